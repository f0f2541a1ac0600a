// A hair's points from a buffer of the host's, which holds them strand after strand at any stride.
//
// Each of the hair's own points knows its place: the number of the host's point that its segment begins with, times the
// pieces that a segment is cut into, plus its piece. Between two of the host's points lies a uniform Catmull-Rom spline:
// src/groom/tessellate.rs has the equations. Positions are taken relative to the new origin before anything else is done
// with them, so that the curve is as exact as they are. One that is not finite leaves its points where they were.

@group(1) @binding(0) var<uniform> gather_of: Gather;
@group(1) @binding(1) var<storage, read> gather_source: array<u32>;
@group(1) @binding(2) var<storage, read> gather_places: array<u32>;
@group(1) @binding(3) var<storage, read> attributes: array<PointAttributes>;
@group(1) @binding(4) var<storage, read_write> points: array<Point>;

// The bits of a float's exponent: all of them are set where it is infinite, or no number.
const GATHER_EXPONENT: u32 = 0x7f800000u;

struct GatherPosition {
    position: vec3f,
    finite: bool,
}

fn gather_finite(bits: vec3u) -> bool {
    return all((bits & vec3u(GATHER_EXPONENT)) != vec3u(GATHER_EXPONENT));
}

// The host's point `number`, relative to the new origin.
fn gather_position(number: u32) -> GatherPosition {
    let at = gather_of.base + (number - gather_of.lowest) * gather_of.stride;
    let bits = vec3u(gather_source[at], gather_source[at + 1u], gather_source[at + 2u]);
    let position = (bitcast<vec3f>(bits) - gather_of.origin) - gather_of.origin_rest;
    return GatherPosition(position, gather_finite(bits));
}

// The place of the hair's point `index`, piece `piece` of the segment that begins with the host's point `number`.
fn gather_cut(index: u32, number: u32, piece: u32) -> GatherPosition {
    let p1 = gather_position(number);
    if piece == 0u { return p1; }
    let start = index - piece;
    let is_first = (attributes[start].strand & POINT_FIRST) != 0u;
    let is_last = (attributes[start + gather_of.pieces].strand & POINT_LAST) != 0u;
    let p2 = gather_position(number + 1u);
    var p0 = GatherPosition(2.0 * p1.position - p2.position, true);
    var p3 = GatherPosition(2.0 * p2.position - p1.position, true);
    if !is_first { p0 = gather_position(number - 1u); }
    if !is_last { p3 = gather_position(number + 2u); }
    let t = f32(piece) / f32(gather_of.pieces);
    let t2 = t * t;
    let t3 = t2 * t;
    let m1 = 0.5 * (p2.position - p0.position);
    let m2 = 0.5 * (p3.position - p1.position);
    // Cubic Hermite basis.
    let position = p1.position * (2.0 * t3 - 3.0 * t2 + 1.0) + m1 * (t3 - 2.0 * t2 + t)
        + p2.position * (3.0 * t2 - 2.0 * t3) + m2 * (t3 - t2);
    return GatherPosition(position, p0.finite && p1.finite && p2.finite && p3.finite);
}

@compute @workgroup_size(64)
fn gather(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = invocation.x + invocation.y * groups.x * 64u;
    if index >= gather_of.count { return; }
    let place = gather_places[index];
    if place == NO_PLACE { return; }
    let number = place / gather_of.pieces;
    if number < gather_of.first || number >= gather_of.end { return; }
    let found = gather_cut(index, number, place % gather_of.pieces);
    // What is finite may have made something that is not.
    let finite = found.finite && gather_finite(bitcast<vec3u>(found.position));
    points[index].position = select(points[index].position + gather_of.shift, found.position, finite);
}
