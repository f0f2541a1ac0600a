// The host's own objects: shaded spheres without buffers. tests/capi/spirv.rs makes vulkan_host_spirv.h of it.

struct Object {
    clip_from_world: mat4x4f,
    centre: vec3f,
    radius: f32,
    colour: vec3f,
}

var<immediate> object: Object;

struct Point {
    @builtin(position) position: vec4f,
    @location(0) normal: vec3f,
}

const AROUND: u32 = 64u;
const DOWN: u32 = 32u;
const PI: f32 = 3.14159265;

// Two triangles for each patch of AROUND × DOWN.
@vertex
fn sphere(@builtin(vertex_index) index: u32) -> Point {
    var corners = array<vec2u, 6>(vec2u(0, 0), vec2u(1, 0), vec2u(0, 1), vec2u(0, 1), vec2u(1, 0), vec2u(1, 1));
    let patch_index = index / 6u;
    let corner = corners[index % 6u] + vec2u(patch_index % AROUND, patch_index / AROUND);
    let phi = 2.0 * PI * f32(corner.x) / f32(AROUND);
    let theta = PI * f32(corner.y) / f32(DOWN);
    let normal = vec3f(sin(theta) * cos(phi), cos(theta), sin(theta) * sin(phi));
    let world = object.centre + object.radius * normal;
    return Point(object.clip_from_world * vec4f(world, 1.0), normal);
}

@fragment
fn shade(point: Point) -> @location(0) vec4f {
    let light = max(dot(normalize(point.normal), normalize(vec3f(0.9, 0.8, -0.2))), 0.0);
    return vec4f(object.colour * (0.1 + 0.9 * light), 1.0);
}
