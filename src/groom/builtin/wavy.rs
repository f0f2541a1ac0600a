//! Long wavy hair: flat waves that run through each wisp together.

use super::comb::{Lock, Style, Winding, wind};
use crate::groom::{Curve, Stray};
use glam::Vec3;

/// The style.
pub(super) const STYLE: Style = Style {
    seed: 0x5741_5659,
    points: 33,
    curve: Curve::CatmullRom,
    first_segment: 1.0,
    longest: 0.48,
    cut_height: -0.205,
    layering: 0.05,
    volume: 0.024,
    leaders: 0.10,
    gather: [0.35, 0.8],
    tightness: 0.35,
    clump: [0.35, 0.9],
    raggedness: 0.25,
    stray: Stray {
        fraction: 0.04,
        strength: 0.07,
    },
    shape,
};

/// Waves of a wisp's own length and phase, mostly along the head.
fn shape(points: &mut [Vec3], lock: &mut Lock) {
    let size = lock.shared.between(0.75, 1.2) * lock.own.between(0.85, 1.15);
    // Neighbouring wisps swing together beside the ears and drift apart with their wavelengths.
    let waves = Winding {
        amplitude: [0.0095 * size, 0.0050 * size],
        turn: lock.shared.between(0.064, 0.074),
        phase: 0.8 * lock.shared.signed() + 0.3 * lock.own.signed(),
        onset: [0.04, 0.16],
        hand: 1.0,
        aligned_at: Some(0.03),
    };
    wind(points, &waves);
}
