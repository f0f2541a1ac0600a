//! C and C++ programs: the header alone with every warning an error, its initialisers, and programs that link the library.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use pelage::capi::*;

pub(super) const WARNINGS: [&str; 4] = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"];

pub(super) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The C library that belongs to this test program: cargo puts both into one folder.
pub(super) fn library() -> PathBuf {
    let folder = std::env::current_exe()
        .unwrap()
        .parent()
        .unwrap()
        .to_path_buf();
    let name = format!(
        "{}pelage{}",
        std::env::consts::DLL_PREFIX,
        std::env::consts::DLL_SUFFIX
    );
    let library = folder.join(name);
    assert!(
        library.exists(),
        "{} is missing: cargo build makes it",
        library.display()
    );
    library
}

/// A folder of this test's own.
pub(super) fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("capi")
        .join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[track_caller]
pub(super) fn run(command: &mut Command) -> String {
    let Output {
        status,
        stdout,
        stderr,
    } = command
        .output()
        .unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let (out, error) = (
        String::from_utf8_lossy(&stdout),
        String::from_utf8_lossy(&stderr),
    );
    assert!(status.success(), "{command:?}: {status}\n{out}\n{error}");
    out.into_owned()
}

/// Compiles a C program against the header and the library, and runs it.
fn compile_and_run(name: &str, source: &str, arguments: &[&str]) -> String {
    let program = compile(name, source, &["-lm"]);
    run(Command::new(program)
        .args(arguments)
        .current_dir(folder(name)))
}

/// A folder of this test's own, with the library under its soname and under the name that a linker looks for.
pub(super) fn linkable(name: &str) -> PathBuf {
    let folder = folder(name);
    for alias in [
        "libpelage.so",
        "libpelage.so.0",
        "libpelage.dylib",
        "libpelage.0.dylib",
    ] {
        std::fs::remove_file(folder.join(alias)).ok();
        std::os::unix::fs::symlink(library(), folder.join(alias)).unwrap();
    }
    folder
}

/// Says, past cargo's capture, that a test did not run, or not all of it, for want of a program or a package:
/// scripts/test.sh counts what was said.
pub(super) fn skipped(what: &str) {
    let thread = std::thread::current();
    let test = thread.name().unwrap_or("a test");
    writeln!(std::io::stderr(), "skipped: {test}: no {what}").ok();
}

/// Whether the C compiler finds a header.
pub(super) fn has_header(header: &str) -> bool {
    let source = folder("has_header").join(format!("{}.c", header.replace('/', "_")));
    std::fs::write(
        &source,
        format!("#include <stdio.h>\n#include <{header}>\n"),
    )
    .unwrap();
    let mut compiler = Command::new("cc");
    compiler.args(["-fsyntax-only", "-x", "c"]).arg(source);
    compiler
        .output()
        .is_ok_and(|output| output.status.success())
}

/// Whether there is a program of that name.
pub(super) fn has_program(name: &str) -> bool {
    Command::new(name)
        .arg("--version")
        .output()
        .is_ok_and(|output| output.status.success())
}

/// Compiles a C program against the header and the library.
pub(super) fn compile(name: &str, source: &str, libraries: &[&str]) -> PathBuf {
    let folder = linkable(name);
    let program = folder.join("program");
    let mut compiler = Command::new("cc");
    compiler
        .arg("-std=c99")
        .args(WARNINGS)
        .arg("-I")
        .arg(root().join("include"));
    compiler.arg(root().join(source)).arg("-o").arg(&program);
    compiler
        .arg("-L")
        .arg(&folder)
        .arg(format!("-Wl,-rpath,{}", folder.display()))
        .arg("-lpelage")
        .args(libraries);
    run(&mut compiler);
    program
}

#[test]
fn the_header_compiles_alone_as_c99_c11_and_cpp17_without_a_warning() {
    let folder = folder("header");
    let ways = [
        ("cc", "c", "c99"),
        ("cc", "c", "c11"),
        ("c++", "c++", "c++17"),
    ];
    for (compiler, language, standard) in ways {
        let source = folder.join(format!(
            "{}.{}",
            standard.replace("++", "pp"),
            language.replace("++", "pp")
        ));
        // Twice, as programs do; and every initialiser once. With Vulkan's types, and without.
        let types = [
            "Strands",
            "Frame",
            "Light",
            "View",
            "Adapter",
            "KajiyaKay",
            "Scheuermann",
            "Marschner",
            "Sadeghi",
            "Chiang",
            "ABuffer",
            "Statistics",
            "VulkanInstance",
            "VulkanRequirements",
            "VulkanDevice",
            "VulkanImage",
            "VulkanView",
            "VulkanSemaphore",
            "VulkanSubmit",
            "Window",
            "WindowInfo",
        ];
        let macros = [
            "STRANDS",
            "FRAME",
            "LIGHT",
            "VIEW",
            "ADAPTER",
            "KAJIYA_KAY",
            "SCHEUERMANN",
            "MARSCHNER",
            "SADEGHI",
            "CHIANG",
            "A_BUFFER",
            "STATISTICS",
            "VULKAN_INSTANCE",
            "VULKAN_REQUIREMENTS",
            "VULKAN_DEVICE",
            "VULKAN_IMAGE",
            "VULKAN_VIEW",
            "VULKAN_SEMAPHORE",
            "VULKAN_SUBMIT",
            "WINDOW",
            "WINDOW_INFO",
        ];
        let uses: String = types
            .iter()
            .zip(macros)
            .map(|(name, initialiser)| {
                format!("uint32_t use_{name}(void);\nuint32_t use_{name}(void) {{ Pelage{name} value = PELAGE_{initialiser}_INIT; return value.struct_size; }}\n")
            })
            .collect();
        std::fs::write(
            &source,
            format!("#include \"pelage.h\"\n#include \"pelage.h\"\n{uses}"),
        )
        .unwrap();
        for define in ["-UPELAGE_VULKAN", "-DPELAGE_VULKAN"] {
            let mut command = Command::new(compiler);
            command
                .args(["-x", language, define, "-fsyntax-only"])
                .arg(format!("-std={standard}"))
                .args(WARNINGS);
            run(command.arg("-I").arg(root().join("include")).arg(&source));
        }
    }
}

