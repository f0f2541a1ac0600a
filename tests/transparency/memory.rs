//! What a frame says of its memory before it is recorded, against what is then held.

use pelage::glam::{DMat4, DVec3, Vec3};
use pelage::groom::{BuiltinGroom, builtin};
use pelage::host::offscreen::WantedOutputs;
use pelage::raster::Raster;
use pelage::shading::{Marschner, Shading, ShadingRate};
use pelage::shadow::{
    ApproximatedDeepShadowMap, DeepOpacityMap, KBufferVolume, MomentOpacityMap, OpacityShadowMaps,
    Shadow, ShadowMap,
};
use pelage::transparency::{ABuffer, KBuffer, Storage, Transparency, a_buffer as sizes};
use pelage::{
    Error, Frame, Hair, Light, LightKind, Occluder, ShadowImage, Subresource, Target, Viewport,
    wgpu,
};

use super::every_technique::cases;
use crate::common::images::FORMAT;
use crate::common::scenes::{portrait, unshadowed};
use crate::common::{Device, device};

fn wavy(device: &mut Device, strands: usize) -> Hair {
    let strands = builtin(BuiltinGroom::Wavy, strands).unwrap();
    let foreseen = device.renderer.hair_memory_estimate(&strands).unwrap();
    let before = device.renderer.statistics().bytes_total;
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    let taken = device.renderer.statistics().bytes_total - before;
    assert_eq!(foreseen, taken, "the groom's own bytes");
    hair.opacity = 0.5;
    hair
}

/// Draws a frame, and holds every label's bytes to what was said of it before.
fn assert_foreseen(device: &mut Device, name: &str, frame: &Frame, target: &Target) {
    let held = device.renderer.statistics().bytes_total;
    let estimate = device
        .renderer
        .memory_estimate(frame, &target.into())
        .unwrap();
    assert_eq!(
        device.renderer.statistics().bytes_total,
        held,
        "{name}: saying so took memory"
    );
    let statistics = device.render(frame, target).unwrap();
    assert_eq!(estimate.bytes, statistics.bytes, "{name}");
    assert_eq!(estimate.total, statistics.bytes_total, "{name}");
    // An image of another format may give way to a smaller one.
    let added = statistics.bytes_total.saturating_sub(held);
    assert_eq!(estimate.added, added, "{name}");
}

#[test]
fn every_technique_states_its_bytes_before_the_frame() {
    let Some(mut device) = device() else { return };
    let hair = wavy(&mut device, 300);
    let (hairs, lights) = ([&hair], [unshadowed(DVec3::NEG_Z, Vec3::ONE)]);
    let mut added = 0;
    for size in [[33, 44], [82, 108]] {
        let image = device
            .create_image(size[0], size[1], FORMAT, false)
            .unwrap();
        for case in cases() {
            let frame = Frame {
                hairs: &hairs,
                lights: &lights,
                ambient: Vec3::ZERO,
                view: portrait(size),
                transparency: Some(case.technique),
            };
            let target = Target::cleared(&image.colour);
            let viewport = Viewport::from(&target);
            let estimate = device.renderer.memory_estimate(&frame, &viewport).unwrap();
            added += estimate.added;
            assert!(estimate.of("pelage.transparency.") > 0, "{}", case.name);
            assert_foreseen(&mut device, case.name, &frame, &target);
        }
    }
    assert!(added > 0, "nothing ever grew");
}

