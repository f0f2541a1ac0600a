// Pixels and depths as every transparency technique numbers and orders them.

// Read once an invocation: some drivers would read a uniform anew at every pixel.
var<private> pixels_reverse: bool;
var<private> pixels_width: u32;
var<private> pixels_first: u32;

fn pixels_begin() {
    pixels_reverse = (drawing.flags & DRAWING_REVERSE_Z) != 0u;
    pixels_width = u32(drawing.viewport.x);
    pixels_first = drawing.row_first * pixels_width;
}

// The bits of a positive float order like the float; with reversed Z the order is turned without losing precision.
fn depth_key(depth: f32) -> u32 {
    let bits = bitcast<u32>(max(depth, 0.0));
    return select(bits, 0x3f800000u - bits, pixels_reverse);
}

fn depth_of_key(key: u32) -> f32 {
    return bitcast<f32>(select(key, 0x3f800000u - key, pixels_reverse));
}

// Number of a pixel among those that this pass treats.
fn pixel_number(pixel: vec2u) -> u32 {
    return pixel.y * pixels_width + pixel.x - pixels_first;
}
