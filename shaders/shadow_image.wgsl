// The hair's shadow from one light on the host's opaque scene: for each pixel with a depth, the part of the light that the
// hair lets through to the point behind it. The light's number is that of the instance.

struct ShadowImageVertex {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat, either) light: u32,
}

@vertex
fn shadow_image_vertex(@builtin(vertex_index) vertex: u32, @builtin(instance_index) light: u32) -> ShadowImageVertex {
    return ShadowImageVertex(fullscreen_corner(vertex, 0.0), light);
}

@fragment
fn shadow_image(in: ShadowImageVertex) -> @location(0) vec4f {
    let depth = textureLoad(host_depth, vec2u(in.position.xy), 0);
    let far = select(1.0, 0.0, (frame.flags & FRAME_REVERSE_Z) != 0u);
    if depth == far { return vec4f(1.0); }
    return vec4f(shadow(host_position(in.position.xy, depth), in.light).transmittance, 1.0);
}
