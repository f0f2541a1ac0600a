// Random subsets: a pixel's nearest fragments, one of each subset, are put in order, shaded, and composited front to back.
//
// As Hunz has it, all others are lost, and with them opacity. With `exact alpha` the colour is scaled up to the opacity of
// all the pixel's fragments.

@group(3) @binding(1) var<storage, read> fill: array<u32>;
@group(3) @binding(2) var<storage, read> links: array<u32>;
@group(3) @binding(3) var<storage, read> subset_points: array<u32>;
@group(3) @binding(6) var<storage, read> subset_values: array<u32>;

struct Resolved {
    // Premultiplied.
    colour: vec4f,
    // Key of the nearest fragment.
    key: u32,
}

fn random_subsets_opacity(value: u32) -> f32 {
    let root = f32(value >> 16u) / 65535.0;
    return root * root;
}

// The opacity of all of a pixel's fragments, or what its subsets have.
fn random_subsets_alpha(number: u32, kept: f32) -> f32 {
    if frame.technique.y == 0.0 { return kept; }
    return 1.0 - exp(-f32(fill[number]) / OPTICAL_DEPTH_SCALE);
}

fn resolve(pixel: vec2u) -> Resolved {
    pixels_begin();
    shaded_begin(pixel);
    let number = pixel_number(pixel);
    let first = number * SUBSETS;
    // The places of the subsets that are not empty, in order of (depth, segment): insertion, since they are few.
    var places: array<u32, SUBSETS>;
    var count = 0u;
    for (var subset = 0u; subset < SUBSETS; subset++) {
        let place = first + subset;
        let key = links[place];
        if key == 0u { continue; }
        let point = subset_points[place];
        var at = count;
        while at > 0u {
            let other = places[at - 1u];
            // Words are distances from the largest: the larger is nearer.
            if links[other] > key || (links[other] == key && subset_points[other] > point) { break; }
            places[at] = other;
            at -= 1u;
        }
        places[at] = place;
        count += 1u;
    }
    var result = Resolved(vec4f(0.0), 0xffffffffu);
    if count == 0u { return result; }
    var colour = vec3f(0.0);
    var transmittance = 1.0;
    // 1 - transmittance, which would cancel where opacities are tiny.
    var kept = 0.0;
    for (var i = 0u; i < count; i++) {
        let place = places[i];
        let value = subset_values[place];
        let opacity = random_subsets_opacity(value);
        let along = f32(value & 0xffffu) / 65535.0;
        colour += transmittance * opacity * shaded_colour(0xffffffffu - subset_points[place], along);
        kept += transmittance * opacity;
        transmittance *= 1.0 - opacity;
    }
    let alpha = random_subsets_alpha(number, kept);
    if kept > 0.0 { colour *= alpha / kept; }
    result.colour = vec4f(colour, alpha);
    result.key = 0xffffffffu - links[places[0]];
    return result;
}

fn nearest(pixel: vec2u) -> Nearest {
    pixels_begin();
    let number = pixel_number(pixel);
    let first = number * SUBSETS;
    var key = 0u;
    var point = 0u;
    var value = 0u;
    var transmittance = 1.0;
    for (var place = first; place < first + SUBSETS; place++) {
        if links[place] == 0u { continue; }
        transmittance *= 1.0 - random_subsets_opacity(subset_values[place]);
        if links[place] > key || (links[place] == key && subset_points[place] > point) {
            key = links[place];
            point = subset_points[place];
            value = subset_values[place];
        }
    }
    if key == 0u { return Nearest(0xffffffffu, 0xffffffffu, 0.0, 0.0); }
    let alpha = random_subsets_alpha(number, 1.0 - transmittance);
    return Nearest(0xffffffffu - key, 0xffffffffu - point, f32(value & 0xffffu) / 65535.0, alpha);
}
