//! What is explained of a setup: sections of words and formulas, for every design in it.

use forwardstep_sim::{Setup, check_setup};

use super::case::{Case, cases};
use super::formula::Formula;

/// Why a run of a setup converges.
#[derive(Clone, Debug, PartialEq)]
pub struct Explanation {
    /// Every design in it: agents with the same reference dynamics and the same kind of law.
    pub designs: Vec<Explained>,
}

/// One design.
#[derive(Clone, Debug, PartialEq)]
pub struct Explained {
    /// The agents that have it, by their numbers.
    pub agents: Vec<usize>,
    /// N: the order of the reference dynamics with respect to q; `None` where it is not known.
    pub order: Option<usize>,
    /// The degree of the closed loop, and that after degree reduction; `None` where there is no cascade.
    pub degrees: Option<[usize; 2]>,
    /// In the order in which they are read.
    pub sections: Vec<Section>,
}

/// A part of an explanation.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// What it is about.
    pub subject: Subject,
    /// Words and formulas.
    pub lines: Vec<Line>,
}

/// What a section is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// What z is, and of which order.
    VirtualControl,
    /// How z is made.
    ReferenceDynamics,
    /// How s is made to vanish.
    Controller,
    /// The closed loop.
    Cascade,
    /// How derivatives of s are absorbed.
    DegreeReduction,
    /// Averages.
    Laplacian,
    /// What follows.
    Convergence,
}

impl Subject {
    /// Its heading.
    pub fn heading(self) -> &'static str {
        match self {
            Subject::VirtualControl => "Virtual control",
            Subject::ReferenceDynamics => "Reference dynamics",
            Subject::Controller => "Controller",
            Subject::Cascade => "Differential cascade",
            Subject::DegreeReduction => "Degree reduction",
            Subject::Laplacian => "Laplacian form",
            Subject::Convergence => "Why it converges",
        }
    }

    /// A stable name, in snake case.
    pub fn name(self) -> &'static str {
        match self {
            Subject::VirtualControl => "virtual_control",
            Subject::ReferenceDynamics => "reference_dynamics",
            Subject::Controller => "controller",
            Subject::Cascade => "cascade",
            Subject::DegreeReduction => "degree_reduction",
            Subject::Laplacian => "laplacian",
            Subject::Convergence => "convergence",
        }
    }
}

/// A line of a section.
#[derive(Clone, Debug, PartialEq)]
pub enum Line {
    /// A sentence or several.
    Words(String),
    /// A formula, and where it stands in the paper; empty where it does not.
    Formula(Formula, &'static str),
}

impl Section {
    /// An empty one.
    pub(super) fn new(subject: Subject) -> Self {
        Section { subject, lines: Vec::new() }
    }

    /// With a sentence more.
    pub(super) fn words(mut self, words: impl Into<String>) -> Self {
        self.lines.push(Line::Words(words.into()));
        self
    }

    /// With a formula more, and where it stands in the paper.
    pub(super) fn formula(mut self, formula: Formula, place: &'static str) -> Self {
        self.lines.push(Line::Formula(formula, place));
        self
    }

    /// With several more; the place belongs to the last, as the number of a system does.
    pub(super) fn system(mut self, formulas: Vec<Formula>, place: &'static str) -> Self {
        let last = formulas.len().saturating_sub(1);
        let each = formulas.into_iter().enumerate();
        self.lines.extend(each.map(|(k, formula)| Line::Formula(formula, if k == last { place } else { "" })));
        self
    }
}

/// Explains a setup: what z is, the closed loop as a differential cascade, and how its degree is reduced, derived from the setup's own
/// reference dynamics and laws.
///
/// Of a setup that has no meaning ([`forwardstep_sim::check_setup`]) nothing is explained.
///
/// **Source**: Sections III to V of the paper; every formula names its own. Nothing is said of reference dynamics and laws from outside
/// that do not say what they are.
pub fn explain(setup: &Setup) -> Explanation {
    let cases = if check_setup(setup).is_ok() { cases(setup) } else { Vec::new() };
    Explanation { designs: cases.iter().map(Case::explained).collect() }
}
