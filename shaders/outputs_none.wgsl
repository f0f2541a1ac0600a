// The outputs beside the colour where a frame has no hair.

struct Outputs {
    @location(0) depth: f32,
    @location(1) coverage: f32,
    @location(2) motion: vec2f,
    @location(3) ids: vec2u,
}

@fragment
fn outputs() -> Outputs {
    return Outputs(select(1.0, 0.0, REVERSE_Z), 0.0, vec2f(0.0), vec2u(0xffffffffu));
}
