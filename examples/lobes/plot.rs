//! The curves as SVG.

use std::error::Error;
use std::path::Path;

use pelage::glam::DVec3;
use plotters::prelude::*;

use crate::lobes::{Curve, LIGHT};

/// Pixels a panel's side, and of the title.
const PANEL: u32 = 210;
const TITLE: u32 = 34;
/// What a panel shows to each side, in radii of the outer circle: the rest holds the words.
const REACH: f64 = 1.28;
/// The channels' colours.
const CHANNELS: [(usize, RGBColor); 3] = [
    (0, RGBColor(200, 40, 40)),
    (1, RGBColor(30, 140, 60)),
    (2, RGBColor(40, 80, 210)),
];
/// That of a lobe which all channels share.
const GREY: [(usize, RGBColor); 1] = [(0, RGBColor(60, 60, 60))];

/// Writes rows of panels: around the fibre, and along it.
pub fn write(path: &Path, title: &str, rows: &[Vec<Curve>; 2]) -> Result<(), Box<dyn Error>> {
    let columns = rows[0].len();
    let size = (PANEL * columns as u32, TITLE + 2 * PANEL);
    let root = SVGBackend::new(path, size).into_drawing_area();
    root.fill(&WHITE)?;
    root.draw(&Text::new(title.to_owned(), (12, 9), ("sans-serif", 17)))?;
    let (_, below) = root.split_vertically(TITLE);
    let panels = below.split_evenly((2, columns));
    for (number, panel) in panels.iter().enumerate() {
        let (row, column) = (number / columns, number % columns);
        draw(panel, &rows[row][column], row == 1)?;
    }
    root.present()?;
    Ok(())
}

fn draw(
    panel: &DrawingArea<SVGBackend, plotters::coord::Shift>,
    curve: &Curve,
    is_along: bool,
) -> Result<(), Box<dyn Error>> {
    let mut chart = ChartBuilder::on(panel).build_cartesian_2d(-REACH..REACH, -REACH..REACH)?;
    let grid = BLACK.mix(0.13);
    let turn = |radius: f64, angle: f64| (radius * angle.cos(), radius * angle.sin());
    for radius in [0.25, 0.5, 0.75, 1.0] {
        let circle = (0..=72).map(|i| turn(radius, f64::from(i).to_radians() * 5.0));
        chart.draw_series(LineSeries::new(circle, grid))?;
    }
    for degrees in (0..180).step_by(30) {
        let angle = f64::from(degrees).to_radians();
        chart.draw_series(LineSeries::new([turn(1.0, angle), turn(-1.0, angle)], grid))?;
    }
    // The light, and the fibre: end on, or from root to tip.
    let light = if is_along { LIGHT } else { 0.0 };
    let arrow = [turn(1.22, light), turn(1.04, light)];
    chart.draw_series(LineSeries::new(
        arrow,
        RGBColor(230, 150, 0).stroke_width(3),
    ))?;
    chart.draw_series([Circle::new(
        turn(1.04, light),
        4,
        RGBColor(230, 150, 0).filled(),
    )])?;
    if is_along {
        let fibre = [(0.0, -1.0), (0.0, 1.0)];
        chart.draw_series(LineSeries::new(fibre, BLACK.mix(0.45).stroke_width(3)))?;
    } else {
        chart.draw_series([Circle::new((0.0, 0.0), 4, BLACK.mix(0.45).filled())])?;
    }
    let peak = curve.peak();
    let channels: &[(usize, RGBColor)] = if curve.is_grey() { &GREY } else { &CHANNELS };
    for &(channel, colour) in channels {
        let path = |pick: &dyn Fn(&(f64, DVec3, DVec3)) -> DVec3| -> Vec<(f64, f64)> {
            let points = curve.points.iter();
            points.map(|p| turn(pick(p)[channel] / peak, p.0)).collect()
        };
        let (exact, found) = (path(&|p| p.2), path(&|p| p.1));
        chart.draw_series(LineSeries::new(exact, colour.mix(0.3).stroke_width(5)))?;
        chart.draw_series(LineSeries::new(found, colour.stroke_width(1)))?;
    }
    panel.draw(&Text::new(curve.name, (6, 4), ("sans-serif", 14)))?;
    let digits = if peak < 0.1 { 4 } else { 2 };
    let words = format!("peak {peak:.digits$}, error {:.0e}", curve.error());
    panel.draw(&Text::new(
        words,
        (6, PANEL as i32 - 16),
        ("sans-serif", 11),
    ))?;
    Ok(())
}
