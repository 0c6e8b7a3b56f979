//! Functions of several variables as they are written: formulas in t, and the χ, ψ and φ of a chain.
//!
//! An [`Expression`] has one meaning and one [`fold`](Expression::fold); what it is folded into is an [`Algebra`]:
//!
//! - `float`: a value in `f64`;
//! - `interval`: what it keeps within, rounded outwards;
//! - `exact`: the same with rational ends, so that 0.1 + 0.2 − 0.3 is zero;
//! - `jet`: derivatives over either of the first two;
//! - `graph`: a graph without repetitions, differentiated as often as needed, and compiled to a `tape`;
//! - `series`: truncated power series in several variables, laid out in advance as a list of multiplications;
//! - `uniform`: which way it goes, and whether it is uniformly continuous;
//! - `tail`: a sum of powers and logarithms with enclosed coefficients, which tells what it does from some time on;
//! - `period`: whether it is made of waves with a common period.
//!
//! `bounds` cuts intervals until bounds are tight, `for_ever` says what becomes of it on [0, ∞), `domain` where it has a value, `kinks` finds where |a|, min and max change branches, and `number` keeps
//! constants as they were written.
//!
//! Backstepping differentiates the regressors of a chain up to one time less than its order. Differences would not be
//! exact. For low orders a graph is differentiated once, when the law is built, and what is left at run time is a list of additions and
//! products. For high orders the graph of all derivatives grows faster than the numbers that carry them: `series`.

mod bounds;
mod domain;
mod exact;
mod float;
mod for_ever;
mod graph;
mod interval;
mod jet;
mod kinks;
mod number;
mod operation;
mod period;
mod same;
mod series;
mod tail;
mod tape;
mod uniform;

use alloc::vec;
use alloc::vec::Vec;
use core::ops::{Add, Div, Mul, Neg, Sub};

use thiserror::Error;

pub use bounds::{search, weighted};
pub use domain::{Domain, Gap};
pub use float::Floats;
pub use for_ever::ForEver;
pub use graph::{Graph, Node};
pub use interval::{Interval, Intervals};
pub use jet::{Branch, Branching, MOST_DERIVATIVES, Taylor};
pub use kinks::{KinkError, MOST_KINKS, Switch, bisect};
pub use number::{MOST_DIGITS, Number};
use series::MOST_PRODUCTS;
pub(crate) use series::{Program, Register, Series, Term};
pub use tape::Tape;

/// Steps that an expression may have: some 2 μs for a value of it, which is asked for at every stage of every step, and sums of 256 terms,
/// which is how deep the checker of certificates goes.
pub const MOST_STEPS: usize = 512;
/// Values that may wait at once for their operator without memory being allocated.
pub const MOST_WAITING: usize = 32;
/// Nodes that a graph may have: some 0.8 ms for an evaluation, by what half as many were measured to take.
pub const MOST_NODES: usize = 200_000;

/// One step of an expression, for a stack of values.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// A constant.
    Number(Number),
    /// A variable, numbered from zero.
    Variable(usize),
    /// A function of what is on top of the stack.
    Unary(Unary),
    /// A function of the two that are on top.
    Binary(Binary),
    /// The top, to a constant power; it must not be negative unless the power is a whole number.
    Power(Number),
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
    /// |a|.
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
    /// The smaller.
    Min,
    /// The larger.
    Max,
}

/// Why there is no such function, derivative or tape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum ExpressionError {
    /// An operand is missing, or values are left over.
    #[error("the steps do not make one value")]
    Unbalanced,
    /// A constant that is no number.
    #[error("a constant is not finite")]
    NotFinite,
    /// Too many steps.
    #[error(
        "the expression has {steps} steps, but a value of more than {MOST_STEPS} takes more than 2 μs at every stage of every step"
    )]
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
    /// The series of a design take too long.
    #[error(
        "with its derivatives one evaluation of the law takes more than {} million multiplications, about 5 ms, and {} MB; every \
         equation less divides that by three: use fewer equations or parameters, or regressors of fewer states",
        MOST_PRODUCTS / 1_000_000,
        MOST_PRODUCTS * 4 / 1_000_000
    )]
    TooCostly,
    /// The derivatives grow too large.
    #[error(
        "with its derivatives this takes more than {MOST_NODES} operations, about 0.8 ms for each evaluation; use fewer parameters or simpler terms"
    )]
    TooLarge,
}

/// What an expression can be folded into: a method for every kind of step.
pub trait Algebra {
    /// What stands for a sub-expression.
    type Value: Clone;

    /// A constant.
    fn number(&mut self, number: &Number) -> Self::Value;
    /// A variable.
    fn variable(&mut self, index: usize) -> Self::Value;
    /// A function of one value.
    fn unary(&mut self, function: Unary, a: Self::Value) -> Self::Value;
    /// A function of two values.
    fn binary(&mut self, function: Binary, a: Self::Value, b: Self::Value) -> Self::Value;
    /// A constant power.
    fn power(&mut self, a: Self::Value, exponent: &Number) -> Self::Value;
}

