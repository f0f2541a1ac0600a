//! Double-precision ground truth for hair rendering, on the CPU.
//!
//! Everything here is derived from definitions and papers, runs in `f64`, and shares no code with the renderer whose
//! error it measures.
//!
//! - [`scene`]: strands and cameras as plain data
//! - [`project`]: strands on the screen, clipped at the near plane
//! - [`coverage`]: the area of a pixel that a fibre covers, exactly and by supersampling
//! - [`fragments`]: the exact list of fragments of every pixel
//! - [`composite`]: what those lists look like
//! - [`transmittance`]: how much light reaches a point through other fibres
//! - [`kajiya_kay`]: how a fibre scatters it
//! - [`error`]: how far one image is from another

pub mod composite;
pub mod coverage;
pub mod error;
pub mod fragments;
pub mod kajiya_kay;
pub mod project;
pub mod scene;
pub mod transmittance;

mod bvh;
mod random;

pub use glam;
