// A strand's segment on the screen or on a light's map, and the fragment that it leaves in a pixel.
//
// One fragment per strand per crossing: a segment owns the pixels whose centres lie between the bisector planes at its
// ends. There its coverage is that of the unbounded band, clipped only at the strand's own ends. Both segments of a
// joint evaluate the same plane, so that every pixel has exactly one owner.
//
// A fibre is a tube without caps, worth its length on the screen times its width. A strand's end cuts every band within a pixel of it
// straight across, as far along the band as the strand goes on: so a strand far shorter than wide, or one that points at the eye,
// shows next to nothing, however its last points lie. Cuts at right angles to its first and to its last segment would open a wedge.
//
// Where the header says TOUCH_ONLY no coverage is found, only which pixels the fibre touches: enough for a front and for
// a count. FOOTPRINT says what of a pixel is looked at: its square; its slice, which is enough for a map; or its centre, as the
// hardware samples a triangle.

const FOOTPRINT_SQUARE: u32 = 0u;
const FOOTPRINT_SLICE: u32 = 1u;
const FOOTPRINT_CENTRE: u32 = 2u;

// Whether the invocation's segment need not be compared with the host's depth.
var<private> segment_in_front: bool;

// How far beyond its joint a segment counts as beside it, in half-widths. Of 0, ¼, ½, 1 and √3 the closest to the supersampled area
// of bent strands 1 to 10 px wide; at 0.1 px all are alike.
const SEGMENT_BESIDE_JOINT: f32 = 0.5;
// How much may count of what lies beyond a joint: less than would bring an end into a pixel's reach that is a pixel behind the joint.
const SEGMENT_MOST_BEYOND: f32 = 0.2928;

struct Segment {
    start: vec2f,
    end: vec2f,
    tangent: vec2f,
    normal: vec2f,
    start_plane: vec2f,
    end_plane: vec2f,
    length: f32,
    inverse_length: f32,
    start_half_width: f32,
    end_half_width: f32,
    start_depth: f32,
    end_depth: f32,
    // Places on the whole segment of the part before the near plane.
    along_start: f32,
    along_end: f32,
    // How far beyond the segment's ends the strand goes on, in pixels; huge where that is a pixel or more.
    before: f32,
    after: f32,
    starts: bool,
    ends: bool,
    // The fibre's own opacity, and the number of the first point among the frame's pooled points.
    opacity: f32,
    point: u32,
    valid: bool,
    footprint: Footprint,
    // Whether it is held against slices.
    slice: bool,
}

struct Fragment {
    // Depth as the view stores it, from 0 to 1; distance along the axis on a light's map.
    depth: f32,
    // Place along the segment, from 0 to 1.
    along: f32,
    // The fibre's opacity × coverage.
    opacity: f32,
    // Whether the fibre touches the pixel, if only by a part too small for a float: all else is undefined where not.
    touched: bool,
    // Number of the segment's first point among the frame's pooled points.
    point: u32,
}

fn segment_beyond(word: u32) -> f32 {
    let steps = word & PROJECTED_DISTANCE_MAX;
    return select(f32(steps) / f32(PROJECTED_DISTANCE_MAX), 1e9, steps == PROJECTED_DISTANCE_MAX);
}

