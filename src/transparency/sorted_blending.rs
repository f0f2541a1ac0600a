//! Sorted blending: segments sorted into bins by the depth of their farther end, and blended in that order (Kim 2003, §3).
//!
//! The order is one of segments, not of fragments: where segments of one bin, or long ones, cross, it is wrong. It is the same
//! for every frame of the same hair and view.
//!
//! A draw in that order reads any point at any time, so that it binds the points of all hairs at once, and the sort its whole
//! histogram: in up to [`MAX_PARTS`] parts each, as many as the device's bindings ask for.

use crate::error::{Error, Result, invalid};
use crate::gpu::{Gpu, Group, Passes, PipelineKey, RenderSpec, workgroups};
use crate::layout::Projected;
use crate::plan::{Band, Plan};
use crate::raster::{Draw, Footprint};
use crate::resources::Bound;
use crate::shader::{Constant, Module};
use crate::transparency::{Fragments, Needs, nearest};

/// The most bins.
pub const MAX_BINS: u32 = 4096;
/// Points of the smallest chunk that one invocation sorts, and about how many chunks there are.
const SMALLEST_CHUNK: u64 = 256;
const CHUNKS: u64 = 1024;
/// The most chunks: an invocation walks through a bin's row of them.
const MAX_CHUNKS: u64 = 32768;
/// Bytes of one segment in the order.
const RECORD_BYTES: u64 = 8;
/// Bindings of what may be larger than one. A frame has no more points than 8 bytes each fit one binding, a third of a projected
/// point's: with what is lost to alignment that is more than three.
pub(crate) const MAX_PARTS: u32 = 4;
/// Elements that parts are multiples of: every device takes offsets that are multiples of 256 bytes.
const ALIGNED_POINTS: u64 = 32;
const ALIGNED_WORDS: u64 = 64;
const _: () = assert!((ALIGNED_POINTS * size_of::<Projected>() as u64).is_multiple_of(256));
/// The most elements of a part, whatever a device binds: the shaders count all parts' in 32 bits.
const MOST_EACH: u64 = 1 << 30;

/// The order in which segments are blended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum BlendOrder {
    /// Farthest first, each over what is there.
    #[default]
    BackToFront,
    /// Nearest first, each under what is there.
    FrontToBack,
}

/// Settings of sorted blending. It draws ribbons, whatever their width; 8 bytes a segment and 8 or 16 a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SortedBlending {
    /// Bins of depth over the extent of all hair, from 1 to [`MAX_BINS`].
    pub bins: u32,
    /// Which segments come first.
    pub order: BlendOrder,
    /// Frames after a sorted one that take its order, as long as they draw the same hair with the same opacity; 0: every
    /// frame is sorted. Frames are sorted until one that was is known to have run.
    pub reuse: u32,
    /// Blended as 32-bit floats where the device blends these, instead of 16-bit ones: these round at every layer and lose
    /// layers fainter than that, for an RMSE of 2.5e-3 in dense hair. However many fibres of opacity α there are, they may stay
    /// short of opaque by 2⁻¹¹ / α.
    pub full_precision: bool,
}

impl Default for SortedBlending {
    fn default() -> Self {
        Self {
            bins: 1024,
            order: BlendOrder::BackToFront,
            reuse: 0,
            full_precision: false,
        }
    }
}

impl SortedBlending {
    pub(crate) fn validate(&self) -> Result<()> {
        if !(1..=MAX_BINS).contains(&self.bins) {
            return invalid!(
                "sorted_blending: bins {} is not within 1 and {MAX_BINS}",
                self.bins
            );
        }
        Ok(())
    }

    /// The format of the image that segments are blended into.
    pub(crate) fn format(&self, gpu: &Gpu) -> wgpu::TextureFormat {
        let blendable = wgpu::Features::FLOAT32_BLENDABLE;
        if self.full_precision && gpu.device.features().contains(blendable) {
            wgpu::TextureFormat::Rgba32Float
        } else {
            wgpu::TextureFormat::Rgba16Float
        }
    }
}

/// How a frame's segments are shared out among the sort's invocations.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Sorting {
    pub bins: u64,
    /// Points of a chunk.
    pub each: u64,
    pub chunks: u64,
    /// Where each run's chunks begin.
    pub bases: Vec<u32>,
    /// All segments.
    pub count: u64,
    /// The points of all hairs, as the draw binds them.
    pub points: Parts,
    /// Words of the histogram: a row of chunks for each bin, and the bins' totals.
    pub histogram: Parts,
}

/// How elements are shared out among bindings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Parts {
    count: u64,
    /// Elements of each part but the last.
    each: u64,
}

impl Parts {
    /// Of `bytes` an element, in multiples of `aligned` elements. How large they are depends on the device alone.
    pub fn new(count: u64, bytes: u64, aligned: u64, binding: u64) -> Self {
        let each = binding / (aligned * bytes) * aligned;
        Self {
            count,
            each: each.clamp(1, MOST_EACH),
        }
    }

