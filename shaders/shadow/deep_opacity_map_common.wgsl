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
