// Two unit vectors perpendicular to each guide at every point, carried along it by the smallest turns: what
// `transported_frames` in src/groom/interpolate.rs does, one guide an invocation.

@group(1) @binding(0) var<uniform> guided_of: Guided;
@group(1) @binding(1) var<storage, read> guided_points: array<f32>;
@group(1) @binding(2) var<storage, read> guided_offsets: array<u32>;
@group(1) @binding(6) var<storage, read_write> guided_frames: array<f32>;

fn guided_frames_point(number: u32) -> vec3f {
    let at = 3u * number;
    return vec3f(guided_points[at], guided_points[at + 1u], guided_points[at + 2u]);
}

// A unit vector, or `otherwise` where there is no length.
fn guided_frames_unit(v: vec3f, otherwise: vec3f) -> vec3f {
    let size = length(v);
    if !(size > 1e-30 && size < 1e30) { return otherwise; }
    return v / size;
}

// Some unit vector perpendicular to the unit vector `v`: Duff et al., Building an Orthonormal Basis, Revisited (2017).
fn guided_frames_any(v: vec3f) -> vec3f {
    let side = select(-1.0, 1.0, v.z >= 0.0);
    let a = -1.0 / (side + v.z);
    let b = v.x * v.y * a;
    return vec3f(b, side + v.y * v.y * a, -v.y);
}

@compute @workgroup_size(64)
fn guided_frames_carry(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let guide = invocation.x + invocation.y * groups.x * 64u;
    if guide >= guided_of.count { return; }
    let first = guided_offsets[guide];
    let end = guided_offsets[guide + 1u];
    var tangent = vec3f(0.0, 1.0, 0.0);
    var normal = vec3f(1.0, 0.0, 0.0);
    for (var point = first; point < end; point++) {
        let before = guided_frames_point(select(point - 1u, point, point == first));
        let after = guided_frames_point(min(point + 1u, end - 1u));
        // Where points coincide the last tangent holds.
        tangent = guided_frames_unit(after - before, tangent);
        normal = guided_frames_unit(normal - tangent * dot(normal, tangent), guided_frames_any(tangent));
        let binormal = cross(tangent, normal);
        for (var axis = 0u; axis < 3u; axis++) {
            guided_frames[6u * point + axis] = normal[axis];
            guided_frames[6u * point + 3u + axis] = binormal[axis];
        }
    }
}
