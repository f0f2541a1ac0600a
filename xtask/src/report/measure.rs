//! The GPU's side: renders a case, compares it, and times it.

use std::collections::BTreeMap;
use std::time::Instant;

use pelage::glam::Vec3;
use pelage::host::offscreen::{Image, Offscreen, OffscreenOptions};
use pelage::shadow::Shadow;
use pelage::transparency::a_buffer::{FRAGMENT_BYTES, NODE_BYTES};
use pelage::transparency::{DbkBuffer, Storage, Transparency};
use pelage::{Frame, Hair, Light, LightKind, Target, wgpu};
use pelage_reference::composite;
use pelage_reference::error::{ImageError, alpha_error, colour_error};

use super::Group;
use super::ladder::Case;
use super::row::{Error, Fragments, Row, Times};
use super::scenes::{Loaded, Scene};
use super::truth::{self, IRRADIANCE, Truth};
use super::{flip, samples};
use crate::Result;

/// Frames before any is timed: shaders are compiled and pools find their size.
const WARM_UP_FRAMES: usize = 2;
/// Frames that are timed, unless two of them have taken so many milliseconds.
const TIMED_FRAMES: usize = 5;
const TIMED_MS: f64 = 2_000.0;
/// Two fragments have the same colour if it differs by no more than this part: more than 16-bit floats lose.
const SAME_COLOUR: f64 = 0.005;

/// A case on a device of its own, so that its memory is its own.
pub struct Bench<'a> {
    offscreen: Offscreen,
    image: Image,
    hair: Hair,
    truth: &'a Truth,
}

/// Measures a case.
pub fn measure(scene: &Scene, truth: &Truth, case: &Case) -> Result<Row> {
    if case.group == Group::Samples {
        return samples::measure(scene, truth, case);
    }
    let start = Instant::now();
    let mut case = case.clone();
    set_pool(&mut case, truth.fragments());
    if let (Some(part), Transparency::DbkBuffer(settings)) = (case.shift, &mut case.transparency) {
        settings.depth_shift = Some((part * truth.depth()) as f32);
    }
    let mut bench = Bench::new(scene, truth, &case)?;
    let (error, image_error, alpha) = match case.group {
        Group::Shadow => {
            let (error, image_error) = bench.shadow_error(&case)?;
            (error, Some(image_error), None)
        }
        Group::Shading => {
            let truth = truth.nearest(&case.shading, case.rate.is_some())?;
            (bench.image_error(&case, &truth)?.0, None, None)
        }
        _ => {
            let (error, alpha) = bench.image_error(&case, &truth.exact())?;
            (error, None, Some(alpha))
        }
    };
    let times = timed(|| match case.group {
        Group::Shadow => bench.pass_time(&case, "pelage.shadow."),
        _ => bench.render(case.shadow, case.transparency),
    })?;
    let passes = match case.group {
        Group::Transparency => bench.passes(&case)?,
        _ => BTreeMap::new(),
    };
    let statistics = bench.offscreen.renderer.statistics();
    let fragments = statistics.fragments;
    let squares = match image_error {
        Some(Error { flip: Some(_), .. }) => Some(truth.squares(&case.shading)?.to_string()),
        _ => None,
    };
    let undecided = match case.group {
        Group::Transparency => Some(truth.undecided()).filter(|pixels| *pixels > 0),
        _ => None,
    };
    Ok(Row {
        image_error,
        squares,
        undecided,
        alpha_error: alpha,
        passes,
        seconds: Some(start.elapsed().as_secs_f64()),
        bytes: statistics.bytes_total,
        fragments: (fragments.produced > 0).then_some(Fragments {
            produced: fragments.produced,
            culled: fragments.culled,
            stored: fragments.stored,
            merged: fragments.merged,
        }),
        fewest: match case.transparency {
            Transparency::DbkBuffer(DbkBuffer {
                epsilon,
                depth_shift: None,
                ..
            }) => truth.fewest(epsilon),
            _ => None,
        },
        ..row(scene, &case, error, spread(times), bench.adapter())
    })
}

