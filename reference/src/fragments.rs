//! The exact list of fragments of every pixel: one fragment per strand per crossing.
//!
//! A strand's segments are often shorter than a pixel, and composited over one another they would lose a part of a
//! lone hair's light. So they share out the pixels: with `b_j` the normalised sum of the directions on the screen of
//! the strand before and after `p_j`, segment i owns the pixels whose centres c have `(c - p_i)·b_i >= 0` and
//! `(c - p_{i+1})·b_{i+1} < 0`. There its coverage is the area of the pixel inside the unbounded band around its axis,
//! whose half-width is the one at the point of the axis next to c.
//!
//! At the ends of a strand no plane limits what is owned. A fibre is a tube without caps, so that it is worth its length on
//! the screen times its width: the band is cut across, as far along it as the strand goes on, bends straightened out. So cuts are
//! parallel, and a strand that is far shorter than wide, or points at the eye, shows next to nothing, whichever
//! way its last points happen to lie; cuts at right angles to its first and to its last segment would leave a wedge of all its
//! width between them. Where a centre lies beyond a joint, on the outer side of the bend, the strand there is the joint swept
//! round: of what lies beyond, half the half-width does not count as length, and of the rest no more than 1 - ½√2; but no pixel
//! is covered over more than twice the strand's length.
//!
//! An end is also where the near plane cuts, and where a strand turns by more than 120°: what follows is a new crossing.
//!
//! A direction is that towards the nearest point of the strand that is farther than [`SHORTEST_DIRECTION`]; a segment shorter than this
//! takes that of `b_i`. So a segment that points at the eye, whose direction on the screen is an accident, turns no joint.

use crate::coverage::{Band, HalfPlane, band_coverage};
use crate::project::{ScreenPoint, ScreenSegment, project_strand};
use crate::scene::{Camera, Strands};
use glam::DVec2;
use rayon::prelude::*;
use std::f64::consts::FRAC_1_SQRT_2;

/// Points no farther than this from each other on the screen, in pixels, tell no direction. What single precision
/// gets wrong of a place in an image of 1000 pixels, 1e-4, turns what is longer by less than 0.03.
pub const SHORTEST_DIRECTION: f64 = 1.0 / 256.0;

/// Where a strand goes on for so many pixels, its end is out of a pixel's reach.
const REACH: f64 = 1.0;

/// Up to how far beyond its joint a segment is beside it, in half-widths: of 0, ¼, ½, 1 and √3 the one whose areas are closest to
/// the supersampled ones of bent strands 1 to 10 px wide; those of thinner ones differ little.
const BESIDE_JOINT: f64 = 0.5;

/// How much may count, in pixels, of what lies beyond that: 1 - ½√2, so that no end that is [`REACH`] behind the joint cuts a pixel.
const MOST_BEYOND: f64 = 1.0 - FRAC_1_SQRT_2;

/// How much of a pixel's way along the band a strand covers at most, in its own lengths.
const MOST_OF_LENGTH: f64 = 2.0;

/// The cosine of the greatest turn, 120°, across which pixels are shared out.
const SHARPEST_JOINT: f64 = -0.5;

/// A joint's plane leans by no more than half the greatest turn: tan 60°.
const STEEPEST_PLANE: f64 = 1.732_050_807_568_877_2;

/// Slack, in pixels, of the search for candidates; the rule itself has none.
const SLACK: f64 = 1e-6;

/// Strands that one thread walks at a time.
const STRANDS_PER_TASK: usize = 64;

/// What one strand leaves in one pixel where it crosses it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fragment {
    /// Normalised device depth, from 0 (near) to 1, of the segment's point next to the pixel's centre.
    pub depth: f64,
    /// Where that point lies on the segment, from 0 to 1. Of a segment that the near plane cuts, the place on the whole
    /// segment.
    pub t: f64,
    /// The part of the pixel's area that is covered: above 0, up to 1.
    pub coverage: f64,
    /// Index of the strand.
    pub strand: u32,
    /// Index, in the points of all strands, of the segment's first point.
    pub segment: u32,
}

