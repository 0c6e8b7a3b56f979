//! Desired dynamics 𝒵 that a user writes down: linear, of any order, for plants of any order (Section IV-B).
//!
//! For a plant of order k let N ≥ k and ℓ = N − k + 1. What x should do is written in x alone,
//!
//! ```text
//! x^(N) = x_d^(N) − Σ_{r<N} γ_r (x^(r) − x_d^(r)) − Σ_j w_ij [ Σ_{r<N} b_r x^(r) − c₀ x_j(t−T_ij) − c₁ ẋ_j(t−T_ij) ]
//! ```
//!
//! without x_d where no target is followed. z follows x^(k−1), s = x^(k−1) − z, and with a_r = γ_r + b_r Σ_j w_ij the right side
//! becomes z^(ℓ) = 𝒵 in one of three ways (Remark 6), for which x^(N) = z^(ℓ) + s^(ℓ) is (43) with 𝒵 in x and
//!
//! ```text
//! Measured    x^(r) for r < k, z^(r−k+1) above        𝓕 = s^(ℓ) + Σ_{0<r<ℓ} a_{k−1+r} s^(r)
//! Z           the same with z for x^(k−1)             𝓕 = s^(ℓ) + Σ_{0≤r<ℓ} a_{k−1+r} s^(r)
//! X           x^(r) for all r                         𝓕 = s^(ℓ)
//! ```
//!
//! since z^(r) = x^(k−1+r) − s^(r). With s ≡ 0 the three are one motion, and 𝓕 contains no more than s^(ℓ): the cascade has
//! degree ℓ. The third needs derivatives that are not measured; it avoids them in the integration of z, for constant weights:
//! with y = x^(k−1) the equation p^ℓ z = −Σ_{0<m<ℓ} a_{N−m} p^(ℓ−m) y + R, where R has what is measured and heard, is
//!
//! ```text
//! z = v_1,    v̇_m = v_{m+1} − a_{N−m} y  for m < ℓ,    v̇_ℓ = R
//! ```
//!
//! **A nonlinear protocol** adds f to the right side, a function of x, ẋ, …, x^(N−1), of Σ_j w_ij x_j(t−T_ij) and Σ_j w_ij, of x_d and its
//! derivatives, and of t, in which x^(r) is replaced as above. In x alone its arguments z^(r) are x^(k−1+r) − s^(r), so that f stands in 𝒵
//! and in 𝓕; the highest derivative of s is s^(ℓ) still, and so is the degree. With f a target and neighbours may stand in one 𝒵: t, x_d and
//! what is heard hold no s of the agent's own. It is not written in x: what is not measured cannot be integrated through f.
//!
//! (24) of order ℓ is γ_r = α_{r−1}, b_r = α_r, c₀ = α₀; (a5) has c₁ = α₀/κ₀ besides; (a9) is γ_r = α_r with a target.

use alloc::vec::Vec;

use thiserror::Error;

use super::{Exchange, Heard, Measured, Reference, ReferenceOut, Sliding, begin, check};
use crate::expression::{Expression, ExpressionError, Graph, MOST_STEPS, Tape};
use crate::{LengthError, Scalar};

/// In which variables 𝒵 is written: Remark 6.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WrittenIn {
    /// Derivatives of x as far as they are measured, those of z above.
    #[default]
    Measured,
    /// z and its derivatives from x^(k−1) on.
    Z,
    /// x alone: what is not measured is avoided in the integration. For constant weights.
    X,
}

/// Desired dynamics of one kind of agent, as the head of this file has them: linear, or with f.
#[derive(Clone, Debug)]
pub struct DesiredDynamics {
    own: Vec<f64>,
    coupled: Vec<f64>,
    heard: [f64; 2],
    tracks: bool,
    written: WrittenIn,
    protocol: Option<Tape>,
}

