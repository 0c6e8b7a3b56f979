//! Feedback linearisation of (33) with several axes and a matrix ψ: the law of `linearising`, with an inverse in the place of a quotient.
//!
//! ```text
//! d^k x/dt^k = χ₀(x*) + Y(x*) θ + ψ(x*) u + w                             (33), x ∈ ℝᵐ
//! s = d^(k−1)x/dt^(k−1) − z
//! u = ψ⁻¹ (ż − χ₀ − Y θ̂ − k s)
//! θ̂ = θ    or    θ̂' = Γ Yᵀ s
//! ```
//!
//! z comes from the reference dynamics of [`ReferenceModel`], which are linear and the same for every axis, so the first line of (43) is m times that
//! of one axis, and its degree and reduction are. With Δθ = θ̂ − θ the second line is ṡ = −k s − Y Δθ + w, so
//! V = ½ sᵀs + ½ Δθᵀ Γ⁻¹ Δθ has
//!
//! ```text
//! V̇ = −k sᵀs − sᵀY Δθ + Δθᵀ Yᵀ s + sᵀw = −k sᵀs + sᵀw
//! ```
//!
//! whatever z does. From there on the argument is that of one axis: without w, s is bounded and square-integrable, and s → 0 exponentially
//! where θ is known, or as soon as Y is bounded along the run where it is adapted. None of it asks for more of ψ than that ψ⁻¹ exists; that u
//! stays bounded takes a bound on ‖ψ⁻¹‖ = 1/σ_min(ψ), which is why the run ends where the smallest singular value falls below a floor. The
//! paper has one axis, where σ_min(ψ) = |ψ|.
//!
//! θ̂ may be kept within bounds, entry by entry as of one axis, by the projection of `law::bounds`.

use alloc::vec;
use alloc::vec::Vec;

use super::following::{ChainError, ChainMeasured, Following, positive, vanishes};
use super::reference_model::{ReferenceModelInput, ReferenceModelWork};
use super::{Balance, Controller, ControllerInput, ControllerOutput, Jets, Singularity, Truth};
use crate::LengthError;
use crate::law::ParameterBounds;
use crate::linear::{invert, singular_values};
use crate::plant::{VectorChain, VectorFormulas, VectorFormulasWork};
use crate::reference::Position;
use crate::signal::{Block, Signal};

#[cfg(doc)]
use super::ReferenceModel;

/// Control of (33) with several axes by feedback linearisation, with θ known or adapted.
///
/// State: z, ż, …, z^(ℓ−1), m entries each, then θ̂ if it is adapted. Shown: the reference, s, σ_min(ψ), θ̂ if it is adapted, and x − x_d
/// when it tracks.
///
/// **Source**: (33)–(43) and Remark 6 for each axis; adaptation as in (7). **Measures**: x, ẋ, …, d^(k−1)x/dt^(k−1). **Transmits**: x.
/// **Requires**: what [`Linearising`](super::Linearising) does, with the smallest singular value of ψ away from zero.
/// **Guarantees**: what it does, for every axis.
/// **Deviates from the paper**: its plants have one axis, and it prints no adaptive design for (33).
///
/// ```
/// use forwardstep_core::controller::{ControllerOutput, Controller, Following, ControllerInput, Jets, ReferenceModel, VectorLinearising};
/// use forwardstep_core::expression::Expression;
/// use forwardstep_core::plant::{Plant, VectorChain, VectorFormulas};
/// use forwardstep_core::reference::{Consensus, Heard};
///
/// // ẋ₁ = −x₂ + u₁ + u₂, ẋ₂ = θ x₁ − u₁ + u₂
/// let (x, number) = (Expression::variable, Expression::number);
/// let psi = vec![vec![number(1.0), number(1.0)], vec![number(-1.0), number(1.0)]];
/// let terms = VectorFormulas::new(1, vec![-x(1), number(0.0)], vec![vec![number(0.0)], vec![x(0)]], psi)?;
/// let guide = ReferenceModel::Consensus(Consensus::new([(&[1.0][..], 0.0)])?);
/// let law = VectorLinearising::new(terms.clone(), vec![0.7], Following { guide, gain_per_s: 5.0, floor: 0.1 })?;
/// let (x, state) = ([0.3, -0.4], [0.5, 0.1, 0.0, 0.2]);
/// let given = ControllerInput { measured: law.see(&x)?, heard: Heard::new(&[0.8], &[0.8, 0.1], 2)?, target: Jets::NONE };
/// let (mut input, mut d_state, mut shown) = ([0.0; 2], [0.0; 4], [0.0; 7]);
/// let asked = ControllerOutput { input: &mut input, d_state: &mut d_state, shown: &mut shown };
/// law.evaluate(&mut law.scratch(), given, &state, asked)?;
///
/// let plant = VectorChain { terms, theta: vec![0.7] };
/// let mut dx = [0.0; 2];
/// plant.rate(&mut plant.scratch(), &x, &input, &[], &mut dx)?;
/// for axis in 0..2 {
///     let s = x[axis] - state[axis];
///     assert!((dx[axis] - d_state[axis] + 5.0 * s).abs() < 1e-12);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct VectorLinearising {
    terms: VectorFormulas,
    following: Following,
    /// θ, or θ̂(0).
    theta: Vec<f64>,
    /// The diagonal of Γ, if θ is adapted.
    adaptation: Option<Vec<f64>>,
    bounds: Option<ParameterBounds>,
}

