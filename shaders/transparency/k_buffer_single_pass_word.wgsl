// What a fragment of the single-pass k-buffer adds to its pixel's tail, in the emission and in the resolve: the same steps.

fn single_pass_value(word: u32) -> vec2f {
    let root = f32(word & 0xffffu) / 65535.0;
    return vec2f(root * root, f32(word >> 16u) / 65535.0);
}

fn single_pass_depth_steps(word: u32) -> u32 {
    return u32(optical_depth(single_pass_value(word).x) * TAIL_DEPTH_SCALE + 0.5);
}

// Steps of Σ opacity and Σ opacity × colour.
fn single_pass_steps(point: u32, word: u32, tail_scale: f32) -> vec4u {
    let value = single_pass_value(word);
    let colour = min(value.x * shaded_colour(point, value.y) * tail_scale, vec3f(TAIL_LARGEST));
    return vec4u(vec4f(value.x * TAIL_WEIGHT_SCALE, colour) + 0.5);
}
