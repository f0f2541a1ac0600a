//! How densely a groom fills space.

use glam::{DVec3, Vec3};

use super::Strands;

/// Cells along the longest side of the box around the strands, from a few strands to many.
const CELLS: [f64; 2] = [8.0, 32.0];
/// Points that a cell should hold on average, so that gaps between neighbouring strands do not count as empty.
const POINTS_A_CELL: f64 = 8.0;

/// What a ray through a groom meets on average, in the groom's own units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Density {
    /// Of the cells of a grid through which a strand passes.
    pub volume: f64,
    /// Mean over the strands' length.
    pub diameter: f64,
}

/// Measures strands; curves by their control polygons.
pub(crate) fn density(strands: &Strands) -> Density {
    let (low, high) = strands.bounds().unwrap_or_default();
    let low = Vec3::from(low).as_dvec3();
    let size = (Vec3::from(high).as_dvec3() - low).max_element();
    let mut measured = Density {
        volume: 0.0,
        diameter: 0.0,
    };
    if size <= 0.0 {
        return measured;
    }
    let wanted = (strands.points().len() as f64 / POINTS_A_CELL).cbrt();
    let cells = wanted.clamp(CELLS[0], CELLS[1]).round();
    let cell = size / cells;
    let side = cells as usize + 1;
    let mut filled = vec![false; side.pow(3)];
    let (mut length, mut area) = (0.0, 0.0);
    for strand in 0..strands.strand_count() {
        let range = strands.range(strand);
        for at in range.start..range.end.saturating_sub(1) {
            let [a, b] = [at, at + 1].map(|at| Vec3::from(strands.points()[at]).as_dvec3());
            let radii = f64::from(strands.radii()[at] + strands.radii()[at + 1]);
            let segment = a.distance(b);
            length += segment;
            area += radii * segment;
            // Half a cell a step: no cell that is crossed by more than a corner is missed.
            let steps = (2.0 * segment / cell).ceil().max(1.0) as usize;
            for step in 0..=steps {
                let place: DVec3 = (a.lerp(b, step as f64 / steps as f64) - low) / cell;
                let [x, y, z] = place.to_array().map(|c| (c as usize).min(side - 1));
                filled[(z * side + y) * side + x] = true;
            }
        }
    }
    if length > 0.0 {
        measured.diameter = area / length;
        measured.volume = filled.iter().filter(|cell| **cell).count() as f64 * cell.powi(3);
    }
    measured
}
