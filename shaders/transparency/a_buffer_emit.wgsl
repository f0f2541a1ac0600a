// A-buffer, as the rasterisers fill it. Two storages:
//
// Counted arrays: COUNT counts a pixel's fragments, a scan turns counts into places, SCATTER stores.
// Where the pool is too small SCATTER returns at once and SCATTER_OVERFLOW does its work.
// Linked lists (Yang et al. 2010, Hunz algorithm 3): LIST takes a node and makes it the head of its pixel's list.
//
// Overflow: what does not fit is merged into the pixel's tail. Counted arrays first give each pixel its share and find,
// by RANGE and a few rounds of HISTOGRAM, the depth up to which the nearest fragments fill it.

// Counted: fragments of a pixel. Lists: head of a pixel's list, 0 = none, else node + 1.
@group(3) @binding(1) var<storage, read_write> fill: array<atomic<u32>>;

const STAGE_COUNT: u32 = 0u;
const STAGE_RANGE: u32 = 1u;
const STAGE_HISTOGRAM: u32 = 2u;
const STAGE_SCATTER: u32 = 3u;
const STAGE_SCATTER_OVERFLOW: u32 = 4u;
const STAGE_LIST: u32 = 5u;

fn emit_begin() -> bool {
    a_buffer_begin();
    if STAGE == STAGE_COUNT || STAGE == STAGE_LIST { return true; }
    return (atomicLoad(&counters.overflow) != 0u) != (STAGE == STAGE_SCATTER);
}

fn emit_end() {
    if (STAGE == STAGE_COUNT || STAGE == STAGE_LIST) && a_buffer_culled > 0u {
        atomicAdd(&counters.culled, a_buffer_culled);
    }
}

fn emit(pixel: vec2u, fragment: Fragment, compare: bool) {
    if !fragment_in_range(fragment) { return; }
    let key = depth_key(fragment.depth);
    if fragment_hidden(pixel, key, compare) {
        a_buffer_culled += 1u;
        return;
    }
    let number = pixel_number(pixel);
    if STAGE == STAGE_COUNT {
        atomicAdd(&fill[number], 1u);
    } else if STAGE == STAGE_RANGE {
        a_buffer_range(number, key);
    } else if STAGE == STAGE_HISTOGRAM {
        a_buffer_histogram(number, key);
    } else if STAGE == STAGE_SCATTER {
        a_buffer_scatter(number, key, fragment);
    } else if STAGE == STAGE_SCATTER_OVERFLOW {
        a_buffer_scatter_overflow(number, key, fragment);
    } else if fragment.opacity > 0.0 {
        let node = atomicAdd(&counters.stored, 1u);
        if node >= a_buffer_capacity {
            atomicMax(&overflow[number * OVERFLOW_WORDS + TAIL_FIRST_KEY], 0xffffffffu - key);
            tail_merge(number, fragment);
            return;
        }
        a_buffer_store(node, key, fragment);
        atomicStore(&links[node], atomicExchange(&fill[number], node + 1u));
    }
}
