//! Hairs: made of strands, guides, files or nothing, moved, and told how to be drawn.

use std::ffi::c_void;

use glam::DMat4;

use super::descriptor::{self, descriptor};
use super::error::{PelageResult, guard};
use super::input::{array, check_bytes, fill, output, outputs, slice};
use super::registry::{Host, Kind, PelageContext, PelageHair, State};
use super::settings::{self, PelageShading, PelageShadow, PelageTransparency};
use super::strands::{
    PelageClumpSettings, PelageInterpolationSettings, PelageStrands, check_radius, clump_input,
    curve, mesh_input, read_strands,
};
use crate::error::{Error, Result, invalid};
use crate::geometry::{Hair, Instance, MAX_INSTANCES};
use crate::groom::{
    BuiltinGroom, GuidedStrands, MAX_POINTS, Strands, builtin, formats, interpolate_clumps,
    interpolate_on_mesh,
};
use crate::renderer::Renderer;

/// Long and straight, parted.
pub const PELAGE_BUILTIN_STRAIGHT: u32 = 0;
/// Long, with waves that each wisp shares.
pub const PELAGE_BUILTIN_WAVY: u32 = 1;
/// Shoulder-length helical locks.
pub const PELAGE_BUILTIN_CURLY: u32 = 2;

/// The number of strands that the built-in grooms are made for.
pub const PELAGE_BUILTIN_STRAND_COUNT: u64 = 50000;

const _: () = assert!(PELAGE_BUILTIN_STRAND_COUNT == BuiltinGroom::DEFAULT_STRAND_COUNT as u64);

/// A hair file in memory: Cem Yuksel's `.hair`, or AMD TressFX's `.tfx` of versions 3 and 4.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageFile {
    /// `sizeof(PelageFile)`.
    pub struct_size: u32,
    /// `PELAGE_CURVE_…`: how the file's points make a curve; the formats do not say.
    pub curve: u32,
    /// The file's bytes. Read during the call only.
    pub bytes: *const c_void,
    /// The number of bytes.
    pub size: u64,
    /// Radius at the root, in the file's units, in place of the file's own radii; 0, with `tip_radius`: the file's, or
    /// where it has none (TressFX) what fits the groom's size.
    pub root_radius: f32,
    /// Radius at the tip, likewise.
    pub tip_radius: f32,
}

impl Default for PelageFile {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            curve: 0,
            bytes: std::ptr::null(),
            size: 0,
            root_radius: 0.0,
            tip_radius: 0.0,
        }
    }
}

descriptor!(PelageFile, "PELAGE_FILE_INIT", tip_radius: f32);

/// What a hair is made of.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageHairInfo {
    /// `sizeof(PelageHairInfo)`.
    pub struct_size: u32,
    /// `PELAGE_CURVE_…`.
    pub curve: u32,
    /// The number of strands.
    pub strand_count: u64,
    /// The number of points, of all strands together.
    pub point_count: u64,
    /// The lowest corner of the box around all points, in the groom's own space; zero where there are none.
    pub low: [f32; 3],
    /// The highest corner.
    pub high: [f32; 3],
}

impl Default for PelageHairInfo {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            curve: 0,
            strand_count: 0,
            point_count: 0,
            low: [0.0; 3],
            high: [0.0; 3],
        }
    }
}

descriptor!(PelageHairInfo, "PELAGE_HAIR_INFO_INIT", high: [f32; 3]);

/// Makes strands, then uploads them as a new hair. The context's lock is held for the upload alone.
unsafe fn create(
    context: PelageContext,
    hair: *mut PelageHair,
    strands: impl FnOnce() -> Result<Strands>,
) -> PelageResult {
    // SAFETY: the rule of the module `capi`.
    unsafe { create_of(context, hair, strands, Renderer::create_hair) }
}

