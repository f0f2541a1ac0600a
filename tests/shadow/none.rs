//! No shadow: every light reaches every fibre, and nothing is made for it.

use pelage::Frame;
use pelage::glam::{DVec3, Vec3};
use pelage::groom::{BuiltinGroom, builtin};

use crate::common::device;
use crate::common::images::render;
use crate::common::scenes::{portrait, unshadowed};

#[test]
fn without_shadows_no_map_is_held() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 100).unwrap();
    let hair = device.renderer.create_hair(&strands).unwrap();
    let hairs = [&hair];
    let size = [32, 42];
    let lights = [unshadowed(DVec3::NEG_Z, Vec3::ONE)];
    let frame = Frame {
        hairs: &hairs,
        lights: &lights,
        ambient: Vec3::ZERO,
        view: portrait(size),
        transparency: None,
    };
    let (_, statistics) = render(&mut device, &frame, size);
    let maps = statistics
        .bytes
        .iter()
        .find(|(label, _)| label == "pelage.shadow.maps");
    assert!(maps.is_none_or(|(_, bytes)| *bytes <= 256), "{maps:?}");
}
