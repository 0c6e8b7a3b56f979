//! A point mass without velocity measurement: (a7)–(a9), and consensus of many.
//!
//! ```text
//! m ẍ = u                                                                   (a7)
//! u = m̂ ż − k y                                                             (a8)
//! z̈ = x⃛_d − α₂(ż − ẍ_d) − α₁(z − ẋ_d) − α₀(x − x_d)                          (a9), tracking
//! z^(ℓ) = (24) with z in place of ẋ                                         Remark 7, consensus
//! ẏ + λ_f y = λ_f s,   m̂' = −γ* żᵀs,   s = ẋ − z
//! ```
//!
//! Neither y nor m̂ needs ẋ. With ṗ = z + y the filter is y = λ_f (x − p). Integrating m̂' by parts,
//!
//! ```text
//! m̂(t) = m̂(0) + I(t) − γ* (żᵀx − ½ zᵀz)(t),   İ = γ* z̈ᵀx,   I(0) = γ* (żᵀx − ½ zᵀz)(0)
//! ```
//!
//! (the paper prints z x − z z, whose derivative is another). With V = ½ m sᵀs + (k/2λ_f) yᵀy + (m̂ − m)²/2γ*,
//!
//! ```text
//! V̇ = sᵀ(−k y + (m̂ − m) ż) + (k/λ_f) yᵀẏ − (m̂ − m) żᵀs = −k sᵀy + k yᵀ(s − y) = −k yᵀy
//! ```
//!
//! while nothing acts from outside; a force f adds sᵀf. So y is square-integrable, s is bounded, and s = y + ẏ/λ_f.
//!
//! **Bounds.** żᵀs is not measured, so m̂' cannot be slowed down at a bound: u takes Π(m̂) with what is found by parts for μ, as derived in
//! `law::clamped`, with ρ = λ_f. V has W/γ* for its last term, and V̇ = −k yᵀy − (λ_f/γ*)(Π(μ) − m)(μ − Π(μ)).
//!
//! **Consensus**, which Remark 7 announces and does not print. Let agents exchange positions and let each take (24) of order
//! ℓ ≥ 2 with its own z where (24) has ẋ. With ẋ = z + y + ẏ/λ_f let x' = x − y/λ_f, so ẋ' = z + y. In x' the agents follow
//! (24) for integrators, whose state converges for switching graphs and delays as in Theorem 3, driven by y in its first
//! equation and by α₀ Σ w (y_i − y_j(t−T))/λ_f in its last: two square-integrable inputs, as s is in Theorem 2. No derivative
//! of a switching quantity is left, so the cascade has degree one.
//! From there the argument is that of Theorem 2: states are bounded, ẏ is uniformly continuous, y and s vanish, the
//! agents agree and come to rest.

use alloc::vec::Vec;

use super::reference_model::{ReferenceModel, ReferenceModelInput, ReferenceModelWork};
use super::{Balance, Controller, ControllerInput, ControllerOutput, Jets, Singularity, Truth};
use crate::LengthError;
use crate::law::Range;
use crate::plant::Mechanical;
use crate::reference::Position;
use crate::robot::PointMass;
use crate::signal::{Block, Signal};

/// The position of a point mass.
#[derive(Clone, Copy, Debug)]
pub struct PositionMeasured<'a> {
    /// x, m entries.
    pub x: &'a [f64],
}

