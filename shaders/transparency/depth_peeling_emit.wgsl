// Depth peeling (Everitt, Interactive Order-Independent Transparency, 2001), as the rasterisers fill it. Each peel finds
// every pixel's next fragment in the order of (depth, segment): stage UPPER the least upper half of a word beyond the last peel's,
// stage LOWER the least lower half that goes with it, both by atomic extremes. A pass over the pixels then lays the fragment under
// what is there (depth_peeling_advance). The last stage, TAIL, merges what no peel has reached.
//
// All stages but the first return at once where no pixel found anything in the last peel: counters.overflow tells.

@group(3) @binding(0) var<storage, read_write> counters: Counters;
// PEEL_… a pixel.
@group(3) @binding(3) var<storage, read_write> peeled: array<u32>;

const STAGE_FIRST_UPPER: u32 = 0u;
const STAGE_UPPER: u32 = 1u;
const STAGE_LOWER: u32 = 2u;
const STAGE_TAIL: u32 = 3u;

var<private> depth_peeling_produced: u32;
var<private> depth_peeling_culled: u32;
var<private> depth_peeling_merged: u32;

fn emit_begin() -> bool {
    emit_common_begin();
    word_begin();
    depth_peeling_produced = 0u;
    depth_peeling_culled = 0u;
    depth_peeling_merged = 0u;
    return STAGE == STAGE_FIRST_UPPER || atomicLoad(&counters.overflow) != 0u;
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
        if STAGE == STAGE_FIRST_UPPER { depth_peeling_culled += 1u; }
        return;
    }
    if STAGE == STAGE_FIRST_UPPER { depth_peeling_produced += 1u; }
    let number = pixel_number(pixel);
    let state = number * PEEL_WORDS;
    let word = word_pack(StoredFragment(key, fragment.point, fragment.opacity, fragment.along));
    if !word_before(vec2u(peeled[state + PEEL_UPPER], peeled[state + PEEL_LOWER]), word) { return; }
    // Until the tail is begun, its words hold what the peel has found.
    let found = number * OVERFLOW_WORDS;
    if STAGE == STAGE_TAIL {
        tail_merge(number, fragment);
        depth_peeling_merged += 1u;
    } else if STAGE == STAGE_LOWER {
        if atomicLoad(&overflow[found + FOUND_UPPER]) == ~word.x { atomicMax(&overflow[found + FOUND_LOWER], ~word.y); }
    } else {
        atomicMax(&overflow[found + FOUND_UPPER], ~word.x);
    }
}
