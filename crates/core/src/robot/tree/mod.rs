//! Fixed-base trees of rigid bodies with revolute and prismatic joints.

mod assemble;
mod model;

pub use assemble::{JointKind, LinkJoint, LinkSpec, Placement, TreeError, inertia_about_frame};
pub use model::Tree;