#[test]
fn the_headers_initialisers_are_the_librarys_defaults() {
    let printed = compile_and_run("initialisers", "tests/c/initialisers.c", &[]);
    let mut expected = String::new();
    macro_rules! expect {
        ($($type:ident),* $(,)?) => {
            $(
                let value = $type::default();
                // SAFETY: a `repr(C)` struct without padding, as `descriptor` checks, is as many bytes as its size.
                let bytes = unsafe {
                    std::slice::from_raw_parts(std::ptr::from_ref(&value).cast::<u8>(), size_of::<$type>())
                };
                let hex: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
                expected += &format!("{} {hex}\n", stringify!($type));
            )*
        };
    }
    expect!(
        PelageContextDescriptor,
        PelageAdapter,
        PelageStrands,
        PelageInterpolationSettings,
        PelageClumpSettings,
        PelageFile,
        PelageHairInfo,
        PelageKajiyaKay,
        PelageScheuermann,
        PelageMarschner,
        PelageSadeghi,
        PelageChiang,
        PelageShading,
        PelageDeepOpacityMap,
        PelageShadowMap,
        PelageApproximatedDeepShadowMap,
        PelageOpacityShadowMaps,
        PelageMomentOpacityMap,
        PelageKBufferVolume,
        PelageShadow,
        PelageOpaque,
        PelageABuffer,
        PelageDbkBuffer,
        PelageWeightedBlended,
        PelageDepthPeeling,
        PelageRandomSubsets,
        PelageSortedBlending,
        PelageKBuffer,
        PelageKPlusBuffer,
        PelageKBufferSinglePass,
        PelageMoment,
        PelageTransparency,
        PelageView,
        PelageLight,
        PelageFrame,
        PelageTargetDescriptor,
        PelageMemoryEstimate,
        PelageStatistics,
        PelageVulkanInstance,
        PelageVulkanRequirements,
        PelageVulkanDevice,
        PelageVulkanImage,
        PelageVulkanView,
        PelageVulkanOccluder,
        PelageVulkanShadowImage,
        PelageVulkanPoints,
        PelageVulkanSemaphore,
        PelageVulkanSubmit,
        PelageWindow,
        PelageWindowInfo,
    );
    for (printed, expected) in printed.lines().zip(expected.lines()) {
        assert_eq!(printed, expected);
    }
    assert_eq!(printed.lines().count(), expected.lines().count());
}

#[test]
fn the_example_draws_a_picture() {
    let printed = compile_and_run(
        "offscreen",
        "examples/c/offscreen.c",
        &["picture.ppm", "2000"],
    );
    assert!(
        printed.contains("2000 strands") && printed.contains("wrote picture.ppm"),
        "{printed}"
    );
    let picture = std::fs::read(folder("offscreen").join("picture.ppm")).unwrap();
    let pixels = picture
        .strip_prefix(b"P6\n480 640\n255\n")
        .expect("a PPM's header");
    assert_eq!(pixels.len(), 480 * 640 * 3);
    let wall = &pixels[..3];
    let hairy = pixels.chunks(3).filter(|pixel| *pixel != wall).count();
    assert!(hairy > 480 * 640 / 50, "{hairy} pixels show hair");
}

#[test]
fn a_program_that_does_everything_wrong_survives() {
    let printed = compile_and_run("abuse", "tests/c/abuse.c", &["1", "validated"]);
    // Its contexts ask for the validation layer, which writes to the standard output.
    assert!(!printed.contains("Validation"), "{printed}");
    assert_eq!(printed.lines().last(), Some("0 failures"), "{printed}");
}

#[cfg(target_os = "linux")]
#[test]
fn the_library_exports_pelage_symbols_alone_under_its_soname() {
    let symbols = run(Command::new("nm")
        .args(["-D", "--defined-only"])
        .arg(library()));
    let names: Vec<&str> = symbols
        .lines()
        .filter_map(|line| line.split_whitespace().last())
        .collect();
    assert!(names.len() > 30, "{symbols}");
    assert!(
        names.iter().all(|name| name.starts_with("pelage_")),
        "{symbols}"
    );
    let header = std::fs::read_to_string(root().join("include/pelage.h")).unwrap();
    for name in &names {
        assert!(
            header.contains(&format!("{name}(")),
            "{name} is not in the header"
        );
    }
    let dynamic = run(Command::new("readelf").arg("-d").arg(library()));
    assert!(
        dynamic.contains(&format!("[libpelage.so.{PELAGE_ABI_VERSION}]")),
        "{dynamic}"
    );
}
