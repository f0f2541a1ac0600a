// Opaque: the colour of a pixel's nearest fragment, at the whole opacity of all its fragments, so that silhouettes
// stay soft and fibres thinner than a pixel fade instead of breaking into dots.

@group(3) @binding(1) var<storage, read> fill: array<u32>;
@group(3) @binding(2) var<storage, read> links: array<u32>;
@group(3) @binding(3) var<storage, read> fragment_keys: array<u32>;

struct Resolved {
    // Premultiplied.
    colour: vec4f,
    // Key of the nearest fragment.
    key: u32,
}

fn resolve(pixel: vec2u) -> Resolved {
    pixels_begin();
    shaded_begin(pixel);
    let number = pixel_number(pixel);
    if fill[number] == 0u { return Resolved(vec4f(0.0), 0xffffffffu); }
    let winner = 0xffffffffu - links[number];
    let colour = shaded_colour(winner >> 8u, f32(winner & 255u) / 255.0);
    let opacity = 1.0 - exp(-f32(fragment_keys[number]) / OPTICAL_DEPTH_SCALE);
    return Resolved(vec4f(colour * opacity, opacity), 0xffffffffu - fill[number]);
}

fn nearest(pixel: vec2u) -> Nearest {
    pixels_begin();
    let number = pixel_number(pixel);
    if fill[number] == 0u { return Nearest(0xffffffffu, 0xffffffffu, 0.0, 0.0); }
    let winner = 0xffffffffu - links[number];
    let opacity = 1.0 - exp(-f32(fragment_keys[number]) / OPTICAL_DEPTH_SCALE);
    return Nearest(0xffffffffu - fill[number], winner >> 8u, f32(winner & 255u) / 255.0, opacity);
}
