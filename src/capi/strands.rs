//! Strands from a host's arrays, and few strands to many.

use super::descriptor::{self, descriptor};
use super::input::{optional_slice, reserved, slice};
use crate::error::{Result, invalid};
use crate::groom::{
    ClumpSettings, Curve, Guides, InterpolationSettings, MAX_POINTS, Strands, Stray,
};

/// Straight segments between the points.
pub const PELAGE_CURVE_POLYLINE: u32 = 0;
/// A uniform Catmull-Rom spline through every point.
pub const PELAGE_CURVE_CATMULL_ROM: u32 = 1;

/// The most points of all strands together.
pub const PELAGE_MAX_POINTS: u64 = 1 << 28;

const _: () = assert!(PELAGE_MAX_POINTS == MAX_POINTS as u64);

/// Strands as arrays, which are copied. Lengths are in the host's units, in the groom's own space.
///
/// A strand has at least one point, its root first; one of a single point is kept and draws nothing. There may be no
/// strands at all.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageStrands {
    /// `sizeof(PelageStrands)`.
    pub struct_size: u32,
    /// `PELAGE_CURVE_…`: how the points make a curve.
    pub curve: u32,
    /// Three floats a point, strand after strand; finite.
    pub positions: *const f32,
    /// The number of points, at most `PELAGE_MAX_POINTS`.
    pub point_count: u64,
    /// Points of each strand, at least 1; they sum to `point_count`.
    pub counts: *const u32,
    /// The number of strands.
    pub strand_count: u64,
    /// One radius a point, finite and at least 0; NULL: from `root_radius` to `tip_radius`.
    pub radii: *const f32,
    /// Three floats a strand, linear RGB factors, finite and at least 0; NULL: white.
    pub colours: *const f32,
    /// One coordinate a point, from 0 at the root to 1 at the tip, not falling along a strand; NULL: by arc length.
    pub coordinates: *const f32,
    /// Radius at the root, at least 0; read where `radii` is NULL.
    pub root_radius: f32,
    /// Radius at the tip, at least 0; read where `radii` is NULL. Runs linearly in the coordinate.
    pub tip_radius: f32,
}

impl Default for PelageStrands {
    fn default() -> Self {
        use std::ptr::null;
        Self {
            struct_size: size_of::<Self>() as u32,
            curve: PELAGE_CURVE_POLYLINE,
            positions: null(),
            point_count: 0,
            counts: null(),
            strand_count: 0,
            radii: null(),
            colours: null(),
            coordinates: null(),
            root_radius: 0.0,
            tip_radius: 0.0,
        }
    }
}

descriptor!(PelageStrands, "PELAGE_STRANDS_INIT", tip_radius: f32);

/// How the triangles between guides are filled.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageInterpolationSettings {
    /// `sizeof(PelageInterpolationSettings)`.
    pub struct_size: u32,
    /// Another seed, another groom of the same kind.
    pub seed: u32,
    /// Three guide numbers a triangle: the mesh whose vertices are the guides' roots.
    pub triangles: *const u32,
    /// The number of triangles.
    pub triangle_count: u64,
    /// Strands per unit of area, in host units; at least 0. A scalp has 200 to 300 a square centimetre.
    pub density: f32,
    /// How closely tips gather at the nearest guide: 0 spreads them over the triangle, 1 puts them on the guide.
    pub clump: f32,
    /// The fraction of the strands that leave their clump, 0 to 1.
    pub stray_fraction: f32,
    /// How far a stray's tip is displaced at most, as a fraction of the strand's length; at least 0.
    pub stray_strength: f32,
}

impl Default for PelageInterpolationSettings {
    fn default() -> Self {
        let settings = InterpolationSettings::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            seed: settings.seed,
            triangles: std::ptr::null(),
            triangle_count: 0,
            density: settings.density,
            clump: settings.clump,
            stray_fraction: settings.stray.fraction,
            stray_strength: settings.stray.strength,
        }
    }
}

descriptor!(PelageInterpolationSettings, "PELAGE_INTERPOLATION_SETTINGS_INIT", stray_strength: f32);

/// How each guide is surrounded by followers.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageClumpSettings {
    /// `sizeof(PelageClumpSettings)`.
    pub struct_size: u32,
    /// Another seed, another groom of the same kind.
    pub seed: u32,
    /// Strands that are added to each guide.
    pub followers: u32,
    /// Radius of the disc in which the followers' roots lie, in host units; at least 0.
    pub root_radius: f32,
    /// The disc's radius at the tip over that at the root; at least 0.
    pub tip_factor: f32,
    /// The fraction of the strands that leave their clump, 0 to 1.
    pub stray_fraction: f32,
    /// How far a stray's tip is displaced at most, as a fraction of the strand's length; at least 0.
    pub stray_strength: f32,
    /// 0.
    pub reserved: u32,
}

