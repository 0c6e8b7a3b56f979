//! The steps of adaptive backstepping in the shape that is evaluated faster.
//!
//! Two shapes compute the same numbers up to rounding: a tape of the graph of all derivatives (`steps`), and operations on truncated power
//! series (`steps_in_series`). Measured once, on one core of a machine with other work, for a strict-feedback chain with two parameters and
//! two functions of one or two states in every equation; empty where no tape was made:
//!
//! | order | operations of the tape | μs | multiplications of the series | μs |
//! |---|---|---|---|---|
//! | 2 | 60 | 0.17 | 56 | 0.45 |
//! | 3 | 206 | 0.53 | 191 | 0.89 |
//! | 4 | 798 | 1.7 | 598 | 1.4 |
//! | 5 | 3413 | 12 | 1829 | 2.9 |
//! | 6 | 17630 | 63 | 5448 | 6.6 |
//! | 7 | 107019 | 400 | 15953 | 15 |
//! | 8 | | | 46251 | 35 |
//! | 9 | | | 132475 | 90 |
//! | 10 | | | 374329 | 260 |
//!
//! The tape grows by 4 to 6 with every order and the series by 3. What the series would take is counted before a graph is made, and the
//! tape is taken up to [`FEW_PRODUCTS`].

use alloc::vec;
use alloc::vec::Vec;

use super::interior::Metric;
use super::steps::Steps;
use super::steps_in_series::SeriesSteps;
use crate::LengthError;
use crate::expression::{ExpressionError, Tape};
use crate::plant::CascadeTerms;

/// Up to so many multiplications of the series the tape is faster, or slower by a quarter at most, and runs of low order keep their bits.
const FEW_PRODUCTS: u64 = 700;

/// How u and θ̂' are computed. Given: x_1 … x_n, θ̂, y, ẏ, …, y^(n).
#[derive(Clone, Debug)]
pub(super) struct Recursion {
    order: usize,
    parameters: usize,
    shape: Shape,
}

#[derive(Clone, Debug)]
enum Shape {
    Tape {
        /// u, its factor, e, θ̂'.
        law: Tape,
        /// Σ_j e_j ∂e_j/∂x_i, an entry per equation: what V gains from a disturbance of it.
        slopes: Tape,
    },
    Series(SeriesSteps),
}

/// Working memory of [`Recursion`].
#[derive(Clone, Debug)]
pub(super) struct RecursionWork {
    /// What is given.
    pub(super) given: Vec<f64>,
    law: Vec<f64>,
    slopes: Vec<f64>,
    out: Vec<f64>,
}

/// What the last step gives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stepped<'a> {
    /// u.
    pub(super) input: f64,
    /// ∂e_n/∂x_n ψ.
    pub(super) divisor: f64,
    /// e_1 … e_n.
    pub(super) errors: &'a [f64],
    /// Γ τ_n: θ̂', or ξ' of `interior`.
    pub(super) d_theta_hat: &'a [f64],
}

impl Recursion {
    /// For a chain, with c_1 … c_n and the diagonal of Γ, or Γ(θ̂).
    ///
    /// # Errors
    /// [`ExpressionError`] when a term that must be differentiated has no derivative, or it takes too many multiplications.
    pub(super) fn new(terms: &CascadeTerms, gains: &[f64], gamma: Metric<'_>) -> Result<Self, ExpressionError> {
        let (order, parameters) = (terms.order(), terms.parameters());
        let series = SeriesSteps::new(terms, gains, gamma)?;
        let shape = if series.products() > FEW_PRODUCTS {
            Shape::Series(series)
        } else {
            match tape(terms, gains, gamma) {
                // Terms that are simple as series and not as they are written.
                Err(ExpressionError::TooLarge) => Shape::Series(series),
                shape => shape?,
            }
        };
        Ok(Recursion { order, parameters, shape })
    }

    /// Working memory for one evaluation.
    pub(super) fn work(&self) -> RecursionWork {
        let (n, p) = (self.order, self.parameters);
        let (law, slopes, outputs) = match &self.shape {
            Shape::Tape { law, slopes } => (law.workspace(), slopes.workspace(), law.outputs().max(slopes.outputs())),
            Shape::Series(series) => (series.workspace(), Vec::new(), series.outputs()),
        };
        RecursionWork { given: vec![0.0; 2 * n + p + 1], law, slopes, out: vec![0.0; outputs] }
    }

    /// The law.
    ///
    /// # Errors
    /// [`LengthError`] when the working memory is that of another one.
    pub(super) fn evaluate<'a>(&self, work: &'a mut RecursionWork) -> Result<Stepped<'a>, LengthError> {
        let (n, p) = (self.order, self.parameters);
        let RecursionWork { given, law: workspace, out, .. } = work;
        match &self.shape {
            Shape::Tape { law, .. } => law.evaluate(given, workspace, out.get_mut(..2 + n + p).unwrap_or_default())?,
            Shape::Series(series) => series.evaluate(given, workspace, out)?,
        }
        LengthError::check("values", (2 + n + p).max(out.len()), out.len())?;
        let (errors, d_theta_hat) = (&out[2..2 + n], &out[2 + n..2 + n + p]);
        Ok(Stepped { input: out[0], divisor: out[1], errors, d_theta_hat })
    }

    /// Σ_j e_j ∂e_j/∂x_i, an entry per equation.
    ///
    /// # Errors
    /// [`LengthError`] when the working memory is that of another one.
    pub(super) fn slopes<'a>(&self, work: &'a mut RecursionWork) -> Result<&'a [f64], LengthError> {
        let (n, p) = (self.order, self.parameters);
        let RecursionWork { given, law, slopes: workspace, out } = work;
        match &self.shape {
            Shape::Tape { slopes, .. } => {
                let out = out.get_mut(..n).unwrap_or_default();
                slopes.evaluate(given, workspace, out)?;
                Ok(out)
            }
            Shape::Series(series) => {
                series.evaluate(given, law, out)?;
                Ok(&out[2 + n + p..][..n])
            }
        }
    }
}

/// Both tapes.
fn tape(terms: &CascadeTerms, gains: &[f64], gamma: Metric<'_>) -> Result<Shape, ExpressionError> {
    let Steps { mut graph, input, divisor, errors, d_theta_hat } = Steps::new(terms, gains, gamma)?;
    let mut outputs = vec![input, divisor];
    outputs.extend(&errors);
    outputs.extend(d_theta_hat);
    let law = Tape::new(&graph, &outputs)?;
    let mut sums = Vec::with_capacity(terms.order());
    for i in 0..terms.order() {
        let slopes = errors.iter().map(|e| graph.derivative(*e, i)).collect::<Result<Vec<_>, _>>()?;
        sums.push(graph.dot(&slopes, &errors));
    }
    Ok(Shape::Tape { law, slopes: Tape::new(&graph, &sums)? })
}
