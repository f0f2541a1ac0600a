// Fronts of a light's map: the nearest depth of each block of texels.

// Where a texel's front lies among a map's fronts, of which blocks of 1 << shift texels a side share one.
fn shadow_front_place(texel: vec2u, resolution: u32, shift: u32) -> u32 {
    let width = (resolution + (1u << shift) - 1u) >> shift;
    return (texel.y >> shift) * width + (texel.x >> shift);
}

// The bits of a positive float order like the float; kept as a distance from the largest one, so that a cleared word
// is the farthest front and the nearest fragment the maximum.
const SHADOW_FARTHEST: u32 = 0x7f7fffffu;

fn shadow_front_word(depth: f32) -> u32 {
    return SHADOW_FARTHEST - bitcast<u32>(max(depth, 0.0));
}

fn shadow_front(word: u32) -> f32 {
    return bitcast<f32>(SHADOW_FARTHEST - word);
}
