//! Strands → GPU buffers. Strands are ordered along a Morton curve by their midpoints once, on load, so that
//! neighbouring invocations touch neighbouring pixels; curves are cut into straight segments.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

use glam::{DMat4, DVec3, Vec3};

use crate::error::{Error, Result, invalid};
use crate::gpu::{Allocation, Gpu, Group, Passes, PipelineKey, workgroups};
use crate::groom::density::{Density, density};
use crate::groom::{Curve, Strands, tessellate};
use crate::guided::Guiding;
use crate::layout::{POINT_FIRST, POINT_LAST, POINT_STRAND, Point, PointAttributes, Projected};
use crate::plan::Plan;
use crate::resources::Bound;
use crate::shader::{Constant, Module};
use crate::shading::{Shading, ShadingRate};
use crate::shadow::Shadow;
use crate::transparency::Transparency;

/// Runs begin at multiples of this many points, so that their parts of the buffers can be bound.
const RUN_ALIGNMENT: usize = 64;
/// The most points of all hairs of a frame: what fits in 24 bits beside a place along the segment.
pub(crate) const MAX_FRAME_POINTS: u64 = 1 << 24;

/// The most instances of one hair: what 16 bits count beside the hair's own number.
pub(crate) const MAX_INSTANCES: usize = 0xffff;

/// Tells the hairs of all renderers apart, and their buffers from those that they had before.
static SERIAL: AtomicU64 = AtomicU64::new(1);

pub(crate) fn next_serial() -> u64 {
    SERIAL.fetch_add(1, Ordering::Relaxed)
}

/// A part of a hair's points that one dispatch treats: whole strands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Run {
    pub first: u32,
    pub count: u32,
    /// Segments between its points.
    pub segments: u32,
}

/// A groom on the GPU, with how it is to be drawn. Made by [`crate::Renderer::create_hair`].
///
/// Changing a field takes effect with the next frame recorded. Not shared between renderers.
#[derive(Debug)]
pub struct Hair {
    /// World space from the groom's own space; any invertible affine transform, in double precision.
    pub world_from_object: DMat4,
    /// The fibres' own opacity α, from 0 to 1.
    pub opacity: f32,
    /// The shading model.
    pub shading: Shading,
    /// Where it is evaluated; the same for all hairs of a frame.
    pub shading_rate: ShadingRate,
    /// The shadow technique that this hair wishes for lights that name none.
    pub shadow: Option<Shadow>,
    /// The transparency technique that this hair wishes for frames that name none.
    pub transparency: Option<Transparency>,
    /// `world_from_object` of the frame before, for motion vectors. `None`: the hair was where it is.
    pub previous_world_from_object: Option<DMat4>,
    /// Copies of the groom, each drawn with `world_from_object` after its own transform. Empty: one, as it is.
    pub instances: Vec<Instance>,
    pub(crate) geometry: Geometry,
}

/// One copy of a groom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instance {
    /// The groom's own space from the copy's; any invertible affine transform.
    pub object_from_instance: DMat4,
    /// The same in the frame before, for motion vectors. `None`: as now.
    pub previous_object_from_instance: Option<DMat4>,
}

/// The GPU's side of a hair.
#[derive(Debug)]
pub(crate) struct Geometry {
    /// Of its buffers.
    pub serial: u64,
    /// Of its points, whatever buffer they are in: another one after every update.
    pub content: u64,
    /// Held by every update of the GPU's that may still run.
    pub landing: Arc<()>,
    pub points: Allocation,
    pub attributes: Allocation,
    pub colours: Allocation,
    pub runs: Vec<Run>,
    /// Points are stored relative to this position of the groom's own space.
    pub origin: DVec3,
    /// Half the extent of the box around all points, whose centre is `origin`.
    pub half_extent: DVec3,
    pub max_radius: f64,
    /// The greatest channel of the strands' colours.
    pub brightest: f32,
    /// Sum of all segments' lengths.
    pub length: f64,
    pub strand_count: u64,
    pub segment_count: u64,
    /// What the host gave, the order of its strands on the GPU, and the pieces that each of its segments was cut into.
    pub strands: Strands,
    pub order: Vec<u32>,
    pub pieces: u32,
    /// What moving hair keeps: its points as they were before, with their origin.
    pub previous: Option<(Allocation, DVec3)>,
    /// Whether the points have moved since the frame before.
    pub moved: bool,
    /// Whether the points are of the GPU's making, so that `strands` does not know them.
    pub gathered: bool,
    /// On the host's Vulkan device: the submission before which updates were made last, and how many.
    pub waiting: (u64, u32),
    /// Which of the host's points each point comes from, once that has been asked for.
    pub places: Option<Allocation>,
    /// The guides that it follows.
    pub guiding: Option<Guiding>,
    /// How densely it fills space, as it was when that was first asked for.
    density: OnceLock<Density>,
}

