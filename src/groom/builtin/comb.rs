//! Combs hair over the built-in head: guides grow from the scalp along a flow, under gravity and clear of the body, gather
//! into locks, are filled up with strands, and the strands are cut, shaped and pushed out of the body.

use super::head;
use crate::error::Result;
use crate::groom::even::EvenGuides;
use crate::groom::hash::Draws;
use crate::groom::interpolate::{Placement, Stray, blend};
use crate::groom::scalp::{PARTING_X, Scalp, height_over_hairline};
use crate::groom::{Curve, Strands};
use glam::{Vec3, vec3};

/// What makes one hairstyle differ from another. Lengths in metres.
pub(super) struct Style {
    pub(super) seed: u32,
    /// Points a strand.
    pub(super) points: usize,
    pub(super) curve: Curve,
    /// The first segment's length over that of an even one: below 1, points gather where hair bends over the head.
    pub(super) first_segment: f32,
    /// The longest strand, and the height at which hair is cut before that.
    pub(super) longest: f32,
    pub(super) cut_height: f32,
    /// How much higher the shortest layer, from the crown, is cut than the longest.
    pub(super) layering: f32,
    /// How far the outermost layer stands off the head.
    pub(super) volume: f32,
    /// The part of the guides that lead a lock, and how far the lock's others join them at the tip, 0 to 1.
    pub(super) leaders: f32,
    pub(super) gather: [f32; 2],
    /// How far strands join their lock's leader in the middle and further down, 0 to 1.
    pub(super) tightness: f32,
    /// How closely strands clump at their guide's tip, least and most.
    pub(super) clump: [f32; 2],
    /// A strand is at most this part shorter than its guide.
    pub(super) raggedness: f32,
    pub(super) stray: Stray,
    /// Bends a strand out of its smooth course.
    pub(super) shape: fn(&mut [Vec3], &mut Lock),
}

impl Style {
    /// Where along a strand its point `i` lies, from 0 to 1.
    fn along(&self, i: usize) -> f32 {
        let u = i as f32 / (self.points - 1) as f32;
        u * (self.first_segment + (1.0 - self.first_segment) * u)
    }
}

/// What a strand's shape may depend on.
pub(super) struct Lock {
    /// Draws that all strands of the lock share.
    pub(super) shared: Draws,
    /// The strand's own draws.
    pub(super) own: Draws,
}

/// A grown guide: its course, evenly spaced, and the guide that leads its lock.
struct Guide {
    course: Vec<Vec3>,
    leader: usize,
}

/// The parting reaches back to this z.
const PARTING_END: f32 = -0.05;

/// Step along a growing guide.
const STEP: f32 = 0.006;

/// Strands closer to the body than this are pushed out.
const CLEARANCE: f32 = 0.0008;

/// The radius of a fibre's root with 50,000 strands, and the tip's radius over it.
const ROOT_RADIUS: f32 = 4.5e-5;
const TIP_TAPER: f32 = 0.35;

/// How much a radius may differ from that to keep the coverage of 50,000 strands.
const RADIUS_FACTORS: [f32; 2] = [0.6, 20.0];

/// Makes `count` strands of a style.
pub(super) fn comb(style: &Style, count: usize) -> Result<Strands> {
    if count == 0 {
        return Ok(Strands::default().with_curve(style.curve));
    }
    let scalp = Scalp::new();
    let guides = gather(&scalp, grow_all(&scalp, style), style);
    let clump: Vec<f32> = (0..guides.len())
        .map(|guide| {
            Draws::new(scalp.keys[guide], style.seed ^ 1).between(style.clump[0], style.clump[1])
        })
        .collect();
    let placements = scalp.placements(count, &clump, &style.stray, style.seed);

    let courses = guides
        .iter()
        .flat_map(|guide| guide.course.iter().map(|p| p.to_array()))
        .collect();
    let guide_strands = Strands::new(courses, &vec![style.points as u32; guides.len()], 0.0)?;
    let strands = blend(&EvenGuides::new(&guide_strands), &placements)?;
    let mut points: Vec<Vec3> = strands.points().iter().map(|p| Vec3::from(*p)).collect();
    for (at, (own, placement)) in points.chunks_mut(style.points).zip(&placements).enumerate() {
        finish(
            own,
            at as u32,
            &guides,
            &guides[nearest_guide(placement)],
            style,
        );
    }

    let factor = (50_000.0 / count as f32).clamp(RADIUS_FACTORS[0], RADIUS_FACTORS[1]);
    let positions = points.iter().map(|p| p.to_array()).collect();
    let strands = Strands::new(positions, &vec![style.points as u32; count], 0.0)?;
    let root = ROOT_RADIUS * factor;
    let strands = taper(strands, root)?;
    Ok(strands
        .with_colours(tints(count, style.seed))?
        .with_curve(style.curve))
}

