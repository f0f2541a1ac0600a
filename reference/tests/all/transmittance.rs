use crate::{Random, wavy_strands};
use pelage_reference::fragments::fragment_lists;
use pelage_reference::glam::DVec3;
use pelage_reference::scene::{Camera, Strands, look_at};
use pelage_reference::transmittance::{Light, Occluders, Query, texel_transmittance};
use proptest::prelude::*;

const UP: Light = Light::Directional { towards: DVec3::Z };

fn lights() -> [Light; 3] {
    [
        UP,
        Light::Directional {
            towards: DVec3::new(1.0, 2.0, -0.5),
        },
        Light::Point {
            position: DVec3::new(2.0, -1.0, 3.0),
        },
    ]
}

#[test]
fn a_wall_of_opaque_fibres_lets_nothing_through() {
    let bar = |i: i32| {
        [
            (DVec3::new(-5.0, f64::from(i) * 0.1, 1.0), 0.06),
            (DVec3::new(5.0, f64::from(i) * 0.1, 1.0), 0.06),
        ]
    };
    let occluders = Occluders::new(&Strands::from_polylines((-20..20).map(bar)));
    let query = Query {
        light: UP,
        alpha: 1.0,
        footprint: 0.3,
        samples: 64,
    };
    assert_eq!(occluders.transmittance(DVec3::ZERO, None, &query), 0.0);
    assert_eq!(
        occluders.transmittance(DVec3::Z * 2.0, None, &query),
        1.0,
        "beyond the wall"
    );
    let lamp_before_wall = Query {
        light: Light::Point {
            position: DVec3::Z * 0.9,
        },
        ..query
    };
    assert_eq!(
        occluders.transmittance(DVec3::ZERO, None, &lamp_before_wall),
        1.0
    );
}

#[test]
fn a_crossing_counts_once_however_many_segments_it_touches() {
    let split: Vec<_> = (0..=1000)
        .map(|i| (DVec3::new(i as f64 * 1e-3 - 0.5, 0.0, 1.0), 0.05))
        .collect();
    let occluders = Occluders::new(&Strands::from_polylines([split]));
    assert_eq!(
        occluders.crossings(DVec3::new(0.01, 0.0, 0.0), None, &UP),
        1
    );
    assert_eq!(
        occluders.crossings(DVec3::new(0.51, 0.0, 0.0), None, &UP),
        0,
        "ends are cut straight"
    );
    let slanted = Light::Directional {
        towards: DVec3::new(1.0, 0.0, 1e-3),
    };
    assert_eq!(
        occluders.crossings(DVec3::new(-1000.0, 0.0, 0.0), None, &slanted),
        1,
        "nearly along the fibre"
    );
}

#[test]
fn two_fibres_end_to_end_in_the_points_are_two_crossings() {
    let strand = |z: f64| {
        [
            (DVec3::new(-1.0, 0.0, z), 0.1),
            (DVec3::new(1.0, 0.0, z), 0.1),
        ]
    };
    let occluders = Occluders::new(&Strands::from_polylines([
        strand(1.0),
        strand(2.0),
        strand(3.0),
    ]));
    assert_eq!(occluders.crossings(DVec3::ZERO, None, &UP), 3);
    assert_eq!(
        occluders.crossings(DVec3::Z * 2.0, Some(2), &UP),
        1,
        "from the middle one"
    );
}

#[test]
fn a_strand_that_comes_back_shadows_itself() {
    let hook = [
        DVec3::ZERO,
        DVec3::new(1.0, 0.0, 0.0),
        DVec3::new(2.0, 0.0, 0.5),
        DVec3::new(2.0, 0.0, 1.0),
        DVec3::new(0.0, 0.0, 1.0),
    ];
    let occluders = Occluders::new(&Strands::from_polylines([hook.map(|p| (p, 0.01))]));
    let query = Query {
        light: UP,
        alpha: 0.4,
        footprint: 0.0,
        samples: 1,
    };
    assert_eq!(
        occluders.transmittance(DVec3::new(0.5, 0.0, 0.0), Some(0), &query),
        0.6
    );
    assert_eq!(
        occluders.transmittance(DVec3::new(0.5, 0.0, 1.0), Some(3), &query),
        1.0
    );
}

