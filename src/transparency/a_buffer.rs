//! A-buffer: every fragment of a pixel stored, sorted and composited (Yang et al. 2010, Hunz §5.1).

use crate::error::{Result, invalid};
use crate::gpu::{Gpu, Group, Passes, PipelineKey};
use crate::layout::{OVERFLOW_WORDS, SCAN_BLOCK};
use crate::plan::{Band, Plan};
use crate::raster::{self, Draw, Emission, Footprint, Raster};
use crate::resources::Bound;
use crate::shader::{Constant, Module};
use crate::shading::Shader;
use crate::transparency::{Fragments, Needs, tail};

const COUNT: Emission = Emission {
    label: "pelage.transparency.a_buffer.count",
    stage: 0,
    files: &[
        "common/pixels",
        "transparency/emit_common",
        "transparency/overflow",
        "transparency/shaded",
        "transparency/tail_sums_emit",
        "transparency/tail_emit",
        "transparency/fragment_word",
        "transparency/a_buffer_store",
        "transparency/a_buffer_emit",
    ],
    group: Group::PixelsWritten,
    touch_only: true,
    footprint: Footprint::Square,
};
const RANGE: Emission = Emission {
    label: "pelage.transparency.a_buffer.overflow_range",
    stage: 1,
    ..COUNT
};
const HISTOGRAM: Emission = Emission {
    label: "pelage.transparency.a_buffer.overflow_histogram",
    stage: 2,
    ..COUNT
};
const SCATTER: Emission = Emission {
    label: "pelage.transparency.a_buffer.scatter",
    stage: 3,
    touch_only: false,
    ..COUNT
};
const SCATTER_OVERFLOW: Emission = Emission {
    label: "pelage.transparency.a_buffer.overflow_scatter",
    stage: 4,
    touch_only: false,
    ..COUNT
};
const LIST: Emission = Emission {
    label: "pelage.transparency.a_buffer.list",
    stage: 5,
    touch_only: false,
    ..COUNT
};

/// Workgroups that stride over the pixels: `OVERFLOW_STRIDE` / 64 in WGSL.
const OVERFLOW_WORKGROUPS: u32 = 256;

/// All stages.
pub(crate) const EMISSIONS: [Emission; 6] =
    [COUNT, RANGE, HISTOGRAM, SCATTER, SCATTER_OVERFLOW, LIST];

/// What lies behind this transmittance changes a pixel by less than 1/4096 of its own radiance.
pub(crate) const UNSEEN: f32 = 1.0 / 4096.0;
/// Rounds of the search for a pixel's share; each parts the depth range by four: 4⁵ = 1,024 depths a pixel.
const SEARCH_ROUNDS: u32 = 5;

/// Bytes of one stored fragment in counted arrays: depth key, point, opacity and place in one word of 64 bits.
pub const FRAGMENT_BYTES: u64 = 8;
/// Bytes of half of it, the upper or the lower one, which lie in bindings of their own.
pub(crate) const HALF_BYTES: u64 = 4;
/// Bytes of one node of a linked list: a fragment and the next node.
pub const NODE_BYTES: u64 = 12;

/// How the A-buffer keeps a pixel's fragments.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Storage {
    /// Counted first, then stored side by side: two passes, no shared counter.
    #[default]
    Counted,
    /// Per-pixel linked lists: one pass, one counter for all.
    Lists,
}

/// Settings of the A-buffer.
///
/// The same frame twice is bit-identical, except for a pixel of so many faint fragments that to order them takes too many steps
/// (some thousand, of which more than a thousand show): the farthest are merged, and their mean colour may change in its last bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ABuffer {
    /// How fragments are kept.
    pub storage: Storage,
    /// The rasteriser.
    pub raster: Raster,
    /// Bytes of the fragment pool. `None`: the library estimates, and grows it within the byte budget.
    pub pool_bytes: Option<u64>,
}

impl ABuffer {
    pub(crate) fn validate(&self) -> Result<()> {
        validate_pool("a_buffer", self.pool_bytes)
    }

    pub(crate) fn needs(&self, pixels: u64) -> Needs {
        let linked = self.storage == Storage::Lists;
        Needs {
            fill: pixels * 4,
            links: if linked { 0 } else { scan_words(pixels) * 4 },
            overflow: pixels * 4 * OVERFLOW_WORDS,
            fragments: Fragments::Pool {
                linked,
                bytes: self.pool_bytes,
            },
        }
    }
}

/// Refuses a pool that holds no fragment.
pub(crate) fn validate_pool(stem: &str, pool_bytes: Option<u64>) -> Result<()> {
    match pool_bytes {
        Some(bytes) if bytes < FRAGMENT_BYTES.max(NODE_BYTES) => {
            invalid!("{stem}: pool_bytes {bytes} holds no fragment; the least is {NODE_BYTES}")
        }
        _ => Ok(()),
    }
}

/// Words of the scan over `pixels` pixels: a place each, the total, and the blocks' sums.
pub(crate) fn scan_words(pixels: u64) -> u64 {
    pixels + 1 + pixels.div_ceil(u64::from(SCAN_BLOCK))
}

/// Clears what a band's fragments are counted in, and counts them where the storage asks for it.
pub(crate) fn count(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    draw: &Draw,
    plan: &Plan,
    storage: Storage,
) -> Result<()> {
    let pixels = plan.width * band.rows;
    passes.encode("pelage.transparency.a_buffer.clear", |encoder| {
        encoder.clear_buffer(&bound.pixels.fill.buffer, 0, Some(u64::from(pixels) * 4));
        if storage == Storage::Lists {
            encoder.clear_buffer(
                &bound.pixels.overflow.buffer,
                0,
                Some(u64::from(pixels) * 4 * OVERFLOW_WORDS),
            );
        }
        bound.clear_counters(encoder);
    });
    match storage {
        Storage::Lists => Ok(()),
        Storage::Counted => raster::record(gpu, passes, bound, &COUNT, draw, plan),
    }
}