// Joints of the screen's polyline that turn by more than 120° are stored as breaks; see project.wgsl.
fn segment(index: u32) -> Segment {
    var s: Segment;
    s.valid = false;
    let p = projected_point(index);
    let flags = p.bisector_flags.y;
    if (flags & (PROJECTED_LAST | PROJECTED_UNSEEN)) != 0u || index + 1u >= drawing.point_count { return s; }
    let q = projected_point(index + 1u);
    let next_flags = q.bisector_flags.y;
    if (flags & (PROJECTED_BEHIND | PROJECTED_CUT_START)) == PROJECTED_BEHIND { return s; }
    if (next_flags & (PROJECTED_BEHIND | PROJECTED_CUT_END)) == PROJECTED_BEHIND { return s; }
    segment_in_front = (flags & PROJECTED_IN_FRONT) != 0u;
    s.start = p.position;
    s.end = q.position;
    s.along_start = 0.0;
    s.along_end = 1.0;
    if (flags & PROJECTED_BEHIND) != 0u {
        s.along_start = f32(flags & PROJECTED_DISTANCE_MAX) / f32(PROJECTED_DISTANCE_MAX);
    }
    if (next_flags & PROJECTED_BEHIND) != 0u {
        let steps = (next_flags >> PROJECTED_DISTANCE_BITS) & PROJECTED_DISTANCE_MAX;
        s.along_end = f32(steps) / f32(PROJECTED_DISTANCE_MAX);
        if (next_flags & PROJECTED_CUT_START) != 0u {
            let range = PROJECTED_SECOND_RANGE * max(drawing.viewport.x, drawing.viewport.y);
            s.end = unpack2x16snorm(q.bisector_flags.x) * range;
        }
    }
    s.start_plane = unpack2x16snorm(p.bisector_flags.x);
    s.end_plane = unpack2x16snorm(q.bisector_flags.x);
    let offset = s.end - s.start;
    s.length = length(offset);
    // Shorter segments have the direction of the strand around their start.
    if s.length > PROJECTED_DIRECTION_PX {
        s.tangent = offset / s.length;
        s.inverse_length = 1.0 / s.length;
    } else {
        s.tangent = normalize(s.start_plane);
        s.inverse_length = 0.0;
    }
    s.normal = vec2f(s.tangent.y, -s.tangent.x);
    let twice = PROJECTED_CUT_START | PROJECTED_CUT_END;
    let near = select(0.0, 1.0, (drawing.flags & DRAWING_REVERSE_Z) != 0u);
    s.start_half_width = p.depth_width.y;
    s.start_depth = select(p.depth_width.x, near, (flags & twice) == twice);
    s.end_half_width = select(q.depth_width.y, q.depth_width.x, (next_flags & twice) == twice);
    s.end_depth = select(q.depth_width.x, near, (next_flags & twice) == twice);
    s.starts = (flags & (PROJECTED_FIRST | PROJECTED_BREAK | PROJECTED_CUT_START)) != 0u;
    s.ends = (next_flags & (PROJECTED_LAST | PROJECTED_BREAK | PROJECTED_CUT_END)) != 0u;
    s.before = select(segment_beyond(flags >> PROJECTED_DISTANCE_BITS), 0.0, s.starts);
    s.after = select(segment_beyond(next_flags), 0.0, s.ends);
    s.slice = FOOTPRINT == FOOTPRINT_SLICE && max(s.start_half_width, s.end_half_width) <= FOOTPRINT_SLICE_MOST;
    s.footprint = footprint(s.normal);
    if s.slice { s.footprint = footprint_slice(s.normal); }
    if FOOTPRINT == FOOTPRINT_CENTRE { s.footprint.support = 0.0; }
    // Uniforms are read here once and not at every pixel, where some drivers would read them anew.
    s.opacity = drawing.opacity;
    s.point = drawing.point_base + index;
    s.valid = max(s.start_half_width, s.end_half_width) > 0.0 && s.opacity > 0.0;
    return s;
}

// How far from its axis the segment can touch a pixel's centre.
fn segment_reach(s: Segment) -> f32 {
    return max(s.start_half_width, s.end_half_width) + s.footprint.support;
}

// How far beyond an end along the axis owned pixels can lie.
fn segment_overhang(s: Segment, plane: vec2f, is_end: bool, reach: f32) -> f32 {
    if is_end {
        if !s.slice { return s.footprint.support; }
        let across = min(abs(s.normal.x), abs(s.normal.y));
        return (0.5 + reach * across) * s.footprint.inverse_a;
    }
    let along = dot(plane, s.tangent);
    return reach * abs(dot(plane, s.normal)) / max(along, 0.25);
}

