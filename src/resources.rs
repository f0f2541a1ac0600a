//! What frames draw with: pools that grow and are kept, a ring of uniforms and counters, and bind groups that are made
//! anew only when one of these changes.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use crate::error::{Error, Result};
use crate::frame::{Frame, Target};
use crate::gpu::{Allocation, Gpu, Group, Passes};
use crate::layout::{Counters, MAX_OCCLUDERS, PointOutput, Projected};
use crate::plan::{Plan, part_capacity};
use crate::raster::Rasteriser;
use crate::shading::tables;
use crate::transparency::Fragments;
use crate::transparency::a_buffer::{FRAGMENT_BYTES, NODE_BYTES};

/// Frames that may be recorded before the first of them is submitted: each has its own uniforms and counters.
pub(crate) const RING: usize = 8;
/// Bytes of one band's counters; an offset that every device can bind.
const COUNTER_STRIDE: u64 = 256;
/// Bands whose counters are kept.
const MAX_BANDS: u64 = 64;
/// Room in a new pool beyond what the frame is expected, or was measured, to need.
const POOL_MARGIN: f64 = 1.15;

/// Fragments of the smallest pool that the library makes of itself.
const SMALLEST_POOL: u64 = 1 << 16;
/// Bytes that a pool leaves free in the host's budget.
const RESERVE: u64 = 1 << 16;

/// The state of a slot's counters on their way back.
const IDLE: u8 = 0;
const PENDING: u8 = 1;
const ARRIVED: u8 = 2;
const FAILED: u8 = 3;

/// The pixels' buffers, in the order of their bindings.
pub(crate) struct Pixels {
    pub counters: Allocation,
    pub fill: Allocation,
    pub links: Allocation,
    /// The parts of the fragment pool.
    pub fragments: [Allocation; 3],
    pub overflow: Allocation,
}

/// One frame's uniforms and returning counters.
struct Slot {
    uniforms: Option<Allocation>,
    counters: Allocation,
    state: Arc<AtomicU8>,
    bands: u64,
    lists: bool,
    capacity: u64,
    /// The tables that the frame fills; 0: none.
    fills: u64,
    frame: Option<wgpu::BindGroup>,
    frame_without_depth: Option<wgpu::BindGroup>,
    depth: Option<wgpu::Texture>,
    /// The host's shadow maps, and what binds them.
    occluding: Vec<wgpu::Texture>,
    occluders: Option<wgpu::BindGroup>,
}

/// One run's bind groups.
pub(crate) struct RunGroups {
    pub project: wgpu::BindGroup,
    pub segments: wgpu::BindGroup,
    pub shade: wgpu::BindGroup,
    /// Where an output asks for it.
    pub track: Option<wgpu::BindGroup>,
}

/// Bind groups of the pools.
struct Groups {
    serials: Vec<u64>,
    generation: u64,
    tracked: bool,
    point_outputs: wgpu::BindGroup,
    tables: u64,
    tables_written: Option<wgpu::BindGroup>,
    runs: Vec<RunGroups>,
    host_tiles: wgpu::BindGroup,
    maps_written: wgpu::BindGroup,
    maps_read: wgpu::BindGroup,
    pixels_written: wgpu::BindGroup,
    pixels_read: wgpu::BindGroup,
}

/// What the passes of one frame bind.
pub(crate) struct Bound<'a> {
    pub frame: &'a wgpu::BindGroup,
    pub frame_without_depth: &'a wgpu::BindGroup,
    pub runs: &'a [RunGroups],
    pub host_tiles: &'a wgpu::BindGroup,
    /// The shading models' tables, where they are still to be filled.
    pub tables: Option<&'a wgpu::BindGroup>,
    pub maps_written: &'a wgpu::BindGroup,
    pub maps_read: &'a wgpu::BindGroup,
    /// Where the host has shadow maps.
    pub occluders: Option<&'a wgpu::BindGroup>,
    pub pixels_written: &'a wgpu::BindGroup,
    pub pixels: &'a Pixels,
    pub pixels_read: &'a wgpu::BindGroup,
    pub point_outputs: &'a wgpu::BindGroup,
    pub attachment: Option<wgpu::TextureView>,
    /// A copy of the counters, for the arguments in them.
    pub arguments: &'a wgpu::Buffer,
    returned: &'a Allocation,
}

