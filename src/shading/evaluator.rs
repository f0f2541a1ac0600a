//! A shading model at single directions, found by the very shader that frames use: to draw its lobes, to fit its
//! parameters, to measure it. See `shaders/shading/evaluate.wgsl`.

use std::cell::RefCell;
use std::collections::HashMap;
use std::num::NonZeroU64;
use std::sync::mpsc;
use std::time::{Duration, Instant};

use glam::Vec3;

use super::{Shader, Shading, ShadingRate, tables};
use crate::error::{Error, Result, invalid};
use crate::gpu::{Allocation, Gpu, workgroups};
use crate::layout;
use crate::shader::Module;

/// A point of a strand, and where light and eye are seen from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// From root to tip, unit length.
    pub tangent: Vec3,
    /// Towards the light, unit length.
    pub to_light: Vec3,
    /// Towards the eye, unit length.
    pub to_eye: Vec3,
    /// The strand's colour factor, linear RGB.
    pub colour: Vec3,
    /// 0 at the root, 1 at the tip.
    pub coordinate: f32,
    /// The strand's number, by which it has its own glints.
    pub strand: u32,
    /// The part of the light that comes straight, 0 to 1.
    pub transmittance: f32,
    /// Fibres towards the light, not negative: for dual scattering.
    pub fibres: f32,
    /// The part of the fibre's width that is seen, from -1 to 1 across it: for Chiang's near field.
    pub across: [f32; 2],
}

impl Sample {
    /// A lit white fibre, seen in all its width; the vectors as in the fields.
    pub fn lit(tangent: Vec3, to_light: Vec3, to_eye: Vec3) -> Self {
        Self {
            tangent,
            to_light,
            to_eye,
            colour: Vec3::ONE,
            coordinate: 0.0,
            strand: 0,
            transmittance: 1.0,
            fibres: 0.0,
            across: [-1.0, 1.0],
        }
    }

    fn layout(&self) -> layout::Sample {
        layout::Sample {
            tangent: self.tangent.into(),
            coordinate: self.coordinate,
            to_light: self.to_light.into(),
            transmittance: self.transmittance,
            to_eye: self.to_eye.into(),
            fibres: self.fibres,
            colour: self.colour.into(),
            strand: self.strand,
            across: self.across,
            padding_0: 0.0,
            padding_1: 0.0,
        }
    }
}

/// Evaluates shading models on a device of the host. Pipelines are made at their first use and kept. Every call waits for the
/// device.
pub struct Evaluator {
    gpu: Gpu,
    pipelines: RefCell<HashMap<(Entry, Shader), wgpu::ComputePipeline>>,
}

/// An entry point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Entry {
    Scatter,
    Uniform,
    Tabulate,
}

impl Entry {
    fn name(self) -> &'static str {
        match self {
            Self::Scatter => "evaluate_scatter",
            Self::Uniform => "evaluate_uniform",
            Self::Tabulate => "shading_tabulate",
        }
    }
}

/// The module that evaluates a model.
pub(crate) fn module(model: &Shading) -> Module {
    shader(model).functions().and(&["shading/evaluate"])
}

/// The shader that it evaluates: a fragment's, since these have a near field.
fn shader(model: &Shading) -> Shader {
    Shader::of(model, ShadingRate::Fragment)
}

/// What one call binds.
struct Batch {
    pipeline: wgpu::ComputePipeline,
    groups: [wgpu::BindGroup; 2],
    values: Allocation,
    count: u32,
}