/// The times of as many frames as are timed.
fn timed(mut frame: impl FnMut() -> Result<f64>) -> Result<Vec<f64>> {
    let start = Instant::now();
    let mut times = Vec::with_capacity(TIMED_FRAMES);
    while times.len() < TIMED_FRAMES
        && (times.len() < 2 || start.elapsed().as_secs_f64() * 1e3 < TIMED_MS)
    {
        times.push(frame()?);
    }
    Ok(times)
}

/// A case's row of today, with what every group measures.
pub fn row(
    scene: &Scene,
    case: &Case,
    error: Error,
    ms: Times,
    adapter: &wgpu::AdapterInfo,
) -> Row {
    Row {
        group: case.group.name().into(),
        technique: case.technique().into(),
        settings: case.settings(),
        scene: scene.name.into(),
        width: scene.size[0],
        height: scene.size[1],
        error,
        image_error: None,
        squares: None,
        undecided: None,
        alpha_error: None,
        ms,
        samples: None,
        ratio: None,
        shading_ms: None,
        bytes: 0,
        fragments: None,
        fewest: None,
        passes: BTreeMap::new(),
        seconds: None,
        adapter: adapter.name.clone(),
        driver: format!("{} {}", adapter.driver, adapter.driver_info)
            .trim()
            .into(),
        date: time::OffsetDateTime::now_utc().date().to_string(),
    }
}

/// Turns a part of the pool into bytes.
fn set_pool(case: &mut Case, fragments: u64) {
    let Some(part) = case.pool else { return };
    let bytes = |storage| {
        let each = match storage {
            Storage::Counted => FRAGMENT_BYTES,
            Storage::Lists => NODE_BYTES,
        };
        Some((part * fragments as f64 * each as f64) as u64)
    };
    match &mut case.transparency {
        Transparency::ABuffer(settings) => settings.pool_bytes = bytes(settings.storage),
        Transparency::KBuffer(settings) => settings.pool_bytes = bytes(settings.storage),
        Transparency::KBufferSinglePass(settings) => settings.pool_bytes = bytes(Storage::Lists),
        _ => {}
    }
}

/// The least and the median of at least one.
pub fn spread(mut times: Vec<f64>) -> Times {
    times.sort_unstable_by(f64::total_cmp);
    Times {
        min: times[0],
        median: times[times.len() / 2],
    }
}

impl<'a> Bench<'a> {
    /// The scene's groom with the case's shading.
    pub fn new(scene: &Scene, truth: &'a Truth, case: &Case) -> Result<Self> {
        let mut offscreen = Offscreen::new(&OffscreenOptions::default()).map_err(sentence)?;
        offscreen.renderer.set_shadow_reuse(case.reuse);
        let [width, height] = scene.size;
        let image = offscreen
            .create_image(
                width,
                height,
                wgpu::TextureFormat::Rgba32Float,
                truth.scene.host_depth.is_some(),
            )
            .map_err(sentence)?;
        if let (Some(image), Some(depth)) = (&image.depth, &truth.scene.host_depth) {
            offscreen.write_depth(image, depth).map_err(sentence)?;
        }
        let mut hair = offscreen
            .renderer
            .create_hair(&truth.scene.strands)
            .map_err(sentence)?;
        hair.opacity = truth.scene.opacity;
        hair.shading = case.shading;
        hair.shading_rate = case.rate.unwrap_or_default();
        Ok(Self {
            offscreen,
            image,
            hair,
            truth,
        })
    }

