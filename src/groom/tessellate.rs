//! Curves as polylines.
//!
//! Between points p₁ and p₂ a uniform Catmull-Rom spline is the cubic Hermite with the tangents ½(p₂ - p₀) and
//! ½(p₃ - p₁) (Catmull and Rom, *A class of local interpolating splines*, 1974). It passes through every point and its
//! tangent is continuous. A strand's missing outer neighbours are reflections: p₋₁ = 2p₀ - p₁.

use super::strands::MAX_POINTS;
use super::{Curve, Strands};
use crate::error::{Result, invalid};
use glam::Vec3;

/// Cuts every segment of every strand into `pieces_per_segment` straight pieces, evenly in the curve's parameter.
///
/// The outcome is a polyline through the same points; radius and coordinate run linearly between them, so that neither
/// overshoots. A polyline cut into one piece a segment is itself.
///
/// # Errors
/// [`InvalidValue`](crate::Error::InvalidValue): `pieces_per_segment` of 0; more points than a groom can have.
pub fn tessellate(strands: &Strands, pieces_per_segment: u32) -> Result<Strands> {
    if pieces_per_segment == 0 {
        return invalid!("pieces_per_segment 0: a segment has at least one piece");
    }
    let pieces = pieces_per_segment as usize;
    let total = strands
        .segment_count()
        .saturating_mul(pieces)
        .saturating_add(strands.strand_count());
    if total > MAX_POINTS {
        return invalid!(
            "pieces_per_segment {pieces} makes {total} points: a groom has at most {MAX_POINTS}"
        );
    }
    let mut points = Vec::with_capacity(total);
    let mut radii = Vec::with_capacity(total);
    let mut coordinates = Vec::with_capacity(total);
    let mut counts = Vec::with_capacity(strands.strand_count());
    for strand in 0..strands.strand_count() {
        let range = strands.range(strand);
        let own = &strands.points()[range.clone()];
        cut(own, pieces, |segment, t| {
            points.push(position(own, strands.curve(), segment, t).to_array())
        });
        let (r, u) = (
            &strands.radii()[range.clone()],
            &strands.coordinates()[range],
        );
        cut(own, pieces, |segment, t| radii.push(linear(r, segment, t)));
        cut(own, pieces, |segment, t| {
            coordinates.push(linear(u, segment, t))
        });
        counts.push(((own.len() - 1) * pieces + 1) as u32);
    }
    Strands::new(points, &counts, 0.0)?
        .with_point_radii(radii)?
        .with_coordinates(coordinates)?
        .with_colours(strands.colours().to_vec())
}

/// Visits (segment, t) of every point of the cut strand, root first; points of the old strand have t = 0.
fn cut(own: &[[f32; 3]], pieces: usize, mut visit: impl FnMut(usize, f32)) {
    for segment in 0..own.len() - 1 {
        for piece in 0..pieces {
            visit(segment, piece as f32 / pieces as f32);
        }
    }
    visit(own.len() - 1, 0.0);
}

fn linear(values: &[f32], segment: usize, t: f32) -> f32 {
    let first = values[segment];
    match values.get(segment + 1) {
        // Rounding must not step over the next value, or a coordinate could fall.
        Some(&second) if t > 0.0 => {
            (first + (second - first) * t).clamp(first.min(second), first.max(second))
        }
        _ => first,
    }
}

fn position(own: &[[f32; 3]], curve: Curve, segment: usize, t: f32) -> Vec3 {
    let p1 = Vec3::from(own[segment]);
    if t == 0.0 {
        return p1;
    }
    let p2 = Vec3::from(own[segment + 1]);
    if curve == Curve::Polyline {
        return p1.lerp(p2, t);
    }
    let p0 = if segment > 0 {
        Vec3::from(own[segment - 1])
    } else {
        2.0 * p1 - p2
    };
    let p3 = own
        .get(segment + 2)
        .map_or(2.0 * p2 - p1, |p| Vec3::from(*p));
    let (m1, m2) = (0.5 * (p2 - p0), 0.5 * (p3 - p1));
    let (t2, t3) = (t * t, t * t * t);
    // Cubic Hermite basis.
    p1 * (2.0 * t3 - 3.0 * t2 + 1.0)
        + m1 * (t3 - 2.0 * t2 + t)
        + p2 * (3.0 * t2 - 2.0 * t3)
        + m2 * (t3 - t2)
}
