//! The host's own Vulkan device: hair between the host's passes, drawn into its images.
//!
//! The host asks for [`requirements`] before it makes its device, hands its handles over in a [`DeviceDescriptor`], and
//! gives each frame its images, with the layouts in which they come and go, and the semaphores to wait on and to signal.
//! Nothing of the host's is ever destroyed, and its queue is touched only while its lock is held: for the submission in
//! [`Vulkan::render`], and when the context is dropped.
//!
//! A submission stands alone in the queue's order: a full barrier comes before the first command of each view and after
//! its last. So a host that submits to the same queue before and after needs no semaphore at all, and one that uses
//! another queue needs nothing but semaphores.

mod barrier;
mod buffer;
mod device;
mod image;
mod queue;
mod requirements;

use std::sync::Arc;

pub use ash;
use ash::vk;
use wgpu::TextureUses;

pub use buffer::Points;
pub use device::{DeviceDescriptor, HostInstance};
pub use image::{Aspect, Image, colour_formats, depth_formats};
pub use queue::{QueueLock, Semaphore};
pub use requirements::{FEATURE_STORAGE, Requirements, requirements};

use self::barrier::{Families, Step};
use self::image::Wrapped;
use super::lost::Lost;
use crate::error::{Error, Result, invalid};
use crate::frame::{Frame, Outputs, ShadowImage, Target};
use crate::gather::PointSource;
use crate::geometry::Hair;
use crate::occluder::Occluder;
use crate::renderer::Renderer;
use crate::resources::RING;
use crate::surface::Subresources;

/// The least version of Vulkan, of the instance and of the device.
pub const API_VERSION: u32 = vk::API_VERSION_1_3;

/// The most views of one submission.
pub const MAX_VIEWS: usize = RING;

/// The most updates of one hair that wait for a submission: no more than two of them can be seen, the last by motion vectors
/// from the one before.
pub const MAX_WAITING_UPDATES: u32 = 16;

/// One view to be drawn: a frame, and the host's images that it goes into.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// What is drawn.
    pub frame: &'a Frame<'a>,
    /// Hair is blended over what it holds, premultiplied.
    pub colour: &'a Image,
    /// The opaque scene's depth, of the colour's size: it hides hair.
    pub depth: Option<&'a Image>,
    /// As of [`Target::clear`].
    pub clear: bool,
    /// As of [`Target::write_depth`].
    pub write_depth: bool,
    /// As of [`Target::receive_shadow`].
    pub receive_shadow: bool,
    /// As of [`Target::rectangle`].
    pub rectangle: Option<[u32; 4]>,
    /// What else is written.
    pub outputs: ViewOutputs<'a>,
    /// As of [`Target::occluders`].
    pub occluders: &'a [ViewOccluder],
    /// As of [`Target::shadow_images`]: lights and their images, each of the colour's size, with the usage `COLOR_ATTACHMENT`.
    pub shadow_images: &'a [(usize, Image)],
    /// As of [`Target::shadows_only`]. The colour is then taken and given back as it is.
    pub shadows_only: bool,
}

/// A shadow map of the host's: [`crate::Occluder`] of its own image, with the usage `SAMPLED`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewOccluder {
    /// As of [`crate::Occluder::light`].
    pub light: usize,
    /// The depth of the opaque scene as the light sees it.
    pub depth: Image,
    /// As of [`crate::Occluder::clip_from_world`].
    pub clip_from_world: glam::DMat4,
    /// As of [`crate::Occluder::reverse_z`].
    pub reverse_z: bool,
    /// As of [`crate::Occluder::flip_y`].
    pub flip_y: bool,
    /// As of [`crate::Occluder::bias`].
    pub bias: f32,
    /// As of [`crate::Occluder::pcf`].
    pub pcf: u32,
}

