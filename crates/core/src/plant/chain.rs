//! The plant (33): d^k x/dt^k = χ(x*) + ψ(x*) u + w with x* = [x, ẋ, …, d^(k−1)x/dt^(k−1)].
//!
//! w is a disturbance, which the paper has not. χ = χ₀ + φᵀθ has a part that is known and a part that is linear in unknown parameters. There may be
//! none. What χ₀, φ and ψ are is said by [`Terms`]: closures in Rust, or [`Formulas`] that come from a file.

use alloc::vec;
use alloc::vec::Vec;
use core::fmt;

use super::{Plant, check_external};
use crate::LengthError;
use crate::expression::{Expression, ExpressionError, Graph, Tape};
use crate::signal::{Block, Signal};

/// χ₀, φ and ψ of (33).
///
/// Behind the check of lengths nothing panics, whatever the numbers.
pub trait Terms: Clone + Send + Sync + 'static {
    /// Working memory of one call.
    type Scratch: Send + Sync;

    /// Allocates it.
    fn scratch(&self) -> Self::Scratch;

    /// k, at least one.
    fn order(&self) -> usize;

    /// Entries of φ and θ.
    fn parameters(&self) -> usize;

    /// Gives χ₀ and ψ, and writes φ.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    fn terms(&self, scratch: &mut Self::Scratch, x: &[f64], phi: &mut [f64]) -> Result<(f64, f64), LengthError>;
}

/// χ₀, φ and ψ as functions in Rust.
///
/// ```
/// use forwardstep_core::plant::{Closures, Terms};
///
/// // ẍ = −x³ + θ ẋ + (2 + x²) u
/// let terms = Closures {
///     order: 2,
///     parameters: 1,
///     chi: |x: &[f64]| -x[0].powi(3),
///     phi: |x: &[f64], phi: &mut [f64]| phi[0] = x[1],
///     psi: |x: &[f64]| 2.0 + x[0] * x[0],
/// };
/// let mut phi = [0.0];
/// assert_eq!(terms.terms(&mut (), &[1.0, 3.0], &mut phi)?, (-1.0, 3.0));
/// assert_eq!(phi, [3.0]);
/// # Ok::<(), forwardstep_core::LengthError>(())
/// ```
#[derive(Clone, Copy)]
pub struct Closures<C, F, P> {
    /// k.
    pub order: usize,
    /// Entries of φ.
    pub parameters: usize,
    /// χ₀ of x*.
    pub chi: C,
    /// Writes φ of x*.
    pub phi: F,
    /// ψ of x*.
    pub psi: P,
}

impl<C, F, P> fmt::Debug for Closures<C, F, P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Closures").field("order", &self.order).field("parameters", &self.parameters).finish()
    }
}

impl<C, F, P> Terms for Closures<C, F, P>
where
    C: Fn(&[f64]) -> f64 + Clone + Send + Sync + 'static,
    F: Fn(&[f64], &mut [f64]) + Clone + Send + Sync + 'static,
    P: Fn(&[f64]) -> f64 + Clone + Send + Sync + 'static,
{
    type Scratch = ();

    fn scratch(&self) {}

    fn order(&self) -> usize {
        self.order
    }

    fn parameters(&self) -> usize {
        self.parameters
    }

    fn terms(&self, (): &mut (), x: &[f64], phi: &mut [f64]) -> Result<(f64, f64), LengthError> {
        LengthError::check("state of the chain", self.order, x.len())?;
        LengthError::check("regressor", self.parameters, phi.len())?;
        (self.phi)(x, phi);
        Ok(((self.chi)(x), (self.psi)(x)))
    }
}

/// χ₀, φ and ψ as expressions; variable r is d^r x/dt^r.
#[derive(Clone, Debug)]
pub struct Formulas {
    order: usize,
    chi: Expression,
    phi: Vec<Expression>,
    psi: Expression,
    tape: Tape,
}

