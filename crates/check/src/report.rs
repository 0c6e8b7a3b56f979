//! Answers to "does a theorem apply?", hypothesis by hypothesis.

use crate::hypothesis::{Answer, Hypothesis, Id};
use crate::theorem::Theorem;

/// The theorem that speaks about a setup, with its hypotheses in the order in which they should be read.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// The theorem, and whose it is.
    pub theorem: Theorem,
    /// What it promises, in one sentence.
    pub promises: String,
    /// Its hypotheses and what was found.
    pub hypotheses: Vec<Hypothesis>,
}

impl Report {
    /// The worst answer of all hypotheses; [`Answer::NotCovered`] when there are none, since every theorem has some: an empty
    /// list has been forgotten.
    pub fn worst(&self) -> Answer {
        self.worst_without(&[])
    }

    /// The worst answer but for those about `accepted`; [`Answer::Holds`] where only those remain.
    pub fn worst_without(&self, accepted: &[Id]) -> Answer {
        if self.hypotheses.is_empty() {
            return Answer::NotCovered;
        }
        let counted = self.hypotheses.iter().filter(|hypothesis| !accepted.contains(&hypothesis.id));
        counted.map(Hypothesis::answer).max().unwrap_or(Answer::Holds)
    }
}
