//! Windows of an X server that lives for one test: `tests/c/window.c` and the example, under the validation layer.

use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;

use super::lost::{loader, shim};
use super::programs::{compile, folder, has_header, run, skipped};
use super::vulkan::{silent, validated};

/// An X server without a screen.
struct Server {
    process: Child,
    display: String,
}

impl Server {
    /// `None` where there is none to be had: the test has then said so.
    fn start() -> Option<Self> {
        let spawned = Command::new("Xvfb")
            .args([
                "-displayfd",
                "1",
                "-screen",
                "0",
                "800x800x24",
                "-nolisten",
                "tcp",
            ])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let Ok(mut process) = spawned else {
            skipped("Xvfb (Debian's xvfb)");
            return None;
        };
        // It says which number it has taken when it is ready.
        let mut number = String::new();
        BufReader::new(process.stdout.take().unwrap())
            .read_line(&mut number)
            .unwrap();
        assert!(!number.trim().is_empty(), "Xvfb has ended");
        Some(Self {
            process,
            display: format!(":{}", number.trim()),
        })
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.process.kill().ok();
        self.process.wait().ok();
    }
}

/// The program, compiled once; `None` without the X server's headers.
fn program() -> Option<&'static PathBuf> {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    if !has_header("X11/Xutil.h") || !has_header("xcb/xcb.h") {
        skipped("headers of Xlib and Xcb (Debian's libx11-dev)");
        return None;
    }
    Some(PROGRAM.get_or_init(|| {
        let libraries = ["-D_POSIX_C_SOURCE=199309L", "-lX11", "-lxcb", "-lm"];
        compile("window", "tests/c/window.c", &libraries)
    }))
}

/// Runs a mode of the program that must go right, without a word of the layer's; what it says.
#[track_caller]
fn goes_right(mode: &str, environment: &[(&str, &str)]) -> Option<String> {
    let (server, program) = (Server::start()?, program()?);
    let printed = validated(
        Command::new(program)
            .arg(mode)
            .env("DISPLAY", &server.display)
            .envs(environment.iter().copied()),
    );
    silent(&printed);
    assert_eq!(printed.lines().last(), Some("0 failures"), "{printed}");
    Some(printed)
}

#[test]
fn a_windows_pictures_are_those_offscreen_and_the_screen_shows_them() {
    if let Some(printed) = goes_right("compare", &[]) {
        assert_eq!(
            printed.matches("the target is off by").count(),
            4,
            "{printed}"
        );
        assert_eq!(
            printed.matches("the screen is off by").count(),
            4,
            "{printed}"
        );
    }
}

#[test]
fn a_window_that_is_resized_or_minimised_is_followed() {
    if let Some(printed) = goes_right("resize", &[]) {
        assert_eq!(
            printed.matches("the screen is off by").count(),
            6,
            "{printed}"
        );
    }
}

#[test]
fn present_modes_and_formats_are_those_that_the_surface_has() {
    if let Some(printed) = goes_right("modes", &[]) {
        assert!(printed.contains("fifo: the screen is off by"), "{printed}");
    }
}

#[test]
fn wrong_windows_are_refused_with_a_sentence() {
    goes_right("refusals", &[]);
}

#[test]
fn a_window_that_is_no_more_is_an_error_and_its_context_lives_on() {
    goes_right("gone", &[]);
}

/// Runs a mode in which the window's images from `first` to `last` fail with `result`.
#[track_caller]
fn with_failing_images(mode: &str, result: i32, [first, last]: [u32; 2]) -> Option<String> {
    let [result, first, last] = [result.to_string(), first.to_string(), last.to_string()];
    goes_right(
        mode,
        &[
            ("LD_LIBRARY_PATH", shim().to_str().unwrap()),
            ("SHIM_VULKAN", &loader()),
            ("SHIM_RESULT", &result),
            ("SHIM_FIRST", &first),
            ("SHIM_LAST", &last),
        ],
    )
}

const VK_TIMEOUT: i32 = 2;
const VK_ERROR_DEVICE_LOST: i32 = -4;
const VK_ERROR_SURFACE_LOST_KHR: i32 = -1_000_000_000;
const VK_ERROR_OUT_OF_DATE_KHR: i32 = -1_000_001_004;

#[test]
fn a_surface_that_is_lost_or_outdated_is_made_anew() {
    for (result, anew) in [
        (VK_ERROR_SURFACE_LOST_KHR, 2),
        (VK_ERROR_OUT_OF_DATE_KHR, 0),
    ] {
        let Some(printed) = with_failing_images("lost", result, [3, 4]) else {
            return;
        };
        assert_eq!(printed.matches("shim: image").count(), 2, "{printed}");
        assert_eq!(
            printed.matches("has been made anew").count(),
            anew,
            "{printed}"
        );
    }
}

#[test]
fn a_window_that_never_comes_to_rest_skips_its_frames() {
    for result in [VK_ERROR_SURFACE_LOST_KHR, VK_ERROR_OUT_OF_DATE_KHR] {
        with_failing_images("changing", result, [1, 100]);
    }
    with_failing_images("timeout", VK_TIMEOUT, [1, 1]);
}

#[test]
fn a_device_that_is_lost_at_a_window_is_an_error_and_its_context_can_be_destroyed() {
    with_failing_images("device", VK_ERROR_DEVICE_LOST, [1, 1]);
}

/// The pixels of a PPM file.
fn ppm(path: PathBuf) -> Vec<u8> {
    let bytes = std::fs::read(&path).unwrap();
    bytes
        .strip_prefix(b"P6\n480 640\n255\n")
        .unwrap_or_else(|| panic!("{} is another picture", path.display()))
        .to_vec()
}

#[test]
fn the_window_example_shows_the_picture_of_the_offscreen_one() {
    let Some(server) = Server::start() else {
        return;
    };
    if !has_header("GLFW/glfw3.h") || !has_header("X11/extensions/Xrandr.h") {
        skipped("headers of GLFW (Debian's libglfw3-dev, libxrandr-dev)");
        return;
    }
    const STRANDS: &str = "2000";
    let offscreen = folder("window_offscreen");
    let picture = compile("window_offscreen", "examples/c/offscreen.c", &["-lm"]);
    run(Command::new(picture)
        .args(["picture.ppm", STRANDS])
        .current_dir(&offscreen));
    let expected = ppm(offscreen.join("picture.ppm"));

    let window = folder("window_example");
    let program = compile(
        "window_example",
        "examples/c/window.c",
        &["-lglfw", "-lX11", "-lm"],
    );
    for format in ["srgb8", "unorm8"] {
        let printed = validated(
            Command::new(&program)
                .args(["--frames", "8", "--turn", "0", "--strands", STRANDS])
                .args(["--format", format, "--screenshot", "picture.ppm"])
                .env("DISPLAY", &server.display)
                .current_dir(&window),
        );
        silent(&printed);
        assert!(
            printed.contains("2000 strands, 8 frames shown, 0 skipped"),
            "{printed}"
        );
        let shown = ppm(window.join("picture.ppm"));
        assert_eq!(shown.len(), expected.len());
        let hairy = expected.chunks(3).filter(|pixel| *pixel != &expected[..3]);
        assert!(hairy.count() > 480 * 640 / 10);
        // 8 bits; drivers round the sRGB curve their own way.
        let error = shown
            .iter()
            .zip(&expected)
            .map(|(a, b)| a.abs_diff(*b))
            .max();
        assert!(error <= Some(1), "{format}: off by {error:?} of 255");
    }
}
