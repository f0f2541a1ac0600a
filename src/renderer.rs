//! The renderer: a device's pipelines and pools, and the calls that make hair and record frames.

use crate::error::{Error, Result, invalid};
use crate::frame::{self, Frame, Target};
use crate::gather::{self, PointSource};
use crate::geometry::{Geometry, Hair};
use crate::gpu::{Gpu, Passes};
use crate::groom::{GuidedStrands, Strands};
use crate::guided::{self, Guiding};
use crate::memory::{MemoryEstimate, Viewport};
use crate::plan::Plan;
use crate::resources::Resources;
use crate::statistics::{Fragments, Statistics};

/// Renders hair on one device. Use it from one thread at a time.
///
/// It holds pipelines, which are made at their first use, and pools, which grow as frames need them and are kept.
pub struct Renderer {
    gpu: Gpu,
    resources: Resources,
    statistics: Statistics,
}

impl Renderer {
    /// A renderer on a device of the host.
    ///
    /// # Errors
    /// A device that allows fewer than 4 bind groups, 10 storage buffers a stage, or 256 invocations a workgroup.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Self> {
        let gpu = Gpu::new(device, queue)?;
        let resources = Resources::new(&gpu)?;
        Ok(Self {
            gpu,
            resources,
            statistics: Statistics::default(),
        })
    }

    /// Uploads strands as a hair with default shading, fully opaque fibres, and no wishes.
    ///
    /// # Errors
    /// More points than the device binds; no memory left, on the device or in the byte budget.
    pub fn create_hair(&mut self, strands: &Strands) -> Result<Hair> {
        Ok(Hair {
            world_from_object: glam::DMat4::IDENTITY,
            opacity: 1.0,
            shading: Default::default(),
            shading_rate: Default::default(),
            shadow: None,
            transparency: None,
            previous_world_from_object: None,
            instances: Vec::new(),
            geometry: Geometry::new(&self.gpu, strands)?,
        })
    }

    /// Replaces every position of a hair: moving hair with the same strands. Takes effect with the next frame recorded.
    /// Motion vectors tell from the positions before the last update, until [`Hair::rest`].
    ///
    /// # Errors
    /// Another number of points, or a position that is not finite; the hair is then as it was.
    pub fn update_points(&mut self, hair: &mut Hair, points: &[[f32; 3]]) -> Result<()> {
        hair.geometry.update(&self.gpu, points)
    }

    /// Replaces every position of a hair by those of a buffer of the host's, which are read when `encoder` is submitted:
    /// before, or together with, the frames that shall show them. Otherwise as [`Renderer::update_points`]; a later update
    /// from the CPU waits for that submission. A position that is not finite leaves its point where it was.
    ///
    /// [`Hair::strands`] is not told of the new positions.
    ///
    /// # Errors
    /// A source that does not fit: the value is named. No memory. The hair is then as it was, and nothing is recorded.
    pub fn update_points_from(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        hair: &mut Hair,
        source: &PointSource,
    ) -> Result<()> {
        gather::update(&mut self.gpu, encoder, &mut hair.geometry, source)
    }

    /// Uploads strands that remember their guides, so that these can be moved instead of them: a hair as
    /// [`Renderer::create_hair`] makes it, with 12 bytes more a point, and 48 a strand on a mesh or 24 a follower.
    ///
    /// # Errors
    /// As [`Renderer::create_hair`]; guides that are too large for the device's bindings.
    pub fn create_guided_hair(&mut self, strands: &GuidedStrands) -> Result<Hair> {
        let mut hair = self.create_hair(strands.strands())?;
        hair.geometry.guiding = Some(Guiding::new(&self.gpu, strands)?);
        Ok(hair)
    }

    /// Moves the guides of a hair, and all its strands after them: [`GuidedStrands::follow`] on the GPU. Otherwise as
    /// [`Renderer::update_points_from`], with which it can alternate.
    ///
    /// # Errors
    /// A hair without guides; another number of points than the guides have; a position that is not finite; no memory. The
    /// hair is then as it was, and nothing is recorded.
    pub fn update_guides(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        hair: &mut Hair,
        points: &[[f32; 3]],
    ) -> Result<()> {
        guided::update(&mut self.gpu, encoder, &mut hair.geometry, points)
    }

    /// As [`Renderer::update_guides`], with the guides' points from a buffer of the host's. The source's bounds are those of
    /// the guides: what stands out from them is added, as long as guides keep their length.
    ///
    /// # Errors
    /// A hair without guides; a source that does not fit; no memory. The hair is then as it was, and nothing is recorded.
    pub fn update_guides_from(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        hair: &mut Hair,
        source: &PointSource,
    ) -> Result<()> {
        guided::update_from(&mut self.gpu, encoder, &mut hair.geometry, source)
    }

    /// Limits the GPU memory that the renderer takes, in bytes; `None` lifts the limit. What is held is kept.
    pub fn set_byte_budget(&mut self, budget: Option<u64>) {
        self.gpu.set_byte_budget(budget);
    }

    /// Whether a frame takes the shadow maps that an earlier one has filled, where all is as it was then: the hairs' points,
    /// places and opacities, the light and its technique, whatever the view. On by default: the picture is the same, bit for
    /// bit. Off for a measurement of frames with everything new, or where frames are submitted in another order than they
    /// were recorded in.
    ///
    /// What has been filled counts only once it is known to have run: the first frames after a change fill their maps
    /// again until the counters of one have come back.
    pub fn set_shadow_reuse(&mut self, reuse: bool) {
        self.resources.set_shadow_reuse(reuse);
    }

    /// States the GPU memory that the renderer will hold once a frame has been recorded. The technique, the viewport, the hairs,
    /// pools' own `pool_bytes` and the byte budget decide it, together with what the last frames left and how many fragments
    /// they needed: pools grow and are kept. The device's memory and this renderer are as before.
    ///
    /// # Errors
    /// A value out of range, named; a conflict of wishes; a viewport of no pixels, or larger than the device's largest image.
    pub fn memory_estimate(
        &mut self,
        frame: &Frame,
        viewport: &Viewport,
    ) -> Result<MemoryEstimate> {
        let Viewport { width, height, .. } = *viewport;
        if width == 0 || height == 0 {
            return invalid!("a viewport of {width}×{height} pixels");
        }
        self.gpu.check_size([width, height])?;
        self.collect();
        let plan = Plan::new(&self.gpu, frame, viewport, None)?;
        let forecast = self.resources.forecast(&self.gpu, &plan)?;
        Ok(forecast.estimate())
    }

    /// States the GPU memory that [`Renderer::create_hair`] will take for strands, in bytes. As much work as that, but for the
    /// upload.
    ///
    /// # Errors
    /// More points than the device binds.
    pub fn hair_memory_estimate(&self, strands: &Strands) -> Result<u64> {
        Geometry::bytes(&self.gpu, strands)
    }

    /// Records a frame into the host's encoder and submits nothing. At most eight frames may be recorded before the
    /// first of them is submitted. They are submitted in the order in which they were recorded, or not at all: a frame may
    /// take shadow maps that one before it has filled ([`Renderer::set_shadow_reuse`]).
    ///
    /// # Errors
    /// A value out of range, named; a conflict of wishes; a target that does not fit; no memory. Nothing has then been
    /// recorded.
    pub fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame,
        target: &Target,
    ) -> Result<()> {
        self.record_passes(&mut Passes::Recorded(encoder), frame, target)
    }

    /// Renders a frame pass by pass, each submitted alone and waited for, and returns the statistics with their times.
    /// Slower than [`Renderer::record`] by the waits.
    ///
    /// # Errors
    /// As [`Renderer::record`].
    pub fn render_timed(&mut self, frame: &Frame, target: &Target) -> Result<Statistics> {
        let mut passes = Passes::timed(&self.gpu);
        self.record_passes(&mut passes, frame, target)?;
        let mut statistics = self.statistics();
        if let Passes::Timed(timed) = passes {
            statistics.passes = timed.times;
        }
        Ok(statistics)
    }

    fn record_passes(&mut self, passes: &mut Passes, frame: &Frame, target: &Target) -> Result<()> {
        target.validate(&self.gpu.device)?;
        self.collect();
        if self.resources.next_slot_busy() {
            self.wait()?;
            // What has arrived meanwhile is still mapped.
            self.collect();
            if self.resources.next_slot_busy() {
                return Err(Error::InvalidValue(
                    "eight frames have been recorded and none of them submitted; submit before recording more".into(),
                ));
            }
        }
        let mut plan = Plan::new(&self.gpu, frame, &target.into(), Some(target))?;
        self.resources
            .prepare(&self.gpu, frame, &mut plan, target)?;
        frame::record(&mut self.gpu, passes, &self.resources, &plan, target)?;
        self.statistics.strands = plan.strands;
        self.statistics.segments = plan.segments;
        let filled = plan.maps.iter().filter(|map| map.filled).count();
        self.statistics.shadow_maps_filled = filled as u64;
        self.statistics.shadow_maps_taken = (plan.maps.len() - filled) as u64;
        if plan.runs.is_empty() {
            self.statistics.fragments = Fragments::default();
        }
        Ok(())
    }

    /// Statistics of the latest frame whose counters have come back, and of the memory held now. Does not wait.
    pub fn statistics(&mut self) -> Statistics {
        self.collect();
        let ledger = self.gpu.ledger();
        self.statistics.bytes = ledger.by_label();
        self.statistics.bytes_total = ledger.total();
        self.statistics.bytes_peak = ledger.peak();
        self.statistics.clone()
    }

    /// The device that the renderer works on.
    pub fn device(&self) -> &wgpu::Device {
        &self.gpu.device
    }

    /// The queue that the renderer works on.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.gpu.queue
    }

    /// For the crate's own tests.
    pub(crate) fn parts(&mut self) -> (&mut Gpu, &mut Resources) {
        (&mut self.gpu, &mut self.resources)
    }

    /// Waits for all work submitted to the device.
    pub(crate) fn wait(&mut self) -> Result<()> {
        match self.gpu.device.poll(wgpu::PollType::wait_indefinitely()) {
            Ok(_) => Ok(()),
            Err(error) => Err(Error::DeviceLost(error.to_string())),
        }
    }

    fn collect(&mut self) {
        if let Err(error) = self.gpu.device.poll(wgpu::PollType::Poll) {
            log::debug!("polling: {error}");
        }
        let Some(returned) = self.resources.collect() else {
            return;
        };
        self.statistics.fragments = Fragments {
            produced: returned.produced,
            culled: returned.culled,
            stored: returned.stored,
            merged: returned.merged,
        };
        self.statistics.covered_pixels = returned.covered;
        if returned.overflowed > 0 {
            log::warn!(
                "the fragment pool was too small for {} of {} fragments, which were merged",
                returned.overflowed,
                returned.produced
            );
        }
    }
}
