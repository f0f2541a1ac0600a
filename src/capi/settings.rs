//! Techniques with their settings: a shading model, a shadow technique, a transparency technique.

use std::ptr::null;

use super::descriptor::{self, descriptor};
use super::error::{PelageResult, guard};
use super::input::{fill, outputs, reserved, slice};
use crate::error::{Result, invalid};
use crate::raster::Raster;
use crate::shading::{
    CausticRemoval, Chiang, DualScattering, HairColour, Highlight, KajiyaKay, LobeControls,
    Marschner, Precision, Roots, RoughnessVariation, Sadeghi, Scheuermann, Shading, ShadingRate,
    Tables, sigma_a_from_melanin, sigma_a_from_reflectance,
};
use crate::shadow::{
    ApproximatedDeepShadowMap, Attenuation, DeepOpacityMap, KBufferVolume, MomentOpacityMap,
    OpacityShadowMaps, Shadow, ShadowMap,
};
use crate::transparency::{ABuffer, DbkBuffer, Opaque, Storage, Transparency};
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
/// At each fragment that the transparency technique keeps, at its own position.
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

/// Every light reaches every fibre.
pub const PELAGE_SHADOW_NONE: u32 = 0;
/// Yuksel and Keyser 2008.
pub const PELAGE_SHADOW_DEEP_OPACITY_MAP: u32 = 1;
/// Nearest depths with percentage-closer filtering.
pub const PELAGE_SHADOW_SHADOW_MAP: u32 = 2;
/// Nearest depths, and a guess of the fibres behind them.
pub const PELAGE_SHADOW_APPROXIMATED_DEEP_SHADOW_MAP: u32 = 3;
/// Kim and Neumann 2001.
pub const PELAGE_SHADOW_OPACITY_SHADOW_MAPS: u32 = 4;
/// Peters and Klein 2015, Münstermann et al. 2018.
pub const PELAGE_SHADOW_MOMENT_OPACITY_MAP: u32 = 5;
/// Yu et al. 2012.
pub const PELAGE_SHADOW_K_BUFFER_VOLUME: u32 = 6;

/// A fibre takes as much of the light as its opacity says.
pub const PELAGE_ATTENUATION_OPACITY: u32 = 0;
/// A fibre takes what its surface reflects and its inside absorbs.
pub const PELAGE_ATTENUATION_FRESNEL: u32 = 1;

/// The nearest fragment's colour at the pixel's whole opacity.
pub const PELAGE_TRANSPARENCY_OPAQUE: u32 = 0;
/// Every fragment stored, sorted and composited.
pub const PELAGE_TRANSPARENCY_A_BUFFER: u32 = 1;
/// As the A-buffer, but that nothing is stored behind the depth from which on it changes a pixel by less than a tolerance.
pub const PELAGE_TRANSPARENCY_DBK_BUFFER: u32 = 10;

/// The library chooses.
pub const PELAGE_RASTER_AUTO: u32 = 0;
/// Camera-facing triangle strips.
pub const PELAGE_RASTER_RIBBONS: u32 = 1;
/// A compute pass that walks the pixels of each segment.
pub const PELAGE_RASTER_WALK: u32 = 2;

/// Fragments counted first, then stored side by side.
pub const PELAGE_STORAGE_COUNTED: u32 = 0;
/// Per-pixel linked lists.
pub const PELAGE_STORAGE_LISTS: u32 = 1;

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
        }
    }
}

descriptor!(PelageMarschner, "PELAGE_MARSCHNER_INIT", lobe_tolerance: f32);

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
        }
    }
}

descriptor!(PelageSadeghi, "PELAGE_SADEGHI_INIT", lobe_tolerance: f32);

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
        }
    }
}

descriptor!(PelageChiang, "PELAGE_CHIANG_INIT", near_field: u32);

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

