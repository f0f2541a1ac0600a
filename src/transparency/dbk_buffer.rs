//! DBK-buffer: an A-buffer that stores nothing behind a depth of each pixel (Hunz §5.3). Hunz's user guesses that depth, as
//! a shift behind the nearest fragment. Here the host gives a tolerance ε instead, and the depth is found:
//!
//! A first walk sums every fragment's optical depth Ω = -ln(1 - opacity) in eight bins of depth a pixel, rounded down, and counts
//! it. The cut-off is the end of the bin in which the sum reaches -ln ε. With K the fragments before it and R the rest,
//! the pixel's exact alpha is 1 - T_K T_R and the drawn one 1 - T_K; they differ by T_K (1 - T_R) ≤ T_K ≤ ε. The colour lacks
//! T_K times the rest's own composite, which is no brighter than its brightest fragment: ε times that at most. The resolve stops
//! where the transmittance is ε, by the same bound: where finding cut-offs would take longer than it saves, that alone is done. What
//! it leaves out it takes to hide as much, each, as what it has composited, and to have the colour of the first that it leaves out:
//! whatever the guess is, alpha errs by T_K at most, and colour by T_K times the brightest that is left out.
//!
//! Where a pixel's bins lie is a guess: an estimate of the optical depth in its tile of 8×8 pixels, from one place on each
//! segment, says between which depths the cut-off is likely. It bounds nothing: what is nearer falls into the first bin, what is
//! farther into the last, and a poor guess only costs memory.

use crate::error::{Result, invalid};
use crate::geometry::{self, Projection};
use crate::gpu::{Gpu, Group, Passes, PipelineKey, workgroups};
use crate::layout::HOST_TILE;
use crate::plan::{Band, POOL_MARGIN, Plan};
use crate::raster::{self, Draw, Emission, Footprint, Raster, Rasteriser};
use crate::resources::Bound;
use crate::shader::{Constant, Module};
use crate::shading::Shader;
use crate::transparency::a_buffer::{self, Store, scan_words, validate_pool};
use crate::transparency::{Fragments, Needs, tail};

const BINS: Emission = Emission {
    label: "pelage.transparency.dbk_buffer.bins",
    stage: 0,
    files: &[
        "common/pixels",
        "transparency/emit_common",
        "transparency/overflow",
        "transparency/shaded",
        "transparency/tail_sums_emit",
        "transparency/dbk_buffer_common",
        "transparency/tail_emit",
        "transparency/fragment_word",
        "transparency/a_buffer_store",
        "transparency/dbk_buffer_emit",
    ],
    group: Group::PixelsWritten,
    touch_only: false,
    footprint: Footprint::Square,
};
const STORE: Store = Store {
    range: Emission {
        label: "pelage.transparency.dbk_buffer.overflow_range",
        stage: 1,
        touch_only: true,
        ..BINS
    },
    histogram: Emission {
        label: "pelage.transparency.dbk_buffer.overflow_histogram",
        stage: 2,
        touch_only: true,
        ..BINS
    },
    scatter: Emission {
        label: "pelage.transparency.dbk_buffer.scatter",
        stage: 3,
        ..BINS
    },
    scatter_overflow: Emission {
        label: "pelage.transparency.dbk_buffer.overflow_scatter",
        stage: 4,
        ..BINS
    },
};
const FRONT: Emission = Emission {
    label: "pelage.transparency.dbk_buffer.front",
    stage: 5,
    touch_only: true,
    ..BINS
};
const KEPT: Emission = Emission {
    label: "pelage.transparency.dbk_buffer.kept",
    stage: 6,
    ..BINS
};
const STORE_BY_SHIFT: Store = Store {
    range: Emission {
        label: "pelage.transparency.dbk_buffer.shift.overflow_range",
        stage: 7,
        ..STORE.range
    },
    histogram: Emission {
        label: "pelage.transparency.dbk_buffer.shift.overflow_histogram",
        stage: 8,
        ..STORE.histogram
    },
    scatter: Emission {
        label: "pelage.transparency.dbk_buffer.shift.scatter",
        stage: 9,
        ..STORE.scatter
    },
    scatter_overflow: Emission {
        label: "pelage.transparency.dbk_buffer.shift.overflow_scatter",
        stage: 10,
        ..STORE.scatter_overflow
    },
};

