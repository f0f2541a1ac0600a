//! Tests of `pelage::shadow`.

mod deep_opacity_map;
mod none;
