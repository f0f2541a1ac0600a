//! k⁺-buffer: the K nearest fragments of a pixel and no others (Vasilakis and Fudos 2014, Hunz §5.2).

use crate::error::{Error, Result};
use crate::gpu::{Gpu, Group, Passes};
use crate::plan::{Band, Plan};
use crate::raster::{self, Draw, Emission, Footprint, Raster};
use crate::resources::Bound;
use crate::shader::{Constant, Module};
use crate::transparency::k_buffer::{Rest, rest_word, validate_k};
use crate::transparency::{Fragments, Needs};

const INSERT_64: Emission = Emission {
    label: "pelage.transparency.k_plus_buffer.insert_64",
    stage: 0,
    files: &[
        "common/pixels",
        "transparency/emit_common",
        "transparency/overflow",
        "transparency/shaded",
        "transparency/fragment_word",
        "transparency/k_plus_buffer_word",
        "transparency/k_plus_buffer_emit",
        "transparency/k_plus_buffer_emit_64",
    ],
    group: Group::PixelsWritten,
    touch_only: false,
    footprint: Footprint::Square,
};
const INSERT_32: Emission = Emission {
    label: "pelage.transparency.k_plus_buffer.insert_32",
    files: &[
        "common/pixels",
        "transparency/emit_common",
        "transparency/overflow",
        "transparency/shaded",
        "transparency/fragment_word",
        "transparency/k_plus_buffer_word",
        "transparency/k_plus_buffer_emit",
        "transparency/k_plus_buffer_emit_32",
    ],
    ..INSERT_64
};
const STORE_32: Emission = Emission {
    label: "pelage.transparency.k_plus_buffer.store_32",
    stage: 1,
    ..INSERT_32
};

/// Words a pixel of the sums of all its fragments' colours; `K_PLUS_SUMS` in WGSL.
const SUMS: u64 = 5;
/// Bytes of one kept fragment.
const WORD_BYTES: u64 = 8;

/// The atomic operations that keep a pixel's fragments in order. The picture does not depend on them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Atomics {
    /// Of 64 bits where the device was opened with them, else of 32.
    #[default]
    Auto,
    /// One pass. The device needs `SHADER_INT64` and `SHADER_INT64_ATOMIC_ALL_OPS`.
    Bits64,
    /// Two passes, on any device.
    Bits32,
}

/// Settings of the k⁺-buffer. It takes 8 K + 4 bytes a pixel whatever the hair, 4 fewer where the rest is dropped, and 20 more
/// where it is merged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct KPlusBuffer {
    /// Fragments of a pixel that are kept, from 1 to [`crate::transparency::k_buffer::MAX_K`].
    pub k: u32,
    /// What becomes of those behind them.
    pub rest: Rest,
    /// Which atomic operations are used.
    pub atomics: Atomics,
    /// The rasteriser.
    pub raster: Raster,
}

impl Default for KPlusBuffer {
    fn default() -> Self {
        Self {
            k: 8,
            rest: Rest::Alpha,
            atomics: Atomics::default(),
            raster: Raster::default(),
        }
    }
}

impl KPlusBuffer {
    pub(crate) fn validate(&self) -> Result<()> {
        validate_k("k_plus_buffer", self.k)
    }

    pub(crate) fn fits(&self, gpu: &Gpu) -> Result<()> {
        if self.atomics == Atomics::Bits64 && !gpu.wide_atomics() {
            return Err(Error::Unsupported(
                "k_plus_buffer: the device was not opened with 64-bit atomics".into(),
            ));
        }
        Ok(())
    }

    pub(crate) fn needs(&self, pixels: u64) -> Needs {
        Needs {
            fill: if self.rest == Rest::Dropped {
                0
            } else {
                pixels * 4
            },
            links: 0,
            overflow: if self.rest == Rest::Merged {
                pixels * 4 * SUMS
            } else {
                0
            },
            fragments: Fragments::Fixed(pixels * WORD_BYTES * u64::from(self.k)),
        }
    }

    /// Settings that make another pipeline, in 12 bits.
    pub(crate) fn variant(&self) -> u32 {
        self.k << 2 | rest_word(self.rest)
    }

    fn stage(&self, emission: Emission) -> Emission {
        Emission {
            stage: emission.stage | self.variant() << 1,
            ..emission
        }
    }

    /// The stages in either form, the 64-bit one first.
    pub(crate) fn emissions(&self) -> [Emission; 3] {
        [INSERT_64, INSERT_32, STORE_32].map(|emission| self.stage(emission))
    }
}

pub(crate) fn record(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    draw: &Draw,
    plan: &Plan,
    settings: &KPlusBuffer,
) -> Result<()> {
    let needs = settings.needs(u64::from(plan.width) * u64::from(band.rows));
    let Fragments::Fixed(words) = needs.fragments else {
        return Ok(());
    };
    passes.encode("pelage.transparency.k_plus_buffer.clear", |encoder| {
        for (buffer, bytes) in [
            (&bound.pixels.fill, needs.fill),
            (&bound.pixels.overflow, needs.overflow),
            (&bound.pixels.fragments[0], words),
        ] {
            if bytes > 0 {
                encoder.clear_buffer(&buffer.buffer, 0, Some(bytes));
            }
        }
        bound.clear_counters(encoder);
    });
    let [insert_64, insert_32, store_32] = settings.emissions();
    if settings.atomics != Atomics::Bits32 && gpu.wide_atomics() {
        raster::record(gpu, passes, bound, &insert_64, draw, plan)?;
    } else {
        raster::record(gpu, passes, bound, &insert_32, draw, plan)?;
        raster::record(gpu, passes, bound, &store_32, draw, plan)?;
    }
    bound.keep_counters(passes, band.number);
    Ok(())
}

/// The files that supply `resolve(pixel)`.
pub(crate) fn resolve_module(common: Module, settings: &KPlusBuffer) -> Module {
    common
        .and(&[
            "transparency/overflow",
            "transparency/fragment_word",
            "transparency/k_plus_buffer_word",
            "transparency/k_plus_buffer",
        ])
        .with("K", Constant::U32(settings.k))
        .with("REST", Constant::U32(rest_word(settings.rest)))
}
