// Shading at fragments: what is asked of `transparency/shaded` is found anew at the fragment's own place along its segment:
// position, tangent, shadow and model. `shading/fibre_points` has written what it reads.

@group(1) @binding(0) var<storage, read> shading_tables: array<u32>;
@group(3) @binding(6) var<storage, read> fibre_points: array<vec4u>;

// Where the fragment's run keeps its parameters.
var<private> fragments_run: u32;

fn material_value(i: u32) -> vec4f {
    // All hairs of the frame have the same.
    if ONE_MATERIAL { return material.values[i]; }
    return bitcast<vec4f>(fibre_points[fragments_run + i]);
}

fn fragments_tangent(word: u32) -> vec3f {
    let flat = unpack2x16snorm(word);
    let z = 1.0 - abs(flat.x) - abs(flat.y);
    let below = max(-z, 0.0);
    return normalize(vec3f(flat - select(vec2f(-below), vec2f(below), flat >= vec2f(0.0)), z));
}

// The pixel that is resolved.
var<private> fragments_pixel: vec2u;

fn shaded_begin(pixel: vec2u) { fragments_pixel = pixel; }

// Where the line of sight through the view's pixel coordinates passes the fibre: from -1 to 1 across it, as Chiang's h.
fn fragments_offset(coordinates: vec2f, position: vec3f, tangent: vec3f, radius: f32) -> f32 {
    let ndc = vec2f(2.0, -2.0) * coordinates / vec2f(f32(frame.width), f32(frame.height)) + vec2f(-1.0, 1.0);
    let homogeneous = frame.relative_from_clip * vec4f(ndc, 0.5, 1.0);
    let seen = homogeneous.xyz / homogeneous.w;
    let to_eye = frame.eye.xyz - seen * frame.eye.w;
    let across = cross(tangent, to_eye);
    let size = length(across);
    let on_ray = select(seen, frame.eye.xyz, frame.eye.w > 0.0);
    return select(0.0, -dot(on_ray - position, across) / max(size * radius, 1e-30), size > 1e-12);
}

// The part of the fibre's width that the pixel sees; all of it where it is not wider than the pixel.
fn fragments_across(position: vec3f, tangent: vec3f, radius: f32) -> vec2f {
    let centre = vec2f(fragments_pixel) + 0.5;
    let h = fragments_offset(centre, position, tangent, radius);
    let right = fragments_offset(centre + vec2f(1.0, 0.0), position, tangent, radius) - h;
    let below = fragments_offset(centre + vec2f(0.0, 1.0), position, tangent, radius) - h;
    let half = 0.5 * length(vec2f(right, below));
    if !(half < 1.0) { return vec2f(-1.0, 1.0); }
    // A centre beside the fibre sees its rim: never less than a hundredth of the pixel.
    let middle = clamp(h, -1.0 - 0.98 * half, 1.0 + 0.98 * half);
    return clamp(vec2f(middle - half, middle + half), vec2f(-1.0), vec2f(1.0));
}

fn shaded_colour(point: u32, along: f32) -> vec3f {
    let at = point * FIBRE_POINT_VECTORS;
    let start = fibre_points[at];
    let own = fibre_points[at + 1u];
    let end = fibre_points[at + FIBRE_POINT_VECTORS];
    let end_own = fibre_points[at + FIBRE_POINT_VECTORS + 1u];
    fragments_run = frame.fibre_runs + (own.w >> 16u) * FIBRE_RUN_VECTORS;
    settings_begin();
    let from_tangent = fragments_tangent(start.w);
    let turned = mix(from_tangent, fragments_tangent(end.w), along);
    let size = length(turned);
    var fibre: Fibre;
    // Ends that lead against each other have no tangent between them.
    fibre.tangent = select(from_tangent, turned / max(size, 1e-6), size > 1e-6);
    fibre.colour = vec3f(unpack2x16float(own.x), unpack2x16float(own.y & 0xffffu).x);
    fibre.coordinate = mix(f32(own.y >> 16u), f32(end_own.y >> 16u), along) / 65535.0;
    fibre.strand = own.z & POINT_STRAND;
    let before = bitcast<vec3f>(start.xyz);
    let after = bitcast<vec3f>(end.xyz);
    let position = mix(before, after, along);
    let run = fibre_points[fragments_run + MATERIAL_VECTORS];
    let radius = mix(unpack2x16float(own.w).x, unpack2x16float(end_own.w).x, along) * bitcast<f32>(run.y);
    // The segment alone, prolonged.
    let starts = (own.z & POINT_FIRST) != 0u;
    let ends = (end_own.z & POINT_LAST) != 0u;
    shadow_fibre = ShadowFibre(before, after, radius, bitcast<f32>(run.z), starts, ends);
    fibre.across = vec2f(-1.0, 1.0);
    if NEAR { fibre.across = fragments_across(position, fibre.tangent, radius); }
    // From the buffer and not from the uniform, since one software driver compiles a fragment shader anew, at every draw, whose
    // loop ends at a uniform.
    return shading_radiance(fibre, position, run.x);
}
