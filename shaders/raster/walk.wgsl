// The walk: one invocation walks the pixels that one segment touches, slice by slice along the segment's major axis,
// and hands each fragment to `emit`. No render pass, no attachment.

@compute @workgroup_size(64)
fn walk(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let number = invocation.x + invocation.y * groups.x * 64u;
    if number >= order[drawing.point_count - 1u] || !emit_begin() { return; }
    let index = order[number];
    let s = segment(index);
    if !s.valid { return; }
    // Three copies, so that most segments pay neither for ends nor for a comparison with the host's depth.
    if segment_near_end(s) {
        walk_pixels(s, invocation.z, true, true);
    } else if EMIT_COMPARES && !segment_in_front {
        walk_pixels(s, invocation.z, false, true);
    } else {
        walk_pixels(s, invocation.z, false, false);
    }
    emit_end();
}

fn walk_pixels(s: Segment, split: u32, near_end: bool, compare: bool) {
    let reach = segment_reach(s);
    let a = s.start - s.tangent * segment_overhang(s, s.start_plane, s.starts, reach);
    let b = s.end + s.tangent * segment_overhang(s, s.end_plane, s.ends, reach);

    // (major, minor) coordinates.
    let steep = abs(s.tangent.y) > abs(s.tangent.x);
    let tangent = select(s.tangent.xy, s.tangent.yx, steep);
    let start = select(s.start.xy, s.start.yx, steep);
    let down = DOWNSCALE;
    let rows = vec2f(f32(drawing.row_first / down), f32((drawing.row_end + down - 1u) / down));
    let columns = vec2f(0.0, segment_viewport().x);
    let major_bounds = select(columns, rows, steep);
    let minor_bounds = select(rows, columns, steep);
    let major_a = select(a.x, a.y, steep);
    let major_b = select(b.x, b.y, steep);
    let spread = reach * abs(tangent.y);
    let first = i32(max(ceil(min(major_a, major_b) - spread - 0.5), major_bounds.x));
    let last = i32(min(floor(max(major_a, major_b) + spread - 0.5), major_bounds.y - 1.0));
    let slope = tangent.y / tangent.x;
    let extent = reach / abs(tangent.x);

    let stride = i32(drawing.splits);
    for (var major = first + i32(split); major <= last; major += stride) {
        let major_centre = f32(major) + 0.5;
        let middle = start.y + (major_centre - start.x) * slope;
        let minor_first = i32(max(ceil(middle - extent - 0.5), minor_bounds.x));
        let minor_last = i32(min(floor(middle + extent - 0.5), minor_bounds.y - 1.0));
        for (var minor = minor_first; minor <= minor_last; minor++) {
            let coordinates = vec2f(major_centre, f32(minor) + 0.5);
            let centre = select(coordinates.xy, coordinates.yx, steep);
            let fragment = segment_fragment(s, centre, near_end);
            if fragment.touched { emit(vec2u(centre), fragment, compare); }
        }
    }
}
