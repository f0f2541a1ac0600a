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

// The view's pixel of a fragment of the target. Lanes that run beside a rectangle's rim for their neighbours' sake get a
// pixel of the band too: what they would read elsewhere might be any number.
fn pixel_of(position: vec4f) -> vec2u {
    let first = frame.origin + vec2u(0u, drawing.row_first);
    let last = frame.origin + vec2u(u32(drawing.viewport.x), drawing.row_end) - 1u;
    return clamp(vec2u(position.xy), first, last) - frame.origin;
}

// What the outputs beside the colour ask of a pixel: key, point and place along the segment of its nearest fragment, with
// 0xffffffff where there is none, and the opacity of all.
struct Nearest {
    key: u32,
    point: u32,
    along: f32,
    opacity: f32,
}

// Number of a pixel among those that this pass treats.
fn pixel_number(pixel: vec2u) -> u32 {
    return pixel.y * pixels_width + pixel.x - pixels_first;
}

// A depth's place in the extent of all hair along the view's axis; `coefficients` is frame.place_of_depth.
fn place_in_extent(coefficients: vec4f, depth: f32) -> f32 {
    let place = (coefficients.x * depth + coefficients.y) / (coefficients.z * depth + coefficients.w);
    return clamp(place, 0.0, 1.0);
}
