//! The plan of a frame: everything that the CPU decides before a pass is recorded. Matrices are composed in double
//! precision here; the GPU sees positions relative to the view's eye.

mod choices;
mod seen;

use std::ops::Range;

use glam::{DMat4, DVec3, DVec4, Vec3};

use crate::error::{Error, Result, invalid};
use crate::frame::{Frame, ShadowImage, Target};
use crate::geometry::{Hair, Instance, MAX_FRAME_POINTS, Run};
use crate::gpu::{Gpu, spread_workgroups};
use crate::layout::{
    self, FIBRE_POINT_VECTORS, FIBRE_RUN_VECTORS, MAX_LIGHTS, MAX_OCCLUDERS, MAX_SHADOW_VIEWS,
    UNIFORM_STRIDE,
};
use crate::light::{LightCamera, LightKind, light_cameras};
use crate::memory::Viewport;
use crate::occluder::{self, Occluder};
use crate::raster::Rasteriser;
use crate::shading::transmission::{self, greatest_angle};
use crate::shading::{Shader, Shading, ShadingRate};
use crate::shadow::{Fibres, Shadow, Shape, Sight};
use crate::transparency::a_buffer::HALF_BYTES;
use crate::transparency::nearest::Sought;
use crate::transparency::sorted_blending::Sorting;
use crate::transparency::{Needs, Transparency};
use crate::view::View;
use choices::{choose_shadow, choose_transparency, one_shader};
use seen::{Seen, Word, key_range, place_of_depth, view_size};

/// A run of a hair, and where its points lie among the frame's pooled points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlannedRun {
    pub hair: usize,
    /// Number among the frame's placed hairs: a hair's instances are placed one by one.
    pub placed: usize,
    pub run: Run,
    pub base: u32,
    pub material: u32,
}

/// One map of one light.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PlannedMap {
    pub technique: Shadow,
    pub shape: Shape,
    pub rasteriser: Rasteriser,
    /// Whether the map's near plane may cross the hair.
    pub crosses: bool,
    /// Uniform offsets, one a run.
    pub drawings: Vec<u32>,
    pub splits: u32,
    /// Its words among those of all maps.
    pub words: Range<u64>,
    /// Whether this frame fills it, and does not take it as an earlier one has left it.
    pub filled: bool,
}

/// A map that is to be planned.
struct Map {
    technique: Shadow,
    shape: Shape,
    camera: LightCamera,
    /// The widest fibre's, in texels.
    half_width: f64,
}

/// A band of rows whose pixels fit in the bindings.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Band {
    pub number: u32,
    pub first: u32,
    pub rows: u32,
    pub drawings: Vec<u32>,
    /// Uniform offset of the points of all runs together, where they are sorted.
    pub whole: u32,
}

/// The plan of a frame.
#[derive(Debug)]
pub(crate) struct Plan {
    pub width: u32,
    pub height: u32,
    pub runs: Vec<PlannedRun>,
    /// Which geometries the runs read, to tell when bindings must be made anew.
    pub serials: Vec<u64>,
    /// Which points each run draws, whatever buffer they are in.
    pub contents: Vec<u64>,
    /// Whether all of them are surely there: no update of the GPU's is still to run.
    pub landed: bool,
    pub maps: Vec<PlannedMap>,
    pub bands: Vec<Band>,
    pub transparency: Transparency,
    pub rasteriser: Rasteriser,
    pub splits: u32,
    pub point_count: u64,
    /// Words of all lights' maps.
    pub map_words: u64,
    /// Fragments that the frame is expected to produce.
    pub expected_fragments: u64,
    /// Uniform blocks; the frame's first.
    pub uniforms: Vec<u8>,
    pub strands: u64,
    pub segments: u64,
    pub shader: Shader,
    /// How light may go through fibres, where that may be left out.
    pub transmissions: Vec<Transmission>,
    /// Every hair's model.
    pub shadings: Vec<Shading>,
    /// Every hair's uniform block.
    materials: Vec<u32>,
    /// The technique of all lights that have maps; none where no light has any.
    pub shadow: Shadow,
    /// Whether only the images of the hair's shadow are written.
    pub shadows_only: bool,
    pub reverse_z: bool,
    pub host_depth: bool,
    /// What is asked of each pixel's nearest fragment where the technique does not know it.
    pub sought: Sought,
    /// How sorted blending sorts; empty for other techniques.
    pub sorting: Sorting,
    /// Whether this frame sorts anew.
    pub sort: bool,
    /// Whether the view's near plane may cross the hair.
    pub crosses: bool,
    /// Whether the technique cuts off what cannot be seen.
    pub cuts: bool,
    /// Whether an output asks for a record of each point.
    pub tracked: bool,
    /// The pixel of the target that the view begins at.
    pub origin: [u32; 2],
    pub frame_uniform: layout::Frame,
}