/// Working memory of [`VectorLinearising`].
#[derive(Clone, Debug)]
pub struct VectorLinearisingWork {
    terms: VectorFormulasWork,
    guide: ReferenceModelWork,
    /// ψ, overwritten twice.
    psi: Vec<f64>,
    inverse: Vec<f64>,
    /// ż − χ₀ − Y θ̂ − k s.
    wanted: Vec<f64>,
}

impl VectorLinearising {
    /// For a plant with these terms and the known θ.
    ///
    /// # Errors
    /// [`ChainError`] when the reference does not suit the plant, or lengths differ.
    pub fn new(terms: VectorFormulas, theta: Vec<f64>, following: Following) -> Result<Self, ChainError> {
        positive(&[following.gain_per_s])?;
        following.guide.check(terms.order(), 1)?;
        LengthError::check("theta", terms.parameters(), theta.len())?;
        Ok(VectorLinearising { terms, following, theta, adaptation: None, bounds: None })
    }

    /// For a plant with these terms and unknown θ; `adaptation` is the diagonal of Γ, `estimate_start` is θ̂(0).
    ///
    /// # Errors
    /// [`ChainError`] when the reference does not suit the plant, lengths differ, or a gain is not positive.
    pub fn adaptive(
        terms: VectorFormulas,
        following: Following,
        adaptation: Vec<f64>,
        estimate_start: Vec<f64>,
    ) -> Result<Self, ChainError> {
        LengthError::check("adaptation gains", terms.parameters(), adaptation.len())?;
        positive(&adaptation)?;
        let law = VectorLinearising::new(terms, estimate_start, following)?;
        Ok(VectorLinearising { adaptation: Some(adaptation), ..law })
    }

    /// The same with estimates that are kept within `bounds`.
    ///
    /// # Errors
    /// [`ChainError`] when there is not an entry for each parameter.
    pub fn bounded(self, bounds: ParameterBounds) -> Result<Self, ChainError> {
        bounds.check(self.terms.parameters())?;
        Ok(VectorLinearising { bounds: Some(bounds), ..self })
    }

    fn vectors(&self) -> usize {
        self.following.guide.vectors(self.terms.order())
    }

    /// Where θ̂ stands in the state.
    fn at(&self) -> usize {
        self.vectors() * self.terms.axes()
    }

    /// How many entries θ̂ has; none when θ is known.
    fn estimates(&self) -> usize {
        self.adaptation.as_ref().map_or(0, Vec::len)
    }

    fn shown_len(&self) -> usize {
        let m = self.terms.axes();
        self.at() + m + 1 + self.estimates() + if self.following.guide.tracks() { m } else { 0 }
    }

