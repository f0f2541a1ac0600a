//! A shading model with its settings.

use std::ptr::null;

use super::{settings, switch};
use crate::capi::descriptor::{self, descriptor};
use crate::capi::error::{PelageResult, guard};
use crate::capi::input::{fill, outputs, reserved, slice};
use crate::error::{Result, invalid};
use crate::shading::{
    CausticRemoval, Chiang, DualScattering, HairColour, Highlight, KajiyaKay, LobeControls,
    Marschner, Precision, Roots, RoughnessVariation, Sadeghi, Scheuermann, Shading, ShadingRate,
    Tables, sigma_a_from_melanin, sigma_a_from_reflectance,
};
use glam::Vec3;

/// Kajiya and Kay 1989.
pub const PELAGE_SHADING_KAJIYA_KAY: u32 = 0;
/// Scheuermann 2004: Kajiya-Kay with two highlights.
pub const PELAGE_SHADING_SCHEUERMANN: u32 = 1;
/// Marschner et al. 2003.
pub const PELAGE_SHADING_MARSCHNER: u32 = 2;
/// Sadeghi et al. 2010.
pub const PELAGE_SHADING_SADEGHI: u32 = 3;
/// Chiang et al. 2016, d'Eon et al. 2011.
pub const PELAGE_SHADING_CHIANG: u32 = 4;

/// At strand points, once a view; a fragment's colour is interpolated along its segment.
pub const PELAGE_SHADING_RATE_POINT: u32 = 0;
/// At each fragment that the transparency technique keeps, at its own position. Refused with weighted blended, depth peeling,
/// random subsets, sorted blending, the single-pass k-buffer, moments, and the k+-buffer with `PELAGE_REST_MERGED`, which need
/// colours before they know what they keep.
pub const PELAGE_SHADING_RATE_FRAGMENT: u32 = 1;

/// Of the exact exit angle.
pub const PELAGE_ROOTS_EXACT: u32 = 0;
/// Of its fit by a cubic polynomial.
pub const PELAGE_ROOTS_CUBIC: u32 = 1;

/// 16-bit floats.
pub const PELAGE_PRECISION_F16: u32 = 0;
/// 32-bit floats.
pub const PELAGE_PRECISION_F32: u32 = 1;

/// Black hair.
pub const PELAGE_HAIR_COLOUR_BLACK: u32 = 0;
/// Brown hair.
pub const PELAGE_HAIR_COLOUR_BROWN: u32 = 1;
/// Blond hair.
pub const PELAGE_HAIR_COLOUR_BLOND: u32 = 2;
/// Red hair.
pub const PELAGE_HAIR_COLOUR_RED: u32 = 3;
/// Grey hair.
pub const PELAGE_HAIR_COLOUR_GREY: u32 = 4;
/// White hair.
pub const PELAGE_HAIR_COLOUR_WHITE: u32 = 5;
/// Dyed hair, blue.
pub const PELAGE_HAIR_COLOUR_DYED: u32 = 6;

/// Kajiya and Kay's diffuse and specular lobes.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageKajiyaKay {
    /// `sizeof(PelageKajiyaKay)`.
    pub struct_size: u32,
    /// Diffuse coefficient, linear RGB, at least 0; multiplies each strand's own colour. About 1/pi for a light fibre.
    pub diffuse: [f32; 3],
    /// Specular coefficient, linear RGB, at least 0.
    pub specular: [f32; 3],
    /// The specular lobe's exponent, from 1 to 100000.
    pub exponent: f32,
}

impl Default for PelageKajiyaKay {
    fn default() -> Self {
        let KajiyaKay {
            diffuse,
            specular,
            exponent,
        } = KajiyaKay::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            diffuse: diffuse.into(),
            specular: specular.into(),
            exponent,
        }
    }
}

descriptor!(PelageKajiyaKay, "PELAGE_KAJIYA_KAY_INIT", exponent: f32);

/// One highlight of Scheuermann's model.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageHighlight {
    /// Coefficient, linear RGB, from 0 to 1e6.
    pub colour: [f32; 3],
    /// Exponent, from 1 to 100000.
    pub exponent: f32,
    /// The tangent is turned by atan(shift) towards the eye, from -10 to 10. Positive moves the highlight to the root.
    pub shift: f32,
}

impl PelageHighlight {
    fn of(highlight: Highlight) -> Self {
        Self {
            colour: highlight.colour.into(),
            exponent: highlight.exponent,
            shift: highlight.shift,
        }
    }

