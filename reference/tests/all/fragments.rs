use crate::{Random, wavy_strands};
use pelage_reference::coverage::{Ribbon, supersampled_coverage};
use pelage_reference::fragments::{FragmentLists, fragment_lists};
use pelage_reference::glam::{DVec2, DVec3};
use pelage_reference::scene::{Camera, Strands, look_at};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

const SIZE: usize = 128;
const CURVE_SAMPLES: usize = 32;

/// Of a strand's whole area, where no joint turns by more than 0.2: measured 0.004. What one band loses on one side of
/// a joint, another wins on the other.
const CURVE_TOTAL: f64 = 0.02;

/// Of one pixel, where a joint bends by up to 0.2 and the owner's band is taken beyond it: measured 0.043, of which
/// 0.006 is sampling.
const CURVE_PIXEL: f64 = 0.08;

/// A strand on the screen, at depth ½.
fn on_screen(points: &[DVec2], half_width: f64) -> Strands {
    Strands::from_polylines([points
        .iter()
        .map(|p| (p.extend(0.5), half_width))
        .collect::<Vec<_>>()])
}

fn lists_of(strands: &Strands) -> FragmentLists {
    fragment_lists(strands, &Camera::of_pixels(SIZE, SIZE), None)
}

fn total_coverage(lists: &FragmentLists) -> f64 {
    lists
        .fragments
        .iter()
        .map(|fragment| fragment.coverage)
        .sum()
}

fn centre(pixel: usize) -> DVec2 {
    DVec2::new((pixel % SIZE) as f64 + 0.5, (pixel / SIZE) as f64 + 0.5)
}

