//! Few guides to many strands.
//!
//! On a mesh: Lansink, *Hair Simulation & Rendering* (2010), §4.1.4, after Bertails et al. (2006): a triangle of area A
//! is given A × density strands; each blends the triangle's three guides with barycentrics that run from its root's,
//! uniform over the triangle, to its tip's, near the guide whose root is nearest. Unlike the printed form, the weights
//! reach the tip's at the tip (i/(n-1), not i/n) and always sum to 1; the stray hairs that the printed sums made by
//! accident are a setting of their own. Without a mesh: followers in a disc around each guide.

use super::even::EvenGuides;
use super::hash::Draws;
use super::strands::MAX_POINTS;
use super::{Guides, Strands};
use crate::error::{Result, invalid};
use glam::Vec3;

/// The largest number of strands that an interpolation makes.
pub const MAX_INTERPOLATED_STRANDS: usize = 1 << 24;

/// Stray hairs: strands that leave their clump towards the tip.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stray {
    /// The fraction of the strands that stray, 0 to 1.
    pub fraction: f32,
    /// How far a stray's tip is displaced at most, as a fraction of the strand's length; at least 0. The displacement
    /// grows with the square of the distance from the root and has a random direction.
    pub strength: f32,
}

/// How [`interpolate_on_mesh`] fills the triangles between guides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InterpolationSettings {
    /// Strands per unit of area, in host units; at least 0. A scalp has 200 to 300 a square centimetre.
    pub density: f32,
    /// How closely tips gather at the nearest guide: 0 spreads them over the triangle, 1 puts them on the guide.
    pub clump: f32,
    /// Hairs that leave their clump.
    pub stray: Stray,
    /// Another seed, another groom of the same kind.
    pub seed: u32,
}

impl Default for InterpolationSettings {
    /// No strands (a density depends on the host's units), Lansink's clump of 0.75, no stray hairs.
    fn default() -> Self {
        Self {
            density: 0.0,
            clump: 0.75,
            stray: Stray::default(),
            seed: 0,
        }
    }
}

/// How [`interpolate_clumps`] surrounds each guide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClumpSettings {
    /// Strands that are added to each guide.
    pub followers: u32,
    /// Radius of the disc in which the followers' roots lie, in host units; at least 0.
    pub root_radius: f32,
    /// The disc's radius at the tip over that at the root; at least 0. Below 1 the followers close up, above they spread.
    pub tip_factor: f32,
    /// Hairs that leave their clump.
    pub stray: Stray,
    /// Another seed, another groom of the same kind.
    pub seed: u32,
}

impl Default for ClumpSettings {
    /// Four followers on the guide itself (a radius depends on the host's units), tips at half the roots' distance.
    fn default() -> Self {
        Self {
            followers: 4,
            root_radius: 0.0,
            tip_factor: 0.5,
            stray: Stray::default(),
            seed: 0,
        }
    }
}

/// Where one strand grows between three guides, and where it goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Placement {
    /// The triangle's guides.
    pub(crate) guides: [u32; 3],
    /// Their weights at the root and at the tip; each sums to 1.
    pub(crate) root: [f32; 3],
    pub(crate) tip: [f32; 3],
    /// Displacement of the tip over the strand's length.
    pub(crate) stray: Vec3,
}

/// Keeps the draws of triangles apart from those of strands.
const TRIANGLE_SALT: u32 = 0x7472_6961;

/// Fills the triangles between `guides` with strands; the guides themselves are not among them.
///
/// A triangle gets area × density strands, the fraction by chance, so that the total is right on average. Guides of
/// differing numbers of points are first resampled, by coordinate, to the longest's. Radii blend as positions do,
/// colours by the root's weights; coordinates are by arc length; the curve is the guides'.
///
/// # Errors
/// [`InvalidValue`](crate::Error::InvalidValue): a setting out of its range or not finite; guides without a mesh; more
/// than [`MAX_INTERPOLATED_STRANDS`] strands to be expected, or more points than a groom can have.
pub fn interpolate_on_mesh(guides: &Guides, settings: &InterpolationSettings) -> Result<Strands> {
    let placements = placements(guides, settings)?;
    blend(&EvenGuides::new(guides.strands()), &placements)
}

/// Surrounds each guide with followers at random places of a disc perpendicular to it; no mesh is needed.
///
/// A guide comes first, then its followers, whose offsets are carried along it without twist. Followers have the
/// guide's radii, colour and coordinates, and the curve is the guides'.
///
/// # Errors
/// [`InvalidValue`](crate::Error::InvalidValue): a setting out of its range or not finite; more than
/// [`MAX_INTERPOLATED_STRANDS`] strands, or more points than a groom can have; a follower too far away for its numbers.
pub fn interpolate_clumps(guides: &Strands, settings: &ClumpSettings) -> Result<Strands> {
    surround(guides, &followers(guides, settings)?, settings)
}

