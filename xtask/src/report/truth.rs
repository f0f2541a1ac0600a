//! The double-precision side: the very same strands and camera, and what they should look like.

use std::cell::OnceCell;
use std::f64::consts::PI;
use std::fmt;

use bytemuck::{Pod, Zeroable};
use pelage::glam::{DVec3, Vec3};
use pelage::shading::{Sample, Shading};
use pelage_reference::composite::{self, Image, point_colours};
use pelage_reference::fibre::{Direction, FibreModel};
use pelage_reference::fragments::{FragmentLists, fragment_lists};
use pelage_reference::project::curve_tangents;
use pelage_reference::scene::Camera;
use pelage_reference::transmittance::{Light, Occluders, Query};
use pelage_reference::{kajiya_kay, scheuermann};

use rayon::prelude::*;

use super::kept::{Key, kept};
use super::ladder::{EPSILONS, picture_shading};
use super::models;
use super::scenes::{self, Loaded, Scene};
use crate::Result;
use crate::scene_file::framing::Framing;

/// Irradiance on a plane that faces the light: a white fibre is then as bright as white.
pub const IRRADIANCE: f64 = PI;

/// Rows whose fragments are listed at a time: all of a large frame's would need gigabytes.
const BAND_ROWS: usize = 128;
/// How many points' transmittance is compared at most.
const MOST_PROBES: usize = 6_000;
/// Fragments this close to the opaque scene's depth, four units of a float below 1, may lie before it or behind it for all that single
/// precision knows.
const UNDECIDED: f32 = 2.4e-7;
/// Pixels a side of the squares whose pictures are compared as pictures, and how many there are.
pub const SQUARE: usize = 64;
pub const SQUARES: usize = 4;
/// Pixels between the places where a square may begin.
const SQUARE_STEP: usize = 8;
/// The part of a square's pixels that can be compared, at least, where there are enough of such squares.
const SQUARE_COVERED: f64 = 0.98;
/// Rays a point: the footprint's mean then errs by less than 1/16.
const RAYS: usize = 64;
/// Points of fibres that show less than this are not compared: their colour has too few digits.
const LEAST_OPACITY: f64 = 0.02;
/// Nor are fibres that run almost along the light.
const LEAST_BRIGHTNESS: f64 = 0.1;

/// A model's value times the cosine for a tangent and the ways to light and eye.
type Scatter = Box<dyn Fn(DVec3, DVec3, DVec3) -> DVec3 + Sync>;

/// The reference's value of a model with these parameters.
fn scatter(shading: &Shading) -> Result<Scatter> {
    fn fibre(model: impl FibreModel + 'static) -> Scatter {
        Box::new(move |tangent: DVec3, to_light, to_eye| {
            let tangent = tangent.normalize();
            // The section is round: any axis across the tangent will do.
            let across = tangent.any_orthonormal_vector();
            let seen = |v: DVec3| Direction::in_frame(v.normalize(), tangent, across);
            model.scatter(seen(to_light), seen(to_eye))
        })
    }
    Ok(match shading {
        Shading::KajiyaKay(model) => {
            let channels: [kajiya_kay::KajiyaKay; 3] =
                std::array::from_fn(|channel| kajiya_kay::KajiyaKay {
                    diffuse: f64::from(model.diffuse[channel]),
                    specular: f64::from(model.specular[channel]),
                    exponent: f64::from(model.exponent),
                });
            Box::new(move |tangent, to_light, to_eye| {
                let value = |model| kajiya_kay::scatter(tangent, to_light, to_eye, model);
                DVec3::from_array(channels.each_ref().map(value))
            })
        }
        Shading::Scheuermann(model) => {
            let model = models::of_scheuermann(model);
            Box::new(move |tangent, to_light, to_eye| {
                scheuermann::scatter(tangent, to_light, to_eye, &model)
            })
        }
        Shading::Marschner(model) => fibre(models::of_marschner(model)),
        Shading::Sadeghi(model) if model.normalised => {
            fibre(models::of_sadeghi(model).normalised())
        }
        Shading::Sadeghi(model) => fibre(models::of_sadeghi(model)),
        Shading::Chiang(model) => fibre(models::of_chiang(model)),
        other => return Err(format!("the reference has no {}", other.stem())),
    })
}

