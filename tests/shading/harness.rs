//! Runs a shading model's WGSL over many directions on the device, its tables made as a frame makes them.

use pelage::glam::DVec3;
use pelage::shading::{self, Sample, Shading};
use pelage_reference::fibre::{Direction, FibreModel};

use crate::common::Device;

/// One evaluation.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    pub tangent: DVec3,
    pub wi: DVec3,
    pub wo: DVec3,
    /// Fibres towards the light; the light that comes straight is e^-fibres.
    pub fibres: f64,
    pub strand: u32,
    /// Root-to-tip coordinate.
    pub coordinate: f64,
    /// The part of the fibre's width that is seen.
    pub across: [f64; 2],
}

/// The fibre's tangent and the first axis of its section, far from any axis of space.
pub fn frame() -> [DVec3; 2] {
    let tangent = DVec3::new(0.48, -0.6, 0.64).as_vec3().as_dvec3();
    [
        tangent,
        DVec3::new(0.8, 0.64, 0.0)
            .reject_from(tangent.normalize())
            .normalize(),
    ]
}

/// A direction by inclination and azimuth, as f32, as the device is given it.
pub fn direction(theta: f64, phi: f64) -> DVec3 {
    let [tangent, first] = frame();
    let tangent = tangent.normalize();
    let second = tangent.cross(first);
    let v = Direction::new(theta, phi).to_vector();
    (tangent * v.x + first * v.y + second * v.z)
        .as_vec3()
        .as_dvec3()
}

/// The direction as the reference sees it.
pub fn seen(v: DVec3) -> Direction {
    let [tangent, first] = frame();
    Direction::in_frame(v, tangent.normalize(), first)
}

/// Light and eye at these angles, unshadowed.
pub fn case(theta_i: f64, theta_o: f64, phi: f64) -> Case {
    Case {
        tangent: frame()[0],
        wi: direction(theta_i, 0.2),
        wo: direction(theta_o, 0.2 + phi),
        fibres: 0.0,
        strand: 0,
        coordinate: 0.0,
        across: [-1.0, 1.0],
    }
}

/// Directions whose part across the tangent is smaller have no azimuth that an f32 could tell (6e-8 of 1): what they give must
/// be what the reference gives at some azimuth.
const ALONG: f64 = 1e-4;

/// Inclinations from end to end, the tangent itself and what is next to it, every azimuth that is special; and the mirror
/// cones of lobes at these sums of inclinations.
pub fn hard_cases(sums: &[f64]) -> Vec<Case> {
    let right = std::f64::consts::FRAC_PI_2;
    let pi = std::f64::consts::PI;
    let thetas = [
        -right,
        -right + 1e-6,
        -1.5,
        -0.9,
        -0.2,
        0.0,
        0.4,
        1.2,
        right - 1e-3,
        right,
    ];
    let phis = [0.0, 1e-4, 0.3, 1.0, 0.5 * pi, 2.0, 2.8, pi - 1e-3, pi];
    let mut cases = Vec::new();
    for theta_i in thetas {
        let mirrored = sums
            .iter()
            .map(|sum| sum - theta_i)
            .filter(|t| t.abs() <= right);
        for theta_o in thetas.into_iter().chain(mirrored) {
            // Along the tangent there is no azimuth.
            let phis = if theta_i.cos().min(theta_o.cos()) < ALONG {
                &phis[..1]
            } else {
                &phis[..]
            };
            cases.extend(phis.iter().map(|&phi| case(theta_i, theta_o, phi)));
        }
    }
    cases
}

/// Pipelines of one model, for any parameters.
pub struct Evaluator {
    evaluator: shading::Evaluator,
    /// Azimuths at which the reference is asked what a direction along the tangent may give; Chiang's far field, which is slow, has
    /// but R's wide lobe there.
    azimuths: u32,
}

