//! A distance field's zero surface as triangles, by naive surface nets: one vertex a cell that the surface crosses, at
//! the mean of its edge crossings; one quad a crossed grid edge (Gibson, *Constrained elastic surface nets*, 1998).

use super::head::gradient;
use crate::groom::Mesh;
use glam::{IVec3, Vec3, ivec3};
use std::collections::HashMap;

/// Cells along the edge of the blocks that are skipped where the surface is far.
const BLOCK: i32 = 4;

/// A grid's planes on one axis, rising; cells may differ in size.
pub(super) type Planes = Vec<f32>;

/// Planes from `low` to at least `high`, `fine` apart within `half_width` of `focus`, up to `coarse` apart beyond.
pub(super) fn planes(
    [low, high]: [f32; 2],
    focus: f32,
    half_width: f32,
    [fine, coarse]: [f32; 2],
) -> Planes {
    let mut planes = vec![low];
    let mut at = low;
    while at < high || planes.len() % BLOCK as usize != 1 {
        let beyond = ((at - focus).abs() - half_width) / half_width;
        at += fine + (coarse - fine) * beyond.clamp(0.0, 1.0);
        planes.push(at);
    }
    planes
}

/// A skipped block's distance must exceed its half diagonal by this factor, for a field that is only a bound.
const SKIP: f32 = 1.6;

/// The step of a normal's central differences, in metres: smooths what the grid cannot hold.
const NORMAL_STEP: f32 = 0.0012;

/// Polygonises `field` on the grid of the given planes, which must hold the surface.
pub(super) fn polygonise(field: impl Fn(Vec3) -> f32, grid: &[Planes; 3]) -> Mesh {
    let place = |corner: IVec3| {
        Vec3::from_array(std::array::from_fn(|axis| {
            grid[axis][corner[axis] as usize]
        }))
    };
    let cells = IVec3::from_array(std::array::from_fn(|axis| grid[axis].len() as i32 - 1));
    let mut net = Net::default();
    for block in boxes(IVec3::ZERO, cells / BLOCK) {
        let first = block * BLOCK;
        let (low, high) = (place(first), place(first + BLOCK));
        if field(low.midpoint(high)).abs() > SKIP * 0.5 * low.distance(high) {
            continue;
        }
        for cell in boxes(first, first + BLOCK) {
            net.add_vertex(cell, &field, &place);
        }
    }
    net.stitch();
    let normals = net
        .positions
        .iter()
        .map(|p| gradient(&field, *p, NORMAL_STEP).to_array())
        .collect();
    Mesh {
        positions: net.positions.iter().map(|p| p.to_array()).collect(),
        normals,
        indices: net.indices,
    }
}

#[derive(Default)]
struct Net {
    /// The vertex of a crossed cell.
    vertices: HashMap<IVec3, u32>,
    /// Crossed cells in the order they were met, with the signs (inside: true) of corner 0 and its three neighbours.
    cells: Vec<(IVec3, [bool; 4])>,
    positions: Vec<Vec3>,
    indices: Vec<u32>,
}

impl Net {
    fn add_vertex(
        &mut self,
        cell: IVec3,
        field: &impl Fn(Vec3) -> f32,
        place: &impl Fn(IVec3) -> Vec3,
    ) {
        let corner = |k: usize| cell + ivec3((k & 1) as i32, (k >> 1 & 1) as i32, (k >> 2) as i32);
        let values: [f32; 8] = std::array::from_fn(|k| field(place(corner(k))));
        let (mut sum, mut crossings) = (Vec3::ZERO, 0.0);
        for a in 0..8usize {
            for axis in [1, 2, 4] {
                let b = a | axis;
                if b != a && (values[a] < 0.0) != (values[b] < 0.0) {
                    let t = values[a] / (values[a] - values[b]);
                    sum += place(corner(a)).lerp(place(corner(b)), t);
                    crossings += 1.0;
                }
            }
        }
        if crossings > 0.0 {
            self.vertices.insert(cell, self.positions.len() as u32);
            self.positions.push(sum / crossings);
            self.cells
                .push((cell, [0, 1, 2, 4].map(|k| values[k] < 0.0)));
        }
    }

    /// Two triangles for each crossed edge from a cell's corner 0, between the four cells around it.
    fn stitch(&mut self) {
        for (cell, inside) in std::mem::take(&mut self.cells) {
            for axis in 0..3 {
                if inside[0] == inside[axis + 1] {
                    continue;
                }
                let [u, v] = [(axis + 1) % 3, (axis + 2) % 3].map(|k| IVec3::AXES[k]);
                let ring = [cell, cell - u, cell - u - v, cell - v]
                    .map(|c| self.vertices.get(&c).copied());
                let [Some(a), Some(b), Some(c), Some(d)] = ring else {
                    continue;
                };
                // The surface faces from the inside corner to the outside one.
                let quad = if inside[0] {
                    [a, b, c, a, c, d]
                } else {
                    [a, c, b, a, d, c]
                };
                self.indices.extend(quad);
            }
        }
    }
}

/// All integer points from `low` up to but not including `high`, in a fixed order.
fn boxes(low: IVec3, high: IVec3) -> impl Iterator<Item = IVec3> {
    (low.z..high.z).flat_map(move |z| {
        (low.y..high.y).flat_map(move |y| (low.x..high.x).map(move |x| ivec3(x, y, z)))
    })
}
