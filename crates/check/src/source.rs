//! Whose a theorem or a hypothesis is.

/// Whose it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The paper states it.
    Paper,
    /// The paper states it with a slip; the names of the slips are those of PAPER.md.
    Corrected(&'static str),
    /// Derived for this software; the paper does not state it.
    Derived,
    /// The author of a law from outside states it.
    Declared,
}

impl Source {
    /// In words: `the paper`, `the paper as corrected (E1)`, `derived for this software, not in the paper`.
    pub fn words(self) -> String {
        match self {
            Source::Paper => "the paper".into(),
            Source::Corrected(slips) => format!("the paper as corrected ({slips})"),
            Source::Derived => "derived for this software, not in the paper".into(),
            Source::Declared => "declared by its author".into(),
        }
    }
}
