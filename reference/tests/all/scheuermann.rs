use pelage_reference::glam::DVec3;
use pelage_reference::kajiya_kay::{self, KajiyaKay};
use pelage_reference::scheuermann::{Highlight, Scheuermann, scatter};
use proptest::prelude::*;

/// Products of unit vectors, to a power of up to 500, as for Kajiya-Kay.
const ROUNDING: f64 = 1e-12;

fn highlight(value: f64, exponent: f64, shift: f64) -> Highlight {
    Highlight {
        colour: DVec3::splat(value),
        exponent,
        shift,
    }
}

fn at(theta: f64) -> DVec3 {
    DVec3::new(theta.sin(), theta.cos(), 0.0)
}

#[test]
fn without_shifts_it_is_kajiya_kay_with_two_exponents() {
    let model = Scheuermann {
        diffuse: DVec3::splat(0.3),
        primary: highlight(0.5, 80.0, 0.0),
        secondary: highlight(0.2, 10.0, 0.0),
    };
    let (t, l, e) = (
        DVec3::X,
        DVec3::new(0.2, 1.0, 0.3),
        DVec3::new(-0.1, 0.5, 1.0),
    );
    let lobe = |diffuse, specular, exponent| {
        kajiya_kay::scatter(
            t,
            l,
            e,
            &KajiyaKay {
                diffuse,
                specular,
                exponent,
            },
        )
    };
    let expected = lobe(0.3, 0.5, 80.0) + lobe(0.0, 0.2, 10.0);
    assert!(
        (scatter(t, l, e, &model) - DVec3::splat(expected))
            .abs()
            .max_element()
            < ROUNDING
    );
}

#[test]
fn a_positive_shift_moves_a_highlight_towards_the_root() {
    let delta: f64 = 0.1;
    let model = Scheuermann {
        diffuse: DVec3::ZERO,
        primary: highlight(1.0, 400.0, delta.tan()),
        secondary: highlight(0.0, 1.0, 0.0),
    };
    // Light across the fibre, eye in the same plane: the peak is at theta_i + theta_o = -2 delta.
    let value = |theta_o: f64| scatter(DVec3::X * 2.0, at(0.0), at(theta_o), &model).x;
    assert!((value(-2.0 * delta) - 1.0).abs() < ROUNDING);
    assert!(value(-2.0 * delta - 0.05) < 1.0 && value(-2.0 * delta + 0.05) < 1.0);
}

proptest! {
    #[test]
    fn values_lie_between_nothing_and_the_sum_of_the_coefficients(
        theta_i in crate::marschner::any_theta(), theta_o in crate::marschner::any_theta(), phi in -3.2..3.2f64,
        shifts in [-1.0..1.0f64, -1.0..1.0], exponents in [0.0..500.0f64, 0.0..500.0],
    ) {
        let model = Scheuermann {
            diffuse: DVec3::splat(0.3),
            primary: highlight(0.5, exponents[0], shifts[0]),
            secondary: highlight(0.2, exponents[1], shifts[1]),
        };
        let e = DVec3::new(theta_o.sin(), theta_o.cos() * phi.cos(), theta_o.cos() * phi.sin());
        let value = scatter(DVec3::X, at(theta_i), e, &model);
        prop_assert!(value.is_finite() && value.min_element() >= 0.0 && value.max_element() <= 1.0 + ROUNDING);
    }
}

#[test]
fn light_or_eye_along_the_fibre_is_no_trouble() {
    let model = Scheuermann {
        diffuse: DVec3::ONE,
        primary: highlight(1.0, 50.0, 0.1),
        secondary: highlight(1.0, 20.0, -0.1),
    };
    for (l, e) in [
        (DVec3::X, DVec3::X),
        (DVec3::Y, -DVec3::X),
        (DVec3::X, DVec3::Z),
    ] {
        let value = scatter(DVec3::X, l, e, &model);
        assert!(value.is_finite() && value.min_element() >= 0.0);
    }
}
