//! Feedback linearisation as the second step of Section IV, for (33) with χ linear in parameters, known or not.
//!
//! ```text
//! d^k x/dt^k = χ₀(x*) + φ(x*)ᵀθ + ψ(x*) u                                 (33)
//! s = d^(k−1)x/dt^(k−1) − z
//! u = (ż − χ₀ − φᵀθ̂ − k s)/ψ
//! θ̂ = θ    or    θ̂' = Γ φ s
//! ```
//!
//! z comes from the reference dynamics of [`ReferenceModel`], which also says how the first line of (43) is reduced to degree zero.
//! With Δθ = θ̂ − θ the second line of (43) is ṡ = −k s − φᵀΔθ, so V = ½ s² + ½ Δθᵀ Γ⁻¹ Δθ has
//!
//! ```text
//! V̇ = −k s² − s φᵀΔθ + Δθᵀ φ s = −k s²
//! ```
//!
//! whatever z does, and a disturbance w adds s w: without one s and θ̂ are bounded and s is square-integrable. With θ known s → 0 exponentially. With θ adapted s → 0
//! follows as soon as φ is bounded along the run, for then ṡ is; φ is bounded if x* is, or if its functions are. Neither step
//! differentiates anything: ż is a state of the reference for ℓ ≥ 2, and for ℓ = 1 what its dynamics give.

//!
//! θ̂ may be kept within bounds: ϑ̂_j' = c_j γ_j φ_j s by the projection of `law::bounds`, which takes from V̇ what that file derives.

use alloc::vec::Vec;

use super::following::{ChainError, ChainMeasured, Following, FollowingWork, positive};
use super::{Balance, Controller, ControllerInput, ControllerOutput, Singularity, Truth};
use crate::LengthError;
use crate::law::ParameterBounds;
use crate::plant::{Chain, Terms};
use crate::reference::Position;
use crate::signal::{Block, Signal};

#[cfg(doc)]
use super::ReferenceModel;

/// Control of (33) by feedback linearisation, with θ known or adapted.
///
/// State: z, ż, …, z^(ℓ−1), then θ̂ if it is adapted. Shown: the reference, s, ψ, θ̂ if it is adapted, and x − x_d when it
/// tracks.
///
/// **Source**: (33)–(43), Remark 6; adaptation as in (7). **Measures**: x, ẋ, …, d^(k−1)x/dt^(k−1). **Transmits**: x.
/// **Requires**: ψ away from zero; k and Γ positive; positive roots, k + ℓ − 1 to track and k + ℓ − 2 to agree, ℓ ≥ 1; x_d
/// with k + ℓ − 1 bounded derivatives, or a network as for Theorem 3 with (24); if θ is adapted, φ bounded along the run.
/// **Guarantees**: x − x_d → 0 with its derivatives; with a network x_i − x_j → 0 and all derivatives → 0. u is ℓ − 2 times
/// continuously differentiable through switches and delay jumps.
/// **Deviates from the paper**: it announces adaptive designs for (33) and prints none.
///
/// With θ known the loop is ṡ = −k s, whatever the plant is:
///
/// ```
/// use forwardstep_core::controller::{ControllerOutput, Controller, Following, ControllerInput, Jets, ReferenceModel, Linearising};
/// use forwardstep_core::plant::{Chain, Closures, Plant};
/// use forwardstep_core::reference::{Consensus, Heard};
///
/// // ẍ = −x³ + θ ẋ + (2 + x²) u
/// let terms = Closures {
///     order: 2,
///     parameters: 1,
///     chi: |x: &[f64]| -x[0] * x[0] * x[0],
///     phi: |x: &[f64], phi: &mut [f64]| phi[0] = x[1],
///     psi: |x: &[f64]| 2.0 + x[0] * x[0],
/// };
/// let guide = ReferenceModel::Consensus(Consensus::new([(&[1.0, 2.0][..], 0.0)])?);
/// let law = Linearising::new(terms, vec![0.7], Following { guide, gain_per_s: 5.0, floor: 0.1 })?;
/// let x = [0.3, -0.4];
/// let given = ControllerInput { measured: law.see(&x)?, heard: Heard::new(&[0.8], &[0.8], 1)?, target: Jets::NONE };
/// let state = [0.5, 0.1];
/// let (mut input, mut d_state, mut shown) = ([0.0], [0.0; 2], [0.0; 4]);
/// let asked = ControllerOutput { input: &mut input, d_state: &mut d_state, shown: &mut shown };
/// law.evaluate(&mut law.scratch(), given, &state, asked)?;
///
/// let plant = Chain { terms, theta: vec![0.7] };
/// let mut dx = [0.0; 2];
/// plant.rate(&mut plant.scratch(), &x, &input, &[], &mut dx)?;
/// let s = x[1] - state[0];
/// assert!((dx[1] - d_state[0] + 5.0 * s).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Linearising<T> {
    terms: T,
    following: Following,
    /// θ, or θ̂(0).
    theta: Vec<f64>,
    /// The diagonal of Γ, if θ is adapted.
    adaptation: Option<Vec<f64>>,
    bounds: Option<ParameterBounds>,
}

