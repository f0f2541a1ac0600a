// The host's opaque scene: two-sided Lambert under the frame's lights.

struct Light {
    // Towards the light (w = 0), or the light's place relative to the eye (w = 1).
    place: vec4f,
    // Irradiance, or intensity; w: the cosine of a spot's outer angle.
    power: vec4f,
    // A spot's axis; w: one over the difference of the inner and the outer angle's cosines.
    axis: vec4f,
}

struct Scene {
    clip_from_relative: mat4x4f,
    albedo: vec4f,
    // Radiance of the environment; w: the number of lights.
    ambient: vec4f,
    lights: array<Light, 16>,
}

@group(0) @binding(0) var<uniform> scene: Scene;

struct Vertex {
    @builtin(position) clip: vec4f,
    // Relative to the eye.
    @location(0) place: vec3f,
    @location(1) normal: vec3f,
}

@vertex
fn lambert_vertex(@location(0) place: vec3f, @location(1) normal: vec3f) -> Vertex {
    return Vertex(scene.clip_from_relative * vec4f(place, 1.0), place, normal);
}

@fragment
fn lambert(vertex: Vertex) -> @location(0) vec4f {
    // The side that is seen is the one that is lit. The triangle tells which that is: a smooth normal near an outline
    // may look away from the eye although its side is seen.
    let plane = cross(dpdx(vertex.place), dpdy(vertex.place));
    let seen = select(plane, -plane, dot(plane, vertex.place) > 0.0);
    let normal = select(-1.0, 1.0, dot(vertex.normal, seen) >= 0.0) * normalize(vertex.normal);
    var irradiance = 3.14159265 * scene.ambient.xyz;
    for (var i = 0u; i < u32(scene.ambient.w); i++) {
        let light = scene.lights[i];
        let to_light = light.place.xyz - vertex.place * light.place.w;
        let distance = max(length(to_light), 1e-20);
        let falloff = select(1.0, 1.0 / (distance * distance), light.place.w > 0.0);
        let t = saturate((-dot(light.axis.xyz, to_light / distance) - light.power.w) * light.axis.w);
        irradiance += light.power.xyz * falloff * t * t * (3.0 - 2.0 * t) * max(dot(normal, to_light / distance), 0.0);
    }
    return vec4f(scene.albedo.xyz * irradiance / 3.14159265, 1.0);
}
