// A-buffer: the resolve. Selects a pixel's fragments in order of (depth, segment), eight at a time in registers, and
// composites them front to back until the rest cannot be seen; then the overflow's tail.
//
// A pixel whose list is so long that ordering it would take more than A_BUFFER_STEPS steps has its farthest part
// merged like a tail: exact transmittance, weighted colour.

@group(3) @binding(0) var<storage, read> counters: array<u32>;
@group(3) @binding(1) var<storage, read> fill: array<u32>;
@group(3) @binding(2) var<storage, read> links: array<u32>;
@group(3) @binding(3) var<storage, read> fragments_0: array<u32>;
@group(3) @binding(4) var<storage, read> fragments_1: array<u32>;
@group(3) @binding(5) var<storage, read> fragments_2: array<u32>;
@group(3) @binding(6) var<storage, read> overflow: array<u32>;
@group(3) @binding(7) var<storage, read> shaded: array<vec2u>;

// What lies behind this transmittance changes a pixel by less than 1/4096 of its own radiance.
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

struct Candidate {
    key: u32,
    point: u32,
    place: u32,
}

// One of a fragment's words: 0 its key, 1 its point, 2 its opacity and place along the segment.
fn a_buffer_word(place: u32, word: u32) -> u32 {
    let part = frame.part_capacity;
    if PARTS == 1u || place < part { return fragments_0[place * 3u + word]; }
    if PARTS == 2u || place < 2u * part { return fragments_1[(place - part) * 3u + word]; }
    return fragments_2[(place - 2u * part) * 3u + word];
}

fn a_buffer_before(a: Candidate, b: Candidate) -> bool {
    return a.key < b.key || (a.key == b.key && a.point < b.point);
}

fn a_buffer_order(near: ptr<function, Candidate>, far: ptr<function, Candidate>) {
    if a_buffer_before(*far, *near) {
        let moved = *near;
        *near = *far;
        *far = moved;
    }
}

// The first fragment of a pixel: a place in counted arrays, a node + 1 in lists.
fn a_buffer_first(number: u32) -> u32 {
    return select(links[number], fill[number], LISTS);
}

fn a_buffer_shade(candidate: Candidate, transmittance: f32) -> vec4f {
    let value = unpack2x16float(a_buffer_word(candidate.place, 2u));
    return vec4f(transmittance * value.x * shaded_colour(candidate.point, value.y), transmittance * (1.0 - value.x));
}

// Colour and transmittance of a pixel's tail.
fn a_buffer_tail(number: u32) -> vec4f {
    let words = number * OVERFLOW_WORDS;
    let carries = overflow[words + TAIL_CARRIES];
    var sums: array<f32, 5>;
    for (var i = 0u; i < 5u; i++) {
        sums[i] = f32(overflow[words + i]) + f32((carries >> (i * TAIL_CARRY_BITS)) & 63u) * 4294967296.0;
    }
    if sums[TAIL_WEIGHT] == 0.0 { return vec4f(0.0, 0.0, 0.0, 1.0); }
    let through = exp(-sums[TAIL_DEPTH] / TAIL_DEPTH_SCALE);
    let colour = vec3f(sums[2], sums[3], sums[4]) / frame.tail_scale / (sums[TAIL_WEIGHT] / TAIL_WEIGHT_SCALE);
    return vec4f(colour * (1.0 - through), through);
}

fn resolve(pixel: vec2u) -> Resolved {
    let number = pixel_number(pixel);
    let first = a_buffer_first(number);
    var count = 0u;
    if LISTS {
        var node = first;
        while node != 0u && count < A_BUFFER_STEPS {
            count += 1u;
            node = links[node - 1u];
        }
    } else {
        count = links[number + 1u] - first;
    }
    var result = Resolved(vec4f(0.0), A_BUFFER_NONE);
    var transmittance = 1.0;
    var colour = vec3f(0.0);
    // The last fragment composited; all further ones lie behind it.
    var last = Candidate(0u, 0u, A_BUFFER_NONE);
    var done = 0u;
    let rounds = A_BUFFER_STEPS / (count + 9u);
    for (var round = 0u; round < rounds && done < count && transmittance > A_BUFFER_UNSEEN; round++) {
        let none = Candidate(A_BUFFER_NONE, A_BUFFER_NONE, A_BUFFER_NONE);
        var k0 = none;
        var k1 = none;
        var k2 = none;
        var k3 = none;
        var k4 = none;
        var k5 = none;
        var k6 = none;
        var k7 = none;
        var node = first;
        for (var i = 0u; i < count; i++) {
            let place = select(first + i, node - 1u, LISTS);
            if LISTS { node = links[place]; }
            let key = a_buffer_word(place, 0u);
            if key > k7.key || key < last.key { continue; }
            let candidate = Candidate(key, a_buffer_word(place, 1u), place);
            if last.place != A_BUFFER_NONE && !a_buffer_before(last, candidate) { continue; }
            if !a_buffer_before(candidate, k7) { continue; }
            k7 = candidate;
            a_buffer_order(&k6, &k7);
            a_buffer_order(&k5, &k6);
            a_buffer_order(&k4, &k5);
            a_buffer_order(&k3, &k4);
            a_buffer_order(&k2, &k3);
            a_buffer_order(&k1, &k2);
            a_buffer_order(&k0, &k1);
        }
        if done == 0u { result.key = k0.key; }
        var chosen = array<Candidate, 8>(k0, k1, k2, k3, k4, k5, k6, k7);
        for (var i = 0u; i < 8u && chosen[i].place != A_BUFFER_NONE; i++) {
            let shade = a_buffer_shade(chosen[i], transmittance);
            colour += shade.xyz;
            transmittance = shade.w;
            last = chosen[i];
            done += 1u;
        }
        // Equal fragments of one segment cannot be parted; there are none, but a fault must not loop.
        if k0.place == A_BUFFER_NONE { break; }
    }
    if done < count && transmittance > A_BUFFER_UNSEEN {
        var depth = 0.0;
        var weight = 0.0;
        var sum = vec3f(0.0);
        var node = first;
        for (var i = 0u; i < count; i++) {
            let place = select(first + i, node - 1u, LISTS);
            if LISTS { node = links[place]; }
            let candidate = Candidate(a_buffer_word(place, 0u), a_buffer_word(place, 1u), place);
            if last.place != A_BUFFER_NONE && !a_buffer_before(last, candidate) { continue; }
            let value = unpack2x16float(a_buffer_word(place, 2u));
            depth += optical_depth(value.x);
            weight += value.x;
            sum += value.x * shaded_colour(candidate.point, value.y);
        }
        let through = exp(-depth);
        colour += transmittance * (1.0 - through) * sum / max(weight, 1e-20);
        transmittance *= through;
    }
    let overflowed = select(counters[COUNTERS_OVERFLOW] != 0u, counters[COUNTERS_STORED] > frame.capacity, LISTS);
    if overflowed && transmittance > A_BUFFER_UNSEEN {
        let tail = a_buffer_tail(number);
        colour += transmittance * tail.xyz;
        transmittance *= tail.w;
    }
    result.colour = vec4f(colour, 1.0 - transmittance);
    return result;
}
