//! A scene on the GPU: rendered, read back, and measured.

use std::time::Instant;

use pelage::glam::Vec3;
use pelage::groom::Mesh;
use pelage::host::offscreen::{Image, Offscreen, OffscreenOptions};
use pelage::{Frame, Hair, Light, LightKind, PassTime, Statistics, Target, wgpu};
use serde_json::{Map, Value, json};

use super::framing::{self, Bounds, Framing};
use super::groom::{self, Groom};
use super::mesh_pass::{MeshPass, Scenery};
use super::output::{Picture, Spread};
use super::scene::{Result, Scene};
use super::techniques::{self, number, numbers};

/// A scene on the GPU, ready to be rendered again and again.
pub struct Renderer {
    offscreen: Offscreen,
    image: Image,
    hair: Hair,
    meshes: Option<MeshPass>,
    framing: Framing,
    lights: Vec<Light>,
    ambient: Vec3,
    transparency: pelage::transparency::Transparency,
}

/// What the statistics file tells of.
pub struct Rendered<'a> {
    /// The last picture.
    pub picture: &'a Picture,
    /// Wall clock of the frames.
    pub times: Spread,
    /// Of the last frame.
    pub statistics: &'a Statistics,
}

impl Renderer {
    /// Opens a device and uploads everything.
    pub fn new(scene: &Scene, groom: &Groom, mesh: &Mesh) -> Result<Self> {
        let bounds = Bounds::around(groom.strands.points()).ok_or("the hair has no points")?;
        let all = Bounds::around(&mesh.positions).map_or(bounds, |mesh| bounds.union(mesh));
        let framing = framing::frame(&scene.camera, bounds, groom.front, all)?;
        let (lights, ambient) = framing::lights(scene, &framing);

        let mut offscreen = Offscreen::new(&OffscreenOptions::default()).map_err(sentence)?;
        let features = offscreen.renderer.device().features();
        let format = if features.contains(wgpu::Features::FLOAT32_BLENDABLE) {
            wgpu::TextureFormat::Rgba32Float
        } else {
            wgpu::TextureFormat::Rgba16Float
        };
        let has_meshes = !mesh.indices.is_empty();
        let image = offscreen
            .create_image(framing.width, framing.height, format, has_meshes)
            .map_err(sentence)?;
        let scenery = Scenery {
            view: framing.view,
            eye: framing.eye,
            lights: &lights,
            ambient,
        };
        let meshes =
            has_meshes.then(|| MeshPass::new(offscreen.renderer.device(), &image, mesh, &scenery));
        let mut hair = offscreen
            .renderer
            .create_hair(&groom.strands)
            .map_err(sentence)?;
        hair.opacity = scene.fibre.opacity;
        hair.shading = scene.shading;
        hair.shading_rate = scene.shading_rate;
        Ok(Self {
            offscreen,
            image,
            hair,
            meshes,
            framing,
            lights,
            ambient,
            transparency: scene.transparency,
        })
    }

    /// Whether frames take the shadow maps of those before them.
    pub fn set_shadow_reuse(&mut self, reuse: bool) {
        self.offscreen.renderer.set_shadow_reuse(reuse);
    }

    /// Renders a frame and waits for it. Returns the wall clock from the start of recording, in milliseconds.
    pub fn render(&mut self) -> Result<f64> {
        let start = Instant::now();
        let mut encoder = self
            .offscreen
            .renderer
            .device()
            .create_command_encoder(&Default::default());
        if let Some(meshes) = &self.meshes {
            meshes.record(&mut encoder, &self.image);
        }
        let hairs = [&self.hair];
        let frame = frame(
            &hairs,
            &self.lights,
            self.ambient,
            &self.framing,
            self.transparency,
        );
        let target = target(&self.image, self.meshes.is_none());
        self.offscreen
            .renderer
            .record(&mut encoder, &frame, &target)
            .map_err(sentence)?;
        self.submit(encoder)?;
        Ok(milliseconds(start))
    }

    /// What the last frame drew.
    pub fn picture(&mut self) -> Result<Picture> {
        let pixels = self
            .offscreen
            .read_colour(&self.image.colour)
            .map_err(sentence)?;
        Ok(Picture {
            width: self.framing.width,
            height: self.framing.height,
            pixels,
        })
    }

    /// Of the last frame that was waited for.
    pub fn statistics(&mut self) -> Statistics {
        self.offscreen.renderer.statistics()
    }

    /// The device in use.
    pub fn adapter_info(&self) -> &wgpu::AdapterInfo {
        self.offscreen.adapter_info()
    }

    /// Renders once more, pass by pass, and returns the time of each.
    fn pass_times(&mut self) -> Result<Vec<PassTime>> {
        let mut times = Vec::new();
        if let Some(meshes) = &self.meshes {
            let start = Instant::now();
            let mut encoder = self
                .offscreen
                .renderer
                .device()
                .create_command_encoder(&Default::default());
            meshes.record(&mut encoder, &self.image);
            self.submit(encoder)?;
            times.push(PassTime {
                label: "host.meshes".into(),
                ms: milliseconds(start),
            });
        }
        let hairs = [&self.hair];
        let frame = frame(
            &hairs,
            &self.lights,
            self.ambient,
            &self.framing,
            self.transparency,
        );
        let target = target(&self.image, self.meshes.is_none());
        times.extend(
            self.offscreen
                .renderer
                .render_timed(&frame, &target)
                .map_err(sentence)?
                .passes,
        );
        Ok(times)
    }

