//! Formulas in named variables instead of t: the terms of a chain. They become expressions of the core, which evaluates and
//! differentiates them.

use forwardstep_core::expression::{Binary, Expression, ExpressionError, Step, Unary};

use super::{FormulaError, FormulaStep, MOST_STEPS};

/// The expression of steps that hold variables and no t.
///
/// ```
/// use forwardstep_core::expression::{Graph, Programme};
/// use forwardstep_sim::formula::{FormulaStep::*, expression};
/// // x0 sin x1, and its slope in x1
/// let product = expression(&[Variable(0), Variable(1), Sin, Multiply])?;
/// let mut graph = Graph::new(2);
/// let value = graph.import(&product)?;
/// let slope = graph.derivative(value, 1)?;
/// let programme = Programme::new(&graph, &[value, slope])?;
/// let mut out = [0.0; 2];
/// programme.evaluate(&[3.0, 0.0], &mut programme.registers(), &mut out)?;
/// assert_eq!(out, [0.0, 3.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`FormulaError`] when the steps do not make one value, are too many, or hold t.
pub fn expression(steps: &[FormulaStep]) -> Result<Expression, FormulaError> {
    use FormulaStep as S;
    if steps.len() > MOST_STEPS {
        return Err(FormulaError::TooLong { steps: steps.len() });
    }
    let mut made = Vec::with_capacity(steps.len());
    for step in steps {
        made.push(match *step {
            S::Number(value) => Step::Number(value),
            S::Variable(index) => Step::Variable(index),
            S::Time => return Err(FormulaError::Time),
            S::Negate => Step::Unary(Unary::Negate),
            S::Add => Step::Binary(Binary::Add),
            S::Subtract => Step::Binary(Binary::Subtract),
            S::Multiply => Step::Binary(Binary::Multiply),
            S::Divide => Step::Binary(Binary::Divide),
            S::Power(exponent) => Step::Power(exponent),
            S::Sin => Step::Unary(Unary::Sin),
            S::Cos => Step::Unary(Unary::Cos),
            S::Exp => Step::Unary(Unary::Exp),
            S::Log => Step::Unary(Unary::Log),
            S::Sqrt => Step::Unary(Unary::Sqrt),
            S::Abs => Step::Unary(Unary::Abs),
            S::Min => Step::Binary(Binary::Min),
            S::Max => Step::Binary(Binary::Max),
            S::Tanh => Step::Unary(Unary::Tanh),
            S::Atan => Step::Unary(Unary::Atan),
        });
    }
    Expression::new(made).map_err(|error| match error {
        ExpressionError::NotFinite => FormulaError::NotFinite,
        _ => FormulaError::Unbalanced,
    })
}
