// Fronts of a light's map: the nearest depth of each texel.

// The bits of a positive float order like the float; kept as a distance from the largest one, so that a cleared word
// is the farthest front and the nearest fragment the maximum.
const SHADOW_FARTHEST: u32 = 0x7f7fffffu;

fn shadow_front_word(depth: f32) -> u32 {
    return SHADOW_FARTHEST - bitcast<u32>(max(depth, 0.0));
}

fn shadow_front(word: u32) -> f32 {
    return bitcast<f32>(SHADOW_FARTHEST - word);
}
