// One triangle that covers the viewport.

fn fullscreen_corner(vertex: u32, depth: f32) -> vec4f {
    let corner = vec2f(f32((vertex << 1u) & 2u), f32(vertex & 2u));
    return vec4f(corner * 2.0 - 1.0, depth, 1.0);
}

@vertex
fn fullscreen_vertex(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4f {
    return fullscreen_corner(vertex, 0.0);
}
