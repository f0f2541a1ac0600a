//! Images of the hair's shadow on the host's opaque scene, against rays in double precision.

use pelage::glam::{DVec3, Vec3, Vec4};
use pelage::groom::Strands;
use pelage::shadow::{DeepOpacityMap, Shadow};
use pelage::{Frame, Hair, Light, ShadowImage, Target, wgpu};
use pelage_reference::transmittance::{Light as Towards, Occluders, Query};

use crate::common::images::{FORMAT, write_depth};
use crate::common::scenes::{WHITE, camera, pixel_view, unshadowed, world};
use crate::common::{Device, device};

const SIZE: [u32; 2] = [64, 64];
const PIXELS: usize = (SIZE[0] * SIZE[1]) as usize;
/// Where the wall stands, behind the hair.
const WALL: f64 = -5.0;
/// A texel is an eighth of a pixel, a fibre five of them: what is left is the filter at the fibres' rims. Measured 0.021.
const RMSE: f64 = 0.03;

fn hair(device: &mut Device) -> Hair {
    let points: Vec<[f32; 3]> = (0..40)
        .flat_map(|i| {
            let (a, b) = ((i * 17 % 41) as f32 - 20.0, (i * 29 % 43) as f32 - 21.0);
            let z = (i % 7) as f32;
            [[-30.0, a, z], [30.0, b, z + 1.0]]
        })
        .collect();
    let strands = Strands::new(points, &[2; 40], 0.3).unwrap();
    let mut hair = device.renderer.create_hair(&strands).unwrap();
    (hair.shading, hair.opacity) = (WHITE, 0.7);
    hair
}

fn image(device: &Device, format: wgpu::TextureFormat) -> wgpu::Texture {
    device
        .renderer
        .device()
        .create_texture(&wgpu::TextureDescriptor {
            label: Some("test.shadow_image"),
            size: wgpu::Extent3d {
                width: SIZE[0],
                height: SIZE[1],
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        })
}

fn values(device: &mut Device, image: &wgpu::Texture) -> Vec<f64> {
    let words = device.read_words(image).unwrap();
    words
        .iter()
        .map(|word| f64::from(f32::from_bits(*word)))
        .collect()
}

#[test]
fn a_shadow_image_holds_the_transmittance_towards_its_light() {
    let Some(mut device) = device() else { return };
    let hair = hair(&mut device);
    let hairs = [&hair];
    let direction = DVec3::new(0.2, -0.1, -1.0);
    let map = DeepOpacityMap {
        layers: 16,
        ..Default::default()
    };
    let lights = [
        unshadowed(DVec3::NEG_Z, Vec3::ONE),
        Light {
            shadow: Some(Shadow::DeepOpacityMap(map)),
            ..Light::directional(direction, Vec3::ONE)
        },
    ];
    let frame = Frame {
        hairs: &hairs,
        lights: &lights,
        ambient: Vec3::ZERO,
        view: pixel_view(SIZE, 100.0),
        transparency: None,
    };
    let clip = camera(&frame.view, SIZE).clip_from_world * DVec3::new(0.0, 0.0, WALL).extend(1.0);
    // The upper rows have no wall.
    let sky = 8 * SIZE[0] as usize;
    let depths: Vec<f32> = (0..PIXELS)
        .map(|i| if i < sky { 1.0 } else { clip.z as f32 })
        .collect();
    let held = device.create_image(SIZE[0], SIZE[1], FORMAT, true).unwrap();
    write_depth(&device, held.depth.as_ref().unwrap(), &depths);
    let before = vec![Vec4::new(0.1, 0.2, 0.3, 0.4); PIXELS];
    device.write_colour(&held.colour, &before).unwrap();

    let images = [0, 1].map(|_| image(&device, wgpu::TextureFormat::R32Float));
    let coarse = image(&device, wgpu::TextureFormat::R8Unorm);
    let wanted = [(0, &images[0]), (1, &images[1]), (1, &coarse)];
    let wanted = wanted.map(|(light, image)| ShadowImage {
        light,
        image,
        subresource: Default::default(),
    });
    let target = Target {
        depth: held.depth.as_ref(),
        shadow_images: &wanted,
        shadows_only: true,
        ..Target::cleared(&held.colour)
    };
    let statistics = device.render(&frame, &target).unwrap();
    assert_eq!(statistics.fragments.produced, 0);
    assert!(
        device.read_colour(&held.colour).unwrap() == before,
        "the colour was touched"
    );
    let [unshadowed, alone] = images.each_ref().map(|image| values(&mut device, image));
    assert!(unshadowed.iter().all(|value| *value == 1.0));

    let world = world(&hairs);
    let query = Query {
        light: Towards::Directional {
            towards: -direction,
        },
        alpha: f64::from(hair.opacity),
        footprint: 0.125 / std::f64::consts::PI.sqrt(),
        samples: 16,
    };
    let point = |i: usize| {
        let [x, y] = [i % SIZE[0] as usize, i / SIZE[0] as usize].map(|at| at as f64 + 0.5);
        (DVec3::new(x - 32.0, 32.0 - y, WALL), None)
    };
    let points: Vec<_> = (sky..PIXELS).map(point).collect();
    let exact = Occluders::new(&world.strands).transmittances(&points, &query);
    let squares = exact
        .iter()
        .zip(&alone[sky..])
        .map(|(a, b)| (a - b).powi(2));
    let rmse = (squares.sum::<f64>() / exact.len() as f64).sqrt();
    let mean = exact.iter().sum::<f64>() / exact.len() as f64;
    eprintln!("shadow image: RMSE {rmse:.4}, mean of the exact {mean:.4}");
    assert!(mean < 0.85 && alone[..sky].iter().all(|value| *value == 1.0));
    assert!(rmse < RMSE, "{rmse}");

    // Together with the hair it is the same.
    let target = Target {
        shadows_only: false,
        ..target
    };
    let statistics = device.render(&frame, &target).unwrap();
    assert!(statistics.fragments.produced > 0);
    assert!(values(&mut device, &images[1]) == alone);
    // Without hair it is all lit.
    let frame = Frame {
        hairs: &[],
        ..frame
    };
    device.render(&frame, &target).unwrap();
    assert!(
        values(&mut device, &images[1])
            .iter()
            .all(|value| *value == 1.0)
    );
}

#[test]
fn shadow_images_that_do_not_fit_are_named() {
    let Some(mut device) = device() else { return };
    let lights = [unshadowed(DVec3::NEG_Z, Vec3::ONE)];
    let frame = Frame {
        hairs: &[],
        lights: &lights,
        ambient: Vec3::ZERO,
        view: pixel_view(SIZE, 100.0),
        transparency: None,
    };
    let held = device.create_image(SIZE[0], SIZE[1], FORMAT, true).unwrap();
    let good = image(&device, wgpu::TextureFormat::R32Float);
    let odd = image(&device, wgpu::TextureFormat::Rg32Float);
    for (light, image, with_depth, named) in [
        (1, &good, true, "light 1 of a frame of 1 lights"),
        (0, &odd, true, "has the format Rg32Float"),
        (0, &good, false, "shadow images need a depth"),
    ] {
        let wanted = [ShadowImage {
            light,
            image,
            subresource: Default::default(),
        }];
        let target = Target {
            depth: held.depth.as_ref().filter(|_| with_depth),
            shadow_images: &wanted,
            ..Target::cleared(&held.colour)
        };
        let error = device.render(&frame, &target).unwrap_err().to_string();
        assert!(error.contains(named), "{error}");
    }
}
