//! Scenes as the device draws them, and the same as the reference sees them.

use pelage::glam::{DMat4, DQuat, DVec3, DVec4, Vec3};
use pelage::groom::{Strands, tessellate};
use pelage::raster::Raster;
use pelage::shading::{KajiyaKay, Shading};
use pelage::shadow::Shadow;
use pelage::transparency::{ABuffer, Storage, Transparency};
use pelage::{Frame, Hair, Light, LightKind, View};
use pelage_reference::composite::{self, Image};
use pelage_reference::fragments::{FragmentLists, fragment_lists};
use pelage_reference::kajiya_kay;
use pelage_reference::project;
use pelage_reference::scene;

/// Both storages of the A-buffer by both rasterisers.
pub const A_BUFFERS: [(&str, Storage, Raster); 4] = [
    ("counted walk", Storage::Counted, Raster::Walk),
    ("counted ribbons", Storage::Counted, Raster::Ribbons),
    ("lists walk", Storage::Lists, Raster::Walk),
    ("lists ribbons", Storage::Lists, Raster::Ribbons),
];

/// The A-buffer with the pool that the library chooses.
pub fn a_buffer(storage: Storage, raster: Raster) -> Transparency {
    Transparency::ABuffer(ABuffer {
        storage,
        raster,
        pool_bytes: None,
    })
}

/// White diffuse fibres without a highlight: radiance = sin(t, l) × irradiance.
pub const WHITE: Shading = Shading::KajiyaKay(KajiyaKay {
    diffuse: Vec3::ONE,
    specular: Vec3::ZERO,
    exponent: 1.0,
});

/// A directional light that nothing shadows.
pub fn unshadowed(direction: DVec3, irradiance: Vec3) -> Light {
    Light {
        shadow: Some(Shadow::None),
        ..Light::directional(direction, irradiance)
    }
}

/// A warm one from above and the side that nothing shadows.
pub fn sunlight() -> Light {
    unshadowed(DVec3::new(-0.5, -0.6, -0.7), Vec3::new(2.0, 1.9, 1.7))
}

/// The built-in head from the front and above, filling a frame of 328×430.
pub fn portrait(size: [u32; 2]) -> View {
    let (eye, target) = (DVec3::new(0.1, 0.12, 0.95), DVec3::new(0.0, -0.03, 0.0));
    View::perspective(
        eye,
        target,
        DVec3::Y,
        0.6,
        f64::from(size[0]) / f64::from(size[1]),
        [0.1, 10.0],
    )
    .unwrap()
}

/// An orthographic view down -z in which a unit is a pixel: x to the right, y up, the origin in the image's middle;
/// z from -depth to depth.
pub fn pixel_view(size: [u32; 2], depth: f64) -> View {
    let scale = DVec3::new(
        2.0 / f64::from(size[0]),
        2.0 / f64::from(size[1]),
        -0.5 / depth,
    );
    View {
        view_from_world: DMat4::from_translation(DVec3::new(0.0, 0.0, -depth)),
        clip_from_view: DMat4::from_scale_rotation_translation(scale, DQuat::IDENTITY, DVec3::ZERO),
        reverse_z: false,
        flip_y: false,
        jitter: [0.0; 2],
        previous: None,
    }
}

/// The same view with depth reversed.
pub fn reversed(view: &View) -> View {
    let flip = DMat4::from_cols(
        DVec4::X,
        DVec4::Y,
        DVec4::new(0.0, 0.0, -1.0, 0.0),
        DVec4::new(0.0, 0.0, 1.0, 1.0),
    );
    View {
        clip_from_view: flip * view.clip_from_view,
        reverse_z: true,
        ..*view
    }
}

/// The strands of several hairs as the reference sees them: cut as the library cuts them, in world space.
pub struct World {
    pub strands: scene::Strands,
    /// Hair and strand of the hair, of every strand.
    pub sources: Vec<(usize, usize)>,
}

pub fn world(hairs: &[&Hair]) -> World {
    let mut strands = scene::Strands {
        offsets: vec![0],
        ..Default::default()
    };
    let mut sources = Vec::new();
    for (number, hair) in hairs.iter().enumerate() {
        let drawn = drawn_strands(hair.strands());
        let scale = hair.world_from_object.determinant().abs().cbrt();
        for strand in 0..drawn.strand_count() {
            for at in drawn.range(strand) {
                let point = Vec3::from(drawn.points()[at]).as_dvec3();
                strands
                    .points
                    .push(hair.world_from_object.transform_point3(point));
                strands.radii.push(f64::from(drawn.radii()[at]) * scale);
            }
            strands.offsets.push(strands.points.len());
            sources.push((number, strand));
        }
    }
    World { strands, sources }
}