/// Strands that were made of guides, and remember how: they can follow the guides wherever these go.
///
/// What was drawn by chance, the number of strands among it, stays as it was drawn for the guides at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct GuidedStrands {
    strands: Strands,
    guides: Strands,
    pub(crate) makeup: Makeup,
}

/// What strands are made up of, beside their guides.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Makeup {
    Mesh(Vec<Placement>),
    /// Of each guide in turn.
    Clumps(Vec<Follower>, ClumpSettings),
}

impl GuidedStrands {
    /// The strands of [`interpolate_on_mesh`].
    ///
    /// # Errors
    /// As of that function.
    pub fn on_mesh(guides: &Guides, settings: &InterpolationSettings) -> Result<Self> {
        let placements = placements(guides, settings)?;
        Ok(Self {
            strands: blend(&EvenGuides::new(guides.strands()), &placements)?,
            guides: guides.strands().clone(),
            makeup: Makeup::Mesh(placements),
        })
    }

    /// The strands of [`interpolate_clumps`].
    ///
    /// # Errors
    /// As of that function.
    pub fn clumps(guides: &Strands, settings: &ClumpSettings) -> Result<Self> {
        let followers = followers(guides, settings)?;
        Ok(Self {
            strands: surround(guides, &followers, settings)?,
            guides: guides.clone(),
            makeup: Makeup::Clumps(followers, *settings),
        })
    }

    /// The strands as the guides were at rest.
    pub fn strands(&self) -> &Strands {
        &self.strands
    }

    /// The guides at rest.
    pub fn guides(&self) -> &Strands {
        &self.guides
    }

    /// Every strand's points where the guides' points are `points`. Guides of differing numbers of points are resampled by
    /// the coordinates that they had at rest.
    ///
    /// # Errors
    /// Another number of points than the guides have; a position that is not finite.
    pub fn follow(&self, points: &[[f32; 3]]) -> Result<Vec<[f32; 3]>> {
        let mut guides = self.guides.clone();
        guides.set_points(points)?;
        match &self.makeup {
            Makeup::Mesh(placements) => Ok(blended(&EvenGuides::new(&guides), placements).0),
            Makeup::Clumps(followers, settings) => {
                let mut points = Vec::with_capacity(self.strands.points().len());
                surround_points(&guides, followers, settings, &mut points);
                Ok(points)
            }
        }
    }
}

/// Where the strands of every triangle grow.
fn placements(guides: &Guides, settings: &InterpolationSettings) -> Result<Vec<Placement>> {
    check_settings(settings)?;
    if guides.triangles().is_empty() && guides.strands().strand_count() > 0 {
        return invalid!(
            "{} guides have no mesh to interpolate on",
            guides.strands().strand_count()
        );
    }
    let strands = guides.strands();
    let root =
        |guide: u32| Vec3::from(strands.points()[strands.range(guide as usize).start]).as_dvec3();
    let area = |t: &[u32; 3]| {
        0.5 * (root(t[1]) - root(t[0]))
            .cross(root(t[2]) - root(t[0]))
            .length()
    };
    let expected = guides
        .triangles()
        .iter()
        .map(|t| area(t) * f64::from(settings.density));
    check_total(expected.clone().sum(), strands, settings.density)?;

    let mut owners = Vec::new();
    for (at, (triangle, expected)) in guides.triangles().iter().zip(expected).enumerate() {
        let chance = f64::from(Draws::new(at as u32, settings.seed ^ TRIANGLE_SALT).uniform());
        let count = (expected + chance).floor() as usize;
        owners.extend((0..count).map(|_| *triangle));
    }
    let place = |(at, triangle): (usize, &[u32; 3])| place(*triangle, at as u32, settings);
    Ok(owners.iter().enumerate().map(place).collect())
}

/// One follower's place beside its guide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Follower {
    /// The direction from the guide, in its frame.
    pub(crate) cos: f32,
    pub(crate) sin: f32,
    /// The distance from the guide at the root.
    pub(crate) distance: f32,
    /// Displacement of the tip over the strand's length.
    pub(crate) stray: Vec3,
}

