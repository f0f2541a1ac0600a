//! The `wgpu_host` example: a host's own wgpu device, and its picture against the library's own.

#[allow(dead_code)]
#[path = "../examples/wgpu_host.rs"]
mod host;

use host::{AMBIENT, COLOUR, Host, SIZE, light, view};
use pelage::glam::Vec4;
use pelage::groom::{BuiltinGroom, builtin};
use pelage::{Frame, Target};

use crate::common;

const STRANDS: usize = 2_000;
/// Of either device's colour: both run the same commands on the same driver.
const TOLERANCE: f32 = 1e-4;

/// The host's colour as floats.
fn colour(host: &Host) -> Vec<Vec4> {
    let bytes = host.read(&host.colour, 8).unwrap();
    let halves = bytemuck::pod_collect_to_vec::<u8, u16>(&bytes);
    let float = |bits: &u16| half::f16::from_bits(*bits).to_f32();
    halves
        .chunks_exact(4)
        .map(|texel| Vec4::from_array(std::array::from_fn(|at| float(&texel[at]))))
        .collect()
}

fn depth(host: &Host) -> Vec<f32> {
    bytemuck::pod_collect_to_vec(&host.read(&host.depth, 4).unwrap())
}

fn furthest(a: &[Vec4], b: &[Vec4]) -> f32 {
    assert_eq!(a.len(), b.len());
    let difference = |(a, b): (&Vec4, &Vec4)| (*a - *b).abs().max_element();
    a.iter().zip(b).map(difference).fold(0.0, f32::max)
}

#[test]
fn hair_between_a_hosts_own_passes_is_the_librarys_own_picture() {
    // Its log hears what the validation layer has to say of the host's device too.
    let Some(mut device) = common::device() else {
        return;
    };
    let mut host = Host::new().unwrap();
    host.frame(&[]).unwrap();
    let (opaque, opaque_depth) = (colour(&host), depth(&host));
    let hair = host.hair(STRANDS).unwrap();
    host.frame(&[&hair]).unwrap();
    let (drawn, drawn_depth) = (colour(&host), depth(&host));

    let image = device.create_image(SIZE[0], SIZE[1], COLOUR, true).unwrap();
    let target_depth = image.depth.as_ref().unwrap();
    device.write_colour(&image.colour, &opaque).unwrap();
    device.write_depth(target_depth, &opaque_depth).unwrap();
    let strands = builtin(BuiltinGroom::Wavy, STRANDS).unwrap();
    let hair = device.renderer.create_hair(&strands).unwrap();
    let frame = Frame {
        hairs: &[&hair],
        lights: &[light()],
        ambient: AMBIENT,
        view: view().unwrap(),
        transparency: None,
    };
    let target = Target {
        depth: Some(target_depth),
        clear: false,
        write_depth: true,
        receive_shadow: true,
        ..Target::cleared(&image.colour)
    };
    device.render(&frame, &target).unwrap();
    let expected = device.read_colour(&image.colour).unwrap();
    let expected_depth = device.read_depth(target_depth).unwrap();

    let error = furthest(&drawn, &expected);
    let depths = drawn_depth.iter().zip(&expected_depth);
    let depth_error = depths.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    eprintln!("colour is off by {error:e}, depth by {depth_error:e}");
    assert!(error <= TOLERANCE && depth_error <= TOLERANCE);

    // The picture shows a head, hair before it, and a head that hides hair.
    let count =
        |differs: &dyn Fn(usize) -> bool| (0..opaque.len()).filter(|at| differs(*at)).count();
    let head = count(&|at| opaque_depth[at] < 1.0);
    let changed = count(&|at| (drawn[at] - opaque[at]).abs().max_element() > 0.02);
    let bare = count(&|at| opaque_depth[at] < 1.0 && drawn[at] == opaque[at]);
    assert!(
        head > 20_000 && changed > 20_000 && bare > 1_000,
        "{head}, {changed}, {bare}"
    );
}

#[test]
fn the_example_has_its_passes_in_order() {
    let Some(_device) = common::device() else {
        return;
    };
    let mut host = Host::new().unwrap();
    let hair = host.hair(STRANDS).unwrap();
    host.frame(&[&hair]).unwrap();
    // What the last pass shows is made of what the hair was drawn into.
    let shown = host.read(&host.shown, 4).unwrap();
    let curve = |radiance: f32| {
        let v = f64::from(1.0 - (-1.5 * radiance).exp());
        let encoded = if v <= 0.0031308 {
            12.92 * v
        } else {
            1.055 * v.powf(1.0 / 2.4) - 0.055
        };
        255.0 * encoded
    };
    for (pixel, radiance) in shown.chunks_exact(4).zip(colour(&host)) {
        for channel in 0..3 {
            let difference = f64::from(pixel[channel]) - curve(radiance[channel]);
            assert!(difference.abs() <= 1.5, "{pixel:?} for {radiance}");
        }
    }
}
