//! A radius for grooms whose file has none.

use super::Strands;

/// How often the fibres' side-on area should cover the surface of the groom's box. A human head of hair has about 4:
/// 100,000 fibres of 0.2 m length and 40 µm radius show 1.6 m², and a box around them has a surface of 0.4 m².
const COVERS: f64 = 4.0;

/// The thinnest and thickest fitting radius as fractions of the box's diagonal.
const RADIUS_OVER_DIAGONAL: [f64; 2] = [2e-5, 1e-3];

impl Strands {
    /// A radius, in host units, with which this groom looks like hair at its own size: the one with which the fibres'
    /// summed side-on area, Σ length × 2 radius, is four times the surface of the bounding box, kept
    /// between 2·10⁻⁵ and 10⁻³ of the box's diagonal. Zero where all points coincide or there are none.
    ///
    /// Meant for files that carry no radius; use it with [`Strands::with_root_tip_radii`].
    pub fn fitting_radius(&self) -> f32 {
        let Some((low, high)) = self.bounds() else {
            return 0.0;
        };
        let [x, y, z] = std::array::from_fn(|axis| f64::from(high[axis]) - f64::from(low[axis]));
        let diagonal = (x * x + y * y + z * z).sqrt();
        let surface = 2.0 * (x * y + y * z + z * x);
        let covering = COVERS * surface / (2.0 * self.total_length());
        let [thinnest, thickest] = RADIUS_OVER_DIAGONAL.map(|fraction| fraction * diagonal);
        // A groom of lone points has no length; its radius is never seen.
        let radius = if covering.is_finite() {
            covering.clamp(thinnest, thickest)
        } else {
            thinnest
        };
        radius.min(f64::from(f32::MAX)) as f32
    }

    /// The summed length of all segments, in host units.
    fn total_length(&self) -> f64 {
        let length = |pair: &[[f32; 3]]| -> f64 {
            let squares =
                (0..3).map(|axis| (f64::from(pair[1][axis]) - f64::from(pair[0][axis])).powi(2));
            squares.sum::<f64>().sqrt()
        };
        (0..self.strand_count())
            .flat_map(|strand| self.points()[self.range(strand)].windows(2))
            .map(length)
            .sum()
    }
}