impl Evaluator {
    pub fn new(device: &mut Device, shading: &Shading) -> Self {
        let (gpu, queue) = (device.renderer.device(), device.renderer.queue());
        let azimuths = if matches!(shading, Shading::Chiang(_)) {
            8
        } else {
            64
        };
        Self {
            evaluator: shading::Evaluator::new(gpu, queue).unwrap(),
            azimuths,
        }
    }

    /// `scatter` and `scatter_uniform` of every case.
    pub fn run(&self, shading: &Shading, cases: &[Case]) -> Vec<[DVec3; 2]> {
        let sample = |case: &Case| Sample {
            transmittance: (-case.fibres).exp() as f32,
            fibres: case.fibres as f32,
            strand: case.strand,
            coordinate: case.coordinate as f32,
            across: case.across.map(|h| h as f32),
            ..Sample::lit(case.tangent.as_vec3(), case.wi.as_vec3(), case.wo.as_vec3())
        };
        let samples: Vec<Sample> = cases.iter().map(sample).collect();
        let values = self.evaluator.scatter(shading, &samples).unwrap();
        let uniform = self.evaluator.uniform(shading, &samples).unwrap();
        std::iter::zip(values, uniform)
            .map(|(value, uniform)| [value.as_dvec3(), uniform.as_dvec3()])
            .collect()
    }

    /// The worst error of `scatter` against a model of the reference over unshadowed cases, of the largest value among them;
    /// and the case. Every value must be finite and not negative.
    pub fn worst(
        &self,
        name: &str,
        shading: &Shading,
        cases: &[Case],
        model: &impl FibreModel,
    ) -> f64 {
        let values = self.run(shading, cases);
        let (mut worst, mut at, mut peak) = (0.0f64, None, 0.0f64);
        for (case, [value, _]) in cases.iter().zip(values) {
            assert!(
                value.is_finite() && value.min_element() >= 0.0,
                "{name}: {value} at {case:?}"
            );
            let (wi, wo) = (seen(case.wi), seen(case.wo));
            let mut expected = model.scatter(wi, wo);
            if wi.cos_theta().min(wo.cos_theta()) < ALONG {
                let (mut low, mut high) = (expected, expected);
                for i in 0..=self.azimuths {
                    let phi =
                        wi.phi + std::f64::consts::PI * f64::from(i) / f64::from(self.azimuths);
                    let there = model.scatter(wi, Direction::new(wo.theta, phi));
                    (low, high) = (low.min(there), high.max(there));
                }
                expected = value.clamp(low, high);
            }
            peak = peak.max(expected.max_element());
            let off = (value - expected).abs().max_element();
            if off > worst {
                (worst, at) = (off, Some((wi, wo, value, expected)));
            }
        }
        let error = worst / peak;
        let place = at.map(|(wi, wo, value, expected)| {
            format!(
                "θ_i {:.4} θ_o {:.4} φ {:.4}: {value:.5} for {expected:.5}",
                wi.theta,
                wo.theta,
                wo.phi - wi.phi
            )
        });
        eprintln!(
            "{name}: worst {error:.2e} of the peak {peak:.3e} at {}",
            place.unwrap_or_default()
        );
        error
    }

    /// ∫ scatter dω_i at a view's inclination, by midpoints in both angles.
    pub fn furnace(&self, shading: &Shading, theta_o: f64, nodes: [usize; 2]) -> DVec3 {
        use std::f64::consts::{FRAC_PI_2, PI, TAU};
        let mut cases = Vec::new();
        let mut weights = Vec::new();
        for i in 0..nodes[0] {
            let theta = PI * (i as f64 + 0.5) / nodes[0] as f64 - FRAC_PI_2;
            for j in 0..nodes[1] {
                let phi = TAU * (j as f64 + 0.5) / nodes[1] as f64;
                cases.push(Case {
                    wi: direction(theta, phi),
                    ..case(0.0, theta_o, 0.0)
                });
                weights.push(theta.cos() * PI / nodes[0] as f64 * TAU / nodes[1] as f64);
            }
        }
        self.run(shading, &cases)
            .iter()
            .zip(weights)
            .map(|([value, _], weight)| *value * weight)
            .sum()
    }
}