/// Fragments that a pool can hold on this device, whatever its memory: each half of their words is in one binding.
pub(crate) fn most_fragments(gpu: &Gpu) -> u64 {
    gpu.max_binding() / HALF_BYTES
}

/// Room in a new pool beyond what the frame is expected, or was measured, to need.
pub(crate) const POOL_MARGIN: f64 = 1.15;

/// Segments wider than this many pixels in all are shared among invocations: some drivers end loops at 65,535 steps.
const PIXELS_AN_INVOCATION: f64 = 8192.0;

/// A hair as the frame sees it.
struct Placed {
    hair: usize,
    instance: usize,
    relative_from_object: DMat4,
    /// World space from the object space of the points now, and of the frame before's points then.
    world_from_points: DMat4,
    previous_world_from_points: DMat4,
    half_extent: DVec3,
    /// Corners of its box in relative space.
    corners: [DVec3; 8],
    scale: f64,
    radius: f64,
}

/// A hair's instances, or itself.
fn place_all(number: usize, hair: &Hair, origin: DVec3) -> Vec<Placed> {
    let single = [Instance {
        object_from_instance: DMat4::IDENTITY,
        previous_object_from_instance: None,
    }];
    let instances = if hair.instances.is_empty() {
        &single[..]
    } else {
        &hair.instances
    };
    let place = |(at, instance)| place(number, hair, at, instance, origin);
    instances.iter().enumerate().map(place).collect()
}

fn place(number: usize, hair: &Hair, at: usize, instance: &Instance, origin: DVec3) -> Placed {
    let geometry = &hair.geometry;
    let world_from_instance = hair.world_from_object * instance.object_from_instance;
    let previous_world_from_instance = hair
        .previous_world_from_object
        .unwrap_or(hair.world_from_object)
        * instance
            .previous_object_from_instance
            .unwrap_or(instance.object_from_instance);
    let previous_origin = geometry.previous().map_or(geometry.origin, |(_, at)| at);
    let world_from_points = world_from_instance * DMat4::from_translation(geometry.origin);
    let relative_from_object = DMat4::from_translation(-origin) * world_from_points;
    // Of what does not depend on the view: maps are kept from one to another.
    let scale = glam::DMat3::from_mat4(world_from_points)
        .determinant()
        .abs()
        .cbrt();
    Placed {
        hair: number,
        instance: at,
        relative_from_object,
        world_from_points,
        previous_world_from_points: previous_world_from_instance
            * DMat4::from_translation(previous_origin),
        half_extent: geometry.half_extent,
        corners: corners(&relative_from_object, geometry.half_extent),
        scale,
        radius: geometry.max_radius * scale,
    }
}

/// A box's corners in another space.
fn corners(matrix: &DMat4, half_extent: DVec3) -> [DVec3; 8] {
    std::array::from_fn(|corner| {
        let sign = |bit: usize| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
        matrix.transform_point3(half_extent * DVec3::new(sign(0), sign(1), sign(2)))
    })
}

/// The placed hairs as lights see them, in *anchored* space: world space with the middle of all hair as its origin. What is
/// found there is the same, bit for bit, from wherever the hair is viewed.
struct Anchored {
    /// In world space.
    origin: DVec3,
    from_points: Vec<DMat4>,
    corners: Vec<[DVec3; 8]>,
}

impl Anchored {
    fn new(placed: &[Placed]) -> Self {
        let in_world = placed
            .iter()
            .flat_map(|hair| corners(&hair.world_from_points, hair.half_extent));
        let (low, high) = in_world
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
                (low.min(p), high.max(p))
            });
        let origin = if placed.is_empty() {
            DVec3::ZERO
        } else {
            0.5 * (low + high)
        };
        let from_points: Vec<DMat4> = placed
            .iter()
            .map(|hair| DMat4::from_translation(-origin) * hair.world_from_points)
            .collect();
        Self {
            origin,
            corners: from_points
                .iter()
                .zip(placed)
                .map(|(matrix, hair)| corners(matrix, hair.half_extent))
                .collect(),
            from_points,
        }
    }
}

fn matrix(m: DMat4) -> [[f32; 4]; 4] {
    m.as_mat4().to_cols_array_2d()
}

fn vector(v: DVec4) -> [f32; 4] {
    v.as_vec4().into()
}

