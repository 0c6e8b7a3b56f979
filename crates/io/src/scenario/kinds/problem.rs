//! What a kind finds wrong with its table, in an error type of its own.

use std::error::Error;
use std::fmt;
use std::sync::Arc;

use super::super::problem::ScenarioProblem;

/// A mistake in the table of a kind, and what to do about it.
pub trait Mistake: Error + Send + Sync + 'static {
    /// What the user can do.
    fn help(&self) -> Option<String>;
}

/// Any [`Mistake`].
#[derive(Clone)]
pub struct KindProblem(Arc<dyn Mistake>);

impl KindProblem {
    /// What the user can do.
    pub fn help(&self) -> Option<String> {
        self.0.help()
    }
}

impl fmt::Debug for KindProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(&self.0, f)
    }
}

impl fmt::Display for KindProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.0, f)
    }
}

impl Error for KindProblem {}

impl PartialEq for KindProblem {
    /// Whether both say the same.
    fn eq(&self, other: &Self) -> bool {
        (self.to_string(), self.help()) == (other.to_string(), other.help())
    }
}

impl<M: Mistake> From<M> for ScenarioProblem {
    fn from(mistake: M) -> Self {
        ScenarioProblem::Kind(KindProblem(Arc::new(mistake)))
    }
}
