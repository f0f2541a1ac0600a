//! The tables of a frame's models: made when a model's parameters change, in a new buffer, so that frames recorded before
//! keep theirs; none where no model in use needs one.

use super::Shading;
use crate::error::{Error, Result};
use crate::gpu::{Allocation, Gpu, Group, Passes, PipelineKey, workgroups};
use crate::plan::Plan;
use crate::resources::Bound;
use crate::shader::Module;

/// Where a model's tables begin, in words: by one inclination, azimuthal; size and format; 0.
pub(crate) type Place = [u32; 4];

/// Where each model's tables lie, the words that the host writes, and the number of all words.
pub(crate) fn lay_out(models: &[Shading], ambient: bool) -> (Vec<Place>, Vec<f32>, u64) {
    let mut words: Vec<f32> = Vec::new();
    let mut places = Vec::new();
    for model in models {
        let mut place = [0; 4];
        if model.needs_angles(ambient) {
            place[0] = words.len() as u32;
            words.extend(model.angles());
        }
        places.push(place);
    }
    let mut size = words.len() as u64;
    for (place, model) in places.iter_mut().zip(models) {
        if let Some(tables) = model.tables() {
            place[1] = size as u32;
            place[2] = tables.word();
            size += tables.words(model.dual_scattering().is_some());
        }
    }
    (places, words, size)
}

/// The tables of all models of a frame.
#[derive(Default)]
pub(crate) struct Held {
    /// The models, and whether uniform light falls on them.
    models: Vec<Shading>,
    ambient: bool,
    places: Vec<Place>,
    pub buffer: Option<Allocation>,
    /// Counts the buffers made: 0 is none.
    pub serial: u64,
    /// Whether the passes that fill the buffer have run.
    pub filled: bool,
}

impl Held {
    /// Makes the tables that a frame's models need, if these are not the ones of the last frame.
    pub fn hold(&mut self, gpu: &Gpu, plan: &Plan) -> Result<()> {
        let ambient = plan.frame_uniform.ambient.iter().any(|&c| c > 0.0);
        let mut models: Vec<Shading> = Vec::new();
        for shading in &plan.shadings {
            if !models.contains(shading) {
                models.push(*shading);
            }
        }
        if models == self.models && ambient == self.ambient {
            return Ok(());
        }
        let (places, words, size) = lay_out(&models, ambient);
        if size * 4 > gpu.max_binding() {
            return Err(Error::Unsupported(format!(
                "the shading models' tables take {} bytes; this device binds {}",
                size * 4,
                gpu.max_binding()
            )));
        }
        // The old tables come free before the new ones are made.
        *self = Self {
            serial: self.serial,
            ..Self::default()
        };
        if size > 0 {
            let buffer = gpu.storage("pelage.shading.tables", size * 4)?;
            if !words.is_empty() {
                gpu.queue
                    .write_buffer(&buffer.buffer, 0, bytemuck::cast_slice(&words));
            }
            self.buffer = Some(buffer);
        }
        self.serial += 1;
        self.filled = size == words.len() as u64;
        (self.models, self.ambient, self.places) = (models, ambient, places);
        Ok(())
    }

    /// Where a model's tables lie.
    pub fn place(&self, shading: &Shading) -> Place {
        let found = self.models.iter().position(|model| model == shading);
        found.map_or([0; 4], |number| self.places[number])
    }
}

/// The module that fills a model's tables.
pub(crate) fn module(files: &[&'static str]) -> Module {
    Module::new(&["shadow/none", "shading/fibre_type", "shading/tables"]).and(files)
}

/// Fills the tables that the GPU makes, where that has not been done.
pub(crate) fn record(gpu: &mut Gpu, passes: &mut Passes, bound: &Bound, plan: &Plan) -> Result<()> {
    let Some(group) = bound.tables else {
        return Ok(());
    };
    let mut done: Vec<Shading> = Vec::new();
    for run in &plan.runs {
        let shading = plan.shadings[run.hair];
        let (Some(tables), Some(label)) = (shading.tables(), shading.tables_label()) else {
            continue;
        };
        if done.contains(&shading) {
            continue;
        }
        let (_, files) = shading.points();
        let pipeline = gpu.compute(
            PipelineKey::new(label),
            "shading_tabulate",
            &[Group::Frame, Group::TablesWritten],
            || module(files),
        )?;
        let entries = tables.size * tables.size;
        let count = if shading.dual_scattering().is_some() {
            2 * entries
        } else {
            entries
        };
        passes.compute(label, |pass| {
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, bound.frame, &[0, 0, run.material]);
            pass.set_bind_group(1, group, &[]);
            let (x, y) = workgroups(count);
            pass.dispatch_workgroups(x, y, 1);
        });
        done.push(shading);
    }
    Ok(())
}
