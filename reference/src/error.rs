//! How far one image is from another: linear differences, channel by channel, over the pixels that matter.
//!
//! With d the absolute differences of all channels of all those pixels: `√(Σ d² / n)`, the smallest d that at least
//! 99 % of them do not exceed (nearest rank), and the greatest.

use crate::composite::Image;

/// Differences between two images.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ImageError {
    /// Root of the mean square difference.
    pub rmse: f64,
    /// The 99th percentile of the absolute differences.
    pub p99: f64,
    /// The greatest absolute difference.
    pub max: f64,
    /// The number of pixels compared; with 0, all of the above are 0.
    pub pixels: usize,
    /// The greatest absolute difference in the pixels that were *not* compared, alpha included: shows what is drawn
    /// where nothing should be.
    pub max_elsewhere: f64,
}

/// The absolute difference; of what is not a number, infinite, so that it cannot pass for small.
fn difference(a: f64, b: f64) -> f64 {
    let difference = (a - b).abs();
    if difference.is_nan() {
        f64::INFINITY
    } else {
        difference
    }
}

fn error_of_channels(
    actual: &Image,
    reference: &Image,
    mask: Option<&[bool]>,
    channels: &[usize],
) -> ImageError {
    assert_eq!(
        [actual.width, actual.height],
        [reference.width, reference.height],
        "images differ in size"
    );
    if let Some(mask) = mask {
        assert_eq!(
            mask.len(),
            reference.pixels.len(),
            "the mask has another size than the images"
        );
    }
    let compared = |i: usize| mask.map_or(reference.pixels[i][3] > 0.0, |mask| mask[i]);
    let difference_at =
        |i: usize, c: usize| difference(actual.pixels[i][c], reference.pixels[i][c]);

    let mut differences = Vec::new();
    let mut max_elsewhere = 0.0_f64;
    for i in 0..reference.pixels.len() {
        if compared(i) {
            differences.extend(channels.iter().map(|&c| difference_at(i, c)));
        } else {
            max_elsewhere = (0..4)
                .map(|c| difference_at(i, c))
                .fold(max_elsewhere, f64::max);
        }
    }
    if differences.is_empty() {
        return ImageError {
            max_elsewhere,
            ..ImageError::default()
        };
    }

    differences.sort_unstable_by(f64::total_cmp);
    let count = differences.len();
    let rank = (count * 99).div_ceil(100);
    ImageError {
        rmse: (differences.iter().map(|d| d * d).sum::<f64>() / count as f64).sqrt(),
        p99: differences[rank - 1],
        max: differences[count - 1],
        pixels: count / channels.len(),
        max_elsewhere,
    }
}

/// The error of red, green and blue over the pixels of `mask`, or else those where the reference's alpha is above 0.
///
/// # Panics
/// If sizes differ.
pub fn colour_error(actual: &Image, reference: &Image, mask: Option<&[bool]>) -> ImageError {
    error_of_channels(actual, reference, mask, &[0, 1, 2])
}

/// The error of alpha over the same pixels as [`colour_error`].
///
/// # Panics
/// If sizes differ.
pub fn alpha_error(actual: &Image, reference: &Image, mask: Option<&[bool]>) -> ImageError {
    error_of_channels(actual, reference, mask, &[3])
}