impl Plan {
    /// The viewport is the target's. Without a target, its corner, occluders and shadow images are left out.
    pub fn new(
        gpu: &Gpu,
        frame: &Frame,
        viewport: &Viewport,
        target: Option<&Target>,
    ) -> Result<Self> {
        frame.view.validate()?;
        if frame.lights.len() > MAX_LIGHTS {
            return invalid!(
                "{} lights: a frame takes at most {MAX_LIGHTS}",
                frame.lights.len()
            );
        }
        if !frame.ambient.is_finite() || frame.ambient.min_element() < 0.0 {
            let Vec3 { x, y, z } = frame.ambient;
            return invalid!(
                "ambient ({x}, {y}, {z}) has a component that is negative or not finite"
            );
        }
        frame
            .lights
            .iter()
            .enumerate()
            .try_for_each(|(number, light)| light.validate(number))?;
        frame
            .hairs
            .iter()
            .enumerate()
            .try_for_each(|(number, hair)| hair.validate(number))?;
        let occluded_by = target.map_or(&[][..], |target| target.occluders);
        occluder::validate(occluded_by, frame.lights.len())?;
        let lights = frame.lights.len();
        let unlit = |shadow: &ShadowImage| shadow.light >= lights;
        let shadow_images = target.map_or(&[][..], |target| target.shadow_images);
        if let Some(number) = shadow_images.iter().position(unlit) {
            return invalid!(
                "shadow image {number}: light {} of a frame of {lights} lights",
                shadow_images[number].light
            );
        }
        let transparency = choose_transparency(frame)?;
        transparency.validate()?;
        transparency.fits(gpu)?;
        let mut shader = one_shader(frame)?;
        shader.occluded = !occluded_by.is_empty();
        if shader.occluded && shader.rate == ShadingRate::Fragment {
            return Err(Error::Conflict(
                "occluders shadow hair that is shaded at points; hair 0 has the shading rate Fragment".into(),
            ));
        }
        if shader.rate == ShadingRate::Fragment && !transparency.shades_fragments() {
            return Err(Error::Conflict(format!(
                "the shading rate {:?} and the transparency {}, which takes {:?} alone",
                shader.rate,
                transparency.stem(),
                ShadingRate::Point
            )));
        }

        let Viewport { width, height, .. } = *viewport;
        let [left, top, ..] = target.map_or([0; 4], Target::area);
        let origin = frame.view.origin();
        let placed: Vec<Placed> = frame
            .hairs
            .iter()
            .enumerate()
            .flat_map(|(number, hair)| place_all(number, hair, origin))
            .collect();
        let (runs, point_count) = plan_runs(frame, &placed, shader.rate, gpu)?;
        let clip_from_relative = frame.view.clip_y_up_from_view()
            * frame.view.view_from_world
            * DMat4::from_translation(origin);
        let eye = frame.view.eye();
        let eye_relative = if eye.w > 0.0 {
            (eye.truncate() - origin).extend(1.0)
        } else {
            eye
        };
        let seen = view_size(&clip_from_relative, &placed, frame, width, height);
        let reverse_z = frame.view.reverse_z;
        let boxes = placed.iter().map(|hair| {
            // What the host moves on the GPU may leave its box: twice the box is room enough.
            let moved = frame.hairs[hair.hair].geometry.gathered;
            let half_extent = hair.half_extent * if moved { 2.0 } else { 1.0 };
            corners(&hair.relative_from_object, half_extent)
        });
        let keys = key_range(&clip_from_relative, boxes, reverse_z);
        let perspective = clip_from_relative.row(3).truncate().length() > 1e-12;
        let word = Word::new(keys, perspective && !reverse_z, point_count);

        let mut flags = 0;
        if frame.view.reverse_z {
            flags |= layout::FRAME_REVERSE_Z;
        }
        let sought = if transparency.seeks_nearest() {
            Sought::by(viewport)
        } else {
            Sought::default()
        };
        if sought.depth {
            flags |= layout::FRAME_NEAREST;
        }

        let mut cuts = false;
        let mut expected_fragments = seen.fragments;
        if let Transparency::DbkBuffer(settings) = transparency {
            let segments = runs.iter().map(|run| u64::from(run.run.segments)).sum();
            let cut_depth = f64::from(settings.cut_depth());
            let pays = seen.culling_pays(cut_depth, segments);
            cuts = settings.cuts(seen.fragments, most_fragments(gpu), pays);
            if cuts && settings.depth_shift.is_none() {
                expected_fragments = seen.kept(cut_depth);
            }
        }

        let largest = runs.iter().map(|run| run.run.count).max().unwrap_or(0);
        let (_, rows) = spread_workgroups(largest);
        let mut plan = Self {
            width,
            height,
            serials: runs
                .iter()
                .flat_map(|run| {
                    let geometry = &frame.hairs[run.hair].geometry;
                    [geometry.serial, u64::from(geometry.previous().is_some())]
                })
                .collect(),
            contents: runs
                .iter()
                .map(|run| frame.hairs[run.hair].geometry.content)
                .collect(),
            landed: frame.hairs.iter().all(|hair| hair.geometry.landed()),
            maps: Vec::new(),
            bands: Vec::new(),
            transparency,
            rasteriser: transparency.raster().choose(seen.half_width_px),
            splits: seen.splits(),
            point_count,
            map_words: 0,
            expected_fragments: expected_fragments as u64,
            uniforms: Vec::new(),
            strands: placed
                .iter()
                .map(|placed| frame.hairs[placed.hair].geometry.strand_count)
                .sum(),
            segments: placed
                .iter()
                .map(|placed| frame.hairs[placed.hair].geometry.segment_count)
                .sum(),
            shader,
            transmissions: transmissions(frame, &placed, origin, eye_relative),
            shadings: frame.hairs.iter().map(|hair| hair.shading).collect(),
            materials: Vec::new(),
            shadow: Shadow::None,
            shadows_only: viewport.shadows_only,
            reverse_z: frame.view.reverse_z,
            host_depth: viewport.depth,
            sought,
            sorting: Sorting::default(),
            sort: false,
            crosses: crosses(
                &clip_from_relative,
                frame.view.reverse_z,
                frame.hairs,
                placed.iter().map(|placed| (placed.hair, &placed.corners)),
            ),
            cuts,
            tracked: viewport.tracked(),
            origin: [left, top],
            frame_uniform: layout::Frame {
                ambient: frame.ambient.into(),
                light_count: frame.lights.len() as u32,
                eye: vector(eye_relative),
                relative_from_clip: matrix(clip_from_relative.inverse()),
                width,
                height,
                capacity: 0,
                flags,
                tail_scale: tail_scale(frame, &placed, origin),
                run_points: largest,
                run_rows: rows,
                unseen: transparency.unseen(),
                origin: [left, top],
                key_first: word.key_first,
                word_bits: word.bits,
                cut_depth: transparency.cut_depth(),
                depth_shift: transparency.depth_shift(),
                fibre_runs: (point_count * FIBRE_POINT_VECTORS) as u32,
                seed: transparency.seed(),
                place_of_depth: place_of_depth(&clip_from_relative, &placed, frame.view.reverse_z),
                technique: transparency.values(),
                occluder_count: occluded_by.len() as u32,
                padding_0: 0,
                padding_1: 0,
                padding_2: 0,
                lights: bytemuck::Zeroable::zeroed(),
                shadow_views: bytemuck::Zeroable::zeroed(),
                occluders: occluders(occluded_by, origin),
            },
            runs,
        };
        plan.uniforms.resize(
            std::mem::size_of::<layout::Frame>().next_multiple_of(UNIFORM_STRIDE as usize),
            0,
        );
        let materials: Vec<u32> = frame
            .hairs
            .iter()
            .map(|hair| plan.uniform(&hair.shading.material()))
            .collect();
        for run in &mut plan.runs {
            run.material = materials[run.hair];
        }
        plan.materials = materials;
        if let Transparency::SortedBlending(settings) = &plan.transparency {
            let runs = plan
                .runs
                .iter()
                .map(|run| [run.run.count, run.run.segments].map(u64::from));
            plan.sorting = Sorting::new(settings, runs, point_count, gpu.max_binding())?;
            plan.frame_uniform.technique = plan.sorting.values(settings.order);
        }
        plan.add_lights(frame, &placed, origin, gpu)?;
        plan.add_bands(frame, &placed, &clip_from_relative, eye_relative, gpu);
        Ok(plan)
    }

