//! Frames: a view, lights, ambient light and the hairs that are drawn.

use std::collections::BTreeMap;
use std::ptr::null;

use glam::{DMat4, DVec3};

use super::descriptor::{self, descriptor};
use super::error::{PelageResult, guard};
use super::input::{array, flags, reserved, slice};
use super::registry::PelageHair;
use super::settings::{self, PelageShadow, PelageTransparency};
use crate::error::{Result, invalid};
use crate::frame::Frame;
use crate::geometry::Hair;
use crate::layout::MAX_LIGHTS;
use crate::light::{Light, LightKind};
use crate::transparency::Transparency;
use crate::view::{PreviousView, View};

/// Clip depth 1 is near and 0 far.
pub const PELAGE_VIEW_REVERSE_Z: u32 = 1;
/// Clip space's y points down the image, as Vulkan's own convention has it, not up.
pub const PELAGE_VIEW_FLIP_Y: u32 = 2;
/// The previous matrices and jitter are given, for motion vectors; without it the camera stood still.
pub const PELAGE_VIEW_PREVIOUS: u32 = 4;

/// A light so far away that its rays are parallel.
pub const PELAGE_LIGHT_DIRECTIONAL: u32 = 0;
/// A light at a point that shines in all directions.
pub const PELAGE_LIGHT_POINT: u32 = 1;
/// A light at a point that shines into a cone.
pub const PELAGE_LIGHT_SPOT: u32 = 2;

/// The most lights of a frame.
pub const PELAGE_MAX_LIGHTS: u32 = 16;

const _: () = assert!(PELAGE_MAX_LIGHTS as usize == MAX_LIGHTS);

/// A camera. Right-handed world, clip depth from 0 to 1, row 0 of the image at the top.
///
/// World coordinates may be large: the matrices are composed in double precision.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageView {
    /// `sizeof(PelageView)`.
    pub struct_size: u32,
    /// Any of `PELAGE_VIEW_…`, or 0.
    pub flags: u32,
    /// Camera space from world space, column-major; the camera looks along -z. Can be inverted.
    pub view_from_world: [f64; 16],
    /// Clip space from camera space, column-major. Can be inverted.
    pub clip_from_view: [f64; 16],
    /// With `PELAGE_VIEW_PREVIOUS`: both matrices of the frame before.
    pub previous_view_from_world: [f64; 16],
    /// See above.
    pub previous_clip_from_view: [f64; 16],
    /// How far `clip_from_view` shifts the image for temporal antialiasing, in pixels, +x right, +y down; it is taken out of
    /// motion vectors and changes nothing else.
    pub jitter: [f32; 2],
    /// The same of the frame before.
    pub previous_jitter: [f32; 2],
    /// The part of the target that the view fills: left, top, width, height in pixels; all 0: the whole target.
    pub rectangle: [u32; 4],
}

impl Default for PelageView {
    fn default() -> Self {
        let identity = DMat4::IDENTITY.to_cols_array();
        Self {
            struct_size: size_of::<Self>() as u32,
            flags: 0,
            view_from_world: identity,
            clip_from_view: identity,
            previous_view_from_world: identity,
            previous_clip_from_view: identity,
            jitter: [0.0; 2],
            previous_jitter: [0.0; 2],
            rectangle: [0; 4],
        }
    }
}

descriptor!(PelageView, "PELAGE_VIEW_INIT", rectangle: [u32; 4]);

/// One light.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageLight {
    /// `sizeof(PelageLight)`.
    pub struct_size: u32,
    /// `PELAGE_LIGHT_…`.
    pub kind: u32,
    /// Of a directional light or a spot: the way it travels, in world space; any length but zero.
    pub direction: [f64; 3],
    /// Of a point light or a spot: world space, host units.
    pub position: [f64; 3],
    /// Linear RGB, at least 0. Of a directional light: irradiance on a plane that faces it. Of a point light or a spot:
    /// radiant intensity, that is irradiance times squared distance.
    pub power: [f32; 3],
    /// 0.
    pub reserved: u32,
    /// How hair shadows this light; NULL: as the frame's hairs wish.
    pub shadow: *const PelageShadow,
    /// Of a spot: the angle from its axis up to which it has all of its intensity, in radians, from 0 to `outer_angle`.
    pub inner_angle: f32,
    /// Of a spot: the angle from which on it has none, in radians, above 0 and up to pi/2.
    pub outer_angle: f32,
}

