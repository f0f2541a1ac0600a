// What the A-buffer's storage holds, as the resolves of the techniques that fill it read it: a pixel's fragments, in no
// order, and its nearest one. `tail` has what did not fit.

@group(3) @binding(0) var<storage, read> counters: array<u32>;
@group(3) @binding(1) var<storage, read> fill: array<u32>;
@group(3) @binding(2) var<storage, read> links: array<u32>;
// The upper halves of the fragments' words, by fours, and the lower ones.
@group(3) @binding(3) var<storage, read> fragments_0: array<vec4u>;
@group(3) @binding(4) var<storage, read> fragments_1: array<u32>;

// What the A-buffer leaves out at most, by its transmittance; `UNSEEN` in Rust.
const A_BUFFER_UNSEEN: f32 = 0.000244140625;
// Some drivers end an invocation's loops silently near 65,535 steps.
const A_BUFFER_STEPS: u32 = 49152u;
const A_BUFFER_NONE: u32 = 0xffffffffu;
// The word of Counters that tells of an overflow, and the one that counts nodes asked for.
const COUNTERS_STORED: u32 = 2u;
const COUNTERS_OVERFLOW: u32 = 4u;

struct Resolved {
    // Premultiplied.
    colour: vec4f,
    // Key of the nearest fragment.
    key: u32,
}

fn a_buffer_upper(place: u32) -> u32 {
    return fragments_0[place / 4u][place % 4u];
}

fn a_buffer_word(place: u32) -> vec2u {
    return vec2u(a_buffer_upper(place), fragments_1[place]);
}

// The first fragment of a pixel: a place in counted arrays, a node + 1 in lists. The scatter has counted each pixel's
// place up to its end, which is where the next one's begins.
fn a_buffer_first(number: u32) -> u32 {
    if LISTS { return fill[number]; }
    return select(links[max(number, 1u) - 1u], 0u, number == 0u);
}

// Fragments in the list of a pixel that begins there.
fn a_buffer_count(number: u32, first: u32) -> u32 {
    if !LISTS { return links[number] - first; }
    var count = 0u;
    var node = first;
    while node != 0u && count < A_BUFFER_STEPS {
        count += 1u;
        node = links[node - 1u];
    }
    return count;
}

// Whether the pool was too small, so that there are tails.
fn a_buffer_overflowed() -> bool {
    return select(counters[COUNTERS_OVERFLOW] != 0u, counters[COUNTERS_STORED] > frame.capacity, LISTS);
}

// The depth that a pixel's tail begins at: all that is known where nothing was stored.
fn a_buffer_tail_key(number: u32) -> u32 {
    let word = overflow[number * OVERFLOW_WORDS + TAIL_FIRST_KEY];
    // In lists it is the distance from the largest key, so that a cleared word is none.
    return select(word, A_BUFFER_NONE - word, LISTS);
}

// The nearest fragment of a pixel, and the opacity of all.
fn a_buffer_nearest(pixel: vec2u) -> Nearest {
    pixels_begin();
    word_begin();
    let number = pixel_number(pixel);
    let first = a_buffer_first(number);
    var foremost = vec2u(A_BUFFER_NONE);
    var near = Nearest(A_BUFFER_NONE, A_BUFFER_NONE, 0.0, 0.0);
    // An integer sum, whatever the order of the fragments; from 2^31 on, an optical depth of 32,768, it stays.
    var depth = 0u;
    var node = first;
    var place = first;
    for (var i = 0u; i < A_BUFFER_STEPS; i++) {
        if LISTS {
            if node == 0u { break; }
            place = node - 1u;
            node = links[place];
        } else {
            if place >= links[number] { break; }
        }
        let word = a_buffer_word(place);
        let value = word_value(word.y);
        place += 1u;
        if value.x == 0.0 { continue; }
        depth = min(depth + u32(optical_depth(value.x) * OPTICAL_DEPTH_SCALE + 0.5), 0x80000000u);
        if word_before(word, foremost) {
            foremost = word;
            near.along = value.y;
        }
    }
    if foremost.x != A_BUFFER_NONE {
        near.key = word_key(foremost.x);
        near.point = word_point(foremost);
    }
    var transmittance = exp(-f32(depth) / OPTICAL_DEPTH_SCALE);
    if a_buffer_overflowed() {
        let through = tail_through(number);
        transmittance *= through;
        if near.key == A_BUFFER_NONE && through < 1.0 { near.key = a_buffer_tail_key(number); }
    }
    near.opacity = 1.0 - transmittance * resolve_beyond(number).w;
    return near;
}
