// The guides' positions, from a buffer of any stride, brought to the points that strands are made of: every guide with as
// many points as the longest, or as they are. A position that is not finite leaves the guide's point where it was.

@group(1) @binding(0) var<uniform> guided_of: Guided;
@group(1) @binding(1) var<storage, read> guided_source: array<u32>;
@group(1) @binding(2) var<storage, read> guided_taps: array<vec4u>;
@group(1) @binding(6) var<storage, read_write> guided_points: array<f32>;

// The bits of a float's exponent: all of them are set where it is infinite, or no number.
const GUIDED_EXPONENT: u32 = 0x7f800000u;

fn guided_bits(number: u32) -> vec3u {
    let at = guided_of.source_base + number * guided_of.stride;
    return vec3u(guided_source[at], guided_source[at + 1u], guided_source[at + 2u]);
}

fn guided_finite(bits: vec3u) -> bool {
    return all((bits & vec3u(GUIDED_EXPONENT)) != vec3u(GUIDED_EXPONENT));
}

@compute @workgroup_size(64)
fn guided(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = invocation.x + invocation.y * groups.x * 64u;
    if index >= guided_of.count { return; }
    // Two points of the host's, and where between them.
    let tap = guided_taps[index];
    let first = guided_bits(tap.x);
    let second = guided_bits(tap.y);
    let t = bitcast<f32>(tap.z);
    let position = bitcast<vec3f>(first) * (1.0 - t) + bitcast<vec3f>(second) * t;
    if !guided_finite(first) || !guided_finite(second) || !guided_finite(bitcast<vec3u>(position)) { return; }
    for (var axis = 0u; axis < 3u; axis++) { guided_points[3u * index + axis] = position[axis]; }
}