/// The host's images for [`crate::Outputs`], all of the colour's size, with the usage `COLOR_ATTACHMENT`. What they hold
/// outside the view's rectangle is kept, so that only a view that fills them takes the layout `UNDEFINED`.
#[derive(Debug, Clone, Copy, Default)]
pub struct ViewOutputs<'a> {
    /// `R32_SFLOAT`.
    pub nearest_depth: Option<&'a Image>,
    /// `R32_SFLOAT`, `R16_SFLOAT` or `R8_UNORM`.
    pub coverage: Option<&'a Image>,
    /// `R32G32_SFLOAT` or `R16G16_SFLOAT`.
    pub motion: Option<&'a Image>,
    /// `R32G32_UINT`.
    pub ids: Option<&'a Image>,
}

impl<'a> ViewOutputs<'a> {
    fn images(&self) -> [(Aspect, Option<&'a Image>); 4] {
        [
            (Aspect::NearestDepth, self.nearest_depth),
            (Aspect::Coverage, self.coverage),
            (Aspect::Motion, self.motion),
            (Aspect::Ids, self.ids),
        ]
    }
}

/// A context on the host's device.
pub struct Vulkan {
    /// `None` once the queue is being taken down.
    renderer: Option<Renderer>,
    device: ash::Device,
    formats: image::Formats,
    families: Families,
    /// What the next submission does before its views.
    ahead: Vec<wgpu::CommandBuffer>,
    lock: Option<Arc<dyn QueueLock>>,
    /// How many submissions there have been.
    submissions: u64,
    lost: Lost,
    info: wgpu::AdapterInfo,
}

impl Vulkan {
    /// A context on the host's device. Several may share one device and one queue.
    ///
    /// # Errors
    /// A handle that is null or does not belong to the others; a device that falls short; an extension that is required
    /// and not enabled; no memory.
    ///
    /// # Safety
    /// The handles are valid and what the descriptor says of them is so; the device was made with the extensions and
    /// features of [`requirements`]. All of them stay valid until the context and all hair made on it are dropped.
    pub unsafe fn new(descriptor: &DeviceDescriptor) -> Result<Self> {
        // SAFETY: the host's promise is passed on.
        let opened = unsafe { device::open(descriptor) }?;
        let lost = Lost::watch(&opened.device);
        opened
            .device
            .on_uncaptured_error(Arc::new(|error| log::error!("{error}")));
        let renderer = Renderer::new(&opened.device, &opened.queue);
        let mut context = Self {
            renderer: None,
            device: opened.raw,
            formats: opened.formats,
            families: opened.families,
            ahead: Vec::new(),
            lock: descriptor.lock.clone(),
            submissions: 0,
            lost,
            info: opened.info,
        };
        match renderer {
            Ok(renderer) => {
                context.renderer = Some(renderer);
                Ok(context)
            }
            Err(error) => {
                let _held = context.hold();
                drop(opened.queue);
                Err(error)
            }
        }
    }

    /// Name and driver of the device.
    pub fn adapter_info(&self) -> &wgpu::AdapterInfo {
        &self.info
    }

    /// Runs `call` on the renderer.
    ///
    /// # Errors
    /// Those of `call`; a device that was lost before or meanwhile.
    pub fn with_renderer<T>(&mut self, call: impl FnOnce(&mut Renderer) -> Result<T>) -> Result<T> {
        self.lost.alive()?;
        let renderer = self.renderer.as_mut().ok_or_else(gone)?;
        let result = call(renderer);
        self.lost.settle(result)
    }

    /// Records commands that the next submission of [`Vulkan::render`] does before its views. The calls that
    /// [`Renderer`] documents as waiting for a submission wait for that one.
    ///
    /// # Errors
    /// Those of `call`; a lost device. Nothing is then recorded.
    pub fn record_ahead(
        &mut self,
        call: impl FnOnce(&mut Renderer, &mut wgpu::CommandEncoder) -> Result<()>,
    ) -> Result<()> {
        let commands = self.commands_ahead(call)?;
        self.ahead.push(commands);
        Ok(())
    }