    /// Renders once; the wall clock from the start of recording in milliseconds.
    pub fn render(&mut self, shadow: Shadow, transparency: Transparency) -> Result<f64> {
        let lights = [light(&self.truth.scene, shadow)];
        let hairs = [&self.hair];
        let frame = frame(&hairs, &lights, self.truth, transparency);
        let start = Instant::now();
        self.offscreen
            .render(&frame, &target(&self.image))
            .map_err(sentence)?;
        Ok(start.elapsed().as_secs_f64() * 1e3)
    }

    /// The picture after enough frames for the pools to have found their size.
    fn picture(&mut self, shadow: Shadow, transparency: Transparency) -> Result<composite::Image> {
        for _ in 0..WARM_UP_FRAMES {
            self.render(shadow, transparency)?;
        }
        let pixels = self
            .offscreen
            .read_colour(&self.image.colour)
            .map_err(sentence)?;
        Ok(composite::Image {
            width: self.image.colour.width() as usize,
            height: self.image.colour.height() as usize,
            pixels: pixels
                .iter()
                .map(|pixel| pixel.to_array().map(f64::from))
                .collect(),
        })
    }

    /// Frames before any is timed.
    pub fn warm_up(&mut self, case: &Case) -> Result<()> {
        for _ in 0..WARM_UP_FRAMES {
            self.render(case.shadow, case.transparency)?;
        }
        Ok(())
    }

    /// The device.
    pub fn adapter(&self) -> &wgpu::AdapterInfo {
        self.offscreen.adapter_info()
    }

    /// GPU memory held.
    pub fn bytes(&mut self) -> u64 {
        self.offscreen.renderer.statistics().bytes_total
    }

    /// The time of each pass of a frame, submitted alone, in milliseconds.
    pub fn passes(&mut self, case: &Case) -> Result<BTreeMap<String, f64>> {
        let lights = [light(&self.truth.scene, case.shadow)];
        let hairs = [&self.hair];
        let frame = frame(&hairs, &lights, self.truth, case.transparency);
        let passes = self
            .offscreen
            .renderer
            .render_timed(&frame, &target(&self.image))
            .map_err(sentence)?
            .passes;
        Ok(passes
            .into_iter()
            .map(|pass| (pass.label, pass.ms))
            .collect())
    }

    /// The sum of the passes whose label begins so.
    pub fn pass_time(&mut self, case: &Case, prefix: &str) -> Result<f64> {
        let passes = self.passes(case)?;
        let of_prefix = passes.iter().filter(|(label, _)| label.starts_with(prefix));
        Ok(of_prefix.map(|(_, ms)| ms).sum())
    }

    /// The picture against another: its colours, and its opacity.
    fn image_error(&mut self, case: &Case, truth: &composite::Image) -> Result<(Error, Error)> {
        let actual = self.picture(case.shadow, case.transparency)?;
        let of = |error: ImageError, flip| Error {
            rmse: error.rmse,
            p99: error.p99,
            max: error.max,
            flip,
            bias: None,
        };
        let comparable = self.truth.comparable();
        let colour = colour_error(&actual, truth, Some(&comparable));
        Ok((
            of(colour, flip::mean(&actual, truth)),
            of(alpha_error(&actual, truth, Some(&comparable)), None),
        ))
    }

    /// Errors of transmittance and of the picture at the truth's probes. Transmittance is the picture with shadow over
    /// the one without; where the latter has another colour than the truth, another strand was nearest and the point is
    /// not the probe's.
    fn shadow_error(&mut self, case: &Case) -> Result<(Error, Error)> {
        let lit = self.picture(Shadow::None, case.transparency)?;
        let shadowed = self.picture(case.shadow, case.transparency)?;
        let mut transmittance = Vec::new();
        let mut radiance = Vec::new();
        for probe in self.truth.probes(&case.shading)? {
            let [lit, shadowed] = [&lit, &shadowed].map(|image| image.pixels[probe.pixel as usize]);
            let expected = probe.bright.map(|bright| probe.opacity * bright);
            if (0..3).any(|c| (lit[c] - expected[c]).abs() > SAME_COLOUR * expected[c]) {
                continue;
            }
            transmittance.push(shadowed[0] / lit[0] - probe.transmittance);
            radiance
                .extend((0..3).map(|c| (shadowed[c] - expected[c] * probe.transmittance).abs()));
        }
        let compared = transmittance.len();
        let all = self.truth.probes(&case.shading)?.len();
        if compared * 2 < all {
            return Err(format!(
                "only {compared} of {all} points could be told apart"
            ));
        }
        let error = Error {
            bias: Some(transmittance.iter().sum::<f64>() / compared as f64),
            ..error_of(transmittance.iter().map(|t| t.abs()).collect())
        };
        let image_error = Error {
            flip: self.squares_flip(case, &lit, &shadowed)?,
            ..error_of(radiance)
        };
        Ok((error, image_error))
    }

