//! The library's own device when the driver fails: `tests/c/lost.c`, with a library in the place of Vulkan's.

use std::path::PathBuf;
use std::process::Command;
use std::sync::OnceLock;

use super::programs::{compile, folder, root, run};
use super::vulkan::{silent, validated};

/// A library in the place of Vulkan's that lets calls fail; its folder.
pub(super) fn shim() -> &'static PathBuf {
    static SHIM: OnceLock<PathBuf> = OnceLock::new();
    SHIM.get_or_init(|| {
        let folder = folder("vulkan_shim");
        let mut compiler = Command::new("cc");
        compiler.args([
            "-std=c99", "-Wall", "-Wextra", "-Werror", "-fPIC", "-shared",
        ]);
        compiler.arg(root().join("tests/c/vulkan_shim.c"));
        compiler
            .arg("-o")
            .arg(folder.join("libvulkan.so.1"))
            .arg("-ldl")
            // Once it were unloaded, Vulkan's own would be found under its name.
            .arg("-Wl,-soname,libvulkan.so.1,-z,nodelete");
        run(&mut compiler);
        folder
    })
}

/// Where Vulkan's own loader lies, as the dynamic linker says.
pub(super) fn loader() -> String {
    let path = format!("{}:/usr/sbin:/sbin", std::env::var("PATH").unwrap());
    let known = run(Command::new("ldconfig").arg("-p").env("PATH", path));
    let line = known.lines().find(|line| line.contains("libvulkan.so.1 "));
    let (_, place) = line.expect("Vulkan's loader").split_once("=> ").unwrap();
    place.trim().to_owned()
}

/// Runs a mode of the program; what it says.
#[track_caller]
fn goes_right(mode: &str) -> String {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    let program = PROGRAM.get_or_init(|| compile("lost", "tests/c/lost.c", &[]));
    let printed = validated(
        Command::new(program)
            .arg(mode)
            .env("LD_LIBRARY_PATH", shim())
            .env("SHIM_VULKAN", loader()),
    );
    silent(&printed);
    assert_eq!(printed.lines().last(), Some("0 failures"), "{printed}");
    printed
}

#[test]
fn a_lost_device_of_its_own_leaves_a_dead_context_that_can_be_destroyed() {
    let printed = goes_right("lost");
    assert_eq!(
        printed.matches("the driver has given it up").count(),
        4,
        "{printed}"
    );
}

#[test]
fn memory_that_fails_leaves_the_context_alive_unless_the_driver_gives_up() {
    goes_right("memory");
}

#[test]
fn updates_without_a_frame_are_not_kept() {
    goes_right("updates");
}
