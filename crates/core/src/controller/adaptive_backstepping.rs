//! Forwardstepping and backstepping together: consensus of parametric chains, as Section IV-A names it and does not print.
//!
//! The parameters are unknown and enter every equation of the chain, so derivatives of x_1 are not known, and z cannot follow
//! one of them. It follows x_1 itself. In the terms of (33)–(43) that is k = 1: the variable that z follows is
//! d^(k−1)x_1/dt^(k−1) = x_1, and ℓ ≥ n differentiators are added to it.
//!
//! ```text
//! z^(ℓ) = −Σ_{r≥1} α_{r−1} z^(r) − Σ_j w_ij [α₀ x_1 + Σ_{r≥1} α_r z^(r) − α₀ x_{1,j}(t−T_ij)]      the guide of order k = 1
//! s = x_1 − z
//! u, θ̂': the steps of `steps`, with y = z, ẏ = ż, …, y^(n) = z^(n)
//! ```
//!
//! z, …, z^(ℓ−1) are states and z^(ℓ) is what the dynamics give, so all that backstepping differentiates is known without
//! differentiating anything that was heard, neither the weights nor the delays. u is continuous through switches and jumps of
//! the delays for ℓ > n; for ℓ = n it jumps with z^(n) and stays bounded.
//!
//! **Why the interconnection is as in (43).** The first line of (43), x_1^(ℓ) = z^(ℓ) + s^(ℓ), has the interconnection F = s^(ℓ)
//! and the degree ℓ. In z, …, z^(ℓ−1) it becomes (24) for x_1 = z + s,
//!
//! ```text
//! z^(ℓ) = (24) in z − α₀ Σ_j w_ij (s_i − s_j(t−T_ij))
//! ```
//!
//! which has the degree zero: no derivative of s is left. The second line is V̇ = −Σ c_i e_i² with e_1 = s, whatever z
//! does, so e and θ̂ are bounded and e is square-integrable. Then (24) has bounded inputs, and differences of z between agents
//! and all derivatives of z are bounded. Where the regressors and their derivatives are bounded along the run, ė is bounded
//! and e → 0. So the inputs of (24) vanish, and with them the differences and derivatives of z: x_1 of all agents agree and
//! come to rest. (Vanishing inputs are all that is used: s_j(t−T_ij) need not be square-integrable where a delay jumps.)
//!
//! Regressors are bounded along the run if x_1 is, or if their functions are (sin, tanh). Vanishing inputs alone do not exclude
//! that all agents drift together without bound, ever more slowly.
//!
//! Tracking is the same with Σ α_r of the guide for tracking.
//!
//! **Disturbances.** w_i in the equation of x_i adds Σ_j e_j ∂e_j/∂x_i w_i to V̇. For the last equation of a strict-feedback chain
//! that is e_n w_n, and V stays finite under a bounded w_n. Slopes of earlier steps may grow with the state.
//!
//! **Bounds** of θ̂ take a gain Γ(θ̂) that vanishes there; `interior` derives why, and why a projection is not admissible.

use alloc::vec::Vec;

use super::following::{ChainError, ChainMeasured, positive, vanishes};
use super::interior::{Interior, Metric};
use super::recursion::{Recursion, RecursionWork, Stepped};
use super::reference_model::{ReferenceModel, ReferenceModelError, ReferenceModelInput, ReferenceModelWork};
use super::{Balance, Controller, ControllerInput, ControllerOutput, Jets, Singularity, Truth};
use crate::LengthError;
use crate::law::{ParameterBounds, Range};
use crate::plant::{Cascade, CascadeTerms};
use crate::reference::Position;
use crate::signal::{Block, Signal};

