//! A point mass without velocity measurement, in the manner of model reference adaptive control: what Remark 7 compares (a8) and (a9) with.
//!
//! In the manner of Ioannou and Sun for relative degree two, derived here for (a7), of which only m is unknown: their four estimates per axis
//! become one. The model is ë + α₁ ė + α₀ e = 0 with e = x − x_d, and p > 0 is a zero that makes its transfer function positive real.
//!
//! ```text
//! u = m̂ φ₀ + m̂' φ − α₁ η,   φ₀ = ẍ_d + α₁ ẋ_d − α₀ e − α₁ y,   φ̇ = φ₀ − p φ
//! y = λ_f (x − x_f),   ẋ_f = y,   η̇ = u − λ_f η,   m̂' = −γ* eᵀφ
//! ```
//!
//! y stands in for ẋ, and η for m (ẋ − y), which y leaves out. With m ẍ = u + f,
//!
//! ```text
//! δ = η − m (ẋ − y):   δ̇ = −λ_f δ − f
//! ```
//!
//! so that δ vanishes by itself, and is zero from a start at rest. Let Δm = m̂ − m. Since m̂' φ + Δm φ₀ = (d/dt + p)(Δm φ),
//!
//! ```text
//! m (ë + α₁ ė + α₀ e) = (d/dt + p)(Δm φ) − α₁ δ + f
//! ```
//!
//! The input is differentiated once on the right. With b = α₁ − p and r = ė − Δm φ/m + b e it is not:
//!
//! ```text
//! ė = −b e + r + Δm φ/m,   ṙ = −p r − (α₀ − p b) e + (f − α₁ δ)/m
//! ```
//!
//! Let α₀ > p b > 0 and c = 1/(α₀ − p b), so that the two meet in V with opposite signs, and h = α₁² c/(2 m p λ_f). With
//! V = ½ m (eᵀe + c rᵀr) + ½ h δᵀδ + Δm²/2γ*,
//!
//! ```text
//! V̇ = eᵀφ Δm + Δm m̂'/γ* − m b eᵀe − m c p rᵀr − c α₁ rᵀδ − h λ_f δᵀδ + (c r − h δ)ᵀf
//!   = −m b eᵀe − [m c p rᵀr + c α₁ rᵀδ + h λ_f δᵀδ] + (c r − h δ)ᵀf
//! ```
//!
//! The bracket is not negative: (c α₁)² = 2 m c p h λ_f is less than 4 m c p · h λ_f. So e, r, δ are bounded and square-integrable while nothing
//! acts from outside, x and y are bounded, φ₀ and φ with them, and so is ė: e → 0. Then r → 0, and as ë is bounded too ė → 0.
//!
//! The two conditions on p hold for p = α₀ α₁/(α₁² + 2 α₀), which is taken: p < ½ α₁ and p α₁ < α₀.
//!
//! Two things set it apart from (a8) with (a9). The term m̂' φ = −γ* (eᵀφ) φ is the high gain that Remark 7 speaks of: it grows with the square of φ,
//! and so with that of the target's acceleration. And without an estimate of velocities nothing is left of V where agents are to agree: φ₀ takes ẍ_d.

use alloc::vec;
use alloc::vec::Vec;

use super::position_only::PositionMeasured;
use super::{Balance, Controller, ControllerInput, ControllerOutput, Singularity, Truth};
use crate::LengthError;
use crate::plant::Mechanical;
use crate::reference::Position;
use crate::robot::PointMass;
use crate::signal::{Block, Signal};