/// Desired dynamics without meaning.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum DesiredError {
    /// N = 0.
    #[error("the desired dynamics have no coefficients, but their order is how many there are")]
    Empty,
    /// A coefficient that is no number.
    #[error("coefficient {index} is {value}, but must be finite")]
    NotFinite {
        /// Which one, from zero.
        index: usize,
        /// The offending value.
        value: f64,
    },
    /// What stands beside the weights is of a higher order than the rest.
    #[error("{got} coefficients of the coupling, but below the order of the desired dynamics there are {most}")]
    CouplingTooLong {
        /// N.
        most: usize,
        /// How many there are.
        got: usize,
    },
    /// A function without a value that can be computed, or of more than there is.
    #[error(transparent)]
    Protocol(#[from] ExpressionError),
    /// A nonlinear protocol in x alone.
    #[error("a nonlinear protocol is not written in x, since what is not measured cannot be integrated through it")]
    ProtocolInX,
    /// A target and neighbours at once, without f.
    #[error(
        "the desired dynamics follow a target and hear neighbours, but one of both is what linear ones are for: to do both, state what neighbours \
         add as a nonlinear protocol, and what is known of it"
    )]
    TargetAndNeighbours,
}

impl DesiredDynamics {
    /// From γ_0 … γ_{N−1}, from b_0, b_1, …, at most N of them, and from c₀, c₁; `tracks` says whether x_d is followed.
    ///
    /// # Errors
    /// [`DesiredError`] when there is no γ, a coefficient is not finite, or there are more b than γ.
    pub fn new(
        own: Vec<f64>,
        coupled: Vec<f64>,
        heard: [f64; 2],
        tracks: bool,
        written: WrittenIn,
    ) -> Result<Self, DesiredError> {
        if own.is_empty() {
            return Err(DesiredError::Empty);
        }
        if coupled.len() > own.len() {
            return Err(DesiredError::CouplingTooLong { most: own.len(), got: coupled.len() });
        }
        for list in [&own[..], &coupled, &heard] {
            if let Some(index) = list.iter().position(|value| !value.is_finite()) {
                return Err(DesiredError::NotFinite { index, value: list[index] });
            }
        }
        Ok(DesiredDynamics { own, coupled, heard, tracks, written, protocol: None })
    }

    /// The same with f, whose variables are x, ẋ, …, x^(N−1), Σ_j w_ij x_j, Σ_j w_ij, then x_d, …, x_d^(N) where a target is followed,
    /// and t.
    ///
    /// # Errors
    /// [`DesiredError`] when f has another variable, is too large, or 𝒵 is written in x.
    pub fn with_protocol(self, protocol: &Expression) -> Result<Self, DesiredError> {
        if self.written == WrittenIn::X {
            return Err(DesiredError::ProtocolInX);
        }
        let order = self.order();
        let mut graph = Graph::new(order + 3 + if self.tracks { order + 1 } else { 0 });
        let value = graph.import(protocol)?;
        Ok(DesiredDynamics { protocol: Some(Tape::new(&graph, &[value])?), ..self })
    }

    /// Whether there is an f.
    pub fn is_linear(&self) -> bool {
        self.protocol.is_none()
    }

    /// How many numbers of working memory f takes.
    pub(crate) fn steps(&self) -> usize {
        self.protocol.as_ref().map_or(0, Tape::steps)
    }

    /// N.
    pub fn order(&self) -> usize {
        self.own.len()
    }

    /// γ_0 … γ_{N−1}.
    pub fn own(&self) -> &[f64] {
        &self.own
    }

    /// b_0, b_1, ….
    pub fn coupled(&self) -> &[f64] {
        &self.coupled
    }

    /// c₀ and c₁.
    pub fn heard(&self) -> [f64; 2] {
        self.heard
    }

    /// ℓ for a plant of order `plant`; zero where N is below that.
    pub fn vectors(&self, plant: usize) -> usize {
        (self.own.len() + 1).saturating_sub(plant)
    }

    /// Whether a target is followed.
    pub fn tracks(&self) -> bool {
        self.tracks
    }

    /// The variables it is written in.
    pub fn written(&self) -> WrittenIn {
        self.written
    }

    /// a_r for a Σ_j w_ij of `degree`.
    #[inline(always)]
    fn coefficient(&self, r: usize, degree: f64) -> f64 {
        match self.coupled.get(r) {
            Some(coupled) => degree.mul_add(*coupled, self.own[r]),
            None => self.own[r],
        }
    }