impl Bound<'_> {
    /// Index and bind group of what an emission writes.
    pub fn emission(&self, group: Group) -> (u32, &wgpu::BindGroup) {
        match group {
            Group::MapsWritten => (2, self.maps_written),
            _ => (3, self.pixels_written),
        }
    }

    /// Zeroes the counters before a band.
    pub fn clear_counters(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.clear_buffer(&self.pixels.counters.buffer, 0, None);
    }

    /// Copies the counters to where their arguments can be taken from.
    pub fn copy_arguments(&self, passes: &mut Passes) {
        let size = size_of::<Counters>() as u64;
        passes.encode("pelage.transparency.arguments", |encoder| {
            encoder.copy_buffer_to_buffer(
                &self.pixels.counters.buffer,
                0,
                self.arguments,
                0,
                Some(size),
            );
        });
    }

    /// Keeps a band's counters for the host.
    pub fn keep_counters(&self, passes: &mut Passes, band: u32) {
        let size = size_of::<Counters>() as u64;
        let at = u64::from(band).min(MAX_BANDS - 1) * COUNTER_STRIDE;
        passes.encode("pelage.counters", |encoder| {
            encoder.copy_buffer_to_buffer(
                &self.pixels.counters.buffer,
                0,
                &self.returned.buffer,
                at,
                Some(size),
            );
        });
    }
}

/// Counters of a finished frame, summed over its bands.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Returned {
    pub produced: u64,
    pub culled: u64,
    pub stored: u64,
    pub merged: u64,
    pub covered: u64,
    /// The most that one band asked of the pool.
    pub needed: u64,
}

/// Pools, ring and bind groups.
pub(crate) struct Resources {
    projected: Allocation,
    shaded: Allocation,
    point_outputs: Allocation,
    host_tiles: Allocation,
    maps: Allocation,
    tables: tables::Held,
    pixels: Pixels,
    arguments: Allocation,
    generation: u64,
    groups: Option<Groups>,
    slots: Vec<Slot>,
    slot: usize,
    no_depth: wgpu::Texture,
    attachment: Option<wgpu::Texture>,
    /// Fragments that the last frames needed.
    needed: u64,
    capacity: u64,
}

/// `count` elements of `each` bytes, from `first` on.
fn part(allocation: &Allocation, first: u64, count: u64, each: u64) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::Buffer(wgpu::BufferBinding {
        buffer: &allocation.buffer,
        offset: first * each,
        size: std::num::NonZeroU64::new(count.max(1) * each),
    })
}

/// What a depth texture's depth is bound by.
fn depth_view(depth: &wgpu::Texture) -> wgpu::TextureView {
    depth.create_view(&wgpu::TextureViewDescriptor {
        aspect: wgpu::TextureAspect::DepthOnly,
        ..Default::default()
    })
}

/// Grows a buffer to `size` bytes; the old one is kept where that fails.
fn grow(
    gpu: &Gpu,
    slot: &mut Allocation,
    label: &'static str,
    size: u64,
    generation: &mut u64,
) -> Result<()> {
    if slot.size() >= size {
        return Ok(());
    }
    *slot = gpu.storage(label, size)?;
    *generation += 1;
    Ok(())
}

