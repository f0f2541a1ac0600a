//! What fragment lists look like: exact composites, premultiplied, over nothing.
//!
//! A fragment's opacity is `a = alpha · coverage`. Front to back, from C = 0 and T = 1: `C += T·a·c`, `T *= 1 - a`; the
//! pixel is (C, 1 - T) (Porter and Duff, *Compositing Digital Images*, 1984).

use crate::fragments::{Fragment, FragmentLists};
use rayon::prelude::*;

/// An image in linear radiance.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green, blue, premultiplied with alpha, and alpha; row by row from the top.
    pub pixels: Vec<[f64; 4]>,
}

impl Image {
    /// The image over an opaque background of one linear colour.
    pub fn over(&self, background: [f64; 3]) -> Self {
        let pixel = |p: &[f64; 4]| {
            let rest = 1.0 - p[3];
            [
                p[0] + background[0] * rest,
                p[1] + background[1] * rest,
                p[2] + background[2] * rest,
                1.0,
            ]
        };
        Self {
            pixels: self.pixels.iter().map(pixel).collect(),
            ..*self
        }
    }
}

/// Colours that are given per point of the strands, interpolated linearly along the segment.
pub fn point_colours(colours: &[[f64; 3]]) -> impl Fn(&Fragment) -> [f64; 3] + Sync + '_ {
    move |fragment| {
        let [start, end] = [
            colours[fragment.segment as usize],
            colours[fragment.segment as usize + 1],
        ];
        std::array::from_fn(|channel| {
            start[channel] * (1.0 - fragment.t) + end[channel] * fragment.t
        })
    }
}

/// Radiance and transmittance while fragments are laid under one another.
pub(crate) struct Layers {
    radiance: [f64; 3],
    transmittance: f64,
}

impl Layers {
    pub(crate) fn new() -> Self {
        Self {
            radiance: [0.0; 3],
            transmittance: 1.0,
        }
    }

    pub(crate) fn under(&mut self, opacity: f64, colour: [f64; 3]) {
        for (sum, channel) in self.radiance.iter_mut().zip(colour) {
            *sum += self.transmittance * opacity * channel;
        }
        self.transmittance *= 1.0 - opacity;
    }

    pub(crate) fn pixel(&self) -> [f64; 4] {
        let [red, green, blue] = self.radiance;
        [red, green, blue, 1.0 - self.transmittance]
    }
}

pub(crate) fn image_of(
    lists: &FragmentLists,
    pixel: impl Fn(&[Fragment]) -> [f64; 4] + Sync,
) -> Image {
    let pixels = (0..lists.pixels())
        .into_par_iter()
        .map(|i| pixel(lists.pixel(i)))
        .collect();
    Image {
        width: lists.width,
        height: lists.height,
        pixels,
    }
}

/// The part of the light from behind that passes a list of fragments: Π (1 - alpha · coverage).
pub fn transmittance(fragments: &[Fragment], alpha: f64) -> f64 {
    fragments
        .iter()
        .map(|fragment| 1.0 - alpha * fragment.coverage)
        .product()
}

/// The exact composite, front to back. `alpha`, from 0 to 1, is the fibres' own opacity; colours are linear.
pub fn composite(
    lists: &FragmentLists,
    alpha: f64,
    colour: impl Fn(&Fragment) -> [f64; 3] + Sync,
) -> Image {
    image_of(lists, |fragments| {
        let mut layers = Layers::new();
        for fragment in fragments {
            layers.under(alpha * fragment.coverage, colour(fragment));
        }
        layers.pixel()
    })
}

/// The composite in which each pixel's nearest `exact` fragments keep their order, and the others are one layer behind
/// them, with their exact opacity, 1 - Π(1 - a), and their mean colour, Σ a·c / Σ a.
pub fn composite_with_tail(
    lists: &FragmentLists,
    alpha: f64,
    exact: usize,
    colour: impl Fn(&Fragment) -> [f64; 3] + Sync,
) -> Image {
    image_of(lists, |fragments| {
        let (head, tail) = fragments.split_at(exact.min(fragments.len()));
        let mut layers = Layers::new();
        for fragment in head {
            layers.under(alpha * fragment.coverage, colour(fragment));
        }

        let mut weighted = [0.0; 3];
        let mut weight = 0.0;
        for fragment in tail {
            let opacity = alpha * fragment.coverage;
            weight += opacity;
            for (sum, channel) in weighted.iter_mut().zip(colour(fragment)) {
                *sum += opacity * channel;
            }
        }
        if weight > 0.0 {
            layers.under(
                1.0 - transmittance(tail, alpha),
                weighted.map(|sum| sum / weight),
            );
        }
        layers.pixel()
    })
}

/// What a renderer shows that keeps the nearest fragment only: its colour, with the opacity of the whole list.
pub fn opaque(
    lists: &FragmentLists,
    alpha: f64,
    colour: impl Fn(&Fragment) -> [f64; 3] + Sync,
) -> Image {
    image_of(lists, |fragments| {
        let mut layers = Layers::new();
        if let Some(nearest) = fragments.first() {
            layers.under(1.0 - transmittance(fragments, alpha), colour(nearest));
        }
        layers.pixel()
    })
}

/// The depth of each pixel's nearest fragment, row by row; 1 where there is none.
pub fn nearest_depth(lists: &FragmentLists) -> Vec<f64> {
    (0..lists.pixels())
        .map(|i| {
            lists
                .pixel(i)
                .first()
                .map_or(1.0, |fragment| fragment.depth)
        })
        .collect()
}

/// For each pixel, the fewest of its nearest fragments that must be kept for what lies behind them to receive less than
/// `tolerance` of the light: up to and including the one that takes the transmittance below it, or all.
pub fn fragments_needed(lists: &FragmentLists, alpha: f64, tolerance: f64) -> Vec<usize> {
    let needed = |fragments: &[Fragment]| {
        let mut transmittance = 1.0;
        let enough = fragments.iter().position(|fragment| {
            transmittance *= 1.0 - alpha * fragment.coverage;
            transmittance < tolerance
        });
        enough.map_or(fragments.len(), |last| last + 1)
    };
    (0..lists.pixels())
        .into_par_iter()
        .map(|i| needed(lists.pixel(i)))
        .collect()
}
