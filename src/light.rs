//! Lights: where they are, how strong, how they are shadowed, and how their maps see the hair.

use glam::{DMat4, DVec3, DVec4, Vec3};

use crate::error::{Result, invalid};
use crate::shadow::Shadow;

/// Where a light is and how strong.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// A light so far away that its rays are parallel.
    Directional {
        /// The way the light travels, in world space; any length but zero.
        direction: DVec3,
        /// Irradiance on a plane that faces the light, linear RGB.
        irradiance: Vec3,
    },
    /// A light at a point that shines in all directions.
    Point {
        /// World space, host units.
        position: DVec3,
        /// Radiant intensity, linear RGB: irradiance × distance².
        intensity: Vec3,
    },
}

/// One light of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Where the light is and how strong.
    pub kind: LightKind,
    /// How hair shadows this light. `None`: as the frame's hairs wish.
    pub shadow: Option<Shadow>,
}

impl Light {
    /// A directional light, shadowed as the hairs wish.
    pub fn directional(direction: DVec3, irradiance: Vec3) -> Self {
        Self {
            kind: LightKind::Directional {
                direction,
                irradiance,
            },
            shadow: None,
        }
    }

    /// A point light, shadowed as the hairs wish.
    pub fn point(position: DVec3, intensity: Vec3) -> Self {
        Self {
            kind: LightKind::Point {
                position,
                intensity,
            },
            shadow: None,
        }
    }

    /// Checks that everything is finite, the direction has a length, and no power is negative.
    pub(crate) fn validate(&self, number: usize) -> Result<()> {
        let (place, what, power) = match self.kind {
            LightKind::Directional {
                direction,
                irradiance,
            } => (direction, "direction", irradiance),
            LightKind::Point {
                position,
                intensity,
            } => (position, "position", intensity),
        };
        if !place.is_finite() {
            return invalid!(
                "light {number}: {what} ({}, {}, {}) is not finite",
                place.x,
                place.y,
                place.z
            );
        }
        let length = place.length();
        if matches!(self.kind, LightKind::Directional { .. })
            && !(length > 0.0 && length.is_finite())
        {
            return invalid!(
                "light {number}: direction ({}, {}, {}) has no usable length",
                place.x,
                place.y,
                place.z
            );
        }
        if !power.is_finite() || power.min_element() < 0.0 {
            return invalid!(
                "light {number}: power ({}, {}, {}) has a component that is negative or not finite",
                power.x,
                power.y,
                power.z
            );
        }
        match &self.shadow {
            Some(shadow) => shadow.validate(),
            None => Ok(()),
        }
    }
}

/// A light's view of the hair.
pub(crate) struct LightCamera {
    pub clip_from_relative: DMat4,
    /// Distance along the axis, 0 at the nearest hair.
    pub depth_row: DVec4,
    pub eye: DVec4,
}

pub(crate) struct LightCameras {
    pub views: Vec<LightCamera>,
    /// Depth range of the hair.
    pub extent: f64,
    /// Width of a map at the hair's middle, and at the nearest hair.
    pub width: f64,
    pub nearest_width: f64,
}

/// Fits a light's maps to the corners of all hairs' boxes.
pub(crate) fn light_cameras(place: DVec4, corners: &[DVec3], radius: f64) -> LightCameras {
    let centre = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let size = corners
        .iter()
        .map(|p| p.distance(centre))
        .fold(0.0, f64::max)
        + radius;
    let size = size.max(centre.length() * 1e-9).max(1e-12);
    if place.w == 0.0 {
        return directional_camera(-place.truncate(), corners, radius.max(size * 1e-6));
    }
    let light = place.truncate();
    let distance = light.distance(centre);
    if distance > 1.2 * size {
        let half_angle = (size / distance).asin();
        let near = distance - size;
        let camera = point_camera(light, centre - light, half_angle, near, 0.5 * near);
        let width = |distance: f64| 2.0 * distance * half_angle.tan();
        return LightCameras {
            views: vec![camera],
            extent: 2.0 * size,
            width: width(distance),
            nearest_width: width(near),
        };
    }
    // The light is among the hair: a cube.
    let axes = [
        DVec3::X,
        DVec3::NEG_X,
        DVec3::Y,
        DVec3::NEG_Y,
        DVec3::Z,
        DVec3::NEG_Z,
    ];
    // Hair closer to the light than this casts no shadow.
    let plane = 0.01 * size;
    let views = axes
        .map(|axis| point_camera(light, axis, std::f64::consts::FRAC_PI_4, 0.0, plane))
        .into();
    LightCameras {
        views,
        extent: distance + size,
        width: distance + size,
        nearest_width: 2.0 * plane,
    }
}

/// Two unit vectors that complete a direction.
fn basis(direction: DVec3) -> (DVec3, DVec3) {
    let right = direction.any_orthonormal_vector();
    (right, right.cross(direction))
}

/// An orthographic camera that holds all corners, `margin` wider on each side.
fn directional_camera(axis: DVec3, corners: &[DVec3], margin: f64) -> LightCameras {
    let (right, up) = basis(axis);
    let range = |direction: DVec3| {
        let along = corners.iter().map(|p| p.dot(direction));
        let low = along.clone().fold(f64::INFINITY, f64::min) - margin;
        (low, along.fold(f64::NEG_INFINITY, f64::max) + margin)
    };
    let ((x0, x1), (y0, y1), (z0, z1)) = (range(right), range(up), range(axis));
    let row = |direction: DVec3, low: f64, high: f64| {
        let scale = 2.0 / (high - low);
        (direction * scale).extend(-0.5 * (low + high) * scale)
    };
    let depth_row = axis.extend(-z0);
    // Clip depth runs from ¼ to ¾, well inside both planes.
    let z_row = depth_row * (0.5 / (z1 - z0)) + DVec4::W * 0.25;
    let rows = DMat4::from_cols(row(right, x0, x1), row(up, y0, y1), z_row, DVec4::W);
    let camera = LightCamera {
        clip_from_relative: rows.transpose(),
        depth_row,
        eye: (-axis).extend(0.0),
    };
    let width = (x1 - x0).max(y1 - y0);
    LightCameras {
        views: vec![camera],
        extent: z1 - z0,
        width,
        nearest_width: (x1 - x0).min(y1 - y0),
    }
}

/// A perspective camera at a light; depth is the distance along the axis beyond `near`.
fn point_camera(
    light: DVec3,
    direction: DVec3,
    half_angle: f64,
    near: f64,
    plane: f64,
) -> LightCamera {
    let axis = direction.normalize();
    let (right, up) = basis(axis);
    let row = |direction: DVec3| direction.extend(-direction.dot(light));
    let focal = 1.0 / half_angle.tan();
    let along = row(axis);
    // Clip depth 1 - plane / distance: no far plane.
    let rows = DMat4::from_cols(
        row(right) * focal,
        row(up) * focal,
        along - DVec4::W * plane,
        along,
    );
    LightCamera {
        clip_from_relative: rows.transpose(),
        depth_row: along - DVec4::W * near,
        eye: light.extend(1.0),
    }
}
