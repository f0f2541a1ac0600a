//! Single-pass k-buffer: each pixel's nearest fragments in a linked list that is in order from the start (Yu et al. 2012,
//! §5.2).

use crate::error::{Result, invalid};
use crate::gpu::{Gpu, Group, Passes};
use crate::layout::OVERFLOW_WORDS;
use crate::plan::{Band, Plan};
use crate::raster::{self, Draw, Emission, Footprint, Raster};
use crate::resources::Bound;
use crate::shader::{Constant, Module};
use crate::transparency::a_buffer::{self, validate_pool};
use crate::transparency::k_buffer::{Rest, rest_word, validate_k};
use crate::transparency::{Fragments, Needs};

const INSERT: Emission = Emission {
    label: "pelage.transparency.k_buffer_single_pass.insert",
    stage: 0,
    files: &[
        "common/pixels",
        "transparency/emit_common",
        "transparency/overflow",
        "transparency/shaded",
        "transparency/fragment_word",
        "transparency/k_buffer_single_pass_word",
        "transparency/k_buffer_single_pass_emit",
    ],
    group: Group::PixelsWritten,
    touch_only: false,
    footprint: Footprint::Square,
};

/// The most failures that can be asked for.
const MAX_RETRIES: u32 = 255;

/// Settings of the single-pass k-buffer. A fragment is stored unless K nearer ones already are, so that the pool takes what
/// was among the K nearest at any time: K (1 + ln(n / K)) of a pixel's n, if they come in no order.
///
/// The same frame twice is bit-identical as long as nothing fails. Which fragments miss out, where the pool is too small or a
/// fragment gives up after its retries, is the scheduler's choice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct KBufferSinglePass {
    /// Fragments of a pixel that keep their order, from 1 to [`crate::transparency::k_buffer::MAX_K`].
    pub k: u32,
    /// What becomes of those behind them.
    pub rest: Rest,
    /// How often a fragment tries again, where others were faster, before it is merged into its pixel's tail: up to 255.
    pub retries: u32,
    /// The rasteriser.
    pub raster: Raster,
    /// Bytes of the fragment pool. `None`: the library estimates, and grows it within the byte budget.
    pub pool_bytes: Option<u64>,
}

impl Default for KBufferSinglePass {
    fn default() -> Self {
        Self {
            k: 8,
            rest: Rest::default(),
            retries: 32,
            raster: Raster::default(),
            pool_bytes: None,
        }
    }
}

impl KBufferSinglePass {
    pub(crate) fn validate(&self) -> Result<()> {
        validate_k("k_buffer_single_pass", self.k)?;
        if self.retries > MAX_RETRIES {
            return invalid!(
                "k_buffer_single_pass: retries {} is more than {MAX_RETRIES}",
                self.retries
            );
        }
        validate_pool("k_buffer_single_pass", self.pool_bytes)
    }

    pub(crate) fn needs(&self, pixels: u64) -> Needs {
        Needs {
            fill: pixels * 4,
            links: 0,
            overflow: pixels * 4 * OVERFLOW_WORDS,
            fragments: Fragments::Pool {
                linked: true,
                bytes: self.pool_bytes,
            },
        }
    }

    /// Nodes that `fragments` in `pixels` pixels are expected to take.
    pub(crate) fn expected(&self, fragments: u64, pixels: u64) -> u64 {
        let (k, each) = (f64::from(self.k), fragments as f64 / pixels.max(1) as f64);
        if each <= k {
            return fragments;
        }
        (pixels as f64 * k * (1.0 + (each / k).ln())) as u64
    }

    /// Settings that make another composite pipeline, in 12 bits.
    pub(crate) fn variant(&self) -> u32 {
        self.k << 2 | rest_word(self.rest)
    }

    /// The stage with the settings in it.
    pub(crate) fn emission(&self) -> Emission {
        Emission {
            stage: self.variant() | self.retries << 9,
            ..INSERT
        }
    }
}

pub(crate) fn record(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    draw: &Draw,
    plan: &Plan,
    settings: &KBufferSinglePass,
) -> Result<()> {
    let needs = settings.needs(u64::from(plan.width) * u64::from(band.rows));
    let capacity = u64::from(plan.frame_uniform.capacity);
    passes.encode(
        "pelage.transparency.k_buffer_single_pass.clear",
        |encoder| {
            let mut clear = |buffer: &wgpu::Buffer, bytes| {
                if bytes > 0 {
                    encoder.clear_buffer(buffer, 0, Some(bytes));
                }
            };
            clear(&bound.pixels.fill.buffer, needs.fill);
            clear(&bound.pixels.overflow.buffer, needs.overflow);
            clear(&bound.pixels.links.buffer, capacity * 4);
            for half in &bound.pixels.fragments {
                clear(&half.buffer, capacity * a_buffer::HALF_BYTES);
            }
            bound.clear_counters(encoder);
        },
    );
    raster::record(gpu, passes, bound, &settings.emission(), draw, plan)?;
    bound.keep_counters(passes, band.number);
    Ok(())
}

/// The files that supply `resolve(pixel)`.
pub(crate) fn resolve_module(common: Module, settings: &KBufferSinglePass) -> Module {
    common
        .and(&[
            "transparency/overflow",
            "transparency/fragment_word",
            "transparency/k_buffer_single_pass_word",
            "transparency/k_buffer_single_pass",
        ])
        .with("K", Constant::U32(settings.k))
        .with("REST", Constant::U32(rest_word(settings.rest)))
}
