//! Evidence of targets, offsets and leaders.

use forwardstep_sim::formula::Witness;

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
    /// The norm of a quaternion stays above this.
    NormAbove {
        /// By enclosures, or by looking often, and by how fast it can change between two looks.
        least: f64,
    },
    /// The norm of a quaternion comes as close to zero as one likes.
    NormFades {
        /// A value of it below half of what it is on the run, if one was found.
        witness: Option<Witness>,
    },
    /// The smallest norm that was seen, without a bound above zero.
    NormSeen {
        /// When, s.
        t_s: f64,
        /// The norm.
        norm: f64,
    },
    /// All entries of a quaternion are shown to come to zero together.
    NormVanishes {
        /// When, s, as far as a number that is rounded says.
        t_s: f64,
    },
}

/// What is known of bounds for all time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bounded {
    /// Everything keeps within bounds.
    ForEver,
    /// Neither this nor its contrary is shown.
    NotShown,
    /// A curve through points joins rest by a third derivative that jumps, so that the fourth has no bound there.
    Jumps,
    /// A derivative exceeds every bound.
    Unbounded {
        /// Which; zero for the motion itself.
        derivative: usize,
        /// A value of it that is twice as large as any on the run, if one was found.
        witness: Option<Witness>,
    },
}

impl MotionEvidence {
    pub(super) fn answer(&self) -> Answer {
        match self {
            MotionEvidence::Derivatives(Bounded::ForEver)
            | MotionEvidence::EntryAway { .. }
            | MotionEvidence::NormAbove { .. } => Answer::Holds,
            MotionEvidence::Derivatives(Bounded::NotShown | Bounded::Jumps) | MotionEvidence::NormSeen { .. } => {
                Answer::NotShown
            }
            MotionEvidence::OfAgent => Answer::Watched,
            MotionEvidence::Derivatives(Bounded::Unbounded { .. })
            | MotionEvidence::NormFades { .. }
            | MotionEvidence::NormVanishes { .. } => Answer::Violated,
        }
    }

    pub(super) fn rigour(&self) -> Rigour {
        match self {
            MotionEvidence::OfAgent => Rigour::Watched,
            MotionEvidence::Derivatives(_)
            | MotionEvidence::EntryAway { .. }
            | MotionEvidence::NormFades { .. }
            | MotionEvidence::NormVanishes { .. }
            | MotionEvidence::NormAbove { .. } => Rigour::Enclosed,
            MotionEvidence::NormSeen { .. } => Rigour::Sampled,
        }
    }
}
