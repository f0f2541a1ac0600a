//! Scheuermann: Kajiya-Kay with two highlights, as engines use it.
//!
//! `scatter = k_d sin(t,l) + k_1 K(t_1; m_1) + k_2 K(t_2; m_2)`, `t_j = normalise(t + shift_j n)`,
//!
//! with K the lobe of Kajiya-Kay, `max(0, sin(t_j,l) sin(t_j,e) - (t_j·l)(t_j·e))^m_j`. n is perpendicular to the tangent;
//! here it is the part of the view's direction perpendicular to the tangent, normalised, as it is where hair has no surface
//! under it. The primary highlight has the light's colour and moves towards the tip, the secondary one has the hair's
//! and moves towards the root, or as the signs of the shifts say.
//!
//! Scheuermann, *Practical Real-Time Hair Rendering and Shading*, SIGGRAPH 2004 sketches; Hunz (2016), §3.2. He writes
//! the lobe with a half vector, `sin(t_j, h)^m`; like Hunz, this takes Kajiya and Kay's. `scatter` includes the cosine.

use crate::kajiya_kay::{self, KajiyaKay};
use glam::DVec3;

/// One highlight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Highlight {
    /// Coefficient k_j, per steradian, not negative.
    pub colour: DVec3,
    /// Exponent m_j, not negative.
    pub exponent: f64,
    /// The tangent is turned by atan(shift) towards the view's normal. Positive moves the highlight towards the root:
    /// with the tangent turned by δ, the mirror cone lies at θ_h = -δ.
    pub shift: f64,
}

/// The model's coefficients.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scheuermann {
    /// Diffuse coefficient k_d, per steradian, not negative.
    pub diffuse: DVec3,
    /// The first highlight.
    pub primary: Highlight,
    /// The second.
    pub secondary: Highlight,
}

/// The tangent turned towards `normal`, or the tangent where there is no normal.
fn shifted(tangent: DVec3, normal: DVec3, shift: f64) -> DVec3 {
    (tangent + normal * shift).normalize()
}

/// The value of the model, per steradian, times cos θ_i.
///
/// `tangent` points from root to tip; all vectors may have any length but 0, and leave the fibre. A view along the
/// tangent has no normal: there the highlights are not shifted. Never negative, at most the coefficients' sum.
pub fn scatter(tangent: DVec3, to_light: DVec3, to_eye: DVec3, model: &Scheuermann) -> DVec3 {
    let tangent = tangent.normalize();
    let eye = to_eye.normalize();
    let normal = (eye - tangent * tangent.dot(eye)).normalize_or_zero();
    let lobe = |highlight: &Highlight| {
        let kajiya_kay = KajiyaKay {
            diffuse: 0.0,
            specular: 1.0,
            exponent: highlight.exponent,
        };
        let tangent = shifted(tangent, normal, highlight.shift);
        highlight.colour * kajiya_kay::scatter(tangent, to_light, eye, &kajiya_kay)
    };
    let diffuse = tangent.cross(to_light.normalize()).length().min(1.0);
    model.diffuse * diffuse + lobe(&model.primary) + lobe(&model.secondary)
}
