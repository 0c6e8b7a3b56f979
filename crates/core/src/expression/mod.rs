//! Functions of several variables that can be evaluated and differentiated exactly: the χ, ψ and φ of a chain.
//!
//! - `mod`: an [`Expression`] as it is written, by hand in Rust or read from a file.
//! - `graph`: expressions as one graph without repetitions, and its derivatives.
//! - `programme`: a graph as straight-line code, evaluated without allocating.
//!
//! Backstepping differentiates the regressors of a chain up to one time less than its order. Differences would not be
//! exact, and numbers that carry all their derivatives grow with every variable. A graph is differentiated once, when the
//! law is built, and what is left at run time is a list of additions and products.

mod graph;
mod programme;

use alloc::vec;
use alloc::vec::Vec;
use core::ops::{Add, Div, Mul, Neg, Sub};

use thiserror::Error;

pub use graph::{Graph, Node};
pub use programme::Programme;

/// Steps that an expression may have.
pub const MOST_STEPS: usize = 1024;
/// Nodes that a graph may have.
pub const MOST_NODES: usize = 200_000;

/// One step of an expression, for a stack of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// A constant.
    Number(f64),
    /// A variable, numbered from zero.
    Variable(usize),
    /// A function of what is on top of the stack.
    Unary(Unary),
    /// A function of the two that are on top.
    Binary(Binary),
    /// The top, to a constant power.
    Power(f64),
}

/// Functions of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Unary {
    /// −a.
    Negate,
    /// sin a.
    Sin,
    /// cos a.
    Cos,
    /// eᵃ.
    Exp,
    /// The natural logarithm of a.
    Log,
    /// √a.
    Sqrt,
    /// |a|; not differentiated.
    Abs,
    /// tanh a.
    Tanh,
    /// arctan a.
    Atan,
}

/// Functions of two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Binary {
    /// a + b.
    Add,
    /// a − b.
    Subtract,
    /// a b.
    Multiply,
    /// a / b.
    Divide,
    /// The smaller; not differentiated.
    Min,
    /// The larger; not differentiated.
    Max,
}

/// Why there is no such function, derivative or programme.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum ExpressionError {
    /// An operand is missing, or values are left over.
    #[error("the steps do not make one value")]
    Unbalanced,
    /// A constant that is no number.
    #[error("a constant is not finite")]
    NotFinite,
    /// Too many steps.
    #[error("the expression has {steps} steps, but at most {MOST_STEPS} are accepted")]
    TooLong {
        /// How many there are.
        steps: usize,
    },
    /// A variable that does not exist.
    #[error("variable {variable} is used, but there are {count} only, numbered from zero")]
    Variable {
        /// The first that is too much.
        variable: usize,
        /// How many there are.
        count: usize,
    },
    /// A derivative that jumps.
    #[error("a derivative is needed, but {function} has none everywhere; use a smooth function such as tanh")]
    NotSmooth {
        /// The name of the function.
        function: &'static str,
    },
    /// The derivatives grow too large.
    #[error("with its derivatives this takes more than {MOST_NODES} operations; use fewer parameters or simpler terms")]
    TooLarge,
}

/// A function of numbered variables.
///
/// ```
/// use forwardstep_core::expression::{Expression, Graph, Programme};
///
/// let x = Expression::variable(0);
/// let f = x.clone() * x.sin_of() + 2.0;
/// let mut graph = Graph::new(1);
/// let value = graph.import(&f)?;
/// let slope = graph.derivative(value, 0)?;
/// let programme = Programme::new(&graph, &[value, slope])?;
/// let (mut registers, mut out) = (programme.registers(), [0.0; 2]);
/// programme.evaluate(&[0.0], &mut registers, &mut out)?;
/// assert_eq!(out, [2.0, 0.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    steps: Vec<Step>,
}

impl Expression {
    /// From steps, operands before operators.
    ///
    /// # Errors
    /// [`ExpressionError`] when they do not make one value, are too many, or hold a constant that is not finite.
    pub fn new(steps: Vec<Step>) -> Result<Self, ExpressionError> {
        if steps.len() > MOST_STEPS {
            return Err(ExpressionError::TooLong { steps: steps.len() });
        }
        let mut waiting = 0_usize;
        for step in &steps {
            let operands = match step {
                Step::Number(value) | Step::Power(value) if !value.is_finite() => {
                    return Err(ExpressionError::NotFinite);
                }
                Step::Number(_) | Step::Variable(_) => 0,
                Step::Unary(_) | Step::Power(_) => 1,
                Step::Binary(_) => 2,
            };
            waiting = waiting.checked_sub(operands).ok_or(ExpressionError::Unbalanced)? + 1;
        }
        if waiting == 1 { Ok(Expression { steps }) } else { Err(ExpressionError::Unbalanced) }
    }

    /// Its steps.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// Variable `index`, from zero.
    pub fn variable(index: usize) -> Self {
        Expression { steps: vec![Step::Variable(index)] }
    }

    /// A constant.
    pub fn number(value: f64) -> Self {
        Expression { steps: vec![Step::Number(value)] }
    }

    /// Whether variable `index` is in it.
    pub fn has(&self, index: usize) -> bool {
        self.steps.contains(&Step::Variable(index))
    }

    /// The largest number of a variable, and one; zero for a constant.
    pub fn variables(&self) -> usize {
        let numbers = self.steps.iter().map(|step| if let Step::Variable(index) = step { index + 1 } else { 0 });
        numbers.max().unwrap_or(0)
    }

    fn then(mut self, step: Step) -> Self {
        self.steps.push(step);
        self
    }

    /// To a constant power.
    #[must_use]
    pub fn power(self, exponent: f64) -> Self {
        self.then(Step::Power(exponent))
    }

    /// Its sine.
    #[must_use]
    pub fn sin_of(self) -> Self {
        self.then(Step::Unary(Unary::Sin))
    }

    /// Its cosine.
    #[must_use]
    pub fn cos_of(self) -> Self {
        self.then(Step::Unary(Unary::Cos))
    }

    /// Its hyperbolic tangent.
    #[must_use]
    pub fn tanh_of(self) -> Self {
        self.then(Step::Unary(Unary::Tanh))
    }

    /// e to it.
    #[must_use]
    pub fn exp_of(self) -> Self {
        self.then(Step::Unary(Unary::Exp))
    }
}

impl From<f64> for Expression {
    fn from(value: f64) -> Self {
        Expression::number(value)
    }
}

impl Neg for Expression {
    type Output = Self;
    fn neg(self) -> Self {
        self.then(Step::Unary(Unary::Negate))
    }
}

macro_rules! binary {
    ($($operator:ident :: $method:ident = $step:ident),+) => {$(
        impl<E: Into<Expression>> $operator<E> for Expression {
            type Output = Self;
            fn $method(mut self, other: E) -> Self {
                self.steps.extend(other.into().steps);
                self.then(Step::Binary(Binary::$step))
            }
        }
    )+};
}
binary!(Add::add = Add, Sub::sub = Subtract, Mul::mul = Multiply, Div::div = Divide);
