// A-buffer with counted arrays, pool too small: a pixel's passes around the rasterisers' RANGE and HISTOGRAM stages.
// A fixed number of workgroups strides over the pixels, so that the passes cost next to nothing where the pool suffices
// and all return at once.

@group(3) @binding(0) var<storage, read_write> counters: Counters;
@group(3) @binding(1) var<storage, read_write> fill: array<u32>;
@group(3) @binding(5) var<storage, read_write> overflow: array<u32>;

const OVERFLOW_STRIDE: u32 = 16384u;

// Pixels to treat: none where the pool suffices.
fn a_buffer_pixels() -> u32 {
    let count = (drawing.row_end - drawing.row_first) * u32(drawing.viewport.x);
    return select(0u, count, atomicLoad(&counters.overflow) != 0u);
}

// A pixel's share of the pool: one fragment where there are enough, and of the rest in proportion to its count; where
// there are fewer fragments than covered pixels, one in every so many pixels.
fn a_buffer_share(number: u32, count: u32) -> u32 {
    let produced = f32(atomicLoad(&counters.produced));
    let covered = atomicLoad(&counters.covered);
    if frame.capacity <= covered {
        let pixels = f32((drawing.row_end - drawing.row_first) * u32(drawing.viewport.x));
        let part = f32(frame.capacity) / pixels * 0.9999;
        return min(count, u32(f32(number + 1u) * part) - u32(f32(number) * part));
    }
    // Rounded down by more than the error of f32, so that the shares never sum to more than the pool.
    let share = 1u + u32(f32(count) * (f32(frame.capacity - covered) / produced) * 0.9999);
    return min(min(count, PIXEL_MOST), share);
}

fn a_buffer_overflow_begin_pixel(number: u32) {
    overflow[number * OVERFLOW_WORDS + SEARCH_LOW] = 0xffffffffu;
    overflow[number * OVERFLOW_WORDS + SEARCH_WIDTH] = 0u;
}

// After RANGE: low and highest key → low and width.
fn a_buffer_overflow_range_pixel(number: u32) {
    let words = number * OVERFLOW_WORDS;
    let low = overflow[words + SEARCH_LOW];
    overflow[words + SEARCH_WIDTH] = select(0u, overflow[words + SEARCH_WIDTH] - low + 1u, fill[number] > 0u);
    for (var word = SEARCH_KEPT; word < OVERFLOW_WORDS; word++) { overflow[words + word] = 0u; }
}

// After HISTOGRAM: keeps the nearest bins that fit, and searches on in the first that does not.
fn a_buffer_overflow_select_pixel(number: u32) {
    let words = number * OVERFLOW_WORDS;
    let share = a_buffer_share(number, fill[number]);
    let bin_width = search_bin_width(overflow[words + SEARCH_WIDTH]);
    var low = overflow[words + SEARCH_LOW];
    var width = overflow[words + SEARCH_WIDTH];
    var kept = overflow[words + SEARCH_KEPT];
    for (var bin = 0u; bin < SEARCH_BIN_COUNT && width > 0u; bin++) {
        let count = overflow[words + SEARCH_BINS + bin];
        if kept + count > share {
            width = min(width, bin_width);
            break;
        }
        kept += count;
        let step = min(width, bin_width);
        low += step;
        width -= step;
    }
    overflow[words + SEARCH_LOW] = low;
    // A bin of one key cannot be parted further.
    overflow[words + SEARCH_WIDTH] = select(width, 0u, width <= 1u);
    overflow[words + SEARCH_KEPT] = kept;
    for (var bin = 0u; bin < SEARCH_BIN_COUNT; bin++) { overflow[words + SEARCH_BINS + bin] = 0u; }
}

// The search becomes an empty tail that begins at its key.
fn a_buffer_overflow_end_pixel(number: u32) {
    let words = number * OVERFLOW_WORDS;
    let first_key = overflow[words + SEARCH_LOW];
    fill[number] = overflow[words + SEARCH_KEPT];
    for (var word = 0u; word < OVERFLOW_WORDS; word++) { overflow[words + word] = 0u; }
    overflow[words + TAIL_FIRST_KEY] = first_key;
}

@compute @workgroup_size(64)
fn a_buffer_overflow_begin(@builtin(global_invocation_id) invocation: vec3u) {
    let pixels = a_buffer_pixels();
    for (var number = invocation.x; number < pixels; number += OVERFLOW_STRIDE) { a_buffer_overflow_begin_pixel(number); }
}

@compute @workgroup_size(64)
fn a_buffer_overflow_range(@builtin(global_invocation_id) invocation: vec3u) {
    let pixels = a_buffer_pixels();
    for (var number = invocation.x; number < pixels; number += OVERFLOW_STRIDE) { a_buffer_overflow_range_pixel(number); }
}

@compute @workgroup_size(64)
fn a_buffer_overflow_select(@builtin(global_invocation_id) invocation: vec3u) {
    let pixels = a_buffer_pixels();
    for (var number = invocation.x; number < pixels; number += OVERFLOW_STRIDE) { a_buffer_overflow_select_pixel(number); }
}

@compute @workgroup_size(64)
fn a_buffer_overflow_end(@builtin(global_invocation_id) invocation: vec3u) {
    let pixels = a_buffer_pixels();
    for (var number = invocation.x; number < pixels; number += OVERFLOW_STRIDE) { a_buffer_overflow_end_pixel(number); }
}
