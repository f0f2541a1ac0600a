//! Strands on the screen: position, depth and half-width in pixels of every point, clipped at the near plane.
//!
//! A fibre of radius r seen from the direction V has its silhouette at `p ± r·o` with `o = (T × V) / |T × V|`, T its
//! tangent. The half-width on the screen is the distance of the projection of `p + r·o` from the line through the
//! projection of p along the projected tangent. Distances on the screen are formed from clip-space differences,
//! `a/w_a - b/w_b = (Δ·w_b - b·Δw) / (w_a·w_b)` with `Δ = a - b`, which loses no digits when fibres are thin.

use crate::scene::{Camera, Strands};
use glam::{DVec2, DVec3, DVec4};

/// Below this share of the longer end's w, a segment is cut off even where its depth is not negative.
const SMALLEST_W: f64 = 1e-9;

/// Projected tangents shorter than this share of the projected radius have no direction.
const DEGENERATE_TANGENT: f64 = 1e-9;

/// A point of a fibre as it appears on the screen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScreenPoint {
    /// Position in pixels, y down.
    pub pixel: DVec2,
    /// Normalised device depth: 0 at the near plane, 1 at the far one.
    pub depth: f64,
    /// Half of the fibre's width, in pixels.
    pub half_width: f64,
}

/// The part of a segment that lies before the eye.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScreenSegment {
    /// Index, in the points of all strands, of the segment's first point.
    pub segment: usize,
    /// Where it starts on the screen.
    pub start: ScreenPoint,
    /// Where it ends on the screen.
    pub end: ScreenPoint,
    /// Where `start` and `end` lie on the whole segment, as parts of its length in world space: 0 and 1 if unclipped.
    pub span: [f64; 2],
}

/// Tangents of a polyline: at each point, the normalised sum of the unit directions of the nearest segments before and
/// after it that have a length. Where they cancel (a turn of 180°), the earlier one; `None` if all points coincide.
pub fn tangents(points: &[DVec3]) -> Option<Vec<DVec3>> {
    let directions: Vec<Option<DVec3>> = points
        .windows(2)
        .map(|ends| (ends[1] - ends[0]).try_normalize())
        .collect();
    let first = directions.iter().flatten().next().copied()?;

    let mut before = vec![None; points.len()];
    for i in 1..points.len() {
        before[i] = directions[i - 1].or(before[i - 1]);
    }
    let mut after = vec![None; points.len()];
    for i in (0..points.len() - 1).rev() {
        after[i] = directions[i].or(after[i + 1]);
    }

    let tangent = |(before, after): (&Option<DVec3>, &Option<DVec3>)| match (before, after) {
        (Some(before), Some(after)) => (*before + *after).try_normalize().unwrap_or(*before),
        (Some(only), None) | (None, Some(only)) => *only,
        (None, None) => first,
    };
    Some(before.iter().zip(&after).map(tangent).collect())
}

/// Tangents of the curve that a polyline stands for: at each point, that of the circle through it and its two neighbours,
/// which parts the turn between the two segments in proportion to their lengths. At an end, or beside a neighbour that
/// coincides, the one segment's direction; `None` where there is none, or where the strand folds back upon itself.
pub fn curve_tangents(points: &[DVec3]) -> Vec<Option<DVec3>> {
    let segment = |from: usize| {
        let offset = points.get(from + 1)? - points[from];
        Some((offset.try_normalize()?, offset.length()))
    };
    let tangent = |at: usize| match (at.checked_sub(1).and_then(segment), segment(at)) {
        // The nearer neighbour's direction counts for more.
        (Some((u, a)), Some((v, b))) => (u * b + v * a).try_normalize(),
        (Some((only, _)), None) | (None, Some((only, _))) => Some(only),
        (None, None) => None,
    };
    (0..points.len()).map(tangent).collect()
}

/// A point of a fibre in world space, with its clip-space position.
#[derive(Clone, Copy)]
struct FibrePoint {
    world: DVec3,
    clip: DVec4,
    tangent: DVec3,
    radius: f64,
}

/// How far, in pixels, the projection of `clip + offset` is from that of `clip`; `w` is `offset`'s own share of w.
fn screen_step(camera: &Camera, clip: DVec4, offset: DVec4, w: f64) -> DVec2 {
    let ndc = (offset.truncate().truncate() * clip.w - clip.truncate().truncate() * offset.w)
        / (clip.w * (clip.w + w));
    ndc * camera.pixels_per_ndc()
}

