//! Tests of `pelage::shading`.

mod chiang;
mod continuity;
mod dual_scattering;
mod harness;
mod kajiya_kay;
mod marschner;
mod near_field;
mod rate;
mod reference;
mod roughness;
mod sadeghi;
mod scheuermann;
mod tables;
mod transmission;
mod truth;
