//! How much light reaches a point on a fibre through the other fibres.
//!
//! Along one ray, `Π (1 - alpha)` over its crossings. A ray crosses a fibre where its distance from the fibre's axis is
//! no more than the radius there; segments that follow one another and are hit by the same ray are one crossing. Over a
//! footprint, the mean over rays that start anywhere in a disc around the point, at right angles to the light.
//!
//! A lone straight hair does not shadow itself, whatever its footprint: the part of the strand that holds the point is
//! left out, up to where it first leaves the disc's path towards the light. What comes back into it counts.
//!
//! Beside it, what an opacity map can know at best: the optical depth `Ω = -Σ ln(1 - alpha·coverage)` of what lies
//! nearer to the light in the texel that holds the point, averaged over that texel.

use crate::bvh::{Aabb, Bvh, Ray};
use crate::fragments::FragmentLists;
use crate::random;
use crate::scene::{Camera, Strands};
use glam::DVec3;
use rayon::prelude::*;

/// A strand has left the path of its own light where it is farther from it than the footprint's radius and this many
/// of its own radii at the point.
pub const OWN_RADII: f64 = 4.0;

/// The square of the sine below which a segment is taken to run along a ray.
const END_ON: f64 = 1e-24;

/// Where light comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Light {
    /// From infinitely far away.
    Directional {
        /// The direction towards the light, of any length but 0.
        towards: DVec3,
    },
    /// From a point.
    Point {
        /// Its position in world space.
        position: DVec3,
    },
}

impl Light {
    fn ray_from(&self, origin: DVec3) -> Ray {
        match *self {
            Self::Directional { towards } => Ray {
                origin,
                direction: towards.normalize(),
                length: f64::INFINITY,
            },
            Self::Point { position } => {
                let step = position - origin;
                let direction = step.try_normalize().unwrap_or(DVec3::Z);
                Ray {
                    origin,
                    direction,
                    length: step.length(),
                }
            }
        }
    }
}

/// What is asked about many points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Query {
    /// Where light comes from.
    pub light: Light,
    /// The fibres' own opacity, from 0 to 1.
    pub alpha: f64,
    /// The radius of the disc over which the transmittance is averaged, in world units; 0 for the point itself.
    pub footprint: f64,
    /// Rays per point, at least 1; with a footprint of 0 there is one.
    pub samples: usize,
}

/// A segment that has a length, as something that stops light.
#[derive(Clone, Copy)]
struct Cylinder {
    start: DVec3,
    along: DVec3,
    radii: [f64; 2],
    /// Where it lies among all segments that have a length, in the strands' order.
    rank: u32,
    strand: u32,
    /// Length of the strand up to the segment's start.
    arc: f64,
    /// The segment before it, from start to end, or `None` where the strand starts.
    before: Option<DVec3>,
    /// Whether the strand ends with it.
    is_last: bool,
}

/// A segment that a ray hits.
#[derive(Clone, Copy)]
struct Hit {
    rank: u32,
    strand: u32,
    /// Lengths of the strand up to the segment's start and end.
    arc: [f64; 2],
    radius: f64,
}

impl Hit {
    /// Whether `next`, a later hit in the strands' order, belongs to the same crossing: nothing lies between them, or
    /// no more of the strand than it is wide.
    fn goes_on_in(&self, next: &Self) -> bool {
        self.strand == next.strand && next.arc[0] - self.arc[1] <= 2.0 * self.radius
    }
}

impl Cylinder {
    fn radius(&self) -> f64 {
        self.radii[0].max(self.radii[1])
    }

    fn bounds(&self) -> Aabb {
        let end = self.start + self.along;
        Aabb {
            min: self.start.min(end) - self.radius(),
            max: self.start.max(end) + self.radius(),
        }
    }

    fn hit(&self) -> Hit {
        let arc = [self.arc, self.arc + self.along.length()];
        Hit {
            rank: self.rank,
            strand: self.strand,
            arc,
            radius: self.radius(),
        }
    }

