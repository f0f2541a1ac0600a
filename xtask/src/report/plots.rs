//! Error against time and against memory, a plot each of every scene and group.

use std::collections::BTreeMap;
use std::path::Path;

use plotters::prelude::*;
use serde_json::Value;

use super::row::Row;
use crate::Result;

/// Errors below this are drawn at it: a logarithm has no place for zero.
const LEAST_ERROR: f64 = 1e-6;

/// What the horizontal axis shows.
#[derive(Clone, Copy)]
struct Axis {
    file: &'static str,
    name: &'static str,
    value: fn(&Row) -> f64,
}

const AXES: [Axis; 2] = [
    Axis {
        file: "time",
        name: "milliseconds, median",
        value: |row| row.ms.median,
    },
    Axis {
        file: "memory",
        name: "megabytes",
        value: |row| row.bytes as f64 / 1e6,
    },
];

/// Points of one colour: a technique with those settings that are words.
type Series<'a> = BTreeMap<String, Vec<&'a Row>>;

/// Writes `error_AXIS_SCENE_GROUP.svg`.
pub fn write(folder: &Path, rows: &[Row]) -> Result<()> {
    let mut plots: BTreeMap<(&str, &str), Series> = BTreeMap::new();
    for row in rows {
        plots
            .entry((&row.scene, &row.group))
            .or_default()
            .entry(series(row))
            .or_default()
            .push(row);
    }
    for ((scene, group), series) in &plots {
        for axis in AXES {
            let path = folder.join(format!("error_{}_{scene}_{group}.svg", axis.file));
            plot(
                &path,
                &format!("{group} on {scene}: error against {}", axis.file),
                axis,
                series,
            )
            .map_err(|error| format!("{} cannot be drawn: {error}", path.display()))?;
        }
    }
    Ok(())
}

fn series(row: &Row) -> String {
    let word = |key: &str| {
        row.settings
            .get(key)
            .and_then(Value::as_str)
            .map(|word| format!(" {word}"))
    };
    let number = |key: &str| {
        row.settings
            .get(key)
            .and_then(Value::as_u64)
            .map(|number| format!(" {key} {number}"))
    };
    let parts = [
        word("storage"),
        word("raster").filter(|word| word != " auto"),
        number("layers"),
        number("pcf"),
    ];
    row.technique.clone() + &parts.into_iter().flatten().collect::<String>()
}

/// A range around values, a little wider than they are.
fn around(values: impl Iterator<Item = f64> + Clone) -> std::ops::Range<f64> {
    let low = values.clone().fold(f64::INFINITY, f64::min);
    let high = values.fold(0.0, f64::max);
    low / 1.3..high * 1.3
}

fn plot(
    path: &Path,
    title: &str,
    axis: Axis,
    series: &Series,
) -> std::result::Result<(), Box<dyn std::error::Error>> {
    let all = || series.values().flatten();
    let error = |row: &Row| row.error.rmse.max(LEAST_ERROR);
    let root = SVGBackend::new(path, (760, 460)).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .caption(title, ("sans-serif", 18))
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(64)
        .build_cartesian_2d(
            around(all().map(|row| (axis.value)(row))).log_scale(),
            around(all().map(|row| error(row))).log_scale(),
        )?;
    let plain = |value: &f64| {
        if *value < 0.01 {
            format!("{value:.0e}")
        } else {
            format!("{value:.4}")
                .trim_end_matches('0')
                .trim_end_matches('.')
                .to_owned()
        }
    };
    chart
        .configure_mesh()
        .x_desc(axis.name)
        .y_desc("RMSE")
        .x_label_formatter(&plain)
        .y_label_formatter(&plain)
        .light_line_style(WHITE)
        .draw()?;
    for (number, (name, rows)) in series.iter().enumerate() {
        let colour = Palette99::pick(number).to_rgba();
        let mut points: Vec<(f64, f64)> = rows
            .iter()
            .map(|row| ((axis.value)(row), error(row)))
            .collect();
        points.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        chart.draw_series(LineSeries::new(
            points.iter().copied(),
            colour.stroke_width(1),
        ))?;
        chart
            .draw_series(
                points
                    .iter()
                    .map(|point| Circle::new(*point, 4, colour.filled())),
            )?
            .label(name)
            .legend(move |(x, y)| Circle::new((x + 8, y), 4, colour.filled()));
    }
    chart
        .configure_series_labels()
        .border_style(BLACK.mix(0.3))
        .background_style(WHITE.mix(0.8))
        .draw()?;
    root.present()?;
    Ok(())
}
