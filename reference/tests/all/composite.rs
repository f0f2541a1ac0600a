use crate::wavy_strands;
use pelage_reference::composite::{
    Image, composite, composite_with_tail, fragments_needed, nearest_depth, opaque, point_colours,
    transmittance,
};
use pelage_reference::fragments::{Fragment, FragmentLists, fragment_lists};
use pelage_reference::glam::DVec3;
use pelage_reference::scene::{Camera, Strands, look_at};

/// Products and sums of a few hundred numbers below 1: measured 4e-16.
const ROUNDING: f64 = 1e-13;

fn camera() -> Camera {
    let view = look_at(DVec3::Z * 4.0, DVec3::ZERO, DVec3::Y);
    Camera::perspective(view, 0.7, [0.1, 10.0], [96, 72])
}

fn field() -> (Strands, FragmentLists, Vec<[f64; 3]>) {
    let strands = wavy_strands(400, 12, 1.5, 0.01, 11);
    let lists = fragment_lists(&strands, &camera(), None);
    let colours = strands
        .points
        .iter()
        .map(|p| [0.5 + 0.3 * p.x.sin(), 0.5 + 0.3 * p.y.cos(), 0.7])
        .collect();
    (strands, lists, colours)
}

/// Hair that hides what is behind it by far.
fn thick_field() -> (FragmentLists, Vec<[f64; 3]>) {
    let strands = wavy_strands(600, 12, 1.5, 0.05, 12);
    let colours = strands
        .points
        .iter()
        .map(|p| [0.5 + 0.3 * p.x.sin(), 0.5, 0.7])
        .collect();
    (fragment_lists(&strands, &camera(), None), colours)
}