    /// What the technique and the frame ask of the pixels' buffers for `pixels` pixels.
    pub fn needs(&self, pixels: u64) -> Needs {
        let mut needs = self.transparency.needs(pixels);
        if self.sought.depth {
            needs.fill = needs.fill.max(pixels * 4);
        }
        if self.sought.segment {
            needs.links = needs.links.max(pixels * 4);
        }
        needs
    }

    /// Tiles of the view that know the host's farthest depth.
    pub fn tile_count(&self) -> u32 {
        self.width.div_ceil(layout::HOST_TILE) * self.height.div_ceil(layout::HOST_TILE)
    }

    /// Bytes of what shading at fragments reads of points and runs.
    pub fn fibre_point_bytes(&self) -> u64 {
        fibre_point_bytes(self.point_count, self.runs.len())
    }

    /// Appends a uniform block; its offset.
    fn uniform<T: bytemuck::Pod>(&mut self, value: &T) -> u32 {
        let offset = self.uniforms.len();
        self.uniforms.extend_from_slice(bytemuck::bytes_of(value));
        self.uniforms.resize(
            self.uniforms
                .len()
                .next_multiple_of(UNIFORM_STRIDE as usize),
            0,
        );
        offset as u32
    }

    /// The shader of one hair by itself.
    pub fn shader_of(&self, hair: usize) -> Shader {
        Shader {
            shadow: self.shader.shadow,
            occluded: self.shader.occluded,
            transmits: self.shader.transmits,
            ..Shader::of(&self.shadings[hair], self.shader.rate)
        }
    }

