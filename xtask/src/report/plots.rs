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
type Series<'a> = Vec<(String, Vec<&'a Row>)>;

/// Writes `error_AXIS_SCENE_GROUP.svg`.
pub fn write(folder: &Path, rows: &[Row]) -> Result<()> {
    let mut plots: BTreeMap<(&str, &str), Series> = BTreeMap::new();
    for row in rows {
        let (name, plot) = (
            series(row),
            plots.entry((&row.scene, &row.group)).or_default(),
        );
        match plot.iter_mut().find(|(known, _)| *known == name) {
            Some((_, rows)) => rows.push(row),
            None => plot.push((name, vec![row])),
        }
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

/// Pixels of a plot, and of the legend to its right.
const SIZE: (u32, u32) = (880, 460);
const LEGEND_WIDTH: u32 = 240;

/// A range around values, from and to 1, 2 or 5 times a power of ten.
fn around(values: impl Iterator<Item = f64> + Clone) -> std::ops::Range<f64> {
    let steps = |value: f64| {
        let power = 10.0_f64.powf(value.log10().floor());
        [1.0, 2.0, 5.0, 10.0].map(|step| step * power)
    };
    let low = values.clone().fold(f64::INFINITY, f64::min) / 1.1;
    let high = values.fold(0.0, f64::max) * 1.1;
    let below = steps(low).into_iter().rfind(|step| *step <= low);
    let above = steps(high).into_iter().find(|step| *step >= high);
    below.unwrap_or(low)..above.unwrap_or(high)
}

/// Few digits: 0.01, 250, 2e-4.
fn plain(value: &f64) -> String {
    if *value < 0.01 {
        return format!("{value:.0e}");
    }
    let text = format!("{value:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn plot(
    path: &Path,
    title: &str,
    axis: Axis,
    series: &Series,
) -> std::result::Result<(), Box<dyn std::error::Error>> {
    let all = || series.iter().flat_map(|(_, rows)| rows);
    let error = |row: &Row| row.error.rmse.max(LEAST_ERROR);
    let root = SVGBackend::new(path, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let (left, right) = root.split_horizontally(SIZE.0 - LEGEND_WIDTH);
    let mut chart = ChartBuilder::on(&left)
        .caption(title, ("sans-serif", 18))
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(64)
        .build_cartesian_2d(
            around(all().map(|row| (axis.value)(row))).log_scale(),
            around(all().map(|row| error(row))).log_scale(),
        )?;
    chart
        .configure_mesh()
        .x_desc(axis.name)
        .y_desc("RMSE")
        .x_labels(20)
        .y_labels(20)
        .x_label_formatter(&plain)
        .y_label_formatter(&plain)
        .bold_line_style(BLACK.mix(0.15))
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
        let dots = points
            .iter()
            .map(|point| Circle::new(*point, 4, colour.filled()));
        chart.draw_series(dots)?;
        let line = 48 + 18 * number as i32;
        right.draw(&Circle::new((6, line), 4, colour.filled()))?;
        right.draw(&Text::new(
            name.as_str(),
            (16, line - 6),
            ("sans-serif", 12),
        ))?;
    }
    root.present()?;
    Ok(())
}
