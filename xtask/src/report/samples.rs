//! A shading model by itself: nanoseconds a shaded sample, and its error against the exact model.

use pelage::host::offscreen::{Offscreen, OffscreenOptions};
use pelage::shading::{Evaluator, Precision, Roots, Sample, Shading};

use super::ladder::Case;
use super::measure::{error_of, row, sentence, spread};
use super::row::Row;
use super::scenes::Scene;
use super::truth::Truth;
use crate::Result;

/// Samples of one evaluation that is timed: the groom's points in their order, again and again.
const SAMPLES: usize = 1 << 18;
/// Evaluations that are timed, each of all samples: as many as take this long in seconds. They are short and many, so that the
/// least is one that nothing else disturbed.
const SECONDS: f64 = 4.0;
/// The least and the most.
const REPEATS: [f64; 2] = [3.0, 40.0];
/// Samples that are compared at most: the reference integrates each.
const COMPARED: usize = 8192;

/// Measures a model over the scene's strand points.
pub fn measure(scene: &Scene, truth: &Truth, case: &Case) -> Result<Row> {
    let offscreen = Offscreen::new(&OffscreenOptions::default()).map_err(sentence)?;
    let (device, queue) = (offscreen.renderer.device(), offscreen.renderer.queue());
    let evaluator = Evaluator::new(device, queue).map_err(sentence)?;
    let points = truth.samples();

    let stride = points.len().div_ceil(COMPARED);
    let compared: Vec<Sample> = points.iter().copied().step_by(stride).collect();
    let values = evaluator
        .scatter(&case.shading, &compared)
        .map_err(sentence)?;
    let expected = truth.scatter_samples(&exact(&case.shading), &compared)?;
    let mean_square = expected
        .iter()
        .map(|v| v.length_squared() / 3.0)
        .sum::<f64>();
    let whole = (mean_square / expected.len() as f64).sqrt();
    let differences = std::iter::zip(values, expected)
        .flat_map(|(value, expected)| ((value.as_dvec3() - expected).abs() / whole).to_array())
        .collect();

    let timed: Vec<Sample> = points.iter().copied().cycle().take(SAMPLES).collect();
    let times = |repeats: usize| {
        let times = evaluator.times(&case.shading, &timed, repeats);
        times.map_err(sentence)
    };
    let first = times(1)?[0].as_secs_f64();
    let times = times((SECONDS / first).clamp(REPEATS[0], REPEATS[1]) as usize)?;
    let times = times.iter().map(|time| time.as_secs_f64() * 1e3).collect();
    Ok(Row {
        samples: Some(SAMPLES as u64),
        bytes: table_bytes(&case.shading),
        ..row(
            scene,
            case,
            error_of(differences),
            spread(times),
            offscreen.adapter_info(),
        )
    })
}

/// The model that a shortcut stands for.
fn exact(shading: &Shading) -> Shading {
    match *shading {
        Shading::Marschner(mut model) => {
            model.roots = Roots::Exact;
            Shading::Marschner(model)
        }
        other => other,
    }
}

/// Bytes of a model's tables of azimuthal functions.
fn table_bytes(shading: &Shading) -> u64 {
    let tables = match shading {
        Shading::Marschner(model) => model.tables,
        Shading::Chiang(model) => model.tables,
        _ => None,
    };
    tables.map_or(0, |tables| {
        let each = if tables.precision == Precision::F32 {
            40
        } else {
            20
        };
        u64::from(tables.size).pow(2) * each
    })
}
