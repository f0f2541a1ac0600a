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
//! - [`blending`]: what they look like to renderers that keep no order, or a coarse one
//! - [`k_buffer`], [`moment`]: what they look like to a renderer that keeps the nearest of them, or moments of all
//! - [`transmittance`]: how much light reaches a point through other fibres
//! - [`shadow_maps`]: what techniques make of that which look a point up in a map of the light
//! - [`opacity_models`]: what a few numbers a texel know of it
//! - [`k_buffer_volume`]: the nearest scattering events along a light's ray
//! - [`fibre`]: directions in a fibre's frame, lobes, and what every scattering model of a fibre offers
//! - [`kajiya_kay`], [`scheuermann`]: how a fibre scatters light, from fixed lobes
//! - [`marschner`], [`sadeghi`], [`chiang`]: the same from physics, from an artist's controls, and with all energy kept
//! - [`dual_scattering`]: light that more than one fibre scattered
//! - [`fresnel`], [`ray_optics`]: a dielectric's surface, and rays through a cylinder of it
//! - [`furnace`]: what a model returns of uniform light
//! - [`error`]: how far one image is from another

pub mod blending;
pub mod chiang;
pub mod composite;
pub mod coverage;
pub mod dual_scattering;
pub mod error;
pub mod fibre;
pub mod fragments;
pub mod fresnel;
pub mod furnace;
pub mod k_buffer;
pub mod k_buffer_volume;
pub mod kajiya_kay;
pub mod marschner;
pub mod moment;
pub mod opacity_models;
pub mod project;
pub mod ray_optics;
pub mod sadeghi;
pub mod scene;
pub mod scheuermann;
pub mod shadow_maps;
pub mod transmittance;

mod bvh;
mod quadrature;
mod random;

pub use glam;
