// DBK-buffer, as the rasterisers fill it: an A-buffer in counted arrays that stores no fragment behind a pixel's cut-off.
//
// Bounded by a tolerance: BINS counts fragments and sums their optical depths in bins of depth; where the sum has
// reached the tolerance's the rest is cut off (dbk_buffer.wgsl), and SCATTER stores what is left.
//
// By a depth shift (Hunz §5.3): FRONT finds the nearest depth, KEPT counts what lies within the shift behind it, and sums the
// optical depth of what lies beyond; SCATTER stores, and finds the nearest fragment beyond, which is drawn opaque behind.
//
// RANGE, HISTOGRAM and SCATTER_OVERFLOW are the A-buffer's.

@group(3) @binding(1) var<storage, read_write> fill: array<u32>;

const STAGE_BINS: u32 = 0u;
const STAGE_RANGE: u32 = 1u;
const STAGE_HISTOGRAM: u32 = 2u;
const STAGE_SCATTER: u32 = 3u;
const STAGE_SCATTER_OVERFLOW: u32 = 4u;
const STAGE_FRONT: u32 = 5u;
const STAGE_KEPT: u32 = 6u;
// By a depth shift RANGE to SCATTER_OVERFLOW are numbered from here.
const STAGE_BY_SHIFT: u32 = 7u;

const BY_SHIFT: bool = STAGE >= STAGE_FRONT;
const STAGE_BASE: u32 = select(STAGE, STAGE - min(STAGE, STAGE_BY_SHIFT) + STAGE_RANGE, STAGE >= STAGE_BY_SHIFT);

var<private> dbk_pixel_count: u32;
var<private> dbk_column_count: u32;
var<private> dbk_row_first: u32;
var<private> dbk_cut_depth: f32;
var<private> dbk_frame_steps: vec2u;

fn emit_begin() -> bool {
    a_buffer_begin();
    dbk_pixel_count = dbk_pixels();
    dbk_column_count = dbk_columns();
    dbk_row_first = drawing.row_first;
    dbk_cut_depth = frame.cut_depth;
    dbk_frame_steps = dbk_steps();
    if STAGE_BASE == STAGE_BINS || STAGE_BASE == STAGE_FRONT || STAGE_BASE == STAGE_KEPT { return true; }
    return (atomicLoad(&counters.overflow) != 0u) != (STAGE_BASE == STAGE_SCATTER);
}

fn emit_end() {
    if (STAGE_BASE == STAGE_BINS || STAGE_BASE == STAGE_KEPT) && a_buffer_culled > 0u {
        atomicAdd(&counters.culled, a_buffer_culled);
    }
}

fn dbk_count(pixel: vec2u, number: u32, key: u32, fragment: Fragment) {
    let tile = dbk_tile(dbk_column_count, pixel - vec2u(0u, dbk_row_first));
    let words = dbk_tile_words(dbk_pixel_count, tile);
    let bin = dbk_bin(key, fill[words], dbk_frame_steps);
    // Of the opacity that is stored. One fragment counts for no more than the tolerance asks for.
    let depth = u32(min(optical_depth(word_opacity(fragment.opacity, fragment.point)), dbk_cut_depth) * DBK_DEPTH_SCALE);
    let before = atomicAdd(&overflow[number * DBK_BINS + bin], (depth << DBK_COUNT_BITS) | 1u);
    // A count that runs over is carried to the pixel, which is then not cut off at all.
    if (before & DBK_COUNT_MAX) == DBK_COUNT_MAX { atomicAdd(&links[number], DBK_COUNT_MAX + 1u); }
}

// Fragments beyond the depth shift.
fn dbk_beyond(number: u32, key: u32, fragment: Fragment) {
    let words = DBK_BEYOND_AT * dbk_pixel_count + number * DBK_BEYOND_WORDS;
    if STAGE_BASE == STAGE_KEPT {
        a_buffer_culled += 1u;
        let depth = u32(optical_depth(fragment.opacity) * OPTICAL_DEPTH_SCALE + 0.5);
        let before = atomicAdd(&overflow[words + DBK_BEYOND_DEPTH], depth);
        if before + depth < before { atomicOr(&overflow[words + DBK_BEYOND_DEPTH], 0x80000000u); }
        if fragment.opacity > 0.0 { atomicMax(&overflow[words + DBK_BEYOND_NEAREST], 0xffffffffu - key); }
    } else if fragment.opacity > 0.0 && atomicLoad(&overflow[words + DBK_BEYOND_NEAREST]) == 0xffffffffu - key {
        let along = u32(fragment.along * 255.0 + 0.5);
        atomicMax(&overflow[words + DBK_BEYOND_WINNER], 0xffffffffu - ((fragment.point << 8u) | along));
    }
}

fn emit(pixel: vec2u, fragment: Fragment, compare: bool) {
    if !fragment_in_range(fragment) { return; }
    let key = depth_key(fragment.depth);
    let number = pixel_number(pixel);
    if STAGE_BASE != STAGE_BINS && STAGE_BASE != STAGE_FRONT {
        // Nothing that is cut off lies before the host's scene alone: most fragments need but one comparison.
        if key >= fill[dbk_pixel_count + number] {
            if BY_SHIFT && (STAGE_BASE == STAGE_KEPT || STAGE_BASE == STAGE_SCATTER || STAGE_BASE == STAGE_SCATTER_OVERFLOW) {
                if fragment_hidden(pixel, key, compare) {
                    a_buffer_culled += 1u;
                } else {
                    dbk_beyond(number, key, fragment);
                }
            }
            return;
        }
    }
    if fragment_hidden(pixel, key, compare) {
        a_buffer_culled += 1u;
        return;
    }
    if STAGE_BASE == STAGE_BINS {
        dbk_count(pixel, number, key, fragment);
    } else if STAGE_BASE == STAGE_FRONT {
        atomicMax(&overflow[number * DBK_BINS], 0xffffffffu - key);
    } else if STAGE_BASE == STAGE_KEPT {
        atomicAdd(&links[number], 1u);
    } else if STAGE_BASE == STAGE_RANGE {
        a_buffer_range(number, key);
    } else if STAGE_BASE == STAGE_HISTOGRAM {
        a_buffer_histogram(number, key);
    } else if STAGE_BASE == STAGE_SCATTER {
        a_buffer_scatter(number, key, fragment);
    } else {
        a_buffer_scatter_overflow(number, key, fragment);
    }
}