/// Adaptive backstepping for strict-feedback and pure-feedback chains, led by reference dynamics.
///
/// State: z, ż, …, z^(ℓ−1), θ̂. Shown: the reference, e_1 … e_n, the factor of u, θ̂, and x_1 − x_d when it tracks.
///
/// **Source**: Section IV-A, (43) with k = 1 about x_1; tuning functions as in the literature on backstepping.
/// **Measures**: x_1 … x_n. **Transmits**: x_1.
/// **Requires**: ∂e_n/∂x_n ψ away from zero (ψ for strict feedback); c and Γ positive; positive roots, at least n to track
/// and n − 1 to agree; x_d with ℓ bounded derivatives, or a network as for Theorem 3 with (24); regressors bounded along the
/// run.
/// **Guarantees**: x_1 − x_d → 0; with a network x_1 of all agents agree and come to rest, whatever their orders.
/// **Deviates from the paper**: it names the combination; the design and the argument are our own derivation.
///
/// V loses Σ c_i e_i², though θ̂ is wrong:
///
/// ```
/// use forwardstep_core::controller::{
///     AdaptiveBackstepping, ControllerOutput, BacksteppingGains, Balance, Controller, ControllerInput, Jets, ReferenceModel, Truth,
/// };
/// use forwardstep_core::expression::Expression;
/// use forwardstep_core::plant::{Cascade, CascadeTerms, Plant};
/// use forwardstep_core::reference::{Consensus, Heard};
///
/// // ẋ₁ = x₂ + θ x₁²,   ẋ₂ = u
/// let square = Expression::variable(0) * Expression::variable(0);
/// let terms = CascadeTerms::strict(vec![vec![square], vec![Expression::number(0.0)]])?;
/// let guide = ReferenceModel::Consensus(Consensus::new([(&[1.0, 2.0][..], 0.0)])?);
/// let gains = BacksteppingGains { gains_per_s: vec![2.0, 3.0], adaptation: vec![1.5], floor: 0.1 };
/// let law = AdaptiveBackstepping::new(&terms, guide, gains, vec![0.2])?;
/// let plant = Cascade::new(terms, vec![0.7])?;
/// let size = law.states().iter().map(|(_, n)| n).sum::<usize>();
/// let shown_size = law.shown().iter().map(|(_, n)| n).sum::<usize>();
///
/// // V and its loss, and where plant and law are after a short time.
/// let after = |x: [f64; 2], state: &[f64], h: f64| -> Result<(Balance, [f64; 2], Vec<f64>), Box<dyn std::error::Error>> {
///     let given = ControllerInput { measured: law.see(&x)?, heard: Heard::new(&[0.8], &[0.8], 1)?, target: Jets::NONE };
///     let (mut input, mut d_state, mut shown, mut dx) = ([0.0], vec![0.0; size], vec![0.0; shown_size], [0.0; 2]);
///     let asked = ControllerOutput { input: &mut input, d_state: &mut d_state, shown: &mut shown };
///     law.evaluate(&mut law.scratch(), given, state, asked)?;
///     plant.rate(&mut plant.scratch(), &x, &input, &[], &mut dx)?;
///     let truth = Truth { plant: &plant, state: &x, external: &[] };
///     let balance = law.balance(&mut law.scratch(), truth, given, state, &shown)?;
///     let moved = state.iter().zip(&d_state).map(|(x, dx)| x + h * dx).collect();
///     Ok((balance, [x[0] + h * dx[0], x[1] + h * dx[1]], moved))
/// };
/// let start: Vec<f64> = (0..size).map(|k| 0.1 * k as f64 - 0.2).collect();
/// let (now, x, state) = after([0.3, -0.4], &start, 1e-7)?;
/// let (then, ..) = after(x, &state, 0.0)?;
/// assert!(((then.value - now.value) / 1e-7 + now.dissipation).abs() < 1e-4 * now.dissipation);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct AdaptiveBackstepping {
    order: usize,
    guide: ReferenceModel,
    gains_per_s: Vec<f64>,
    adaptation: Vec<f64>,
    estimate_start: Vec<f64>,
    floor: f64,
    recursion: Recursion,
    /// Where ξ is integrated in the place of θ̂.
    interior: Option<Interior>,
}

/// Gains of [`AdaptiveBackstepping`].
#[derive(Clone, Debug, PartialEq)]
pub struct BacksteppingGains {
    /// c_1 … c_n, 1/s.
    pub gains_per_s: Vec<f64>,
    /// The diagonal of Γ.
    pub adaptation: Vec<f64>,
    /// What the factor of u must stay above.
    pub floor: f64,
}

impl AdaptiveBackstepping {
    /// For a chain; `estimate_start` is θ̂(0).
    ///
    /// # Errors
    /// [`ChainError`] when the reference has too few roots, lengths differ, a gain is not positive, or a term that must be
    /// differentiated has no derivative.
    pub fn new(
        terms: &CascadeTerms,
        guide: ReferenceModel,
        gains: BacksteppingGains,
        estimate_start: Vec<f64>,
    ) -> Result<Self, ChainError> {
        AdaptiveBackstepping::within(terms, guide, gains, estimate_start, None)
    }

