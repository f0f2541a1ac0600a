//! Shading at points and at fragments, against the reference shaded at fragments.

use pelage::glam::{DMat4, DVec3, Vec3};
use pelage::groom::{BuiltinGroom, Strands, builtin};
use pelage::shading::{
    Chiang, DualScattering, KajiyaKay, Marschner, Precision, Roots, Sadeghi, Scheuermann, Shading,
    ShadingRate, Tables,
};
use pelage::transparency::{ABuffer, Culling, DbkBuffer, Opaque, Storage, Transparency};
use pelage::{Frame, Hair, Light, LightKind};
use pelage_reference::composite::{self, Image};
use pelage_reference::error::{alpha_error, colour_error};
use pelage_reference::fragments::Fragment;
use pelage_reference::kajiya_kay;

use crate::common::images::{assert_identical, render, write_failure};
use crate::common::scenes::{
    A_BUFFERS, a_buffer, camera, curve_tangents, lists, pixel_view, portrait, sunlight, unshadowed,
    world,
};
use crate::common::{Device, device};

const SIZE: [u32; 2] = [164, 215];

/// A highlight that turns within a segment.
const SHINY: KajiyaKay = KajiyaKay {
    diffuse: Vec3::new(0.2, 0.15, 0.1),
    specular: Vec3::splat(0.3),
    exponent: 60.0,
};

/// The radiance of a fragment in f64: position and tangent are interpolated along its segment. Kajiya-Kay, directional
/// lights, no shadow.
fn fragment_radiance(frame: &Frame) -> impl Fn(&Fragment) -> [f64; 3] + Sync + use<> {
    let world = world(frame.hairs);
    let tangents = curve_tangents(&world.strands);
    let eye = camera(&frame.view, [1, 1]).eye.truncate();
    let models: Vec<(KajiyaKay, Vec3)> = world
        .sources
        .iter()
        .map(|&(hair, strand)| {
            let Shading::KajiyaKay(model) = frame.hairs[hair].shading else {
                panic!("another model")
            };
            let colour = frame.hairs[hair].strands().colours()[strand];
            (model, Vec3::from(colour))
        })
        .collect();
    let lights: Vec<(DVec3, DVec3)> = frame
        .lights
        .iter()
        .map(|light| match light.kind {
            LightKind::Directional {
                direction,
                irradiance,
            } => (-direction.normalize(), irradiance.as_dvec3()),
            LightKind::Point { .. } | LightKind::Spot { .. } => panic!("another light"),
        })
        .collect();
    move |fragment| {
        let (first, t) = (fragment.segment as usize, fragment.t);
        let tangent = tangents[first].lerp(tangents[first + 1], t).normalize();
        let position = world.strands.points[first].lerp(world.strands.points[first + 1], t);
        let (model, colour) = models[fragment.strand as usize];
        std::array::from_fn(|channel| {
            let model = kajiya_kay::KajiyaKay {
                diffuse: f64::from(model.diffuse[channel] * colour[channel]),
                specular: f64::from(model.specular[channel]),
                exponent: f64::from(model.exponent),
            };
            let of = |&(to_light, irradiance): &(DVec3, DVec3)| {
                irradiance[channel] * kajiya_kay::scatter(tangent, to_light, eye - position, &model)
            };
            lights.iter().map(of).sum()
        })
    }
}

/// Each strand by this many of its points, evenly picked.
fn coarse(strands: &Strands, count: usize) -> Strands {
    let (mut points, mut radii) = (Vec::new(), Vec::new());
    for strand in 0..strands.strand_count() {
        let range = strands.range(strand);
        for i in 0..count {
            let at = range.start + i * (range.len() - 1) / (count - 1);
            points.push(strands.points()[at]);
            radii.push(strands.radii()[at]);
        }
    }
    let counts = vec![count as u32; strands.strand_count()];
    Strands::new(points, &counts, 1.0)
        .unwrap()
        .with_point_radii(radii)
        .unwrap()
}

fn lights() -> [Light; 1] {
    [sunlight()]
}

fn hair(device: &mut Device, strands: &Strands, shading: Shading) -> Hair {
    let mut hair = device.renderer.create_hair(strands).unwrap();
    hair.opacity = 0.7;
    hair.shading = shading;
    hair
}

