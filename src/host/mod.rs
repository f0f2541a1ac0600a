//! Where devices and targets come from.

pub mod offscreen;
mod readback;
mod write_depth;

pub use readback::Readback;