/// Model reference adaptive control of a point mass without velocity.
///
/// State: x_f, η, φ, m each, and m̂; they start such that y, η and φ are zero. Shown: y, m̂, x − x_d.
///
/// **Source**: Remark 7 speaks of it; derived at the head of this file. **Measures**: x. **Transmits**: nothing.
/// **Requires**: λ_f, γ*, α₀, α₁ positive; x_d with two bounded derivatives.
/// **Guarantees**: x − x_d → 0 and ẋ − ẋ_d → 0. u is continuous where ẍ_d is.
/// **Deviates from the paper**: it is no law of the paper.
///
/// ```
/// use forwardstep_core::controller::{ControllerOutput, Controller, ControllerInput, Jets, ModelReference};
/// use forwardstep_core::reference::Heard;
///
/// let law = ModelReference { axes: 1, alpha: [2.0, 3.0], filter_per_s: 20.0, adaptation: 3.0, estimate_start: 1.5 };
/// let target = [[0.2, 0.1, -0.3, 0.0, 0.0]];
/// let given = ControllerInput { measured: law.see(&[0.5, 9.9])?, heard: Heard::new(&[0.0], &[0.0], 1)?, target: Jets::from(&target) };
/// let (mut state, mut d_state) = (vec![0.0; 4], vec![0.0; 4]);
/// law.start(&mut (), given, &[], &mut state)?;
/// // x_f, η and φ after a while.
/// (state[0], state[1], state[2]) = (0.45, 0.7, -0.4);
/// let (mut input, mut shown) = (vec![0.0], vec![0.0; 3]);
/// law.evaluate(&mut (), given, &state, ControllerOutput { input: &mut input, d_state: &mut d_state, shown: &mut shown })?;
///
/// let [y, m_hat, error] = shown[..] else { panic!() };
/// let phi_0 = -0.3 + 3.0 * 0.1 - 2.0 * error - 3.0 * y;
/// // The velocity, 9.9, was not read.
/// assert!((d_state[3] - (-3.0 * error * -0.4)).abs() < 1e-12 && (y - 20.0 * 0.05).abs() < 1e-12);
/// assert!((input[0] - (m_hat * phi_0 + d_state[3] * -0.4 - 3.0 * 0.7)).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ModelReference {
    /// m.
    pub axes: usize,
    /// α₀, α₁ of the model.
    pub alpha: [f64; 2],
    /// λ_f, 1/s.
    pub filter_per_s: f64,
    /// γ*; zero when m̂ is not adapted.
    pub adaptation: f64,
    /// m̂(0), kg.
    pub estimate_start: f64,
}

impl ModelReference {
    /// p.
    fn zero(&self) -> f64 {
        let [a0, a1] = self.alpha;
        a0 * a1 / (a1 * a1 + 2.0 * a0)
    }
}

impl Controller for ModelReference {
    type Plant = Mechanical<PointMass>;
    type Exchange = Position;
    type Measured<'a> = PositionMeasured<'a>;
    type Scratch = ();