fn frame<'a>(hairs: &'a [&'a Hair], lights: &'a [Light]) -> Frame<'a> {
    Frame {
        hairs,
        lights,
        ambient: Vec3::ZERO,
        view: portrait(SIZE),
        transparency: None,
    }
}

fn at_fragments(frame: &Frame) -> Image {
    let opacity = f64::from(frame.hairs[0].opacity);
    composite::composite(&lists(frame, SIZE, None), opacity, fragment_radiance(frame))
}

/// RMSE of colours up to about 1: a fragment's place in 16 bits, its tangent in 2 × 16, depths that f32 cannot tell apart, and
/// where strands of few points turn sharply the coverage at their joints, which is the same at either rate. Measured 1.4e-5 and 2.0e-5 for
/// straight hair, 3.1e-4 and 6.2e-4 for curly hair, 4.4e-4 for two hairs; points give 0.005 to 0.025.
const EXACT: f64 = 1e-3;
/// With what a tolerance of 1/256 leaves out.
const CULLED: f64 = 3e-3;
/// With a place along the segment in 8 bits.
const EIGHT_BITS: f64 = 4e-3;

/// Asserts the colours, and that coverage is what it is at the other rate: the picture `at_points`.
fn assert_colours(
    name: &str,
    actual: &Image,
    expected: &Image,
    at_points: &Image,
    rmse: f64,
) -> f64 {
    let error = colour_error(actual, expected, None);
    eprintln!("{name}: {error:?}");
    let alphas = |image: &Image| image.pixels.iter().map(|p| p[3]).collect::<Vec<_>>();
    assert_eq!(alphas(actual), alphas(at_points), "{name}");
    if error.rmse > rmse {
        write_failure(name, actual, expected);
        panic!("{name}: {error:?}");
    }
    error.rmse
}

#[test]
fn fragments_are_lit_at_their_own_place() {
    let Some(mut device) = device() else { return };
    for (name, groom) in [
        ("straight", BuiltinGroom::Straight),
        ("curly", BuiltinGroom::Curly),
    ] {
        let fine = builtin(groom, 600).unwrap();
        let fine = pelage::groom::tessellate(&fine, 2).unwrap();
        for (detail, strands) in [("8 points", coarse(&fine, 8)), ("fine", fine.clone())] {
            let mut hair = hair(&mut device, &strands, Shading::KajiyaKay(SHINY));
            let lights = lights();
            let expected = at_fragments(&frame(&[&hair], &lights));
            let name = format!("{name}, {detail}");
            let (at_points, _) = render(&mut device, &frame(&[&hair], &lights), SIZE);
            let error = colour_error(&at_points, &expected, None);
            eprintln!("{name}, shaded at points: {error:?}");
            hair.shading_rate = ShadingRate::Fragment;
            let (actual, _) = render(&mut device, &frame(&[&hair], &lights), SIZE);
            let name = format!("{name}, shaded at fragments");
            let exact = assert_colours(&name, &actual, &expected, &at_points, EXACT);
            assert!(error.rmse > 10.0 * exact, "{name}: {error:?} at points");
        }
    }
}

#[test]
fn every_storage_rasteriser_and_technique_shades_fragments() {
    let Some(mut device) = device() else { return };
    let strands = coarse(&builtin(BuiltinGroom::Wavy, 400).unwrap(), 8);
    let mut hair = hair(&mut device, &strands, Shading::KajiyaKay(SHINY));
    let lights = lights();
    let (expected, nearest) = {
        let hairs = [&hair];
        let frame = frame(&hairs, &lights);
        let fragments = lists(&frame, SIZE, None);
        let opacity = f64::from(hair.opacity);
        let nearest = composite::opaque(&fragments, opacity, fragment_radiance(&frame));
        (at_fragments(&frame), nearest)
    };
    let opaque = Transparency::Opaque(Opaque::default());
    let culled = Transparency::DbkBuffer(DbkBuffer {
        culling: Culling::Always,
        ..DbkBuffer::default()
    });
    let techniques = A_BUFFERS
        .map(|(name, storage, raster)| (name, a_buffer(storage, raster), &expected, EXACT))
        .into_iter()
        .chain([
            ("dbk_buffer", culled, &expected, CULLED),
            ("opaque", opaque, &nearest, EIGHT_BITS),
        ]);
    for (name, technique, expected, tolerance) in techniques {
        let mut picture = |rate| {
            hair.shading_rate = rate;
            let hairs = [&hair];
            let frame = Frame {
                transparency: Some(technique),
                ..frame(&hairs, &lights)
            };
            render(&mut device, &frame, SIZE).0
        };
        let at_points = picture(ShadingRate::Point);
        let actual = picture(ShadingRate::Fragment);
        let name = format!("at fragments, {name}");
        assert_colours(&name, &actual, expected, &at_points, tolerance);
    }
}