/// The fragments of an image, pixel by pixel, row by row, each pixel's sorted by (depth, segment).
#[derive(Debug, Clone, PartialEq)]
pub struct FragmentLists {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Pixel i's fragments are `fragments[offsets[i]..offsets[i + 1]]`; one more entry than pixels.
    pub offsets: Vec<usize>,
    /// All fragments.
    pub fragments: Vec<Fragment>,
}

impl FragmentLists {
    /// The fragments of pixel `y * width + x`, nearest first.
    pub fn pixel(&self, index: usize) -> &[Fragment] {
        &self.fragments[self.offsets[index]..self.offsets[index + 1]]
    }

    /// The fragments of pixel (x, y), nearest first.
    pub fn at(&self, x: usize, y: usize) -> &[Fragment] {
        self.pixel(y * self.width + x)
    }

    /// The number of pixels.
    pub fn pixels(&self) -> usize {
        self.width * self.height
    }

    /// Shares out fragments that bear the index of their pixel.
    fn sorted(width: usize, height: usize, found: Vec<Vec<(u32, Fragment)>>) -> Self {
        let mut offsets = vec![0; width * height + 1];
        for (pixel, _) in found.iter().flatten() {
            offsets[*pixel as usize + 1] += 1;
        }
        for i in 1..offsets.len() {
            offsets[i] += offsets[i - 1];
        }
        let nothing = Fragment {
            depth: 0.0,
            t: 0.0,
            coverage: 0.0,
            strand: 0,
            segment: 0,
        };
        let mut fragments = vec![nothing; offsets[width * height]];
        let mut next = offsets.clone();
        for (pixel, fragment) in found.into_iter().flatten() {
            fragments[next[pixel as usize]] = fragment;
            next[pixel as usize] += 1;
        }

        let mut rest = fragments.as_mut_slice();
        let mut lists = Vec::with_capacity(width * height);
        for range in offsets.windows(2) {
            let (list, tail) = rest.split_at_mut(range[1] - range[0]);
            lists.push(list);
            rest = tail;
        }
        lists.into_par_iter().with_min_len(256).for_each(|list| {
            list.sort_unstable_by(|a, b| {
                a.depth.total_cmp(&b.depth).then(a.segment.cmp(&b.segment))
            });
        });
        Self {
            width,
            height,
            offsets,
            fragments,
        }
    }
}

/// A plane on the screen, seen edge-on, that separates the pixels of two segments.
#[derive(Clone, Copy)]
struct Joint {
    point: DVec2,
    normal: DVec2,
}

impl Joint {
    /// Whether a pixel's centre belongs to what comes after the joint.
    fn before(&self, centre: DVec2) -> bool {
        (centre - self.point).dot(self.normal) >= 0.0
    }
}

/// A segment that has a direction on the screen.
#[derive(Clone, Copy)]
struct Piece {
    source: ScreenSegment,
    direction: DVec2,
    length: f64,
    /// Length of the crossing up to the segment's start, in pixels.
    arc: f64,
    /// The plane towards the segment before; `None` at an end.
    behind: Option<Joint>,
    /// The plane towards the segment after; `None` at an end.
    ahead: Option<Joint>,
}

/// A chain of segments that share out pixels among themselves.
struct Crossing {
    pieces: Vec<Piece>,
    length: f64,
}

/// The unit direction from `points[at]` to the nearest of the following points that tells one.
fn direction<'a>(at: DVec2, others: impl Iterator<Item = &'a DVec2>) -> Option<DVec2> {
    let mut ways = others.map(|other| *other - at);
    let way = ways.find(|way| way.length() > SHORTEST_DIRECTION)?;
    Some(way.normalize())
}