/// An arc of a circle around the middle of the image.
fn arc(radius: f64, turn: f64, segments: usize, phase: f64) -> Vec<DVec2> {
    let at = |i| {
        DVec2::splat(64.2) + DVec2::from_angle(phase + turn * i as f64 / segments as f64) * radius
    };
    (0..=segments).map(at).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn a_straight_strand_covers_its_length_times_its_width(
        width in prop_oneof![0.01..0.1f64, 0.1..1.0f64, 1.0..10.0f64],
        angle in prop_oneof![0.0..TAU, Just(0.0), Just(PI / 4.0), Just(PI / 2.0), Just(PI)],
        x in -0.5..0.5f64, y in -0.5..0.5f64,
        segment in prop_oneof![0.05..0.5f64, 0.5..5.0f64, 5.0..50.0f64],
        segments in 1..40usize,
    ) {
        /// Relative, over sums of up to 1000 pixels: measured below 1e-13.
        const EXACT: f64 = 1e-11;
        let segments = segments.min((100.0 / segment) as usize);
        let along = DVec2::from_angle(angle) * segment;
        let first = DVec2::new(64.0 + x, 64.0 + y) - along * (segments as f64 * 0.5);
        let points: Vec<DVec2> = (0..=segments).map(|i| first + along * i as f64).collect();

        let lists = lists_of(&on_screen(&points, width * 0.5));
        let expected = width * segment * segments as f64;
        let measured = total_coverage(&lists);
        prop_assert!((measured / expected - 1.0).abs() < EXACT, "{measured} {expected}");

        for pixel in 0..lists.pixels() {
            prop_assert!(lists.pixel(pixel).len() <= 1, "pixel {pixel} holds the strand twice");
        }
    }

    #[test]
    fn every_pixel_of_a_gently_curved_strand_has_one_fragment_of_the_right_area(
        radius in 15.0..60.0f64, turn in 0.5..3.0f64, phase in 0.0..TAU,
        segments in 2..200usize, width in 0.05..3.0f64,
    ) {
        // Gentle: a turn of less than 0.2 at a joint.
        let segments = segments.max((turn / 0.2).ceil() as usize);
        let points = arc(radius, turn, segments, phase);
        let lists = lists_of(&on_screen(&points, width * 0.5));
        let half_widths = vec![width * 0.5; points.len()];
        let ribbon = Ribbon { points: &points, half_widths: &half_widths };

        let mut sampled_total = 0.0;
        let mut touched = 0;
        let mut worst = 0.0_f64;
        for pixel in 0..lists.pixels() {
            // Off the arc by more than its sagitta, a pixel and its width there is nothing.
            if (centre(pixel).distance(DVec2::splat(64.2)) - radius).abs() > 3.5 {
                prop_assert!(lists.pixel(pixel).is_empty());
                continue;
            }
            let sampled = supersampled_coverage(&ribbon, centre(pixel), CURVE_SAMPLES);
            let exact = total(lists.pixel(pixel));
            prop_assert!(lists.pixel(pixel).len() <= 1);
            prop_assert!(sampled < 0.05 || lists.pixel(pixel).len() == 1, "{sampled} lost at {}", centre(pixel));
            sampled_total += sampled;
            touched += usize::from(sampled > 0.0);
            worst = worst.max((exact - sampled).abs());
        }
        let measured = total_coverage(&lists);
        let area = width * 2.0 * segments as f64 * radius * (0.5 * turn / segments as f64).sin();
        // Two edges cross up to 4·32 cells of a pixel.
        let sampling = 5.0 * (touched as f64).sqrt() * 0.5 * (4.0 * CURVE_SAMPLES as f64).sqrt() / (CURVE_SAMPLES.pow(2) as f64);
        prop_assert!((measured - sampled_total).abs() < CURVE_TOTAL * area + sampling, "{measured} {sampled_total}");
        prop_assert!((measured / area - 1.0).abs() < CURVE_TOTAL, "{measured} {area}");
        prop_assert!(worst < CURVE_PIXEL, "{worst}");
    }

    #[test]
    fn splitting_segments_changes_nothing(
        ax in 20.0..100.0f64, ay in 20.0..100.0f64, bx in 20.0..100.0f64, by in 20.0..100.0f64,
        width in 0.02..8.0f64, parts in 2..300usize,
    ) {
        /// Points of a split line are off it by 1e-14, and tilt parts of 1e-3 px: measured 3e-12.
        const ROUNDING: f64 = 1e-9;
        let [a, b] = [DVec2::new(ax, ay), DVec2::new(bx, by)];
        prop_assume!(a.distance(b) > 0.1);
        let points: Vec<DVec2> = (0..=parts).map(|i| a.lerp(b, i as f64 / parts as f64)).collect();
        let whole = lists_of(&on_screen(&[a, b], width * 0.5));
        let split = lists_of(&on_screen(&points, width * 0.5));
        for pixel in 0..whole.pixels() {
            let [whole, split] = [&whole, &split].map(|lists| total(lists.pixel(pixel)));
            prop_assert!((whole - split).abs() < ROUNDING, "{} {whole} {split}", centre(pixel));
        }
    }
}

fn total(fragments: &[pelage_reference::fragments::Fragment]) -> f64 {
    fragments.iter().map(|fragment| fragment.coverage).sum()
}

#[test]
fn coincident_points_change_nothing() {
    let points = arc(40.0, 2.0, 30, 0.3);
    let doubled: Vec<DVec2> = points.iter().flat_map(|&p| [p, p, p]).collect();
    let [plain, doubled] = [points, doubled].map(|points| lists_of(&on_screen(&points, 0.7)));
    assert_eq!(plain.offsets, doubled.offsets);
    for (a, b) in plain.fragments.iter().zip(&doubled.fragments) {
        assert_eq!([a.coverage, a.depth, a.t], [b.coverage, b.depth, b.t]);
        assert_eq!(
            a.segment * 3 + 2,
            b.segment,
            "the segment that has a length"
        );
    }
}