impl Default for PelageLight {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            kind: PELAGE_LIGHT_DIRECTIONAL,
            direction: [0.0, -1.0, 0.0],
            position: [0.0; 3],
            power: [1.0; 3],
            reserved: 0,
            shadow: null(),
            inner_angle: 0.4,
            outer_angle: 0.5,
        }
    }
}

descriptor!(
    PelageLight,
    "PELAGE_LIGHT_INIT",
    outer_angle: f32,
    since shadow: *const PelageShadow
);

/// What one frame draws. Read during the call only.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageFrame {
    /// `sizeof(PelageFrame)`.
    pub struct_size: u32,
    /// The number of hairs.
    pub hair_count: u32,
    /// The hairs, each once; they sort and shadow against each other.
    pub hairs: *const PelageHair,
    /// The lights, each begun with `PELAGE_LIGHT_INIT`.
    pub lights: *const PelageLight,
    /// From where, and through which lens. Not NULL.
    pub view: *const PelageView,
    /// The transparency technique; NULL: what all hairs wish for.
    pub transparency: *const PelageTransparency,
    /// The number of lights, at most `PELAGE_MAX_LIGHTS`.
    pub light_count: u32,
    /// Radiance of a uniform environment, linear RGB, at least 0; it reaches every fibre unshadowed.
    pub ambient: [f32; 3],
}

impl Default for PelageFrame {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            hair_count: 0,
            hairs: null(),
            lights: null(),
            view: null(),
            transparency: null(),
            light_count: 0,
            ambient: [0.0; 3],
        }
    }
}

descriptor!(PelageFrame, "PELAGE_FRAME_INIT", ambient: [f32; 3]);

/// Fills `*view`, begun with `PELAGE_VIEW_INIT`, with a perspective view from `eye` towards `target` (three doubles each,
/// world space). `up` is not parallel to the way from eye to target; `vertical_fov` is in radians, above 0 and below pi;
/// `aspect` is width over height; clip depth is 0 at `near_plane` and 1 at `far_plane`, both distances above 0.
///
/// Errors: values that are not finite or make no view.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_view_perspective(
    eye: *const f64,
    target: *const f64,
    up: *const f64,
    vertical_fov: f64,
    aspect: f64,
    near_plane: f64,
    far_plane: f64,
    view: *mut PelageView,
) -> PelageResult {
    guard(|| {
        // SAFETY: the rule of the module `capi`.
        let [eye, target, up] = unsafe {
            [
                array("eye", eye)?,
                array("target", target)?,
                array("up", up)?,
            ]
        }
        .map(DVec3::from_array);
        let made = View::perspective(
            eye,
            target,
            up,
            vertical_fov,
            aspect,
            [near_plane, far_plane],
        )?;
        let value = PelageView {
            view_from_world: made.view_from_world.to_cols_array(),
            clip_from_view: made.clip_from_view.to_cols_array(),
            ..Default::default()
        };
        // SAFETY: the rule of the module `capi`.
        unsafe { descriptor::write("view", view, &value) }
    })
}

/// A frame in the crate's own types, but for its hairs, which are another context's business until its lock is held.
pub(super) struct GivenFrame<'a> {
    hairs: &'a [PelageHair],
    lights: Vec<Light>,
    ambient: [f32; 3],
    view: View,
    pub(super) rectangle: Option<[u32; 4]>,
    transparency: Option<Transparency>,
}

impl<'a> GivenFrame<'a> {
    /// The most hairs of a frame.
    const MOST_HAIRS: usize = 1 << 16;

