//! Evidence of robots before they run: inertias for all postures, what bounds their dynamics, how far they reach.

use crate::hypothesis::{Answer, Named, Rigour};
use crate::practical::FastestDamping;

/// What was found of robots.
#[derive(Clone, Debug, PartialEq)]
pub enum RobotEvidence {
    /// No eigenvalue of M(q) is below a bound, at any q.
    UniformInertia {
        /// The smallest bound.
        least: f64,
        /// Its unit.
        unit: InertiaUnit,
        /// Whose it is.
        agent: Named,
        /// How many agents with that unit have a bound.
        agents: usize,
        /// The fastest motion that K causes, where it is that of a robot with this unit.
        damping: Option<(Named, FastestDamping)>,
    },
    /// At some q there are velocities with no kinetic energy, or with less: `direction` · M(q) `direction` ≤ 0.
    SingularInertia {
        /// Whose.
        agent: Named,
        /// Joint positions, rad or m.
        q: Vec<f64>,
        /// Joint velocities.
        direction: Vec<f64>,
    },
    /// Bodies without mass or inertia of their own, and no bound was found.
    UnknownInertia {
        /// Whose.
        agents: Vec<Named>,
        /// Where M of the first was seen closest to singular.
        q: Vec<f64>,
        /// What its eigenvalues exceed there.
        least: f64,
    },
    /// C(q, q̇)/|q̇| and g(q) are bounded.
    BoundedDynamics {
        /// Whether that needed prismatic joints to be parallel to the revolute ones that carry them.
        sliding: bool,
    },
    /// A prismatic joint extends across the axis of a revolute one that carries it.
    Swung {
        /// Whose robots have such joints.
        agents: Vec<Named>,
        /// One of them.
        joint: String,
        /// What it keeps within, where a run ends as it leaves them; for all such joints or for none.
        limits: Option<[f64; 2]>,
    },
    /// A target keeps between distances that the tip can have, for all time.
    WithinReach {
        /// How far it is at least and at most.
        target: MotionExtent,
        /// How far the tip can be.
        reach: MotionExtent,
        /// Whether all places in between can be reached, or it is only known that no others can.
        exact: bool,
    },
    /// A target is where the end-effector cannot be.
    OutOfReach {
        /// On which side.
        side: ReachSide,
        /// When, s.
        t_s: f64,
        /// How far it is then, m.
        distance_m: f64,
        /// The distance that the tip cannot pass, m.
        limit_m: f64,
    },
    /// Neither is shown.
    ReachNotShown {
        /// Between which distances the target was seen.
        seen: MotionExtent,
        /// Between which the tip can be.
        reach: MotionExtent,
    },
}

/// Units of eigenvalues of M.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum InertiaUnit {
    /// kg m², all joints turn.
    Turning,
    /// kg, all joints slide.
    Sliding,
    /// Both: radians and metres count alike.
    Mixed,
}

/// Between which distances, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionExtent {
    /// At least.
    pub least: f64,
    /// At most.
    pub most: f64,
}

/// On which side of what can be reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReachSide {
    /// Farther than the arm is long.
    Beyond,
    /// Closer than the arm can be folded.
    Inside,
}

impl RobotEvidence {
    pub(super) fn answer(&self) -> Answer {
        match self {
            RobotEvidence::UniformInertia { .. }
            | RobotEvidence::BoundedDynamics { .. }
            | RobotEvidence::WithinReach { .. } => Answer::Holds,
            RobotEvidence::Swung { limits: Some(_), .. } => Answer::Watched,
            RobotEvidence::Swung { limits: None, .. }
            | RobotEvidence::UnknownInertia { .. }
            | RobotEvidence::ReachNotShown { .. } => Answer::NotShown,
            RobotEvidence::SingularInertia { .. } | RobotEvidence::OutOfReach { .. } => Answer::Violated,
        }
    }

    pub(super) fn rigour(&self) -> Rigour {
        match self {
            RobotEvidence::BoundedDynamics { sliding: false } => Rigour::Exact,
            RobotEvidence::UniformInertia { .. } | RobotEvidence::SingularInertia { .. } => Rigour::Enclosed,
            RobotEvidence::WithinReach { .. } => Rigour::Enclosed,
            RobotEvidence::BoundedDynamics { sliding: true } | RobotEvidence::Swung { limits: None, .. } => {
                Rigour::Computed
            }
            RobotEvidence::Swung { limits: Some(_), .. } => Rigour::Watched,
            RobotEvidence::UnknownInertia { .. }
            | RobotEvidence::OutOfReach { .. }
            | RobotEvidence::ReachNotShown { .. } => Rigour::Sampled,
        }
    }
}
