// Sorted blending: the image into which the segments were blended.

@group(3) @binding(0) var blended: texture_2d<f32>;

struct Resolved {
    // Premultiplied.
    colour: vec4f,
    // Key of the nearest fragment.
    key: u32,
}

fn resolve(pixel: vec2u) -> Resolved {
    pixels_begin();
    return Resolved(textureLoad(blended, pixel, 0), nearest_key(pixel_number(pixel)));
}

fn nearest(pixel: vec2u) -> Nearest {
    pixels_begin();
    return nearest_of(pixel_number(pixel), textureLoad(blended, pixel, 0).w);
}