impl Formulas {
    /// For a plant of order `order`.
    ///
    /// # Errors
    /// [`ExpressionError`] when one of them has a variable that does not exist.
    pub fn new(
        order: usize,
        chi: &Expression,
        phi: Vec<Expression>,
        psi: &Expression,
    ) -> Result<Self, ExpressionError> {
        let mut graph = Graph::new(order);
        let mut outputs = vec![graph.import(chi)?, graph.import(psi)?];
        for phi in &phi {
            outputs.push(graph.import(phi)?);
        }
        let tape = Tape::new(&graph, &outputs)?;
        Ok(Formulas { order, chi: chi.clone(), phi, psi: psi.clone(), tape })
    }

    /// χ₀.
    pub fn drift(&self) -> &Expression {
        &self.chi
    }

    /// ψ.
    pub fn input(&self) -> &Expression {
        &self.psi
    }

    /// φ.
    pub fn regressor(&self) -> &[Expression] {
        &self.phi
    }
}

/// Working memory of [`Formulas`].
#[derive(Clone, Debug)]
pub struct FormulasWork {
    workspace: Vec<f64>,
    out: Vec<f64>,
}

impl Terms for Formulas {
    type Scratch = FormulasWork;

    fn scratch(&self) -> FormulasWork {
        FormulasWork { workspace: self.tape.workspace(), out: vec![0.0; self.tape.outputs()] }
    }

    fn order(&self) -> usize {
        self.order
    }

    fn parameters(&self) -> usize {
        self.phi.len()
    }

    fn terms(&self, work: &mut FormulasWork, x: &[f64], phi: &mut [f64]) -> Result<(f64, f64), LengthError> {
        LengthError::check("regressor", self.phi.len(), phi.len())?;
        self.tape.evaluate(x, &mut work.workspace, &mut work.out)?;
        phi.copy_from_slice(&work.out[2..]);
        Ok((work.out[0], work.out[1]))
    }
}

/// (33) with its true parameters, as a plant. State and output: x*. Input: u. From outside: w.
#[derive(Clone, Debug)]
pub struct Chain<T> {
    /// χ₀, φ and ψ.
    pub terms: T,
    /// The true θ.
    pub theta: Vec<f64>,
}

/// Working memory of a chain.
#[derive(Clone, Debug)]
pub struct ChainWork<S> {
    pub(crate) terms: S,
    pub(crate) phi: Vec<f64>,
}

impl<T: Terms> Plant for Chain<T> {
    type Scratch = ChainWork<T::Scratch>;

    fn scratch(&self) -> Self::Scratch {
        ChainWork { terms: self.terms.scratch(), phi: vec![0.0; self.terms.parameters()] }
    }

    fn axes(&self) -> usize {
        1
    }

    fn states(&self) -> Vec<Block> {
        let name = |r: usize| match r {
            0 => Signal::Position,
            1 => Signal::Velocity,
            r => Signal::Derivative(r as u8),
        };
        (0..self.terms.order()).map(|r| (name(r), 1)).collect()
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

    fn output(&self, _: &mut Self::Scratch, state: &[f64], output: &mut [f64]) -> Result<(), LengthError> {
        LengthError::check("state", self.output_len(), state.len())?;
        LengthError::check("output", self.output_len(), output.len())?;
        output.copy_from_slice(state);
        Ok(())
    }

    fn limit(&self, _: &[f64], _: &mut [f64]) {}

    fn settle(&self, _: &mut [f64]) {}

    fn rate(
        &self,
        work: &mut Self::Scratch,
        state: &[f64],
        input: &[f64],
        external: &[f64],
        d_state: &mut [f64],
    ) -> Result<(), LengthError> {
        let k = self.terms.order();
        LengthError::check("state", k, state.len())?;
        LengthError::check("rate", k, d_state.len())?;
        LengthError::check("input", 1, input.len())?;
        check_external(1, external)?;
        LengthError::check("theta", work.phi.len(), self.theta.len())?;
        let (mut top, psi) = self.terms.terms(&mut work.terms, state, &mut work.phi)?;
        for (phi, theta) in work.phi.iter().zip(&self.theta) {
            top += phi * theta;
        }
        top += psi * input[0];
        for disturbance in external {
            top += disturbance;
        }
        if let Some((last, below)) = d_state.split_last_mut() {
            below.copy_from_slice(&state[1..]);
            *last = top;
        }
        Ok(())
    }
}
