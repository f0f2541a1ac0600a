//! Tests of `pelage::shading`.

mod kajiya_kay;
