//! Strands that follow their guides on the GPU: what `groom/interpolate.rs` does with a groom at rest, done by compute
//! passes with the guides as they are now. Guides → even guides (and their frames) → strands in the host's order, which
//! are then gathered like any points of the host's.

use glam::{DVec3, Vec3};

use crate::error::{Error, Result, invalid};
use crate::gather::{self, POSITION, PointSource, alignment, part};
use crate::geometry::Geometry;
use crate::gpu::{Allocation, Gpu, Group, PipelineKey, workgroups};
use crate::groom::even::{longest, taps};
use crate::groom::interpolate::{Follower, Makeup};
use crate::groom::{ClumpSettings, Curve, GuidedStrands, Strands};
use crate::layout::{Guided, Placement};
use crate::shader::Module;

/// Bytes of what the GPU keeps a follower.
const FOLLOWER: u64 = 24;
/// How far a Catmull-Rom curve leaves the box of its points at most, in lengths of a segment: the larger of the tangents'
/// basis functions has 4/27 as its peak.
const OVERSHOOT: f64 = 0.15;

/// The guides of a hair, and how its strands are made of them.
#[derive(Debug)]
pub(crate) struct Guiding {
    rest: Strands,
    /// Points of the guides as strands are made of them, after resampling.
    even_count: u32,
    points_each: u32,
    taps: Allocation,
    points: Allocation,
    makeup: Buffers,
    /// Every strand's points in the host's order.
    strands: Allocation,
    chunks: Vec<Chunk>,
    /// The largest displacement of a tip over its length, and the largest distance from a guide.
    stray: f64,
    distance: f64,
}

#[derive(Debug)]
enum Buffers {
    Mesh { placements: Allocation },
    Clumps(Box<Clumps>),
}

#[derive(Debug)]
struct Clumps {
    offsets: Allocation,
    frames: Allocation,
    coordinates: Allocation,
    followers: Allocation,
    settings: ClumpSettings,
}

/// Strands that one dispatch makes: what can be bound at once. Bytes of what they are made up of, and of their points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Chunk {
    count: u32,
    first_guide: u32,
    makeup: [u64; 2],
    strands: [u64; 2],
}

impl Guiding {
    pub fn new(gpu: &Gpu, guided: &GuidedStrands) -> Result<Self> {
        let guides = guided.guides();
        let on_mesh = matches!(guided.makeup, Makeup::Mesh(_));
        let points_each = longest(guides);
        let places: Vec<[u32; 4]> = if on_mesh {
            let even = taps(guides, points_each).into_iter();
            even.map(|tap| [tap.at as u32, tap.next as u32, tap.t.to_bits(), 0])
                .collect()
        } else {
            let all = 0..guides.points().len() as u32;
            all.map(|at| [at, at, 0, 0]).collect()
        };
        let limit = gpu.max_binding();
        // Frames and taps are the largest of what is bound whole.
        let most = limit / 24;
        if places.len() as u64 > most {
            return Err(Error::Unsupported(format!(
                "guides of {} points; this device takes {most}",
                places.len()
            )));
        }
        let rest: Vec<[f32; 3]> = places
            .iter()
            .map(|[at, next, t, _]| {
                let [p, q] = [at, next].map(|k| Vec3::from(guides.points()[*k as usize]));
                p.lerp(q, f32::from_bits(*t)).to_array()
            })
            .collect();
        let strand_points = guided.strands().points().len() as u64;
        let (makeup, chunks) = match &guided.makeup {
            Makeup::Mesh(placements) => {
                let chunks = mesh_chunks(placements.len() as u64, points_each as u64, limit)?;
                let placements: Vec<Placement> = placements.iter().map(Into::into).collect();
                let placements = gpu.filled(
                    "pelage.guided.placements",
                    bytemuck::cast_slice(&placements),
                )?;
                (Buffers::Mesh { placements }, chunks)
            }
            Makeup::Clumps(followers, settings) => {
                let followers: Vec<[f32; 6]> = followers.iter().map(six).collect();
                let offsets = bytemuck::cast_slice(guides.offsets());
                let coordinates = bytemuck::cast_slice(guides.coordinates());
                let clumps = Clumps {
                    offsets: gpu.filled("pelage.guided.offsets", offsets)?,
                    frames: gpu.storage("pelage.guided.frames", rest.len() as u64 * 24)?,
                    coordinates: gpu.filled("pelage.guided.coordinates", coordinates)?,
                    followers: gpu
                        .filled("pelage.guided.followers", bytemuck::cast_slice(&followers))?,
                    settings: *settings,
                };
                let chunks = clump_chunks(guides, settings, limit.saturating_sub(alignment(gpu)))?;
                (Buffers::Clumps(Box::new(clumps)), chunks)
            }
        };
        let (stray, distance) = guided.makeup.reach();
        Ok(Self {
            rest: guides.clone(),
            even_count: rest.len() as u32,
            points_each: points_each as u32,
            taps: gpu.filled("pelage.guided.taps", bytemuck::cast_slice(&places))?,
            points: gpu.filled("pelage.guided.guides", bytemuck::cast_slice(&rest))?,
            makeup,
            strands: gpu.storage("pelage.guided.strands", strand_points * POSITION)?,
            chunks,
            stray,
            distance,
        })
    }