#[test]
fn segments_too_short_to_have_a_direction_turn_no_joint() {
    let straight = [
        DVec2::new(20.0, 20.3),
        DVec2::new(50.0, 20.3),
        DVec2::new(100.0, 20.3),
    ];
    let knot = DVec2::new(50.0, 20.3 + 1e-9);
    let knotted = [straight[0], straight[1], knot, straight[1], straight[2]];
    let [plain, knotted] =
        [&straight[..], &knotted[..]].map(|points| lists_of(&on_screen(points, 2.0)));
    assert_eq!(plain.offsets, knotted.offsets);
    assert!((total_coverage(&plain) - total_coverage(&knotted)).abs() < 1e-6);
}

#[test]
fn strands_of_one_point_and_of_coincident_points_leave_nothing() {
    let strands = Strands::from_polylines([
        vec![],
        vec![(DVec3::new(60.0, 60.0, 0.5), 4.0)],
        vec![(DVec3::new(60.0, 60.0, 0.5), 4.0); 5],
    ]);
    assert!(lists_of(&strands).fragments.is_empty());
    assert!(lists_of(&Strands::default()).fragments.is_empty());
    assert_eq!(lists_of(&Strands::default()).offsets.len(), SIZE * SIZE + 1);
}

#[test]
fn a_sharp_turn_is_a_second_crossing() {
    let turned = |angle: f64| {
        let corner = DVec2::new(64.3, 64.4);
        let points = [
            corner - DVec2::X * 30.0,
            corner,
            corner + DVec2::from_angle(angle) * 30.0,
        ];
        lists_of(&on_screen(&points, 0.4))
    };
    let crossings = |lists: &FragmentLists| (0..lists.pixels()).map(|i| lists.pixel(i).len()).max();
    assert_eq!(crossings(&turned(119f64.to_radians())), Some(1));
    assert_eq!(crossings(&turned(121f64.to_radians())), Some(2));
    // Each is cut straight where it ends.
    let area = total_coverage(&turned(179f64.to_radians()));
    assert!((area - 2.0 * 30.0 * 0.8).abs() < 1e-9, "{area}");
}

/// Strands of segments of hashed lengths up to `longest`, bent by up to 115° at every joint.
fn bent(longest: f64, seed: u64) -> Vec<DVec2> {
    let mut random = Random(seed);
    let mut at = DVec2::splat(64.0) + DVec2::new(random.within(0.0, 1.0), random.within(0.0, 1.0));
    let mut angle = random.within(0.0, TAU);
    let mut points = vec![at];
    for _ in 0..3 {
        at += DVec2::from_angle(angle) * random.within(0.1 * longest, longest);
        points.push(at);
        angle += random.within(-2.0, 2.0);
    }
    points
}

#[test]
fn a_strand_covers_no_more_of_a_pixel_than_twice_its_length() {
    for seed in 0..400 {
        for longest in [1e-5, 1e-3, 0.03] {
            let points = bent(longest, seed);
            let length: f64 = points
                .windows(2)
                .map(|ends| ends[0].distance(ends[1]))
                .sum();
            for half_width in [0.05, 0.5, 5.0, 25.0] {
                let lists = lists_of(&on_screen(&points, half_width));
                for fragment in &lists.fragments {
                    // A pixel is at most √2 across.
                    let most = 2.0 * length * 2f64.sqrt() * (1.0 + 1e-9);
                    assert!(
                        fragment.coverage <= most,
                        "{} of {length}",
                        fragment.coverage
                    );
                }
            }
        }
    }
}

/// Root mean square over the pixels of strands 2 px wide, shorter than a pixel and bent sharply: measured 0.131. Cuts at right angles to
/// the first and the last segment have 0.161.
const BENT_ENDS: f64 = 0.14;