    /// Whether a ray passes within the radius of the axis, between the segment's ends or in the wedge that a bend opens
    /// between the segment before and this one. A strand's ends are cut straight.
    fn is_hit(&self, ray: &Ray) -> bool {
        // Seen along the ray, the ray is a point and the axis a line.
        let to_start = self.start - ray.origin;
        let [depth, slope] = [to_start.dot(ray.direction), self.along.dot(ray.direction)];
        let start = to_start - ray.direction * depth;
        let along = self.along - ray.direction * slope;
        let seen = along.length_squared();

        if seen <= END_ON * self.along.length_squared() {
            let nearest = depth.min(depth + slope);
            let farthest = depth.max(depth + slope);
            return start.length() <= self.radius() && farthest > 0.0 && nearest < ray.length;
        }
        let unbounded = -start.dot(along) / seen;
        let in_wedge = || self.before.is_some_and(|before| -start.dot(before) > 0.0);
        if unbounded > 1.0 || (unbounded < 0.0 && !in_wedge()) {
            return false;
        }
        let t = unbounded.max(0.0);
        let radius = self.radii[0] + (self.radii[1] - self.radii[0]) * t;
        let at = depth + slope * t;
        at > 0.0 && at < ray.length && (start + along * t).length_squared() <= radius * radius
    }

    /// The least distance between the axis and a ray, its origin included.
    fn distance_from(&self, ray: &Ray) -> f64 {
        let to_point = |t: f64| {
            let point = self.start + self.along * t - ray.origin;
            let s = point.dot(ray.direction).clamp(0.0, ray.length);
            (point - ray.direction * s).length()
        };
        // The distance to a ray is convex along the axis: thirds close in on its least value.
        let [mut low, mut high] = [0.0_f64, 1.0_f64];
        for _ in 0..60 {
            let third = (high - low) / 3.0;
            if to_point(low + third) <= to_point(high - third) {
                high -= third
            } else {
                low += third
            }
        }
        to_point(0.5 * (low + high))
            .min(to_point(0.0))
            .min(to_point(1.0))
    }
}

/// Fibres that stand in the light's way.
pub struct Occluders {
    /// In the order of the hierarchy.
    cylinders: Vec<Cylinder>,
    bvh: Bvh,
    /// For each rank, the place in `cylinders`.
    by_rank: Vec<u32>,
    /// For each point of the strands, the rank of the segment that starts there, or of the nearest one with a length
    /// before it, else after it.
    of_point: Vec<Option<u32>>,
}

/// The segments that have a length, in the strands' order, and for each point its own.
fn cylinders_of(strands: &Strands) -> (Vec<Cylinder>, Vec<Option<u32>>) {
    let mut cylinders: Vec<Cylinder> = Vec::new();
    let mut of_point = vec![None; strands.points.len()];
    for strand in 0..strands.len() {
        let range = strands.range(strand);
        let first = cylinders.len();
        let mut arc = 0.0;
        for i in range.clone().take(range.len().saturating_sub(1)) {
            let along = strands.points[i + 1] - strands.points[i];
            if along != DVec3::ZERO {
                cylinders.push(Cylinder {
                    start: strands.points[i],
                    along,
                    radii: [strands.radii[i], strands.radii[i + 1]],
                    rank: cylinders.len() as u32,
                    strand: strand as u32,
                    arc,
                    before: cylinders[first..].last().map(|before| before.along),
                    is_last: false,
                });
                arc += along.length();
            }
            of_point[i] = (cylinders.len() > first).then(|| cylinders.len() as u32 - 1);
        }
        if cylinders.len() == first {
            continue;
        }
        cylinders.last_mut().expect("the strand has one").is_last = true;
        of_point[range.end - 1] = Some(cylinders.len() as u32 - 1);
        for own in &mut of_point[range] {
            own.get_or_insert(first as u32);
        }
    }
    (cylinders, of_point)
}

impl Occluders {
    /// Prepares all segments of the strands; those of no length stop nothing.
    pub fn new(strands: &Strands) -> Self {
        let (in_order, of_point) = cylinders_of(strands);
        let bounds: Vec<Aabb> = in_order.par_iter().map(Cylinder::bounds).collect();
        let bvh = Bvh::new(&bounds);
        let cylinders: Vec<Cylinder> = bvh
            .order()
            .iter()
            .map(|&rank| in_order[rank as usize])
            .collect();
        let mut by_rank = vec![0; cylinders.len()];
        for (place, &rank) in bvh.order().iter().enumerate() {
            by_rank[rank as usize] = place as u32;
        }
        Self {
            cylinders,
            bvh,
            by_rank,
            of_point,
        }
    }

    /// Ranks of the segments around `own_segment` that are not asked about, first and last: up to the first one on each
    /// side that is wholly outside of the footprint's path.
    fn own_path(&self, own_segment: usize, path: &Ray, footprint: f64) -> Option<[u32; 2]> {
        let own = self.of_point[own_segment]? as usize;
        let segment = |rank: usize| &self.cylinders[self.by_rank[rank] as usize];
        let reach = footprint + OWN_RADII * segment(own).radius();
        let within = |rank: usize| segment(rank).distance_from(path) <= reach;

        let [mut first, mut last] = [own; 2];
        while segment(first).before.is_some() && (first == own || within(first)) {
            first -= 1;
        }
        while !segment(last).is_last && (last == own || within(last)) {
            last += 1;
        }
        Some([first as u32, last as u32])
    }

