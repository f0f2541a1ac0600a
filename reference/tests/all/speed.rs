//! Measurements, not properties: `cargo test --release -p pelage-reference -- --ignored --nocapture`.

use crate::{Random, wavy_strands};
use pelage_reference::composite::composite;
use pelage_reference::fragments::fragment_lists;
use pelage_reference::glam::DVec3;
use pelage_reference::scene::{Camera, look_at};
use pelage_reference::transmittance::{Light, Occluders, Query};
use std::time::Instant;

#[test]
#[ignore = "a measurement"]
fn ten_thousand_strands_are_listed_in_a_second_or_two() {
    let strands = wavy_strands(10_000, 16, 1.5, 0.002, 1);
    let view = look_at(DVec3::Z * 4.0, DVec3::ZERO, DVec3::Y);
    let camera = Camera::perspective(view, 0.7, [0.1, 10.0], [328, 430]);
    let start = Instant::now();
    let lists = fragment_lists(&strands, &camera, None);
    let listed = start.elapsed();
    let image = composite(&lists, 0.5, |_| [1.0; 3]);
    println!(
        "{} fragments in {listed:?}, with composite {:?}",
        lists.fragments.len(),
        start.elapsed()
    );
    assert!(image.pixels.iter().any(|pixel| pixel[3] > 0.5));
}

#[test]
#[ignore = "a measurement"]
fn ten_thousand_points_are_lit_through_fifty_thousand_strands_in_a_few_seconds() {
    let strands = wavy_strands(50_000, 16, 1.5, 0.001, 2);
    let start = Instant::now();
    let occluders = Occluders::new(&strands);
    println!("800,000 segments prepared in {:?}", start.elapsed());
    let mut random = Random(3);
    let points: Vec<(DVec3, Option<usize>)> = (0..10_000)
        .map(|_| {
            let point = strands.range(random.within(0.0, 50_000.0) as usize).start + 8;
            (strands.points[point], Some(point))
        })
        .collect();
    let light = Light::Directional {
        towards: DVec3::new(0.3, 1.0, 0.5),
    };
    let start = Instant::now();
    let query = Query {
        light,
        alpha: 0.3,
        footprint: 0.002,
        samples: 16,
    };
    let passed = occluders.transmittances(&points, &query);
    let mean = passed.iter().sum::<f64>() / passed.len() as f64;
    println!(
        "160,000 rays in {:?}, mean transmittance {mean:.4}",
        start.elapsed()
    );
}
