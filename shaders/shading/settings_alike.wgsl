// The settings of a frame whose hairs have the same: they are constants.

fn settings_begin() {}
