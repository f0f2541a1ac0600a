//! Tests of the shaders as naga reads them, without a device.

use std::collections::BTreeSet;

use naga::valid::{Capabilities, ValidationFlags, Validator};
use pelage::testing;

fn parsed(name: &str, source: &str) -> naga::Module {
    naga::front::wgsl::parse_str(source)
        .unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(source)))
}

/// The struct of a module that has a name, with its size.
fn wgsl_struct<'a>(module: &'a naga::Module, name: &str) -> (&'a [naga::StructMember], u32) {
    let found = module.types.iter().find_map(|(_, held)| match &held.inner {
        naga::TypeInner::Struct { members, span } if held.name.as_deref() == Some(name) => {
            Some((&members[..], *span))
        }
        _ => None,
    });
    found.unwrap_or_else(|| panic!("no struct {name} in the module"))
}

/// Names that follow a keyword at the start of a line.
fn declared<'a>(text: &'a str, keyword: &str) -> BTreeSet<&'a str> {
    let name = |rest: &'a str| {
        rest.split(|c: char| !c.is_alphanumeric() && c != '_')
            .next()
            .unwrap()
    };
    text.lines()
        .filter_map(|line| line.strip_prefix(keyword))
        .map(name)
        .collect()
}

#[test]
fn every_combination_joins_and_validates() {
    for combination in testing::combinations() {
        let module = parsed(&combination.name, &combination.source);
        // What unpacking 16-bit floats asks for: every Vulkan device has it. And 64-bit atomics, which not every one has.
        let mut capabilities = Capabilities::SHADER_FLOAT16_IN_FLOAT32;
        if combination.name.contains("_64") {
            capabilities |= Capabilities::SHADER_INT64 | Capabilities::SHADER_INT64_ATOMIC_ALL_OPS;
        }
        let mut validator = Validator::new(ValidationFlags::all(), capabilities);
        if let Err(error) = validator.validate(&module) {
            panic!(
                "{}: {}",
                combination.name,
                error.emit_to_string(&combination.source)
            );
        }
        assert!(
            !module.entry_points.is_empty(),
            "{}: no entry point",
            combination.name
        );
    }
}

#[test]
fn every_shader_file_is_part_of_a_combination() {
    let combinations = testing::combinations();
    let used: BTreeSet<&str> = combinations
        .iter()
        .flat_map(|c| c.files.iter().copied())
        .collect();
    let common = ["common/layout", "common/frame", "common/optical_depth"];
    for stem in testing::shader_files() {
        assert!(
            used.contains(stem) || common.contains(&stem),
            "{stem} is in no combination"
        );
    }
}

#[test]
fn every_file_of_the_shader_folder_is_known() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/shaders");
    let mut folders = vec![std::path::PathBuf::from(root)];
    let mut found = BTreeSet::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path
                .extension()
                .is_some_and(|extension| extension == "wgsl")
            {
                found.insert(
                    path.strip_prefix(root)
                        .unwrap()
                        .with_extension("")
                        .to_str()
                        .unwrap()
                        .to_string(),
                );
            }
        }
    }
    let known: BTreeSet<String> = testing::shader_files()
        .into_iter()
        .map(String::from)
        .collect();
    // The hosts' helpers keep their own.
    found.retain(|stem| !stem.starts_with("host/"));
    assert_eq!(found, known);
}

#[test]
fn shared_structs_have_the_same_sizes_and_offsets_in_rust_and_wgsl() {
    let source = testing::module_source(&["common/pixels", "common/project"]);
    let header = "const CROSSES: bool = true;\nconst VIEW: bool = true;\n";
    let module = parsed("project", &format!("{header}{source}"));
    for layout in testing::layouts() {
        let (members, span) = wgsl_struct(&module, layout.name);
        // An array of them steps by the size rounded up to the alignment, which naga's span is.
        assert_eq!(span as usize, layout.size, "size of {}", layout.name);
        let fields: Vec<(&str, usize)> = members
            .iter()
            .map(|member| (member.name.as_deref().unwrap(), member.offset as usize))
            .collect();
        assert_eq!(fields, layout.fields, "fields of {}", layout.name);
    }
}

#[test]
fn every_shared_struct_is_compared() {
    let compared: BTreeSet<&str> = testing::layouts()
        .iter()
        .map(|layout| layout.name)
        .collect();
    assert_eq!(
        declared(include_str!("../src/layout.rs"), "pub struct "),
        compared
    );
    assert_eq!(
        declared(include_str!("../shaders/common/layout.wgsl"), "struct "),
        compared
    );
}

#[test]
fn shared_constants_have_the_same_values_in_rust_and_wgsl() {
    let files: [&[&str]; 4] = [
        &["common/scan"],
        &["transparency/overflow"],
        &["transparency/fragment_word"],
        &["common/order"],
    ];
    let sources = files.map(testing::module_source);
    let scan_again = "const SCAN_AGAIN: bool = false;\n";
    let modules = sources.map(|source| parsed("constants", &format!("{scan_again}{source}")));
    for (name, value) in testing::shared_constants() {
        let found = modules.iter().find_map(|module| {
            let (_, constant) = module
                .constants
                .iter()
                .find(|(_, c)| c.name.as_deref() == Some(name))?;
            match module.global_expressions[constant.init] {
                naga::Expression::Literal(naga::Literal::U32(found)) => Some(found),
                ref other => panic!("{name} is {other:?}"),
            }
        });
        assert_eq!(found, Some(value), "{name}");
    }
}

#[test]
fn an_error_is_mapped_back_to_its_file_and_line() {
    let files = ["common/coverage", "common/segment"];
    let source = testing::module_source(&files);
    let at = source
        .lines()
        .position(|line| line.starts_with("fn segment_reach"))
        .unwrap()
        + 1;
    let own = include_str!("../shaders/common/segment.wgsl");
    let expected = own
        .lines()
        .position(|line| line.starts_with("fn segment_reach"))
        .unwrap()
        + 1;
    assert_eq!(
        testing::module_origin(&files, at),
        format!("shaders/common/segment.wgsl:{expected}")
    );
}
