//! Views: from where, and through which lens, a frame is seen.

use glam::{DMat4, DVec3, DVec4};

use crate::error::{Result, invalid};

/// A camera. Right-handed world, clip depth from 0 to 1, row 0 of the image at the top.
///
/// Both matrices are double precision and composed on the CPU, so that world coordinates may be large.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Camera space from world space; the camera looks along -z.
    pub view_from_world: DMat4,
    /// Clip space from camera space.
    pub clip_from_view: DMat4,
    /// Clip depth 1 is near and 0 far.
    pub reverse_z: bool,
    /// Clip space's y points down the image, as Vulkan's own convention has it, not up.
    pub flip_y: bool,
    /// How far `clip_from_view` shifts the image for temporal antialiasing, in pixels, +x right, +y down. It is taken out
    /// of motion vectors and changes nothing else.
    pub jitter: [f32; 2],
    /// The camera of the frame before, for motion vectors. `None`: it stood still.
    pub previous: Option<PreviousView>,
}

/// What a view was in the frame before; fields as in [`View`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PreviousView {
    /// Camera space from world space.
    pub view_from_world: DMat4,
    /// Clip space from camera space.
    pub clip_from_view: DMat4,
    /// In pixels.
    pub jitter: [f32; 2],
}

impl View {
    /// A perspective view from `eye` towards `target`. `vertical_fov` in radians, `aspect` = width over height.
    ///
    /// # Errors
    /// Values that are not finite or make no view: an eye at its target, a field of view outside 0…π, near ≥ far.
    pub fn perspective(
        eye: DVec3,
        target: DVec3,
        up: DVec3,
        vertical_fov: f64,
        aspect: f64,
        depth_range: [f64; 2],
    ) -> Result<Self> {
        let [near, far] = depth_range;
        if !(vertical_fov > 0.0 && vertical_fov < std::f64::consts::PI) {
            return invalid!("vertical field of view {vertical_fov} is not between 0 and π");
        }
        if !(aspect > 0.0 && aspect.is_finite()) {
            return invalid!("aspect ratio {aspect} is not positive");
        }
        if !(near > 0.0 && far > near && far.is_finite()) {
            return invalid!("depth range {near}…{far} is not positive and rising");
        }
        let side = (target - eye).cross(up);
        if !(eye.is_finite() && side.is_finite() && side.length() > 0.0) {
            return invalid!("eye {eye}, target {target} and up {up} make no view");
        }
        let focal = 1.0 / (0.5 * vertical_fov).tan();
        let clip_from_view = DMat4::from_cols(
            DVec4::new(focal / aspect, 0.0, 0.0, 0.0),
            DVec4::new(0.0, focal, 0.0, 0.0),
            DVec4::new(0.0, 0.0, far / (near - far), -1.0),
            DVec4::new(0.0, 0.0, near * far / (near - far), 0.0),
        );
        Ok(Self {
            view_from_world: look_at(eye, target - eye, up),
            clip_from_view,
            reverse_z: false,
            flip_y: false,
            jitter: [0.0; 2],
            previous: None,
        })
    }

    /// Position of the eye in world space (w = 1), or for an orthographic view the direction towards it (w = 0).
    pub(crate) fn eye(&self) -> DVec4 {
        let world_from_view = self.view_from_world.inverse();
        // The eye is the point that projects to w = 0 everywhere: the last row of the projection tells its kind.
        if self.clip_from_view.row(3).truncate().length() > 1e-12 {
            world_from_view.w_axis.truncate().extend(1.0)
        } else {
            world_from_view.z_axis.truncate().normalize().extend(0.0)
        }
    }

    /// The view of the frame before, or this one.
    pub(crate) fn before(&self) -> Self {
        let Some(previous) = self.previous else {
            return *self;
        };
        Self {
            view_from_world: previous.view_from_world,
            clip_from_view: previous.clip_from_view,
            jitter: previous.jitter,
            ..*self
        }
    }

    /// Clip space, with y up the image, from camera space.
    pub(crate) fn clip_y_up_from_view(&self) -> DMat4 {
        let flip = DVec3::new(1.0, if self.flip_y { -1.0 } else { 1.0 }, 1.0);
        DMat4::from_scale(flip) * self.clip_from_view
    }

    /// Where relative space has its zero: the eye's position, so that what is near keeps its precision.
    pub(crate) fn origin(&self) -> DVec3 {
        self.view_from_world.inverse().w_axis.truncate()
    }

    pub(crate) fn validate(&self) -> Result<()> {
        if let Some(previous) = &self.previous {
            let finite = previous.view_from_world.is_finite()
                && previous.clip_from_view.is_finite()
                && previous.jitter.iter().all(|shift| shift.is_finite());
            if !finite {
                return invalid!("the previous view has a value that is not finite");
            }
        }
        if !self.jitter.iter().all(|shift| shift.is_finite()) {
            return invalid!("jitter {:?} is not finite", self.jitter);
        }
        for (name, matrix) in [
            ("view_from_world", &self.view_from_world),
            ("clip_from_view", &self.clip_from_view),
        ] {
            if !matrix.is_finite() {
                return invalid!("{name} has an element that is not finite");
            }
            let determinant = matrix.determinant();
            if determinant == 0.0 || !determinant.is_finite() {
                return invalid!("{name} cannot be inverted: its determinant is {determinant}");
            }
        }
        Ok(())
    }
}

/// The right-handed view matrix from `eye` along `forward`.
pub(crate) fn look_at(eye: DVec3, forward: DVec3, up: DVec3) -> DMat4 {
    let back = -forward.normalize();
    let right = up.cross(back).normalize();
    let above = back.cross(right);
    let rotation = DMat4::from_cols(
        right.extend(0.0),
        above.extend(0.0),
        back.extend(0.0),
        DVec4::W,
    )
    .transpose();
    rotation * DMat4::from_translation(-eye)
}
