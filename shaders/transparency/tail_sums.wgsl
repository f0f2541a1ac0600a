// The colour of an overflow's tail, from its sums; `words` is where the pixel's begin, `weight` its Σ opacity.

fn tail_colour(words: u32, weight: f32) -> vec3f {
    return vec3f(tail_sum(words, TAIL_COLOUR), tail_sum(words, TAIL_COLOUR + 1u), tail_sum(words, TAIL_COLOUR + 2u))
        / (frame.tail_scale * weight);
}
