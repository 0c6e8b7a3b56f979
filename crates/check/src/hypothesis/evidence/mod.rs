//! What was found about a hypothesis: numbers, names and reasons as data, and what they amount to.
//!
//! Each kind of evidence says its answer and its rigour here, and its sentence in `words`. None of the matches has an arm
//! for the rest.
//!
//! # What the answers mean for what goes on after the run
//!
//! A theorem speaks of all time, and on a bounded time every continuous function is bounded: that a bound holds until the
//! end of the run says nothing. So it is asked what is known of later times.
//!
//! - What a rule says is known for ever: a formula, a sum of waves, a table after whose last row there is rest, a periodic
//!   schedule. It *holds* where that is certified, is *violated* where it is refuted, with a value and a time if one was
//!   found, and else *not shown*. Whether the run sees any of it plays no part.
//! - Of what was drawn or logged nothing is known beyond the end of the run. There, and only there, it *holds on [0, end]*,
//!   provided the run has shown something: a link on which nothing arrives has shown nothing.
//! - What depends on the motion is *watched*: a run in which it fails ends there.

mod following;
mod graph;
mod kinds;
mod links;
mod motion;
mod reference;
mod robots;
mod surroundings;

use super::{Answer, Rigour};

pub use following::FollowingEvidence;
pub(super) use following::{MOST_HELD, MOST_LEFT};
pub use graph::GraphEvidence;
pub use kinds::{FactorEverywhere, KindEvidence, Term};
pub use links::{LinkEvidence, TooOld, WeightFault};
pub use motion::{Bounded, MotionEvidence};
pub use reference::{ReferenceEvidence, TriedRun};
pub use robots::{InertiaUnit, MotionExtent, ReachSide, RobotEvidence};
pub use surroundings::{Inexact, Limited, LoopEvidence};

/// Evidence for or against a hypothesis.
#[derive(Clone, Debug, PartialEq)]
pub enum Evidence {
    /// Of graphs and their schedule.
    Graph(GraphEvidence),
    /// Of delays, weights and couplings.
    Links(LinkEvidence),
    /// Of reference dynamics.
    Reference(ReferenceEvidence),
    /// Of what follows a leader.
    Following(FollowingEvidence),
    /// Of what surrounds a law: gains, pushes, limits, sampling.
    Loop(LoopEvidence),
    /// Of targets, offsets and leaders.
    Motion(MotionEvidence),
    /// Of a kind of system and its law.
    Kind(KindEvidence),
    /// Of robots before they run.
    Robot(RobotEvidence),
}

/// Takes an answer, or a rigour, from whichever evidence there is.
macro_rules! of_any {
    ($evidence:expr, $what:ident) => {
        match $evidence {
            Evidence::Graph(evidence) => evidence.$what(),
            Evidence::Links(evidence) => evidence.$what(),
            Evidence::Reference(evidence) => evidence.$what(),
            Evidence::Following(evidence) => evidence.$what(),
            Evidence::Loop(evidence) => evidence.$what(),
            Evidence::Motion(evidence) => evidence.$what(),
            Evidence::Kind(evidence) => evidence.$what(),
            Evidence::Robot(evidence) => evidence.$what(),
        }
    };
}

impl Evidence {
    /// What it amounts to.
    pub fn answer(&self) -> Answer {
        of_any!(self, answer)
    }

    /// How it was come by.
    pub fn rigour(&self) -> Rigour {
        of_any!(self, rigour)
    }
}

/// `From` for each kind of evidence.
macro_rules! from {
    ($($kind:ident($evidence:ty)),*) => {
        $(impl From<$evidence> for Evidence {
            fn from(evidence: $evidence) -> Evidence {
                Evidence::$kind(evidence)
            }
        })*
    };
}

from!(
    Graph(GraphEvidence),
    Links(LinkEvidence),
    Reference(ReferenceEvidence),
    Following(FollowingEvidence),
    Loop(LoopEvidence),
    Motion(MotionEvidence),
    Kind(KindEvidence),
    Robot(RobotEvidence)
);

/// For all time, or up to the end of the run.
fn holds(for_all_time: bool) -> Answer {
    if for_all_time { Answer::Holds } else { Answer::HoldsOnHorizon }
}