/// Radii that hold to mid-length and then fall smoothly to the tip's.
fn taper(strands: Strands, root: f32) -> Result<Strands> {
    let radius = |u: &f32| root * (1.0 - (1.0 - TIP_TAPER) * smooth(0.4, 1.0, *u));
    let radii = strands.coordinates().iter().map(radius).collect();
    strands.with_point_radii(radii)
}

/// Slightly different brightness a strand, as in real hair.
fn tints(count: usize, seed: u32) -> Vec<[f32; 3]> {
    (0..count as u32)
        .map(|strand| [Draws::new(strand, seed ^ 2).between(0.8, 1.0); 3])
        .collect()
}

fn nearest_guide(placement: &Placement) -> usize {
    let nearest = (0..3)
        .max_by(|a, b| placement.root[*a].total_cmp(&placement.root[*b]))
        .unwrap_or(0);
    placement.guides[nearest] as usize
}

/// Tightens, cuts, shapes and clears one strand.
fn finish(points: &mut [Vec3], strand: u32, guides: &[Guide], guide: &Guide, style: &Style) {
    let mut lock = Lock {
        shared: Draws::new(guide.leader as u32, style.seed ^ 3),
        own: Draws::new(strand, style.seed ^ 4),
    };
    for (i, (point, leading)) in points
        .iter_mut()
        .zip(&guides[guide.leader].course)
        .enumerate()
    {
        *point = point.lerp(
            *leading,
            style.tightness * smooth(0.0, 0.45, style.along(i)),
        );
    }
    // The square makes most strands nearly full length and few much shorter, which softens the tips.
    let short = lock.own.uniform();
    shorten(points, 1.0 - style.raggedness * short * short);
    (style.shape)(points, &mut lock);
    for point in points.iter_mut().skip(1) {
        *point = clear(*point, CLEARANCE);
    }
}

/// Keeps the given part of a strand's length, with as many points.
fn shorten(points: &mut [Vec3], part: f32) {
    let old = points.to_vec();
    for (i, point) in points.iter_mut().enumerate() {
        let at = i as f32 * part;
        let first = (at as usize).min(old.len() - 1);
        *point = old[first].lerp(old[(first + 1).min(old.len() - 1)], at - first as f32);
    }
}

/// Moves a point out until it is `clearance` away from the body.
fn clear(mut p: Vec3, clearance: f32) -> Vec3 {
    // The field is only an estimate, so one step may fall short.
    for _ in 0..4 {
        let lack = clearance - head::hair_distance(p);
        if lack <= 0.0 {
            break;
        }
        p += head::gradient(head::hair_distance, p, 1e-3) * lack;
    }
    p
}

fn grow_all(scalp: &Scalp, style: &Style) -> Vec<Vec<Vec3>> {
    let mut used = vec![false; scalp.roots.len()];
    for guide in scalp.triangles.as_flattened() {
        used[*guide as usize] = true;
    }
    let grow = |guide: usize| match used[guide] {
        true => resample(&grow(scalp, guide, style), style),
        false => vec![scalp.roots[guide]; style.points],
    };
    (0..scalp.roots.len()).map(grow).collect()
}

