//! Properties of the reference: it is what all else is held to, so it is held to definitions.

mod blending;
mod chiang;
mod composite;
mod coverage;
mod dual_scattering;
mod error;
mod fibre;
mod fragments;
mod fresnel;
mod kajiya_kay;
mod marschner;
mod project;
mod ray_optics;
mod sadeghi;
mod scheuermann;
mod shadow_maps;
mod transmittance;

use pelage_reference::glam::DVec3;
use pelage_reference::scene::Strands;
use std::path::PathBuf;

/// A shared table's lines without the heading, or `None`, with a line on stderr, where it is not there.
pub fn truth_table(test: &str, name: &str) -> Option<Vec<String>> {
    let root = std::env::var_os("PELAGE_SHARED").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared")),
        PathBuf::from,
    );
    let text = std::fs::read_to_string(root.join("truth/fibre").join(name)).ok();
    if text.is_none() {
        eprintln!("skipped: {test}: truth/fibre/{name}");
    }
    Some(text?.lines().skip(1).map(String::from).collect())
}

/// The numbers of a table's line, from column `first` on.
pub fn numbers(line: &str, first: usize) -> Vec<f64> {
    line.split(',')
        .skip(first)
        .map(|field| field.parse().unwrap())
        .collect()
}

/// SplitMix64, for scenes that no property generates.
pub struct Random(pub u64);

impl Random {
    /// A number in [low, high).
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        low + (high - low) * (((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64)
    }

    /// A direction, all equally likely.
    pub fn direction(&mut self) -> DVec3 {
        let z = self.within(-1.0, 1.0);
        let angle = self.within(0.0, std::f64::consts::TAU);
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * angle.cos(), r * angle.sin(), z)
    }

    /// A point of a box around the origin.
    pub fn point(&mut self, half: DVec3) -> DVec3 {
        DVec3::new(
            self.within(-half.x, half.x),
            self.within(-half.y, half.y),
            self.within(-half.z, half.z),
        )
    }
}

/// Wavy strands of `segments` segments in a box from -1 to 1, `length` long.
pub fn wavy_strands(
    strands: usize,
    segments: usize,
    length: f64,
    radius: f64,
    seed: u64,
) -> Strands {
    let mut random = Random(seed);
    Strands::from_polylines((0..strands).map(|_| {
        let mut at = random.point(DVec3::ONE);
        let mut direction = random.direction();
        let mut strand = vec![(at, radius)];
        for i in 0..segments {
            direction = (direction + random.direction() * 0.15).normalize();
            at += direction * (length / segments as f64);
            strand.push((at, radius * (1.0 - 0.5 * (i + 1) as f64 / segments as f64)));
        }
        strand
    }))
}
