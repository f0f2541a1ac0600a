//! Hosts in other languages, and hosts that build against an installed library.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::programs::{WARNINGS, compile, folder, has_program, library, root, run, skipped};

/// Compiles a C++ program against the header and the library.
fn compile_cpp(name: &str, source: &str, flags: &[&str]) -> PathBuf {
    let folder = super::programs::linkable(name);
    let program = folder.join("program");
    let mut compiler = Command::new("c++");
    compiler
        .args(["-std=c++17", "-Wshadow", "-Wconversion"])
        .args(WARNINGS)
        .args(flags)
        .arg("-I")
        .arg(root().join("include"))
        .arg(root().join(source))
        .arg("-o")
        .arg(&program)
        .arg("-L")
        .arg(&folder)
        .arg(format!("-Wl,-rpath,{}", folder.display()))
        .arg("-lpelage");
    run(&mut compiler);
    program
}

/// The picture of the C example, of 2000 strands.
fn picture_of_the_c_example(name: &str) -> Vec<u8> {
    let program = compile(name, "examples/c/offscreen.c", &["-lm"]);
    run(Command::new(program)
        .args(["picture.ppm", "2000"])
        .current_dir(folder(name)));
    std::fs::read(folder(name).join("picture.ppm")).unwrap()
}

#[test]
fn cpp_objects_own_what_they_hold_with_exceptions_and_without() {
    for (name, flags) in [
        ("raii", &[][..]),
        ("raii_without_exceptions", &["-fno-exceptions", "-fno-rtti"]),
    ] {
        let program = compile_cpp(name, "tests/c/raii.cpp", flags);
        let printed = run(&mut Command::new(program));
        assert_eq!(printed.lines().last(), Some("0 failures"), "{printed}");
    }
}

#[test]
fn the_cpp_example_draws_the_picture_of_the_c_one() {
    let program = compile_cpp("offscreen_cpp", "examples/cpp/offscreen.cpp", &[]);
    let folder = folder("offscreen_cpp");
    let printed = run(Command::new(&program)
        .args(["picture.ppm", "2000"])
        .current_dir(&folder));
    assert!(
        printed.contains("2000 strands; wrote picture.ppm"),
        "{printed}"
    );
    let picture = std::fs::read(folder.join("picture.ppm")).unwrap();
    assert!(
        picture == picture_of_the_c_example("offscreen_for_cpp"),
        "the two pictures differ"
    );
    // An error ends it with the library's sentence.
    let failed = Command::new(program)
        .args(["none.ppm", "99999999999"])
        .current_dir(&folder)
        .output()
        .unwrap();
    assert_eq!(failed.status.code(), Some(1));
    let sentence = String::from_utf8_lossy(&failed.stderr);
    assert!(sentence.contains("99999999999"), "{sentence}");
}

/// A Python that has NumPy, or else any: the one on the path, or Debian's own.
fn python() -> Option<(&'static str, bool)> {
    let works = |program: &str, code: &str| {
        Command::new(program)
            .args(["-c", code])
            .output()
            .is_ok_and(|output| output.status.success())
    };
    let candidates = ["python3", "/usr/bin/python3"];
    let with = candidates
        .into_iter()
        .find(|program| works(program, "import numpy"));
    let any = candidates
        .into_iter()
        .find(|program| works(program, "pass"));
    with.map(|program| (program, true))
        .or(any.map(|program| (program, false)))
}

#[test]
fn the_python_example_draws_the_picture_of_the_c_one() {
    let Some((python, numpy)) = python() else {
        skipped("Python (Debian's python3)");
        return;
    };
    let folder = folder("python");
    let printed = run(Command::new(python)
        .arg(root().join("examples/python/offscreen.py"))
        .arg("--library")
        .arg(library())
        .args(["--strands", "2000", "--out", "picture.ppm"])
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .current_dir(&folder));
    assert!(printed.contains("2000 strands"), "{printed}");
    if numpy {
        assert!(
            printed.contains("a NumPy array of (640, 480, 4), float32"),
            "{printed}"
        );
    } else {
        skipped("NumPy (Debian's python3-numpy): the picture is in a ctypes array");
    }
    let picture = std::fs::read(folder.join("picture.ppm")).unwrap();
    let expected = picture_of_the_c_example("offscreen_for_python");
    assert_eq!(picture.len(), expected.len());
    // Single against double precision where the wall is added.
    let error = picture
        .iter()
        .zip(&expected)
        .map(|(a, b)| a.abs_diff(*b))
        .max();
    assert!(error <= Some(1), "off by {error:?} of 255");
}

