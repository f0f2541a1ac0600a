// The composite: each pixel's resolved hair, premultiplied, blended over the target's colour; on request its nearest
// depth into the target's depth.

@vertex
fn composite_vertex(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4f {
    let corner = vec2f(f32((vertex << 1u) & 2u), f32(vertex & 2u));
    return vec4f(corner * 2.0 - 1.0, 0.0, 1.0);
}

@fragment
fn composite(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return resolve(pixel_of(position)).colour;
}

struct ColourAndDepth {
    @location(0) colour: vec4f,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn composite_with_depth(@builtin(position) position: vec4f) -> ColourAndDepth {
    let resolved = resolve(pixel_of(position));
    if resolved.key == 0xffffffffu { discard; }
    return ColourAndDepth(resolved.colour, depth_of_key(resolved.key));
}
