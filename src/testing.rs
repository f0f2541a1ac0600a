//! What this crate's own tests ask that no host needs to: joined shader modules, and the structs shared with them. Not
//! part of the API.
#![allow(missing_docs)]

use std::mem::offset_of;

use crate::Renderer;
use crate::composite;
use crate::geometry::Projection;
use crate::gpu::GUARD;
use crate::layout;
use crate::shader::{Constant, FILES, Module};
use crate::shading::{
    Chiang, DualScattering, KajiyaKay, Marschner, Precision, Roots, RoughnessVariation, Sadeghi,
    Scheuermann, Shader, Shading, ShadingRate, Tables, evaluator, gather_module, tables,
    transmission,
};
use crate::shadow::{
    ApproximatedDeepShadowMap, DeepOpacityMap, KBufferVolume, MomentOpacityMap, OpacityShadowMaps,
    Shadow, ShadowMap, approximated_deep_shadow_map, deep_opacity_map, k_buffer_volume,
    moment_opacity_map, opacity_shadow_maps, shadow_map,
};
use crate::transparency::{
    ABuffer, DbkBuffer, DepthPeeling, KBuffer, KBufferSinglePass, KPlusBuffer, Moment, Opaque,
    RandomSubsets, Rest, Selection, SortedBlending, Storage, Transparency, WeightedBlended,
    a_buffer, dbk_buffer, depth_peeling, moment, nearest, opaque, random_subsets, resolve_module,
    sorted_blending, weighted_blended,
};

/// Bytes of a guard: as many as a workgroup of a loop that went one element too far would write.
const GUARD_BYTES: u64 = 4096;

/// Puts a guard behind every buffer that the renderer makes from now on, and has it make the pixels' buffers anew.
pub fn guard(renderer: &mut Renderer) {
    let (gpu, resources) = renderer.parts();
    gpu.guard = GUARD_BYTES;
    resources.drop_pixels(gpu).unwrap();
}

/// Writes one word behind the first of the pixels' buffers, as a shader might.
pub fn break_guard(renderer: &mut Renderer) {
    let (gpu, resources) = renderer.parts();
    let fill = resources.emitted()[1];
    gpu.queue.write_buffer(&fill.buffer, fill.size(), &[0; 4]);
}

/// How many of the buffers that emissions write are guarded, and the labels of those whose guard has been written to. Waits
/// for the GPU.
pub fn guards(renderer: &mut Renderer) -> (usize, Vec<&'static str>) {
    let (gpu, resources) = renderer.parts();
    let (mut count, mut broken) = (0, Vec::new());
    for held in resources.emitted() {
        if held.buffer.size() == held.size() {
            continue;
        }
        count += 1;
        let copy = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("pelage.testing.guard"),
            size: GUARD_BYTES,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&held.buffer, held.size(), &copy, 0, Some(GUARD_BYTES));
        gpu.queue.submit([encoder.finish()]);
        copy.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
        gpu.device
            .poll(wgpu::PollType::wait_indefinitely())
            .unwrap();
        let bytes = copy.get_mapped_range(..).unwrap();
        if bytes.iter().any(|byte| *byte != GUARD) {
            broken.push(held.label());
        }
    }
    (count, broken)
}

/// A module that the crate can build.
pub struct Combination {
    pub name: String,
    pub source: String,
    pub files: Vec<&'static str>,
}

/// Every shading model, with its defaults.
pub fn models() -> [Shading; 5] {
    [
        Shading::KajiyaKay(KajiyaKay::default()),
        Shading::Scheuermann(Scheuermann::default()),
        Shading::Marschner(Marschner::default()),
        Shading::Sadeghi(Sadeghi::default()),
        Shading::Chiang(Chiang::default()),
    ]
}

/// Every shadow technique, with its defaults.
pub fn shadows() -> [Shadow; 7] {
    [
        Shadow::None,
        Shadow::DeepOpacityMap(DeepOpacityMap::default()),
        Shadow::ShadowMap(ShadowMap::default()),
        Shadow::ApproximatedDeepShadowMap(ApproximatedDeepShadowMap::default()),
        Shadow::OpacityShadowMaps(OpacityShadowMaps::default()),
        Shadow::MomentOpacityMap(MomentOpacityMap::default()),
        Shadow::KBufferVolume(KBufferVolume::default()),
    ]
}

