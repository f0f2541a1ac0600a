// Depth peeling: the peels in their order, then the tail of what none has reached.

@group(3) @binding(3) var<storage, read> peeled: array<u32>;

struct Resolved {
    // Premultiplied.
    colour: vec4f,
    // Key of the nearest fragment.
    key: u32,
}

fn depth_peeling_composite(number: u32) -> vec4f {
    let words = number * PEEL_WORDS;
    let bits = vec3u(peeled[words + PEEL_COLOUR], peeled[words + PEEL_COLOUR + 1u], peeled[words + PEEL_COLOUR + 2u]);
    var colour = bitcast<vec3f>(bits);
    var transmittance = bitcast<f32>(peeled[words + PEEL_TRANSMITTANCE] ^ PEEL_ONE);
    let word = peeled[words + PEEL_VALUE];
    if word != 0u {
        let value = depth_peeling_value(word);
        colour += transmittance * value.x * shaded_colour(peeled[words + PEEL_POINT] - 1u, value.y);
        transmittance *= 1.0 - value.x;
    }
    if transmittance > PEEL_UNSEEN {
        let tail = tail_of(number);
        colour += transmittance * tail.xyz;
        transmittance *= tail.w;
    }
    return vec4f(colour, 1.0 - transmittance);
}

fn resolve(pixel: vec2u) -> Resolved {
    pixels_begin();
    shaded_begin(pixel);
    let number = pixel_number(pixel);
    return Resolved(depth_peeling_composite(number), nearest_key(number));
}

fn nearest(pixel: vec2u) -> Nearest {
    pixels_begin();
    let number = pixel_number(pixel);
    return nearest_of(number, depth_peeling_composite(number).w);
}
