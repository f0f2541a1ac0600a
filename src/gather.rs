//! Points from a buffer of the GPU's: hair that the host has skinned or simulated there, brought into the renderer's own
//! order and cut into straight pieces by a compute pass. `shaders/gather.wgsl` has the details.

use std::num::NonZeroU64;

use glam::DVec3;

use crate::error::{Error, Result, invalid};
use crate::geometry::{Geometry, Run, next_serial};
use crate::gpu::{Allocation, Gpu, Group, PipelineKey, workgroups};
use crate::layout::{Gather, NO_PLACE};
use crate::shader::Module;

const LABEL: &str = "pelage.geometry.gather";
/// Bytes of a position: three floats.
pub(crate) const POSITION: u64 = 12;

/// Positions in a buffer of the host's: three 32-bit floats a point, in the groom's own space, strand after strand, root
/// first.
#[derive(Debug, Clone, Copy)]
pub struct PointSource<'a> {
    /// On the renderer's device, with the usage `STORAGE`.
    pub buffer: &'a wgpu::Buffer,
    /// Bytes before the first position, a multiple of 4.
    pub offset: u64,
    /// Bytes from one position to the next: a multiple of 4, at least 12.
    pub stride: u64,
    /// The lowest and the highest corner of a box around all points, and the curves through them, in the groom's own space.
    /// What lies outside is drawn, but its shadow may be cut off; and strands that lie nearer to the eye than a box of twice the size
    /// may be drawn in another order among themselves.
    pub bounds: [DVec3; 2],
}

impl PointSource<'_> {
    /// Checks the source for `count` points; `limit` is the largest binding.
    pub(crate) fn validate(&self, count: u64, limit: u64) -> Result<()> {
        if !self.buffer.usage().contains(wgpu::BufferUsages::STORAGE) {
            return invalid!("the buffer's usage {:?} lacks STORAGE", self.buffer.usage());
        }
        if !self.offset.is_multiple_of(4) {
            return invalid!("offset {} is not a multiple of 4", self.offset);
        }
        if self.stride < POSITION || !self.stride.is_multiple_of(4) {
            return invalid!(
                "stride {} is not a multiple of 4 of at least {POSITION}",
                self.stride
            );
        }
        if self.stride > limit / 16 {
            return Err(Error::Unsupported(format!(
                "stride {}: this device takes up to {}",
                self.stride,
                limit / 16
            )));
        }
        let [low, high] = self.bounds;
        if !low.is_finite() || !high.is_finite() || !low.cmple(high).all() {
            return invalid!("bounds from {low} to {high} make no box");
        }
        if !low.as_vec3().is_finite() || !high.as_vec3().is_finite() {
            return invalid!("bounds from {low} to {high} are beyond single precision");
        }
        let needed = (count.max(1) - 1)
            .saturating_mul(self.stride)
            .saturating_add(self.offset)
            .saturating_add(POSITION);
        if count > 0 && needed > self.buffer.size() {
            return invalid!(
                "{count} points from offset {} at stride {} take {needed} bytes; the buffer has {}",
                self.offset,
                self.stride,
                self.buffer.size()
            );
        }
        Ok(())
    }
}

/// Points of the host's that one binding holds: `first` to `end`, and their neighbours from `low` on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Window {
    first: u64,
    end: u64,
    low: u64,
    /// The bound part, and the word in it at which the point `low` begins.
    offset: u64,
    size: u64,
    base: u64,
}

/// Parts `count` points such that each part, with the neighbours that its curves need, can be bound.
fn windows(count: u64, offset: u64, stride: u64, alignment: u64, limit: u64) -> Vec<Window> {
    // One point before each part and two after it are neighbours.
    let each = ((limit - alignment) / stride).saturating_sub(4).max(1);
    let window = |number: u64| {
        let first = number * each;
        let end = (first + each).min(count);
        let low = first.saturating_sub(1);
        let from = offset + low * stride;
        let to = offset + ((end + 2).min(count) - 1) * stride + POSITION;
        let aligned = from / alignment * alignment;
        Window {
            first,
            end,
            low,
            offset: aligned,
            size: to - aligned,
            base: (from - aligned) / 4,
        }
    };
    (0..count.div_ceil(each)).map(window).collect()
}

/// Which of the host's points each of the hair's own points comes from.
fn places(geometry: &Geometry) -> Vec<u32> {
    let pieces = geometry.pieces;
    let mut places = Vec::new();
    let mut order = geometry.order.iter();
    for run in &geometry.runs {
        places.resize(run.first as usize, NO_PLACE);
        while places.len() < (run.first + run.count) as usize {
            let Some(strand) = order.next() else { break };
            let range = geometry.strands.range(*strand as usize);
            let last = range.end as u32 - 1;
            places.extend(range.start as u32 * pieces..=last * pieces);
        }
    }
    let end = places.len().next_multiple_of(64);
    places.resize(end, NO_PLACE);
    places
}

/// A gathering that lacks nothing but an encoder.
pub(crate) struct Gathering {
    pipeline: wgpu::ComputePipeline,
    dispatches: Vec<(wgpu::BindGroup, (u32, u32))>,
    bounds: [DVec3; 2],
}

