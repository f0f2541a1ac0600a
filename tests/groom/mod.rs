//! Tests of `pelage::groom`.

mod builtin;
mod formats;
mod interpolate;
mod tessellate;

use pelage::groom::Strands;
use std::path::PathBuf;

/// A shared data file's bytes, or `None`, with a line on stderr, where it is not there.
fn shared_data(test: &str, path: &str) -> Option<Vec<u8>> {
    let root = std::env::var_os("PELAGE_SHARED").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared")),
        PathBuf::from,
    );
    let bytes = std::fs::read(root.join("data").join(path)).ok();
    if bytes.is_none() {
        eprintln!("skipped: {test}: data/{path}");
    }
    bytes
}

/// Three guides of three points over a right triangle of area ½ in y = 0, leaning apart.
fn three_guides() -> Strands {
    let guide = |x: f32, z: f32| {
        [
            [x, 0.0, z],
            [1.2 * x, 1.0, 1.2 * z],
            [1.5 * x, 2.0, 1.5 * z + 0.1],
        ]
    };
    let points = [guide(0.0, 0.0), guide(1.0, 0.0), guide(0.0, 1.0)].concat();
    Strands::new(points, &[3, 3, 3], 0.01).unwrap()
}

/// Each strand's points.
fn strands_of(strands: &Strands) -> impl Iterator<Item = &[[f32; 3]]> {
    (0..strands.strand_count()).map(|strand| &strands.points()[strands.range(strand)])
}