/// The same of what `upload` takes.
unsafe fn create_of<T>(
    context: PelageContext,
    hair: *mut PelageHair,
    make: impl FnOnce() -> Result<T>,
    upload: fn(&mut Renderer, &T) -> Result<Hair>,
) -> PelageResult {
    guard(|| {
        context.check()?;
        // SAFETY: the rule of the module `capi`.
        let hair = unsafe { output("hair", hair) }?;
        let made = make()?;
        let upload = |state: &mut State| state.host.upload(|renderer| upload(renderer, &made));
        hair.write(PelageHair {
            id: context.make(Kind::Hair, |state| &mut state.hairs, upload)?,
        });
        Ok(())
    })
}

/// Makes a hair of strands: default shading, fully opaque fibres, no wishes, and the identity for its transform.
///
/// Errors: a value out of its range, named by strand and point; no memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_hair_create_from_strands(
    context: PelageContext,
    strands: *const PelageStrands,
    hair: *mut PelageHair,
) -> PelageResult {
    // SAFETY: the rule of the module `capi`.
    unsafe { create(context, hair, || read_strands("strands", strands)) }
}

/// Makes a hair of many strands between few guides that grow from a mesh. The guides themselves are not among them.
///
/// A triangle gets area times density strands, each a blend of its three guides.
///
/// Errors: as `pelage_hair_create_from_strands`; a triangle that names no guide; guides without triangles; more than 2^24
/// strands to be expected.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_hair_create_interpolated_on_mesh(
    context: PelageContext,
    guides: *const PelageStrands,
    settings: *const PelageInterpolationSettings,
    hair: *mut PelageHair,
) -> PelageResult {
    // SAFETY: the rule of the module `capi`.
    unsafe {
        create(context, hair, || {
            let (guides, settings) = mesh_input(guides, settings)?;
            interpolate_on_mesh(&guides, &settings)
        })
    }
}

/// As `pelage_hair_create_interpolated_on_mesh`, for a hair that remembers its guides: `pelage_hair_update_guides` moves them,
/// and all strands after them. Takes 12 bytes of GPU memory more a point, and 48 a strand.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_hair_create_guided_on_mesh(
    context: PelageContext,
    guides: *const PelageStrands,
    settings: *const PelageInterpolationSettings,
    hair: *mut PelageHair,
) -> PelageResult {
    // SAFETY: the rule of the module `capi`.
    unsafe {
        let make = || {
            let (guides, settings) = mesh_input(guides, settings)?;
            GuidedStrands::on_mesh(&guides, &settings)
        };
        create_of(context, hair, make, Renderer::create_guided_hair)
    }
}

/// Makes a hair of guides, each with followers around it; no mesh is needed. A guide comes first, then its followers.
///
/// Errors: as `pelage_hair_create_from_strands`; more than 2^24 strands.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_hair_create_interpolated_clumps(
    context: PelageContext,
    guides: *const PelageStrands,
    settings: *const PelageClumpSettings,
    hair: *mut PelageHair,
) -> PelageResult {
    // SAFETY: the rule of the module `capi`.
    unsafe {
        create(context, hair, || {
            let (guides, settings) = clump_input(guides, settings)?;
            interpolate_clumps(&guides, &settings)
        })
    }
}

/// As `pelage_hair_create_interpolated_clumps`, for a hair that remembers its guides: `pelage_hair_update_guides` moves them,
/// and all strands after them. Takes 12 bytes of GPU memory more a point, and 24 a follower.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_hair_create_guided_clumps(
    context: PelageContext,
    guides: *const PelageStrands,
    settings: *const PelageClumpSettings,
    hair: *mut PelageHair,
) -> PelageResult {
    // SAFETY: the rule of the module `capi`.
    unsafe {
        let make = || {
            let (guides, settings) = clump_input(guides, settings)?;
            GuidedStrands::clumps(&guides, &settings)
        };
        create_of(context, hair, make, Renderer::create_guided_hair)
    }
}

/// Makes a hair of a file in memory.
///
/// Errors: `PELAGE_INVALID_FILE` for bytes that are neither format, truncated or corrupt; a radius out of its range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_hair_create_from_file(
    context: PelageContext,
    file: *const PelageFile,
    hair: *mut PelageHair,
) -> PelageResult {
    // SAFETY: the rule of the module `capi`.
    unsafe { create(context, hair, || read_file(file)) }
}

