//! One robot by itself: a name or a path in, a description or its dynamics at a state out.

mod description;
mod open;
mod state;
mod state_problem;

pub use description::{BodyDescription, Dynamics, JointDescription, RobotDescription};
pub use open::{OpenRobotError, open_robot, open_state};
pub use state::{JointState, read_state};
pub use state_problem::StateProblem;
