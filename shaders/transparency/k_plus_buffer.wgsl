// k⁺-buffer: the resolve. The words are in order; they are composited front to back, and the rest is a layer behind them.

// Σ -ln(1 - opacity) of all fragments of a pixel.
@group(3) @binding(1) var<storage, read> fill: array<u32>;
// Lower and upper half of each word.
@group(3) @binding(3) var<storage, read> fragments: array<vec2u>;
@group(3) @binding(5) var<storage, read> overflow: array<u32>;

// What lies behind this transmittance changes a pixel by less than 1/4096 of its own radiance.
const K_PLUS_UNSEEN: f32 = 0.000244140625;

struct Resolved {
    // Premultiplied.
    colour: vec4f,
    // Key of the nearest fragment.
    key: u32,
}

// A pixel's sums less what was kept: mean colour of the rest, and its weight.
fn k_plus_rest(number: u32, kept: vec4u) -> vec4f {
    let words = number * K_PLUS_SUMS;
    let carries = vec4u(overflow[words + K_PLUS_CARRIES]) >> (vec4u(0u, 1u, 2u, 3u) * TAIL_CARRY_BITS);
    let sums = vec4u(overflow[words], overflow[words + 1u], overflow[words + 2u], overflow[words + 3u]);
    let borrow = select(vec4u(0u), vec4u(1u), kept > sums);
    let rest = vec4f(sums - kept) + vec4f(vec4i(carries & vec4u(63u)) - vec4i(borrow)) * 4294967296.0;
    // Rounded otherwise here than there a sum may fall short by a few steps.
    let weight = rest.x / TAIL_WEIGHT_SCALE;
    return vec4f(max(rest.yzw, vec3f(0.0)) / k_plus_tail_scale / max(weight, 1e-20), weight);
}

fn resolve(pixel: vec2u) -> Resolved {
    pixels_begin();
    shaded_begin(pixel);
    k_plus_begin();
    let number = pixel_number(pixel);
    var result = Resolved(vec4f(0.0), 0xffffffffu);
    var transmittance = 1.0;
    var colour = vec3f(0.0);
    var kept = vec4u(0u);
    for (var i = 0u; i < K && transmittance > K_PLUS_UNSEEN; i++) {
        let word = fragments[number * K + i];
        if word.y == 0u { break; }
        let fragment = word_unpack(~word.yx);
        if i == 0u { result.key = fragment.key; }
        colour += transmittance * fragment.opacity * shaded_colour(fragment.point, fragment.along);
        transmittance *= 1.0 - fragment.opacity;
        if REST == REST_MERGED { kept += k_plus_steps(fragment); }
    }
    if REST != REST_DROPPED && result.key != 0xffffffffu {
        // Exact, where the product above is of opacities in few bits.
        let depth = fill[number];
        let through = select(exp(-f32(depth) / OPTICAL_DEPTH_SCALE), 0.0, depth >= 0x80000000u);
        let behind = max(transmittance - through, 0.0);
        var own = colour / max(1.0 - transmittance, 1e-20);
        if REST == REST_MERGED && transmittance > K_PLUS_UNSEEN {
            let rest = k_plus_rest(number, kept);
            if rest.w > 0.001 { own = rest.xyz; }
        }
        colour += behind * own;
        transmittance = through;
    }
    result.colour = vec4f(colour, 1.0 - transmittance);
    return result;
}

fn nearest(pixel: vec2u) -> Nearest {
    let resolved = resolve(pixel);
    if resolved.key == 0xffffffffu { return Nearest(0xffffffffu, 0xffffffffu, 0.0, 0.0); }
    let fragment = word_unpack(~fragments[pixel_number(pixel) * K].yx);
    return Nearest(resolved.key, fragment.point, fragment.along, resolved.colour.w);
}
