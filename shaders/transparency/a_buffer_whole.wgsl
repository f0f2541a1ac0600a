// Nothing lies behind what the pool and its tail hold.

// Colour and transmittance.
fn resolve_beyond(number: u32) -> vec4f {
    return vec4f(0.0, 0.0, 0.0, 1.0);
}
