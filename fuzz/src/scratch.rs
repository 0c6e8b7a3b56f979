//! A folder for the files of one fuzzer.

use std::fs;
use std::path::{Path, PathBuf};
use std::process;

/// A folder that belongs to this process.
pub struct Scratch {
    folder: PathBuf,
}

impl Scratch {
    /// Makes the folder, where `TMPDIR` says.
    pub fn new() -> Self {
        let folder = std::env::temp_dir().join(format!("forwardstep-fuzz-{}", process::id()));
        fs::create_dir_all(&folder).expect("a folder for scratch");
        Scratch { folder }
    }

    /// Writes a file.
    pub fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.folder.join(name);
        fs::write(&path, bytes).expect("a file in the scratch folder");
        path
    }

    /// Where the files are.
    pub fn folder(&self) -> &Path {
        &self.folder
    }
}

impl Default for Scratch {
    fn default() -> Self {
        Self::new()
    }
}