/// Grows one guide from its root to where it is cut.
fn grow(scalp: &Scalp, guide: usize, style: &Style) -> Vec<Vec3> {
    let mut draws = Draws::new(scalp.keys[guide], style.seed ^ 5);
    let (root, normal, side) = (scalp.roots[guide], scalp.normals[guide], scalp.sides[guide]);
    // Hair from above lies over hair from below.
    let rank = smooth(-0.09, 0.11, root.y);
    let layer = style.volume * (0.12 + 0.88 * rank) * draws.between(0.75, 1.1) + 0.001;
    let cut = style.cut_height + style.layering * rank + 0.012 * draws.signed();
    let longest = style.longest * draws.between(0.93, 1.0);
    let mut direction = (flow(root, normal, side) + normal * 0.45).normalize();
    let mut course = vec![root];
    let (mut p, mut length) = (root, 0.0);
    while length < longest && (p.y > cut || length < 0.03) {
        let outward = head::gradient(head::hair_distance, p, 2e-3);
        let height = head::hair_distance(p);
        let clearance = layer * smooth(0.0, 0.13, length);
        // Near the scalp hair is combed; further off it only falls, and is drawn in by the hair around it.
        let combed = smooth(0.06, 0.02, height) * smooth(-0.06, 0.03, p.y);
        let drawn_in = (outward * (height - clearance) / 0.03).clamp_length_max(1.0);
        let pull = flow(p, outward, side) * combed - Vec3::Y * (1.0 - combed) - drawn_in * 0.3
            + drape(p, height);
        direction = (direction + pull * 0.38).normalize();
        let mut next = p + direction * STEP;
        let lack = clearance - head::hair_distance(next);
        if lack > 0.0 {
            next += outward * lack;
            direction = (next - p).try_normalize().unwrap_or(direction);
            next = p + direction * STEP;
        }
        p = next;
        length += STEP;
        course.push(p);
    }
    course
}

/// Where the comb leads hair at `p` on the skin: away from the parting above, backwards in front, down elsewhere.
fn flow(p: Vec3, normal: Vec3, side: f32) -> Vec3 {
    let top = smooth(0.03, 0.10, p.y);
    let back = smooth(-0.02, PARTING_END - 0.03, p.z);
    let front = smooth(0.01, 0.06, p.z);
    let near_parting = smooth(0.06, 0.0, (p.x - PARTING_X).abs());
    let lateral = side * (top * (1.0 - back) + 0.25 * near_parting * (1.0 - back));
    let wanted = vec3(
        lateral,
        -1.0 + 0.55 * top * (1.0 - back),
        -0.35 * top - 0.75 * front,
    );
    (wanted - normal * wanted.dot(normal))
        .try_normalize()
        .unwrap_or(-Vec3::Y)
}

/// Hair that meets the shoulders slides off them to the front or the back, not outwards.
fn drape(p: Vec3, height: f32) -> Vec3 {
    const RIDGE_Z: f32 = -0.035;
    let near = smooth(0.035, 0.01, height) * smooth(-0.11, -0.16, p.y);
    let forward = ((p.z - RIDGE_Z) / 0.02).clamp(-1.0, 1.0);
    vec3(
        -0.5 * p.x.signum() * smooth(0.03, 0.08, p.x.abs()),
        0.0,
        0.8 * forward,
    ) * near
}

/// A course resampled to the style's points.
fn resample(course: &[Vec3], style: &Style) -> Vec<Vec3> {
    let last = (course.len() - 1) as f32;
    let at = |i: usize| {
        let place = last * style.along(i);
        let first = (place as usize).min(course.len() - 1);
        course[first].lerp(
            course[(first + 1).min(course.len() - 1)],
            place - first as f32,
        )
    };
    (0..style.points).map(at).collect()
}