impl Hair {
    /// The strands as given. Positions that came from a buffer of the GPU's are not among them: they are then those that the
    /// CPU knew last.
    pub fn strands(&self) -> &Strands {
        &self.geometry.strands
    }

    /// Says that the points have not moved since the frame before, whatever [`crate::Renderer::update_points`] did then: their motion
    /// is zero until the next update.
    pub fn rest(&mut self) {
        self.geometry.moved = false;
    }

    /// Whether the points were last given by the GPU, so that [`Hair::strands`] does not have them.
    pub fn moved_on_gpu(&self) -> bool {
        self.geometry.gathered
    }

    pub(crate) fn validate(&self, number: usize) -> Result<()> {
        if !self.world_from_object.is_finite() {
            return invalid!("hair {number}: world_from_object has an element that is not finite");
        }
        let determinant = self.world_from_object.determinant();
        if determinant == 0.0 || !determinant.is_finite() {
            return invalid!(
                "hair {number}: world_from_object cannot be inverted: its determinant is {determinant}"
            );
        }
        if let Some(matrix) = self.previous_world_from_object
            && !matrix.is_finite()
        {
            return invalid!(
                "hair {number}: previous_world_from_object has an element that is not finite"
            );
        }
        if self.instances.len() > MAX_INSTANCES {
            return invalid!(
                "hair {number}: {} instances: a hair has at most {MAX_INSTANCES}",
                self.instances.len()
            );
        }
        for (at, instance) in self.instances.iter().enumerate() {
            let determinant = instance.object_from_instance.determinant();
            let previous = instance.previous_object_from_instance;
            if !instance.object_from_instance.is_finite()
                || determinant == 0.0
                || !determinant.is_finite()
                || previous.is_some_and(|matrix| !matrix.is_finite())
            {
                return invalid!(
                    "hair {number}: instance {at} has a transform that is not finite or cannot be inverted"
                );
            }
        }
        if !(0.0..=1.0).contains(&self.opacity) {
            return invalid!(
                "hair {number}: opacity {} is not between 0 and 1",
                self.opacity
            );
        }
        self.shading.validate()?;
        self.shadow.map_or(Ok(()), |shadow| shadow.validate())?;
        self.transparency
            .map_or(Ok(()), |transparency| transparency.validate())
    }
}

/// The data that goes into a hair's buffers.
struct Packed {
    points: Vec<Point>,
    attributes: Vec<PointAttributes>,
    runs: Vec<Run>,
    origin: DVec3,
    half_extent: DVec3,
    max_radius: f64,
    length: f64,
    segment_count: u64,
}

impl Geometry {
    pub fn new(gpu: &Gpu, strands: &Strands) -> Result<Self> {
        if strands.strand_count() > POINT_STRAND as usize {
            return invalid!(
                "{} strands: a hair has at most {POINT_STRAND}",
                strands.strand_count()
            );
        }
        let (order, pieces) = (morton_order(strands), curve_pieces(strands));
        let packed = pack(strands, &order, pieces, run_limit(gpu))?;
        let colours = half_colours(strands);
        let buffer = |label, bytes: &[u8]| -> Result<Allocation> {
            let allocation = gpu.storage(label, bytes.len() as u64)?;
            gpu.queue.write_buffer(&allocation.buffer, 0, bytes);
            Ok(allocation)
        };
        Ok(Self {
            serial: next_serial(),
            content: next_serial(),
            landing: Arc::default(),
            points: buffer(
                "pelage.geometry.points",
                bytemuck::cast_slice(&packed.points),
            )?,
            attributes: buffer(
                "pelage.geometry.attributes",
                bytemuck::cast_slice(&packed.attributes),
            )?,
            colours: buffer("pelage.geometry.colours", bytemuck::cast_slice(&colours))?,
            runs: packed.runs,
            origin: packed.origin,
            half_extent: packed.half_extent,
            max_radius: packed.max_radius,
            brightest: strands
                .colours()
                .iter()
                .flatten()
                .fold(0.0, |a, c| a.max(*c)),
            length: packed.length,
            strand_count: strands.strand_count() as u64,
            segment_count: packed.segment_count,
            strands: strands.clone(),
            order,
            pieces,
            previous: None,
            moved: false,
            gathered: false,
            waiting: (0, 0),
            places: None,
            guiding: None,
            density: OnceLock::new(),
        })
    }

