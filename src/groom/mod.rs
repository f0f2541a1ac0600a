//! Grooms: strands as plain, validated data, and the ways to make them. CPU only, no GPU types.

mod strands;

pub use strands::{Curve, Strands};