    /// How far strands may stand out from the box around their guides.
    fn reach(&self, points: &[[f32; 3]]) -> f64 {
        let (mut longest_guide, mut longest_segment) = (0.0f64, 0.0f64);
        for guide in 0..self.rest.strand_count() {
            let mut length = 0.0;
            for pair in points[self.rest.range(guide)].windows(2) {
                let [a, b] = [pair[0], pair[1]].map(|p| Vec3::from(p).as_dvec3());
                length += a.distance(b);
                longest_segment = longest_segment.max(a.distance(b));
            }
            longest_guide = longest_guide.max(length);
        }
        let overshoot = match self.rest.curve() {
            Curve::Polyline => 0.0,
            Curve::CatmullRom => OVERSHOOT * (longest_segment + 2.0 * self.distance),
        };
        self.distance + self.stray * (longest_guide + 2.0 * self.distance) + overshoot
    }

    /// The passes that make the strands' points of the guides' in `source`.
    fn dispatches(&self, gpu: &mut Gpu, source: &PointSource) -> Result<Vec<Dispatch>> {
        let alignment = alignment(gpu);
        let end = source.offset + (self.rest.points().len() as u64 - 1) * source.stride + POSITION;
        let (given, source_base) = words(source.buffer, [source.offset, end], alignment);
        if end - source.offset / alignment * alignment > gpu.max_binding() {
            return Err(Error::Unsupported(format!(
                "the guides take {} bytes of the buffer; this device binds {}",
                end - source.offset,
                gpu.max_binding()
            )));
        }
        let guides = self.points.binding();
        let common = Guided {
            points_each: self.points_each,
            ..Guided::default()
        };
        let even = Guided {
            source_base,
            stride: (source.stride / 4) as u32,
            count: self.even_count,
            ..common
        };
        let taps = self.taps.binding();
        let mut passes = vec![dispatch(
            gpu,
            "guided",
            "guided",
            &even,
            &[given, taps],
            &guides,
        )?];
        match &self.makeup {
            Buffers::Mesh { placements } => {
                for chunk in &self.chunks {
                    let (own, _) = words(&placements.buffer, chunk.makeup, alignment);
                    let (strands, strands_base) =
                        words(&self.strands.buffer, chunk.strands, alignment);
                    let uniform = Guided {
                        count: chunk.count,
                        strands_base,
                        ..common
                    };
                    let read = [guides.clone(), own];
                    let stem = "guided_mesh";
                    passes.push(dispatch(gpu, stem, stem, &uniform, &read, &strands)?);
                }
            }
            Buffers::Clumps(clumps) => {
                let Clumps {
                    offsets,
                    frames,
                    coordinates,
                    followers,
                    settings,
                } = &**clumps;
                let carried = Guided {
                    count: self.rest.strand_count() as u32,
                    ..common
                };
                let read = [guides.clone(), offsets.binding()];
                let (stem, entry) = ("guided_frames", "guided_frames_carry");
                passes.push(dispatch(
                    gpu,
                    stem,
                    entry,
                    &carried,
                    &read,
                    &frames.binding(),
                )?);
                for chunk in &self.chunks {
                    let (own, followers_base) = words(&followers.buffer, chunk.makeup, alignment);
                    let (strands, strands_base) =
                        words(&self.strands.buffer, chunk.strands, alignment);
                    let uniform = Guided {
                        count: chunk.count,
                        followers: settings.followers,
                        followers_base,
                        strands_base,
                        first_guide: chunk.first_guide,
                        tip_factor: settings.tip_factor,
                        ..common
                    };
                    let read = [
                        guides.clone(),
                        offsets.binding(),
                        frames.binding(),
                        coordinates.binding(),
                        own,
                    ];
                    let stem = "guided_clumps";
                    passes.push(dispatch(gpu, stem, stem, &uniform, &read, &strands)?);
                }
            }
        }
        Ok(passes)
    }
}

