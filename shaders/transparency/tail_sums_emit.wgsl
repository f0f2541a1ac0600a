// The colour of an overflow's tail: Σ opacity × colour, where colours are known as fragments are found.

fn tail_merge_colour(pixel: u32, fragment: Fragment) {
    let colour = shaded_colour(fragment.point, fragment.along);
    let steps = min(fragment.opacity * colour * frame.tail_scale, vec3f(TAIL_LARGEST));
    tail_add(pixel, TAIL_COLOUR, steps.x);
    tail_add(pixel, TAIL_COLOUR + 1u, steps.y);
    tail_add(pixel, TAIL_COLOUR + 2u, steps.z);
}