unsafe fn read_file(file: *const PelageFile) -> Result<Strands> {
    // SAFETY: the rule of the module `capi`.
    let given = unsafe { descriptor::read("file", file) }?;
    check_radius("root_radius", given.root_radius)?;
    check_radius("tip_radius", given.tip_radius)?;
    let curve = curve(given.curve)?;
    // SAFETY: the rule of the module `capi`.
    let bytes = unsafe {
        slice(
            "bytes",
            given.bytes.cast::<u8>(),
            given.size,
            isize::MAX as usize,
        )
    }?;
    let strands = formats::read(bytes)?.with_curve(curve);
    if given.root_radius == 0.0 && given.tip_radius == 0.0 {
        return Ok(strands);
    }
    strands.with_root_tip_radii(given.root_radius, given.tip_radius)
}

/// Makes a hair out of nothing: `strand_count` strands (0 to about 2^23) of a built-in groom (`PELAGE_BUILTIN_…`) on a
/// head-shaped scalp, in metres, +y up, the face towards +z, the origin between the ears. The same on every call.
///
/// Errors: an unknown groom; too many strands.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_hair_create_builtin(
    context: PelageContext,
    groom: u32,
    strand_count: u64,
    hair: *mut PelageHair,
) -> PelageResult {
    let make = || {
        let groom = match groom {
            PELAGE_BUILTIN_STRAIGHT => BuiltinGroom::Straight,
            PELAGE_BUILTIN_WAVY => BuiltinGroom::Wavy,
            PELAGE_BUILTIN_CURLY => BuiltinGroom::Curly,
            _ => return invalid!("groom {groom} is not one of PELAGE_BUILTIN_…"),
        };
        builtin(groom, usize::try_from(strand_count).unwrap_or(usize::MAX))
    };
    // SAFETY: the rule of the module `capi`.
    unsafe { create(context, hair, make) }
}

/// States in `*bytes` the GPU memory that a hair of strands will take, in bytes, before it is made. As much work as
/// `pelage_hair_create_from_strands`, but for the upload; allocates no GPU memory.
///
/// Errors: as that function's.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_hair_memory_estimate(
    context: PelageContext,
    strands: *const PelageStrands,
    bytes: *mut u64,
) -> PelageResult {
    guard(|| {
        context.check()?;
        // SAFETY: the rule of the module `capi`.
        let (strands, bytes) = unsafe {
            let bytes = output("bytes", bytes)?;
            (read_strands("strands", strands)?, bytes)
        };
        let found = context.with(|State { host, .. }| {
            host.with_renderer(|renderer| renderer.hair_memory_estimate(&strands))
        })?;
        bytes.write(found);
        Ok(())
    })
}

/// Destroys a hair. Frames that were rendered with it are not touched.
#[unsafe(no_mangle)]
pub extern "C" fn pelage_hair_destroy(hair: PelageHair) -> PelageResult {
    guard(|| hair.destroy())
}

/// Says what a hair is made of. The box is that of the positions that the CPU gave last; those of guides or of a buffer are not
/// known to it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_hair_info(
    hair: PelageHair,
    info: *mut PelageHairInfo,
) -> PelageResult {
    guard(|| {
        let value = hair.with(|hair, _| {
            let strands = hair.strands();
            let (low, high) = strands.bounds().unwrap_or_default();
            Ok(PelageHairInfo {
                curve: strands.curve() as u32,
                strand_count: strands.strand_count() as u64,
                point_count: strands.points().len() as u64,
                low,
                high,
                ..Default::default()
            })
        })?;
        // SAFETY: the rule of the module `capi`.
        unsafe { descriptor::write("info", info, &value) }
    })
}

/// Copies a hair's positions, as the CPU gave them last (guides and buffers do not change them), into `positions`: three floats a point, `size` bytes in all, which
/// must be 12 times the number of points.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_hair_points(
    hair: PelageHair,
    positions: *mut f32,
    size: u64,
) -> PelageResult {
    guard(|| {
        hair.with(|hair, _| {
            let points = hair.strands().points();
            check_bytes::<[f32; 3]>("positions", size, points.len(), "the hair's points take")?;
            // SAFETY: the rule of the module `capi`.
            let out = unsafe { outputs("positions", positions.cast::<[f32; 3]>(), points.len()) }?;
            fill(out, points.iter().copied());
            Ok(())
        })
    })
}

