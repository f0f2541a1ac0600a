// The composite: each pixel's resolved hair, premultiplied, blended over the target's colour; on request its nearest
// depth into the target's depth.

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