    /// Writes where a hair's model has its tables, and its settings.
    pub fn set_tables(&mut self, hair: usize, place: crate::shading::tables::Place) {
        let [angles, azimuthal, size] = place;
        let settings = self.shadings[hair].settings(self.shader.rate);
        let words = [angles, azimuthal, size, settings];
        let at = self.materials[hair] as usize + std::mem::offset_of!(layout::Material, values);
        let last = at + 15 * size_of::<[f32; 4]>();
        self.uniforms[last..last + size_of_val(&words)]
            .copy_from_slice(bytemuck::cast_slice(&words));
    }

    /// Leaves the TT lobe out where its bound is within every hair's tolerance.
    pub fn leave_out_transmission(&mut self, bounds: &mut transmission::Bounds) {
        let mut sum = (0, 0.0f32);
        let mut small = !self.transmissions.is_empty();
        for lit in &self.transmissions {
            let Some((lobe, tolerance)) = self.shadings[lit.hair].transmission() else {
                return;
            };
            if sum.0 != lit.placed {
                sum = (lit.placed, 0.0);
            }
            sum.1 += lit.power * transmission::look_up(bounds.of(&lobe), lit.angle);
            small &= sum.1 <= tolerance;
        }
        self.shader.transmits = !small;
    }

    /// Writes the frame's own block, when everything in it is known.
    pub fn seal(&mut self, capacity: u64) {
        self.frame_uniform.capacity = capacity as u32;
        let size = std::mem::size_of::<layout::Frame>();
        self.uniforms[..size].copy_from_slice(bytemuck::bytes_of(&self.frame_uniform));
    }

    /// One drawing of the view a run, alike but for the hair.
    fn drawings(&mut self, frame: &Frame, placed: &[Placed], common: &layout::Drawing) -> Vec<u32> {
        let clip_from_world = |view: &View| view.clip_y_up_from_view() * view.view_from_world;
        let now = clip_from_world(&frame.view);
        let before = clip_from_world(&frame.view.before());
        (0..self.runs.len())
            .map(|number| {
                let run = self.runs[number];
                let hair = &placed[run.placed];
                self.uniform(&layout::Drawing {
                    clip_from_object: matrix(now * hair.world_from_points),
                    previous_clip_from_object: matrix(before * hair.previous_world_from_points),
                    hair: hair.hair as u32 | (hair.instance as u32) << 16,
                    fibre_run: self.frame_uniform.fibre_runs
                        + number as u32 * FIBRE_RUN_VECTORS as u32,
                    fibre_run_number: number as u32,
                    largest_radius: hair.radius as f32,
                    relative_from_object: matrix(hair.relative_from_object),
                    radius_scale: hair.scale as f32,
                    opacity: frame.hairs[run.hair].opacity,
                    point_count: run.run.count,
                    point_base: run.base,
                    chunk_base: self.sorting.bases.get(number).copied().unwrap_or(0),
                    ..*common
                })
            })
            .collect()
    }

    /// One drawing of a map a run. Nothing in it depends on the view, so that later frames can tell the map by it.
    fn map_drawings(
        &mut self,
        frame: &Frame,
        placed: &[Placed],
        anchored: &Anchored,
        common: &layout::Drawing,
    ) -> Vec<u32> {
        (0..self.runs.len())
            .map(|number| {
                let run = self.runs[number];
                self.uniform(&layout::Drawing {
                    relative_from_object: matrix(anchored.from_points[run.placed]),
                    radius_scale: placed[run.placed].scale as f32,
                    opacity: frame.hairs[run.hair].opacity,
                    point_count: run.run.count,
                    point_base: run.base,
                    ..*common
                })
            })
            .collect()
    }

    /// The uniform blocks of a map's drawings.
    pub fn map_blocks(&self, map: &PlannedMap) -> &[u8] {
        let [Some(first), Some(last)] = [map.drawings.first(), map.drawings.last()] else {
            return &[];
        };
        &self.uniforms[*first as usize..*last as usize + size_of::<layout::Drawing>()]
    }