/// A function of numbered variables.
///
/// ```
/// use forwardstep_core::expression::{Expression, Graph, Tape};
///
/// let x = Expression::variable(0);
/// let f = x.clone() * x.sin_of() + 2.0;
/// let mut graph = Graph::new(1);
/// let value = graph.import(&f)?;
/// let slope = graph.derivative(value, 0)?;
/// let tape = Tape::new(&graph, &[value, slope])?;
/// let (mut workspace, mut out) = (tape.workspace(), [0.0; 2]);
/// tape.evaluate(&[0.0], &mut workspace, &mut out)?;
/// assert_eq!(out, [2.0, 0.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// One in a single variable, such as a formula in t, is also evaluated by itself, with derivatives, and enclosed:
///
/// ```
/// # use forwardstep_core::expression::Expression;
/// let formula = Expression::variable(0).sin_of() * 0.1 + 0.2;
/// assert_eq!(formula.eval(0.0), 0.2);
/// assert_eq!(formula.jet(0.0)[1], 0.1);
/// let bounds = formula.bounds(0.0, f64::INFINITY);
/// assert!(bounds.low >= 0.1 - 1e-12 && bounds.high <= 0.3 + 1e-12);
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
                Step::Number(number) | Step::Power(number) if !number.value().is_finite() => {
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

    /// The expression as `algebra` has it. Allocates only where more than [`MOST_WAITING`] values wait, or the algebra does.
    pub fn fold<A: Algebra>(&self, algebra: &mut A) -> A::Value {
        let mut stack = Stack { few: [const { None }; MOST_WAITING], count: 0, more: Vec::new() };
        for step in &self.steps {
            let value = match step {
                Step::Number(number) => algebra.number(number),
                Step::Variable(index) => algebra.variable(*index),
                Step::Unary(function) => match stack.pop() {
                    Some(a) => algebra.unary(*function, a),
                    None => continue,
                },
                Step::Power(exponent) => match stack.pop() {
                    Some(a) => algebra.power(a, exponent),
                    None => continue,
                },
                Step::Binary(function) => match (stack.pop(), stack.pop()) {
                    (Some(b), Some(a)) => algebra.binary(*function, a, b),
                    _ => continue,
                },
            };
            stack.push(value);
        }
        // Every constructor leaves one value, and no step without its operands.
        stack.pop().unwrap_or_else(|| algebra.number(&f64::NAN.into()))
    }

    /// Its value for these variables; not-a-number or infinite where there is none.
    pub fn value(&self, variables: &[f64]) -> f64 {
        self.fold(&mut Floats::new(variables))
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
    pub fn number(number: impl Into<Number>) -> Self {
        Expression { steps: vec![Step::Number(number.into())] }
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

    /// This as the operand of `function`.
    #[must_use]
    pub fn under(self, function: Unary) -> Self {
        self.then(Step::Unary(function))
    }

    /// To a constant power.
    #[must_use]
    pub fn power(self, exponent: impl Into<Number>) -> Self {
        self.then(Step::Power(exponent.into()))
    }
}

/// The values that wait for their operator, the first of them without allocating.
struct Stack<V> {
    few: [Option<V>; MOST_WAITING],
    count: usize,
    more: Vec<V>,
}

impl<V> Stack<V> {
    fn push(&mut self, value: V) {
        match self.few.get_mut(self.count) {
            Some(place) => *place = Some(value),
            None => self.more.push(value),
        }
        self.count += 1;
    }

    fn pop(&mut self) -> Option<V> {
        self.count = self.count.checked_sub(1)?;
        self.more.pop().or_else(|| self.few.get_mut(self.count)?.take())
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

macro_rules! functions {
    ($($method:ident = $step:ident, $words:literal);+) => {
        impl Expression {$(
            #[doc = $words]
            #[must_use]
            pub fn $method(self) -> Self {
                self.then(Step::Unary(Unary::$step))
            }
        )+}
    };
}
functions!(
    sin_of = Sin, "Its sine.";
    cos_of = Cos, "Its cosine.";
    exp_of = Exp, "e to it.";
    log_of = Log, "Its natural logarithm.";
    sqrt_of = Sqrt, "Its square root.";
    abs_of = Abs, "Its size.";
    tanh_of = Tanh, "Its hyperbolic tangent.";
    atan_of = Atan, "Its arc tangent."
);

macro_rules! binary {
    ($($operator:ident :: $method:ident = $step:ident),+) => {$(
        impl<E: Into<Expression>> $operator<E> for Expression {
            type Output = Self;
            fn $method(self, other: E) -> Self {
                self.with(other, Binary::$step)
            }
        }
    )+};
}
binary!(Add::add = Add, Sub::sub = Subtract, Mul::mul = Multiply, Div::div = Divide);

impl Expression {
    /// This and `other`, in this order, as the operands of `function`.
    #[must_use]
    pub fn with(mut self, other: impl Into<Expression>, function: Binary) -> Self {
        self.steps.extend(other.into().steps);
        self.then(Step::Binary(function))
    }

    /// The smaller of the two.
    #[must_use]
    pub fn smaller(self, other: impl Into<Expression>) -> Self {
        self.with(other, Binary::Min)
    }

    /// The larger of the two.
    #[must_use]
    pub fn larger(self, other: impl Into<Expression>) -> Self {
        self.with(other, Binary::Max)
    }
}
