// The host's own shadow maps: whether its opaque scene stands between a light and a position.

@group(3) @binding(0) var occluder_0: texture_depth_2d;
@group(3) @binding(1) var occluder_1: texture_depth_2d;
@group(3) @binding(2) var occluder_2: texture_depth_2d;
@group(3) @binding(3) var occluder_3: texture_depth_2d;
@group(3) @binding(4) var occluder_4: texture_depth_2d;
@group(3) @binding(5) var occluder_5: texture_depth_2d;
@group(3) @binding(6) var occluder_6: texture_depth_2d;
@group(3) @binding(7) var occluder_7: texture_depth_2d;

fn occluder_depth(number: u32, texel: vec2i) -> f32 {
    switch number {
        case 0u: { return textureLoad(occluder_0, texel, 0); }
        case 1u: { return textureLoad(occluder_1, texel, 0); }
        case 2u: { return textureLoad(occluder_2, texel, 0); }
        case 3u: { return textureLoad(occluder_3, texel, 0); }
        case 4u: { return textureLoad(occluder_4, texel, 0); }
        case 5u: { return textureLoad(occluder_5, texel, 0); }
        case 6u: { return textureLoad(occluder_6, texel, 0); }
        default: { return textureLoad(occluder_7, texel, 0); }
    }
}

fn occluder_size(number: u32) -> vec2i {
    switch number {
        case 0u: { return vec2i(textureDimensions(occluder_0)); }
        case 1u: { return vec2i(textureDimensions(occluder_1)); }
        case 2u: { return vec2i(textureDimensions(occluder_2)); }
        case 3u: { return vec2i(textureDimensions(occluder_3)); }
        case 4u: { return vec2i(textureDimensions(occluder_4)); }
        case 5u: { return vec2i(textureDimensions(occluder_5)); }
        case 6u: { return vec2i(textureDimensions(occluder_6)); }
        default: { return vec2i(textureDimensions(occluder_7)); }
    }
}

// The part of a box of `width` texels around a place, in texels, that is lit at a depth; beyond the map all is.
fn occluder_filtered(number: u32, place: vec2f, depth: f32, width: i32) -> f32 {
    let size = occluder_size(number);
    let reverse = (frame.occluders[number].flags & OCCLUDER_REVERSE_Z) != 0u;
    let corner = place - 0.5 * f32(width);
    let first = floor(corner);
    let offset = corner - first;
    var lit = 0.0;
    for (var y = 0; y <= width; y++) {
        let weight_y = select(select(1.0, offset.y, y == width), 1.0 - offset.y, y == 0);
        for (var x = 0; x <= width; x++) {
            let weight = weight_y * select(select(1.0, offset.x, x == width), 1.0 - offset.x, x == 0);
            let texel = vec2i(first) + vec2i(x, y);
            var hidden = false;
            if all(texel >= vec2i(0)) && all(texel < size) {
                let nearest = occluder_depth(number, texel);
                hidden = select(depth > nearest, depth < nearest, reverse);
            }
            lit += select(weight, 0.0, hidden);
        }
    }
    return lit / f32(width * width);
}

// The part of a light, in the direction `wi` from a position, that the host's opaque scene lets through.
fn occlusion(position: vec3f, wi: vec3f, light: u32) -> f32 {
    let count = frame.occluder_count;
    for (var number = 0u; number < count; number++) {
        if frame.occluders[number].light != light { continue; }
        let moved = position + wi * frame.occluders[number].bias;
        let clip = frame.occluders[number].clip_from_relative * vec4f(moved, 1.0);
        if clip.w <= 0.0 || any(abs(clip.xy) > vec2f(clip.w)) { continue; }
        let ndc = clip.xyz / clip.w;
        let place = vec2f(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * vec2f(occluder_size(number));
        return occluder_filtered(number, place, saturate(ndc.z), i32(frame.occluders[number].pcf));
    }
    return 1.0;
}
