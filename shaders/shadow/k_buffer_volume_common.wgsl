// K-buffer volumetric shadow (Yu et al. 2012, §3.1): the K scattering events of each texel that are nearest to the light.
//
// An event is one word: 20 bits of depth over the hair's extent, then 12 bits that say how much of the light it takes. It is
// kept as its complement, so that a cleared word is an empty slot and the nearest event the greatest word. A texel's slots are
// filled by a chain of atomic maxima: each slot keeps the greater word and hands the lesser one on, so that in the end
// they hold the K nearest in order, whatever the order in which fragments came. Equal words are equal events, and
// both are kept.
//
// A texel's words: K slots; then what lies behind the last of them, as a sum of optical depths, its farthest depth and its
// colour; then, where light is coloured, K words of the transmittance behind each event.

const VOLUME_DEPTH_BITS: u32 = 20u;
const VOLUME_DEPTH_LAST: f32 = 1048575.0;
const VOLUME_PAYLOAD_BITS: u32 = 12u;
const VOLUME_PAYLOAD_MASK: u32 = 0xfffu;
const VOLUME_PAYLOAD_LAST: f32 = 4095.0;
// Where light passes through fibres the payload is 8 bits of opacity and 4 of the fibre's inclination.
const VOLUME_INCLINATION_BITS: u32 = 4u;
const VOLUME_INCLINATIONS: u32 = 16u;
const VOLUME_OPACITY_LAST: f32 = 255.0;
// The words behind the slots.
const VOLUME_REST: u32 = 0u;
const VOLUME_BACK: u32 = 1u;
const VOLUME_COLOUR: u32 = 2u;
const VOLUME_TAIL_WORDS: u32 = 3u;
// A sum of optical depths from here on stays.
const VOLUME_DENSE: u32 = 0x80000000u;

fn volume_depth(depth: f32, extent: f32) -> u32 {
    return u32(clamp(depth / extent, 0.0, 1.0) * VOLUME_DEPTH_LAST + 0.5);
}

// Opacity and inclination as a payload; the root keeps thin fibres' small opacities apart. 0: no event.
fn volume_payload(opacity: f32, inclination: f32, coloured: bool) -> u32 {
    if !coloured { return u32(sqrt(opacity) * VOLUME_PAYLOAD_LAST + 0.5); }
    let kept = u32(sqrt(opacity) * VOLUME_OPACITY_LAST + 0.5);
    if kept == 0u { return 0u; }
    let bin = min(u32(inclination * (f32(VOLUME_INCLINATIONS) / 1.5707964)), VOLUME_INCLINATIONS - 1u);
    return (kept << VOLUME_INCLINATION_BITS) | bin;
}

fn volume_opacity(payload: u32, coloured: bool) -> f32 {
    let root = select(f32(payload) / VOLUME_PAYLOAD_LAST,
        f32(payload >> VOLUME_INCLINATION_BITS) / VOLUME_OPACITY_LAST, coloured);
    return root * root;
}

// Roots of three transmittances in 11, 11 and 10 bits.
fn volume_pack(transmittance: vec3f) -> u32 {
    let root = vec3u(sqrt(transmittance) * vec3f(2047.0, 2047.0, 1023.0) + 0.5);
    return root.x | (root.y << 11u) | (root.z << 22u);
}

fn volume_unpack(word: u32) -> vec3f {
    let root = vec3f(vec3u(word & 0x7ffu, (word >> 11u) & 0x7ffu, word >> 22u)) / vec3f(2047.0, 2047.0, 1023.0);
    return root * root;
}
