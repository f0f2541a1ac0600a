// What a light throws on a position that nothing shadows.

struct LightReach {
    // Unit, towards the light.
    wi: vec3f,
    // On a plane that faces the light.
    irradiance: vec3f,
}

fn light_reach(light: u32, position: vec3f) -> LightReach {
    let place = frame.lights[light].place;
    let to_light = place.xyz - position * place.w;
    let distance = max(length(to_light), 1e-20);
    let wi = to_light / distance;
    let falloff = select(1.0, 1.0 / (distance * distance), place.w > 0.0);
    let t = saturate((-dot(frame.lights[light].axis, wi) - frame.lights[light].cos_outer) * frame.lights[light].edge);
    return LightReach(wi, frame.lights[light].power * (falloff * t * t * (3.0 - 2.0 * t)));
}
