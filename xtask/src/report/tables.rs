//! The rows as markdown tables.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use serde_json::Value;

use super::row::{Error, Row};
use super::{choice, plots, published};
use crate::Result;

const HEADING: &str = "# Error, time and memory

Made by `cargo xtask report` from `report.json`; do not edit. Errors are against the double-precision reference, as parts
of white.

- **Transparency**: the picture against the exact sorted composite, over pixels that hair covers, without shadows; time of
  the whole frame.
- **Shadow**: transmittance at the strand points next to the nearest fragments of at most 6,000 pixels, against 64 rays
  over a disc of half a pixel's size; time of the light's passes, each submitted alone. \"Picture\" is the error of the shaded
  nearest fragments. Convergence: the error of opacity shadow maps falls as N^-0.8 from 16 to 128 planes (a test on 2,000
  straight strands: RMSE 0.132 to 0.0245), and is not yet the texels' own there.
- A shadow's ꟻLIP is the mean over four squares of 64 pixels of hair: of all squares that hair fills, in the order of their probes'
  mean transmittance by the reference, those in the middles of four equal parts.
- **Samples**: each model by itself over the groom's strand points: the least nanoseconds a sample, of 2¹⁸ in a dispatch and up to 40 dispatches, with reading and
  writing a sample's 96 bytes; errors against the exact model, of the root of its mean square. MB are the tables' alone. At points and at
  fragments the models are the same; what differs is how many there are.
- **Frames**: whole frames of all models, which take turns; ratios are those to Kajiya-Kay's frame of the same round; the shading
  passes submitted alone, but at `rate` fragment, where the resolve shades. `chiang` and `marschner` come through tables of the default size, and directly.
  A row with `shadow_reuse` takes the shadow maps of the frame before, as frames do where only the camera moves; in all other
  rows of all groups every frame fills its own.
- **Shading**: the nearest fragments' picture against the reference's, without shadows; time of the whole frame. Where a row
  names its `rate`, the reference is shaded at fragments, else at strand points.
- \"Passes\" are those of geometry, shading, transparency and composite, each submitted alone, in one frame.
- ꟻLIP is the mean over the whole picture, on mid-grey. Memory is all of the library's on the device: geometry too.
- `shift_part` 0.5 is a depth shift of half the groom's extent along the view.
- More than 8 peels, and single-pass k-buffers of more than 16, are measured on the small scene alone.
- `pool_part` 0.1 is a fragment pool a tenth of what all fragments need: the rest is merged.

";

/// Writes `README.md`.
pub fn write(folder: &Path, rows: &[Row]) -> Result<()> {
    let mut tables: BTreeMap<(&str, &str), Vec<&Row>> = BTreeMap::new();
    for row in rows {
        tables
            .entry((&row.scene, &row.group))
            .or_default()
            .push(row);
    }
    let mut text = HEADING.to_owned();
    for group in ["transparency", "shadow"] {
        // Writing to a string does not fail.
        writeln!(text, "## Which to choose when: {group}\n").ok();
        text += "Of each scene's rows the fastest and the smallest technique within an error; settings and figures are with the scene.\n\n";
        text += &choice::of_group(group, rows);
        text += "\n";
    }
    text += "## What the sources say\n\nMemory at 656×861 for as many fragments as Hunz had (2016, §6.3.3); here with the tail that keeps what overflows.\n\n";
    text += &published::memory()?;
    text += "\n";
    text += &published::times(rows);
    text += "\n";
    for ((scene, group), rows) in tables {
        let row = rows[0];
        let Row {
            width,
            height,
            adapter,
            driver,
            date,
            ..
        } = row;
        writeln!(
            text,
            "## {scene}, {width}×{height}: {group}\n\n{adapter}, {driver}, {date}.\n"
        )
        .ok();
        if matches!(group, "transparency" | "shadow") {
            text += &choice::of_scene(&rows);
            text += "\n";
        }
        if let Some(pixels) = row.undecided {
            writeln!(text, "{pixels} pixels are not compared: single precision cannot tell whether the opaque scene hides a fragment there.\n").ok();
        }
        text += &match group {
            "samples" => sample_table(&rows),
            "frames" => frame_table(&rows),
            _ => table(&rows, group == "shadow"),
        };
        text += "\n";
        for (path, title) in plots::names(scene, group, &rows) {
            writeln!(text, "![{title}]({path})").ok();
        }
        text += "\n";
    }
    let path = folder.join("README.md");
    std::fs::write(&path, text)
        .map_err(|error| format!("{} cannot be written: {error}", path.display()))
}

