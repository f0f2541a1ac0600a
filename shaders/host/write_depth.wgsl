// Writes an image of floats into a depth attachment: WebGPU copies no data into a 32-bit float depth.

@group(0) @binding(0) var depths: texture_2d<f32>;

@vertex
fn write_depth_vertex(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4f {
    // One triangle that covers the image.
    return vec4f(f32(vertex & 1u) * 4.0 - 1.0, f32(vertex >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn write_depth(@builtin(position) pixel: vec4f) -> @builtin(frag_depth) f32 {
    return textureLoad(depths, vec2u(pixel.xy), 0).r;
}