/// Splits a run where it turns too sharply to go on; leaves out what has no direction, and segments between coincident points.
fn crossings(run: &[ScreenSegment]) -> Vec<Crossing> {
    let mut points = vec![run[0].start.pixel];
    points.extend(run.iter().map(|source| source.end.pixel));

    let mut chains: Vec<Crossing> = Vec::new();
    let mut open = false;
    for (i, source) in run.iter().enumerate() {
        let here = points[i];
        let step = source.end.pixel - here;
        let length = step.length();
        if length == 0.0 {
            continue;
        }
        let after = direction(here, points[i + 1..].iter());
        let before = direction(here, points[..i].iter().rev()).map(|way| -way);
        let normal = match (before, after) {
            (Some(before), Some(after)) => (before + after).try_normalize().unwrap_or(after),
            (Some(only), None) | (None, Some(only)) => only,
            (None, None) => {
                open = false;
                continue;
            }
        };
        let turned = |(before, after): (DVec2, DVec2)| before.dot(after) < SHARPEST_JOINT;
        let joint = Joint {
            point: here,
            normal,
        };
        let mut piece = Piece {
            source: *source,
            direction: if length > SHORTEST_DIRECTION {
                step / length
            } else {
                normal
            },
            length,
            arc: 0.0,
            behind: None,
            ahead: None,
        };
        match chains.last_mut() {
            Some(chain) if open && !before.zip(after).is_some_and(turned) => {
                if let Some(last) = chain.pieces.last_mut() {
                    last.ahead = Some(joint);
                }
                piece.behind = Some(joint);
                piece.arc = chain.length;
                chain.length += length;
                chain.pieces.push(piece);
            }
            _ => chains.push(Crossing {
                pieces: vec![piece],
                length,
            }),
        }
        open = true;
    }
    chains
}

