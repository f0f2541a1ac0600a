// No shadow: every light reaches every fibre.

struct ShadowSample {
    transmittance: vec3f,
    // Σ coverage of the fibres towards the light.
    fibres: f32,
}

fn shadow(position: vec3f, light: u32) -> ShadowSample {
    return ShadowSample(vec3f(1.0), 0.0);
}