fn drawn_strands(strands: &Strands) -> Strands {
    tessellate(strands, pelage::testing::curve_pieces(strands)).unwrap()
}

/// The reference's camera of a view. Reversed depth is turned back.
pub fn camera(view: &View, size: [u32; 2]) -> scene::Camera {
    let view = if view.reverse_z {
        reversed(view)
    } else {
        *view
    };
    let world_from_view = view.view_from_world.inverse();
    let perspective = view.clip_from_view.row(3).truncate().length() > 0.0;
    let eye = if perspective {
        world_from_view.w_axis.truncate().extend(1.0)
    } else {
        world_from_view.z_axis.truncate().normalize().extend(0.0)
    };
    scene::Camera {
        clip_from_world: view.clip_from_view * view.view_from_world,
        eye,
        width: size[0] as usize,
        height: size[1] as usize,
    }
}

/// The reference's fragments of a frame.
pub fn lists(frame: &Frame, size: [u32; 2], host_depth: Option<&[f32]>) -> FragmentLists {
    fragment_lists(
        &world(frame.hairs).strands,
        &camera(&frame.view, size),
        host_depth,
    )
}

/// Unit tangents of all strands; where there is no length, +y.
pub fn curve_tangents(strands: &scene::Strands) -> Vec<DVec3> {
    (0..strands.len())
        .flat_map(|strand| project::curve_tangents(&strands.points[strands.range(strand)]))
        .map(|tangent| tangent.unwrap_or(DVec3::Y))
        .collect()
}

/// Direction to a light and the irradiance that it throws on a point.
fn reaching(light: &Light, point: DVec3) -> (DVec3, Vec3) {
    match light.kind {
        LightKind::Directional {
            direction,
            irradiance,
        } => (-direction, irradiance),
        LightKind::Point {
            position,
            intensity,
        } => {
            let way = position - point;
            (way, intensity / way.length_squared() as f32)
        }
        LightKind::Spot {
            position,
            direction,
            intensity,
            inner_angle,
            outer_angle,
        } => {
            let way = position - point;
            let cos = -way.normalize().dot(direction.normalize());
            let [inner, outer] = [inner_angle, outer_angle].map(|angle| f64::from(angle).cos());
            let t = ((cos - outer) / (inner - outer)).clamp(0.0, 1.0);
            let lit = t * t * (3.0 - 2.0 * t) / way.length_squared();
            (way, intensity * lit as f32)
        }
    }
}

/// The radiance of every point of the frame's strands towards the eye, in f64: Kajiya-Kay under all lights, without
/// shadows or ambient light.
pub fn point_radiance(frame: &Frame) -> Vec<[f64; 3]> {
    let world = world(frame.hairs);
    let tangents = curve_tangents(&world.strands);
    let eye = camera(&frame.view, [1, 1]).eye;
    let mut radiance = Vec::with_capacity(tangents.len());
    for (strand, &(hair, own)) in world.sources.iter().enumerate() {
        let hair = frame.hairs[hair];
        let Shading::KajiyaKay(model) = hair.shading else {
            panic!("another model")
        };
        let colour = hair.strands().colours()[own];
        for at in world.strands.range(strand) {
            let point = world.strands.points[at];
            let to_eye = eye.truncate() - point * eye.w;
            radiance.push(std::array::from_fn(|channel| {
                let channel_model = kajiya_kay::KajiyaKay {
                    diffuse: f64::from(model.diffuse[channel]) * f64::from(colour[channel]),
                    specular: f64::from(model.specular[channel]),
                    exponent: f64::from(model.exponent),
                };
                let of_light = |light: &Light| {
                    let (to_light, irradiance) = reaching(light, point);
                    f64::from(irradiance[channel])
                        * kajiya_kay::scatter(tangents[at], to_light, to_eye, &channel_model)
                };
                frame.lights.iter().map(of_light).sum::<f64>()
            }));
        }
    }
    radiance
}

/// The exact composite of a frame. All its hairs have the same opacity.
pub fn reference(frame: &Frame, size: [u32; 2], host_depth: Option<&[f32]>) -> Image {
    let colours = point_radiance(frame);
    let opacity = f64::from(frame.hairs.first().map_or(1.0, |hair| hair.opacity));
    composite::composite(
        &lists(frame, size, host_depth),
        opacity,
        composite::point_colours(&colours),
    )
}