/// Settings of the deep opacity map.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageDeepOpacityMap {
    /// `sizeof(PelageDeepOpacityMap)`.
    pub struct_size: u32,
    /// Texels a side, from 16 to 8192.
    pub resolution: u32,
    /// Layers, from 1 to 64.
    pub layers: u32,
    /// Width of the filter in texels: 1, 3 or 5.
    pub pcf: u32,
    /// Depth behind the front at which the last layer ends, as a part of the hair's extent along the light, above 0 and
    /// up to 1. What lies deeper counts in the last layer.
    pub depth: f32,
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
    /// The part of each channel that a crossed fibre passes on, from 0 to below 1: all hair's alike.
    pub transmitted: [f32; 3],
}

impl Default for PelageDeepOpacityMap {
    fn default() -> Self {
        let DeepOpacityMap {
            resolution,
            layers,
            pcf,
            depth,
            transmitted,
            ..
        } = DeepOpacityMap::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            resolution,
            layers,
            pcf,
            depth,
            raster: PELAGE_RASTER_AUTO,
            transmitted: transmitted.into(),
        }
    }
}

descriptor!(PelageDeepOpacityMap, "PELAGE_DEEP_OPACITY_MAP_INIT", transmitted: [f32; 3]);

/// Settings of the moment opacity map.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageMomentOpacityMap {
    /// `sizeof(PelageMomentOpacityMap)`.
    pub struct_size: u32,
    /// Texels a side, from 16 to 8192.
    pub resolution: u32,
    /// Moments beside the sum, 4 or 6.
    pub moments: u32,
    /// Width of the filter in texels: 1, 3 or 5.
    pub pcf: u32,
    /// The part of each channel that a crossed fibre passes on, from 0 to below 1: all hair's alike.
    pub transmitted: [f32; 3],
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
}

impl Default for PelageMomentOpacityMap {
    fn default() -> Self {
        let MomentOpacityMap {
            resolution,
            moments,
            pcf,
            transmitted,
            ..
        } = MomentOpacityMap::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            resolution,
            moments,
            pcf,
            transmitted: transmitted.into(),
            raster: PELAGE_RASTER_AUTO,
        }
    }
}

descriptor!(PelageMomentOpacityMap, "PELAGE_MOMENT_OPACITY_MAP_INIT", raster: u32);

/// Settings of the k-buffer volumetric shadow.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageKBufferVolume {
    /// `sizeof(PelageKBufferVolume)`.
    pub struct_size: u32,
    /// Texels a side, from 16 to 8192.
    pub resolution: u32,
    /// Events a texel, from 1 to 64.
    pub k: u32,
    /// Width of the filter in texels: 1, 3 or 5.
    pub pcf: u32,
    /// 1: what lies behind the K-th event counts, spread evenly to the farthest one. 0: it does not.
    pub tail: u32,
    /// `PELAGE_ATTENUATION_…`: what a fibre takes of the light.
    pub attenuation: u32,
    /// Of `PELAGE_ATTENUATION_FRESNEL`: the index of refraction, from 1.01 to 3.
    pub eta: f32,
    /// Of `PELAGE_ATTENUATION_FRESNEL`: absorption per fibre radius, from 0.
    pub sigma_a: [f32; 3],
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
}

impl Default for PelageKBufferVolume {
    fn default() -> Self {
        let KBufferVolume {
            resolution,
            k,
            pcf,
            tail,
            ..
        } = KBufferVolume::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            resolution,
            k,
            pcf,
            tail: u32::from(tail),
            attenuation: PELAGE_ATTENUATION_OPACITY,
            eta: 1.55,
            sigma_a: [0.0; 3],
            raster: PELAGE_RASTER_AUTO,
        }
    }
}

descriptor!(PelageKBufferVolume, "PELAGE_K_BUFFER_VOLUME_INIT", raster: u32);

/// Settings of the shadow map.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageShadowMap {
    /// `sizeof(PelageShadowMap)`.
    pub struct_size: u32,
    /// Texels a side, from 16 to 8192.
    pub resolution: u32,
    /// Width of the filter in texels: 1, 3 or 5.
    pub pcf: u32,
    /// The part of the light that a shadow takes, from 0 to 1.
    pub strength: f32,
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
}