    fn commands_ahead(
        &mut self,
        call: impl FnOnce(&mut Renderer, &mut wgpu::CommandEncoder) -> Result<()>,
    ) -> Result<wgpu::CommandBuffer> {
        self.lost.alive()?;
        let renderer = self.renderer.as_mut().ok_or_else(gone)?;
        let device = renderer.device().clone();
        let errors = Errors::watch(&device);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("pelage.vulkan.ahead"),
        });
        let recorded = call(renderer, &mut encoder).map(|()| encoder.finish());
        let found = errors.take();
        self.settle(recorded, found)
    }

    /// Updates a hair by `call`, unless [`MAX_WAITING_UPDATES`] of this hair wait for a submission: each holds memory until then.
    ///
    /// # Errors
    /// Those of `call`; too many updates.
    pub fn update(
        &mut self,
        hair: &mut Hair,
        call: impl FnOnce(&mut Self, &mut Hair) -> Result<()>,
    ) -> Result<()> {
        let (submission, count) = hair.geometry.waiting;
        let count = if submission == self.submissions {
            count
        } else {
            0
        };
        if count >= MAX_WAITING_UPDATES {
            return Err(Error::Conflict(format!(
                "{count} updates of the hair wait for a submission; hand them over first, by one of no views if nothing is to be drawn"
            )));
        }
        call(self, hair)?;
        hair.geometry.waiting = (self.submissions, count + 1);
        Ok(())
    }

    /// Whether anything waits for the next submission.
    pub fn is_ahead(&self) -> bool {
        !self.ahead.is_empty()
    }

    /// Moves a hair by a buffer of the host's: [`Renderer::update_points_from`], or with `guides`
    /// [`Renderer::update_guides_from`], in the next submission of [`Vulkan::render`], before its views.
    ///
    /// A full barrier stands before and after what reads the buffer, so that what fills it, or fills it again, needs no
    /// semaphore on the same queue.
    ///
    /// # Errors
    /// A buffer that is NULL or lacks the usage `STORAGE_BUFFER`; a family that there is not; those of the two functions, and of
    /// [`Vulkan::update`].
    ///
    /// # Safety
    /// The buffer is what it is said to be, bound to memory, and stays valid until the GPU is done with the next
    /// submission, or the context is dropped.
    pub unsafe fn update_from(
        &mut self,
        hair: &mut Hair,
        source: &Points,
        guides: bool,
    ) -> Result<()> {
        self.update(hair, |context, hair| {
            // SAFETY: the host's promise is passed on.
            unsafe { context.record_update(hair, source, guides) }
        })
    }

    unsafe fn record_update(
        &mut self,
        hair: &mut Hair,
        source: &Points,
        guides: bool,
    ) -> Result<()> {
        source.validate(&self.families)?;
        self.lost.alive()?;
        let device = self.renderer.as_ref().ok_or_else(gone)?.device();
        let transfer = |towards_us| {
            let barrier = source.owner_barrier(&self.families, towards_us);
            let step = Step {
                buffers: barrier.as_slice(),
                images: &[],
            };
            // SAFETY: the buffer belongs to the family that the host has named.
            barrier.map(|_| unsafe { barrier::record(device, &self.device, &[step]) })
        };
        let (acquired, released) = (transfer(true).transpose()?, transfer(false).transpose()?);
        let commands = self.commands_ahead(|renderer, encoder| {
            // SAFETY: the host's promise is passed on.
            let buffer = unsafe { source.wrap(renderer.device()) }?;
            let source = PointSource {
                buffer: &buffer,
                offset: source.offset,
                stride: source.stride,
                bounds: source.bounds,
            };
            if guides {
                renderer.update_guides_from(encoder, hair, &source)
            } else {
                renderer.update_points_from(encoder, hair, &source)
            }
        })?;
        self.ahead
            .extend(acquired.into_iter().chain([commands]).chain(released));
        Ok(())
    }

    /// Records views into one submission and hands it to the queue. Waits for nothing, unless more than [`MAX_VIEWS`]
    /// views are on their way.
    ///
    /// The submission waits for `waits`, and signals `signals` when the GPU is done with it.
    ///
    /// # Errors
    /// An image that cannot be drawn into, a value out of range, no memory: nothing has then been submitted, and no
    /// semaphore will be signalled. A lost device: the context is dead, and can be dropped.
    ///
    /// # Safety
    /// Images, layouts and semaphores are what they are said to be, and stay valid until the GPU is done. Where a wait
    /// must be answered by the host itself, the host is not waiting for this call.
    pub unsafe fn render(
        &mut self,
        views: &[View],
        waits: &[Semaphore],
        signals: &[Semaphore],
    ) -> Result<()> {
        self.lost.alive()?;
        if views.len() > MAX_VIEWS {
            return invalid!(
                "{} views: one submission takes at most {MAX_VIEWS}",
                views.len()
            );
        }
        queue::validate("waits", waits)?;
        queue::validate("signals", signals)?;
        for (number, view) in views.iter().enumerate() {
            view.validate(&self.formats, &self.families)
                .map_err(|error| about(number, error))?;
        }
        let device = self.renderer.as_ref().ok_or_else(gone)?.device().clone();
        let errors = Errors::watch(&device);
        let record = |(number, view): (usize, &View)| {
            // SAFETY: the host's promise is passed on.
            unsafe { self.record(view) }.map_err(|error| about(number, error))
        };
        let recorded = views
            .iter()
            .enumerate()
            .map(record)
            .collect::<Result<Vec<_>>>();
        let found = errors.take();
        let recorded = self.settle(recorded, found)?;
        let before = self.precede(&device)?;
        let commands = before.into_iter().chain(recorded.into_iter().flatten());
        let errors = Errors::watch(&device);
        // SAFETY: the host's promise is passed on.
        let submitted = unsafe { self.submit(commands, waits, signals) };
        let found = errors.take();
        self.settle(submitted, found)?;
        self.submissions += 1;
        Ok(())
    }

    /// What comes before the views: a barrier, what has been recorded ahead, a barrier.
    fn precede(&mut self, device: &wgpu::Device) -> Result<Vec<wgpu::CommandBuffer>> {
        if self.ahead.is_empty() {
            return Ok(Vec::new());
        }
        // SAFETY: nothing is named.
        let barrier = || unsafe { barrier::record(device, &self.device, &[Step::default()]) };
        let (first, last) = (barrier()?, barrier()?);
        let mut commands = vec![first];
        commands.append(&mut self.ahead);
        commands.push(last);
        Ok(commands)
    }

    /// One view's commands: a barrier, the frame, a barrier.
    unsafe fn record(&mut self, view: &View) -> Result<[wgpu::CommandBuffer; 3]> {
        let renderer = self.renderer.as_mut().ok_or_else(gone)?;
        let device = renderer.device().clone();
        let wrap = |image, aspect| {
            // SAFETY: the host's images are what they are said to be.
            unsafe { Wrapped::new(&device, image, aspect, &self.formats) }
        };
        let colour = wrap(view.colour, Aspect::Colour)?;
        let depth = view
            .depth
            .map(|image| wrap(image, Aspect::Depth))
            .transpose()?;
        let mut outputs = [const { None }; 4];
        for (output, (aspect, image)) in outputs.iter_mut().zip(view.outputs.images()) {
            *output = image.map(|image| wrap(image, aspect)).transpose()?;
        }
        let occluders = view
            .occluders
            .iter()
            .map(|occluder| wrap(&occluder.depth, Aspect::Occluder))
            .collect::<Result<Vec<_>>>()?;
        let shadow_images = view
            .shadow_images
            .iter()
            .map(|(_, image)| wrap(image, Aspect::ShadowImage))
            .collect::<Result<Vec<_>>>()?;
        let images = || {
            let given = [Some(&colour), depth.as_ref()].into_iter();
            let given = given.chain(outputs.iter().map(Option::as_ref)).flatten();
            given.chain(&occluders).chain(&shadow_images)
        };
        let output = |at: usize| outputs[at].as_ref().map(|output| &output.texture);

        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("pelage.vulkan"),
        });
        let occluding: Vec<_> = view
            .occluders
            .iter()
            .zip(&occluders)
            .map(|(given, wrapped)| Occluder {
                light: given.light,
                depth: &wrapped.texture,
                subresource: given.depth.subresource,
                clip_from_world: given.clip_from_world,
                reverse_z: given.reverse_z,
                flip_y: given.flip_y,
                bias: given.bias,
                pcf: given.pcf,
            })
            .collect();
        let shadows: Vec<_> = view
            .shadow_images
            .iter()
            .zip(&shadow_images)
            .map(|((light, given), wrapped)| ShadowImage {
                light: *light,
                image: &wrapped.texture,
                subresource: given.subresource,
            })
            .collect();
        let target = Target {
            colour: &colour.texture,
            depth: depth.as_ref().map(|depth| &depth.texture),
            clear: view.clear,
            write_depth: view.write_depth,
            receive_shadow: view.receive_shadow,
            rectangle: view.rectangle,
            outputs: Outputs {
                nearest_depth: output(0),
                coverage: output(1),
                motion: output(2),
                ids: output(3),
            },
            occluders: &occluding,
            shadow_images: &shadows,
            shadows_only: view.shadows_only,
            subresources: view.subresources(),
        };
        renderer.record(&mut encoder, view.frame, &target)?;
        // Colour and outputs end as they began, as targets. Of the depth the other layers and levels are read-only from the
        // start, so that nothing happens to them.
        encoder.transition_resources(
            std::iter::empty(),
            depth
                .iter()
                .chain(&occluders)
                .map(|depth| wgpu::TextureTransition {
                    texture: &depth.texture,
                    selector: None,
                    state: TextureUses::RESOURCE,
                }),
        );
        let barriers = |towards_us| {
            let layouts: Vec<_> = images()
                .map(|image| image.layout_barrier(towards_us))
                .collect();
            let owners: Vec<_> = images()
                .filter_map(|image| image.owner_barrier(&self.families, towards_us))
                .collect();
            let step = |images| Step {
                buffers: &[],
                images,
            };
            // What changes hands is taken before all else, and given back after all else.
            let mut steps = vec![step(&layouts[..])];
            if !owners.is_empty() {
                steps.insert(usize::from(!towards_us), step(&owners));
            }
            // SAFETY: the images are in the layouts that the barriers expect, and belong to the families that they name: the
            // host's, and after the frame its own.
            unsafe { barrier::record(&device, &self.device, &steps) }
        };
        Ok([barriers(true)?, encoder.finish(), barriers(false)?])
    }

    /// Hands recorded views to the queue, with the host's lock held.
    unsafe fn submit(
        &mut self,
        recorded: impl Iterator<Item = wgpu::CommandBuffer>,
        waits: &[Semaphore],
        signals: &[Semaphore],
    ) -> Result<()> {
        let queue = self.renderer.as_ref().ok_or_else(gone)?.queue();
        // SAFETY: nothing of the raw queue is kept or destroyed.
        let Some(raw) = (unsafe { queue.as_hal::<wgpu::hal::api::Vulkan>() }) else {
            return Err(Error::Internal("the queue is not Vulkan's".into()));
        };
        let _held = self.hold();
        for wait in waits {
            let stages = vk::PipelineStageFlags::ALL_COMMANDS;
            raw.add_wait_semaphore(wait.semaphore, wait.value, stages);
        }
        for signal in signals {
            raw.add_signal_semaphore(signal.semaphore, signal.value);
        }
        queue.submit(recorded);
        // What a failed submission has left over is not for the next one.
        for wait in waits {
            raw.remove_wait_semaphore(wait.semaphore);
        }
        for signal in signals {
            raw.remove_signal_semaphore(signal.semaphore);
        }
        Ok(())
    }

    /// Says what a lost device, or else the call itself, or else wgpu had to say.
    fn settle<T>(&self, result: Result<T>, found: Option<wgpu::Error>) -> Result<T> {
        self.lost.settle(match (result, found) {
            (Err(error), _) => Err(error),
            (Ok(_), Some(error @ wgpu::Error::OutOfMemory { .. })) => {
                Err(Error::OutOfMemory(error.to_string()))
            }
            (Ok(_), Some(error)) => Err(Error::Internal(error.to_string())),
            (Ok(value), None) => Ok(value),
        })
    }

    /// Takes the host's lock around the queue.
    fn hold(&self) -> queue::Held<'_> {
        queue::hold(self.lock.as_deref())
    }
}

