// Pixels and depths as every transparency technique numbers and orders them.

// The bits of a positive float order like the float; with reversed Z the order is turned without losing precision.
fn depth_key(depth: f32) -> u32 {
    let bits = bitcast<u32>(max(depth, 0.0));
    return select(bits, 0x3f800000u - bits, (drawing.flags & DRAWING_REVERSE_Z) != 0u);
}

fn depth_of_key(key: u32) -> f32 {
    return bitcast<f32>(select(key, 0x3f800000u - key, (drawing.flags & DRAWING_REVERSE_Z) != 0u));
}

// Number of a pixel among those that this pass treats.
fn pixel_number(pixel: vec2u) -> u32 {
    return (pixel.y - drawing.row_first) * u32(drawing.viewport.x) + pixel.x;
}
