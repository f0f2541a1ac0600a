//! Tests of `pelage::transparency`.

mod a_buffer;
mod k_buffer;
mod k_buffer_single_pass;
mod k_plus_buffer;
mod kept;
mod moment;
mod opaque;
mod overflow;