impl<T: Terms> Linearising<T> {
    /// For a plant with these terms and the known θ.
    ///
    /// # Errors
    /// [`ChainError`] when the reference does not suit the plant, or lengths differ.
    pub fn new(terms: T, theta: Vec<f64>, following: Following) -> Result<Self, ChainError> {
        following.check(&terms)?;
        LengthError::check("theta", terms.parameters(), theta.len())?;
        Ok(Linearising { terms, following, theta, adaptation: None, bounds: None })
    }

    /// For a plant with these terms and unknown θ; `adaptation` is the diagonal of Γ, `estimate_start` is θ̂(0).
    ///
    /// # Errors
    /// [`ChainError`] when the reference does not suit the plant, lengths differ, or a gain is not positive.
    pub fn adaptive(
        terms: T,
        following: Following,
        adaptation: Vec<f64>,
        estimate_start: Vec<f64>,
    ) -> Result<Self, ChainError> {
        LengthError::check("adaptation gains", terms.parameters(), adaptation.len())?;
        positive(&adaptation)?;
        Ok(Linearising { adaptation: Some(adaptation), ..Linearising::new(terms, estimate_start, following)? })
    }

    /// The same with estimates that are kept within `bounds`.
    ///
    /// # Errors
    /// [`ChainError`] when there is not an entry for each parameter.
    pub fn bounded(self, bounds: ParameterBounds) -> Result<Self, ChainError> {
        bounds.check(self.terms.parameters())?;
        Ok(Linearising { bounds: Some(bounds), ..self })
    }

    /// How z is followed.
    pub fn following(&self) -> &Following {
        &self.following
    }

    /// Where θ̂ stands in the state.
    fn at(&self) -> usize {
        self.following.guide.vectors(self.terms.order())
    }

    /// How many entries θ̂ has; none when θ is known.
    fn estimates(&self) -> usize {
        self.adaptation.as_ref().map_or(0, Vec::len)
    }
}

impl<T: Terms> Controller for Linearising<T> {
    type Plant = Chain<T>;
    type Exchange = Position;
    type Measured<'a> = ChainMeasured<'a>;
    type Scratch = FollowingWork<T::Scratch>;

