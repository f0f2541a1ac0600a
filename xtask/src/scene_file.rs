//! The scene file's reader, the `render` example's own, so that the report and the pictures mean the same by a setting.

// The report needs a part of each.
#![allow(dead_code)]

#[path = "../../examples/render/framing.rs"]
pub mod framing;
#[path = "../../examples/render/groom.rs"]
pub mod groom;
#[path = "../../examples/render/mesh_pass.rs"]
pub mod mesh_pass;
#[path = "../../examples/render/meshes.rs"]
pub mod meshes;
#[path = "../../examples/render/scene.rs"]
pub mod scene;
#[path = "../../examples/render/techniques/mod.rs"]
pub mod techniques;