/// Every look-up: of coloured light, too.
fn look_ups() -> Vec<Shadow> {
    let transmitted = glam::Vec3::splat(0.5);
    let mut shadows = shadows().to_vec();
    shadows.push(Shadow::DeepOpacityMap(DeepOpacityMap {
        transmitted,
        ..DeepOpacityMap::default()
    }));
    shadows.push(Shadow::MomentOpacityMap(MomentOpacityMap {
        transmitted,
        ..MomentOpacityMap::default()
    }));
    shadows
}

/// A light's first map.
pub struct LightMap {
    pub clip_from_world: glam::DMat4,
    /// Depth along the map's axis = dot(depth_row, (position, 1)), in world space.
    pub depth_row: glam::DVec4,
    /// Depth range of the hair.
    pub extent: f64,
    /// How much nearer to the light than it is a point is taken to be.
    pub bias: f64,
    /// The technique's values.
    pub values: [f32; 4],
}

/// How a light of a frame sees the hair; `None` without a map.
pub fn light_map(frame: &crate::Frame, light: usize) -> Option<LightMap> {
    let (camera, origin, extent, shape) = crate::plan::first_map(frame, light)?;
    let row = camera.depth_row;
    Some(LightMap {
        clip_from_world: camera.clip_from_anchored * glam::DMat4::from_translation(-origin),
        depth_row: row.truncate().extend(row.w - row.truncate().dot(origin)),
        extent,
        bias: shape.bias,
        values: shape.values,
    })
}

/// Every model with each of its settings that has shaders of its own.
fn variants() -> Vec<Shading> {
    let mut variants = models().to_vec();
    let dual_scattering = Some(DualScattering::default());
    let marschner = Marschner {
        dual_scattering,
        tables: None,
        ..Marschner::default()
    };
    for roots in [Roots::Exact, Roots::Cubic] {
        for eccentricity in [1.0, 0.9] {
            variants.push(Shading::Marschner(Marschner {
                roots,
                eccentricity,
                ..marschner
            }));
        }
    }
    variants.push(Shading::Sadeghi(Sadeghi {
        dual_scattering,
        ..Sadeghi::default()
    }));
    for precision in [None, Some(Precision::F32), Some(Precision::F16)] {
        variants.push(Shading::Chiang(Chiang {
            dual_scattering,
            tables: precision.map(|precision| Tables {
                precision,
                ..Tables::default()
            }),
            ..Chiang::default()
        }));
    }
    let roughness = RoughnessVariation {
        strand: 0.5,
        tip: 1.0,
    };
    variants.push(Shading::Marschner(Marschner {
        roughness,
        ..Marschner::default()
    }));
    variants.push(Shading::Sadeghi(Sadeghi {
        roughness,
        ..Sadeghi::default()
    }));
    variants.push(Shading::Chiang(Chiang {
        roughness,
        near_field: true,
        ..Chiang::default()
    }));
    variants
}

/// The shaders of all these, those without TT, and those of hairs that differ in their settings.
fn shaders() -> Vec<Shader> {
    let of = |shading: &Shading| Shader::of(shading, ShadingRate::Fragment);
    let mut shaders: Vec<Shader> = variants().iter().map(of).collect();
    for model in models() {
        shaders.push(Shader {
            transmits: false,
            ..of(&model)
        });
        shaders.push(Shader {
            varies: true,
            settings: None,
            ..of(&model)
        });
    }
    shaders
}

/// What tells the shaders of one model apart.
fn detail(shader: &Shader) -> String {
    let settings = shader
        .settings
        .map_or("of each hair".into(), |bits| format!("{bits:b}"));
    let Shader {
        varies, transmits, ..
    } = shader;
    format!("settings {settings}, varies {varies}, transmits {transmits}")
}