impl Default for PelageShadowMap {
    fn default() -> Self {
        let ShadowMap {
            resolution,
            pcf,
            strength,
            ..
        } = ShadowMap::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            resolution,
            pcf,
            strength,
            raster: PELAGE_RASTER_AUTO,
        }
    }
}

descriptor!(PelageShadowMap, "PELAGE_SHADOW_MAP_INIT", raster: u32);

/// Settings of the approximated deep shadow map.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageApproximatedDeepShadowMap {
    /// `sizeof(PelageApproximatedDeepShadowMap)`.
    pub struct_size: u32,
    /// Texels a side, from 16 to 8192.
    pub resolution: u32,
    /// Width of the filter in texels: 1, 3 or 5.
    pub pcf: u32,
    /// Opacity of each fibre that is guessed to lie in the way, above 0 and up to 1. 0: the fibres' own.
    pub opacity: f32,
    /// Mean distance between fibres along a ray, in host units. 0: such that mean transmittance is that of fibres spread
    /// evenly in the volume that they fill.
    pub spacing: f32,
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
}

impl Default for PelageApproximatedDeepShadowMap {
    fn default() -> Self {
        let ApproximatedDeepShadowMap {
            resolution, pcf, ..
        } = ApproximatedDeepShadowMap::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            resolution,
            pcf,
            opacity: 0.0,
            spacing: 0.0,
            raster: PELAGE_RASTER_AUTO,
        }
    }
}

descriptor!(
    PelageApproximatedDeepShadowMap,
    "PELAGE_APPROXIMATED_DEEP_SHADOW_MAP_INIT",
    raster: u32
);

/// Settings of opacity shadow maps.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageOpacityShadowMaps {
    /// `sizeof(PelageOpacityShadowMaps)`.
    pub struct_size: u32,
    /// Texels a side, from 16 to 8192.
    pub resolution: u32,
    /// Planes, from 1 to 256.
    pub layers: u32,
    /// How much farther apart the planes lie with depth, from 0, evenly, to 1, as the square of their number.
    pub unevenness: f32,
    /// Width of the filter in texels: 1, 3 or 5.
    pub pcf: u32,
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
}

impl Default for PelageOpacityShadowMaps {
    fn default() -> Self {
        let OpacityShadowMaps {
            resolution,
            layers,
            unevenness,
            pcf,
            ..
        } = OpacityShadowMaps::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            resolution,
            layers,
            unevenness,
            pcf,
            raster: PELAGE_RASTER_AUTO,
        }
    }
}

descriptor!(PelageOpacityShadowMaps, "PELAGE_OPACITY_SHADOW_MAPS_INIT", raster: u32);

/// A shadow technique with its settings.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageShadow {
    /// `sizeof(PelageShadow)`.
    pub struct_size: u32,
    /// `PELAGE_SHADOW_…`.
    pub technique: u32,
    /// For `PELAGE_SHADOW_DEEP_OPACITY_MAP`; NULL: as `PELAGE_DEEP_OPACITY_MAP_INIT`.
    pub deep_opacity_map: *const PelageDeepOpacityMap,
    /// For `PELAGE_SHADOW_SHADOW_MAP`; NULL: as `PELAGE_SHADOW_MAP_INIT`.
    pub shadow_map: *const PelageShadowMap,
    /// For `PELAGE_SHADOW_APPROXIMATED_DEEP_SHADOW_MAP`; NULL: as `PELAGE_APPROXIMATED_DEEP_SHADOW_MAP_INIT`.
    pub approximated_deep_shadow_map: *const PelageApproximatedDeepShadowMap,
    /// For `PELAGE_SHADOW_OPACITY_SHADOW_MAPS`; NULL: as `PELAGE_OPACITY_SHADOW_MAPS_INIT`.
    pub opacity_shadow_maps: *const PelageOpacityShadowMaps,
    /// For `PELAGE_SHADOW_MOMENT_OPACITY_MAP`; NULL: as `PELAGE_MOMENT_OPACITY_MAP_INIT`.
    pub moment_opacity_map: *const PelageMomentOpacityMap,
    /// For `PELAGE_SHADOW_K_BUFFER_VOLUME`; NULL: as `PELAGE_K_BUFFER_VOLUME_INIT`.
    pub k_buffer_volume: *const PelageKBufferVolume,
}

