//! What shadow techniques yield that look a point up in a light's map: models of the techniques themselves, in f64, over
//! the exact fragments of each texel. How far that is from the light that truly arrives is for
//! [`transmittance`](crate::transmittance) to say.
//!
//! A texel is its slice: the line through its centre along the axis, x or y, that the fibre crosses more steeply. What the fibre
//! covers of the line counts as covered, times the part of the texel's extent along the other axis that lies between the strand's
//! ends. So all that a thin fibre covers of a row or a column of texels is in one of them. Of a fibre wider than
//! [`WIDEST_SLICED`] it is the square.
//!
//! All share the filter: the mean over a square of `pcf` texels a side around the point of what each texel says.

use crate::fragments::{Fragment, FragmentLists};
use crate::scene::{Camera, Strands};
use glam::{DVec2, DVec3, DVec4, Vec2Swizzles};

/// The greatest half-width, in texels, of a segment that is held against slices.
pub const WIDEST_SLICED: f64 = 0.25;

/// A light's map of some strands, and depth along its axis.
pub struct LightMap<'a> {
    /// Its camera, orthographic: the light is infinitely far away.
    pub camera: &'a Camera,
    /// Its texels' fragments.
    pub lists: &'a FragmentLists,
    /// Depth along the axis = `depth_row · (position, 1)`.
    pub depth_row: DVec4,
    /// The strands.
    pub strands: &'a Strands,
}

/// A fragment on a light's map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Occluder {
    /// Index, in the points of all strands, of the segment's first point.
    pub segment: usize,
    /// Depth along the map's axis.
    pub depth: f64,
    /// The part of the texel's slice, or of its square, that the fibre covers.
    pub coverage: f64,
    /// Whether the texel's centre is covered.
    pub at_centre: bool,
}

impl LightMap<'_> {
    /// Depth of a world position along the map's axis.
    pub fn depth(&self, position: DVec3) -> f64 {
        self.depth_row.dot(position.extend(1.0))
    }

    /// A direction in texels, and a position.
    fn texels(&self, vector: DVec4) -> DVec2 {
        let clip = self.camera.clip_from_world * vector;
        let half = 0.5 * DVec2::new(self.camera.width as f64, self.camera.height as f64);
        DVec2::new((clip.x + vector.w) * half.x, (vector.w - clip.y) * half.y)
    }

    /// A point on the map, in texels.
    fn place(&self, point: usize) -> DVec2 {
        self.texels(self.strands.points[point].extend(1.0))
    }

    /// Along a strand, how far it goes on in texels from a point to its end, or 2 where that is farther.
    fn rest(&self, points: impl Iterator<Item = usize>) -> f64 {
        let mut places = points.map(|point| self.place(point));
        let Some(mut last) = places.next() else {
            return 0.0;
        };
        let mut sum = 0.0;
        for place in places {
            sum += (place - last).length();
            last = place;
            if sum >= 2.0 {
                return 2.0;
            }
        }
        sum
    }

    /// The part of a texel's slice that a fibre of this half-width covers, which has a direction there.
    fn slice(&self, fragment: &Fragment, centre: DVec2, half_width: f64) -> f64 {
        let first = fragment.segment as usize;
        let [a, b] = [self.place(first), self.place(first + 1)];
        let along = (b - a).normalize_or_zero();
        // Major coordinate first.
        let turned = |v: DVec2| {
            if along.y.abs() > along.x.abs() {
                v.yx()
            } else {
                v
            }
        };
        let [way, from] = [turned(along), turned(centre - a)];
        if way.x == 0.0 {
            return 0.0;
        }
        // Where on the axis, from the segment's first point, the slice's middle lies.
        let middle = from.x / way.x;
        let offset = middle * way.y - from.y;
        let half = half_width / way.x.abs();
        let across = ((offset + half).min(0.5) - (offset - half).max(-0.5)).max(0.0);
        let points = self.strands.range(fragment.strand as usize);
        let start = -self.rest((points.start..=first).rev());
        let end = (b - a).length() + self.rest(first + 1..points.end);
        let [start, end] = [start, end].map(|s| ((s - middle) * way.x.abs()).clamp(-0.5, 0.5));
        across * (end - start).max(0.0)
    }

    /// A texel's fragments, nearest to the light first.
    pub fn occluders(&self, x: usize, y: usize) -> Vec<Occluder> {
        let centre = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        let towards_light = self.camera.eye.truncate();
        let seen = |fragment: &Fragment| {
            let first = fragment.segment as usize;
            let [a, b] = [self.strands.points[first], self.strands.points[first + 1]];
            let axis = a.lerp(b, fragment.t);
            let [r0, r1] = [self.strands.radii[first], self.strands.radii[first + 1]];
            let radius = r0 + (r1 - r0) * fragment.t;
            let along = self.texels((b - a).extend(0.0)).normalize_or_zero();
            let across = along.perp();
            let outwards = (b - a).cross(towards_light).normalize_or_zero() * radius;
            let half_width = self.texels(outwards.extend(0.0)).dot(across).abs();
            let widest = half_width * r0.max(r1) / radius.max(f64::MIN_POSITIVE);
            let distance = (centre - self.texels(axis.extend(1.0))).dot(across).abs();
            Occluder {
                segment: first,
                depth: self.depth(axis),
                coverage: if widest > WIDEST_SLICED {
                    fragment.coverage
                } else {
                    self.slice(fragment, centre, half_width)
                },
                at_centre: distance < half_width,
            }
        };
        let occluders = self.lists.at(x, y).iter().map(seen);
        occluders.filter(|o| o.coverage > 0.0).collect()
    }

    /// The mean of `texel(x, y)` over the square of `pcf` texels around a position; 1 outside of the map.
    pub fn filtered(
        &self,
        position: DVec3,
        pcf: usize,
        texel: impl Fn(usize, usize) -> f64,
    ) -> f64 {
        let middle = self.texels(position.extend(1.0));
        let half = 0.5 * pcf as f64;
        let (low, high) = (middle - half, middle + half);
        let part = |cell: i64, low: f64, high: f64| {
            (high.min(cell as f64 + 1.0) - low.max(cell as f64)).max(0.0)
        };
        let mut sum = 0.0;
        for y in low.y.floor() as i64..=high.y.floor() as i64 {
            for x in low.x.floor() as i64..=high.x.floor() as i64 {
                let inside = (0..self.lists.width as i64).contains(&x)
                    && (0..self.lists.height as i64).contains(&y);
                let value = if inside {
                    texel(x as usize, y as usize)
                } else {
                    1.0
                };
                sum += value * part(x, low.x, high.x) * part(y, low.y, high.y);
            }
        }
        sum / (pcf * pcf) as f64
    }
}