/// A scene, and what is known of it.
pub struct Truth {
    /// Strands, camera, light and the opaque scene's depth.
    pub scene: Loaded,
    name: &'static str,
    key: Key,
    pixels: Vec<Pixel>,
    opacity: f64,
    reference: pelage_reference::scene::Strands,
    eye: DVec3,
    tangents: Vec<DVec3>,
    probes: OnceCell<Vec<Probe>>,
    squares: OnceCell<Squares>,
}

/// Squares of [`SQUARE`] pixels, and all of their pixels' transmittances.
#[derive(Debug)]
pub struct Squares {
    /// First columns and rows.
    pub corners: Vec<[usize; 2]>,
    /// The pixels that can be compared.
    pub probes: Vec<Probe>,
}

impl fmt::Display for Squares {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let corners = self.corners.iter();
        let corners: Vec<String> = corners.map(|[x, y]| format!("({x}, {y})")).collect();
        write!(f, "{SQUARE} pixels from {}", corners.join(", "))
    }
}

/// What is kept of a pixel that hair covers.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
struct Pixel {
    /// Its index, row by row.
    index: u32,
    /// How many fragments it has.
    count: u32,
    /// The fewest of them that each of [`EPSILONS`] allows.
    fewest: [u32; EPSILONS.len()],
    /// Index of the first point of the nearest fragment's segment.
    segment: u32,
    /// Whether a fragment lies within [`UNDECIDED`] of the opaque scene.
    undecided: u32,
    /// Where the nearest fragment lies on its segment.
    t: f64,
    /// Its coverage.
    coverage: f64,
    /// The part of the light from behind that passes all fragments.
    transmittance: f64,
    /// The exact composite, shaded by [`picture_shading`].
    exact: [f64; 3],
}

/// A pixel whose nearest fragment's transmittance towards the light is known.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Probe {
    /// The pixel's index.
    pub pixel: u64,
    /// Brightness of the fragment without shadow, the strand's colour included, per channel.
    pub bright: [f64; 3],
    /// The part of the light that reaches it.
    pub transmittance: f64,
    /// The pixel's opacity.
    pub opacity: f64,
}

impl Truth {
    /// Loads a scene and composites its fragments, or takes the composite that is kept of a former run.
    pub fn new(scene: &Scene) -> Result<Self> {
        let loaded = scenes::load(scene)?;
        let strands = &loaded.strands;
        let reference = pelage_reference::scene::Strands {
            points: strands
                .points()
                .iter()
                .map(|p| Vec3::from(*p).as_dvec3())
                .collect(),
            offsets: strands
                .offsets()
                .iter()
                .map(|offset| *offset as usize)
                .collect(),
            radii: strands
                .radii()
                .iter()
                .map(|radius| f64::from(*radius))
                .collect(),
        };
        let mut tangents = Vec::with_capacity(reference.points.len());
        for strand in 0..reference.len() {
            let points = &reference.points[reference.range(strand)];
            tangents.extend(
                curve_tangents(points)
                    .into_iter()
                    .map(|t| t.unwrap_or(DVec3::Y)),
            );
        }
        let view = loaded.framing.view;
        let matrices = [view.clip_from_view, view.view_from_world].map(|m| m.to_cols_array());
        let key = Key::new()?
            .and(strands.points())
            .and(strands.offsets())
            .and(strands.radii())
            .and(&matrices)
            .and(&[loaded.framing.width, loaded.framing.height])
            .and(&[loaded.opacity])
            .and(&loaded.light.to_array())
            .and(loaded.host_depth.as_deref().unwrap_or_default())
            .and(format!("{:?}", picture_shading()).as_bytes());
        let mut truth = Self {
            name: scene.name,
            key,
            pixels: Vec::new(),
            opacity: f64::from(loaded.opacity),
            eye: loaded.framing.eye,
            reference,
            tangents,
            probes: OnceCell::new(),
            squares: OnceCell::new(),
            scene: loaded,
        };
        let colours = truth.colours(&picture_shading())?;
        truth.pixels = kept(&format!("{}-pixels", scene.name), &truth.key, || {
            truth.find_pixels(&colours)
        })?;
        Ok(truth)
    }

