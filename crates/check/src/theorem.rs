//! The statements that a setup can fall under: theorems and remarks of the paper, and what stands in their place.

use std::fmt;

use forwardstep_sim::{Exchange, SetupError};

use crate::instance::{self, Design};
use crate::source::Source;

/// A statement about the long run. `Display` names it with its equations.
#[derive(Clone, Debug, PartialEq)]
pub enum Theorem {
    /// Theorem 1, for (3).
    Theorem1,
    /// Remark 3, for (23).
    Remark3,
    /// Theorem 2, for (a1).
    Theorem2,
    /// Theorem 3 for (aa10), which is (a5) of order one.
    FirstOrder,
    /// Theorem 3 for (a5).
    Theorem3Velocities {
        /// ℓ.
        order: usize,
    },
    /// Theorem 3 for (24).
    Theorem3Positions {
        /// ℓ.
        order: usize,
    },
    /// Theorem 3 with an order of its own for every agent.
    OwnOrders {
        /// (a5) or (24).
        exchange: Exchange,
        /// The lowest ℓ.
        least: usize,
        /// The highest ℓ.
        most: usize,
    },
    /// The baseline that the paper argues against; no theorem.
    Backstepping,
    /// Agents of different kinds, each treated somewhere; no single theorem.
    Mixture(Vec<&'static str>),
    /// Agents of different kinds, each with a target of its own, and what is said of each kind.
    Targets(Vec<Theorem>),
    /// (43) for tracking, with these second steps.
    ChainsTrack(Vec<&'static str>),
    /// (43) with (24), with these second steps.
    ChainsAgree(Vec<&'static str>),
    /// (6)–(7) behind reference dynamics for tracking.
    RobotsTrack,
    /// (a8) with (a9).
    PositionOnlyTracks,
    /// A model and a high gain in the place of (a8).
    ModelReference,
    /// Remark 7: (a8) with (24) in z.
    PositionOnlyAgree {
        /// ℓ.
        order: usize,
    },
    /// Section V-B, continuous control of vehicles.
    ContinuousThrust,
    /// Theorem 4.
    Theorem4,
    /// Theorem 5.
    Theorem5,
    /// Vehicles by their measured acceleration, as Remark 8 names for contrast.
    ThrustByAcceleration,
    /// Theorem 6.
    Theorem6,
    /// The argument of Theorem 6 for positions and orientations of six joints.
    Theorem6Pose,
    /// The argument of Theorem 6 with a null-space term of redundant joints.
    Theorem6Redundant,
    /// Tips by their measured velocity, as Remark 9 names for contrast.
    TipVelocity,
    /// Theorem 7.
    Theorem7,
    /// A filter of the attitude error in the place of Theorem 7.
    PassivityFilter,
    /// Theorem 8.
    Theorem8,
    /// (110) over graphs that take turns.
    SwitchingLeader,
    /// (110) over links that delay.
    LateLeader,
    /// Theorem 9.
    Theorem9,
    /// Remark 12.
    Remark12,
    /// Swarm tracking, named in Remark 11.
    Swarm,
    /// Agreement with a leader on one vector.
    CompositeLeader,
    /// An observer of the leader, of the kind that Remark 11 names for contrast.
    LeaderObserver,
    /// (43) with desired dynamics that are no design of the paper.
    Desired,
    /// What the author of a law, or of reference dynamics, from outside states, with its source.
    Declared(String),
    /// None, since the parts of the setup do not fit together.
    Refused(Box<SetupError>),
    /// Another statement, by an argument of ours that goes beyond it. It keeps the name of the other.
    Extended {
        /// The other.
        theorem: Box<Theorem>,
        /// How far beyond, in the order in which it is said; never empty.
        by: Vec<Extension>,
    },
}

/// What the paper has nowhere, and what its statements are extended to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extension {
    /// What is heard counts by a nonlinear function of the difference, as in `coupling` of `forwardstep_sim`.
    NonlinearCoupling,
    /// Agents keep offsets, at rest or moving, from where all agree. The paper names formations only as a reason for consensus.
    Offsets,
}

impl Extension {
    fn words(self) -> &'static str {
        match self {
            Extension::NonlinearCoupling => "a nonlinear coupling",
            Extension::Offsets => "offsets from where all agree",
        }
    }
}

impl Theorem {
    /// This statement as far as it is extended by `by`, if by anything. What others state, and the baseline, is not ours to extend.
    pub(crate) fn extended(self, by: Vec<Extension>) -> Theorem {
        let ours = !matches!(self, Theorem::Declared(_) | Theorem::Backstepping);
        if ours && !by.is_empty() { Theorem::Extended { theorem: Box::new(self), by } } else { self }
    }