    const MEASURES: &'static [&'static str] = &["position", "its derivatives below the order of the plant"];
    const KNOWS_OFFSETS: bool = false;

    fn target_derivatives(&self) -> usize {
        self.following.guide.target_derivatives()
    }

    fn scratch(&self) -> Self::Scratch {
        self.following.work(&self.terms)
    }

    fn states(&self) -> Vec<Block> {
        let mut states = self.following.states(self.terms.order());
        states.extend(self.adaptation.as_ref().map(|gamma| (Signal::Estimate, gamma.len())));
        states
    }

    fn shown(&self) -> Vec<Block> {
        self.following.shown(self.terms.order(), self.estimates())
    }

    fn reads(&self, signal: Signal) -> bool {
        matches!(signal, Signal::Position | Signal::Velocity | Signal::Derivative(_))
    }

    fn see<'a>(&self, output: &'a [f64]) -> Result<ChainMeasured<'a>, LengthError> {
        LengthError::check("output", self.terms.order(), output.len())?;
        Ok(ChainMeasured { x: output })
    }

    fn start(
        &self,
        _: &mut Self::Scratch,
        given: ControllerInput<'_, Self>,
        wanted: &[Vec<f64>],
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        LengthError::check("state", self.at() + self.estimates(), state.len())?;
        let known = (given.measured.x, given.heard.degree);
        self.following.start(self.terms.order(), known, wanted, state)?;
        state[self.at()..].copy_from_slice(&self.theta[..self.estimates()]);
        Ok(())
    }

    fn evaluate(
        &self,
        work: &mut Self::Scratch,
        given: ControllerInput<'_, Self>,
        state: &[f64],
        asked: ControllerOutput<'_>,
    ) -> Result<(), LengthError> {
        let ControllerOutput { input, d_state, shown } = asked;
        let p = self.estimates();
        self.following.lengths(&self.terms, p, [state.len(), d_state.len(), input.len(), shown.len()])?;
        let (x, at) = (given.measured.x, self.at());
        let found = self.following.evaluate(&self.terms, work, given, x, state, (d_state, shown))?;
        let theta_hat = if self.adaptation.is_some() { &state[at..] } else { &self.theta };
        let mut chi = found.chi;
        for (phi, theta_hat) in work.phi.iter().zip(theta_hat) {
            chi += phi * theta_hat;
        }
        input[0] = (found.dz - chi - self.following.gain_per_s * found.s) / found.psi;
        for (j, gamma) in self.adaptation.iter().flatten().enumerate() {
            let rate = gamma * work.phi[j] * found.s;
            d_state[at + j] = self.bounds.as_ref().map_or(rate, |bounds| bounds.slowed(j, theta_hat[j], rate));
            shown[at + 2 + j] = theta_hat[j];
        }
        Ok(())
    }

    fn trouble(&self, _: &[f64], shown: &[f64]) -> Option<Singularity> {
        self.following.trouble(self.terms.order(), shown)
    }

    fn settle(&self, _: &mut [f64]) {}

    fn balance(
        &self,
        work: &mut Self::Scratch,
        truth: Truth<'_, Self::Plant>,
        _: ControllerInput<'_, Self>,
        state: &[f64],
        shown: &[f64],
    ) -> Result<Balance, LengthError> {
        let p = self.estimates();
        LengthError::check("state", self.at() + p, state.len())?;
        LengthError::check("theta", self.terms.parameters(), truth.plant.theta.len())?;
        let s = self.following.s(&self.terms, p, shown)?;
        let mut value = 0.5 * s * s;
        for (j, gamma) in self.adaptation.iter().flatten().enumerate() {
            let delta = state[self.at() + j] - truth.plant.theta[j];
            value += 0.5 * delta * delta / gamma;
        }
        let power: f64 = truth.external.iter().map(|w| s * w).sum();
        let mut dissipation = self.following.gain_per_s * s * s - power;
        if let Some(bounds) = &self.bounds {
            self.terms.terms(&mut work.terms, truth.state, &mut work.phi)?;
            let theta_hat = &state[self.at()..];
            for (j, gamma) in self.adaptation.iter().flatten().enumerate() {
                let rate = gamma * work.phi[j] * s;
                let withheld = rate - bounds.slowed(j, theta_hat[j], rate);
                dissipation += (theta_hat[j] - truth.plant.theta[j]) * withheld / gamma;
            }
        }
        Ok(Balance { value, dissipation })
    }
}
