//! A graph as straight-line code.

use alloc::vec;
use alloc::vec::Vec;

use super::graph::Op;
use super::{Binary, ExpressionError, Graph, Node, Unary};
use crate::{LengthError, Scalar};

/// Whole exponents up to this are products.
const MOST_POWER: f64 = 64.0;

/// Several values of a [`Graph`], computed together: operation i writes register i.
///
/// **Guarantees**: no allocation in [`Programme::evaluate`], the same bits on every machine.
#[derive(Clone, Debug)]
pub struct Programme {
    variables: usize,
    ops: Vec<Op>,
    outputs: Vec<Node>,
}

impl Programme {
    /// Keeps of `graph` what `outputs` need.
    ///
    /// # Errors
    /// [`ExpressionError::TooLarge`] when the graph has outgrown its limit.
    pub fn new(graph: &Graph, outputs: &[Node]) -> Result<Self, ExpressionError> {
        if graph.is_full() {
            return Err(ExpressionError::TooLarge);
        }
        let all = graph.ops();
        let mut needed = vec![false; all.len()];
        for output in outputs {
            needed[output.0] = true;
        }
        for index in (0..all.len()).rev() {
            if needed[index] {
                match all[index] {
                    Op::Number(_) | Op::Variable(_) => {}
                    Op::Unary(_, a) | Op::Power(a, _) => needed[a.0] = true,
                    Op::Binary(_, a, b) => (needed[a.0], needed[b.0]) = (true, true),
                }
            }
        }
        let (mut ops, mut place) = (Vec::new(), vec![Node(0); all.len()]);
        for (index, op) in all.iter().enumerate().filter(|(index, _)| needed[*index]) {
            place[index] = Node(ops.len());
            ops.push(match *op {
                Op::Unary(function, a) => Op::Unary(function, place[a.0]),
                Op::Power(a, exponent) => Op::Power(place[a.0], exponent),
                Op::Binary(function, a, b) => Op::Binary(function, place[a.0], place[b.0]),
                leaf => leaf,
            });
        }
        let outputs = outputs.iter().map(|node| place[node.0]).collect();
        Ok(Programme { variables: graph.variables(), ops, outputs })
    }

    /// How many variables it takes.
    pub fn variables(&self) -> usize {
        self.variables
    }

    /// How many values it gives.
    pub fn outputs(&self) -> usize {
        self.outputs.len()
    }

    /// Working memory for one evaluation.
    pub fn registers(&self) -> Vec<f64> {
        vec![0.0; self.ops.len()]
    }

    /// The values for `variables`; not-a-number or infinite where there is none.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    pub fn evaluate(&self, variables: &[f64], registers: &mut [f64], out: &mut [f64]) -> Result<(), LengthError> {
        LengthError::check("variables", self.variables, variables.len())?;
        LengthError::check("registers", self.ops.len(), registers.len())?;
        LengthError::check("values", self.outputs.len(), out.len())?;
        for (index, op) in self.ops.iter().enumerate() {
            registers[index] = match *op {
                Op::Number(value) => value,
                Op::Variable(variable) => variables[variable],
                Op::Unary(function, a) => apply(function, registers[a.0]),
                Op::Binary(function, a, b) => combine(function, registers[a.0], registers[b.0]),
                Op::Power(a, exponent) => power(registers[a.0], exponent),
            };
        }
        for (value, node) in out.iter_mut().zip(&self.outputs) {
            *value = registers[node.0];
        }
        Ok(())
    }
}

pub(super) fn apply(function: Unary, a: f64) -> f64 {
    match function {
        Unary::Negate => -a,
        Unary::Sin => Scalar::sin_cos(a).0,
        Unary::Cos => Scalar::sin_cos(a).1,
        Unary::Exp => libm::exp(a),
        Unary::Log => libm::log(a),
        Unary::Sqrt => libm::sqrt(a),
        Unary::Abs => a.abs(),
        Unary::Tanh => libm::tanh(a),
        Unary::Atan => libm::atan(a),
    }
}

