//! A plain triangle mesh in host units.

/// Triangles with a unit normal a vertex; what hair grows on and is hidden by.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// One position a vertex.
    pub positions: Vec<[f32; 3]>,
    /// One outward unit normal a vertex.
    pub normals: Vec<[f32; 3]>,
    /// Three vertex indices a triangle, counter-clockwise seen from outside.
    pub indices: Vec<u32>,
}

impl Mesh {
    /// The number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.indices.len() / 3
    }
}
