// The colour of an overflow's tail: the mean of the fragments that `tail_samples_emit` has drawn, shaded here.

// The inverses of TAIL_HASHES modulo 2³².
const TAIL_INVERSES: vec3u = vec3u(0x0e8b2f51u, 0xb6c92f47u, 0xa89ed915u);

fn tail_colour(words: u32, weight: f32) -> vec3f {
    var sum = vec3f(0.0);
    for (var i = 0u; i < 3u; i++) {
        let name = ~(overflow[words + TAIL_COLOUR + i] * TAIL_INVERSES[i]);
        sum += shaded_colour(name >> 8u, f32(name & 255u) / 255.0);
    }
    return sum / 3.0;
}
