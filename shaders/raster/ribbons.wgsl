// Ribbons: one instanced strip of four vertices a segment, wide enough for every pixel that the segment owns; the
// fragment shader finds the same fragment as the walk and hands it to `emit`.

struct RibbonVertex {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat, either) index: u32,
}

@vertex
fn ribbon_vertex(@builtin(vertex_index) vertex: u32, @builtin(instance_index) index: u32) -> RibbonVertex {
    var out: RibbonVertex;
    out.index = index;
    out.position = vec4f(0.0, 0.0, -1.0, 1.0);
    let s = segment(index);
    if !s.valid { return out; }
    // A pixel whose centre lies at the ribbon's rim must still be drawn.
    let reach = segment_reach(s) + 0.01;
    let at_end = vertex >= 2u;
    let plane = select(s.start_plane, s.end_plane, at_end);
    let overhang = segment_overhang(s, plane, select(s.starts, s.ends, at_end), reach) + 0.01;
    let side = select(-reach, reach, (vertex & 1u) == 1u);
    let corner = select(s.start - overhang * s.tangent, s.end + overhang * s.tangent, at_end) + side * s.normal;
    let ndc = vec2f(2.0, -2.0) * corner / segment_viewport() + vec2f(-1.0, 1.0);
    out.position = vec4f(ndc, 0.5, 1.0);
    return out;
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