    /// How many they are.
    fn number(&self) -> u64 {
        self.count.div_ceil(self.each).max(1)
    }

    /// First element and number of elements of each part; of one that is not needed none.
    pub fn ranges(&self) -> [[u64; 2]; MAX_PARTS as usize] {
        std::array::from_fn(|part| match part as u64 * self.each {
            first if first < self.count => [first, self.each.min(self.count - first)],
            _ => [0; 2],
        })
    }

    /// The same as constants for shaders: parts, and elements of each but the last.
    fn constants(&self) -> [Constant; 2] {
        [self.number(), self.each].map(|value| Constant::U32(value as u32))
    }
}

impl Sorting {
    /// For runs of so many points and segments, whose pooled points are `points`.
    pub fn new(
        settings: &SortedBlending,
        runs: impl Iterator<Item = [u64; 2]> + Clone,
        points: u64,
        binding: u64,
    ) -> Result<Self> {
        let count: u64 = runs.clone().map(|[_, segments]| segments).sum();
        let each = points.div_ceil(CHUNKS).max(SMALLEST_CHUNK);
        let mut bases = Vec::new();
        let mut chunks = 0;
        for [points, _] in runs {
            bases.push(chunks as u32);
            chunks += points.div_ceil(each);
        }
        let (bins, chunks) = (u64::from(settings.bins), chunks.max(1));
        let [of_points, of_words] = [size_of::<Projected>() as u64, 4];
        let words = bins * chunks + bins;
        let sorting = Self {
            bins,
            each,
            chunks,
            bases,
            count,
            points: Parts::new(points, of_points, ALIGNED_POINTS, binding),
            histogram: Parts::new(words, of_words, ALIGNED_WORDS, binding),
        };
        let parts = sorting.points.number().max(sorting.histogram.number());
        if parts > u64::from(MAX_PARTS) || sorting.order_bytes() > binding || chunks > MAX_CHUNKS {
            return Err(Error::Unsupported(format!(
                "sorted_blending: {count} segments of {} runs in {bins} bins need {} bytes of points and {} of a histogram in \
                 {MAX_PARTS} bindings each, {} bytes of an order in one, and {chunks} chunks; this device binds {binding}, and \
                 {MAX_CHUNKS} chunks are taken",
                sorting.bases.len(),
                points * of_points,
                words * of_words,
                sorting.order_bytes(),
            )));
        }
        Ok(sorting)
    }

    pub fn order_bytes(&self) -> u64 {
        self.count * RECORD_BYTES
    }

    /// As the shaders read them.
    pub fn values(&self, order: BlendOrder) -> [f32; 4] {
        let front_to_back = f32::from(u8::from(order == BlendOrder::FrontToBack));
        [
            self.bins as f32,
            self.chunks as f32,
            self.each as f32,
            front_to_back,
        ]
    }
}

/// It keeps neither pixels nor fragments in buffers.
pub(crate) const NEEDS: Needs = Needs {
    fill: 0,
    links: 0,
    overflow: 0,
    fragments: Fragments::Fixed(0),
};

pub(crate) fn record(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    draw: &Draw,
    plan: &Plan,
    settings: &SortedBlending,
) -> Result<()> {
    passes.encode("pelage.transparency.sorted_blending.clear", |encoder| {
        bound.clear_counters(encoder);
    });
    if plan.sort && band.number == 0 {
        sort(gpu, passes, bound, band, plan)?;
    }
    blend(gpu, passes, bound, band, plan, settings)?;
    nearest::record(gpu, passes, bound, band, draw, plan)?;
    bound.keep_counters(passes, band.number);
    Ok(())
}

/// The files of the sort; its entry points are `sort_count`, `sort_rows`, `sort_totals` and `sort_scatter`.
pub(crate) fn sort_module(histogram: Parts) -> Module {
    let [parts, each] = histogram.constants();
    Module::new(&[
        "common/coverage",
        "common/run",
        "common/segment",
        "common/pixels",
        "transparency/sorted_blending_sort",
    ])
    .with("HISTOGRAM_PARTS", parts)
    .with("HISTOGRAM_EACH", each)
    .with("TOUCH_ONLY", Constant::Bool(true))
    .with("FOOTPRINT", Constant::U32(Footprint::Square as u32))
}