    /// d/dt of z, ż, …, or of v_1, v_2, …, on one axis of a plant of order `plant`.
    ///
    /// `x` gives x^(r) for r < k; `target` is x_d with its derivatives, at least N of them, where one is followed.
    #[inline(always)]
    pub(crate) fn rate<X: Exchange>(
        &self,
        plant: usize,
        place: Place,
        x: impl Fn(usize) -> f64,
        (state, degree, Heard { sums, time_s, .. }): (&[f64], f64, Heard<'_, X>),
        target: Option<&[f64]>,
        (workspace, d_state): (&mut [f64], &mut [f64]),
    ) -> Result<(), LengthError> {
        let (order, vectors) = (self.order(), self.vectors(plant));
        let Place { block, entry } = place;
        let Some(top) = vectors.checked_sub(1) else { return Ok(()) };
        let z = |r: usize| state[r * block + entry];
        let y = x(plant - 1);
        for m in 0..top {
            d_state[m * block + entry] = match self.written {
                WrittenIn::Measured | WrittenIn::Z => z(m + 1),
                WrittenIn::X => self.coefficient(order - 1 - m, degree).neg_mul_add(y, z(m + 1)),
            };
        }
        // x^(r) as it is written; in x alone what is above is in v already.
        let written = |r: usize| match self.written {
            WrittenIn::Z if r + 1 == plant => z(0),
            _ if r < plant => x(r),
            WrittenIn::Measured | WrittenIn::Z => z(r + 1 - plant),
            WrittenIn::X => 0.0,
        };
        let received = X::term(sums, entry, self.heard[0], self.heard[1]);
        d_state[top * block + entry] = match target {
            None => (0..order).fold(received, |rate, r| self.coefficient(r, degree).neg_mul_add(written(r), rate)),
            Some(target) => {
                let desired = |r: usize| target.get(r).copied().unwrap_or(f64::NAN);
                let mut rate = desired(order);
                for (r, own) in self.own.iter().enumerate().rev() {
                    rate -= own * (written(r) - desired(r));
                }
                let coupled = self.coupled.iter().enumerate();
                coupled.fold(rate + received, |rate, (r, coupled)| (degree * coupled).neg_mul_add(written(r), rate))
            }
        };
        let Some(tape) = &self.protocol else { return Ok(()) };
        let last = tape.variables() - 1;
        let variable = |v: usize| match v {
            _ if v < order => written(v),
            _ if v == order => X::position(sums, entry),
            _ if v == order + 1 => degree,
            _ if v == last => time_s,
            _ => target.and_then(|target| target.get(v - order - 2)).copied().unwrap_or(f64::NAN),
        };
        let mut value = [0.0];
        tape.evaluate_at(variable, workspace, &mut value)?;
        d_state[top * block + entry] += value[0];
        Ok(())
    }

    /// From z, ż, … in `state`, as they are to start, to v_1, v_2, …, if that is what is integrated: v_{i+1} is z^(i) with what
    /// it lacks of x^(k−1), of which the derivatives are those of z where s starts at rest.
    pub(crate) fn begin(&self, plant: usize, place: Place, y: f64, degree: f64, state: &mut [f64]) {
        let (order, vectors) = (self.order(), self.vectors(plant));
        let Place { block, entry } = place;
        if self.written != WrittenIn::X {
            return;
        }
        for i in (1..vectors).rev() {
            for m in 1..=i {
                let derivative = if m == i { y } else { state[(i - m) * block + entry] };
                state[i * block + entry] += self.coefficient(order - m, degree) * derivative;
            }
        }
    }
}

/// Where the entry of an axis stands in a block, and how long a block is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) block: usize,
    pub(crate) entry: usize,
}

/// k of a Lagrangian robot.
const ROBOT: usize = 2;

