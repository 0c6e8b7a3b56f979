//! Evidence of targets, offsets and leaders.

use crate::hypothesis::{Answer, Rigour};

/// What was found of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MotionEvidence {
    /// How far its derivatives are bounded.
    Derivatives(Bounded),
    /// It is that of an agent, which follows a target of its own.
    OfAgent,
    /// One entry of a quaternion is never smaller in magnitude.
    EntryAway {
        /// Its bound.
        least: f64,
    },
    /// The norm of a quaternion stays above this until the end of the run.
    NormAbove {
        /// By looking often, and by how fast it can change between two looks.
        least: f64,
    },
    /// The smallest norm that was seen, without a bound above zero.
    NormSeen {
        /// When, s.
        t_s: f64,
        /// The norm.
        norm: f64,
    },
    /// A norm that is zero, but for rounding.
    NormVanishes {
        /// When, s.
        t_s: f64,
        /// The norm.
        norm: f64,
    },
}

/// How far interval arithmetic bounds something.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Bounded {
    /// For all time.
    ForEver,
    /// Up to the end of the run.
    OnRun,
    /// Not even that.
    NotShown,
}

impl MotionEvidence {
    pub(super) fn answer(&self) -> Answer {
        match self {
            MotionEvidence::Derivatives(Bounded::ForEver) | MotionEvidence::EntryAway { .. } => Answer::Holds,
            MotionEvidence::Derivatives(Bounded::OnRun) | MotionEvidence::NormAbove { .. } => Answer::HoldsOnHorizon,
            MotionEvidence::Derivatives(Bounded::NotShown) | MotionEvidence::NormSeen { .. } => Answer::NotShown,
            MotionEvidence::OfAgent => Answer::Watched,
            MotionEvidence::NormVanishes { .. } => Answer::Violated,
        }
    }

    pub(super) fn rigour(&self) -> Rigour {
        match self {
            MotionEvidence::OfAgent => Rigour::Watched,
            MotionEvidence::Derivatives(_) | MotionEvidence::EntryAway { .. } => Rigour::Enclosed,
            MotionEvidence::NormAbove { .. } => Rigour::Computed,
            MotionEvidence::NormSeen { .. } | MotionEvidence::NormVanishes { .. } => Rigour::Sampled,
        }
    }
}