    /// The same with estimates that stay strictly between bounds, if there are some; their margins are not read.
    ///
    /// # Errors
    /// As [`AdaptiveBackstepping::new`], and when an estimate does not start between its bounds.
    pub fn within(
        terms: &CascadeTerms,
        guide: ReferenceModel,
        gains: BacksteppingGains,
        estimate_start: Vec<f64>,
        bounds: Option<&ParameterBounds>,
    ) -> Result<Self, ChainError> {
        let BacksteppingGains { gains_per_s, adaptation, floor } = gains;
        let n = terms.order();
        guide.check(1, n)?;
        if (0..guide.vectors(1)).any(|r| !matches!(guide.signal(r), Signal::Reference(_))) {
            return Err(ReferenceModelError::NoDerivatives.into());
        }
        LengthError::check("gains of the steps", n, gains_per_s.len())?;
        LengthError::check("adaptation gains", terms.parameters(), adaptation.len())?;
        LengthError::check("theta_hat", terms.parameters(), estimate_start.len())?;
        positive(&gains_per_s)?;
        positive(&adaptation)?;
        let interior = bounds.map(|bounds| interior(bounds, &estimate_start)).transpose()?;
        let slopes = interior.as_ref().map_or_else(Vec::new, |interior| interior.slopes(n));
        let recursion = Recursion::new(terms, &gains_per_s, Metric { gamma: &adaptation, slopes: &slopes })?;
        Ok(AdaptiveBackstepping {
            order: n,
            guide,
            gains_per_s,
            adaptation,
            estimate_start,
            floor,
            recursion,
            interior,
        })
    }

    /// θ̂ of what is integrated.
    fn estimate(&self, k: usize, integrated: f64) -> f64 {
        self.interior.as_ref().map_or(integrated, |interior| interior.theta_hat(k, integrated))
    }

    /// ℓ.
    pub fn vectors(&self) -> usize {
        self.guide.vectors(1)
    }

    /// Where z leads.
    pub fn guide(&self) -> &ReferenceModel {
        &self.guide
    }

    /// p.
    fn parameters(&self) -> usize {
        self.adaptation.len()
    }

    fn shown_len(&self) -> usize {
        self.vectors() + self.order + 1 + self.parameters() + usize::from(self.guide.tracks())
    }
}

/// Bounds with a start between them.
fn interior(bounds: &ParameterBounds, start: &[f64]) -> Result<Interior, ChainError> {
    bounds.check(start.len())?;
    let interior = Interior::new(bounds);
    match start.iter().enumerate().find(|(k, start)| !interior.holds(*k, **start)) {
        None => Ok(interior),
        Some((parameter, start)) => {
            let Range { lower, upper } = bounds.range(parameter);
            Err(ChainError::StartAtBound { parameter, start: *start, lower, upper })
        }
    }
}

/// Working memory of [`AdaptiveBackstepping`].
#[derive(Clone, Debug)]
pub struct BacksteppingWork {
    guide: ReferenceModelWork,
    recursion: RecursionWork,
}

impl Controller for AdaptiveBackstepping {
    type Plant = Cascade;
    type Exchange = Position;
    type Measured<'a> = ChainMeasured<'a>;
    type Scratch = BacksteppingWork;