    /// How many times a ray crosses a fibre, but for the segments whose ranks lie in `own`.
    fn crossings_of(&self, ray: &Ray, own: Option<[u32; 2]>, hits: &mut Vec<Hit>) -> usize {
        hits.clear();
        let asked = |rank: u32| own.is_none_or(|[first, last]| rank < first || rank > last);
        self.bvh.visit_ranges(ray, |range| {
            let hit = self.cylinders[range]
                .iter()
                .filter(|cylinder| asked(cylinder.rank) && cylinder.is_hit(ray));
            hits.extend(hit.map(Cylinder::hit));
        });
        hits.sort_unstable_by_key(|hit| hit.rank);
        hits.len()
            - hits
                .windows(2)
                .filter(|pair| pair[0].goes_on_in(&pair[1]))
                .count()
    }

    /// How many fibres lie between a point and the light. `own_segment` is the index, in the points of all strands, of
    /// the first point of the segment on which the point lies; `None` for a point in the air.
    pub fn crossings(&self, point: DVec3, own_segment: Option<usize>, light: &Light) -> usize {
        let ray = light.ray_from(point);
        let own = own_segment.and_then(|segment| self.own_path(segment, &ray, 0.0));
        self.crossings_of(&ray, own, &mut Vec::new())
    }

    /// The part of the light, from 0 to 1, that reaches the footprint around a point; `own_segment` as in
    /// [`Occluders::crossings`].
    pub fn transmittance(&self, point: DVec3, own_segment: Option<usize>, query: &Query) -> f64 {
        let path = query.light.ray_from(point);
        let own = own_segment.and_then(|segment| self.own_path(segment, &path, query.footprint));
        let rays = if query.footprint > 0.0 {
            query.samples.max(1)
        } else {
            1
        };
        let mut hits = Vec::new();
        let passed: f64 = (0..rays)
            .map(|i| {
                let ray = query
                    .light
                    .ray_from(point + disc_offset(&path, query.footprint, i, rays));
                let crossings = self.crossings_of(&ray, own, &mut hits);
                (1.0 - query.alpha).powi(crossings as i32)
            })
            .sum();
        passed / rays as f64
    }

    /// [`Occluders::transmittance`] of many points, on all cores.
    pub fn transmittances(&self, points: &[(DVec3, Option<usize>)], query: &Query) -> Vec<f64> {
        points
            .par_iter()
            .map(|&(point, own)| self.transmittance(point, own, query))
            .collect()
    }
}

/// Sample `i` of `n` in a disc at right angles to a path: a sunflower's spiral (Vogel 1979), which fills the disc
/// evenly, turned by a hash of the place.
fn disc_offset(path: &Ray, radius: f64, i: usize, n: usize) -> DVec3 {
    if radius == 0.0 {
        return DVec3::ZERO;
    }
    let golden_angle = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let place = path
        .origin
        .to_array()
        .iter()
        .fold(0, |seed, x| random::hash(seed ^ x.to_bits()));
    let angle = i as f64 * golden_angle + random::unit(place, 0) * std::f64::consts::TAU;
    let distance = radius * ((i as f64 + 0.5) / n as f64).sqrt();
    let (across, up) = path.direction.any_orthonormal_pair();
    (across * angle.cos() + up * angle.sin()) * distance
}

/// What a map knows of the light at a point: `exp(-Ω)`, where Ω is the optical depth, averaged over the texel that holds
/// the point, of all fragments nearer to the light. `lists` are those of the light's camera, usually orthographic, whose
/// pixels are the texels. 1 outside of the map. The exact product, not limited to Ω ≤ 16.
pub fn texel_transmittance(lists: &FragmentLists, light: &Camera, alpha: f64, point: DVec3) -> f64 {
    let clip = light.clip_from_world * point.extend(1.0);
    let pixel = light.pixel_from_clip(clip);
    let inside = |x: f64, size: usize| (0.0..size as f64).contains(&x);
    if clip.w <= 0.0 || !inside(pixel.x, lists.width) || !inside(pixel.y, lists.height) {
        return 1.0;
    }
    let depth = clip.z / clip.w;
    let nearer = lists
        .at(pixel.x as usize, pixel.y as usize)
        .iter()
        .take_while(|fragment| fragment.depth < depth);
    nearer
        .map(|fragment| 1.0 - alpha * fragment.coverage)
        .product()
}
