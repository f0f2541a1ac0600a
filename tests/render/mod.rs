//! The `render` example: its scene files, its errors and its exit status.

#[allow(dead_code)]
#[path = "../../examples/render/scene.rs"]
mod scene;
#[allow(dead_code, unused_imports)]
#[path = "../../examples/render/techniques/mod.rs"]
mod techniques;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use pelage::Raster;
use pelage::glam::Vec3;
use pelage::groom::BuiltinGroom;
use pelage::shading::{KajiyaKay, Shading};
use pelage::shadow::{DeepOpacityMap, Shadow};
use pelage::transparency::{ABuffer, Storage, Transparency};
use scene::{HairSource, Scene};

fn parse(text: &str) -> Result<Scene, String> {
    parse_with(text, &[])
}

fn parse_with(text: &str, overrides: &[&str]) -> Result<Scene, String> {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    Scene::parse(text, Path::new("scenes"), &overrides)
}

/// The error of a scene, which must be one line.
fn error(text: &str, overrides: &[&str]) -> String {
    let error = parse_with(text, overrides).unwrap_err();
    assert!(!error.contains('\n'), "{error}");
    error
}

fn assert_names(error: &str, names: &[&str]) {
    for name in names {
        assert!(error.contains(name), "{name:?} is not in {error:?}");
    }
}

const EVERY_KEY: &str = r#"{"hair": ["a.hair", "b.tfx"],
    "camera": {"eye": [0, 0.4, 3], "target": [0, 1, 0], "up": [0, 0, 1], "vfov_deg": 36, "width": 512, "height": 256},
    "light": [{"direction": [-1, -2, -3], "irradiance": [1, 2, 3]}, {"position": [4, 5, 6], "intensity": [7, 8, 9]}],
    "ambient": [0.1, 0.2, 0.3],
    "fibre": {"radius": 0.0025, "opacity": 0.5, "eta": 1.5, "sigma_a": [0.06, 0.1, 0.2], "beta_m": 0.2, "beta_n": 0.4,
        "alpha_deg": 3},
    "shading": {"model": "kajiya_kay", "specular": [0.1, 0.1, 0.1], "exponent": 50},
    "shadow": {"technique": "deep_opacity_map", "resolution": 1024, "layers": 4, "pcf": 5, "depth": 0.25, "transmitted": [0.5, 0.25, 0.0], "raster": "ribbons"},
    "transparency": {"technique": "a_buffer", "storage": "lists", "raster": "walk", "pool_bytes": 1000000},
    "meshes": ["head.obj"]}"#;

#[test]
fn every_key_is_read() {
    let scene = parse(EVERY_KEY).unwrap();
    let file = |name: &str| HairSource::File(Path::new("scenes").join(name));
    assert_eq!(scene.hair, [file("a.hair"), file("b.tfx")]);
    assert_eq!(scene.camera.eye, Some([0.0, 0.4, 3.0]));
    assert_eq!(
        (
            scene.camera.width,
            scene.camera.height,
            scene.camera.vfov_deg
        ),
        (512, 256, 36.0)
    );
    let lights = scene.lights.unwrap();
    assert_eq!(lights[0].direction, Some([-1.0, -2.0, -3.0]));
    assert_eq!(lights[1].intensity, Some([7.0, 8.0, 9.0]));
    assert_eq!(scene.ambient, [0.1, 0.2, 0.3]);
    assert_eq!(
        (
            scene.fibre.radius,
            scene.fibre.opacity,
            scene.fibre.alpha_deg
        ),
        (Some(0.0025), 0.5, 3.0)
    );
    let Shading::KajiyaKay(model) = scene.shading else {
        panic!("{:?}", scene.shading)
    };
    assert_eq!(model.exponent, 50.0);
    assert_eq!(
        model.diffuse,
        KajiyaKay::diffuse_of([0.06, 0.1, 0.2].into())
    );
    let map = DeepOpacityMap {
        resolution: 1024,
        layers: 4,
        pcf: 5,
        depth: 0.25,
        transmitted: Vec3::new(0.5, 0.25, 0.0),
        raster: Raster::Ribbons,
    };
    assert_eq!(scene.shadow, Shadow::DeepOpacityMap(map));
    let buffer = ABuffer {
        storage: Storage::Lists,
        raster: Raster::Walk,
        pool_bytes: Some(1_000_000),
    };
    assert_eq!(scene.transparency, Transparency::ABuffer(buffer));
    assert_eq!(scene.meshes, Some(vec![PathBuf::from("scenes/head.obj")]));
}

