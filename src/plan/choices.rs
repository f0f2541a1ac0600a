//! What a frame's hairs agree on: one technique of each kind, one shading model.

use crate::error::{Error, Result};
use crate::frame::Frame;
use crate::shading::{Shader, Shading, ShadingRate};
use crate::shadow::Shadow;
use crate::transparency::Transparency;

/// The frame's technique, or what its hairs agree on.
pub(super) fn choose_transparency(frame: &Frame) -> Result<Transparency> {
    if let Some(transparency) = frame.transparency {
        return Ok(transparency);
    }
    agree(
        "transparency",
        frame.hairs.iter().map(|hair| hair.transparency),
        Transparency::stem,
    )
}

/// The light's technique, or what the hairs agree on.
pub(super) fn choose_shadow(frame: &Frame, light: usize) -> Result<Shadow> {
    if let Some(shadow) = frame.lights[light].shadow {
        return Ok(shadow);
    }
    agree(
        "shadow",
        frame.hairs.iter().map(|hair| hair.shadow),
        Shadow::stem,
    )
}

/// The only wish, the default where nobody wishes, or an error.
fn agree<T: Copy + PartialEq + Default>(
    what: &str,
    wishes: impl Iterator<Item = Option<T>>,
    stem: fn(&T) -> &'static str,
) -> Result<T> {
    let mut agreed: Option<(usize, T)> = None;
    for (number, wish) in wishes.enumerate() {
        match (agreed, wish) {
            (Some((first, a)), Some(b)) if a != b => {
                return Err(Error::Conflict(format!(
                    "hair {first} wishes for the {what} {} and hair {number} for {}, or with other settings; name one on \
                     the frame",
                    stem(&a),
                    stem(&b)
                )));
            }
            (None, Some(b)) => agreed = Some((number, b)),
            _ => {}
        }
    }
    Ok(agreed.map(|(_, wish)| wish).unwrap_or_default())
}

/// All hairs' model and rate; one of each a frame for now, parameters may differ.
pub(super) fn one_shader(frame: &Frame) -> Result<Shader> {
    let Some(first) = frame.hairs.first() else {
        return Ok(Shader::of(&Shading::default(), ShadingRate::default()));
    };
    for (number, hair) in frame.hairs.iter().enumerate() {
        if hair.shading.stem() != first.shading.stem() {
            return Err(Error::Conflict(format!(
                "hair 0 has the shading {} and hair {number} {}",
                first.shading.stem(),
                hair.shading.stem()
            )));
        }
        if hair.shading_rate != first.shading_rate {
            return Err(Error::Conflict(format!(
                "hair 0 has the shading rate {:?} and hair {number} {:?}",
                first.shading_rate, hair.shading_rate
            )));
        }
    }
    let mut shader = Shader::of(&first.shading, first.shading_rate);
    for hair in frame.hairs {
        let own = Shader::of(&hair.shading, hair.shading_rate);
        shader.one_material &= hair.shading == first.shading;
        shader.varies |= own.varies;
        if own.settings != shader.settings {
            shader.settings = None;
        }
    }
    Ok(shader)
}