    fn highlight(&self) -> Highlight {
        Highlight {
            colour: self.colour.into(),
            exponent: self.exponent,
            shift: self.shift,
        }
    }
}

/// Scheuermann 2004: Kajiya-Kay with two highlights.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageScheuermann {
    /// `sizeof(PelageScheuermann)`.
    pub struct_size: u32,
    /// Diffuse coefficient, linear RGB, from 0 to 1e6; multiplies each strand's own colour.
    pub diffuse: [f32; 3],
    /// The first highlight, of the light's colour.
    pub primary: PelageHighlight,
    /// The second; multiplies each strand's own colour.
    pub secondary: PelageHighlight,
}

impl Default for PelageScheuermann {
    fn default() -> Self {
        let model = Scheuermann::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            diffuse: model.diffuse.into(),
            primary: PelageHighlight::of(model.primary),
            secondary: PelageHighlight::of(model.secondary),
        }
    }
}

descriptor!(PelageScheuermann, "PELAGE_SCHEUERMANN_INIT", secondary: PelageHighlight);

/// Marschner et al. 2003.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageMarschner {
    /// `sizeof(PelageMarschner)`.
    pub struct_size: u32,
    /// Index of refraction, from 1.01 to 3.
    pub eta: f32,
    /// Absorption per fibre radius, linear RGB, from 0 to 1e6.
    pub sigma_a: [f32; 3],
    /// Shifts of R, TT and TRT in terms of half the sum of both inclinations, radians, -pi/2 to pi/2; negative is towards
    /// the root.
    pub alpha: [f32; 3],
    /// Widths of R, TT and TRT in the same terms, radians, from 1e-5 to 10.
    pub beta: [f32; 3],
    /// One axis of the section over the other, from 0.75 to 1.33.
    pub eccentricity: f32,
    /// `PELAGE_ROOTS_…`.
    pub roots: u32,
    /// 0: the caustic stays; 1: it is taken out, and glints are put in its place.
    pub remove_caustic: u32,
    /// Azimuthal width of the glints, radians, from 1e-5 to 10.
    pub caustic_width: f32,
    /// Scale of the glints, from 0 to 100; 0.5 keeps the energy.
    pub caustic_scale: f32,
    /// Range of the index above 2 in which the glints fade, from 1e-5 to 10.
    pub caustic_fade: f32,
    /// Limit of the caustic's width across the fibre, from 0 to 1.
    pub caustic_limit: f32,
    /// What a crossing transmits further at the tip, linear RGB, from 0 to 1.
    pub tip_colour: [f32; 3],
    /// Rows and columns of the tables, from 32 to 512; 0: no tables.
    pub table_size: u32,
    /// `PELAGE_PRECISION_…`.
    pub table_precision: u32,
    /// 0: single scattering; 1: with dual scattering.
    pub dual_scattering: u32,
    /// Density of hair before the shaded fibre, from 0 to 1.
    pub forward_density: f32,
    /// Density of hair around it, from 0 to 1.
    pub backward_density: f32,
    /// Each strand's roughness lies between 1 - this and 1 + this times the model's, from 0 to 0.9.
    pub roughness_strand: f32,
    /// The tip's roughness over the root's, from 0.1 to 10.
    pub roughness_tip: f32,
    /// Radiance by which no fibre may change where the TT lobe is left out, from 0, never, to 1e6.
    pub lobe_tolerance: f32,
    /// How much its fibres lie in other directions, from 0, combed hair, to 1.
    pub disorder: f32,
}

impl Default for PelageMarschner {
    fn default() -> Self {
        let model = Marschner::default();
        let caustic = model.caustic.unwrap_or_default();
        let (table_size, table_precision) = table_words(model.tables);
        let dual = DualScattering::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            eta: model.eta,
            sigma_a: model.sigma_a.into(),
            alpha: model.alpha,
            beta: model.beta,
            eccentricity: model.eccentricity,
            roots: PELAGE_ROOTS_EXACT,
            remove_caustic: 1,
            caustic_width: caustic.w_c,
            caustic_scale: caustic.k_g,
            caustic_fade: caustic.delta_eta,
            caustic_limit: caustic.delta_h_max,
            tip_colour: model.tip_colour.into(),
            table_size,
            table_precision,
            dual_scattering: 0,
            forward_density: dual.forward,
            backward_density: dual.backward,
            roughness_strand: model.roughness.strand,
            roughness_tip: model.roughness.tip,
            lobe_tolerance: model.lobe_tolerance,
            disorder: dual.disorder,
        }
    }
}

