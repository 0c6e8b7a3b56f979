//! A folder for the files of one fuzzer.

use std::fs;
use std::path::{Path, PathBuf};
use std::process;

/// A folder that belongs to this process.
pub struct Scratch {
    folder: PathBuf,
}

impl Scratch {
    /// Makes the folder, in memory where there is such a place: a fuzzer writes thousands of files per second.
    pub fn new() -> Self {
        let memory = Path::new("/dev/shm");
        let parent = if memory.is_dir() { memory.to_owned() } else { std::env::temp_dir() };
        let folder = parent.join(format!("forwardstep-fuzz-{}", process::id()));
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