fn greatest_difference(a: &Image, b: &Image) -> f64 {
    let channels = |image: &Image| image.pixels.iter().flatten().copied().collect::<Vec<f64>>();
    channels(a)
        .iter()
        .zip(channels(b))
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

#[test]
fn an_opaque_front_hides_all_behind_it() {
    let plank = |z: f64| {
        [
            (DVec3::new(-10.0, 8.0, z), 40.0),
            (DVec3::new(30.0, 8.0, z), 40.0),
        ]
    };
    let strands = Strands::from_polylines([plank(0.7), plank(0.3), plank(0.5)]);
    let lists = fragment_lists(&strands, &Camera::of_pixels(16, 16), None);
    let image = composite(&lists, 1.0, |fragment| {
        [f64::from(fragment.strand), 0.25, 0.5]
    });
    assert!(
        image
            .pixels
            .iter()
            .all(|pixel| *pixel == [1.0, 0.25, 0.5, 1.0])
    );
    assert!(
        nearest_depth(&lists)
            .iter()
            .all(|depth| (depth - 0.3).abs() < ROUNDING)
    );
    assert!(
        fragments_needed(&lists, 1.0, 0.01)
            .iter()
            .all(|&needed| needed == 1)
    );
}

#[test]
fn two_layers_are_as_written() {
    let bar = |z: f64, half: f64| {
        [
            (DVec3::new(0.0, 0.5, z), half),
            (DVec3::new(1.0, 0.5, z), half),
        ]
    };
    let strands = Strands::from_polylines([bar(0.6, 0.25), bar(0.4, 0.1)]);
    let lists = fragment_lists(&strands, &Camera::of_pixels(1, 1), None);
    let [near, far] = [0.8 * 0.2, 0.8 * 0.5];
    let image = composite(&lists, 0.8, |f| {
        if f.strand == 1 {
            [1.0, 0.0, 0.0]
        } else {
            [0.0, 1.0, 0.0]
        }
    });
    let expected = [
        near,
        (1.0 - near) * far,
        0.0,
        1.0 - (1.0 - near) * (1.0 - far),
    ];
    for (actual, expected) in image.pixels[0].into_iter().zip(expected) {
        assert!((actual - expected).abs() < ROUNDING, "{actual} {expected}");
    }
    let over = image.over([0.0, 0.0, 2.0]).pixels[0];
    assert!((over[2] - 2.0 * (1.0 - near) * (1.0 - far)).abs() < ROUNDING && over[3] == 1.0);
}

#[test]
fn the_order_of_the_strands_does_not_matter() {
    let (strands, lists, colours) = field();
    let order: Vec<usize> = (0..strands.len())
        .map(|i| (i * 171 + 13) % strands.len())
        .collect();
    let strand = |&s: &usize| {
        strands
            .range(s)
            .map(|i| (strands.points[i], strands.radii[i]))
            .collect::<Vec<_>>()
    };
    let shuffled = Strands::from_polylines(order.iter().map(strand));
    let shuffled_colours: Vec<[f64; 3]> = order
        .iter()
        .flat_map(|&s| strands.range(s).map(|i| colours[i]))
        .collect();
    let shuffled_lists = fragment_lists(&shuffled, &camera(), None);
    let a = composite(&lists, 0.6, point_colours(&colours));
    let b = composite(&shuffled_lists, 0.6, point_colours(&shuffled_colours));
    assert!(greatest_difference(&a, &b) < ROUNDING);
}

#[test]
fn hair_of_one_colour_is_that_colour_times_alpha() {
    let (_, lists, _) = field();
    let colour = |_: &Fragment| [0.3, 0.6, 0.9];
    for image in [
        composite(&lists, 0.5, colour),
        composite_with_tail(&lists, 0.5, 3, colour),
        opaque(&lists, 0.5, colour),
    ] {
        for (i, pixel) in image.pixels.iter().enumerate() {
            assert!((pixel[3] - (1.0 - transmittance(lists.pixel(i), 0.5))).abs() < ROUNDING);
            for (channel, expected) in pixel.iter().zip([0.3, 0.6, 0.9]) {
                assert!((channel - expected * pixel[3]).abs() < ROUNDING);
            }
        }
    }
}

#[test]
fn a_tail_behind_all_fragments_is_the_exact_composite_and_longer_heads_are_nearer_to_it() {
    let (_, lists, colours) = field();
    let longest = (0..lists.pixels())
        .map(|i| lists.pixel(i).len())
        .max()
        .unwrap();
    let exact = composite(&lists, 0.7, point_colours(&colours));
    let with_tail = |head| {
        greatest_difference(
            &exact,
            &composite_with_tail(&lists, 0.7, head, point_colours(&colours)),
        )
    };
    assert_eq!(with_tail(longest), 0.0);
    assert!(
        with_tail(longest - 1) < ROUNDING,
        "a tail of one fragment is that fragment"
    );
    assert!(with_tail(1) > with_tail(8) && with_tail(8) > 0.0);
}

#[test]
fn fragments_beyond_the_needed_ones_change_a_pixel_by_less_than_the_tolerance() {
    let (lists, colours) = thick_field();
    let exact = composite(&lists, 0.9, point_colours(&colours));
    for tolerance in [0.3, 0.05, 0.004] {
        let needed = fragments_needed(&lists, 0.9, tolerance);
        let mut cut_off = lists.clone();
        cut_off.fragments.clear();
        cut_off.offsets = vec![0];
        for (i, &needed) in needed.iter().enumerate() {
            cut_off
                .fragments
                .extend_from_slice(&lists.pixel(i)[..needed]);
            cut_off.offsets.push(cut_off.fragments.len());
        }
        assert!(cut_off.fragments.len() < lists.fragments.len());
        let difference =
            greatest_difference(&exact, &composite(&cut_off, 0.9, point_colours(&colours)));
        assert!(difference < tolerance, "{difference} {tolerance}");
    }
}

#[test]
fn no_hair_is_no_light_and_full_transmittance() {
    let lists = fragment_lists(&Strands::default(), &camera(), None);
    let image = composite(&lists, 1.0, |_| [1.0; 3]);
    assert!(image.pixels.iter().all(|pixel| *pixel == [0.0; 4]));
    assert!(nearest_depth(&lists).iter().all(|&depth| depth == 1.0));
    assert!(
        fragments_needed(&lists, 1.0, 0.1)
            .iter()
            .all(|&needed| needed == 0)
    );
}