    /// The lights with their maps.
    fn add_lights(
        &mut self,
        frame: &Frame,
        placed: &[Placed],
        origin: DVec3,
        gpu: &Gpu,
    ) -> Result<()> {
        let anchored = Anchored::new(placed);
        let corners: Vec<DVec3> = anchored.corners.iter().flatten().copied().collect();
        let radius = placed.iter().fold(0.0f64, |a, hair| a.max(hair.radius));
        for (number, light) in frame.lights.iter().enumerate() {
            let emitter = light.kind.emitter(origin);
            let uniform = &mut self.frame_uniform.lights[number];
            uniform.place = vector(emitter.place);
            uniform.power = emitter.power.into();
            uniform.axis = emitter.axis.as_vec3().into();
            uniform.cos_outer = emitter.cosines[0] as f32;
            uniform.edge = 1.0 / (emitter.cosines[1] - emitter.cosines[0]).max(1e-6) as f32;
            let technique = choose_shadow(frame, number)?;
            if corners.is_empty() || self.runs.is_empty() {
                continue;
            }
            let cameras = light_cameras(&light.kind.emitter(anchored.origin), &corners, radius);
            let fibres = fibres(frame, placed, technique.needs_density());
            let sight = Sight::new(&cameras, radius, fibres);
            let Some(shape) = technique.shape(&sight) else {
                continue;
            };
            if self.shadow != Shadow::None && self.shadow.stem() != technique.stem() {
                return Err(Error::Conflict(format!(
                    "light {number} has the shadow {} and one before it {}; a frame takes one technique",
                    technique.stem(),
                    self.shadow.stem()
                )));
            }
            if !self.shadow.colours() {
                self.shadow = technique;
                self.shader.shadow = technique.look_up();
            }
            let first = self.maps.len();
            if first + cameras.views.len() > MAX_SHADOW_VIEWS {
                return Err(Error::Unsupported(format!(
                    "light {number}: a frame takes at most {MAX_SHADOW_VIEWS} shadow maps"
                )));
            }
            *uniform = layout::Light {
                map_count: cameras.views.len() as u32,
                map_first: first as u32,
                resolution: shape.resolution,
                pcf: shape.pcf,
                layer_count: shape.layers,
                bias: shape.bias as f32,
                ..*uniform
            };
            let half_width = sight.half_width(shape.resolution);
            for camera in cameras.views {
                let map = Map {
                    technique,
                    shape,
                    camera,
                    half_width,
                };
                self.add_map(frame, placed, &anchored, &map, gpu)?;
            }
        }
        Ok(())
    }

    fn add_map(
        &mut self,
        frame: &Frame,
        placed: &[Placed],
        anchored: &Anchored,
        map: &Map,
        gpu: &Gpu,
    ) -> Result<()> {
        let Map {
            technique,
            shape,
            ref camera,
            half_width,
        } = *map;
        let front_base = self.map_words;
        let layer_base = front_base + shape.fronts();
        self.map_words = layer_base + u64::from(shape.resolution).pow(2) * u64::from(shape.layers);
        if self.map_words * 4 > gpu.max_binding() {
            return Err(Error::Unsupported(format!(
                "the shadow maps of this frame take {} bytes; this device binds {}",
                self.map_words * 4,
                gpu.max_binding()
            )));
        }
        let anchored_from_relative = DMat4::from_translation(frame.view.origin() - anchored.origin);
        self.frame_uniform.shadow_views[self.maps.len()] = layout::ShadowView {
            clip_from_relative: matrix(camera.clip_from_anchored * anchored_from_relative),
            depth_row: vector(anchored_from_relative.transpose() * camera.depth_row),
            front_base: front_base as u32,
            layer_base: layer_base as u32,
            padding_0: 0,
            padding_1: 0,
            values: shape.values,
            colour: shape.colour,
        };
        let seen = Seen {
            image_px: f64::from(shape.resolution).powi(2),
            half_width_px: half_width,
            length_px: f64::from(shape.resolution),
            fragments: 0.0,
            depth: 0.0,
            each: Vec::new(),
            bounds: [0.0; 4],
        };
        let drawings = self.map_drawings(
            frame,
            placed,
            anchored,
            &layout::Drawing {
                clip_from_relative: matrix(camera.clip_from_anchored),
                eye: vector(camera.eye),
                depth_row: vector(camera.depth_row),
                viewport: [shape.resolution as f32; 2],
                splits: seen.splits(),
                front_base: front_base as u32,
                layer_base: layer_base as u32,
                layer_count: shape.layers,
                row_end: shape.resolution,
                map_values: shape.values,
                map_colour: shape.colour,
                ..bytemuck::Zeroable::zeroed()
            },
        );
        self.maps.push(PlannedMap {
            crosses: crosses(
                &camera.clip_from_anchored,
                false,
                frame.hairs,
                placed
                    .iter()
                    .map(|placed| placed.hair)
                    .zip(&anchored.corners),
            ),
            technique,
            shape,
            rasteriser: shape.raster.choose(half_width),
            drawings,
            splits: seen.splits(),
            words: front_base..self.map_words,
            filled: true,
        });
        Ok(())
    }

