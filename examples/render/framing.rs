//! From where a scene is seen and by what it is lit, where its file leaves that open.

use pelage::glam::{DVec3, Vec3};
use pelage::shadow::Shadow;
use pelage::{Light, LightKind, View};

use super::scene::{Camera, Result, Scene};

/// Room around the groom, as a factor of its size on the screen.
const MARGIN: f64 = 1.06;
/// The near plane lies no nearer than this part of the far one, so that depth keeps its precision.
const LEAST_NEAR_OVER_FAR: f64 = 1e-3;
/// The default key light: irradiance on a plane that faces it.
const KEY_IRRADIANCE: f32 = std::f32::consts::PI;

/// An axis-aligned box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The lowest corner.
    pub low: DVec3,
    /// The highest corner.
    pub high: DVec3,
}

impl Bounds {
    /// The box around positions; `None` of none.
    pub fn around<'a>(positions: impl IntoIterator<Item = &'a [f32; 3]>) -> Option<Self> {
        positions
            .into_iter()
            .map(|p| Vec3::from(*p).as_dvec3())
            .fold(None, |bounds, p| match bounds {
                None => Some(Self { low: p, high: p }),
                Some(Self { low, high }) => Some(Self {
                    low: low.min(p),
                    high: high.max(p),
                }),
            })
    }

    /// The box around both.
    pub fn union(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// The middle.
    pub fn centre(&self) -> DVec3 {
        0.5 * (self.low + self.high)
    }

    /// The eight corners.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |axis: usize| {
                if i >> axis & 1 == 0 {
                    self.low[axis]
                } else {
                    self.high[axis]
                }
            };
            DVec3::new(pick(0), pick(1), pick(2))
        })
    }
}

/// A camera with nothing left open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Framing {
    /// Position of the eye.
    pub eye: DVec3,
    /// What is looked at.
    pub target: DVec3,
    /// Which way is up.
    pub up: DVec3,
    /// Full vertical field of view in degrees.
    pub vfov_deg: f64,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The view that follows.
    pub view: View,
}

/// Completes a camera. `groom` is what a camera without eye frames from its `front`; `all` is what has to lie within
/// the depth range.
pub fn frame(camera: &Camera, groom: Bounds, front: DVec3, all: Bounds) -> Result<Framing> {
    let Camera {
        vfov_deg,
        width,
        height,
        ..
    } = *camera;
    let half_fov = 0.5 * vfov_deg.to_radians();
    if !(half_fov > 0.0 && half_fov < std::f64::consts::FRAC_PI_2) {
        return Err(format!(
            "camera.vfov_deg {vfov_deg} is not between 0 and 180"
        ));
    }
    for (key, size) in [("width", width), ("height", height)] {
        if size == 0 {
            return Err(format!("camera.{key} is 0"));
        }
    }
    let aspect = f64::from(width) / f64::from(height);
    let target = camera.target.map_or(groom.centre(), DVec3::from);
    let up = DVec3::from(camera.up);
    let eye = camera.eye.map_or_else(
        || target + front * distance(&groom, target, front, half_fov, aspect),
        DVec3::from,
    );

    let forward = (target - eye).normalize_or(DVec3::NEG_Z);
    let depths = all.corners().map(|corner| (corner - eye).dot(forward));
    let farthest = depths.into_iter().fold(0.0, f64::max);
    let nearest = depths.into_iter().fold(f64::INFINITY, f64::min);
    let far = if farthest > 0.0 { 1.01 * farthest } else { 1.0 };
    let near = (0.98 * nearest)
        .max(LEAST_NEAR_OVER_FAR * far)
        .min(0.99 * far);
    let view = View::perspective(eye, target, up, vfov_deg.to_radians(), aspect, [near, far])
        .map_err(|error| format!("camera: {error}"))?;
    Ok(Framing {
        eye,
        target,
        up,
        vfov_deg,
        width,
        height,
        view,
    })
}

/// How far in front of `target` an eye sees the whole of a box. `front` is +z or -z.
fn distance(bounds: &Bounds, target: DVec3, front: DVec3, half_fov: f64, aspect: f64) -> f64 {
    let slope = half_fov.tan();
    let fits = |corner: DVec3| {
        let offset = (corner - target).abs() * MARGIN;
        (corner - target).dot(front) + (offset.y / slope).max(offset.x / (slope * aspect))
    };
    let distance = bounds.corners().into_iter().map(fits).fold(0.0, f64::max);
    if distance > 0.0 { distance } else { 1.0 }
}

/// The frame's lights, each with the scene's shadow technique, and its ambient radiance.
pub fn lights(scene: &Scene, framing: &Framing) -> (Vec<Light>, Vec3) {
    let shadow = Some(scene.shadow);
    let mut ambient = Vec3::from(scene.ambient);
    let Some(keys) = &scene.lights else {
        return (vec![key_light(framing, shadow)], ambient);
    };
    let mut lights = Vec::new();
    for key in keys {
        ambient += key.ambient.map_or(Vec3::ZERO, Vec3::from);
        if let (Some(position), Some(intensity)) = (key.position, key.intensity) {
            let (position, intensity) = (position.into(), intensity.into());
            let kind = match (key.cone_deg, key.direction) {
                (Some([inner, outer]), Some(direction)) => LightKind::Spot {
                    position,
                    direction: direction.into(),
                    intensity,
                    inner_angle: inner.to_radians(),
                    outer_angle: outer.to_radians(),
                },
                _ => LightKind::Point {
                    position,
                    intensity,
                },
            };
            lights.push(Light { kind, shadow });
        } else if key.direction.is_some() || key.irradiance.is_some() || key.ambient.is_none() {
            let mut light = key_light(framing, shadow);
            if let LightKind::Directional {
                direction,
                irradiance,
            } = &mut light.kind
            {
                *direction = key.direction.map_or(*direction, DVec3::from);
                *irradiance = key.irradiance.map_or(*irradiance, Vec3::from);
            }
            lights.push(light);
        }
    }
    (lights, ambient)
}

/// One light from the upper left, in front.
fn key_light(framing: &Framing, shadow: Option<Shadow>) -> Light {
    let back = (framing.eye - framing.target).normalize_or(DVec3::Z);
    let right = framing.up.cross(back).normalize_or(DVec3::X);
    let above = back.cross(right);
    let direction = 0.55 * right - 0.7 * above - 0.75 * back;
    Light {
        kind: LightKind::Directional {
            direction,
            irradiance: Vec3::splat(KEY_IRRADIANCE),
        },
        shadow,
    }
}