#[test]
fn the_ends_of_sharply_bent_strands_are_close_to_their_area() {
    let (mut sum, mut count) = (0.0, 0);
    for seed in 0..300 {
        let points = bent(0.33, seed);
        let half_widths = [1.0; 4];
        let ribbon = Ribbon {
            points: &points,
            half_widths: &half_widths,
        };
        let lists = lists_of(&on_screen(&points, 1.0));
        for pixel in 0..lists.pixels() {
            if centre(pixel).distance(points[0]) > 4.0 {
                continue;
            }
            let passed: f64 = lists
                .pixel(pixel)
                .iter()
                .map(|fragment| 1.0 - fragment.coverage)
                .product();
            let sampled = supersampled_coverage(&ribbon, centre(pixel), CURVE_SAMPLES);
            if passed < 1.0 || sampled > 0.0 {
                sum += (1.0 - passed - sampled).powi(2);
                count += 1;
            }
        }
    }
    let rmse = (sum / f64::from(count)).sqrt();
    assert!(rmse < BENT_ENDS, "{rmse}");
}

#[test]
fn depth_and_place_follow_the_segment() {
    let strand = [
        (DVec3::new(10.0, 20.5, 0.2), 0.3),
        (DVec3::new(110.0, 20.5, 0.8), 0.3),
    ];
    let lists = lists_of(&Strands::from_polylines([strand]));
    for x in 10..110 {
        let [fragment] = lists.at(x, 20) else {
            panic!("one fragment at {x}")
        };
        let t = (x as f64 + 0.5 - 10.0) / 100.0;
        assert!((fragment.t - t).abs() < 1e-12 && (fragment.depth - (0.2 + 0.6 * t)).abs() < 1e-12);
    }
}

#[test]
fn what_lies_behind_the_host_or_beyond_the_far_plane_is_left_out() {
    let strand = [
        (DVec3::new(10.0, 20.5, 0.0), 0.3),
        (DVec3::new(110.0, 20.5, 2.0), 0.3),
    ];
    let strands = Strands::from_polylines([strand]);
    let camera = Camera::of_pixels(SIZE, SIZE);
    let columns =
        |lists: &FragmentLists| (0..SIZE).filter(|&x| !lists.at(x, 20).is_empty()).count();
    assert_eq!(columns(&fragment_lists(&strands, &camera, None)), 50);
    let host = vec![0.5; SIZE * SIZE];
    let visible = fragment_lists(&strands, &camera, Some(&host));
    assert_eq!(columns(&visible), 25);
    assert!(
        visible
            .fragments
            .iter()
            .all(|fragment| fragment.depth < 0.5)
    );
}

#[test]
fn lists_are_sorted_and_every_fragment_is_in_range() {
    let strands = wavy_strands(300, 12, 1.5, 0.01, 7);
    let view = look_at(DVec3::Z * 4.0, DVec3::ZERO, DVec3::Y);
    let lists = fragment_lists(
        &strands,
        &Camera::perspective(view, 0.7, [0.1, 10.0], [160, 120]),
        None,
    );
    assert!(lists.fragments.len() > 10_000);
    for i in 0..lists.pixels() {
        assert!(
            lists
                .pixel(i)
                .windows(2)
                .all(|p| (p[0].depth, p[0].segment) < (p[1].depth, p[1].segment))
        );
    }
    for fragment in &lists.fragments {
        assert!((0.0..=1.0).contains(&fragment.depth) && (0.0..=1.0).contains(&fragment.t));
        assert!(fragment.coverage > 0.0 && fragment.coverage <= 1.0);
        assert!(
            strands
                .range(fragment.strand as usize)
                .contains(&(fragment.segment as usize))
        );
    }
}

