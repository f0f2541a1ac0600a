//! The area of a pixel's unit square that a fibre covers.
//!
//! Exactly: the square is clipped by half-planes (Sutherland and Hodgman, *Reentrant Polygon Clipping*, 1974), and the
//! rest is a convex polygon, whose area is ½ Σ (v_i - v_0) × (v_{i+1} - v_0). By supersampling: the union of a whole
//! strand's quads and joints, by asking of many points whether they lie inside; this knows nothing of how segments
//! share pixels among themselves, hence cannot repeat a mistake made there.

use crate::random;
use glam::DVec2;

/// Half-planes that may cut one square; each adds at most one corner.
const MOST_CUTS: usize = 12;

/// The side of a line towards which `normal` points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfPlane {
    /// A point on the line.
    pub point: DVec2,
    /// Towards the inside; of any length but 0.
    pub normal: DVec2,
}

/// All points within `half_width` of an unbounded line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// A point on the line.
    pub point: DVec2,
    /// Along the line, of length 1.
    pub direction: DVec2,
    /// In pixels, not negative.
    pub half_width: f64,
}

/// A strand on the screen.
#[derive(Debug, Clone, Copy)]
pub struct Ribbon<'a> {
    /// Its points in pixels.
    pub points: &'a [DVec2],
    /// Half of its width at each point, in pixels.
    pub half_widths: &'a [f64],
}

/// A convex polygon with few corners.
struct Polygon {
    corners: [DVec2; 4 + MOST_CUTS],
    len: usize,
}

impl Polygon {
    fn unit_square() -> Self {
        let mut corners = [DVec2::ZERO; 4 + MOST_CUTS];
        corners[..4].copy_from_slice(&[
            DVec2::new(-0.5, -0.5),
            DVec2::new(0.5, -0.5),
            DVec2::new(0.5, 0.5),
            DVec2::new(-0.5, 0.5),
        ]);
        Self { corners, len: 4 }
    }

    /// What remains where `normal · v + distance >= 0`.
    fn clipped(&self, normal: DVec2, distance: f64) -> Self {
        let mut rest = Self {
            corners: [DVec2::ZERO; 4 + MOST_CUTS],
            len: 0,
        };
        for i in 0..self.len {
            let [a, b] = [self.corners[i], self.corners[(i + 1) % self.len]];
            let [side_a, side_b] = [normal.dot(a) + distance, normal.dot(b) + distance];
            if side_a >= 0.0 {
                rest.push(a);
            }
            if (side_a >= 0.0) != (side_b >= 0.0) {
                rest.push(a + (b - a) * (side_a / (side_a - side_b)));
            }
        }
        rest
    }

    fn push(&mut self, corner: DVec2) {
        // A cut adds one corner; more can only be rounding's doing, and would be duplicates.
        if self.len < self.corners.len() {
            self.corners[self.len] = corner;
            self.len += 1;
        }
    }

    fn area(&self) -> f64 {
        let first = self.corners[0];
        let triangle = |edge: &[DVec2]| (edge[0] - first).perp_dot(edge[1] - first);
        0.5 * self.corners[..self.len]
            .windows(2)
            .map(triangle)
            .sum::<f64>()
            .abs()
    }
}

/// The area, from 0 to 1, of the pixel around `centre` that lies in the band and on the inner side of every cut.
///
/// # Panics
/// With more than ten cuts.
pub fn band_coverage(centre: DVec2, band: &Band, cuts: &[HalfPlane]) -> f64 {
    assert!(
        cuts.len() + 2 <= MOST_CUTS,
        "{} cuts are more than {}",
        cuts.len(),
        MOST_CUTS - 2
    );
    let across = band.direction.perp();
    // Distance of the centre from the axis; all else is relative to the centre, so that large coordinates cost nothing.
    let offset = across.dot(centre - band.point);

    let mut polygon = Polygon::unit_square();
    polygon = polygon.clipped(across, offset + band.half_width);
    polygon = polygon.clipped(-across, band.half_width - offset);
    for cut in cuts {
        let normal = cut.normal.normalize();
        polygon = polygon.clipped(normal, normal.dot(centre - cut.point));
    }
    polygon.area().min(1.0)
}