impl Drop for Vulkan {
    /// Waits for the queue, with the host's lock held.
    fn drop(&mut self) {
        let renderer = self.renderer.take();
        let ahead = std::mem::take(&mut self.ahead);
        let _held = self.hold();
        drop(ahead);
        drop(renderer);
    }
}

impl View<'_> {
    fn validate(&self, formats: &image::Formats, families: &Families) -> Result<()> {
        self.colour.validate(Aspect::Colour, formats, families)?;
        if self.colour.layout_in == vk::ImageLayout::UNDEFINED && (!self.clear || self.shadows_only)
        {
            return invalid!(
                "colour: layout_in is VK_IMAGE_LAYOUT_UNDEFINED, which loses what the image holds; clear it, or name its layout"
            );
        }
        let vk::Extent2D { width, height } = self.colour.extent;
        let [width, height] = self.colour.subresource.size([width, height]);
        let fills = self
            .rectangle
            .is_none_or(|area| area == [0, 0, width, height]);
        let mut seen = vec![(Aspect::Colour, self.colour)];
        for (aspect, image) in self.others() {
            image.validate(aspect, formats, families)?;
            let name = aspect.name();
            let kept = matches!(aspect, Aspect::Depth | Aspect::Occluder) || !fills;
            if image.layout_in == vk::ImageLayout::UNDEFINED && kept {
                return invalid!(
                    "{name}: layout_in is VK_IMAGE_LAYOUT_UNDEFINED, which loses what the image holds"
                );
            }
            let same = |(_, other): &&(Aspect, &Image)| {
                (other.image, other.subresource) == (image.image, image.subresource)
            };
            if let Some((other, _)) = seen.iter().find(same) {
                return invalid!(
                    "{name} is the same image as {}, and the same layer and mip level of it",
                    other.name()
                );
            }
            seen.push((aspect, image));
        }
        Ok(())
    }

    fn subresources(&self) -> Subresources {
        let of = |image: Option<&Image>| image.map(|image| image.subresource).unwrap_or_default();
        Subresources {
            colour: self.colour.subresource,
            depth: of(self.depth),
            nearest_depth: of(self.outputs.nearest_depth),
            coverage: of(self.outputs.coverage),
            motion: of(self.outputs.motion),
            ids: of(self.outputs.ids),
        }
    }

    /// The images that are given beside the colour.
    fn others(&self) -> impl Iterator<Item = (Aspect, &Image)> {
        let occluders = self.occluders.iter();
        let shadows = self.shadow_images.iter();
        std::iter::once((Aspect::Depth, self.depth))
            .chain(self.outputs.images())
            .filter_map(|(aspect, image)| Some((aspect, image?)))
            .chain(occluders.map(|given| (Aspect::Occluder, &given.depth)))
            .chain(shadows.map(|(_, image)| (Aspect::ShadowImage, image)))
    }
}

/// Errors of wgpu that would otherwise go to the log.
struct Errors([wgpu::ErrorScopeGuard; 3]);

impl Errors {
    fn watch(device: &wgpu::Device) -> Self {
        use wgpu::ErrorFilter::{Internal, OutOfMemory, Validation};
        Self([Validation, OutOfMemory, Internal].map(|filter| device.push_error_scope(filter)))
    }

    /// What was found: a failed validation before all else.
    fn take(self) -> Option<wgpu::Error> {
        let mut found = None;
        for scope in self.0.into_iter().rev() {
            found = pollster::block_on(scope.pop()).or(found);
        }
        found
    }
}

fn gone() -> Error {
    Error::Internal("the renderer is gone".into())
}

/// Says which view an error is about.
fn about(number: usize, error: Error) -> Error {
    match error {
        Error::InvalidValue(what) => Error::InvalidValue(format!("views[{number}]: {what}")),
        Error::Unsupported(what) => Error::Unsupported(format!("views[{number}]: {what}")),
        Error::Conflict(what) => Error::Conflict(format!("views[{number}]: {what}")),
        other => other,
    }
}