/// Half of a fibre's width in pixels, at a point with `clip.w > 0`.
fn half_width(camera: &Camera, point: &FibrePoint) -> f64 {
    let towards_eye = (camera.eye.truncate() - point.world * camera.eye.w)
        .try_normalize()
        .unwrap_or(DVec3::Z);
    let outwards = point
        .tangent
        .cross(towards_eye)
        .try_normalize()
        .unwrap_or_else(|| towards_eye.any_orthonormal_vector());

    let offset = camera.clip_from_world * (outwards * point.radius).extend(0.0);
    // Either silhouette will do; one of them is before the eye.
    let offset = if point.clip.w + offset.w > 0.0 {
        offset
    } else {
        -offset
    };
    let step = screen_step(camera, point.clip, offset, offset.w);

    let along = camera.clip_from_world * (point.tangent * point.radius).extend(0.0);
    let tangent = screen_step(camera, point.clip, along, 0.0);
    if tangent.length() <= DEGENERATE_TANGENT * step.length() {
        return step.length();
    }
    step.perp_dot(tangent.normalize()).abs()
}

/// The point as it appears on the screen; its clip-space w must be positive.
fn on_screen(camera: &Camera, point: &FibrePoint) -> ScreenPoint {
    ScreenPoint {
        pixel: camera.pixel_from_clip(point.clip),
        depth: point.clip.z / point.clip.w,
        half_width: half_width(camera, point),
    }
}

/// The part [t0, t1] of a segment whose depth is not negative and whose w is positive, or `None`.
fn visible_span(start: DVec4, end: DVec4) -> Option<[f64; 2]> {
    let smallest_w = SMALLEST_W * start.w.abs().max(end.w.abs());
    let mut span = [0.0_f64, 1.0_f64];
    for (a, b) in [(start.z, end.z), (start.w - smallest_w, end.w - smallest_w)] {
        match (a >= 0.0, b >= 0.0) {
            (true, true) => {}
            (false, false) => return None,
            (false, true) => span[0] = span[0].max(a / (a - b)),
            (true, false) => span[1] = span[1].min(a / (a - b)),
        }
    }
    (span[0] <= span[1] && smallest_w > 0.0).then_some(span)
}

/// The point of a segment at `t`, where the near plane cuts it. Its tangent is the segment's own direction.
fn cut(start: &FibrePoint, end: &FibrePoint, t: f64) -> Option<FibrePoint> {
    Some(FibrePoint {
        world: start.world.lerp(end.world, t),
        clip: start.clip.lerp(end.clip, t),
        tangent: (end.world - start.world).try_normalize()?,
        radius: start.radius + (end.radius - start.radius) * t,
    })
}

/// The same point, with a depth that rounding took before the near plane put back onto it.
fn at_least_near(point: ScreenPoint) -> ScreenPoint {
    ScreenPoint {
        depth: point.depth.max(0.0),
        ..point
    }
}

/// One strand on the screen, as runs of segments that hang together; a strand that passes the near plane falls into
/// several. Segments of no length are kept. No run is empty; a strand of one point, or of points that all coincide,
/// gives none.
pub fn project_strand(
    strands: &Strands,
    camera: &Camera,
    strand: usize,
) -> Vec<Vec<ScreenSegment>> {
    let range = strands.range(strand);
    let Some(tangents) = tangents(&strands.points[range.clone()]) else {
        return Vec::new();
    };
    let fibre: Vec<FibrePoint> = range
        .clone()
        .zip(tangents)
        .map(|(i, tangent)| FibrePoint {
            world: strands.points[i],
            clip: camera.clip_from_world * strands.points[i].extend(1.0),
            tangent,
            radius: strands.radii[i],
        })
        .collect();

    let mut runs = vec![Vec::new()];
    let mut open: Option<ScreenPoint> = None;
    for (i, ends) in fibre.windows(2).enumerate() {
        let [start, end] = [&ends[0], &ends[1]];
        let Some(span) = visible_span(start.clip, end.clip) else {
            runs.push(Vec::new());
            open = None;
            continue;
        };
        if span[0] > 0.0 {
            runs.push(Vec::new());
            open = None;
        }
        let place = |t: f64| match t {
            0.0 => Some(on_screen(camera, start)),
            1.0 => Some(on_screen(camera, end)),
            t => cut(start, end, t)
                .map(|point| on_screen(camera, &point))
                .map(at_least_near),
        };
        let first = open.or_else(|| place(span[0]));
        let (Some(first), Some(last)) = (first, place(span[1])) else {
            continue;
        };
        runs.last_mut()
            .expect("runs start with one")
            .push(ScreenSegment {
                segment: range.start + i,
                start: first,
                end: last,
                span,
            });
        open = (span[1] == 1.0).then_some(last);
        if span[1] < 1.0 {
            runs.push(Vec::new());
        }
    }
    runs.retain(|run| !run.is_empty());
    runs
}