descriptor!(PelageMarschner, "PELAGE_MARSCHNER_INIT", disorder: f32);

/// One lobe of Sadeghi's model.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageLobe {
    /// Linear RGB, from 0 to 1e6.
    pub colour: [f32; 3],
    /// From 0 to 1e6.
    pub intensity: f32,
    /// Shift in terms of half the sum of both inclinations, radians, -pi/2 to pi/2; negative is towards the root.
    pub shift: f32,
    /// Width in the same terms, radians, from 1e-5 to 10.
    pub width: f32,
}

impl PelageLobe {
    fn of(lobe: LobeControls) -> Self {
        Self {
            colour: lobe.colour.into(),
            intensity: lobe.intensity,
            shift: lobe.shift,
            width: lobe.width,
        }
    }

    fn controls(&self) -> LobeControls {
        LobeControls {
            colour: self.colour.into(),
            intensity: self.intensity,
            shift: self.shift,
            width: self.width,
        }
    }
}

/// Sadeghi et al. 2010.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageSadeghi {
    /// `sizeof(PelageSadeghi)`.
    pub struct_size: u32,
    /// Primary highlight.
    pub r: PelageLobe,
    /// Forward lobe.
    pub tt: PelageLobe,
    /// Secondary highlight, with the glints.
    pub trt: PelageLobe,
    /// Azimuthal width of the forward lobe, radians, from 1e-5 to 10.
    pub tt_azimuthal_width: f32,
    /// Intensity of the glints relative to the secondary highlight, from 0 to 1e6.
    pub glint_intensity: f32,
    /// Azimuthal width of the glints, radians, from 1e-5 to 10.
    pub glint_width: f32,
    /// Range of half the angle between a strand's two glints, radians, from 0 to pi.
    pub glint_angle: [f32; 2],
    /// 1: divided by the part of the light that is scattered where that is above 1; 0: as published.
    pub normalised: u32,
    /// What a crossing transmits further at the tip, linear RGB, from 0 to 1.
    pub tip_colour: [f32; 3],
    /// 0: single scattering; 1: with dual scattering.
    pub dual_scattering: u32,
    /// Density of hair before the shaded fibre, from 0 to 1.
    pub forward_density: f32,
    /// Density of hair around it, from 0 to 1.
    pub backward_density: f32,
    /// Each strand's roughness lies between 1 - this and 1 + this times the model's, from 0 to 0.9.
    pub roughness_strand: f32,
    /// The tip's roughness over the root's, from 0.1 to 10.
    pub roughness_tip: f32,
    /// Radiance by which no fibre may change where the TT lobe is left out, from 0, never, to 1e6.
    pub lobe_tolerance: f32,
    /// How much its fibres lie in other directions, from 0, combed hair, to 1.
    pub disorder: f32,
}

impl Default for PelageSadeghi {
    fn default() -> Self {
        let model = Sadeghi::default();
        let dual = DualScattering::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            r: PelageLobe::of(model.r),
            tt: PelageLobe::of(model.tt),
            trt: PelageLobe::of(model.trt),
            tt_azimuthal_width: model.tt_azimuthal_width,
            glint_intensity: model.glint_intensity,
            glint_width: model.glint_width,
            glint_angle: model.glint_angle,
            normalised: u32::from(model.normalised),
            tip_colour: model.tip_colour.into(),
            dual_scattering: 0,
            forward_density: dual.forward,
            backward_density: dual.backward,
            roughness_strand: model.roughness.strand,
            roughness_tip: model.roughness.tip,
            lobe_tolerance: model.lobe_tolerance,
            disorder: dual.disorder,
        }
    }
}

descriptor!(PelageSadeghi, "PELAGE_SADEGHI_INIT", disorder: f32);

