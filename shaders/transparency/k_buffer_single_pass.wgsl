// Single-pass k-buffer (Yu et al. 2012, §5.2): the resolve. A pixel's list is in order: its first K nodes are composited
// front to back, and what follows joins the tail, which is one layer behind them.

@group(3) @binding(0) var<storage, read> counters: array<u32>;
@group(3) @binding(1) var<storage, read> fill: array<u32>;
@group(3) @binding(2) var<storage, read> links: array<u32>;
// The upper and the lower halves of the nodes' words, inverted.
@group(3) @binding(3) var<storage, read> fragments_0: array<u32>;
@group(3) @binding(4) var<storage, read> fragments_1: array<u32>;
@group(3) @binding(5) var<storage, read> overflow: array<u32>;

const REST_MERGED: u32 = 0u;
const REST_ALPHA: u32 = 1u;
const REST_DROPPED: u32 = 2u;

// What lies behind this transmittance changes a pixel by less than 1/4096 of its own radiance.
const SINGLE_PASS_UNSEEN: f32 = 0.000244140625;
// Some drivers end an invocation's loops silently near 65,535 steps.
const SINGLE_PASS_STEPS: u32 = 49152u;
const SINGLE_PASS_END: u32 = 0xffffffffu;

struct Resolved {
    // Premultiplied.
    colour: vec4f,
    // Key of the nearest fragment.
    key: u32,
}

fn single_pass_word(node: u32) -> vec2u {
    return ~vec2u(fragments_0[node], fragments_1[node]);
}

fn resolve(pixel: vec2u) -> Resolved {
    pixels_begin();
    word_begin();
    shaded_begin(pixel);
    let number = pixel_number(pixel);
    let words = number * OVERFLOW_WORDS;
    var next = select(fill[number], SINGLE_PASS_END, fill[number] == 0u);
    // Nothing is nearer than what was stored, but where it failed.
    var result = Resolved(vec4f(0.0), ~overflow[words + TAIL_FIRST_KEY]);
    if next != SINGLE_PASS_END { result.key = min(result.key, word_key(single_pass_word(next - 1u).x)); }
    var transmittance = 1.0;
    var colour = vec3f(0.0);
    for (var i = 0u; i < K && next != SINGLE_PASS_END && transmittance > SINGLE_PASS_UNSEEN; i++) {
        let fragment = word_unpack(single_pass_word(next - 1u));
        colour += transmittance * fragment.opacity * shaded_colour(fragment.point, fragment.along);
        transmittance *= 1.0 - fragment.opacity;
        next = links[next - 1u];
    }
    if transmittance <= SINGLE_PASS_UNSEEN {
        result.colour = vec4f(colour, 1.0 - transmittance);
        return result;
    }
    let carries = overflow[words + TAIL_CARRIES];
    var low = vec4u(overflow[words + 1u], overflow[words + 2u], overflow[words + 3u], overflow[words + 4u]);
    var high = (vec4u(carries) >> (vec4u(1u, 2u, 3u, 4u) * TAIL_CARRY_BITS)) & vec4u(63u);
    var depth = vec2u(overflow[words + TAIL_DEPTH], carries & 63u);
    for (var i = 0u; i < SINGLE_PASS_STEPS && next != SINGLE_PASS_END && REST != REST_DROPPED; i++) {
        let fragment = word_unpack(single_pass_word(next - 1u));
        let depth_steps = single_pass_depth_steps(fragment);
        depth.x += depth_steps;
        depth.y += select(0u, 1u, depth.x < depth_steps);
        if REST == REST_MERGED {
            let steps = single_pass_steps(fragment, frame.tail_scale);
            low += steps;
            high += select(vec4u(0u), vec4u(1u), low < steps);
        }
        next = links[next - 1u];
    }
    let rest = 1.0 - exp(-(f32(depth.x) + f32(depth.y) * 4294967296.0) / TAIL_DEPTH_SCALE);
    let sums = vec4f(low) + vec4f(high) * 4294967296.0;
    var behind = colour / max(1.0 - transmittance, 1e-20);
    if sums.x > 0.0 { behind = sums.yzw / frame.tail_scale / (sums.x / TAIL_WEIGHT_SCALE); }
    colour += transmittance * rest * behind;
    transmittance *= 1.0 - rest;
    result.colour = vec4f(colour, 1.0 - transmittance);
    return result;
}

fn nearest(pixel: vec2u) -> Nearest {
    let resolved = resolve(pixel);
    var near = Nearest(resolved.key, 0xffffffffu, 0.0, resolved.colour.w);
    let first = fill[pixel_number(pixel)];
    if first == 0u { return near; }
    let fragment = word_unpack(single_pass_word(first - 1u));
    near.point = fragment.point;
    near.along = fragment.along;
    return near;
}
