// The overflow of a fragment pool: seven words a pixel. While counted arrays look for each pixel's share they hold the
// search; afterwards the tail, into which all that does not fit is merged by exact transmittance and weighted colour.

const OVERFLOW_WORDS: u32 = 7u;

// The search for the depth key up to which a pixel's nearest fragments fill its share.
const SEARCH_LOW: u32 = 0u;
const SEARCH_WIDTH: u32 = 1u;
const SEARCH_KEPT: u32 = 2u;
const SEARCH_BINS: u32 = 3u;
const SEARCH_BIN_COUNT: u32 = 4u;

// The tail: Σ -ln(1 - opacity), Σ opacity, what its colour is found by, carries of the sums, and the first key of the tail.
const TAIL_DEPTH: u32 = 0u;
const TAIL_WEIGHT: u32 = 1u;
const TAIL_COLOUR: u32 = 2u;
const TAIL_CARRIES: u32 = 5u;
const TAIL_FIRST_KEY: u32 = 6u;
// A carry counts up to 63, so that a sum holds 2^38 steps: 10^6 opaque fragments.
const TAIL_CARRY_BITS: u32 = 6u;
const TAIL_DEPTH_SCALE: f32 = 16384.0;
const TAIL_WEIGHT_SCALE: f32 = 131072.0;
// Steps of one fragment's colour at most.
const TAIL_LARGEST: f32 = 262144.0;

fn search_bin_width(width: u32) -> u32 {
    return (width + SEARCH_BIN_COUNT - 1u) / SEARCH_BIN_COUNT;
}
