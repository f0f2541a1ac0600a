// Approximated deep shadow map: the look-up (Hunz §4.3; Martin et al. 2014 as "approximated deep shadows"). How many
// fibres lie between the light and a point is guessed from its depth behind the texel's nearest fibre, d_f - d_s, and the
// mean spacing w of fibres along the ray:
//
//     n = (d_f - d_s) / w + 1 where that is above the bias (the ε-step: the nearest fibre itself), else 0
//     transmittance = (1 - α_s)ⁿ
//
// Hunz (eq. 68, 69) calls w the width of a hair and the result "in shadow"; with w a width the fibres would fill all of
// space, and the value is what passes.

fn shadow_texel(place: vec2u, map: u32, light: u32, depth: f32) -> ShadowTexel {
    let texel = place.y * frame.lights[light].resolution + place.x;
    let behind = depth - shadow_front(shadow_maps[frame.shadow_views[map].front_base + texel]);
    if !(behind > 0.0) { return ShadowTexel(vec3f(1.0), 0.0); }
    // 1 / w, and -ln(1 - α_s).
    let values = frame.shadow_views[map].values;
    let optical_depth = (behind * values.x + 1.0) * values.y;
    return shadow_passed(optical_depth, map);
}
