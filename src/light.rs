//! Lights: where they are, how strong, how they are shadowed, and how their maps see the hair.

use glam::{DMat4, DVec2, DVec3, DVec4, Vec3};

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
    /// A light at a point that shines into a cone.
    Spot {
        /// World space, host units.
        position: DVec3,
        /// The cone's axis, the way the light travels, in world space; any length but zero.
        direction: DVec3,
        /// Radiant intensity within the inner cone, linear RGB: irradiance × distance².
        intensity: Vec3,
        /// Angle from the axis up to which the intensity is full, in radians, from 0 to `outer_angle`.
        inner_angle: f32,
        /// Angle from the axis from which on it is 0, in radians, above 0 and up to π/2. Between the two it falls as
        /// t² (3 - 2t), t linear in the angle's cosine.
        outer_angle: f32,
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

    /// A spot light, shadowed as the hairs wish; see [`LightKind::Spot`].
    pub fn spot(
        position: DVec3,
        direction: DVec3,
        intensity: Vec3,
        [inner_angle, outer_angle]: [f32; 2],
    ) -> Self {
        Self {
            kind: LightKind::Spot {
                position,
                direction,
                intensity,
                inner_angle,
                outer_angle,
            },
            shadow: None,
        }
    }

    /// Checks that everything is finite, the direction has a length, and no power is negative.
    pub(crate) fn validate(&self, number: usize) -> Result<()> {
        let finite = |what: &str, v: DVec3| {
            if v.is_finite() {
                return Ok(());
            }
            invalid!(
                "light {number}: {what} ({}, {}, {}) is not finite",
                v.x,
                v.y,
                v.z
            )
        };
        let directed = |v: DVec3| {
            finite("direction", v)?;
            let length = v.length();
            if length > 0.0 && length.is_finite() {
                return Ok(());
            }
            invalid!(
                "light {number}: direction ({}, {}, {}) has no usable length",
                v.x,
                v.y,
                v.z
            )
        };
        let power = match self.kind {
            LightKind::Directional {
                direction,
                irradiance,
            } => {
                directed(direction)?;
                irradiance
            }
            LightKind::Point {
                position,
                intensity,
            } => {
                finite("position", position)?;
                intensity
            }
            LightKind::Spot {
                position,
                direction,
                intensity,
                inner_angle,
                outer_angle,
            } => {
                finite("position", position)?;
                directed(direction)?;
                if !(outer_angle > 0.0 && outer_angle <= std::f32::consts::FRAC_PI_2) {
                    return invalid!(
                        "light {number}: outer_angle {outer_angle} is not above 0 and up to π/2"
                    );
                }
                if !(inner_angle >= 0.0 && inner_angle <= outer_angle) {
                    return invalid!(
                        "light {number}: inner_angle {inner_angle} is not between 0 and outer_angle {outer_angle}"
                    );
                }
                intensity
            }
        };
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

/// How a light shines, as the shaders have it, in world space with another origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Emitter {
    /// Position (w = 1) or direction towards the light (w = 0).
    pub place: DVec4,
    /// Irradiance or intensity.
    pub power: Vec3,
    /// Of a spot: its unit axis.
    pub axis: DVec3,
    /// Cosines of the outer and the inner angle.
    pub cosines: [f64; 2],
}

impl LightKind {
    /// The light as seen from an origin.
    pub(crate) fn emitter(&self, origin: DVec3) -> Emitter {
        // Every direction is well within the cone.
        let everywhere = |place, power| Emitter {
            place,
            power,
            axis: DVec3::ZERO,
            cosines: [-2.0, -1.0],
        };
        match *self {
            Self::Directional {
                direction,
                irradiance,
            } => everywhere((-direction.normalize()).extend(0.0), irradiance),
            Self::Point {
                position,
                intensity,
            } => everywhere((position - origin).extend(1.0), intensity),
            Self::Spot {
                position,
                direction,
                intensity,
                inner_angle,
                outer_angle,
            } => Emitter {
                place: (position - origin).extend(1.0),
                power: intensity,
                axis: direction.normalize(),
                cosines: [outer_angle, inner_angle].map(|angle| f64::from(angle).cos()),
            },
        }
    }
}

/// A light's view of the hair, in the space in which the light and the hair's corners are given: the plan's anchored space.
pub(crate) struct LightCamera {
    pub clip_from_anchored: DMat4,
    /// Distance along the axis, 0 at the nearest hair.
    pub depth_row: DVec4,
    pub eye: DVec4,
}

pub(crate) struct LightCameras {
    pub views: Vec<LightCamera>,
    /// Depth range of the hair.
    pub extent: f64,
    /// The longer side of a map at the hair's middle, and the shorter one at the nearest hair.
    pub width: f64,
    pub nearest_width: f64,
}

/// The tangent of the widest half-angle that one map sees; beyond it there are six.
const WIDEST: f64 = 1.75;
/// Hair that is closer to a light among the hair than this part of the hair's size casts no shadow.
const NEAREST: f64 = 0.01;

/// Fits a light's maps to the corners of all hairs' boxes.
pub(crate) fn light_cameras(emitter: &Emitter, corners: &[DVec3], radius: f64) -> LightCameras {
    let centre = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let size = corners
        .iter()
        .map(|p| p.distance(centre))
        .fold(0.0, f64::max)
        + radius;
    let size = size.max(centre.length() * 1e-9).max(1e-12);
    let margin = radius.max(size * 1e-6);
    if emitter.place.w == 0.0 {
        return directional_camera(-emitter.place.truncate(), corners, margin);
    }
    let light = emitter.place.truncate();
    let cone = (1.0 - emitter.cosines[0].powi(2)).max(0.0).sqrt() / emitter.cosines[0].max(1e-9);
    if emitter.axis != DVec3::ZERO && cone <= WIDEST {
        return spot_camera(light, emitter.axis, cone, corners, size, margin);
    }
    let towards = centre - light;
    if let Some(axis) = towards.try_normalize() {
        let seen = Seen::new(light, axis, corners);
        let near = seen.nearest - margin;
        if near > 0.1 * size
            && let rectangle = seen.rectangle(margin)
            && rectangle.reach() <= WIDEST
        {
            let plane = 0.5 * near;
            return perspective_camera(
                light,
                axis,
                &rectangle,
                [near, seen.farthest + margin],
                plane,
            );
        }
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
    let plane = NEAREST * size;
    let face = |axis| point_camera(light, axis, &Rectangle::square(1.0), 0.0, plane);
    let distance = towards.length();
    LightCameras {
        views: axes.map(face).into(),
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

/// A rectangle in a plane: a unit vector along its first side, and its range along that and the other.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Rectangle {
    along: DVec2,
    low: DVec2,
    high: DVec2,
}

impl Rectangle {
    fn square(half: f64) -> Self {
        Self {
            along: DVec2::X,
            low: DVec2::splat(-half),
            high: DVec2::splat(half),
        }
    }

    /// The one of least area around some points: a side of it lies on a side of their hull.
    fn around(points: &[DVec2]) -> Self {
        let hull = hull(points);
        let ranged = |along: DVec2| {
            let seen = |p: &DVec2| DVec2::new(p.dot(along), p.dot(along.perp()));
            let low = hull.iter().map(seen).fold(DVec2::INFINITY, DVec2::min);
            let high = hull.iter().map(seen).fold(DVec2::NEG_INFINITY, DVec2::max);
            Self { along, low, high }
        };
        let sides = hull.iter().zip(hull.iter().cycle().skip(1));
        let candidates = sides.filter_map(|(a, b)| (*b - *a).try_normalize());
        let area = |rectangle: &Self| {
            let sides = rectangle.high - rectangle.low;
            sides.x * sides.y
        };
        candidates
            .map(ranged)
            .min_by(|a, b| area(a).total_cmp(&area(b)))
            .unwrap_or_else(|| ranged(DVec2::X))
    }

    fn grown(self, margin: f64) -> Self {
        Self {
            low: self.low - margin,
            high: self.high + margin,
            ..self
        }
    }

    fn sides(&self) -> DVec2 {
        self.high - self.low
    }

    /// How far it lies from the origin along its sides at most.
    fn reach(&self) -> f64 {
        self.low.abs().max(self.high.abs()).max_element()
    }
}

/// The convex hull of some points, counter-clockwise (Andrew's monotone chain).
fn hull(points: &[DVec2]) -> Vec<DVec2> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let chain = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp_dot(point - b) <= 0.0
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut sorted.iter().copied());
    hull.append(&mut chain(&mut sorted.iter().rev().copied()));
    if hull.is_empty() { sorted } else { hull }
}

/// Corners as a place sees them along an axis: their depths, and where they lie, over their depth.
struct Seen {
    nearest: f64,
    farthest: f64,
    places: Vec<DVec2>,
}

impl Seen {
    fn new(from: DVec3, axis: DVec3, corners: &[DVec3]) -> Self {
        let (right, up) = basis(axis);
        let depth = |p: &DVec3| (*p - from).dot(axis);
        let place = |p: &DVec3| {
            let way = *p - from;
            DVec2::new(way.dot(right), way.dot(up)) / way.dot(axis)
        };
        Self {
            nearest: corners.iter().map(depth).fold(f64::INFINITY, f64::min),
            farthest: corners.iter().map(depth).fold(f64::NEG_INFINITY, f64::max),
            places: corners.iter().map(place).collect(),
        }
    }

    /// What holds them all, with spheres of a radius around them; all lie farther off than that.
    fn rectangle(&self, radius: f64) -> Rectangle {
        let widest = self.places.iter().map(|p| p.length()).fold(0.0, f64::max);
        Rectangle::around(&self.places).grown(radius * (1.0 + widest) / (self.nearest - radius))
    }
}

/// A spot's map: of its cone, or of what the hair fills of it.
fn spot_camera(
    light: DVec3,
    axis: DVec3,
    cone: f64,
    corners: &[DVec3],
    size: f64,
    margin: f64,
) -> LightCameras {
    let seen = Seen::new(light, axis, corners);
    let plane = NEAREST * size;
    let far = (seen.farthest + margin).max(2.0 * plane);
    // The rims of the map are not to be filtered with what lies beyond them.
    let whole = Rectangle::square(1.05 * cone);
    if seen.nearest - margin <= plane {
        return perspective_camera(light, axis, &whole, [plane, far], plane);
    }
    let near = seen.nearest - margin;
    let mut rectangle = seen.rectangle(margin);
    rectangle.low = rectangle.low.max(whole.low);
    rectangle.high = rectangle.high.min(whole.high);
    if rectangle.sides().min_element() <= 0.0 {
        // The cone misses the hair.
        rectangle = whole;
    }
    perspective_camera(light, axis, &rectangle, [near, far], 0.5 * near)
}

/// An orthographic camera that holds all corners, `margin` wider on each side.
fn directional_camera(axis: DVec3, corners: &[DVec3], margin: f64) -> LightCameras {
    let (right, up) = basis(axis);
    let places: Vec<DVec2> = corners
        .iter()
        .map(|p| DVec2::new(p.dot(right), p.dot(up)))
        .collect();
    let rectangle = Rectangle::around(&places).grown(margin);
    let depths = corners.iter().map(|p| p.dot(axis));
    let z0 = depths.clone().fold(f64::INFINITY, f64::min) - margin;
    let z1 = depths.fold(f64::NEG_INFINITY, f64::max) + margin;
    let depth_row = axis.extend(-z0);
    // Clip depth runs from ¼ to ¾, well inside both planes.
    let z_row = depth_row * (0.5 / (z1 - z0)) + DVec4::W * 0.25;
    let [x_row, y_row] = rows(&rectangle, right.extend(0.0), up.extend(0.0), DVec4::W);
    let camera = LightCamera {
        clip_from_anchored: DMat4::from_cols(x_row, y_row, z_row, DVec4::W).transpose(),
        depth_row,
        eye: (-axis).extend(0.0),
    };
    LightCameras {
        views: vec![camera],
        extent: z1 - z0,
        width: rectangle.sides().max_element(),
        nearest_width: rectangle.sides().min_element(),
    }
}

/// The rows of clip x and y that map a rectangle to -1…1, given the rows of the plane's axes and of w.
fn rows(rectangle: &Rectangle, right: DVec4, up: DVec4, w: DVec4) -> [DVec4; 2] {
    let Rectangle { along, low, high } = *rectangle;
    let across = along.perp();
    let sides = [(along, low.x, high.x), (across, low.y, high.y)];
    sides.map(|(side, low, high)| {
        let scale = 2.0 / (high - low);
        (right * side.x + up * side.y) * scale - w * (0.5 * (low + high) * scale)
    })
}

/// One perspective map of the depths from `near` to `far`.
fn perspective_camera(
    light: DVec3,
    axis: DVec3,
    rectangle: &Rectangle,
    [near, far]: [f64; 2],
    plane: f64,
) -> LightCameras {
    LightCameras {
        views: vec![point_camera(light, axis, rectangle, near, plane)],
        extent: far - near,
        width: rectangle.sides().max_element() * 0.5 * (near + far),
        nearest_width: rectangle.sides().min_element() * near,
    }
}

/// A perspective camera at a light, of a rectangle at the distance 1; depth is the distance along the axis beyond `near`.
fn point_camera(
    light: DVec3,
    axis: DVec3,
    rectangle: &Rectangle,
    near: f64,
    plane: f64,
) -> LightCamera {
    let (right, up) = basis(axis);
    let row = |direction: DVec3| direction.extend(-direction.dot(light));
    let along = row(axis);
    let [x_row, y_row] = rows(rectangle, row(right), row(up), along);
    // Clip depth 1 - plane / distance: no far plane.
    let rows = DMat4::from_cols(x_row, y_row, along - DVec4::W * plane, along);
    LightCamera {
        clip_from_anchored: rows.transpose(),
        depth_row: along - DVec4::W * near,
        eye: light.extend(1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Corners of a box, turned, off the origin.
    fn corners() -> Vec<DVec3> {
        let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 0.7, -0.3);
        (0..8)
            .map(|corner| {
                let sign = |bit: usize| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
                DVec3::new(3.0, -2.0, 1.0)
                    + turn * (DVec3::new(2.0, 0.5, 0.25) * DVec3::new(sign(0), sign(1), sign(2)))
            })
            .collect()
    }

    fn cameras(kind: LightKind, radius: f64) -> LightCameras {
        light_cameras(&kind.emitter(DVec3::ZERO), &corners(), radius)
    }

    /// The largest |x| or |y| in clip space that spheres around the corners reach.
    fn reach(camera: &LightCamera, radius: f64) -> f64 {
        let mut most = 0.0f64;
        for corner in corners() {
            for way in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE.normalize()] {
                for side in [-radius, radius] {
                    let clip = camera.clip_from_anchored * (corner + way * side).extend(1.0);
                    assert!(clip.w > 0.0 && clip.z > 0.0);
                    most = most.max((clip.truncate() / clip.w).truncate().abs().max_element());
                }
            }
        }
        most
    }

    #[test]
    fn a_map_holds_all_hair_and_no_more() {
        for kind in [
            LightKind::Directional {
                direction: DVec3::new(0.3, -0.8, 0.5),
                irradiance: Vec3::ONE,
            },
            LightKind::Point {
                position: DVec3::new(3.0, 4.0, -2.0),
                intensity: Vec3::ONE,
            },
            LightKind::Spot {
                position: DVec3::new(3.0, 4.0, -2.0),
                direction: DVec3::new(0.05, -6.0, 3.2),
                intensity: Vec3::ONE,
                inner_angle: 0.5,
                outer_angle: 0.8,
            },
        ] {
            let found = cameras(kind, 0.01);
            assert_eq!(found.views.len(), 1, "{kind:?}");
            let reach = reach(&found.views[0], 0.01);
            assert!(reach <= 1.0 && reach > 0.97, "{kind:?}: {reach}");
        }
    }

    #[test]
    fn a_directional_map_is_turned_with_the_hair() {
        let found = cameras(
            LightKind::Directional {
                direction: DVec3::new(0.3, -0.8, 0.5),
                irradiance: Vec3::ONE,
            },
            0.0,
        );
        // Along the axes of the world it would be at least as long as the box's diagonal is seen, a side.
        assert!(
            found.nearest_width < 0.5 * found.width,
            "{} of {}",
            found.nearest_width,
            found.width
        );
    }

    #[test]
    fn a_spot_among_the_hair_has_one_map_and_a_point_six() {
        let position = DVec3::new(3.0, -2.0, 1.0);
        let intensity = Vec3::ONE;
        let spot = |outer_angle| {
            let kind = LightKind::Spot {
                position,
                direction: DVec3::X,
                intensity,
                inner_angle: 0.1,
                outer_angle,
            };
            cameras(kind, 0.01).views.len()
        };
        assert_eq!((spot(0.5), spot(1.5)), (1, 6));
        let point = LightKind::Point {
            position,
            intensity,
        };
        assert_eq!(cameras(point, 0.01).views.len(), 6);
    }

    #[test]
    fn corners_in_one_line_or_one_place_make_finite_maps() {
        let directional = LightKind::Directional {
            direction: DVec3::NEG_Y,
            irradiance: Vec3::ONE,
        };
        for corners in [
            vec![DVec3::ONE; 8],
            (0..8).map(|i| DVec3::new(f64::from(i), 0.0, 0.0)).collect(),
            (0..8).map(|i| DVec3::new(0.0, f64::from(i), 0.0)).collect(),
        ] {
            let found = light_cameras(&directional.emitter(DVec3::ZERO), &corners, 0.0);
            let matrix = found.views[0].clip_from_anchored;
            assert!(matrix.is_finite() && found.width > 0.0 && found.nearest_width > 0.0);
        }
    }
}
