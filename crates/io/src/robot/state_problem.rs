//! Why a state is refused.

use thiserror::Error;

use crate::Problem;
use crate::wording::choose;

/// Why a state file has no meaning for a robot.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum StateProblem {
    /// The text is not JSON.
    #[error("not well-formed JSON: {message}")]
    Json {
        /// What the JSON parser says.
        message: String,
    },
    /// Something else where an object should be.
    #[error("{what} is {found}, but must be an object")]
    NotAnObject {
        /// The state, or the entry of a joint.
        what: String,
        /// The beginning of what was written.
        found: String,
    },
    /// A joint that does not move, or is not there at all.
    #[error("the robot has no moving joint `{joint}`")]
    UnknownJoint {
        /// What was written.
        joint: String,
        /// The joints that move.
        joints: Vec<String>,
    },
    /// A quantity that is none of the four.
    #[error("joint `{joint}` has the unknown entry `{key}`")]
    UnknownKey {
        /// The joint.
        joint: String,
        /// What was written.
        key: String,
    },
    /// A joint, or a quantity of a joint, for the second time.
    #[error("{what} is given twice")]
    Twice {
        /// The joint or the quantity.
        what: String,
    },
    /// Something else where a number should be.
    #[error("`{key}` of joint `{joint}` is {found}, which is not a number")]
    NotANumber {
        /// The joint.
        joint: String,
        /// The quantity.
        key: &'static str,
        /// The beginning of what was written.
        found: String,
    },
    /// A number beyond the range of double precision, or none by name.
    #[error("{found} is not a finite number")]
    NotFinite {
        /// The beginning of what was written.
        found: String,
    },
    /// A joint has no position.
    #[error("joint `{joint}` has no `q`")]
    NoPosition {
        /// The joint.
        joint: String,
    },
    /// A moving joint is not in the file.
    #[error("the state says nothing of joint `{joint}`")]
    MissingJoint {
        /// The joint.
        joint: String,
    },
}

impl Problem for StateProblem {
    fn help(&self) -> Option<String> {
        match self {
            StateProblem::UnknownJoint { joint, joints } => Some(choose(joint, "its joints are", joints)),
            StateProblem::UnknownKey { key, .. } => Some(choose(key, "entries are", &super::state::KEYS)),
            StateProblem::NotAnObject { .. } => {
                Some(r#"write { "joint": { "q": 0, "dq": 0, "z": 0, "dz": 0 }, … }"#.to_owned())
            }
            StateProblem::NoPosition { .. } | StateProblem::MissingJoint { .. } => {
                Some("every moving joint needs a position `q`; `dq`, `z` and `dz` are 0 unless given".to_owned())
            }
            _ => None,
        }
    }
}
