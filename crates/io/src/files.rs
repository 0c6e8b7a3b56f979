//! Text files, and what stands beside them.

use std::io::{ErrorKind, Read};
use std::path::Path;

/// Text files larger than this are not read.
const MOST_BYTES: u64 = 1 << 26;

/// Files beside `path` with the same extension.
pub(crate) fn neighbours(path: &Path) -> Vec<String> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let mut names: Vec<_> = names.filter(|name| Path::new(name).extension() == path.extension()).collect();
    names.sort();
    names
}

/// Reads a text file of reasonable size.
pub(crate) fn read_text(path: &Path) -> Result<String, ErrorKind> {
    let file = std::fs::File::open(path).map_err(|error| error.kind())?;
    let mut text = String::new();
    let read = file.take(MOST_BYTES + 1).read_to_string(&mut text).map_err(|error| error.kind())?;
    if read as u64 > MOST_BYTES { Err(ErrorKind::FileTooLarge) } else { Ok(text) }
}
