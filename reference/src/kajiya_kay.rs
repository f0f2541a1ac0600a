//! Kajiya-Kay: what a thin cylinder scatters, from one fixed pair of lobes.
//!
//! With t the fibre's tangent, l and e leaving the fibre towards light and eye:
//!
//! `scatter = k_d · sin(t,l) + k_s · max(0, sin(t,l) sin(t,e) - (t·l)(t·e))^m`
//!
//! Kajiya and Kay, *Rendering Fur with Three Dimensional Textures*, SIGGRAPH 1989. With both directions leaving the
//! fibre, the mirror cone is where t·e = -t·l, so the sign before the product of cosines is negative; Kim (2003) and
//! Lansink (2010) print it positive. Reflected radiance is ∫ scatter · L_i dω: the cosine of the incident inclination,
//! which is sin(t,l), is inside the diffuse term, and the specular coefficient is on the same scale.

use glam::DVec3;

/// The model's coefficients for one colour channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KajiyaKay {
    /// Diffuse coefficient k_d, per steradian, not negative.
    pub diffuse: f64,
    /// Specular coefficient k_s, per steradian, not negative.
    pub specular: f64,
    /// Exponent m of the specular lobe, not negative; with 0 the lobe is 1 everywhere.
    pub exponent: f64,
}

/// Sine and cosine of the angle between two directions. The sine is |a × b|, which stays exact where the directions are
/// parallel; √(1 - cos²) does not.
fn sine_cosine(a: DVec3, b: DVec3) -> (f64, f64) {
    (a.cross(b).length().min(1.0), a.dot(b).clamp(-1.0, 1.0))
}

/// The value of the model, per steradian, times cos θ_i.
///
/// `tangent`, `to_light` and `to_eye` may have any length but 0; the tangent's sign does not matter. Never negative and
/// at most `diffuse + specular`.
pub fn scatter(tangent: DVec3, to_light: DVec3, to_eye: DVec3, model: &KajiyaKay) -> f64 {
    let tangent = tangent.normalize();
    let (sin_l, cos_l) = sine_cosine(tangent, to_light.normalize());
    let (sin_e, cos_e) = sine_cosine(tangent, to_eye.normalize());
    let mirror = (sin_l * sin_e - cos_l * cos_e).clamp(0.0, 1.0);
    model.diffuse * sin_l + model.specular * mirror.powf(model.exponent)
}