    pub(super) unsafe fn read(pointer: *const PelageFrame) -> Result<Self> {
        // SAFETY: the rule of the module `capi`.
        let given = unsafe { descriptor::read("frame", pointer) }?;
        // SAFETY: the rule of the module `capi`.
        let lights = unsafe {
            descriptor::read_array("lights", given.lights, given.light_count, MAX_LIGHTS)
        }?;
        // SAFETY: the rule of the module `capi`.
        let (view, rectangle) = unsafe { view(given.view) }?;
        // SAFETY: the rule of the module `capi`.
        unsafe {
            Ok(Self {
                hairs: slice(
                    "hairs",
                    given.hairs,
                    u64::from(given.hair_count),
                    Self::MOST_HAIRS,
                )?,
                lights: lights
                    .iter()
                    .enumerate()
                    .map(|(at, given)| light(at, given))
                    .collect::<Result<_>>()?,
                ambient: given.ambient,
                view,
                rectangle,
                transparency: settings::transparency("transparency", given.transparency)?,
            })
        }
    }

    /// The hairs among a context's own, each once.
    pub(super) fn hairs<'b>(&self, own: &'b BTreeMap<u64, Hair>) -> Result<Vec<&'b Hair>> {
        let mut seen = std::collections::BTreeSet::new();
        let find = |(at, handle): (usize, &PelageHair)| {
            let hair = handle.among(own).map_err(|error| match error {
                crate::Error::InvalidHandle(what) => {
                    crate::Error::InvalidHandle(format!("hairs[{at}]: {what}"))
                }
                other => other,
            })?;
            if !seen.insert(handle.id) {
                return invalid!("hairs[{at}] is in the frame already");
            }
            Ok(hair)
        };
        self.hairs.iter().enumerate().map(find).collect()
    }

    /// The frame that draws `hairs`.
    pub(super) fn frame<'b>(&'b self, hairs: &'b [&'b Hair]) -> Frame<'b> {
        Frame {
            hairs,
            lights: &self.lights,
            ambient: self.ambient.into(),
            view: self.view,
            transparency: self.transparency,
        }
    }
}

unsafe fn view(pointer: *const PelageView) -> Result<(View, Option<[u32; 4]>)> {
    // SAFETY: the rule of the module `capi`.
    let given = unsafe { descriptor::read("view", pointer) }?;
    let all = PELAGE_VIEW_REVERSE_Z | PELAGE_VIEW_FLIP_Y | PELAGE_VIEW_PREVIOUS;
    let flags = flags("view: flags", given.flags, all)?;
    let view = View {
        view_from_world: DMat4::from_cols_array(&given.view_from_world),
        clip_from_view: DMat4::from_cols_array(&given.clip_from_view),
        reverse_z: flags & PELAGE_VIEW_REVERSE_Z != 0,
        flip_y: flags & PELAGE_VIEW_FLIP_Y != 0,
        jitter: given.jitter,
        previous: (flags & PELAGE_VIEW_PREVIOUS != 0).then(|| PreviousView {
            view_from_world: DMat4::from_cols_array(&given.previous_view_from_world),
            clip_from_view: DMat4::from_cols_array(&given.previous_clip_from_view),
            jitter: given.previous_jitter,
        }),
    };
    Ok((view, (given.rectangle != [0; 4]).then_some(given.rectangle)))
}

unsafe fn light(number: usize, given: &PelageLight) -> Result<Light> {
    reserved("PelageLight", given.reserved)?;
    let power = given.power.into();
    let kind = match given.kind {
        PELAGE_LIGHT_DIRECTIONAL => LightKind::Directional {
            direction: given.direction.into(),
            irradiance: power,
        },
        PELAGE_LIGHT_POINT => LightKind::Point {
            position: given.position.into(),
            intensity: power,
        },
        PELAGE_LIGHT_SPOT => LightKind::Spot {
            position: given.position.into(),
            direction: given.direction.into(),
            intensity: power,
            inner_angle: given.inner_angle,
            outer_angle: given.outer_angle,
        },
        unknown => return invalid!("light {number}: kind {unknown} is not one of PELAGE_LIGHT_…"),
    };
    // SAFETY: the rule of the module `capi`.
    let shadow = unsafe { settings::shadow(&format!("light {number}: shadow"), given.shadow) }?;
    Ok(Light { kind, shadow })
}
