// The part of a pixel's footprint (a unit square) that a fibre covers, exactly.
//
// A fibre is a band {x : |n·x - d| < h} with unit normal n. The square's profile along n is a trapezoid whose integral
// is `half_plane`; the band is the difference of two of them. At a strand's own ends the band becomes a rectangle and
// the area follows from Green's theorem over the clipped edges. Widths from 0.01 px fade, and never break into dots.

// The trapezoid of the unit square along a normal: plateau |d| < inner, support |d| < support.
struct Footprint {
    inner: f32,
    support: f32,
    inverse_a: f32,
    inverse_2b: f32,
}

fn footprint(normal: vec2f) -> Footprint {
    let a = max(abs(normal.x), abs(normal.y));
    let b = min(abs(normal.x), abs(normal.y));
    return Footprint(0.5 * (a - b), 0.5 * (a + b), 1.0 / a, 0.5 / max(b, 1e-6));
}

// Area of the square between its centre line and the line at distance `d`, signed like `d`: from -½ to ½.
fn coverage_half_plane(f: Footprint, d: f32) -> f32 {
    let reach = min(abs(d), f.support);
    let inner = min(reach, f.inner);
    let outer = reach - inner;
    return sign(d) * (inner + outer * (1.0 - outer * f.inverse_2b)) * f.inverse_a;
}

// Area of the square within the band whose axis is at distance `d` and whose half-width is `h`.
fn coverage_band(f: Footprint, d: f32, h: f32) -> f32 {
    return coverage_half_plane(f, d + h) - coverage_half_plane(f, d - h);
}

// ½ p × q of the part of the edge p…q that lies in the box low…high. Both figures run counter-clockwise; of two edges
// that coincide, one is `closed` and counts where both run the same way, and none counts where the figures only touch.
fn coverage_edge(p: vec2f, q: vec2f, low: vec2f, high: vec2f, closed: bool) -> f32 {
    let d = q - p;
    var enter = 0.0;
    var leave = 1.0;
    for (var axis = 0u; axis < 2u; axis++) {
        if abs(d[axis]) < 1e-7 {
            if p[axis] < low[axis] || p[axis] > high[axis] { return 0.0; }
            let turn = select(d.x, -d.y, axis == 0u);
            if p[axis] == low[axis] && !(closed && turn > 0.0) { return 0.0; }
            if p[axis] == high[axis] && !(closed && turn < 0.0) { return 0.0; }
        } else {
            let a = (low[axis] - p[axis]) / d[axis];
            let b = (high[axis] - p[axis]) / d[axis];
            enter = max(enter, min(a, b));
            leave = min(leave, max(a, b));
        }
    }
    if leave <= enter { return 0.0; }
    let from_point = p + enter * d;
    let to_point = p + leave * d;
    return 0.5 * (from_point.x * to_point.y - from_point.y * to_point.x);
}

// Area of the square within the rectangle that spans low…high in the frame (normal, tangent) around the square's
// centre. Green's theorem: the square's edges inside the rectangle and the rectangle's inside the square.
fn coverage_rectangle(normal: vec2f, low_bound: vec2f, high_bound: vec2f) -> f32 {
    // The square reaches to ½√2; bounding the rectangle keeps the clipping exact in f32.
    let low = clamp(low_bound, vec2f(-1.0), vec2f(1.0));
    let high = clamp(high_bound, vec2f(-1.0), vec2f(1.0));
    if any(high <= low) { return 0.0; }
    let tangent = vec2f(-normal.y, normal.x);
    // The square's corners, counter-clockwise, in the fibre's frame.
    let a = 0.5 * vec2f(-normal.x - normal.y, -tangent.x - tangent.y);
    let b = 0.5 * vec2f(normal.x - normal.y, tangent.x - tangent.y);
    var area = coverage_edge(a, b, low, high, true) + coverage_edge(b, -a, low, high, true)
        + coverage_edge(-a, -b, low, high, true) + coverage_edge(-b, a, low, high, true);
    // The rectangle's corners, counter-clockwise, in the square's frame.
    let r0 = low.x * normal + low.y * tangent;
    let r1 = high.x * normal + low.y * tangent;
    let r2 = high.x * normal + high.y * tangent;
    let r3 = low.x * normal + high.y * tangent;
    let corner = vec2f(0.5);
    area += coverage_edge(r0, r1, -corner, corner, false) + coverage_edge(r1, r2, -corner, corner, false)
        + coverage_edge(r2, r3, -corner, corner, false) + coverage_edge(r3, r0, -corner, corner, false);
    return clamp(area, 0.0, 1.0);
}