#[test]
fn what_is_left_out_is_the_librarys_default() {
    let scene = parse(r#"{"hair": "builtin:wavy"}"#).unwrap();
    assert_eq!(scene.hair, [HairSource::Builtin(BuiltinGroom::Wavy)]);
    assert_eq!(scene.shading, Shading::default());
    assert_eq!(scene.shadow, Shadow::default());
    assert_eq!(scene.transparency, Transparency::default());
    assert_eq!(
        (
            scene.camera.width,
            scene.camera.height,
            scene.camera.vfov_deg
        ),
        (656, 861, 30.0)
    );
    assert_eq!(
        (scene.lights, scene.meshes, scene.fibre.radius),
        (None, None, None)
    );
}

#[test]
fn settings_as_resolved_are_read_back_as_they_were() {
    let scene = parse(EVERY_KEY).unwrap();
    let text = serde_json::json!({
        "hair": "x.hair",
        "shading": techniques::shading_settings(&scene.shading),
        "shadow": techniques::shadow_settings(&scene.shadow),
        "transparency": techniques::transparency_settings(&scene.transparency),
    });
    let again = parse(&text.to_string()).unwrap();
    assert_eq!(
        (again.shading, again.shadow, again.transparency),
        (scene.shading, scene.shadow, scene.transparency)
    );
}

#[test]
fn every_shading_model_is_read_back_as_it_was() {
    for shading in [
        r#"{"model": "scheuermann", "primary": {"exponent": 200}}"#,
        r#"{"model": "marschner", "alpha_deg": [-5, 2.5, 7.5], "dual_scattering": true, "tables": false}"#,
        r#"{"model": "sadeghi", "tt_intensity": 2, "dual_scattering": {"forward": 0.5, "backward": 0.6}}"#,
        r#"{"model": "chiang", "tables": {"size": 128, "precision": "f32"}, "tip_colour": [0.9, 0.8, 0.7]}"#,
    ] {
        let scene = parse(&format!(r#"{{"hair": "x.hair", "shading": {shading}}}"#)).unwrap();
        let settings = techniques::shading_settings(&scene.shading);
        let again =
            parse(&serde_json::json!({ "hair": "x.hair", "shading": settings }).to_string());
        assert_eq!(
            techniques::shading_settings(&again.unwrap().shading),
            settings
        );
        scene.shading.validate().unwrap();
    }
    let unknown = r#"{"hair": "a.hair", "shading": {"model": "chiang", "beta_m": 0.1}}"#;
    assert_names(
        &error(unknown, &[]),
        &["beta_m", "dual_scattering", "tables"],
    );
}

#[test]
fn an_unknown_key_is_an_error_that_names_the_known_ones() {
    assert_names(
        &error(r#"{"hair": "a.hair", "lamp": {}}"#, &[]),
        &["lamp", "hair", "light", "transparency"],
    );
    let camera = r#"{"hair": "a.hair", "camera": {"fov": 30}}"#;
    assert_names(&error(camera, &[]), &["camera", "fov", "vfov_deg"]);
    let light =
        r#"{"hair": "a.hair", "light": [{"direction": [0, -1, 0]}, {"colour": [1, 1, 1]}]}"#;
    assert_names(&error(light, &[]), &["light[1]", "colour", "irradiance"]);
    let shadow = r#"{"hair": "a.hair", "shadow": {"technique": "deep_opacity_map", "bias": 1}}"#;
    assert_names(
        &error(shadow, &[]),
        &["shadow", "bias", "technique", "resolution", "pcf"],
    );
    let none = r#"{"hair": "a.hair", "shadow": {"technique": "none", "layers": 1}}"#;
    assert_names(&error(none, &[]), &["shadow", "layers", "technique"]);
    let opaque =
        r#"{"hair": "a.hair", "transparency": {"technique": "opaque", "storage": "lists"}}"#;
    assert_names(
        &error(opaque, &[]),
        &["transparency", "storage", "technique", "raster"],
    );
}

#[test]
fn an_unknown_stem_is_an_error_that_names_those_of_this_build() {
    let shading = r#"{"hair": "a.hair", "shading": {"model": "phong"}}"#;
    assert_names(
        &error(shading, &[]),
        &["shading.model", "phong", "kajiya_kay"],
    );
    let shadow = r#"{"hair": "a.hair", "shadow": {"technique": "stencil"}}"#;
    assert_names(
        &error(shadow, &[]),
        &["shadow.technique", "stencil", "none", "deep_opacity_map"],
    );
    let transparency = r#"{"hair": "a.hair", "transparency": {"technique": 3}}"#;
    assert_names(
        &error(transparency, &[]),
        &["transparency.technique", "3", "opaque", "a_buffer"],
    );
    assert_names(
        &error(r#"{"hair": "builtin:mohawk"}"#, &[]),
        &["builtin:mohawk", "builtin:curly"],
    );
}

#[test]
fn a_value_of_the_wrong_kind_is_named_by_its_key() {
    assert_names(
        &error(r#"{"hair": "a", "fibre": {"opacity": "half"}}"#, &[]),
        &["fibre.opacity", "half"],
    );
    assert_names(
        &error(r#"{"hair": "a", "camera": {"eye": [1, 2]}}"#, &[]),
        &["camera.eye"],
    );
    assert_names(&error(r#"{"hair": 7}"#, &[]), &["hair", "7"]);
    assert_names(&error(r#"{"hair": []}"#, &[]), &["hair", "empty"]);
    assert_names(&error(r#"{"camera": {}}"#, &[]), &["hair"]);
    assert_names(
        &error(r#"{"hair": "a", "transparency": {"raster": "rays"}}"#, &[]),
        &["transparency.raster", "rays", "walk"],
    );
    assert_names(&error("[]", &[]), &["object"]);
    assert_names(&error("{\"hair\":\n", &[]), &["JSON", "line 2"]);
    let mixed = r#"{"hair": "a", "light": {"position": [0, 0, 0], "irradiance": [1, 1, 1]}}"#;
    assert_names(&error(mixed, &[]), &["light", "position", "irradiance"]);
    assert_names(
        &error(r#"{"hair": "a", "light": {"position": [0, 0, 0]}}"#, &[]),
        &["light.intensity", "missing"],
    );
}

#[test]
fn overrides_have_the_last_word() {
    let overrides = [
        "camera.width=99",
        "shadow.layers=2",
        "fibre.opacity=0.25",
        "transparency={\"technique\":\"opaque\"}",
        "hair=\"builtin:curly\"",
        "camera.width=100",
    ];
    let scene = parse_with(EVERY_KEY, &overrides).unwrap();
    assert_eq!(
        (scene.camera.width, scene.camera.height, scene.fibre.opacity),
        (100, 256, 0.25)
    );
    let Shadow::DeepOpacityMap(map) = scene.shadow else {
        panic!("{:?}", scene.shadow)
    };
    assert_eq!((map.layers, map.resolution), (2, 1024));
    assert_eq!(scene.transparency.stem(), "opaque");
    assert_eq!(scene.hair, [HairSource::Builtin(BuiltinGroom::Curly)]);
    // A group that the file leaves out.
    let scene = parse_with(
        r#"{"hair": "a"}"#,
        &[
            "transparency.technique=\"a_buffer\"",
            "transparency.storage=\"lists\"",
        ],
    )
    .unwrap();
    assert!(matches!(
        scene.transparency,
        Transparency::ABuffer(ABuffer {
            storage: Storage::Lists,
            ..
        })
    ));
}

#[test]
fn an_override_that_selects_another_technique_drops_the_files_settings_of_the_former() {
    let scene = parse_with(EVERY_KEY, &["shadow.technique=\"none\""]).unwrap();
    assert_eq!(scene.shadow, Shadow::None);
    let scene = parse_with(EVERY_KEY, &["transparency.technique=\"opaque\""]).unwrap();
    assert_eq!(scene.transparency.raster(), Raster::Walk);
    // But not its own.
    let wrong = error(EVERY_KEY, &["shadow.technique=\"none\"", "shadow.layers=2"]);
    assert_names(&wrong, &["shadow", "layers"]);
}

#[test]
fn an_override_that_cannot_be_read_is_named() {
    let scene = r#"{"hair": "a", "light": []}"#;
    assert_names(
        &error(scene, &["camera.width"]),
        &["--set", "camera.width", "="],
    );
    assert_names(
        &error(scene, &["shadow.technique=none"]),
        &["--set", "shadow.technique", "none", "quotes"],
    );
    assert_names(&error(scene, &["shadow.size=3"]), &["size", "resolution"]);
    assert_names(
        &error(scene, &["light.direction=[0,-1,0]"]),
        &["--set", "light", "list"],
    );
}

/// The example as cargo has built it beside the tests.
fn render(arguments: &[&str]) -> Output {
    let tests = std::env::current_exe().unwrap();
    let folder = tests.ancestors().nth(2).unwrap();
    let example = folder
        .join("examples")
        .join(format!("render{}", std::env::consts::EXE_SUFFIX));
    Command::new(&example)
        .args(arguments)
        .output()
        .unwrap_or_else(|error| panic!("{}: {error}", example.display()))
}

/// A folder for one test's files, emptied.
fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("render")
        .join(test);
    std::fs::remove_dir_all(&folder).ok();
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// The sentence of a run that must fail and leave no picture.
fn failure(folder: &Path, scene: &Path, more: &[&str]) -> String {
    let out = folder.join("out.exr");
    let mut arguments = vec![scene.to_str().unwrap(), "--out", out.to_str().unwrap()];
    arguments.extend(more);
    let output = render(&arguments);
    assert!(!output.status.success());
    assert!(!out.exists());
    let text = String::from_utf8(output.stderr).unwrap();
    let mut ours = text
        .lines()
        .filter_map(|line| line.strip_prefix("render: "));
    let sentence = ours
        .next()
        .unwrap_or_else(|| panic!("no sentence in {text:?}"))
        .to_owned();
    assert_eq!(ours.next(), None, "{text:?}");
    sentence
}

#[test]
fn a_file_that_is_missing_or_broken_is_named_on_stderr() {
    let folder = folder("missing");
    let scene = folder.join("scene.json");
    assert_names(
        &failure(&folder, &scene, &[]),
        &["scene.json", "No such file"],
    );
    std::fs::write(&scene, r#"{"hair": "absent.hair"}"#).unwrap();
    assert_names(
        &failure(&folder, &scene, &[]),
        &["absent.hair", "No such file"],
    );
    std::fs::write(folder.join("broken.hair"), b"HAIR").unwrap();
    assert_names(
        &failure(&folder, &scene, &["--set", "hair=\"broken.hair\""]),
        &["broken.hair"],
    );
    std::fs::write(folder.join("broken.obj"), "v 0 0 zero\n").unwrap();
    let mesh = failure(
        &folder,
        &scene,
        &[
            "--set",
            "hair=\"builtin:straight\"",
            "--set",
            "meshes=[\"broken.obj\"]",
        ],
    );
    assert_names(&mesh, &["broken.obj"]);
    std::fs::write(&scene, "{").unwrap();
    assert_names(&failure(&folder, &scene, &[]), &["scene.json", "JSON"]);
}

#[test]
fn a_wrong_argument_is_one_sentence() {
    let folder = folder("arguments");
    let scene = folder.join("scene.json");
    std::fs::write(&scene, r#"{"hair": "builtin:straight"}"#).unwrap();
    assert_names(
        &failure(&folder, &scene, &["--size", "0x9"]),
        &["--size", "0x9", "656x861"],
    );
    assert_names(
        &failure(&folder, &scene, &["--frames", "none"]),
        &["--frames", "none"],
    );
    let output = render(&[scene.to_str().unwrap(), "--out", "picture.png"]);
    assert!(!output.status.success());
    assert_names(
        &String::from_utf8(output.stderr).unwrap(),
        &["picture.png", ".exr"],
    );
}
