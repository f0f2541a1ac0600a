//! Whole frames of every shading model in one run: they take turns, so that whatever else the machine does meets all alike.

use indicatif::ProgressBar;
use pelage::shading::ShadingRate;

use super::ladder::Case;
use super::measure::{Bench, row, spread};
use super::row::{Error, Row};
use super::scenes::Scene;
use super::truth::Truth;
use crate::Result;

/// Rounds that are timed.
const ROUNDS: usize = 9;

/// Whether fibres are shaded in passes of their own: fragments are where they are composited.
fn has_passes(case: &Case) -> bool {
    case.rate != Some(ShadingRate::Fragment)
}

/// Measures all cases; ratios are to the first.
pub fn measure(
    scene: &Scene,
    truth: &Truth,
    cases: &[Case],
    progress: &ProgressBar,
) -> Result<Vec<Row>> {
    let mut benches = Vec::new();
    for case in cases {
        progress.set_message(format!("preparing {case}"));
        let mut bench = Bench::new(scene, truth, case)?;
        bench.warm_up(case)?;
        benches.push(bench);
    }
    let mut frames = vec![Vec::new(); cases.len()];
    let mut shading = vec![Vec::new(); cases.len()];
    for round in 0..ROUNDS {
        progress.set_message(format!("round {} of {ROUNDS}", round + 1));
        for (at, (bench, case)) in benches.iter_mut().zip(cases).enumerate() {
            frames[at].push(bench.render(case.shadow, case.transparency)?);
        }
        for (at, (bench, case)) in benches.iter_mut().zip(cases).enumerate() {
            if has_passes(case) {
                shading[at].push(bench.pass_time(case, "pelage.shading.")?);
            }
        }
    }
    let first = frames[0].clone();
    let mut rows = Vec::new();
    for (at, case) in cases.iter().enumerate() {
        let ratios = std::iter::zip(&frames[at], &first)
            .map(|(ms, first)| ms / first)
            .collect();
        let bench = &mut benches[at];
        let bytes = bench.bytes();
        rows.push(Row {
            ratio: Some(spread(ratios)),
            shading_ms: has_passes(case).then(|| spread(shading[at].clone())),
            bytes,
            ..row(
                scene,
                case,
                Error::default(),
                spread(frames[at].clone()),
                bench.adapter(),
            )
        });
    }
    Ok(rows)
}
