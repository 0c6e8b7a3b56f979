//! The operations of an expression, each with the steps of its operands.

use alloc::vec::Vec;

use super::{Binary, Expression, Number, Step, Unary};

/// One operation and what it is done to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Operation<'a> {
    Unary(Unary, &'a [Step]),
    Binary(Binary, [&'a [Step]; 2]),
    Power(&'a [Step], &'a Number),
}

impl Expression {
    /// Its operations, in the order in which they are done.
    pub(super) fn operations(&self) -> Vec<Operation<'_>> {
        let steps = self.steps();
        let mut found = Vec::new();
        // Where each value that waits for its operator begins.
        let mut waiting: Vec<usize> = Vec::new();
        for (at, step) in steps.iter().enumerate() {
            let operation = match step {
                Step::Number(_) | Step::Variable(_) => {
                    waiting.push(at);
                    None
                }
                Step::Unary(function) => waiting.last().map(|a| Operation::Unary(*function, &steps[*a..at])),
                Step::Power(exponent) => waiting.last().map(|a| Operation::Power(&steps[*a..at], exponent)),
                Step::Binary(function) => {
                    let b = waiting.pop().unwrap_or(at);
                    waiting.last().map(|a| Operation::Binary(*function, [&steps[*a..b], &steps[b..at]]))
                }
            };
            found.extend(operation);
        }
        found
    }
}
