//! A graph as a tape: straight-line code with a workspace.

use alloc::vec;
use alloc::vec::Vec;

use super::float::{apply, combine, power};
use super::graph::Op;
use super::interval::{Interval, Intervals};
use super::{Algebra, ExpressionError, Graph, Node, Number};
use crate::LengthError;

/// Several values of a [`Graph`], computed together: operation i writes entry i of the workspace.
///
/// **Guarantees**: no allocation in [`Tape::evaluate`], the same bits on every machine.
#[derive(Clone, Debug)]
pub struct Tape {
    variables: usize,
    ops: Vec<Op>,
    outputs: Vec<Node>,
}

impl Tape {
    /// Keeps of `graph` what `outputs` need.
    ///
    /// # Errors
    /// [`ExpressionError::TooLarge`] when the graph has outgrown its limit.
    pub fn new(graph: &Graph, outputs: &[Node]) -> Result<Self, ExpressionError> {
        if graph.is_full() {
            return Err(ExpressionError::TooLarge);
        }
        let (mut ops, mut place) = (Vec::new(), vec![Node(0); graph.ops().len()]);
        for node in graph.below(outputs) {
            place[node.0] = Node(ops.len());
            ops.push(graph.ops()[node.0].moved(&place));
        }
        let outputs = outputs.iter().map(|node| place[node.0]).collect();
        Ok(Tape { variables: graph.variables(), ops, outputs })
    }

    /// How many variables it takes.
    pub fn variables(&self) -> usize {
        self.variables
    }

    /// How many values it gives.
    pub fn outputs(&self) -> usize {
        self.outputs.len()
    }

    /// How many numbers of working memory one evaluation takes.
    pub fn steps(&self) -> usize {
        self.ops.len()
    }

    /// Working memory for one evaluation.
    pub fn workspace(&self) -> Vec<f64> {
        vec![0.0; self.ops.len()]
    }

    /// The values for `variables`; not-a-number or infinite where there is none.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    pub fn evaluate(&self, variables: &[f64], workspace: &mut [f64], out: &mut [f64]) -> Result<(), LengthError> {
        LengthError::check("variables", self.variables, variables.len())?;
        self.evaluate_at(|variable| variables[variable], workspace, out)
    }

    /// The same where variable `v` is `variables(v)`.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    #[inline(always)]
    pub fn evaluate_at(
        &self,
        variables: impl Fn(usize) -> f64,
        workspace: &mut [f64],
        out: &mut [f64],
    ) -> Result<(), LengthError> {
        LengthError::check("workspace", self.ops.len(), workspace.len())?;
        LengthError::check("values", self.outputs.len(), out.len())?;
        for (index, op) in self.ops.iter().enumerate() {
            workspace[index] = match *op {
                Op::Number(bits) => f64::from_bits(bits),
                Op::Variable(variable) => variables(variable),
                Op::Unary(function, a) => apply(function, workspace[a.0]),
                Op::Binary(function, a, b) => combine(function, workspace[a.0], workspace[b.0]),
                Op::Power(a, exponent) => power(workspace[a.0], f64::from_bits(exponent)),
            };
        }
        for (value, node) in out.iter_mut().zip(&self.outputs) {
            *value = workspace[node.0];
        }
        Ok(())
    }

    /// Intervals that hold the values for `variables`, with room for what the constants were before they were rounded to `f64`.
    ///
    /// # Errors
    /// [`LengthError`] when `variables` has the wrong length.
    pub fn enclose(&self, variables: &[f64]) -> Result<Vec<Interval>, LengthError> {
        LengthError::check("variables", self.variables, variables.len())?;
        let points: Vec<Interval> = variables.iter().map(|x| Interval::point(*x)).collect();
        let (mut algebra, mut found) = (Intervals(&points), Vec::<Interval>::with_capacity(self.ops.len()));
        for op in &self.ops {
            let value = match *op {
                Op::Number(bits) => around(f64::from_bits(bits)),
                Op::Variable(variable) => algebra.variable(variable),
                Op::Unary(function, a) => algebra.unary(function, found[a.0]),
                Op::Binary(function, a, b) => algebra.binary(function, found[a.0], found[b.0]),
                Op::Power(a, exponent) => algebra.power(found[a.0], &Number::from(f64::from_bits(exponent))),
            };
            found.push(value);
        }
        Ok(self.outputs.iter().map(|node| found[node.0].or_whole()).collect())
    }
}

/// What a few operations on constants round to this number; whole numbers are taken as they are.
fn around(value: f64) -> Interval {
    let room = if libm::trunc(value) == value { 0.0 } else { 1e-15 * value.abs() };
    Interval::point(value).with_room(room)
}
