// Weighted blended transparency (McGuire and Bavoil, Weighted Blended Order-Independent Transparency, 2013), as the
// rasterisers fill it: one pass without any order. Every fragment adds to its pixel's sums, weighed by a function of its
// depth that falls towards the far end of the hair, as the light does that reaches the eye.

@group(3) @binding(0) var<storage, read_write> counters: Counters;
@group(3) @binding(5) var<storage, read_write> sums: array<atomic<u32>>;

const WEIGHTED_BLENDED_UNIFORM: f32 = 0.0;
const WEIGHTED_BLENDED_CUBIC: f32 = 1.0;
// The least weight over the largest: below it the sums would lose what a lone far fibre adds.
const WEIGHTED_BLENDED_LEAST: f32 = 0.0009765625;

var<private> weighted_blended_produced: u32;
var<private> weighted_blended_culled: u32;
var<private> weighted_blended_place: vec4f;
// Kind, falloff.
var<private> weighted_blended_settings: vec2f;
var<private> weighted_blended_colour_scale: f32;

fn emit_begin() -> bool {
    weighted_blended_produced = 0u;
    weighted_blended_culled = 0u;
    weighted_blended_place = frame.place_of_depth;
    weighted_blended_settings = frame.technique.xy;
    weighted_blended_colour_scale = frame.tail_scale * WEIGHTED_BLENDED_COLOUR;
    emit_common_begin();
    return true;
}

fn emit_end() {
    if weighted_blended_produced > 0u { atomicAdd(&counters.produced, weighted_blended_produced); }
    if weighted_blended_culled > 0u { atomicAdd(&counters.culled, weighted_blended_culled); }
}

// The weight at a place in the hair's extent, 0 at its near end and 1 at its far one; at most 1.
fn weighted_blended_weight(settings: vec2f, place: f32, opacity: f32) -> f32 {
    if settings.x == WEIGHTED_BLENDED_UNIFORM { return 1.0; }
    if settings.x == WEIGHTED_BLENDED_CUBIC {
        // McGuire and Bavoil eq. 10, over its largest value.
        let rest = 1.0 - place;
        return opacity * max(WEIGHTED_BLENDED_LEAST, rest * rest * rest);
    }
    return max(WEIGHTED_BLENDED_LEAST, exp(-settings.y * place));
}

// Adds to one of a pixel's four sums.
fn weighted_blended_add(words: u32, sum: u32, value: f32) {
    let steps = u32(min(value, WEIGHTED_BLENDED_SCALE) + 0.5);
    let before = atomicAdd(&sums[words + WEIGHTED_BLENDED_SUMS + sum], steps);
    if before + steps < before {
        atomicAdd(&sums[words + WEIGHTED_BLENDED_CARRIES + sum / 2u], 1u << (16u * (sum & 1u)));
    }
}

fn emit(pixel: vec2u, fragment: Fragment, compare: bool) {
    if !fragment_in_range(fragment) || fragment.opacity == 0.0 { return; }
    let key = depth_key(fragment.depth);
    if fragment_hidden(pixel, key, compare) {
        weighted_blended_culled += 1u;
        return;
    }
    weighted_blended_produced += 1u;
    let words = pixel_number(pixel) * WEIGHTED_BLENDED_WORDS;
    let depth = u32(optical_depth(fragment.opacity) * OPTICAL_DEPTH_SCALE + 0.5);
    let before = atomicAdd(&sums[words + WEIGHTED_BLENDED_DEPTH], depth);
    if before + depth < before { atomicOr(&sums[words + WEIGHTED_BLENDED_DEPTH], 0x80000000u); }

    let place = place_in_extent(weighted_blended_place, fragment.depth);
    let weight = fragment.opacity * weighted_blended_weight(weighted_blended_settings, place, fragment.opacity);
    let colour = shaded_colour(fragment.point, fragment.along) * (weight * weighted_blended_colour_scale);
    weighted_blended_add(words, 0u, weight * WEIGHTED_BLENDED_SCALE);
    weighted_blended_add(words, 1u, colour.x);
    weighted_blended_add(words, 2u, colour.y);
    weighted_blended_add(words, 3u, colour.z);
}
