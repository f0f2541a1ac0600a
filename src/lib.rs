//! pelage renders hair and fur inside other people's programs.

pub mod capi;
mod composite;
pub mod error;
mod frame;
mod gather;
mod geometry;
mod gpu;
pub mod groom;
mod guided;
pub mod host;
mod layout;
mod light;
mod memory;
mod occluder;
mod plan;
pub mod raster;
mod renderer;
mod resources;
mod shader;
pub mod shading;
pub mod shadow;
mod statistics;
mod surface;
#[doc(hidden)]
pub mod testing;
pub mod transparency;
mod view;

pub use error::{Error, Result};
pub use frame::{Frame, NO_STRAND, Outputs, ShadowImage, Target};
pub use gather::PointSource;
pub use geometry::{Hair, Instance};
pub use glam;
pub use layout::{MAX_LIGHTS, MAX_OCCLUDERS};
pub use light::{Light, LightKind};
pub use memory::{MemoryEstimate, Viewport};
pub use occluder::Occluder;
pub use raster::Raster;
pub use renderer::Renderer;
pub use statistics::{Fragments, PassTime, Statistics};
pub use surface::{Subresource, Subresources};
pub use view::{PreviousView, View};
pub use wgpu;
