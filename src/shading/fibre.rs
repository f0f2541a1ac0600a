//! What the models of a dielectric fibre share: dual scattering, tables, colours of hair, checks.

use glam::Vec3;

use crate::error::{Result, invalid};

/// Light that other fibres have scattered (Zinke et al. 2008, in Sadeghi and Tamstorf's form): a part goes on through the
/// fibres between light and eye, a part comes back from those around. Takes the number of fibres towards the light from
/// the light's shadow technique; without shadows only the part from around is added.
///
/// Two things differ from the papers, where these are further from others' pictures of the same hair. The number of fibres met is
/// taken as Poisson's with the technique's sum of coverage n as its mean: `e⁻ⁿ` comes straight, and `d_f (e^(-n(1-ã_f)) - e⁻ⁿ)`
/// through fibres. And ã_f is not ā_f but `1 - √((1-ā_f)² - ā_b²)`: light that turns twice goes on, too (Kubelka and Munk's two
/// streams).
///
/// The papers' fibres are all parallel, so that light keeps its inclination but for the lobes' widths. What
/// [`disorder`](Self::disorder) says of fibres that are not is this library's own, and fitted to one picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DualScattering {
    /// d_f, from 0 to 1: how much of the space around a lit fibre is hair. The papers have 0.7 and say that 0.6 to 0.8 fits;
    /// here the number of fibres met is random already, and 1 is nearer to traced hair.
    pub forward: f32,
    /// d_b, from 0 to 1; likewise for light that comes back. With the papers' 0.7 traced hair is met best.
    pub backward: f32,
    /// From 0, hair that is combed, to 1, fibres in all directions: light that has met others then comes with any inclination,
    /// and goes round what it does not get through.
    pub disorder: f32,
}

impl Default for DualScattering {
    fn default() -> Self {
        Self {
            forward: 1.0,
            backward: 0.7,
            disorder: 1.0,
        }
    }
}

impl DualScattering {
    pub(crate) fn validate(&self, model: &str) -> Result<()> {
        within(model, "dual_scattering.forward", self.forward, [0.0, 1.0])?;
        within(model, "dual_scattering.backward", self.backward, [0.0, 1.0])?;
        within(model, "dual_scattering.disorder", self.disorder, [0.0, 1.0])
    }
}

/// How roughness varies: between strands, and along each. It multiplies the model's own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoughnessVariation {
    /// Each strand's roughness lies between 1 - this and 1 + this times the model's, by a hash of its number; 0 to 0.9.
    pub strand: f32,
    /// The tip's roughness over the root's, linear between, 0.1 to 10.
    pub tip: f32,
}

impl Default for RoughnessVariation {
    /// None.
    fn default() -> Self {
        Self {
            strand: 0.0,
            tip: 1.0,
        }
    }
}

impl RoughnessVariation {
    /// Whether there is any.
    pub(crate) fn varies(&self) -> bool {
        *self != Self::default()
    }

    pub(crate) fn validate(&self, model: &str) -> Result<()> {
        within(model, "roughness.strand", self.strand, [0.0, 0.9])?;
        within(model, "roughness.tip", self.tip, [0.1, 10.0])
    }
}

/// How a table's numbers are held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Precision {
    /// 16-bit floats: half the bytes; 5e-4 of each value.
    #[default]
    F16,
    /// 32-bit floats.
    F32,
}

/// Tables of a model's azimuthal functions over |θ| and φ (Hunz §3.3.4): made on the GPU when parameters change, and read with
/// bilinear interpolation. 20 bytes an entry as f16, 40 as f32; twice that with dual scattering.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tables {
    /// Rows and columns, from 32 to 512. A lobe narrower than π / size around the fibre is not resolved.
    pub size: u32,
    /// How numbers are held.
    pub precision: Precision,
}

/// The least and the greatest [`Tables::size`].
pub const TABLE_SIZES: [u32; 2] = [32, 512];

impl Default for Tables {
    fn default() -> Self {
        Self {
            size: 64,
            precision: Precision::F16,
        }
    }
}

impl Tables {
    pub(crate) fn validate(&self, model: &str) -> Result<()> {
        let [least, most] = TABLE_SIZES;
        if self.size < least || self.size > most {
            return invalid!(
                "{model}: tables.size {} is not between {least} and {most}",
                self.size
            );
        }
        Ok(())
    }

    /// Words of the tables: one, or with dual scattering two.
    pub(crate) fn words(&self, dual: bool) -> u64 {
        let each = if self.precision == Precision::F16 {
            5
        } else {
            10
        };
        u64::from(self.size).pow(2) * each * if dual { 2 } else { 1 }
    }