#[test]
fn hairs_of_other_parameters_and_places_keep_their_own() {
    let Some(mut device) = device() else { return };
    let straight = coarse(&builtin(BuiltinGroom::Straight, 300).unwrap(), 8);
    let count = straight.strand_count();
    let red = straight
        .clone()
        .with_colours(vec![[1.0, 0.3, 0.2]; count])
        .unwrap();
    let curly = builtin(BuiltinGroom::Curly, 200).unwrap();
    let mut first = hair(&mut device, &red, Shading::KajiyaKay(SHINY));
    let other = KajiyaKay {
        diffuse: Vec3::new(0.0, 0.2, 0.4),
        exponent: 20.0,
        ..SHINY
    };
    let mut second = hair(&mut device, &curly, Shading::KajiyaKay(other));
    second.world_from_object =
        DMat4::from_translation(DVec3::new(0.05, -0.02, 0.03)) * DMat4::from_rotation_y(0.4);
    let lights = lights();
    let (at_points, _) = render(&mut device, &frame(&[&first, &second], &lights), SIZE);
    first.shading_rate = ShadingRate::Fragment;
    second.shading_rate = ShadingRate::Fragment;
    let hairs = [&first, &second];
    let frame = frame(&hairs, &lights);
    let (actual, _) = render(&mut device, &frame, SIZE);
    let expected = at_fragments(&frame);
    assert_colours(
        "two hairs at fragments",
        &actual,
        &expected,
        &at_points,
        EXACT,
    );
}

/// Of a picture's brightest channel. At points each hair has its own shaders, and the same picture; at fragments one module reads the
/// settings of all, and compilers may join other sums: measured 0, too.
const SETTINGS_APART: f64 = 1e-4;