    fn find_pixels(&self, colours: &[[f64; 3]]) -> Vec<Pixel> {
        let Framing {
            view,
            eye,
            width,
            height,
            ..
        } = self.scene.framing;
        let [width, height] = [width as usize, height as usize];
        let camera = Camera {
            clip_from_world: view.clip_from_view * view.view_from_world,
            eye: eye.extend(1.0),
            width,
            height,
        };
        let mut pixels = Vec::new();
        for first in (0..height).step_by(BAND_ROWS) {
            let rows = BAND_ROWS.min(height - first);
            let places = first * width..(first + rows) * width;
            let depth = self.scene.host_depth.as_deref();
            let depth = depth.map(|depth| &depth[places.clone()]);
            let lists = fragment_lists(&self.reference, &camera.rows(first, rows), depth);
            let mut found = self.pixels_of(&lists, places.start, colours);
            if let Some(depth) = depth {
                let [before, behind] = [-UNDECIDED, UNDECIDED].map(|by| {
                    let depth: Vec<f32> = depth.iter().map(|depth| depth + by).collect();
                    fragment_lists(&self.reference, &camera.rows(first, rows), Some(&depth))
                });
                for pixel in &mut found {
                    let at = pixel.index as usize - places.start;
                    let [before, behind] = [&before, &behind].map(|lists| lists.pixel(at).len());
                    pixel.undecided = u32::from(before != behind);
                }
            }
            pixels.extend(found);
        }
        pixels
    }

    /// Pixels where the opaque scene hides a fragment or not by less than single precision tells.
    pub fn undecided(&self) -> usize {
        self.pixels
            .iter()
            .filter(|pixel| pixel.undecided != 0)
            .count()
    }

    /// Whether a pixel is covered, and decided.
    pub fn comparable(&self) -> Vec<bool> {
        let framing = &self.scene.framing;
        let mut comparable = vec![false; framing.width as usize * framing.height as usize];
        for pixel in &self.pixels {
            comparable[pixel.index as usize] = pixel.undecided == 0 && pixel.transmittance < 1.0;
        }
        comparable
    }

    /// Of a band of rows that begins at pixel `first`.
    fn pixels_of(&self, lists: &FragmentLists, first: usize, colours: &[[f64; 3]]) -> Vec<Pixel> {
        let exact = composite::composite(lists, self.opacity, point_colours(colours));
        let fewest = EPSILONS
            .map(|epsilon| composite::fragments_needed(lists, self.opacity, f64::from(epsilon)));
        let pixel = |at: usize| {
            let fragments = lists.pixel(at);
            let nearest = fragments.first()?;
            let [red, green, blue, _] = exact.pixels[at];
            Some(Pixel {
                index: (first + at) as u32,
                count: fragments.len() as u32,
                fewest: std::array::from_fn(|number| fewest[number][at] as u32),
                segment: nearest.segment,
                undecided: 0,
                t: nearest.t,
                coverage: nearest.coverage,
                transmittance: composite::transmittance(fragments, self.opacity),
                exact: [red, green, blue],
            })
        };
        (0..lists.pixels()).filter_map(pixel).collect()
    }

    /// The groom's extent along the view.
    pub fn depth(&self) -> f64 {
        let framing = &self.scene.framing;
        let forward = (framing.target - framing.eye).normalize();
        let depths = self.reference.points.iter().map(|p| p.dot(forward));
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        let [near, far] = depths.fold(none, |[low, high], d| [low.min(d), high.max(d)]);
        far - near
    }

    /// How many fragments there are.
    pub fn fragments(&self) -> u64 {
        self.pixels.iter().map(|pixel| u64::from(pixel.count)).sum()
    }

