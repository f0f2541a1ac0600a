//! Where devices and targets come from.

pub mod offscreen;
