// The part of a pixel's footprint (a unit square) that a fibre covers, exactly.
//
// A fibre is a band {x : |n·x - d| < h} with unit normal n. The square's profile along n is a trapezoid whose integral
// is `half_plane`; the band is the difference of two of them. At a strand's own ends the band becomes a rectangle and
// the area follows from an integral over the square's rim. Widths from 0.01 px fade, and never break into dots.

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

// The same of the pixel's slice: the line through its centre across the fibre's major axis. A thin fibre leaves one fragment a
// slice, with all of what it covers there, and not parts of it in two or three pixels.
fn footprint_slice(normal: vec2f) -> Footprint {
    let a = max(abs(normal.x), abs(normal.y));
    return Footprint(0.5 * a, 0.5 * a, 1.0 / a, 0.0);
}

// Fibres whose half-width is more than this part of a pixel are never held against slices: sums of -ln(1 - coverage) grow faster than
// the coverage, the more, the more of it is in one pixel, and take what is behind a wide fibre for behind many.
const FOOTPRINT_SLICE_MOST: f32 = 0.25;

// Area of the square between its centre line and the line at distance `d`, signed like `d`: from -½ to ½.
fn coverage_half_plane(f: Footprint, d: f32) -> f32 {
    let reach = clamp(d, -f.support, f.support);
    let inner = clamp(reach, -f.inner, f.inner);
    let outer = reach - inner;
    return (inner + outer * (1.0 - abs(outer) * f.inverse_2b)) * f.inverse_a;
}

// Area of the square within the band whose axis is at distance `d` and whose half-width is `h`.
fn coverage_band(f: Footprint, d: f32, h: f32) -> f32 {
    return coverage_half_plane(f, d + h) - coverage_half_plane(f, d - h);
}

// ∫ clamp(n - low, 0, width) dt along the edge p…q, given as (n, t), over the part with t in start…end.
fn coverage_edge(p: vec2f, q: vec2f, low: f32, width: f32, start: f32, end: f32) -> f32 {
    let rise = q.y - p.y;
    if abs(rise) < 1e-7 { return 0.0; }
    let slope = (q.x - p.x) / rise;
    let t0 = clamp(p.y, start, end);
    let t1 = clamp(q.y, start, end);
    let n0 = p.x + (t0 - p.y) * slope - low;
    let n1 = p.x + (t1 - p.y) * slope - low;
    let c0 = clamp(n0, 0.0, width);
    let c1 = clamp(n1, 0.0, width);
    let run = n1 - n0;
    let sum = 0.5 * (c1 - c0) * (c1 + c0) + width * (max(n1, width) - max(n0, width));
    return (t1 - t0) * select(sum / run, 0.5 * (c0 + c1), abs(run) < 1e-6);
}

// Whether the rectangle |n + across| < half_width, start < t < end reaches into the square along the square's own axes.
fn coverage_touches(normal: vec2f, across: f32, half_width: f32, start: f32, end: f32) -> bool {
    let tangent = vec2f(-normal.y, normal.x);
    let centre = 0.5 * (start + end) * tangent - across * normal;
    return all(abs(centre) < 0.5 + half_width * abs(normal) + 0.5 * (end - start) * abs(tangent));
}

// The part of a slice's major extent that lies between the fibre's ends, which are at distances start and end along the tangent from
// the foot of the perpendicular from the pixel's centre; `across` is the centre's distance from the axis.
fn coverage_slice_ends(normal: vec2f, across: f32, start: f32, end: f32) -> f32 {
    let steep = abs(normal.x) > abs(normal.y);
    let major = select(-normal.y, normal.x, steep);
    // From the foot to the point of the axis in the slice's middle, along the major axis.
    let offset = across * select(normal.x, normal.y, steep) * sign(major);
    let bounds = clamp(vec2f(start, end) * abs(major) - offset, vec2f(-0.5), vec2f(0.5));
    return max(bounds.y - bounds.x, 0.0);
}

// Area of the square within the rectangle low < n < low + width, start < t < end in the frame (normal, tangent) around
// the square's centre. By the divergence theorem it is ∮ clamp(n - low, 0, width) dt over the part of the square's rim
// with t in start…end; only the square's four edges count, and coincident edges need no care.
fn coverage_rectangle(normal: vec2f, low: f32, width: f32, start: f32, end: f32) -> f32 {
    if end <= start { return 0.0; }
    // The square's corners, counter-clockwise, in the fibre's frame, whose tangent is (-n_y, n_x).
    let a = 0.5 * vec2f(-normal.x - normal.y, normal.y - normal.x);
    let b = 0.5 * vec2f(normal.x - normal.y, -normal.y - normal.x);
    let area = coverage_edge(a, b, low, width, start, end) + coverage_edge(b, -a, low, width, start, end)
        + coverage_edge(-a, -b, low, width, start, end) + coverage_edge(-b, a, low, width, start, end);
    return clamp(area, 0.0, 1.0);
}
