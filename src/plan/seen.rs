//! How the hair lies in a view: its size on the screen, and its depths.

use std::ops::RangeInclusive;

use glam::{DMat4, DVec3};

use super::{PIXELS_AN_INVOCATION, Placed};
use crate::frame::Frame;
use crate::layout::{WORD_ALONG_BITS, WORD_VALUE_BITS_MOST};

/// How large the hair is on the screen.
pub(super) struct Seen {
    /// Pixels of the image.
    pub image_px: f64,
    pub half_width_px: f64,
    pub length_px: f64,
    pub fragments: f64,
    /// Optical depth of all fragments together.
    pub depth: f64,
    /// Of each hair, its fragments and their optical depth.
    pub each: Vec<[f64; 2]>,
    /// Left, top, right and bottom of the hair in pixels, within the image.
    pub bounds: [f64; 4],
}

impl Seen {
    /// Pixels that hair covers: a little less than half of its bounds, 22 % to 60 % over the built-in grooms and five others.
    fn covered_px(&self) -> f64 {
        const COVERED: f64 = 0.45;
        let [left, top, right, bottom] = self.bounds;
        COVERED * (right - left).max(1.0) * (bottom - top).max(1.0)
    }

    /// Fragments that a pool should hold where what lies behind an optical depth is cut off: of each hair by itself, as if it covered
    /// all of the bounds.
    pub fn kept(&self, cut_depth: f64) -> f64 {
        let [left, top, right, bottom] = self.bounds;
        let area = (right - left).max(1.0) * (bottom - top).max(1.0);
        let kept = |[fragments, depth]: &[f64; 2]| fragments * (cut_depth * area / depth).min(1.0);
        self.each.iter().map(kept).sum()
    }

    /// Whether the DBK-buffer's cut-offs save more time in the resolve, which reads a pixel's list once for every sixteen fragments
    /// that it composites, than finding them takes. By what these cost on a driver that runs on two cores: on none of the report's scenes it
    /// pays; it does where a pixel has a thousand fragments, each of which hides little.
    pub fn culling_pays(&self, cut_depth: f64, segments: u64) -> bool {
        /// Nanoseconds for a key that the resolve reads; for a segment and for a fragment to be culled or not.
        const KEY: f64 = 1.6;
        const SEGMENT: f64 = 130.0;
        const FRAGMENT: f64 = 10.0;
        let pixels = self.covered_px();
        let (count, depth) = (self.fragments / pixels, self.depth / pixels);
        // What is composited is before the cut-off, whether that is looked for or not.
        let stored = count * (cut_depth / depth).min(1.0);
        let keys = (count - stored) * stored / 16.0 * pixels;
        keys * KEY > segments as f64 * SEGMENT + self.fragments * FRAGMENT
    }

    /// Invocations that share one segment, so that none walks too many pixels: loops end after 65,535 steps on some devices.
    pub fn splits(&self) -> u32 {
        const MOST_STEPS: f64 = 60_000.0;
        let pixels = self.length_px * (2.0 * self.half_width_px + 3.0);
        let most = (self.image_px / MOST_STEPS).ceil().max(64.0);
        (pixels / PIXELS_AN_INVOCATION).ceil().clamp(1.0, most) as u32
    }
}

