// What every technique that stores fragments in the A-buffer's pool writes: a fragment, and a step of the search for a
// pixel's share; `tail_emit` merges what does not fit.

@group(3) @binding(0) var<storage, read_write> counters: Counters;
// Counted: first place of a pixel, counted up to its end as fragments are stored. Lists: next node, as in `fill`.
@group(3) @binding(2) var<storage, read_write> links: array<atomic<u32>>;
// The upper and the lower halves of the fragments' words.
@group(3) @binding(3) var<storage, read_write> fragments_0: array<u32>;
@group(3) @binding(4) var<storage, read_write> fragments_1: array<u32>;

var<private> a_buffer_culled: u32;
var<private> a_buffer_capacity: u32;

fn a_buffer_begin() {
    emit_common_begin();
    a_buffer_culled = 0u;
    a_buffer_capacity = frame.capacity;
    word_begin();
}

fn a_buffer_store(place: u32, key: u32, fragment: Fragment) {
    let word = word_pack(StoredFragment(key, fragment.point, fragment.opacity, fragment.along));
    fragments_0[place] = word.x;
    fragments_1[place] = word.y;
}

// Widens the range of a pixel's keys.
fn a_buffer_range(number: u32, key: u32) {
    let words = number * OVERFLOW_WORDS;
    atomicMin(&overflow[words + SEARCH_LOW], key);
    atomicMax(&overflow[words + SEARCH_WIDTH], key);
}

// Counts a key in the bin of what is left of the range.
fn a_buffer_histogram(number: u32, key: u32) {
    let words = number * OVERFLOW_WORDS;
    let low = atomicLoad(&overflow[words + SEARCH_LOW]);
    let width = atomicLoad(&overflow[words + SEARCH_WIDTH]);
    if key >= low && key - low < width {
        atomicAdd(&overflow[words + SEARCH_BINS + (key - low) / search_bin_width(width)], 1u);
    }
}

// Stores a fragment in the pixel's next place.
fn a_buffer_scatter(number: u32, key: u32, fragment: Fragment) {
    // The count and this pass evaluate the same expressions; should they differ all the same, the pool's end holds.
    let place = atomicAdd(&links[number], 1u);
    if place < a_buffer_capacity { a_buffer_store(place, key, fragment); }
}

// Stores a fragment that lies before the pixel's tail, and merges one that does not.
fn a_buffer_scatter_overflow(number: u32, key: u32, fragment: Fragment) {
    if key >= atomicLoad(&overflow[number * OVERFLOW_WORDS + TAIL_FIRST_KEY]) {
        tail_merge(number, fragment);
    } else {
        a_buffer_scatter(number, key, fragment);
    }
}