// In clip space, one of the four corners of a strip that holds every pixel that the segment owns.
fn segment_corner(s: Segment, vertex: u32) -> vec4f {
    if !s.valid { return vec4f(0.0, 0.0, -1.0, 1.0); }
    // A pixel whose centre lies at the ribbon's rim must still be drawn.
    let reach = segment_reach(s) + 0.01;
    let at_end = vertex >= 2u;
    let plane = select(s.start_plane, s.end_plane, at_end);
    let overhang = segment_overhang(s, plane, select(s.starts, s.ends, at_end), reach) + 0.01;
    let side = select(-reach, reach, (vertex & 1u) == 1u);
    let corner = select(s.start - overhang * s.tangent, s.end + overhang * s.tangent, at_end) + side * s.normal;
    let ndc = vec2f(2.0, -2.0) * corner / drawing.viewport + vec2f(-1.0, 1.0);
    return vec4f(ndc, 0.5, 1.0);
}

// Whether an end of the strand lies within a footprint of the segment.
fn segment_near_end(s: Segment) -> bool {
    return min(s.before, s.after) < 1.0;
}

// The segment's fragment in the pixel with the given centre. `near_end` is `segment_near_end`; where a caller passes
// `false` as a constant the code for ends is left out.
fn segment_fragment(s: Segment, centre: vec2f, near_end: bool) -> Fragment {
    var fragment: Fragment;
    fragment.touched = false;
    let from_start = centre - s.start;
    if !s.starts && dot(from_start, s.start_plane) < 0.0 { return fragment; }
    if !s.ends && dot(centre - s.end, s.end_plane) >= 0.0 { return fragment; }
    let along = dot(from_start, s.tangent);
    let across = dot(from_start, s.normal);
    let part = clamp(along * s.inverse_length, 0.0, 1.0);
    // Not by `mix`, nor by weights: some drivers make one thing or another of these by what else a shader holds, and what one pass
    // has counted another has to find again.
    let half_width = s.start_half_width + (s.end_half_width - s.start_half_width) * part;
    fragment.along = s.along_start + (s.along_end - s.along_start) * part;
    fragment.depth = s.start_depth + (s.end_depth - s.start_depth) * part;
    fragment.point = s.point;
    let support = s.footprint.support;
    // A strand's end cuts every segment within a footprint of it, not only the last one.
    var start = -along - s.before;
    var end = s.length - along + s.after;
    fragment.touched = abs(across) < half_width + support;
    if near_end {
        if s.slice {
            let part = coverage_slice_ends(s.normal, across, max(start, -2.0), min(end, 2.0));
            fragment.touched = fragment.touched && part > 0.0;
        } else {
            // Beyond a joint, on the bend's outer side, the strand is the joint swept round: what lies beyond counts little, and
            // a strand shows no more than twice its length.
            let back = select(max(-along, 0.0), 0.0, s.starts);
            let past = select(max(along - s.length, 0.0), 0.0, s.ends);
            let beside = SEGMENT_BESIDE_JOINT * half_width;
            start -= back - clamp(back - beside, 0.0, SEGMENT_MOST_BEYOND);
            end += past - clamp(past - beside, 0.0, SEGMENT_MOST_BEYOND);
            let most = 2.0 * (s.before + s.length + s.after);
            start = select(max(start, end - most), start, back > 0.0);
            end = min(end, start + most);
            fragment.touched = fragment.touched && start < support && end > -support && (FOOTPRINT == FOOTPRINT_CENTRE
                || coverage_touches(s.normal, across, half_width, max(start, -2.0), min(end, 2.0)));
        }
    }
    if !TOUCH_ONLY {
        var coverage = coverage_band(s.footprint, across, half_width);
        if near_end && s.slice {
            coverage *= coverage_slice_ends(s.normal, across, max(start, -2.0), min(end, 2.0));
        } else if near_end && (start > -support || end < support) {
            coverage = coverage_rectangle(s.normal, -across - half_width, 2.0 * half_width, start, end);
        }
        fragment.opacity = s.opacity * max(coverage, 0.0);
    }
    return fragment;
}
