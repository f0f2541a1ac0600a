//! Images on their way back from the GPU, so that a host need not wait for them.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use glam::Vec4;

use super::offscreen::Offscreen;
use crate::error::{Error, Result, invalid};

/// The states of a copy.
const PENDING: u8 = 0;
const ARRIVED: u8 = 1;
const FAILED: u8 = 2;

/// An image's texels on their way to the host. Made by [`Offscreen::begin_read`].
#[derive(Debug)]
pub struct Readback {
    buffer: wgpu::Buffer,
    state: Arc<AtomicU8>,
    format: wgpu::TextureFormat,
    width: u32,
    height: u32,
    /// Bytes of a row, and of a row with its padding.
    row: u32,
    stride: u32,
}

impl Readback {
    /// Width and height of the image in pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// The image's format.
    pub fn format(&self) -> wgpu::TextureFormat {
        self.format
    }
}

impl Offscreen {
    /// Sends a copy of an image's texels, as they are after all work submitted so far, on its way to the host. Does not
    /// wait.
    ///
    /// # Errors
    /// An image larger than the device's largest buffer; no memory.
    pub fn begin_read(&self, texture: &wgpu::Texture) -> Result<Readback> {
        let device = self.renderer.device();
        let texel = texture
            .format()
            .block_copy_size(Some(wgpu::TextureAspect::All))
            .unwrap_or(4);
        let row = texture.width() * texel;
        let stride = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let size = u64::from(stride) * u64::from(texture.height());
        let most = device.limits().max_buffer_size;
        if size > most {
            return Err(Error::Unsupported(format!(
                "reading {size} bytes; this device's largest buffer holds {most}"
            )));
        }
        let scope = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("pelage.image.read"),
            size,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        if let Some(error) = pollster::block_on(scope.pop()) {
            return Err(Error::OutOfMemory(format!("reading {size} bytes: {error}")));
        }
        let mut encoder = device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(stride),
                    rows_per_image: None,
                },
            },
            texture.size(),
        );
        self.renderer.queue().submit([encoder.finish()]);
        self.settle(Ok(()))?;
        let state = Arc::new(AtomicU8::new(PENDING));
        let arrived = state.clone();
        buffer.map_async(wgpu::MapMode::Read, .., move |result| {
            arrived.store(
                if result.is_ok() { ARRIVED } else { FAILED },
                Ordering::Release,
            );
        });
        let (width, height) = (texture.width(), texture.height());
        Ok(Readback {
            buffer,
            state,
            format: texture.format(),
            width,
            height,
            row,
            stride,
        })
    }

    /// Whether an image has arrived. Does not wait.
    ///
    /// # Errors
    /// A lost device.
    pub fn poll_read(&self, readback: &Readback) -> Result<bool> {
        if let Err(error) = self.renderer.device().poll(wgpu::PollType::Poll) {
            return Err(Error::DeviceLost(error.to_string()));
        }
        match readback.state.load(Ordering::Acquire) {
            FAILED => Err(Error::DeviceLost("an image could not be read back".into())),
            state => Ok(state == ARRIVED),
        }
    }

    /// The colours of an image on its way, row 0 at the top. Waits for it if it has not arrived.
    ///
    /// # Errors
    /// An image of another format than `Rgba16Float` and `Rgba32Float`; a lost device.
    pub fn finish_colour(&mut self, readback: &Readback) -> Result<Vec<Vec4>> {
        let bytes = self.finish(readback)?;
        match readback.format {
            wgpu::TextureFormat::Rgba32Float => {
                let values = bytemuck::pod_collect_to_vec::<u8, f32>(&bytes);
                Ok(values.chunks_exact(4).map(Vec4::from_slice).collect())
            }
            wgpu::TextureFormat::Rgba16Float => {
                let values = bytemuck::pod_collect_to_vec::<u8, u16>(&bytes);
                let float = |bits: u16| half::f16::from_bits(bits).to_f32();
                Ok(values
                    .chunks_exact(4)
                    .map(|c| Vec4::from_array(std::array::from_fn(|i| float(c[i]))))
                    .collect())
            }
            format => {
                invalid!("an image of format {format:?}; Rgba16Float and Rgba32Float can be read")
            }
        }
    }

    /// The depths of an image on its way, row 0 at the top. Waits for it if it has not arrived.
    ///
    /// # Errors
    /// An image of another format than `Depth32Float`; a lost device.
    pub fn finish_depth(&mut self, readback: &Readback) -> Result<Vec<f32>> {
        if readback.format != wgpu::TextureFormat::Depth32Float {
            return invalid!(
                "a depth of format {:?}; Depth32Float can be read",
                readback.format
            );
        }
        Ok(bytemuck::pod_collect_to_vec(&self.finish(readback)?))
    }

    /// The 32-bit words of an image on its way, row 0 at the top.
    pub(super) fn finish_words(&mut self, readback: &Readback) -> Result<Vec<u32>> {
        Ok(bytemuck::pod_collect_to_vec(&self.finish(readback)?))
    }

    /// The texels, rows packed.
    fn finish(&mut self, readback: &Readback) -> Result<Vec<u8>> {
        if !self.poll_read(readback)? {
            self.renderer.wait()?;
            if !self.poll_read(readback)? {
                return Err(Error::Internal(
                    "an image has not arrived after all work was done".into(),
                ));
            }
        }
        let mapped = readback
            .buffer
            .get_mapped_range(..)
            .map_err(|error| Error::DeviceLost(error.to_string()))?;
        let (row, stride) = (readback.row as usize, readback.stride as usize);
        let mut bytes = Vec::with_capacity(row * readback.height as usize);
        mapped
            .chunks_exact(stride)
            .for_each(|line| bytes.extend_from_slice(&line[..row]));
        Ok(bytes)
    }
}
