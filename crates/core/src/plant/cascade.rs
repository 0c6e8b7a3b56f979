//! Parametric strict-feedback and pure-feedback chains.
//!
//! ```text
//! ẋ_i = f_i(x_1 … x_{i+1}) + φ_i(x_1 … x_{i+1})ᵀθ + w_i,  i < n
//! ẋ_n = f_n(x) + φ_n(x)ᵀθ + ψ(x) u + w_n
//! ```
//!
//! A pure-feedback chain asks for ∂(f_i + φ_iᵀθ)/∂x_{i+1} ≠ 0. A strict-feedback chain is one with f_i = x_{i+1} and φ_i
//! without x_{i+1}. w is a disturbance, none in the designs. What agents agree on, and transmit, is x_1.

use alloc::vec;
use alloc::vec::Vec;

use thiserror::Error;

use super::{Plant, check_external};
use crate::LengthError;
use crate::expression::{Expression, ExpressionError, Graph, Tape};
use crate::signal::{Block, Signal};

/// A [`Signal::Coordinate`] numbers a state.
const MOST_STATES: usize = u8::MAX as usize;

/// f, φ and ψ. Variable i, from zero, is x_{i+1}.
#[derive(Clone, Debug)]
pub struct CascadeTerms {
    known: Vec<Expression>,
    regressors: Vec<Vec<Expression>>,
    input: Expression,
    parameters: usize,
}

