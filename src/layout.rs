//! Every struct shared with WGSL, and nowhere else: `shaders/common/layout.wgsl` holds the same fields in the same
//! order. A test compares sizes and offsets as naga reads them.

use bytemuck::{Pod, Zeroable};

/// The most lights that one frame takes.
pub const MAX_LIGHTS: usize = 16;
/// The most maps that all lights of one frame take; a point light inside the hair takes six.
pub const MAX_SHADOW_VIEWS: usize = 32;
/// The most shadow maps of the host's that one frame takes.
pub const MAX_OCCLUDERS: usize = 8;
/// The distance of uniform blocks, which every device takes.
pub const UNIFORM_STRIDE: u64 = 256;

pub const DRAWING_DEPTH_OVER_W: u32 = 1;
pub const DRAWING_REVERSE_Z: u32 = 2;
pub const DRAWING_HOST_DEPTH: u32 = 4;
pub const FRAME_REVERSE_Z: u32 = 1;
pub const OCCLUDER_REVERSE_Z: u32 = 1;
pub const FRAME_NEAREST: u32 = 2;
pub const POINT_FIRST: u32 = 0x8000_0000;
pub const POINT_LAST: u32 = 0x4000_0000;
pub const POINT_STRAND: u32 = 0x3fff_ffff;
/// Pixels a side of the tiles that know the host's farthest depth; the same in WGSL.
pub const HOST_TILE: u32 = 4;
/// Words a pixel of the overflow buffer; `OVERFLOW_WORDS` in WGSL.
pub const OVERFLOW_WORDS: u64 = 7;
/// Vectors of a hair's shading parameters; the same in WGSL.
pub const MATERIAL_VECTORS: usize = 16;
/// Vectors of a point, and of a run, in the pool of per-fragment shading; the same in WGSL.
pub const FIBRE_POINT_VECTORS: u64 = 2;
pub const FIBRE_RUN_VECTORS: u64 = 17;
/// Bits of a stored fragment's place along its segment, and of place and opacity at most; the same in WGSL.
pub const WORD_ALONG_BITS: u32 = 8;
pub const WORD_VALUE_BITS_MOST: u32 = WORD_ALONG_BITS + 16;
/// Keys by which segments are ordered; `ORDER_KEYS` in WGSL.
pub const ORDER_KEYS: u64 = 2048;
/// Parts of a dispatch whose work is spread; `SPREAD_PARTS` in WGSL.
pub const SPREAD_PARTS: u32 = 64;
/// Pixels that one workgroup of the scan treats; `SCAN_BLOCK` in WGSL.
pub const SCAN_BLOCK: u32 = 2048;

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Drawing {
    pub clip_from_relative: [[f32; 4]; 4],
    pub relative_from_object: [[f32; 4]; 4],
    pub eye: [f32; 4],
    pub depth_row: [f32; 4],
    pub viewport: [f32; 2],
    pub radius_scale: f32,
    pub opacity: f32,
    pub point_count: u32,
    pub point_base: u32,
    pub flags: u32,
    pub splits: u32,
    pub front_base: u32,
    pub layer_base: u32,
    pub layer_count: u32,
    pub padding_3: u32,
    pub row_first: u32,
    pub row_end: u32,
    pub chunk_base: u32,
    pub hair: u32,
    pub map_values: [f32; 4],
    pub map_colour: [f32; 4],
    pub clip_from_object: [[f32; 4]; 4],
    pub previous_clip_from_object: [[f32; 4]; 4],
    pub jitter_motion: [f32; 2],
    pub fibre_run: u32,
    pub fibre_run_number: u32,
    pub largest_radius: f32,
    pub padding_0: u32,
    pub padding_1: u32,
    pub padding_2: u32,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Light {
    pub place: [f32; 4],
    pub power: [f32; 3],
    pub map_count: u32,
    pub map_first: u32,
    pub resolution: u32,
    pub pcf: u32,
    pub layer_count: u32,
    pub bias: f32,
    pub cos_outer: f32,
    pub edge: f32,
    pub padding_0: f32,
    pub axis: [f32; 3],
    pub padding_1: f32,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct ShadowView {
    pub clip_from_relative: [[f32; 4]; 4],
    pub depth_row: [f32; 4],
    pub front_base: u32,
    pub layer_base: u32,
    pub padding_0: u32,
    pub padding_1: u32,
    pub values: [f32; 4],
    pub colour: [f32; 4],
}

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Occluder {
    pub clip_from_relative: [[f32; 4]; 4],
    pub light: u32,
    pub pcf: u32,
    pub bias: f32,
    pub flags: u32,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Frame {
    pub ambient: [f32; 3],
    pub light_count: u32,
    pub eye: [f32; 4],
    pub relative_from_clip: [[f32; 4]; 4],
    pub width: u32,
    pub height: u32,
    pub capacity: u32,
    pub flags: u32,
    pub tail_scale: f32,
    pub run_points: u32,
    pub run_rows: u32,
    pub unseen: f32,
    pub origin: [u32; 2],
    pub cut_depth: f32,
    pub depth_shift: f32,
    pub fibre_runs: u32,
    pub seed: u32,
    pub key_first: u32,
    pub word_bits: u32,
    pub place_of_depth: [f32; 4],
    pub technique: [f32; 4],
    pub occluder_count: u32,
    pub padding_0: u32,
    pub padding_1: u32,
    pub padding_2: u32,
    pub lights: [Light; MAX_LIGHTS],
    pub shadow_views: [ShadowView; MAX_SHADOW_VIEWS],
    pub occluders: [Occluder; MAX_OCCLUDERS],
}

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
pub struct Material {
    pub values: [[f32; 4]; MATERIAL_VECTORS],
}

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
pub struct Sample {
    pub tangent: [f32; 3],
    pub coordinate: f32,
    pub to_light: [f32; 3],
    pub transmittance: f32,
    pub to_eye: [f32; 3],
    pub fibres: f32,
    pub colour: [f32; 3],
    pub strand: u32,
    pub across: [f32; 2],
    pub padding_0: f32,
    pub padding_1: f32,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Pod, Zeroable)]
pub struct Counters {
    pub produced: u32,
    pub culled: u32,
    pub stored: u32,
    pub merged: u32,
    pub overflow: u32,
    pub covered: u32,
    pub crowded: u32,
    pub padding_0: u32,
    pub walk_arguments: [u32; 4],
    pub ribbon_arguments: [u32; 4],
}

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Point {
    pub position: [f32; 3],
    pub radius: f32,
}

/// No point of the host's: padding between runs; the same in WGSL.
pub const NO_PLACE: u32 = u32::MAX;

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Gather {
    pub origin: [f32; 3],
    pub first: u32,
    pub origin_rest: [f32; 3],
    pub end: u32,
    pub shift: [f32; 3],
    pub lowest: u32,
    pub base: u32,
    pub stride: u32,
    pub pieces: u32,
    pub count: u32,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
pub struct Guided {
    pub source_base: u32,
    pub stride: u32,
    pub count: u32,
    pub points_each: u32,
    pub followers: u32,
    pub followers_base: u32,
    pub strands_base: u32,
    pub first_guide: u32,
    pub tip_factor: f32,
    pub padding_0: u32,
    pub padding_1: u32,
    pub padding_2: u32,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Placement {
    pub root: [f32; 3],
    pub guide_0: u32,
    pub tip: [f32; 3],
    pub guide_1: u32,
    pub stray: [f32; 3],
    pub guide_2: u32,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct PointAttributes {
    pub strand: u32,
    pub coordinate: f32,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct PointOutput {
    pub motion: [f32; 2],
    pub hair: u32,
    pub strand: u32,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Projected {
    pub position: [f32; 2],
    pub depth_width: [f32; 2],
    pub bisector_flags: [u32; 2],
}
