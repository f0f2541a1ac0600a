// The look-up in a light's maps, as all techniques share it: which map sees a position, and a box filter over the
// texels, each of which the technique's own `shadow_texel(texel, map, light, depth) -> ShadowTexel` looks up. What is
// averaged is transmittance, so that the filter blurs a shadow's edge as a light of that size would.

@group(2) @binding(0) var<storage, read> shadow_maps: array<u32>;

struct ShadowSample {
    transmittance: vec3f,
    // Σ coverage of the fibres towards the light.
    fibres: f32,
}

// The same of one texel, from its front to a depth along the map's axis. Where a technique sums optical depths
// `shadow_passed(optical_depth, map)` says what they leave.
struct ShadowTexel {
    transmittance: vec3f,
    fibres: f32,
}

// What single precision gets wrong of a depth, as a part of the terms that it is the sum of: a few roundings. Those of a point that
// is far from the eye, but close behind another one, are large beside its depth.
const SHADOW_DEPTH_ROUNDING: f32 = 4.8e-7;

// Of the position that is looked up.
var<private> shadow_depth_rounding: f32;

// The map of a light that sees a position: the cube's face by the largest component, or the only map.
fn shadow_face(position: vec3f, light: u32) -> u32 {
    if frame.lights[light].map_count == 1u { return frame.lights[light].map_first; }
    let d = position - frame.lights[light].place.xyz;
    let m = abs(d);
    var face = select(0u, 1u, d.x < 0.0);
    if m.y > m.x && m.y >= m.z { face = select(2u, 3u, d.y < 0.0); }
    if m.z > m.x && m.z > m.y { face = select(4u, 5u, d.z < 0.0); }
    return frame.lights[light].map_first + face;
}

// The shadow at a position, with a filter of `width` texels.
fn shadow_filtered(position: vec3f, light: u32, width: i32) -> ShadowSample {
    if frame.lights[light].map_count == 0u { return ShadowSample(vec3f(1.0), 0.0); }
    let map = shadow_face(position, light);
    let resolution = i32(frame.lights[light].resolution);
    let clip = frame.shadow_views[map].clip_from_relative * vec4f(position, 1.0);
    let place = vec2f(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w) * f32(resolution);
    let depth_row = frame.shadow_views[map].depth_row;
    let exact = dot(depth_row, vec4f(position, 1.0));
    shadow_depth_rounding = SHADOW_DEPTH_ROUNDING * dot(abs(depth_row), abs(vec4f(position, 1.0)));
    let depth = exact - frame.lights[light].bias;
    shadow_own_begin(position, clip, exact, map, light);

    // The box reaches over pcf + 1 texels a side; the rims weigh by the part of them inside.
    let corner = place - 0.5 * f32(width);
    let first = floor(corner);
    let offset = corner - first;
    var transmittance = vec3f(0.0);
    var fibres = 0.0;
    for (var y = 0; y <= width; y++) {
        let row = i32(first.y) + y;
        let weight_y = select(select(1.0, offset.y, y == width), 1.0 - offset.y, y == 0);
        for (var x = 0; x <= width; x++) {
            let column = i32(first.x) + x;
            let weight = weight_y * select(select(1.0, offset.x, x == width), 1.0 - offset.x, x == 0);
            var texel = ShadowTexel(vec3f(1.0), 0.0);
            if row >= 0 && row < resolution && column >= 0 && column < resolution {
                texel = shadow_texel(vec2u(vec2i(column, row)), map, light, depth);
            }
            transmittance += weight * texel.transmittance;
            fibres += weight * texel.fibres;
        }
    }
    let area = f32(width * width);
    return ShadowSample(transmittance / area, fibres / area);
}

fn shadow(position: vec3f, light: u32) -> ShadowSample {
    return shadow_filtered(position, light, i32(frame.lights[light].pcf));
}

// The shadow on the host's opaque scene, where many more points than the hair's are looked up: a filter two texels
// narrower, at least one. Maps of nearest depths alone, which have no layers, hold fibres that texels' centres happen to lie on: what
// hair hides by its colours shows on skin as dots, unless five texels are averaged.
fn shadow_received(position: vec3f, light: u32) -> ShadowSample {
    let pcf = i32(frame.lights[light].pcf);
    return shadow_filtered(position, light, select(max(pcf - 2, 1), max(pcf, 5), frame.lights[light].layer_count == 0u));
}
