// Deep opacity map: the look-up. Opacity is interpolated linearly between a texel's layers; points past the last layer
// take its whole sum.

fn shadow_texel(place: vec2u, map: u32, light: u32, depth: f32) -> ShadowTexel {
    let resolution = frame.lights[light].resolution;
    let texel = place.y * resolution + place.x;
    let fronts = frame.shadow_views[map].front_base;
    let front = shadow_front(shadow_maps[fronts + texel]);
    let count = frame.lights[light].layer_count;
    let extent = frame.shadow_views[map].values.x;
    let behind = (depth - front) / extent;
    if !(behind > 0.0) { return ShadowTexel(vec3f(1.0), 0.0); }
    let layer = deep_opacity_layer(behind, count);
    let word = frame.shadow_views[map].layer_base + texel * count + layer;
    var sum = 0.0;
    if layer > 0u { sum = f32(shadow_maps[word - 1u]) / OPTICAL_DEPTH_SCALE; }
    var end = f32(shadow_maps[word]) / OPTICAL_DEPTH_SCALE;
    // Without the point's own fibre.
    let own = shadow_own(place);
    let own_layer = deep_opacity_layer((own.depth - front) / extent, count);
    if own_layer < layer { sum = max(sum - own.optical_depth, 0.0); }
    if own_layer <= layer { end = max(end - own.optical_depth, sum); }
    let low = deep_opacity_boundary(f32(layer) / f32(count));
    let high = deep_opacity_boundary(f32(layer + 1u) / f32(count));
    let part = clamp((behind - low) / (high - low), 0.0, 1.0);
    let others = mix(sum, end, part);
    return shadow_passed(others, map);
}