impl Crossing {
    /// The part of the pixel around `centre` that a segment covers, and where on the segment (0 to 1 on the screen).
    fn coverage(&self, piece: &Piece, centre: DVec2) -> (f64, f64) {
        let [start, end] = [&piece.source.start, &piece.source.end];
        let along = (centre - start.pixel).dot(piece.direction);
        let t = if piece.length > SHORTEST_DIRECTION {
            (along / piece.length).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let band = Band {
            point: start.pixel,
            direction: piece.direction,
            half_width: start.half_width + (end.half_width - start.half_width) * t,
        };

        // How far from the segment's own ends those of the strand are, and how much of what lies beyond a joint counts.
        let before = piece.arc;
        let after = self.length - piece.arc - piece.length;
        let beside = BESIDE_JOINT * band.half_width;
        let counted = |over: f64| (over - beside).clamp(0.0, MOST_BEYOND);
        let most = MOST_OF_LENGTH * self.length;
        let (first, last) = if piece.behind.is_some() && along < 0.0 {
            let first = along - before + counted(-along);
            (first, (piece.length + after).min(first + most))
        } else if piece.ahead.is_some() && along > piece.length {
            let last = along + after - counted(along - piece.length);
            ((-before).max(last - most), last)
        } else {
            (-before, piece.length + after)
        };
        let cut = |place: f64, normal: DVec2| HalfPlane {
            point: start.pixel + piece.direction * place,
            normal,
        };
        let mut cuts = Vec::with_capacity(2);
        if before < REACH {
            cuts.push(cut(first, piece.direction));
        }
        if after < REACH {
            cuts.push(cut(last, -piece.direction));
        }
        (band_coverage(centre, &band, &cuts), t)
    }
}

/// Shrinks an interval of x to where `normal · (c - point) + slack >= 0` in the row of centres at `y`.
fn narrow(interval: &mut [f64; 2], y: f64, point: DVec2, normal: DVec2, slack: f64) {
    let rest = normal.y * (y - point.y) + slack;
    if normal.x.abs() < 1e-12 {
        if rest < -SLACK {
            *interval = [1.0, 0.0];
        }
    } else if normal.x > 0.0 {
        interval[0] = interval[0].max(point.x - rest / normal.x);
    } else {
        interval[1] = interval[1].min(point.x - rest / normal.x);
    }
}

/// Calls `visit` with every pixel (x, y) that a segment may own and cover.
fn candidates(piece: &Piece, camera: &Camera, mut visit: impl FnMut(usize, usize)) {
    let [start, end] = [&piece.source.start, &piece.source.end];
    let across = piece.direction.perp();
    let lateral = start.half_width.max(end.half_width) + FRAC_1_SQRT_2 + SLACK;
    let beyond = |joint: Option<Joint>| {
        if joint.is_some() {
            lateral * STEEPEST_PLANE
        } else {
            FRAC_1_SQRT_2
        }
    };

    // Rows: those of the rectangle that holds every owned centre near enough to be covered.
    let back = start.pixel - piece.direction * (beyond(piece.behind) + SLACK);
    let front = end.pixel + piece.direction * (beyond(piece.ahead) + SLACK);
    let spread = (across.y * lateral).abs();
    let top = (back.y.min(front.y) - spread - 0.5).ceil().max(0.0);
    let bottom = (back.y.max(front.y) + spread - 0.5)
        .floor()
        .min(camera.height as f64 - 1.0);
    if top > bottom {
        return;
    }

    for row in top as usize..=bottom as usize {
        let y = row as f64 + 0.5;
        let mut interval = [0.5, camera.width as f64 - 0.5];
        narrow(&mut interval, y, start.pixel, across, lateral);
        narrow(&mut interval, y, start.pixel, -across, lateral);
        narrow(&mut interval, y, back, piece.direction, 0.0);
        narrow(&mut interval, y, front, -piece.direction, 0.0);
        if let Some(joint) = piece.behind {
            narrow(&mut interval, y, joint.point, joint.normal, SLACK);
        }
        if let Some(joint) = piece.ahead {
            narrow(&mut interval, y, joint.point, -joint.normal, SLACK);
        }
        let first = (interval[0] - 0.5 - SLACK).ceil().max(0.0);
        let last = (interval[1] - 0.5 + SLACK)
            .floor()
            .min(camera.width as f64 - 1.0);
        if first <= last {
            (first as usize..=last as usize).for_each(|column| visit(column, row));
        }
    }
}

/// The fragments of one chain of segments, with the pixels in which they lie.
fn crossing_fragments(
    crossing: &Crossing,
    camera: &Camera,
    strand: u32,
    found: &mut Vec<(u32, Fragment)>,
) {
    for piece in &crossing.pieces {
        candidates(piece, camera, |x, y| {
            let centre = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            let owned = piece.behind.is_none_or(|joint| joint.before(centre))
                && piece.ahead.is_none_or(|joint| !joint.before(centre));
            if !owned {
                return;
            }
            let (coverage, t) = crossing.coverage(piece, centre);
            if coverage <= 0.0 {
                return;
            }
            let ScreenSegment {
                segment,
                start,
                end,
                span,
            } = piece.source;
            let fragment = Fragment {
                depth: interpolated_depth(&start, &end, t),
                t: span[0] + (span[1] - span[0]) * t,
                coverage,
                strand,
                segment: segment as u32,
            };
            found.push(((y * camera.width + x) as u32, fragment));
        });
    }
}

fn interpolated_depth(start: &ScreenPoint, end: &ScreenPoint, t: f64) -> f64 {
    start.depth * (1.0 - t) + end.depth * t
}

/// The fragments of all strands, with depths from 0 to 1.
///
/// `host_depth` holds the depth of what the host has drawn, a value per pixel, row by row; fragments at or behind it
/// are left out.
///
/// # Panics
/// If `host_depth` has another size than the image, or there are 2³² points or pixels.
pub fn fragment_lists(
    strands: &Strands,
    camera: &Camera,
    host_depth: Option<&[f32]>,
) -> FragmentLists {
    let [width, height] = [camera.width, camera.height];
    assert!(
        strands.points.len() < u32::MAX as usize && width * height < u32::MAX as usize,
        "scene too large"
    );
    if let Some(host) = host_depth {
        assert_eq!(
            host.len(),
            width * height,
            "the host's depth has another size than the image"
        );
    }
    let visible = |pixel: u32, depth: f64| {
        (0.0..=1.0).contains(&depth)
            && host_depth.is_none_or(|host| depth < f64::from(host[pixel as usize]))
    };

    let tasks = strands.len().div_ceil(STRANDS_PER_TASK);
    let found: Vec<Vec<(u32, Fragment)>> = (0..tasks)
        .into_par_iter()
        .map(|task| {
            let mut found = Vec::new();
            let last = ((task + 1) * STRANDS_PER_TASK).min(strands.len());
            for strand in task * STRANDS_PER_TASK..last {
                for run in project_strand(strands, camera, strand) {
                    for crossing in crossings(&run) {
                        crossing_fragments(&crossing, camera, strand as u32, &mut found);
                    }
                }
            }
            found.retain(|(pixel, fragment)| visible(*pixel, fragment.depth));
            found
        })
        .collect();
    FragmentLists::sorted(width, height, found)
}