pub(super) fn combine(function: Binary, a: f64, b: f64) -> f64 {
    match function {
        Binary::Add => a + b,
        Binary::Subtract => a - b,
        Binary::Multiply => a * b,
        Binary::Divide => a / b,
        // Unlike f64::min, these let not-a-number through.
        Binary::Min if b < a || b.is_nan() => b,
        Binary::Max if b > a || b.is_nan() => b,
        Binary::Min | Binary::Max => a,
    }
}

/// aᶜ; a product when c is a small whole number.
pub(super) fn power(base: f64, exponent: f64) -> f64 {
    if exponent.abs() > MOST_POWER || exponent as i32 as f64 != exponent {
        return libm::pow(base, exponent);
    }
    let (mut result, mut square, mut left) = (1.0, base, (exponent as i32).unsigned_abs());
    while left > 0 {
        if left & 1 == 1 {
            result *= square;
        }
        left >>= 1;
        if left > 0 {
            square *= square;
        }
    }
    if exponent < 0.0 { 1.0 / result } else { result }
}

#[cfg(test)]
mod tests {
    use super::super::Expression;
    use super::*;

    /// x y² + sin(x y)/(2 + cos x) + tanh(y) e^(−x) + √(1 + x²) + arctan y, and logarithms.
    fn example() -> Expression {
        let (x, y) = (Expression::variable(0), Expression::variable(1));
        let first = x.clone() * y.clone().power(2.0);
        let second = (x.clone() * y.clone()).sin_of() / (x.clone().cos_of() + 2.0);
        let third = y.clone().tanh_of() * (-x.clone()).exp_of();
        let fourth = (x.clone().power(2.0) + 1.0).power(0.5) - (y.clone() * 3.0 + 0.5);
        first + second + third + fourth
    }

    #[test]
    fn prop_derivatives_are_those_of_differences() {
        let mut graph = Graph::new(2);
        let f = graph.import(&example()).unwrap();
        let (fx, fy) = (graph.derivative(f, 0).unwrap(), graph.derivative(f, 1).unwrap());
        let fxy = graph.derivative(fx, 1).unwrap();
        let fyx = graph.derivative(fy, 0).unwrap();
        let programme = Programme::new(&graph, &[f, fx, fy, fxy, fyx]).unwrap();
        let mut registers = programme.registers();
        let mut at = |x: f64, y: f64| {
            let mut out = [0.0; 5];
            programme.evaluate(&[x, y], &mut registers, &mut out).unwrap();
            out
        };
        let h = 1e-5;
        for (x, y) in [(0.3, -1.2), (1.7, 0.4), (-0.9, 2.0)] {
            let here = at(x, y);
            let slope = |up: f64, down: f64| (up - down) / (2.0 * h);
            let (right, left, up, down) = (at(x + h, y), at(x - h, y), at(x, y + h), at(x, y - h));
            assert!((here[1] - slope(right[0], left[0])).abs() < 1e-8);
            assert!((here[2] - slope(up[0], down[0])).abs() < 1e-8);
            assert!((here[3] - slope(up[1], down[1])).abs() < 1e-8);
            assert!((here[3] - here[4]).abs() < 1e-12);
        }
    }

    #[test]
    fn what_has_no_derivative_is_an_error_where_it_varies() {
        let abs = Expression::new(alloc::vec![super::super::Step::Variable(0), super::super::Step::Unary(Unary::Abs)]);
        let mut graph = Graph::new(2);
        let f = graph.import(&abs.unwrap()).unwrap();
        assert_eq!(graph.derivative(f, 1), Ok(graph.zero()));
        assert_eq!(graph.derivative(f, 0), Err(ExpressionError::NotSmooth { function: "abs" }));
        assert_eq!(graph.derivative(f, 2), Err(ExpressionError::Variable { variable: 2, count: 2 }));
    }

    #[test]
    fn repeated_terms_are_computed_once() {
        let (x, y) = (Expression::variable(0), Expression::variable(1));
        let twice = (x.clone() * y.clone()) + (y * x);
        let mut graph = Graph::new(2);
        let f = graph.import(&twice).unwrap();
        // x, y, their product, and the sum.
        assert_eq!(Programme::new(&graph, &[f]).unwrap().registers().len(), 4);
    }
}