/// Moves a hair: replaces every position by three floats of `positions` a point, `point_count` points, as many as the hair
/// has. Takes effect with the next frame rendered.
///
/// Errors: another number of points; a position that is not finite; on the host's Vulkan device, an update of this hair by its
/// guides or by a buffer that no submission has taken yet, or 16 updates of any kind (`PELAGE_CONFLICT`): render first.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_hair_update_points(
    hair: PelageHair,
    positions: *const f32,
    point_count: u64,
) -> PelageResult {
    guard(|| {
        // SAFETY: the rule of the module `capi`.
        let points = unsafe {
            slice(
                "positions",
                positions.cast::<[f32; 3]>(),
                point_count,
                MAX_POINTS,
            )
        }?;
        hair.with(|hair, host| {
            if let Host::Vulkan(vulkan) = host
                && vulkan.is_ahead()
                && hair.moved_on_gpu()
            {
                return Err(Error::Conflict(
                    "the hair's last update is still waiting for pelage_vulkan_render".into(),
                ));
            }
            host.update_points(hair, points)
        })
    })
}

/// Moves the guides of a hair that remembers them, and all its strands after them, on the GPU: three floats of `positions` a
/// point of the guides, `point_count` points, as many as they have. Takes effect with the next frame rendered; on the host's
/// Vulkan device as the first thing that the next submission does.
///
/// The number of strands, and what was drawn by chance, stays as it was. `pelage_hair_points` is not told of the new positions.
///
/// Errors: a hair that was not made by `pelage_hair_create_guided_...`; another number of points; a position that is not
/// finite; no memory; on the host's Vulkan device, 16 updates of this hair that no submission has taken yet (`PELAGE_CONFLICT`).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_hair_update_guides(
    hair: PelageHair,
    positions: *const f32,
    point_count: u64,
) -> PelageResult {
    guard(|| {
        // SAFETY: the rule of the module `capi`.
        let points = unsafe {
            slice(
                "positions",
                positions.cast::<[f32; 3]>(),
                point_count,
                MAX_POINTS,
            )
        }?;
        hair.with(|hair, host| host.update_guides(hair, points))
    })
}

/// Places a hair: `world_from_object`, 16 doubles, column-major, an affine transform that can be inverted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_hair_set_transform(
    hair: PelageHair,
    world_from_object: *const f64,
) -> PelageResult {
    guard(|| {
        // SAFETY: the rule of the module `capi`.
        let matrix = unsafe { affine("world_from_object", world_from_object) }?;
        hair.with(|hair, _| {
            hair.world_from_object = matrix;
            Ok(())
        })
    })
}

/// Says where a hair was in the frame before, for motion vectors: `world_from_object` of then, 16 doubles, column-major. NULL: where
/// it is.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_hair_set_previous_transform(
    hair: PelageHair,
    world_from_object: *const f64,
) -> PelageResult {
    guard(|| {
        let previous = if world_from_object.is_null() {
            None
        } else {
            // SAFETY: the rule of the module `capi`.
            Some(unsafe { affine("world_from_object", world_from_object) }?)
        };
        hair.with(|hair, _| {
            hair.previous_world_from_object = previous;
            Ok(())
        })
    })
}