/// Draws each guide towards the nearest leader of its side, more and more towards the tip.
fn gather(scalp: &Scalp, courses: Vec<Vec<Vec3>>, style: &Style) -> Vec<Guide> {
    let leads = |guide: usize| {
        let grows = height_over_hairline(scalp.roots[guide]) > 0.0;
        grows && Draws::new(scalp.keys[guide], style.seed ^ 6).uniform() < style.leaders
    };
    let leaders: Vec<usize> = (0..courses.len()).filter(|guide| leads(*guide)).collect();
    let distance = |a: usize, b: usize| {
        // The parting ends at the crown; behind it locks may form across its plane.
        let parted = scalp.sides[a] != scalp.sides[b] && scalp.roots[a].z > PARTING_END;
        let other_side = if parted { 1.0 } else { 0.0 };
        scalp.roots[a].distance(scalp.roots[b]) + other_side
    };
    let nearest = |guide: usize| {
        let nearest = leaders
            .iter()
            .copied()
            .min_by(|a, b| distance(guide, *a).total_cmp(&distance(guide, *b)));
        nearest.unwrap_or(guide)
    };
    let join = |guide: usize| {
        let leader = nearest(guide);
        let mut draws = Draws::new(scalp.keys[guide], style.seed ^ 7);
        let strength = draws.between(style.gather[0], style.gather[1]);
        let toward = |(i, p): (usize, &Vec3)| {
            let gathered = strength * smooth(0.05, 0.9, style.along(i));
            p.lerp(courses[leader][i], gathered)
        };
        Guide {
            course: courses[guide].iter().enumerate().map(toward).collect(),
            leader,
        }
    };
    (0..courses.len()).map(join).collect()
}

/// The cubic step from 0 at `low` to 1 at `high`; `low` may be the larger.
pub(super) fn smooth(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// A winding around a strand's smooth course.
pub(super) struct Winding {
    /// Distance from the course, along the head and away from it.
    pub(super) amplitude: [f32; 2],
    /// Length of one turn along the course.
    pub(super) turn: f32,
    /// Radians at the root.
    pub(super) phase: f32,
    /// Where along the strand the winding sets in and where it is full.
    pub(super) onset: [f32; 2],
    /// 1 or -1.
    pub(super) hand: f32,
    /// The phase counts from where the strand passes this height instead of from the root, so that strands of differing
    /// roots swing together.
    pub(super) aligned_at: Option<f32>,
}

/// Winds a strand around its own course.
pub(super) fn wind(points: &mut [Vec3], winding: &Winding) {
    let course = points.to_vec();
    let start = winding
        .aligned_at
        .map_or(0.0, |height| length_to_height(&course, height));
    let mut length = 0.0;
    for i in 1..points.len() {
        length += course[i].distance(course[i - 1]);
        let tangent = (course[(i + 1).min(course.len() - 1)] - course[i - 1])
            .try_normalize()
            .unwrap_or(-Vec3::Y);
        let away = course[i] - vec3(0.0, course[i].y.min(0.03), -0.02);
        let across = tangent
            .cross(away)
            .try_normalize()
            .unwrap_or_else(|| tangent.any_orthonormal_vector());
        let out = across.cross(tangent);
        let (sin, cos) = (winding.phase
            + winding.hand * std::f32::consts::TAU * (length - start) / winding.turn)
            .sin_cos();
        let grown = smooth(winding.onset[0], winding.onset[1], length);
        // The outward part is lifted by its amplitude, so that winding makes volume instead of entering the head.
        let [wide, high] = winding.amplitude;
        points[i] += (across * (wide * cos) + out * (high * (sin + 0.5))) * grown;
    }
}

/// The length at which a course last falls through `height`; for a root below it, minus the drop that is missing.
fn length_to_height(course: &[Vec3], height: f32) -> f32 {
    if course[0].y <= height {
        return course[0].y - height;
    }
    let mut length = 0.0;
    for pair in course.windows(2) {
        if pair[1].y < height {
            let part = (pair[0].y - height) / (pair[0].y - pair[1].y);
            return length + part * pair[0].distance(pair[1]);
        }
        length += pair[0].distance(pair[1]);
    }
    length
}