/// All stages.
pub(crate) const EMISSIONS: [Emission; 11] = [
    BINS,
    STORE.range,
    STORE.histogram,
    STORE.scatter,
    STORE.scatter_overflow,
    FRONT,
    KEPT,
    STORE_BY_SHIFT.range,
    STORE_BY_SHIFT.histogram,
    STORE_BY_SHIFT.scatter,
    STORE_BY_SHIFT.scatter_overflow,
];

/// Pixels a side of the tiles whose depths place the bins; `DBK_TILE` in WGSL.
const TILE: u32 = 8;
/// Words a pixel: bins, and by a depth shift what lies beyond; `DBK_BINS` and `DBK_BEYOND_WORDS` in WGSL.
const BIN_WORDS: u64 = 8;
/// Words of a tile's histogram; `DBK_STEPS` in WGSL. All of them fit where the bins come later.
const STEPS: u64 = 64;
const BEYOND_WORDS: u64 = 3;

/// When the DBK-buffer looks for cut-offs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum Culling {
    /// Where an estimate says that it saves more time than it takes, or that `pool_bytes`, or the device's bindings,
    /// hold fewer fragments than there are. Elsewhere all are stored; the error is bounded all the same.
    #[default]
    Auto,
    /// In every frame: the fewest fragments are stored.
    Always,
}

/// Settings of the DBK-buffer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DbkBuffer {
    /// When cut-offs are looked for; by a depth shift they always are.
    pub culling: Culling,
    /// How much of a pixel's alpha, and of its culled hair's radiance, may be left out: from 1e-6 to 0.5.
    pub epsilon: f32,
    /// Hunz's own form: what lies farther than this behind the nearest fragment, in host units along the ray, is drawn as
    /// one opaque layer. It decides in place of `epsilon`, and nothing bounds its error.
    pub depth_shift: Option<f32>,
    /// The rasteriser.
    pub raster: Raster,
    /// Bytes of the fragment pool. `None`: the library estimates, and grows it within the byte budget. Where cut-offs are looked
    /// for by `epsilon` it estimates what is kept: should a first frame keep more, what does not fit is merged, as in a pool that
    /// is too small, and the next frames' pool holds it.
    pub pool_bytes: Option<u64>,
}

impl Default for DbkBuffer {
    fn default() -> Self {
        Self {
            culling: Culling::Auto,
            epsilon: 1.0 / 256.0,
            depth_shift: None,
            raster: Raster::Auto,
            pool_bytes: None,
        }
    }
}

impl DbkBuffer {
    pub(crate) fn validate(&self) -> Result<()> {
        if !(1e-6..=0.5).contains(&self.epsilon) {
            return invalid!(
                "dbk_buffer: epsilon {} is not between 1e-6 and 0.5",
                self.epsilon
            );
        }
        if let Some(shift) = self.depth_shift
            && !(shift >= 0.0 && shift.is_finite())
        {
            return invalid!("dbk_buffer: depth_shift {shift} is negative or not finite");
        }
        validate_pool("dbk_buffer", self.pool_bytes)
    }

    /// The optical depth at which a pixel is cut off: a little more than -ln ε, for the rounding of optical depths.
    pub(crate) fn cut_depth(&self) -> f32 {
        -self.epsilon.ln() * 1.001
    }

    /// Whether this frame's cut-offs are looked for, with so many fragments expected, at most so many held by this device's
    /// bindings, and where they would save time.
    pub(crate) fn cuts(&self, fragments: f64, most: u64, pays: bool) -> bool {
        let held = self
            .pool_bytes
            .map(|bytes| bytes / a_buffer::FRAGMENT_BYTES);
        self.depth_shift.is_some()
            || self.culling == Culling::Always
            || pays
            || fragments * POOL_MARGIN > most as f64
            || held.is_some_and(|held| held < fragments as u64)
    }

    pub(crate) fn needs(&self, pixels: u64) -> Needs {
        let beyond = if self.depth_shift.is_some() {
            BEYOND_WORDS
        } else {
            0
        };
        // An image of any shape has at most so many tiles of 8×8 pixels.
        let tiles = pixels / 8 + 1;
        Needs {
            fill: pixels * 8 + tiles * 8,
            links: scan_words(pixels) * 4,
            overflow: (pixels * (BIN_WORDS + beyond) + STEPS) * 4,
            fragments: Fragments::Pool {
                linked: false,
                bytes: self.pool_bytes,
            },
        }
    }
}

