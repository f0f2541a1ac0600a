//! Scheuermann 2004 (Hunz §3.2): Kajiya-Kay with two highlights, as engines use it. See
//! `shaders/shading/scheuermann.wgsl`.

use glam::Vec3;

use super::fibre::{all_within, within};
use super::kajiya_kay::{KajiyaKay, MAX_EXPONENT, lobe_width};
use crate::error::Result;
use crate::layout::Material;

/// The label of the pass that shades points, and the model's shaders.
pub(crate) const POINTS: (&str, &[&str]) = (
    "pelage.shading.scheuermann.points",
    &["shading/scheuermann"],
);

/// One highlight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Highlight {
    /// Coefficient, linear RGB, per steradian, 0 to 10⁶.
    pub colour: Vec3,
    /// Exponent, 1 to 10⁵.
    pub exponent: f32,
    /// The tangent is turned by atan(shift) towards the eye, -10 to 10. Positive moves the highlight towards the root.
    pub shift: f32,
}

/// Scheuermann's model. The cosine is inside: radiance = value × irradiance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scheuermann {
    /// k_d, linear RGB, 0 to 10⁶. Multiplies each strand's own colour.
    pub diffuse: Vec3,
    /// The first highlight, of the light's colour.
    pub primary: Highlight,
    /// The second; multiplies each strand's own colour.
    pub secondary: Highlight,
}

impl Default for Scheuermann {
    /// Dark blond hair.
    fn default() -> Self {
        let diffuse = KajiyaKay::default().diffuse;
        Self {
            diffuse,
            primary: Highlight {
                colour: Vec3::splat(0.06),
                exponent: 120.0,
                shift: 0.07,
            },
            secondary: Highlight {
                colour: diffuse,
                exponent: 30.0,
                shift: -0.1,
            },
        }
    }
}

impl Scheuermann {
    /// The default with the colour of a fibre of this absorption per radius.
    pub fn of_fibre(sigma_a: Vec3) -> Self {
        let diffuse = KajiyaKay::diffuse_of(sigma_a);
        let model = Self::default();
        Self {
            diffuse,
            secondary: Highlight {
                colour: diffuse,
                ..model.secondary
            },
            ..model
        }
    }

    pub(crate) fn validate(&self) -> Result<()> {
        all_within("scheuermann", "diffuse", self.diffuse, [0.0, 1e6])?;
        for (name, highlight) in [("primary", self.primary), ("secondary", self.secondary)] {
            let named = |field: &str| format!("{name}.{field}");
            all_within(
                "scheuermann",
                &named("colour"),
                highlight.colour,
                [0.0, 1e6],
            )?;
            within(
                "scheuermann",
                &named("exponent"),
                highlight.exponent,
                [1.0, MAX_EXPONENT],
            )?;
            within(
                "scheuermann",
                &named("shift"),
                highlight.shift,
                [-10.0, 10.0],
            )?;
        }
        Ok(())
    }

    pub(crate) fn brightest(&self) -> f32 {
        self.diffuse.max_element()
            + self.primary.colour.max_element()
            + self.secondary.colour.max_element()
    }

    pub(crate) fn material(&self) -> Material {
        let mut material = Material::default();
        material.values[0] = self.diffuse.extend(0.0).into();
        let both = [self.primary, self.secondary];
        for (j, highlight) in both.into_iter().enumerate() {
            material.values[1 + j] = highlight.colour.extend(highlight.exponent).into();
            material.values[3][j] = highlight.shift;
            material.values[3][2 + j] = lobe_width(f64::from(highlight.exponent));
        }
        material
    }
}
