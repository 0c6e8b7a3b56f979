//! Where the file of a mesh is. Only what lies in the URDF's own folder, or in its package, is read: a robot from elsewhere must not bring
//! other files of this machine onto a page.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::files::open_file;

/// Larger files are not read.
const MOST_BYTES: u64 = 64 << 20;
/// Folders above that of the URDF among which a package is looked for.
const MOST_ABOVE: usize = 6;

/// The folders of a URDF.
pub(super) struct Folders {
    /// Its own.
    own: PathBuf,
    /// Its own and all above it that may be its package, with links resolved.
    above: Vec<PathBuf>,
}

impl Folders {
    /// Of the URDF at a path; nothing where it has none, as a shipped robot.
    pub(super) fn of(urdf: &str) -> Option<Folders> {
        let own = fs::canonicalize(urdf).ok()?.parent()?.to_owned();
        let above = own.ancestors().take(MOST_ABOVE + 1).map(Path::to_owned).collect();
        Some(Folders { own, above })
    }

    /// The file that a URDF calls `name`, with links resolved.
    pub(super) fn path(&self, name: &str) -> Result<PathBuf, String> {
        let (asked, root) = if let Some(rest) = name.strip_prefix("package://") {
            let (package, rest) = rest.split_once('/').ok_or("it names a package and no file")?;
            let root = self.package(Some(package)).ok_or_else(|| {
                format!(
                    "the package `{package}` is not the one of the URDF: name the folder of the URDF, or one above it, `{package}`, and let the \
                     meshes lie in it as the URDF says"
                )
            })?;
            (root.join(rest), root)
        } else {
            let plain = name.strip_prefix("file://").unwrap_or(name);
            (self.own.join(plain), self.package(None).unwrap_or(&self.own))
        };
        let path = fs::canonicalize(&asked).map_err(|error| match error.kind() {
            std::io::ErrorKind::NotFound => "there is no such file".to_owned(),
            _ => error.to_string(),
        })?;
        // What links lead to counts, not where they stand.
        if path.starts_with(root) || path.starts_with(&self.own) {
            Ok(path)
        } else {
            Err("it lies outside of the URDF's folder and package, and is not read".to_owned())
        }
    }

    /// The nearest folder with this name, or without one the nearest that says that it is a package.
    fn package(&self, name: Option<&str>) -> Option<&PathBuf> {
        match name {
            Some(name) => self.above.iter().find(|folder| folder.file_name().is_some_and(|own| own == name)),
            None => self.above.iter().find(|folder| folder.join("package.xml").is_file()),
        }
    }
}

/// The bytes of a file.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, String> {
    let file = open_file(path).map_err(|error| error.to_string())?;
    let mut bytes = Vec::new();
    file.take(MOST_BYTES + 1).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(format!("it is larger than {} MB", MOST_BYTES >> 20));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn nothing_outside_of_the_folder_or_the_package_is_read() {
        let all = tempfile::tempdir().unwrap();
        let arm = all.path().join("arm");
        for folder in ["arm/urdf", "arm/meshes", "arm/urdf/near"] {
            fs::create_dir_all(all.path().join(folder)).unwrap();
        }
        for file in ["secret.stl", "arm/meshes/a.stl", "arm/urdf/near/b.stl", "arm/urdf/arm.urdf"] {
            fs::write(all.path().join(file), file).unwrap();
        }
        let urdf = arm.join("urdf/arm.urdf");
        let read = |name: &str| {
            let path = Folders::of(urdf.to_str().unwrap()).unwrap().path(name);
            path.and_then(|path| super::read(&path)).map(|bytes| String::from_utf8(bytes).unwrap())
        };
        let outside = Err("it lies outside of the URDF's folder and package, and is not read".to_owned());
        assert_eq!(read("near/b.stl"), Ok("arm/urdf/near/b.stl".into()));
        assert_eq!(read("package://arm/meshes/a.stl"), Ok("arm/meshes/a.stl".into()));
        assert_eq!(read("package://arm/../secret.stl"), outside);
        assert_eq!(read("../../secret.stl"), outside);
        assert_eq!(read("../meshes/a.stl"), outside, "no file says that it is a package");
        let secret = all.path().join("secret.stl");
        assert_eq!(read(secret.to_str().unwrap()), outside);
        assert_eq!(read(&format!("file://{}", secret.display())), outside);
        assert!(read("package://leg/a.stl").unwrap_err().contains("`leg`"));
        assert_eq!(read("near/none.stl"), Err("there is no such file".into()));
        assert!(read("near").is_err() && read("package://arm").is_err() && read("").is_err());
        fs::write(arm.join("package.xml"), "<package/>").unwrap();
        assert_eq!(read("../meshes/a.stl"), Ok("arm/meshes/a.stl".into()));
        assert_eq!(read("../../secret.stl"), outside);
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(&secret, arm.join("urdf/near/link.stl")).unwrap();
            assert_eq!(read("near/link.stl"), outside);
        }
    }
}