/// Draws `count` copies of a hair, up to 65535, each placed by its own transform and then by the hair's:
/// `object_from_instance`, 16 doubles a copy, column-major, affine transforms that can be inverted.
/// `previous_object_from_instance`: the same of the frame before, for motion vectors, or NULL. 0 copies: the hair itself, once.
///
/// Errors: a transform that is not affine, not finite or cannot be inverted; too many copies.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_hair_set_instances(
    hair: PelageHair,
    object_from_instance: *const f64,
    previous_object_from_instance: *const f64,
    count: u32,
) -> PelageResult {
    guard(|| {
        if count as usize > MAX_INSTANCES {
            return invalid!("{count} instances: a hair has at most {MAX_INSTANCES}");
        }
        let matrix = |name: &str, pointer: *const f64, at: u32| {
            // SAFETY: the host gives 16 doubles for each of `count` copies.
            unsafe { affine(&format!("{name}[{at}]"), pointer.add(at as usize * 16)) }
        };
        if count > 0 && object_from_instance.is_null() {
            return invalid!("object_from_instance is NULL, but {count} instances are announced");
        }
        let instances: Vec<Instance> = (0..count)
            .map(|at| {
                Ok(Instance {
                    object_from_instance: matrix("object_from_instance", object_from_instance, at)?,
                    previous_object_from_instance: if previous_object_from_instance.is_null() {
                        None
                    } else {
                        Some(matrix(
                            "previous_object_from_instance",
                            previous_object_from_instance,
                            at,
                        )?)
                    },
                })
            })
            .collect::<Result<_>>()?;
        hair.with(|hair, _| {
            hair.instances = instances;
            Ok(())
        })
    })
}

/// Says that a hair's points have not moved since the frame before, whatever `pelage_hair_update_points` did then: their motion is
/// zero until the next update.
#[unsafe(no_mangle)]
pub extern "C" fn pelage_hair_rest(hair: PelageHair) -> PelageResult {
    guard(|| {
        hair.with(|hair, _| {
            hair.rest();
            Ok(())
        })
    })
}

/// An affine transform that can be inverted.
unsafe fn affine(name: &str, pointer: *const f64) -> Result<DMat4> {
    // SAFETY: the rule of the module `capi`.
    let matrix = DMat4::from_cols_array(&unsafe { array(name, pointer) }?);
    let determinant = matrix.determinant();
    if !matrix.is_finite() || determinant == 0.0 || !determinant.is_finite() {
        return invalid!("{name} {:?} cannot be inverted", matrix.to_cols_array());
    }
    if matrix.row(3) != glam::DVec4::W {
        return invalid!(
            "{name}'s last row {} is not that of an affine transform, (0, 0, 0, 1)",
            matrix.row(3)
        );
    }
    Ok(matrix)
}

/// Sets the fibres' own opacity, from 0 to 1.
#[unsafe(no_mangle)]
pub extern "C" fn pelage_hair_set_opacity(hair: PelageHair, opacity: f32) -> PelageResult {
    guard(|| {
        if !(0.0..=1.0).contains(&opacity) {
            return invalid!("opacity {opacity} is not between 0 and 1");
        }
        hair.with(|hair, _| {
            hair.opacity = opacity;
            Ok(())
        })
    })
}

/// Sets a hair's shading model, and where it is evaluated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_hair_set_shading(
    hair: PelageHair,
    shading: *const PelageShading,
) -> PelageResult {
    guard(|| {
        // SAFETY: the rule of the module `capi`.
        let (shading, rate) = unsafe { settings::shading("shading", shading) }?;
        hair.with(|hair, _| {
            hair.shading = shading;
            hair.shading_rate = rate;
            Ok(())
        })
    })
}

/// Sets the shadow technique that a hair wishes for lights that name none; NULL: no wish. Where no hair has one, lights
/// are shadowed as `PELAGE_SHADOW_INIT` says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_hair_set_shadow(
    hair: PelageHair,
    shadow: *const PelageShadow,
) -> PelageResult {
    guard(|| {
        // SAFETY: the rule of the module `capi`.
        let shadow = unsafe { settings::shadow("shadow", shadow) }?;
        hair.with(|hair, _| {
            hair.shadow = shadow;
            Ok(())
        })
    })
}

/// Sets the transparency technique that a hair wishes for frames that name none; NULL: no wish. Where no hair has one,
/// frames are drawn as `PELAGE_TRANSPARENCY_INIT` says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_hair_set_transparency(
    hair: PelageHair,
    transparency: *const PelageTransparency,
) -> PelageResult {
    guard(|| {
        // SAFETY: the rule of the module `capi`.
        let transparency = unsafe { settings::transparency("transparency", transparency) }?;
        hair.with(|hair, _| {
            hair.transparency = transparency;
            Ok(())
        })
    })
}