    /// A picture of covered pixels' colours and opacities.
    fn image(&self, mut colour: impl FnMut(&Pixel) -> [f64; 4]) -> Image {
        let [width, height] = [self.scene.framing.width, self.scene.framing.height];
        let [width, height] = [width as usize, height as usize];
        let mut pixels = vec![[0.0; 4]; width * height];
        for pixel in &self.pixels {
            pixels[pixel.index as usize] = colour(pixel);
        }
        Image {
            width,
            height,
            pixels,
        }
    }

    /// Every strand point, lit, as the shading pass sees it.
    pub fn samples(&self) -> Vec<Sample> {
        let to_light = -self.scene.light.normalize();
        let sample = |(point, tangent): (&DVec3, &DVec3)| {
            let to_eye = (self.eye - *point).normalize();
            let [tangent, to_light, to_eye] =
                [tangent.normalize(), to_light, to_eye].map(|v| v.as_vec3());
            Sample::lit(tangent, to_light, to_eye)
        };
        std::iter::zip(&self.reference.points, &self.tangents)
            .map(sample)
            .collect()
    }

    /// The reference's values of samples.
    pub fn scatter_samples(&self, shading: &Shading, samples: &[Sample]) -> Result<Vec<DVec3>> {
        let scatter = scatter(shading)?;
        let value = |sample: &Sample| {
            let [tangent, to_light, to_eye] =
                [sample.tangent, sample.to_light, sample.to_eye].map(|v| v.as_dvec3());
            scatter(tangent, to_light, to_eye)
        };
        Ok(samples.par_iter().map(value).collect())
    }

    /// Radiance towards the eye of every point, without shadow.
    fn colours(&self, shading: &Shading) -> Result<Vec<[f64; 3]>> {
        self.colours_of(shading, |_| true)
    }

    /// The same of the points that are `wanted`, and zero of the others.
    fn colours_of(
        &self,
        shading: &Shading,
        wanted: impl Fn(usize) -> bool + Sync,
    ) -> Result<Vec<[f64; 3]>> {
        let (scatter, light) = (scatter(shading)?, self.scene.light);
        let (eye, points, tangents) = (self.eye, &self.reference.points, &self.tangents);
        let radiance = |point: usize| {
            if !wanted(point) {
                return [0.0; 3];
            }
            let to_eye = eye - points[point];
            (IRRADIANCE * scatter(tangents[point], -light, to_eye)).to_array()
        };
        Ok((0..points.len()).into_par_iter().map(radiance).collect())
    }

    /// The picture of each pixel's nearest fragment, its colour interpolated between points or found at its own place.
    pub fn nearest(&self, shading: &Shading, at_fragments: bool) -> Result<Image> {
        let shown = |pixel: &Pixel, colour: [f64; 3]| {
            let alpha = 1.0 - pixel.transmittance;
            let [red, green, blue] = colour.map(|channel| alpha * channel);
            [red, green, blue, alpha]
        };
        if at_fragments {
            let (scatter, light) = (scatter(shading)?, self.scene.light);
            let (eye, points, tangents) = (self.eye, &self.reference.points, &self.tangents);
            let colour = |pixel: &Pixel| {
                let (first, t) = (pixel.segment as usize, pixel.t);
                let place = |values: &[DVec3]| values[first].lerp(values[first + 1], t);
                let tangent = place(tangents).normalize_or(tangents[first]);
                let to_eye = eye - place(points);
                (IRRADIANCE * scatter(tangent, -light, to_eye)).to_array()
            };
            let colours: Vec<_> = self.pixels.par_iter().map(colour).collect();
            let mut colours = colours.into_iter();
            return Ok(self.image(|pixel| shown(pixel, colours.next().unwrap_or_default())));
        }
        let mut wanted = vec![false; self.reference.points.len()];
        for pixel in &self.pixels {
            let first = pixel.segment as usize;
            (wanted[first], wanted[first + 1]) = (true, true);
        }
        let colours = self.colours_of(shading, |point| wanted[point])?;
        let colour = |pixel: &Pixel| {
            let ends = [0, 1].map(|end| colours[pixel.segment as usize + end]);
            std::array::from_fn(|c| ends[0][c] * (1.0 - pixel.t) + ends[1][c] * pixel.t)
        };
        Ok(self.image(|pixel| shown(pixel, colour(pixel))))
    }

