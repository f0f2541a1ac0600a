//! Viewports whose buffers are larger than what a device binds.

use pelage::glam::{DVec3, Vec3};
use pelage::groom::Strands;
use pelage::host::offscreen::Offscreen;
use pelage::raster::Raster;
use pelage::transparency::{Culling, DbkBuffer, KPlusBuffer, Storage, Transparency};
use pelage::{Error, Frame, Hair, Target, wgpu};

use crate::common::device;
use crate::common::scenes::{WHITE, a_buffer, pixel_view, reference, unshadowed};
use crate::limits::{least, open};

const SIZE: [u32; 2] = [3840, 2160];
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Half floats step by 2⁻¹¹ below 1, and stored opacities are halves too.
const TOLERANCE: f64 = 2e-3;

/// Strands from one corner of the image towards the other, behind one another where they cross.
fn strands(offscreen: &mut Offscreen) -> Hair {
    let points = (0..10).flat_map(|i| {
        let (step, z) = (i as f32, 0.5 * i as f32);
        let turn = if i % 2 == 0 { 1.0 } else { -1.0 };
        [
            [-1900.0, turn * (-1060.0 + 40.0 * step), z],
            [1900.0, turn * (1060.0 - 60.0 * step), -z],
        ]
    });
    let strands = Strands::new(points.collect(), &[2; 10], 1.5).unwrap();
    let mut hair = offscreen.renderer.create_hair(&strands).unwrap();
    (hair.shading, hair.opacity) = (WHITE, 0.6);
    hair
}

#[test]
fn four_thousand_pixels_a_row_are_drawn_within_bindings_of_128_mib() {
    if device().is_none() {
        return;
    }
    let (device, queue, info) = open(least());
    let mut offscreen = Offscreen::on(&device, &queue, info).unwrap();
    let hair = strands(&mut offscreen);
    let hairs = [&hair];
    let lights = [unshadowed(DVec3::NEG_Z, Vec3::new(1.0, 0.7, 0.4))];
    let image = offscreen
        .create_image(SIZE[0], SIZE[1], FORMAT, false)
        .unwrap();
    let mut expected = None;
    // Counted arrays behind a cut-off, linked lists, and eight words a pixel, which take more than one binding.
    for technique in [
        Transparency::DbkBuffer(DbkBuffer {
            culling: Culling::Always,
            ..DbkBuffer::default()
        }),
        a_buffer(Storage::Lists, Raster::Walk),
        Transparency::KPlusBuffer(KPlusBuffer::default()),
    ] {
        let frame = Frame {
            hairs: &hairs,
            lights: &lights,
            ambient: Vec3::ZERO,
            view: pixel_view(SIZE, 20.0),
            transparency: Some(technique),
        };
        let expected = expected.get_or_insert_with(|| reference(&frame, SIZE, None));
        let target = Target::cleared(&image.colour);
        let estimate = offscreen
            .renderer
            .memory_estimate(&frame, &(&target).into())
            .unwrap();
        let statistics = offscreen.render(&frame, &target).unwrap();
        assert_eq!(
            estimate.total,
            statistics.bytes_total,
            "{}",
            technique.stem()
        );
        let pixels = offscreen.read_colour(&image.colour).unwrap();
        let mut covered = 0;
        for (at, (actual, expected)) in pixels.iter().zip(&expected.pixels).enumerate() {
            covered += usize::from(expected[3] > 0.0);
            for (a, e) in actual.to_array().into_iter().zip(expected) {
                let place = [at as u32 % SIZE[0], at as u32 / SIZE[0]];
                assert!(
                    (f64::from(a) - e).abs() < TOLERANCE,
                    "{}, {place:?}: {actual:?} where {expected:?} is exact",
                    technique.stem()
                );
            }
        }
        assert!(covered > 100_000, "{covered} pixels");
    }
}

#[test]
fn what_a_budget_does_not_hold_is_named_and_the_next_frame_is_drawn() {
    let Some(mut device) = device() else { return };
    let hair = strands(&mut device);
    let hairs = [&hair];
    let lights = [unshadowed(DVec3::NEG_Z, Vec3::ONE)];
    let frame = |size| Frame {
        hairs: &hairs,
        lights: &lights,
        ambient: Vec3::ZERO,
        view: pixel_view(size, 20.0),
        transparency: Some(Transparency::KPlusBuffer(KPlusBuffer::default())),
    };
    device.renderer.set_byte_budget(Some(64 << 20));
    let large = device
        .create_image(SIZE[0], SIZE[1], FORMAT, false)
        .unwrap();
    let drawn = device.render(&frame(SIZE), &Target::cleared(&large.colour));
    let Err(Error::OutOfMemory(message)) = drawn else {
        panic!("{drawn:?}");
    };
    assert!(
        message.contains("pelage.transparency.") && message.contains("budget"),
        "{message}"
    );
    let small = device.create_image(64, 64, FORMAT, false).unwrap();
    device
        .render(&frame([64, 64]), &Target::cleared(&small.colour))
        .unwrap();
}
