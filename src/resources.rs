//! What frames draw with: pools that grow and are kept, a ring of uniforms and counters, and bind groups that are made
//! anew only when one of these changes.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use crate::error::Result;
use crate::frame::{Frame, Target};
use crate::gpu::{Allocation, Gpu, Group, ImageAllocation, Passes};
use crate::layout::{Counters, MAX_OCCLUDERS, ORDER_KEYS, PointOutput, Projected};
use crate::memory::Forecast;
use crate::occluder::Occluder;
use crate::plan::{POOL_MARGIN, Plan, PlannedMap, most_fragments};
use crate::raster::{ATTACHMENT, Rasteriser};
use crate::shading::{ShadingRate, tables, transmission};
use crate::shadow::held::HeldMaps;
use crate::surface::{Subresource, Surface};
use crate::transparency::a_buffer::{FRAGMENT_BYTES, HALF_BYTES, NODE_BYTES};
use crate::transparency::sorted_blending::MAX_PARTS;
use crate::transparency::{Fragments, Transparency, read_group};

/// Frames that may be recorded before the first of them is submitted: each has its own uniforms and counters.
pub(crate) const RING: usize = 8;
/// Bytes of one band's counters; an offset that every device can bind.
const COUNTER_STRIDE: u64 = 256;
/// Bands whose counters are kept.
const MAX_BANDS: u64 = 64;
/// Fragments of the smallest pool that the library makes of itself.
const SMALLEST_POOL: u64 = 1 << 16;
/// Bytes that a pool leaves free in the host's budget.
const RESERVE: u64 = 1 << 16;

const UNIFORMS: &str = "pelage.uniforms";
const LINKS: &str = "pelage.transparency.links";
const FRAGMENTS: &str = "pelage.transparency.fragments";
const HISTOGRAM: &str = "pelage.transparency.sorted_blending.histogram";

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
    /// The fragment pool: the upper and the lower halves of words.
    pub fragments: [Allocation; 2],
    pub overflow: Allocation,
}

impl Pixels {
    fn new(gpu: &Gpu) -> Result<Self> {
        let empty = |label| gpu.storage(label, 256);
        Ok(Self {
            counters: empty("pelage.counters")?,
            fill: empty("pelage.transparency.fill")?,
            links: empty(LINKS)?,
            fragments: [empty(FRAGMENTS)?, empty(FRAGMENTS)?],
            overflow: empty("pelage.transparency.overflow")?,
        })
    }
}

/// One frame's uniforms and returning counters.
struct Slot {
    uniforms: Option<Allocation>,
    counters: Allocation,
    state: Arc<AtomicU8>,
    bands: u64,
    /// Whether fragments lie in a pool, and whether as linked nodes.
    pool: bool,
    lists: bool,
    capacity: u64,
    /// The tables that the frame fills; 0: none.
    fills: u64,
    /// The order that it sorts; 0: none.
    sorts: u64,
    /// The shadow maps that it fills and later frames may take.
    maps: Vec<u64>,
    frame: Option<wgpu::BindGroup>,
    frame_without_depth: Option<wgpu::BindGroup>,
    depth: Option<(wgpu::Texture, Subresource)>,
    /// The host's shadow maps, and what binds them.
    occluding: Vec<(wgpu::Texture, Subresource)>,
    occluders: Option<wgpu::BindGroup>,
}

/// One run's bind groups.
pub(crate) struct RunGroups {
    pub project: wgpu::BindGroup,
    pub order: wgpu::BindGroup,
    pub segments: wgpu::BindGroup,
    pub shade: wgpu::BindGroup,
    /// Where an output asks for it.
    pub track: Option<wgpu::BindGroup>,
}

/// What sorted blending binds.
pub(crate) struct SortedGroups {
    /// Order and histogram.
    pub sorting: wgpu::BindGroup,
    /// The order, and all hairs' points.
    pub segments: wgpu::BindGroup,
    pub shaded: wgpu::BindGroup,
    pub image: wgpu::TextureView,
    read: wgpu::BindGroup,
}

/// The order that sorted blending has found.
#[derive(Default)]
struct Order {
    /// What it is the order of.
    of: Vec<u64>,
    number: u64,
    /// Frames that have taken it.
    age: u32,
    /// Whether a frame that found it is known to have run.
    known: bool,
}

