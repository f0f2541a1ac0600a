use pelage_reference::blending::{bin_of, bin_sorted, random_subsets, weighted_blended};
use pelage_reference::composite::{Image, composite, composite_with_tail, opaque, point_colours};
use pelage_reference::error::colour_error;
use pelage_reference::fragments::{Fragment, FragmentLists, fragment_lists};
use pelage_reference::glam::DVec3;
use pelage_reference::scene::{Camera, Strands, look_at};

use crate::wavy_strands;

/// Products and sums of a few hundred numbers below 1: measured 4e-16.
const ROUNDING: f64 = 1e-13;
/// The same where a colour is divided by its own opacity 1 - (1 - a): an a of 1e-7 keeps nine digits. Measured: 5.2e-10.
const ROUNDING_OF_FAINT: f64 = 1e-8;

fn field() -> (FragmentLists, Vec<[f64; 3]>) {
    let strands = wavy_strands(400, 12, 1.5, 0.01, 11);
    let view = look_at(DVec3::Z * 4.0, DVec3::ZERO, DVec3::Y);
    let camera = Camera::perspective(view, 0.7, [0.1, 10.0], [96, 72]);
    let colours = strands
        .points
        .iter()
        .map(|p| [0.5 + 0.3 * p.x.sin(), 0.5 + 0.3 * p.y.cos(), 0.7])
        .collect();
    (fragment_lists(&strands, &camera, None), colours)
}

fn greatest_difference(a: &Image, b: &Image) -> f64 {
    let both = a.pixels.iter().zip(&b.pixels);
    both.flat_map(|(a, b)| (0..4).map(|c| (a[c] - b[c]).abs()))
        .fold(0.0, f64::max)
}

#[test]
fn equal_weights_give_the_mean_colour_of_a_tail() {
    let (lists, colours) = field();
    let colour = point_colours(&colours);
    let mean = weighted_blended(&lists, 0.4, |_, _| 1.0, &colour);
    let tail = composite_with_tail(&lists, 0.4, 0, &colour);
    assert!(greatest_difference(&mean, &tail) < ROUNDING);
}

#[test]
fn two_weighted_layers_are_as_written() {
    let bar = |z: f64, half: f64| {
        [
            (DVec3::new(0.0, 0.5, z), half),
            (DVec3::new(1.0, 0.5, z), half),
        ]
    };
    let strands = Strands::from_polylines([bar(0.6, 0.25), bar(0.4, 0.1)]);
    let lists = fragment_lists(&strands, &Camera::of_pixels(1, 1), None);
    let [near, far] = [0.8 * 0.2, 0.8 * 0.5];
    let weight = |f: &Fragment, _: f64| if f.depth < 0.5 { 3.0 } else { 0.5 };
    let image = weighted_blended(&lists, 0.8, weight, |f| {
        if f.strand == 1 {
            [1.0, 0.0, 0.0]
        } else {
            [0.0, 1.0, 0.0]
        }
    });
    let opacity = 1.0 - (1.0 - near) * (1.0 - far);
    let total = 3.0 * near + 0.5 * far;
    let expected = [
        opacity * 3.0 * near / total,
        opacity * 0.5 * far / total,
        0.0,
        opacity,
    ];
    for (actual, expected) in image.pixels[0].into_iter().zip(expected) {
        assert!((actual - expected).abs() < ROUNDING, "{actual} {expected}");
    }
}

#[test]
fn one_subset_is_the_nearest_fragment_and_one_each_is_exact() {
    let (lists, colours) = field();
    let colour = point_colours(&colours);
    let one = random_subsets(&lists, 0.4, |_| 0, true, &colour);
    let off = greatest_difference(&one, &opaque(&lists, 0.4, &colour));
    assert!(off < ROUNDING_OF_FAINT, "{off}");
    // A strand that crosses a pixel twice leaves two fragments of one subset: few do.
    let all = random_subsets(&lists, 0.4, |strand| strand as usize, true, &colour);
    let exact = composite(&lists, 0.4, &colour);
    let error = colour_error(&all, &exact, None);
    assert!(error.rmse < 0.01, "{error:?}");
}

#[test]
fn kept_fragments_alone_are_never_more_opaque_than_all() {
    let (lists, colours) = field();
    let colour = point_colours(&colours);
    let subset = |strand: u32| (strand as usize * 7) % 4;
    let published = random_subsets(&lists, 0.4, subset, false, &colour);
    let exact = random_subsets(&lists, 0.4, subset, true, &colour);
    let less = published.pixels.iter().zip(&exact.pixels);
    assert!(less.clone().all(|(a, b)| a[3] <= b[3] + ROUNDING));
    assert!(less.clone().any(|(a, b)| a[3] < b[3] - 0.01));
}

#[test]
fn a_bin_for_each_depth_is_the_exact_order_and_one_bin_is_not() {
    let (lists, colours) = field();
    let colour = point_colours(&colours);
    let exact = composite(&lists, 0.4, &colour);
    // Each segment by its own nearest fragment: exact but where segments cross.
    let mut ranks: Vec<(f64, u32)> = Vec::new();
    for fragment in &lists.fragments {
        ranks.push((fragment.depth, fragment.segment));
    }
    ranks.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut rank = vec![usize::MAX; colours.len()];
    for (at, (_, segment)) in ranks.iter().enumerate() {
        let held = &mut rank[*segment as usize];
        *held = (*held).min(at);
    }
    let fine = bin_sorted(&lists, 0.4, |segment| rank[segment as usize], &colour);
    let coarse = bin_sorted(&lists, 0.4, |_| 0, &colour);
    let [fine, coarse] = [&fine, &coarse].map(|image| colour_error(image, &exact, None).rmse);
    assert!(fine < 0.2 * coarse, "{fine} {coarse}");
}

#[test]
fn bins_part_the_extent_evenly() {
    assert_eq!(bin_of([2.0, 3.0], [1.0, 5.0], 4), 2);
    assert_eq!(bin_of([3.0, 2.0], [1.0, 5.0], 4), 2);
    assert_eq!(bin_of([1.0, 1.0], [1.0, 5.0], 4), 0);
    assert_eq!(bin_of([5.0, 1.0], [1.0, 5.0], 4), 3);
}