/// Bounds of fibre width and segment length on the screen, and an estimate of the fragments.
pub(super) fn view_size(
    clip_from_relative: &DMat4,
    placed: &[Placed],
    frame: &Frame,
    width: u32,
    height: u32,
) -> Seen {
    let screen = f64::from(width.max(height));
    let mut seen = Seen {
        image_px: f64::from(width) * f64::from(height),
        half_width_px: 0.0,
        length_px: 0.0,
        fragments: 0.0,
        depth: 0.0,
        each: Vec::new(),
        bounds: [f64::INFINITY, f64::INFINITY, 0.0, 0.0],
    };
    let size = [f64::from(width), f64::from(height)];
    for placed in placed {
        let hair = frame.hairs[placed.hair];
        if hair.geometry.segment_count == 0 {
            continue;
        }
        // Pixels a unit of length: the rows' lengths are the focal lengths, w the distance.
        let focal = (0..2)
            .map(|axis| {
                clip_from_relative.row(axis).truncate().length()
                    * 0.5
                    * f64::from([width, height][axis])
            })
            .fold(0.0f64, f64::max);
        let distance = |p: &DVec3| clip_from_relative.row(3).dot(p.extend(1.0));
        let nearest = placed
            .corners
            .iter()
            .map(distance)
            .fold(f64::INFINITY, f64::min);
        let middle = placed.corners.iter().map(distance).sum::<f64>() / 8.0;
        let diagonal = placed.corners[0].distance(placed.corners[7]);
        let parallel = clip_from_relative.row(3).truncate().length() < 1e-12;
        let px = |distance: f64| {
            if parallel {
                focal / distance
            } else {
                focal / distance.max(diagonal * 1e-3).max(f64::MIN_POSITIVE)
            }
        };
        let longest = (diagonal * px(nearest)).min(2.0 * screen);
        seen.half_width_px = seen
            .half_width_px
            .max((placed.radius * px(nearest)).min(screen));
        seen.length_px = seen.length_px.max(longest);
        // A fibre of width w touches w + 4/π pixels a pixel of length on average; what leaves the screen is not counted.
        let middle_px = px(middle.max(nearest));
        let inside = (screen * screen / (diagonal * middle_px).powi(2)).min(1.0);
        let length = hair.geometry.length * placed.scale * middle_px;
        let touched = 2.0 * placed.radius * middle_px + 1.28;
        let fragments = length * touched * inside.max(0.05);
        let opacity = f64::from(hair.opacity) * (1.0 - 1.28 / touched);
        let depth = fragments * -(1.0 - opacity).max(1e-7).ln();
        seen.fragments += fragments;
        seen.depth += depth;
        seen.each.push([fragments, depth]);
        for corner in placed.corners {
            let clip = *clip_from_relative * corner.extend(1.0);
            // What reaches behind the eye may be anywhere.
            let at = |axis: usize, sign: f64| {
                let middle = 0.5 + 0.5 * sign * clip[axis] / clip.w;
                middle.clamp(0.0, 1.0) * size[axis]
            };
            let places = if clip.w > 0.0 {
                [[at(0, 1.0), at(1, -1.0)]; 2]
            } else {
                [[0.0; 2], size]
            };
            for place in places {
                for (axis, at) in place.into_iter().enumerate() {
                    seen.bounds[axis] = seen.bounds[axis].min(at);
                    seen.bounds[axis + 2] = seen.bounds[axis + 2].max(at);
                }
            }
        }
    }
    seen
}

/// The coefficients that take a stored depth to its place between the hair's nearest and farthest distance along the view's
/// axis, 0 to 1: (x depth + y) / (z depth + w).
pub(super) fn place_of_depth(
    clip_from_relative: &DMat4,
    placed: &[Placed],
    reverse_z: bool,
) -> [f32; 4] {
    let [depth_row, w_row] = [clip_from_relative.row(2), clip_from_relative.row(3)];
    let corners = || {
        let points = placed.iter().flat_map(|placed| placed.corners);
        points.map(|p| (depth_row.dot(p.extend(1.0)), w_row.dot(p.extend(1.0))))
    };
    let range = |values: &mut dyn Iterator<Item = f64>| {
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
            [low.min(value), high.max(value)]
        })
    };
    let axis = w_row.truncate();
    // Depth × w = a w + b, as of every projection whose near plane is perpendicular to the axis.
    let a = depth_row.truncate().dot(axis) / axis.length_squared();
    let b = depth_row.w - a * w_row.w;
    let perspective = axis.length() > 1e-12 && b != 0.0;
    let [p, q, r, s] = if perspective {
        let [mut near, far] = range(&mut corners().map(|(_, w)| w));
        // What lies before the near plane, whose depth is 0 or 1, is not seen.
        let planes = [b / -a, b / (1.0 - a)].into_iter();
        near = near.max(planes.filter(|w| *w > 0.0).fold(f64::INFINITY, f64::min));
        [-near, b + near * a, far - near, (near - far) * a]
    } else {
        let [low, high] = range(&mut corners().map(|(depth, _)| depth));
        let [near, far] = if reverse_z { [high, low] } else { [low, high] };
        [1.0, -near, 0.0, far - near]
    };
    let found = [p, q, r, s].map(|value| value as f32);
    let extended = found.iter().all(|value| value.is_finite()) && (r != 0.0 || s != 0.0);
    if extended {
        found
    } else {
        [0.0, 0.0, 0.0, 1.0]
    }
}

