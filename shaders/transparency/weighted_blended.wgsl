// Weighted blended transparency: a pixel's colour is the mean of its fragments', weighed by opacity and depth; its opacity is
// exact, 1 - Π (1 - opacity).

@group(3) @binding(5) var<storage, read> sums: array<u32>;

struct Resolved {
    // Premultiplied.
    colour: vec4f,
    // Key of the nearest fragment.
    key: u32,
}

fn weighted_blended_opacity(words: u32) -> f32 {
    return 1.0 - exp(-f32(sums[words + WEIGHTED_BLENDED_DEPTH]) / OPTICAL_DEPTH_SCALE);
}

fn weighted_blended_sum(words: u32, sum: u32) -> f32 {
    let carries = (sums[words + WEIGHTED_BLENDED_CARRIES + sum / 2u] >> (16u * (sum & 1u))) & 0xffffu;
    return f32(sums[words + WEIGHTED_BLENDED_SUMS + sum]) + f32(carries) * 4294967296.0;
}

fn resolve(pixel: vec2u) -> Resolved {
    pixels_begin();
    let number = pixel_number(pixel);
    let words = number * WEIGHTED_BLENDED_WORDS;
    let weight = weighted_blended_sum(words, 0u);
    let opacity = weighted_blended_opacity(words);
    // What is too faint for a step has no colour, and as good as no opacity.
    if weight == 0.0 { return Resolved(vec4f(0.0, 0.0, 0.0, opacity), nearest_key(number)); }
    let colour = vec3f(weighted_blended_sum(words, 1u), weighted_blended_sum(words, 2u), weighted_blended_sum(words, 3u));
    let scale = WEIGHTED_BLENDED_SCALE / (frame.tail_scale * WEIGHTED_BLENDED_COLOUR);
    return Resolved(vec4f(colour * (opacity * scale / weight), opacity), nearest_key(number));
}

fn nearest(pixel: vec2u) -> Nearest {
    pixels_begin();
    let number = pixel_number(pixel);
    return nearest_of(number, weighted_blended_opacity(number * WEIGHTED_BLENDED_WORDS));
}