impl Evaluator {
    /// An evaluator on a device.
    ///
    /// # Errors
    /// A device that [`crate::Renderer::new`] would not take either.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Self> {
        Ok(Self {
            gpu: Gpu::new(device, queue)?,
            pipelines: RefCell::default(),
        })
    }

    /// The pipeline of an entry point for a model's settings.
    fn pipeline(&self, entry: Entry, model: &Shading) -> Result<wgpu::ComputePipeline> {
        let key = (entry, shader(model));
        if let Some(pipeline) = self.pipelines.borrow().get(&key) {
            return Ok(pipeline.clone());
        }
        let module = match entry {
            Entry::Tabulate => tables::module(model),
            Entry::Scatter | Entry::Uniform => module(model),
        };
        let device = &self.gpu.device;
        let label = format!("pelage.shading.{}.{}", model.stem(), entry.name());
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(&label),
            layout: None,
            module: &crate::host::shader_module(device, &label, module.join().source),
            entry_point: Some(entry.name()),
            compilation_options: Default::default(),
            cache: None,
        });
        if let Some(error) = pollster::block_on(scope.pop()) {
            return Err(Error::Internal(format!("pipeline {label}: {error}")));
        }
        self.pipelines.borrow_mut().insert(key, pipeline.clone());
        Ok(pipeline)
    }

    /// The model times the cosine, per steradian: radiance towards the eye for a unit of irradiance on a plane that faces the
    /// light, one value a sample.
    ///
    /// # Errors
    /// A parameter out of range; no samples, or more than the device binds (80 bytes
    /// each); no memory; a lost device.
    pub fn scatter(&self, model: &Shading, samples: &[Sample]) -> Result<Vec<Vec3>> {
        self.run(Entry::Scatter, model, samples)
    }

    /// Radiance towards the eye under uniform light of radiance 1 from everywhere; of a sample the light is not read.
    ///
    /// # Errors
    /// As [`Evaluator::scatter`].
    pub fn uniform(&self, model: &Shading, samples: &[Sample]) -> Result<Vec<Vec3>> {
        self.run(Entry::Uniform, model, samples)
    }

    /// Wall clock of as many evaluations of all samples by [`Evaluator::scatter`]'s shader, each submitted alone and waited
    /// for, after one that is not counted. Reading and writing a sample's 96 bytes is part of it; making tables is not.
    ///
    /// # Errors
    /// As [`Evaluator::scatter`].
    pub fn times(
        &self,
        model: &Shading,
        samples: &[Sample],
        repeats: usize,
    ) -> Result<Vec<Duration>> {
        let batch = self.prepare(Entry::Scatter, model, samples)?;
        let once = || {
            let start = Instant::now();
            let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
            dispatch(&mut encoder, &batch);
            self.submit(encoder)?;
            Ok(start.elapsed())
        };
        once()?;
        (0..repeats).map(|_| once()).collect()
    }

    fn run(&self, entry: Entry, model: &Shading, samples: &[Sample]) -> Result<Vec<Vec3>> {
        let batch = self.prepare(entry, model, samples)?;
        let size = u64::from(batch.count) * 16;
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        let returned = self.gpu.allocate("pelage.shading.returned", size, usage)?;
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        dispatch(&mut encoder, &batch);
        encoder.copy_buffer_to_buffer(&batch.values.buffer, 0, &returned.buffer, 0, Some(size));
        let (sender, receiver) = mpsc::channel();
        encoder.map_buffer_on_submit(
            &returned.buffer,
            wgpu::MapMode::Read,
            ..size,
            move |result| {
                sender.send(result).ok();
            },
        );
        self.submit(encoder)?;
        let lost = |error: String| Error::DeviceLost(format!("reading a model's values: {error}"));
        receiver
            .recv()
            .map_err(|error| lost(error.to_string()))?
            .map_err(|error| lost(error.to_string()))?;
        let view = returned
            .buffer
            .get_mapped_range(..size)
            .map_err(|error| lost(error.to_string()))?;
        let values: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&view);
        Ok(values
            .into_iter()
            .map(|[x, y, z, _]| Vec3::new(x, y, z))
            .collect())
    }

    /// Uploads samples and parameters, and makes the tables.
    fn prepare(&self, entry: Entry, model: &Shading, samples: &[Sample]) -> Result<Batch> {
        model.validate()?;
        let most = self.gpu.max_binding() / size_of::<layout::Sample>() as u64;
        if samples.is_empty() || samples.len() as u64 > most {
            return invalid!("{} samples are not between 1 and {most}", samples.len());
        }
        let count = samples.len() as u32;

        let (places, words, size) = tables::lay_out(&[*model], true);
        let mut material = model.material();
        let [angles, azimuthal, size_of_table] = places[0];
        material.values[15] = [angles, azimuthal, size_of_table, 0].map(f32::from_bits);
        let material = self
            .gpu
            .uniform("pelage.shading.material", bytemuck::bytes_of(&material))?;
        let table = self.gpu.storage("pelage.shading.tables", size * 4)?;
        self.gpu
            .queue
            .write_buffer(&table.buffer, 0, bytemuck::cast_slice(&words));
        let samples: Vec<_> = samples.iter().map(Sample::layout).collect();
        let samples = self
            .gpu
            .filled("pelage.shading.samples", bytemuck::cast_slice(&samples))?;
        let values = self
            .gpu
            .storage("pelage.shading.values", u64::from(count) * 16)?;

        let bind = |binding, buffer| (binding, whole(buffer, None));
        // The exact size: the shader asks for the array's length.
        let bytes = u64::from(count) * size_of::<layout::Sample>() as u64;
        let mut entries = vec![
            (0, whole(&samples.buffer, NonZeroU64::new(bytes))),
            bind(1, &values.buffer),
        ];
        let (_, files) = model.points();
        if files.contains(&"shading/fibre") {
            entries.push(bind(2, &table.buffer));
        }
        let pipeline = self.pipeline(entry, model)?;
        let groups = [
            self.group(&pipeline, 0, &[bind(2, &material.buffer)]),
            self.group(&pipeline, 1, &entries),
        ];
        if model.tables().is_some() {
            let pipeline = self.pipeline(Entry::Tabulate, model)?;
            let batch = Batch {
                groups: [
                    self.group(&pipeline, 0, &[bind(2, &material.buffer)]),
                    self.group(&pipeline, 1, &[bind(0, &table.buffer)]),
                ],
                pipeline,
                count: tables::entries(model),
                values: table,
            };
            let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
            dispatch(&mut encoder, &batch);
            self.submit(encoder)?;
        }
        Ok(Batch {
            pipeline,
            groups,
            values,
            count,
        })
    }

    fn group(
        &self,
        pipeline: &wgpu::ComputePipeline,
        index: u32,
        entries: &[(u32, wgpu::BufferBinding)],
    ) -> wgpu::BindGroup {
        let entries: Vec<_> = entries
            .iter()
            .map(|(binding, buffer)| wgpu::BindGroupEntry {
                binding: *binding,
                resource: wgpu::BindingResource::Buffer(buffer.clone()),
            })
            .collect();
        let device = &self.gpu.device;
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("pelage.shading.evaluate"),
            layout: &pipeline.get_bind_group_layout(index),
            entries: &entries,
        })
    }

    /// Submits and waits.
    fn submit(&self, encoder: wgpu::CommandEncoder) -> Result<()> {
        self.gpu.queue.submit([encoder.finish()]);
        let waited = self.gpu.device.poll(wgpu::PollType::wait_indefinitely());
        waited
            .map(|_| ())
            .map_err(|error| Error::DeviceLost(error.to_string()))
    }
}

fn whole(buffer: &wgpu::Buffer, size: Option<NonZeroU64>) -> wgpu::BufferBinding<'_> {
    wgpu::BufferBinding {
        buffer,
        offset: 0,
        size,
    }
}

fn dispatch(encoder: &mut wgpu::CommandEncoder, batch: &Batch) {
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&batch.pipeline);
    for (index, group) in batch.groups.iter().enumerate() {
        pass.set_bind_group(index as u32, group, &[]);
    }
    let (x, y) = workgroups(batch.count);
    pass.dispatch_workgroups(x, y, 1);
}
