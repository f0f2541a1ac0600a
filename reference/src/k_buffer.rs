//! What a renderer shows that keeps the K nearest fragments of each pixel (Yu et al., *A Framework for Rendering Complex
//! Scattering Effects on Hair*, 2012, §5; Vasilakis and Fudos, *k⁺-buffer*, 2014).
//!
//! The K nearest by (depth, segment) are laid under one another, front to back. The published forms leave out the rest; two
//! others put it behind them as one layer with its exact opacity, 1 - Π(1 - a).

use crate::composite::{Image, Layers, image_of, transmittance};
use crate::fragments::{Fragment, FragmentLists};

/// What becomes of the fragments behind the K nearest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rest {
    /// One layer of their exact opacity in their mean colour, Σ a·c / Σ a.
    Merged,
    /// One layer of their exact opacity in the colour of what lies before them, C / (1 - T).
    Alpha,
    /// Nothing, as published.
    Dropped,
}

/// The picture of the `k` nearest fragments of each pixel. `alpha`, from 0 to 1, is the fibres' own opacity.
pub fn k_buffer(
    lists: &FragmentLists,
    alpha: f64,
    k: usize,
    rest: Rest,
    colour: impl Fn(&Fragment) -> [f64; 3] + Sync,
) -> Image {
    image_of(lists, |fragments| {
        let (kept, behind) = fragments.split_at(k.min(fragments.len()));
        let mut layers = Layers::new();
        for fragment in kept {
            layers.under(alpha * fragment.coverage, colour(fragment));
        }
        let opacity = 1.0 - transmittance(behind, alpha);
        if opacity > 0.0 && rest == Rest::Merged {
            layers.under(opacity, mean(behind, &colour));
        } else if opacity > 0.0 && rest == Rest::Alpha {
            let [red, green, blue, covered] = layers.pixel();
            layers.under(opacity, [red, green, blue].map(|c| c / covered));
        }
        layers.pixel()
    })
}

/// Σ a·c / Σ a; the fibres' own opacity cancels.
fn mean(fragments: &[Fragment], colour: impl Fn(&Fragment) -> [f64; 3]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    let mut weight = 0.0;
    for fragment in fragments {
        weight += fragment.coverage;
        for (sum, channel) in sum.iter_mut().zip(colour(fragment)) {
            *sum += fragment.coverage * channel;
        }
    }
    sum.map(|channel| channel / weight)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::composite::composite;

    /// One pixel of fragments with these coverages, nearest first.
    fn lists(coverages: &[f64]) -> FragmentLists {
        let fragment = |(i, &coverage): (usize, &f64)| Fragment {
            depth: 0.1 * i as f64,
            t: 0.5,
            coverage,
            strand: i as u32,
            segment: 2 * i as u32,
        };
        FragmentLists {
            width: 1,
            height: 1,
            offsets: vec![0, coverages.len()],
            fragments: coverages.iter().enumerate().map(fragment).collect(),
        }
    }

    fn colour(fragment: &Fragment) -> [f64; 3] {
        [
            fragment.depth,
            1.0 - fragment.depth,
            fragment.coverage * 0.5,
        ]
    }

    const COVERAGES: [f64; 5] = [0.3, 1.0, 0.2, 0.7, 0.4];

    #[test]
    fn with_k_as_many_as_there_are_every_form_is_the_exact_composite() {
        let lists = lists(&COVERAGES);
        for rest in [Rest::Merged, Rest::Alpha, Rest::Dropped] {
            for k in [5, 64] {
                let kept = k_buffer(&lists, 0.6, k, rest, colour);
                assert_eq!(kept, composite(&lists, 0.6, colour));
            }
        }
    }

    #[test]
    fn only_dropping_changes_alpha() {
        let lists = lists(&COVERAGES);
        let exact = composite(&lists, 0.6, colour).pixels[0][3];
        for k in 1..5 {
            for rest in [Rest::Merged, Rest::Alpha] {
                let alpha = k_buffer(&lists, 0.6, k, rest, colour).pixels[0][3];
                assert!((alpha - exact).abs() < 1e-15, "{k} {rest:?}");
            }
            let dropped = k_buffer(&lists, 0.6, k, Rest::Dropped, colour).pixels[0][3];
            let expected = 1.0 - transmittance(&lists.fragments[..k], 0.6);
            assert!((dropped - expected).abs() < 1e-15);
            assert!(dropped < exact);
        }
    }

    #[test]
    fn fragments_of_one_colour_keep_it_whatever_becomes_of_the_rest() {
        let lists = lists(&COVERAGES);
        for rest in [Rest::Merged, Rest::Alpha, Rest::Dropped] {
            let [red, green, blue, alpha] =
                k_buffer(&lists, 0.5, 2, rest, |_| [0.2, 0.4, 0.8]).pixels[0];
            for (channel, expected) in [red, green, blue].into_iter().zip([0.2, 0.4, 0.8]) {
                assert!((channel - expected * alpha).abs() < 1e-15);
            }
        }
    }
}
