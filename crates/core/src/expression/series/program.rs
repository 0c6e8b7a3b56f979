//! The operations on coefficients, and how they are run.

use alloc::vec::Vec;
use core::ops::Range;

use super::super::Binary;
use super::super::float::combine;
use super::outer::Outer;
use crate::LengthError;

/// An operation. Places are entries of the coefficients.
#[derive(Clone, Debug)]
pub(super) enum Op {
    /// A given entry times a factor.
    Read { to: usize, entry: usize, factor: f64 },
    /// Coefficients times factors.
    Slope { to: usize, sources: Range<usize> },
    /// g₀, g₁, … of a function.
    Outer { outer: Outer, from: Option<usize>, to: usize, count: usize },
    /// A function of two constants.
    Combine { function: Binary, to: usize, a: Option<usize>, b: Option<usize> },
    /// A sum of parts.
    Sum { to: usize, count: usize, parts: Range<usize> },
}

/// A coefficient and what it is multiplied by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source {
    pub(super) from: usize,
    pub(super) factor: f64,
}

/// A term of a sum.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) kind: PartKind,
    pub(super) factor: f64,
    pub(super) a: usize,
    pub(super) b: usize,
    pub(super) rows: Range<usize>,
}

/// What a term is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PartKind {
    Scaled,
    Product,
    HalfSquare,
}

/// One coefficient of the first factor times those of the second from its first on, from its own one for a square.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub(super) of: u32,
    pub(super) count: u32,
    /// Where it is listed which coefficient of the result each is added to.
    pub(super) targets: usize,
}

/// Operations on the coefficients of series, in order.
///
/// **Guarantees**: no allocation in [`Program::evaluate`], the same bits on every machine.
#[derive(Clone, Debug)]
pub(crate) struct Program {
    pub(super) coefficients: Vec<f64>,
    pub(super) ops: Vec<Op>,
    pub(super) parts: Vec<Part>,
    pub(super) rows: Vec<Row>,
    pub(super) targets: Vec<u32>,
    pub(super) sources: Vec<Source>,
    /// Where the results are; nowhere if they are always zero.
    pub(super) outputs: Vec<Option<usize>>,
}

impl Program {
    /// How many results there are.
    pub(crate) fn outputs(&self) -> usize {
        self.outputs.len()
    }

    /// Working memory for one evaluation.
    pub(crate) fn workspace(&self) -> Vec<f64> {
        self.coefficients.clone()
    }

    /// The results for what is given; not-a-number or infinite where there is none.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    pub(crate) fn evaluate(&self, given: &[f64], work: &mut [f64], out: &mut [f64]) -> Result<(), LengthError> {
        LengthError::check("workspace", self.coefficients.len(), work.len())?;
        LengthError::check("values", self.outputs.len(), out.len())?;
        let value = |work: &[f64], at: Option<usize>| at.map_or(0.0, |at| work[at]);
        for op in &self.ops {
            match op {
                Op::Read { to, entry, factor } => {
                    work[*to] = factor * given.get(*entry).copied().unwrap_or(f64::NAN);
                }
                Op::Slope { to, sources } => {
                    for (to, Source { from, factor }) in (*to..).zip(&self.sources[sources.clone()]) {
                        work[to] = factor * work[*from];
                    }
                }
                Op::Outer { outer, from, to, count } => {
                    let at = value(work, *from);
                    outer.coefficients(at, &mut work[*to..*to + *count]);
                }
                Op::Combine { function, to, a, b } => work[*to] = combine(*function, value(work, *a), value(work, *b)),
                Op::Sum { to, count, parts } => {
                    // Operands stand before results.
                    let (before, after) = work.split_at_mut(*to);
                    let sum = &mut after[..*count];
                    sum.fill(0.0);
                    self.parts[parts.clone()].iter().for_each(|part| self.add(part, before, sum));
                }
            }
        }
        for (out, at) in out.iter_mut().zip(&self.outputs) {
            *out = value(work, *at);
        }
        Ok(())
    }

    /// Adds a term to a sum.
    fn add(&self, part: &Part, work: &[f64], sum: &mut [f64]) {
        for Row { of, count, targets } in &self.rows[part.rows.clone()] {
            let (of, count) = (*of as usize, *count as usize);
            let targets = &self.targets[*targets..*targets + count];
            match part.kind {
                PartKind::Scaled => scatter(part.factor, &work[part.b..part.b + count], targets, sum),
                PartKind::Product => {
                    scatter(part.factor * work[part.a + of], &work[part.b..part.b + count], targets, sum);
                }
                PartKind::HalfSquare => {
                    let own = work[part.a + of];
                    if let [square, rest @ ..] = targets {
                        sum[*square as usize] += 0.5 * own * own;
                        let from = part.b + of + 1;
                        scatter(own, &work[from..from + rest.len()], rest, sum);
                    }
                }
            }
        }
    }
}

/// Adds multiples of coefficients to those listed.
#[inline]
fn scatter(factor: f64, from: &[f64], targets: &[u32], sum: &mut [f64]) {
    for (value, target) in from.iter().zip(targets) {
        sum[*target as usize] += factor * value;
    }
}
