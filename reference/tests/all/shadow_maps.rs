//! The models of shadow techniques, against values found by hand.

use pelage_reference::fragments::fragment_lists;
use pelage_reference::glam::{DVec3, DVec4};
use pelage_reference::scene::{Camera, Strands, look_at};
use pelage_reference::shadow_maps::{
    LightMap, Occluder, approximated_deep_shadow_map, nearest_depth, opacity_shadow_maps,
    shadow_map,
};

fn occluder(depth: f64, coverage: f64, at_centre: bool) -> Occluder {
    Occluder {
        segment: 0,
        depth,
        coverage,
        at_centre,
    }
}

#[test]
fn a_shadow_map_decides_by_the_nearest_fibre_at_the_centre() {
    let occluders = [occluder(1.0, 0.2, false), occluder(2.0, 0.4, true)];
    assert_eq!(shadow_map(&occluders, 1.5, 0.6), 1.0);
    assert_eq!(shadow_map(&occluders, 2.5, 0.6), 0.4);
    assert_eq!(shadow_map(&[], 2.5, 0.6), 1.0);
}

#[test]
fn a_point_s_own_fibre_stands_for_it_where_it_crosses_the_texel() {
    assert_eq!(nearest_depth(2.0, None, 0.5), 2.0);
    assert_eq!(nearest_depth(2.0, Some(3.0), 0.5), 1.5);
    assert_eq!(nearest_depth(2.0, Some(1.0), 0.5), 0.5);
}

#[test]
fn an_approximated_deep_shadow_map_counts_the_nearest_fibre_and_one_every_spacing() {
    // One that misses the centre is not known of.
    let occluders = [occluder(0.5, 0.2, false), occluder(1.0, 0.2, true)];
    let passed = |depth| approximated_deep_shadow_map(&occluders, depth, 0.5, 0.25);
    assert_eq!(passed(1.0), 1.0);
    assert!((passed(1.0 + 1e-9) - 0.5).abs() < 1e-6);
    assert!((passed(1.5) - 0.125).abs() < 1e-12);
}

#[test]
fn opacity_shadow_maps_know_the_exact_product_at_planes_and_a_mean_between() {
    let occluders = [occluder(0.5, 0.5, true), occluder(1.5, 1.0, true)];
    let planes = [0.0, 1.0, 2.0];
    let passed = |depth| opacity_shadow_maps(&occluders, depth, 0.8, &planes);
    assert_eq!(passed(0.0), 1.0);
    assert!((passed(1.0) - 0.6).abs() < 1e-12);
    assert!((passed(2.0) - 0.6 * 0.2).abs() < 1e-12);
    // The second fibre covers all: half of its optical depth of ln 5 at half of its slab.
    assert!((passed(1.5) - 0.6 * 0.2f64.sqrt()).abs() < 1e-12);
    assert!((passed(9.0) - 0.6 * 0.2).abs() < 1e-12);
}

/// Two crossed fibres, one across a map of 8×8 texels of size 1, seen from +z.
#[test]
fn a_map_knows_depths_centres_and_the_filter_s_weights() {
    let strands = Strands::from_polylines([
        [
            (DVec3::new(-3.0, 0.4, 1.0), 0.2),
            (DVec3::new(3.0, 0.4, 1.0), 0.2),
        ],
        [
            (DVec3::new(0.3, -3.0, -1.0), 0.05),
            (DVec3::new(0.3, 3.0, 0.0), 0.05),
        ],
    ]);
    let view = look_at(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, DVec3::Y);
    let camera = Camera::orthographic(view, 4.0, [0.0, 10.0], [8, 8]);
    let lists = fragment_lists(&strands, &camera, None);
    let map = LightMap {
        camera: &camera,
        lists: &lists,
        depth_row: DVec4::new(0.0, 0.0, -1.0, 5.0),
        strands: &strands,
    };
    // The texel with x from 0 to 1 and y from 0 to 1: row 3, column 4.
    let occluders = map.occluders(4, 3);
    assert_eq!(occluders.len(), 2);
    let [first, second] = [occluders[0], occluders[1]];
    assert!((first.depth - 4.0).abs() < 1e-12 && first.at_centre);
    // The texel's middle is at y = 0.5, where the other strand is at z = -1 + 3.5 / 6.
    assert!((second.depth - (6.0 - 3.5 / 6.0)).abs() < 1e-9 && !second.at_centre);
    assert!((first.coverage - 0.4).abs() < 1e-9);

    // Centred on (0.75, 0.5): a box of 1 covers columns 4 and 5 by three quarters and one; of 3, by parts.
    let position = DVec3::new(0.75, 0.5, 0.0);
    let of_column = |column: usize| move |x: usize, _: usize| f64::from(u8::from(x == column));
    assert!((map.filtered(position, 1, of_column(4)) - 0.75).abs() < 1e-12);
    assert!((map.filtered(position, 1, of_column(5)) - 0.25).abs() < 1e-12);
    assert!((map.filtered(position, 3, of_column(3)) - 0.75 / 3.0).abs() < 1e-12);
    assert!((map.filtered(DVec3::new(4.0, 0.0, 0.0), 1, |_, _| 0.0) - 0.5).abs() < 1e-12);
}
