// Ribbons: one instanced strip of four vertices a segment, wide enough for every pixel that the segment owns; the
// fragment shader finds the same fragment as the walk and hands it to `emit`.

struct RibbonVertex {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat, either) index: u32,
}

@vertex
fn ribbon_vertex(@builtin(vertex_index) vertex: u32, @builtin(instance_index) index: u32) -> RibbonVertex {
    return RibbonVertex(segment_corner(segment(index), vertex), index);
}

@fragment
fn ribbon_fragment(in: RibbonVertex) -> @location(0) vec4f {
    if emit_begin() {
        let s = segment(in.index);
        let fragment = segment_fragment(s, floor(in.position.xy) + 0.5, segment_near_end(s));
        if fragment.touched { emit(vec2u(in.position.xy), fragment, !segment_in_front); }
        emit_end();
    }
    return vec4f(0.0);
}
