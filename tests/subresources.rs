//! Layers and mip levels of a host's textures as targets.

use pelage::glam::{DVec3, Vec3, Vec4};
use pelage::groom::{BuiltinGroom, builtin};
use pelage::{Error, Frame, Light, Outputs, Subresource, Subresources, Target, View, wgpu};

use crate::common::images::FORMAT;
use crate::common::{Device, device};

const SIDE: u32 = 48;
/// Of the opaque scene: it hides a part of the hair.
const DEPTH: f32 = 0.905;
const COVERAGE: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

fn texture(
    device: &Device,
    format: wgpu::TextureFormat,
    side: u32,
    layers: u32,
    mip_levels: u32,
) -> wgpu::Texture {
    let device = device.renderer.device();
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("test.target"),
        size: wgpu::Extent3d {
            width: side,
            height: side,
            depth_or_array_layers: layers,
        },
        mip_level_count: mip_levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC
            | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

/// Copies `SIDE` × `SIDE` texels of a subresource into a texture of its own, or back.
fn copy(device: &Device, own: &wgpu::Texture, other: &wgpu::Texture, at: Subresource, out: bool) {
    let part = wgpu::TexelCopyTextureInfo {
        texture: other,
        mip_level: at.mip_level,
        origin: wgpu::Origin3d {
            z: at.layer,
            ..Default::default()
        },
        aspect: wgpu::TextureAspect::All,
    };
    let (from, to) = if out {
        (part, own.as_image_copy())
    } else {
        (own.as_image_copy(), part)
    };
    let (gpu, queue) = (device.renderer.device(), device.renderer.queue());
    let mut encoder = gpu.create_command_encoder(&Default::default());
    encoder.copy_texture_to_texture(from, to, own.size());
    queue.submit([encoder.finish()]);
}

/// The texels of a subresource.
fn read(device: &mut Device, texture: &wgpu::Texture, at: Subresource) -> Vec<Vec4> {
    let own = self::texture(device, FORMAT, SIDE, 1, 1);
    copy(device, &own, texture, at, true);
    device.read_colour(&own).unwrap()
}

fn floats(device: &mut Device, texture: &wgpu::Texture, at: Subresource) -> Vec<u32> {
    let own = self::texture(device, COVERAGE, SIDE, 1, 1);
    copy(device, &own, texture, at, true);
    device.read_words(&own).unwrap()
}

fn view(eye: f64) -> View {
    let eye = DVec3::new(0.6 + eye, 0.15, -0.75);
    View::perspective(
        eye,
        DVec3::new(0.0, -0.06, 0.0),
        DVec3::Y,
        0.5,
        1.0,
        [0.1, 10.0],
    )
    .unwrap()
}

fn at(layer: u32, mip_level: u32) -> Subresource {
    Subresource { layer, mip_level }
}

#[test]
fn both_eyes_drawn_into_layers_are_those_drawn_into_images_of_their_own() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Wavy, 500).unwrap();
    let hair = device.renderer.create_hair(&strands).unwrap();
    let (hairs, lights) = (
        [&hair],
        [Light::directional(
            DVec3::new(-0.9, -0.8, 0.2),
            Vec3::splat(2.0),
        )],
    );
    let frame = |eye: usize| Frame {
        hairs: &hairs,
        lights: &lights,
        ambient: Vec3::splat(0.05),
        view: view(0.08 * eye as f64),
        transparency: None,
    };
    let scene = texture(&device, wgpu::TextureFormat::Depth32Float, SIDE, 1, 1);
    let depths = vec![DEPTH; (SIDE * SIDE) as usize];
    device.write_depth(&scene, &depths).unwrap();

    let mut alone = Vec::new();
    for eye in 0..2 {
        let image = device.create_image(SIDE, SIDE, FORMAT, true).unwrap();
        let coverage = texture(&device, COVERAGE, SIDE, 1, 1);
        let depth = image.depth.as_ref().unwrap();
        copy(&device, &scene, depth, at(0, 0), false);
        let target = Target {
            depth: Some(depth),
            write_depth: true,
            outputs: Outputs {
                coverage: Some(&coverage),
                ..Default::default()
            },
            ..Target::cleared(&image.colour)
        };
        device.render(&frame(eye), &target).unwrap();
        alone.push((
            device.read_colour(&image.colour).unwrap(),
            device.read_depth(depth).unwrap(),
            floats(&mut device, &coverage, at(0, 0)),
        ));
    }
    assert!(alone[0].0 != alone[1].0);
    assert!(alone[0].1.iter().filter(|depth| **depth < DEPTH).count() > 50);

    // Colour at mip level 1; the coverages of both eyes in one image.
    let colour = texture(&device, FORMAT, 2 * SIDE + 1, 3, 2);
    let depth = texture(&device, wgpu::TextureFormat::Depth32Float, SIDE, 2, 1);
    let coverage = texture(&device, COVERAGE, SIDE, 2, 1);
    let untouched = texture(&device, FORMAT, SIDE, 1, 1);
    let own = vec![Vec4::splat(0.75); (SIDE * SIDE) as usize];
    device.write_colour(&untouched, &own).unwrap();
    copy(&device, &untouched, &colour, at(1, 1), false);
    let places = [(at(2, 1), at(1, 0)), (at(0, 1), at(0, 0))];
    let mut encoder = device
        .renderer
        .device()
        .create_command_encoder(&Default::default());
    for (_, place) in places {
        copy(&device, &scene, &depth, place, false);
    }
    for (eye, (place, other)) in places.into_iter().enumerate() {
        let target = Target {
            depth: Some(&depth),
            write_depth: true,
            outputs: Outputs {
                coverage: Some(&coverage),
                ..Default::default()
            },
            subresources: Subresources {
                colour: place,
                depth: other,
                coverage: other,
                ..Default::default()
            },
            ..Target::cleared(&colour)
        };
        device
            .renderer
            .record(&mut encoder, &frame(eye), &target)
            .unwrap();
    }
    device.renderer.queue().submit([encoder.finish()]);
    for ((place, other), (colours, depths, coverages)) in places.into_iter().zip(&alone) {
        assert!(read(&mut device, &colour, place) == *colours);
        assert!(floats(&mut device, &coverage, other) == *coverages);
        let own = device.create_image(SIDE, SIDE, FORMAT, true).unwrap();
        let own = own.depth.unwrap();
        copy(&device, &own, &depth, other, true);
        assert!(device.read_depth(&own).unwrap() == *depths);
    }
    assert!(read(&mut device, &colour, at(1, 1)) == own);
}

