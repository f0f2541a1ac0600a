// The outputs beside the colour: of each pixel's nearest fibre its depth, its motion and whose it is, and the part of the
// pixel that hair covers.

@group(1) @binding(0) var<storage, read> point_outputs: array<PointOutput>;

const NO_STRAND: u32 = 0xffffffffu;

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
fn outputs(@builtin(position) position: vec4f) -> Outputs {
    let near = nearest(pixel_of(position));
    var out = Outputs(select(1.0, 0.0, pixels_reverse), near.opacity, vec2f(0.0), vec2u(NO_STRAND));
    if near.key != 0xffffffffu { out.depth = depth_of_key(near.key); }
    if near.point != 0xffffffffu && TRACKED {
        let a = point_outputs[near.point];
        let b = point_outputs[near.point + 1u];
        out.motion = mix(a.motion, b.motion, near.along);
        out.ids = vec2u(a.hair, a.strand);
    }
    return out;
}
