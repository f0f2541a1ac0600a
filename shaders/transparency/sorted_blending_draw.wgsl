// Sorted blending: ribbons in the order of the sort, blended by fixed function. The drawing's own opacity is 1.

struct BlendedVertex {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat, either) index: u32,
    @location(1) @interpolate(flat, either) opacity: f32,
}

@vertex
fn sorted_blending_vertex(@builtin(vertex_index) vertex: u32, @builtin(instance_index) number: u32) -> BlendedVertex {
    var out: BlendedVertex;
    out.index = order[2u * number];
    out.opacity = bitcast<f32>(order[2u * number + 1u]);
    out.position = segment_corner(segment(out.index), vertex);
    return out;
}

@fragment
fn sorted_blending_fragment(in: BlendedVertex) -> @location(0) vec4f {
    emit_common_begin();
    let s = segment(in.index);
    let fragment = segment_fragment(s, floor(in.position.xy) + 0.5, segment_near_end(s));
    let opacity = fragment.opacity * in.opacity;
    if !fragment.touched || !fragment_in_range(fragment) || !(opacity > 0.0) { discard; }
    if fragment_hidden(vec2u(in.position.xy), depth_key(fragment.depth), !segment_in_front) { discard; }
    return vec4f(shaded_colour(fragment.point, fragment.along) * opacity, opacity);
}