    const MEASURES: &'static [&'static str] = &["position"];
    const KNOWS_OFFSETS: bool = false;

    fn target_derivatives(&self) -> usize {
        2
    }

    fn scratch(&self) {}

    fn states(&self) -> Vec<Block> {
        let filter = (Signal::Filter, self.axes);
        vec![filter, filter, filter, (Signal::Estimate, 1)]
    }

    fn shown(&self) -> Vec<Block> {
        vec![(Signal::Filter, self.axes), (Signal::Estimate, 1), (Signal::Error, self.axes)]
    }

    fn reads(&self, signal: Signal) -> bool {
        signal == Signal::Position
    }

    fn see<'a>(&self, output: &'a [f64]) -> Result<PositionMeasured<'a>, LengthError> {
        LengthError::check("output", 2 * self.axes, output.len())?;
        Ok(PositionMeasured { x: &output[..self.axes] })
    }

    /// `wanted` is not read: there is no z.
    fn start(
        &self,
        (): &mut (),
        given: ControllerInput<'_, Self>,
        _: &[Vec<f64>],
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        LengthError::check("state", 3 * self.axes + 1, state.len())?;
        LengthError::check("x", self.axes, given.measured.x.len())?;
        state.fill(0.0);
        // y(0) = 0.
        state[..self.axes].copy_from_slice(given.measured.x);
        state[3 * self.axes] = self.estimate_start;
        Ok(())
    }

    fn evaluate(
        &self,
        (): &mut (),
        given: ControllerInput<'_, Self>,
        state: &[f64],
        asked: ControllerOutput<'_>,
    ) -> Result<(), LengthError> {
        let m = self.axes;
        LengthError::check("state", 3 * m + 1, state.len())?;
        LengthError::check("rate", 3 * m + 1, asked.d_state.len())?;
        LengthError::check("input", m, asked.input.len())?;
        LengthError::check("shown", 2 * m + 1, asked.shown.len())?;
        LengthError::check("target", m, given.target.len())?;
        let x = given.measured.x;
        LengthError::check("x", m, x.len())?;
        let ([a0, a1], m_hat) = (self.alpha, state[3 * m]);
        let (eta, phi) = (&state[m..2 * m], &state[2 * m..3 * m]);
        let mut learnt = 0.0;
        for k in 0..m {
            let jet = given.target.jet(k);
            let (error, y) = (x[k] - jet[0], self.filter_per_s * (x[k] - state[k]));
            let phi_0 = jet[2] + a1 * jet[1] - a0 * error - a1 * y;
            learnt += error * phi[k];
            asked.input[k] = m_hat * phi_0 - a1 * eta[k];
            asked.d_state[k] = y;
            asked.d_state[2 * m + k] = phi_0 - self.zero() * phi[k];
            asked.shown[k] = y;
            asked.shown[m + 1 + k] = error;
        }
        let d_m_hat = -self.adaptation * learnt;
        for k in 0..m {
            asked.input[k] += d_m_hat * phi[k];
            asked.d_state[m + k] = asked.input[k] - self.filter_per_s * eta[k];
        }
        asked.d_state[3 * m] = d_m_hat;
        asked.shown[m] = m_hat;
        Ok(())
    }

    fn settle(&self, _: &mut [f64]) {}

    fn trouble(&self, _: &[f64], _: &[f64]) -> Option<Singularity> {
        None
    }

    fn balance(
        &self,
        (): &mut (),
        truth: Truth<'_, Self::Plant>,
        given: ControllerInput<'_, Self>,
        state: &[f64],
        shown: &[f64],
    ) -> Result<Balance, LengthError> {
        let m = self.axes;
        LengthError::check("state of the plant", 2 * m, truth.state.len())?;
        LengthError::check("state", 3 * m + 1, state.len())?;
        LengthError::check("shown", 2 * m + 1, shown.len())?;
        LengthError::check("target", m, given.target.len())?;
        LengthError::check("theta", 1, truth.plant.theta.len())?;
        let ([a0, a1], mass, p) = (self.alpha, truth.plant.theta[0], self.zero());
        let b = a1 - p;
        let c = 1.0 / (a0 - p * b);
        let h = a1 * a1 * c / (2.0 * mass * p * self.filter_per_s);
        let off = state[3 * m] - mass;
        let learnt = if self.adaptation > 0.0 { 0.5 * off * off / self.adaptation } else { 0.0 };
        let (mut value, mut dissipation) = (learnt, 0.0);
        for k in 0..m {
            let (velocity, y, e) = (truth.state[m + k], shown[k], shown[m + 1 + k]);
            let delta = state[m + k] - mass * (velocity - y);
            let r = velocity - given.target.jet(k)[1] - off * state[2 * m + k] / mass + b * e;
            let force = truth.external.get(k).copied().unwrap_or(0.0);
            value += 0.5 * mass * (e * e + c * r * r) + 0.5 * h * delta * delta;
            dissipation +=
                mass * (b * e * e + c * p * r * r) + c * a1 * r * delta + h * self.filter_per_s * delta * delta;
            dissipation -= (c * r - h * delta) * force;
        }
        Ok(Balance { value, dissipation })
    }
}