/// Makes all that a gathering needs; `None` where there is nothing to gather.
pub(crate) fn prepare(
    gpu: &mut Gpu,
    geometry: &mut Geometry,
    source: &PointSource,
) -> Result<Option<Gathering>> {
    let count = geometry.strands.points().len() as u64;
    let limit = gpu.max_binding();
    source.validate(count, limit)?;
    if count == 0 {
        return Ok(None);
    }
    let pipeline = gpu.compute(PipelineKey::new(LABEL), "gather", &[Group::Gather], || {
        Module::new(&["gather"])
    })?;
    geometry.keep_previous(gpu)?;
    if geometry.places.is_none() {
        let places = gpu.filled(
            "pelage.geometry.places",
            bytemuck::cast_slice(&places(geometry)),
        )?;
        geometry.places = Some(places);
    }
    let Some(places) = &geometry.places else {
        return Err(Error::Internal("the hair has no places".into()));
    };
    let [low, high] = source.bounds;
    let origin = 0.5 * (low + high);
    let alignment = alignment(gpu);
    let windows = windows(count, source.offset, source.stride, alignment, limit);
    let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
    let mut dispatches = Vec::new();
    for run in &geometry.runs {
        for window in &windows {
            let uniform = gpu.uniform(
                LABEL,
                bytemuck::bytes_of(&Gather {
                    origin: origin.as_vec3().into(),
                    first: window.first as u32,
                    origin_rest: (origin - origin.as_vec3().as_dvec3()).as_vec3().into(),
                    end: window.end as u32,
                    shift: (geometry.origin - origin).as_vec3().into(),
                    lowest: window.low as u32,
                    base: window.base as u32,
                    stride: (source.stride / 4) as u32,
                    pieces: geometry.pieces,
                    count: run.count,
                }),
            )?;
            let group = gpu.bind(
                LABEL,
                Group::Gather,
                &[
                    uniform.binding(),
                    part(source.buffer, window.offset, window.size),
                    own(places, run, 4),
                    own(&geometry.attributes, run, 8),
                    own(&geometry.points, run, 16),
                ],
            );
            dispatches.push((group, workgroups(run.count)));
        }
    }
    if let Some(error) = pollster::block_on(scope.pop()) {
        return invalid!("the buffer cannot be read: {error}");
    }
    Ok(Some(Gathering {
        pipeline,
        dispatches,
        bounds: source.bounds,
    }))
}

impl Gathering {
    /// Records the copy of the points to those of the frame before, and the pass that replaces them.
    pub fn record(self, encoder: &mut wgpu::CommandEncoder, geometry: &mut Geometry) {
        let Some((previous, previous_origin)) = &mut geometry.previous else {
            return;
        };
        let (points, size) = (&geometry.points.buffer, geometry.points.size());
        encoder.copy_buffer_to_buffer(points, 0, &previous.buffer, 0, Some(size));
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(LABEL),
            timestamp_writes: None,
        });
        pass.set_pipeline(&self.pipeline);
        for (group, (x, y)) in &self.dispatches {
            pass.set_bind_group(1, group, &[]);
            pass.dispatch_workgroups(*x, *y, 1);
        }
        drop(pass);
        // Until this has run, nobody knows which points a frame will see.
        let landing = geometry.landing.clone();
        encoder.on_submitted_work_done(move || drop(landing));
        let [low, high] = self.bounds;
        *previous_origin = geometry.origin;
        geometry.origin = 0.5 * (low + high);
        geometry.half_extent = 0.5 * (high - low);
        geometry.content = next_serial();
        geometry.moved = true;
        geometry.gathered = true;
    }
}

/// Records the replacement of a hair's points.
pub(crate) fn update(
    gpu: &mut Gpu,
    encoder: &mut wgpu::CommandEncoder,
    geometry: &mut Geometry,
    source: &PointSource,
) -> Result<()> {
    if let Some(gathering) = prepare(gpu, geometry, source)? {
        gathering.record(encoder, geometry);
    }
    Ok(())
}

/// Bytes to whose multiples bound parts begin.
pub(crate) fn alignment(gpu: &Gpu) -> u64 {
    u64::from(gpu.limits.min_storage_buffer_offset_alignment).max(4)
}

/// A run's part of a buffer of `each` bytes a point.
fn own<'a>(allocation: &'a Allocation, run: &Run, each: u64) -> wgpu::BindingResource<'a> {
    let (first, count) = (u64::from(run.first), u64::from(run.count));
    part(&allocation.buffer, first * each, count * each)
}

pub(crate) fn part(buffer: &wgpu::Buffer, offset: u64, size: u64) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::Buffer(wgpu::BufferBinding {
        buffer,
        offset,
        size: NonZeroU64::new(size),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_cover_every_point_once_and_fit_the_binding() {
        for (count, offset, stride, alignment, limit) in [
            (1, 0, 12, 256, 1 << 27),
            (1000, 4, 12, 32, 1024),
            (1000, 1020, 16, 256, 4096),
            (77, 8, 64, 4, 2048),
        ] {
            let windows = windows(count, offset, stride, alignment, limit);
            let mut next = 0;
            for window in &windows {
                assert_eq!(window.first, next);
                next = window.end;
                assert!(window.size <= limit && window.size.is_multiple_of(4));
                assert!(window.offset.is_multiple_of(alignment));
                assert_eq!(
                    window.offset + window.base * 4,
                    offset + window.low * stride
                );
                assert!(window.low == window.first.saturating_sub(1));
                let last = (window.end + 1).min(count - 1);
                assert!(
                    window.offset + window.size >= offset + last * stride + POSITION,
                    "{window:?}"
                );
                assert!(window.offset + window.size <= offset + (count - 1) * stride + POSITION);
            }
            assert_eq!(next, count);
        }
    }
}
