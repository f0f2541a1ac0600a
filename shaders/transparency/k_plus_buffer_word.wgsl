// k⁺-buffer (Vasilakis and Fudos 2014; Hunz 2016, §5.2): the K nearest fragments of a pixel and no others, in K words of
// 64 bits.
//
// The published forms guard a max-array or a max-heap of a pixel by a lock, or by fragment interlock. WGSL promises no
// forward progress to those who wait, so that nobody may wait here: a pixel's words are kept in order by a chain of
// atomic extremes, each of which keeps the nearer fragment and hands the farther on to the next word. Every fragment
// passes every word at most once, in any order of the fragments the same K stay, and they stay in order: the farthest is
// the last word, which is what a max-array or a max-heap is there to find, and the resolve has nothing left to sort.
//
// A word is `fragment_word`'s, stored inverted, so that cleared memory is the farthest.

const REST_MERGED: u32 = 0u;
const REST_ALPHA: u32 = 1u;
const REST_DROPPED: u32 = 2u;

// REST_MERGED: Σ opacity, Σ opacity × colour, and their carries, of all fragments of a pixel.
const K_PLUS_SUMS: u32 = 5u;
const K_PLUS_CARRIES: u32 = 4u;

// Read once an invocation: some drivers would read a uniform anew at every pixel.
var<private> k_plus_tail_scale: f32;

fn k_plus_begin() {
    word_begin();
    k_plus_tail_scale = frame.tail_scale;
}

// Steps of Σ opacity and Σ opacity × colour.
fn k_plus_steps(fragment: StoredFragment) -> vec4u {
    let colour = fragment.opacity * shaded_colour(fragment.point, fragment.along) * k_plus_tail_scale;
    return vec4u(vec4f(fragment.opacity * TAIL_WEIGHT_SCALE, min(colour, vec3f(TAIL_LARGEST))) + 0.5);
}
