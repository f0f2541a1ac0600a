//! The models, the directions at which they are evaluated, and the lobes found there.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use pelage::glam::{DVec3, Vec3};
use pelage::shading::{
    Chiang, Evaluator, HairColour, KajiyaKay, Marschner, Sadeghi, Sample, Scheuermann, Shading,
};
use pelage_reference::fibre::{Direction, FibreModel};
use pelage_reference::{kajiya_kay, scheuermann};

use crate::reference;

/// Directions of a curve.
const STEPS: usize = 360;
/// The light's inclination in the plots along the fibre.
pub const LIGHT: f64 = 30.0 * PI / 180.0;
/// A strand's own colours by which lobes are told apart: R does not depend on it, TT is proportional to it, TRT to its square,
/// the residual to its cube. So far from one another that each lobe outweighs the rest in one of the values.
const COLOURS: [f64; 4] = [0.0, 1.0, 16.0, 256.0];

/// A model to be drawn.
pub struct Model {
    /// The file's stem.
    pub name: &'static str,
    /// What stands above the plots.
    pub title: &'static str,
    /// Its parameters.
    pub shading: Shading,
    lobes: Lobes,
}

/// How a model's lobes are told apart.
enum Lobes {
    /// Each is the whole of a model whose other coefficients are 0.
    Alone(Vec<(&'static str, Shading, Value)>),
    /// By the strand's own colour.
    ByColour(Box<dyn FibreModel>, &'static [&'static str]),
}

/// The reference's value at a tangent, towards light and eye.
type Value = Box<dyn Fn(DVec3, DVec3, DVec3) -> DVec3>;

/// One lobe, or the sum, along a plot's directions.
pub struct Curve {
    /// Its name.
    pub name: &'static str,
    /// Angles in the plot, and the GPU's and the reference's values there.
    pub points: Vec<(f64, DVec3, DVec3)>,
}

impl Curve {
    /// The reference's largest value.
    pub fn peak(&self) -> f64 {
        let largest =
            |peak: f64, (_, _, expected): &(f64, DVec3, DVec3)| peak.max(expected.max_element());
        self.points.iter().fold(1e-30, largest)
    }

    /// Whether all channels are alike.
    pub fn is_grey(&self) -> bool {
        let spread = |v: DVec3| v.max_element() - v.min_element();
        self.points
            .iter()
            .all(|(_, _, expected)| spread(*expected) <= 1e-9 * self.peak())
    }

