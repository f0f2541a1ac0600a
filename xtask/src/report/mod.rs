//! `cargo xtask report`: scene × technique × settings → error against the double-precision reference, time and memory.
//!
//! Writes `docs/report/report.json`, a list of rows, and from it tables (`docs/report/README.md`) and plots (SVG). Rows
//! that are already there are kept, so that a run that was stopped goes on where it was.

mod choice;
mod estimate;
mod flip;
mod frames;
mod kept;
mod ladder;
mod measure;
#[path = "../../../tests/shading/reference.rs"]
mod models;
mod plots;
mod published;
mod row;
mod samples;
mod scenes;
mod tables;
mod truth;

use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};

use pelage::shadow::Shadow;

use crate::{Result, root};
use ladder::Case;
use row::Row;
use scenes::{SCENES, Scene};

/// What is measured.
#[derive(Debug, Clone, Args)]
pub struct Options {
    /// The small scene only.
    #[arg(long)]
    quick: bool,
    /// One group only.
    #[arg(long)]
    group: Option<Group>,
    /// One scene only, by its name in the tables.
    #[arg(long, value_name = "NAME")]
    scene: Option<String>,
    /// One technique only, by its stem.
    #[arg(long, value_name = "STEM")]
    technique: Option<String>,
    /// Say what is missing and about how long it takes, and measure nothing.
    #[arg(long)]
    list: bool,
    /// Measure again what is already in report.json.
    #[arg(long)]
    force: bool,
}

/// A kind of technique.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Group {
    /// Shading models.
    Shading,
    /// Shading models by themselves: nanoseconds a sample.
    Samples,
    /// Whole frames of all shading models in one run.
    Frames,
    /// Shadow techniques.
    Shadow,
    /// Transparency techniques.
    Transparency,
}

impl Group {
    /// Its name in rows.
    fn name(self) -> &'static str {
        match self {
            Self::Shading => "shading",
            Self::Samples => "samples",
            Self::Frames => "frames",
            Self::Shadow => "shadow",
            Self::Transparency => "transparency",
        }
    }
}

/// Measures what is missing, and writes everything.
pub fn run(options: &Options) -> Result<()> {
    let folder = root().join("docs/report");
    std::fs::create_dir_all(&folder)
        .map_err(|error| format!("{} cannot be made: {error}", folder.display()))?;
    let path = folder.join("report.json");
    let mut rows = row::load(&path)?;
    let scenes = chosen(options)?;
    if options.list {
        let missing = |scene| (scene, missing(scene, options, &rows));
        print!("{}", estimate::list(scenes.into_iter().map(missing), &rows));
        return Ok(());
    }
    for scene in scenes {
        let cases = cases(scene, options);
        let missing = missing(scene, options, &rows);
        println!(
            "{}: {} rows, {} to measure",
            scene.name,
            cases.len(),
            missing.len()
        );
        if missing.is_empty() {
            continue;
        }
        if !scene.is_there() {
            eprintln!(
                "xtask: {} is left out: its scene file is not there",
                scene.name
            );
            continue;
        }
        let progress = ProgressBar::new(missing.len() as u64).with_style(
            ProgressStyle::with_template("{bar:30} {pos}/{len} {msg} [{elapsed}]")
                .map_err(|error| error.to_string())?,
        );
        let truth = truth::Truth::new(scene)?;
        let (in_turns, alone): (Vec<Case>, Vec<Case>) = missing
            .into_iter()
            .partition(|case| case.group == Group::Frames);
        for shadow in turns(&in_turns) {
            // What takes turns is measured whole, even if some of it is there.
            let turn: Vec<Case> = (cases.iter())
                .filter(|case| case.group == Group::Frames && case.shadow == shadow)
                .cloned()
                .collect();
            let measured = frames::measure(scene, &truth, &turn, &progress)?;
            rows.retain(|old| !turn.iter().any(|case| old.is_of(case, scene)));
            for row in measured {
                progress.suspend(|| println!("{row}"));
                rows.push(row);
            }
            row::save(&path, &rows)?;
        }
        for case in &alone {
            progress.set_message(case.to_string());
            match measure::measure(scene, &truth, case) {
                Ok(row) => {
                    progress.suspend(|| println!("{row}"));
                    rows.retain(|old| !old.is_of(case, scene));
                    rows.push(row);
                    row::save(&path, &rows)?;
                }
                Err(error) => progress
                    .suspend(|| eprintln!("xtask: {case} on {} is left out: {error}", scene.name)),
            }
            progress.inc(1);
        }
        progress.finish_and_clear();
    }
    row::save(&path, &rows)?;
    tables::write(&folder, &rows)?;
    plots::write(&folder, &rows)
}

/// The shadow techniques of cases that take turns: those with the same one do so together.
fn turns(cases: &[Case]) -> Vec<Shadow> {
    let mut shadows = Vec::new();
    for case in cases {
        if !shadows.contains(&case.shadow) {
            shadows.push(case.shadow);
        }
    }
    shadows
}

/// The cases of a scene that the options ask for.
fn cases(scene: &Scene, options: &Options) -> Vec<Case> {
    let stem = options.technique.as_deref();
    let wanted = |case: &Case| {
        options.group.is_none_or(|group| group == case.group)
            && stem.is_none_or(|stem| stem == case.technique())
    };
    let cases = ladder::cases(scene, options.quick).into_iter();
    cases.filter(wanted).collect()
}

/// Those of them that are still to be measured, or lack something.
fn missing(scene: &Scene, options: &Options, rows: &[Row]) -> Vec<Case> {
    let measured = |case: &Case| {
        let of_case = |row: &&Row| row.is_of(case, scene);
        rows.iter().find(of_case).is_some_and(Row::is_whole)
    };
    let mut missing = cases(scene, options);
    missing.retain(|case| options.force || !measured(case));
    missing
}

/// The scenes that the options ask for.
fn chosen(options: &Options) -> Result<Vec<&'static Scene>> {
    let scenes: Vec<_> = match &options.scene {
        Some(name) => SCENES.iter().filter(|scene| scene.name == name).collect(),
        None => SCENES
            .iter()
            .filter(|scene| scene.quick || !options.quick)
            .collect(),
    };
    if scenes.is_empty() {
        let known: Vec<_> = SCENES.iter().map(|scene| scene.name).collect();
        let name = options.scene.as_deref().unwrap_or_default();
        return Err(format!(
            "--scene {name} is unknown; there are {}",
            known.join(", ")
        ));
    }
    Ok(scenes)
}
