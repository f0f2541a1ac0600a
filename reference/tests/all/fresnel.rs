use pelage_reference::fresnel::{bravais, bravais_fresnel, fresnel};
use proptest::prelude::*;
use std::f64::consts::FRAC_PI_2;

/// A few dozen operations, and a square root of a difference near grazing incidence: measured 2.6e-13.
const ROUNDING: f64 = 1e-11;

#[test]
fn glass_reflects_four_per_cent_at_normal_incidence() {
    let r = fresnel(1.5, 1.0);
    assert!((r.perpendicular - 0.04).abs() < 1e-15 && (r.parallel - 0.04).abs() < 1e-15);
}

#[test]
fn at_brewsters_angle_nothing_is_reflected_in_the_plane_of_incidence() {
    let eta: f64 = 1.55;
    let r = fresnel(eta, eta.atan().cos());
    assert!(r.parallel < 1e-30 && r.perpendicular > 0.1, "{r:?}");
}

#[test]
fn beyond_the_critical_angle_all_is_reflected() {
    assert_eq!(fresnel(1.0 / 1.55, 0.5).unpolarised(), 1.0);
    assert_eq!(fresnel(1.55, 0.0).unpolarised(), 1.0);
}

proptest! {
    #[test]
    fn both_ways_through_a_surface_reflect_alike(eta in 1.01..3.0f64, cos_i in 0.0..1.0f64) {
        let sin_t = (1.0 - cos_i * cos_i).sqrt() / eta;
        let inside = fresnel(1.0 / eta, (1.0 - sin_t * sin_t).sqrt());
        prop_assert!((fresnel(eta, cos_i).unpolarised() - inside.unpolarised()).abs() < ROUNDING);
    }

    #[test]
    fn bravais_indices_reflect_unpolarised_light_as_space_does(
        eta in 1.01..3.0f64, theta in -1.55..1.55f64, cos_i in 0.001..1.0f64,
    ) {
        let plane = bravais_fresnel(eta, theta, cos_i).unpolarised();
        let space = fresnel(eta, theta.cos() * cos_i).unpolarised();
        prop_assert!((plane - space).abs() < ROUNDING, "{plane} {space}");
    }

    #[test]
    fn bravais_indices_multiply_to_the_square_of_the_index(eta in 1.01..3.0f64, theta in -1.57..1.57f64) {
        let (eta_perp, eta_par) = bravais(eta, theta);
        prop_assert!((eta_perp * eta_par - eta * eta).abs() < 1e-12 * eta * eta);
        prop_assert!(eta_perp >= eta * (1.0 - 1e-12));
    }
}

#[test]
fn along_the_fibre_the_index_is_as_large_as_numbers_go_and_all_is_reflected() {
    assert!(bravais(1.55, FRAC_PI_2).0 > 1e15);
    assert!(fresnel(1.55, FRAC_PI_2.cos()).unpolarised() > 1.0 - 1e-14);
}
