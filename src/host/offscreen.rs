//! Offscreen: the library's own device, no window. Falls back to a software adapter.

use glam::Vec4;

use super::lost::Lost;
use crate::error::{Error, Result, invalid};
use crate::frame::{Frame, Outputs, Target};
use crate::renderer::Renderer;
use crate::statistics::Statistics;

/// How an offscreen device is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct OffscreenOptions {
    /// Take a software adapter even where a GPU is present.
    pub force_software: bool,
    /// Load the validation layer where it is installed; it writes what it finds to the standard output.
    pub validation: bool,
}

/// A device of the library's own, with its renderer.
pub struct Offscreen {
    /// The renderer on this device.
    pub renderer: Renderer,
    info: wgpu::AdapterInfo,
    pub(super) write_depth: Option<wgpu::RenderPipeline>,
    lost: Lost,
}

/// An image to draw into, with an optional depth.
#[derive(Debug, Clone)]
pub struct Image {
    /// `Rgba16Float` or `Rgba32Float`, linear, premultiplied.
    pub colour: wgpu::Texture,
    /// `Depth32Float`.
    pub depth: Option<wgpu::Texture>,
    /// What else is written, each in the first of its formats.
    pub outputs: ImageOutputs,
}

/// The images of [`Outputs`] that an [`Image`] has.
#[derive(Debug, Clone, Default)]
pub struct ImageOutputs {
    /// `R32Float`.
    pub nearest_depth: Option<wgpu::Texture>,
    /// `R32Float`.
    pub coverage: Option<wgpu::Texture>,
    /// `Rg32Float`.
    pub motion: Option<wgpu::Texture>,
    /// `Rg32Uint`.
    pub ids: Option<wgpu::Texture>,
}

/// Which outputs an image is to have.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct WantedOutputs {
    /// The nearest fibre's depth.
    pub nearest_depth: bool,
    /// The part of a pixel that hair covers.
    pub coverage: bool,
    /// Motion on the screen.
    pub motion: bool,
    /// Hair, instance and strand.
    pub ids: bool,
}

impl Image {
    /// What else is written, as a [`Target`] names it.
    pub fn outputs(&self) -> Outputs<'_> {
        Outputs {
            nearest_depth: self.outputs.nearest_depth.as_ref(),
            coverage: self.outputs.coverage.as_ref(),
            motion: self.outputs.motion.as_ref(),
            ids: self.outputs.ids.as_ref(),
        }
    }
}

/// Vulkan, with its validation layer where that is asked for.
pub(super) fn instance(options: &OffscreenOptions) -> wgpu::Instance {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::VULKAN;
    descriptor.flags = if options.validation {
        wgpu::InstanceFlags::VALIDATION
    } else {
        wgpu::InstanceFlags::empty()
    };
    wgpu::Instance::new(descriptor)
}

/// A GPU if there is one, else a software adapter; one that can show the surface, if there is one.
pub(super) async fn adapter(
    instance: &wgpu::Instance,
    options: &OffscreenOptions,
    surface: Option<&wgpu::Surface<'static>>,
) -> std::result::Result<wgpu::Adapter, wgpu::RequestAdapterError> {
    let mut request = wgpu::RequestAdapterOptions {
        power_preference: wgpu::PowerPreference::HighPerformance,
        force_fallback_adapter: options.force_software,
        compatible_surface: surface,
        ..Default::default()
    };
    let mut adapter = instance.request_adapter(&request).await;
    if adapter.is_err() {
        request.force_fallback_adapter = true;
        adapter = instance.request_adapter(&request).await;
    }
    adapter
}

impl Offscreen {
    /// Opens a device: a GPU if there is one, else a software adapter.
    ///
    /// # Errors
    /// No Vulkan driver at all, or a device that falls short; see [`Renderer::new`].
    pub fn new(options: &OffscreenOptions) -> Result<Self> {
        pollster::block_on(Self::open(options))
    }

    async fn open(options: &OffscreenOptions) -> Result<Self> {
        let adapter = adapter(&instance(options), options, None)
            .await
            .map_err(|error| {
                Error::Unsupported(format!(
                    "no Vulkan driver was found ({error}); on Debian, install mesa-vulkan-drivers for a software one"
                ))
            })?;
        Self::on_adapter(&adapter).await
    }

