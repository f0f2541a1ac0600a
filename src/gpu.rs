//! The device as the library uses it: bind group layouts, pipelines made once, buffers whose bytes are counted, and a
//! recorder that can time each pass.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Instant;

use crate::error::{Error, Result};
use crate::layout::SPREAD_PARTS;
use crate::memory::Forecast;
use crate::raster::Rasteriser;
use crate::shader::Module;
use crate::shading::Shader;
use crate::statistics::PassTime;
use crate::transparency::sorted_blending::MAX_PARTS;

/// The kinds of bind groups. Their numbers in WGSL: frame 0, geometry 1, shadow maps 2, pixels 3.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Group {
    Frame,
    HostTiles,
    HostTilesRead,
    Project,
    Order,
    Segments,
    Shade,
    Track,
    PointOutputs,
    TablesWritten,
    TablesRead,
    Gather,
    Guided,
    MapsWritten,
    MapsRead,
    PixelsWritten,
    PixelsRead,
    Occluders,
    /// What sorted blending sorts, what it draws, and the image that it blends into.
    Sorting,
    SortedSegments,
    Shaded,
    BlendedRead,
}

const GROUPS: [Group; 22] = [
    Group::Frame,
    Group::HostTiles,
    Group::HostTilesRead,
    Group::Project,
    Group::Order,
    Group::Segments,
    Group::Shade,
    Group::Track,
    Group::PointOutputs,
    Group::TablesWritten,
    Group::TablesRead,
    Group::Gather,
    Group::Guided,
    Group::MapsWritten,
    Group::MapsRead,
    Group::PixelsWritten,
    Group::PixelsRead,
    Group::Occluders,
    Group::Sorting,
    Group::SortedSegments,
    Group::Shaded,
    Group::BlendedRead,
];

/// Storage buffers of the pixel groups; all but the last are written by emitting passes.
pub(crate) const PIXEL_BUFFERS: u32 = 7;

impl Group {
    fn index(self) -> usize {
        match self {
            Self::Frame => 0,
            Self::HostTiles
            | Self::HostTilesRead
            | Self::Project
            | Self::Order
            | Self::Segments
            | Self::SortedSegments
            | Self::Shade
            | Self::Track
            | Self::PointOutputs
            | Self::TablesWritten
            | Self::TablesRead
            | Self::Gather
            | Self::Guided => 1,
            Self::MapsWritten | Self::MapsRead => 2,
            Self::PixelsWritten
            | Self::PixelsRead
            | Self::Occluders
            | Self::Sorting
            | Self::Shaded
            | Self::BlendedRead => 3,
        }
    }

    fn entries(self) -> Vec<wgpu::BindGroupLayoutEntry> {
        use wgpu::ShaderStages as Stages;
        let raster = Stages::COMPUTE | Stages::FRAGMENT;
        let storage = |binding, visibility, read_only| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let uniform = |binding, has_dynamic_offset| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: Stages::all(),
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset,
                min_binding_size: None,
            },
            count: None,
        };
        let depth = |binding, visibility| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty: wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Depth,
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            count: None,
        };
        match self {
            Self::Frame => {
                vec![
                    uniform(0, true),
                    uniform(1, true),
                    uniform(2, true),
                    depth(3, raster),
                ]
            }
            Self::HostTiles => vec![storage(0, Stages::COMPUTE, false)],
            Self::HostTilesRead => vec![storage(0, Stages::VERTEX, true)],
            Self::Project => (0..4)
                .map(|binding| storage(binding, Stages::COMPUTE, binding != 2))
                .collect(),
            Self::Order => (0..3)
                .map(|binding| storage(binding, Stages::COMPUTE, binding == 0))
                .collect(),
            Self::Segments => (0..2)
                .map(|binding| storage(binding, raster | Stages::VERTEX, true))
                .collect(),
            Self::Shade => (0..6)
                .map(|binding| storage(binding, Stages::COMPUTE, binding != 4))
                .collect(),
            Self::Track => (0..4)
                .map(|binding| storage(binding, Stages::COMPUTE, binding < 3))
                .collect(),
            Self::PointOutputs => vec![storage(0, Stages::FRAGMENT, true)],
            Self::TablesWritten => vec![storage(0, Stages::COMPUTE, false)],
            Self::TablesRead => vec![storage(0, Stages::FRAGMENT, true)],
            Self::Gather => std::iter::once(uniform(0, false))
                .chain((1..5).map(|binding| storage(binding, Stages::COMPUTE, binding < 4)))
                .collect(),
            Self::Guided => std::iter::once(uniform(0, false))
                .chain((1..7).map(|binding| storage(binding, Stages::COMPUTE, binding < 6)))
                .collect(),
            Self::MapsWritten => vec![storage(0, raster, false)],
            Self::MapsRead => vec![storage(0, raster, true)],
            Self::PixelsWritten => (0..PIXEL_BUFFERS)
                .map(|binding| storage(binding, raster, binding + 1 == PIXEL_BUFFERS))
                .collect(),
            Self::Occluders => (0..crate::layout::MAX_OCCLUDERS as u32)
                .map(|binding| depth(binding, Stages::COMPUTE))
                .collect(),
            Self::PixelsRead => (0..PIXEL_BUFFERS)
                .map(|binding| storage(binding, Stages::FRAGMENT | Stages::VERTEX, true))
                .collect(),
            Self::Sorting => (0..1 + MAX_PARTS)
                .map(|binding| storage(binding, Stages::COMPUTE, false))
                .collect(),
            Self::SortedSegments => (0..1 + MAX_PARTS)
                .map(|binding| storage(binding, Stages::FRAGMENT | Stages::VERTEX, true))
                .collect(),
            // The number that it has among the pixels' buffers.
            Self::Shaded => vec![storage(PIXEL_BUFFERS - 1, Stages::FRAGMENT, true)],
            Self::BlendedRead => {
                let image = wgpu::BindGroupLayoutEntry {
                    binding: 0,
                    visibility: Stages::FRAGMENT,
                    ty: wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: false },
                        view_dimension: wgpu::TextureViewDimension::D2,
                        multisampled: false,
                    },
                    count: None,
                };
                std::iter::once(image)
                    .chain((1..3).map(|binding| storage(binding, Stages::FRAGMENT, true)))
                    .collect()
            }
        }
    }
}