/// Bind groups of the pools.
struct Groups {
    serials: Vec<u64>,
    generation: u64,
    rate: ShadingRate,
    tracked: bool,
    point_outputs: wgpu::BindGroup,
    tables: u64,
    tables_written: Option<wgpu::BindGroup>,
    /// Where fragments are shaded.
    tables_read: Option<wgpu::BindGroup>,
    runs: Vec<RunGroups>,
    host_tiles: wgpu::BindGroup,
    host_tiles_read: wgpu::BindGroup,
    maps_written: wgpu::BindGroup,
    maps_read: wgpu::BindGroup,
    pixels_written: wgpu::BindGroup,
    pixels_read: wgpu::BindGroup,
    /// Where the technique sorts.
    sorted: Option<SortedGroups>,
}

/// What the passes of one frame bind.
pub(crate) struct Bound<'a> {
    pub frame: &'a wgpu::BindGroup,
    pub frame_without_depth: &'a wgpu::BindGroup,
    pub runs: &'a [RunGroups],
    pub host_tiles: &'a wgpu::BindGroup,
    pub host_tiles_read: &'a wgpu::BindGroup,
    /// The shading models' tables, where they are still to be filled.
    pub tables: Option<&'a wgpu::BindGroup>,
    /// The same, where fragments are shaded and read them.
    pub tables_read: Option<&'a wgpu::BindGroup>,
    pub maps_written: &'a wgpu::BindGroup,
    pub maps_read: &'a wgpu::BindGroup,
    /// Where the host has shadow maps.
    pub occluders: Option<&'a wgpu::BindGroup>,
    pub pixels_written: &'a wgpu::BindGroup,
    pub pixels: &'a Pixels,
    pixels_read: &'a wgpu::BindGroup,
    pub sorted: Option<&'a SortedGroups>,
    /// The parts of the sort's histogram.
    pub histogram: &'a [Allocation; MAX_PARTS as usize],
    pub point_outputs: &'a wgpu::BindGroup,
    pub attachment: Option<wgpu::TextureView>,
    pub order_counts: &'a wgpu::Buffer,
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

    /// What the composite reads of the pixels.
    pub fn read(&self, plan: &Plan) -> &wgpu::BindGroup {
        match (read_group(&plan.transparency), self.sorted) {
            (Group::BlendedRead, Some(sorted)) => &sorted.read,
            _ => self.pixels_read,
        }
    }

    /// Zeroes the counters before a band.
    pub fn clear_counters(&self, encoder: &mut wgpu::CommandEncoder) {
        let counters = &self.pixels.counters;
        encoder.clear_buffer(&counters.buffer, 0, Some(counters.size()));
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
    /// Of these, for want of room in the pool.
    pub overflowed: u64,
    pub covered: u64,
    /// The most that one band asked of the pool.
    pub needed: u64,
}

/// Pools, ring and bind groups.
pub(crate) struct Resources {
    projected: Allocation,
    /// The order of every run's segments, and its keys' counts.
    order: Allocation,
    order_counts: Allocation,
    shaded: Allocation,
    fibre_points: Allocation,
    point_outputs: Allocation,
    host_tiles: Allocation,
    maps: Allocation,
    held_maps: HeldMaps,
    tables: tables::Held,
    bounds: transmission::Bounds,
    pixels: Pixels,
    /// The parts of the sort's histogram.
    histogram: [Allocation; MAX_PARTS as usize],
    sorted: Allocation,
    blended: Option<ImageAllocation>,
    found: Order,
    arguments: Allocation,
    generation: u64,
    groups: Option<Groups>,
    slots: Vec<Slot>,
    slot: usize,
    no_depth: wgpu::Texture,
    attachment: Option<ImageAllocation>,
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

/// What it means that buffers grow.
enum Growth<'a> {
    /// They are made anew.
    Made {
        gpu: &'a Gpu,
        /// How many were.
        count: u64,
    },
    /// It is said what they would take.
    Foreseen(&'a mut Forecast),
}

impl Growth<'_> {
    /// Grows a buffer to `size` bytes; the old one is kept where that fails.
    fn buffer(&mut self, slot: &mut Allocation, label: &'static str, size: u64) -> Result<()> {
        if slot.size() >= size {
            return Ok(());
        }
        match self {
            Self::Made { gpu, count } => {
                *slot = gpu.storage(label, size)?;
                *count += 1;
            }
            Self::Foreseen(forecast) => {
                forecast.replace(label, slot.size(), Gpu::allocated(size));
            }
        }
        Ok(())
    }

