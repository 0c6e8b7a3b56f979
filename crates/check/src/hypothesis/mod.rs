//! A hypothesis of a theorem: which, of what, and the evidence for or against it.
//!
//! Nothing here is free text. The answer and how rigorous it is follow from the evidence, by `evidence`, and so do the
//! sentences, by `words`: an answer cannot contradict its reason.

mod evidence;
mod id;
mod words;

use forwardstep_sim::Setup;
use forwardstep_sim::leader::FollowingDesign;

pub use evidence::{
    Bounded, Evidence, FactorEverywhere, FollowingEvidence, GraphEvidence, InertiaUnit, Inexact, KindEvidence, Limited,
    LinkEvidence, LoopEvidence, MotionEvidence, MotionExtent, ReachSide, ReferenceEvidence, RobotEvidence, Term,
    TooOld, TriedRun, WeightFault,
};
pub use id::Id;
pub(crate) use words::{counterexample, numbers};

use crate::source::Source;

/// One hypothesis.
#[derive(Clone, Debug, PartialEq)]
pub struct Hypothesis {
    /// Which.
    pub id: Id,
    /// What it is required of.
    pub subject: Subject,
    /// What was found.
    pub evidence: Evidence,
}

/// What a hypothesis is required of.
#[derive(Clone, Debug, PartialEq)]
pub enum Subject {
    /// The setup as a whole.
    Setup,
    /// The reference dynamics.
    Reference,
    /// One agent.
    Agent(Named),
    /// The targets of some agents with their derivatives.
    Targets {
        /// The agents.
        agents: Vec<Named>,
        /// Up to which derivative, four at most.
        derivatives: usize,
        /// Whether they may travel for ever, so that they themselves do not count.
        travels: bool,
    },
    /// The derivatives of the offsets of some agents. A formation may travel: its offsets themselves do not count.
    Offsets {
        /// The agents.
        agents: Vec<Named>,
        /// Up to which derivative, four at most.
        derivatives: usize,
    },
    /// What drives the leader away from those who follow it by this design.
    Drive(FollowingDesign),
}

/// An agent, or the leader, by index and name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Named {
    /// Index of the vertex in the network.
    pub index: usize,
    /// Its name.
    pub name: String,
}

impl Named {
    pub(crate) fn of(setup: &Setup, index: usize) -> Named {
        Named { index, name: setup.vertex_name(index).to_owned() }
    }

    pub(crate) fn all(setup: &Setup, indices: &[usize]) -> Vec<Named> {
        indices.iter().map(|index| Named::of(setup, *index)).collect()
    }
}

/// The answers, from best to worst.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Answer {
    /// For all time.
    Holds,
    /// Only shown on the horizon of the run.
    HoldsOnHorizon,
    /// Only a run can show it: one in which it fails stops there.
    Watched,
    /// Neither certified nor refuted.
    NotShown,
    /// The paper does not speak about this case.
    NotCovered,
    /// It fails, and the evidence is a witness.
    Violated,
}

impl Answer {
    /// Whether it speaks for a design: *holds*, *holds on [0, end]* or *watched during the run*.
    pub fn is_fine(self) -> bool {
        match self {
            Answer::Holds | Answer::HoldsOnHorizon | Answer::Watched => true,
            Answer::NotShown | Answer::NotCovered | Answer::Violated => false,
        }
    }

    /// The words used in tables: `holds`, `holds on [0, end]`, `watched during the run`, `not shown`,
    /// `not covered by the paper`, `violated`.
    pub fn words(self) -> &'static str {
        match self {
            Answer::Holds => "holds",
            Answer::HoldsOnHorizon => "holds on [0, end]",
            Answer::Watched => "watched during the run",
            Answer::NotShown => "not shown",
            Answer::NotCovered => "not covered by the paper",
            Answer::Violated => "violated",
        }
    }
}

/// How the evidence was come by, from firmest to weakest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Rigour {
    /// By counting and comparing what the setup says, or by construction: nothing was rounded.
    Exact,
    /// By interval arithmetic.
    Enclosed,
    /// From numbers that were drawn or logged, up to the end of the run.
    Given,
    /// In floating point, without a bound on the rounding.
    Computed,
    /// By looking at finitely many points.
    Sampled,
    /// By the word of the user.
    Declared,
    /// By the run itself.
    Watched,
}

impl Rigour {
    /// One word, as in `summary.json`.
    pub fn word(self) -> &'static str {
        match self {
            Rigour::Exact => "exact",
            Rigour::Enclosed => "enclosed",
            Rigour::Given => "given",
            Rigour::Computed => "computed",
            Rigour::Sampled => "sampled",
            Rigour::Declared => "declared",
            Rigour::Watched => "watched",
        }
    }

    /// What the word means.
    pub fn meaning(self) -> &'static str {
        match self {
            Rigour::Exact => "by counting and comparing what the scenario says, with nothing rounded",
            Rigour::Enclosed => "by interval arithmetic, which bounds all rounding",
            Rigour::Given => "from numbers that were drawn or logged, up to the end of the run",
            Rigour::Computed => "in floating point, without a bound on the rounding",
            Rigour::Sampled => "by looking at finitely many points",
            Rigour::Declared => "by the word of the user",
            Rigour::Watched => "by the run itself",
        }
    }
}

impl Hypothesis {
    /// A hypothesis about the setup as a whole.
    pub(crate) fn new(id: Id, evidence: impl Into<Evidence>) -> Hypothesis {
        Hypothesis::about(id, Subject::Setup, evidence)
    }

    pub(crate) fn about(id: Id, subject: Subject, evidence: impl Into<Evidence>) -> Hypothesis {
        Hypothesis { id, subject, evidence: evidence.into() }
    }

    /// Where the paper asks for it, as [`Id::place`]; the paper has no offsets.
    pub fn place(&self) -> &'static str {
        match self.subject {
            Subject::Offsets { .. } => "own derivation",
            Subject::Setup | Subject::Reference | Subject::Agent(_) | Subject::Targets { .. } | Subject::Drive(_) => {
                self.id.place()
            }
        }
    }

    /// Whose hypothesis it is, as [`Id::source`].
    pub fn source(&self) -> Source {
        match self.subject {
            Subject::Offsets { .. } => Source::Derived,
            Subject::Setup | Subject::Reference | Subject::Agent(_) | Subject::Targets { .. } | Subject::Drive(_) => {
                self.id.source()
            }
        }
    }

    /// What was found.
    pub fn answer(&self) -> Answer {
        self.evidence.answer()
    }

    /// How it was found.
    pub fn rigour(&self) -> Rigour {
        self.evidence.rigour()
    }

    /// What is required, in words.
    pub fn requires(&self) -> String {
        words::requires(self.id, &self.subject)
    }

    /// The certificate or the witness in words: the smallest window and its root, the unreachable agent, …
    pub fn because(&self) -> String {
        words::because(&self.evidence)
    }

    /// The smallest change that would make this hypothesis hold for all time, as far as it is known: an edge, γ, κ₀, a rate; `None` where
    /// it holds. It says nothing of the other hypotheses.
    pub fn change(&self) -> Option<String> {
        words::change(&self.evidence)
    }
}