#[test]
fn pools_of_a_stated_size_and_of_what_a_budget_leaves_are_foreseen() {
    let Some(mut device) = device() else { return };
    let hair = wavy(&mut device, 300);
    let (hairs, lights) = ([&hair], [unshadowed(DVec3::NEG_Z, Vec3::ONE)]);
    let size = [82, 108];
    let image = device
        .create_image(size[0], size[1], FORMAT, false)
        .unwrap();
    let target = Target::cleared(&image.colour);
    for storage in [Storage::Counted, Storage::Lists] {
        for pool_bytes in [Some(16), Some(1000 * sizes::NODE_BYTES), None] {
            let settings = ABuffer {
                storage,
                raster: Raster::Ribbons,
                pool_bytes,
            };
            let frame = Frame {
                hairs: &hairs,
                lights: &lights,
                ambient: Vec3::ZERO,
                view: portrait(size),
                transparency: Some(Transparency::ABuffer(settings)),
            };
            if pool_bytes.is_none() {
                let held = device.renderer.statistics().bytes_total;
                device.renderer.set_byte_budget(Some(held + (1 << 20)));
            }
            let name = format!("{storage:?}, pool {pool_bytes:?}");
            assert_foreseen(&mut device, &name, &frame, &target);
            device.renderer.set_byte_budget(None);
        }
    }
}

#[test]
fn shadows_tables_outputs_and_fragment_shading_are_foreseen() {
    let Some(mut device) = device() else { return };
    let mut hair = wavy(&mut device, 300);
    let size = [41, 54];
    let mut image = device.create_image(size[0], size[1], FORMAT, true).unwrap();
    let wanted = WantedOutputs {
        nearest_depth: true,
        coverage: true,
        motion: true,
        ids: true,
    };
    device.add_outputs(&mut image, wanted).unwrap();
    let plain = Target::cleared(&image.colour);
    let full = Target {
        depth: image.depth.as_ref(),
        write_depth: true,
        outputs: image.outputs(),
        ..plain
    };
    let map = |resolution, raster| {
        Some(Shadow::DeepOpacityMap(DeepOpacityMap {
            resolution,
            raster,
            ..Default::default()
        }))
    };
    let sun = |shadow| Light {
        shadow,
        ..Light::directional(DVec3::NEG_Y, Vec3::ONE)
    };
    let lamp = Light {
        kind: LightKind::Point {
            position: DVec3::new(0.0, 0.1, 0.0),
            intensity: Vec3::ONE,
        },
        shadow: map(64, Raster::Walk),
    };
    let lights = [
        vec![sun(Some(Shadow::None))],
        vec![sun(map(128, Raster::Walk))],
        vec![sun(map(256, Raster::Ribbons)), lamp],
    ];
    for shading in [Shading::default(), Shading::Marschner(Marschner::default())] {
        hair.shading = shading;
        for rate in [ShadingRate::Point, ShadingRate::Fragment] {
            hair.shading_rate = rate;
            for (number, lights) in lights.iter().enumerate() {
                for target in [plain, full] {
                    let hairs = [&hair];
                    let frame = Frame {
                        hairs: &hairs,
                        lights,
                        ambient: Vec3::splat(0.1),
                        view: portrait(size),
                        transparency: Some(Transparency::KBuffer(KBuffer::default())),
                    };
                    let name = format!("{}, {rate:?}, lights {number}", shading.stem());
                    assert_foreseen(&mut device, &name, &frame, &target);
                }
            }
        }
    }
}