impl Default for PelageClumpSettings {
    fn default() -> Self {
        let settings = ClumpSettings::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            seed: settings.seed,
            followers: settings.followers,
            root_radius: settings.root_radius,
            tip_factor: settings.tip_factor,
            stray_fraction: settings.stray.fraction,
            stray_strength: settings.stray.strength,
            reserved: 0,
        }
    }
}

descriptor!(PelageClumpSettings, "PELAGE_CLUMP_SETTINGS_INIT", reserved: u32);

pub(super) fn curve(value: u32) -> Result<Curve> {
    match value {
        PELAGE_CURVE_POLYLINE => Ok(Curve::Polyline),
        PELAGE_CURVE_CATMULL_ROM => Ok(Curve::CatmullRom),
        _ => invalid!("curve {value} is not one of PELAGE_CURVE_…"),
    }
}

/// Validated strands from a host's arrays.
pub(super) unsafe fn read_strands(name: &str, pointer: *const PelageStrands) -> Result<Strands> {
    // SAFETY: the rule of the module `capi`.
    let given = unsafe { descriptor::read(name, pointer) }?;
    let curve = curve(given.curve)?;
    let points = given.point_count as usize;
    // SAFETY: the rule of the module `capi`. Both counts are checked against the most before any other array is looked at.
    let (positions, counts) = unsafe {
        (
            slice(
                "positions",
                given.positions.cast::<[f32; 3]>(),
                given.point_count,
                MAX_POINTS,
            )?,
            slice("counts", given.counts, given.strand_count, MAX_POINTS)?,
        )
    };
    let mut strands = Strands::new(positions.to_vec(), counts, 0.0)?;
    // SAFETY: the rule of the module `capi`.
    let (radii, colours, coordinates) = unsafe {
        (
            optional_slice("radii", given.radii, points)?,
            optional_slice("colours", given.colours.cast::<[f32; 3]>(), counts.len())?,
            optional_slice("coordinates", given.coordinates, points)?,
        )
    };
    if let Some(coordinates) = coordinates {
        strands = strands.with_coordinates(coordinates.to_vec())?;
    }
    if let Some(colours) = colours {
        strands = strands.with_colours(colours.to_vec())?;
    }
    with_radii(strands, radii, given.root_radius, given.tip_radius)
        .map(|strands| strands.with_curve(curve))
}

fn with_radii(strands: Strands, radii: Option<&[f32]>, root: f32, tip: f32) -> Result<Strands> {
    if let Some(radii) = radii {
        return strands.with_point_radii(radii.to_vec());
    }
    check_radius("root_radius", root)?;
    check_radius("tip_radius", tip)?;
    strands.with_root_tip_radii(root, tip)
}

pub(super) fn check_radius(name: &str, radius: f32) -> Result<()> {
    if !(radius.is_finite() && radius >= 0.0) {
        return invalid!("{name} {radius} is not a finite number of at least 0");
    }
    Ok(())
}

/// Guides on a mesh, and how to fill its triangles.
pub(super) unsafe fn mesh_input(
    guides: *const PelageStrands,
    settings: *const PelageInterpolationSettings,
) -> Result<(Guides, InterpolationSettings)> {
    // SAFETY: the rule of the module `capi`.
    let (strands, given) = unsafe {
        (
            read_strands("guides", guides)?,
            descriptor::read("settings", settings)?,
        )
    };
    // SAFETY: the rule of the module `capi`.
    let triangles = unsafe {
        slice(
            "triangles",
            given.triangles.cast::<[u32; 3]>(),
            given.triangle_count,
            MAX_POINTS,
        )
    }?;
    let settings = InterpolationSettings {
        density: given.density,
        clump: given.clump,
        stray: Stray {
            fraction: given.stray_fraction,
            strength: given.stray_strength,
        },
        seed: given.seed,
    };
    Ok((Guides::on_mesh(strands, triangles.to_vec())?, settings))
}

/// Guides, and how to surround each.
pub(super) unsafe fn clump_input(
    guides: *const PelageStrands,
    settings: *const PelageClumpSettings,
) -> Result<(Strands, ClumpSettings)> {
    // SAFETY: the rule of the module `capi`.
    let (strands, given) = unsafe {
        (
            read_strands("guides", guides)?,
            descriptor::read("settings", settings)?,
        )
    };
    reserved("PelageClumpSettings", given.reserved)?;
    let settings = ClumpSettings {
        followers: given.followers,
        root_radius: given.root_radius,
        tip_factor: given.tip_factor,
        stray: Stray {
            fraction: given.stray_fraction,
            strength: given.stray_strength,
        },
        seed: given.seed,
    };
    Ok((strands, settings))
}