/// Finds each pixel's cut-off, and drops the segments that lie behind all of theirs.
pub(crate) fn count(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    draw: &Draw,
    plan: &Plan,
    settings: &DbkBuffer,
) -> Result<()> {
    let pixels = u64::from(plan.width) * u64::from(band.rows);
    let needs = settings.needs(pixels);
    passes.encode("pelage.transparency.dbk_buffer.clear", |encoder| {
        encoder.clear_buffer(&bound.pixels.fill.buffer, 0, Some(needs.fill));
        encoder.clear_buffer(&bound.pixels.links.buffer, 0, Some(pixels * 4));
        encoder.clear_buffer(&bound.pixels.overflow.buffer, 0, Some(needs.overflow));
        bound.clear_counters(encoder);
    });
    if settings.depth_shift.is_some() {
        raster::record(gpu, passes, bound, &FRONT, draw, plan)?;
        pixel_pass(gpu, passes, bound, band, plan, &SHIFT)?;
        raster::record(gpu, passes, bound, &KEPT, draw, plan)?;
        return pixel_pass(gpu, passes, bound, band, plan, &KEPT_COUNTS);
    }
    for step in [&DEPTHS, &ESTIMATE] {
        point_pass(gpu, passes, bound, band, plan, step)?;
    }
    pixel_pass(gpu, passes, bound, band, plan, &RANGES)?;
    raster::record(gpu, passes, bound, &BINS, draw, plan)?;
    pixel_pass(gpu, passes, bound, band, plan, &CUT)?;
    // What one band does not need another may.
    if plan.bands.len() > 1 {
        return Ok(());
    }
    pixel_pass(gpu, passes, bound, band, plan, &TILES)?;
    point_pass(gpu, passes, bound, band, plan, &DROP)?;
    if draw.rasteriser == Rasteriser::Walk {
        let label = "pelage.transparency.dbk_buffer.order";
        geometry::order(gpu, passes, bound, label, draw.drawings, plan)?;
    }
    Ok(())
}

/// Stores what is not cut off.
pub(crate) fn record(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    draw: &Draw,
    plan: &Plan,
    settings: &DbkBuffer,
) -> Result<()> {
    let stages = if settings.depth_shift.is_some() {
        &STORE_BY_SHIFT
    } else {
        &STORE
    };
    a_buffer::store(gpu, passes, bound, band, draw, plan, stages)?;
    bound.keep_counters(passes, band.number);
    Ok(())
}

/// A pass over all points.
struct PointPass {
    label: &'static str,
    entry: &'static str,
    module: fn() -> Module,
    /// Whether it writes projected points, in place of the pixels' buffers.
    projects: bool,
}

const DEPTHS: PointPass = PointPass {
    label: "pelage.transparency.dbk_buffer.depths",
    entry: "dbk_buffer_depths",
    module: depths_module,
    projects: false,
};
const ESTIMATE: PointPass = PointPass {
    label: "pelage.transparency.dbk_buffer.estimate",
    entry: "dbk_buffer_estimate",
    ..DEPTHS
};
const DROP: PointPass = PointPass {
    label: "pelage.transparency.dbk_buffer.drop",
    entry: "dbk_buffer_drop",
    module: drop_module,
    projects: true,
};

fn point_pass(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    plan: &Plan,
    step: &PointPass,
) -> Result<()> {
    let groups: &[Group] = if step.projects {
        &[Group::Frame, Group::Project]
    } else {
        &[Group::Frame, Group::Segments, Group::PixelsWritten]
    };
    let key = PipelineKey::new(step.label);
    let pipeline = gpu.compute(key, step.entry, groups, step.module)?;
    passes.compute(step.label, |pass| {
        pass.set_pipeline(&pipeline);
        if !step.projects {
            pass.set_bind_group(3, bound.pixels_written, &[]);
        }
        for ((run, drawing), groups) in plan.runs.iter().zip(&band.drawings).zip(bound.runs) {
            pass.set_bind_group(0, bound.frame, &[0, *drawing, run.material]);
            let points = if step.projects {
                &groups.project
            } else {
                &groups.segments
            };
            pass.set_bind_group(1, points, &[]);
            let (x, y) = workgroups(run.run.count);
            pass.dispatch_workgroups(x, y, 1);
        }
    });
    Ok(())
}