/// GPU memory held, by label.
#[derive(Debug, Default)]
pub(crate) struct Ledger {
    by_label: BTreeMap<&'static str, u64>,
    total: u64,
    peak: u64,
    budget: Option<u64>,
}

impl Ledger {
    pub fn by_label(&self) -> Vec<(String, u64)> {
        self.by_label
            .iter()
            .filter(|(_, bytes)| **bytes > 0)
            .map(|(label, bytes)| (label.to_string(), *bytes))
            .collect()
    }

    pub fn total(&self) -> u64 {
        self.total
    }

    /// What is held now, for what is yet to be.
    pub fn forecast(&self) -> Forecast {
        Forecast::new(self.by_label.clone(), self.budget)
    }

    pub fn peak(&self) -> u64 {
        self.peak
    }

    /// Bytes left within the budget.
    pub fn left(&self) -> u64 {
        self.budget
            .map_or(u64::MAX, |budget| budget.saturating_sub(self.total))
    }
}

/// What fills a guard.
pub(crate) const GUARD: u8 = 0xc5;

/// Bytes on the ledger, until this is dropped.
#[derive(Debug)]
struct Booking {
    label: &'static str,
    size: u64,
    ledger: Arc<Mutex<Ledger>>,
}

/// A buffer whose bytes are on the ledger.
#[derive(Debug)]
pub(crate) struct Allocation {
    pub buffer: wgpu::Buffer,
    booking: Booking,
}

/// An image whose bytes are on the ledger.
#[derive(Debug)]
pub(crate) struct ImageAllocation {
    pub texture: wgpu::Texture,
    booking: Booking,
}

impl Drop for Booking {
    fn drop(&mut self) {
        let mut ledger = lock(&self.ledger);
        ledger.total -= self.size;
        if let Some(bytes) = ledger.by_label.get_mut(self.label) {
            *bytes -= self.size;
        }
    }
}

impl ImageAllocation {
    /// Its bytes.
    pub fn size(&self) -> u64 {
        self.booking.size
    }
}

impl Allocation {
    pub fn label(&self) -> &'static str {
        self.booking.label
    }

    pub fn size(&self) -> u64 {
        self.booking.size
    }

    pub fn binding(&self) -> wgpu::BindingResource<'_> {
        self.buffer.as_entire_binding()
    }
}

fn lock(ledger: &Mutex<Ledger>) -> MutexGuard<'_, Ledger> {
    ledger
        .lock()
        .unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// What tells one pipeline from another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct PipelineKey {
    pub label: &'static str,
    pub rasteriser: Option<Rasteriser>,
    pub colour: Option<wgpu::TextureFormat>,
    pub depth: Option<wgpu::TextureFormat>,
    /// The shading model, where fragments are shaded.
    pub shading: Option<Shader>,
    pub variant: u32,
}

