// The position, in relative space, that a pixel of the host's depth stands for.

fn host_position(pixel: vec2f, depth: f32) -> vec3f {
    let local = pixel - vec2f(frame.origin);
    let ndc = vec2f(2.0, -2.0) * local / vec2f(f32(frame.width), f32(frame.height)) + vec2f(-1.0, 1.0);
    let homogeneous = frame.relative_from_clip * vec4f(ndc, depth, 1.0);
    return homogeneous.xyz / homogeneous.w;
}
