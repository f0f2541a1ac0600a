// Deep opacity map: where its layers lie, and its fixed-point optical depths.
//
// Layer k of K ends at extent · f(k/K) behind the front, f(x) = x (1 + x) / 2: the layers near the lit surface, where
// transmittance changes most, are half as thick as even ones, those at the back one and a half times.

fn deep_opacity_boundary(x: f32) -> f32 {
    return 0.5 * x * (1.0 + x);
}

// The layer, from 0 to count - 1, of a depth behind the front in units of the extent. The last layer is open-ended.
fn deep_opacity_layer(depth: f32, count: u32) -> u32 {
    let x = 0.5 * (sqrt(1.0 + 8.0 * clamp(depth, 0.0, 1.0)) - 1.0);
    return min(u32(x * f32(count)), count - 1u);
}

// Texels a side that share one front: the layers of neighbouring texels then begin together, and fronts cost a third.
const DEEP_OPACITY_FRONT: u32 = 2u;

// Where a texel's front lies among a map's fronts.
fn deep_opacity_front_place(texel: vec2u, resolution: u32) -> u32 {
    let width = (resolution + DEEP_OPACITY_FRONT - 1u) / DEEP_OPACITY_FRONT;
    return (texel.y / DEEP_OPACITY_FRONT) * width + texel.x / DEEP_OPACITY_FRONT;
}

// The bits of a positive float order like the float; kept as a distance from the largest one, so that a cleared word
// is the farthest front and the nearest fragment the maximum.
const DEEP_OPACITY_FARTHEST: u32 = 0x7f7fffffu;

fn deep_opacity_front_word(depth: f32) -> u32 {
    return DEEP_OPACITY_FARTHEST - bitcast<u32>(max(depth, 0.0));
}

fn deep_opacity_front(word: u32) -> f32 {
    return bitcast<f32>(DEEP_OPACITY_FARTHEST - word);
}
