// Sorted blending: what the draw reads of all runs.

// Two words a segment: its first point among the frame's pooled points, and its fibre's opacity.
@group(1) @binding(0) var<storage, read> order: array<u32>;
// The pooled points in POINT_PARTS bindings, since one may be too small for them. Each but the last holds POINTS_EACH.
@group(1) @binding(1) var<storage, read> projected_0: array<Projected>;
@group(1) @binding(2) var<storage, read> projected_1: array<Projected>;
@group(1) @binding(3) var<storage, read> projected_2: array<Projected>;
@group(1) @binding(4) var<storage, read> projected_3: array<Projected>;

// A segment's ends may lie in two parts.
fn projected_point(index: u32) -> Projected {
    if POINT_PARTS == 1u || index < POINTS_EACH { return projected_0[index]; }
    if POINT_PARTS == 2u || index < 2u * POINTS_EACH { return projected_1[index - POINTS_EACH]; }
    if POINT_PARTS == 3u || index < 3u * POINTS_EACH { return projected_2[index - 2u * POINTS_EACH]; }
    return projected_3[index - 3u * POINTS_EACH];
}
