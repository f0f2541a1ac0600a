// Depth peeling: the peels in their order, then the tail of what none has reached.

@group(3) @binding(3) var<storage, read> peeled: array<u32>;

struct Resolved {
    // Premultiplied.
    colour: vec4f,
    // Key of the nearest fragment.
    key: u32,
}

fn depth_peeling_composite(number: u32) -> vec4f {
    let state = number * PEEL_WORDS;
    let bits = vec3u(peeled[state + PEEL_COLOUR], peeled[state + PEEL_COLOUR + 1u], peeled[state + PEEL_COLOUR + 2u]);
    var colour = bitcast<vec3f>(bits);
    var transmittance = bitcast<f32>(peeled[state + PEEL_TRANSMITTANCE] ^ PEEL_ONE);
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