/// Sorts all segments.
fn sort(gpu: &mut Gpu, passes: &mut Passes, bound: &Bound, band: &Band, plan: &Plan) -> Result<()> {
    let label = "pelage.transparency.sorted_blending.sort";
    let Some(sorted) = bound.sorted else {
        return Err(Error::Internal("a sort without its buffers".into()));
    };
    let groups = [Group::Frame, Group::Segments, Group::Sorting];
    let mut pipelines = Vec::with_capacity(4);
    for (variant, entry) in ["sort_count", "sort_rows", "sort_totals", "sort_scatter"]
        .into_iter()
        .enumerate()
    {
        let key = PipelineKey {
            variant: (variant as u32) << 3 | plan.sorting.histogram.number() as u32,
            ..PipelineKey::new(label)
        };
        let module = || sort_module(plan.sorting.histogram);
        pipelines.push(gpu.compute(key, entry, &groups, module)?);
    }
    passes.encode(label, |encoder| {
        let histogram = plan.sorting.histogram;
        let parts = bound.histogram.iter().zip(histogram.ranges());
        for (part, [_, words]) in parts.take(histogram.number() as usize) {
            encoder.clear_buffer(&part.buffer, 0, Some(words * 4));
        }
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(label),
            timestamp_writes: None,
        });
        pass.set_bind_group(3, &sorted.sorting, &[]);
        for (step, pipeline) in pipelines.iter().enumerate() {
            pass.set_pipeline(pipeline);
            let all_runs = step == 0 || step == 3;
            for ((run, drawing), groups) in plan.runs.iter().zip(&band.drawings).zip(bound.runs) {
                pass.set_bind_group(0, bound.frame, &[0, *drawing, run.material]);
                pass.set_bind_group(1, &groups.segments, &[]);
                if !all_runs {
                    let bins = plan.sorting.bins as u32;
                    pass.dispatch_workgroups(if step == 1 { bins.div_ceil(64) } else { 1 }, 1, 1);
                    break;
                }
                let chunks = u64::from(run.run.count).div_ceil(plan.sorting.each);
                let (x, y) = workgroups(chunks as u32);
                pass.dispatch_workgroups(x, y, 1);
            }
        }
    });
    Ok(())
}

/// The files of the draw.
pub(crate) fn draw_module(points: Parts) -> Module {
    let [parts, each] = points.constants();
    Module::new(&[
        "common/coverage",
        "transparency/sorted_blending_points",
        "common/segment",
        "common/pixels",
        "transparency/emit_common",
        "transparency/shaded",
        "transparency/sorted_blending_draw",
    ])
    .with("POINT_PARTS", parts)
    .with("POINTS_EACH", each)
    .with("TOUCH_ONLY", Constant::Bool(false))
    .with("FOOTPRINT", Constant::U32(Footprint::Square as u32))
}

/// Each over, or under, what is there; premultiplied.
fn blend_state(order: BlendOrder) -> wgpu::BlendState {
    let under = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::OneMinusDstAlpha,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    };
    match order {
        BlendOrder::BackToFront => wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING,
        BlendOrder::FrontToBack => wgpu::BlendState {
            color: under,
            alpha: under,
        },
    }
}

/// Blends a band's segments in their order.
fn blend(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    band: &Band,
    plan: &Plan,
    settings: &SortedBlending,
) -> Result<()> {
    let label = "pelage.transparency.sorted_blending.blend";
    let Some(sorted) = bound.sorted else {
        return Err(Error::Internal("blending without an image".into()));
    };
    let format = settings.format(gpu);
    let key = PipelineKey {
        colour: Some(format),
        variant: (settings.order as u32) << 3 | plan.sorting.points.number() as u32,
        ..PipelineKey::new(label)
    };
    let pipeline = gpu.render(key, || RenderSpec {
        module: draw_module(plan.sorting.points),
        vertex: "sorted_blending_vertex",
        fragment: "sorted_blending_fragment",
        groups: &[Group::Frame, Group::SortedSegments, Group::Shaded],
        topology: wgpu::PrimitiveTopology::TriangleStrip,
        targets: vec![Some(wgpu::ColorTargetState {
            format,
            blend: Some(blend_state(settings.order)),
            write_mask: wgpu::ColorWrites::ALL,
        })],
        depth_stencil: None,
    })?;
    passes.encode(label, |encoder| {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(label),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &sorted.image,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: if band.number == 0 {
                        wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT)
                    } else {
                        wgpu::LoadOp::Load
                    },
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: None,
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        pass.set_viewport(0.0, 0.0, plan.width as f32, plan.height as f32, 0.0, 1.0);
        pass.set_scissor_rect(0, band.first, plan.width, band.rows);
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, bound.frame, &[0, band.whole, plan.runs[0].material]);
        pass.set_bind_group(1, &sorted.segments, &[]);
        pass.set_bind_group(3, &sorted.shaded, &[]);
        pass.draw(0..4, 0..plan.sorting.count as u32);
    });
    Ok(())
}

/// The files that supply `resolve(pixel)`.
pub(crate) fn resolve_module(pixels: Module) -> Module {
    pixels.and(&["transparency/nearest", "transparency/sorted_blending"])
}
