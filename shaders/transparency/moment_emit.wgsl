// Moment-based transparency, as the rasterisers fill it. RANGE finds the depths between which a pixel's fragments lie,
// MOMENTS sums their optical depth and its moments, by integers. The third stage is in `moment_emit_colour`.

@group(3) @binding(0) var<storage, read_write> counters: Counters;
// Distance of the nearest key from the largest, so that a cleared word is the farthest; and the farthest key.
@group(3) @binding(1) var<storage, read_write> fill: array<atomic<u32>>;
@group(3) @binding(2) var<storage, read_write> links: array<atomic<u32>>;
// Σ ω, Σ ω (1 + z) / 2, Σ ω z², Σ ω (1 + z³) / 2, Σ ω z⁴, and their carries.
@group(3) @binding(3) var<storage, read_write> moments: array<atomic<u32>>;

const STAGE_RANGE: u32 = 0u;
const STAGE_MOMENTS: u32 = 1u;

var<private> moment_produced: u32;
var<private> moment_culled: u32;

fn emit_begin() -> bool {
    moment_produced = 0u;
    moment_culled = 0u;
    emit_common_begin();
    return true;
}

fn emit_end() {
    if STAGE != STAGE_RANGE { return; }
    if moment_produced > 0u {
        atomicAdd(&counters.produced, moment_produced);
        atomicAdd(&counters.merged, moment_produced);
    }
    if moment_culled > 0u { atomicAdd(&counters.culled, moment_culled); }
}

fn moment_add(pixel: u32, sum: u32, value: f32) {
    let steps = u32(value * MOMENT_SCALE + 0.5);
    let words = pixel * MOMENT_WORDS;
    let before = atomicAdd(&moments[words + sum], steps);
    if before + steps < before {
        let carries = atomicLoad(&moments[words + MOMENT_CARRIES]) >> (sum * MOMENT_CARRY_BITS);
        if (carries & 63u) < MOMENT_MOST_CARRIES {
            atomicAdd(&moments[words + MOMENT_CARRIES], 1u << (sum * MOMENT_CARRY_BITS));
        }
    }
}

fn emit(pixel: vec2u, fragment: Fragment, compare: bool) {
    if !fragment_in_range(fragment) || fragment.opacity == 0.0 { return; }
    let key = depth_key(fragment.depth);
    if fragment_hidden(pixel, key, compare) {
        moment_culled += 1u;
        return;
    }
    let number = pixel_number(pixel);
    if STAGE == STAGE_RANGE {
        moment_produced += 1u;
        atomicMax(&fill[number], 0xffffffffu - key);
        atomicMax(&links[number], key);
        return;
    }
    let z = moment_place(key, 0xffffffffu - atomicLoad(&fill[number]), atomicLoad(&links[number]));
    let depth = optical_depth(fragment.opacity);
    moment_add(number, 0u, depth);
    moment_add(number, 1u, depth * (0.5 + 0.5 * z));
    moment_add(number, 2u, depth * z * z);
    moment_add(number, 3u, depth * (0.5 + 0.5 * z * z * z));
    moment_add(number, 4u, depth * z * z * z * z);
}
