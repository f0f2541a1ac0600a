//! What is written: the picture as OpenEXR and PNG, and the statistics as JSON.

use std::path::{Path, PathBuf};

use pelage::glam::Vec4;
use serde_json::{Value, json};

use super::scene::Result;

/// A picture: linear, premultiplied, row 0 at the top.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Row by row.
    pub pixels: Vec<Vec4>,
}

/// Checks that a path ends in `.exr` and makes its folder, before any time is spent on what is to be written there.
pub fn prepare(path: &Path) -> Result<()> {
    if path.extension().is_none_or(|extension| extension != "exr") {
        return Err(format!("--out {} does not end in .exr", path.display()));
    }
    make_folder(path)
}

/// Makes the folder that a file goes into.
pub fn make_folder(path: &Path) -> Result<()> {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => std::fs::create_dir_all(folder)
            .map_err(|error| format!("the folder {} cannot be made: {error}", folder.display())),
        _ => Ok(()),
    }
}

/// Writes `path` as 32-bit float RGBA, and beside it a PNG. Returns the PNG's path.
pub fn write(path: &Path, picture: &Picture) -> Result<PathBuf> {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let pixel = |x: usize, y: usize| picture.pixels[y * width + x].into();
    let pixel = |x, y| -> (f32, f32, f32, f32) { pixel(x, y) };
    exr::prelude::write_rgba_file(path, width, height, pixel)
        .map_err(|error| format!("{} cannot be written: {error}", path.display()))?;
    let beside = path.with_extension("png");
    write_png(&beside, picture)
        .map_err(|error| format!("{} cannot be written: {error}", beside.display()))?;
    Ok(beside)
}

/// An 8-bit sRGB picture over black: the premultiplied colours as they stand, cut off at 1.
fn write_png(path: &Path, picture: &Picture) -> std::result::Result<(), png::EncodingError> {
    let file = std::io::BufWriter::new(std::fs::File::create(path)?);
    let mut encoder = png::Encoder::new(file, picture.width, picture.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let bytes: Vec<u8> = picture
        .pixels
        .iter()
        .flat_map(|pixel| [pixel.x, pixel.y, pixel.z])
        .map(srgb_byte)
        .collect();
    encoder.write_header()?.write_image_data(&bytes)
}

/// IEC 61966-2-1.
fn srgb_byte(linear: f32) -> u8 {
    let linear = linear.clamp(0.0, 1.0);
    let encoded = if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    };
    (255.0 * encoded).round() as u8
}

/// Writes JSON with line breaks.
pub fn write_json(path: &Path, value: &Value) -> Result<()> {
    make_folder(path)?;
    std::fs::write(path, format!("{value:#}\n"))
        .map_err(|error| format!("{} cannot be written: {error}", path.display()))
}

/// Least, median and greatest of some times in milliseconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// The least.
    pub min: f64,
    /// The median; the mean of the two in the middle of an even number.
    pub median: f64,
    /// The greatest.
    pub max: f64,
}

impl Spread {
    /// Of at least one time.
    pub fn of(times: &[f64]) -> Self {
        let mut times = times.to_vec();
        times.sort_unstable_by(f64::total_cmp);
        let middle = times.len() / 2;
        let median = if times.len() % 2 == 1 {
            times[middle]
        } else {
            0.5 * (times[middle - 1] + times[middle])
        };
        Self {
            min: times[0],
            median,
            max: times[times.len() - 1],
        }
    }

    /// As the statistics file has it.
    pub fn json(&self) -> Value {
        json!({ "min": self.min, "median": self.median, "max": self.max })
    }
}
