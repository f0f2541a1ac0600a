//! Tests of `pelage::shading`.

mod chiang;
mod dual_scattering;
mod harness;
mod kajiya_kay;
mod marschner;
mod reference;
mod sadeghi;
mod scheuermann;
mod tables;
mod truth;
