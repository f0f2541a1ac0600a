// What a fragment of the single-pass k-buffer adds to its pixel's tail, in the emission and in the resolve: the same steps.

fn single_pass_depth_steps(fragment: StoredFragment) -> u32 {
    return u32(optical_depth(fragment.opacity) * TAIL_DEPTH_SCALE + 0.5);
}

// Steps of Σ opacity and Σ opacity × colour.
fn single_pass_steps(fragment: StoredFragment, tail_scale: f32) -> vec4u {
    let colour = min(fragment.opacity * shaded_colour(fragment.point, fragment.along) * tail_scale, vec3f(TAIL_LARGEST));
    return vec4u(vec4f(fragment.opacity * TAIL_WEIGHT_SCALE, colour) + 0.5);
}