    /// The view, in bands of rows.
    fn add_bands(
        &mut self,
        frame: &Frame,
        placed: &[Placed],
        clip_from_relative: &DMat4,
        eye: DVec4,
        gpu: &Gpu,
    ) {
        let most = Needs::most_pixels(|pixels| self.needs(pixels), gpu.max_binding());
        let rows = (most / u64::from(self.width)).clamp(1, u64::from(self.height)) as u32;
        let mut flags = layout::DRAWING_DEPTH_OVER_W;
        flags |= if frame.view.reverse_z {
            layout::DRAWING_REVERSE_Z
        } else {
            0
        };
        flags |= if self.host_depth {
            layout::DRAWING_HOST_DEPTH
        } else {
            0
        };
        let previous = frame.view.before();
        let jitter = |axis: usize| frame.view.jitter[axis] - previous.jitter[axis];
        for (number, first) in (0..self.height).step_by(rows as usize).enumerate() {
            let rows = rows.min(self.height - first);
            let common = layout::Drawing {
                clip_from_relative: matrix(*clip_from_relative),
                eye: vector(eye),
                depth_row: vector(clip_from_relative.row(2)),
                viewport: [self.width as f32, self.height as f32],
                flags,
                splits: self.splits,
                row_first: first,
                row_end: first + rows,
                jitter_motion: [jitter(0), jitter(1)],
                ..bytemuck::Zeroable::zeroed()
            };
            let drawings = self.drawings(frame, placed, &common);
            let whole = if self.sorting.bins > 0 {
                self.uniform(&layout::Drawing {
                    opacity: 1.0,
                    point_count: self.point_count as u32,
                    ..common
                })
            } else {
                0
            };
            self.bands.push(Band {
                number: number as u32,
                first,
                rows,
                drawings,
                whole,
            });
        }
    }
}

/// Rounding of a point's distance from the near plane, as part of its clip coordinates, many times over.
const NEAR_PLANE_ROUNDING: f64 = 1e-4;

/// Whether the near plane may cross the hair's boxes: their hairs and corners. What the GPU moves may be anywhere.
fn crosses<'a>(
    clip_from_space: &DMat4,
    reverse_z: bool,
    hairs: &[&Hair],
    mut boxes: impl Iterator<Item = (usize, &'a [DVec3; 8])>,
) -> bool {
    let behind = |corner: &DVec3| {
        let clip = *clip_from_space * corner.extend(1.0);
        let distance = if reverse_z { clip.w - clip.z } else { clip.z };
        distance < NEAR_PLANE_ROUNDING * clip.w.abs().max(clip.z.abs())
    };
    boxes.any(|(hair, corners)| hairs[hair].geometry.gathered || corners.iter().any(behind))
}

/// One light as one placed hair is lit by it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Transmission {
    pub placed: usize,
    pub hair: usize,
    /// The greatest angle between the ways to the light and to the eye, over the whole hair.
    pub angle: f64,
    /// The greatest irradiance times the strands' own colour, over the whole hair and all channels.
    pub power: f32,
}

/// Every light on every placed hair; none where a hair's model keeps all its lobes.
fn transmissions(frame: &Frame, placed: &[Placed], origin: DVec3, eye: DVec4) -> Vec<Transmission> {
    let optional = |hair: &&Hair| hair.shading.transmission().is_some();
    if frame.hairs.is_empty() || !frame.hairs.iter().all(optional) {
        return Vec::new();
    }
    let lit = |(number, placed): (usize, &Placed)| {
        let centre = placed.corners.iter().sum::<DVec3>() / 8.0;
        let radius = placed
            .corners
            .iter()
            .fold(0.0f64, |most, corner| most.max(corner.distance(centre)));
        let hair = placed.hair;
        let colour = frame.hairs[hair].geometry.brightest;
        frame.lights.iter().map(move |light| {
            // Of a spot as if it shone in all directions.
            let emitter = light.kind.emitter(origin);
            let brightest = emitter.power.max_element();
            let irradiance = if emitter.place.w == 0.0 {
                brightest
            } else {
                let near = (emitter.place.truncate().distance(centre) - radius).max(1e-30);
                (f64::from(brightest) / (near * near)) as f32
            };
            Transmission {
                placed: number,
                hair,
                angle: greatest_angle(centre, radius, emitter.place, eye),
                power: irradiance * colour,
            }
        })
    };
    placed.iter().enumerate().flat_map(lit).collect()
}

/// Bytes of the points and of the runs as shading at fragments reads them.
fn fibre_point_bytes(points: u64, runs: usize) -> u64 {
    (points * FIBRE_POINT_VECTORS + runs as u64 * FIBRE_RUN_VECTORS) * 16
}

/// Runs of a frame whose fragments are shaded at most: what 16 bits count.
const MAX_FIBRE_RUNS: usize = 1 << 16;