    /// The picture of all fragments, shaded by [`picture_shading`].
    pub fn exact(&self) -> Image {
        self.image(|pixel| {
            let [red, green, blue] = pixel.exact;
            [red, green, blue, 1.0 - pixel.transmittance]
        })
    }

    /// The fewest fragments that must be stored for what lies behind them to receive less than one of [`EPSILONS`] of the
    /// light.
    pub fn fewest(&self, epsilon: f32) -> Option<u64> {
        let number = EPSILONS.iter().position(|known| *known == epsilon)?;
        let fewest = |pixel: &Pixel| u64::from(pixel.fewest[number]);
        Some(self.pixels.iter().map(fewest).sum())
    }

    /// Transmittances of nearest fragments, evenly picked over the covered pixels. They are means over a disc of half
    /// a pixel's size around each strand point, interpolated as colours are. All cases are shaded alike: the first model is
    /// the one that counts.
    pub fn probes(&self, shading: &Shading) -> Result<&[Probe]> {
        if self.probes.get().is_none() {
            let colours = self.colours(shading)?;
            let probes = kept(&format!("{}-probes", self.name), &self.key, || {
                let shown = self.shown(&colours);
                let stride = shown.len().div_ceil(MOST_PROBES).max(1);
                let picked: Vec<&Pixel> = shown.into_iter().step_by(stride).collect();
                self.find_probes(&picked, &colours)
            })?;
            self.probes.set(probes).ok();
        }
        let probes = self.probes.get().ok_or("no probes")?;
        Ok(probes)
    }

    /// The same of every pixel of some squares of hair, a fair sample of its light: all squares that hair fills are put in the
    /// order of their probes' mean transmittance, and those in the middles of [`SQUARES`] equal parts of that order are taken,
    /// or the next ones that overlap none before.
    pub fn squares(&self, shading: &Shading) -> Result<&Squares> {
        if self.squares.get().is_none() {
            let colours = self.colours(shading)?;
            let shown = self.shown(&colours);
            let corners = self.corners(&shown, self.probes(shading)?);
            let key = self.key.clone().and(corners.as_flattened());
            let probes = kept(&format!("{}-squares", self.name), &key, || {
                let within = |pixel: &&Pixel| {
                    let place = self.place(pixel.index as usize);
                    corners.iter().any(|corner| in_square(*corner, place))
                };
                let picked: Vec<&Pixel> = shown.into_iter().filter(within).collect();
                self.find_probes(&picked, &colours)
            })?;
            self.squares.set(Squares { corners, probes }).ok();
        }
        let squares = self.squares.get().ok_or("no squares")?;
        Ok(squares)
    }

    fn corners(&self, shown: &[&Pixel], probes: &[Probe]) -> Vec<[usize; 2]> {
        let [width, height] = [self.scene.framing.width, self.scene.framing.height];
        let [width, height] = [width as usize, height as usize];
        let mut filled = vec![0; width * height];
        for pixel in shown {
            filled[pixel.index as usize] = 1;
        }
        let places = |size: usize| (0..=size.saturating_sub(SQUARE)).step_by(SQUARE_STEP);
        let mut squares = Vec::new();
        for corner in places(height).flat_map(|top| places(width).map(move |left| [left, top])) {
            let [left, top] = corner;
            let rows = (top..height.min(top + SQUARE)).map(|row| row * width);
            let count: usize = rows
                .flat_map(|row| &filled[row + left..row + width.min(left + SQUARE)])
                .sum();
            let inside = probes
                .iter()
                .filter(|probe| in_square(corner, self.place(probe.pixel as usize)));
            let (number, sum) = inside.fold((0, 0.0), |(number, sum), probe| {
                (number + 1, sum + probe.transmittance)
            });
            if number > 0 {
                squares.push((count, sum / f64::from(number), corner));
            }
        }
        // A groom may have no square without a gap: then the fullest tenth.
        let mut counts: Vec<usize> = squares.iter().map(|(count, ..)| *count).collect();
        counts.sort_unstable();
        let tenth = counts.get(counts.len() * 9 / 10).copied().unwrap_or(0);
        let least = tenth.min((SQUARE_COVERED * (SQUARE * SQUARE) as f64) as usize);
        squares.retain(|(count, ..)| *count >= least);
        squares.sort_by(|a, b| a.1.total_cmp(&b.1));
        let mut corners: Vec<[usize; 2]> = Vec::new();
        for part in 0..SQUARES {
            let middle = (2 * part + 1) * squares.len() / (2 * SQUARES);
            let apart = |corner: &[usize; 2]| {
                let overlaps = |other: &[usize; 2]| {
                    (0..2).all(|axis| corner[axis].abs_diff(other[axis]) < SQUARE)
                };
                !corners.iter().any(overlaps)
            };
            let next = squares[middle..].iter().map(|square| square.2).find(apart);
            corners.extend(next);
        }
        corners
    }