/// Chiang et al. 2016, d'Eon et al. 2011.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageChiang {
    /// `sizeof(PelageChiang)`.
    pub struct_size: u32,
    /// Longitudinal roughness, from 0.001 to 1.
    pub beta_m: f32,
    /// Azimuthal roughness, from 0.001 to 1.
    pub beta_n: f32,
    /// Tilt of the cuticle's scales, radians, -pi/2 to pi/2; positive moves the first highlight towards the root.
    pub alpha: f32,
    /// Index of refraction, from 1.01 to 3.
    pub eta: f32,
    /// Absorption per fibre radius, linear RGB, from 0 to 1e6. See `pelage_sigma_a_from_melanin`.
    pub sigma_a: [f32; 3],
    /// What a crossing transmits further at the tip, linear RGB, from 0 to 1.
    pub tip_colour: [f32; 3],
    /// Intervals of the integral across the fibre where there are no tables, from 8 to 256.
    pub intervals: u32,
    /// Rows and columns of the tables, from 32 to 512; 0: no tables.
    pub table_size: u32,
    /// `PELAGE_PRECISION_…`.
    pub table_precision: u32,
    /// 0: single scattering; 1: with dual scattering.
    pub dual_scattering: u32,
    /// Density of hair before the shaded fibre, from 0 to 1.
    pub forward_density: f32,
    /// Density of hair around it, from 0 to 1.
    pub backward_density: f32,
    /// Each strand's roughness lies between 1 - this and 1 + this times the model's, from 0 to 0.9.
    pub roughness_strand: f32,
    /// The tip's roughness over the root's, from 0.1 to 10.
    pub roughness_tip: f32,
    /// Radiance by which no fibre may change where the TT lobe is left out, from 0, never, to 1e6.
    pub lobe_tolerance: f32,
    /// 1: fibres wider than a pixel are shaded by where the pixel lies across them, at `PELAGE_SHADING_RATE_FRAGMENT`; 0: all by
    /// the mean over their width.
    pub near_field: u32,
    /// How much its fibres lie in other directions, from 0, combed hair, to 1.
    pub disorder: f32,
}

impl Default for PelageChiang {
    fn default() -> Self {
        let model = Chiang::default();
        let (table_size, table_precision) = table_words(model.tables);
        let dual = DualScattering::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            beta_m: model.beta_m,
            beta_n: model.beta_n,
            alpha: model.alpha,
            eta: model.eta,
            sigma_a: model.sigma_a.into(),
            tip_colour: model.tip_colour.into(),
            intervals: model.intervals,
            table_size,
            table_precision,
            dual_scattering: 0,
            forward_density: dual.forward,
            backward_density: dual.backward,
            roughness_strand: model.roughness.strand,
            roughness_tip: model.roughness.tip,
            lobe_tolerance: model.lobe_tolerance,
            near_field: u32::from(model.near_field),
            disorder: dual.disorder,
        }
    }
}

descriptor!(PelageChiang, "PELAGE_CHIANG_INIT", disorder: f32);

/// A shading model with its parameters.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageShading {
    /// `sizeof(PelageShading)`.
    pub struct_size: u32,
    /// `PELAGE_SHADING_…`.
    pub model: u32,
    /// For `PELAGE_SHADING_KAJIYA_KAY`; NULL: as `PELAGE_KAJIYA_KAY_INIT`.
    pub kajiya_kay: *const PelageKajiyaKay,
    /// For `PELAGE_SHADING_SCHEUERMANN`; NULL: as `PELAGE_SCHEUERMANN_INIT`.
    pub scheuermann: *const PelageScheuermann,
    /// For `PELAGE_SHADING_MARSCHNER`; NULL: as `PELAGE_MARSCHNER_INIT`.
    pub marschner: *const PelageMarschner,
    /// For `PELAGE_SHADING_SADEGHI`; NULL: as `PELAGE_SADEGHI_INIT`.
    pub sadeghi: *const PelageSadeghi,
    /// For `PELAGE_SHADING_CHIANG`; NULL: as `PELAGE_CHIANG_INIT`.
    pub chiang: *const PelageChiang,
    /// `PELAGE_SHADING_RATE_…`; the same for all hairs of a frame.
    pub rate: u32,
    /// 0.
    pub reserved: u32,
}

impl Default for PelageShading {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            model: PELAGE_SHADING_KAJIYA_KAY,
            kajiya_kay: null(),
            scheuermann: null(),
            marschner: null(),
            sadeghi: null(),
            chiang: null(),
            rate: PELAGE_SHADING_RATE_POINT,
            reserved: 0,
        }
    }
}

descriptor!(PelageShading, "PELAGE_SHADING_INIT", reserved: u32);

/// Size and precision of tables as C has them.
fn table_words(tables: Option<Tables>) -> (u32, u32) {
    let precision = match tables.map(|tables| tables.precision) {
        Some(Precision::F32) => PELAGE_PRECISION_F32,
        _ => PELAGE_PRECISION_F16,
    };
    (tables.map_or(0, |tables| tables.size), precision)
}

