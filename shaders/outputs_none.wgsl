// The outputs beside the colour where a frame has no hair.

struct Outputs {
    @location(0) depth: f32,
    @location(1) coverage: f32,
    @location(2) motion: vec2f,
    @location(3) ids: vec2u,
}

@vertex
fn outputs_vertex(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4f {
    let corner = vec2f(f32((vertex << 1u) & 2u), f32(vertex & 2u));
    return vec4f(corner * 2.0 - 1.0, 0.0, 1.0);
}

@fragment
fn outputs() -> Outputs {
    return Outputs(select(1.0, 0.0, REVERSE_Z), 0.0, vec2f(0.0), vec2u(0xffffffffu));
}