/// The same for a population of Lagrangian robots, for which k = 2 and no target is followed.
///
/// State: `[z, ż, …, z^(ℓ−1)]`, or `[v_1, …, v_ℓ]` where 𝒵 is written in x.
///
/// **Source**: (43), Remark 6. **Measures**: q, q̇. **Transmits**: what `X` says.
/// **Requires**: N ≥ 2; constant weights where 𝒵 is written in x.
/// **Guarantees**: z^(ℓ) = 𝒵. Where that leads to is said by 𝒵.
///
/// (24) of order two, written as desired dynamics:
///
/// ```
/// use forwardstep_core::reference::{
///     Consensus, Desired, DesiredDynamics, Heard, Measured, Position, Reference, ReferenceOut, WrittenIn,
/// };
///
/// let desired = DesiredDynamics::new(vec![0.0, 2.0, 3.0], vec![2.0, 3.0, 1.0], [2.0, 0.0], false, WrittenIn::Measured)?;
/// let desired = Desired::<Position>::new(1, desired).ok_or("of order two at least")?;
/// let consensus = Consensus::<Position>::new([(&[1.0, 2.0][..], 0.0)])?;
/// let rates = |reference: &dyn Reference<Exchange = Position>| {
///     let mut rate = [0.0; 2];
///     let out = ReferenceOut { z: &mut [0.0], dz: &mut [0.0], d_state: &mut rate };
///     let heard = Heard::new(&[0.7], &[0.4], 1)?;
///     reference.evaluate(1, Measured { q: &[0.3], dq: &[-0.2] }, &[0.5, 0.1], heard, out)?;
///     Ok::<_, forwardstep_core::LengthError>(rate)
/// };
/// assert_eq!(rates(&desired)?, rates(&consensus)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Desired<X> {
    exchange: core::marker::PhantomData<X>,
    agents: usize,
    dynamics: DesiredDynamics,
}

impl<X: Exchange> Desired<X> {
    /// For so many agents. `None` when N is below two, f has more than [`MOST_STEPS`] steps, or a target is followed, which a population
    /// has not.
    pub fn new(agents: usize, dynamics: DesiredDynamics) -> Option<Self> {
        let suits = dynamics.order() >= ROBOT && !dynamics.tracks && dynamics.steps() <= MOST_STEPS;
        suits.then_some(Desired { exchange: core::marker::PhantomData, agents, dynamics })
    }
}

impl<X: Exchange> Reference for Desired<X> {
    type Exchange = X;

    fn agents(&self) -> usize {
        self.agents
    }

    fn vectors(&self) -> usize {
        self.dynamics.vectors(ROBOT)
    }

    fn derivatives(&self) -> usize {
        match self.dynamics.written {
            WrittenIn::Measured | WrittenIn::Z => self.vectors(),
            WrittenIn::X => 1,
        }
    }

    fn sliding(&self) -> Option<&Sliding> {
        None
    }

    fn is_affine(&self) -> bool {
        self.dynamics.is_linear()
    }

    #[inline(always)]
    fn evaluate(
        &self,
        axes: usize,
        measured: Measured<'_>,
        state: &[f64],
        heard: Heard<'_, X>,
        out: ReferenceOut<'_>,
    ) -> Result<(), LengthError> {
        let n = self.agents;
        check([axes, n, self.vectors()], measured, state, heard, &out)?;
        let mut rates = |workspace: &mut [f64]| {
            let block = axes * n;
            (0..block).try_for_each(|entry| {
                let x = |r: usize| if r == 0 { measured.q[entry] } else { measured.dq[entry] };
                let given = (state, heard.degree[entry % n], heard);
                self.dynamics.rate::<X>(ROBOT, Place { block, entry }, x, given, None, (workspace, out.d_state))
            })
        };
        match self.dynamics.steps() {
            0 => rates(&mut [])?,
            // A population has no working memory of its own.
            steps => rates([0.0; MOST_STEPS].get_mut(..steps).unwrap_or_default())?,
        }
        let block = axes * n;
        out.z.copy_from_slice(&state[..block]);
        out.dz.copy_from_slice(&out.d_state[..block]);
        Ok(())
    }

    fn start(
        &self,
        axes: usize,
        measured: Measured<'_>,
        given: &[f64],
        heard: Heard<'_, X>,
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        let block = axes * self.agents;
        let need = self.vectors() * block;
        begin([need, need], given, state)?;
        LengthError::check("dq", block, measured.dq.len())?;
        LengthError::check("degree", self.agents, heard.degree.len())?;
        for entry in 0..block {
            let degree = heard.degree[entry % self.agents];
            self.dynamics.begin(ROBOT, Place { block, entry }, measured.dq[entry], degree, state);
        }
        Ok(())
    }
}
