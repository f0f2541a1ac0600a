//! Kajiya and Kay 1989 (Kim §5, Hunz §3.2), with both directions leaving the fibre:
//!
//! Ψ = k_d sin(t, l) + k_s max(0, sin(t, l) sin(t, e) - (t·l)(t·e))^m

use glam::Vec3;

use crate::error::{Result, invalid};
use crate::layout::Material;

/// The label of the pass that shades points, and the model's shader.
pub(crate) const POINTS: (&str, &[&str]) =
    ("pelage.shading.kajiya_kay.points", &["shading/kajiya_kay"]);
/// The largest exponent; beyond it the lobe is narrower than an f32 direction can tell.
pub const MAX_EXPONENT: f32 = 1e5;

/// Kajiya and Kay's diffuse and specular lobes. The cosine is inside: radiance = Ψ × irradiance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KajiyaKay {
    /// k_d, linear RGB, ≥ 0. Multiplies each strand's own colour. About 1/π for a light fibre.
    pub diffuse: Vec3,
    /// k_s, linear RGB, ≥ 0.
    pub specular: Vec3,
    /// m, from 1 to 10⁵.
    pub exponent: f32,
}

impl Default for KajiyaKay {
    /// Dark blond hair.
    fn default() -> Self {
        Self {
            specular: Vec3::splat(0.09),
            exponent: 60.0,
            diffuse: Self::diffuse_of(Vec3::new(0.2, 0.35, 0.8)),
        }
    }
}

impl KajiyaKay {
    /// The diffuse coefficient of a fibre with absorption `sigma_a` per radius: what light keeps along the mean chord
    /// of a circle, π/2 radii, spread like Lambert's by 1/π.
    pub fn diffuse_of(sigma_a: Vec3) -> Vec3 {
        (sigma_a * -std::f32::consts::FRAC_PI_2).exp() * std::f32::consts::FRAC_1_PI
    }

    pub(crate) fn validate(&self) -> Result<()> {
        for (name, colour) in [("diffuse", self.diffuse), ("specular", self.specular)] {
            if !colour.is_finite() || colour.min_element() < 0.0 {
                return invalid!(
                    "kajiya_kay: {name} ({}, {}, {}) has a component that is negative or not finite",
                    colour.x,
                    colour.y,
                    colour.z
                );
            }
        }
        if !(1.0..=MAX_EXPONENT).contains(&self.exponent) {
            return invalid!(
                "kajiya_kay: exponent {} is not between 1 and {MAX_EXPONENT}",
                self.exponent
            );
        }
        Ok(())
    }

    pub(crate) fn material(&self) -> Material {
        let mut material = Material::default();
        material.values[0] = self.diffuse.extend(self.exponent).into();
        material.values[1] = self
            .specular
            .extend(lobe_width(self.exponent as f64))
            .into();
        material
    }
}

/// ∫ cos^(m+1) x dx over -π/2…π/2, by the midpoint rule, which for this periodic integrand converges faster than any
/// power of the step; the step follows the lobe's width.
pub(super) fn lobe_width(exponent: f64) -> f32 {
    let steps = 64 + (8.0 * exponent.sqrt()) as usize;
    let step = std::f64::consts::PI / steps as f64;
    let sum: f64 = (0..steps)
        .map(|i| ((i as f64 + 0.5) * step).sin().powf(exponent + 1.0))
        .sum();
    (sum * step) as f32
}
