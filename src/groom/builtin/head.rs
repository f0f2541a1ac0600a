//! A head, neck and shoulders as a signed distance field, in metres: +y up, the face towards +z, ears on ±x, the origin
//! between the ears. The crown is at y = 0.12, the chin at -0.12, the shoulders' tops at -0.18, the base at -0.25.
//!
//! Ellipsoids, spheres and capsules are joined by a polynomial smooth minimum (Quilez, "smooth minimum",
//! <https://iquilezles.org/articles/smin/>). The field is a bound on the distance rather than the distance itself:
//! ellipsoids use the first-order estimate f / |∇f|.

use glam::{Vec3, vec3};

/// Signed distance estimate to the skin, in metres; negative inside.
pub(crate) fn distance(p: Vec3) -> f32 {
    // The head is symmetric: what is modelled at x >= 0 holds at -x too.
    join(skull_of(p), ears(p), 0.004)
}

/// Signed distance estimate to what hair stays out of: the skin, and the space before the face.
pub(crate) fn hair_distance(p: Vec3) -> f32 {
    let face_room = ellipsoid(p - vec3(0.0, -0.045, 0.085), vec3(0.06, 0.105, 0.06));
    join(distance(p), face_room, 0.02)
}

/// The outward unit normal of a distance field by central differences.
pub(crate) fn gradient(field: impl Fn(Vec3) -> f32, p: Vec3, step: f32) -> Vec3 {
    let slope = |axis: Vec3| field(p + axis * step) - field(p - axis * step);
    vec3(slope(Vec3::X), slope(Vec3::Y), slope(Vec3::Z))
        .try_normalize()
        .unwrap_or(Vec3::Y)
}

/// Signed distance estimate to the head without its ears, in metres: where hair grows.
pub(crate) fn skull_of(p: Vec3) -> f32 {
    let q = vec3(p.x.abs(), p.y, p.z);
    let mut d = skull(q);
    d = join(d, face(q), 0.018);
    join(features(d, q), torso(q), 0.022)
}

fn skull(q: Vec3) -> f32 {
    let back = ellipsoid(q - vec3(0.0, 0.030, -0.022), vec3(0.077, 0.090, 0.090));
    let front = ellipsoid(q - vec3(0.0, 0.036, 0.020), vec3(0.066, 0.078, 0.066));
    join(back, front, 0.03)
}

fn face(q: Vec3) -> f32 {
    let mask = ellipsoid(q - vec3(0.0, -0.040, 0.028), vec3(0.059, 0.078, 0.056));
    let jaw = capsule(
        q,
        vec3(0.040, -0.064, 0.006),
        vec3(0.014, -0.102, 0.060),
        0.018,
        0.015,
    );
    let chin = ellipsoid(q - vec3(0.0, -0.106, 0.072), vec3(0.018, 0.014, 0.014));
    let cheek = sphere(q - vec3(0.041, -0.026, 0.055), 0.021);
    let jowl = sphere(q - vec3(0.030, -0.060, 0.042), 0.025);
    join(
        join(mask, jaw, 0.025),
        join(join(chin, cheek, 0.02), jowl, 0.02),
        0.022,
    )
}

/// Adds brow, nose, lips and eyes to the smooth face `d`.
fn features(d: f32, q: Vec3) -> f32 {
    let brow = capsule(
        q,
        vec3(0.004, 0.016, 0.080),
        vec3(0.040, 0.018, 0.066),
        0.008,
        0.008,
    );
    let mut d = join(d, brow, 0.016);
    let socket = ellipsoid(q - vec3(0.031, -0.001, 0.090), vec3(0.018, 0.012, 0.016));
    d = carve(d, socket, 0.012);
    let eyeball = sphere(q - vec3(0.031, -0.001, 0.0655), 0.0125);
    d = join(d, eyeball, 0.003);
    let upper_lid = capsule(
        q,
        vec3(0.021, 0.005, 0.075),
        vec3(0.043, 0.003, 0.069),
        0.003,
        0.003,
    );
    d = join(d, upper_lid, 0.005);
    let bridge = capsule(
        q,
        vec3(0.0, 0.010, 0.083),
        vec3(0.0, -0.032, 0.0985),
        0.007,
        0.0115,
    );
    let nostril = sphere(q - vec3(0.0115, -0.037, 0.088), 0.0075);
    d = join(d, join(bridge, nostril, 0.008), 0.010);
    let upper_lip = capsule(
        q,
        vec3(0.0, -0.0640, 0.0840),
        vec3(0.020, -0.0680, 0.0755),
        0.0055,
        0.003,
    );
    let lower_lip = capsule(
        q,
        vec3(0.0, -0.0755, 0.0815),
        vec3(0.017, -0.0715, 0.0750),
        0.0065,
        0.003,
    );
    let lips = join(upper_lip, lower_lip, 0.006);
    join(d, lips, 0.008)
}

/// Signed distance estimate to the ears, in metres.
pub(crate) fn ears(p: Vec3) -> f32 {
    ear(vec3(p.x.abs(), p.y, p.z))
}

fn ear(q: Vec3) -> f32 {
    // Tilted back and standing off the head.
    let local = q - vec3(0.076, -0.010, -0.014);
    let tilted = vec3(
        local.x - 0.25 * (-local.z).max(-0.01),
        local.y,
        local.z + 0.25 * local.y,
    );
    let shell = ellipsoid(tilted, vec3(0.010, 0.030, 0.018));
    let bowl = ellipsoid(
        tilted - vec3(0.014, 0.003, 0.003),
        vec3(0.009, 0.018, 0.010),
    );
    carve(shell, bowl, 0.006)
}

fn torso(q: Vec3) -> f32 {
    let neck = capsule(
        q,
        vec3(0.0, -0.060, -0.028),
        vec3(0.0, -0.190, -0.038),
        0.049,
        0.056,
    );
    let shoulder = capsule(
        q,
        vec3(0.03, -0.214, -0.042),
        vec3(0.140, -0.234, -0.038),
        0.043,
        0.043,
    );
    let chest = ellipsoid(q - vec3(0.0, -0.300, -0.022), vec3(0.155, 0.105, 0.082));
    let bust = join(join(neck, shoulder, 0.06), chest, 0.05);
    // A bust ends in a flat base.
    carve(bust, q.y + 0.25, 0.02)
}

/// Smooth union over a width of `k`.
fn join(a: f32, b: f32, k: f32) -> f32 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - 0.25 * k * h * h
}

/// Smoothly takes `b` out of `a`; for a plane height `b`, all that is below it.
fn carve(a: f32, b: f32, k: f32) -> f32 {
    -join(-a, b, k)
}

fn sphere(p: Vec3, radius: f32) -> f32 {
    p.length() - radius
}

fn ellipsoid(p: Vec3, radii: Vec3) -> f32 {
    let scaled = (p / radii).length();
    let slope = (p / (radii * radii)).length();
    // At the centre the estimate is 0/0; there the distance is the shortest radius.
    if slope > 1e-6 {
        scaled * (scaled - 1.0) / slope
    } else {
        -radii.min_element()
    }
}

/// A capsule between two balls of different radii (the cone between them by linear interpolation).
fn capsule(p: Vec3, a: Vec3, b: Vec3, radius_a: f32, radius_b: f32) -> f32 {
    let (pa, ba) = (p - a, b - a);
    let t = (pa.dot(ba) / ba.length_squared()).clamp(0.0, 1.0);
    (pa - ba * t).length() - (radius_a + (radius_b - radius_a) * t)
}
