// Transmittance from four power moments of optical depth (Münstermann et al. 2018; Sharpe 2018).
//
// Of the distributions over depth that have a pixel's moments b_k / b_0, the one with a mass w_0 at a fragment's depth z and
// two others bounds what may lie before it: their part before z, and that with w_0. A fragment's own mass is known and is
// none of what lies before it; of the remaining w_0 a part is taken to be. Then T = exp(-b_0 F).

// How far moments are drawn to those of a distribution that no rounding makes impossible.
const MOMENT_BIAS: f32 = 1e-5;
// The part of w_0, less a fragment's own, that is taken to lie before it.
const MOMENT_OVERESTIMATION: f32 = 0.5;
// Steps a unit of the sums of moments; a carry counts 2^32 of them.
const MOMENT_SCALE: f32 = 1048576.0;
// Steps a unit of the sums of weights, and of colours over the overflow's tail_scale: the least weight has a thousand. Weights
// sum to little more than 1, and the sums hold 800.
const MOMENT_WEIGHT_SCALE: f32 = 268435456.0;
const MOMENT_COLOUR_SCALE: f32 = 4096.0;
const MOMENT_COLOUR_LARGEST: f32 = 1073741824.0;
// The least transmittance that weighs: of a thick pile at one depth each fragment has next to none, and their mean must not
// be lost to the steps. A hundred of them behind all others weigh a 2600th.
const MOMENT_LEAST: f32 = 3.8147e-6;
// Words a pixel: Σ ω and four sums of moments, with their carries; Σ a T and Σ a T c, with theirs, and the nearest fragment.
const MOMENT_WORDS: u32 = 6u;
const MOMENT_CARRIES: u32 = 5u;
const MOMENT_COLOUR_WORDS: u32 = 6u;
const MOMENT_COLOUR_CARRIES: u32 = 4u;
const MOMENT_WINNER: u32 = 5u;
// Six bits a carry, which stick before they run into the next.
const MOMENT_CARRY_BITS: u32 = 6u;
const MOMENT_MOST_CARRIES: u32 = 48u;

// A sum with its carries.
fn moment_sum(low: u32, carries: u32, number: u32) -> f32 {
    return f32(low) + f32((carries >> (number * MOMENT_CARRY_BITS)) & 63u) * 4294967296.0;
}

// Place of a key among a pixel's, from -1 to 1. Keys are steps of a float, and so logarithms where depth is reversed.
fn moment_place(key: u32, nearest_key: u32, farthest_key: u32) -> f32 {
    if farthest_key <= nearest_key { return 0.0; }
    return 2.0 * f32(key - nearest_key) / f32(farthest_key - nearest_key) - 1.0;
}

// The part of the light that reaches a fragment of optical depth `own` at `z`; `total` is b_0, `normalised` b_1 / b_0 to b_4 / b_0.
fn moment_transmittance(total: f32, normalised: vec4f, z: f32, own: f32) -> f32 {
    let b = mix(normalised, vec4f(0.0, 0.375, 0.0, 0.375), MOMENT_BIAS);
    // The Hankel matrix as L D Lᵀ, and with it the kernel polynomial at z: c.x + c.y x + c.z x².
    let d11 = b.y - b.x * b.x;
    let l21_d11 = b.z - b.x * b.y;
    let l21 = l21_d11 / d11;
    let d22 = (b.w - b.y * b.y) - l21_d11 * l21;
    var c = vec3f(1.0, z - b.x, z * z - b.y);
    c.z = (c.z - l21 * c.y) / d22;
    c.y = c.y / d11 - l21 * c.z;
    c.x -= c.y * b.x + c.z * b.y;
    let greatest = 1.0 / (c.x + z * (c.y + z * c.z));
    // Its roots hold the other two masses. One that lies far out holds next to nothing.
    let half = 0.5 * c.y;
    let root = sqrt(max(half * half - c.x * c.z, 0.0));
    let q = -(half + select(-root, root, half >= 0.0));
    let z1 = clamp(q / c.z, -1e4, 1e4);
    let z2 = clamp(c.x / q, -1e4, 1e4);
    let others = 1.0 - greatest;
    let first = b.x - greatest * z;
    let w1 = clamp((first - others * z2) / (z1 - z2), 0.0, max(others, 0.0));
    let before = select(0.0, w1, z1 < z) + select(0.0, max(others - w1, 0.0), z2 < z);
    let around = max(greatest - own / total, 0.0);
    return max(exp(-total * clamp(before + MOMENT_OVERESTIMATION * around, 0.0, 1.0)), MOMENT_LEAST);
}
