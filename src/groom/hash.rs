//! Random choices as a pure function of (strand, seed): the same groom on every machine, run and thread count.
//!
//! The generator is the 32-bit PCG hash (a linear congruential step, then a permuting xorshift-multiply), as evaluated
//! for graphics by Jarzynski and Olano, *Hash Functions for GPU Rendering*, JCGT 9(3), 2020.

use glam::Vec3;

/// One round of the 32-bit PCG hash; a bijection of `value`.
pub(crate) fn pcg(value: u32) -> u32 {
    let state = value.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// The random numbers that belong to one strand (or triangle, or guide): draw 0, 1, 2 … of (strand, seed).
#[derive(Debug, Clone)]
pub(crate) struct Draws {
    key: u32,
    drawn: u32,
}

impl Draws {
    /// The draws of `strand` under `seed`.
    pub(crate) fn new(strand: u32, seed: u32) -> Self {
        Self {
            key: pcg(strand ^ pcg(seed)),
            drawn: 0,
        }
    }

    /// The next number, uniform in [0, 1).
    pub(crate) fn uniform(&mut self) -> f32 {
        self.drawn = self.drawn.wrapping_add(1);
        let bits = pcg(self.key ^ pcg(self.drawn));
        // 24 bits fill the mantissa, so that rounding never reaches 1.
        (bits >> 8) as f32 / (1 << 24) as f32
    }

    /// The next number, uniform in [-1, 1).
    pub(crate) fn signed(&mut self) -> f32 {
        2.0 * self.uniform() - 1.0
    }

    /// The next number between `low` and `high`.
    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.uniform()
    }

    /// A unit vector, uniform over the sphere (two draws).
    pub(crate) fn direction(&mut self) -> Vec3 {
        let (z, phi) = (self.signed(), std::f32::consts::TAU * self.uniform());
        let rho = (1.0 - z * z).max(0.0).sqrt();
        Vec3::new(rho * phi.cos(), rho * phi.sin(), z)
    }

    /// Barycentrics uniform over a triangle (two draws): the unit square's upper half is folded onto the lower.
    pub(crate) fn barycentrics(&mut self) -> [f32; 3] {
        self.corner_barycentrics(1.0)
    }

    /// Barycentrics whose last two weights are drawn below `reach` and then folded so that all three are at least 0.
    pub(crate) fn corner_barycentrics(&mut self, reach: f32) -> [f32; 3] {
        let (v1, v2) = (reach * self.uniform(), reach * self.uniform());
        let (v1, v2) = if v1 + v2 > 1.0 {
            (1.0 - v1, 1.0 - v2)
        } else {
            (v1, v2)
        };
        [(1.0 - v1 - v2).max(0.0), v1, v2]
    }
}
