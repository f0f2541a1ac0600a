//! Lights: where they are, how strong, and how they are shadowed.

use glam::{DVec3, Vec3};

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
