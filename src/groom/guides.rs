//! Guide strands, with or without the mesh whose vertices they grow from.

use super::Strands;
use crate::error::{Result, invalid};

/// Strands from which more are made, and optionally the triangles of the mesh on which they stand.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Guides {
    strands: Strands,
    triangles: Vec<[u32; 3]>,
}

impl Guides {
    /// Guides without a mesh.
    pub fn new(strands: Strands) -> Self {
        Self {
            strands,
            triangles: Vec::new(),
        }
    }

    /// Guides that grow from the vertices of a mesh: guide `i` stands on vertex `i`, and each of `triangles` holds three
    /// such indices. The mesh's vertices are the guides' roots.
    ///
    /// # Errors
    /// A triangle that names a guide that is not there.
    pub fn on_mesh(strands: Strands, triangles: Vec<[u32; 3]>) -> Result<Self> {
        let count = strands.strand_count();
        for (at, triangle) in triangles.iter().enumerate() {
            if let Some(guide) = triangle.iter().find(|guide| **guide as usize >= count) {
                return invalid!("triangle {at}: guide {guide} is not one of the {count} guides");
            }
        }
        Ok(Self { strands, triangles })
    }

    /// The guide strands.
    pub fn strands(&self) -> &Strands {
        &self.strands
    }

    /// Three guide indices a triangle; empty without a mesh.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }
}
