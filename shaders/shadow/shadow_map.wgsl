// Shadow map: the look-up (Williams 1978, as Hunz §6.2 uses it). A texel whose nearest fibre lies before the point takes
// `strength` of the light; the filter averages these decisions (percentage-closer filtering, Reeves et al. 1987).

fn shadow_texel(place: vec2u, map: u32, light: u32, depth: f32) -> ShadowTexel {
    let texel = place.y * frame.lights[light].resolution + place.x;
    let front = shadow_front(shadow_maps[frame.shadow_views[map].front_base + texel]);
    // Transmittance and optical depth of what lies in shadow, and the margin.
    let values = frame.shadow_views[map].values;
    let hidden = shadow_nearest_depth(place, depth, values.z) > front;
    return ShadowTexel(vec3f(select(1.0, values.x, hidden)), select(0.0, values.y, hidden));
}