impl From<&crate::groom::interpolate::Placement> for Placement {
    fn from(placement: &crate::groom::interpolate::Placement) -> Self {
        let [guide_0, guide_1, guide_2] = placement.guides;
        Self {
            root: placement.root,
            guide_0,
            tip: placement.tip,
            guide_1,
            stray: placement.stray.into(),
            guide_2,
        }
    }
}

fn six(follower: &Follower) -> [f32; 6] {
    let [x, y, z] = follower.stray.to_array();
    [follower.cos, follower.sin, follower.distance, x, y, z]
}

impl Makeup {
    /// The largest displacement of a tip over its length, and the largest distance from a guide.
    fn reach(&self) -> (f64, f64) {
        let largest = |values: &mut dyn Iterator<Item = f32>| f64::from(values.fold(0.0, f32::max));
        match self {
            Self::Mesh(placements) => (
                largest(&mut placements.iter().map(|p| p.stray.length())),
                0.0,
            ),
            Self::Clumps(followers, settings) => (
                largest(&mut followers.iter().map(|f| f.stray.length())),
                largest(&mut followers.iter().map(|f| f.distance))
                    * f64::from(settings.tip_factor.max(1.0)),
            ),
        }
    }
}

/// Parts strands of `points_each` points.
fn mesh_chunks(count: u64, points_each: u64, limit: u64) -> Result<Vec<Chunk>> {
    let each = (points_each * POSITION).max(size_of::<Placement>() as u64);
    // By 64, so that parts begin where they can be bound.
    let step = limit / each / 64 * 64;
    if step == 0 {
        return Err(Error::Unsupported(format!(
            "guides of {points_each} points: this device binds {limit} bytes"
        )));
    }
    let chunk = |number: u64| {
        let (first, end) = (number * step, ((number + 1) * step).min(count));
        let bytes = |each| [first * each, end * each];
        Chunk {
            count: (end - first) as u32,
            first_guide: 0,
            makeup: bytes(size_of::<Placement>() as u64),
            strands: bytes(points_each * POSITION),
        }
    };
    Ok((0..count.div_ceil(step)).map(chunk).collect())
}

/// Parts guides with their followers.
fn clump_chunks(guides: &Strands, settings: &ClumpSettings, limit: u64) -> Result<Vec<Chunk>> {
    let followers = u64::from(settings.followers);
    let each = followers + 1;
    let chunk = |first: usize, end: usize| {
        let offset = |guide: usize| u64::from(guides.offsets()[guide]) * each * POSITION;
        Chunk {
            count: ((end - first) as u64 * each) as u32,
            first_guide: first as u32,
            makeup: [first, end].map(|guide| guide as u64 * followers * FOLLOWER),
            strands: [offset(first), offset(end)],
        }
    };
    let fits = |chunk: &Chunk| {
        chunk.strands[1] - chunk.strands[0] <= limit && chunk.makeup[1] - chunk.makeup[0] <= limit
    };
    let (mut chunks, mut first) = (Vec::new(), 0);
    for guide in 0..guides.strand_count() {
        if !fits(&chunk(guide, guide + 1)) {
            return Err(Error::Unsupported(format!(
                "guide {guide}: {} points with {followers} followers; this device binds {limit} bytes",
                guides.range(guide).len()
            )));
        }
        if !fits(&chunk(first, guide + 1)) {
            chunks.push(chunk(first, guide));
            first = guide;
        }
    }
    if first < guides.strand_count() {
        chunks.push(chunk(first, guides.strand_count()));
    }
    Ok(chunks)
}

/// Bytes of a buffer as they can be bound, and the word at which they begin there.
fn words(
    buffer: &wgpu::Buffer,
    bytes: [u64; 2],
    alignment: u64,
) -> (wgpu::BindingResource<'_>, u32) {
    let from = bytes[0] / alignment * alignment;
    // What is empty, as followers of none, is bound by one word that nobody reads.
    let from = from.min(buffer.size().saturating_sub(1) / alignment * alignment);
    let size = bytes[1].saturating_sub(from).max(4);
    (part(buffer, from, size), ((bytes[0] - from) / 4) as u32)
}

/// One pass of a kind.
struct Dispatch {
    label: &'static str,
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    count: u32,
}

