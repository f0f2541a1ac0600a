// Maps of nearest depths: where a point stands in a texel. Its own fibre may be the texel's nearest one; there the fibre as
// the map holds it, and not the point, is what others must lie before, by a margin for what its bends are off the straight.

fn shadow_nearest_depth(texel: vec2u, depth: f32, margin: f32) -> f32 {
    let own = shadow_own(texel);
    return select(depth, min(depth, own.depth) - margin, own.touches);
}
