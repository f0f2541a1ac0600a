// Every struct that Rust and WGSL share. `src/layout.rs` holds the same fields in the same order; a test compares
// sizes and offsets as naga reads them.

// One dispatch or draw: a run of one hair's strands, as a view or a light sees it. Relative space is world space
// with the eye of the frame's view as its origin, so that large world coordinates cost no precision. For maps its origin is
// the middle of all hair, and what follows `map_colour` is zero: nothing of a map's drawing depends on the view.
struct Drawing {
    clip_from_relative: mat4x4f,
    relative_from_object: mat4x4f,
    // Position of the eye (w = 1) or direction towards it (w = 0), in relative space.
    eye: vec4f,
    // Stored depth = dot(depth_row, position), over w where DRAWING_DEPTH_OVER_W is set.
    depth_row: vec4f,
    // Pixels or texels.
    viewport: vec2f,
    // Length in relative space of a length of one in object space.
    radius_scale: f32,
    opacity: f32,
    // Number of points of the run, and where the run starts among the frame's pooled points.
    point_count: u32,
    point_base: u32,
    flags: u32,
    // Workgroups that share one segment's pixels (wide fibres).
    splits: u32,
    // First word of this map's fronts and of its layers in the shadow maps, and words a texel of the latter.
    front_base: u32,
    layer_base: u32,
    layer_count: u32,
    padding_3: u32,
    // Rows of the view that this pass treats; pooled pixels are numbered from `row_first`.
    row_first: u32,
    row_end: u32,
    // The run's first chunk in the sort of sorted blending.
    chunk_base: u32,
    // The hair's place in the frame, and its instance in the upper 16 bits.
    hair: u32,
    // The shadow technique's values, in the order in which its files read them.
    map_values: vec4f,
    // What its fibres do to each channel.
    map_colour: vec4f,
    // Clip space of this frame and of the one before, y up, from the object space of this frame's and that one's points.
    clip_from_object: mat4x4f,
    previous_clip_from_object: mat4x4f,
    // How much of a point's motion is the views' jitter, in pixels.
    jitter_motion: vec2f,
    // Where per-fragment shading keeps the run's parameters, in vectors; the run's number; the hair's largest radius, in
    // relative space.
    fibre_run: u32,
    fibre_run_number: u32,
    largest_radius: f32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

const DRAWING_DEPTH_OVER_W: u32 = 1u;
const DRAWING_REVERSE_Z: u32 = 2u;
const DRAWING_HOST_DEPTH: u32 = 4u;

// Pixels a side of the tiles that know the host's farthest depth.
const HOST_TILE: u32 = 4u;

struct Light {
    // Position (w = 1) or direction towards the light (w = 0), in relative space.
    place: vec4f,
    // Irradiance on a plane facing it, or intensity (w = 1).
    power: vec3f,
    // Maps of this light: none where it casts no shadow, 1, or 6 as a cube.
    map_count: u32,
    map_first: u32,
    resolution: u32,
    // Width of the filter in texels.
    pcf: u32,
    // Words a texel of the maps' layers.
    layer_count: u32,
    // Depth by which a shaded point is moved towards the light.
    bias: f32,
    // Of a spot: the cosine of the angle from which on nothing is lit, one over how much higher that is where all is, and
    // the axis; of others the axis is zero, and everything is lit.
    cos_outer: f32,
    edge: f32,
    padding_0: f32,
    axis: vec3f,
    padding_1: f32,
}

struct ShadowView {
    clip_from_relative: mat4x4f,
    // Distance along the map's axis = dot(depth_row, position).
    depth_row: vec4f,
    // As in the map's drawings.
    front_base: u32,
    layer_base: u32,
    padding_0: u32,
    padding_1: u32,
    values: vec4f,
    colour: vec4f,
}

// A shadow map of the host's.
struct Occluder {
    clip_from_relative: mat4x4f,
    // The light's number.
    light: u32,
    // Width of the filter in texels.
    pcf: u32,
    // How far a point is moved towards the light.
    bias: f32,
    flags: u32,
}

const OCCLUDER_REVERSE_Z: u32 = 1u;

struct Frame {
    ambient: vec3f,
    light_count: u32,
    // Position of the eye (w = 1) or direction towards it (w = 0), in relative space.
    eye: vec4f,
    // Relative space from clip space, to find the point that a host's depth stands for.
    relative_from_clip: mat4x4f,
    width: u32,
    height: u32,
    // Fragments that the pool holds.
    capacity: u32,
    flags: u32,
    // Steps a unit of radiance of the overflow tail's fixed-point colours.
    tail_scale: f32,
    // The largest run's points, and the rows of workgroups of its walk.
    run_points: u32,
    run_rows: u32,
    // What lies behind this transmittance is not composited.
    unseen: f32,
    // The pixel of the target that the view begins at.
    origin: vec2u,
    // DBK-buffer: optical depth beyond which nothing is stored, and the depth shift in host units where that decides.
    cut_depth: f32,
    depth_shift: f32,
    // Where the runs' parameters begin among the points of per-fragment shading, in vectors.
    fibre_runs: u32,
    // What strands' hashes are made with.
    seed: u32,
    // The nearest depth key of the frame's hair; and how a fragment's word is parted, from the lowest eight bits: bits by which keys
    // are shifted, bits of the point in the upper half, bits below it in the lower, bits by which keys are shifted to place the
    // DBK-buffer's bins.
    key_first: u32,
    word_bits: u32,
    // A depth's place in the extent of all hair along the view's axis, from 0 to 1: (x depth + y) / (z depth + w).
    place_of_depth: vec4f,
    // Settings of the transparency technique, in the order in which its files read them.
    technique: vec4f,
    occluder_count: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
    lights: array<Light, MAX_LIGHTS>,
    shadow_views: array<ShadowView, MAX_SHADOW_VIEWS>,
    occluders: array<Occluder, MAX_OCCLUDERS>,
}

const FRAME_REVERSE_Z: u32 = 1u;
// Each pixel's nearest fragment is sought, for outputs or the host's depth.
const FRAME_NEAREST: u32 = 2u;

// The parameters of a hair's shading model, in the order in which its file reads them.
struct Material {
    values: array<vec4f, MATERIAL_VECTORS>,
}

const MATERIAL_VECTORS: u32 = 16u;

// Vectors of a point, and of a run, in the pool of per-fragment shading.
const FIBRE_POINT_VECTORS: u32 = 2u;
const FIBRE_RUN_VECTORS: u32 = 17u;
// A fibre and the ways to light and eye, of unit length, at which a model is evaluated by itself.
struct Sample {
    tangent: vec3f,
    // Root-to-tip coordinate.
    coordinate: f32,
    to_light: vec3f,
    // Of the light that comes straight, and how many fibres are towards it.
    transmittance: f32,
    to_eye: vec3f,
    fibres: f32,
    colour: vec3f,
    strand: u32,
    // The part of the fibre's width that is seen.
    across: vec2f,
    padding_0: f32,
    padding_1: f32,
}

// Parts of a dispatch whose work is spread, a power of two: its workgroups are a multiple of them.
const SPREAD_PARTS: u32 = 64u;

// The most fragments of one pixel that counted arrays store: to order more would take more steps than some drivers' loops
// have. The rest goes to the pixel's tail.
const PIXEL_MOST: u32 = 8192u;

// Counters of a frame, read back by the host some frames later.
struct Counters {
    produced: atomic<u32>,
    culled: atomic<u32>,
    stored: atomic<u32>,
    merged: atomic<u32>,
    // 1 where the pool is too small for this frame, or a pixel has more than it may store.
    overflow: atomic<u32>,
    covered: atomic<u32>,
    crowded: atomic<u32>,
    padding_0: u32,
    // Arguments of the overflow's walks and ribbons: all zero, and so none is run, where the pool suffices.
    walk_arguments: vec4u,
    ribbon_arguments: vec4u,
}

// A strand's point as the host gave it.
struct Point {
    position: vec3f,
    radius: f32,
}

// One dispatch of `gather`: the points that come from the host's points `first` to `end`, within one run.
struct Gather {
    // The new origin of the hair's points, and what single precision cuts off it.
    origin: vec3f,
    first: u32,
    origin_rest: vec3f,
    end: u32,
    // The former origin as seen from the new one.
    shift: vec3f,
    // The host's point that the bound part begins with, and the word at which.
    lowest: u32,
    base: u32,
    // Words from one of the host's points to the next.
    stride: u32,
    // Straight pieces of each of the host's segments.
    pieces: u32,
    // Points of the run.
    count: u32,
}

// No point of the host's: padding between runs.
const NO_PLACE: u32 = 0xffffffffu;

// One dispatch of the shaders `guided…`.
struct Guided {
    // The word at which the source's first position begins, and words from one to the next.
    source_base: u32,
    stride: u32,
    // Invocations.
    count: u32,
    // Points of every guide and strand on a mesh.
    points_each: u32,
    // Followers of each guide.
    followers: u32,
    // The words at which the first follower and the first strand of this dispatch begin, and the guide that it begins with.
    followers_base: u32,
    strands_base: u32,
    first_guide: u32,
    // The followers' distance at the tip over that at the root.
    tip_factor: f32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

// A strand between three guides: their weights at the root and at the tip, and the tip's displacement over its length.
struct Placement {
    root: vec3f,
    guide_0: u32,
    tip: vec3f,
    guide_1: u32,
    stray: vec3f,
    guide_2: u32,
}

// `strand` holds the strand's number and the two flags below.
struct PointAttributes {
    strand: u32,
    // Root-to-tip coordinate.
    coordinate: f32,
}

const POINT_FIRST: u32 = 0x80000000u;
const POINT_LAST: u32 = 0x40000000u;
const POINT_STRAND: u32 = 0x3fffffffu;

// What the outputs beside the colour say of a point: motion on the screen in pixels, and whose it is.
struct PointOutput {
    motion: vec2f,
    hair: u32,
    strand: u32,
}

// A point as a view or a light sees it. Pairs, since some drivers take as long to load one word as two.
struct Projected {
    // In pixels.
    position: vec2f,
    // Depth, and half-width in pixels.
    depth_width: vec2f,
    // The bisector, which is the unit normal of the plane that parts the point's two segments (2 × snorm16); and the flags:
    // PROJECTED_… below, and how far it is along the strand to its first and its last point, in pixels up to 1, in 12
    // bits each.
    bisector_flags: vec2u,
}

// Points no farther than this from each other on the screen tell no direction: what single precision gets wrong of a place in an
// image of 1000 pixels, 1e-4, turns what is longer by less than 0.03. So a segment that points at the eye turns no joint.
const PROJECTED_DIRECTION_PX: f32 = 0.00390625;
const PROJECTED_FIRST: u32 = 0x80000000u;
const PROJECTED_LAST: u32 = 0x40000000u;
// The turn is so sharp that both segments end here.
const PROJECTED_BREAK: u32 = 0x20000000u;
// Behind the near plane; the next two say which of the point's segments cross it. Position, depth and half-width are
// then those of the crossing. Where both cross they are the following segment's, except that the depth, which is the
// near plane's, holds the last one's half-width, and the bisector its position. The two distances are places along the last and along the following segment instead.
const PROJECTED_BEHIND: u32 = 0x10000000u;
const PROJECTED_CUT_START: u32 = 0x08000000u;
const PROJECTED_CUT_END: u32 = 0x04000000u;
// The segment that begins here lies outside the image or behind the host's opaque scene.
const PROJECTED_UNSEEN: u32 = 0x02000000u;
// It lies before all of the host's opaque scene that it may cover.
const PROJECTED_IN_FRONT: u32 = 0x01000000u;
// Range of that packing, in widths or heights of the image.
const PROJECTED_SECOND_RANGE: f32 = 2.0;
const PROJECTED_DISTANCE_BITS: u32 = 12u;
const PROJECTED_DISTANCE_MAX: u32 = 0xfffu;