    /// The rate of θ̂_j that the gradient asks for, and what is let through.
    fn adapted(&self, j: usize, gamma: f64, theta_hat: f64, (regressor, s): (&[f64], &[f64])) -> [f64; 2] {
        let column = regressor.iter().skip(j).step_by(self.terms.parameters());
        let rate = gamma * column.zip(s).map(|(entry, s)| entry * s).sum::<f64>();
        [rate, self.bounds.as_ref().map_or(rate, |bounds| bounds.slowed(j, theta_hat, rate))]
    }
}

impl Controller for VectorLinearising {
    type Plant = VectorChain;
    type Exchange = Position;
    type Measured<'a> = ChainMeasured<'a>;
    type Scratch = VectorLinearisingWork;

    const MEASURES: &'static [&'static str] = &["position", "its derivatives below the order of the plant"];
    const KNOWS_OFFSETS: bool = false;

    fn target_derivatives(&self) -> usize {
        self.following.guide.target_derivatives()
    }

    fn scratch(&self) -> VectorLinearisingWork {
        let m = self.terms.axes();
        let (terms, guide) = (self.terms.work(), self.following.guide.work(m));
        VectorLinearisingWork { terms, guide, psi: vec![0.0; m * m], inverse: vec![0.0; m * m], wanted: vec![0.0; m] }
    }

    fn states(&self) -> Vec<Block> {
        let m = self.terms.axes();
        let mut states: Vec<Block> = (0..self.vectors()).map(|r| (self.following.guide.signal(r), m)).collect();
        states.extend(self.adaptation.as_ref().map(|gamma| (Signal::Estimate, gamma.len())));
        states
    }

    fn shown(&self) -> Vec<Block> {
        let m = self.terms.axes();
        let mut shown: Vec<Block> = (0..self.vectors()).map(|r| (self.following.guide.signal(r), m)).collect();
        shown.extend([(Signal::TrackingError, m), (Signal::Divisor, 1)]);
        shown.extend((self.estimates() > 0).then(|| (Signal::Estimate, self.estimates())));
        shown.extend(self.following.guide.tracks().then_some((Signal::Error, m)));
        shown
    }

    fn reads(&self, signal: Signal) -> bool {
        matches!(signal, Signal::Position | Signal::Velocity | Signal::Derivative(_))
    }

    fn see<'a>(&self, output: &'a [f64]) -> Result<ChainMeasured<'a>, LengthError> {
        LengthError::check("output", self.terms.order() * self.terms.axes(), output.len())?;
        Ok(ChainMeasured { x: output })
    }

    /// s = 0 unless `wanted` says otherwise, and higher derivatives zero.
    fn start(
        &self,
        _: &mut VectorLinearisingWork,
        given: ControllerInput<'_, Self>,
        wanted: &[Vec<f64>],
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        let (k, m) = (self.terms.order(), self.terms.axes());
        LengthError::check("state", self.at() + self.estimates(), state.len())?;
        LengthError::check("x", k * m, given.measured.x.len())?;
        let (reference, estimate) = state.split_at_mut(self.at());
        reference.fill(0.0);
        let top = &given.measured.x[(k - 1) * m..];
        for (z, x) in reference.iter_mut().zip(top) {
            *z = *x;
        }
        for (block, wanted) in reference.chunks_exact_mut(m).zip(wanted) {
            LengthError::check("the start of the reference", m, wanted.len())?;
            block.copy_from_slice(wanted);
        }
        self.following.guide.begin(k, top, given.heard.degree.first().copied().unwrap_or(0.0), reference)?;
        estimate.copy_from_slice(&self.theta[..estimate.len()]);
        Ok(())
    }

    fn evaluate(
        &self,
        work: &mut VectorLinearisingWork,
        given: ControllerInput<'_, Self>,
        state: &[f64],
        asked: ControllerOutput<'_>,
    ) -> Result<(), LengthError> {
        let ControllerOutput { input, d_state, shown } = asked;
        let (k, m, at, p) = (self.terms.order(), self.terms.axes(), self.at(), self.estimates());
        LengthError::check("state", at + p, state.len())?;
        LengthError::check("rate", at + p, d_state.len())?;
        LengthError::check("input", m, input.len())?;
        LengthError::check("shown", self.shown_len(), shown.len())?;
        let x = given.measured.x;
        LengthError::check("x", k * m, x.len())?;
        let VectorLinearisingWork { terms, guide, psi, inverse, wanted } = work;

        let target = if self.following.guide.tracks() { given.target } else { Jets::NONE };
        let leads = ReferenceModelInput { measured: x, state: &state[..at], heard: given.heard, target };
        self.following.guide.rate(k, m, leads, guide, &mut d_state[..at])?;
        self.terms.terms(terms, x)?;

        let (reference, rest) = shown.split_at_mut(at);
        reference.copy_from_slice(&state[..at]);
        let (s, rest) = rest.split_at_mut(m);
        for (s, (x, z)) in s.iter_mut().zip(x[(k - 1) * m..].iter().zip(state)) {
            *s = x - z;
        }
        psi.copy_from_slice(terms.psi());
        [rest[0], _] = singular_values(m, m, psi);

        // u = ψ⁻¹ (ż − χ₀ − Y θ̂ − k s)
        let theta_hat = if self.adaptation.is_some() { &state[at..] } else { &self.theta };
        wanted.fill(0.0);
        terms.add_drift(theta_hat, wanted);
        for (wanted, (dz, s)) in wanted.iter_mut().zip(d_state.iter().zip(&*s)) {
            *wanted = dz - *wanted - self.following.gain_per_s * s;
        }
        psi.copy_from_slice(terms.psi());
        invert(m, psi, inverse);
        for (u, row) in input.iter_mut().zip(inverse.chunks_exact(m)) {
            *u = row.iter().zip(&*wanted).map(|(inverse, wanted)| inverse * wanted).sum();
        }

        for (j, gamma) in self.adaptation.iter().flatten().enumerate() {
            let [_, rate] = self.adapted(j, *gamma, theta_hat[j], (terms.regressor(), s));
            d_state[at + j] = rate;
            rest[1 + j] = theta_hat[j];
        }
        for ((error, x), jet) in rest[1 + p..].iter_mut().zip(x).zip(target) {
            *error = x - jet[0];
        }
        Ok(())
    }

    /// ψ close to a matrix without an inverse.
    fn trouble(&self, _: &[f64], shown: &[f64]) -> Option<Singularity> {
        vanishes(*shown.get(self.at() + self.terms.axes())?, self.following.floor)
    }

    fn settle(&self, _: &mut [f64]) {}

    fn balance(
        &self,
        work: &mut VectorLinearisingWork,
        truth: Truth<'_, VectorChain>,
        _: ControllerInput<'_, Self>,
        state: &[f64],
        shown: &[f64],
    ) -> Result<Balance, LengthError> {
        let (m, at) = (self.terms.axes(), self.at());
        LengthError::check("state", at + self.estimates(), state.len())?;
        LengthError::check("shown", self.shown_len(), shown.len())?;
        let theta = &truth.plant.theta;
        LengthError::check("theta", self.terms.parameters(), theta.len())?;
        let s = &shown[at..at + m];
        let square: f64 = s.iter().map(|s| s * s).sum();
        let power: f64 = s.iter().zip(truth.external).map(|(s, w)| s * w).sum();
        let (mut value, mut dissipation) = (0.5 * square, self.following.gain_per_s * square - power);
        self.terms.terms(&mut work.terms, truth.state)?;
        for (j, gamma) in self.adaptation.iter().flatten().enumerate() {
            let delta = state[at + j] - theta[j];
            value += 0.5 * delta * delta / gamma;
            let [rate, let_through] = self.adapted(j, *gamma, state[at + j], (work.terms.regressor(), s));
            dissipation += delta * (rate - let_through) / gamma;
        }
        Ok(Balance { value, dissipation })
    }
}
