//! Shoulder-length curls: locks that wind as helices, of either hand.

use super::comb::{Lock, Style, Winding, wind};
use crate::groom::{Curve, Stray};
use glam::Vec3;

/// The style.
pub(super) const STYLE: Style = Style {
    seed: 0x4355_524c,
    points: 33,
    curve: Curve::CatmullRom,
    first_segment: 1.0,
    longest: 0.36,
    cut_height: -0.170,
    layering: 0.06,
    volume: 0.024,
    leaders: 0.12,
    gather: [0.5, 0.95],
    tightness: 0.70,
    clump: [0.5, 0.9],
    raggedness: 0.18,
    stray: Stray {
        fraction: 0.05,
        strength: 0.08,
    },
    shape,
};

/// A helix whose radius, turn, phase and hand belong to the lock.
fn shape(points: &mut [Vec3], lock: &mut Lock) {
    let radius = lock.shared.between(0.0060, 0.0115) * lock.own.between(0.85, 1.12);
    let curls = Winding {
        amplitude: [radius, radius],
        turn: lock.shared.between(0.038, 0.050),
        phase: std::f32::consts::TAU * lock.shared.uniform() + 0.35 * lock.own.signed(),
        onset: [0.015, 0.09],
        aligned_at: None,
        hand: if lock.shared.uniform() < 0.5 {
            -1.0
        } else {
            1.0
        },
    };
    let bend = Winding {
        amplitude: [
            lock.shared.between(0.002, 0.008),
            lock.shared.between(0.0, 0.005),
        ],
        turn: lock.shared.between(0.11, 0.2),
        phase: std::f32::consts::TAU * lock.shared.uniform(),
        onset: [0.03, 0.12],
        aligned_at: None,
        hand: 1.0,
    };
    // The slow bend first, so that the curls wind around it.
    wind(points, &bend);
    wind(points, &curls);
}