/// What must lie before a point in a texel to shadow it: in front of the point, and where its own fibre crosses the texel, at
/// a depth `own`, by `margin` in front of that too.
pub fn nearest_depth(depth: f64, own: Option<f64>, margin: f64) -> f64 {
    own.map_or(depth, |own| own.min(depth) - margin)
}

/// Shadow map: what lies behind the nearest fibre at the texel's centre loses `strength` of its light.
pub fn shadow_map(occluders: &[Occluder], depth: f64, strength: f64) -> f64 {
    let mut at_centre = occluders.iter().filter(|occluder| occluder.at_centre);
    match at_centre.next() {
        Some(nearest) if nearest.depth < depth => 1.0 - strength,
        _ => 1.0,
    }
}

/// Approximated deep shadow map (Hunz eq. 68, 69): `(1 - opacity)ⁿ`, n the fibres that lie `spacing` apart from each other
/// between the nearest one at the texel's centre, which counts, and the point.
pub fn approximated_deep_shadow_map(
    occluders: &[Occluder],
    depth: f64,
    opacity: f64,
    spacing: f64,
) -> f64 {
    let mut at_centre = occluders.iter().filter(|occluder| occluder.at_centre);
    match at_centre.next() {
        Some(nearest) if nearest.depth < depth => {
            (1.0 - opacity).powf((depth - nearest.depth) / spacing + 1.0)
        }
        _ => 1.0,
    }
}

/// Opacity shadow maps (Kim routine 2, κ = 1): `exp(-Ω)`, Ω known at planes, `planes[0]` before all hair, and linear in
/// between. `occluders` are those of other fibres than the point's own.
pub fn opacity_shadow_maps(occluders: &[Occluder], depth: f64, alpha: f64, planes: &[f64]) -> f64 {
    let last = planes.len() - 1;
    let sum_before = |plane: usize| -> f64 {
        let passed = |o: &&Occluder| plane == last || (plane > 0 && o.depth < planes[plane]);
        let optical_depth = |o: &Occluder| -(1.0 - alpha * o.coverage).ln();
        occluders
            .iter()
            .filter(passed)
            .map(optical_depth)
            .map(|d| d.min(16.0))
            .sum()
    };
    if depth <= planes[0] {
        return 1.0;
    }
    let slab = planes[1..last]
        .iter()
        .filter(|plane| **plane <= depth)
        .count();
    let [before, behind] = [sum_before(slab), sum_before(slab + 1)];
    let part = (depth - planes[slab]) / (planes[slab + 1] - planes[slab]);
    (-(before + part.min(1.0) * (behind - before))).exp()
}