    /// Mean ꟻLIP over the truth's squares. Where the nearest strand is another than the reference's, or nothing is known, both
    /// pictures are alike.
    fn squares_flip(
        &self,
        case: &Case,
        lit: &composite::Image,
        shadowed: &composite::Image,
    ) -> Result<Option<f64>> {
        let squares = self.truth.squares(&case.shading)?;
        let mut sum = 0.0;
        if squares.corners.is_empty() {
            return Ok(None);
        }
        for &corner in &squares.corners {
            let blank = composite::Image {
                width: truth::SQUARE,
                height: truth::SQUARE,
                pixels: vec![[0.0; 4]; truth::SQUARE * truth::SQUARE],
            };
            let (mut actual, mut expected) = (blank.clone(), blank);
            for probe in &squares.probes {
                let pixel = probe.pixel as usize;
                let [x, y] = self.truth.place(pixel);
                let bright = probe.bright.map(|bright| probe.opacity * bright);
                let same =
                    |c: usize| (lit.pixels[pixel][c] - bright[c]).abs() <= SAME_COLOUR * bright[c];
                if !truth::in_square(corner, [x, y]) || !(0..3).all(same) {
                    continue;
                }
                let at = (y - corner[1]) * truth::SQUARE + x - corner[0];
                let [red, green, blue] = bright.map(|bright| bright * probe.transmittance);
                actual.pixels[at] = shadowed.pixels[pixel];
                expected.pixels[at] = [red, green, blue, probe.opacity];
            }
            let Some(mean) = flip::mean(&actual, &expected) else {
                return Ok(None);
            };
            sum += mean;
        }
        Ok(Some(sum / squares.corners.len() as f64))
    }
}

/// Of absolute differences, at least one.
pub fn error_of(mut differences: Vec<f64>) -> Error {
    differences.sort_unstable_by(f64::total_cmp);
    let count = differences.len();
    Error {
        rmse: (differences.iter().map(|d| d * d).sum::<f64>() / count as f64).sqrt(),
        p99: differences[(count * 99).div_ceil(100) - 1],
        max: differences[count - 1],
        flip: None,
        bias: None,
    }
}

fn light(scene: &Loaded, shadow: Shadow) -> Light {
    let kind = LightKind::Directional {
        direction: scene.light,
        irradiance: Vec3::splat(IRRADIANCE as f32),
    };
    Light {
        kind,
        shadow: Some(shadow),
    }
}

/// The hair alone, behind the opaque scene's depth where there is one.
fn target(image: &Image) -> Target<'_> {
    Target {
        depth: image.depth.as_ref(),
        ..Target::cleared(&image.colour)
    }
}

fn frame<'a>(
    hairs: &'a [&'a Hair],
    lights: &'a [Light],
    truth: &Truth,
    transparency: Transparency,
) -> Frame<'a> {
    Frame {
        hairs,
        lights,
        ambient: Vec3::ZERO,
        view: truth.scene.framing.view,
        transparency: Some(transparency),
    }
}

/// An error as a sentence.
pub fn sentence(error: pelage::Error) -> String {
    error.to_string()
}