/// A pass over a band's pixels, or tiles of them.
struct PixelPass {
    label: &'static str,
    entry: &'static str,
    module: fn() -> Module,
    /// Pixels a side.
    each: u32,
}

const RANGES: PixelPass = PixelPass {
    label: "pelage.transparency.dbk_buffer.ranges",
    entry: "dbk_buffer_ranges",
    module: pixels_module,
    each: TILE,
};

const CUT: PixelPass = PixelPass {
    label: "pelage.transparency.dbk_buffer.cut",
    entry: "dbk_buffer_cut",
    module: cut_module,
    each: 1,
};
const TILES: PixelPass = PixelPass {
    label: "pelage.transparency.dbk_buffer.tiles",
    entry: "dbk_buffer_tiles",
    module: pixels_module,
    each: HOST_TILE,
};
const SHIFT: PixelPass = PixelPass {
    label: "pelage.transparency.dbk_buffer.shift",
    entry: "dbk_buffer_shift",
    module: pixels_module,
    each: 1,
};
const KEPT_COUNTS: PixelPass = PixelPass {
    label: "pelage.transparency.dbk_buffer.kept_counts",
    entry: "dbk_buffer_kept",
    module: pixels_module,
    each: 1,
};

fn pixel_pass(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    plan: &Plan,
    step: &PixelPass,
) -> Result<()> {
    let groups = [Group::Frame, Group::HostTiles, Group::PixelsWritten];
    let key = PipelineKey::new(step.label);
    let pipeline = gpu.compute(key, step.entry, &groups, step.module)?;
    let (x, y) = workgroups(plan.width.div_ceil(step.each) * band.rows.div_ceil(step.each));
    passes.compute(step.label, |pass| {
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(
            0,
            bound.frame,
            &[0, band.drawings[0], plan.runs[0].material],
        );
        pass.set_bind_group(1, bound.host_tiles, &[]);
        pass.set_bind_group(3, bound.pixels_written, &[]);
        pass.dispatch_workgroups(x, y, 1);
    });
    Ok(())
}

/// The module of the points' depths.
pub(crate) fn depths_module() -> Module {
    Module::new(&[
        "common/pixels",
        "transparency/dbk_buffer_common",
        "transparency/dbk_buffer_depths",
    ])
}

/// The module that drops segments.
pub(crate) fn drop_module() -> Module {
    let projection = Projection {
        crosses: false,
        view: true,
    };
    projection.module(&["transparency/dbk_buffer_drop"])
}

/// The module of the pixels' passes.
pub(crate) fn pixels_module() -> Module {
    Module::new(&[
        "common/pixels",
        "transparency/dbk_buffer_common",
        "transparency/dbk_buffer",
    ])
}

/// The module of the pixels' cut-offs.
pub(crate) fn cut_module() -> Module {
    Module::new(&[
        "common/pixels",
        "transparency/dbk_buffer_common",
        "transparency/dbk_buffer_cut",
    ])
}

/// The files that supply `resolve(pixel)`.
pub(crate) fn resolve_module(
    common: Module,
    settings: &DbkBuffer,
    shader: Option<&Shader>,
) -> Module {
    let beyond: &[&'static str] = if settings.depth_shift.is_some() {
        &[
            "transparency/dbk_buffer_common",
            "transparency/dbk_buffer_beyond",
        ]
    } else {
        &["transparency/a_buffer_whole"]
    };
    common
        .and(&["transparency/overflow", tail(shader), "transparency/tail"])
        .and(beyond)
        .and(&[
            "transparency/fragment_word",
            "transparency/a_buffer_read",
            "transparency/a_buffer_sorted",
            "transparency/a_buffer",
        ])
        .with("LISTS", Constant::Bool(false))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_device_or_the_host_does_not_hold_is_culled() {
        let settings = DbkBuffer::default();
        let most = 33_000_000;
        assert!(!settings.cuts(26.4e6, most, false));
        assert!(settings.cuts(36.0e6, most, false));
        assert!(settings.cuts(26.4e6, most, true));
        let pool = DbkBuffer {
            pool_bytes: Some(1_000_000 * a_buffer::FRAGMENT_BYTES),
            ..settings
        };
        assert!(!pool.cuts(0.9e6, most, false));
        assert!(pool.cuts(1.1e6, most, false));
    }
}