/// Bounds of the depth keys (see `depth_key` in WGSL) of all hair in a view.
pub(super) fn key_range(
    clip_from_relative: &DMat4,
    boxes: impl Iterator<Item = [DVec3; 8]>,
    reverse_z: bool,
) -> [u32; 2] {
    /// Keys by which single precision may miss a corner.
    const MARGIN: u32 = 64;
    let farthest = 1.0f32.to_bits();
    let key = |(z, w): (f64, f64)| {
        let depth = (z / w).clamp(0.0, 1.0) as f32;
        match reverse_z {
            true => farthest - depth.to_bits(),
            false => depth.to_bits(),
        }
    };
    let mut range: Option<[u32; 2]> = None;
    let mut widen = |key: u32| {
        let [first, last] = range.unwrap_or([key, key]);
        range = Some([first.min(key), last.max(key)]);
    };
    for corners in boxes {
        let clip = corners.map(|p| {
            let row = |row| clip_from_relative.row(row).dot(p.extend(1.0));
            (row(2), row(3))
        });
        let seen = || clip.iter().filter(|(_, w)| *w > 0.0);
        let behind = || clip.iter().filter(|(_, w)| *w <= 0.0);
        seen().for_each(|corner| widen(key(*corner)));
        // Towards a corner behind the eye the box comes as near as may be; and where the projection is odd it may go as far.
        for (corner, beyond) in seen().flat_map(|a| behind().map(move |b| (a, b))) {
            widen(0);
            let part = corner.1 / (corner.1 - beyond.1);
            let z = corner.0 + part * (beyond.0 - corner.0);
            if (z > 0.0) != reverse_z {
                widen(farthest);
            }
        }
    }
    let [first, last] = range.unwrap_or([0, farthest]);
    [
        first.saturating_sub(MARGIN),
        last.saturating_add(MARGIN).min(farthest),
    ]
}

/// How a fragment's word of 64 bits is parted among its depth key, its point and its value.
pub(super) struct Word {
    /// The frame's `key_first`.
    pub key_first: u32,
    /// The frame's `word_bits`.
    pub bits: u32,
}

