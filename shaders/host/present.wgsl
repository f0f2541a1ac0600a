// Puts a target over a clear colour into a window's surface, pixel upon pixel from the upper left: both are linear, the
// target premultiplied. Where the surface's format does not encode what is written to it, it is encoded here.

// IEC 61966-2-1.
const SRGB_LINEAR_END = 0.0031308;

// True where the surface holds bytes of the sRGB curve and its format is not told so.
override encode: bool;

@group(0) @binding(0) var<uniform> clear: vec4f;
@group(0) @binding(1) var shown: texture_2d<f32>;

fn present_srgb(linear: vec3f) -> vec3f {
    let value = clamp(linear, vec3f(0.0), vec3f(1.0));
    let low = 12.92 * value;
    let high = 1.055 * pow(value, vec3f(1.0 / 2.4)) - 0.055;
    return select(high, low, value <= vec3f(SRGB_LINEAR_END));
}

@vertex
fn present_vertex(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4f {
    // One triangle that covers the surface.
    return vec4f(f32(vertex & 1u) * 4.0 - 1.0, f32(vertex >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn present(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let at = vec2u(pixel.xy);
    var colour = clear.rgb;
    if (all(at < textureDimensions(shown))) {
        let over = textureLoad(shown, at, 0);
        colour = over.rgb + (1.0 - over.a) * clear.rgb;
    }
    if (encode) {
        colour = present_srgb(colour);
    }
    return vec4f(colour, 1.0);
}