/// Why terms make no chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum CascadeError {
    /// No equation at all.
    #[error("a chain needs at least one equation")]
    Empty,
    /// More states than there are numbers for.
    #[error("a chain has {order} equations, but its states are numbered from 1 to {MOST_STATES}")]
    TooMany {
        /// How many there are.
        order: usize,
    },
    /// Equations that do not match.
    #[error(transparent)]
    Length(#[from] LengthError),
    /// An equation that looks too far up the chain.
    #[error("equation {equation} of the chain uses x{used}, but may use no state beyond x{most}")]
    Above {
        /// From one.
        equation: usize,
        /// The variable used, from one.
        used: usize,
        /// The last one that may be used, from one.
        most: usize,
    },
    /// An expression without meaning, or without a derivative.
    #[error(transparent)]
    Expression(#[from] ExpressionError),
}

impl CascadeTerms {
    /// A pure-feedback chain: f_1 … f_n, then φ_1 … φ_n with as many entries each as there are parameters, then ψ.
    ///
    /// # Errors
    /// [`CascadeError`] when there are more than 255 equations, the lists differ in length or an equation uses a variable further up than the next.
    pub fn new(
        known: Vec<Expression>,
        regressors: Vec<Vec<Expression>>,
        input: Expression,
    ) -> Result<Self, CascadeError> {
        let n = known.len();
        if n > MOST_STATES {
            return Err(CascadeError::TooMany { order: n });
        }
        LengthError::check("regressors of a chain", n, regressors.len())?;
        let parameters = regressors.first().ok_or(CascadeError::Empty)?.len();
        for (i, (known, regressor)) in known.iter().zip(&regressors).enumerate() {
            LengthError::check("regressor of an equation", parameters, regressor.len())?;
            let most = (i + 2).min(n);
            for expression in regressor.iter().chain([known]) {
                if expression.variables() > most {
                    return Err(CascadeError::Above { equation: i + 1, used: expression.variables(), most });
                }
            }
        }
        if input.variables() > n {
            return Err(CascadeError::Above { equation: n, used: input.variables(), most: n });
        }
        Ok(CascadeTerms { known, regressors, input, parameters })
    }

    /// A strict-feedback chain ẋ_i = x_{i+1} + φ_iᵀθ, ẋ_n = u + φ_nᵀθ.
    ///
    /// # Errors
    /// [`CascadeError`] when φ_i uses more than x_1 … x_i, or the lists differ in length.
    pub fn strict(regressors: Vec<Vec<Expression>>) -> Result<Self, CascadeError> {
        let n = regressors.len();
        for (i, regressor) in regressors.iter().enumerate() {
            for expression in regressor {
                if expression.variables() > i + 1 {
                    return Err(CascadeError::Above { equation: i + 1, used: expression.variables(), most: i + 1 });
                }
            }
        }
        let mut known: Vec<Expression> = (1..n).map(Expression::variable).collect();
        known.push(Expression::number(0.0));
        CascadeTerms::new(known, regressors, Expression::number(1.0))
    }

    /// n.
    pub fn order(&self) -> usize {
        self.known.len()
    }

    /// Entries of θ.
    pub fn parameters(&self) -> usize {
        self.parameters
    }

    /// f_1 … f_n.
    pub fn known(&self) -> &[Expression] {
        &self.known
    }

    /// φ_1 … φ_n.
    pub fn regressors(&self) -> &[Vec<Expression>] {
        &self.regressors
    }

    /// ψ.
    pub fn input(&self) -> &Expression {
        &self.input
    }

    /// Whether every equation is ẋ_i = x_{i+1} + φ_i(x_1 … x_i)ᵀθ.
    pub fn is_strict(&self) -> bool {
        let last = self.order() - 1;
        (0..last).all(|i| {
            self.known[i] == Expression::variable(i + 1)
                && self.regressors[i].iter().all(|phi| phi.variables() <= i + 1)
        })
    }
}

/// A chain with its true parameters, as a plant. State and output: x_1 … x_n. Input: u. From outside: w.
#[derive(Clone, Debug)]
pub struct Cascade {
    terms: CascadeTerms,
    theta: Vec<f64>,
    tape: Tape,
}

impl Cascade {
    /// With the true θ.
    ///
    /// # Errors
    /// [`CascadeError`] when θ has the wrong number of entries, or the terms are too large.
    pub fn new(terms: CascadeTerms, theta: Vec<f64>) -> Result<Self, CascadeError> {
        let n = terms.order();
        LengthError::check("theta", terms.parameters(), theta.len())?;
        // ẋ = rates[..n] and ψ u on the last.
        let mut graph = Graph::new(n);
        let mut outputs = Vec::with_capacity(n + 1);
        for (known, regressor) in terms.known().iter().zip(terms.regressors()) {
            let mut rate = graph.import(known)?;
            for (phi, theta) in regressor.iter().zip(&theta) {
                let phi = graph.import(phi)?;
                let term = graph.scaled(*theta, phi);
                rate = graph.plus(rate, term);
            }
            outputs.push(rate);
        }
        outputs.push(graph.import(terms.input())?);
        let tape = Tape::new(&graph, &outputs)?;
        Ok(Cascade { terms, theta, tape })
    }

    /// f, φ and ψ.
    pub fn terms(&self) -> &CascadeTerms {
        &self.terms
    }

    /// The true θ.
    pub fn theta(&self) -> &[f64] {
        &self.theta
    }
}

/// Working memory of a cascade.
#[derive(Clone, Debug)]
pub struct CascadeWork {
    workspace: Vec<f64>,
    out: Vec<f64>,
}

impl Plant for Cascade {
    type Scratch = CascadeWork;

    fn scratch(&self) -> CascadeWork {
        CascadeWork { workspace: self.tape.workspace(), out: vec![0.0; self.tape.outputs()] }
    }

    fn axes(&self) -> usize {
        1
    }

    fn states(&self) -> Vec<Block> {
        let name = |i: usize| if i == 0 { Signal::Position } else { Signal::Coordinate(i as u8 + 1) };
        (0..self.terms.order()).map(|i| (name(i), 1)).collect()
    }

    fn inputs(&self) -> Vec<Block> {
        vec![(Signal::Torque, 1)]
    }

    fn outputs(&self) -> Vec<Block> {
        self.states()
    }

    fn output_len(&self) -> usize {
        self.terms.order()
    }

    fn output(&self, _: &mut CascadeWork, state: &[f64], output: &mut [f64]) -> Result<(), LengthError> {
        LengthError::check("state", self.output_len(), state.len())?;
        LengthError::check("output", self.output_len(), output.len())?;
        output.copy_from_slice(state);
        Ok(())
    }

    fn limit(&self, _: &[f64], _: &mut [f64]) {}

    fn settle(&self, _: &mut [f64]) {}

    fn rate(
        &self,
        work: &mut CascadeWork,
        state: &[f64],
        input: &[f64],
        external: &[f64],
        d_state: &mut [f64],
    ) -> Result<(), LengthError> {
        let n = self.terms.order();
        LengthError::check("rate", n, d_state.len())?;
        LengthError::check("input", 1, input.len())?;
        check_external(n, external)?;
        self.tape.evaluate(state, &mut work.workspace, &mut work.out)?;
        d_state.copy_from_slice(&work.out[..n]);
        d_state[n - 1] += work.out[n] * input[0];
        for (rate, disturbance) in d_state.iter_mut().zip(external) {
            *rate += disturbance;
        }
        Ok(())
    }
}
