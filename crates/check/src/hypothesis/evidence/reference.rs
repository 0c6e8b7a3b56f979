//! Evidence of reference dynamics.

use forwardstep_core::reference::RootPair;

use crate::hypothesis::{Answer, Named, Rigour};

/// What was found of the reference dynamics.
#[derive(Clone, Debug, PartialEq)]
pub enum ReferenceEvidence {
    /// The polynomials are given by their roots −κ.
    Roots {
        /// The smallest κ, 1/s.
        smallest_per_s: f64,
    },
    /// Roots of an agent that have to be real are not.
    ComplexRoots {
        /// The agent.
        agent: Named,
        /// Its first pair.
        pair: RootPair,
    },
    /// All roots, real or not, lie to the left of a line.
    Hurwitz {
        /// How far it is from the axis at least, 1/s.
        slowest_per_s: f64,
    },
    /// All are of this order.
    Order(usize),
    /// Two are not of the same order.
    Orders([(Named, usize); 2]),
    /// κ₀ is common wherever agents hear each other in a cycle.
    FirstRootCommon,
    /// κ₀ differs in a cycle, over a fixed graph with constant delays and weights.
    FirstRootsOverConstants,
    /// Two agents in a cycle, and their κ₀, 1/s.
    FirstRoots([(Named, f64); 2]),
    /// A derivative is estimated by a filter.
    FilteredDerivative {
        /// Its time constant, s.
        filter_s: f64,
    },
    /// λ of Remark 4.
    Manipulability {
        /// The largest.
        largest: f64,
    },
    /// Desired dynamics are a design of the paper.
    Design {
        /// Its equation.
        design: &'static str,
        /// How many roots it has.
        order: usize,
    },
    /// The polynomial of a target has its roots to the left of the axis by the criterion of Routh and Hurwitz.
    Stable {
        /// Its degree.
        order: usize,
    },
    /// It has not.
    Unstable {
        /// The first row of the array of Routh whose first entry is not positive, from zero.
        row: usize,
        /// Its degree.
        order: usize,
    },
    /// Desired dynamics in which agents hear each other are no design that is known.
    NoDesign {
        /// Whether graph, weights and delays are constant.
        steady: bool,
        /// Whether their polynomial is given by roots, so that it could be compared.
        by_roots: bool,
    },
    /// They are written in variables in which none is known.
    NoDesignInThese,
    /// Runs of a nonlinear protocol alone, from states that are drawn.
    Tried {
        /// How many were made.
        runs: usize,
        /// One that ends farther from what it is for than it began.
        found: Option<TriedRun>,
    },
}

/// A run of desired dynamics that ends farther from what they are for than it began.
#[derive(Clone, Debug, PartialEq)]
pub struct TriedRun {
    /// Where the agents start.
    pub start: Vec<f64>,
    /// Whether there is an s, which vanishes.
    pub disturbed: bool,
    /// The distance at most in the first tenth of the run.
    pub from: f64,
    /// The distance at the end; infinite where the run breaks down.
    pub to: f64,
    /// When it was to end, s.
    pub until_s: f64,
}

/// A run that comes to be so many times farther speaks against what is declared.
const GROWN: f64 = 1e3;

impl TriedRun {
    /// Whether it speaks against what is declared, as far as a computed run can: it broke down, or grew beyond what a short run, or
    /// one that swings, explains.
    pub fn diverges(&self) -> bool {
        self.to.is_nan() || self.to >= GROWN * self.from
    }
}

impl ReferenceEvidence {
    pub(super) fn answer(&self) -> Answer {
        match self {
            ReferenceEvidence::Roots { smallest_per_s: slowest_per_s }
            | ReferenceEvidence::Hurwitz { slowest_per_s } => {
                if *slowest_per_s > 0.0 {
                    Answer::Holds
                } else {
                    Answer::Violated
                }
            }
            ReferenceEvidence::Order(_)
            | ReferenceEvidence::Orders(_)
            | ReferenceEvidence::FirstRootCommon
            | ReferenceEvidence::FirstRootsOverConstants
            | ReferenceEvidence::Manipulability { .. } => Answer::Holds,
            ReferenceEvidence::Design { .. } | ReferenceEvidence::Stable { .. } => Answer::Holds,
            ReferenceEvidence::ComplexRoots { .. }
            | ReferenceEvidence::NoDesign { .. }
            | ReferenceEvidence::NoDesignInThese
            // A run is computed in floating point: no other program can replay it exactly, so it refutes nothing strictly.
            | ReferenceEvidence::Tried { .. } => Answer::NotShown,
            ReferenceEvidence::Unstable { .. } => Answer::Violated,
            ReferenceEvidence::FirstRoots(_) | ReferenceEvidence::FilteredDerivative { .. } => Answer::NotCovered,
        }
    }

    /// All of it is compared as it was given, but for what was run.
    pub(super) fn rigour(&self) -> Rigour {
        match self {
            ReferenceEvidence::Tried { .. } => Rigour::Sampled,
            ReferenceEvidence::Roots { .. }
            | ReferenceEvidence::ComplexRoots { .. }
            | ReferenceEvidence::Hurwitz { .. }
            | ReferenceEvidence::Order(_)
            | ReferenceEvidence::Orders(_)
            | ReferenceEvidence::FirstRootCommon
            | ReferenceEvidence::FirstRootsOverConstants
            | ReferenceEvidence::FirstRoots(_)
            | ReferenceEvidence::FilteredDerivative { .. }
            | ReferenceEvidence::Manipulability { .. }
            | ReferenceEvidence::Design { .. }
            | ReferenceEvidence::Stable { .. }
            | ReferenceEvidence::Unstable { .. }
            | ReferenceEvidence::NoDesign { .. }
            | ReferenceEvidence::NoDesignInThese => Rigour::Exact,
        }
    }
}
