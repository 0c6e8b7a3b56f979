//! From what a user types to a robot, and to a state of it.

use std::fmt;
use std::path::{Path, PathBuf};

use miette::{Diagnostic, LabeledSpan, SourceCode};
use thiserror::Error;

use super::state::{JointState, read_state};
use super::state_problem::StateProblem;
use crate::files::{ReadError, neighbours, read_text};
use crate::shown;
use crate::urdf::{self, SHIPPED_ROBOTS, UrdfOptions, UrdfProblem, UrdfRobot};
use crate::wording::choose;
use crate::{InputError, SourceText};

/// Why there is no robot, or no state, to look at.
#[derive(Clone, Debug, Error)]
pub enum OpenRobotError {
    /// Neither a shipped robot nor a file.
    #[error("there is no robot `{}`", shown(name))]
    Unknown {
        /// What was asked for.
        name: String,
    },
    /// A file that cannot be read.
    #[error("cannot read `{}`: {reason}", shown(path))]
    File {
        /// The file.
        path: PathBuf,
        /// Why not.
        reason: ReadError,
    },
    /// A file for a state that cannot be read.
    #[error("cannot read `{}`: {reason}", shown(path))]
    StateFile {
        /// The file.
        path: PathBuf,
        /// Why not.
        reason: ReadError,
    },
    /// A mistake in the robot, or in what was asked of it.
    #[error(transparent)]
    Robot(Box<InputError<UrdfProblem>>),
    /// A mistake in the state.
    #[error(transparent)]
    State(Box<InputError<StateProblem>>),
}

impl OpenRobotError {
    /// The mistake in a file.
    fn inner(&self) -> Option<&dyn Diagnostic> {
        match self {
            OpenRobotError::Robot(error) => Some(error.as_ref()),
            OpenRobotError::State(error) => Some(error.as_ref()),
            OpenRobotError::Unknown { .. } | OpenRobotError::File { .. } | OpenRobotError::StateFile { .. } => None,
        }
    }
}

impl Diagnostic for OpenRobotError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        match self {
            OpenRobotError::Unknown { name } => {
                let shipped = SHIPPED_ROBOTS.map(|(name, _)| name);
                let text = choose(name, "shipped robots are", &shipped);
                Some(Box::new(format!("{text}; for a file of your own give its path, such as `my-arm.urdf`")))
            }
            OpenRobotError::File { path, reason: ReadError::Missing } => among(path, "urdf"),
            OpenRobotError::StateFile { path, reason: ReadError::Missing } => among(path, "json"),
            OpenRobotError::StateFile { reason, .. } => {
                let help = reason
                    .help()
                    .unwrap_or("name a JSON file with the state, as { \"joint\": { \"q\": 0.1, \"dq\": 0 } }");
                Some(Box::new(help))
            }
            OpenRobotError::File { reason, .. } => {
                let help = reason.help().unwrap_or("name the URDF itself: XML that begins with <robot name=\"…\">");
                Some(Box::new(help))
            }
            OpenRobotError::Robot(_) | OpenRobotError::State(_) => self.inner()?.help(),
        }
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.inner()?.source_code()
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        self.inner()?.labels()
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        self.inner()?.related()
    }
}

/// Which files there are in the place of one that is missing.
fn among(path: &Path, extension: &str) -> Option<Box<dyn fmt::Display>> {
    let known = neighbours(path, extension);
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    (!known.is_empty()).then(|| Box::new(choose(name, "in that folder:", &known)) as Box<_>)
}

/// Opens the URDF at this path, else the shipped robot of this name.
///
/// # Errors
/// [`OpenRobotError`] when there is no such robot, or it cannot be read or is refused.
pub fn open_robot(name_or_path: &str, options: &UrdfOptions) -> Result<UrdfRobot, OpenRobotError> {
    let source = match (read_text(Path::new(name_or_path)), urdf::shipped_robot(name_or_path)) {
        (Ok(text), _) => SourceText::new(name_or_path, text),
        (Err(ReadError::Missing), Some(text)) => SourceText::new(name_or_path, text),
        (Err(reason), _) => return Err(unreadable(name_or_path, reason)),
    };
    urdf::read_urdf(&source, options).map_err(|error| OpenRobotError::Robot(Box::new(error)))
}

fn unreadable(name_or_path: &str, reason: ReadError) -> OpenRobotError {
    let path = Path::new(name_or_path);
    let looks_like_a_name = path.extension().is_none() && path.components().count() <= 1;
    if reason == ReadError::Missing && looks_like_a_name {
        OpenRobotError::Unknown { name: name_or_path.to_owned() }
    } else {
        OpenRobotError::File { path: path.to_owned(), reason }
    }
}

/// Opens the state of `robot` in a JSON file.
///
/// # Errors
/// [`OpenRobotError`] when the file cannot be read or has a mistake.
pub fn open_state(path: &Path, robot: &UrdfRobot) -> Result<JointState, OpenRobotError> {
    let text = read_text(path).map_err(|reason| OpenRobotError::StateFile { path: path.to_owned(), reason })?;
    let joints: Vec<&str> = robot.robot.axes.iter().map(|axis| axis.name.as_str()).collect();
    let source = SourceText::new(path.display().to_string(), text);
    read_state(&source, &joints).map_err(|error| OpenRobotError::State(Box::new(error)))
}
