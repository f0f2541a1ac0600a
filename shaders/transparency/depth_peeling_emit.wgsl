// Depth peeling (Everitt, Interactive Order-Independent Transparency, 2001), as the rasterisers fill it. Each peel finds
// every pixel's next fragment in the order of (depth, segment): stage KEY the least key beyond the last peel's, stage POINT
// the first segment that has it, both by atomic minima. What that fragment holds is stored by the KEY of the peel after it,
// when it is known; a pass over the pixels then lays it under what is there (depth_peeling_advance). The last stage, TAIL,
// merges what no peel has reached.
//
// All stages but the first return at once where no pixel found anything in the last peel: counters.overflow tells.

@group(3) @binding(0) var<storage, read_write> counters: Counters;
// PEEL_… a pixel.
@group(3) @binding(3) var<storage, read_write> peeled: array<u32>;

const STAGE_FIRST_KEY: u32 = 0u;
const STAGE_KEY: u32 = 1u;
const STAGE_POINT: u32 = 2u;
const STAGE_TAIL: u32 = 3u;

var<private> depth_peeling_produced: u32;
var<private> depth_peeling_culled: u32;
var<private> depth_peeling_merged: u32;

fn emit_begin() -> bool {
    emit_common_begin();
    depth_peeling_produced = 0u;
    depth_peeling_culled = 0u;
    depth_peeling_merged = 0u;
    return STAGE == STAGE_FIRST_KEY || atomicLoad(&counters.overflow) != 0u;
}

fn emit_end() {
    if depth_peeling_produced > 0u {
        atomicAdd(&counters.produced, depth_peeling_produced);
        atomicStore(&counters.overflow, 1u);
    }
    if depth_peeling_culled > 0u { atomicAdd(&counters.culled, depth_peeling_culled); }
    if depth_peeling_merged > 0u { atomicAdd(&counters.merged, depth_peeling_merged); }
}

fn emit(pixel: vec2u, fragment: Fragment, compare: bool) {
    if !fragment_in_range(fragment) || fragment.opacity == 0.0 { return; }
    let key = depth_key(fragment.depth);
    if fragment_hidden(pixel, key, compare) {
        if STAGE == STAGE_FIRST_KEY { depth_peeling_culled += 1u; }
        return;
    }
    if STAGE == STAGE_FIRST_KEY { depth_peeling_produced += 1u; }
    let number = pixel_number(pixel);
    let words = number * PEEL_WORDS;
    let last_key = peeled[words + PEEL_KEY];
    let next_point = peeled[words + PEEL_POINT];
    if STAGE != STAGE_POINT && key == last_key && fragment.point + 1u == next_point {
        // As the A-buffer stores it.
        peeled[words + PEEL_VALUE] = u32(sqrt(fragment.opacity) * 65535.0 + 0.5)
            | (u32(fragment.along * 65535.0 + 0.5) << 16u);
        return;
    }
    if key < last_key || (key == last_key && fragment.point < next_point) { return; }
    // Until the tail is begun, its words hold what the peel has found.
    let found = number * OVERFLOW_WORDS;
    if STAGE == STAGE_TAIL {
        tail_merge(number, fragment);
        depth_peeling_merged += 1u;
    } else if STAGE == STAGE_POINT {
        if atomicLoad(&overflow[found + FOUND_KEY]) == 0xffffffffu - key {
            atomicMax(&overflow[found + FOUND_POINT], 0xffffffffu - fragment.point);
        }
    } else {
        atomicMax(&overflow[found + FOUND_KEY], 0xffffffffu - key);
    }
}
