//! Hashes that serve as random numbers: the same input gives the same samples on every run.
//!
//! The mixing function is SplitMix64's finaliser (Steele, Lea and Flood, *Fast Splittable Pseudorandom Number
//! Generators*, 2014).

/// Scrambles 64 bits, so that inputs that differ in one bit give unrelated outputs.
pub(crate) fn hash(value: u64) -> u64 {
    let z = value.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// A number in [0, 1) that depends on `seed` and `index` alone.
pub(crate) fn unit(seed: u64, index: u64) -> f64 {
    let bits = hash(hash(seed) ^ index);
    // The upper 53 bits fill an f64's mantissa.
    (bits >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}
