// DBK-buffer by a depth shift: what lies beyond the shift, drawn as one opaque layer: the colour of its nearest fragment
// at the opacity of all.

// Colour, premultiplied, and transmittance.
fn resolve_beyond(number: u32) -> vec4f {
    let words = DBK_BEYOND_AT * dbk_pixels() + number * DBK_BEYOND_WORDS;
    if overflow[words + DBK_BEYOND_NEAREST] == 0u { return vec4f(0.0, 0.0, 0.0, 1.0); }
    let winner = 0xffffffffu - overflow[words + DBK_BEYOND_WINNER];
    let through = exp(-f32(overflow[words + DBK_BEYOND_DEPTH]) / OPTICAL_DEPTH_SCALE);
    return vec4f(shaded_colour(winner >> 8u, f32(winner & 255u) / 255.0) * (1.0 - through), through);
}
