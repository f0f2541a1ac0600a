//! Tests of `pelage::shadow`.

mod approximated_deep_shadow_map;
mod deep_opacity_map;
mod every;
mod none;
mod opacity_shadow_maps;
mod shadow_map;
mod support;