#[test]
fn a_footprint_half_in_shadow_gets_half_the_light() {
    /// 4000 samples that fill the disc evenly: an edge through it errs by measured 1.5e-4.
    const SAMPLING: f64 = 2e-3;
    let bar = [
        (DVec3::new(-9.0, 5.0, 1.0), 5.0),
        (DVec3::new(9.0, 5.0, 1.0), 5.0),
    ];
    let occluders = Occluders::new(&Strands::from_polylines([bar]));
    let query = Query {
        light: UP,
        alpha: 0.6,
        footprint: 0.2,
        samples: 4000,
    };
    let measured = occluders.transmittance(DVec3::new(0.3, 0.0, -20.0), None, &query);
    assert!((measured - 0.7).abs() < SAMPLING, "{measured}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn a_lone_straight_hair_does_not_shadow_itself(
        seed in 0..u64::MAX, segments in 1..40usize, radius in 1e-4..1e-1f64, footprint in 0.0..0.5f64, at in 0.0..1.0f64,
    ) {
        let mut random = Random(seed);
        let [start, direction] = [random.point(DVec3::ONE), random.direction()];
        let strand: Vec<_> =
            (0..=segments).map(|i| (start + direction * (i as f64 / segments as f64), radius)).collect();
        let occluders = Occluders::new(&Strands::from_polylines([strand]));
        let own = ((at * segments as f64) as usize).min(segments - 1);
        let along = Light::Directional { towards: direction };
        for light in lights().into_iter().chain([along]) {
            let query = Query { light, alpha: 1.0, footprint, samples: 16 };
            prop_assert_eq!(occluders.transmittance(start + direction * at, Some(own), &query), 1.0);
        }
    }

    #[test]
    fn more_hair_and_more_opaque_hair_let_less_light_through(seed in 0..u64::MAX, alpha in 0.0..1.0f64) {
        let strands = wavy_strands(120, 8, 1.5, 0.02, seed);
        let half = Strands { offsets: strands.offsets[..61].to_vec(), ..strands.clone() };
        let half = Strands::from_polylines((0..60).map(|s| {
            half.range(s).map(|i| (half.points[i], half.radii[i])).collect::<Vec<_>>()
        }));
        let [all, half] = [Occluders::new(&strands), Occluders::new(&half)];
        let mut random = Random(seed ^ 1);
        for light in lights() {
            let point = random.point(DVec3::ONE);
            let query = Query { light, alpha, footprint: 0.05, samples: 8 };
            let [all, half] = [&all, &half].map(|occluders| occluders.transmittance(point, None, &query));
            prop_assert!((0.0..=1.0).contains(&all) && all <= half, "{all} {half}");
        }
    }

    #[test]
    fn the_hierarchy_finds_what_asking_every_segment_finds(seed in 0..u64::MAX) {
        let strands = wavy_strands(60, 10, 1.5, 0.03, seed);
        let occluders = Occluders::new(&strands);
        let mut random = Random(seed ^ 2);
        for light in lights() {
            let point = random.point(DVec3::ONE);
            prop_assert_eq!(occluders.crossings(point, None, &light), crossings_one_by_one(&strands, point, &light));
        }
    }
}

/// Crossings by the closest points of two lines, segment by segment, in the strands' order.
fn crossings_one_by_one(strands: &Strands, point: DVec3, light: &Light) -> usize {
    let (ray, reach) = match *light {
        Light::Directional { towards } => (towards, f64::INFINITY),
        Light::Point { position } => (position - point, 1.0),
    };
    let mut crossings = 0;
    for strand in 0..strands.len() {
        let range = strands.range(strand);
        let mut inside = false;
        for i in range.start..range.end - 1 {
            let [a, b] = [strands.points[i], strands.points[i + 1]];
            let [u, w] = [b - a, a - point];
            // Minimise |w + t u - s ray|².
            let [uu, ur, rr, uw, rw] = [u.dot(u), u.dot(ray), ray.dot(ray), u.dot(w), ray.dot(w)];
            let t = (ur * rw - rr * uw) / (uu * rr - ur * ur);
            // Before the start, only the wedge beyond the end of the segment before is filled.
            let side = |d: DVec3| -(w - ray * (rw / rr)).dot(d);
            let in_wedge = i > range.start && side(a - strands.points[i.max(1) - 1]) > 0.0;
            let open = t > 1.0 || (t < 0.0 && !in_wedge);
            let t = t.clamp(0.0, 1.0);
            let s = (rw + t * ur) / rr;
            let radius = strands.radii[i] * (1.0 - t) + strands.radii[i + 1] * t;
            let hit = !open && s > 0.0 && s < reach && (w + u * t - ray * s).length() <= radius;
            // No segment of these strands is as short as they are wide.
            crossings += usize::from(hit && !inside);
            inside = hit;
        }
    }
    crossings
}