    /// The stable name, in kebab case.
    pub fn name(&self) -> &'static str {
        match self {
            Theorem::Theorem1 => "theorem-1",
            Theorem::Remark3 => "remark-3",
            Theorem::Theorem2 => "theorem-2",
            Theorem::FirstOrder => "theorem-3-first-order",
            Theorem::Theorem3Velocities { .. } => "theorem-3-velocities",
            Theorem::Theorem3Positions { .. } => "theorem-3-positions",
            Theorem::OwnOrders { .. } => "theorem-3-own-orders",
            Theorem::Backstepping => "backstepping",
            Theorem::Mixture(_) => "mixture",
            Theorem::Targets(_) => "targets",
            Theorem::ChainsTrack(_) => "chains-track",
            Theorem::ChainsAgree(_) => "chains-agree",
            Theorem::RobotsTrack => "robots-track",
            Theorem::PositionOnlyTracks => "position-only-tracks",
            Theorem::PositionOnlyAgree { .. } => "remark-7",
            Theorem::ModelReference => "model-reference",
            Theorem::ContinuousThrust => "continuous-thrust",
            Theorem::Theorem4 => "theorem-4",
            Theorem::Theorem5 => "theorem-5",
            Theorem::ThrustByAcceleration => "thrust-by-acceleration",
            Theorem::Theorem6 => "theorem-6",
            Theorem::Theorem6Pose => "theorem-6-pose",
            Theorem::Theorem6Redundant => "theorem-6-redundant",
            Theorem::TipVelocity => "tip-velocity",
            Theorem::Theorem7 => "theorem-7",
            Theorem::PassivityFilter => "passivity-filter",
            Theorem::Theorem8 => "theorem-8",
            Theorem::SwitchingLeader => "theorem-8-switching",
            Theorem::LateLeader => "theorem-8-late",
            Theorem::Theorem9 => "theorem-9",
            Theorem::Remark12 => "remark-12",
            Theorem::Swarm => "swarm",
            Theorem::CompositeLeader => "composite",
            Theorem::LeaderObserver => "leader-observer",
            Theorem::Desired => "desired-dynamics",
            Theorem::Declared(_) => "declared",
            Theorem::Refused(_) => "refused",
            Theorem::Extended { theorem, .. } => theorem.name(),
        }
    }

    /// Whether each of some, of which there is one at least, is the paper's.
    fn are_of_the_paper(all: &[Theorem]) -> bool {
        let own = |theorem: &Theorem| matches!(theorem.source(), Source::Paper | Source::Corrected(_));
        !all.is_empty() && all.iter().all(own)
    }

    /// Whose it is. Slips are those of PAPER.md that touch the statement.
    pub fn source(&self) -> Source {
        match self {
            Theorem::Theorem1
            | Theorem::Remark3
            | Theorem::Theorem2
            | Theorem::Backstepping
            | Theorem::ContinuousThrust
            | Theorem::Theorem4
            | Theorem::Theorem5
            | Theorem::Theorem8
            | Theorem::Theorem9
            | Theorem::Remark12 => Source::Paper,
            // No stronger than the weakest of them.
            Theorem::Targets(all) if Theorem::are_of_the_paper(all) => Source::Paper,
            Theorem::Targets(_) => Source::Derived,
            Theorem::FirstOrder => Source::Corrected("E1, E2, E3"),
            Theorem::Theorem3Velocities { .. } => Source::Corrected("E1, E2"),
            Theorem::Theorem3Positions { .. } => Source::Corrected("E2"),
            Theorem::PositionOnlyTracks => Source::Corrected("E9, E10"),
            Theorem::Theorem6 => Source::Corrected("E11, E12"),
            Theorem::Theorem7 => Source::Corrected("E13"),
            // Section IV leaves the second step open, Remark 7 announces its consensus, Remark 11 its swarm.
            // So does Theorem 3 with one order for all.
            Theorem::Mixture(_)
            | Theorem::OwnOrders { .. }
            | Theorem::RobotsTrack
            | Theorem::ChainsTrack(_)
            | Theorem::ChainsAgree(_)
            | Theorem::PositionOnlyAgree { .. }
            | Theorem::Desired
            | Theorem::SwitchingLeader
            | Theorem::LateLeader
            | Theorem::Theorem6Pose
            | Theorem::Theorem6Redundant
            | Theorem::PassivityFilter
            | Theorem::ModelReference
            | Theorem::TipVelocity
            | Theorem::ThrustByAcceleration
            | Theorem::LeaderObserver
            | Theorem::CompositeLeader
            | Theorem::Swarm
            | Theorem::Refused(_)
            | Theorem::Extended { .. } => Source::Derived,
            Theorem::Declared(_) => Source::Declared,
        }
    }
}

