//! k-buffer from the A-buffer: of a pixel's stored fragments the K nearest are composited (Yu et al. 2012, §5.1).
//!
//! Yu states that keeping K in registers is 2.6 times as fast as a selection sort of the K foremost at K = 16, and 6.2 times at
//! K = 64. On lavapipe 22.3.6 with two cores that does not show in whole frames: 10,000 strands at opacity 0.5, 328×430, counted
//! arrays by the walk, nothing else running, in ms:
//!
//! | K | registers | rounds of eight | selection sort |
//! |---|---|---|---|
//! | 16 | 274 | 295 | 310 |
//! | 64 | 536 | 440 | 576 |
//!
//! Why is not profiled; a whole frame is more than its resolve.

use crate::error::{Result, invalid};
use crate::raster::Raster;
use crate::shader::{Constant, Module};
use crate::shading::Shader;
use crate::transparency::a_buffer::{self, ABuffer, Storage};
use crate::transparency::tail;

/// The most fragments of a pixel that a k-buffer keeps.
pub const MAX_K: u32 = 64;

/// What becomes of the fragments behind the K nearest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Rest {
    /// One layer behind them of exact opacity, in the mean of their own colours.
    #[default]
    Merged,
    /// One layer behind them of exact opacity, in the mean colour of the K. None of the rest is shaded.
    Alpha,
    /// Left out, as published: hair of many thin layers is too transparent.
    Dropped,
}

/// How many fragments one way through a pixel's list selects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Selection {
    /// All K (Yu).
    #[default]
    Registers,
    /// Eight, as often as it takes.
    Rounds,
    /// One: a selection sort of the K foremost (Yang et al. 2010), for comparison.
    Sort,
}

/// Settings of the k-buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct KBuffer {
    /// Fragments of a pixel that keep their order, from 1 to [`MAX_K`].
    pub k: u32,
    /// What becomes of those behind them.
    pub rest: Rest,
    /// How they are selected. The picture does not depend on it.
    pub selection: Selection,
    /// How fragments are stored.
    pub storage: Storage,
    /// The rasteriser.
    pub raster: Raster,
    /// Bytes of the fragment pool. `None`: the library estimates, and grows it within the byte budget.
    pub pool_bytes: Option<u64>,
}

impl Default for KBuffer {
    fn default() -> Self {
        let ABuffer {
            storage,
            raster,
            pool_bytes,
        } = ABuffer::default();
        Self {
            k: 16,
            rest: Rest::default(),
            selection: Selection::default(),
            storage,
            raster,
            pool_bytes,
        }
    }
}

impl KBuffer {
    pub(crate) fn validate(&self) -> Result<()> {
        validate_k("k_buffer", self.k)?;
        a_buffer::validate_pool("k_buffer", self.pool_bytes)
    }

    /// The A-buffer that it is made from.
    pub(crate) fn stored(&self) -> ABuffer {
        ABuffer {
            storage: self.storage,
            raster: self.raster,
            pool_bytes: self.pool_bytes,
        }
    }

    fn registers(&self) -> u32 {
        match self.selection {
            Selection::Registers => self.k,
            Selection::Rounds => self.k.min(8),
            Selection::Sort => 1,
        }
    }

    /// Settings that make another pipeline, in 12 bits.
    pub(crate) fn variant(&self) -> u32 {
        ((self.k * 4 + rest_word(self.rest)) * 4 + self.selection as u32) * 2
            + u32::from(self.storage == Storage::Lists)
    }
}

/// Refuses a number of fragments out of its range.
pub(crate) fn validate_k(stem: &str, k: u32) -> Result<()> {
    if (1..=MAX_K).contains(&k) {
        return Ok(());
    }
    invalid!("{stem}: k {k} is not from 1 to {MAX_K}")
}

/// `REST` in WGSL.
pub(crate) fn rest_word(rest: Rest) -> u32 {
    match rest {
        Rest::Merged => 0,
        Rest::Alpha => 1,
        Rest::Dropped => 2,
    }
}

/// The files that supply `resolve(pixel)`.
pub(crate) fn resolve_module(
    common: Module,
    settings: &KBuffer,
    shader: Option<&Shader>,
) -> Module {
    common
        .and(&[
            "transparency/overflow",
            tail(shader),
            "transparency/tail",
            "transparency/a_buffer_whole",
            "transparency/fragment_word",
            "transparency/a_buffer_read",
            "transparency/k_buffer",
        ])
        .with("LISTS", Constant::Bool(settings.storage == Storage::Lists))
        .with("K", Constant::U32(settings.k))
        .with("REGISTERS", Constant::U32(settings.registers()))
        .with("REST", Constant::U32(rest_word(settings.rest)))
}
