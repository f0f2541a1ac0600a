//! Which WGSL files make which module. Modules are made by joining files behind a header of constants; an error in one
//! is mapped back to its file and line.

use crate::layout;

macro_rules! files {
    ($($stem:literal),* $(,)?) => {
        /// Every shader file: stem and text.
        pub(crate) const FILES: &[(&str, &str)] = &[
            $(($stem, include_str!(concat!("../shaders/", $stem, ".wgsl")))),*
        ];
    };
}

files![
    "common/layout",
    "common/frame",
    "common/optical_depth",
    "common/coverage",
    "common/run",
    "common/segment",
    "common/pixels",
    "common/fullscreen",
    "common/host_tiles",
    "common/project",
    "common/order",
    "common/scan",
    "common/spread",
    "common/tiles",
    "common/light",
    "common/host_position",
    "common/track",
    "raster/walk",
    "raster/ribbons",
    "shading/material",
    "shading/radiance",
    "shading/points_common",
    "shading/points",
    "shading/fibre_points",
    "shading/fragments",
    "shading/settings",
    "shading/settings_alike",
    "shading/fibre_type",
    "shading/fibre",
    "shading/tables",
    "shading/evaluate",
    "shading/kajiya_kay",
    "shading/scheuermann",
    "shading/marschner",
    "shading/sadeghi",
    "shading/chiang",
    "shadow/none",
    "shadow/map",
    "shadow/passed",
    "shadow/passed_coloured",
    "shadow/own",
    "shadow/front",
    "shadow/map_emit",
    "shadow/nearest",
    "shadow/nearest_emit",
    "shadow/shadow_map",
    "shadow/approximated_deep_shadow_map",
    "shadow/opacity_shadow_maps",
    "shadow/opacity_shadow_maps_common",
    "shadow/opacity_shadow_maps_emit",
    "shadow/opacity_shadow_maps_sum",
    "shadow/deep_opacity_map",
    "shadow/deep_opacity_map_common",
    "shadow/deep_opacity_map_emit",
    "shadow/deep_opacity_map_prefix",
    "shadow/moment_opacity_map",
    "shadow/moment_opacity_map_common",
    "shadow/moment_opacity_map_emit",
    "shadow/k_buffer_volume",
    "shadow/k_buffer_volume_common",
    "shadow/k_buffer_volume_emit",
    "shadow/k_buffer_volume_prefix",
    "transparency/emit_common",
    "transparency/fragment_word",
    "transparency/nearest",
    "transparency/nearest_emit",
    "transparency/weighted_blended",
    "transparency/weighted_blended_emit",
    "transparency/weighted_blended_sums",
    "transparency/shaded",
    "transparency/overflow",
    "transparency/tail",
    "transparency/tail_emit",
    "transparency/tail_sums",
    "transparency/tail_sums_emit",
    "transparency/tail_samples",
    "transparency/tail_samples_emit",
    "transparency/depth_peeling",
    "transparency/depth_peeling_advance",
    "transparency/depth_peeling_emit",
    "transparency/depth_peeling_state",
    "transparency/random_subsets",
    "transparency/random_subsets_emit",
    "transparency/sorted_blending",
    "transparency/sorted_blending_draw",
    "transparency/sorted_blending_points",
    "transparency/sorted_blending_sort",
    "transparency/opaque",
    "transparency/opaque_emit",
    "transparency/a_buffer",
    "transparency/a_buffer_emit",
    "transparency/a_buffer_overflow",
    "transparency/a_buffer_read",
    "transparency/a_buffer_sorted",
    "transparency/k_buffer",
    "transparency/k_buffer_single_pass",
    "transparency/k_buffer_single_pass_emit",
    "transparency/k_buffer_single_pass_word",
    "transparency/k_plus_buffer",
    "transparency/k_plus_buffer_emit",
    "transparency/k_plus_buffer_emit_32",
    "transparency/k_plus_buffer_emit_64",
    "transparency/k_plus_buffer_word",
    "transparency/moment",
    "transparency/moment_emit",
    "transparency/moment_emit_colour",
    "transparency/moment_transmittance",
    "transparency/a_buffer_store",
    "transparency/a_buffer_tiles",
    "transparency/a_buffer_whole",
    "transparency/dbk_buffer",
    "transparency/dbk_buffer_beyond",
    "transparency/dbk_buffer_common",
    "transparency/dbk_buffer_cut",
    "transparency/dbk_buffer_depths",
    "transparency/dbk_buffer_drop",
    "transparency/dbk_buffer_emit",
    "composite",
    "gather",
    "guided",
    "guided_mesh",
    "guided_frames",
    "guided_clumps",
    "receive",
    "occluder",
    "occluder_none",
    "shadow_image",
    "shadow_image_none",
    "outputs",
    "outputs_none",
];

/// What every module begins with.
const COMMON: &[&str] = &["common/layout", "common/frame", "common/optical_depth"];

/// A module to be joined: header constants, then files by stem.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub(crate) struct Module {
    pub constants: Vec<(&'static str, Constant)>,
    pub files: Vec<&'static str>,
}

/// A header constant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Constant {
    U32(u32),
    Bool(bool),
}

/// A joined module and where its lines come from.
pub(crate) struct Joined {
    pub source: String,
    /// First line (from 1) of each file in `source`.
    starts: Vec<(usize, &'static str)>,
}

impl Module {
    pub fn new(files: &[&'static str]) -> Self {
        Self {
            constants: Vec::new(),
            files: files.to_vec(),
        }
    }

    pub fn and(mut self, files: &[&'static str]) -> Self {
        self.files.extend_from_slice(files);
        self
    }

    pub fn with(mut self, name: &'static str, constant: Constant) -> Self {
        self.constants.push((name, constant));
        self
    }

    pub fn join(&self) -> Joined {
        let mut source = format!(
            "const MAX_LIGHTS: u32 = {}u;\nconst MAX_SHADOW_VIEWS: u32 = {}u;\nconst MAX_OCCLUDERS: u32 = {}u;\n",
            layout::MAX_LIGHTS,
            layout::MAX_SHADOW_VIEWS,
            layout::MAX_OCCLUDERS
        );
        for (name, constant) in &self.constants {
            source += &match constant {
                Constant::U32(value) => format!("const {name}: u32 = {value}u;\n"),
                Constant::Bool(value) => format!("const {name}: bool = {value};\n"),
            };
        }
        let mut starts = Vec::new();
        for stem in COMMON.iter().chain(&self.files) {
            starts.push((source.lines().count() + 1, *stem));
            source += file(stem);
        }
        Joined { source, starts }
    }
}

impl Joined {
    /// The file and line that a line of the joined source came from.
    pub fn origin(&self, line: usize) -> String {
        match self.starts.iter().rev().find(|(start, _)| *start <= line) {
            Some((start, stem)) => format!("shaders/{stem}.wgsl:{}", line - start + 1),
            None => format!("header:{line}"),
        }
    }
}

/// The text of a file; an unknown stem is our own fault.
fn file(stem: &str) -> &'static str {
    let found = FILES.iter().find(|(name, _)| *name == stem);
    assert!(found.is_some(), "no shader file has the stem {stem}");
    found.map_or("", |(_, text)| text)
}
