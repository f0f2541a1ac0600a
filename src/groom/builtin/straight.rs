//! Long straight hair with a parting: to the shoulders and a little beyond, in soft layers.

use super::comb::{Lock, Style, Winding, wind};
use crate::groom::{Curve, Stray};
use glam::Vec3;

/// The style.
pub(super) const STYLE: Style = Style {
    seed: 0x5354_5241,
    points: 17,
    curve: Curve::Polyline,
    first_segment: 0.45,
    longest: 0.46,
    cut_height: -0.205,
    layering: 0.025,
    volume: 0.017,
    leaders: 0.13,
    gather: [0.15, 0.75],
    tightness: 0.12,
    clump: [0.35, 0.92],
    raggedness: 0.30,
    stray: Stray {
        fraction: 0.03,
        strength: 0.07,
    },
    shape,
};

/// A single long bend of a few millimetres, so that locks do not hang like wires.
fn shape(points: &mut [Vec3], lock: &mut Lock) {
    let bend = Winding {
        amplitude: [
            lock.shared.between(0.001, 0.004),
            lock.shared.between(0.0, 0.003),
        ],
        turn: lock.shared.between(0.16, 0.26),
        phase: std::f32::consts::TAU * lock.shared.uniform() + 0.5 * lock.own.signed(),
        onset: [0.06, 0.25],
        hand: 1.0,
        aligned_at: None,
    };
    wind(points, &bend);
}
