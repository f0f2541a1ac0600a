//! Polar plots of every shading model's lobes, evaluated on the GPU, beside the double-precision reference.
//!
//! ```sh
//! cargo run --example lobes -- [folder]
//! ```
//!
//! Writes `MODEL.svg` into the folder (`out/lobes`). Each has a column for each lobe and one for their sum. Above: around the
//! fibre, seen along it, with the light at the right, perpendicular to the fibre as the eye is. Below: along the fibre, in the
//! plane of light and fibre, the root below; the light comes from the upper right, 30° from the normal plane. The radius
//! is the model's value with its cosine, of the lobe's peak; a colour for each channel. The broad pale line is the reference,
//! the thin one the library's own shader.

mod lobes;
mod plot;
#[path = "../../tests/shading/reference.rs"]
mod reference;

use std::error::Error;
use std::path::PathBuf;

use pelage::host::offscreen::{Offscreen, OffscreenOptions};
use pelage::shading::Evaluator;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1);
    let folder = folder.map_or_else(|| PathBuf::from("out/lobes"), PathBuf::from);
    std::fs::create_dir_all(&folder)?;
    let offscreen = Offscreen::new(&OffscreenOptions::default())?;
    let (device, queue) = (offscreen.renderer.device(), offscreen.renderer.queue());
    let evaluator = Evaluator::new(device, queue)?;
    for model in lobes::models() {
        let [around, along] = [lobes::around(), lobes::along()];
        let rows = [
            lobes::curves(&evaluator, &model, &around)?,
            lobes::curves(&evaluator, &model, &along)?,
        ];
        let path = folder.join(model.name.to_owned() + ".svg");
        plot::write(&path, model.title, &rows)?;
        println!("{}", path.display());
        for (row, name) in rows.iter().zip(["around", "along"]) {
            for curve in row {
                println!(
                    "  {name} {:<10} peak {:.4}, error {:.1e} of it",
                    curve.name,
                    curve.peak(),
                    curve.error()
                );
            }
        }
    }
    Ok(())
}
