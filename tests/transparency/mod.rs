//! Tests of `pelage::transparency`.

mod a_buffer;
mod dbk_buffer;
mod depth_peeling;
mod every_technique;
mod k_buffer;
mod k_buffer_single_pass;
mod k_plus_buffer;
mod kept;
mod large;
mod memory;
mod moment;
mod opaque;
mod overflow;
mod pools;
mod random_subsets;
mod sorted_blending;
mod weighted_blended;

use pelage::glam::DVec3;
use pelage::{Hair, View};

/// The extremes of a perspective view's distances of the corners of a hair's box.
fn extent(hair: &Hair, view: &View) -> [f64; 2] {
    let (_, origin) = pelage::testing::points_buffer(hair);
    let half = pelage::testing::half_extent(hair);
    let distances = (0..8).map(|corner| {
        let sign = |bit: i32| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let point = origin + half * DVec3::new(sign(0), sign(1), sign(2));
        let world = hair.world_from_object.transform_point3(point);
        -view.view_from_world.transform_point3(world).z
    });
    distances.fold([f64::INFINITY, 0.0], |[low, high], distance| {
        [low.min(distance), high.max(distance)]
    })
}

/// The distance of a depth in [`crate::common::scenes::portrait`], whose planes are 0.1 and 10 away.
fn portrait_distance(depth: f64) -> f64 {
    let [near, far] = [0.1, 10.0];
    near * far / (far - depth * (far - near))
}
