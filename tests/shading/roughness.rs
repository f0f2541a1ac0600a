//! Roughness that varies between strands and along them, against the reference of the roughness that it comes to.

use pelage::shading::{Chiang, Marschner, Precision, RoughnessVariation, Sadeghi, Shading, Tables};
use pelage::testing;

use super::harness::{Case, Evaluator, hard_cases};
use super::reference::{of_chiang, of_marschner, of_sadeghi};
use super::{chiang, marschner, sadeghi};
use crate::common::device;

const VARIATION: RoughnessVariation = RoughnessVariation {
    strand: 0.5,
    tip: 1.6,
};

/// A strand's random number, from 0 to 1 (PCG with the word of Jarzynski and Olano 2020).
fn random(strand: u32, seed: u32) -> f64 {
    let state = (strand ^ seed.wrapping_mul(0x9e37_79b9))
        .wrapping_mul(747_796_405)
        .wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    f64::from(((word >> 22) ^ word) >> 8) / f64::from(1u32 << 24)
}

/// How many times as rough as its model a fibre is there.
fn factor(strand: u32, coordinate: f64) -> f32 {
    let own = 1.0 + f64::from(VARIATION.strand) * (2.0 * random(strand, 3) - 1.0);
    (own * (1.0 + (f64::from(VARIATION.tip) - 1.0) * coordinate)) as f32
}

/// As the models' own tests: 4e-4 for 128 intervals across the fibre, and where β_n comes to 0.15 or less.
const USUAL: f64 = 1e-3;

#[test]
fn varied_fibres_are_those_of_the_roughness_that_it_comes_to() {
    let Some(mut device) = device() else { return };
    let own = |strand, coordinate, sums: &[f64]| -> Vec<Case> {
        let cases = hard_cases(sums).into_iter().step_by(3);
        cases
            .map(|case| Case {
                strand,
                coordinate,
                ..case
            })
            .collect()
    };
    let factors: Vec<f32> = (0..40).map(|strand| factor(strand, 0.0)).collect();
    let (least, most) = factors
        .iter()
        .fold((2.0f32, 0.0f32), |(a, b), f| (a.min(*f), b.max(*f)));
    assert!(
        (0.5..0.6).contains(&least) && (1.4..=1.5).contains(&most),
        "{least} {most}"
    );

    let rough = Chiang {
        roughness: VARIATION,
        ..chiang::direct()
    };
    let smooth = Marschner {
        roughness: VARIATION,
        ..marschner::direct()
    };
    let artist = Sadeghi {
        roughness: VARIATION,
        ..sadeghi::plain()
    };
    let evaluators = [
        Shading::Chiang(rough),
        Shading::Marschner(smooth),
        Shading::Sadeghi(artist),
    ]
    .map(|shading| Evaluator::new(&mut device, &shading));
    for (strand, coordinate) in [(0, 0.0), (7, 0.0), (19, 0.5), (1234, 1.0)] {
        let scale = factor(strand, coordinate);
        let name =
            |model| format!("{model}, strand {strand} at {coordinate}, {scale:.3} times as rough");
        let truth = of_chiang(&Chiang {
            beta_m: (rough.beta_m * scale).clamp(1e-3, 1.0),
            beta_n: (rough.beta_n * scale).clamp(1e-3, 1.0),
            ..chiang::direct()
        });
        let a = f64::from(rough.alpha);
        let cases = own(strand, coordinate, &[-2.0 * a, a, 4.0 * a]);
        let error = evaluators[0].worst(&name("chiang"), &Shading::Chiang(rough), &cases, &truth);
        assert!(error <= USUAL, "{}: {error:e}", name("chiang"));

        let truth = of_marschner(&Marschner {
            beta: smooth.beta.map(|beta| beta * scale),
            ..marschner::direct()
        });
        let cases = own(
            strand,
            coordinate,
            &smooth.alpha.map(|a| 2.0 * f64::from(a)),
        );
        let error = evaluators[1].worst(
            &name("marschner"),
            &Shading::Marschner(smooth),
            &cases,
            &truth,
        );
        assert!(error <= USUAL, "{}: {error:e}", name("marschner"));

        let mut wide = sadeghi::plain();
        for lobe in [&mut wide.r, &mut wide.tt, &mut wide.trt] {
            lobe.width *= scale;
            // As much light in a wider lobe.
            lobe.intensity /= scale;
        }
        let cases = own(strand, coordinate, &[0.0]);
        let error = evaluators[2].worst(
            &name("sadeghi"),
            &Shading::Sadeghi(artist),
            &cases,
            &of_sadeghi(&wide),
        );
        assert!(error <= USUAL, "{}: {error:e}", name("sadeghi"));
    }
}

#[test]
fn a_varied_chiang_makes_no_tables_and_a_varied_marschner_keeps_them() {
    let tables = Some(Tables {
        size: 64,
        precision: Precision::F32,
    });
    let words = |shading: Shading| testing::tables_of(&shading, false).2;
    let varied = Shading::Chiang(Chiang {
        tables,
        roughness: VARIATION,
        ..Chiang::default()
    });
    let own = Shading::Chiang(Chiang {
        tables,
        ..Chiang::default()
    });
    // A table of N is of one β_n; Marschner's holds none.
    assert_eq!(words(varied), 0);
    assert_eq!(words(own), 64 * 64 * 10);
    let varied = Shading::Marschner(Marschner {
        tables,
        roughness: VARIATION,
        ..Marschner::default()
    });
    assert_eq!(words(varied), 64 * 64 * 10);
}

#[test]
fn a_variation_out_of_range_is_named() {
    for (roughness, named) in [
        (
            RoughnessVariation {
                strand: 0.95,
                tip: 1.0,
            },
            "roughness.strand",
        ),
        (
            RoughnessVariation {
                strand: 0.0,
                tip: f32::NAN,
            },
            "roughness.tip",
        ),
    ] {
        for shading in [
            Shading::Chiang(Chiang {
                roughness,
                ..Chiang::default()
            }),
            Shading::Marschner(Marschner {
                roughness,
                ..Marschner::default()
            }),
            Shading::Sadeghi(Sadeghi {
                roughness,
                ..Sadeghi::default()
            }),
        ] {
            let error = shading.validate().unwrap_err().to_string();
            assert!(error.contains(named), "{error}");
        }
    }
}