impl Word {
    /// `finest_near`: whether keys are finest at the near plane, as of perspective whose depths are not reversed.
    pub fn new([first, last]: [u32; 2], finest_near: bool, point_count: u64) -> Self {
        /// Opacity, of 11 to 16 bits, and place along the segment.
        const VALUE_BITS: RangeInclusive<u32> = WORD_ALONG_BITS + 11..=WORD_VALUE_BITS_MOST;
        /// What the halves of a word leave a point at least, so that a key is all in the upper one.
        const LEAST_POINT_BITS: u32 = 13;
        /// Of a bin's place, `DBK_FIRST_MAX` in WGSL.
        const BIN_BITS: u32 = 17;
        /// Where not all keys fit and hair reaches through the near plane, these depths are one: a thousandth of that plane's
        /// distance behind it.
        const AT_NEAR_PLANE: f32 = 1.0 / 1024.0;
        let bits = |value: u64| u64::BITS - value.leading_zeros();
        // The greatest key is left out: no half is ever all ones.
        let all = |first: u32| bits(u64::from(last - first) + 2);
        let point_bits = bits(point_count).max(LEAST_POINT_BITS);
        let most = 64 - point_bits - VALUE_BITS.start();
        let at_near_plane = AT_NEAR_PLANE.to_bits();
        let clamps = finest_near && first == 0 && at_near_plane < last && all(first) > most;
        let key_first = if clamps { at_near_plane } else { first };
        let all_bits = all(key_first);
        let left = (64 - point_bits).saturating_sub(all_bits);
        let value_bits = left.clamp(*VALUE_BITS.start(), *VALUE_BITS.end());
        let key_bits = all_bits.min(64 - value_bits - point_bits);
        let key_shift = all_bits - key_bits;
        // The point has what is left.
        let upper_point_bits = 32 - key_bits;
        let bin_shift = all_bits.saturating_sub(BIN_BITS);
        Self {
            key_first,
            bits: key_shift | upper_point_bits << 8 | value_bits << 16 | bin_shift << 24,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec4;

    use super::*;
    use crate::geometry::MAX_FRAME_POINTS;

    #[test]
    fn culling_pays_where_pixels_have_very_many_faint_fragments() {
        // So many fragments a pixel, of such an optical depth each.
        let pays = |count: f64, depth: f64, segments: u64| {
            let mut seen = Seen {
                image_px: 656.0 * 861.0,
                half_width_px: 0.1,
                length_px: 10.0,
                fragments: 0.0,
                depth: 0.0,
                each: Vec::new(),
                bounds: [0.0, 0.0, 656.0, 861.0],
            };
            seen.fragments = count * seen.covered_px();
            seen.depth = depth * seen.fragments;
            // What leaves 1/256 of the light.
            seen.culling_pays(256f64.ln(), segments)
        };
        assert!(pays(2_000.0, 0.02, 8_000_000));
        assert!(!pays(104.0, 0.2, 800_000));
        assert!(!pays(104.0, 0.02, 800_000));
    }

    /// Key shift, bits of the point in the upper half, bits of the value.
    fn parts(range: [u32; 2], finest_near: bool, point_count: u64) -> ([u32; 3], u32) {
        let word = Word::new(range, finest_near, point_count);
        let part = |at: u32| word.bits >> at & 255;
        ([part(0), part(8), part(16)], word.key_first)
    }

    #[test]
    fn a_word_has_room_for_every_point_and_most_keys() {
        let one = 1.0f32.to_bits();
        let near_one = [0.98f32.to_bits(), 0.99f32.to_bits()];
        // A head's worth at some distance: opacity has all its sixteen bits.
        assert_eq!(parts(near_one, false, 850_000), ([0, 14, 24], near_one[0]));
        // The most points of a frame, all depths: the value has its least bits, and keys give way.
        assert_eq!(parts([0, one], false, MAX_FRAME_POINTS), ([10, 12, 19], 0));
        let ([shift, ..], first) = parts([0, one], true, 2_000_000);
        assert_eq!((shift, first), (3, (1.0f32 / 1024.0).to_bits()));
        // All of the hair at the near plane: its depths are not made one.
        let at_plane = [0, 0.0005f32.to_bits()];
        assert_eq!(parts(at_plane, true, 2_000_000).1, 0);
        for point_count in [1, 2, 100, 8191, 8192, 1 << 20, MAX_FRAME_POINTS, 1 << 30] {
            for range in [[5, 5], [0, 64], [0, one], near_one, [one - 64, one]] {
                for finest_near in [false, true] {
                    let ([shift, upper, value], first) = parts(range, finest_near, point_count);
                    assert!((19..=24).contains(&value) && upper < 32);
                    // Every point, and every key; of shifted ones the last two may be one.
                    assert!(point_count < 1 << (upper + 32 - value));
                    assert!(u64::from((range[1] - first) >> shift) < 1u64 << (32 - upper));
                    assert!(shift > 0 || u64::from(range[1] - first) < (1u64 << (32 - upper)) - 1);
                }
            }
        }
    }

    #[test]
    fn keys_span_what_is_before_the_eye() {
        let hair = |centre: f64, half: f64| {
            let corner = |i: usize, bit: usize| if i >> bit & 1 == 1 { half } else { -half };
            std::array::from_fn(|i| DVec3::new(corner(i, 0), corner(i, 1), corner(i, 2) - centre))
        };
        let [near, far] = [0.1, 100.0];
        let one = 1.0f32.to_bits();
        for reverse_z in [false, true] {
            let planes = if reverse_z { [far, near] } else { [near, far] };
            let slope = planes[1] / (planes[0] - planes[1]);
            let clip_from_relative = DMat4::from_cols(
                DVec4::X,
                DVec4::Y,
                DVec4::new(0.0, 0.0, slope, -1.0),
                DVec4::new(0.0, 0.0, planes[0] * slope, 0.0),
            );
            let key = |z: f64| {
                let clip = clip_from_relative * DVec3::new(0.0, 0.0, -z).extend(1.0);
                let depth = (clip.z / clip.w).clamp(0.0, 1.0) as f32;
                if reverse_z {
                    one - depth.to_bits()
                } else {
                    depth.to_bits()
                }
            };
            for (name, centre, half, [nearest, farthest]) in [
                ("before the eye", 5.0, 1.0, [4.0, 6.0]),
                ("around the eye", 1.0, 4.0, [near, 5.0]),
                ("through the near plane", 1.0, 0.95, [near, 1.95]),
                ("through the far plane", 90.0, 30.0, [60.0, far]),
                ("behind the eye", -9.0, 2.0, [near, far]),
            ] {
                let [first, last] = key_range(
                    &clip_from_relative,
                    std::iter::once(hair(centre, half)),
                    reverse_z,
                );
                let [low, high] = [key(nearest), key(farthest)];
                assert!(
                    first <= low && low - first <= 200,
                    "{name}: {first} for {low}"
                );
                assert!(
                    last >= high && last - high <= 200,
                    "{name}: {last} for {high}"
                );
            }
        }
    }
}