#[test]
fn a_layer_or_a_mip_level_that_is_not_there_is_named() {
    let Some(mut device) = device() else { return };
    let colour = texture(&device, FORMAT, SIDE, 3, 2);
    let coverage = texture(&device, COVERAGE, SIDE / 2, 1, 1);
    let frame = Frame {
        hairs: &[],
        lights: &[],
        ambient: Vec3::ZERO,
        view: view(0.0),
        transparency: None,
    };
    for (named, colour_at, coverage_at) in [
        ("colour: layer 3 of an image of 3", at(3, 0), at(0, 0)),
        ("colour: mip level 2 of an image of 2", at(0, 2), at(0, 0)),
        ("coverage: layer 1 of an image of 1", at(2, 1), at(1, 0)),
        ("coverage is 24×24, its colour 48×48", at(2, 0), at(0, 0)),
    ] {
        let target = Target {
            outputs: Outputs {
                coverage: Some(&coverage),
                ..Default::default()
            },
            subresources: Subresources {
                colour: colour_at,
                coverage: coverage_at,
                ..Default::default()
            },
            ..Target::cleared(&colour)
        };
        let refused = device.render(&frame, &target).map(|_| ());
        assert!(
            matches!(&refused, Err(Error::InvalidValue(m)) if m.contains(named)),
            "{named}: {refused:?}"
        );
    }
}
