//! The double-precision side: the very same strands and camera, and what they should look like.

use std::cell::OnceCell;
use std::f64::consts::PI;

use pelage::glam::{DVec3, Vec3};
use pelage::groom::{self, Curve, Strands};
use pelage::shading::KajiyaKay;
use pelage_reference::composite::{self, Image, point_colours};
use pelage_reference::fragments::{FragmentLists, fragment_lists};
use pelage_reference::kajiya_kay;
use pelage_reference::project::tangents;
use pelage_reference::scene::Camera;
use pelage_reference::transmittance::{Light, Occluders, Query};

use super::ladder::Scene;
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
            all.extend(tangents(points).unwrap_or_else(|| vec![DVec3::Y; points.len()]));
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

    /// Radiance towards the eye of every point, without shadow.
    fn colours(&self, model: &KajiyaKay) -> Vec<[f64; 3]> {
        let to_light = -LIGHT_DIRECTION;
        let mut colours = Vec::with_capacity(self.reference.points.len());
        for (strand, colour) in self.strands.colours().iter().enumerate() {
            for point in self.reference.range(strand) {
                let to_eye = self.eye - self.reference.points[point];
                colours.push(std::array::from_fn(|channel| {
                    let model = kajiya_kay::KajiyaKay {
                        diffuse: f64::from(model.diffuse[channel]) * f64::from(colour[channel]),
                        specular: f64::from(model.specular[channel]),
                        exponent: f64::from(model.exponent),
                    };
                    IRRADIANCE * kajiya_kay::scatter(self.tangents[point], to_light, to_eye, &model)
                }));
            }
        }
        colours
    }

    /// The picture of each pixel's nearest fragment.
    pub fn nearest(&self, model: &KajiyaKay) -> Image {
        composite::opaque(
            &self.lists,
            self.opacity,
            point_colours(&self.colours(model)),
        )
    }

    /// The picture of all fragments. All cases are shaded alike: the first model is the one that counts.
    pub fn exact(&self, model: &KajiyaKay) -> &Image {
        self.exact.get_or_init(|| {
            composite::composite(
                &self.lists,
                self.opacity,
                point_colours(&self.colours(model)),
            )
        })
    }

    /// Transmittances of nearest fragments, evenly picked over the covered pixels. They are means over a disc of half
    /// a pixel's size around each strand point, interpolated as colours are. As for the model, see [`Truth::exact`].
    pub fn probes(&self, model: &KajiyaKay) -> &[Probe] {
        self.probes.get_or_init(|| self.find_probes(model))
    }

    fn find_probes(&self, model: &KajiyaKay) -> Vec<Probe> {
        let colours = self.colours(model);
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
