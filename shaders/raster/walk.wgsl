// The walk: one invocation walks the pixels that one segment touches, slice by slice along the segment's major axis,
// and hands each fragment to `emit`. No render pass, no attachment.

@compute @workgroup_size(64)
fn walk(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let count = order[drawing.point_count - 1u];
    let number = spread_number(invocation.x + invocation.y * groups.x * 64u, groups.x * groups.y, count);
    if number >= count || !emit_begin() { return; }
    let index = order[number];
    let s = segment(index);
    if !s.valid { return; }
    // Three copies, so that most pixels pay neither for ends nor for a comparison with the host's depth.
    let slices = walk_slices(s);
    if segment_near_end(s) { walk_pixels(s, slices, invocation.z, true, true); }
    if EMIT_COMPARES && !segment_in_front {
        walk_pixels(s, slices, invocation.z, false, true);
    } else {
        walk_pixels(s, slices, invocation.z, false, false);
    }
    emit_end();
}

// The slices of pixels across a segment's major axis.
struct Slices {
    steep: bool,
    // All of them, and those without pixels near a strand's end: first and last.
    all: vec2i,
    inner: vec2i,
    // First and last pixel of each slice, before the half-width is added, from its centre: start.y + (centre - start.x) × slope.
    start: vec2f,
    slope: f32,
    extent: f32,
    minor_bounds: vec2f,
}

fn walk_slices(s: Segment) -> Slices {
    let reach = segment_reach(s);
    let a = s.start - s.tangent * segment_overhang(s, s.start_plane, s.starts, reach);
    let b = s.end + s.tangent * segment_overhang(s, s.end_plane, s.ends, reach);

    // (major, minor) coordinates.
    var slices: Slices;
    slices.steep = abs(s.tangent.y) > abs(s.tangent.x);
    let steep = slices.steep;
    let tangent = select(s.tangent.xy, s.tangent.yx, steep);
    slices.start = select(s.start.xy, s.start.yx, steep);
    let rows = vec2f(f32(drawing.row_first), f32(drawing.row_end));
    let columns = vec2f(0.0, drawing.viewport.x);
    let major_bounds = select(columns, rows, steep);
    slices.minor_bounds = select(rows, columns, steep);
    let major_a = select(a.x, a.y, steep);
    let major_b = select(b.x, b.y, steep);
    let spread = reach * abs(tangent.y);
    slices.all = vec2i(
        i32(max(ceil(min(major_a, major_b) - spread - 0.5), major_bounds.x)),
        i32(min(floor(max(major_a, major_b) + spread - 0.5), major_bounds.y - 1.0)),
    );
    slices.slope = tangent.y / tangent.x;
    slices.extent = reach / abs(tangent.x);

    // Along the fibre a slice's pixels are as far as its centre, and up to this much before or behind it.
    slices.inner = slices.all;
    if segment_near_end(s) {
        let margin = s.footprint.support + reach * abs(slices.slope) + 0.01;
        let near = slices.start.x + (margin - s.before) * tangent.x;
        let far = slices.start.x + (s.length + s.after - margin) * tangent.x;
        let forward = tangent.x > 0.0;
        let bounds = clamp(select(vec2f(far, near), vec2f(near, far), forward), vec2f(-1e6), vec2f(1e6));
        slices.inner = vec2i(
            max(slices.all.x, i32(ceil(bounds.x - 0.5))),
            min(slices.all.y, i32(floor(bounds.y - 0.5))),
        );
    }
    return slices;
}

// First and last pixel of a slice.
fn walk_slice(slices: Slices, major: i32) -> vec2i {
    let middle = slices.start.y + (f32(major) + 0.5 - slices.start.x) * slices.slope;
    return vec2i(
        i32(max(ceil(middle - slices.extent - 0.5), slices.minor_bounds.x)),
        i32(min(floor(middle + slices.extent - 0.5), slices.minor_bounds.y - 1.0)),
    );
}

// The pixels of the slices with a strand's end, or of the others. One loop over both axes, so that segments side by side need
// not wait for each other at every slice.
fn walk_pixels(s: Segment, slices: Slices, split: u32, near_end: bool, compare: bool) {
    let stride = i32(drawing.splits);
    // Between the two ends there may be nothing to leave out.
    let skip = select(slices.inner, vec2i(0x7fffffff, 0), slices.inner.x > slices.inner.y);
    let range = select(slices.inner, slices.all, near_end);
    var major = range.x + i32(split);
    if near_end && major >= skip.x && major <= skip.y { major += (skip.y - major) / stride * stride + stride; }
    var minors = walk_slice(slices, major);
    for (; major <= range.y;) {
        if minors.x <= minors.y {
            let coordinates = vec2f(f32(major) + 0.5, f32(minors.x) + 0.5);
            let centre = select(coordinates.xy, coordinates.yx, slices.steep);
            let fragment = segment_fragment(s, centre, near_end);
            if fragment.touched { emit(vec2u(centre), fragment, compare); }
        }
        minors.x += 1;
        if minors.x > minors.y {
            major += stride;
            if near_end && major >= skip.x && major <= skip.y { major += (skip.y - major) / stride * stride + stride; }
            minors = walk_slice(slices, major);
        }
    }
}