    /// A pixel's column and row.
    pub fn place(&self, pixel: usize) -> [usize; 2] {
        let width = self.scene.framing.width as usize;
        [pixel % width, pixel / width]
    }

    /// The pixels whose transmittance can be told from their colour.
    fn shown(&self, colours: &[[f64; 3]]) -> Vec<&Pixel> {
        let shown = |pixel: &&Pixel| {
            self.opacity * pixel.coverage >= LEAST_OPACITY
                && colours[pixel.segment as usize][0] >= LEAST_BRIGHTNESS
        };
        self.pixels.iter().filter(shown).collect()
    }

    fn find_probes(&self, picked: &[&Pixel], colours: &[[f64; 3]]) -> Vec<Probe> {
        // Neighbours share their fibres' points.
        let mut wanted: Vec<usize> = picked
            .iter()
            .flat_map(|pixel| [pixel.segment as usize, pixel.segment as usize + 1])
            .collect();
        wanted.sort_unstable();
        wanted.dedup();
        let points: Vec<(DVec3, Option<usize>)> = wanted
            .iter()
            .map(|&point| (self.reference.points[point], Some(point)))
            .collect();
        let query = Query {
            light: Light::Directional {
                towards: -self.scene.light,
            },
            alpha: self.opacity,
            footprint: 0.5 * self.pixel_size(),
            samples: RAYS,
        };
        let passed = Occluders::new(&self.reference).transmittances(&points, &query);
        let passed_at = |point: usize| {
            let at = wanted.binary_search(&point);
            at.map_or(1.0, |at| passed[at])
        };
        let probe = |pixel: &&Pixel| {
            let ends = [0, 1].map(|end| pixel.segment as usize + end);
            let [start, end] = ends.map(|point| colours[point]);
            let ends = ends.map(passed_at);
            let mix = |channel: usize, passed: [f64; 2]| {
                start[channel] * passed[0] * (1.0 - pixel.t) + end[channel] * passed[1] * pixel.t
            };
            let bright: [f64; 3] = std::array::from_fn(|channel| mix(channel, [1.0, 1.0]));
            Probe {
                pixel: u64::from(pixel.index),
                bright,
                transmittance: mix(0, ends) / bright[0],
                opacity: 1.0 - pixel.transmittance,
            }
        };
        picked.iter().map(probe).collect()
    }

    /// A pixel's size in world units at the middle of the groom.
    fn pixel_size(&self) -> f64 {
        let framing = &self.scene.framing;
        let distance = framing.eye.distance(framing.target);
        2.0 * distance * (0.5 * framing.vfov_deg.to_radians()).tan() / f64::from(framing.height)
    }
}

/// Whether a pixel at a column and row lies in the square that begins at a corner.
pub fn in_square(corner: [usize; 2], place: [usize; 2]) -> bool {
    (0..2).all(|axis| (corner[axis]..corner[axis] + SQUARE).contains(&place[axis]))
}