impl Resources {
    pub fn new(gpu: &Gpu) -> Result<Self> {
        let empty = |label| gpu.storage(label, 256);
        let slots = (0..RING)
            .map(|_| {
                let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
                Ok(Slot {
                    uniforms: None,
                    counters: gpu.allocate(
                        "pelage.counters.returned",
                        MAX_BANDS * COUNTER_STRIDE,
                        usage,
                    )?,
                    state: Arc::default(),
                    bands: 0,
                    lists: false,
                    capacity: 0,
                    fills: 0,
                    frame: None,
                    frame_without_depth: None,
                    depth: None,
                    occluding: Vec::new(),
                    occluders: None,
                })
            })
            .collect::<Result<Vec<_>>>()?;
        Ok(Self {
            projected: empty("pelage.geometry.projected")?,
            shaded: empty("pelage.shading.points")?,
            point_outputs: empty("pelage.geometry.point_outputs")?,
            host_tiles: empty("pelage.geometry.host_tiles")?,
            maps: empty("pelage.shadow.maps")?,
            tables: tables::Held::default(),
            pixels: Pixels {
                counters: empty("pelage.counters")?,
                fill: empty("pelage.transparency.fill")?,
                links: empty("pelage.transparency.links")?,
                fragments: [
                    empty("pelage.transparency.fragments")?,
                    empty("pelage.transparency.fragments")?,
                    empty("pelage.transparency.fragments")?,
                ],
                overflow: empty("pelage.transparency.overflow")?,
            },
            arguments: gpu.allocate(
                "pelage.transparency.arguments",
                256,
                wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_DST,
            )?,
            generation: 0,
            groups: None,
            slots,
            slot: 0,
            no_depth: gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("pelage.no_depth"),
                size: wgpu::Extent3d {
                    width: 1,
                    height: 1,
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Depth32Float,
                usage: wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            }),
            attachment: None,
            needed: 0,
            capacity: 0,
        })
    }

    /// Makes everything that the plan needs, and writes its uniforms.
    pub fn prepare(
        &mut self,
        gpu: &Gpu,
        frame: &Frame,
        plan: &mut Plan,
        target: &Target,
    ) -> Result<()> {
        if plan.runs.is_empty() {
            return Ok(());
        }
        self.tables.hold(gpu, plan)?;
        for hair in 0..plan.shadings.len() {
            let place = self.tables.place(&plan.shadings[hair]);
            plan.set_tables(hair, place);
        }
        self.grow_pools(gpu, plan)?;
        if gpu.limits.max_texture_dimension_2d < plan.width.max(plan.height) {
            return Err(Error::Unsupported(format!(
                "a target of {}×{} pixels",
                plan.width, plan.height
            )));
        }
        self.grow_attachment(gpu, plan);
        let key_matches = self.groups.as_ref().is_some_and(|groups| {
            groups.generation == self.generation
                && groups.serials == plan.serials
                && (groups.tracked || !plan.tracked)
                && groups.tables == self.tables.serial()
        });
        if !key_matches {
            self.groups = Some(self.bind(gpu, frame, plan));
        }
        plan.seal(self.capacity);
        self.slot = (self.slot + 1) % RING;
        self.write_uniforms(gpu, plan, target)
    }

    fn grow_pools(&mut self, gpu: &Gpu, plan: &Plan) -> Result<()> {
        let generation = &mut self.generation;
        let points = plan.point_count;
        grow(
            gpu,
            &mut self.projected,
            "pelage.geometry.projected",
            points * size_of::<Projected>() as u64,
            generation,
        )?;
        grow(
            gpu,
            &mut self.shaded,
            "pelage.shading.points",
            points * 8,
            generation,
        )?;
        if plan.tracked {
            grow(
                gpu,
                &mut self.point_outputs,
                "pelage.geometry.point_outputs",
                points * size_of::<PointOutput>() as u64,
                generation,
            )?;
        }
        if plan.host_depth || plan.cuts {
            let bytes = u64::from(plan.tile_count()) * 8;
            grow(
                gpu,
                &mut self.host_tiles,
                "pelage.geometry.host_tiles",
                bytes,
                generation,
            )?;
        }
        grow(
            gpu,
            &mut self.maps,
            "pelage.shadow.maps",
            plan.map_words * 4,
            generation,
        )?;
        if plan.shadows_only {
            return Ok(());
        }
        let pixels = plan
            .bands
            .iter()
            .map(|band| u64::from(plan.width) * u64::from(band.rows))
            .max()
            .unwrap_or(0);
        let pool = &mut self.pixels;
        let needs = plan.transparency.needs(pixels);
        let mut sized =
            |slot: &mut Allocation, label, bytes| grow(gpu, slot, label, bytes, generation);
        sized(&mut pool.fill, "pelage.transparency.fill", needs.fill)?;
        sized(&mut pool.links, "pelage.transparency.links", needs.links)?;
        sized(
            &mut pool.overflow,
            "pelage.transparency.overflow",
            needs.overflow,
        )?;
        match needs.fragments {
            Fragments::Fixed(bytes) => sized(
                &mut pool.fragments[0],
                "pelage.transparency.fragments",
                bytes,
            ),
            Fragments::Pool { linked, bytes } => self.grow_fragments(gpu, plan, linked, bytes),
        }
    }

    /// Sizes the fragment pool: to what the host says, or to what is expected or was measured, within the budget.
    fn grow_fragments(
        &mut self,
        gpu: &Gpu,
        plan: &Plan,
        lists: bool,
        pool_bytes: Option<u64>,
    ) -> Result<()> {
        let each = if lists { NODE_BYTES } else { FRAGMENT_BYTES };
        let part = part_capacity(gpu);
        let held = self.fragments_held(part);
        // Lists keep their links in one binding.
        let most = if lists {
            (3 * part).min(gpu.max_binding() / 4)
        } else {
            3 * part
        };
        let wanted = match pool_bytes {
            Some(bytes) => (bytes / each).min(most),
            None => {
                let expected = plan.expected_fragments.max(self.needed) as f64 * POOL_MARGIN;
                (expected as u64).clamp(SMALLEST_POOL.min(most), most)
            }
        };
        // What the old pool holds comes free before the new one is made; the ring's uniforms find room too.
        let reserve = RING as u64 * (plan.uniforms.len() as u64).next_power_of_two() + RESERVE;
        let left = (gpu.ledger().left().saturating_sub(reserve) / each).saturating_add(held);
        let wanted = wanted.min(left).max(1);
        if held < wanted {
            for (number, slot) in self.pixels.fragments.iter_mut().enumerate() {
                let bytes = wanted.saturating_sub(number as u64 * part).min(part) * FRAGMENT_BYTES;
                if slot.size() < bytes {
                    // The old part comes free before the new one is made.
                    *slot = gpu.storage("pelage.transparency.fragments", 256)?;
                    self.generation += 1;
                    grow(
                        gpu,
                        slot,
                        "pelage.transparency.fragments",
                        bytes,
                        &mut self.generation,
                    )?;
                }
            }
        }
        if lists {
            let links = &mut self.pixels.links;
            let label = "pelage.transparency.links";
            grow(gpu, links, label, wanted * 4, &mut self.generation)?;
        }
        let held = self.fragments_held(part).min(most);
        self.capacity = if pool_bytes.is_some() {
            wanted.min(held)
        } else {
            held
        };
        if lists {
            self.capacity = self.capacity.min(self.pixels.links.size() / 4);
        }
        Ok(())
    }

    /// Fragments that the pool's parts hold: a part counts where the one before it is full.
    fn fragments_held(&self, part: u64) -> u64 {
        let mut held = 0;
        for slot in &self.pixels.fragments {
            let fragments = (slot.size() / FRAGMENT_BYTES).min(part);
            held += fragments;
            if fragments < part {
                break;
            }
        }
        held
    }

    /// The attachment of ribbons, as large as the largest image that they draw.
    fn grow_attachment(&mut self, gpu: &Gpu, plan: &Plan) {
        let view = [(plan.rasteriser, plan.width, plan.height)];
        let maps = plan
            .maps
            .iter()
            .map(|map| (map.rasteriser, map.shape.resolution, map.shape.resolution));
        let sizes = view
            .into_iter()
            .chain(maps)
            .filter(|(rasteriser, ..)| *rasteriser == Rasteriser::Ribbons);
        let Some((width, height)) = sizes
            .map(|(_, w, h)| (w, h))
            .reduce(|a, b| (a.0.max(b.0), a.1.max(b.1)))
        else {
            return;
        };
        if self
            .attachment
            .as_ref()
            .is_some_and(|held| held.width() >= width && held.height() >= height)
        {
            return;
        }
        self.attachment = Some(gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("pelage.raster.ribbons"),
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: crate::raster::ATTACHMENT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        }));
    }

    fn bind(&self, gpu: &Gpu, frame: &Frame, plan: &Plan) -> Groups {
        let runs = plan
            .runs
            .iter()
            .map(|run| {
                let geometry = &frame.hairs[run.hair].geometry;
                let (first, base, count) = (
                    u64::from(run.run.first),
                    u64::from(run.base),
                    u64::from(run.run.count),
                );
                let points = || part(&geometry.points, first, count, 16);
                let attributes = || part(&geometry.attributes, first, count, 8);
                let each = size_of::<Projected>() as u64;
                let projected = || part(&self.projected, base, count, each);
                RunGroups {
                    project: gpu.bind(
                        "pelage.project",
                        Group::Project,
                        &[
                            points(),
                            attributes(),
                            projected(),
                            self.host_tiles.binding(),
                        ],
                    ),
                    segments: gpu.bind(
                        "pelage.segments",
                        Group::Segments,
                        &[projected(), part(&geometry.segments, first, count, 4)],
                    ),
                    shade: gpu.bind(
                        "pelage.shade",
                        Group::Shade,
                        &[
                            points(),
                            attributes(),
                            geometry.colours.binding(),
                            projected(),
                            self.shaded.binding(),
                            // Models without tables read none: anything will do.
                            self.tables.buffer().unwrap_or(&geometry.colours).binding(),
                        ],
                    ),
                    track: plan.tracked.then(|| {
                        let previous = match geometry.previous() {
                            Some((buffer, _)) => part(buffer, first, count, 16),
                            None => points(),
                        };
                        gpu.bind(
                            "pelage.track",
                            Group::Track,
                            &[
                                points(),
                                previous,
                                attributes(),
                                self.point_outputs.binding(),
                            ],
                        )
                    }),
                }
            })
            .collect();
        let pool = &self.pixels;
        let pixels: Vec<_> = [
            &pool.counters,
            &pool.fill,
            &pool.links,
            &pool.fragments[0],
            &pool.fragments[1],
            &pool.fragments[2],
            &pool.overflow,
            &self.shaded,
        ]
        .into_iter()
        .map(Allocation::binding)
        .collect();
        Groups {
            serials: plan.serials.clone(),
            generation: self.generation,
            tracked: plan.tracked,
            point_outputs: gpu.bind(
                "pelage.point_outputs",
                Group::PointOutputs,
                &[self.point_outputs.binding()],
            ),
            tables: self.tables.serial(),
            tables_written: self.tables.buffer().map(|buffer| {
                gpu.bind(
                    "pelage.shading.tables",
                    Group::TablesWritten,
                    &[buffer.binding()],
                )
            }),
            runs,
            host_tiles: gpu.bind(
                "pelage.host_tiles",
                Group::HostTiles,
                &[self.host_tiles.binding()],
            ),
            maps_written: gpu.bind(
                "pelage.maps_written",
                Group::MapsWritten,
                &[self.maps.binding()],
            ),
            maps_read: gpu.bind("pelage.maps_read", Group::MapsRead, &[self.maps.binding()]),
            pixels_written: gpu.bind("pelage.pixels_written", Group::PixelsWritten, &pixels),
            pixels_read: gpu.bind("pelage.pixels_read", Group::PixelsRead, &pixels),
        }
    }

    fn write_uniforms(&mut self, gpu: &Gpu, plan: &Plan, target: &Target) -> Result<()> {
        let slot = &mut self.slots[self.slot];
        let size = plan.uniforms.len() as u64;
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let stale = slot.uniforms.as_ref().is_none_or(|held| held.size() < size);
        if stale {
            slot.uniforms =
                Some(gpu.allocate("pelage.uniforms", size.next_power_of_two(), usage)?);
        }
        let Some(uniforms) = &slot.uniforms else {
            return Ok(());
        };
        gpu.queue.write_buffer(&uniforms.buffer, 0, &plan.uniforms);
        if stale || slot.frame.is_none() || slot.depth.as_ref() != target.depth {
            let bind = |depth: &wgpu::Texture| {
                let view = depth_view(depth);
                let block = |size: usize| {
                    wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                        buffer: &uniforms.buffer,
                        offset: 0,
                        size: std::num::NonZeroU64::new(size as u64),
                    })
                };
                gpu.bind(
                    "pelage.frame",
                    Group::Frame,
                    &[
                        block(size_of::<crate::layout::Frame>()),
                        block(size_of::<crate::layout::Drawing>()),
                        block(size_of::<crate::layout::Material>()),
                        wgpu::BindingResource::TextureView(&view),
                    ],
                )
            };
            slot.frame = Some(bind(target.depth.unwrap_or(&self.no_depth)));
            slot.frame_without_depth = Some(bind(&self.no_depth));
            slot.depth = target.depth.cloned();
        }
        let given = target.occluders.iter().map(|occluder| occluder.depth);
        if !slot.occluding.iter().eq(given.clone()) {
            slot.occluding = given.cloned().collect();
            slot.occluders = (!slot.occluding.is_empty()).then(|| {
                let maps = slot.occluding.iter();
                let views: Vec<_> = maps
                    .chain(std::iter::repeat(&self.no_depth))
                    .take(MAX_OCCLUDERS)
                    .map(depth_view)
                    .collect();
                let views: Vec<_> = views
                    .iter()
                    .map(wgpu::BindingResource::TextureView)
                    .collect();
                gpu.bind("pelage.occluders", Group::Occluders, &views)
            });
        }
        slot.bands = plan.bands.len() as u64;
        slot.lists = plan.transparency.needs(0).fragments.linked();
        slot.capacity = self.capacity;
        slot.fills = if plan.shadows_only {
            0
        } else {
            self.tables.to_fill()
        };
        Ok(())
    }

    /// What the passes of the frame just prepared bind.
    pub fn bound<'a>(&'a self, plan: &Plan) -> Option<Bound<'a>> {
        if plan.runs.is_empty() {
            return None;
        }
        let slot = &self.slots[self.slot];
        let groups = self.groups.as_ref()?;
        Some(Bound {
            frame: slot.frame.as_ref()?,
            frame_without_depth: slot.frame_without_depth.as_ref()?,
            runs: &groups.runs,
            host_tiles: &groups.host_tiles,
            tables: groups.tables_written.as_ref().filter(|_| slot.fills > 0),
            maps_written: &groups.maps_written,
            maps_read: &groups.maps_read,
            occluders: slot.occluders.as_ref(),
            pixels_written: &groups.pixels_written,
            pixels_read: &groups.pixels_read,
            point_outputs: &groups.point_outputs,
            pixels: &self.pixels,
            attachment: self
                .attachment
                .as_ref()
                .map(|texture| texture.create_view(&Default::default())),
            arguments: &self.arguments.buffer,
            returned: &slot.counters,
        })
    }

    /// Clears the shadow maps for a new frame.
    pub fn clear_maps(&self, passes: &mut Passes, plan: &Plan) {
        if plan.map_words > 0 {
            passes.encode("pelage.shadow.clear", |encoder| {
                encoder.clear_buffer(&self.maps.buffer, 0, Some(plan.map_words * 4));
            });
        }
    }

    /// Counters of a frame that draws no hair.
    pub fn keep_nothing(&self, passes: &mut Passes, bound: &Bound, plan: &Plan) {
        passes.encode("pelage.counters", |encoder| bound.clear_counters(encoder));
        for band in &plan.bands {
            bound.keep_counters(passes, band.number);
        }
        self.read_counters(passes);
    }

    /// Sends the frame's counters on their way back to the host; they arrive some frames later.
    pub fn read_counters(&self, passes: &mut Passes) {
        let slot = &self.slots[self.slot];
        slot.state.store(PENDING, Ordering::Release);
        let arrival = Arrival(slot.state.clone());
        let arrived = move |result: std::result::Result<(), wgpu::BufferAsyncError>| {
            if result.is_ok() {
                arrival.0.store(ARRIVED, Ordering::Release);
            }
        };
        passes.encode("pelage.counters", |encoder| {
            encoder.map_buffer_on_submit(&slot.counters.buffer, wgpu::MapMode::Read, .., arrived);
        });
    }

    /// Whether the slot that the next frame will use is still on its way.
    pub fn next_slot_busy(&self) -> bool {
        self.slots[(self.slot + 1) % RING]
            .state
            .load(Ordering::Acquire)
            == PENDING
    }

    /// Takes in all counters that have arrived; the newest.
    pub fn collect(&mut self) -> Option<Returned> {
        let mut newest = None;
        for step in 1..=RING {
            let number = (self.slot + step) % RING;
            let slot = &mut self.slots[number];
            match slot.state.load(Ordering::Acquire) {
                ARRIVED => {
                    newest = Some(read_slot(slot));
                    // A frame that was recorded and never submitted has filled nothing.
                    self.tables.mark_filled(slot.fills);
                    slot.counters.buffer.unmap();
                    slot.state.store(IDLE, Ordering::Release);
                }
                FAILED => slot.state.store(IDLE, Ordering::Release),
                _ => {}
            }
        }
        if let Some(returned) = newest {
            self.needed = returned.needed;
        }
        newest
    }
}

