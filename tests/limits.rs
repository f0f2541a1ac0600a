//! Devices that have no more than what the library needs, and devices that have less.

use pelage::glam::{DVec3, Vec3, Vec4};
use pelage::groom::{BuiltinGroom, builtin};
use pelage::host::offscreen::{Offscreen, WantedOutputs};
use pelage::raster::Raster;
use pelage::transparency::{
    DepthPeeling, KPlusBuffer, Opaque, RandomSubsets, Rest, SortedBlending, Storage, Transparency,
    WeightedBlended,
};
use pelage::wgpu::{self, Features, Limits};
use pelage::{Error, Frame, Light, Target};

use crate::common::device;
use crate::common::scenes::{a_buffer, portrait};

const SIZE: [u32; 2] = [41, 54];

/// What every driver allows that the library is made for.
pub fn least() -> Limits {
    Limits {
        max_bind_groups: 4,
        max_storage_buffers_per_shader_stage: 10,
        max_compute_invocations_per_workgroup: 256,
        max_compute_workgroup_size_x: 256,
        max_storage_buffer_binding_size: 128 << 20,
        max_buffer_size: 256 << 20,
        ..Limits::default()
    }
}

pub fn open(limits: Limits) -> (wgpu::Device, wgpu::Queue, wgpu::AdapterInfo) {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::VULKAN;
    descriptor.flags = wgpu::InstanceFlags::VALIDATION;
    let instance = wgpu::Instance::new(descriptor);
    let adapter =
        pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
            .unwrap();
    let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
        required_features: Features::empty(),
        required_limits: limits,
        ..Default::default()
    }))
    .unwrap();
    (device, queue, adapter.get_info())
}

/// A frame into half floats, which every device blends, with every output.
fn draw(offscreen: &mut Offscreen, transparency: Transparency) -> (Vec<Vec4>, Vec<u32>) {
    let strands = builtin(BuiltinGroom::Wavy, 300).unwrap();
    let mut hair = offscreen.renderer.create_hair(&strands).unwrap();
    hair.opacity = 0.5;
    let frame = Frame {
        hairs: &[&hair],
        lights: &[
            Light::directional(DVec3::new(-0.4, -0.7, -0.6), Vec3::ONE),
            Light::directional(DVec3::new(0.9, -0.1, -0.2), Vec3::splat(0.3)),
        ],
        ambient: Vec3::splat(0.1),
        view: portrait(SIZE),
        transparency: Some(transparency),
    };
    let format = wgpu::TextureFormat::Rgba16Float;
    let mut image = offscreen
        .create_image(SIZE[0], SIZE[1], format, true)
        .unwrap();
    let wanted = WantedOutputs {
        nearest_depth: true,
        coverage: true,
        motion: true,
        ids: true,
    };
    offscreen.add_outputs(&mut image, wanted).unwrap();
    let target = Target {
        depth: image.depth.as_ref(),
        write_depth: true,
        receive_shadow: true,
        outputs: image.outputs(),
        ..Target::cleared(&image.colour)
    };
    offscreen.render(&frame, &target).unwrap();
    let ids = offscreen
        .read_words(image.outputs.ids.as_ref().unwrap())
        .unwrap();
    (offscreen.read_colour(&image.colour).unwrap(), ids)
}

#[test]
fn a_device_without_anything_optional_draws_the_same() {
    let Some(mut rich) = device() else { return };
    let (device, queue, info) = open(least());
    assert!(device.features().is_empty());
    let mut poor = Offscreen::on(&device, &queue, info).unwrap();
    for transparency in [
        a_buffer(Storage::Counted, Raster::Walk),
        a_buffer(Storage::Lists, Raster::Ribbons),
        // By 64-bit atomics on the one, by 32-bit ones on the other.
        Transparency::KPlusBuffer(KPlusBuffer {
            rest: Rest::Merged,
            ..KPlusBuffer::default()
        }),
        Transparency::Opaque(Opaque {
            raster: Raster::Ribbons,
        }),
        Transparency::WeightedBlended(WeightedBlended::default()),
        Transparency::DepthPeeling(DepthPeeling::default()),
        Transparency::RandomSubsets(RandomSubsets::default()),
        Transparency::SortedBlending(SortedBlending::default()),
    ] {
        let (poor, rich) = (draw(&mut poor, transparency), draw(&mut rich, transparency));
        assert!(rich.0.iter().any(|pixel| pixel.w > 0.5));
        assert!(poor == rich, "{transparency:?}");
    }
}

#[test]
fn a_device_that_falls_short_is_refused_with_what_it_lacks() {
    if device().is_none() {
        return;
    }
    let cases: [(&str, Limits); 3] = [
        (
            "3 bind groups",
            Limits {
                max_bind_groups: 3,
                ..least()
            },
        ),
        (
            "9 storage buffers",
            Limits {
                max_storage_buffers_per_shader_stage: 9,
                ..least()
            },
        ),
        (
            "128 invocations",
            Limits {
                max_compute_invocations_per_workgroup: 128,
                max_compute_workgroup_size_x: 128,
                max_compute_workgroup_size_y: 128,
                ..least()
            },
        ),
    ];
    for (words, limits) in cases {
        let (device, queue, info) = open(limits);
        let Err(error) = Offscreen::on(&device, &queue, info) else {
            panic!("a device with {words} was taken");
        };
        assert!(
            matches!(error, Error::Unsupported(_)) && error.to_string().contains(words),
            "{error}, but {words} was expected"
        );
    }
}
