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

/// Of models by themselves.
const SAMPLE_AXIS: Axis = Axis {
    file: "samples",
    name: "nanoseconds a sample, the least",
    value: |row| row.ns().unwrap_or_default(),
};

/// A plot's file, title, axis and rows.
struct Plot<'a> {
    file: String,
    title: String,
    axis: Axis,
    series: Series<'a>,
    /// Whether its errors are all against the same, so that one row can be better than another.
    has_front: bool,
    /// Whether a point bears the number that tells it from the others of its series.
    has_numbers: bool,
}

/// The plots of a scene's group: of each axis, or of samples of each model that has more than one row.
fn plots<'a>(scene: &str, group: &str, rows: &[&'a Row]) -> Vec<Plot<'a>> {
    if group == "frames" {
        return Vec::new();
    }
    if group != "samples" {
        let plot = |axis: Axis| Plot {
            file: format!("error_{}_{scene}_{group}.svg", axis.file),
            title: format!("{group} on {scene}: error against {}", axis.file),
            axis,
            series: in_series(rows),
            has_front: group != "shading",
            has_numbers: false,
        };
        return AXES.map(plot).into();
    }
    let mut models: Vec<&str> = rows.iter().map(|row| &*row.technique).collect();
    models.dedup();
    let of_model = |model: &str| {
        let rows: Vec<&Row> = rows
            .iter()
            .copied()
            .filter(|r| r.technique == model)
            .collect();
        (rows.len() > 2).then(|| Plot {
            file: format!("error_samples_{scene}_{model}.svg"),
            title: format!("{model} on {scene}: error against time of a sample"),
            axis: SAMPLE_AXIS,
            series: in_series(&rows),
            has_front: true,
            has_numbers: true,
        })
    };
    models.into_iter().filter_map(of_model).collect()
}

/// Files and titles of the plots of a scene's group.
pub fn names(scene: &str, group: &str, rows: &[&Row]) -> Vec<(String, String)> {
    let plots = plots(scene, group, rows).into_iter();
    plots.map(|plot| (plot.file, plot.title)).collect()
}

/// Writes every plot.
pub fn write(folder: &Path, rows: &[Row]) -> Result<()> {
    let mut groups: BTreeMap<(&str, &str), Vec<&Row>> = BTreeMap::new();
    for row in rows {
        groups
            .entry((&row.scene, &row.group))
            .or_default()
            .push(row);
    }
    for ((scene, group), rows) in &groups {
        for plot in plots(scene, group, rows) {
            let path = folder.join(&plot.file);
            draw(&path, &plot)
                .map_err(|error| format!("{} cannot be drawn: {error}", path.display()))?;
        }
    }
    Ok(())
}

fn in_series<'a>(rows: &[&'a Row]) -> Series<'a> {
    let mut all: Series = Vec::new();
    for row in rows {
        let name = series(row);
        match all.iter_mut().find(|(known, _)| *known == name) {
            Some((_, rows)) => rows.push(row),
            None => all.push((name, vec![row])),
        }
    }
    all
}

/// Size of a model's tables, or its intervals across the fibre.
fn number_of(row: &Row) -> Option<String> {
    let settings = &row.settings;
    let tables = settings.get("tables").and_then(|tables| tables.get("size"));
    let number = tables.or_else(|| settings.get("intervals"))?;
    Some(number.to_string())
}

/// The rows that no other beats in both, by rising time.
fn pareto_front(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut front: Vec<(f64, f64)> = Vec::new();
    for point in points {
        if front.last().is_none_or(|last| point.1 < last.1) {
            front.push(point);
        }
    }
    front
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
    let tables = row
        .settings
        .get("tables")
        .map(|tables| match tables.get("precision") {
            Some(precision) => format!(" tables {}", precision.as_str().unwrap_or_default()),
            None => " direct".to_owned(),
        });
    let is = |key: &str| row.settings.get(key) == Some(&Value::Bool(true));
    let parts = [
        tables,
        is("cubic").then(|| " cubic".to_owned()),
        is("normalised").then(|| " normalised".to_owned()),
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

fn draw(path: &Path, plot: &Plot) -> std::result::Result<(), Box<dyn std::error::Error>> {
    let Plot {
        title,
        axis,
        series,
        ..
    } = plot;
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
    if plot.has_front {
        let points = all().map(|row| ((axis.value)(row), error(row))).collect();
        let front = pareto_front(points);
        chart.draw_series(LineSeries::new(front, BLACK.mix(0.12).stroke_width(9)))?;
        right.draw(&Rectangle::new(
            [(0, 26), (12, 34)],
            BLACK.mix(0.12).filled(),
        ))?;
        right.draw(&Text::new("Pareto front", (16, 24), ("sans-serif", 12)))?;
    }
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
        if plot.has_numbers {
            let numbers = rows.iter().filter_map(|row| {
                let place = ((axis.value)(row), error(row));
                let text = Text::new(number_of(row)?, (6, -5), ("sans-serif", 11));
                Some(EmptyElement::at(place) + text)
            });
            chart.draw_series(numbers)?;
        }
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