    /// Bytes that [`Geometry::new`] takes.
    pub fn bytes(gpu: &Gpu, strands: &Strands) -> Result<u64> {
        let (order, pieces) = (morton_order(strands), curve_pieces(strands));
        let packed = pack(strands, &order, pieces, run_limit(gpu))?;
        let sizes = [
            size_of_val(&*packed.points),
            size_of_val(&*packed.attributes),
            size_of_val(&*half_colours(strands)),
        ];
        Ok(sizes.map(|size| Gpu::allocated(size as u64)).iter().sum())
    }

    /// How densely the strands fill space; measured once, and not anew where they move.
    pub fn density(&self) -> Density {
        *self.density.get_or_init(|| density(&self.strands))
    }

    /// Replaces every position; see [`Strands::set_points`]. Curves stay cut into as many pieces as they were.
    pub fn update(&mut self, gpu: &Gpu, points: &[[f32; 3]]) -> Result<()> {
        let mut strands = self.strands.clone();
        strands.set_points(points)?;
        let packed = pack(&strands, &self.order, self.pieces, run_limit(gpu))?;
        // The former points stay where they are, for motion vectors, and the new ones go into the other buffer.
        self.keep_previous(gpu)?;
        if let Some((buffer, origin)) = &mut self.previous {
            std::mem::swap(&mut self.points, buffer);
            *origin = self.origin;
            self.serial = next_serial();
        }
        gpu.queue
            .write_buffer(&self.points.buffer, 0, bytemuck::cast_slice(&packed.points));
        self.content = next_serial();
        self.gathered = false;
        self.moved = true;
        self.origin = packed.origin;
        self.half_extent = packed.half_extent;
        self.length = packed.length;
        self.strands = strands;
        Ok(())
    }
}

impl Geometry {
    /// Makes room for the points of the frame before.
    pub fn keep_previous(&mut self, gpu: &Gpu) -> Result<()> {
        if self.previous.is_none() {
            let buffer = gpu.storage("pelage.geometry.previous_points", self.points.size())?;
            self.previous = Some((buffer, self.origin));
        }
        Ok(())
    }

    /// Whether no update of the GPU's is still to run: each was either done or dropped without being submitted.
    pub fn landed(&self) -> bool {
        Arc::strong_count(&self.landing) == 1
    }

    /// The points of the frame before and their origin, where they have moved.
    pub fn previous(&self) -> Option<(&Allocation, DVec3)> {
        let (buffer, origin) = self.previous.as_ref()?;
        self.moved.then_some((buffer, *origin))
    }
}

/// The most points of one run: what one binding of projected points holds.
fn run_limit(gpu: &Gpu) -> usize {
    (gpu.max_binding() / size_of::<Projected>() as u64) as usize / RUN_ALIGNMENT * RUN_ALIGNMENT
}

fn half_colour(c: [f32; 3]) -> [u32; 2] {
    let half = |v: f32| u32::from(half::f16::from_f32(v.min(65504.0)).to_bits());
    [half(c[0]) | half(c[1]) << 16, half(c[2])]
}

/// The strands' colours as the GPU holds them.
fn half_colours(strands: &Strands) -> Vec<[u32; 2]> {
    strands.colours().iter().map(|c| half_colour(*c)).collect()
}

/// Strand numbers in the order of a Morton curve through their middle points.
fn morton_order(strands: &Strands) -> Vec<u32> {
    let Some((low, high)) = strands.bounds() else {
        return Vec::new();
    };
    let (low, high) = (Vec3::from(low), Vec3::from(high));
    let scale = 1023.0 / (high - low).max_element().max(f32::MIN_POSITIVE);
    let code = |strand: usize| {
        let range = strands.range(strand);
        let middle = Vec3::from(strands.points()[(range.start + range.end) / 2]);
        let cell = ((middle - low) * scale).clamp(Vec3::ZERO, Vec3::splat(1023.0));
        spread_bits(cell.x as u32)
            | spread_bits(cell.y as u32) << 1
            | spread_bits(cell.z as u32) << 2
    };
    let mut order: Vec<(u32, u32)> = (0..strands.strand_count())
        .map(|strand| (code(strand), strand as u32))
        .collect();
    order.sort_unstable();
    order.into_iter().map(|(_, strand)| strand).collect()
}