#[test]
fn a_strand_through_the_near_plane_is_one_that_ends_there() {
    let view = look_at(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y);
    let camera = Camera::perspective(view, 1.0, [1.0, 20.0], [160, 120]);
    let [far, behind] = [DVec3::new(-0.9, -0.4, -2.0), DVec3::new(0.5, 0.3, 9.0)];
    // The near plane is at z = 4.
    let at_near = far.lerp(behind, 6.0 / 11.0);
    let lists = |end: DVec3| {
        fragment_lists(
            &Strands::from_polylines([[(far, 0.02), (end, 0.02)]]),
            &camera,
            None,
        )
    };
    let [through, ending] = [lists(behind), lists(at_near)];
    assert!(total_coverage(&through) > 10.0);
    assert_eq!(through.fragments.len(), ending.fragments.len());
    for (a, b) in through.fragments.iter().zip(&ending.fragments) {
        assert!((a.coverage - b.coverage).abs() < 1e-9 && (a.depth - b.depth).abs() < 1e-9);
        assert!(
            (a.t - b.t * 6.0 / 11.0).abs() < 1e-9,
            "the place on the whole segment"
        );
    }
}

#[test]
fn strands_at_and_around_the_eye_stay_finite() {
    let view = look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y);
    let camera = Camera::perspective(view, 1.2, [1e-4, 20.0], [64, 48]);
    let lists = fragment_lists(&wavy_strands(400, 8, 1.0, 0.02, 3), &camera, None);
    assert!(!lists.fragments.is_empty());
    assert!(
        lists
            .fragments
            .iter()
            .all(|f| f.coverage.is_finite() && f.depth.is_finite() && f.t.is_finite())
    );
}

#[test]
fn two_segments_share_out_pixels_along_the_bisector_of_their_joint() {
    // Right and then down, around (64.3, 64.4): the bisector plane's normal is (1, 1).
    let corner = DVec2::new(64.3, 64.4);
    let points = [corner - DVec2::X * 30.0, corner, corner + DVec2::Y * 30.0];
    let lists = lists_of(&on_screen(&points, 3.0));
    let mut owned = [0, 0];
    for pixel in 0..lists.pixels() {
        for fragment in lists.pixel(pixel) {
            let offset = centre(pixel) - corner;
            assert_eq!(
                fragment.segment,
                u32::from(offset.x + offset.y >= 0.0),
                "{offset}"
            );
            owned[fragment.segment as usize] += 1;
        }
    }
    assert!(owned[0] > 150 && owned[1] > 150, "{owned:?}");
}

#[test]
fn a_strand_may_be_walked_from_either_end() {
    let mut points = arc(30.0, 4.0, 23, 0.77);
    let forwards = lists_of(&on_screen(&points, 1.3));
    points.reverse();
    let backwards = lists_of(&on_screen(&points, 1.3));
    for pixel in 0..forwards.pixels() {
        let [forwards, backwards] = [&forwards, &backwards].map(|lists| total(lists.pixel(pixel)));
        assert!(
            (forwards - backwards).abs() < 1e-12,
            "{}: {forwards} {backwards}",
            centre(pixel)
        );
    }
}

#[test]
fn bands_of_rows_hold_the_fragments_of_the_whole() {
    let strands = wavy_strands(60, 12, 1.5, 0.01, 7);
    let view = look_at(DVec3::new(0.3, 0.2, 4.0), DVec3::ZERO, DVec3::Y);
    let camera = Camera::perspective(view, 0.7, [0.5, 10.0], [61, 47]);
    let whole = fragment_lists(&strands, &camera, None);
    let mut compared = 0;
    for (first, rows) in [(0, 1), (1, 30), (31, 16)] {
        let band = fragment_lists(&strands, &camera.rows(first, rows), None);
        assert_eq!((band.width, band.height), (61, rows));
        for pixel in 0..band.pixels() {
            let (own, expected) = (band.pixel(pixel), whole.pixel(first * 61 + pixel));
            assert_eq!(own.len(), expected.len());
            for (own, expected) in own.iter().zip(expected) {
                assert_eq!(own.segment, expected.segment);
                // Rows are counted from another place: a last digit of a pixel's.
                assert!((own.coverage - expected.coverage).abs() < 1e-9);
                assert!((own.depth - expected.depth).abs() < 1e-12);
                compared += 1;
            }
        }
    }
    assert_eq!(compared, whole.fragments.len());
    assert!(compared > 1000);
}
