//! Fixed-base trees of rigid bodies with revolute and prismatic joints.

mod articulated;
mod assemble;
mod axes;
mod composite;
mod drives;
mod lagrangian;
mod model;
mod motion;
mod physical;
mod placement;
mod spatial;
mod subdivided;
mod sweep;
mod tip;
mod uniform;
mod wrench;

pub use assemble::{Anchor, Assembled, LinkJoint, LinkSpec, TreeError, inertia_about_frame};
pub use model::{JointKind, Tree, TreeScratch};
pub use physical::{InertiaDefect, MassMatrixError, inertia_defects};
pub use placement::Placement;
pub use tip::{TipError, TreeTip, Uncertain};
pub use wrench::{Axes, LinkPoint, PointMotion, PointWrench};
