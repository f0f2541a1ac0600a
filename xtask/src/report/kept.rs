//! What is slow to compute, kept in `target/report/` for the next run.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;

use bytemuck::Pod;

use crate::{Result, root};

/// To be raised where this tool computes something else of the same input.
const VERSION: u32 = 1;

/// The models of techniques by which tests judge maps; nothing that is kept comes from them.
const MODELS: &str = "shadow_maps.rs";

/// What a kept result depends on. It begins with the reference's own source.
#[derive(Clone)]
pub struct Key(DefaultHasher);

impl Key {
    /// Of the reference as it is now.
    pub fn new() -> Result<Self> {
        let folder = root().join("reference/src");
        let unreadable = |error| format!("{} cannot be read: {error}", folder.display());
        let mut files = Vec::new();
        for entry in std::fs::read_dir(&folder).map_err(unreadable)? {
            let path = entry.map_err(unreadable)?.path();
            if !path.ends_with(MODELS) {
                files.push(path);
            }
        }
        files.sort();
        let mut hasher = DefaultHasher::new();
        VERSION.hash(&mut hasher);
        for file in files {
            std::fs::read(file).map_err(unreadable)?.hash(&mut hasher);
        }
        Ok(Self(hasher))
    }

    /// And of these.
    pub fn and<T: Pod>(mut self, values: &[T]) -> Self {
        bytemuck::cast_slice::<T, u8>(values).hash(&mut self.0);
        self
    }
}

fn folder() -> PathBuf {
    root().join("target/report")
}

/// Whether some result of this name is there, of whatever input.
pub fn is_there(name: &str) -> bool {
    let begins = format!("{name}-");
    let Ok(entries) = std::fs::read_dir(folder()) else {
        return false;
    };
    let mut names = entries.flatten().map(|entry| entry.file_name());
    names.any(|file| file.to_string_lossy().starts_with(&begins))
}

/// The kept result of this name and key, or what `make` makes, which is then kept in place of older ones.
pub fn kept<T: Pod>(name: &str, key: &Key, make: impl FnOnce() -> Vec<T>) -> Result<Vec<T>> {
    let path = folder().join(format!("{name}-{:016x}.bin", key.0.finish()));
    if let Ok(bytes) = std::fs::read(&path)
        && bytes.len() % size_of::<T>() == 0
    {
        return Ok(bytemuck::pod_collect_to_vec(&bytes));
    }
    let made = make();
    let unwritable = |error| format!("{} cannot be written: {error}", path.display());
    std::fs::create_dir_all(folder()).map_err(unwritable)?;
    let begins = format!("{name}-");
    for old in std::fs::read_dir(folder()).map_err(unwritable)?.flatten() {
        if old.file_name().to_string_lossy().starts_with(&begins) {
            std::fs::remove_file(old.path()).map_err(unwritable)?;
        }
    }
    let beside = path.with_extension("new");
    std::fs::write(&beside, bytemuck::cast_slice::<T, u8>(&made)).map_err(unwritable)?;
    std::fs::rename(&beside, &path).map_err(unwritable)?;
    Ok(made)
}
