//! What fragment lists look like to renderers that do not sort fragments: weighted sums, subsets, and segments in bins.
//!
//! McGuire and Bavoil, *Weighted Blended Order-Independent Transparency*, 2013; Hunz, *Interactive Physically-Based Hair
//! Rendering*, 2016, §5.4; Kim, *Algorithms for Hardware Accelerated Hair Rendering*, 2003, §3.

use crate::composite::{Image, Layers, image_of, transmittance};
use crate::fragments::{Fragment, FragmentLists};

/// Colour Σ w·a·c / Σ w·a at the exact opacity 1 - Π(1 - a): McGuire and Bavoil's equation 3 over nothing. `weight` takes a
/// fragment and its opacity a; w > 0.
pub fn weighted_blended(
    lists: &FragmentLists,
    alpha: f64,
    weight: impl Fn(&Fragment, f64) -> f64 + Sync,
    colour: impl Fn(&Fragment) -> [f64; 3] + Sync,
) -> Image {
    image_of(lists, |fragments| {
        let mut sum = [0.0; 3];
        let mut total = 0.0;
        for fragment in fragments {
            let opacity = alpha * fragment.coverage;
            let weight = opacity * weight(fragment, opacity);
            total += weight;
            for (sum, channel) in sum.iter_mut().zip(colour(fragment)) {
                *sum += weight * channel;
            }
        }
        let mut layers = Layers::new();
        if total > 0.0 {
            layers.under(
                1.0 - transmittance(fragments, alpha),
                sum.map(|sum| sum / total),
            );
        }
        layers.pixel()
    })
}

/// The nearest fragment of each subset, in order. `subset` takes a strand. Where fragments of one subset lie at one depth the
/// first segment gives the colour, and the most opaque the opacity. With `exact_alpha` the result is scaled to the opacity of
/// the whole list; without, as published, it has that of the fragments that are kept.
pub fn random_subsets(
    lists: &FragmentLists,
    alpha: f64,
    subset: impl Fn(u32) -> usize + Sync,
    exact_alpha: bool,
    colour: impl Fn(&Fragment) -> [f64; 3] + Sync,
) -> Image {
    image_of(lists, |fragments| {
        let mut kept: Vec<(usize, &Fragment, f64)> = Vec::new();
        for fragment in fragments {
            let subset = subset(fragment.strand);
            match kept.iter_mut().find(|(held, ..)| *held == subset) {
                Some((_, first, coverage)) if first.depth == fragment.depth => {
                    *coverage = coverage.max(fragment.coverage);
                }
                Some(_) => {}
                None => kept.push((subset, fragment, fragment.coverage)),
            }
        }
        let mut layers = Layers::new();
        for (_, fragment, coverage) in kept {
            layers.under(alpha * coverage, colour(fragment));
        }
        let pixel = layers.pixel();
        let whole = 1.0 - transmittance(fragments, alpha);
        if !exact_alpha || pixel[3] == 0.0 {
            return pixel;
        }
        pixel.map(|value| value * whole / pixel[3])
    })
}

/// Fragments in the order of their segments' bins, nearest bin first; `bin` takes the index of a segment's first point.
/// Fragments of one bin keep the order of their segments.
pub fn bin_sorted(
    lists: &FragmentLists,
    alpha: f64,
    bin: impl Fn(u32) -> usize + Sync,
    colour: impl Fn(&Fragment) -> [f64; 3] + Sync,
) -> Image {
    image_of(lists, |fragments| {
        let mut fragments: Vec<&Fragment> = fragments.iter().collect();
        fragments.sort_by_key(|fragment| (bin(fragment.segment), fragment.segment));
        let mut layers = Layers::new();
        for fragment in fragments {
            layers.under(alpha * fragment.coverage, colour(fragment));
        }
        layers.pixel()
    })
}

/// The bin of a segment by the distances of its ends from the plane of the eye (Kim's equation, with the bins' number for ε):
/// `bins` of equal width between the extremes of the whole groom, counted from the near end.
pub fn bin_of(ends: [f64; 2], extremes: [f64; 2], bins: usize) -> usize {
    let far = ends[0].max(ends[1]);
    let place = (far - extremes[0]) / (extremes[1] - extremes[0]);
    ((place * bins as f64) as usize).min(bins - 1)
}