    /// Grows a buffer whose old bytes come free before the new ones are taken.
    fn buffer_anew(&mut self, slot: &mut Allocation, label: &'static str, size: u64) -> Result<()> {
        if let Self::Made { gpu, count } = self
            && slot.size() < size
        {
            *slot = gpu.storage(label, 256)?;
            *count += 1;
        }
        self.buffer(slot, label, size)
    }

    /// Makes an image of another size or format; the old one comes free before.
    fn image(
        &mut self,
        slot: &mut Option<ImageAllocation>,
        label: &'static str,
        size: [u32; 2],
        format: wgpu::TextureFormat,
    ) -> Result<()> {
        match self {
            Self::Made { gpu, count } => {
                *slot = None;
                *count += 1;
                *slot = Some(gpu.image(label, size, format)?);
            }
            Self::Foreseen(forecast) => {
                let before = slot.as_ref().map_or(0, ImageAllocation::size);
                forecast.replace(label, before, Gpu::image_bytes(size, format));
            }
        }
        Ok(())
    }

    /// Bytes left within the budget.
    fn left(&self) -> u64 {
        match self {
            Self::Made { gpu, .. } => gpu.ledger().left(),
            Self::Foreseen(forecast) => forecast.left(),
        }
    }
}

/// Bytes of a frame's uniform blocks.
fn uniform_bytes(plan: &Plan) -> u64 {
    (plan.uniforms.len() as u64).next_power_of_two()
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
                    pool: false,
                    lists: false,
                    capacity: 0,
                    fills: 0,
                    sorts: 0,
                    maps: Vec::new(),
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
            order: empty("pelage.geometry.order")?,
            order_counts: empty("pelage.geometry.order_counts")?,
            shaded: empty("pelage.shading.points")?,
            fibre_points: empty("pelage.shading.fibre_points")?,
            point_outputs: empty("pelage.geometry.point_outputs")?,
            host_tiles: empty("pelage.geometry.host_tiles")?,
            maps: empty("pelage.shadow.maps")?,
            held_maps: HeldMaps::default(),
            tables: tables::Held::default(),
            bounds: transmission::Bounds::default(),
            pixels: Pixels::new(gpu)?,
            histogram: [
                empty(HISTOGRAM)?,
                empty(HISTOGRAM)?,
                empty(HISTOGRAM)?,
                empty(HISTOGRAM)?,
            ],
            sorted: empty("pelage.transparency.sorted_blending.order")?,
            blended: None,
            found: Order::default(),
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
        plan.leave_out_transmission(&mut self.bounds);
        self.tables.hold(gpu, plan)?;
        for hair in 0..plan.shadings.len() {
            let place = self.tables.place(&plan.shadings[hair]);
            plan.set_tables(hair, place);
        }
        let mut growth = Growth::Made { gpu, count: 0 };
        let map_bytes = self.maps.size();
        let grown = self.grow(gpu, plan, &mut growth);
        if let Growth::Made { count, .. } = growth {
            self.generation += count;
        }
        if self.maps.size() != map_bytes {
            self.held_maps.forget();
        }
        self.capacity = grown?;
        self.find_order(frame, plan);
        let key_matches = self.groups.as_ref().is_some_and(|groups| {
            groups.generation == self.generation
                && groups.serials == plan.serials
                && groups.rate == plan.shader.rate
                && (groups.tracked || !plan.tracked)
                && (groups.sorted.is_some() || plan.sorting.bins == 0)
                && groups.tables == self.tables.serial()
        });
        if !key_matches {
            self.groups = Some(self.bind(gpu, frame, plan));
        }
        plan.seal(self.capacity);
        self.slot = (self.slot + 1) % RING;
        self.held_maps.take(plan, &mut self.slots[self.slot].maps);
        self.write_uniforms(gpu, plan, target)
    }

    /// Lets the pixels' buffers go, as if no frame had been drawn.
    pub fn drop_pixels(&mut self, gpu: &Gpu) -> Result<()> {
        self.pixels = Pixels::new(gpu)?;
        self.needed = 0;
        self.generation += 1;
        Ok(())
    }

    /// The buffers that emissions write.
    pub fn emitted(&self) -> Vec<&Allocation> {
        let pool = &self.pixels;
        let mut all = vec![
            &pool.counters,
            &pool.fill,
            &pool.links,
            &pool.overflow,
            &self.sorted,
            &self.maps,
        ];
        all.extend(pool.fragments.iter().chain(&self.histogram));
        all
    }

    /// What will be held when the plan's frame is prepared.
    pub fn forecast(&mut self, gpu: &Gpu, plan: &Plan) -> Result<Forecast> {
        let mut forecast = gpu.ledger().forecast();
        if plan.runs.is_empty() {
            return Ok(forecast);
        }
        self.tables.forecast(plan, &mut forecast);
        self.grow(gpu, plan, &mut Growth::Foreseen(&mut forecast))?;
        let uniforms = &self.slots[(self.slot + 1) % RING].uniforms;
        let held = uniforms.as_ref().map_or(0, Allocation::size);
        if held < plan.uniforms.len() as u64 {
            forecast.replace(UNIFORMS, held, Gpu::allocated(uniform_bytes(plan)));
        }
        Ok(forecast)
    }

    /// Grows everything to what the plan needs. Returns how many fragments the pool holds.
    fn grow(&mut self, gpu: &Gpu, plan: &Plan, growth: &mut Growth) -> Result<u64> {
        gpu.check_size([plan.width, plan.height])?;
        self.grow_points(plan, growth)?;
        growth.buffer(&mut self.maps, "pelage.shadow.maps", plan.map_words * 4)?;
        self.grow_attachment(plan, growth)?;
        self.grow_sorted(gpu, plan, growth)?;
        if plan.shadows_only {
            return Ok(self.capacity);
        }
        // Last: a pool takes what the budget leaves.
        self.grow_pixels(gpu, plan, growth)
    }

    /// What belongs to points, segments and tiles.
    fn grow_points(&mut self, plan: &Plan, growth: &mut Growth) -> Result<()> {
        let points = plan.point_count;
        let each = size_of::<Projected>() as u64;
        growth.buffer(
            &mut self.projected,
            "pelage.geometry.projected",
            points * each,
        )?;
        growth.buffer(&mut self.order, "pelage.geometry.order", points * 4)?;
        growth.buffer(
            &mut self.order_counts,
            "pelage.geometry.order_counts",
            plan.runs.len() as u64 * ORDER_KEYS * 4,
        )?;
        match plan.shader.rate {
            ShadingRate::Point => {
                growth.buffer(&mut self.shaded, "pelage.shading.points", points * 8)?;
            }
            ShadingRate::Fragment => growth.buffer(
                &mut self.fibre_points,
                "pelage.shading.fibre_points",
                plan.fibre_point_bytes(),
            )?,
        }
        if plan.tracked {
            growth.buffer(
                &mut self.point_outputs,
                "pelage.geometry.point_outputs",
                points * size_of::<PointOutput>() as u64,
            )?;
        }
        if plan.host_depth || plan.cuts {
            growth.buffer(
                &mut self.host_tiles,
                "pelage.geometry.host_tiles",
                u64::from(plan.tile_count()) * 8,
            )?;
        }
        Ok(())
    }

    /// What belongs to pixels. Returns how many fragments the pool holds.
    fn grow_pixels(&mut self, gpu: &Gpu, plan: &Plan, growth: &mut Growth) -> Result<u64> {
        let pixels = plan
            .bands
            .iter()
            .map(|band| u64::from(plan.width) * u64::from(band.rows))
            .max()
            .unwrap_or(0);
        let pool = &mut self.pixels;
        let needs = plan.needs(pixels);
        growth.buffer(&mut pool.fill, "pelage.transparency.fill", needs.fill)?;
        if !needs.fragments.linked() {
            growth.buffer(&mut pool.links, LINKS, needs.links)?;
        }
        growth.buffer(
            &mut pool.overflow,
            "pelage.transparency.overflow",
            needs.overflow,
        )?;
        match needs.fragments {
            Fragments::Fixed(bytes) => {
                growth.buffer(&mut pool.fragments[0], FRAGMENTS, bytes)?;
                Ok(self.capacity)
            }
            Fragments::Halves(bytes) => {
                for half in &mut pool.fragments {
                    growth.buffer(half, FRAGMENTS, bytes)?;
                }
                Ok(self.capacity)
            }
            Fragments::Pool { linked, bytes } => {
                let expected = plan.transparency.expected(plan.expected_fragments, pixels);
                self.grow_fragments(gpu, plan, expected, linked, bytes, growth)
            }
        }
    }

    /// Sizes the fragment pool: to what the host says, or to what is expected or was measured, within the budget.
    fn grow_fragments(
        &mut self,
        gpu: &Gpu,
        plan: &Plan,
        expected: u64,
        lists: bool,
        pool_bytes: Option<u64>,
        growth: &mut Growth,
    ) -> Result<u64> {
        let each = if lists { NODE_BYTES } else { FRAGMENT_BYTES };
        let held = self.fragments_held();
        let most = most_fragments(gpu);
        let wanted = match pool_bytes {
            Some(bytes) => (bytes / each).min(most),
            None => {
                let expected = expected.max(self.needed) as f64 * POOL_MARGIN;
                (expected as u64).clamp(SMALLEST_POOL.min(most), most)
            }
        };
        // What the old pool holds comes free before the new one is made; the ring's uniforms find room too.
        let reserve = RING as u64 * uniform_bytes(plan) + RESERVE;
        let left = (growth.left().saturating_sub(reserve) / each).saturating_add(held);
        let wanted = wanted.min(left).max(1);
        if held < wanted {
            for half in &mut self.pixels.fragments {
                growth.buffer_anew(half, FRAGMENTS, wanted * HALF_BYTES)?;
            }
        }
        if lists {
            growth.buffer(&mut self.pixels.links, LINKS, wanted * 4)?;
        }
        let held = self.fragments_held().min(most);
        let capacity = if pool_bytes.is_some() {
            wanted.min(held)
        } else {
            held
        };
        Ok(if lists {
            capacity.min(self.pixels.links.size() / 4)
        } else {
            capacity
        })
    }

    /// Fragments that the pool holds.
    fn fragments_held(&self) -> u64 {
        let [upper, lower] = self.pixels.fragments.each_ref().map(Allocation::size);
        upper.min(lower) / HALF_BYTES
    }

    /// The attachment of ribbons, as large as the largest image that they draw.
    fn grow_attachment(&mut self, plan: &Plan, growth: &mut Growth) -> Result<()> {
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
            return Ok(());
        };
        let fits = |held: &ImageAllocation| {
            held.texture.width() >= width && held.texture.height() >= height
        };
        if self.attachment.as_ref().is_some_and(fits) {
            return Ok(());
        }
        let label = "pelage.raster.ribbons";
        let size = [width, height];
        growth.image(&mut self.attachment, label, size, ATTACHMENT)
    }

    /// What sorted blending needs.
    fn grow_sorted(&mut self, gpu: &Gpu, plan: &Plan, growth: &mut Growth) -> Result<()> {
        let Transparency::SortedBlending(settings) = plan.transparency else {
            return Ok(());
        };
        let words = plan.sorting.histogram.ranges();
        for (part, [_, words]) in self.histogram.iter_mut().zip(words) {
            growth.buffer(part, HISTOGRAM, words * 4)?;
        }
        growth.buffer(
            &mut self.sorted,
            "pelage.transparency.sorted_blending.order",
            plan.sorting.order_bytes(),
        )?;
        let format = settings.format(gpu);
        let fits = |held: &ImageAllocation| {
            let image = &held.texture;
            image.format() == format && image.width() >= plan.width && image.height() >= plan.height
        };
        if self.blended.as_ref().is_some_and(fits) {
            return Ok(());
        }
        let label = "pelage.transparency.sorted_blending.image";
        let size = [plan.width, plan.height];
        growth.image(&mut self.blended, label, size, format)
    }

    /// Whether this frame sorts anew, where the technique sorts.
    fn find_order(&mut self, frame: &Frame, plan: &mut Plan) {
        let Transparency::SortedBlending(settings) = plan.transparency else {
            return;
        };
        let mut of = plan.serials.clone();
        let opacities = frame.hairs.iter().map(|hair| hair.opacity.to_bits());
        of.extend(opacities.map(u64::from));
        of.extend([plan.sorting.bins, settings.order as u64]);
        let found = &mut self.found;
        if found.of != of || (found.known && found.age >= settings.reuse) {
            *found = Order {
                of,
                number: found.number + 1,
                age: 0,
                known: false,
            };
        }
        // A frame that was recorded and never submitted has sorted nothing.
        plan.sort = !found.known;
        if found.known {
            found.age += 1;
        }
    }

    /// What sorted blending binds.
    fn bind_sorted<'a>(&'a self, gpu: &Gpu, plan: &Plan) -> Option<SortedGroups> {
        let blended = self.blended.as_ref().filter(|_| plan.sorting.bins > 0)?;
        let image = blended.texture.create_view(&Default::default());
        let each = size_of::<Projected>() as u64;
        let points = plan.sorting.points.ranges();
        let points = points.map(|[first, count]| part(&self.projected, first, count, each));
        let histogram = self.histogram.each_ref().map(Allocation::binding);
        let after_order = |parts: [wgpu::BindingResource<'a>; MAX_PARTS as usize]| {
            let order = std::iter::once(self.sorted.binding());
            order.chain(parts).collect::<Vec<_>>()
        };
        Some(SortedGroups {
            sorting: gpu.bind("pelage.sorting", Group::Sorting, &after_order(histogram)),
            segments: gpu.bind(
                "pelage.sorted_segments",
                Group::SortedSegments,
                &after_order(points),
            ),
            shaded: gpu.bind("pelage.shaded", Group::Shaded, &[self.shaded.binding()]),
            read: gpu.bind(
                "pelage.blended",
                Group::BlendedRead,
                &[
                    wgpu::BindingResource::TextureView(&image),
                    self.pixels.fill.binding(),
                    self.pixels.links.binding(),
                ],
            ),
            image,
        })
    }

    fn bind(&self, gpu: &Gpu, frame: &Frame, plan: &Plan) -> Groups {
        let shaded = match plan.shader.rate {
            ShadingRate::Point => &self.shaded,
            ShadingRate::Fragment => &self.fibre_points,
        };
        let runs = plan
            .runs
            .iter()
            .enumerate()
            .map(|(number, run)| {
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
                        &[projected(), part(&self.order, base, count, 4)],
                    ),
                    order: gpu.bind(
                        "pelage.order",
                        Group::Order,
                        &[
                            projected(),
                            part(&self.order, base, count, 4),
                            part(
                                &self.order_counts,
                                number as u64 * ORDER_KEYS,
                                ORDER_KEYS,
                                4,
                            ),
                        ],
                    ),
                    shade: gpu.bind(
                        "pelage.shade",
                        Group::Shade,
                        &[
                            points(),
                            attributes(),
                            geometry.colours.binding(),
                            projected(),
                            shaded.binding(),
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
            &pool.overflow,
            shaded,
        ]
        .into_iter()
        .map(Allocation::binding)
        .collect();
        Groups {
            serials: plan.serials.clone(),
            generation: self.generation,
            rate: plan.shader.rate,
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
            tables_read: plan.shader.of_fragments().map(|_| {
                // Models without tables read none: anything will do.
                let buffer = self.tables.buffer().unwrap_or(&self.projected);
                gpu.bind(
                    "pelage.shading.tables_read",
                    Group::TablesRead,
                    &[buffer.binding()],
                )
            }),
            runs,
            host_tiles: gpu.bind(
                "pelage.host_tiles",
                Group::HostTiles,
                &[self.host_tiles.binding()],
            ),
            host_tiles_read: gpu.bind(
                "pelage.host_tiles_read",
                Group::HostTilesRead,
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
            sorted: self.bind_sorted(gpu, plan),
        }
    }

    fn write_uniforms(&mut self, gpu: &Gpu, plan: &Plan, target: &Target) -> Result<()> {
        let slot = &mut self.slots[self.slot];
        let size = plan.uniforms.len() as u64;
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let stale = slot.uniforms.as_ref().is_none_or(|held| held.size() < size);
        if stale {
            slot.uniforms = Some(gpu.allocate(UNIFORMS, uniform_bytes(plan), usage)?);
        }
        let Some(uniforms) = &slot.uniforms else {
            return Ok(());
        };
        gpu.queue.write_buffer(&uniforms.buffer, 0, &plan.uniforms);
        let depth = target.depth_surface();
        let held = slot
            .depth
            .as_ref()
            .map(|(texture, at)| Surface { texture, at: *at });
        if stale || slot.frame.is_none() || held != depth {
            let bind = |depth: Surface| {
                let view = depth.view(wgpu::TextureAspect::DepthOnly);
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
            let none = Surface {
                texture: &self.no_depth,
                at: Subresource::default(),
            };
            slot.frame = Some(bind(depth.unwrap_or(none)));
            slot.frame_without_depth = Some(bind(none));
            slot.depth = depth.map(|depth| (depth.texture.clone(), depth.at));
        }
        let given = target.occluders.iter().map(Occluder::surface);
        let held = slot.occluding.iter();
        let held = held.map(|(texture, at)| Surface { texture, at: *at });
        if !held.eq(given.clone()) {
            slot.occluding = given
                .clone()
                .map(|map| (map.texture.clone(), map.at))
                .collect();
            slot.occluders = (!slot.occluding.is_empty()).then(|| {
                let none = Surface {
                    texture: &self.no_depth,
                    at: Subresource::default(),
                };
                let views: Vec<_> = given
                    .chain(std::iter::repeat(none))
                    .take(MAX_OCCLUDERS)
                    .map(|map| map.view(wgpu::TextureAspect::DepthOnly))
                    .collect();
                let views: Vec<_> = views
                    .iter()
                    .map(wgpu::BindingResource::TextureView)
                    .collect();
                gpu.bind("pelage.occluders", Group::Occluders, &views)
            });
        }
        slot.bands = plan.bands.len() as u64;
        let fragments = plan.transparency.needs(0).fragments;
        slot.pool = fragments.pooled();
        slot.lists = fragments.linked();
        slot.capacity = self.capacity;
        slot.fills = if plan.shadows_only {
            0
        } else {
            self.tables.to_fill()
        };
        slot.sorts = if plan.sort { self.found.number } else { 0 };
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
            host_tiles_read: &groups.host_tiles_read,
            tables: groups.tables_written.as_ref().filter(|_| slot.fills > 0),
            tables_read: groups.tables_read.as_ref(),
            maps_written: &groups.maps_written,
            maps_read: &groups.maps_read,
            occluders: slot.occluders.as_ref(),
            pixels_written: &groups.pixels_written,
            pixels_read: &groups.pixels_read,
            sorted: groups.sorted.as_ref(),
            histogram: &self.histogram,
            point_outputs: &groups.point_outputs,
            order_counts: &self.order_counts.buffer,
            pixels: &self.pixels,
            attachment: self
                .attachment
                .as_ref()
                .map(|image| image.texture.create_view(&Default::default())),
            arguments: &self.arguments.buffer,
            returned: &slot.counters,
        })
    }

    /// Clears the shadow maps that a frame fills.
    pub fn clear_maps(&self, passes: &mut Passes, plan: &Plan) {
        let filled = || plan.maps.iter().filter(|map| map.filled);
        if filled().next().is_some() {
            passes.encode("pelage.shadow.clear", |encoder| {
                for PlannedMap { words, .. } in filled() {
                    let bytes = 4 * (words.end - words.start);
                    encoder.clear_buffer(&self.maps.buffer, 4 * words.start, Some(bytes));
                }
            });
        }
    }

    /// Whether frames take the shadow maps of earlier ones.
    pub fn set_shadow_reuse(&mut self, reuse: bool) {
        self.held_maps.set_reuse(reuse);
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
                    self.found.known |= slot.sorts > 0 && slot.sorts == self.found.number;
                    self.held_maps.mark_filled(&slot.maps);
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
        let (mut needed, mut found, mut overflowed) = (produced, produced, merged);
        if slot.lists {
            // `stored` counts the nodes that were asked for; of what a technique counts itself some asked for none.
            needed = stored;
            overflowed = stored.saturating_sub(slot.capacity);
            if produced == 0 {
                (found, merged) = (stored, overflowed);
            }
            stored = found - merged;
        } else if !slot.pool {
            overflowed = 0;
        }
        sum.produced += found + culled;
        sum.culled += culled;
        sum.stored += stored;
        sum.merged += merged;
        sum.overflowed += overflowed;
        sum.covered += u64::from(counters.covered);
        sum.needed = sum.needed.max(needed);
    }
    sum
}