impl PipelineKey {
    pub const fn new(label: &'static str) -> Self {
        Self {
            label,
            rasteriser: None,
            colour: None,
            depth: None,
            shading: None,
            variant: 0,
        }
    }
}

/// A render pipeline to be made.
pub(crate) struct RenderSpec<'a> {
    pub module: Module,
    pub vertex: &'a str,
    pub fragment: &'a str,
    pub groups: &'a [Group],
    pub topology: wgpu::PrimitiveTopology,
    pub targets: Vec<Option<wgpu::ColorTargetState>>,
    pub depth_stencil: Option<wgpu::DepthStencilState>,
}

/// The device, its layouts, pipelines and memory.
pub(crate) struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub limits: wgpu::Limits,
    layouts: HashMap<Group, wgpu::BindGroupLayout>,
    compute: HashMap<PipelineKey, wgpu::ComputePipeline>,
    render: HashMap<PipelineKey, wgpu::RenderPipeline>,
    ledger: Arc<Mutex<Ledger>>,
    /// Bytes behind every storage buffer that is made, on no ledger: tests see there whether a shader has left its bounds.
    pub guard: u64,
}

/// Checks what every shader of the library takes for granted.
pub(crate) fn check_limits(limits: &wgpu::Limits) -> Result<()> {
    for (name, has, needs) in [
        ("bind groups", limits.max_bind_groups, 4),
        (
            "storage buffers a stage",
            limits.max_storage_buffers_per_shader_stage,
            10,
        ),
        (
            "invocations a workgroup",
            limits.max_compute_invocations_per_workgroup,
            256,
        ),
    ] {
        if has < needs {
            return Err(Error::Unsupported(format!(
                "the device allows {has} {name}; pelage needs {needs}"
            )));
        }
    }
    Ok(())
}

