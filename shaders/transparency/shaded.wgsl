// The colour of a fragment, as every transparency technique asks for it. Here: radiance of shaded strand points, interpolated
// along the segment. `shading/fragments` is the other file with these functions.

@group(3) @binding(6) var<storage, read> shaded: array<vec2u>;

fn shaded_point(point: u32) -> vec3f {
    let words = shaded[point];
    return vec3f(unpack2x16float(words.x), unpack2x16float(words.y).x);
}

// The hash of the strand that a point is of, 16 bits.
fn shaded_hash(point: u32) -> u32 {
    return shaded[point].y >> 16u;
}

// Before the first colour in a pixel of the view.
fn shaded_begin(pixel: vec2u) {}

fn shaded_colour(point: u32, along: f32) -> vec3f {
    return mix(shaded_point(point), shaded_point(point + 1u), along);
}
