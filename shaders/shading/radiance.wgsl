// A fibre's radiance towards the eye under all lights. The model's file supplies `scatter`, which takes the shadow in, and
// `scatter_uniform`; who calls has set `shadow_fibre`.

fn shading_radiance(fibre: Fibre, position: vec3f, light_count: u32) -> vec3f {
    let to_eye = frame.eye.xyz - position * frame.eye.w;
    let wo = to_eye / max(length(to_eye), 1e-30);
    var radiance = vec3f(0.0);
    if any(frame.ambient > vec3f(0.0)) { radiance = frame.ambient * scatter_uniform(fibre, wo); }
    for (var light = 0u; light < light_count; light++) {
        let reach = light_reach(light, position);
        let wi = reach.wi;
        // Along a strand that leans towards the light its own depth changes within the filter: the look-up moves
        // towards the light by twice the bias times the slope.
        let lean = abs(dot(fibre.tangent, wi));
        let slope = lean / max(sqrt(max(1.0 - lean * lean, 0.0)), 0.125);
        let visible = shadow(position + wi * (2.0 * slope * frame.lights[light].bias), light);
        radiance += occlusion(position, wi, light) * reach.irradiance * scatter(fibre, wi, wo, visible);
    }
    // The largest 16-bit float; also what becomes of an infinity.
    return min(max(radiance, vec3f(0.0)), vec3f(65504.0));
}