/// Fills the A-buffer for a band of rows.
pub(crate) fn record(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    draw: &Draw,
    plan: &Plan,
    storage: Storage,
) -> Result<()> {
    match storage {
        Storage::Lists => raster::record(gpu, passes, bound, &LIST, draw, plan)?,
        Storage::Counted => store(gpu, passes, bound, band, draw, plan, &STORE)?,
    }
    bound.keep_counters(passes, band.number);
    Ok(())
}

/// The stages that store fragments that have been counted.
pub(crate) struct Store {
    pub range: Emission,
    pub histogram: Emission,
    pub scatter: Emission,
    pub scatter_overflow: Emission,
}

const STORE: Store = Store {
    range: RANGE,
    histogram: HISTOGRAM,
    scatter: SCATTER,
    scatter_overflow: SCATTER_OVERFLOW,
};

/// Turns the pixels' counts into places, and stores the fragments there.
pub(crate) fn store(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    draw: &Draw,
    plan: &Plan,
    stages: &Store,
) -> Result<()> {
    scan(gpu, passes, bound, band, plan, false)?;
    // From here to the scatter nothing is run, or all returns at once, where the pool suffices.
    bound.copy_arguments(passes);
    let overflowing = Draw {
        on_overflow: true,
        ..*draw
    };
    search(gpu, passes, bound, band, &overflowing, plan, stages)?;
    scan(gpu, passes, bound, band, plan, true)?;
    let overflow = &stages.scatter_overflow;
    raster::record(gpu, passes, bound, overflow, &overflowing, plan)?;
    raster::record(gpu, passes, bound, &stages.scatter, draw, plan)
}

/// Finds the depth up to which each pixel's nearest fragments fill its share of a pool that is too small.
fn search(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    draw: &Draw,
    plan: &Plan,
    stages: &Store,
) -> Result<()> {
    pixel_pass(
        gpu,
        passes,
        bound,
        band,
        plan,
        (
            "pelage.transparency.a_buffer.overflow_begin",
            "a_buffer_overflow_begin",
        ),
    )?;
    raster::record(gpu, passes, bound, &stages.range, draw, plan)?;
    pixel_pass(
        gpu,
        passes,
        bound,
        band,
        plan,
        (
            "pelage.transparency.a_buffer.overflow_width",
            "a_buffer_overflow_range",
        ),
    )?;
    for _ in 0..SEARCH_ROUNDS {
        raster::record(gpu, passes, bound, &stages.histogram, draw, plan)?;
        pixel_pass(
            gpu,
            passes,
            bound,
            band,
            plan,
            (
                "pelage.transparency.a_buffer.overflow_select",
                "a_buffer_overflow_select",
            ),
        )?;
    }
    pixel_pass(
        gpu,
        passes,
        bound,
        band,
        plan,
        (
            "pelage.transparency.a_buffer.overflow_end",
            "a_buffer_overflow_end",
        ),
    )
}

/// One of the search's passes over a band's pixels: label and entry point.
fn pixel_pass(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    plan: &Plan,
    (label, entry): (&'static str, &'static str),
) -> Result<()> {
    let groups = [Group::Frame, Group::PixelsWritten];
    let pipeline = gpu.compute(PipelineKey::new(label), entry, &groups, || {
        Module::new(&["transparency/overflow", "transparency/a_buffer_overflow"])
    })?;
    passes.compute(label, |pass| {
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(
            0,
            bound.frame,
            &[0, band.drawings[0], plan.runs[0].material],
        );
        pass.set_bind_group(3, bound.pixels_written, &[]);
        pass.dispatch_workgroups(OVERFLOW_WORKGROUPS, 1, 1);
    });
    Ok(())
}

/// Turns a band's pixel counts into places; `again` after the search has lowered them.
fn scan(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    plan: &Plan,
    again: bool,
) -> Result<()> {
    let blocks = (plan.width * band.rows).div_ceil(SCAN_BLOCK);
    let label = if again {
        "pelage.transparency.a_buffer.scan_again"
    } else {
        "pelage.transparency.a_buffer.scan"
    };
    let groups = [Group::Frame, Group::PixelsWritten];
    let mut pipelines = Vec::with_capacity(3);
    for (variant, entry) in ["scan_blocks", "scan_totals", "scan_add"]
        .into_iter()
        .enumerate()
    {
        let key = PipelineKey {
            variant: variant as u32,
            ..PipelineKey::new(label)
        };
        pipelines.push(gpu.compute(key, entry, &groups, || {
            Module::new(&["common/scan"]).with("SCAN_AGAIN", Constant::Bool(again))
        })?);
    }
    passes.compute(label, |pass| {
        pass.set_bind_group(
            0,
            bound.frame,
            &[0, band.drawings[0], plan.runs[0].material],
        );
        pass.set_bind_group(3, bound.pixels_written, &[]);
        for (pipeline, groups) in pipelines.iter().zip([blocks, 1, blocks]) {
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups(groups, 1, 1);
        }
    });
    Ok(())
}

/// The files that supply `resolve(pixel)`.
pub(crate) fn resolve_module(common: Module, storage: Storage, shader: Option<&Shader>) -> Module {
    common
        .and(&[
            "transparency/overflow",
            tail(shader),
            "transparency/tail",
            "transparency/a_buffer_whole",
            "transparency/fragment_word",
            "transparency/a_buffer_read",
            "transparency/a_buffer_sorted",
            "transparency/a_buffer",
        ])
        .with("LISTS", Constant::Bool(storage == Storage::Lists))
}