#[test]
fn hairs_of_other_settings_keep_their_own() {
    let Some(mut device) = device() else { return };
    let size = [64, 24];
    // Wider than a pixel, and so seen by its near field where asked for.
    let strands = |x: f32| {
        let points = (0..4).flat_map(|i| {
            let x = x + 6.0 * i as f32;
            [[x - 3.0, -20.0, -5.0], [x, 0.0, 0.0], [x + 1.0, 20.0, 3.0]]
        });
        Strands::new(points.collect(), &[3; 4], 2.0).unwrap()
    };
    let (left, right) = (strands(-26.0), strands(8.0));
    let direct = Marschner {
        tables: None,
        eccentricity: 0.8,
        ..Marschner::default()
    };
    let tables = |size, precision| Some(Tables { size, precision });
    let pairs = [
        [
            Shading::Marschner(Marschner::default()),
            Shading::Marschner(Marschner {
                roots: Roots::Cubic,
                dual_scattering: Some(DualScattering::default()),
                ..direct
            }),
        ],
        [
            Shading::Marschner(direct),
            Shading::Marschner(Marschner {
                roots: Roots::Cubic,
                eccentricity: 1.0,
                ..direct
            }),
        ],
        [
            Shading::Chiang(Chiang {
                tables: tables(32, Precision::F32),
                near_field: true,
                ..Chiang::default()
            }),
            Shading::Chiang(Chiang {
                tables: tables(64, Precision::F16),
                dual_scattering: Some(DualScattering::default()),
                ..Chiang::default()
            }),
        ],
    ];
    let lights = [
        unshadowed(DVec3::new(0.8, 0.1, -0.5), Vec3::ONE),
        unshadowed(DVec3::new(-0.3, 0.4, 0.8), Vec3::splat(0.5)),
    ];
    for rate in [ShadingRate::Point, ShadingRate::Fragment] {
        for pair in pairs {
            let mut picture = |shadings: &[(&Strands, Shading)]| {
                let hairs: Vec<Hair> = shadings
                    .iter()
                    .map(|(strands, shading)| {
                        let mut hair = hair(&mut device, strands, *shading);
                        hair.shading_rate = rate;
                        hair
                    })
                    .collect();
                let hairs: Vec<&Hair> = hairs.iter().collect();
                let frame = Frame {
                    ambient: Vec3::splat(0.1),
                    view: pixel_view(size, 50.0),
                    ..frame(&hairs, &lights)
                };
                render(&mut device, &frame, size).0
            };
            let both = picture(&[(&left, pair[0]), (&right, pair[1])]);
            let alone = [picture(&[(&left, pair[0])]), picture(&[(&right, pair[1])])];
            let swapped = [picture(&[(&left, pair[1])]), picture(&[(&right, pair[0])])];
            let name = format!("{}, {rate:?}", pair[0].stem());
            let colours = both.pixels.iter().flat_map(|pixel| &pixel[..3]);
            let peak = colours.fold(0.0f64, |peak, channel| peak.max(*channel));
            let worst = |others: &[Image; 2]| {
                let mut worst = 0.0f64;
                for (at, pixel) in both.pixels.iter().enumerate() {
                    let [left, right] = [0, 1].map(|hair| others[hair].pixels[at]);
                    assert!(left[3] == 0.0 || right[3] == 0.0, "{name}: hairs overlap");
                    for c in 0..4 {
                        worst = worst.max((pixel[c] - left[c] - right[c]).abs() / peak);
                    }
                }
                worst
            };
            let (error, other) = (worst(&alone), worst(&swapped));
            eprintln!("{name}: {error:.2e}; with the other's settings {other:.2e}");
            assert!(other > 100.0 * SETTINGS_APART, "{name}: {other}");
            let most = match rate {
                ShadingRate::Point => 0.0,
                ShadingRate::Fragment => SETTINGS_APART,
            };
            if error > most {
                write_failure(&name, &both, &alone[0]);
                panic!("{name}: {error}");
            }
        }
    }
}

/// Where points lie close together both rates agree: what remains is the second difference within a segment, and that colours
/// of points are 16-bit floats. Below 4e-3; with half as many points Scheuermann's had 4.3e-3.
const CLOSE: f64 = 4e-3;

#[test]
fn every_model_shades_fragments_as_it_shades_points_close_together() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 300).unwrap();
    let strands = pelage::groom::tessellate(&strands, 16).unwrap();
    let models = [
        Shading::Scheuermann(Scheuermann::default()),
        Shading::Marschner(Marschner::default()),
        Shading::Marschner(Marschner {
            tables: None,
            eccentricity: 0.9,
            ..Marschner::default()
        }),
        Shading::Sadeghi(Sadeghi::default()),
        Shading::Chiang(Chiang::default()),
        Shading::Chiang(Chiang {
            tables: None,
            intervals: 16,
            dual_scattering: Some(Default::default()),
            ..Chiang::default()
        }),
    ];
    // One that shadows, and uniform light.
    let lights = [Light::directional(
        DVec3::new(-0.5, -0.6, -0.7),
        Vec3::splat(3.0),
    )];
    for shading in models {
        let mut hair = hair(&mut device, &strands, shading);
        let mut pictures = Vec::new();
        for rate in [ShadingRate::Point, ShadingRate::Fragment] {
            hair.shading_rate = rate;
            let hairs = [&hair];
            let frame = Frame {
                ambient: Vec3::splat(0.1),
                ..frame(&hairs, &lights)
            };
            pictures.push(render(&mut device, &frame, SIZE).0);
        }
        let error = colour_error(&pictures[1], &pictures[0], None);
        eprintln!("{}: {error:?}", shading.stem());
        if error.rmse > CLOSE || error.rmse == 0.0 {
            write_failure(shading.stem(), &pictures[1], &pictures[0]);
            panic!("{}: {error:?}", shading.stem());
        }
    }
}

