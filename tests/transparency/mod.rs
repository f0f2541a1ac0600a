//! Tests of `pelage::transparency`.

mod a_buffer;
mod dbk_buffer;
mod opaque;
mod overflow;