#[test]
fn random_cylinders_let_through_what_probability_says() {
    // A ray is hit by each fibre with p = r / W on its own: E Π (1 - alpha) = (1 - alpha p)^n, near exp(-alpha n p).
    const FIBRES: usize = 60;
    const FIELDS: usize = 20_000;
    const RADIUS: f64 = 0.05;
    const REACH: f64 = 1.0;
    const ALPHA: f64 = 0.5;
    let mut random = Random(5);
    let mut sums = [0.0; 2];
    for _ in 0..FIELDS {
        let strands = Strands::from_polylines((0..FIBRES).map(|_| {
            let angle = random.within(0.0, std::f64::consts::PI);
            let [along, across] = [
                DVec3::new(angle.cos(), angle.sin(), 0.0),
                DVec3::new(-angle.sin(), angle.cos(), 0.0),
            ];
            let middle =
                across * random.within(-REACH, REACH) + DVec3::Z * random.within(50.0, 60.0);
            let half = (along + DVec3::Z * random.within(-1.0, 1.0)) * 20.0;
            [(middle - half, RADIUS), (middle + half, RADIUS)]
        }));
        let query = Query {
            light: UP,
            alpha: ALPHA,
            footprint: 0.0,
            samples: 1,
        };
        let passed = Occluders::new(&strands).transmittance(DVec3::ZERO, None, &query);
        sums[0] += passed;
        sums[1] += passed * passed;
    }
    let mean = sums[0] / FIELDS as f64;
    let deviation = ((sums[1] / FIELDS as f64 - mean * mean) / FIELDS as f64).sqrt();
    let expected = (1.0 - ALPHA * RADIUS / REACH).powi(FIBRES as i32);
    assert!(
        (mean - expected).abs() < 4.0 * deviation,
        "{mean} {expected} ± {deviation}"
    );
    assert!((expected - (-ALPHA * RADIUS / REACH * FIBRES as f64).exp()).abs() < 0.01);
}

#[test]
fn degenerate_strands_stop_nothing() {
    let strands =
        Strands::from_polylines([vec![], vec![(DVec3::Z, 1.0)], vec![(DVec3::Z, 1.0); 4]]);
    let occluders = Occluders::new(&strands);
    assert_eq!(occluders.crossings(DVec3::ZERO, None, &UP), 0);
    assert_eq!(occluders.crossings(DVec3::ZERO, Some(2), &UP), 0);
    assert_eq!(
        Occluders::new(&Strands::default()).crossings(DVec3::ZERO, None, &UP),
        0
    );
}

fn light_camera(texels: usize) -> Camera {
    let view = look_at(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y);
    Camera::orthographic(view, 1.5, [0.1, 10.0], [texels, texels])
}

#[test]
fn a_texel_knows_the_fibres_before_a_point_by_their_area() {
    // A texel is 0.3 wide; a fibre 0.06 wide crosses the one in the middle, at z = 1.
    let strand = [
        (DVec3::new(-1.0, 0.0, 1.0), 0.03),
        (DVec3::new(1.0, 0.0, 1.0), 0.03),
    ];
    let camera = light_camera(5);
    let camera = Camera {
        width: 5,
        height: 5,
        ..camera
    };
    let lists = fragment_lists(&Strands::from_polylines([strand]), &camera, None);
    let at = |point| texel_transmittance(&lists, &camera, 0.5, point);
    assert!((at(DVec3::new(0.0, 0.2, 0.0)) - (1.0 - 0.5 * 0.06 / 0.6)).abs() < 1e-12);
    assert_eq!(at(DVec3::new(0.0, 0.2, 1.1)), 1.0, "before the fibre");
    assert_eq!(at(DVec3::new(9.0, 0.2, 0.0)), 1.0, "outside of the map");
}

#[test]
fn fine_texels_agree_with_rays_on_average() {
    /// 2000 points of mean 0.5: measured 5e-4. Within a texel as wide as a fibre, partial overlaps are not told apart.
    const STATISTICAL: f64 = 0.02;
    let strands = wavy_strands(300, 12, 1.5, 0.02, 21);
    let occluders = Occluders::new(&strands);
    let camera = light_camera(1500);
    let lists = fragment_lists(&strands, &camera, None);
    let query = Query {
        light: UP,
        alpha: 0.5,
        footprint: 0.0,
        samples: 1,
    };
    let mut random = Random(9);
    let mut sums = [0.0; 2];
    for _ in 0..2000 {
        let point = random.point(DVec3::ONE);
        sums[0] += occluders.transmittance(point, None, &query) / 2000.0;
        sums[1] += texel_transmittance(&lists, &camera, 0.5, point) / 2000.0;
    }
    println!("rays and texels: {sums:?}");
    assert!(
        (sums[0] - sums[1]).abs() < STATISTICAL && sums[0] < 0.9,
        "{sums:?}"
    );
}
