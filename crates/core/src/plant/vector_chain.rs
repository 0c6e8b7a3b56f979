//! The plant (33) with several axes: x ∈ ℝᵐ, d^k x/dt^k = χ(x*) + ψ(x*) u + w with u, w ∈ ℝᵐ and a matrix ψ ∈ ℝ^(m×m), where
//! x* = [x, ẋ, …, d^(k−1)x/dt^(k−1)] ∈ ℝ^(km).
//!
//! The paper has one axis. χ = χ₀ + Y θ has a part that is known and a part that is linear in unknown parameters; Y ∈ ℝ^(m×p)
//! has a row for each axis. Any term may hold any entry of x*, so that the axes pull at each other.

use alloc::vec;
use alloc::vec::Vec;

use super::{CascadeError, Plant, check_external};
use crate::LengthError;
use crate::expression::{Expression, Graph, Tape};
use crate::signal::{Block, Signal};

/// χ₀, Y and ψ as expressions; variable r m + i is entry i of d^r x/dt^r.
///
/// ```
/// use forwardstep_core::expression::Expression;
/// use forwardstep_core::plant::VectorFormulas;
///
/// // ẋ₁ = x₂ + u₁ and ẋ₂ = θ x₁ + u₁ + 2 u₂
/// let (x, number) = (Expression::variable, Expression::number);
/// let chi = vec![x(1), number(0.0)];
/// let regressor = vec![vec![number(0.0)], vec![x(0)]];
/// let psi = vec![vec![number(1.0), number(0.0)], vec![number(1.0), number(2.0)]];
/// let terms = VectorFormulas::new(1, chi, regressor, psi)?;
/// let mut work = terms.work();
/// terms.terms(&mut work, &[3.0, 4.0])?;
/// assert_eq!((work.chi(), work.psi(), work.regressor()), (&[4.0, 0.0][..], &[1.0, 0.0, 1.0, 2.0][..], &[0.0, 3.0][..]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct VectorFormulas {
    order: usize,
    /// p.
    parameters: usize,
    chi: Vec<Expression>,
    regressor: Vec<Vec<Expression>>,
    psi: Vec<Vec<Expression>>,
    tape: Tape,
}

impl VectorFormulas {
    /// For a plant of order `order` with as many axes as `chi` has entries.
    ///
    /// # Errors
    /// [`CascadeError`] when there is no axis or no order, ψ is not square, Y has not a row for each axis or rows that differ in length, or
    /// one of them has a variable that does not exist.
    pub fn new(
        order: usize,
        chi: Vec<Expression>,
        regressor: Vec<Vec<Expression>>,
        psi: Vec<Vec<Expression>>,
    ) -> Result<Self, CascadeError> {
        let axes = chi.len();
        if axes == 0 || order == 0 {
            return Err(CascadeError::Empty);
        }
        let parameters = regressor.first().map_or(0, Vec::len);
        LengthError::check("rows of psi", axes, psi.len())?;
        LengthError::check("rows of the regressor", axes, regressor.len())?;
        for (psi, regressor) in psi.iter().zip(&regressor) {
            LengthError::check("columns of psi", axes, psi.len())?;
            LengthError::check("columns of the regressor", parameters, regressor.len())?;
        }
        let mut graph = Graph::new(order * axes);
        let mut outputs = Vec::with_capacity(axes * (1 + axes + parameters));
        for term in chi.iter().chain(psi.iter().flatten()).chain(regressor.iter().flatten()) {
            outputs.push(graph.import(term)?);
        }
        let tape = Tape::new(&graph, &outputs)?;
        Ok(VectorFormulas { order, parameters, chi, regressor, psi, tape })
    }

    /// k.
    pub fn order(&self) -> usize {
        self.order
    }

    /// m.
    pub fn axes(&self) -> usize {
        self.chi.len()
    }

    /// p, the entries of θ.
    pub fn parameters(&self) -> usize {
        self.parameters
    }

    /// χ₀, an entry per axis.
    pub fn drift(&self) -> &[Expression] {
        &self.chi
    }

    /// ψ, row by row.
    pub fn input(&self) -> &[Vec<Expression>] {
        &self.psi
    }

    /// Y, row by row.
    pub fn regressor(&self) -> &[Vec<Expression>] {
        &self.regressor
    }

