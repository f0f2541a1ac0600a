//! A head and three hairstyles made by rule, so that there is hair to draw without any file. Lengths are metres.

mod comb;
mod curly;
pub(crate) mod head;
mod straight;
mod surface_nets;
mod wavy;

use super::{MAX_INTERPOLATED_STRANDS, Mesh, Strands};
use crate::error::{Result, invalid};
use glam::Vec3;

/// Hairstyles of the built-in head.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum BuiltinGroom {
    /// Long and straight, parted, 17 points a strand.
    Straight,
    /// Long, with waves that each wisp shares, 33 points a strand, a Catmull-Rom spline.
    Wavy,
    /// Shoulder-length helical locks, 33 points a strand, a Catmull-Rom spline.
    Curly,
}

impl BuiltinGroom {
    /// Every style.
    pub const ALL: [Self; 3] = [Self::Straight, Self::Wavy, Self::Curly];

    /// The number of strands that the styles are made for.
    pub const DEFAULT_STRAND_COUNT: usize = 50_000;
}

/// Combs `strand_count` strands over the built-in head ([`head_mesh`]), in metres; the same on every call.
///
/// With [`BuiltinGroom::DEFAULT_STRAND_COUNT`] strands the root's radius is 45 µm; it is in inverse proportion to the
/// count, from 27 µm to 0.9 mm, so that hair covers the head alike, and falls to 35 % at the tip. Colours are grey
/// factors from 0.8 to 1. No strands are made of a count of 0.
///
/// # Errors
/// [`InvalidValue`](crate::Error::InvalidValue): a count above [`MAX_INTERPOLATED_STRANDS`], or with more points than a
/// groom can have.
pub fn builtin(groom: BuiltinGroom, strand_count: usize) -> Result<Strands> {
    let style = match groom {
        BuiltinGroom::Straight => &straight::STYLE,
        BuiltinGroom::Wavy => &wavy::STYLE,
        BuiltinGroom::Curly => &curly::STYLE,
    };
    let most = MAX_INTERPOLATED_STRANDS.min(super::MAX_POINTS / style.points);
    if strand_count > most {
        return invalid!(
            "strand_count {strand_count}: at most {most} strands of this style are made"
        );
    }
    comb::comb(style, strand_count)
}

/// The head that [`builtin`] combs: head, neck and shoulders, in metres, +y up, the face towards +z, the origin between
/// the ears; closed, about 20,000 triangles.
pub fn head_mesh() -> Mesh {
    // Finer where the face is.
    let grid = [
        surface_nets::planes([-0.208, 0.208], 0.0, 0.062, [0.0042, 0.0100]),
        surface_nets::planes([-0.272, 0.14], -0.035, 0.062, [0.0042, 0.0098]),
        surface_nets::planes([-0.145, 0.125], 0.09, 0.036, [0.0040, 0.0088]),
    ];
    surface_nets::polygonise(head::distance, &grid)
}

/// An estimate of the signed distance from `point` to the built-in head's skin, in metres; negative inside.
pub fn head_distance(point: [f32; 3]) -> f32 {
    head::distance(Vec3::from(point))
}