    const MEASURES: &'static [&'static str] = &["all states of the chain"];
    const KNOWS_OFFSETS: bool = false;

    fn target_derivatives(&self) -> usize {
        self.guide.target_derivatives()
    }

    fn scratch(&self) -> BacksteppingWork {
        BacksteppingWork { guide: self.guide.work(1), recursion: self.recursion.work() }
    }

    fn states(&self) -> Vec<Block> {
        let mut states: Vec<Block> = (0..self.vectors()).map(|r| (Signal::Reference(r as u8), 1)).collect();
        if self.parameters() > 0 {
            states.push((Signal::Estimate, self.parameters()));
        }
        states
    }

    fn shown(&self) -> Vec<Block> {
        let mut shown: Vec<Block> = (0..self.vectors()).map(|r| (Signal::Reference(r as u8), 1)).collect();
        shown.extend([(Signal::TrackingError, self.order), (Signal::Divisor, 1)]);
        if self.parameters() > 0 {
            shown.push((Signal::Estimate, self.parameters()));
        }
        if self.guide.tracks() {
            shown.push((Signal::Error, 1));
        }
        shown
    }

    fn reads(&self, signal: Signal) -> bool {
        matches!(signal, Signal::Position | Signal::Coordinate(_))
    }

    fn see<'a>(&self, output: &'a [f64]) -> Result<ChainMeasured<'a>, LengthError> {
        LengthError::check("output", self.order, output.len())?;
        Ok(ChainMeasured { x: output })
    }

    fn start(
        &self,
        _: &mut BacksteppingWork,
        given: ControllerInput<'_, Self>,
        wanted: &[Vec<f64>],
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        LengthError::check("state", self.vectors() + self.parameters(), state.len())?;
        LengthError::check("x", self.order, given.measured.x.len())?;
        let (reference, theta_hat) = state.split_at_mut(self.vectors());
        reference.fill(0.0);
        reference[0] = given.measured.x[0];
        for (z, wanted) in reference.iter_mut().zip(wanted) {
            LengthError::check("the start of the reference", 1, wanted.len())?;
            *z = wanted[0];
        }
        theta_hat.copy_from_slice(&self.estimate_start);
        if let Some(interior) = &self.interior {
            theta_hat.iter_mut().enumerate().for_each(|(k, own)| *own = interior.xi(k, *own));
        }
        Ok(())
    }

    fn evaluate(
        &self,
        work: &mut BacksteppingWork,
        given: ControllerInput<'_, Self>,
        state: &[f64],
        asked: ControllerOutput<'_>,
    ) -> Result<(), LengthError> {
        let (n, p, vectors) = (self.order, self.parameters(), self.vectors());
        let ControllerOutput { input, d_state, shown } = asked;
        LengthError::check("state", vectors + p, state.len())?;
        LengthError::check("rate", vectors + p, d_state.len())?;
        LengthError::check("input", 1, input.len())?;
        LengthError::check("shown", self.shown_len(), shown.len())?;
        let x = given.measured.x;
        LengthError::check("x", n, x.len())?;
        let (z, integrated) = state.split_at(vectors);
        let theta_hat = &mut shown[vectors + n + 1..][..p];
        for (k, (hat, integrated)) in theta_hat.iter_mut().zip(integrated).enumerate() {
            *hat = self.estimate(k, *integrated);
        }
        let target = if self.guide.tracks() { given.target } else { Jets::NONE };
        let leads = ReferenceModelInput { measured: &x[..1], state: z, heard: given.heard, target };
        self.guide.rate(1, 1, leads, &mut work.guide, &mut d_state[..vectors])?;

        let given = &mut work.recursion.given;
        given[..n].copy_from_slice(x);
        given[n..n + p].copy_from_slice(theta_hat);
        // z^(ℓ) is a rate.
        for (r, y) in given[n + p..].iter_mut().enumerate() {
            *y = if r < vectors { z[r] } else { d_state[vectors - 1] };
        }
        let Stepped { input: u, divisor, errors, d_theta_hat } = self.recursion.evaluate(&mut work.recursion)?;
        input[0] = u;
        d_state[vectors..].copy_from_slice(d_theta_hat);
        shown[..vectors].copy_from_slice(z);
        shown[vectors..][..n].copy_from_slice(errors);
        shown[vectors + n] = divisor;
        if let (Some(jet), Some(error)) = (target.get(0), shown.last_mut()) {
            *error = x[0] - jet[0];
        }
        Ok(())
    }

    fn trouble(&self, _: &[f64], shown: &[f64]) -> Option<Singularity> {
        vanishes(*shown.get(self.vectors() + self.order)?, self.floor)
    }

    fn settle(&self, _: &mut [f64]) {}

    fn balance(
        &self,
        work: &mut BacksteppingWork,
        truth: Truth<'_, Cascade>,
        _: ControllerInput<'_, Self>,
        state: &[f64],
        shown: &[f64],
    ) -> Result<Balance, LengthError> {
        let vectors = self.vectors();
        LengthError::check("state", vectors + self.parameters(), state.len())?;
        LengthError::check("shown", self.shown_len(), shown.len())?;
        LengthError::check("theta", self.parameters(), truth.plant.theta().len())?;
        let (mut value, mut dissipation) = (0.0, 0.0);
        for (e, c) in shown[vectors..].iter().zip(&self.gains_per_s) {
            value += 0.5 * e * e;
            dissipation += c * e * e;
        }
        for (j, theta) in truth.plant.theta().iter().enumerate() {
            let delta = state[vectors + j] - theta;
            let divergence =
                self.interior.as_ref().map_or(0.5 * delta * delta, |of| of.divergence(j, state[vectors + j], *theta));
            value += divergence / self.adaptation[j];
        }
        if !truth.external.is_empty() {
            LengthError::check("state of the plant", self.order, truth.state.len())?;
            let (z, theta_hat) = (&state[..vectors], &shown[vectors + self.order + 1..][..self.parameters()]);
            let known = truth.state.iter().chain(theta_hat).chain(z);
            // The last derivative of z is in no error.
            work.recursion.given.iter_mut().zip(known).for_each(|(given, value)| *given = *value);
            let slopes = self.recursion.slopes(&mut work.recursion)?;
            dissipation -= slopes.iter().zip(truth.external).map(|(slope, w)| slope * w).sum::<f64>();
        }
        Ok(Balance { value, dissipation })
    }
}
