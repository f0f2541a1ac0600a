//! The SPIR-V of `examples/c/vulkan_host.c` is what its WGSL says.

use std::path::Path;

/// The header that holds the module's words.
fn generate(source: &str) -> String {
    let module = naga::front::wgsl::parse_str(source).unwrap();
    let mut validator = naga::valid::Validator::new(
        naga::valid::ValidationFlags::all(),
        naga::valid::Capabilities::IMMEDIATES,
    );
    let info = validator.validate(&module).unwrap();
    // Neither debug names nor a flip of y: the host's viewport does that.
    let options = naga::back::spv::Options {
        flags: naga::back::spv::WriterFlags::empty(),
        ..Default::default()
    };
    let words = naga::back::spv::write_vec(&module, &info, &options, None).unwrap();
    let lines: String = words
        .chunks(10)
        .map(|line| {
            let line: Vec<_> = line.iter().map(|word| format!("0x{word:08x}")).collect();
            format!("    {},\n", line.join(", "))
        })
        .collect();
    format!(
        "/* Made from vulkan_host.wgsl by tests/capi/spirv.rs; do not edit. */\n#include <stdint.h>\n\n\
         static const uint32_t VULKAN_HOST_SPIRV[] = {{\n{lines}}};\n"
    )
}

#[test]
fn the_examples_spirv_is_what_its_wgsl_says() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/c");
    let source = std::fs::read_to_string(folder.join("vulkan_host.wgsl")).unwrap();
    let (fresh, path) = (generate(&source), folder.join("vulkan_host_spirv.h"));
    if std::env::var_os("PELAGE_BLESS").is_some() {
        std::fs::write(&path, &fresh).unwrap();
    }
    assert!(
        std::fs::read_to_string(&path).unwrap_or_default() == fresh,
        "run PELAGE_BLESS=1 cargo test spirv to write examples/c/vulkan_host_spirv.h"
    );
}