/// A shading model's functions, without what calls them; `shading_tables` is to be declared by the caller.
pub fn shading_source(shading: &Shading) -> String {
    Shader::of(shading, ShadingRate::Fragment)
        .functions()
        .join()
        .source
}

/// The tables of one model as a frame would place them: the place, the words that the host writes, and how many there are.
pub fn tables_of(shading: &Shading, ambient: bool) -> ([u32; 3], Vec<f32>, u64) {
    let (places, words, size) = tables::lay_out(&[*shading], ambient);
    (places[0], words, size)
}

/// The bound of a model's TT lobe with no light further from the eye's direction than this; `None` where it is never left out.
pub fn transmission_bound(shading: &Shading, angle: f64) -> Option<f32> {
    let tolerant = match *shading {
        Shading::Marschner(model) => Shading::Marschner(Marschner {
            lobe_tolerance: 1.0,
            ..model
        }),
        Shading::Sadeghi(model) => Shading::Sadeghi(Sadeghi {
            lobe_tolerance: 1.0,
            ..model
        }),
        Shading::Chiang(model) => Shading::Chiang(Chiang {
            lobe_tolerance: 1.0,
            ..model
        }),
        other => other,
    };
    let (lobe, _) = tolerant.transmission()?;
    let bound = transmission::Bounds::default().of(&lobe).to_owned();
    Some(transmission::look_up(&bound, angle))
}

/// A shadow technique's look-up, `shadow_texel` and all beneath it, behind the common files.
pub fn shadow_source(shadow: &Shadow) -> String {
    shadow.module().join().source
}

