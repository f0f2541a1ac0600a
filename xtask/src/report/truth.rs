//! The double-precision side: the very same strands and camera, and what they should look like.

use std::cell::OnceCell;
use std::f64::consts::PI;

use pelage::glam::{DVec3, Vec3};
use pelage::groom::{self, Curve, Strands};
use pelage::shading::{Sample, Shading};
use pelage_reference::composite::{self, Image, point_colours};
use pelage_reference::fibre::{Direction, FibreModel};
use pelage_reference::fragments::{Fragment, FragmentLists, fragment_lists};
use pelage_reference::project::curve_tangents;
use pelage_reference::scene::Camera;
use pelage_reference::transmittance::{Light, Occluders, Query};
use pelage_reference::{kajiya_kay, scheuermann};

use rayon::prelude::*;

use super::ladder::Scene;
use super::models;
use crate::Result;
use crate::scene_file::framing::{self, Bounds, Framing};

/// The way the light travels: from the upper left, in front.
pub const LIGHT_DIRECTION: DVec3 = DVec3::new(0.55, -0.7, -0.75);
/// Irradiance on a plane that faces the light: a white fibre is then as bright as white.
pub const IRRADIANCE: f64 = PI;

/// Straight pieces of a spline's segment.
const CURVE_PIECES: u32 = 4;
/// How many points' transmittance is compared at most.
const MOST_PROBES: usize = 6_000;
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
    /// The strands, cut into straight pieces.
    pub strands: Strands,
    /// The camera.
    pub framing: Framing,
    /// The exact fragments.
    pub lists: FragmentLists,
    opacity: f64,
    reference: pelage_reference::scene::Strands,
    eye: DVec3,
    tangents: Vec<DVec3>,
    probes: OnceCell<Vec<Probe>>,
    exact: OnceCell<Image>,
}

/// A pixel whose nearest fragment's transmittance towards the light is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Probe {
    /// The pixel's index.
    pub pixel: usize,
    /// Brightness of the fragment without shadow, the strand's colour included, per channel.
    pub bright: [f64; 3],
    /// The part of the light that reaches it.
    pub transmittance: f64,
    /// The pixel's opacity.
    pub opacity: f64,
}

impl Truth {
    /// Makes the groom and lists its fragments.
    pub fn new(scene: &Scene) -> Result<Self> {
        let mut strands =
            groom::builtin(scene.groom, scene.strands).map_err(|error| error.to_string())?;
        if strands.curve() != Curve::Polyline {
            strands =
                groom::tessellate(&strands, CURVE_PIECES).map_err(|error| error.to_string())?;
        }
        // White, so that errors are parts of white, and no model's own reading of a strand's colour is in them.
        let white = vec![[1.0; 3]; strands.strand_count()];
        strands = strands
            .with_colours(white)
            .map_err(|error| error.to_string())?;
        let bounds = Bounds::around(strands.points()).ok_or("the groom has no points")?;
        let [width, height] = scene.size;
        let camera = crate::scene_file::scene::Camera {
            width,
            height,
            ..Default::default()
        };
        let framing = framing::frame(&camera, bounds, DVec3::Z, bounds)?;

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
        let camera = Camera {
            clip_from_world: framing.view.clip_from_view * framing.view.view_from_world,
            eye: framing.eye.extend(1.0),
            width: width as usize,
            height: height as usize,
        };
        let lists = fragment_lists(&reference, &camera, None);
        let mut all = Vec::with_capacity(reference.points.len());
        for strand in 0..reference.len() {
            let points = &reference.points[reference.range(strand)];
            all.extend(
                curve_tangents(points)
                    .into_iter()
                    .map(|t| t.unwrap_or(DVec3::Y)),
            );
        }
        Ok(Self {
            strands,
            eye: framing.eye,
            framing,
            lists,
            opacity: f64::from(scene.opacity),
            reference,
            tangents: all,
            probes: OnceCell::new(),
            exact: OnceCell::new(),
        })
    }

    /// Every strand point, lit, as the shading pass sees it.
    pub fn samples(&self) -> Vec<Sample> {
        let to_light = -LIGHT_DIRECTION.normalize();
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
        let scatter = scatter(shading)?;
        let (eye, points, tangents) = (self.eye, &self.reference.points, &self.tangents);
        let radiance = |point: usize| {
            if !wanted(point) {
                return [0.0; 3];
            }
            let to_eye = eye - points[point];
            (IRRADIANCE * scatter(tangents[point], -LIGHT_DIRECTION, to_eye)).to_array()
        };
        Ok((0..points.len()).into_par_iter().map(radiance).collect())
    }

