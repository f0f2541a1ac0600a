//! Directions in the fibre's frame.

use crate::Random;
use pelage_reference::fibre::{Direction, wrap_to_pi};
use pelage_reference::glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

#[test]
fn a_vector_becomes_two_angles_and_back() {
    let mut random = Random(5);
    for _ in 0..1000 {
        let v = random.direction();
        let direction = Direction::from_vector(v * random.within(1e-3, 1e3));
        assert!((direction.to_vector() - v).length() < 1e-14);
    }
}

#[test]
fn a_vector_along_the_tangent_is_at_a_right_angle_and_one_near_it_keeps_its_small_angle() {
    let tip = Direction::from_vector(DVec3::X * 3.0);
    assert_eq!([tip.theta, tip.phi], [FRAC_PI_2, 0.0]);
    assert_eq!(Direction::from_vector(-DVec3::X).theta, -FRAC_PI_2);
    let near = Direction::from_vector(DVec3::new(1.0, 0.0, 1e-12));
    assert!((near.cos_theta() - 1e-12).abs() < 1e-16 && near.phi == FRAC_PI_2);
    assert_eq!(
        Direction::from_vector(DVec3::ZERO),
        Direction::new(0.0, 0.0)
    );
}

#[test]
fn a_frame_in_the_world_puts_the_first_axis_at_azimuth_zero() {
    let mut random = Random(6);
    let tangent = random.direction();
    let major = random.direction();
    let across = (major - tangent * tangent.dot(major)).normalize();
    let at = |v| Direction::in_frame(v, tangent, major);
    assert!(at(across).theta.abs() < 1e-15 && at(across).phi.abs() < 1e-15);
    let minor = at(tangent.cross(across));
    assert!((minor.phi - FRAC_PI_2).abs() < 1e-15);
    assert!((at(tangent).theta - FRAC_PI_2).abs() < 1e-7);
}

#[test]
fn angles_wrap_to_a_half_turn_either_way() {
    for k in -5..5 {
        assert!((wrap_to_pi(0.5 + TAU * f64::from(k)) - 0.5).abs() < 1e-14);
    }
    assert_eq!(wrap_to_pi(PI).abs(), PI);
}
