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
// where nothing is known; then where its bins begin, and how many keys each of them holds.
fn dbk_tile_words(pixels: u32, tile: u32) -> u32 {
    return 2u * (pixels + tile);
}

// The first bin holds what is nearer than `first`, the last one what is farther than all others. Integers, so that every
// pass agrees.
fn dbk_bin(key: u32, first: u32, width: u32) -> u32 {
    var bin = 0u;
    for (var b = 0u; b + 1u < DBK_BINS; b++) { bin += select(0u, 1u, key >= first + b * width); }
    return bin;
}

// The first key beyond a bin.
fn dbk_bin_end(bin: u32, first: u32, width: u32) -> u32 {
    return select(first + bin * width, DBK_NO_CUT, bin + 1u >= DBK_BINS);
}
