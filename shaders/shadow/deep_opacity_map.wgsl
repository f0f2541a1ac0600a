// Deep opacity map: the look-up. Opacity is interpolated linearly between a texel's layers; points past the last layer
// take its whole sum. The filter averages transmittance over a box of `pcf` texels centred on the point.

@group(2) @binding(0) var<storage, read> shadow_maps: array<u32>;

struct ShadowSample {
    transmittance: vec3f,
    // Σ coverage of the fibres towards the light.
    fibres: f32,
}

// Optical depth in front of a depth, in one texel.
fn deep_opacity_map_depth(place: vec2u, map: u32, light: u32, depth: f32) -> f32 {
    let resolution = frame.lights[light].resolution;
    let texel = place.y * resolution + place.x;
    let front_place = frame.shadow_views[map].front_base + deep_opacity_front_place(place, resolution);
    let front = deep_opacity_front(shadow_maps[front_place]);
    let count = frame.lights[light].layer_count;
    let behind = (depth - front) / frame.lights[light].layer_extent;
    if !(behind > 0.0) { return 0.0; }
    let layer = deep_opacity_layer(behind, count);
    let word = frame.shadow_views[map].layer_base + texel * count + layer;
    var sum = 0.0;
    if layer > 0u { sum = f32(shadow_maps[word - 1u]); }
    let low = deep_opacity_boundary(f32(layer) / f32(count));
    let high = deep_opacity_boundary(f32(layer + 1u) / f32(count));
    let part = clamp((behind - low) / (high - low), 0.0, 1.0);
    return mix(sum, f32(shadow_maps[word]), part) / OPTICAL_DEPTH_SCALE;
}

// The map of a light that sees a position: the cube's face by the largest component, or the only map.
fn deep_opacity_map_face(position: vec3f, light: u32) -> u32 {
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
    let map = deep_opacity_map_face(position, light);
    let resolution = i32(frame.lights[light].resolution);
    let clip = frame.shadow_views[map].clip_from_relative * vec4f(position, 1.0);
    let place = vec2f(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w) * f32(resolution);
    let depth = dot(frame.shadow_views[map].depth_row, vec4f(position, 1.0)) - frame.lights[light].bias;

    // The box reaches over pcf + 1 texels a side; the rims weigh by the part of them inside.
    let corner = place - 0.5 * f32(width);
    let first = floor(corner);
    let offset = corner - first;
    var transmittance = 0.0;
    var fibres = 0.0;
    for (var y = 0; y <= width; y++) {
        let row = i32(first.y) + y;
        let weight_y = select(select(1.0, offset.y, y == width), 1.0 - offset.y, y == 0);
        for (var x = 0; x <= width; x++) {
            let column = i32(first.x) + x;
            let weight = weight_y * select(select(1.0, offset.x, x == width), 1.0 - offset.x, x == 0);
            var sum = 0.0;
            if row >= 0 && row < resolution && column >= 0 && column < resolution {
                sum = deep_opacity_map_depth(vec2u(vec2i(column, row)), map, light, depth);
            }
            transmittance += weight * exp(-sum);
            fibres += weight * sum;
        }
    }
    let area = f32(width * width);
    return ShadowSample(vec3f(transmittance / area), fibres / area);
}

fn shadow(position: vec3f, light: u32) -> ShadowSample {
    return shadow_filtered(position, light, i32(frame.lights[light].pcf));
}

// The shadow on the host's opaque scene, where many more points than the hair's are looked up: a filter two texels
// narrower, at least one.
fn shadow_received(position: vec3f, light: u32) -> ShadowSample {
    return shadow_filtered(position, light, max(i32(frame.lights[light].pcf) - 2, 1));
}
