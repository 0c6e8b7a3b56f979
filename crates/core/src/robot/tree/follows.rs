//! What of a tip follows a target, and which trees have such tips.

use thiserror::Error;

/// What of a tip follows a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Follows {
    /// As many coordinates of its position as joints move, as in the paper.
    Position,
    /// Fewer coordinates of its position than joints move; what remains free is left to a null-space term.
    RedundantPosition,
    /// Its position and its orientation, by six joints.
    Pose,
}

/// Joints at most of a chain with a tip: its translations and axes stand on the stack.
pub(super) const MOST_JOINTS: usize = 32;
/// Joints of an arm with poses: as many as rows of J.
const JOINTS_OF_POSE: usize = 6;

/// Why a point of a tree is not a tip that can follow a target.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TipError {
    /// More or fewer joints than coordinates.
    #[error(
        "{joints} joints move and {coordinates} coordinates of the end-effector are to be controlled; task-space control needs as many \
         joints as coordinates (a redundant Jacobian has no inverse): lock joints or choose other coordinates"
    )]
    Size {
        /// Moving joints.
        joints: usize,
        /// Coordinates chosen.
        coordinates: usize,
    },
    /// No joint is left for a null-space term.
    #[error(
        "{joints} joints move and {coordinates} coordinates of the end-effector are to be controlled; a null-space term needs more joints \
         than coordinates, and one coordinate at least"
    )]
    NotRedundant {
        /// Moving joints.
        joints: usize,
        /// Coordinates chosen.
        coordinates: usize,
    },
    /// A pose by other than six joints.
    #[error(
        "{joints} joints move; a pose has three coordinates and three angles, and is followed by exactly six joints (with fewer \
         it cannot be reached, and the theorem has no null-space term beside an orientation)"
    )]
    PoseJoints {
        /// Moving joints.
        joints: usize,
    },
    /// A pose without all coordinates of the position, in order.
    #[error("a pose has the coordinates x, y, z in this order, not others")]
    PoseCoordinates,
    /// More joints than working memory is set aside for.
    #[error("{joints} joints move, more than the {most} that the kinematics of an end-effector are computed for")]
    TooManyJoints {
        /// Moving joints.
        joints: usize,
        /// The most.
        most: usize,
    },
    /// A coordinate is chosen twice, or there is no such coordinate.
    #[error("coordinate {coordinate} (of x = 0, y = 1, z = 2 of the base) is chosen twice, or there is none")]
    Coordinate {
        /// The coordinate.
        coordinate: usize,
    },
    /// A joint does not move the point.
    #[error("joint {joint} does not carry the end-effector; lock it or choose an end-effector behind it")]
    Beside {
        /// The joint, from zero.
        joint: usize,
    },
}

impl Follows {
    /// Whether so many joints suit these coordinates.
    pub(super) fn check(self, joints: usize, chosen: &[usize]) -> Result<(), TipError> {
        for (index, coordinate) in chosen.iter().enumerate() {
            if *coordinate > 2 || chosen[..index].contains(coordinate) {
                return Err(TipError::Coordinate { coordinate: *coordinate });
            }
        }
        let coordinates = chosen.len();
        if joints > MOST_JOINTS {
            return Err(TipError::TooManyJoints { joints, most: MOST_JOINTS });
        }
        match self {
            Follows::Position if joints != coordinates => Err(TipError::Size { joints, coordinates }),
            Follows::RedundantPosition if coordinates == 0 || joints <= coordinates => {
                Err(TipError::NotRedundant { joints, coordinates })
            }
            Follows::Pose if chosen != [0, 1, 2] => Err(TipError::PoseCoordinates),
            Follows::Pose if joints != JOINTS_OF_POSE => Err(TipError::PoseJoints { joints }),
            Follows::Position | Follows::RedundantPosition | Follows::Pose => Ok(()),
        }
    }
}
