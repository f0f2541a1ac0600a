//! Renders a scene file offscreen:
//! `cargo run --release --example render -- SCENE.json --out OUT.exr [--stats STATS.json]`.
//!
//! Writes linear premultiplied RGBA as OpenEXR, beside it an sRGB PNG over black, and statistics as JSON. `scene.rs`
//! documents the format, which README.md shows by example.

mod framing;
mod groom;
mod mesh_pass;
mod meshes;
mod output;
mod picture;
mod scene;
mod techniques;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};

use picture::{Rendered, Renderer};
use scene::{Result, Scene};

/// Frames that are rendered before any is timed: shaders are compiled and pools find their size.
const WARM_UP_FRAMES: u32 = 2;

/// Renders a scene of hair offscreen.
#[derive(Debug, Parser)]
struct Arguments {
    /// The scene file.
    scene: PathBuf,
    /// The picture to write, linear RGBA, premultiplied; a PNG goes beside it.
    #[arg(long, value_name = "OUT.exr")]
    out: PathBuf,
    /// Write times, memory, fragments and the settings as resolved.
    #[arg(long, value_name = "STATS.json")]
    stats: Option<PathBuf>,
    /// The picture's size instead of the scene's.
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<[u32; 2]>,
    /// How many frames to time, after two that warm up.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    frames: u32,
    /// Fill the shadow maps anew in every frame, and do not take what an earlier one has filled.
    #[arg(long)]
    fresh_shadows: bool,
    /// Override a key of the scene; may be repeated.
    #[arg(long, value_name = "GROUP.KEY=JSON")]
    set: Vec<String>,
}

fn parse_size(text: &str) -> Result<[u32; 2]> {
    let size = |text: &str| text.parse::<u32>().ok().filter(|size| *size > 0);
    text.split_once(['x', 'X'])
        .and_then(|(width, height)| Some([size(width)?, size(height)?]))
        .ok_or_else(|| "a size is WIDTHxHEIGHT in pixels, such as 656x861".into())
}

fn main() -> ExitCode {
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("warn"))
        .format_target(false)
        .init();
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return refuse_arguments(&error),
    };
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("render: {}", one_sentence(&error));
            ExitCode::FAILURE
        }
    }
}

/// Help goes to stdout as it is; a wrong argument is one sentence.
fn refuse_arguments(error: &clap::Error) -> ExitCode {
    if !error.use_stderr() {
        // Nothing was rendered, but nothing else was asked for.
        print!("{error}");
        return ExitCode::SUCCESS;
    }
    let text = error.to_string();
    let reason: Vec<&str> = text
        .split("\n\nUsage:")
        .next()
        .unwrap_or(&text)
        .lines()
        .collect();
    eprintln!(
        "render: {}",
        one_sentence(reason.join(" ").trim_start_matches("error: "))
    );
    ExitCode::from(2)
}

/// Without line breaks and runs of spaces.
fn one_sentence(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn run(arguments: &Arguments) -> Result<()> {
    output::prepare(&arguments.out)?;
    let steps =
        4 + u64::from(WARM_UP_FRAMES + arguments.frames) + u64::from(arguments.stats.is_some());
    // Drawn on stderr, and only if that is a terminal.
    let progress = ProgressBar::new(steps).with_style(
        ProgressStyle::with_template("{bar:30} {pos}/{len} {msg} [{elapsed}]")
            .map_err(|error| error.to_string())?,
    );
    let step = |message: &'static str| {
        progress.inc(1);
        progress.set_message(message);
    };
    progress.tick();

    let mut scene = Scene::read(&arguments.scene, &arguments.set)?;
    if let Some([width, height]) = arguments.size {
        (scene.camera.width, scene.camera.height) = (width, height);
    }
    step("reading the groom");
    let groom = groom::load(&scene)?;
    let mesh = meshes::load(&scene)?;
    step("opening a device");
    let mut renderer = Renderer::new(&scene, &groom, &mesh)?;
    renderer.set_shadow_reuse(!arguments.fresh_shadows);
    step("warming up");
    for _ in 0..WARM_UP_FRAMES {
        renderer.render()?;
        step("warming up");
    }
    let mut times = Vec::new();
    for _ in 0..arguments.frames {
        times.push(renderer.render()?);
        step("rendering");
    }
    let picture = renderer.picture()?;
    let statistics = renderer.statistics();
    let png = output::write(&arguments.out, &picture)?;
    if let Some(path) = &arguments.stats {
        step("timing each pass");
        let rendered = Rendered {
            picture: &picture,
            times: output::Spread::of(&times),
            statistics: &statistics,
        };
        let value = renderer.statistics_json(&scene, &rendered)?;
        output::write_json(path, &value)?;
    }
    progress.finish_and_clear();
    let info = renderer.adapter_info();
    println!(
        "{} and {}: {} ({} {}), {} strands, {} segments, {:.0} ms a frame, {:.1} MB of GPU memory",
        arguments.out.display(),
        png.display(),
        info.name,
        info.driver,
        info.driver_info,
        statistics.strands,
        statistics.segments,
        output::Spread::of(&times).median,
        statistics.bytes_total as f64 / 1e6,
    );
    Ok(())
}