/// Every module that the crate can build.
pub fn combinations() -> Vec<Combination> {
    let mut modules: Vec<(String, Module)> = Vec::new();
    const RESTS: [Rest; 3] = [Rest::Merged, Rest::Alpha, Rest::Dropped];
    let plus = RESTS.map(|rest| KPlusBuffer {
        rest,
        ..Default::default()
    });
    let single_pass = RESTS.map(|rest| KBufferSinglePass {
        rest,
        ..Default::default()
    });
    let kept: Vec<_> = plus
        .iter()
        .flat_map(KPlusBuffer::emissions)
        .chain(single_pass.iter().map(KBufferSinglePass::emission))
        .collect();
    let emissions = opaque::EMISSIONS
        .iter()
        .chain(&a_buffer::EMISSIONS)
        .chain(&nearest::EMISSIONS)
        .chain(&weighted_blended::EMISSIONS)
        .chain(&depth_peeling::EMISSIONS)
        .chain(&random_subsets::EMISSIONS)
        .chain(&kept)
        .chain(&moment::EMISSIONS)
        .chain(&dbk_buffer::EMISSIONS)
        .chain(&deep_opacity_map::EMISSIONS)
        .chain([
            &shadow_map::DEPTH,
            &approximated_deep_shadow_map::DEPTH,
            &opacity_shadow_maps::SLABS,
        ])
        .chain(&moment_opacity_map::EMISSIONS)
        .chain(&k_buffer_volume::EMISSIONS);
    for emission in emissions {
        for rasteriser in ["raster/walk", "raster/ribbons"] {
            for rate in [ShadingRate::Point, ShadingRate::Fragment] {
                modules.push((
                    format!(
                        "{} {} {rasteriser}, shaded by {rate:?}",
                        emission.label, emission.stage
                    ),
                    emission.module(rasteriser, rate),
                ));
            }
        }
    }
    let counted = Transparency::ABuffer(ABuffer::default());
    let lists = Transparency::ABuffer(ABuffer {
        storage: Storage::Lists,
        ..Default::default()
    });
    let by_shift = Transparency::DbkBuffer(DbkBuffer {
        depth_shift: Some(1.0),
        ..Default::default()
    });
    let mut techniques = vec![
        (
            "opaque".to_string(),
            Transparency::Opaque(Opaque::default()),
        ),
        ("moment".into(), Transparency::Moment(Moment::default())),
        (
            "weighted_blended".into(),
            Transparency::WeightedBlended(WeightedBlended::default()),
        ),
        (
            "depth_peeling".into(),
            Transparency::DepthPeeling(DepthPeeling::default()),
        ),
        (
            "random_subsets".into(),
            Transparency::RandomSubsets(RandomSubsets::default()),
        ),
        (
            "sorted_blending".into(),
            Transparency::SortedBlending(SortedBlending::default()),
        ),
        ("counted".into(), counted),
        ("lists".into(), lists),
        (
            "dbk_buffer".into(),
            Transparency::DbkBuffer(DbkBuffer::default()),
        ),
        ("dbk_buffer by a shift".into(), by_shift),
    ];
    for settings in plus {
        let name = format!("k_plus_buffer {:?}", settings.rest);
        techniques.push((name, Transparency::KPlusBuffer(settings)));
    }
    for settings in single_pass {
        let name = format!("k_buffer_single_pass {:?}", settings.rest);
        techniques.push((name, Transparency::KBufferSinglePass(settings)));
    }
    for rest in RESTS {
        for (selection, storage) in [
            (Selection::Registers, Storage::Counted),
            (Selection::Rounds, Storage::Lists),
            (Selection::Sort, Storage::Counted),
        ] {
            techniques.push((
                format!("k_buffer {rest:?} {selection:?}"),
                Transparency::KBuffer(KBuffer {
                    rest,
                    selection,
                    storage,
                    ..Default::default()
                }),
            ));
        }
    }
    for (name, technique) in &techniques {
        modules.push((
            format!("composite {name}"),
            composite::module(technique, None),
        ));
        for tracked in [false, true] {
            modules.push((
                format!("outputs {name}, tracked {tracked}"),
                resolve_module(technique, None)
                    .and(&["common/fullscreen", "outputs"])
                    .with("TRACKED", Constant::Bool(tracked)),
            ));
        }
    }
    for crosses in [false, true] {
        for view in [false, true] {
            let module = Projection { crosses, view }.module(&[]);
            modules.push((format!("project, crosses {crosses}, view {view}"), module));
        }
    }
    modules.push(("order".into(), Module::new(&["common/order"])));
    modules.push((
        "host_tiles".into(),
        Module::new(&["common/pixels", "common/host_tiles"]),
    ));
    modules.push(("dbk_buffer depths".into(), dbk_buffer::depths_module()));
    modules.push(("dbk_buffer drop".into(), dbk_buffer::drop_module()));
    modules.push(("dbk_buffer pixels".into(), dbk_buffer::pixels_module()));
    modules.push(("dbk_buffer cut".into(), dbk_buffer::cut_module()));
    for again in [false, true] {
        let module = Module::new(&["common/scan"]).with("SCAN_AGAIN", Constant::Bool(again));
        modules.push((format!("scan, again {again}"), module));
    }
    for shadow in look_ups() {
        for shader in shaders() {
            let shader = Shader {
                shadow: shadow.look_up(),
                one_material: shadow != Shadow::None && shader.settings.is_some(),
                ..shader
            };
            // Shadow techniques are the same to all shaders of a model, and so are transparency techniques.
            let usual = shader.settings.is_some() && shader.transmits && !shader.varies;
            let known = shadow == Shadow::None || shadow == Shadow::default();
            if !(usual || known) {
                continue;
            }
            let name = format!(
                "{}, {}, shadow {}, coloured {}",
                shader.label,
                detail(&shader),
                shadow.stem(),
                shadow.colours()
            );
            if shader.settings.is_some() {
                for occluded in [false, true] {
                    let module = Shader { occluded, ..shader }.points_module();
                    modules.push((format!("points {name}, occluded {occluded}"), module));
                }
            }
            for (technique_name, technique) in &techniques {
                if !technique.shades_fragments() || !(usual || *technique_name == "counted") {
                    continue;
                }
                let module = composite::module(technique, Some(&shader));
                modules.push((format!("composite {technique_name}, {name}"), module));
            }
        }
    }
    for shadow in look_ups().iter().filter(|shadow| **shadow != Shadow::None) {
        modules.push((
            format!("receive {}, coloured {}", shadow.stem(), shadow.colours()),
            composite::receive_module(shadow),
        ));
        modules.push((
            format!(
                "shadow_image {}, coloured {}",
                shadow.stem(),
                shadow.colours()
            ),
            shadow.module().and(composite::SHADOW_IMAGE),
        ));
    }
    modules.push(("fibre_points".into(), gather_module()));
    for model in variants() {
        let settings = model.settings(ShadingRate::Fragment);
        let name = format!("evaluate {}, {settings:b}", model.stem());
        modules.push((name, evaluator::module(&model)));
        if model.tables().is_some() {
            let name = format!("tables {}, {settings:b}", model.stem());
            modules.push((name, tables::module(&model)));
        }
    }
    modules.push(("track".into(), Module::new(&["common/track"])));
    for stem in [
        "gather",
        "guided",
        "guided_mesh",
        "guided_frames",
        "guided_clumps",
    ] {
        modules.push((stem.into(), Module::new(&[stem])));
    }
    for reverse in [false, true] {
        modules.push((
            format!("outputs_none {reverse}"),
            Module::new(&["common/fullscreen", "outputs_none"])
                .with("REVERSE_Z", Constant::Bool(reverse)),
        ));
    }
    for (name, files) in [
        ("deep_opacity_map prefix", deep_opacity_map::PREFIX),
        ("opacity_shadow_maps sum", opacity_shadow_maps::SUM),
        ("k_buffer_volume prefix", k_buffer_volume::PREFIX),
    ] {
        modules.push((name.into(), Module::new(files)));
    }
    modules.push((
        "shadow_image_none".into(),
        Module::new(composite::SHADOW_IMAGE_NONE),
    ));
    for number in 1..=u64::from(sorted_blending::MAX_PARTS) {
        let parts = sorted_blending::Parts::new(64 * number, 4, 64, 256);
        let modules_of = [
            ("sort", sorted_blending::sort_module(parts)),
            ("blend", sorted_blending::draw_module(parts)),
        ];
        modules.extend(modules_of.map(|(name, module)| (format!("{name} of {number}"), module)));
    }
    modules.push(("advance".into(), depth_peeling::advance_module()));
    modules.push((
        "overflow".into(),
        Module::new(&["transparency/overflow", "transparency/a_buffer_overflow"]),
    ));
    modules
        .into_iter()
        .map(|(name, module)| Combination {
            name,
            source: module.join().source,
            files: module.files.clone(),
        })
        .collect()
}

