//! Which library this is.

use std::ffi::c_char;

/// Major version of the header's library.
pub const PELAGE_VERSION_MAJOR: u32 = 0;
/// Minor version of the header's library.
pub const PELAGE_VERSION_MINOR: u32 = 1;
/// Patch version of the header's library.
pub const PELAGE_VERSION_PATCH: u32 = 0;
/// Version of the ABI. Programs built against it run with every library of the same number, which is that of the
/// library's file name too: `libpelage.so.0`.
pub const PELAGE_ABI_VERSION: u32 = 0;

/// The version of the library that is linked, as "major.minor.patch". Cannot fail; any thread; valid for ever.
#[unsafe(no_mangle)]
pub extern "C" fn pelage_version() -> *const c_char {
    const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    VERSION.as_ptr().cast()
}

/// The ABI's version of the library that is linked: to be compared with `PELAGE_ABI_VERSION`. Cannot fail; any thread.
#[unsafe(no_mangle)]
pub extern "C" fn pelage_abi_version() -> u32 {
    PELAGE_ABI_VERSION
}
