//! The tables of a frame's models: made when a model's parameters change, in a new buffer, so that frames recorded before
//! keep theirs; none where no model in use needs one.

use super::{Shader, Shading, ShadingRate};
use crate::error::{Error, Result};
use crate::gpu::{Allocation, Gpu, Group, Passes, PipelineKey, workgroups};
use crate::memory::Forecast;
use crate::plan::Plan;
use crate::resources::{Bound, RING};
use crate::shader::Module;

/// Where a model's tables begin, in words: by one inclination, azimuthal; and their size.
pub(crate) type Place = [u32; 3];

/// Where each model's tables lie, the words that the host writes, and the number of all words.
pub(crate) fn lay_out(models: &[Shading], ambient: bool) -> (Vec<Place>, Vec<f32>, u64) {
    let mut words: Vec<f32> = Vec::new();
    let mut places = Vec::new();
    for model in models {
        let mut place = [0; 3];
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
            place[2] = tables.size;
            size += tables.words(model.dual_scattering().is_some());
        }
    }
    (places, words, size)
}

/// Frames after whose last use tables are dropped: as many as may be under way, so that views that take turns keep theirs.
const KEPT_FRAMES: u64 = RING as u64;

const LABEL: &str = "pelage.shading.tables";

/// A frame's models, each once, and whether uniform light falls on them.
fn models_of(plan: &Plan) -> (Vec<Shading>, bool) {
    let ambient = plan.frame_uniform.ambient.iter().any(|&c| c > 0.0);
    let mut models: Vec<Shading> = Vec::new();
    for shading in &plan.shadings {
        if !models.contains(shading) {
            models.push(*shading);
        }
    }
    (models, ambient)
}

/// The tables of all models of a frame.
struct Set {
    models: Vec<Shading>,
    /// Whether uniform light falls on them.
    ambient: bool,
    places: Vec<Place>,
    buffer: Option<Allocation>,
    serial: u64,
    /// Whether the passes that fill the buffer have run.
    filled: bool,
    /// The frame that used it last.
    used: u64,
}

/// The tables of the last frames; the newest frame's come last.
#[derive(Default)]
pub(crate) struct Held {
    sets: Vec<Set>,
    frame: u64,
    serials: u64,
}

impl Held {
    /// Replaces in a forecast the bytes of what is held by those of what [`Held::hold`] will hold.
    pub fn forecast(&self, plan: &Plan, forecast: &mut Forecast) {
        let (models, ambient) = models_of(plan);
        let bytes = |set: &Set| set.buffer.as_ref().map_or(0, Allocation::size);
        let same = |set: &Set| set.models == models && set.ambient == ambient;
        for set in &self.sets {
            if self.frame + 1 - set.used > KEPT_FRAMES {
                forecast.replace(LABEL, bytes(set), 0);
            }
        }
        let kept = |set: &&Set| self.frame + 1 - set.used <= KEPT_FRAMES;
        let (_, _, words) = lay_out(&models, ambient);
        if words > 0 && !self.sets.iter().filter(kept).any(same) {
            forecast.replace(LABEL, 0, Gpu::allocated(words * 4));
        }
    }

    /// Makes the tables that a frame's models need, if none of the last frames had the same.
    pub fn hold(&mut self, gpu: &Gpu, plan: &Plan) -> Result<()> {
        let (models, ambient) = models_of(plan);
        self.frame += 1;
        let frame = self.frame;
        self.sets.retain(|set| frame - set.used <= KEPT_FRAMES);
        let same = |set: &Set| set.models == models && set.ambient == ambient;
        let mut set = match self.sets.iter().position(same) {
            Some(at) => self.sets.remove(at),
            None => self.make(gpu, models, ambient)?,
        };
        set.used = frame;
        self.sets.push(set);
        Ok(())
    }

    fn make(&mut self, gpu: &Gpu, models: Vec<Shading>, ambient: bool) -> Result<Set> {
        let (places, words, size) = lay_out(&models, ambient);
        if size * 4 > gpu.max_binding() {
            return Err(Error::Unsupported(format!(
                "the shading models' tables take {} bytes; this device binds {}",
                size * 4,
                gpu.max_binding()
            )));
        }
        let mut buffer = None;
        if size > 0 {
            let make = || gpu.storage(LABEL, size * 4);
            // Where there is no room the last frames' tables make it.
            let made = make().or_else(|_| {
                self.sets.clear();
                make()
            })?;
            if !words.is_empty() {
                gpu.queue
                    .write_buffer(&made.buffer, 0, bytemuck::cast_slice(&words));
            }
            buffer = Some(made);
        }
        self.serials += 1;
        Ok(Set {
            models,
            ambient,
            places,
            buffer,
            serial: self.serials,
            filled: size == words.len() as u64,
            used: self.frame,
        })
    }

    /// The buffer of the newest frame's tables.
    pub fn buffer(&self) -> Option<&Allocation> {
        self.sets.last()?.buffer.as_ref()
    }

    /// Tells the newest frame's tables from others; 0 before there are any.
    pub fn serial(&self) -> u64 {
        self.sets.last().map_or(0, |set| set.serial)
    }

    /// The serial of the newest frame's tables where they are still to be filled, else 0.
    pub fn to_fill(&self) -> u64 {
        let last = self.sets.last();
        last.filter(|set| !set.filled).map_or(0, |set| set.serial)
    }

    /// Says that a frame that filled tables has run.
    pub fn mark_filled(&mut self, serial: u64) {
        if let Some(set) = self.sets.iter_mut().find(|set| set.serial == serial) {
            set.filled = true;
        }
    }

    /// Where a model's tables lie.
    pub fn place(&self, shading: &Shading) -> Place {
        let place = |set: &Set| {
            let number = set.models.iter().position(|model| model == shading)?;
            Some(set.places[number])
        };
        self.sets.last().and_then(place).unwrap_or_default()
    }
}

/// The module that fills a model's tables.
pub(crate) fn module(shading: &Shading) -> Module {
    let shader = Shader {
        // Nothing that roughness changes is in a table.
        varies: false,
        ..Shader::of(shading, ShadingRate::Point)
    };
    shader.functions().and(&["shading/tables"])
}

/// Entries of a model's tables: one table, or with dual scattering two.
pub(crate) fn entries(shading: &Shading) -> u32 {
    let tables = if shading.dual_scattering().is_some() {
        2
    } else {
        1
    };
    shading.tables().map_or(0, |t| tables * t.size * t.size)
}

/// Fills the tables that the GPU makes, where that has not been done.
pub(crate) fn record(gpu: &mut Gpu, passes: &mut Passes, bound: &Bound, plan: &Plan) -> Result<()> {
    let Some(group) = bound.tables else {
        return Ok(());
    };
    let mut done: Vec<Shading> = Vec::new();
    for run in &plan.runs {
        let shading = plan.shadings[run.hair];
        let (Some(_), Some(label)) = (shading.tables(), shading.tables_label()) else {
            continue;
        };
        if done.contains(&shading) {
            continue;
        }
        let key = PipelineKey {
            variant: shading.settings(ShadingRate::Point),
            ..PipelineKey::new(label)
        };
        let groups = [Group::Frame, Group::TablesWritten];
        let pipeline = gpu.compute(key, "shading_tabulate", &groups, || module(&shading))?;
        let count = entries(&shading);
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
