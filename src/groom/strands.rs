//! Strands: many curves, root first, with radii, colours and root-to-tip coordinates.

use crate::error::{Result, invalid};

/// The largest number of points that one groom may have.
pub const MAX_POINTS: usize = 1 << 28;

/// How the points of a strand make a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
#[non_exhaustive]
pub enum Curve {
    /// Straight segments between the points.
    #[default]
    Polyline,
    /// A uniform Catmull-Rom spline through every point.
    CatmullRom,
}

/// A set of strands: the validated input of everything that draws.
///
/// Every strand has at least one point, root first; a strand of one point is kept and draws nothing. Positions are
/// finite, in host units. Radii are finite and not negative, one a point. Colours are linear RGB factors, finite and
/// not negative, one a strand. Coordinates run from 0 at the root to 1 at the tip, one a point.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Strands {
    points: Vec<[f32; 3]>,
    offsets: Vec<u32>,
    radii: Vec<f32>,
    colours: Vec<[f32; 3]>,
    coordinates: Vec<f32>,
    curve: Curve,
}

impl Strands {
    /// Makes strands from `points` (all strands' points one after the other, root first) and `counts` (points a
    /// strand), of constant `radius`, white, with coordinates by arc length.
    ///
    /// # Errors
    /// A count of zero, counts that do not sum to the number of points, a position or radius that is not finite, a
    /// negative radius, more than 2²⁸ points.
    pub fn new(points: Vec<[f32; 3]>, counts: &[u32], radius: f32) -> Result<Self> {
        if points.len() > MAX_POINTS {
            return invalid!("{} points: a groom has at most {MAX_POINTS}", points.len());
        }
        let mut offsets = Vec::with_capacity(counts.len() + 1);
        offsets.push(0u32);
        let mut end = 0usize;
        for (strand, &count) in counts.iter().enumerate() {
            if count == 0 {
                return invalid!("strand {strand}: a count of 0 points; a strand has at least one");
            }
            end = end.saturating_add(count as usize);
            if end > points.len() {
                return invalid!(
                    "the counts reach {end} points at strand {strand}, but {} are given",
                    points.len()
                );
            }
            offsets.push(end as u32);
        }
        if end != points.len() {
            return invalid!(
                "the counts sum to {end} points, but {} are given",
                points.len()
            );
        }
        let mut strands = Self {
            radii: Vec::new(),
            colours: vec![[1.0; 3]; counts.len()],
            coordinates: Vec::new(),
            points,
            offsets,
            curve: Curve::Polyline,
        };
        if let Some(at) = strands
            .points
            .iter()
            .position(|p| !p.iter().all(|c| c.is_finite()))
        {
            let [x, y, z] = strands.points[at];
            return invalid!(
                "{}: position ({x}, {y}, {z}) is not finite",
                strands.place(at)
            );
        }
        strands.coordinates = strands.arc_length_coordinates();
        let radii = vec![radius; strands.points.len()];
        strands.with_point_radii(radii)
    }

    /// Sets radii that run linearly in the coordinate from `root` to `tip`.
    ///
    /// # Errors
    /// A radius that is negative or not finite.
    pub fn with_root_tip_radii(self, root: f32, tip: f32) -> Result<Self> {
        let radii = self
            .coordinates
            .iter()
            .map(|u| root + (tip - root) * u)
            .collect();
        self.with_point_radii(radii)
    }

    /// Sets one radius a point.
    ///
    /// # Errors
    /// Another number than one a point; a radius that is negative or not finite.
    pub fn with_point_radii(mut self, radii: Vec<f32>) -> Result<Self> {
        if radii.len() != self.points.len() {
            return invalid!(
                "{} radii for {} points: one a point is needed",
                radii.len(),
                self.points.len()
            );
        }
        if let Some(at) = radii.iter().position(|r| !(r.is_finite() && *r >= 0.0)) {
            return invalid!(
                "{}: radius {} is not a finite number of at least 0",
                self.place(at),
                radii[at]
            );
        }
        self.radii = radii;
        Ok(self)
    }

    /// Sets one linear RGB factor a strand.
    ///
    /// # Errors
    /// Another number than one a strand; a component that is negative or not finite.
    pub fn with_colours(mut self, colours: Vec<[f32; 3]>) -> Result<Self> {
        if colours.len() != self.strand_count() {
            return invalid!(
                "{} colours for {} strands: one a strand is needed",
                colours.len(),
                self.strand_count()
            );
        }
        if let Some(at) = colours
            .iter()
            .position(|c| !c.iter().all(|v| v.is_finite() && *v >= 0.0))
        {
            let [r, g, b] = colours[at];
            return invalid!(
                "strand {at}: colour ({r}, {g}, {b}) has a component that is negative or not finite"
            );
        }
        self.colours = colours;
        Ok(self)
    }

