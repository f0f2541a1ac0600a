//! The scenes of the report: which groom, how large a frame, and how much of each group is measured there.

use std::path::PathBuf;

use pelage::glam::DVec3;
use pelage::groom::{self, BuiltinGroom, Curve, Mesh, Strands};
use pelage::host::offscreen::{Offscreen, OffscreenOptions};
use pelage::{LightKind, wgpu};

use super::Group;
use super::measure::sentence;
use crate::scene_file::framing::{self, Bounds, Framing};
use crate::scene_file::mesh_pass::{MeshPass, Scenery};
use crate::scene_file::scene::Scene as SceneFile;
use crate::scene_file::{groom as files, meshes};
use crate::{Result, root};

/// Straight pieces of a spline's segment.
const CURVE_PIECES: u32 = 4;

/// Where a scene's hair comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Source {
    /// So many strands of a groom of the library, without its head, with fibres of this opacity.
    Builtin(BuiltinGroom, usize, f32),
    /// `scenes/NAME.json` of `PELAGE_SHARED`, or else of `../shared`, read as the `render` example reads it.
    File,
}

/// How much of a group is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// Every technique over the ladder of its settings.
    Ladder,
    /// The same, but for ribbons: which rasteriser finds the fragments changes the time alone, and is seen on other scenes.
    LadderByWalk,
    /// Every technique with its default settings.
    Defaults,
}

/// A groom and a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scene {
    /// Its name in rows.
    pub name: &'static str,
    /// Its hair.
    pub source: Source,
    /// Pixels in a row, and rows.
    pub size: [u32; 2],
    /// The groups that are measured.
    pub groups: &'static [(Group, Extent)],
    /// Whether `--quick` measures it.
    pub quick: bool,
    /// Millions of fragments, for estimates of how long a row takes.
    pub fragments: f64,
}

/// The groups of the scenes on which models are compared too.
const ALL: &[(Group, Extent)] = &[
    (Group::Shading, Extent::Ladder),
    (Group::Samples, Extent::Ladder),
    (Group::Frames, Extent::Ladder),
    (Group::Shadow, Extent::Ladder),
    (Group::Transparency, Extent::Ladder),
];
const TRANSPARENCY_LADDER: &[(Group, Extent)] = &[(Group::Transparency, Extent::LadderByWalk)];
const TRANSPARENCY: &[(Group, Extent)] = &[(Group::Transparency, Extent::Defaults)];
const SHADOW_AND_TRANSPARENCY: &[(Group, Extent)] = &[
    (Group::Shadow, Extent::Defaults),
    (Group::Transparency, Extent::Defaults),
];

const PORTRAIT: [u32; 2] = [656, 861];

/// The usual groom at another opacity.
const fn straight(name: &'static str, opacity: f32) -> Scene {
    Scene {
        name,
        source: Source::Builtin(BuiltinGroom::Straight, 50_000, opacity),
        size: PORTRAIT,
        groups: TRANSPARENCY_LADDER,
        quick: false,
        fragments: 26.4,
    }
}

/// The scenes of the report.
pub const SCENES: &[Scene] = &[
    Scene {
        source: Source::Builtin(BuiltinGroom::Straight, 10_000, 0.5),
        size: [328, 430],
        groups: ALL,
        quick: true,
        fragments: 3.1,
        ..straight("straight_10k", 0.5)
    },
    Scene {
        groups: ALL,
        ..straight("straight", 0.5)
    },
    straight("straight_0.1", 0.1),
    straight("straight_0.3", 0.3),
    straight("straight_0.9", 0.9),
    Scene {
        size: [1920, 1080],
        groups: TRANSPARENCY,
        fragments: 36.0,
        ..straight("straight_1080p", 0.5)
    },
    Scene {
        source: Source::Builtin(BuiltinGroom::Wavy, 50_000, 0.5),
        groups: SHADOW_AND_TRANSPARENCY,
        fragments: 20.0,
        ..straight("wavy", 0.5)
    },
    Scene {
        source: Source::Builtin(BuiltinGroom::Curly, 50_000, 0.5),
        groups: SHADOW_AND_TRANSPARENCY,
        fragments: 20.0,
        ..straight("curly", 0.5)
    },
    Scene {
        source: Source::File,
        size: [1280, 720],
        groups: SHADOW_AND_TRANSPARENCY,
        fragments: 4.5,
        ..straight("sintel", 0.5)
    },
    Scene {
        source: Source::File,
        groups: TRANSPARENCY,
        fragments: 1.2,
        ..straight("bear", 0.8)
    },
    Scene {
        source: Source::File,
        groups: SHADOW_AND_TRANSPARENCY,
        fragments: 1.4,
        ..straight("furball", 1.0)
    },
];