/// The runs of all hairs, with their places in the pools.
fn plan_runs(
    frame: &Frame,
    placed: &[Placed],
    rate: ShadingRate,
    gpu: &Gpu,
) -> Result<(Vec<PlannedRun>, u64)> {
    let mut runs = Vec::new();
    let mut base = 0u64;
    for (number, placed) in placed.iter().enumerate() {
        for run in &frame.hairs[placed.hair].geometry.runs {
            runs.push(PlannedRun {
                hair: placed.hair,
                placed: number,
                run: *run,
                base: base as u32,
                material: 0,
            });
            base += u64::from(run.count).next_multiple_of(64);
        }
    }
    let most = MAX_FRAME_POINTS.min(gpu.max_binding() / 8);
    if base > most {
        return Err(Error::Unsupported(format!(
            "the frame's hairs have {base} points; this device takes {most}"
        )));
    }
    if rate == ShadingRate::Fragment {
        if runs.len() > MAX_FIBRE_RUNS {
            return Err(Error::Unsupported(format!(
                "{} instances: a frame that is shaded per fragment takes {MAX_FIBRE_RUNS}",
                runs.len()
            )));
        }
        let bytes = fibre_point_bytes(base, runs.len());
        if bytes > gpu.max_binding() {
            return Err(Error::Unsupported(format!(
                "shading per fragment takes {bytes} bytes for the frame's {base} points; this device binds {}",
                gpu.max_binding()
            )));
        }
    }
    Ok((runs, base))
}

/// The host's shadow maps, with positions relative to an origin.
fn occluders(given: &[Occluder], origin: DVec3) -> [layout::Occluder; MAX_OCCLUDERS] {
    let mut uniforms = [bytemuck::Zeroable::zeroed(); MAX_OCCLUDERS];
    for (uniform, occluder) in uniforms.iter_mut().zip(given) {
        *uniform = occluder.uniform(origin);
    }
    uniforms
}

/// The first map of a light: its camera, the origin of anchored space, the hair's depth range, and what it is made of.
pub(crate) fn first_map(frame: &Frame, number: usize) -> Option<(LightCamera, DVec3, f64, Shape)> {
    let hairs = frame.hairs.iter().enumerate();
    let placed: Vec<Placed> = hairs
        .flat_map(|(number, hair)| place_all(number, hair, DVec3::ZERO))
        .collect();
    let Anchored {
        origin, corners, ..
    } = Anchored::new(&placed);
    let corners: Vec<DVec3> = corners.into_iter().flatten().collect();
    let radius = placed.iter().fold(0.0f64, |a, hair| a.max(hair.radius));
    let emitter = frame.lights[number].kind.emitter(origin);
    let mut cameras = light_cameras(&emitter, &corners, radius);
    let technique = choose_shadow(frame, number).ok()?;
    let fibres = fibres(frame, &placed, technique.needs_density());
    let shape = technique.shape(&Sight::new(&cameras, radius, fibres))?;
    Some((cameras.views.swap_remove(0), origin, cameras.extent, shape))
}

/// The fibres of all hairs; how densely they fill space only where that is asked for.
fn fibres(frame: &Frame, placed: &[Placed], with_density: bool) -> Fibres {
    let mut fibres = Fibres::default();
    let (mut areas, mut volumes) = (0.0, 0.0);
    for placed in placed {
        let hair = frame.hairs[placed.hair];
        let opacity = f64::from(hair.opacity);
        let length = hair.geometry.length * placed.scale;
        let mut diameter = 2.0 * placed.radius;
        if with_density {
            let density = hair.geometry.density();
            diameter = density.diameter * placed.scale;
            volumes += density.volume * placed.scale.powi(3);
        }
        areas += length * diameter;
        fibres.opacity += opacity * length * diameter;
    }
    let over = |sum: f64, by: f64| if by > 0.0 { sum / by } else { 0.0 };
    Fibres {
        opacity: over(fibres.opacity, areas),
        area_density: over(areas, volumes),
    }
}

/// Steps a unit of radiance of the tail's fixed-point colours: 2¹⁶ for the brightest that the lights should make.
fn tail_scale(frame: &Frame, placed: &[Placed], origin: DVec3) -> f32 {
    let mut power = f64::from(frame.ambient.max_element()) * 12.0;
    for light in frame.lights {
        power += match light.kind {
            LightKind::Directional { irradiance, .. } => f64::from(irradiance.max_element()),
            LightKind::Point {
                position,
                intensity,
            }
            | LightKind::Spot {
                position,
                intensity,
                ..
            } => {
                let nearest = placed
                    .iter()
                    .flat_map(|hair| hair.corners)
                    .map(|p| p.distance(position - origin));
                let diagonal = placed
                    .iter()
                    .map(|hair| hair.corners[0].distance(hair.corners[7]))
                    .fold(0.0, f64::max);
                let distance = nearest.fold(f64::INFINITY, f64::min).max(0.05 * diagonal);
                f64::from(intensity.max_element()) / (distance * distance).max(1e-20)
            }
        };
    }
    let brightest = frame
        .hairs
        .iter()
        .map(|hair| hair.shading.brightest())
        .fold(0.0f32, f32::max);
    let radiance = (f64::from(brightest) * power).clamp(1e-6, 1e6);
    (65536.0 / radiance) as f32
}