/// Counters on their way. Where they never set out, since the frame was not submitted, dropping this says so.
struct Arrival(Arc<AtomicU8>);

impl Drop for Arrival {
    fn drop(&mut self) {
        let (order, seen) = (Ordering::AcqRel, Ordering::Acquire);
        // An error is no failure: they have arrived.
        self.0.compare_exchange(PENDING, FAILED, order, seen).ok();
    }
}

/// The sums of a slot's bands.
fn read_slot(slot: &Slot) -> Returned {
    let mut sum = Returned::default();
    let Ok(bytes) = slot.counters.buffer.get_mapped_range(..) else {
        return sum;
    };
    for band in 0..slot.bands.min(MAX_BANDS) {
        let at = (band * COUNTER_STRIDE) as usize;
        let counters: Counters =
            bytemuck::pod_read_unaligned(&bytes[at..at + size_of::<Counters>()]);
        let [produced, culled, mut stored, mut merged] = [
            counters.produced,
            counters.culled,
            counters.stored,
            counters.merged,
        ]
        .map(u64::from);
        let mut needed = produced;
        if slot.lists {
            needed = stored;
            merged = stored.saturating_sub(slot.capacity);
            stored -= merged;
        }
        sum.produced += if slot.lists { needed } else { produced } + culled;
        sum.culled += culled;
        sum.stored += stored;
        sum.merged += merged;
        sum.covered += u64::from(counters.covered);
        sum.needed = sum.needed.max(needed);
    }
    sum
}