/// The host's own images, which are none of the renderer's memory.
fn host_image(device: &Device, format: wgpu::TextureFormat, size: [u32; 2]) -> wgpu::Texture {
    let descriptor = wgpu::TextureDescriptor {
        label: Some("test.host_image"),
        size: wgpu::Extent3d {
            width: size[0],
            height: size[1],
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    };
    device.renderer.device().create_texture(&descriptor)
}

#[test]
fn occluders_shadow_images_and_received_shadows_are_foreseen() {
    let Some(mut device) = device() else { return };
    let hair = wavy(&mut device, 300);
    let hairs = [&hair];
    let lights = [Light::directional(DVec3::NEG_Y, Vec3::ONE)];
    let size = [41, 54];
    let frame = Frame {
        hairs: &hairs,
        lights: &lights,
        ambient: Vec3::ZERO,
        view: portrait(size),
        transparency: None,
    };
    let image = device.create_image(size[0], size[1], FORMAT, true).unwrap();
    let scene = host_image(&device, wgpu::TextureFormat::Depth32Float, [64, 64]);
    let occluders = [Occluder {
        light: 0,
        depth: &scene,
        subresource: Subresource::default(),
        clip_from_world: DMat4::IDENTITY,
        reverse_z: false,
        flip_y: false,
        bias: 0.0,
        pcf: 3,
    }];
    let shadow = host_image(&device, wgpu::TextureFormat::R8Unorm, size);
    let shadow_images = [ShadowImage {
        light: 0,
        image: &shadow,
        subresource: Subresource::default(),
    }];
    let plain = Target {
        depth: image.depth.as_ref(),
        ..Target::cleared(&image.colour)
    };
    let images = Target {
        shadow_images: &shadow_images,
        ..plain
    };
    let alone = Target {
        shadows_only: true,
        ..images
    };
    // First, as long as there are no pixels' buffers: images alone need none, and what follows does.
    let of = |device: &mut Device, target: &Target| {
        let estimate = device.renderer.memory_estimate(&frame, &target.into());
        estimate.unwrap()
    };
    let [few, all] = [&alone, &images].map(|target| of(&mut device, target));
    let prefix = "pelage.transparency.";
    assert!(few.total < all.total && few.of(prefix) < all.of(prefix));
    assert_eq!(of(&mut device, &plain), all, "images take nothing more");
    assert_foreseen(&mut device, "shadow images alone", &frame, &alone);
    assert_foreseen(&mut device, "shadow images", &frame, &images);
    let full = Target {
        occluders: &occluders,
        receive_shadow: true,
        ..images
    };
    assert_foreseen(
        &mut device,
        "occluders and a received shadow",
        &frame,
        &full,
    );
}

#[test]
fn every_shadow_technique_states_its_bytes_before_the_frame() {
    let Some(mut device) = device() else { return };
    let hair = wavy(&mut device, 300);
    let hairs = [&hair];
    let size = [41, 54];
    let image = device
        .create_image(size[0], size[1], FORMAT, false)
        .unwrap();
    for shadow in [
        Shadow::None,
        Shadow::DeepOpacityMap(DeepOpacityMap::default()),
        Shadow::ShadowMap(ShadowMap::default()),
        Shadow::ApproximatedDeepShadowMap(ApproximatedDeepShadowMap::default()),
        Shadow::OpacityShadowMaps(OpacityShadowMaps::default()),
        Shadow::MomentOpacityMap(MomentOpacityMap::default()),
        Shadow::KBufferVolume(KBufferVolume::default()),
    ] {
        let lights = [Light {
            shadow: Some(shadow),
            ..Light::directional(DVec3::NEG_Y, Vec3::ONE)
        }];
        let frame = Frame {
            hairs: &hairs,
            lights: &lights,
            ambient: Vec3::ZERO,
            view: portrait(size),
            transparency: None,
        };
        let target = Target::cleared(&image.colour);
        assert_foreseen(&mut device, shadow.stem(), &frame, &target);
    }
}

#[test]
fn nothing_is_foreseen_of_a_frame_that_cannot_be_drawn() {
    let Some(mut device) = device() else { return };
    let hair = wavy(&mut device, 10);
    let (hairs, lights) = ([&hair], [unshadowed(DVec3::NEG_Z, Vec3::ONE)]);
    let frame = Frame {
        hairs: &hairs,
        lights: &lights,
        ambient: Vec3::ZERO,
        view: portrait([8, 8]),
        transparency: None,
    };
    let viewport = |width, height| Viewport {
        width,
        height,
        ..Default::default()
    };
    for (size, words) in [([0, 8], "0×8"), ([8, 1 << 30], "8×1073741824")] {
        let estimate = device
            .renderer
            .memory_estimate(&frame, &viewport(size[0], size[1]));
        let Err(error @ (Error::InvalidValue(_) | Error::Unsupported(_))) = estimate else {
            panic!("{size:?}: {estimate:?}");
        };
        assert!(error.to_string().contains(words), "{error}");
    }
    let nothing = Frame {
        hairs: &[],
        ..frame
    };
    let estimate = device.renderer.memory_estimate(&nothing, &viewport(8, 8));
    assert_eq!(estimate.unwrap().added, 0);
}