/// Whether a ribbon covers a point: the point lies beside a segment, no farther than the width there (interpolated
/// linearly), or in the wedge that a bend opens between two segments, no farther from the joint than the width there.
/// The two ends are cut straight.
fn covers(segments: &[RibbonSegment], point: DVec2) -> bool {
    let beside = segments.iter().any(|segment| {
        let t = segment.parameter(point);
        let half_width =
            segment.half_widths[0] + (segment.half_widths[1] - segment.half_widths[0]) * t;
        (0.0..=1.0).contains(&t) && segment.distance(point) <= half_width
    });
    beside
        || segments.windows(2).any(|pair| {
            let in_wedge = pair[0].parameter(point) > 1.0 && pair[1].parameter(point) < 0.0;
            in_wedge && point.distance(pair[1].start) <= pair[1].half_widths[0]
        })
}

struct RibbonSegment {
    start: DVec2,
    along: DVec2,
    half_widths: [f64; 2],
}

impl RibbonSegment {
    fn parameter(&self, point: DVec2) -> f64 {
        (point - self.start).dot(self.along) / self.along.length_squared()
    }

    fn distance(&self, point: DVec2) -> f64 {
        (point - self.start).perp_dot(self.along).abs() / self.along.length()
    }
}

/// The area, from 0 to 1, of the pixel around `centre` that the union of a ribbon's segments and joints covers, by
/// `samples_per_side`² samples, one anywhere in each cell of a grid. Only cells on the ribbon's edges are in doubt: the
/// standard error is at most ½ · √(cells on edges) / samples_per_side².
pub fn supersampled_coverage(ribbon: &Ribbon, centre: DVec2, samples_per_side: usize) -> f64 {
    let widest = ribbon.half_widths.iter().copied().fold(0.0, f64::max);
    let reach = widest + std::f64::consts::FRAC_1_SQRT_2;
    let segments: Vec<RibbonSegment> = distinct_segments(ribbon);
    // A whole pixel is asked about only where the ribbon is near; wedges need both neighbours, so a range is kept.
    let near = |s: &RibbonSegment| {
        let t = s.parameter(centre).clamp(0.0, 1.0);
        centre.distance(s.start + s.along * t) <= reach
    };
    let (Some(first), Some(last)) = (
        segments.iter().position(near),
        segments.iter().rposition(near),
    ) else {
        return 0.0;
    };
    let segments = &segments[first.saturating_sub(1)..(last + 2).min(segments.len())];

    let seed = random::hash(centre.x.to_bits()) ^ centre.y.to_bits();
    let cell = 1.0 / samples_per_side as f64;
    let inside = (0..samples_per_side * samples_per_side)
        .filter(|&i| {
            let jitter = DVec2::new(
                random::unit(seed, 2 * i as u64),
                random::unit(seed, 2 * i as u64 + 1),
            );
            let corner = DVec2::new((i % samples_per_side) as f64, (i / samples_per_side) as f64);
            covers(segments, centre - 0.5 + (corner + jitter) * cell)
        })
        .count();
    inside as f64 * cell * cell
}

/// The segments of a ribbon that have a length.
fn distinct_segments(ribbon: &Ribbon) -> Vec<RibbonSegment> {
    (1..ribbon.points.len())
        .map(|i| RibbonSegment {
            start: ribbon.points[i - 1],
            along: ribbon.points[i] - ribbon.points[i - 1],
            half_widths: [ribbon.half_widths[i - 1], ribbon.half_widths[i]],
        })
        .filter(|segment| segment.along.length_squared() > 0.0)
        .collect()
}
