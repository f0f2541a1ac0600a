use crate::{numbers, truth_table};
use pelage_reference::glam::DVec2;
use pelage_reference::ray_optics::{PATHS, RayOptics, Scattered};

/// Rays of each run: 2^20, as the truth has.
pub const RAYS: usize = 1 << 20;

/// The truth's energies have six decimals: measured 4.9e-7.
const ENERGY: f64 = 2e-6;

/// Of the peak of a path's histogram, 99 % of the bins: the truth's R is noisy by this much against the exact function
/// too; measured 0.0055.
const BINS: f64 = 0.008;

/// Of the peak, any bin, caustics' included; measured 0.0102.
const WORST_BIN: f64 = 0.02;

/// A file of the truth, and the run that it should equal.
pub struct Case {
    pub file: &'static str,
    pub tracer: RayOptics,
    /// Energies as the truth's README has them.
    pub energies: [f64; PATHS],
}

pub fn cases() -> Vec<Case> {
    let case = |file, theta: f64, sigma_a, aspect, phi_i: f64, energies| Case {
        file,
        tracer: RayOptics {
            eta: 1.55,
            sigma_a,
            semi_axes: DVec2::new(1.0, aspect),
            theta_i: theta.to_radians(),
            phi_i: phi_i.to_radians(),
            rays: RAYS,
            bins: 720,
            seed: 1,
        },
        energies,
    };
    vec![
        case(
            "ray_optics_theta0_sigma0.0_aspect1.0_phi0.csv",
            0.0,
            0.0,
            1.0,
            0.0,
            [0.074955, 0.861791, 0.055672, 0.005622],
        ),
        case(
            "ray_optics_theta30_sigma0.2_aspect1.0_phi0.csv",
            30.0,
            0.2,
            1.0,
            0.0,
            [0.086181, 0.565367, 0.028362, 0.002337],
        ),
        case(
            "ray_optics_theta50_sigma0.0_aspect1.0_phi0.csv",
            50.0,
            0.0,
            1.0,
            0.0,
            [0.124407, 0.778072, 0.080755, 0.011936],
        ),
        case(
            "ray_optics_theta20_sigma0.1_aspect0.85_phi0.csv",
            20.0,
            0.1,
            0.85,
            0.0,
            [0.088250, 0.714837, 0.028309, 0.001142],
        ),
        case(
            "ray_optics_theta20_sigma0.1_aspect0.85_phi45.csv",
            20.0,
            0.1,
            0.85,
            45.0,
            [0.079088, 0.645128, 0.072662, 0.027082],
        ),
    ]
}

/// The columns N_R, N_TT, N_TRT, N_TRRT of a file, bin by bin.
pub fn truth_bins(test: &str, file: &str) -> Option<Vec<[f64; PATHS]>> {
    let bins = truth_table(test, file)?
        .iter()
        .map(|line| numbers(line, 1).try_into().unwrap())
        .collect();
    Some(bins)
}

pub fn peak(bins: &[[f64; PATHS]], p: usize) -> f64 {
    bins.iter().map(|bin| bin[p]).fold(0.0, f64::max)
}

#[test]
fn the_tracer_agrees_with_another_in_every_bin_and_in_energy() {
    for case in cases() {
        let Scattered {
            n_p,
            energy,
            cone_error,
        } = case.tracer.run();
        assert!(cone_error < 1e-12, "{}: {cone_error}", case.file);
        for (p, (own, truth)) in energy.iter().zip(case.energies).enumerate() {
            let off = (own - truth).abs();
            println!("{} p {p}: energy {own:.6} off {off:.1e}", case.file);
            assert!(off <= ENERGY, "{} p {p}: {off}", case.file);
        }
        let Some(truth) = truth_bins(
            "the_tracer_agrees_with_another_in_every_bin_and_in_energy",
            case.file,
        ) else {
            continue;
        };
        for p in 0..PATHS {
            let mut errors: Vec<f64> = n_p
                .iter()
                .zip(&truth)
                .map(|(a, b)| (a[p] - b[p]).abs() / peak(&truth, p))
                .collect();
            errors.sort_by(f64::total_cmp);
            let [p99, max] = [errors[712], errors[719]];
            println!("{} p {p}: p99 {p99:.5} max {max:.5}", case.file);
            assert!(
                p99 <= BINS && max <= WORST_BIN,
                "{} p {p}: {p99} {max}",
                case.file
            );
        }
    }
}

#[test]
fn without_absorption_what_four_paths_miss_is_little_and_no_light_is_made() {
    let tracer = RayOptics {
        rays: 1 << 14,
        ..cases().remove(0).tracer
    };
    let sum: f64 = tracer.run().energy.iter().sum();
    assert!(sum < 1.0 && sum > 0.997, "{sum}");
    let total: f64 = tracer.run().n_p.iter().flatten().sum::<f64>() * std::f64::consts::TAU / 720.0;
    assert!((total - sum).abs() < 1e-12);
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_does_not() {
    let tracer = RayOptics {
        rays: 10_000,
        ..cases().remove(4).tracer
    };
    assert_eq!(tracer.run(), tracer.run());
    assert_ne!(tracer.run(), RayOptics { seed: 2, ..tracer }.run());
}
