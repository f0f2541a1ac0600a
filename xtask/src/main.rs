//! What people and CI run: `cargo xtask check | report | gallery`.

mod check;
mod gallery;
mod report;
mod scene_file;

use std::process::{Command, ExitCode};

use clap::{Parser, Subcommand};

/// A value, or one sentence on what went wrong.
type Result<T> = std::result::Result<T, String>;

/// The project's chores.
#[derive(Debug, Parser)]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Formatting, lints, documentation and tests, as CI runs them.
    Check,
    /// Measures every technique's error, time and memory into docs/report/.
    Report(report::Options),
    /// Renders the three built-in grooms into out/.
    Gallery,
}

fn main() -> ExitCode {
    let done = match Arguments::parse().task {
        Task::Check => check::run(),
        Task::Report(options) => report::run(&options),
        Task::Gallery => gallery::run(),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Runs cargo in the workspace's root; its output goes where ours goes.
fn cargo(arguments: &[&str], environment: &[(&str, &str)]) -> Result<()> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let line = arguments.join(" ");
    let status = Command::new(cargo)
        .args(arguments)
        .envs(environment.iter().copied())
        .current_dir(root())
        .status()
        .map_err(|error| format!("cargo {line} cannot be started: {error}"))?;
    if status.success() {
        Ok(())
    } else {
        Err(format!("cargo {line} failed with {status}"))
    }
}

/// The workspace's root.
fn root() -> &'static std::path::Path {
    let manifest = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    manifest.parent().unwrap_or(manifest)
}
