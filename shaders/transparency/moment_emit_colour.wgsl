// Moment-based transparency, its last stage: each fragment's colour, weighted by its opacity and by the transmittance that
// the moments say is before it, summed by integers; and which fragment is the nearest.

@group(3) @binding(1) var<storage, read_write> fill: array<u32>;
@group(3) @binding(2) var<storage, read_write> links: array<u32>;
@group(3) @binding(3) var<storage, read_write> moments: array<u32>;
// Σ a T, Σ a T c, their carries, and the distance of (point, place along the segment) from the largest; the lower wins.
@group(3) @binding(5) var<storage, read_write> overflow: array<atomic<u32>>;

var<private> moment_tail_scale: f32;

fn emit_begin() -> bool {
    emit_common_begin();
    moment_tail_scale = frame.tail_scale;
    return true;
}

fn emit_end() {}

fn moment_add(pixel: u32, sum: u32, value: f32) {
    let steps = u32(value + 0.5);
    let words = pixel * MOMENT_COLOUR_WORDS;
    let before = atomicAdd(&overflow[words + sum], steps);
    if before + steps < before {
        let carries = atomicLoad(&overflow[words + MOMENT_COLOUR_CARRIES]) >> (sum * MOMENT_CARRY_BITS);
        if (carries & 63u) < MOMENT_MOST_CARRIES {
            atomicAdd(&overflow[words + MOMENT_COLOUR_CARRIES], 1u << (sum * MOMENT_CARRY_BITS));
        }
    }
}

fn emit(pixel: vec2u, fragment: Fragment, compare: bool) {
    if !fragment_in_range(fragment) || fragment.opacity == 0.0 { return; }
    let key = depth_key(fragment.depth);
    if fragment_hidden(pixel, key, compare) { return; }
    let number = pixel_number(pixel);
    let nearest_key = 0xffffffffu - fill[number];
    let words = number * MOMENT_WORDS;
    let carries = moments[words + MOMENT_CARRIES];
    var b: array<f32, 5>;
    for (var i = 0u; i < 5u; i++) { b[i] = moment_sum(moments[words + i], carries, i); }
    let normalised = vec4f(2.0 * b[1] - b[0], b[2], 2.0 * b[3] - b[0], b[4]) / max(b[0], 1.0);
    let z = moment_place(key, nearest_key, links[number]);
    let total = b[0] / MOMENT_SCALE;
    let through = moment_transmittance(total, normalised, z, optical_depth(fragment.opacity));
    let weight = fragment.opacity * through;
    let colour = weight * shaded_colour(fragment.point, fragment.along) * moment_tail_scale;
    let steps = min(colour * MOMENT_COLOUR_SCALE, vec3f(MOMENT_COLOUR_LARGEST));
    moment_add(number, 0u, weight * MOMENT_WEIGHT_SCALE);
    moment_add(number, 1u, steps.x);
    moment_add(number, 2u, steps.y);
    moment_add(number, 3u, steps.z);
    if key == nearest_key {
        let along = u32(fragment.along * 255.0 + 0.5);
        atomicMax(&overflow[number * MOMENT_COLOUR_WORDS + MOMENT_WINNER], 0xffffffffu - ((fragment.point << 8u) | along));
    }
}
