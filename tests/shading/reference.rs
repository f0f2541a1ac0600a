//! The reference's models with the parameters of the library's. The report takes them from here too.

use pelage::shading::{Chiang, Highlight, LobeControls, Marschner, Roots, Sadeghi, Scheuermann};
use pelage_reference::{chiang, marschner, sadeghi, scheuermann};

pub fn of_scheuermann(model: &Scheuermann) -> scheuermann::Scheuermann {
    let highlight = |h: &Highlight| scheuermann::Highlight {
        colour: h.colour.as_dvec3(),
        exponent: f64::from(h.exponent),
        shift: f64::from(h.shift),
    };
    scheuermann::Scheuermann {
        diffuse: model.diffuse.as_dvec3(),
        primary: highlight(&model.primary),
        secondary: highlight(&model.secondary),
    }
}

pub fn of_marschner(model: &Marschner) -> marschner::Marschner {
    marschner::Marschner::new(marschner::Params {
        eta: f64::from(model.eta),
        sigma_a: model.sigma_a.as_dvec3(),
        alpha: model.alpha.map(f64::from),
        beta: model.beta.map(f64::from),
        eccentricity: f64::from(model.eccentricity),
        roots: match model.roots {
            Roots::Cubic => marschner::Roots::Cubic,
            _ => marschner::Roots::Exact,
        },
        caustic: model.caustic.map(|c| marschner::CausticRemoval {
            w_c: f64::from(c.w_c),
            k_g: f64::from(c.k_g),
            delta_eta: f64::from(c.delta_eta),
            delta_h_max: f64::from(c.delta_h_max),
        }),
    })
    .unwrap()
}

/// One glint angle for all strands: the least of the range.
pub fn of_sadeghi(model: &Sadeghi) -> sadeghi::Sadeghi {
    let lobe = |lobe: &LobeControls| sadeghi::LobeControls {
        colour: lobe.colour.as_dvec3(),
        intensity: f64::from(lobe.intensity),
        shift: f64::from(lobe.shift),
        width: f64::from(lobe.width),
    };
    sadeghi::Sadeghi::new(sadeghi::Params {
        r: lobe(&model.r),
        tt: lobe(&model.tt),
        trt: lobe(&model.trt),
        tt_azimuthal_width: f64::from(model.tt_azimuthal_width),
        glint_intensity: f64::from(model.glint_intensity),
        glint_width: f64::from(model.glint_width),
        glint_angle: f64::from(model.glint_angle[0]),
    })
    .unwrap()
}

pub fn of_chiang(model: &Chiang) -> chiang::Chiang {
    chiang::Chiang::new(chiang::Params {
        beta_m: f64::from(model.beta_m),
        beta_n: f64::from(model.beta_n),
        alpha: f64::from(model.alpha),
        eta: f64::from(model.eta),
        sigma_a: model.sigma_a.as_dvec3(),
    })
    .unwrap()
}
