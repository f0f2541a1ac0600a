//! Tests of `pelage::shadow`.

mod deep_opacity_map;
mod every;
mod k_buffer_volume;
mod moment_opacity_map;
mod none;
mod support;
