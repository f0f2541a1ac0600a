// Opacity shadow maps: the look-up. Ω is interpolated linearly between the planes before and behind the point;
// transmittance is exp(-Ω). Kim's κ rescales an 8-bit alpha, which stores opacity up to 1; sums of optical depth in fixed
// point need none (κ = 1). Kim's 3×3 filter averages Ω; here it averages transmittance, as for all maps.
//
// Interpolation spreads every fragment over its slab, the point's own fibre too, which would shadow itself by half of its
// own opacity on average: it is taken off.

fn shadow_texel(place: vec2u, map: u32, light: u32, depth: f32) -> ShadowTexel {
    // Extent and unevenness.
    let values = frame.shadow_views[map].values;
    let at = depth / values.x;
    if !(at > 0.0) { return ShadowTexel(vec3f(1.0), 0.0); }
    let count = frame.lights[light].layer_count;
    let slab = opacity_slab(at, values.y, count);
    let texel = place.y * frame.lights[light].resolution + place.x;
    let word = frame.shadow_views[map].layer_base + texel * count + slab;
    var before = 0.0;
    if slab > 0u { before = f32(shadow_maps[word - 1u]) / OPTICAL_DEPTH_SCALE; }
    var behind = f32(shadow_maps[word]) / OPTICAL_DEPTH_SCALE;
    let own = shadow_own(place);
    let own_slab = opacity_slab(own.depth / values.x, values.y, count);
    if own_slab < slab { before = max(before - own.optical_depth, 0.0); }
    if own_slab <= slab { behind = max(behind - own.optical_depth, before); }
    let low = opacity_plane(f32(slab) / f32(count), values.y);
    let high = opacity_plane(f32(slab + 1u) / f32(count), values.y);
    let part = clamp((at - low) / (high - low), 0.0, 1.0);
    let optical_depth = mix(before, behind, part);
    return shadow_passed(optical_depth, map);
}
