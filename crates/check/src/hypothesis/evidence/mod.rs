//! What was found about a hypothesis: numbers, names and reasons as data, and what they amount to.
//!
//! Each kind of evidence says its answer and its rigour here, and its sentence in `words`. None of the matches has an arm
//! for the rest.

mod following;
mod graph;
mod kinds;
mod links;
mod motion;
mod reference;
mod surroundings;

use super::{Answer, Rigour};

pub use following::FollowingEvidence;
pub use graph::GraphEvidence;
pub use kinds::KindEvidence;
pub use links::LinkEvidence;
pub use motion::{Bounded, MotionEvidence};
pub use reference::ReferenceEvidence;
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
    Kind(KindEvidence)
);

/// For all time, or up to the end of the run.
fn holds(for_all_time: bool) -> Answer {
    if for_all_time { Answer::Holds } else { Answer::HoldsOnHorizon }
}
