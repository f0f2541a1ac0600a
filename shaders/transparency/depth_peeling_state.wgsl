// What depth peeling keeps of a pixel, all zero before the first peel.

const PEEL_WORDS: u32 = 6u;
// The last peel's fragment's word, upper and lower half; PEEL_DONE where there is nothing more to be seen.
const PEEL_UPPER: u32 = 0u;
const PEEL_LOWER: u32 = 1u;
// Premultiplied colour of all peels, and the bits of their transmittance ^ those of 1.
const PEEL_COLOUR: u32 = 2u;
const PEEL_TRANSMITTANCE: u32 = 5u;

const PEEL_DONE: u32 = 0xffffffffu;
const PEEL_ONE: u32 = 0x3f800000u;
// What lies behind this transmittance changes a pixel by less than 1/4096 of its own radiance.
const PEEL_UNSEEN: f32 = 0.000244140625;

// The word that the present peel finds, inverted, in the words of the tail.
const FOUND_UPPER: u32 = 0u;
const FOUND_LOWER: u32 = 1u;
