//! Little-endian numbers at given places of a file, every access checked against the file's size.

use crate::error::{Error, Result};

/// A file's bytes and the name of its format, which starts every error.
#[derive(Clone, Copy)]
pub(super) struct Bytes<'a> {
    bytes: &'a [u8],
    format: &'static str,
}

impl<'a> Bytes<'a> {
    /// Views `bytes` as a file of `format`.
    pub(super) fn new(bytes: &'a [u8], format: &'static str) -> Self {
        Self { bytes, format }
    }

    /// An error about this file.
    pub(super) fn error<T>(&self, what: impl std::fmt::Display) -> Result<T> {
        Err(Error::InvalidFile(format!("{} file: {what}", self.format)))
    }

    /// Turns the complaint of a constructor about values that came from this file into one about the file.
    pub(super) fn blame<T>(&self, result: Result<T>) -> Result<T> {
        match result {
            Err(Error::InvalidValue(what)) => self.error(what),
            other => other,
        }
    }

    /// `count` entries of `stride` bytes from byte `at`, called `name` in an error.
    pub(super) fn array(&self, at: u64, count: u64, stride: u64, name: &str) -> Result<&'a [u8]> {
        let end = count
            .checked_mul(stride)
            .and_then(|size| size.checked_add(at));
        match end {
            Some(end) if end <= self.bytes.len() as u64 => {
                Ok(&self.bytes[at as usize..end as usize])
            }
            _ => self.error(format_args!(
                "{count} {name} of {stride} bytes at byte {at} do not fit into {} bytes",
                self.bytes.len()
            )),
        }
    }

    /// The unsigned number in four bytes at byte `at`.
    pub(super) fn u32(&self, at: u64, name: &str) -> Result<u32> {
        Ok(u32::from_le_bytes(self.word(at, name)?))
    }

    /// The unsigned number in eight bytes at byte `at`.
    pub(super) fn u64(&self, at: u64, name: &str) -> Result<u64> {
        Ok(u64::from(self.u32(at, name)?) | u64::from(self.u32(at + 4, name)?) << 32)
    }

    /// The float in four bytes at byte `at`.
    pub(super) fn f32(&self, at: u64, name: &str) -> Result<f32> {
        Ok(f32::from_le_bytes(self.word(at, name)?))
    }

    fn word(&self, at: u64, name: &str) -> Result<[u8; 4]> {
        let word = self.array(at, 1, 4, name)?;
        Ok([word[0], word[1], word[2], word[3]])
    }
}

/// The floats in `bytes`, four bytes each.
pub(super) fn floats(bytes: &[u8]) -> impl ExactSizeIterator<Item = f32> {
    bytes
        .chunks_exact(4)
        .map(|word| f32::from_le_bytes([word[0], word[1], word[2], word[3]]))
}

/// The first three floats of every `stride` bytes.
pub(super) fn vectors(bytes: &[u8], stride: usize) -> Vec<[f32; 3]> {
    let vector = |entry: &[u8]| {
        let mut axes = floats(&entry[..12]);
        std::array::from_fn(|_| axes.next().unwrap_or_default())
    };
    bytes.chunks_exact(stride).map(vector).collect()
}
