// Opacity shadow maps: where the planes lie. Plane i of N stands at extent · f(i/N) from the nearest hair's plane,
// f(x) = x (1 - u + u x): evenly where u = 0, ever farther apart where it is more.

fn opacity_plane(x: f32, uneven: f32) -> f32 {
    return x * (1.0 - uneven + uneven * x);
}

// The slab, from 0 to count - 1, of a depth in units of the extent: what lies between planes i and i + 1.
fn opacity_slab(depth: f32, uneven: f32, count: u32) -> u32 {
    let even = 1.0 - uneven;
    let y = clamp(depth, 0.0, 1.0);
    let x = 2.0 * y / max(even + sqrt(even * even + 4.0 * uneven * y), 1e-20);
    return min(u32(x * f32(count)), count - 1u);
}
