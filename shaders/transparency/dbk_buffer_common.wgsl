// Where the DBK-buffer keeps what it knows of pixels and tiles: behind the pixels' counts in `fill`, a cut-off each, the
// first depth key that is not stored, and two words for each tile, its nearest and its farthest depth; before the
// places are scanned, DBK_BINS words a pixel in `overflow`.

const DBK_TILE: u32 = 8u;
const DBK_BINS: u32 = 8u;
const DBK_NO_CUT: u32 = 0xffffffffu;
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

// Place in `fill` of the two words of the tile that a pixel of the band lies in: distance of the nearest key from the
// largest, and the farthest key; both 0 where nothing is known.
fn dbk_tile(pixels: u32, columns: u32, pixel: vec2u) -> u32 {
    return 2u * (pixels + pixel.y / DBK_TILE * columns + pixel.x / DBK_TILE);
}

// A tile's depths are parted by squares: bin b begins b² / DBK_BINS² of the way from the nearest to the farthest, where
// dense hair is cut off. Integers, so that every pass agrees.
fn dbk_unit(front: u32, back: u32) -> u32 {
    return (back - min(front, back)) / (DBK_BINS * DBK_BINS);
}

fn dbk_bin(key: u32, front: u32, unit: u32) -> u32 {
    let behind = key - min(front, key);
    var bin = 0u;
    for (var b = 1u; b < DBK_BINS; b++) { bin += select(0u, 1u, behind >= b * b * unit); }
    return bin;
}

// The first key beyond a bin.
fn dbk_bin_end(bin: u32, front: u32, unit: u32) -> u32 {
    return select(front + (bin + 1u) * (bin + 1u) * unit, DBK_NO_CUT, bin + 1u >= DBK_BINS);
}
