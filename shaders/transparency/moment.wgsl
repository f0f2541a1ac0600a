// Moment-based transparency (Münstermann et al. 2018; Sharpe 2018): the resolve. The weighted mean of a pixel's colours at the
// exact opacity of all its fragments.

@group(3) @binding(1) var<storage, read> fill: array<u32>;
@group(3) @binding(3) var<storage, read> moments: array<u32>;
@group(3) @binding(5) var<storage, read> overflow: array<u32>;

struct Resolved {
    // Premultiplied.
    colour: vec4f,
    // Key of the nearest fragment.
    key: u32,
}

fn moment_opacity(number: u32) -> f32 {
    let words = number * MOMENT_WORDS;
    return 1.0 - exp(-moment_sum(moments[words], moments[words + MOMENT_CARRIES], 0u) / MOMENT_SCALE);
}

fn resolve(pixel: vec2u) -> Resolved {
    pixels_begin();
    let number = pixel_number(pixel);
    if fill[number] == 0u { return Resolved(vec4f(0.0), 0xffffffffu); }
    let words = number * MOMENT_COLOUR_WORDS;
    let carries = overflow[words + MOMENT_COLOUR_CARRIES];
    var sums: array<f32, 4>;
    for (var i = 0u; i < 4u; i++) { sums[i] = moment_sum(overflow[words + i], carries, i); }
    let scale = MOMENT_WEIGHT_SCALE / (frame.tail_scale * MOMENT_COLOUR_SCALE) / max(sums[0], 1.0);
    let opacity = moment_opacity(number);
    return Resolved(vec4f(vec3f(sums[1], sums[2], sums[3]) * (scale * opacity), opacity), 0xffffffffu - fill[number]);
}

fn nearest(pixel: vec2u) -> Nearest {
    pixels_begin();
    let number = pixel_number(pixel);
    if fill[number] == 0u { return Nearest(0xffffffffu, 0xffffffffu, 0.0, 0.0); }
    let winner = 0xffffffffu - overflow[number * MOMENT_COLOUR_WORDS + MOMENT_WINNER];
    let opacity = moment_opacity(number);
    return Nearest(0xffffffffu - fill[number], winner >> 8u, f32(winner & 255u) / 255.0, opacity);
}
