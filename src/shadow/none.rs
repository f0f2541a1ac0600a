//! No shadow: every light reaches every fibre. Costs no pass, no map and no look-up.

/// The technique's shader: the look-up alone.
pub(crate) const LOOK_UP: &[&str] = &["shadow/none"];
