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
