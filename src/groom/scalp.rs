//! The scalp of the built-in head: its hairline, its parting, a mesh for guides to stand on, and places for roots.

use super::builtin::head;
use super::hash::Draws;
use super::interpolate::{Placement, Stray, nearest_first, stray};
use glam::{Vec3, vec3};
use std::f32::consts::PI;

/// The parting lies in the plane x = `PARTING_X`, in metres, a little to the head's left.
pub(crate) const PARTING_X: f32 = 0.022;

/// Where rays to the scalp start: inside the skull, in the parting's plane.
const CENTRE: Vec3 = vec3(PARTING_X, 0.02, -0.018);

/// Vertices of one side's mesh, from the parting to the ear and from the forehead over the crown to the nape.
const ACROSS: usize = 20;
const ALONG: usize = 66;

/// The mesh's angles in radians: away from the parting's plane, and around the x axis from the face over the crown.
const ACROSS_ANGLES: [f32; 2] = [0.0, 1.52];
const ALONG_ANGLES: [f32; 2] = [-1.0, 4.25];

/// The hairline's height in metres by azimuth (0 before the face, π behind it; either side of the head).
const HAIRLINE: [[f32; 2]; 12] = [
    [0.0, 0.077],
    [0.35, 0.079],
    [0.60, 0.072],
    [0.80, 0.052],
    [1.05, 0.034],
    [1.22, 0.004],
    [1.38, -0.012],
    [1.55, 0.012],
    [1.80, 0.024],
    [2.05, -0.020],
    [2.40, -0.062],
    [PI, -0.080],
];

/// The width of the zone, in metres, in which hair thins out towards the hairline.
const HAIRLINE_SOFTNESS: f32 = 0.007;

/// No hair grows closer to an ear than this, in metres.
const EAR_MARGIN: f32 = 0.002;

/// Guide roots on the scalp, each side of the parting for itself, so that no triangle spans the parting.
pub(crate) struct Scalp {
    pub(crate) roots: Vec<Vec3>,
    pub(crate) normals: Vec<Vec3>,
    /// The side of the parting that a root belongs to: -1 or 1, the sign of x.
    pub(crate) sides: Vec<f32>,
    /// What a guide's random choices hang on; the same for the two sides' guides on the parting's plane.
    pub(crate) keys: Vec<u32>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// Height over the hairline in metres; negative where no hair grows.
pub(crate) fn height_over_hairline(p: Vec3) -> f32 {
    let azimuth = p.x.abs().atan2(p.z + 0.01);
    let after = HAIRLINE
        .iter()
        .position(|[angle, _]| *angle >= azimuth)
        .unwrap_or(HAIRLINE.len() - 1)
        .max(1);
    let ([a, low], [b, high]) = (HAIRLINE[after - 1], HAIRLINE[after]);
    let t = ((azimuth - a) / (b - a)).clamp(0.0, 1.0);
    let height = p.y - (low + (high - low) * t * t * (3.0 - 2.0 * t));
    height.min(head::ears(p) - EAR_MARGIN)
}

impl Scalp {
    /// The scalp's mesh, with a margin of one vertex below the hairline.
    pub(crate) fn new() -> Self {
        let mut scalp = Self {
            roots: Vec::new(),
            normals: Vec::new(),
            sides: Vec::new(),
            keys: Vec::new(),
            triangles: Vec::new(),
        };
        for side in [-1.0, 1.0] {
            let first = scalp.roots.len() as u32;
            for along in 0..ALONG {
                for across in 0..ACROSS {
                    scalp.add_root(side, along, across);
                }
            }
            for along in 0..ALONG as u32 - 1 {
                for across in 0..ACROSS as u32 - 1 {
                    let a = first + along * ACROSS as u32 + across;
                    let (b, c, d) = (a + 1, a + ACROSS as u32, a + ACROSS as u32 + 1);
                    scalp.add_triangle([a, b, c]);
                    scalp.add_triangle([b, d, c]);
                }
            }
        }
        scalp
    }

    fn add_root(&mut self, side: f32, along: usize, across: usize) {
        let angle = |[first, last]: [f32; 2], i: usize, n: usize| {
            first + (last - first) * i as f32 / (n - 1) as f32
        };
        let (sin, cos) = angle(ACROSS_ANGLES, across, ACROSS).sin_cos();
        let around = angle(ALONG_ANGLES, along, ALONG);
        let direction = vec3(side * sin, cos * around.sin(), cos * around.cos());
        let root = march_out(direction);
        self.roots.push(root);
        self.normals
            .push(head::gradient(head::skull_of, root, 1e-3));
        self.sides.push(side);
        let other_side = if side > 0.0 && across > 0 {
            (ALONG * ACROSS) as u32
        } else {
            0
        };
        self.keys
            .push((along * ACROSS + across) as u32 + other_side);
    }

    fn add_triangle(&mut self, triangle: [u32; 3]) {
        let grows = |guide: &u32| height_over_hairline(self.roots[*guide as usize]) > 0.0;
        if triangle.iter().any(grows) {
            self.triangles.push(triangle);
        }
    }

    /// `count` places for strands, evenly by area, thinning at the hairline; `clump` gives each guide's clump.
    pub(crate) fn placements(
        &self,
        count: usize,
        clump: &[f32],
        strays: &Stray,
        seed: u32,
    ) -> Vec<Placement> {
        let corner = |guide: u32| self.roots[guide as usize];
        let mut ends = Vec::with_capacity(self.triangles.len());
        let mut total = 0.0f64;
        for t in &self.triangles {
            let area = (corner(t[1]) - corner(t[0]))
                .cross(corner(t[2]) - corner(t[0]))
                .length();
            total += f64::from(area);
            ends.push(total);
        }
        let mut placements = Vec::with_capacity(count);
        let mut candidate = 0u32;
        while placements.len() < count {
            let mut draws = Draws::new(candidate, seed);
            // A golden-ratio sequence spreads candidates more evenly over the area than chance does.
            let along = (f64::from(candidate) * 0.618_033_988_749_894_9).fract() * total;
            let guides = self.triangles[ends
                .partition_point(|end| *end <= along)
                .min(ends.len() - 1)];
            candidate = candidate.wrapping_add(1);
            let root = draws.barycentrics();
            let position: Vec3 = (0..3).map(|k| corner(guides[k]) * root[k]).sum();
            if height_over_hairline(position) < HAIRLINE_SOFTNESS * draws.uniform() {
                continue;
            }
            let nearest = (0..3)
                .max_by(|a, b| root[*a].total_cmp(&root[*b]))
                .unwrap_or(0);
            let reach = 1.0 - clump[guides[nearest] as usize];
            placements.push(Placement {
                guides,
                root,
                tip: nearest_first(root, draws.corner_barycentrics(reach)),
                stray: stray(&mut draws, strays),
            });
        }
        placements
    }
}

/// Where the ray from the centre leaves the skull.
fn march_out(direction: Vec3) -> Vec3 {
    let mut reach = 0.0;
    for _ in 0..60 {
        reach -= 0.9 * head::skull_of(CENTRE + direction * reach);
    }
    CENTRE + direction * reach
}