/// RMSE and p99 with a tenth of the pool: what is merged has the mean colour of three of its fragments. Counted arrays merge
/// the farthest, the same in every run: measured 0.023 and 0.11. Lists merge what comes late, as the scheduler has it: 0.038 to 0.040
/// and 0.18.
const SAMPLED_COUNTED: [f64; 2] = [0.03, 0.14];
const SAMPLED_LISTS: [f64; 2] = [0.06, 0.27];

#[test]
fn a_small_pool_erases_no_hair_at_fragments() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 1_500).unwrap();
    let mut hair = hair(&mut device, &strands, Shading::KajiyaKay(SHINY));
    hair.shading_rate = ShadingRate::Fragment;
    let (hairs, lights) = ([&hair], lights());
    let mut frame = frame(&hairs, &lights);
    let expected = at_fragments(&frame);
    let need = lists(&frame, SIZE, None).fragments.len() as u64;
    for (name, storage, raster) in A_BUFFERS {
        frame.transparency = Some(Transparency::ABuffer(ABuffer {
            storage,
            raster,
            pool_bytes: Some(need / 10 * 16),
        }));
        let (actual, statistics) = render(&mut device, &frame, SIZE);
        let (colour, alpha) = (
            colour_error(&actual, &expected, None),
            alpha_error(&actual, &expected, None),
        );
        eprintln!("{name}: colour {colour:?}, alpha {alpha:?}");
        assert!(statistics.fragments.merged > need / 2, "{name}");
        let [rmse, p99] = match storage {
            Storage::Counted => SAMPLED_COUNTED,
            Storage::Lists => SAMPLED_LISTS,
        };
        if colour.rmse > rmse || colour.p99 > p99 || alpha.rmse > 1e-3 {
            write_failure(&format!("sampled tail, {name}"), &actual, &expected);
            panic!("{name}: {colour:?}, {alpha:?}");
        }
        if storage == Storage::Counted {
            let (again, _) = render(&mut device, &frame, SIZE);
            assert_identical(name, &again, &actual);
        }
    }
}

#[test]
fn what_the_other_rate_needs_does_not_exist() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 300).unwrap();
    for (rate, own, other) in [
        (
            ShadingRate::Point,
            "pelage.shading.points",
            "pelage.shading.fibre_points",
        ),
        (
            ShadingRate::Fragment,
            "pelage.shading.fibre_points",
            "pelage.shading.points",
        ),
    ] {
        device.forget();
        let mut hair = hair(&mut device, &strands, Shading::KajiyaKay(SHINY));
        hair.shading_rate = rate;
        let (hairs, lights) = ([&hair], lights());
        let frame = frame(&hairs, &lights);
        let image = device
            .create_image(SIZE[0], SIZE[1], crate::common::images::FORMAT, false)
            .unwrap();
        let target = pelage::Target::cleared(&image.colour);
        let statistics = device.renderer.render_timed(&frame, &target).unwrap();
        let held = |label| {
            let found = statistics.bytes.iter().find(|(held, _)| held == label);
            found.map_or(0, |(_, bytes)| *bytes)
        };
        assert!(held(own) > 1000 && held(other) <= 256, "{rate:?}");
        let passes: Vec<_> = statistics.passes.iter().map(|p| &p.label[..]).collect();
        let shaded = passes.contains(&"pelage.shading.kajiya_kay.points");
        let gathered = passes.contains(&"pelage.shading.fibre_points");
        assert_eq!(
            (shaded, gathered),
            (rate == ShadingRate::Point, rate == ShadingRate::Fragment)
        );
    }
}

#[test]
fn hairs_of_unlike_rates_are_a_conflict() {
    let Some(mut device) = device() else { return };
    let strands = builtin(BuiltinGroom::Straight, 20).unwrap();
    let first = hair(&mut device, &strands, Shading::KajiyaKay(SHINY));
    let mut second = hair(&mut device, &strands, Shading::KajiyaKay(SHINY));
    second.shading_rate = ShadingRate::Fragment;
    let (hairs, lights) = ([&first, &second], lights());
    let image = device
        .create_image(SIZE[0], SIZE[1], crate::common::images::FORMAT, false)
        .unwrap();
    let target = pelage::Target::cleared(&image.colour);
    let error = device.render(&frame(&hairs, &lights), &target).unwrap_err();
    assert!(error.to_string().contains("shading rate"), "{error}");
}
