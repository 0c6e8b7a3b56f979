//! Where |a|, min and max of an expression in one variable change branches.
//!
//! The branch is the sign of an *argument*: a for |a|, b − a for min(a, b), a − b for max(a, b). A stretch on which the argument
//! is enclosed on one side of zero has one branch. Where the enclosure of its slope leaves zero out it crosses zero once at
//! most, and the crossing is bisected to the last bit. Anything else is cut in halves, down to stretches so short that
//! everything on them is one event.

use alloc::vec::Vec;

use thiserror::Error;

use super::operation::Operation;
use super::{Binary, Expression, Graph, Interval, Step, Unary};

/// Kinks that an expression may have.
pub const MOST_KINKS: usize = 10_000;
/// Stretches that may be looked at for one argument.
const MOST_STRETCHES: usize = 400_000;
/// What lies closer together than this part of x, or this, is one kink.
const SHORTEST: f64 = 1e-12;
/// So many of the shortest stretches side by side still are.
const MOST_SHORTEST: f64 = 64.0;

/// Where one |a|, min or max changes branches.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Switch {
    /// Whether the first branch is active at the beginning.
    first: bool,
    at: Vec<f64>,
}

impl Switch {
    /// Where, rising.
    pub fn at(&self) -> &[f64] {
        &self.at
    }

    /// Whether the first branch is active right after x.
    pub(super) fn is_first(&self, x: f64) -> bool {
        self.first ^ (self.at.partition_point(|at| *at <= x) % 2 == 1)
    }
}

/// Why kinks could not be found.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum KinkError {
    /// Too many.
    #[error("it has more than {MOST_KINKS} kinks")]
    TooMany,
    /// Kinks that cannot be told apart, or an argument that touches zero or stays there.
    #[error(
        "its kinks near {near} cannot be told apart: what `abs`, `min` or `max` compares stays too close together there"
    )]
    Unclear {
        /// About where.
        near: f64,
    },
}

impl Expression {
    /// Where every |a|, min and max changes branches between `from` and `to`, in the order in which they are written.
    ///
    /// # Errors
    /// [`KinkError`] when that cannot be shown.
    pub fn switches(&self, from: f64, to: f64) -> Result<Vec<Switch>, KinkError> {
        let arguments: Vec<Expression> = self.operations().iter().filter_map(argument).collect();
        arguments.iter().map(|argument| Search::new(argument).run(from, to)).collect()
    }
}

/// The argument of |a|, min or max.
fn argument(operation: &Operation<'_>) -> Option<Expression> {
    let difference = |a: &[Step], b: &[Step]| [a, b, &[Step::Binary(Binary::Subtract)]].concat();
    let steps = match operation {
        Operation::Unary(Unary::Abs, a) => a.to_vec(),
        Operation::Binary(Binary::Max, [a, b]) => difference(a, b),
        Operation::Binary(Binary::Min, [a, b]) => difference(b, a),
        Operation::Unary(..) | Operation::Binary(..) | Operation::Power(..) => return None,
    };
    Some(Expression { steps })
}

/// A walk from left to right over the stretches of one argument.
struct Search<'a> {
    argument: &'a Expression,
    /// The sign last seen.
    positive: Option<bool>,
    switch: Switch,
    /// The short stretches just passed whose sign is not known.
    unclear: Option<[f64; 2]>,
}

impl<'a> Search<'a> {
    fn new(argument: &'a Expression) -> Self {
        Search { argument, positive: None, switch: Switch { first: true, at: Vec::new() }, unclear: None }
    }

    fn run(mut self, from: f64, to: f64) -> Result<Switch, KinkError> {
        let mut graph = Graph::new(1);
        if let Ok(node) = graph.import(self.argument)
            && let Some(value) = graph.constant(node)
        {
            return Ok(Switch { first: value >= 0.0, at: Vec::new() });
        }
        let mut waiting = alloc::vec![[from, to]];
        for _ in 0..MOST_STRETCHES {
            let Some([left, right]) = waiting.pop() else { return Ok(self.switch) };
            if self.settle(left, right)? {
                continue;
            }
            let middle = left + 0.5 * (right - left);
            if right - left <= SHORTEST * right.abs().max(1.0) || middle <= left || middle >= right {
                self.pass_unclear(left, right)?;
            } else {
                waiting.extend([[middle, right], [left, middle]]);
            }
        }
        Err(KinkError::Unclear { near: waiting.last().map_or(to, |[left, _]| *left) })
    }

    /// Whether the branches on a stretch are known.
    fn settle(&mut self, left: f64, right: f64) -> Result<bool, KinkError> {
        let [value, slope, ..] = self.argument.enclose_jet(Interval { low: left, high: right });
        if value.low >= 0.0 || value.high <= 0.0 {
            self.note(value.low >= 0.0, left)?;
            return Ok(true);
        }
        if slope.holds(0.0) {
            return Ok(false);
        }
        let ends = [self.argument.eval(left), self.argument.eval(right)];
        let crosses = ends[0] < 0.0 && ends[1] > 0.0 || ends[0] > 0.0 && ends[1] < 0.0;
        if crosses {
            self.note(ends[0] > 0.0, left)?;
            self.note(ends[1] > 0.0, bisect(|x| self.argument.eval(x), left, right, ends[1] > 0.0))?;
        } else {
            // An end that is a zero belongs to either side.
            self.note(ends[0] + ends[1] >= 0.0, left)?;
        }
        Ok(true)
    }

    /// From `x` on the argument has this sign.
    fn note(&mut self, positive: bool, x: f64) -> Result<(), KinkError> {
        let unclear = self.unclear.take();
        match self.positive.replace(positive) {
            None => self.switch.first = positive,
            Some(before) if before != positive => {
                self.switch.at.push(unclear.map_or(x, |[left, right]| 0.5 * (left + right)));
            }
            Some(_) => {}
        }
        if self.switch.at.len() > MOST_KINKS { Err(KinkError::TooMany) } else { Ok(()) }
    }

    fn pass_unclear(&mut self, left: f64, right: f64) -> Result<(), KinkError> {
        let from = self.unclear.map_or(left, |[from, _]| from);
        self.unclear = Some([from, right]);
        let widest = MOST_SHORTEST * SHORTEST * right.abs().max(1.0);
        if right - from > widest { Err(KinkError::Unclear { near: from }) } else { Ok(()) }
    }
}

/// The right end of a bracket in which `f` changes its sign, to the last bit; `rising` says from negative to positive.
pub fn bisect(f: impl Fn(f64) -> f64, mut left: f64, mut right: f64, rising: bool) -> f64 {
    loop {
        let middle = left + 0.5 * (right - left);
        if middle <= left || middle >= right {
            return right;
        }
        let value = f(middle);
        if value == 0.0 || (value > 0.0) == rising {
            right = middle;
        } else {
            left = middle;
        }
    }
}
