// Where the DBK-buffer keeps what it knows of pixels and tiles: behind the pixels' counts in `fill`, a cut-off each, the
// first depth key that is not stored, and two words for each tile; in `overflow`, until the places are scanned, first a
// histogram of DBK_STEPS words a tile, then DBK_BINS words a pixel.

const DBK_TILE: u32 = 8u;
const DBK_BINS: u32 = 8u;
const DBK_NO_CUT: u32 = 0xffffffffu;
// Steps of depth in which a tile's optical depth is estimated, and steps of that estimate.
const DBK_STEPS: u32 = 64u;
const DBK_ESTIMATE_SCALE: f32 = 16.0;
// The estimated optical depths between which a tile's bins lie, as parts of the one that cuts off.
const DBK_FIRST: f32 = 0.4;
const DBK_LAST: f32 = 2.6;
// A bin's word: below, a count of fragments; above, a sum of optical depth, rounded down, in steps of 1 / DBK_DEPTH_SCALE.
const DBK_COUNT_BITS: u32 = 11u;
const DBK_COUNT_MAX: u32 = 2047u;
const DBK_DEPTH_SCALE: f32 = 2048.0;

// By a depth shift: what lies beyond it, three words a pixel from DBK_BEYOND_AT words a pixel on in `overflow`: the sum of
// optical depth, distance of the nearest key from the largest, and that of (point, place along the segment) of the fragment
// that has it.
const DBK_BEYOND_AT: u32 = 8u;
const DBK_BEYOND_WORDS: u32 = 3u;
const DBK_BEYOND_DEPTH: u32 = 0u;
const DBK_BEYOND_NEAREST: u32 = 1u;
const DBK_BEYOND_WINNER: u32 = 2u;

fn dbk_pixels() -> u32 {
    return (drawing.row_end - drawing.row_first) * u32(drawing.viewport.x);
}

fn dbk_columns() -> u32 {
    return (u32(drawing.viewport.x) + DBK_TILE - 1u) / DBK_TILE;
}

// Number of the tile that a pixel of the band lies in.
fn dbk_tile(columns: u32, pixel: vec2u) -> u32 {
    return pixel.y / DBK_TILE * columns + pixel.x / DBK_TILE;
}

// Place in `fill` of a tile's two words. At first: distance of the nearest key from the largest, and the farthest key, both 0
// where nothing is known; then, in the first one, its bins.
fn dbk_tile_words(pixels: u32, tile: u32) -> u32 {
    return 2u * (pixels + tile);
}

// A tile's bins in one word, in steps of 1 << shift keys from the frame's first key on: above, where the second one begins, never
// at 0; below, how many steps each of them holds.
const DBK_WIDTH_BITS: u32 = 15u;
const DBK_WIDTH_MAX: u32 = 0x7fffu;
const DBK_FIRST_MAX: u32 = 0x1fffeu;
// Nothing is known of the tile: nothing is cut off.
const DBK_NO_BINS: u32 = 0xffffffffu;

// The steps of the frame: its first key, and the shift.
fn dbk_steps() -> vec2u {
    return vec2u(frame.key_first, frame.word_bits >> 24u);
}

fn dbk_step(key: u32, steps: vec2u) -> u32 {
    return (max(key, steps.x) - steps.x) >> steps.y;
}

// The first bin holds what is nearer than all others, the last one what is farther. Integers, so that every pass agrees.
fn dbk_bin(key: u32, bins: u32, steps: vec2u) -> u32 {
    let step = dbk_step(key, steps);
    let first = bins >> DBK_WIDTH_BITS;
    let width = bins & DBK_WIDTH_MAX;
    var bin = 0u;
    for (var b = 0u; b + 1u < DBK_BINS; b++) { bin += select(0u, 1u, step >= first + b * width); }
    return bin;
}

// The first key beyond a bin: a key is before it where `dbk_bin` is `bin` or less.
fn dbk_bin_end(bin: u32, bins: u32, steps: vec2u) -> u32 {
    if bins == DBK_NO_BINS || bin + 1u >= DBK_BINS { return DBK_NO_CUT; }
    return steps.x + (((bins >> DBK_WIDTH_BITS) + bin * (bins & DBK_WIDTH_MAX)) << steps.y);
}

fn dbk_number(invocation: vec3u, groups: vec3u) -> u32 {
    return invocation.x + invocation.y * groups.x * 64u;
}
