//! Tests of `pelage::shadow`.

mod approximated_deep_shadow_map;
mod convergence;
mod deep_opacity_map;
mod every;
mod k_buffer_volume;
mod moment_opacity_map;
mod none;
mod opacity_shadow_maps;
mod reuse;
mod shadow_map;
mod support;
