//! `cargo xtask gallery`: the three built-in grooms, rendered by the example as anyone would.

use crate::{Result, cargo, root};

/// The built-in grooms by their names in scene files.
const GROOMS: [&str; 3] = ["straight", "wavy", "curly"];

/// Writes `out/NAME.exr`, `.png` and `.json` of each groom.
pub fn run() -> Result<()> {
    let out = root().join("out");
    std::fs::create_dir_all(&out)
        .map_err(|error| format!("{} cannot be made: {error}", out.display()))?;
    for groom in GROOMS {
        let scene = out.join(format!("{groom}.scene.json"));
        let text = format!("{{\"hair\": \"builtin:{groom}\"}}\n");
        std::fs::write(&scene, text)
            .map_err(|error| format!("{} cannot be written: {error}", scene.display()))?;
        let [scene, image, statistics] = [
            scene,
            out.join(format!("{groom}.exr")),
            out.join(format!("{groom}.json")),
        ]
        .map(|p| p.display().to_string());
        let arguments = [
            "run",
            "--release",
            "--quiet",
            "--example",
            "render",
            "--",
            &scene,
            "--out",
            &image,
            "--stats",
            &statistics,
        ];
        cargo(&arguments, &[])?;
    }
    Ok(())
}