    /// The distance of rows in θ, and twice that of columns in φ: what lies between is interpolated.
    pub(crate) fn step(&self) -> f64 {
        std::f64::consts::PI / f64::from(self.size - 1)
    }
}

/// `Ok` if a parameter lies in its range; what is not a number does not.
pub(crate) fn within(model: &str, name: &str, value: f32, range: [f32; 2]) -> Result<()> {
    if value >= range[0] && value <= range[1] {
        return Ok(());
    }
    invalid!(
        "{model}: {name} {value} is not between {} and {}",
        range[0],
        range[1]
    )
}

/// The same for every channel.
pub(crate) fn all_within(model: &str, name: &str, value: Vec3, range: [f32; 2]) -> Result<()> {
    value
        .to_array()
        .into_iter()
        .try_for_each(|v| within(model, name, v, range))
}

/// d_f and d_b as WGSL reads them, where there is dual scattering.
pub(crate) fn densities(dual: Option<DualScattering>) -> [f32; 4] {
    dual.map_or([0.0; 4], |dual| [dual.forward, dual.backward, 0.0, 0.0])
}

/// The range of a tolerance of radiance.
pub(crate) const MAX_TOLERANCE: [f32; 2] = [0.0, 1e6];

/// The greatest absorption per radius; beyond it nothing is left of any channel.
pub(crate) const MAX_SIGMA_A: f32 = 1e6;

/// Absorption per fibre radius of hair with these concentrations of melanin (brown hair: 1.3 and 0).
/// Coefficients by d'Eon et al. 2011.
///
/// # Errors
/// A concentration that is negative or not finite.
pub fn sigma_a_from_melanin(eumelanin: f32, pheomelanin: f32) -> Result<Vec3> {
    within("melanin", "eumelanin", eumelanin, [0.0, 1e5])?;
    within("melanin", "pheomelanin", pheomelanin, [0.0, 1e5])?;
    Ok(eumelanin * Vec3::new(0.419, 0.697, 1.37) + pheomelanin * Vec3::new(0.187, 0.4, 1.05))
}

/// Absorption per fibre radius with which a volume of hair has about this linear colour after all scattering, at an azimuthal
/// roughness β_n: `(ln c / (5.969 - 0.215 β + 2.532 β² - 10.73 β³ + 5.574 β⁴ + 0.245 β⁵))²` (Chiang et al. 2016).
///
/// # Errors
/// A channel that is not above 0 and at most 1; `beta_n` not between 0.001 and 1.
pub fn sigma_a_from_reflectance(colour: Vec3, beta_n: f32) -> Result<Vec3> {
    all_within("reflectance", "colour", colour, [1e-6, 1.0])?;
    within("reflectance", "beta_n", beta_n, [1e-3, 1.0])?;
    let b = f64::from(beta_n);
    let fit = [0.245, 5.574, -10.73, 2.532, -0.215, 5.969]
        .into_iter()
        .fold(0.0, |sum, c| sum * b + c);
    let of = |c: f64| (c.ln() / fit).powi(2);
    Ok(colour.as_dvec3().map(of).as_vec3())
}

/// Usual colours of hair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum HairColour {
    /// Eumelanin 8.
    Black,
    /// Eumelanin 1.3 (d'Eon et al. 2011).
    Brown,
    /// Eumelanin 0.3.
    Blond,
    /// Eumelanin 0.2 and pheomelanin 1.2.
    Red,
    /// Eumelanin 0.1: what is left in hair that goes grey evenly.
    Grey,
    /// Eumelanin 0.01.
    White,
    /// A dye of linear reflectance (0.02, 0.15, 0.6) over hair without melanin.
    Dyed,
}

impl HairColour {
    /// Absorption per fibre radius. The concentrations are chosen by eye but for brown's.
    pub fn sigma_a(self) -> Vec3 {
        let (eumelanin, pheomelanin) = match self {
            Self::Black => (8.0, 0.0),
            Self::Brown => (1.3, 0.0),
            Self::Blond => (0.3, 0.0),
            Self::Red => (0.2, 1.2),
            Self::Grey => (0.1, 0.0),
            Self::White => (0.01, 0.0),
            Self::Dyed => {
                return sigma_a_from_reflectance(Vec3::new(0.02, 0.15, 0.6), 0.3)
                    .unwrap_or(Vec3::ONE);
            }
        };
        sigma_a_from_melanin(eumelanin, pheomelanin).unwrap_or(Vec3::ONE)
    }
}

/// v(β_m) = (0.726 β + 0.812 β² + 3.7 β²⁰)², the variance of θ_i + θ_o of Chiang's R.
pub(crate) fn longitudinal_variance(beta_m: f64) -> f64 {
    (0.726 * beta_m + 0.812 * beta_m * beta_m + 3.7 * beta_m.powi(20)).powi(2)
}