    /// Pixels of which hair covers some part, for techniques that do not count them: the hair alone, behind the same
    /// depth, has an alpha there.
    fn count_covered(&mut self) -> Result<u64> {
        let hairs = [&self.hair];
        let frame = frame(
            &hairs,
            &self.lights,
            self.ambient,
            &self.framing,
            self.transparency,
        );
        let target = Target {
            clear: true,
            receive_shadow: false,
            ..target(&self.image, false)
        };
        self.offscreen.render(&frame, &target).map_err(sentence)?;
        Ok(self
            .picture()?
            .pixels
            .iter()
            .filter(|pixel| pixel.w > 0.0)
            .count() as u64)
    }

    /// The statistics file.
    pub fn statistics_json(&mut self, scene: &Scene, rendered: &Rendered) -> Result<Value> {
        let passes = self.pass_times()?;
        let Rendered {
            picture,
            times,
            statistics,
        } = rendered;
        let covered = match statistics.covered_pixels {
            0 if statistics.fragments.produced > 0 => self.count_covered()?,
            counted => counted,
        };
        let mut by_label = Map::new();
        for (label, bytes) in &statistics.bytes {
            by_label.insert(label.clone(), json!(bytes));
        }
        let passes: Vec<Value> = passes
            .iter()
            .map(|pass| json!({ "label": pass.label, "ms": pass.ms }))
            .collect();
        let info = self.adapter_info();
        Ok(json!({
            "adapter": info.name,
            "driver": format!("{} {}", info.driver, info.driver_info).trim(),
            "strands": statistics.strands,
            "segments": statistics.segments,
            "width": picture.width,
            "height": picture.height,
            "frame_ms": times.json(),
            "passes": passes,
            "bytes": { "total": statistics.bytes_total, "peak": statistics.bytes_peak, "by_label": by_label },
            "fragments": {
                "produced": statistics.fragments.produced,
                "culled": statistics.fragments.culled,
                "stored": statistics.fragments.stored,
                "merged": statistics.fragments.merged,
            },
            "covered_pixels": covered,
            "shadow_maps": {
                "filled": statistics.shadow_maps_filled,
                "taken": statistics.shadow_maps_taken,
            },
            "settings": self.settings(scene),
        }))
    }

    /// The scene as it was rendered, with nothing left open.
    fn settings(&self, scene: &Scene) -> Value {
        let Framing {
            eye,
            target,
            up,
            vfov_deg,
            width,
            height,
            ..
        } = self.framing;
        let lights: Vec<Value> = self.lights.iter().map(light_settings).collect();
        let hair: Vec<String> = scene.hair.iter().map(groom::name).collect();
        let radii = self.hair.strands().radii();
        let (least, most) = radii
            .iter()
            .fold((f32::INFINITY, 0.0f32), |(a, b), r| (a.min(*r), b.max(*r)));
        let fibre = json!({
            // One number where it is one, else the range.
            "radius": if least == most { number(least) } else { json!([number(least), number(most)]) },
            "opacity": number(scene.fibre.opacity),
            "eta": number(scene.fibre.eta),
            "sigma_a": numbers(scene.fibre.sigma_a.into()),
            "beta_m": number(scene.fibre.beta_m),
            "beta_n": number(scene.fibre.beta_n),
            "alpha_deg": number(scene.fibre.alpha_deg),
        });
        let meshes = match &scene.meshes {
            Some(paths) => json!(paths),
            None if self.meshes.is_some() => json!(["builtin:head"]),
            None => json!([]),
        };
        let mut shading = techniques::shading_settings(&scene.shading);
        shading["rate"] = techniques::rate_setting(scene.shading_rate);
        json!({
            "hair": hair,
            "camera": {
                "eye": eye.to_array(), "target": target.to_array(), "up": up.to_array(),
                "vfov_deg": vfov_deg, "width": width, "height": height,
            },
            "light": lights,
            "ambient": numbers(self.ambient),
            "fibre": fibre,
            "shading": shading,
            "shadow": techniques::shadow_settings(&scene.shadow),
            "transparency": techniques::transparency_settings(&scene.transparency),
            "meshes": meshes,
        })
    }

    fn submit(&self, encoder: wgpu::CommandEncoder) -> Result<()> {
        self.offscreen.renderer.queue().submit([encoder.finish()]);
        let waited = self
            .offscreen
            .renderer
            .device()
            .poll(wgpu::PollType::wait_indefinitely());
        waited
            .map(|_| ())
            .map_err(|error| format!("the device is lost: {error}"))
    }
}

fn sentence(error: pelage::Error) -> String {
    error.to_string()
}

fn milliseconds(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

fn frame<'a>(
    hairs: &'a [&'a Hair],
    lights: &'a [Light],
    ambient: Vec3,
    framing: &Framing,
    transparency: pelage::transparency::Transparency,
) -> Frame<'a> {
    Frame {
        hairs,
        lights,
        ambient,
        view: framing.view,
        transparency: Some(transparency),
    }
}

/// Into the image; over the opaque scene that is already there, unless it is alone.
fn target(image: &Image, alone: bool) -> Target<'_> {
    Target {
        depth: image.depth.as_ref(),
        clear: alone,
        receive_shadow: !alone,
        ..Target::cleared(&image.colour)
    }
}

fn light_settings(light: &Light) -> Value {
    match light.kind {
        LightKind::Directional {
            direction,
            irradiance,
        } => {
            json!({ "direction": direction.to_array(), "irradiance": numbers(irradiance) })
        }
        LightKind::Point {
            position,
            intensity,
        } => {
            json!({ "position": position.to_array(), "intensity": numbers(intensity) })
        }
        LightKind::Spot {
            position,
            direction,
            intensity,
            inner_angle,
            outer_angle,
        } => {
            let cone = [inner_angle, outer_angle].map(|angle| f64::from(angle).to_degrees());
            json!({
                "position": position.to_array(),
                "direction": direction.to_array(),
                "intensity": numbers(intensity),
                "cone_deg": cone,
            })
        }
    }
}