impl fmt::Display for Theorem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Theorem::Declared(source) => return write!(f, "as declared by its author: {source}"),
            Theorem::Refused(error) => return write!(f, "no theorem: the parts of the setup do not fit together: {error}"),
            Theorem::Extended { theorem, by } => {
                let by: Vec<&str> = by.iter().map(|extension| extension.words()).collect();
                return write!(f, "{theorem}, with {} as derived for this software", by.join(" and "));
            }
            Theorem::Theorem1 => "Theorem 1, reference dynamics (3)",
            Theorem::Remark3 => "Remark 3, reference dynamics (23)",
            Theorem::Theorem2 => "Theorem 2, reference dynamics (a1)",
            Theorem::FirstOrder => "Theorem 3 with (a5) of order 1, which is (aa10)",
            Theorem::Theorem3Velocities { order } => {
                return write!(f, "Theorem 3, reference dynamics (a5) of order {order}");
            }
            Theorem::Theorem3Positions { order } => {
                return write!(f, "Theorem 3, reference dynamics (24) of order {order}");
            }
            Theorem::OwnOrders { exchange, least, most } => {
                let dynamics = instance::name(Design::Consensus, *exchange);
                return write!(f, "the argument of Theorem 3, reference dynamics {dynamics} of orders {least} to {most}");
            }
            Theorem::Backstepping => "no theorem: the backstepping baseline (aa6)",
            Theorem::Mixture(treated) => {
                return write!(f, "no single theorem: {} side by side", treated.join(", "));
            }
            Theorem::Targets(all) if Theorem::are_of_the_paper(all) => "a theorem of Section V for every agent",
            Theorem::Targets(all) => {
                let all: Vec<String> = all.iter().map(Theorem::to_string).collect();
                return write!(f, "each agent by what is said of its law: {}", all.join("; "));
            }
            Theorem::ChainsTrack(steps) => {
                return write!(f, "Section IV, (43) for tracking; second step: {}", steps.join(", "));
            }
            Theorem::ChainsAgree(steps) => {
                return write!(f, "Section IV, (43) with (24) as in Theorem 3; second step: {}", steps.join(", "));
            }
            Theorem::RobotsTrack => {
                "no theorem of the paper: (6) and (7) after Slotine and Li, with reference dynamics for tracking as in (43)"
            }
            Theorem::PositionOnlyTracks => "Section V-A, (a8) with the reference dynamics (a9)",
            Theorem::PositionOnlyAgree { order } => {
                return write!(f, "Remark 7, (a8) with (24) of order {order} in z");
            }
            Theorem::ModelReference => {
                "no theorem of the paper: a mass by a model and a high gain, of the kind that Remark 7 speaks of, as derived for this software"
            }
            Theorem::ContinuousThrust => "Section V-B, continuous control (45), (46)",
            Theorem::Theorem4 => "Theorem 4, (50) with the reference dynamics (49)",
            Theorem::Theorem5 => "Theorem 5, (57) and (58) with the reference dynamics (49)",
            Theorem::ThrustByAcceleration => {
                "no theorem of the paper: vehicles by their measured acceleration, in the manner of what Remark 8 compares Theorem 5 with"
            }
            Theorem::Theorem6 => "Theorem 6, (80) to (82) with the reference dynamics (76)",
            Theorem::Theorem6Pose => {
                "no theorem of the paper: the argument of Theorem 6 for poses, with k_o Δq_v beside K_p Δp in (76) and (80) to (82)"
            }
            Theorem::Theorem6Redundant => {
                "no theorem of the paper: the argument of Theorem 6 with a null-space term of redundant joints in z_r"
            }
            Theorem::TipVelocity => {
                "no theorem of the paper: an end-effector by its measured velocity, in the manner of what Remark 9 compares Theorem 6 with"
            }
            Theorem::Theorem7 => "Theorem 7, (99) to (105) with the reference dynamics (97)",
            Theorem::PassivityFilter => {
                "no theorem of the paper: a passivity filter of the attitude error, of the kind that Remark 10 speaks of, as derived for this software"
            }
            Theorem::Theorem8 => "Theorem 8, reference dynamics (110)",
            Theorem::SwitchingLeader => {
                "no theorem of the paper: (110) over graphs that take turns as derived for this software"
            }
            Theorem::LateLeader => "no theorem of the paper: (110) over links that delay as derived for this software",
            Theorem::Theorem9 => "Theorem 9, reference dynamics (119)",
            Theorem::Remark12 => "Remark 12, reference dynamics (122)",
            Theorem::Desired => "Section IV, (43) with desired dynamics that are no design of the paper",
            Theorem::Swarm => "no theorem of the paper: swarm tracking (Remark 11) as derived for this software",
            Theorem::CompositeLeader => {
                "no theorem of the paper: agreement with the leader on one vector, y = ż + β z + α q, as derived for this software"
            }
            Theorem::LeaderObserver => {
                "no theorem of the paper: an observer of the leader, of the kind that Remark 11 speaks of, as derived for this software"
            }
        })
    }
}
