//! Curves as polylines.

use super::{strands_of, three_guides};
use pelage::groom::{Curve, Strands, tessellate};
use proptest::prelude::*;

#[test]
fn a_polyline_in_one_piece_is_itself() {
    let strands = three_guides();
    assert_eq!(tessellate(&strands, 1).unwrap(), strands);
}

#[test]
fn a_spline_through_points_on_a_line_stays_on_it() {
    let points = (0..5).map(|i| [i as f32, 2.0 * i as f32, 0.0]).collect();
    let cut = tessellate(
        &Strands::new(points, &[5], 1.0)
            .unwrap()
            .with_curve(Curve::CatmullRom),
        4,
    )
    .unwrap();
    for (i, [x, y, _]) in cut.points().iter().enumerate() {
        // Rounding of a few operations on numbers up to 8.
        assert!((x - i as f32 / 4.0).abs() < 1e-5 && (y - 2.0 * x).abs() < 1e-5);
    }
}

#[test]
fn no_pieces_and_too_many_are_refused() {
    for pieces in [0, u32::MAX] {
        let error = tessellate(&three_guides(), pieces).unwrap_err().to_string();
        assert!(
            error.contains(&format!("pieces_per_segment {pieces}")),
            "{error}"
        );
    }
    assert_eq!(
        tessellate(&Strands::default(), 3).unwrap().strand_count(),
        0
    );
}

#[test]
fn lone_points_stay_lone() {
    let lone = Strands::new(vec![[1.0; 3]], &[1], 1.0)
        .unwrap()
        .with_curve(Curve::CatmullRom);
    assert_eq!(tessellate(&lone, 8).unwrap().points(), [[1.0; 3]]);
}

proptest! {
    #[test]
    fn splines_pass_through_every_point_without_kinks(
        points in prop::collection::vec(prop::array::uniform3(-1.0f32..1.0), 3..9),
    ) {
        const PIECES: usize = 1024;
        let count = points.len();
        let strands = Strands::new(points.clone(), &[count as u32], 0.5).unwrap().with_curve(Curve::CatmullRom);
        let cut = tessellate(&strands, PIECES as u32).unwrap();
        prop_assert_eq!(cut.points().len(), (count - 1) * PIECES + 1);
        prop_assert_eq!(cut.curve(), Curve::Polyline);
        for (i, point) in points.iter().enumerate() {
            prop_assert_eq!(cut.points()[i * PIECES], *point);
            prop_assert_eq!(cut.coordinates()[i * PIECES], strands.coordinates()[i]);
        }
        for i in 1..count - 1 {
            let [before, at, after] = [i * PIECES - 1, i * PIECES, i * PIECES + 1].map(|k| cut.points()[k]);
            for axis in 0..3 {
                // Second derivatives are at most 20 for points within a unit, so that one-sided slopes over 1/1024 differ
                // by less than 20/1024 from the common tangent.
                let kink = ((after[axis] - at[axis]) - (at[axis] - before[axis])) * PIECES as f32;
                prop_assert!(kink.abs() < 2.0 * 20.0 / PIECES as f32, "{}", kink);
            }
        }
    }
}

#[test]
fn pieces_hold_the_strands_apart() {
    let cut = tessellate(&three_guides().with_curve(Curve::CatmullRom), 3).unwrap();
    assert_eq!(
        strands_of(&cut).map(<[_]>::len).collect::<Vec<_>>(),
        [7, 7, 7]
    );
}