/// Adaptive control of a point mass without velocity.
///
/// State: z, ż, …, z^(ℓ−1), p, I. Shown: z, ż, y, m̂, and x − x_d when it tracks.
///
/// **Source**: (a8), (a9), Remark 7. **Measures**: x. **Transmits**: x.
/// **Requires**: k, λ_f, γ* positive; a Hurwitz polynomial; x_d with three bounded derivatives, or a network as for
/// Theorem 3 with (24).
/// **Guarantees**: x − x_d → 0 and ẋ − ẋ_d → 0; with a network x_i − x_j → 0 and ẋ_i → 0. u is continuous through switches
/// and delay jumps for ℓ = 2.
/// **Deviates from the paper**: any number of axes, with żᵀs in the adaptation; the integral by parts as in the head of this
/// file; consensus is our own derivation.
///
/// ```
/// use forwardstep_core::controller::{ControllerOutput, Controller, ControllerInput, Jets, ReferenceModel, PositionOnly};
/// use forwardstep_core::reference::{Heard, polynomial};
///
/// let mut alpha = polynomial([1.0, 2.0, 3.0])?;
/// alpha.pop();
/// let guide = ReferenceModel::Tracking { alpha: alpha.clone() };
/// let law = PositionOnly { axes: 1, guide, damping: 8.0, filter_per_s: 20.0, adaptation: 3.0, estimate_start: 1.5, bounds: None };
/// let target = [[0.2, 0.1, -0.3, 0.4, 0.0]];
/// let given = ControllerInput { measured: law.see(&[0.5, 9.9])?, heard: Heard::new(&[0.0], &[0.0], 1)?, target: Jets::from(&target) };
/// let mut scratch = law.scratch();
/// let (mut state, mut d_state) = (vec![0.0; 4], vec![0.0; 4]);
/// law.start(&mut scratch, given, &[vec![0.7], vec![-0.6]], &mut state)?;
/// state[2] += 0.05;
/// let (mut input, mut shown) = (vec![0.0], vec![0.0; 5]);
/// let asked = ControllerOutput { input: &mut input, d_state: &mut d_state, shown: &mut shown };
/// law.evaluate(&mut scratch, given, &state, asked)?;
///
/// let [z, dz, y, m_hat, error] = shown[..] else { panic!() };
/// // (a8) and (a9); the velocity, 9.9, was not read.
/// assert!((input[0] - (m_hat * dz - 8.0 * y)).abs() < 1e-12);
/// let [x_d, dx_d, ddx_d, dddx_d, _] = target[0];
/// assert!((d_state[1] - (dddx_d - alpha[2] * (dz - ddx_d) - alpha[1] * (z - dx_d) - alpha[0] * error)).abs() < 1e-12);
/// assert!((error - (0.5 - x_d)).abs() < 1e-12 && y != 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PositionOnly {
    /// m.
    pub axes: usize,
    /// Where z leads.
    pub guide: ReferenceModel,
    /// k, N s/m.
    pub damping: f64,
    /// λ_f, 1/s.
    pub filter_per_s: f64,
    /// γ*; zero when m̂ is not adapted.
    pub adaptation: f64,
    /// m̂(0), kg.
    pub estimate_start: f64,
    /// Where m is known to be, kg.
    pub bounds: Option<Range>,
}

impl PositionOnly {
    /// Where p and I stand in the state.
    fn layout(&self) -> (usize, usize) {
        let p = self.guide.vectors(2) * self.axes;
        (p, p + self.axes)
    }

    /// γ* (żᵀx − ½ zᵀz).
    fn by_parts(&self, x: &[f64], z: &[f64], dz: &[f64]) -> f64 {
        let mut sum = 0.0;
        for k in 0..self.axes {
            sum += dz[k] * x[k] - 0.5 * z[k] * z[k];
        }
        self.adaptation * sum
    }

    /// m̂, or μ where there are bounds.
    fn found(&self, integral: f64, x: &[f64], z: &[f64], dz: &[f64]) -> f64 {
        self.estimate_start + integral - self.by_parts(x, z, dz)
    }
}

impl Controller for PositionOnly {
    type Plant = Mechanical<PointMass>;
    type Exchange = Position;
    type Measured<'a> = PositionMeasured<'a>;
    type Scratch = ReferenceModelWork;

