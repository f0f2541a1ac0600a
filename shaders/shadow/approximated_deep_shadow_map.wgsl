// Approximated deep shadow map: the look-up (Hunz §4.3; Martin et al. 2014 as "approximated deep shadows"). How many
// fibres lie between the light and a point is guessed from its depth behind the nearest fibre at the texel's centre, d_f - d_s,
// and the mean spacing w of fibres along the ray:
//
//     n = (d_f - d_s) / w + 1 where d_f - d_s > ε (the step: the nearest fibre itself), else 0
//     transmittance = (1 - α_s)ⁿ
//
// Hunz (eq. 68, 69) calls w the width of a hair and the result "in shadow"; with w a width the fibres would fill all of
// space, and the value is what passes.

fn shadow_texel(place: vec2u, map: u32, light: u32, depth: f32) -> ShadowTexel {
    let texel = place.y * frame.lights[light].resolution + place.x;
    // 1 / w, -ln(1 - α_s), and the margin, which is ε.
    let values = frame.shadow_views[map].values;
    let front = shadow_front(shadow_maps[frame.shadow_views[map].front_base + texel]);
    let behind = shadow_nearest_depth(place, depth, values.z) - front;
    if !(behind > 0.0) { return ShadowTexel(vec3f(1.0), 0.0); }
    let optical_depth = (behind * values.x + 1.0) * values.y;
    return shadow_passed(optical_depth, map);
}
