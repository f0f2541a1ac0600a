// Random subsets: a pixel's nearest fragments, one of each subset, are put in order, shaded, and composited front to back.
//
// As Hunz has it, all others are lost, and with them opacity. With `exact alpha` the colour is scaled up to the opacity of
// all the pixel's fragments.

@group(3) @binding(1) var<storage, read> fill: array<u32>;
@group(3) @binding(3) var<storage, read> fragments_0: array<u32>;
@group(3) @binding(4) var<storage, read> fragments_1: array<u32>;

struct Resolved {
    // Premultiplied.
    colour: vec4f,
    // Key of the nearest fragment.
    key: u32,
}

const RANDOM_SUBSETS_NONE: u32 = 0xffffffffu;

// The word of a place; all ones where its subset is empty.
fn random_subsets_word(place: u32) -> vec2u {
    return ~vec2u(fragments_0[place], fragments_1[place]);
}

// The opacity of all of a pixel's fragments, or what its subsets have.
fn random_subsets_alpha(number: u32, kept: f32) -> f32 {
    if frame.technique.y == 0.0 { return kept; }
    return 1.0 - exp(-f32(fill[number]) / OPTICAL_DEPTH_SCALE);
}

fn resolve(pixel: vec2u) -> Resolved {
    pixels_begin();
    word_begin();
    shaded_begin(pixel);
    let number = pixel_number(pixel);
    let first = number * SUBSETS;
    // The words of the subsets that are not empty, in order of (depth, segment): insertion, since they are few.
    var words: array<vec2u, SUBSETS>;
    var count = 0u;
    for (var subset = 0u; subset < SUBSETS; subset++) {
        let word = random_subsets_word(first + subset);
        if word.x == RANDOM_SUBSETS_NONE { continue; }
        var at = count;
        while at > 0u {
            let other = words[at - 1u];
            if word_before(other, word) { break; }
            words[at] = other;
            at -= 1u;
        }
        words[at] = word;
        count += 1u;
    }
    var result = Resolved(vec4f(0.0), 0xffffffffu);
    if count == 0u { return result; }
    var colour = vec3f(0.0);
    var transmittance = 1.0;
    // 1 - transmittance, which would cancel where opacities are tiny.
    var kept = 0.0;
    for (var i = 0u; i < count; i++) {
        let fragment = word_unpack(words[i]);
        colour += transmittance * fragment.opacity * shaded_colour(fragment.point, fragment.along);
        kept += transmittance * fragment.opacity;
        transmittance *= 1.0 - fragment.opacity;
    }
    let alpha = random_subsets_alpha(number, kept);
    if kept > 0.0 { colour *= alpha / kept; }
    result.colour = vec4f(colour, alpha);
    result.key = word_key(words[0].x);
    return result;
}

fn nearest(pixel: vec2u) -> Nearest {
    pixels_begin();
    word_begin();
    let number = pixel_number(pixel);
    let first = number * SUBSETS;
    var foremost = vec2u(RANDOM_SUBSETS_NONE);
    var transmittance = 1.0;
    for (var place = first; place < first + SUBSETS; place++) {
        let word = random_subsets_word(place);
        if word.x == RANDOM_SUBSETS_NONE { continue; }
        transmittance *= 1.0 - word_value(word.y).x;
        if word_before(word, foremost) { foremost = word; }
    }
    if foremost.x == RANDOM_SUBSETS_NONE { return Nearest(0xffffffffu, 0xffffffffu, 0.0, 0.0); }
    let fragment = word_unpack(foremost);
    return Nearest(fragment.key, fragment.point, fragment.along, random_subsets_alpha(number, 1.0 - transmittance));
}
