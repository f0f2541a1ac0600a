// Deep opacity map: where its layers lie.
//
// Layer k of K ends at extent · f(k/K) behind the front, f(x) = (e^(gx) - 1) / (e^g - 1): each layer is thicker than the one
// before it by the same factor. Most light is lost near the lit surface, but some hair lies far behind stray ones.

// The last layer's growth over the first, as a logarithm. Measured on straight, wavy and curly hair: of 2 to 6 the best, or
// within a tenth of it, from 4 to 32 layers.
const DEEP_OPACITY_GROWTH: f32 = 5.0;
const DEEP_OPACITY_RANGE: f32 = 147.41316;

fn deep_opacity_boundary(x: f32) -> f32 {
    return (exp(DEEP_OPACITY_GROWTH * x) - 1.0) / DEEP_OPACITY_RANGE;
}

// The layer, from 0 to count - 1, of a depth behind the front in units of the extent. The last layer is open-ended.
fn deep_opacity_layer(depth: f32, count: u32) -> u32 {
    let x = log(1.0 + DEEP_OPACITY_RANGE * clamp(depth, 0.0, 1.0)) / DEEP_OPACITY_GROWTH;
    return min(u32(x * f32(count)), count - 1u);
}