impl Scene {
    /// How much of a group is measured here; `None` of none.
    pub fn extent(&self, group: Group) -> Option<Extent> {
        let of = |(own, extent): &(Group, Extent)| (*own == group).then_some(*extent);
        self.groups.iter().find_map(of)
    }

    fn path(&self) -> PathBuf {
        let shared = std::env::var_os("PELAGE_SHARED");
        let shared = shared.map_or_else(|| root().join("../shared"), PathBuf::from);
        shared.join(format!("scenes/{}.json", self.name))
    }

    /// Whether what it is read from is there.
    pub fn is_there(&self) -> bool {
        self.source != Source::File || self.path().exists()
    }
}

/// A scene's hair, and from where and by what it is seen.
pub struct Loaded {
    /// The strands, cut into straight pieces, white.
    pub strands: Strands,
    /// The camera.
    pub framing: Framing,
    /// The fibres' own opacity.
    pub opacity: f32,
    /// The way in which the light travels.
    pub light: DVec3,
    /// The depth of the opaque scene, row by row, where there is one.
    pub host_depth: Option<Vec<f32>>,
}

/// Reads or makes a scene. Meshes become a depth that hides hair; their colour is left out.
pub fn load(scene: &Scene) -> Result<Loaded> {
    let (file, groom, mesh) = match scene.source {
        Source::Builtin(groom, strands, opacity) => {
            let mut file = SceneFile::parse(
                r#"{"hair": "builtin:straight"}"#,
                std::path::Path::new(""),
                &[],
            )?;
            file.fibre.opacity = opacity;
            let strands = groom::builtin(groom, strands).map_err(sentence)?;
            let front = DVec3::Z;
            (file, files::Groom { strands, front }, Mesh::default())
        }
        Source::File => {
            let file = SceneFile::read(&scene.path(), &[])?;
            let (groom, mesh) = (files::load(&file)?, meshes::load(&file)?);
            (file, groom, mesh)
        }
    };
    let [width, height] = scene.size;
    let mut camera = file.camera;
    (camera.width, camera.height) = (width, height);
    let bounds = Bounds::around(groom.strands.points()).ok_or("the groom has no points")?;
    let all = Bounds::around(&mesh.positions).map_or(bounds, |mesh| bounds.union(mesh));
    let framing = framing::frame(&camera, bounds, groom.front, all)?;
    let (lights, ambient) = framing::lights(&file, &framing);
    let direction = lights.iter().find_map(|light| match light.kind {
        LightKind::Directional { direction, .. } => Some(direction),
        _ => None,
    });
    let light = direction.ok_or("the scene has no directional light")?;
    let scenery = Scenery {
        view: framing.view,
        eye: framing.eye,
        lights: &lights,
        ambient,
    };
    let host_depth = match mesh.indices.is_empty() {
        true => None,
        false => Some(depth_of(&mesh, &scenery, scene.size)?),
    };

    let mut strands = groom.strands;
    if strands.curve() != Curve::Polyline {
        strands = groom::tessellate(&strands, CURVE_PIECES).map_err(sentence)?;
    }
    // White, so that errors are parts of white, and no model's own reading of a strand's colour is in them.
    let white = vec![[1.0; 3]; strands.strand_count()];
    Ok(Loaded {
        strands: strands.with_colours(white).map_err(sentence)?,
        framing,
        opacity: file.fibre.opacity,
        light,
        host_depth,
    })
}

/// The depth that the `render` example's meshes leave.
fn depth_of(mesh: &Mesh, scenery: &Scenery, [width, height]: [u32; 2]) -> Result<Vec<f32>> {
    let mut offscreen = Offscreen::new(&OffscreenOptions::default()).map_err(sentence)?;
    let image = offscreen
        .create_image(width, height, wgpu::TextureFormat::Rgba16Float, true)
        .map_err(sentence)?;
    let (device, queue) = (offscreen.renderer.device(), offscreen.renderer.queue());
    let mut encoder = device.create_command_encoder(&Default::default());
    MeshPass::new(device, &image, mesh, scenery).record(&mut encoder, &image);
    queue.submit([encoder.finish()]);
    let depth = image.depth.as_ref().ok_or("no depth was made")?;
    offscreen.read_depth(depth).map_err(sentence)
}
