//! The scene's hair: files and built-in grooms joined into one groom, with the radius that the scene asks for.

use std::path::Path;

use pelage::glam::DVec3;
use pelage::groom::{BuiltinGroom, Curve, Strands, builtin, formats, tessellate};

use super::scene::{HairSource, Result, Scene};

/// A tip's radius over the root's where a file has no radius of its own.
const TIP_TAPER: f32 = 0.5;
/// Straight pieces of a spline's segment where splines and polylines are joined.
const CURVE_PIECES: u32 = 4;

/// Strands of one source.
struct Part {
    strands: Strands,
    /// Whether the radii are its own rather than a guess.
    has_radius: bool,
    /// Whether it looks towards -z.
    is_turned: bool,
}

/// A scene's hair as one groom.
#[derive(Debug, Clone, PartialEq)]
pub struct Groom {
    /// All strands.
    pub strands: Strands,
    /// Towards whom it looks: +z, but -z for TressFX 3, whose files stem from left-handed tools.
    pub front: DVec3,
}

/// Loads and joins all of a scene's hair.
pub fn load(scene: &Scene) -> Result<Groom> {
    let parts: Vec<Part> = scene.hair.iter().map(part).collect::<Result<_>>()?;
    let turned = parts.iter().all(|part| part.is_turned);
    let front = if turned { DVec3::NEG_Z } else { DVec3::Z };
    let strands = join_with_radii(parts, scene.fibre.radius)?;
    Ok(Groom { strands, front })
}

/// Joins, and sets the radius where one is asked for, or one that fits where a part has none.
fn join_with_radii(parts: Vec<Part>, radius: Option<f32>) -> Result<Strands> {
    let guess = parts.iter().any(|part| !part.has_radius);
    let owned: Vec<bool> = parts
        .iter()
        .flat_map(|part| std::iter::repeat_n(part.has_radius, part.strands.points().len()))
        .collect();
    let strands = join(parts.into_iter().map(|part| part.strands).collect())?;
    if let Some(radius) = radius {
        return strands
            .with_root_tip_radii(radius, radius)
            .map_err(|_| format!("fibre.radius {radius} is not a finite number of at least 0"));
    }
    if !guess {
        return Ok(strands);
    }
    // The groom's size as a whole decides, not that of each of its files.
    let root = strands.fitting_radius();
    let taper = |at: usize| root * (1.0 + (TIP_TAPER - 1.0) * strands.coordinates()[at]);
    let radii = (0..owned.len())
        .map(|at| {
            if owned[at] {
                strands.radii()[at]
            } else {
                taper(at)
            }
        })
        .collect();
    strands
        .with_point_radii(radii)
        .map_err(|error| error.to_string())
}

/// Whether a scene's hair comes with the built-in head.
pub fn has_builtin_head(scene: &Scene) -> bool {
    scene
        .hair
        .iter()
        .any(|source| matches!(source, HairSource::Builtin(_)))
}

/// The scene file's name of a source.
pub fn name(source: &HairSource) -> String {
    match source {
        HairSource::File(path) => path.display().to_string(),
        HairSource::Builtin(BuiltinGroom::Straight) => "builtin:straight".into(),
        HairSource::Builtin(BuiltinGroom::Wavy) => "builtin:wavy".into(),
        HairSource::Builtin(BuiltinGroom::Curly) => "builtin:curly".into(),
        HairSource::Builtin(groom) => format!("{groom:?}"),
    }
}

fn part(source: &HairSource) -> Result<Part> {
    match source {
        HairSource::Builtin(groom) => builtin(*groom, BuiltinGroom::DEFAULT_STRAND_COUNT)
            .map(|strands| Part {
                strands,
                has_radius: true,
                is_turned: false,
            })
            .map_err(|error| error.to_string()),
        HairSource::File(path) => file(path),
    }
}

fn file(path: &Path) -> Result<Part> {
    let name = path.display();
    let bytes = std::fs::read(path).map_err(|error| format!("{name} cannot be read: {error}"))?;
    let strands = formats::read(&bytes).map_err(|error| format!("{name}: {error}"))?;
    // TressFX holds no radius; HAIR may hold zeros.
    let has_radius =
        bytes.starts_with(b"HAIR") && strands.radii().iter().any(|radius| *radius > 0.0);
    let is_turned = !bytes.starts_with(b"HAIR")
        && bytes
            .first_chunk()
            .is_some_and(|version| f32::from_le_bytes(*version) < 4.0);
    Ok(Part {
        strands,
        has_radius,
        is_turned,
    })
}

/// Puts grooms one after the other.
fn join(mut grooms: Vec<Strands>) -> Result<Strands> {
    if grooms.len() == 1 {
        return Ok(grooms.remove(0));
    }
    let curve = grooms.first().map_or(Curve::Polyline, Strands::curve);
    if grooms.iter().any(|groom| groom.curve() != curve) {
        for groom in &mut grooms {
            if groom.curve() != Curve::Polyline {
                *groom = tessellate(groom, CURVE_PIECES).map_err(|error| error.to_string())?;
            }
        }
    }
    let curve = grooms.first().map_or(Curve::Polyline, Strands::curve);
    let counts: Vec<u32> = grooms
        .iter()
        .flat_map(|groom| groom.offsets().windows(2).map(|span| span[1] - span[0]))
        .collect();
    let points = grooms
        .iter()
        .flat_map(|groom| groom.points().iter().copied())
        .collect();
    Strands::new(points, &counts, 0.0)
        .and_then(|all| {
            all.with_point_radii(
                grooms
                    .iter()
                    .flat_map(|g| g.radii().iter().copied())
                    .collect(),
            )
        })
        .and_then(|all| {
            all.with_colours(
                grooms
                    .iter()
                    .flat_map(|g| g.colours().iter().copied())
                    .collect(),
            )
        })
        .and_then(|all| {
            all.with_coordinates(
                grooms
                    .iter()
                    .flat_map(|g| g.coordinates().iter().copied())
                    .collect(),
            )
        })
        .map(|all| all.with_curve(curve))
        .map_err(|error| error.to_string())
}
