//! Tries to refute what is claimed: random scenarios over all theorems, sizes, delays and schedules.

mod case;
mod judge;
mod text;

use std::collections::BTreeMap;

pub(crate) use case::Case;
pub(crate) use judge::{Failure, Verdict};

/// What became of many cases.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    /// Spreads that did not grow.
    pub(crate) kept: u64,
    /// Closed loops whose balance holds and whose error falls.
    pub(crate) fell: u64,
    /// Closed loops whose balance holds, of which nothing more is promised.
    pub(crate) balanced: u64,
    /// Those whose error had not fallen.
    pub(crate) undecided: Vec<Case>,
    /// Why nothing could be said, and of how many.
    pub(crate) silent: BTreeMap<String, u64>,
    /// Claims that are not so, shrunk.
    pub(crate) failed: Vec<(Case, Failure)>,
}

impl Tally {
    /// Judges one more case. A failure is made as small as it stays one of its kind.
    pub(crate) fn add(&mut self, case: Case) {
        match judge::judge(&case) {
            Verdict::Kept => self.kept += 1,
            Verdict::Fell => self.fell += 1,
            Verdict::Balanced => self.balanced += 1,
            Verdict::Undecided => self.undecided.push(case),
            Verdict::Silent(reason) => *self.silent.entry(reason).or_default() += 1,
            Verdict::Failed(failure) => self.failed.push(shrunk(case, failure)),
        }
    }

    /// How many were judged.
    pub(crate) fn cases(&self) -> u64 {
        let listed = self.undecided.len() + self.failed.len();
        self.kept + self.fell + self.balanced + self.silent.values().sum::<u64>() + listed as u64
    }
}

/// Takes whatever smaller case still fails in the same way, until none does.
fn shrunk(mut case: Case, mut failure: Failure) -> (Case, Failure) {
    loop {
        let smaller = case.smaller().into_iter().find_map(|smaller| match judge::judge(&smaller) {
            Verdict::Failed(found) if found.is_like(&failure) => Some((smaller, found)),
            Verdict::Failed(_)
            | Verdict::Kept
            | Verdict::Fell
            | Verdict::Balanced
            | Verdict::Undecided
            | Verdict::Silent(_) => None,
        });
        match smaller {
            Some(found) => (case, failure) = found,
            None => return (case, failure),
        }
    }
}
