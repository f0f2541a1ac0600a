// A stored fragment in two words, upper and lower half of one number of 64 bits. From its top: the depth key, less the frame's
// first one and shifted by what does not fit; the point; the root of the opacity; the place along the segment. So a pixel's
// fragments are in order of (depth, point) where their words are. How many bits each of them has is the frame's: few points and
// little depth leave more for the opacity, from 11 up to 16.
//
// Neither half is ever all ones: no key is, and no place along a segment.

const WORD_VALUE_BITS_MOST: u32 = 24u;
const WORD_ALONG_BITS: u32 = 8u;
const WORD_ALONG_MASK: u32 = 255u;
const WORD_ALONG_MOST: f32 = 254.0;

struct StoredFragment {
    key: u32,
    point: u32,
    opacity: f32,
    along: f32,
}

// Read once an invocation: some drivers would read a uniform anew at every pixel.
var<private> word_first_key: u32;
var<private> word_key_shift: u32;
// Bits of the point in the upper half, and bits below it in the lower.
var<private> word_point_bits: u32;
var<private> word_value_bits: u32;

fn word_begin() {
    word_first_key = frame.key_first;
    let bits = (vec3u(frame.word_bits) >> vec3u(0u, 8u, 16u)) & vec3u(255u);
    word_key_shift = bits.x;
    word_point_bits = bits.y;
    word_value_bits = bits.z;
}

fn word_opacity_most() -> u32 {
    return (1u << (word_value_bits - WORD_ALONG_BITS)) - 1u;
}

// The root keeps thin fibres' small opacities apart. Where it has fewer than sixteen bits it is rounded up or down by the point's
// hash, so that what many fragments of one opacity lose is nothing on average.
fn word_root(opacity: f32, point: u32) -> u32 {
    let hash = select(f32((point * 0x9e3779b9u) >> 8u) / 16777216.0, 0.5, word_value_bits == WORD_VALUE_BITS_MOST);
    return min(u32(sqrt(opacity) * f32(word_opacity_most()) + hash), word_opacity_most());
}

// An opacity as it is stored.
fn word_opacity(opacity: f32, point: u32) -> f32 {
    let root = f32(word_root(opacity, point)) / f32(word_opacity_most());
    return root * root;
}

fn word_pack(fragment: StoredFragment) -> vec2u {
    // A key outside the frame's range is that of its end.
    let key = (max(fragment.key, word_first_key) - word_first_key) >> word_key_shift;
    let most = (0xffffffffu >> word_point_bits) - 1u;
    let along = u32(fragment.along * WORD_ALONG_MOST + 0.5);
    return vec2u(
        (min(key, most) << word_point_bits) | (fragment.point >> (32u - word_value_bits)),
        (fragment.point << word_value_bits) | (word_root(fragment.opacity, fragment.point) << WORD_ALONG_BITS) | along,
    );
}

// What may be nearer than all keys of the frame is at the eye: a depth that is written hides no more than the fragment itself.
fn word_key(upper: u32) -> u32 {
    let key = upper >> word_point_bits;
    return select((key << word_key_shift) + word_first_key, 0u, key == 0u);
}

fn word_point(word: vec2u) -> u32 {
    return ((word.x & ((1u << word_point_bits) - 1u)) << (32u - word_value_bits)) | (word.y >> word_value_bits);
}

// Opacity and place along the segment.
fn word_value(lower: u32) -> vec2f {
    let root = f32((lower >> WORD_ALONG_BITS) & word_opacity_most()) / f32(word_opacity_most());
    return vec2f(root * root, f32(lower & WORD_ALONG_MASK) / WORD_ALONG_MOST);
}

fn word_unpack(word: vec2u) -> StoredFragment {
    let value = word_value(word.y);
    return StoredFragment(word_key(word.x), word_point(word), value.x, value.y);
}

// Whether one fragment comes before another.
fn word_before(a: vec2u, b: vec2u) -> bool {
    return a.x < b.x || (a.x == b.x && a.y < b.y);
}