/// Puts two zero bits between each of the lower ten bits.
fn spread_bits(value: u32) -> u32 {
    (0..10).fold(0, |spread, bit| spread | (value >> bit & 1) << (3 * bit))
}

/// Cuts curves, orders strands, and parts them into runs of at most `limit` points.
fn pack(strands: &Strands, order: &[u32], pieces: u32, limit: usize) -> Result<Packed> {
    let cut = if pieces == 1 {
        None
    } else {
        Some(tessellate(strands, pieces)?)
    };
    let strands = cut.as_ref().unwrap_or(strands);
    let (low, high) = strands.bounds().unwrap_or_default();
    let (low, high) = (Vec3::from(low).as_dvec3(), Vec3::from(high).as_dvec3());
    let origin = 0.5 * (low + high);
    let mut packed = Packed {
        points: Vec::with_capacity(strands.points().len()),
        attributes: Vec::with_capacity(strands.points().len()),
        runs: Vec::new(),
        origin,
        half_extent: 0.5 * (high - low),
        max_radius: f64::from(strands.radii().iter().fold(0.0f32, |a, r| a.max(*r))),
        length: 0.0,
        segment_count: strands.segment_count() as u64,
    };
    let mut run = Run::default();
    for &strand in order {
        let range = strands.range(strand as usize);
        if range.len() > limit {
            return Err(Error::Unsupported(format!(
                "strand {strand}: {} points; this device binds {limit}",
                range.len()
            )));
        }
        if run.count as usize + range.len() > limit {
            pad(&mut packed);
            packed.runs.push(run);
            run = Run {
                first: packed.points.len() as u32,
                ..Run::default()
            };
        }
        run.count += range.len() as u32;
        run.segments += range.len() as u32 - 1;
        let mut previous: Option<DVec3> = None;
        for at in range.clone() {
            let position = Vec3::from(strands.points()[at]).as_dvec3() - origin;
            packed.length += previous.map_or(0.0, |p| position.distance(p));
            previous = Some(position);
            packed.points.push(Point {
                position: position.as_vec3().into(),
                radius: strands.radii()[at],
            });
            let first = if at == range.start { POINT_FIRST } else { 0 };
            let last = if at + 1 == range.end { POINT_LAST } else { 0 };
            packed.attributes.push(PointAttributes {
                strand: strand | first | last,
                coordinate: strands.coordinates()[at],
            });
        }
    }
    if run.count > 0 {
        pad(&mut packed);
        packed.runs.push(run);
    }
    Ok(packed)
}

/// The turn of a cut curve's joints, in radians, that shows no corner.
const SMOOTH_TURN: f64 = 0.3;
/// Straight pieces of one curved segment at most.
const MAX_CURVE_PIECES: u32 = 8;
/// The part of all joints whose turn decides.
const TURN_QUANTILE: f64 = 0.9;

/// Straight pieces of each curved segment, so that nine of ten joints turn by no more than what looks smooth.
pub(crate) fn curve_pieces(strands: &Strands) -> u32 {
    if strands.curve() == Curve::Polyline {
        return 1;
    }
    let mut turns: Vec<f32> = Vec::new();
    for strand in 0..strands.strand_count() {
        let points = &strands.points()[strands.range(strand)];
        for joint in points.windows(3) {
            let [a, b, c] = [joint[0], joint[1], joint[2]].map(Vec3::from);
            turns.push((b - a).angle_between(c - b));
        }
    }
    turns.retain(|turn| turn.is_finite());
    if turns.is_empty() {
        return 1;
    }
    let at = ((turns.len() - 1) as f64 * TURN_QUANTILE) as usize;
    let (_, turn, _) = turns.select_nth_unstable_by(at, f32::total_cmp);
    ((f64::from(*turn) / SMOOTH_TURN).ceil() as u32).clamp(1, MAX_CURVE_PIECES)
}

/// Fills up to the alignment with strands of one point, which draw nothing.
fn pad(packed: &mut Packed) {
    while !packed.points.len().is_multiple_of(RUN_ALIGNMENT) {
        packed.points.push(Point {
            position: [0.0; 3],
            radius: 0.0,
        });
        packed.attributes.push(PointAttributes {
            strand: POINT_FIRST | POINT_LAST,
            coordinate: 0.0,
        });
    }
}