fn tables(size: u32, precision: u32) -> Result<Option<Tables>> {
    let precision = match precision {
        PELAGE_PRECISION_F16 => Precision::F16,
        PELAGE_PRECISION_F32 => Precision::F32,
        _ => {
            return invalid!("table_precision {precision} is not one of PELAGE_PRECISION_…");
        }
    };
    Ok((size > 0).then_some(Tables { size, precision }))
}

fn dual_scattering(on: u32, dual: DualScattering) -> Result<Option<DualScattering>> {
    Ok(switch("dual_scattering", on)?.then_some(dual))
}

fn marschner(given: &PelageMarschner) -> Result<Marschner> {
    Ok(Marschner {
        eta: given.eta,
        sigma_a: given.sigma_a.into(),
        alpha: given.alpha,
        beta: given.beta,
        eccentricity: given.eccentricity,
        roots: match given.roots {
            PELAGE_ROOTS_EXACT => Roots::Exact,
            PELAGE_ROOTS_CUBIC => Roots::Cubic,
            unknown => return invalid!("roots {unknown} is not one of PELAGE_ROOTS_…"),
        },
        caustic: switch("remove_caustic", given.remove_caustic)?.then_some(CausticRemoval {
            w_c: given.caustic_width,
            k_g: given.caustic_scale,
            delta_eta: given.caustic_fade,
            delta_h_max: given.caustic_limit,
        }),
        tip_colour: given.tip_colour.into(),
        tables: tables(given.table_size, given.table_precision)?,
        dual_scattering: dual_scattering(
            given.dual_scattering,
            DualScattering {
                forward: given.forward_density,
                backward: given.backward_density,
                disorder: given.disorder,
            },
        )?,
        roughness: RoughnessVariation {
            strand: given.roughness_strand,
            tip: given.roughness_tip,
        },
        lobe_tolerance: given.lobe_tolerance,
    })
}

fn sadeghi(given: &PelageSadeghi) -> Result<Sadeghi> {
    Ok(Sadeghi {
        r: given.r.controls(),
        tt: given.tt.controls(),
        trt: given.trt.controls(),
        tt_azimuthal_width: given.tt_azimuthal_width,
        glint_intensity: given.glint_intensity,
        glint_width: given.glint_width,
        glint_angle: given.glint_angle,
        normalised: switch("normalised", given.normalised)?,
        tip_colour: given.tip_colour.into(),
        dual_scattering: dual_scattering(
            given.dual_scattering,
            DualScattering {
                forward: given.forward_density,
                backward: given.backward_density,
                disorder: given.disorder,
            },
        )?,
        roughness: RoughnessVariation {
            strand: given.roughness_strand,
            tip: given.roughness_tip,
        },
        lobe_tolerance: given.lobe_tolerance,
    })
}

fn chiang(given: &PelageChiang) -> Result<Chiang> {
    Ok(Chiang {
        beta_m: given.beta_m,
        beta_n: given.beta_n,
        alpha: given.alpha,
        eta: given.eta,
        sigma_a: given.sigma_a.into(),
        tip_colour: given.tip_colour.into(),
        intervals: given.intervals,
        tables: tables(given.table_size, given.table_precision)?,
        dual_scattering: dual_scattering(
            given.dual_scattering,
            DualScattering {
                forward: given.forward_density,
                backward: given.backward_density,
                disorder: given.disorder,
            },
        )?,
        roughness: RoughnessVariation {
            strand: given.roughness_strand,
            tip: given.roughness_tip,
        },
        lobe_tolerance: given.lobe_tolerance,
        near_field: switch("near_field", given.near_field)?,
    })
}

/// Absorption per fibre radius, linear RGB, of hair with these concentrations of melanin, each from 0 to 100000; brown hair
/// has 1.3 and 0. `sigma_a` takes three floats.
///
/// Errors: a concentration out of its range; NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_sigma_a_from_melanin(
    eumelanin: f32,
    pheomelanin: f32,
    sigma_a: *mut f32,
) -> PelageResult {
    guard(|| {
        // SAFETY: the rule of the module `capi`.
        let sigma_a = unsafe { outputs("sigma_a", sigma_a, 3) }?;
        fill(
            sigma_a,
            sigma_a_from_melanin(eumelanin, pheomelanin)?.to_array(),
        );
        Ok(())
    })
}

