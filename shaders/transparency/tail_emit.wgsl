// Merging fragments into their pixel's tail. `tail_sums_emit` or `tail_samples_emit` keeps what the colour is found by.

@group(3) @binding(5) var<storage, read_write> overflow: array<atomic<u32>>;

// Adds to one sum of a pixel's tail; its carries are counted beside it.
fn tail_add(number: u32, sum: u32, value: f32) {
    let steps = u32(value + 0.5);
    let before = atomicAdd(&overflow[number * OVERFLOW_WORDS + sum], steps);
    if before + steps < before {
        atomicAdd(&overflow[number * OVERFLOW_WORDS + TAIL_CARRIES], 1u << (sum * TAIL_CARRY_BITS));
    }
}

fn tail_merge(number: u32, fragment: Fragment) {
    tail_add(number, TAIL_DEPTH, optical_depth(fragment.opacity) * TAIL_DEPTH_SCALE);
    tail_add(number, TAIL_WEIGHT, fragment.opacity * TAIL_WEIGHT_SCALE);
    tail_merge_colour(number, fragment);
}
