// Radiance of shaded strand points, interpolated along a segment.

fn shaded_point(point: u32) -> vec3f {
    let words = shaded[point];
    return vec3f(unpack2x16float(words.x), unpack2x16float(words.y).x);
}

fn shaded_colour(point: u32, along: f32) -> vec3f {
    return mix(shaded_point(point), shaded_point(point + 1u), along);
}
