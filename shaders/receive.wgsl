// The hair's shadow on the host's opaque scene: for each pixel with a depth, the part of the light's power that the
// hair lets through to the point behind it, multiplied into the target's colour.
//
// Several lights and the ambient term weigh by their power, which is exact for one light and a white diffuse scene.

struct ReceiveVertex {
    @builtin(position) position: vec4f,
    // By way of the vertices, since one software driver compiles a fragment shader anew, at every draw, whose loop ends
    // at a uniform.
    @location(0) @interpolate(flat, either) light_count: u32,
}

@vertex
fn receive_vertex(@builtin(vertex_index) vertex: u32) -> ReceiveVertex {
    return ReceiveVertex(fullscreen_corner(vertex, 0.0), frame.light_count);
}

@fragment
fn receive(in: ReceiveVertex) -> @location(0) vec4f {
    let pixel = in.position;
    let depth = textureLoad(host_depth, vec2u(pixel.xy), 0);
    let far = select(1.0, 0.0, (frame.flags & FRAME_REVERSE_Z) != 0u);
    if depth == far { discard; }
    let position = host_position(pixel.xy, depth);
    var total = frame.ambient;
    var reached = frame.ambient;
    for (var light = 0u; light < in.light_count; light++) {
        let power = light_reach(light, position).irradiance;
        total += power;
        reached += power * shadow_received(position, light).transmittance;
    }
    return vec4f(select(vec3f(1.0), reached / max(total, vec3f(1e-20)), total > vec3f(0.0)), 1.0);
}