    /// The picture of each pixel's nearest fragment, its colour interpolated between points or found at its own place.
    pub fn nearest(&self, shading: &Shading, at_fragments: bool) -> Result<Image> {
        if at_fragments {
            let scatter = scatter(shading)?;
            let (eye, points, tangents) = (self.eye, &self.reference.points, &self.tangents);
            let colour = |fragment: &Fragment| {
                let (first, t) = (fragment.segment as usize, fragment.t);
                let place = |values: &[DVec3]| values[first].lerp(values[first + 1], t);
                let tangent = place(tangents).normalize_or(tangents[first]);
                let to_eye = eye - place(points);
                (IRRADIANCE * scatter(tangent, -LIGHT_DIRECTION, to_eye)).to_array()
            };
            return Ok(composite::opaque(&self.lists, self.opacity, colour));
        }
        let mut shown = vec![false; self.reference.points.len()];
        for fragment in (0..self.lists.pixels()).filter_map(|at| self.lists.pixel(at).first()) {
            let first = fragment.segment as usize;
            (shown[first], shown[first + 1]) = (true, true);
        }
        let colours = self.colours_of(shading, |point| shown[point])?;
        Ok(composite::opaque(
            &self.lists,
            self.opacity,
            point_colours(&colours),
        ))
    }

    /// The picture of all fragments. All cases are shaded alike: the first model is the one that counts.
    pub fn exact(&self, shading: &Shading) -> Result<&Image> {
        if self.exact.get().is_none() {
            let colours = self.colours(shading)?;
            let image = composite::composite(&self.lists, self.opacity, point_colours(&colours));
            self.exact.set(image).ok();
        }
        self.exact.get().ok_or_else(|| "no picture".into())
    }

    /// The fewest fragments that must be stored for what lies behind them to receive less than `tolerance` of the light.
    pub fn fewest(&self, tolerance: f64) -> u64 {
        let needed = composite::fragments_needed(&self.lists, self.opacity, tolerance);
        needed.iter().map(|count| *count as u64).sum()
    }

    /// Transmittances of nearest fragments, evenly picked over the covered pixels. They are means over a disc of half
    /// a pixel's size around each strand point, interpolated as colours are. As for the model, see [`Truth::exact`].
    pub fn probes(&self, shading: &Shading) -> Result<&[Probe]> {
        if self.probes.get().is_none() {
            let probes = self.find_probes(&self.colours(shading)?);
            self.probes.set(probes).ok();
        }
        self.probes
            .get()
            .map(Vec::as_slice)
            .ok_or_else(|| "no probes".into())
    }

    fn find_probes(&self, colours: &[[f64; 3]]) -> Vec<Probe> {
        let shown = |pixel: &usize| {
            self.lists.pixel(*pixel).first().is_some_and(|nearest| {
                self.opacity * nearest.coverage >= LEAST_OPACITY
                    && colours[nearest.segment as usize][0] >= LEAST_BRIGHTNESS
            })
        };
        let covered: Vec<usize> = (0..self.lists.pixels()).filter(shown).collect();
        let stride = covered.len().div_ceil(MOST_PROBES).max(1);
        let picked: Vec<usize> = covered.into_iter().step_by(stride).collect();

        let own = |pixel: usize| self.lists.pixel(pixel)[0].segment as usize;
        let points: Vec<(DVec3, Option<usize>)> = picked
            .iter()
            .flat_map(|pixel| [own(*pixel), own(*pixel) + 1])
            .map(|point| (self.reference.points[point], Some(point)))
            .collect();
        let query = Query {
            light: Light::Directional {
                towards: -LIGHT_DIRECTION,
            },
            alpha: self.opacity,
            footprint: 0.5 * self.pixel_size(),
            samples: RAYS,
        };
        let passed = Occluders::new(&self.reference).transmittances(&points, &query);
        let probe = |(pixel, ends): (&usize, &[f64])| {
            let fragments = self.lists.pixel(*pixel);
            let nearest = &fragments[0];
            let [start, end] = [
                colours[nearest.segment as usize],
                colours[nearest.segment as usize + 1],
            ];
            let mix = |channel: usize, passed: &[f64]| {
                start[channel] * passed[0] * (1.0 - nearest.t)
                    + end[channel] * passed[1] * nearest.t
            };
            let bright: [f64; 3] = std::array::from_fn(|channel| mix(channel, &[1.0, 1.0]));
            Probe {
                pixel: *pixel,
                bright,
                transmittance: mix(0, ends) / bright[0],
                opacity: 1.0 - composite::transmittance(fragments, self.opacity),
            }
        };
        picked
            .iter()
            .zip(passed.chunks_exact(2))
            .map(probe)
            .collect()
    }

    /// A pixel's size in world units at the middle of the groom.
    fn pixel_size(&self) -> f64 {
        let distance = self.framing.eye.distance(self.framing.target);
        2.0 * distance * (0.5 * self.framing.vfov_deg.to_radians()).tan()
            / f64::from(self.framing.height)
    }
}