/// Makes a pass of the shader `stem` that reads `read` and writes `written`.
fn dispatch(
    gpu: &mut Gpu,
    stem: &'static str,
    entry: &str,
    uniform: &Guided,
    read: &[wgpu::BindingResource],
    written: &wgpu::BindingResource,
) -> Result<Dispatch> {
    let label = match stem {
        "guided" => "pelage.guided.guides",
        "guided_mesh" => "pelage.guided.mesh",
        "guided_frames" => "pelage.guided.frames",
        _ => "pelage.guided.clumps",
    };
    let pipeline = gpu.compute(PipelineKey::new(label), entry, &[Group::Guided], || {
        Module::new(&[stem])
    })?;
    let block = gpu.uniform("pelage.guided", bytemuck::bytes_of(uniform))?;
    let mut resources = vec![block.binding()];
    resources.extend_from_slice(read);
    // What a shader does not name is bound all the same.
    resources.resize(6, read[read.len() - 1].clone());
    resources.push(written.clone());
    Ok(Dispatch {
        label,
        group: gpu.bind(label, Group::Guided, &resources),
        pipeline,
        count: uniform.count,
    })
}

/// Records the passes that move a hair's strands after guides from a buffer.
pub(crate) fn update_from(
    gpu: &mut Gpu,
    encoder: &mut wgpu::CommandEncoder,
    geometry: &mut Geometry,
    source: &PointSource,
) -> Result<()> {
    let guiding = guiding(geometry)?;
    let reach = guiding.reach(guiding.rest.points());
    record(gpu, encoder, geometry, source, reach)
}

/// The same for guides from the CPU.
pub(crate) fn update(
    gpu: &mut Gpu,
    encoder: &mut wgpu::CommandEncoder,
    geometry: &mut Geometry,
    points: &[[f32; 3]],
) -> Result<()> {
    let guiding = guiding(geometry)?;
    let mut guides = guiding.rest.clone();
    guides.set_points(points)?;
    let Some((low, high)) = guides.bounds() else {
        return Ok(());
    };
    let reach = guiding.reach(points);
    let given = gpu.filled("pelage.guided.given", bytemuck::cast_slice(points))?;
    let source = PointSource {
        buffer: &given.buffer,
        offset: 0,
        stride: POSITION,
        bounds: [low, high].map(|corner| Vec3::from(corner).as_dvec3()),
    };
    record(gpu, encoder, geometry, &source, reach)
}

fn guiding(geometry: &Geometry) -> Result<&Guiding> {
    match &geometry.guiding {
        Some(guiding) => Ok(guiding),
        None => {
            invalid!("the hair has no guides; it was not made of any, or does not remember them")
        }
    }
}

fn record(
    gpu: &mut Gpu,
    encoder: &mut wgpu::CommandEncoder,
    geometry: &mut Geometry,
    source: &PointSource,
    reach: f64,
) -> Result<()> {
    let Some(guiding) = geometry.guiding.take() else {
        return Ok(());
    };
    let prepared = prepare(gpu, geometry, &guiding, source, reach);
    geometry.guiding = Some(guiding);
    let Some((dispatches, gathering)) = prepared? else {
        return Ok(());
    };
    for dispatch in &dispatches {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(dispatch.label),
            timestamp_writes: None,
        });
        pass.set_pipeline(&dispatch.pipeline);
        pass.set_bind_group(1, &dispatch.group, &[]);
        let (x, y) = workgroups(dispatch.count);
        pass.dispatch_workgroups(x, y, 1);
    }
    gathering.record(encoder, geometry);
    Ok(())
}

/// Makes all that the passes need, before anything is recorded.
fn prepare(
    gpu: &mut Gpu,
    geometry: &mut Geometry,
    guiding: &Guiding,
    source: &PointSource,
    reach: f64,
) -> Result<Option<(Vec<Dispatch>, gather::Gathering)>> {
    let count = guiding.rest.points().len() as u64;
    source.validate(count, gpu.max_binding())?;
    if count == 0 {
        return Ok(None);
    }
    let [low, high] = source.bounds;
    let strands = PointSource {
        buffer: &guiding.strands.buffer,
        offset: 0,
        stride: POSITION,
        bounds: [low - DVec3::splat(reach), high + DVec3::splat(reach)],
    };
    let Some(gathering) = gather::prepare(gpu, geometry, &strands)? else {
        return Ok(None);
    };
    let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
    let dispatches = guiding.dispatches(gpu, source)?;
    if let Some(error) = pollster::block_on(scope.pop()) {
        return invalid!("the buffer cannot be read: {error}");
    }
    Ok(Some((dispatches, gathering)))
}
