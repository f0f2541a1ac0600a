//! The C ABI: what `include/pelage.h` declares. C hosts read that header; Rust hosts use the crate itself.
//!
//! Every function checks what it is given, converts it, makes one call of the crate, and returns a status. Handles wrap
//! ids that are never given out twice (`registry`), descriptors begin with their size (`descriptor`), nothing panics
//! across the boundary (`error`). The doc comments of public items become the header's; `cbindgen.toml` holds its opening.
//!
//! # Safety
//!
//! One rule for all functions: a pointer is NULL, or points to as much memory as its parameter's documentation says, which
//! no other thread changes during the call. Everything else that a host can get wrong is an error, not undefined behaviour.

// The rule above is that of every function; repeating it would fill the header.
#![allow(clippy::missing_safety_doc)]

mod descriptor;
mod input;
mod registry;

// In the header's order.
mod version;

mod error;
mod logging;

mod context;

mod settings;
mod strands;

mod hair;

mod target;

mod readback;

mod frame;
mod render;

mod statistics;

mod vulkan;

mod window;

pub use context::*;
pub use error::*;
pub use frame::*;
pub use hair::*;
pub use logging::*;
pub use readback::*;
pub use registry::{PelageContext, PelageHair, PelageReadback, PelageTarget};
pub use render::*;
pub use settings::*;
pub use statistics::*;
pub use strands::*;
pub use target::*;
pub use version::*;
pub use vulkan::*;
pub use window::*;