/// The followers of every guide in turn.
fn followers(guides: &Strands, settings: &ClumpSettings) -> Result<Vec<Follower>> {
    check_not_negative("root_radius", settings.root_radius)?;
    check_not_negative("tip_factor", settings.tip_factor)?;
    check_stray(&settings.stray)?;
    let each = u64::from(settings.followers) + 1;
    let (strand_count, point_count) = (
        guides.strand_count() as u64 * each,
        guides.points().len() as u64 * each,
    );
    if strand_count > MAX_INTERPOLATED_STRANDS as u64 || point_count > MAX_POINTS as u64 {
        return invalid!(
            "followers {} make {strand_count} strands of {point_count} points: at most {MAX_INTERPOLATED_STRANDS} of \
             {MAX_POINTS} are made",
            settings.followers
        );
    }
    let follower = |(guide, number): (u32, u32)| {
        let strand = guide * (settings.followers + 1) + 1 + number;
        let mut draws = Draws::new(strand, settings.seed);
        // The square root makes places uniform over the disc.
        let (distance, angle) = (
            draws.uniform().sqrt(),
            std::f32::consts::TAU * draws.uniform(),
        );
        let (sin, cos) = angle.sin_cos();
        Follower {
            cos,
            sin,
            distance: distance * settings.root_radius,
            stray: stray(&mut draws, &settings.stray),
        }
    };
    let numbers = |guide| (0..settings.followers).map(move |number| (guide, number));
    let guides = 0..guides.strand_count() as u32;
    Ok(guides.flat_map(numbers).map(follower).collect())
}

/// Guides and their followers.
fn surround(guides: &Strands, followers: &[Follower], settings: &ClumpSettings) -> Result<Strands> {
    let each = settings.followers as usize + 1;
    let copies = |values: &[f32], guide: usize| values[guides.range(guide)].repeat(each);
    let mut points = Vec::with_capacity(guides.points().len() * each);
    let (mut radii, mut coordinates) = (Vec::new(), Vec::new());
    let (mut counts, mut colours) = (Vec::new(), Vec::new());
    surround_points(guides, followers, settings, &mut points);
    for guide in 0..guides.strand_count() {
        radii.extend(copies(guides.radii(), guide));
        coordinates.extend(copies(guides.coordinates(), guide));
        counts.resize(counts.len() + each, guides.range(guide).len() as u32);
        colours.resize(colours.len() + each, guides.colours()[guide]);
    }
    let strands = Strands::new(points, &counts, 0.0)?
        .with_point_radii(radii)?
        .with_coordinates(coordinates)?;
    Ok(strands.with_colours(colours)?.with_curve(guides.curve()))
}

/// Appends the points of every guide and its followers.
fn surround_points(
    guides: &Strands,
    followers: &[Follower],
    settings: &ClumpSettings,
    points: &mut Vec<[f32; 3]>,
) {
    let each = settings.followers as usize;
    for guide in 0..guides.strand_count() {
        let range = guides.range(guide);
        let frames = transported_frames(&guides.points()[range.clone()]);
        points.extend_from_slice(&guides.points()[range]);
        for follower in &followers[guide * each..][..each] {
            follow(guides, guide, &frames, follower, settings, points);
        }
    }
}

/// Blends one strand per placement out of the guides.
pub(crate) fn blend(guides: &EvenGuides, placements: &[Placement]) -> Result<Strands> {
    let (points, radii) = blended(guides, placements);
    let colour = |placement: &Placement| guides.colour(placement.guides, placement.root);
    let counts = vec![guides.points_each as u32; placements.len()];
    let strands = Strands::new(points, &counts, 0.0)?.with_point_radii(radii)?;
    let strands = strands.with_colours(placements.iter().map(colour).collect())?;
    Ok(strands.with_curve(guides.curve))
}

/// Positions and radii of one strand per placement.
fn blended(guides: &EvenGuides, placements: &[Placement]) -> (Vec<[f32; 3]>, Vec<f32>) {
    let n = guides.points_each;
    let last = n.saturating_sub(1).max(1) as f32;
    let mut points = Vec::with_capacity(n * placements.len());
    let mut radii = Vec::with_capacity(n * placements.len());
    for placement in placements {
        let first = points.len();
        for i in 0..n {
            let t = i as f32 / last;
            // The third weight is what is left, so that rounding cannot break the sum.
            let [a, b, _] =
                std::array::from_fn(|k| placement.root[k] * (1.0 - t) + placement.tip[k] * t);
            let weights = [a, b, 1.0 - a - b];
            points.push(guides.position(placement.guides, weights, i).to_array());
            radii.push(guides.radius(placement.guides, weights, i).max(0.0));
        }
        lead_astray(&mut points[first..], placement.stray);
    }
    (points, radii)
}

/// The root's and tip's weights of the strand with number `strand` in its triangle.
fn place(guides: [u32; 3], strand: u32, settings: &InterpolationSettings) -> Placement {
    let mut draws = Draws::new(strand, settings.seed);
    let root = draws.barycentrics();
    Placement {
        guides,
        root,
        tip: nearest_first(root, draws.corner_barycentrics(1.0 - settings.clump)),
        stray: stray(&mut draws, &settings.stray),
    }
}

