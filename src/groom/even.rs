//! Guides brought to one number of points, so that they can be blended point by point.

use super::{Curve, Strands};
use glam::Vec3;

/// The guides' points, all guides with `points_each`, one guide after the other.
pub(crate) struct EvenGuides {
    pub(crate) points_each: usize,
    pub(crate) curve: Curve,
    points: Vec<Vec3>,
    radii: Vec<f32>,
    colours: Vec<Vec3>,
}

impl EvenGuides {
    /// Resamples guides that have fewer points than the longest, evenly in their coordinate.
    pub(crate) fn new(guides: &Strands) -> Self {
        let points_each = longest(guides);
        let mut even = Self {
            points_each,
            curve: guides.curve(),
            points: Vec::new(),
            radii: Vec::new(),
            colours: guides
                .colours()
                .iter()
                .map(|colour| Vec3::from(*colour))
                .collect(),
        };
        for Tap { at, next, t } in taps(guides, points_each) {
            let [p, q] = [at, next].map(|k| Vec3::from(guides.points()[k]));
            even.points.push(p.lerp(q, t));
            let [r, s] = [at, next].map(|k| guides.radii()[k]);
            even.radii.push(r + (s - r) * t);
        }
        even
    }

    /// The weighted position of point `i` of three guides.
    pub(crate) fn position(&self, guides: [u32; 3], weights: [f32; 3], i: usize) -> Vec3 {
        (0..3)
            .map(|k| weights[k] * self.points[guides[k] as usize * self.points_each + i])
            .sum()
    }

    /// The weighted radius of point `i` of three guides.
    pub(crate) fn radius(&self, guides: [u32; 3], weights: [f32; 3], i: usize) -> f32 {
        (0..3)
            .map(|k| weights[k] * self.radii[guides[k] as usize * self.points_each + i])
            .sum()
    }

    /// The weighted colour of three guides.
    pub(crate) fn colour(&self, guides: [u32; 3], weights: [f32; 3]) -> [f32; 3] {
        let colour: Vec3 = (0..3)
            .map(|k| weights[k] * self.colours[guides[k] as usize])
            .sum();
        colour.max(Vec3::ZERO).to_array()
    }
}

/// Where an even guide's point comes from: between two points of the guides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tap {
    pub(crate) at: usize,
    pub(crate) next: usize,
    pub(crate) t: f32,
}

/// The points of the longest guide.
pub(crate) fn longest(guides: &Strands) -> usize {
    let lengths = (0..guides.strand_count()).map(|guide| guides.range(guide).len());
    lengths.max().unwrap_or(0)
}

/// Where the even guides' points come from, `points_each` for every guide.
pub(crate) fn taps(guides: &Strands, points_each: usize) -> Vec<Tap> {
    let last = points_each.saturating_sub(1).max(1) as f32;
    let tap = |guide: usize, i: usize| {
        let range = guides.range(guide);
        if range.len() == points_each {
            let at = range.start + i;
            return Tap {
                at,
                next: at,
                t: 0.0,
            };
        }
        let (at, next, t) = locate(guides, guide, i as f32 / last);
        Tap { at, next, t }
    };
    (0..guides.strand_count())
        .flat_map(|guide| (0..points_each).map(move |i| (guide, i)))
        .map(|(guide, i)| tap(guide, i))
        .collect()
}

/// The two points of a strand around coordinate `u`, and where between them.
fn locate(strands: &Strands, strand: usize, u: f32) -> (usize, usize, f32) {
    let range = strands.range(strand);
    let coordinates = &strands.coordinates()[range.clone()];
    let after = coordinates.partition_point(|c| *c <= u);
    if after == 0 {
        return (range.start, range.start, 0.0);
    }
    if after == coordinates.len() {
        return (range.end - 1, range.end - 1, 0.0);
    }
    let (low, high) = (coordinates[after - 1], coordinates[after]);
    (
        range.start + after - 1,
        range.start + after,
        (u - low) / (high - low),
    )
}
