//! The files that a scenario names: where they are looked for, and what was read.

use std::path::{Component, Path, PathBuf};

use toml::Table;

use crate::SourceText;
use crate::files::{ReadError, neighbours, read_text};

/// The folder beside a scenario in which the files that it names may stand too, as they do in the folder of a run.
pub(crate) const INPUTS: &str = "inputs";

/// A file that a scenario names, as it was read.
#[derive(Clone, Debug)]
pub struct InputFile {
    /// Its name in the scenario.
    pub name: String,
    /// Its text, under the path it was read from.
    pub source: SourceText,
}

/// Where the files of a scenario are, and which were read so far. A file is read once, however often it is named, so that
/// all who name it see the same text.
#[derive(Debug)]
pub struct InputFolder {
    folder: Option<PathBuf>,
    /// Names of the scenario whose files stand elsewhere.
    moved: Vec<(String, PathBuf)>,
    read: Vec<InputFile>,
}

impl InputFolder {
    /// Files are looked for in `folder`, then in its [`INPUTS`]; those named in `moved` at that path only.
    pub(super) fn new(folder: Option<&Path>, moved: Vec<(String, PathBuf)>) -> Self {
        let folder = folder.map(Path::to_owned);
        InputFolder { folder, moved, read: Vec::new() }
    }

    /// The text of the file called `name`.
    ///
    /// # Errors
    /// [`ReadError`] when it is nowhere, or is no text.
    pub fn text(&mut self, name: &str) -> Result<SourceText, ReadError> {
        if let Some(known) = self.read.iter().find(|file| file.name == name) {
            return Ok(known.source.clone());
        }
        let (path, text) = match (self.moved(name), &self.folder) {
            (Some(path), _) => (path.to_owned(), read_text(path)?),
            (None, None) => return Err(ReadError::Missing),
            (None, Some(folder)) => {
                let beside = folder.join(name);
                match (read_text(&beside), plain_name(name)) {
                    (Err(ReadError::Missing), Some(plain)) => {
                        let path = folder.join(INPUTS).join(plain);
                        let text = read_text(&path)?;
                        (path, text)
                    }
                    (text, _) => (beside, text?),
                }
            }
        };
        let source = SourceText::new(path.display().to_string(), text);
        self.read.push(InputFile { name: name.to_owned(), source: source.clone() });
        Ok(source)
    }

    /// Where the file of this name was moved to, if it was.
    pub(super) fn moved(&self, name: &str) -> Option<&Path> {
        self.moved.iter().find(|(moved, _)| moved == name).map(|(_, path)| path.as_path())
    }

    /// Other files that end in `.extension` where `name` was looked for.
    pub(super) fn neighbours(&self, name: &str, extension: &str) -> Vec<String> {
        self.folder.as_deref().map_or_else(Vec::new, |folder| neighbours(&folder.join(name), extension))
    }

    /// Everything that was read.
    pub(super) fn into_read(self) -> Vec<InputFile> {
        self.read
    }
}

/// `name` with `/` between its parts, if it leads downwards from a folder: no `..`, not from the root.
pub(crate) fn plain_name(name: &str) -> Option<String> {
    let mut parts = Vec::new();
    for part in Path::new(name).components() {
        match part {
            Component::Normal(part) => parts.push(part.to_str()?),
            Component::CurDir => {}
            _ => return None,
        }
    }
    (!parts.is_empty()).then(|| parts.join("/"))
}

/// The BLAKE3 digest, in hexadecimal, of what a scenario says apart from its title: comments and layout do not enter.
/// Nothing when the text is no TOML.
pub(crate) fn content_digest(text: &str) -> Option<String> {
    let mut table: Table = text.parse().ok()?;
    table.remove("title");
    // Tables are sorted by their keys, and every number has one way to be written.
    Some(blake3::hash(table.to_string().as_bytes()).to_hex().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_lead_downwards_are_plain() {
        let plain = |name| plain_name(name).unwrap_or_default();
        assert_eq!(plain("./robots//arm.urdf"), "robots/arm.urdf");
        assert_eq!(plain("arm.urdf"), "arm.urdf");
        for name in ["", ".", "..", "../arm.urdf", "robots/../arm.urdf", "/arm.urdf"] {
            assert_eq!(plain_name(name), None, "{name}");
        }
    }

    #[test]
    fn title_comments_and_layout_do_not_enter_the_content() {
        let digest = |text: &str| content_digest(text).unwrap_or_else(|| panic!("{text}"));
        let one = digest("title = \"one\"\nformat = 1 # a comment\n[time]\nend_s = 20");
        assert_eq!(one, digest("# another\ntime = { end_s = 20 }\nformat = 1\ntitle = \"two\""));
        assert_ne!(one, digest("format = 2\n[time]\nend_s = 21"));
        assert_eq!(content_digest("format ="), None);
    }
}