impl Default for PelageShadow {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            technique: PELAGE_SHADOW_DEEP_OPACITY_MAP,
            deep_opacity_map: null(),
            shadow_map: null(),
            approximated_deep_shadow_map: null(),
            opacity_shadow_maps: null(),
            moment_opacity_map: null(),
            k_buffer_volume: null(),
        }
    }
}

descriptor!(PelageShadow, "PELAGE_SHADOW_INIT", k_buffer_volume: *const PelageKBufferVolume);

/// Settings of the opaque technique.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageOpaque {
    /// `sizeof(PelageOpaque)`.
    pub struct_size: u32,
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
}

impl Default for PelageOpaque {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            raster: PELAGE_RASTER_AUTO,
        }
    }
}

descriptor!(PelageOpaque, "PELAGE_OPAQUE_INIT", raster: u32);

/// Settings of the A-buffer.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageABuffer {
    /// `sizeof(PelageABuffer)`.
    pub struct_size: u32,
    /// `PELAGE_STORAGE_…`.
    pub storage: u32,
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
    /// 0.
    pub reserved: u32,
    /// Bytes of the fragment pool, at least 16; 0: the library estimates, and grows it within the byte budget.
    pub pool_bytes: u64,
}

impl Default for PelageABuffer {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            storage: PELAGE_STORAGE_COUNTED,
            raster: PELAGE_RASTER_AUTO,
            reserved: 0,
            pool_bytes: 0,
        }
    }
}

descriptor!(PelageABuffer, "PELAGE_A_BUFFER_INIT", pool_bytes: u64);

/// Settings of the DBK-buffer.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageDbkBuffer {
    /// `sizeof(PelageDbkBuffer)`.
    pub struct_size: u32,
    /// How much of a pixel's alpha, and of its culled hair's radiance, may be left out: from 1e-6 to 0.5.
    pub epsilon: f32,
    /// Above 0: what lies farther than this behind the nearest fragment, in host units along the ray, is drawn as one opaque
    /// layer, and `epsilon` is not asked. 0: `epsilon` decides.
    pub depth_shift: f32,
    /// `PELAGE_RASTER_…`.
    pub raster: u32,
    /// Bytes of the fragment pool, at least 16; 0: the library estimates, and grows it within the byte budget.
    pub pool_bytes: u64,
}

impl Default for PelageDbkBuffer {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            epsilon: DbkBuffer::default().epsilon,
            depth_shift: 0.0,
            raster: PELAGE_RASTER_AUTO,
            pool_bytes: 0,
        }
    }
}

descriptor!(PelageDbkBuffer, "PELAGE_DBK_BUFFER_INIT", pool_bytes: u64);

/// A transparency technique with its settings.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageTransparency {
    /// `sizeof(PelageTransparency)`.
    pub struct_size: u32,
    /// `PELAGE_TRANSPARENCY_…`.
    pub technique: u32,
    /// For `PELAGE_TRANSPARENCY_OPAQUE`; NULL: as `PELAGE_OPAQUE_INIT`.
    pub opaque: *const PelageOpaque,
    /// For `PELAGE_TRANSPARENCY_A_BUFFER`; NULL: as `PELAGE_A_BUFFER_INIT`.
    pub a_buffer: *const PelageABuffer,
    /// For `PELAGE_TRANSPARENCY_DBK_BUFFER`; NULL: as `PELAGE_DBK_BUFFER_INIT`.
    pub dbk_buffer: *const PelageDbkBuffer,
}

impl Default for PelageTransparency {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            technique: PELAGE_TRANSPARENCY_DBK_BUFFER,
            opaque: null(),
            a_buffer: null(),
            dbk_buffer: null(),
        }
    }
}