impl Gpu {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Self> {
        let limits = device.limits();
        check_limits(&limits)?;
        let layouts = GROUPS
            .into_iter()
            .map(|group| {
                let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                    label: Some(&format!("pelage.{group:?}")),
                    entries: &group.entries(),
                });
                (group, layout)
            })
            .collect();
        Ok(Self {
            device: device.clone(),
            queue: queue.clone(),
            limits,
            layouts,
            compute: HashMap::new(),
            render: HashMap::new(),
            ledger: Arc::default(),
            guard: 0,
        })
    }

    pub fn ledger(&self) -> MutexGuard<'_, Ledger> {
        lock(&self.ledger)
    }

    pub fn set_byte_budget(&self, budget: Option<u64>) {
        lock(&self.ledger).budget = budget;
    }

    /// The largest storage binding in bytes.
    pub fn max_binding(&self) -> u64 {
        self.limits
            .max_storage_buffer_binding_size
            .min(self.limits.max_buffer_size)
    }

    /// Whether shaders may use all atomic operations on 64-bit integers.
    pub fn wide_atomics(&self) -> bool {
        let wide = wgpu::Features::SHADER_INT64 | wgpu::Features::SHADER_INT64_ATOMIC_ALL_OPS;
        self.device.features().contains(wide)
    }

    /// Refuses images that are larger than the device's.
    pub fn check_size(&self, [width, height]: [u32; 2]) -> Result<()> {
        if width.max(height) > self.limits.max_texture_dimension_2d {
            return Err(Error::Unsupported(format!(
                "a target of {width}×{height} pixels"
            )));
        }
        Ok(())
    }

    /// Bytes that a buffer of `size` bytes takes.
    pub fn allocated(size: u64) -> u64 {
        size.max(1).next_multiple_of(256)
    }

    /// Bytes of an image.
    pub fn image_bytes([width, height]: [u32; 2], format: wgpu::TextureFormat) -> u64 {
        let texel = u64::from(format.block_copy_size(None).unwrap_or(0));
        u64::from(width) * u64::from(height) * texel
    }

    /// Makes a buffer of `size` bytes, rounded up to 256, and puts it on the ledger.
    pub fn allocate(
        &self,
        label: &'static str,
        size: u64,
        usage: wgpu::BufferUsages,
    ) -> Result<Allocation> {
        self.allocate_filled(label, size, usage, &[])
    }

    /// Makes a uniform block for one command buffer: it holds `bytes` from the start, whatever is written to the queue.
    pub fn uniform(&self, label: &'static str, bytes: &[u8]) -> Result<Allocation> {
        let usage = wgpu::BufferUsages::UNIFORM;
        self.allocate_filled(label, bytes.len() as u64, usage, bytes)
    }

    /// Makes a storage buffer that holds `bytes` from the start.
    pub fn filled(&self, label: &'static str, bytes: &[u8]) -> Result<Allocation> {
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        self.allocate_filled(label, bytes.len() as u64, usage, bytes)
    }

    fn allocate_filled(
        &self,
        label: &'static str,
        size: u64,
        usage: wgpu::BufferUsages,
        bytes: &[u8],
    ) -> Result<Allocation> {
        let size = Self::allocated(size);
        if size > self.limits.max_buffer_size {
            return Err(Error::OutOfMemory(format!(
                "{label}: {size} bytes are more than the device's largest buffer, {}",
                self.limits.max_buffer_size
            )));
        }
        let left = lock(&self.ledger).left();
        if size > left {
            return Err(Error::OutOfMemory(format!(
                "{label}: {size} bytes are more than the {left} left in the budget"
            )));
        }
        let can_be_guarded = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
        let guard = if usage.contains(can_be_guarded) {
            self.guard
        } else {
            0
        };
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: size + guard,
            usage,
            mapped_at_creation: !bytes.is_empty(),
        });
        if let Some(error) = pollster::block_on(scope.pop()) {
            return Err(Error::OutOfMemory(format!(
                "{label}: {size} bytes: {error}"
            )));
        }
        if !bytes.is_empty() {
            let range = 0..bytes.len() as u64;
            match buffer.get_mapped_range_mut(range) {
                Ok(mut view) => view.copy_from_slice(bytes),
                Err(error) => return Err(Error::OutOfMemory(format!("{label}: {error}"))),
            }
            buffer.unmap();
        }
        if guard > 0 {
            self.queue
                .write_buffer(&buffer, size, &vec![GUARD; guard as usize]);
        }
        Ok(Allocation {
            buffer,
            booking: self.book(label, size),
        })
    }

    /// Puts bytes on the ledger.
    fn book(&self, label: &'static str, size: u64) -> Booking {
        let mut ledger = lock(&self.ledger);
        ledger.total += size;
        ledger.peak = ledger.peak.max(ledger.total);
        *ledger.by_label.entry(label).or_default() += size;
        Booking {
            label,
            size,
            ledger: self.ledger.clone(),
        }
    }

    /// Makes an image that is drawn into and read, of an uncompressed format.
    pub fn image(
        &self,
        label: &'static str,
        [width, height]: [u32; 2],
        format: wgpu::TextureFormat,
    ) -> Result<ImageAllocation> {
        let size = Self::image_bytes([width, height], format);
        let left = lock(&self.ledger).left();
        if size > left {
            return Err(Error::OutOfMemory(format!(
                "{label}: {size} bytes are more than the {left} left in the budget"
            )));
        }
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        if let Some(error) = pollster::block_on(scope.pop()) {
            return Err(Error::OutOfMemory(format!(
                "{label}: {size} bytes: {error}"
            )));
        }
        Ok(ImageAllocation {
            texture,
            booking: self.book(label, size),
        })
    }

    /// Makes a storage buffer that can be copied and cleared.
    pub fn storage(&self, label: &'static str, size: u64) -> Result<Allocation> {
        let usage = wgpu::BufferUsages::STORAGE
            | wgpu::BufferUsages::COPY_DST
            | wgpu::BufferUsages::COPY_SRC;
        self.allocate(label, size, usage)
    }

    pub fn bind(
        &self,
        label: &str,
        group: Group,
        resources: &[wgpu::BindingResource],
    ) -> wgpu::BindGroup {
        let layout = group.entries();
        debug_assert_eq!(layout.len(), resources.len(), "{label}");
        let entries: Vec<_> = layout
            .iter()
            .zip(resources)
            .map(|(entry, resource)| wgpu::BindGroupEntry {
                binding: entry.binding,
                resource: resource.clone(),
            })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(label),
            layout: &self.layouts[&group],
            entries: &entries,
        })
    }

    fn pipeline_layout(&self, label: &str, groups: &[Group]) -> wgpu::PipelineLayout {
        let mut slots: [Option<&wgpu::BindGroupLayout>; 4] = [None; 4];
        for group in groups {
            slots[group.index()] = Some(&self.layouts[group]);
        }
        let used = slots
            .iter()
            .rposition(Option::is_some)
            .map_or(0, |last| last + 1);
        self.device
            .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(label),
                bind_group_layouts: &slots[..used],
                immediate_size: 0,
            })
    }

    fn shader(&self, label: &str, module: &Module) -> wgpu::ShaderModule {
        crate::host::shader_module(&self.device, label, module.join().source)
    }

    /// The compute pipeline of `key`, made at its first use.
    pub fn compute(
        &mut self,
        key: PipelineKey,
        entry: &str,
        groups: &[Group],
        module: impl FnOnce() -> Module,
    ) -> Result<wgpu::ComputePipeline> {
        if let Some(pipeline) = self.compute.get(&key) {
            return Ok(pipeline.clone());
        }
        let label = label_of(&key);
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let pipeline = self
            .device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(&label),
                layout: Some(&self.pipeline_layout(&label, groups)),
                module: &self.shader(&label, &module()),
                entry_point: Some(entry),
                compilation_options: Default::default(),
                cache: None,
            });
        if let Some(error) = pollster::block_on(scope.pop()) {
            return Err(Error::Internal(format!("pipeline {label}: {error}")));
        }
        self.compute.insert(key, pipeline.clone());
        Ok(pipeline)
    }

    /// The render pipeline of `key`, made at its first use.
    pub fn render(
        &mut self,
        key: PipelineKey,
        spec: impl FnOnce() -> RenderSpec<'static>,
    ) -> Result<wgpu::RenderPipeline> {
        if let Some(pipeline) = self.render.get(&key) {
            return Ok(pipeline.clone());
        }
        let label = label_of(&key);
        let spec = spec();
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let module = self.shader(&label, &spec.module);
        let pipeline = self
            .device
            .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(&label),
                layout: Some(&self.pipeline_layout(&label, spec.groups)),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(spec.vertex),
                    compilation_options: Default::default(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState {
                    topology: spec.topology,
                    ..Default::default()
                },
                depth_stencil: spec.depth_stencil,
                multisample: Default::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(spec.fragment),
                    compilation_options: Default::default(),
                    targets: &spec.targets,
                }),
                multiview_mask: None,
                cache: None,
            });
        if let Some(error) = pollster::block_on(scope.pop()) {
            return Err(Error::Internal(format!("pipeline {label}: {error}")));
        }
        self.render.insert(key, pipeline.clone());
        Ok(pipeline)
    }
}