/// Gives the first of `weights` to the guide with the largest root weight: the one whose root is nearest.
pub(crate) fn nearest_first(root: [f32; 3], weights: [f32; 3]) -> [f32; 3] {
    let nearest = if root[0] >= root[1] && root[0] >= root[2] {
        0
    } else if root[1] >= root[2] {
        1
    } else {
        2
    };
    std::array::from_fn(|k| weights[(k + 3 - nearest) % 3])
}

/// The tip's displacement over the strand's length; zero for a strand that does not stray.
pub(crate) fn stray(draws: &mut Draws, stray: &Stray) -> Vec3 {
    let strays = draws.uniform() < stray.fraction;
    let (direction, amount) = (draws.direction(), draws.uniform());
    if strays {
        direction * amount * stray.strength
    } else {
        Vec3::ZERO
    }
}

/// Displaces a strand's points by `stray` × its length, growing with the square of the way from the root.
fn lead_astray(points: &mut [[f32; 3]], stray: Vec3) {
    if stray == Vec3::ZERO {
        return;
    }
    let length: f32 = points
        .windows(2)
        .map(|pair| Vec3::from(pair[0]).distance(Vec3::from(pair[1])))
        .sum();
    let last = (points.len() - 1).max(1) as f32;
    for (i, point) in points.iter_mut().enumerate() {
        let u = i as f32 / last;
        *point = (Vec3::from(*point) + stray * (length * u * u)).to_array();
    }
}

/// Two unit vectors perpendicular to the strand at every point, carried along it by the smallest turns.
fn transported_frames(points: &[[f32; 3]]) -> Vec<[Vec3; 2]> {
    let mut tangent = Vec3::Y;
    let mut normal = Vec3::X;
    let mut frames = Vec::with_capacity(points.len());
    for i in 0..points.len() {
        let (before, after) = (
            points[i.saturating_sub(1)],
            points[(i + 1).min(points.len() - 1)],
        );
        // Where points coincide the last tangent holds.
        tangent = (Vec3::from(after) - Vec3::from(before))
            .try_normalize()
            .unwrap_or(tangent);
        let flat = normal - tangent * normal.dot(tangent);
        normal = flat
            .try_normalize()
            .unwrap_or_else(|| tangent.any_orthonormal_vector());
        frames.push([normal, tangent.cross(normal)]);
    }
    frames
}

/// Appends one follower of `guide`.
fn follow(
    guides: &Strands,
    guide: usize,
    frames: &[[Vec3; 2]],
    follower: &Follower,
    settings: &ClumpSettings,
    points: &mut Vec<[f32; 3]>,
) {
    let first = points.len();
    for (at, [x, y]) in guides.range(guide).zip(frames) {
        let spread = 1.0 + (settings.tip_factor - 1.0) * guides.coordinates()[at];
        let offset = (*x * follower.cos + *y * follower.sin) * (follower.distance * spread);
        points.push((Vec3::from(guides.points()[at]) + offset).to_array());
    }
    lead_astray(&mut points[first..], follower.stray);
}

fn check_settings(settings: &InterpolationSettings) -> Result<()> {
    check_not_negative("density", settings.density)?;
    check_fraction("clump", settings.clump)?;
    check_stray(&settings.stray)
}

fn check_stray(stray: &Stray) -> Result<()> {
    check_fraction("stray.fraction", stray.fraction)?;
    check_not_negative("stray.strength", stray.strength)
}

fn check_fraction(name: &str, value: f32) -> Result<()> {
    if !(0.0..=1.0).contains(&value) {
        return invalid!("{name} {value} is not between 0 and 1");
    }
    Ok(())
}

fn check_not_negative(name: &str, value: f32) -> Result<()> {
    if !(value.is_finite() && value >= 0.0) {
        return invalid!("{name} {value} is not a finite number of at least 0");
    }
    Ok(())
}

/// Refuses a density that makes more strands or points than there may be, before any is made.
fn check_total(expected: f64, guides: &Strands, density: f32) -> Result<()> {
    let longest = (0..guides.strand_count())
        .map(|guide| guides.range(guide).len())
        .max()
        .unwrap_or(0);
    let fits = expected <= MAX_INTERPOLATED_STRANDS as f64
        && expected * longest as f64 <= MAX_POINTS as f64;
    if !fits {
        return invalid!(
            "density {density} makes {expected:.0} strands of {longest} points: at most {MAX_INTERPOLATED_STRANDS}              strands and {MAX_POINTS} points are made"
        );
    }
    Ok(())
}