    /// Room for one call of [`VectorFormulas::terms`].
    pub fn work(&self) -> VectorFormulasWork {
        let (workspace, out) = (self.tape.workspace(), vec![0.0; self.tape.outputs()]);
        VectorFormulasWork { workspace, out, axes: self.axes() }
    }

    /// The terms at `x`, into the working memory.
    ///
    /// # Errors
    /// [`LengthError`] when `x` is not x*, of k m entries.
    pub fn terms(&self, work: &mut VectorFormulasWork, x: &[f64]) -> Result<(), LengthError> {
        self.tape.evaluate(x, &mut work.workspace, &mut work.out)
    }
}

/// The terms at one state.
#[derive(Clone, Debug)]
pub struct VectorFormulasWork {
    workspace: Vec<f64>,
    /// χ₀, then ψ row by row, then Y row by row.
    out: Vec<f64>,
    axes: usize,
}

impl VectorFormulasWork {
    /// χ₀, m entries.
    pub fn chi(&self) -> &[f64] {
        &self.out[..self.axes]
    }

    /// ψ row by row, m × m entries.
    pub fn psi(&self) -> &[f64] {
        &self.out[self.axes..self.axes * (1 + self.axes)]
    }

    /// Y row by row, m × p entries.
    pub fn regressor(&self) -> &[f64] {
        &self.out[self.axes * (1 + self.axes)..]
    }

    /// Adds χ₀ + Y θ to `sum`.
    pub(crate) fn add_drift(&self, theta: &[f64], sum: &mut [f64]) {
        for (axis, (sum, chi)) in sum.iter_mut().zip(self.chi()).enumerate() {
            *sum += chi;
            let row = self.regressor().iter().skip(axis * theta.len());
            for (entry, theta) in row.zip(theta) {
                *sum += entry * theta;
            }
        }
    }
}

/// (33) with several axes and its true parameters, as a plant. State and output: x*. Input: u. From outside: w.
#[derive(Clone, Debug)]
pub struct VectorChain {
    /// χ₀, Y and ψ.
    pub terms: VectorFormulas,
    /// The true θ.
    pub theta: Vec<f64>,
}

impl Plant for VectorChain {
    type Scratch = VectorFormulasWork;

    fn scratch(&self) -> VectorFormulasWork {
        self.terms.work()
    }

    fn axes(&self) -> usize {
        self.terms.axes()
    }

    fn states(&self) -> Vec<Block> {
        let name = |r: usize| match r {
            0 => Signal::Position,
            1 => Signal::Velocity,
            r => Signal::Derivative(r as u8),
        };
        (0..self.terms.order).map(|r| (name(r), self.terms.axes())).collect()
    }

    fn inputs(&self) -> Vec<Block> {
        vec![(Signal::Torque, self.terms.axes())]
    }

    fn outputs(&self) -> Vec<Block> {
        self.states()
    }

    fn output_len(&self) -> usize {
        self.terms.order * self.terms.axes()
    }

    fn output(&self, _: &mut VectorFormulasWork, state: &[f64], output: &mut [f64]) -> Result<(), LengthError> {
        LengthError::check("state", self.output_len(), state.len())?;
        LengthError::check("output", self.output_len(), output.len())?;
        output.copy_from_slice(state);
        Ok(())
    }

    fn limit(&self, _: &[f64], _: &mut [f64]) {}

    fn settle(&self, _: &mut [f64]) {}

    fn rate(
        &self,
        work: &mut VectorFormulasWork,
        state: &[f64],
        input: &[f64],
        external: &[f64],
        d_state: &mut [f64],
    ) -> Result<(), LengthError> {
        let (m, len) = (self.terms.axes(), self.output_len());
        LengthError::check("state", len, state.len())?;
        LengthError::check("rate", len, d_state.len())?;
        LengthError::check("input", m, input.len())?;
        LengthError::check("theta", self.terms.parameters, self.theta.len())?;
        check_external(m, external)?;
        self.terms.terms(work, state)?;
        let Some(top) = len.checked_sub(m) else { return Ok(()) };
        d_state[..top].copy_from_slice(&state[m..]);
        let top = &mut d_state[top..];
        top.fill(0.0);
        work.add_drift(&self.theta, top);
        for (axis, top) in top.iter_mut().enumerate() {
            for (psi, u) in work.psi()[axis * m..].iter().zip(input) {
                *top += psi * u;
            }
            *top += external.get(axis).copied().unwrap_or(0.0);
        }
        Ok(())
    }
}
