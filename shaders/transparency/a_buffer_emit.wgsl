// A-buffer, as the rasterisers fill it. Two storages:
//
// Counted arrays: COUNT counts a pixel's fragments, a scan turns counts into places, SCATTER stores.
// Where the pool is too small SCATTER returns at once and SCATTER_OVERFLOW does its work.
// Linked lists (Yang et al. 2010, Hunz algorithm 3): LIST takes a node and makes it the head of its pixel's list.
//
// Overflow: what does not fit is merged into the pixel's tail. Counted arrays first give each pixel its share and find,
// by RANGE and a few rounds of HISTOGRAM, the depth up to which the nearest fragments fill it.

@group(3) @binding(0) var<storage, read_write> counters: Counters;
// Counted: fragments of a pixel. Lists: head of a pixel's list, 0 = none, else node + 1.
@group(3) @binding(1) var<storage, read_write> fill: array<atomic<u32>>;
// Counted: first place of a pixel, counted up to its end as fragments are stored. Lists: next node, as in `fill`.
@group(3) @binding(2) var<storage, read_write> links: array<atomic<u32>>;
// A fragment is three words side by side: key, point, and opacity with place. The pool has three parts, since one binding
// may be too small for it.
@group(3) @binding(3) var<storage, read_write> fragments_0: array<u32>;
@group(3) @binding(4) var<storage, read_write> fragments_1: array<u32>;
@group(3) @binding(5) var<storage, read_write> fragments_2: array<u32>;
@group(3) @binding(7) var<storage, read> shaded: array<vec2u>;

const STAGE_COUNT: u32 = 0u;
const STAGE_RANGE: u32 = 1u;
const STAGE_HISTOGRAM: u32 = 2u;
const STAGE_SCATTER: u32 = 3u;
const STAGE_SCATTER_OVERFLOW: u32 = 4u;
const STAGE_LIST: u32 = 5u;

var<private> a_buffer_culled: u32;
var<private> a_buffer_capacity: u32;
var<private> a_buffer_part: u32;

fn emit_begin() -> bool {
    emit_common_begin();
    a_buffer_culled = 0u;
    a_buffer_capacity = frame.capacity;
    a_buffer_part = frame.part_capacity;
    if STAGE == STAGE_COUNT || STAGE == STAGE_LIST { return true; }
    return (atomicLoad(&counters.overflow) != 0u) != (STAGE == STAGE_SCATTER);
}

fn emit_end() {
    if (STAGE == STAGE_COUNT || STAGE == STAGE_LIST) && a_buffer_culled > 0u {
        atomicAdd(&counters.culled, a_buffer_culled);
    }
}

fn a_buffer_store(place: u32, key: u32, fragment: Fragment) {
    // The root keeps thin fibres' small opacities apart: 0.05 % at 0.001. Both values are within 0 and 1.
    let value = u32(sqrt(fragment.opacity) * 65535.0 + 0.5) | (u32(fragment.along * 65535.0 + 0.5) << 16u);
    let part = a_buffer_part;
    if PARTS == 1u || place < part {
        fragments_0[place * 3u] = key;
        fragments_0[place * 3u + 1u] = fragment.point;
        fragments_0[place * 3u + 2u] = value;
    } else if PARTS > 1u && place < 2u * part {
        let word = (place - part) * 3u;
        fragments_1[word] = key;
        fragments_1[word + 1u] = fragment.point;
        fragments_1[word + 2u] = value;
    } else if PARTS > 2u {
        let word = (place - 2u * part) * 3u;
        fragments_2[word] = key;
        fragments_2[word + 1u] = fragment.point;
        fragments_2[word + 2u] = value;
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
    let words = number * OVERFLOW_WORDS;
    if STAGE == STAGE_COUNT {
        atomicAdd(&fill[number], 1u);
    } else if STAGE == STAGE_RANGE {
        atomicMin(&overflow[words + SEARCH_LOW], key);
        atomicMax(&overflow[words + SEARCH_WIDTH], key);
    } else if STAGE == STAGE_HISTOGRAM {
        let low = atomicLoad(&overflow[words + SEARCH_LOW]);
        let width = atomicLoad(&overflow[words + SEARCH_WIDTH]);
        if key >= low && key - low < width {
            atomicAdd(&overflow[words + SEARCH_BINS + (key - low) / search_bin_width(width)], 1u);
        }
    } else if STAGE == STAGE_SCATTER || STAGE == STAGE_SCATTER_OVERFLOW {
        if STAGE == STAGE_SCATTER_OVERFLOW {
            if key >= atomicLoad(&overflow[words + TAIL_FIRST_KEY]) {
                tail_merge(number, fragment);
                return;
            }
        }
        // The count and this pass evaluate the same expressions; should they differ all the same, the pool's end holds.
        let place = atomicAdd(&links[number], 1u);
        if place < a_buffer_capacity { a_buffer_store(place, key, fragment); }
    } else if fragment.opacity > 0.0 {
        let node = atomicAdd(&counters.stored, 1u);
        if node >= a_buffer_capacity {
            tail_merge(number, fragment);
            return;
        }
        a_buffer_store(node, key, fragment);
        atomicStore(&links[node], atomicExchange(&fill[number], node + 1u));
    }
}