descriptor!(PelageTransparency, "PELAGE_TRANSPARENCY_INIT", dbk_buffer: *const PelageDbkBuffer);

/// What stands behind a pointer to settings, or their defaults behind NULL.
unsafe fn settings<T: descriptor::Descriptor>(name: &str, pointer: *const T) -> Result<T> {
    // SAFETY: the rule of the module `capi`.
    Ok(unsafe { descriptor::read_optional(name, pointer) }?.unwrap_or_default())
}

fn raster(value: u32) -> Result<Raster> {
    match value {
        PELAGE_RASTER_AUTO => Ok(Raster::Auto),
        PELAGE_RASTER_RIBBONS => Ok(Raster::Ribbons),
        PELAGE_RASTER_WALK => Ok(Raster::Walk),
        _ => invalid!("raster {value} is not one of PELAGE_RASTER_…"),
    }
}

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

fn switch(name: &str, value: u32) -> Result<bool> {
    match value {
        0 => Ok(false),
        1 => Ok(true),
        _ => invalid!("{name} {value} is neither 0 nor 1"),
    }
}

fn dual_scattering(on: u32, forward: f32, backward: f32) -> Result<Option<DualScattering>> {
    Ok(switch("dual_scattering", on)?.then_some(DualScattering { forward, backward }))
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
            given.forward_density,
            given.backward_density,
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
            given.forward_density,
            given.backward_density,
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
            given.forward_density,
            given.backward_density,
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
pub(super) unsafe fn shading(
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

fn k_buffer_volume(map: &PelageKBufferVolume) -> Result<KBufferVolume> {
    let attenuation = match map.attenuation {
        PELAGE_ATTENUATION_OPACITY => Attenuation::Opacity,
        PELAGE_ATTENUATION_FRESNEL => Attenuation::Fresnel {
            eta: map.eta,
            sigma_a: map.sigma_a.into(),
        },
        unknown => {
            return invalid!(
                "k_buffer_volume: attenuation {unknown} is not one of PELAGE_ATTENUATION_…"
            );
        }
    };
    if map.tail > 1 {
        return invalid!("k_buffer_volume: tail {} is not 0 or 1", map.tail);
    }
    Ok(KBufferVolume {
        resolution: map.resolution,
        k: map.k,
        pcf: map.pcf,
        tail: map.tail == 1,
        attenuation,
        raster: raster(map.raster)?,
    })
}

/// A validated shadow technique; `None` for NULL.
pub(super) unsafe fn shadow(name: &str, pointer: *const PelageShadow) -> Result<Option<Shadow>> {
    // SAFETY: the rule of the module `capi`.
    let Some(given) = unsafe { descriptor::read_optional(name, pointer) }? else {
        return Ok(None);
    };
    let shadow = match given.technique {
        PELAGE_SHADOW_NONE => Shadow::None,
        PELAGE_SHADOW_DEEP_OPACITY_MAP => {
            // SAFETY: the rule of the module `capi`.
            let map = unsafe { settings("deep_opacity_map", given.deep_opacity_map) }?;
            Shadow::DeepOpacityMap(DeepOpacityMap {
                resolution: map.resolution,
                layers: map.layers,
                pcf: map.pcf,
                depth: map.depth,
                transmitted: map.transmitted.into(),
                raster: raster(map.raster)?,
            })
        }
        PELAGE_SHADOW_SHADOW_MAP => {
            // SAFETY: the rule of the module `capi`.
            let map = unsafe { settings("shadow_map", given.shadow_map) }?;
            Shadow::ShadowMap(ShadowMap {
                resolution: map.resolution,
                pcf: map.pcf,
                strength: map.strength,
                raster: raster(map.raster)?,
            })
        }
        PELAGE_SHADOW_APPROXIMATED_DEEP_SHADOW_MAP => {
            let map = given.approximated_deep_shadow_map;
            // SAFETY: the rule of the module `capi`.
            let map = unsafe { settings("approximated_deep_shadow_map", map) }?;
            let chosen = |value: f32| (value != 0.0).then_some(value);
            Shadow::ApproximatedDeepShadowMap(ApproximatedDeepShadowMap {
                resolution: map.resolution,
                pcf: map.pcf,
                opacity: chosen(map.opacity),
                spacing: chosen(map.spacing),
                raster: raster(map.raster)?,
            })
        }
        PELAGE_SHADOW_OPACITY_SHADOW_MAPS => {
            // SAFETY: the rule of the module `capi`.
            let maps = unsafe { settings("opacity_shadow_maps", given.opacity_shadow_maps) }?;
            Shadow::OpacityShadowMaps(OpacityShadowMaps {
                resolution: maps.resolution,
                layers: maps.layers,
                unevenness: maps.unevenness,
                pcf: maps.pcf,
                raster: raster(maps.raster)?,
            })
        }
        PELAGE_SHADOW_MOMENT_OPACITY_MAP => {
            // SAFETY: the rule of the module `capi`.
            let map = unsafe { settings("moment_opacity_map", given.moment_opacity_map) }?;
            Shadow::MomentOpacityMap(MomentOpacityMap {
                resolution: map.resolution,
                moments: map.moments,
                pcf: map.pcf,
                transmitted: map.transmitted.into(),
                raster: raster(map.raster)?,
            })
        }
        PELAGE_SHADOW_K_BUFFER_VOLUME => {
            // SAFETY: the rule of the module `capi`.
            let map = unsafe { settings("k_buffer_volume", given.k_buffer_volume) }?;
            Shadow::KBufferVolume(k_buffer_volume(&map)?)
        }
        unknown => return invalid!("{name}: technique {unknown} is not one of PELAGE_SHADOW_…"),
    };
    shadow.validate().map(|()| Some(shadow))
}

/// A validated transparency technique; `None` for NULL.
pub(super) unsafe fn transparency(
    name: &str,
    pointer: *const PelageTransparency,
) -> Result<Option<Transparency>> {
    // SAFETY: the rule of the module `capi`.
    let Some(given) = unsafe { descriptor::read_optional(name, pointer) }? else {
        return Ok(None);
    };
    let transparency = match given.technique {
        PELAGE_TRANSPARENCY_OPAQUE => {
            // SAFETY: the rule of the module `capi`.
            let opaque = unsafe { settings("opaque", given.opaque) }?;
            Transparency::Opaque(Opaque {
                raster: raster(opaque.raster)?,
            })
        }
        PELAGE_TRANSPARENCY_A_BUFFER => {
            // SAFETY: the rule of the module `capi`.
            Transparency::ABuffer(a_buffer(&unsafe { settings("a_buffer", given.a_buffer) }?)?)
        }
        PELAGE_TRANSPARENCY_DBK_BUFFER => {
            // SAFETY: the rule of the module `capi`.
            let given = unsafe { settings("dbk_buffer", given.dbk_buffer) }?;
            Transparency::DbkBuffer(DbkBuffer {
                epsilon: given.epsilon,
                depth_shift: (given.depth_shift != 0.0).then_some(given.depth_shift),
                raster: raster(given.raster)?,
                pool_bytes: (given.pool_bytes > 0).then_some(given.pool_bytes),
            })
        }
        unknown => {
            return invalid!("{name}: technique {unknown} is not one of PELAGE_TRANSPARENCY_…");
        }
    };
    transparency.validate().map(|()| Some(transparency))
}

fn a_buffer(given: &PelageABuffer) -> Result<ABuffer> {
    reserved("PelageABuffer", given.reserved)?;
    let storage = match given.storage {
        PELAGE_STORAGE_COUNTED => Storage::Counted,
        PELAGE_STORAGE_LISTS => Storage::Lists,
        unknown => return invalid!("storage {unknown} is not one of PELAGE_STORAGE_…"),
    };
    let pool_bytes = (given.pool_bytes > 0).then_some(given.pool_bytes);
    Ok(ABuffer {
        storage,
        raster: raster(given.raster)?,
        pool_bytes,
    })
}