#[test]
fn the_python_example_of_moving_guides_reads_what_is_beside_the_colour() {
    let Some((python, _)) = python() else {
        skipped("Python (Debian's python3)");
        return;
    };
    let folder = folder("python_moving");
    let printed = run(Command::new(python)
        .arg(root().join("examples/python/moving.py"))
        .arg("--library")
        .arg(library())
        .args(["--steps", "3", "--out", "motion.ppm"])
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .current_dir(&folder));
    // Pixels, strands, copies, coverage, depth and motion of each step.
    let steps: Vec<Vec<f64>> = printed
        .lines()
        .map(|line| {
            let (_, figures) = line.split_once(": ").unwrap();
            let words = figures.split([' ', ',']);
            words.filter_map(|word| word.parse().ok()).collect()
        })
        .collect();
    let [first, _, last] = &steps[..] else {
        panic!("{printed}");
    };
    assert!(steps.iter().all(|step| step.len() == 6), "{printed}");
    assert!(
        steps
            .iter()
            .all(|step| step[0] > 1_000.0 && step[1] > 100.0)
    );
    assert!(steps.iter().all(|step| step[2] == 2.0 && step[3] > 500.0));
    // Nothing has moved before the first step; then the guides do, and one copy comes nearer.
    assert!(first[5] == 0.0 && last[5] > 3.0, "{printed}");
    assert!(last[4] < first[4], "{printed}");
    assert_eq!(
        std::fs::metadata(folder.join("motion.ppm")).unwrap().len(),
        15 + 3 * 192 * 192
    );
}

/// Installs the library under test below a new folder of this test's own.
fn install(name: &str, variables: &[(&str, &Path)]) -> PathBuf {
    let folder = folder(name);
    std::fs::remove_dir_all(&folder).unwrap();
    std::fs::create_dir_all(&folder).unwrap();
    let mut make = Command::new("make");
    make.arg("-C").arg(root()).arg("install");
    make.arg(format!("FROM={}", library().parent().unwrap().display()));
    for (variable, value) in variables {
        make.arg(format!("{variable}={}", value.display()));
    }
    // What the make that runs the tests has been told is not for this one.
    for variable in [
        "MAKEFLAGS",
        "MFLAGS",
        "PREFIX",
        "LIBDIR",
        "INCLUDEDIR",
        "DESTDIR",
    ] {
        make.env_remove(variable);
    }
    run(&mut make);
    folder
}

const EXPECTED: &str = concat!("pelage ", env!("CARGO_PKG_VERSION"), ", 12 strands\n");

