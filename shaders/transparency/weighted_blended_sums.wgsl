// The sums of weighted blended transparency: seven words a pixel. Integers, so that the order of the fragments does not
// matter.
//
// Range: a fragment adds at most 2^26 steps to a sum, and a sum has 16 bits of carries above its word: 2^48 steps, 2^22
// fragments. Optical depth has no carry: it sticks above half of its range, where the transmittance is 0 all the same.
// Precision: a lone fragment of opacity α and weight w adds α w 2^26 steps of weight and as many of colour that is four times
// the brightest expected, so that rounding moves its premultiplied colour by at most 2^-25 / w of the brightest.

const WEIGHTED_BLENDED_WORDS: u32 = 7u;
// Σ -ln(1 - opacity)
const WEIGHTED_BLENDED_DEPTH: u32 = 0u;
// Σ weight × opacity, then Σ weight × opacity × colour
const WEIGHTED_BLENDED_SUMS: u32 = 1u;
// Carries of the four sums, 16 bits each.
const WEIGHTED_BLENDED_CARRIES: u32 = 5u;

// Steps of the largest weight × opacity, 1, and of the largest colour.
const WEIGHTED_BLENDED_SCALE: f32 = 67108864.0;
// frame.tail_scale has 2^16 steps for the brightest radiance; these sums have 2^24.
const WEIGHTED_BLENDED_COLOUR: f32 = 256.0;
