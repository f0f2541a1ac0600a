//! Tests of `pelage::transparency`.

mod a_buffer;
mod opaque;
mod overflow;
