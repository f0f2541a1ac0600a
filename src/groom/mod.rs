//! Grooms: strands as plain, validated data, and the ways to make them. CPU only, no GPU types.
//!
//! [`formats`] reads files; [`Guides`] with [`interpolate_on_mesh`] or [`interpolate_clumps`] make many strands of few;
//! [`builtin`] makes a head and three hairstyles out of nothing; [`tessellate`] turns curves into polylines.

mod builtin;
pub(crate) mod density;
pub(crate) mod even;
pub mod formats;
mod guides;
mod hash;
pub(crate) mod interpolate;
mod mesh;
mod radius;
mod scalp;
mod strands;
mod tessellate;

pub use builtin::{BuiltinGroom, builtin, head_distance, head_mesh};
pub use guides::Guides;
pub use interpolate::{
    ClumpSettings, GuidedStrands, InterpolationSettings, MAX_INTERPOLATED_STRANDS, Stray,
    interpolate_clumps, interpolate_on_mesh,
};
pub use mesh::Mesh;
pub use strands::{Curve, MAX_POINTS, Strands};
pub use tessellate::tessellate;
