//! Names the shared library as programs will look for it: `libpelage.so.0`, after the ABI's major version.
//!
//! Nothing is generated here. The C header is written by `tests/capi/header.rs`, on request only.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let environment = |name: &str| std::env::var(name).unwrap_or_default();
    match environment("CARGO_CFG_TARGET_OS").as_str() {
        "linux" | "android" | "freebsd" | "netbsd" | "openbsd" => {
            println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libpelage.so.0");
        }
        "macos" | "ios" => {
            println!("cargo::rustc-cdylib-link-arg=-Wl,-install_name,@rpath/libpelage.0.dylib");
        }
        _ => {}
    }
}