/// Absorption per fibre radius, linear RGB, with which a volume of hair has about this linear colour (each channel above 0,
/// at most 1) after all scattering, at an azimuthal roughness from 0.001 to 1. `colour` has and `sigma_a` takes three floats.
///
/// Errors: a value out of its range; NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_sigma_a_from_reflectance(
    colour: *const f32,
    beta_n: f32,
    sigma_a: *mut f32,
) -> PelageResult {
    guard(|| {
        // SAFETY: the rule of the module `capi`.
        let colour = unsafe { slice("colour", colour, 3, 3) }?;
        // SAFETY: the rule of the module `capi`.
        let sigma_a = unsafe { outputs("sigma_a", sigma_a, 3) }?;
        let found = sigma_a_from_reflectance(Vec3::from_slice(colour), beta_n)?;
        fill(sigma_a, found.to_array());
        Ok(())
    })
}

/// Absorption per fibre radius, linear RGB, of `PELAGE_HAIR_COLOUR_…`. `sigma_a` takes three floats.
///
/// Errors: an unknown colour; NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_sigma_a_of(colour: u32, sigma_a: *mut f32) -> PelageResult {
    guard(|| {
        // SAFETY: the rule of the module `capi`.
        let sigma_a = unsafe { outputs("sigma_a", sigma_a, 3) }?;
        let colour = match colour {
            PELAGE_HAIR_COLOUR_BLACK => HairColour::Black,
            PELAGE_HAIR_COLOUR_BROWN => HairColour::Brown,
            PELAGE_HAIR_COLOUR_BLOND => HairColour::Blond,
            PELAGE_HAIR_COLOUR_RED => HairColour::Red,
            PELAGE_HAIR_COLOUR_GREY => HairColour::Grey,
            PELAGE_HAIR_COLOUR_WHITE => HairColour::White,
            PELAGE_HAIR_COLOUR_DYED => HairColour::Dyed,
            unknown => {
                return invalid!("colour {unknown} is not one of PELAGE_HAIR_COLOUR_…");
            }
        };
        fill(sigma_a, colour.sigma_a().to_array());
        Ok(())
    })
}

/// A validated shading model, and where it is evaluated.
pub(in crate::capi) unsafe fn shading(
    name: &str,
    pointer: *const PelageShading,
) -> Result<(Shading, ShadingRate)> {
    // SAFETY: the rule of the module `capi`.
    let given = unsafe { descriptor::read(name, pointer) }?;
    reserved("PelageShading", given.reserved)?;
    let rate = match given.rate {
        PELAGE_SHADING_RATE_POINT => ShadingRate::Point,
        PELAGE_SHADING_RATE_FRAGMENT => ShadingRate::Fragment,
        unknown => return invalid!("{name}: rate {unknown} is not one of PELAGE_SHADING_RATE_…"),
    };
    let shading = match given.model {
        PELAGE_SHADING_KAJIYA_KAY => {
            // SAFETY: the rule of the module `capi`.
            let model = unsafe { settings("kajiya_kay", given.kajiya_kay) }?;
            let (diffuse, specular) = (model.diffuse.into(), model.specular.into());
            Shading::KajiyaKay(KajiyaKay {
                diffuse,
                specular,
                exponent: model.exponent,
            })
        }
        PELAGE_SHADING_SCHEUERMANN => {
            // SAFETY: the rule of the module `capi`.
            let model = unsafe { settings("scheuermann", given.scheuermann) }?;
            Shading::Scheuermann(Scheuermann {
                diffuse: model.diffuse.into(),
                primary: model.primary.highlight(),
                secondary: model.secondary.highlight(),
            })
        }
        PELAGE_SHADING_MARSCHNER => {
            // SAFETY: the rule of the module `capi`.
            Shading::Marschner(marschner(&unsafe {
                settings("marschner", given.marschner)
            }?)?)
        }
        PELAGE_SHADING_SADEGHI => {
            // SAFETY: the rule of the module `capi`.
            Shading::Sadeghi(sadeghi(&unsafe { settings("sadeghi", given.sadeghi) }?)?)
        }
        PELAGE_SHADING_CHIANG => {
            // SAFETY: the rule of the module `capi`.
            Shading::Chiang(chiang(&unsafe { settings("chiang", given.chiang) }?)?)
        }
        unknown => return invalid!("{name}: model {unknown} is not one of PELAGE_SHADING_…"),
    };
    shading.validate().map(|()| (shading, rate))
}
