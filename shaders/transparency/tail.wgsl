// A pixel's tail: fragments that were merged, by exact transmittance and weighted colour.

@group(3) @binding(6) var<storage, read> overflow: array<u32>;

// Premultiplied colour and transmittance of a pixel's tail.
fn tail_of(number: u32) -> vec4f {
    let words = number * OVERFLOW_WORDS;
    let carries = overflow[words + TAIL_CARRIES];
    var sums: array<f32, 5>;
    for (var i = 0u; i < 5u; i++) {
        sums[i] = f32(overflow[words + i]) + f32((carries >> (i * TAIL_CARRY_BITS)) & 63u) * 4294967296.0;
    }
    if sums[TAIL_WEIGHT] == 0.0 { return vec4f(0.0, 0.0, 0.0, 1.0); }
    let through = exp(-sums[TAIL_DEPTH] / TAIL_DEPTH_SCALE);
    let colour = vec3f(sums[2], sums[3], sums[4]) / frame.tail_scale / (sums[TAIL_WEIGHT] / TAIL_WEIGHT_SCALE);
    return vec4f(colour * (1.0 - through), through);
}