    /// A device of an adapter.
    pub(super) async fn on_adapter(adapter: &wgpu::Adapter) -> Result<Self> {
        let wanted = wgpu::Features::FLOAT32_BLENDABLE
            | wgpu::Features::SHADER_INT64
            | wgpu::Features::SHADER_INT64_ATOMIC_ALL_OPS;
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                label: Some("pelage"),
                required_features: adapter.features() & wanted,
                required_limits: adapter.limits(),
                ..Default::default()
            })
            .await
            .map_err(|error| Error::Unsupported(format!("the adapter gives no device: {error}")))?;
        device.on_uncaptured_error(std::sync::Arc::new(|error| log::error!("{error}")));
        let lost = Lost::watch(&device);
        let mut offscreen = Self::on(&device, &queue, adapter.get_info())?;
        offscreen.lost = lost;
        Ok(offscreen)
    }

    /// Images and readbacks on a device of the host's, made on the adapter of `info`. The host sees to errors that no call
    /// returns.
    ///
    /// # Errors
    /// A device that falls short; see [`Renderer::new`].
    pub fn on(device: &wgpu::Device, queue: &wgpu::Queue, info: wgpu::AdapterInfo) -> Result<Self> {
        Ok(Self {
            renderer: Renderer::new(device, queue)?,
            info,
            write_depth: None,
            lost: Lost::default(),
        })
    }

    /// Checks that a device of the library's own has not been lost in an earlier call.
    pub(crate) fn alive(&self) -> Result<()> {
        self.lost.alive()
    }

    /// What a call says: its own result, unless the device has been lost in it.
    pub(crate) fn settle<T>(&self, result: Result<T>) -> Result<T> {
        self.lost.settle(result)
    }

    /// Name and driver of the adapter.
    pub fn adapter_info(&self) -> &wgpu::AdapterInfo {
        &self.info
    }

    /// Makes an image of `width` × `height` pixels, cleared to zero, with a depth at `depth` (1 is far) if asked for.
    ///
    /// # Errors
    /// A size of zero or beyond the device's largest; another format than the two of [`Image`]; no memory.
    pub fn create_image(
        &self,
        width: u32,
        height: u32,
        format: wgpu::TextureFormat,
        with_depth: bool,
    ) -> Result<Image> {
        let device = self.renderer.device();
        let largest = device.limits().max_texture_dimension_2d;
        if width == 0 || height == 0 || width > largest || height > largest {
            return invalid!(
                "an image of {width}×{height} pixels; sides from 1 to {largest} are possible"
            );
        }
        if !matches!(
            format,
            wgpu::TextureFormat::Rgba16Float | wgpu::TextureFormat::Rgba32Float
        ) {
            return invalid!(
                "an image of format {format:?}; Rgba16Float and Rgba32Float are possible"
            );
        }
        use wgpu::TextureUsages as Usage;
        let texture = |format, label| {
            device.create_texture(&wgpu::TextureDescriptor {
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
                usage: Usage::RENDER_ATTACHMENT
                    | Usage::TEXTURE_BINDING
                    | Usage::COPY_SRC
                    | Usage::COPY_DST,
                view_formats: &[],
            })
        };
        let scope = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let image = Image {
            colour: texture(format, "pelage.image.colour"),
            depth: with_depth
                .then(|| texture(wgpu::TextureFormat::Depth32Float, "pelage.image.depth")),
            outputs: ImageOutputs::default(),
        };
        if let Some(error) = pollster::block_on(scope.pop()) {
            return Err(Error::OutOfMemory(format!(
                "an image of {width}×{height} pixels: {error}"
            )));
        }
        if let Some(depth) = &image.depth {
            self.clear_depth(depth);
        }
        Ok(image)
    }

    /// Gives an image the outputs that are wanted, in place of those that it has.
    ///
    /// # Errors
    /// No memory; the image is then as it was.
    pub fn add_outputs(&self, image: &mut Image, wanted: WantedOutputs) -> Result<()> {
        use wgpu::TextureFormat as Format;
        let device = self.renderer.device();
        let size = image.colour.size();
        let texture = |wanted: bool, format, label| {
            wanted.then(|| {
                device.create_texture(&wgpu::TextureDescriptor {
                    label: Some(label),
                    size,
                    mip_level_count: 1,
                    sample_count: 1,
                    dimension: wgpu::TextureDimension::D2,
                    format,
                    usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                        | wgpu::TextureUsages::TEXTURE_BINDING
                        | wgpu::TextureUsages::COPY_SRC,
                    view_formats: &[],
                })
            })
        };
        let scope = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let outputs = ImageOutputs {
            nearest_depth: texture(
                wanted.nearest_depth,
                Format::R32Float,
                "pelage.image.nearest_depth",
            ),
            coverage: texture(wanted.coverage, Format::R32Float, "pelage.image.coverage"),
            motion: texture(wanted.motion, Format::Rg32Float, "pelage.image.motion"),
            ids: texture(wanted.ids, Format::Rg32Uint, "pelage.image.ids"),
        };
        if let Some(error) = pollster::block_on(scope.pop()) {
            return Err(Error::OutOfMemory(format!(
                "outputs of {}×{} pixels: {error}",
                size.width, size.height
            )));
        }
        image.outputs = outputs;
        Ok(())
    }

    /// Reads an image of one or two 32-bit words a texel back as its bits, row 0 at the top. Waits for the GPU.
    ///
    /// # Errors
    /// An image of another kind; a lost device.
    pub fn read_words(&mut self, texture: &wgpu::Texture) -> Result<Vec<u32>> {
        use wgpu::TextureFormat as Format;
        if !matches!(
            texture.format(),
            Format::R32Float | Format::Rg32Float | Format::Rg32Uint
        ) {
            return invalid!("an image of format {:?} has no words", texture.format());
        }
        let readback = self.begin_read(texture)?;
        self.finish_words(&readback)
    }

    /// Sets a depth to far.
    fn clear_depth(&self, depth: &wgpu::Texture) {
        let view = depth.create_view(&Default::default());
        let mut encoder = self
            .renderer
            .device()
            .create_command_encoder(&Default::default());
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("pelage.image.clear_depth"),
            color_attachments: &[],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        self.renderer.queue().submit([encoder.finish()]);
    }

    /// Records and submits; does not wait.
    ///
    /// # Errors
    /// As [`Renderer::record`]; nothing has then been submitted. A lost device of the library's own.
    pub fn submit(&mut self, frame: &Frame, target: &Target) -> Result<()> {
        self.alive()?;
        let mut encoder = self
            .renderer
            .device()
            .create_command_encoder(&Default::default());
        let recorded = self.renderer.record(&mut encoder, frame, target);
        self.settle(recorded)?;
        self.renderer.queue().submit([encoder.finish()]);
        self.settle(Ok(()))
    }

    /// Records, submits and waits; the frame's own statistics.
    ///
    /// # Errors
    /// As [`Renderer::record`]; a lost device.
    pub fn render(&mut self, frame: &Frame, target: &Target) -> Result<Statistics> {
        self.submit(frame, target)?;
        let waited = self.renderer.wait();
        self.settle(waited)?;
        Ok(self.renderer.statistics())
    }

    /// Reads a colour image back, row 0 at the top. Waits for the GPU.
    ///
    /// # Errors
    /// An image of another format than the two of [`Image`]; a lost device.
    pub fn read_colour(&mut self, colour: &wgpu::Texture) -> Result<Vec<Vec4>> {
        let readback = self.begin_read(colour)?;
        self.finish_colour(&readback)
    }

    /// Reads a depth image back, row 0 at the top. Waits for the GPU.
    ///
    /// # Errors
    /// An image of another format than `Depth32Float`; a lost device.
    pub fn read_depth(&mut self, depth: &wgpu::Texture) -> Result<Vec<f32>> {
        let readback = self.begin_read(depth)?;
        self.finish_depth(&readback)
    }

    /// Writes a colour image, row 0 at the top: the opaque scene under the hair. `Rgba16Float` holds ±65504 at most; what
    /// is beyond is held at that.
    ///
    /// # Errors
    /// Another number of pixels than the image has; another format than the two of [`Image`].
    pub fn write_colour(&mut self, colour: &wgpu::Texture, pixels: &[Vec4]) -> Result<()> {
        let bytes: Vec<u8> = match colour.format() {
            wgpu::TextureFormat::Rgba32Float => bytemuck::cast_slice(pixels).to_vec(),
            wgpu::TextureFormat::Rgba16Float => pixels
                .iter()
                .flat_map(|p| p.to_array())
                .flat_map(|v| {
                    half::f16::from_f32(v.clamp(-65504.0, 65504.0))
                        .to_bits()
                        .to_ne_bytes()
                })
                .collect(),
            format => {
                return invalid!(
                    "an image of format {format:?}; Rgba16Float and Rgba32Float can be written"
                );
            }
        };
        self.write_texture(colour, &bytes, pixels.len())
    }

    /// Copies packed rows into a texture.
    pub(super) fn write_texture(
        &mut self,
        texture: &wgpu::Texture,
        bytes: &[u8],
        count: usize,
    ) -> Result<()> {
        let expected = texture.width() as usize * texture.height() as usize;
        if count != expected {
            return invalid!(
                "{count} pixels for an image of {}×{}",
                texture.width(),
                texture.height()
            );
        }
        self.renderer.queue().write_texture(
            texture.as_image_copy(),
            bytes,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(bytes.len() as u32 / texture.height()),
                rows_per_image: None,
            },
            texture.size(),
        );
        Ok(())
    }
}
