//! Images: rendered, compared with the reference, and written to `target/test-failures` where they differ.

use pelage::glam::Vec4;
use pelage::{Frame, Statistics, Target, wgpu};
use pelage_reference::composite::Image;
use pelage_reference::error::{ImageError, alpha_error, colour_error};

use super::Device;

/// Full precision, so that the target's own rounding is no part of an error.
pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// Renders into a new image of full precision without an opaque scene.
pub fn render(device: &mut Device, frame: &Frame, size: [u32; 2]) -> (Image, Statistics) {
    let image = device
        .create_image(size[0], size[1], FORMAT, false)
        .unwrap();
    let statistics = device
        .render(frame, &Target::cleared(&image.colour))
        .unwrap();
    (read(device, &image.colour), statistics)
}

/// An image of the device as the reference holds it.
pub fn read(device: &mut Device, colour: &wgpu::Texture) -> Image {
    let pixels = device.read_colour(colour).unwrap();
    image(
        [colour.width(), colour.height()],
        pixels.iter().map(|p| p.to_array().map(f64::from)).collect(),
    )
}

/// Writes depths row by row with a render pass of the host's: a fragment shader over the whole target.
pub fn write_depth(device: &Device, depth: &wgpu::Texture, values: &[f32]) {
    let (gpu, queue) = (device.renderer.device(), device.renderer.queue());
    let source = "
        @group(0) @binding(0) var<storage, read> depths: array<f32>;
        @vertex fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
            return vec4f(vec2f(f32((i << 1u) & 2u), f32(i & 2u)) * 2.0 - 1.0, 0.0, 1.0);
        }
        @fragment fn fragment(@builtin(position) p: vec4f) -> @builtin(frag_depth) f32 {
            return depths[u32(p.y) * WIDTH + u32(p.x)];
        }";
    let source = format!("const WIDTH: u32 = {}u;\n{source}", depth.width());
    let module = gpu.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("test.depth"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let pipeline = gpu.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("test.depth"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: depth.format(),
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: Default::default(),
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    });
    let buffer = gpu.create_buffer(&wgpu::BufferDescriptor {
        label: Some("test.depth"),
        size: values.len() as u64 * 4,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    queue.write_buffer(&buffer, 0, bytemuck::cast_slice(values));
    let group = gpu.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("test.depth"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: buffer.as_entire_binding(),
        }],
    });
    let view = depth.create_view(&Default::default());
    let mut encoder = gpu.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("test.depth"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Load,
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }
    queue.submit([encoder.finish()]);
}

/// Pixels as an image of the reference.
pub fn image(size: [u32; 2], pixels: Vec<[f64; 4]>) -> Image {
    Image {
        width: size[0] as usize,
        height: size[1] as usize,
        pixels,
    }
}

/// An image's pixels as the device takes them.
pub fn pixels(image: &Image) -> Vec<Vec4> {
    image
        .pixels
        .iter()
        .map(|p| Vec4::from_array(p.map(|v| v as f32)))
        .collect()
}

/// What an image may be off by, over hair-covered pixels.
#[derive(Debug, Clone, Copy)]
pub struct Tolerance {
    pub rmse: f64,
    pub p99: f64,
}

/// Errors of colour and alpha; asserts that both, and what lies elsewhere, stay within the tolerance.
pub fn assert_close(
    name: &str,
    actual: &Image,
    expected: &Image,
    tolerance: Tolerance,
) -> [ImageError; 2] {
    let errors = [
        colour_error(actual, expected, None),
        alpha_error(actual, expected, None),
    ];
    eprintln!(
        "{name}: colour {:?}\n{name}: alpha {:?}",
        errors[0], errors[1]
    );
    if std::env::var_os("PELAGE_TEST_OUTLIERS").is_some() {
        for (i, (a, e)) in actual.pixels.iter().zip(&expected.pixels).enumerate() {
            let off = (0..4).map(|c| (a[c] - e[c]).abs()).fold(0.0, f64::max);
            if off > tolerance.p99 {
                eprintln!(
                    "{name}: pixel ({}, {}): {a:.5?}, expected {e:.5?}",
                    i % actual.width,
                    i / actual.width
                );
            }
        }
    }
    let fine = |error: &ImageError| {
        error.rmse <= tolerance.rmse
            && error.p99 <= tolerance.p99
            && error.max_elsewhere <= tolerance.p99
    };
    if !errors.iter().all(fine) {
        write_failure(name, actual, expected);
        panic!(
            "{name}: colour {:?}, alpha {:?}, allowed {tolerance:?}",
            errors[0], errors[1]
        );
    }
    errors
}

/// Asserts that two images are the same, bit for bit.
pub fn assert_identical(name: &str, actual: &Image, expected: &Image) {
    let differing = (0..expected.pixels.len())
        .filter(|&i| actual.pixels[i] != expected.pixels[i])
        .count();
    if differing > 0 {
        write_failure(name, actual, expected);
        panic!("{name}: {differing} pixels differ");
    }
}

/// Writes actual, expected and sixteenfold difference to `target/test-failures`, over grey, gamma 2.2.
pub fn write_failure(name: &str, actual: &Image, expected: &Image) {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/target/test-failures");
    std::fs::create_dir_all(folder).unwrap();
    let file = name.replace(|c: char| !c.is_alphanumeric() && c != '-', "_");
    let shown = |image: &Image| -> Vec<u8> {
        let grey = image.over([0.18; 3]);
        grey.pixels
            .iter()
            .flat_map(|p| [p[0], p[1], p[2]])
            .map(|v| (v.clamp(0.0, 1.0).powf(1.0 / 2.2) * 255.0) as u8)
            .collect()
    };
    let difference: Vec<u8> = actual
        .pixels
        .iter()
        .zip(&expected.pixels)
        .flat_map(|(a, e)| {
            let alpha = (a[3] - e[3]).abs();
            [0, 1, 2].map(|c| ((a[c] - e[c]).abs().max(alpha) * 16.0 * 255.0).min(255.0) as u8)
        })
        .collect();
    for (what, bytes) in [
        ("actual", shown(actual)),
        ("expected", shown(expected)),
        ("difference", difference),
    ] {
        let path = format!("{folder}/{file}-{what}.png");
        let mut encoder = png::Encoder::new(
            std::fs::File::create(&path).unwrap(),
            actual.width as u32,
            actual.height as u32,
        );
        encoder.set_color(png::ColorType::Rgb);
        encoder
            .write_header()
            .unwrap()
            .write_image_data(&bytes)
            .unwrap();
        eprintln!("written: {path}");
    }
}
