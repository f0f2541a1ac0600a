//! All tests of the library as one binary.

mod capi;
mod common;
mod composite;
mod frame;
mod groom;
mod guided;
mod limits;
mod moving;
mod occluder;
mod outputs;
mod raster;
mod render;
mod shaders;
mod shading;
mod shadow;
mod shadow_image;
mod subresources;
mod transparency;
mod wgpu_host;
