// A pixel's tail: fragments that were merged, by exact transmittance and weighted colour. `tail_sums` or `tail_samples` finds
// the colour.

@group(3) @binding(5) var<storage, read> overflow: array<u32>;

// One of the sums of a pixel's tail, with its carries.
fn tail_sum(words: u32, sum: u32) -> f32 {
    let carries = (overflow[words + TAIL_CARRIES] >> (sum * TAIL_CARRY_BITS)) & 63u;
    return f32(overflow[words + sum]) + f32(carries) * 4294967296.0;
}

// The transmittance of a pixel's tail.
fn tail_through(number: u32) -> f32 {
    return exp(-tail_sum(number * OVERFLOW_WORDS, TAIL_DEPTH) / TAIL_DEPTH_SCALE);
}

// Premultiplied colour and transmittance of a pixel's tail.
fn tail_of(number: u32) -> vec4f {
    let words = number * OVERFLOW_WORDS;
    let weight = tail_sum(words, TAIL_WEIGHT) / TAIL_WEIGHT_SCALE;
    if weight == 0.0 { return vec4f(0.0, 0.0, 0.0, 1.0); }
    let through = tail_through(number);
    return vec4f(tail_colour(words, weight) * (1.0 - through), through);
}