fn label_of(key: &PipelineKey) -> String {
    match key.rasteriser {
        Some(Rasteriser::Walk) => format!("{}.walk", key.label),
        Some(Rasteriser::Ribbons) => format!("{}.ribbons", key.label),
        None => key.label.to_string(),
    }
}

/// Workgroups for `count` invocations in groups of 64, as the shaders number them: x + y × x-groups.
pub(crate) fn workgroups(count: u32) -> (u32, u32) {
    let groups = count.div_ceil(64).max(1);
    let columns = groups.min(32768);
    (columns, groups.div_ceil(columns))
}

/// The same where work is spread: a multiple of the parts among which it is.
pub(crate) fn spread_workgroups(count: u32) -> (u32, u32) {
    workgroups(count.max(1).next_multiple_of(64 * SPREAD_PARTS))
}

/// Where passes are recorded: in the host's encoder, or one submission a pass, to time each.
pub(crate) enum Passes<'a> {
    /// The host's encoder; it submits.
    Recorded(&'a mut wgpu::CommandEncoder),
    /// One submission a pass, waited for.
    Timed(Timed),
}

/// The times of passes submitted one by one.
pub(crate) struct Timed {
    device: wgpu::Device,
    queue: wgpu::Queue,
    pub times: Vec<PassTime>,
}

impl<'a> Passes<'a> {
    pub fn timed(gpu: &Gpu) -> Passes<'static> {
        Passes::Timed(Timed {
            device: gpu.device.clone(),
            queue: gpu.queue.clone(),
            times: Vec::new(),
        })
    }

    /// Records into an encoder; in a timed frame submits it and waits.
    pub fn encode(&mut self, label: &str, encode: impl FnOnce(&mut wgpu::CommandEncoder)) {
        match self {
            Self::Recorded(encoder) => encode(encoder),
            Self::Timed(timed) => {
                let start = Instant::now();
                let mut encoder = timed.device.create_command_encoder(&Default::default());
                encode(&mut encoder);
                timed.queue.submit([encoder.finish()]);
                if let Err(error) = timed.device.poll(wgpu::PollType::wait_indefinitely()) {
                    log::error!("waiting for {label}: {error}");
                }
                let ms = start.elapsed().as_secs_f64() * 1e3;
                match timed.times.iter_mut().find(|time| time.label == label) {
                    Some(time) => time.ms += ms,
                    None => timed.times.push(PassTime {
                        label: label.to_string(),
                        ms,
                    }),
                }
            }
        }
    }

    /// Records one compute pass.
    pub fn compute(&mut self, label: &str, record: impl FnOnce(&mut wgpu::ComputePass)) {
        self.encode(label, |encoder| {
            record(
                &mut encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                    label: Some(label),
                    timestamp_writes: None,
                }),
            );
        });
    }
}