fn table(rows: &[&Row], is_shadow: bool) -> String {
    let last = if is_shadow {
        "bias | picture RMSE | ꟻLIP"
    } else {
        "ꟻLIP"
    };
    let rule = if is_shadow { "|---|---" } else { "" };
    let mut text = format!(
        "| technique | settings | RMSE | p99 | max | {last} | α RMSE, max | ms, median (min) | passes, ms | MB | fragments, M: culled, stored | merged |\n|---|---|---|---|---|---|---|---|---|---|---|---{rule}|\n"
    );
    for row in rows {
        let Error {
            rmse,
            p99,
            max,
            flip,
            bias,
        } = row.error;
        let number = |value: Option<f64>| value.map_or("–".into(), |value| format!("{value:.5}"));
        let last = if is_shadow {
            let bias = bias.map_or("–".into(), |bias| format!("{bias:+.4}"));
            format!(
                "{bias} | {} | {}",
                number(row.image_error.map(|error| error.rmse)),
                number(row.image_error.and_then(|error| error.flip))
            )
        } else {
            number(flip)
        };
        let alpha = row.alpha_error.map_or("–".into(), |error| {
            format!("{:.5}, {:.4}", error.rmse, error.max)
        });
        let merged = row.fragments.map_or("–".into(), |f| match f.merged {
            0 => "0".into(),
            merged => format!("{:.0} %", 100.0 * merged as f64 / f.produced as f64),
        });
        writeln!(
            text,
            "| `{}` | {} | {rmse:.5} | {p99:.5} | {max:.4} | {last} | {alpha} | {:.1} ({:.1}) | {} | {:.1} | {} | {merged} |",
            row.technique,
            settings(&row.settings),
            row.ms.median,
            row.ms.min,
            passes(row),
            row.bytes as f64 / 1e6,
            kept(row),
        )
        .ok();
    }
    text
}

/// Times by the kind of pass: geometry, shading, transparency, composite.
fn passes(row: &Row) -> String {
    if row.passes.is_empty() {
        return "–".into();
    }
    let kinds = ["geometry", "shading", "transparency", "composite"].map(|kind| {
        let prefix = format!("pelage.{kind}.");
        let own = row
            .passes
            .iter()
            .filter(|(label, _)| label.starts_with(&prefix));
        let ms: f64 = own.map(|(_, ms)| ms).sum();
        format!("{ms:.0}")
    });
    kinds.join(" + ")
}

/// Millions of fragments, and of what is stored how many times the fewest that the tolerance allows.
fn kept(row: &Row) -> String {
    let Some(fragments) = row.fragments else {
        return "–".into();
    };
    let [produced, culled, stored] =
        [fragments.produced, fragments.culled, fragments.stored].map(|count| count as f64 / 1e6);
    let fewest = row.fewest.map_or(String::new(), |fewest| {
        format!(
            ", {:.2} × the fewest",
            fragments.stored as f64 / fewest.max(1) as f64
        )
    });
    format!("{produced:.1}: {culled:.1}, {stored:.1}{fewest}")
}

fn sample_table(rows: &[&Row]) -> String {
    let mut text =
        "| technique | settings | ns | RMSE | p99 | max | MB |\n|---|---|---|---|---|---|---|\n"
            .to_owned();
    for row in rows {
        writeln!(
            text,
            "| `{}` | {} | {:.1} | {:.1e} | {:.1e} | {:.1e} | {:.3} |",
            row.technique,
            settings(&row.settings),
            row.ns().unwrap_or_default(),
            row.error.rmse,
            row.error.p99,
            row.error.max,
            row.bytes as f64 / 1e6,
        )
        .ok();
    }
    text
}

fn frame_table(rows: &[&Row]) -> String {
    let mut text = "| technique | settings | ms, median (min) | of Kajiya-Kay's | shading passes, ms | MB |\n|---|---|---|---|---|---|\n".to_owned();
    for row in rows {
        let passes = row
            .shading_ms
            .map_or("–".into(), |times| format!("{:.1}", times.median));
        writeln!(
            text,
            "| `{}` | {} | {:.1} ({:.1}) | {:.2} | {passes} | {:.1} |",
            row.technique,
            settings(&row.settings),
            row.ms.median,
            row.ms.min,
            row.ratio.map_or(f64::NAN, |times| times.median),
            row.bytes as f64 / 1e6,
        )
        .ok();
    }
    text
}

/// `key value, key value`.
pub fn settings(settings: &Value) -> String {
    let Some(map) = settings.as_object() else {
        return String::new();
    };
    let one = |(key, value): (&String, &Value)| match value {
        Value::String(text) => format!("{key} {text}"),
        Value::Number(number) => format!(
            "{key} {}",
            number.as_f64().map_or_else(
                || number.to_string(),
                |n| format!("{n:.4}")
                    .trim_end_matches('0')
                    .trim_end_matches('.')
                    .to_owned()
            )
        ),
        other => format!("{key} {other}"),
    };
    map.iter().map(one).collect::<Vec<_>>().join(", ")
}