    /// Sets one root-to-tip coordinate a point, from 0 to 1, not falling along a strand.
    ///
    /// # Errors
    /// Another number than one a point; a coordinate outside 0…1, or that falls along its strand.
    pub fn with_coordinates(mut self, coordinates: Vec<f32>) -> Result<Self> {
        if coordinates.len() != self.points.len() {
            return invalid!(
                "{} coordinates for {} points: one a point is needed",
                coordinates.len(),
                self.points.len()
            );
        }
        if let Some(at) = coordinates.iter().position(|u| !(0.0..=1.0).contains(u)) {
            return invalid!(
                "{}: coordinate {} is not between 0 and 1",
                self.place(at),
                coordinates[at]
            );
        }
        for span in self.offsets.windows(2) {
            let (first, end) = (span[0] as usize, span[1] as usize);
            if let Some(at) = (first + 1..end).find(|&at| coordinates[at] < coordinates[at - 1]) {
                return invalid!(
                    "{}: coordinate {} falls along the strand",
                    self.place(at),
                    coordinates[at]
                );
            }
        }
        self.coordinates = coordinates;
        Ok(self)
    }

    /// Sets how the points make a curve.
    pub fn with_curve(mut self, curve: Curve) -> Self {
        self.curve = curve;
        self
    }

    /// Replaces every position, for moving hair; everything else is kept.
    ///
    /// # Errors
    /// Another number of points, or a position that is not finite; the strands are then as they were.
    pub fn set_points(&mut self, points: &[[f32; 3]]) -> Result<()> {
        if points.len() != self.points.len() {
            return invalid!(
                "{} positions for {} points",
                points.len(),
                self.points.len()
            );
        }
        if let Some(at) = points.iter().position(|p| !p.iter().all(|c| c.is_finite())) {
            let [x, y, z] = points[at];
            return invalid!("{}: position ({x}, {y}, {z}) is not finite", self.place(at));
        }
        self.points.copy_from_slice(points);
        Ok(())
    }

    /// All positions, strand after strand, root first.
    pub fn points(&self) -> &[[f32; 3]] {
        &self.points
    }

    /// One radius a point.
    pub fn radii(&self) -> &[f32] {
        &self.radii
    }

    /// One linear RGB factor a strand.
    pub fn colours(&self) -> &[[f32; 3]] {
        &self.colours
    }

    /// One root-to-tip coordinate a point.
    pub fn coordinates(&self) -> &[f32] {
        &self.coordinates
    }

    /// How the points make a curve.
    pub fn curve(&self) -> Curve {
        self.curve
    }

    /// Strand `s` has the points `offsets[s]..offsets[s + 1]`; one entry more than there are strands.
    pub fn offsets(&self) -> &[u32] {
        if self.offsets.is_empty() {
            &[0]
        } else {
            &self.offsets
        }
    }

    /// The points of strand `s` as a range into [`Strands::points`].
    pub fn range(&self, strand: usize) -> std::ops::Range<usize> {
        self.offsets[strand] as usize..self.offsets[strand + 1] as usize
    }

    /// The number of strands.
    pub fn strand_count(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// The number of segments between consecutive points.
    pub fn segment_count(&self) -> usize {
        self.points.len() - self.strand_count()
    }

    /// The lowest and the highest corner of the box around all points, or `None` where there are no points.
    pub fn bounds(&self) -> Option<([f32; 3], [f32; 3])> {
        let first = *self.points.first()?;
        Some(self.points.iter().fold((first, first), |(low, high), p| {
            (
                std::array::from_fn(|axis| low[axis].min(p[axis])),
                std::array::from_fn(|axis| high[axis].max(p[axis])),
            )
        }))
    }

    /// Arc length from the root over the strand's length; evenly by index where the length is zero.
    fn arc_length_coordinates(&self) -> Vec<f32> {
        let mut coordinates = Vec::with_capacity(self.points.len());
        for span in self.offsets.windows(2) {
            let strand = &self.points[span[0] as usize..span[1] as usize];
            let first = coordinates.len();
            let mut length = 0.0f64;
            coordinates.push(0.0);
            for pair in strand.windows(2) {
                length += (0..3)
                    .map(|axis| (pair[1][axis] as f64 - pair[0][axis] as f64).powi(2))
                    .sum::<f64>()
                    .sqrt();
                coordinates.push(length as f32);
            }
            let last = (strand.len() - 1).max(1) as f32;
            for (at, u) in coordinates[first..].iter_mut().enumerate() {
                *u = if length > 0.0 && length.is_finite() {
                    (*u as f64 / length).clamp(0.0, 1.0) as f32
                } else {
                    at as f32 / last
                };
            }
        }
        coordinates
    }

    /// Names the point `at` for an error.
    fn place(&self, at: usize) -> String {
        let strand = self.offsets.partition_point(|&first| first as usize <= at) - 1;
        format!(
            "strand {strand}, point {}",
            at - self.offsets[strand] as usize
        )
    }
}