/// Records each point's motion and whose it is, where an output asks for it.
pub(crate) fn track(gpu: &mut Gpu, passes: &mut Passes, bound: &Bound, plan: &Plan) -> Result<()> {
    if !plan.tracked {
        return Ok(());
    }
    let label = "pelage.geometry.track";
    let groups = [Group::Frame, Group::Track];
    let pipeline = gpu.compute(PipelineKey::new(label), "track", &groups, || {
        Module::new(&["common/track"])
    })?;
    passes.compute(label, |pass| {
        pass.set_pipeline(&pipeline);
        let drawings = &plan.bands[0].drawings;
        for ((run, drawing), groups) in plan.runs.iter().zip(drawings).zip(bound.runs) {
            let Some(group) = &groups.track else { continue };
            pass.set_bind_group(0, bound.frame, &[0, *drawing, run.material]);
            pass.set_bind_group(1, group, &[]);
            let (x, y) = workgroups(run.run.count);
            pass.dispatch_workgroups(x, y, 1);
        }
    });
    Ok(())
}

/// Finds the farthest and the nearest depth of the host's opaque scene in each tile of the view.
pub(crate) fn host_tiles(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    plan: &Plan,
) -> Result<()> {
    if !plan.host_depth {
        return Ok(());
    }
    let label = "pelage.geometry.host_tiles";
    let groups = [Group::Frame, Group::HostTiles];
    let pipeline = gpu.compute(PipelineKey::new(label), "host_tiles_range", &groups, || {
        Module::new(&["common/pixels", "common/host_tiles"])
    })?;
    passes.compute(label, |pass| {
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(
            0,
            bound.frame,
            &[0, plan.bands[0].drawings[0], plan.runs[0].material],
        );
        pass.set_bind_group(1, bound.host_tiles, &[]);
        let (x, y) = workgroups(plan.tile_count());
        pass.dispatch_workgroups(x, y, 1);
    });
    Ok(())
}

/// What a projection is compiled for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Projection {
    /// Whether the near plane may cross the hair. Where it may not, a point behind it all the same takes its segments with it.
    pub crosses: bool,
    /// Whether segments that cannot be seen are marked.
    pub view: bool,
}

impl Projection {
    pub fn module(&self, files: &[&'static str]) -> Module {
        Module::new(&["common/pixels", "common/project"])
            .with("CROSSES", Constant::Bool(self.crosses))
            .with("VIEW", Constant::Bool(self.view))
            .and(files)
    }
}

/// Projects every run's points for one view or map: each run's drawing says which.
pub(crate) fn project(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    projection: Projection,
    drawings: &[u32],
    plan: &Plan,
) -> Result<()> {
    let label = if projection.view {
        "pelage.geometry.project"
    } else {
        "pelage.shadow.project"
    };
    let key = PipelineKey {
        variant: u32::from(projection.crosses),
        ..PipelineKey::new(label)
    };
    let pipeline = gpu.compute(key, "project", &[Group::Frame, Group::Project], || {
        projection.module(&[])
    })?;
    passes.compute(label, |pass| {
        pass.set_pipeline(&pipeline);
        for ((run, drawing), groups) in plan.runs.iter().zip(drawings).zip(bound.runs) {
            pass.set_bind_group(0, bound.frame, &[0, *drawing, run.material]);
            pass.set_bind_group(1, &groups.project, &[]);
            let (x, y) = workgroups(run.run.count);
            pass.dispatch_workgroups(x, y, 1);
        }
    });
    Ok(())
}

/// Puts every run's segments in the order in which a walk takes them, after a projection.
pub(crate) fn order(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    label: &'static str,
    drawings: &[u32],
    plan: &Plan,
) -> Result<()> {
    let groups = [Group::Frame, Group::Order];
    let mut pipelines = Vec::with_capacity(3);
    for (variant, entry) in ["order_count", "order_scan", "order_place"]
        .into_iter()
        .enumerate()
    {
        let key = PipelineKey {
            variant: variant as u32,
            ..PipelineKey::new("pelage.geometry.order")
        };
        pipelines.push(gpu.compute(key, entry, &groups, || Module::new(&["common/order"]))?);
    }
    passes.encode(label, |encoder| {
        encoder.clear_buffer(bound.order_counts, 0, None);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(label),
            timestamp_writes: None,
        });
        for (step, pipeline) in pipelines.iter().enumerate() {
            pass.set_pipeline(pipeline);
            for ((run, drawing), groups) in plan.runs.iter().zip(drawings).zip(bound.runs) {
                pass.set_bind_group(0, bound.frame, &[0, *drawing, run.material]);
                pass.set_bind_group(1, &groups.order, &[]);
                let (x, y) = if step == 1 {
                    (1, 1)
                } else {
                    workgroups(run.run.count)
                };
                pass.dispatch_workgroups(x, y, 1);
            }
        }
    });
    Ok(())
}
