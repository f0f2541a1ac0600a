// A point's own fibre as a light's map holds it: the fragment that it has left in each texel around the point, found anew
// at the look-up and taken off what the texel sums up. So a fibre does not shadow itself, and no bias is needed, which
// would skip the fibres close in front of it too.
//
// Around the point the strand is taken for the two segments that meet there, prolonged: what the rasteriser drew, as far
// as they reach, by the same rule: the bisector at the point says whose a texel is, its band how much of it is covered.

struct ShadowFibre {
    // The strand's points next to this one, in relative space; the point itself where there is none.
    before: vec3f,
    after: vec3f,
    radius: f32,
    // 0 for a point in the air.
    opacity: f32,
    // Whether the strand begins at `before`, and ends at `after`.
    starts: bool,
    ends: bool,
}

// Of one of the two segments on the map, in texels.
struct ShadowOwnSide {
    // Away from the point.
    tangent: vec2f,
    // Depth a texel.
    slope: f32,
    length: f32,
    footprint: Footprint,
}

struct ShadowOwn {
    optical_depth: f32,
    depth: f32,
    // Whether it touches the texel anywhere, also beside what sums look at.
    touches: bool,
}

// Where the fibre hides more of a texel than this, how much it leaves is rounding: all of the light is what it took.
const SHADOW_OWN_OPAQUE: f32 = 0.93;
// Points closer than this on the map give no direction.
const SHADOW_OWN_COINCIDENT: f32 = 1e-4;
// As PROJECT_DEGENERATE_TANGENT.
const SHADOW_OWN_DEGENERATE: f32 = 1e-4;

// The fibre of the point that is shaded; set by the shading, zero elsewhere.
var<private> shadow_fibre: ShadowFibre;
var<private> shadow_own_place: vec2f;
var<private> shadow_own_depth: f32;
var<private> shadow_own_bisector: vec2f;
var<private> shadow_own_half_width: f32;
var<private> shadow_own_before: ShadowOwnSide;
var<private> shadow_own_after: ShadowOwnSide;

fn shadow_own_pixel(clip: vec4f, resolution: f32) -> vec2f {
    return vec2f(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w) * resolution;
}

fn shadow_own_unit(v: vec3f) -> vec3f {
    return v / max(length(v), 1e-30);
}

// As the rasterisers choose it.
fn shadow_own_footprint(normal: vec2f) -> Footprint {
    if shadow_own_half_width > FOOTPRINT_SLICE_MOST { return footprint(normal); }
    return footprint_slice(normal);
}

fn shadow_own_side(neighbour: vec3f, map: u32, resolution: f32) -> ShadowOwnSide {
    let clip = frame.shadow_views[map].clip_from_relative * vec4f(neighbour, 1.0);
    let offset = shadow_own_pixel(clip, resolution) - shadow_own_place;
    let distance = length(offset);
    let depth = dot(frame.shadow_views[map].depth_row, vec4f(neighbour, 1.0));
    if !(distance > SHADOW_OWN_COINCIDENT) || clip.w <= 0.0 {
        return ShadowOwnSide(vec2f(0.0), 0.0, 0.0, shadow_own_footprint(vec2f(1.0, 0.0)));
    }
    let tangent = offset / distance;
    return ShadowOwnSide(tangent, (depth - shadow_own_depth) / distance, distance, shadow_own_footprint(tangent.yx));
}

// Finds the fibre on the map, whose clip space and depths the point has these values in.
fn shadow_own_begin(position: vec3f, clip: vec4f, depth: f32, map: u32, light: u32) {
    if shadow_fibre.opacity <= 0.0 { return; }
    let resolution = f32(frame.lights[light].resolution);
    shadow_own_place = shadow_own_pixel(clip, resolution);
    shadow_own_depth = depth;
    // Half of the silhouette's width, as the projection finds it.
    let place = frame.lights[light].place;
    let strand = shadow_own_unit(shadow_fibre.after - position) + shadow_own_unit(position - shadow_fibre.before);
    let outwards = shadow_own_unit(cross(strand, place.xyz - position * place.w));
    let c = frame.shadow_views[map].clip_from_relative * vec4f(outwards * shadow_fibre.radius, 0.0);
    let a = frame.shadow_views[map].clip_from_relative * vec4f(shadow_own_unit(strand) * shadow_fibre.radius, 0.0);
    let ndc = clip.xy / clip.w;
    let offset = (c.xy - ndc * c.w) / max(clip.w + c.w, 1e-30) * 0.5 * resolution;
    let along = (a.xy - ndc * a.w) / clip.w * 0.5 * resolution;
    shadow_own_half_width = length(offset);
    if length(along) > SHADOW_OWN_DEGENERATE * shadow_own_half_width {
        shadow_own_half_width = abs(offset.x * along.y - offset.y * along.x) / length(along);
    }

    shadow_own_before = shadow_own_side(shadow_fibre.before, map, resolution);
    shadow_own_after = shadow_own_side(shadow_fibre.after, map, resolution);
    // Where one side has no length on the map the other goes on straight.
    if all(shadow_own_before.tangent == vec2f(0.0)) {
        shadow_own_before = ShadowOwnSide(-shadow_own_after.tangent, -shadow_own_after.slope, 0.0, shadow_own_after.footprint);
    }
    if all(shadow_own_after.tangent == vec2f(0.0)) {
        shadow_own_after = ShadowOwnSide(-shadow_own_before.tangent, -shadow_own_before.slope, 0.0, shadow_own_before.footprint);
    }
    let sum = shadow_own_after.tangent - shadow_own_before.tangent;
    shadow_own_bisector = sum / max(length(sum), 1e-12);
}

// The fibre's fragment in a texel.
fn shadow_own(texel: vec2u) -> ShadowOwn {
    if shadow_fibre.opacity <= 0.0 { return ShadowOwn(0.0, 0.0, false); }
    let centre = vec2f(texel) + 0.5 - shadow_own_place;
    let is_after = dot(centre, shadow_own_bisector) >= 0.0;
    var side = shadow_own_before;
    if is_after { side = shadow_own_after; }
    let along = dot(centre, side.tangent);
    let normal = vec2f(side.tangent.y, -side.tangent.x);
    let across = dot(centre, normal);
    // Beyond the strand's end there is none of it.
    let ends = select(shadow_fibre.starts, shadow_fibre.ends, is_after);
    var cut = 1.0;
    if ends && shadow_own_half_width <= FOOTPRINT_SLICE_MOST {
        cut = coverage_slice_ends(normal, across, -2.0, min(side.length - along, 2.0));
    } else if ends {
        cut = clamp(0.5 + side.length - along, 0.0, 1.0);
    }
    let opacity = shadow_fibre.opacity * cut * coverage_band(side.footprint, across, shadow_own_half_width);
    let taken = select(optical_depth(opacity), OPTICAL_DEPTH_OPAQUE, opacity > SHADOW_OWN_OPAQUE);
    let reach = shadow_own_half_width + 0.5 * (abs(normal.x) + abs(normal.y));
    let touches = abs(across) < reach && !(ends && along >= side.length + 0.5);
    return ShadowOwn(select(0.0, taken, opacity > 0.0), shadow_own_depth + along * side.slope, touches);
}
