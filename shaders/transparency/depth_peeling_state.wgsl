// What depth peeling keeps of a pixel, all zero before the first peel.

const PEEL_WORDS: u32 = 7u;
// The last peel's key, or PEEL_DONE where there is nothing more to be seen; and its point + 1.
const PEEL_KEY: u32 = 0u;
const PEEL_POINT: u32 = 1u;
// The last peel's opacity and place along the segment; 0 until they are known.
const PEEL_VALUE: u32 = 2u;
// Premultiplied colour of all peels before the last one, and the bits of their transmittance ^ those of 1.
const PEEL_COLOUR: u32 = 3u;
const PEEL_TRANSMITTANCE: u32 = 6u;

const PEEL_DONE: u32 = 0xffffffffu;
const PEEL_ONE: u32 = 0x3f800000u;
// What lies behind this transmittance changes a pixel by less than 1/4096 of its own radiance.
const PEEL_UNSEEN: f32 = 0.000244140625;

// What the present peel finds, as distances from the largest, in the words of the tail.
const FOUND_KEY: u32 = 0u;
const FOUND_POINT: u32 = 1u;

// Opacity and place along the segment.
fn depth_peeling_value(word: u32) -> vec2f {
    let root = f32(word & 0xffffu) / 65535.0;
    return vec2f(root * root, f32(word >> 16u) / 65535.0);
}