/// A module of these files, behind the common ones.
pub fn module_source(files: &[&'static str]) -> String {
    Module::new(files).join().source
}

/// Where a line of that module comes from.
pub fn module_origin(files: &[&'static str], line: usize) -> String {
    Module::new(files).join().origin(line)
}

/// Every shader file's stem.
pub fn shader_files() -> Vec<&'static str> {
    FILES.iter().map(|(stem, _)| *stem).collect()
}

/// The uniform block of a hair's shading.
pub fn material_bytes(shading: &Shading) -> Vec<u8> {
    bytemuck::bytes_of(&shading.material()).to_vec()
}

/// A struct shared with WGSL: its size, and its fields' names and offsets.
pub struct Layout {
    pub name: &'static str,
    pub size: usize,
    pub fields: Vec<(&'static str, usize)>,
}

macro_rules! layouts {
    ($($name:ident { $($field:ident),* $(,)? })*) => {
        vec![$(Layout {
            name: stringify!($name),
            size: size_of::<layout::$name>(),
            fields: vec![$((stringify!($field), offset_of!(layout::$name, $field))),*],
        }),*]
    };
}

/// Every struct of `layout.rs`.
pub fn layouts() -> Vec<Layout> {
    layouts! {
        Drawing {
            clip_from_relative, relative_from_object, eye, depth_row, viewport, radius_scale, opacity, point_count,
            point_base, flags, splits, front_base, layer_base, layer_count, padding_3, row_first, row_end,
            chunk_base, hair, map_values, map_colour, clip_from_object, previous_clip_from_object, jitter_motion,
            fibre_run, fibre_run_number, largest_radius, padding_0, padding_1, padding_2,
        }
        Light {
            place, power, map_count, map_first, resolution, pcf, layer_count, bias, cos_outer, edge,
            padding_0, axis, padding_1,
        }
        ShadowView { clip_from_relative, depth_row, front_base, layer_base, padding_0, padding_1, values, colour }
        Frame {
            ambient, light_count, eye, relative_from_clip, width, height, capacity, flags, tail_scale, run_points, run_rows,
            unseen, origin, cut_depth, depth_shift, fibre_runs, seed, key_first, word_bits, place_of_depth, technique,
            occluder_count, padding_0, padding_1, padding_2, lights, shadow_views, occluders,
        }
        Occluder { clip_from_relative, light, pcf, bias, flags }
        Material { values }
        Sample { tangent, coordinate, to_light, transmittance, to_eye, fibres, colour, strand, across, padding_0, padding_1 }
        Counters { produced, culled, stored, merged, overflow, covered, crowded, padding_0, walk_arguments, ribbon_arguments }
        Point { position, radius }
        Gather {
            origin, first, origin_rest, end, shift, lowest, base, stride, pieces, count,
        }
        Guided {
            source_base, stride, count, points_each, followers, followers_base, strands_base, first_guide, tip_factor,
            padding_0, padding_1, padding_2,
        }
        Placement { root, guide_0, tip, guide_1, stray, guide_2 }
        PointAttributes { strand, coordinate }
        PointOutput { motion, hair, strand }
        Projected { position, depth_width, bisector_flags }
    }
}

/// The constants of `layout.rs` that WGSL repeats.
pub fn shared_constants() -> Vec<(&'static str, u32)> {
    vec![
        ("MAX_LIGHTS", layout::MAX_LIGHTS as u32),
        ("MAX_SHADOW_VIEWS", layout::MAX_SHADOW_VIEWS as u32),
        ("MAX_OCCLUDERS", layout::MAX_OCCLUDERS as u32),
        ("OCCLUDER_REVERSE_Z", layout::OCCLUDER_REVERSE_Z),
        ("DRAWING_DEPTH_OVER_W", layout::DRAWING_DEPTH_OVER_W),
        ("DRAWING_REVERSE_Z", layout::DRAWING_REVERSE_Z),
        ("DRAWING_HOST_DEPTH", layout::DRAWING_HOST_DEPTH),
        ("FRAME_REVERSE_Z", layout::FRAME_REVERSE_Z),
        ("FRAME_NEAREST", layout::FRAME_NEAREST),
        ("POINT_FIRST", layout::POINT_FIRST),
        ("POINT_LAST", layout::POINT_LAST),
        ("POINT_STRAND", layout::POINT_STRAND),
        ("NO_PLACE", layout::NO_PLACE),
        ("OVERFLOW_WORDS", layout::OVERFLOW_WORDS as u32),
        ("SCAN_BLOCK", layout::SCAN_BLOCK),
        ("MATERIAL_VECTORS", layout::MATERIAL_VECTORS as u32),
        ("FIBRE_POINT_VECTORS", layout::FIBRE_POINT_VECTORS as u32),
        ("FIBRE_RUN_VECTORS", layout::FIBRE_RUN_VECTORS as u32),
        ("WORD_ALONG_BITS", layout::WORD_ALONG_BITS),
        ("WORD_VALUE_BITS_MOST", layout::WORD_VALUE_BITS_MOST),
        ("ORDER_KEYS", layout::ORDER_KEYS as u32),
        ("SPREAD_PARTS", layout::SPREAD_PARTS),
    ]
}

/// Straight pieces into which each of a groom's curved segments is cut.
pub fn curve_pieces(strands: &crate::groom::Strands) -> u32 {
    crate::geometry::curve_pieces(strands)
}

/// A hair's points as the GPU has them, in its own order, with their origin; what fills the gaps between runs too.
pub fn points_buffer(hair: &crate::Hair) -> (&wgpu::Buffer, glam::DVec3) {
    (&hair.geometry.points.buffer, hair.geometry.origin)
}

/// Half the size of the box that a hair is said to fill, around that origin.
pub fn half_extent(hair: &crate::Hair) -> glam::DVec3 {
    hair.geometry.half_extent
}
