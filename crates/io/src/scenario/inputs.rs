//! The files that a scenario names: where they are looked for, and what was read.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use crate::SourceText;
use crate::files::{ReadError, has_extension, neighbours, read_text, text_of};

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

/// Where the files that a scenario names are. One that is given by its name, in memory or at a path, is looked for nowhere
/// else; the others are in the folder, if there is one, or in its `inputs`.
///
/// Without any file: `None`. A folder alone: `Some(path)`.
///
/// ```
/// use forwardstep_io::SourceText;
/// use forwardstep_io::scenario::{Inputs, read_scenario};
///
/// let text = r#"
///     format = 2
///     time = { end_s = 20 }
///     [[agents]]
///     name = "cart"
///     count = 2
///     robot.urdf = { file = "cart.urdf" }
///     start.position_m = [[0], [1]]
///     [reference.consensus]
///     roots_per_s = [1, 2]
///     exchange = "position_velocity"
///     [network]
///     delay.constant_s = 0.1
///     edges = [["cart-1", "cart-2"], ["cart-2", "cart-1"]]
/// "#;
/// let source = SourceText::new("carts.toml", text);
/// let cart = r#"
///     <robot name="cart">
///       <link name="rail"/>
///       <link name="cart"><inertial><mass value="2"/>
///         <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
///       <joint name="slide" type="prismatic"><parent link="rail"/><child link="cart"/>
///         <axis xyz="1 0 0"/><limit lower="-3" upper="3" velocity="2" effort="50"/></joint>
///     </robot>"#;
///
/// let scenario = read_scenario("carts", &source, Inputs::default().file("cart.urdf", cart))?;
/// assert_eq!(scenario.setup.agents[1].robot.axes[0].name, "slide");
///
/// // Mistakes have their places, in these files too.
/// let wrong = cart.replace("\"2\"", "\"two\"");
/// let error = read_scenario("carts", &source, Inputs::default().file("cart.urdf", wrong)).unwrap_err();
/// assert!(error.to_string().starts_with("cart.urdf:4:"), "{error}");
/// # Ok::<(), forwardstep_io::scenario::ScenarioError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Inputs {
    folder: Option<PathBuf>,
    named: BTreeMap<String, Place>,
}

/// Where a file is that is given by its name.
#[derive(Clone, Debug)]
enum Place {
    Memory(Vec<u8>),
    Path(PathBuf),
}

impl Inputs {
    /// The same with the file that a scenario calls `name`.
    #[must_use]
    pub fn file(self, name: &str, bytes: impl Into<Vec<u8>>) -> Self {
        self.with(name, Place::Memory(bytes.into()))
    }

    /// The same, but the file that a scenario calls `name` stands at `path`.
    #[must_use]
    pub fn file_at(self, name: &str, path: impl Into<PathBuf>) -> Self {
        self.with(name, Place::Path(path.into()))
    }

    fn with(mut self, name: &str, place: Place) -> Self {
        self.named.insert(spelt(name), place);
        self
    }
}

impl From<Option<&Path>> for Inputs {
    fn from(folder: Option<&Path>) -> Self {
        Inputs { folder: folder.map(Path::to_owned), named: BTreeMap::new() }
    }
}

impl<N: AsRef<str>, B: Into<Vec<u8>>> FromIterator<(N, B)> for Inputs {
    /// Names with their bytes.
    fn from_iter<I: IntoIterator<Item = (N, B)>>(files: I) -> Self {
        files.into_iter().fold(Inputs::default(), |inputs, (name, bytes)| inputs.file(name.as_ref(), bytes))
    }
}

/// The files of a scenario, and which were read so far. A file is read once, however often it is named, so that all who name it
/// see the same text.
#[derive(Debug)]
pub struct InputFolder {
    inputs: Inputs,
    read: Vec<InputFile>,
}

impl InputFolder {
    pub(super) fn new(inputs: Inputs) -> Self {
        InputFolder { inputs, read: Vec::new() }
    }

    /// The text of the file called `name`.
    ///
    /// # Errors
    /// [`ReadError`] when it is nowhere, or is no text.
    pub fn text(&mut self, name: &str) -> Result<SourceText, ReadError> {
        if let Some(known) = self.read.iter().find(|file| file.name == name) {
            return Ok(known.source.clone());
        }
        let (path, text) = match (self.inputs.named.get(&spelt(name)), &self.inputs.folder) {
            (Some(Place::Memory(bytes)), _) => (PathBuf::from(name), text_of(bytes.clone())?),
            (Some(Place::Path(path)), _) => (path.clone(), read_text(path)?),
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

    /// Whether it was said where the file of this name is.
    pub(super) fn is_named(&self, name: &str) -> bool {
        self.inputs.named.contains_key(&spelt(name))
    }

    /// Other files that end in `.extension`: those given by their names, and those where `name` was looked for.
    pub(super) fn neighbours(&self, name: &str, extension: &str) -> Vec<String> {
        let Inputs { folder, named } = &self.inputs;
        let own = spelt(name);
        let named = named.keys().filter(|known| **known != own && has_extension(known, extension));
        let mut names: Vec<String> = named.cloned().collect();
        names.extend(folder.iter().flat_map(|folder| neighbours(&folder.join(name), extension)));
        names
    }

    /// How much was read.
    pub(super) fn bytes(&self) -> usize {
        self.read.iter().map(|file| file.source.text().len()).sum()
    }

    /// Everything that was read.
    pub(super) fn into_read(self) -> Vec<InputFile> {
        self.read
    }
}

/// A name as it is compared with others.
fn spelt(name: &str) -> String {
    plain_name(name).unwrap_or_else(|| name.to_owned())
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
}
