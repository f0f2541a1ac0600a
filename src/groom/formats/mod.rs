//! Hair files, read from bytes in memory. What a file says is checked before anything is allocated for it.

mod bytes;
mod hair;
mod tfx;

pub use hair::{read_hair, write_hair};
pub use tfx::read_tfx;

use super::Strands;
use crate::error::{Error, Result};
use bytes::Bytes;

/// Reads strands from the bytes of a `.hair` file ([`read_hair`]) or a `.tfx` file ([`read_tfx`]), whichever they are.
///
/// # Errors
/// [`Error::InvalidFile`] where the bytes are neither, or do not follow their format.
pub fn read(bytes: &[u8]) -> Result<Strands> {
    if bytes.starts_with(hair::MAGIC) {
        return read_hair(bytes);
    }
    match Bytes::new(bytes, "file").f32(0, "version") {
        Ok(version) if tfx::is_version(version) => read_tfx(bytes),
        _ => Err(Error::InvalidFile(
            "the file is neither HAIR (no \"HAIR\" at its start) nor TressFX (no version from 3 to below 5)".into(),
        )),
    }
}