#[cfg(target_os = "linux")]
#[test]
fn a_cmake_project_of_ten_lines_builds_against_the_installed_library() {
    if !has_program("cmake") {
        skipped("CMake (Debian's cmake)");
        return;
    }
    let project = root().join("tests/c/cmake");
    let lines = std::fs::read_to_string(project.join("CMakeLists.txt")).unwrap();
    assert_eq!(lines.lines().count(), 10);
    let prefix = folder("install_cmake").join("prefix");
    let build = install("install_cmake", &[("PREFIX", &prefix)]).join("build");
    run(Command::new("cmake")
        .arg("-S")
        .arg(&project)
        .arg("-B")
        .arg(&build)
        .arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display())));
    run(Command::new("cmake").arg("--build").arg(&build));
    for program in ["host_c", "host_cpp"] {
        assert_eq!(run(&mut Command::new(build.join(program))), EXPECTED);
        let needed = run(Command::new("readelf").arg("-d").arg(build.join(program)));
        assert!(needed.contains("[libpelage.so.0]"), "{needed}");
    }
    // Another version is not found.
    let refused = Command::new("cmake")
        .args([
            "--find-package",
            "-DNAME=pelage",
            "-DLANGUAGE=C",
            "-DCOMPILER_ID=GNU",
            "-DMODE=EXIST",
        ])
        .arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display()))
        .current_dir(&build)
        .output()
        .unwrap();
    assert!(refused.status.success(), "{refused:?}");
    let other = folder("install_cmake").join("other");
    std::fs::create_dir_all(&other).unwrap();
    std::fs::write(
        other.join("CMakeLists.txt"),
        "cmake_minimum_required(VERSION 3.16)\nproject(other NONE)\nfind_package(pelage 0.2 REQUIRED)\n",
    )
    .unwrap();
    let refused = Command::new("cmake")
        .arg("-S")
        .arg(&other)
        .arg("-B")
        .arg(other.join("build"))
        .arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display()))
        .output()
        .unwrap();
    let sentence = String::from_utf8_lossy(&refused.stderr);
    assert!(
        !refused.status.success()
            && sentence.contains(concat!("version: ", env!("CARGO_PKG_VERSION"))),
        "{sentence}"
    );
}

#[cfg(target_os = "linux")]
#[test]
fn pkg_config_finds_the_installed_library() {
    if !has_program("pkg-config") {
        skipped("pkg-config (Debian's pkg-config)");
        return;
    }
    let prefix = folder("install_pkg_config").join("prefix");
    let folder = install("install_pkg_config", &[("PREFIX", &prefix)]);
    let ask = |argument: &str| {
        run(Command::new("pkg-config")
            .args([argument, "pelage"])
            .env("PKG_CONFIG_PATH", prefix.join("lib/pkgconfig")))
    };
    assert_eq!(ask("--modversion").trim(), env!("CARGO_PKG_VERSION"));
    let program = folder.join("program");
    let mut compiler = Command::new("cc");
    compiler.arg("-std=c99").args(WARNINGS);
    compiler.args(ask("--cflags").split_whitespace());
    compiler.arg(root().join("tests/c/cmake/host.c"));
    compiler.arg("-o").arg(&program);
    compiler.args(ask("--libs").split_whitespace());
    run(&mut compiler);
    assert_eq!(
        run(Command::new(program).env("LD_LIBRARY_PATH", prefix.join("lib"))),
        EXPECTED
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_staged_installation_names_the_place_where_it_will_be() {
    let stage = folder("install_staged").join("stage");
    install(
        "install_staged",
        &[("PREFIX", Path::new("/opt/hair")), ("DESTDIR", &stage)],
    );
    let installed = stage.join("opt/hair");
    for file in [
        "include/pelage.h",
        "include/pelage.hpp",
        "lib/libpelage.so",
        "lib/libpelage.so.0",
        concat!("lib/libpelage.so.", env!("CARGO_PKG_VERSION")),
        "lib/pkgconfig/pelage.pc",
        "lib/cmake/pelage/pelageConfig.cmake",
        "lib/cmake/pelage/pelageConfigVersion.cmake",
    ] {
        assert!(installed.join(file).is_file(), "{file} is missing");
    }
    for file in [
        "lib/pkgconfig/pelage.pc",
        "lib/cmake/pelage/pelageConfig.cmake",
    ] {
        let text = std::fs::read_to_string(installed.join(file)).unwrap();
        assert!(text.contains("/opt/hair/lib"), "{text}");
        assert!(!text.contains("stage") && !text.contains('@'), "{text}");
    }
    // A path that is not absolute is refused by its name.
    let refused = Command::new("make")
        .arg("-C")
        .arg(root())
        .args(["install", "PREFIX=hair", "FROM=nowhere"])
        .output()
        .unwrap();
    let sentence = String::from_utf8_lossy(&refused.stderr);
    assert!(
        !refused.status.success() && sentence.contains("PREFIX is hair"),
        "{sentence}"
    );
}
