//! The host's opaque scene as triangles: OBJ files, or the built-in head, with smooth normals.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use pelage::glam::Vec3;
use pelage::groom::{Mesh, head_mesh};

use super::groom;
use super::scene::{Result, Scene};

/// A scene's meshes as one, empty if there are none: the files it names, or else the head of a built-in groom.
pub fn load(scene: &Scene) -> Result<Mesh> {
    match &scene.meshes {
        Some(paths) => read_all(paths),
        None if groom::has_builtin_head(scene) => Ok(head_mesh()),
        None => Ok(Mesh::default()),
    }
}

fn read_all(paths: &[PathBuf]) -> Result<Mesh> {
    let mut mesh = Mesh::default();
    for path in paths {
        read(path, &mut mesh)?;
    }
    mesh.normals = smooth_normals(&mesh);
    Ok(mesh)
}

/// Adds an OBJ file's triangles, without normals.
fn read(path: &Path, mesh: &mut Mesh) -> Result<()> {
    let name = path.display();
    // What the parser says of a missing file names no cause; the file system's own words do.
    let bytes = std::fs::read(path).map_err(|error| format!("{name} cannot be read: {error}"))?;
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..Default::default()
    };
    let no_materials = |_: &Path| tobj::MTLLoadResult::Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(&mut bytes.as_slice(), &options, no_materials)
        .map_err(|error| format!("{name} is no OBJ file that can be read: {error}"))?;
    for model in models {
        let first = mesh.positions.len() as u32;
        let positions = model
            .mesh
            .positions
            .chunks_exact(3)
            .map(|p| [p[0], p[1], p[2]]);
        mesh.positions.extend(positions);
        mesh.indices
            .extend(model.mesh.indices.iter().map(|index| first + index));
    }
    if let Some(at) = mesh
        .positions
        .iter()
        .position(|p| !p.iter().all(|c| c.is_finite()))
    {
        return Err(format!("{name}: vertex {at} is not finite"));
    }
    if mesh
        .indices
        .iter()
        .any(|index| *index as usize >= mesh.positions.len())
    {
        return Err(format!(
            "{name}: a face has a vertex that is not in the file"
        ));
    }
    if mesh.indices.is_empty() {
        return Err(format!("{name} has no faces"));
    }
    Ok(())
}

/// A normal a vertex, the area-weighted mean of the triangles around its position.
fn smooth_normals(mesh: &Mesh) -> Vec<[f32; 3]> {
    let key = |index: u32| mesh.positions[index as usize].map(f32::to_bits);
    let mut sums: HashMap<[u32; 3], Vec3> = HashMap::new();
    for triangle in mesh.indices.chunks_exact(3) {
        let [a, b, c] = [0, 1, 2].map(|i| Vec3::from(mesh.positions[triangle[i] as usize]));
        // Its length is twice the area.
        let normal = (b - a).cross(c - a);
        for index in triangle {
            *sums.entry(key(*index)).or_insert(Vec3::ZERO) += normal;
        }
    }
    let normal = |index: u32| {
        sums.get(&key(index))
            .map_or(Vec3::Y, |sum| sum.normalize_or(Vec3::Y))
            .to_array()
    };
    (0..mesh.positions.len() as u32).map(normal).collect()
}