    /// The largest difference, of the peak.
    pub fn error(&self) -> f64 {
        let off = self
            .points
            .iter()
            .map(|(_, value, expected)| (value - expected).abs().max_element());
        off.fold(0.0, f64::max) / self.peak()
    }
}

/// A direction of a plot: its angle there, the light and the eye in the fibre's frame.
pub type View = (f64, Direction, Direction);

/// Around the fibre.
pub fn around() -> Vec<View> {
    let view = |i| {
        let phi = TAU * i as f64 / STEPS as f64;
        (phi, Direction::new(0.0, 0.0), Direction::new(0.0, phi))
    };
    (0..=STEPS).map(view).collect()
}

/// In the plane of the fibre and the light.
pub fn along() -> Vec<View> {
    let view = |i| {
        let angle = TAU * i as f64 / STEPS as f64 - PI;
        let eye = if angle.abs() <= FRAC_PI_2 {
            Direction::new(angle, 0.0)
        } else {
            Direction::new(PI.copysign(angle) - angle, PI)
        };
        (angle, Direction::new(LIGHT, 0.0), eye)
    };
    (0..=STEPS).map(view).collect()
}

/// Blond hair in every model that is one of a fibre.
pub fn models() -> Vec<Model> {
    let sigma_a = HairColour::Blond.sigma_a();
    let chiang = Chiang {
        sigma_a,
        ..Chiang::default()
    };
    let marschner = Marschner {
        sigma_a,
        ..Marschner::default()
    };
    let sadeghi = Sadeghi {
        glint_angle: [0.65; 2],
        ..Sadeghi::default()
    };
    let fibre = |name, title, shading: Shading, model: Box<dyn FibreModel>| Model {
        name,
        title,
        lobes: match shading {
            Shading::Chiang(_) => Lobes::ByColour(model, &["R", "TT", "TRT", "residual"]),
            _ => Lobes::ByColour(model, &["R", "TT", "TRT"]),
        },
        shading,
    };
    let direct = |mut shading: Shading| {
        match &mut shading {
            Shading::Marschner(model) => model.tables = None,
            Shading::Chiang(model) => model.tables = None,
            _ => (),
        }
        shading
    };
    let of_sadeghi = reference::of_sadeghi(&sadeghi);
    let published = Sadeghi {
        normalised: false,
        ..sadeghi
    };
    let [chiang, marschner] = [Shading::Chiang(chiang), Shading::Marschner(marschner)];
    vec![
        kajiya_kay(),
        scheuermann(),
        fibre(
            "marschner",
            "Marschner, direct",
            direct(marschner),
            of(&marschner),
        ),
        fibre(
            "marschner_tables",
            "Marschner, tables of 64 × 64, f16",
            marschner,
            of(&marschner),
        ),
        fibre(
            "sadeghi_published",
            "Sadeghi, as published",
            Shading::Sadeghi(published),
            Box::new(of_sadeghi),
        ),
        fibre(
            "sadeghi",
            "Sadeghi, normalised",
            Shading::Sadeghi(sadeghi),
            Box::new(of_sadeghi.normalised()),
        ),
        fibre(
            "chiang",
            "Chiang, direct, 32 intervals",
            direct(chiang),
            of(&chiang),
        ),
        fibre(
            "chiang_tables",
            "Chiang, tables of 64 × 64, f16",
            chiang,
            of(&chiang),
        ),
    ]
}

fn of(shading: &Shading) -> Box<dyn FibreModel> {
    match shading {
        Shading::Marschner(model) => Box::new(reference::of_marschner(model)),
        Shading::Chiang(model) => Box::new(reference::of_chiang(model)),
        other => unreachable!("{} is not asked for", other.stem()),
    }
}

fn kajiya_kay() -> Model {
    let model = KajiyaKay::default();
    let value = |model: KajiyaKay| -> Value {
        Box::new(move |tangent, to_light, to_eye| {
            DVec3::from_array(std::array::from_fn(|c| {
                let model = kajiya_kay::KajiyaKay {
                    diffuse: f64::from(model.diffuse[c]),
                    specular: f64::from(model.specular[c]),
                    exponent: f64::from(model.exponent),
                };
                kajiya_kay::scatter(tangent, to_light, to_eye, &model)
            }))
        })
    };
    let lobe = |name, model| (name, Shading::KajiyaKay(model), value(model));
    let (mut diffuse, mut specular) = (model, model);
    diffuse.specular = Vec3::ZERO;
    specular.diffuse = Vec3::ZERO;
    Model {
        name: "kajiya_kay",
        title: "Kajiya-Kay",
        shading: Shading::KajiyaKay(model),
        lobes: Lobes::Alone(vec![
            lobe("diffuse", diffuse),
            lobe("specular", specular),
            lobe("sum", model),
        ]),
    }
}

fn scheuermann() -> Model {
    let model = Scheuermann::default();
    let none = Scheuermann {
        diffuse: Vec3::ZERO,
        primary: pelage::shading::Highlight {
            colour: Vec3::ZERO,
            ..model.primary
        },
        secondary: pelage::shading::Highlight {
            colour: Vec3::ZERO,
            ..model.secondary
        },
    };
    let lobe = |name, model: Scheuermann| {
        let exact = reference::of_scheuermann(&model);
        let value: Value = Box::new(move |tangent, to_light, to_eye| {
            scheuermann::scatter(tangent, to_light, to_eye, &exact)
        });
        (name, Shading::Scheuermann(model), value)
    };
    let diffuse = Scheuermann {
        diffuse: model.diffuse,
        ..none
    };
    let primary = Scheuermann {
        primary: model.primary,
        ..none
    };
    let secondary = Scheuermann {
        secondary: model.secondary,
        ..none
    };
    Model {
        name: "scheuermann",
        title: "Scheuermann",
        shading: Shading::Scheuermann(model),
        lobes: Lobes::Alone(vec![
            lobe("diffuse", diffuse),
            lobe("primary", primary),
            lobe("secondary", secondary),
            lobe("sum", model),
        ]),
    }
}

/// Every lobe and the sum along a plot's directions.
pub fn curves(evaluator: &Evaluator, model: &Model, views: &[View]) -> pelage::Result<Vec<Curve>> {
    // Along x; the frame of the reference.
    let sample = |(_, light, eye): &View, colour: f64| Sample {
        colour: Vec3::splat(colour as f32),
        ..Sample::lit(
            Vec3::X,
            light.to_vector().as_vec3(),
            eye.to_vector().as_vec3(),
        )
    };
    let values = |shading: &Shading, colour: f64| -> pelage::Result<Vec<DVec3>> {
        let samples: Vec<Sample> = views.iter().map(|view| sample(view, colour)).collect();
        let values = evaluator.scatter(shading, &samples)?;
        Ok(values.into_iter().map(Vec3::as_dvec3).collect())
    };
    let curve = |name, values: Vec<DVec3>, expected: &dyn Fn(&View) -> DVec3| Curve {
        name,
        points: std::iter::zip(views, values)
            .map(|(view, value)| (view.0, value, expected(view)))
            .collect(),
    };
    match &model.lobes {
        Lobes::Alone(lobes) => lobes
            .iter()
            .map(|(name, shading, exact)| {
                let expected =
                    |(_, light, eye): &View| exact(DVec3::X, light.to_vector(), eye.to_vector());
                Ok(curve(name, values(shading, 1.0)?, &expected))
            })
            .collect(),
        Lobes::ByColour(exact, names) => {
            let coloured = COLOURS.map(|colour| values(&model.shading, colour));
            let [at_0, at_1, at_2, at_3] = coloured;
            let coloured = [at_0?, at_1?, at_2?, at_3?];
            let parts: Vec<[DVec3; 4]> = (0..views.len())
                .map(|i| coefficients([0, 1, 2, 3].map(|k| coloured[k][i])))
                .collect();
            let expected: Vec<[DVec3; 4]> = views
                .iter()
                .map(|(_, light, eye)| exact.scatter_lobes(*light, *eye))
                .collect();
            let mut curves: Vec<Curve> = (names.iter().enumerate())
                .map(|(lobe, name)| Curve {
                    name,
                    points: (0..views.len())
                        .map(|i| (views[i].0, parts[i][lobe], expected[i][lobe]))
                        .collect(),
                })
                .collect();
            curves.push(Curve {
                name: "sum",
                points: (0..views.len())
                    .map(|i| (views[i].0, coloured[1][i], expected[i].iter().sum()))
                    .collect(),
            });
            Ok(curves)
        }
    }
}

/// The coefficients of the cubic polynomial with these values at [`COLOURS`], by divided differences.
fn coefficients(mut f: [DVec3; 4]) -> [DVec3; 4] {
    for order in 1..4 {
        for i in (order..4).rev() {
            f[i] = (f[i] - f[i - 1]) / (COLOURS[i] - COLOURS[i - order]);
        }
    }
    // Newton's form, multiplied out.
    let mut c = [DVec3::ZERO; 4];
    c[0] = f[3];
    for i in (0..3).rev() {
        for k in (1..4).rev() {
            c[k] = c[k - 1] - COLOURS[i] * c[k];
        }
        c[0] = f[i] - COLOURS[i] * c[0];
    }
    c
}
