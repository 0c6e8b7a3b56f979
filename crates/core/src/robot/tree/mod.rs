//! Fixed-base trees of rigid bodies with revolute and prismatic joints.

mod articulated;
mod assemble;
mod axes;
mod composite;
mod drives;
mod follows;
mod lagrangian;
mod model;
mod motion;
mod physical;
mod placement;
mod spatial;
mod subdivided;
mod sweep;
mod tip;
mod turned;
mod uniform;
mod wrench;

pub use assemble::{Anchor, Assembled, LinkJoint, LinkSpec, TreeError, inertia_about_frame};
pub use follows::{Follows, TipError};
pub use model::{JointKind, Tree, TreeScratch};
pub use physical::{InertiaDefect, MassMatrixError, inertia_defects};
pub use placement::Placement;
pub use tip::{TreeTip, Uncertain};
pub use wrench::{Axes, LinkPoint, PointMotion, PointWrench};
