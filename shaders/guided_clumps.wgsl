// Guides and their followers: what `surround_points` in src/groom/interpolate.rs does, one strand an invocation.

@group(1) @binding(0) var<uniform> guided_of: Guided;
@group(1) @binding(1) var<storage, read> guided_points: array<f32>;
@group(1) @binding(2) var<storage, read> guided_offsets: array<u32>;
@group(1) @binding(3) var<storage, read> guided_frames: array<f32>;
@group(1) @binding(4) var<storage, read> guided_coordinates: array<f32>;
// Six floats a follower: cosine, sine, distance at the root, stray.
@group(1) @binding(5) var<storage, read> guided_followers: array<f32>;
@group(1) @binding(6) var<storage, read_write> guided_strands: array<f32>;

const GUIDED_FOLLOWER: u32 = 6u;

fn guided_clumps_vector(number: u32, part: u32) -> vec3f {
    let at = 6u * number + part;
    return vec3f(guided_frames[at], guided_frames[at + 1u], guided_frames[at + 2u]);
}

fn guided_clumps_point(number: u32) -> vec3f {
    let at = 3u * number;
    return vec3f(guided_points[at], guided_points[at + 1u], guided_points[at + 2u]);
}

// A follower's point beside the guide's point `number`, without the displacement of strays.
fn guided_clumps_beside(number: u32, place: vec3f) -> vec3f {
    let spread = 1.0 + (guided_of.tip_factor - 1.0) * guided_coordinates[number];
    let across = guided_clumps_vector(number, 0u) * place.x + guided_clumps_vector(number, 3u) * place.y;
    return guided_clumps_point(number) + across * (place.z * spread);
}

@compute @workgroup_size(64)
fn guided_clumps(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = invocation.x + invocation.y * groups.x * 64u;
    if index >= guided_of.count { return; }
    // Each guide comes first, then its followers.
    let each = guided_of.followers + 1u;
    let guide = guided_of.first_guide + index / each;
    let number = index % each;
    let first = guided_offsets[guide];
    let count = guided_offsets[guide + 1u] - first;
    let strand_first = (first - guided_offsets[guided_of.first_guide]) * each + number * count;
    var place = vec3f(0.0);
    var stray = vec3f(0.0);
    if number > 0u {
        let at = guided_of.followers_base + GUIDED_FOLLOWER * ((index / each) * guided_of.followers + number - 1u);
        place = vec3f(guided_followers[at], guided_followers[at + 1u], guided_followers[at + 2u]);
        stray = vec3f(guided_followers[at + 3u], guided_followers[at + 4u], guided_followers[at + 5u]);
    }
    let last = f32(max(count, 2u) - 1u);
    var length_of = 0.0;
    if any(stray != vec3f(0.0)) {
        var before = guided_clumps_beside(first, place);
        for (var point = 1u; point < count; point++) {
            let position = guided_clumps_beside(first + point, place);
            length_of += distance(before, position);
            before = position;
        }
    }
    for (var point = 0u; point < count; point++) {
        let along = f32(point) / last;
        let position = guided_clumps_beside(first + point, place) + stray * (length_of * along * along);
        let at = guided_of.strands_base + 3u * (strand_first + point);
        for (var axis = 0u; axis < 3u; axis++) { guided_strands[at + axis] = position[axis]; }
    }
}
