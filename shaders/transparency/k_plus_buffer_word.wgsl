// k⁺-buffer (Vasilakis and Fudos 2014; Hunz 2016, §5.2): the K nearest fragments of a pixel and no others, in K words of
// 64 bits.
//
// The published forms guard a max-array or a max-heap of a pixel by a lock, or by fragment interlock. WGSL promises no
// forward progress to those who wait, so that nobody may wait here: a pixel's words are kept in order by a chain of
// atomic extremes, each of which keeps the nearer fragment and hands the farther on to the next word. Every fragment
// passes every word at most once, in any order of the fragments the same K stay, and they stay in order: the farthest is
// the last word, which is what a max-array or a max-heap is there to find, and the resolve has nothing left to sort.
//
// A word holds, from its top, a fragment's depth key (less the frame's nearest, shifted by what does not fit), its point,
// the root of its opacity in 11 bits, and its place along the segment in 8. So equal depths are ordered by point. Words
// are stored inverted, so that cleared memory is the farthest.

const REST_MERGED: u32 = 0u;
const REST_ALPHA: u32 = 1u;
const REST_DROPPED: u32 = 2u;

const K_PLUS_ALONG_BITS: u32 = 8u;
const K_PLUS_ALONG_MAX: f32 = 255.0;
const K_PLUS_OPACITY_MASK: u32 = 2047u;
const K_PLUS_OPACITY_MAX: f32 = 2047.0;
// Bits below the point, and how many of the point's own lie in the lower half of a word.
const K_PLUS_VALUE_BITS: u32 = 19u;
const K_PLUS_POINT_LOW: u32 = 13u;

// REST_MERGED: Σ opacity, Σ opacity × colour, and their carries, of all fragments of a pixel.
const K_PLUS_SUMS: u32 = 5u;
const K_PLUS_CARRIES: u32 = 4u;

struct KPlusFragment {
    key: u32,
    point: u32,
    opacity: f32,
    along: f32,
}

// Read once an invocation: some drivers would read a uniform anew at every pixel.
var<private> k_plus_first_key: u32;
var<private> k_plus_key_shift: u32;
// Bits of the point in the upper half of a word.
var<private> k_plus_high_bits: u32;
var<private> k_plus_tail_scale: f32;

fn k_plus_begin() {
    k_plus_first_key = frame.key_first;
    k_plus_key_shift = frame.key_packing & 255u;
    k_plus_high_bits = ((frame.key_packing >> 8u) & 255u) - K_PLUS_POINT_LOW;
    k_plus_tail_scale = frame.tail_scale;
}

// The upper and the lower half of a fragment's word, not inverted.
fn k_plus_pack(fragment: KPlusFragment) -> vec2u {
    // A key outside the frame's range is that of its end.
    let key = (max(fragment.key, k_plus_first_key) - k_plus_first_key) >> k_plus_key_shift;
    let most = (0xffffffffu >> k_plus_high_bits) - 1u;
    let value = (u32(sqrt(fragment.opacity) * K_PLUS_OPACITY_MAX + 0.5) << K_PLUS_ALONG_BITS)
        | u32(fragment.along * K_PLUS_ALONG_MAX + 0.5);
    return vec2u(
        (min(key, most) << k_plus_high_bits) | (fragment.point >> K_PLUS_POINT_LOW),
        (fragment.point << K_PLUS_VALUE_BITS) | value,
    );
}

fn k_plus_unpack(word: vec2u) -> KPlusFragment {
    let key = ((word.x >> k_plus_high_bits) << k_plus_key_shift) + k_plus_first_key;
    let point = ((word.x & ((1u << k_plus_high_bits) - 1u)) << K_PLUS_POINT_LOW) | (word.y >> K_PLUS_VALUE_BITS);
    let root = f32((word.y >> K_PLUS_ALONG_BITS) & K_PLUS_OPACITY_MASK) / K_PLUS_OPACITY_MAX;
    return KPlusFragment(key, point, root * root, f32(word.y & 255u) / K_PLUS_ALONG_MAX);
}

// Steps of Σ opacity and Σ opacity × colour.
fn k_plus_steps(fragment: KPlusFragment) -> vec4u {
    let colour = fragment.opacity * shaded_colour(fragment.point, fragment.along) * k_plus_tail_scale;
    return vec4u(vec4f(fragment.opacity * TAIL_WEIGHT_SCALE, min(colour, vec3f(TAIL_LARGEST))) + 0.5);
}