    const MEASURES: &'static [&'static str] = &["position"];
    const KNOWS_OFFSETS: bool = false;

    fn target_derivatives(&self) -> usize {
        self.guide.target_derivatives()
    }

    fn scratch(&self) -> ReferenceModelWork {
        self.guide.work(self.axes)
    }

    fn states(&self) -> Vec<Block> {
        let mut states: Vec<Block> =
            (0..self.guide.vectors(2)).map(|r| (Signal::Reference(r as u8), self.axes)).collect();
        states.extend([(Signal::Filter, self.axes), (Signal::Estimate, 1)]);
        states
    }

    fn shown(&self) -> Vec<Block> {
        let mut shown: Vec<Block> =
            (0..self.guide.vectors(2)).map(|r| (Signal::Reference(r as u8), self.axes)).collect();
        shown.extend([(Signal::Filter, self.axes), (Signal::Estimate, 1)]);
        if self.guide.tracks() {
            shown.push((Signal::Error, self.axes));
        }
        shown
    }

    fn reads(&self, signal: Signal) -> bool {
        signal == Signal::Position
    }

    fn see<'a>(&self, output: &'a [f64]) -> Result<PositionMeasured<'a>, LengthError> {
        LengthError::check("output", 2 * self.axes, output.len())?;
        Ok(PositionMeasured { x: &output[..self.axes] })
    }

    fn start(
        &self,
        _: &mut ReferenceModelWork,
        given: ControllerInput<'_, Self>,
        wanted: &[Vec<f64>],
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        let (p, i) = self.layout();
        LengthError::check("state", i + 1, state.len())?;
        state.fill(0.0);
        for (block, wanted) in state[..p].chunks_exact_mut(self.axes).zip(wanted) {
            LengthError::check("the start of the reference", self.axes, wanted.len())?;
            block.copy_from_slice(wanted);
        }
        // y(0) = 0.
        let (reference, rest) = state.split_at_mut(p);
        rest[..self.axes].copy_from_slice(given.measured.x);
        let (z, dz) = reference.split_at(self.axes);
        rest[self.axes] = self.by_parts(given.measured.x, z, dz);
        Ok(())
    }

    fn evaluate(
        &self,
        work: &mut ReferenceModelWork,
        given: ControllerInput<'_, Self>,
        state: &[f64],
        asked: ControllerOutput<'_>,
    ) -> Result<(), LengthError> {
        let (m, (p, i)) = (self.axes, self.layout());
        LengthError::check("state", i + 1, state.len())?;
        LengthError::check("rate", i + 1, asked.d_state.len())?;
        LengthError::check("input", m, asked.input.len())?;
        // As many as the state, and x − x_d.
        let errors = if self.guide.tracks() { m } else { 0 };
        LengthError::check("shown", i + 1 + errors, asked.shown.len())?;
        let x = given.measured.x;
        LengthError::check("x", m, x.len())?;
        let (z, dz) = (&state[..m], &state[m..2 * m]);
        let target = if self.guide.tracks() { given.target } else { Jets::NONE };
        let leads = ReferenceModelInput { measured: x, state: &state[..p], heard: given.heard, target };
        self.guide.rate(2, m, leads, work, &mut asked.d_state[..p])?;
        let mu = self.found(state[i], x, z, dz);
        let m_hat = self.bounds.map_or(mu, |range| range.nearest(mu));
        let mut d_i = 0.0;
        for k in 0..m {
            let y = self.filter_per_s * (x[k] - state[p + k]);
            asked.d_state[p + k] = z[k] + y;
            asked.input[k] = m_hat * dz[k] - self.damping * y;
            // z̈, whether it is a state or a rate.
            d_i += asked.d_state[m + k] * x[k];
            asked.shown[p + k] = y;
            if let (Some(jet), Some(error)) = (target.get(k), asked.shown.get_mut(i + 1 + k)) {
                *error = x[k] - jet[0];
            }
        }
        asked.d_state[i] = self.adaptation * d_i;
        if let Some(range) = self.bounds {
            asked.d_state[i] -= self.filter_per_s * range.beyond(mu);
        }
        asked.shown[..p].copy_from_slice(&state[..p]);
        asked.shown[i] = m_hat;
        Ok(())
    }

    fn settle(&self, _: &mut [f64]) {}

    fn trouble(&self, _: &[f64], _: &[f64]) -> Option<Singularity> {
        None
    }

    fn balance(
        &self,
        _: &mut ReferenceModelWork,
        truth: Truth<'_, Self::Plant>,
        _: ControllerInput<'_, Self>,
        state: &[f64],
        shown: &[f64],
    ) -> Result<Balance, LengthError> {
        let (m, (p, i)) = (self.axes, self.layout());
        LengthError::check("state of the plant", 2 * m, truth.state.len())?;
        LengthError::check("theta", 1, truth.plant.theta.len())?;
        let mass = truth.plant.theta[0];
        let (mut ss, mut yy, mut power) = (0.0, 0.0, 0.0);
        for k in 0..m {
            let (s, y) = (truth.state[m + k] - state[k], shown[p + k]);
            ss += s * s;
            yy += y * y;
            power += truth.external.get(k).map_or(0.0, |force| s * force);
        }
        let delta = shown[i] - mass;
        let (mut learnt, mut withheld) = (0.5 * delta * delta, 0.0);
        if let Some(range) = self.bounds {
            let mu = self.found(state[i], &truth.state[..m], &state[..m], &state[m..2 * m]);
            (learnt, withheld) = (range.potential(mu, mass), self.filter_per_s * range.withheld(mu, mass));
        }
        let [learnt, withheld] =
            [learnt, withheld].map(|of| if self.adaptation > 0.0 { of / self.adaptation } else { 0.0 });
        let value = 0.5 * mass * ss + 0.5 * self.damping / self.filter_per_s * yy + learnt;
        Ok(Balance { value, dissipation: self.damping * yy + withheld - power })
    }
}
