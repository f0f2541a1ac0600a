// The strand points of a run, as what is shaded takes them.

@group(1) @binding(0) var<storage, read> points: array<Point>;
@group(1) @binding(1) var<storage, read> attributes: array<PointAttributes>;
// Linear RGB, 16-bit floats.
@group(1) @binding(2) var<storage, read> strand_colours: array<vec2u>;
@group(1) @binding(3) var<storage, read> projected: array<Projected>;

// Whether one of the point's two segments may be drawn.
fn points_seen(index: u32) -> bool {
    if (projected[index].bisector_flags.y & (PROJECTED_LAST | PROJECTED_UNSEEN)) == 0u { return true; }
    return (projected[max(index, 1u) - 1u].bisector_flags.y & (PROJECTED_LAST | PROJECTED_UNSEEN)) == 0u;
}

fn points_relative(index: u32) -> vec3f {
    return (drawing.relative_from_object * vec4f(points[index].position, 1.0)).xyz;
}

// The strand's points next to one; the point itself where there is none.
fn points_before(index: u32, strand: u32) -> vec3f {
    return points_relative(select(index - 1u, index, (strand & POINT_FIRST) != 0u));
}

fn points_after(index: u32, strand: u32) -> vec3f {
    return points_relative(select(index + 1u, index, (strand & POINT_LAST) != 0u));
}

// Unit tangent of the circle through a point and its two neighbours, from the ways between them: it parts the turn between the
// two segments as their lengths do, so that unevenly spaced points are lit as even ones are. Some unit vector where the
// strand has no length here.
fn points_tangent(before: vec3f, after: vec3f) -> vec3f {
    let lengths = vec2f(length(before), length(after));
    let parts = lengths / max(lengths.yx, vec2f(1e-30));
    var sum = before / max(parts.x, 1e-30) + after / max(parts.y, 1e-30);
    // At an end, or beside a point that coincides, there is one segment.
    if min(lengths.x, lengths.y) <= 1e-30 { sum = before + after; }
    let size = length(sum);
    return select(vec3f(0.0, 1.0, 0.0), sum / max(size, 1e-30), size > 1e-30);
}
