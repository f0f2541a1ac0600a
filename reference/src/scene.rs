//! What is looked at, and from where: plain data.
//!
//! Pixel (x, y) has its centre at (x + ½, y + ½), and row 0 is the upper one:
//! `pixel = ((ndc.x / 2 + ½) · width, (½ - ndc.y / 2) · height)`. Clip depth is 0 at the near plane and 1 at the far one.

use glam::{DMat4, DVec2, DVec3, DVec4};
use std::ops::Range;

/// Fibres as polylines with a radius at every point.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Strands {
    /// The points of all strands, one strand after the other, in world space.
    pub points: Vec<DVec3>,
    /// Strand `s` is `points[offsets[s]..offsets[s + 1]]`: one more entry than strands, the first 0, none descending.
    pub offsets: Vec<usize>,
    /// A radius per point, in world units, none negative.
    pub radii: Vec<f64>,
}

impl Strands {
    /// Collects strands that are each given as a list of (point, radius).
    pub fn from_polylines<S: AsRef<[(DVec3, f64)]>>(strands: impl IntoIterator<Item = S>) -> Self {
        let mut collected = Self {
            offsets: vec![0],
            ..Self::default()
        };
        for strand in strands {
            collected
                .points
                .extend(strand.as_ref().iter().map(|&(point, _)| point));
            collected
                .radii
                .extend(strand.as_ref().iter().map(|&(_, radius)| radius));
            collected.offsets.push(collected.points.len());
        }
        collected
    }

    /// The number of strands, those with fewer than two points included.
    pub fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Whether there is no strand at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Where strand `strand` lies in `points` and `radii`.
    pub fn range(&self, strand: usize) -> Range<usize> {
        self.offsets[strand]..self.offsets[strand + 1]
    }
}

/// The view_from_world matrix of an eye that looks at `target`: right-handed, x to the right, y up, z backwards.
/// `up` has any length but 0 and is not parallel to the view.
pub fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> DMat4 {
    let back = (eye - target).normalize();
    let right = up.cross(back).normalize();
    let world_from_view = DMat4::from_cols(
        right.extend(0.0),
        back.cross(right).extend(0.0),
        back.extend(0.0),
        eye.extend(1.0),
    );
    world_from_view.inverse()
}

/// A view of the world: of an eye, or of a light that looks at what it lights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Takes world positions to clip space: depth 0 at the near plane, 1 at the far one.
    pub clip_from_world: DMat4,
    /// The eye's position and w = 1, or, for an orthographic view, the direction towards the eye and w = 0.
    pub eye: DVec4,
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl Camera {
    /// A right-handed perspective view. `fov_y` is the full vertical angle in radians; `size` is width and height.
    pub fn perspective(
        view_from_world: DMat4,
        fov_y: f64,
        near_far: [f64; 2],
        size: [usize; 2],
    ) -> Self {
        let aspect = size[0] as f64 / size[1] as f64;
        let [near, far] = near_far;
        let focal = 1.0 / (fov_y * 0.5).tan();
        let depth = far / (near - far);
        let clip_from_view = DMat4::from_cols(
            DVec4::new(focal / aspect, 0.0, 0.0, 0.0),
            DVec4::new(0.0, focal, 0.0, 0.0),
            DVec4::new(0.0, 0.0, depth, -1.0),
            DVec4::new(0.0, 0.0, near * depth, 0.0),
        );
        let eye = view_from_world.inverse().w_axis.truncate().extend(1.0);
        Self {
            clip_from_world: clip_from_view * view_from_world,
            eye,
            width: size[0],
            height: size[1],
        }
    }

    /// A right-handed orthographic view of a box `half_height` high to either side of the axis.
    pub fn orthographic(
        view_from_world: DMat4,
        half_height: f64,
        near_far: [f64; 2],
        size: [usize; 2],
    ) -> Self {
        let half_width = half_height * size[0] as f64 / size[1] as f64;
        let [near, far] = near_far;
        let depth = 1.0 / (near - far);
        let clip_from_view = DMat4::from_cols(
            DVec4::new(1.0 / half_width, 0.0, 0.0, 0.0),
            DVec4::new(0.0, 1.0 / half_height, 0.0, 0.0),
            DVec4::new(0.0, 0.0, depth, 0.0),
            DVec4::new(0.0, 0.0, near * depth, 1.0),
        );
        let backwards = view_from_world.inverse().z_axis.truncate().normalize();
        Self {
            clip_from_world: clip_from_view * view_from_world,
            eye: backwards.extend(0.0),
            width: size[0],
            height: size[1],
        }
    }

    /// A view whose world *is* the screen: x and y are pixel coordinates (y down) and z is the depth, from 0 to 1.
    /// Left-handed, hence for tests of what happens on the screen.
    pub fn of_pixels(width: usize, height: usize) -> Self {
        let clip_from_world = DMat4::from_cols(
            DVec4::new(2.0 / width as f64, 0.0, 0.0, 0.0),
            DVec4::new(0.0, -2.0 / height as f64, 0.0, 0.0),
            DVec4::new(0.0, 0.0, 1.0, 0.0),
            DVec4::new(-1.0, 1.0, 0.0, 1.0),
        );
        Self {
            clip_from_world,
            eye: DVec4::new(0.0, 0.0, -1.0, 0.0),
            width,
            height,
        }
    }

    /// The view of a band of rows alone: `rows` of them, of which the upper one is row `first` of this view.
    pub fn rows(&self, first: usize, rows: usize) -> Self {
        // pixel'.y = pixel.y - first, where pixel.y = (½ - ndc.y / 2) · height.
        let scale = self.height as f64 / rows as f64;
        let shift = 1.0 - (self.height as f64 - 2.0 * first as f64) / rows as f64;
        let band = DMat4::from_cols(
            DVec4::X,
            DVec4::new(0.0, scale, 0.0, 0.0),
            DVec4::Z,
            DVec4::new(0.0, shift, 0.0, 1.0),
        );
        Self {
            clip_from_world: band * self.clip_from_world,
            height: rows,
            ..*self
        }
    }

    /// Where a clip-space position with `w > 0` falls, in pixels.
    pub fn pixel_from_clip(&self, clip: DVec4) -> DVec2 {
        DVec2::new(
            (clip.x / clip.w * 0.5 + 0.5) * self.width as f64,
            (0.5 - clip.y / clip.w * 0.5) * self.height as f64,
        )
    }

    /// Half the extent of the screen in pixels, with the sign of each axis: pixels per unit of ndc.
    pub(crate) fn pixels_per_ndc(&self) -> DVec2 {
        DVec2::new(self.width as f64 * 0.5, self.height as f64 * -0.5)
    }
}
