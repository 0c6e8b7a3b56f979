//! A Lagrangian robot follows a trajectory of its own: (6)–(7) behind reference dynamics for tracking.
//!
//! ```text
//! z^(ℓ) = q_d^(N) − Σ_{r<N} α_r (q_r − q_d^(r)),   N = ℓ + 1,   q₀ = q, q₁ = q̇, q_r = z^(r−1)
//! s = q̇ − z,   τ = −K s + Y(q, q̇, z, ż) ϑ̂,   ϑ̂' = −Γ Y(q, q̇, z, ż)ᵀ s                          (5), (6), (7)
//! ```
//!
//! α₀ … α_{N−1} are those of the Hurwitz polynomial θ^N + Σ α_r θ^r. With one root ℓ = 0 and z = q̇_d − α₀ (q − q_d) is no state: the
//! reference velocity of Slotine and Li, with ż = q̈_d − α₀ (q̇ − q̇_d). With more of them z is integrated, as (43) has it for
//! k = 2, and q̇_d need not be differentiated more than N − 1 times.
//!
//! **Why e = q − q_d vanishes.** V = ½ sᵀM s + ½ ΔϑᵀΓ⁻¹Δϑ has
//!
//! ```text
//! V̇ = −sᵀ(K + D) s + sᵀτ_ext
//! ```
//!
//! whatever z does, so without τ_ext s is bounded and square-integrable, and ϑ̂ is bounded. For ℓ ≥ 1 let x₀ = e and
//! x_r = z^(r−1) − q_d^(r). Then ẋ₀ = x₁ + s, ẋ_r = x_{r+1}, and the last rate is −Σ α_r x_r − α₁ s: a stable linear system whose inputs
//! are s. For ℓ = 0 it is ė = −α₀ e + s. Hence e, ė and all x_r are bounded, ż is, ṡ is, s → 0, and e → 0 with ė.
//!
//! **Desired dynamics** that a user writes down may lead z^(ℓ) as well, with a nonlinear protocol in which agents hear each other's
//! positions. V̇ is the same, so that s is square-integrable; whether e vanishes is what is known of those dynamics.

use alloc::vec;
use alloc::vec::Vec;

use super::reference_model::{ReferenceModel, ReferenceModelInput, ReferenceModelWork};
use super::{Balance, Controller, ControllerInput, ControllerOutput, Singularity, Truth};
use crate::law::{SlotineLi, SlotineLiOutput};
use crate::plant::{Mechanical, Plant};
use crate::reference::Position;
use crate::robot::{Called, Lagrangian, TwoVelocity};
use crate::signal::{Block, Signal};
use crate::{InverseQuadratic, LengthError};

/// q and q̇ of a robot.
#[derive(Clone, Copy, Debug)]
pub struct MotionMeasured<'a> {
    /// q.
    pub q: &'a [f64],
    /// q̇.
    pub dq: &'a [f64],
}

/// Tracking in joint space, with ϑ adapted or known.
///
/// State: z, ż, …, z^(ℓ−1), then ϑ̂ if it is adapted. Shown: z, ż, … as far as they are states, but both in any case; s, ϑ̂ if it is
/// adapted, q − q_d. The target has N derivatives for every axis, two at least.
///
/// **Source**: (5)–(7) after Slotine and Li, with the reference dynamics of [`ReferenceModel`] for k = 2. **Measures**: q, q̇.
/// **Transmits**: nothing, or q where desired dynamics hear it.
/// **Requires**: K and Γ symmetric positive definite; a Hurwitz polynomial; q_d with as many bounded derivatives as that has roots, and
/// two at least.
/// **Guarantees**: q − q_d → 0 and q̇ − q̇_d → 0; under desired dynamics of one's own that s is bounded and square-integrable.
/// **Deviates from the paper**: it has no trajectory for a robot in joint space; the argument at the head of this file is that of
/// its differential cascades.
///
/// ```
/// use forwardstep_core::ResolvedGain;
/// use forwardstep_core::controller::{ControllerOutput, Controller, ControllerInput, ReferenceModel, Jets, JointTracking, Truth};
/// use forwardstep_core::law::SlotineLi;
/// use forwardstep_core::plant::{Mechanical, Plant};
/// use forwardstep_core::reference::Heard;
/// use forwardstep_core::robot::PointMass;
///
/// // A mass of 4 kg comes to rest at zero, its mass known.
/// let robot = PointMass { dimension: 1 };
/// let law = SlotineLi { damping: ResolvedGain::Diagonal(vec![8.0]), adaptation: None, bounds: None };
/// let guide = ReferenceModel::Tracking { alpha: vec![2.0] };
/// let law = JointTracking { robot, guide, law, estimate_start: vec![4.0] };
/// let plant = Mechanical { robot, theta: vec![4.0] };
///
/// let (state, mut tau, mut rate, mut shown) = ([1.0, 0.5], [0.0], [0.0; 2], [0.0; 4]);
/// let given = ControllerInput { measured: law.see(&state)?, heard: Heard::new(&[], &[0.0], 1)?, target: Jets::from(&[[0.0; 5]]) };
/// let mut work = law.scratch();
/// law.evaluate(&mut work, given, &[], ControllerOutput { input: &mut tau, d_state: &mut [], shown: &mut shown })?;
/// plant.rate(&mut plant.scratch(), &state, &tau, &[], &mut rate)?;
/// // z = −2 q and ż = −2 q̇, so V = ½ m s² changes by m s (q̈ − ż) = −K s².
/// let (s, dz) = (0.5 + 2.0, -2.0 * 0.5);
/// let truth = Truth { plant: &plant, state: &state, external: &[] };
/// let balance = law.balance(&mut work, truth, given, &[], &shown)?;
/// assert_eq!((4.0 * s * (rate[1] - dz), balance.dissipation), (-8.0 * s * s, 8.0 * s * s));
/// # Ok::<(), forwardstep_core::LengthError>(())
/// ```
#[derive(Clone, Debug)]
pub struct JointTracking<R> {
    /// The robot, whose ϑ is unknown.
    pub robot: R,
    /// Tracking with one α at least, or desired dynamics written in what is measured.
    pub guide: ReferenceModel,
    /// K and Γ.
    pub law: SlotineLi,
    /// ϑ̂(0), or ϑ when it is known.
    pub estimate_start: Vec<f64>,
}

/// Working memory of [`JointTracking`].
#[derive(Clone, Debug)]
pub struct JointTrackingWork<S> {
    robot: S,
    guide: ReferenceModelWork,
    /// q, then q̇.
    measured: Vec<f64>,
    z: Vec<f64>,
    dz: Vec<f64>,
    s: Vec<f64>,
    damped: Vec<f64>,
    yt_s: Vec<f64>,
    mass: Vec<f64>,
    difference: Vec<f64>,
    inverse_gamma: Option<InverseQuadratic>,
}

impl<R> JointTracking<R>
where
    R: Lagrangian<f64>,
{
    /// Numbers of z, ż, …, z^(ℓ−1).
    fn reference_len(&self) -> usize {
        self.guide.vectors(2) * self.robot.dof()
    }

    /// Entries of ϑ̂ in the state.
    fn estimates(&self) -> usize {
        if self.law.adaptation.is_some() { self.robot.parameter_count() } else { 0 }
    }

    /// Numbers of z and its derivatives that are shown.
    fn shown_reference(&self) -> usize {
        self.reference_len().max(2 * self.robot.dof())
    }

    fn check(&self) -> Result<(), LengthError> {
        let (m, p) = (self.robot.dof(), self.robot.parameter_count());
        LengthError::check("coefficients of the reference", 1, self.guide.roots().min(1))?;
        LengthError::check("damping gain", m, self.law.damping.size())?;
        LengthError::check("start of the estimate", p, self.estimate_start.len())?;
        self.law.adaptation.as_ref().map_or(Ok(()), |gamma| LengthError::check("adaptation gain", p, gamma.size()))
    }

    /// z and ż into the working memory, and the rate of the reference state.
    fn lead(
        &self,
        work: &mut JointTrackingWork<R::Scratch>,
        given: ControllerInput<'_, Self>,
        state: &[f64],
        d_state: &mut [f64],
    ) -> Result<(), LengthError>
    where
        R: Clone + Send + Sync + 'static,
    {
        let (m, ControllerInput { measured: MotionMeasured { q, dq }, heard, target }) = (self.robot.dof(), given);
        LengthError::check("target", m, target.len())?;
        if let ReferenceModel::Tracking { alpha } = &self.guide
            && let [alpha] = alpha[..]
        {
            for (axis, jet) in target.iter().enumerate() {
                let desired = |r: usize| jet.get(r).copied().unwrap_or(f64::NAN);
                work.z[axis] = desired(1) - alpha * (q[axis] - desired(0));
                work.dz[axis] = desired(2) - alpha * (dq[axis] - desired(1));
            }
            return Ok(());
        }
        work.measured[..m].copy_from_slice(q);
        work.measured[m..].copy_from_slice(dq);
        self.guide.rate(
            2,
            m,
            ReferenceModelInput { measured: &work.measured, state, heard, target },
            &mut work.guide,
            d_state,
        )?;
        work.z.copy_from_slice(&state[..m]);
        work.dz.copy_from_slice(&d_state[..m]);
        Ok(())
    }
}

impl<R> Controller for JointTracking<R>
where
    R: Lagrangian<f64> + Clone + Send + Sync + 'static,
{
    type Plant = Mechanical<R>;
    type Exchange = Position;
    type Measured<'a> = MotionMeasured<'a>;
    type Scratch = JointTrackingWork<R::Scratch>;

    const MEASURES: &'static [&'static str] = &["position", "velocity"];
    const KNOWS_OFFSETS: bool = false;

    fn target_derivatives(&self) -> usize {
        // ż holds the second one even where one root asks for the first only.
        self.guide.target_derivatives().max(2)
    }

    fn scratch(&self) -> Self::Scratch {
        let (m, p) = (self.robot.dof(), self.robot.parameter_count());
        JointTrackingWork {
            robot: self.robot.scratch(),
            guide: self.guide.work(m),
            measured: vec![0.0; 2 * m],
            z: vec![0.0; m],
            dz: vec![0.0; m],
            s: vec![0.0; m],
            damped: vec![0.0; m],
            yt_s: vec![0.0; p],
            mass: vec![0.0; m * m],
            difference: vec![0.0; p],
            inverse_gamma: self.law.adaptation.as_ref().and_then(|gamma| InverseQuadratic::new(gamma).ok()),
        }
    }

    fn states(&self) -> Vec<Block> {
        let m = self.robot.dof();
        let mut states: Vec<Block> = (0..self.guide.vectors(2)).map(|r| (Signal::Reference(r as u8), m)).collect();
        states.extend((self.estimates() > 0).then(|| (Signal::Estimate, self.estimates())));
        states
    }

    fn shown(&self) -> Vec<Block> {
        let m = self.robot.dof();
        let references = self.guide.vectors(2).max(2);
        let mut shown: Vec<Block> = (0..references).map(|r| (Signal::Reference(r as u8), m)).collect();
        shown.push((Signal::TrackingError, m));
        shown.extend((self.estimates() > 0).then(|| (Signal::Estimate, self.estimates())));
        shown.push((Signal::Error, m));
        shown
    }

    fn reads(&self, signal: Signal) -> bool {
        matches!(signal, Signal::Position | Signal::Velocity)
    }

    fn see<'a>(&self, output: &'a [f64]) -> Result<MotionMeasured<'a>, LengthError> {
        let m = self.robot.dof();
        LengthError::check("output", 2 * m, output.len())?;
        let (q, dq) = output.split_at(m);
        Ok(MotionMeasured { q, dq })
    }

    fn start(
        &self,
        _: &mut Self::Scratch,
        given: ControllerInput<'_, Self>,
        wanted: &[Vec<f64>],
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        let (m, reference) = (self.robot.dof(), self.reference_len());
        self.check()?;
        LengthError::check("state", reference + self.estimates(), state.len())?;
        let (reference, estimate) = state.split_at_mut(reference);
        reference.fill(0.0);
        // s(0) = 0 unless another start is wanted.
        for (z, dq) in reference.iter_mut().zip(given.measured.dq) {
            *z = *dq;
        }
        for (block, wanted) in reference.chunks_exact_mut(m).zip(wanted) {
            LengthError::check("the start of the reference", m, wanted.len())?;
            block.copy_from_slice(wanted);
        }
        estimate.copy_from_slice(&self.estimate_start[..estimate.len()]);
        Ok(())
    }

    fn evaluate(
        &self,
        work: &mut Self::Scratch,
        given: ControllerInput<'_, Self>,
        state: &[f64],
        asked: ControllerOutput<'_>,
    ) -> Result<(), LengthError> {
        let (m, reference, p) = (self.robot.dof(), self.reference_len(), self.estimates());
        let ControllerOutput { input, d_state, shown } = asked;
        self.check()?;
        LengthError::check("state", reference + p, state.len())?;
        LengthError::check("rate", state.len(), d_state.len())?;
        LengthError::check("shown", self.shown_reference() + p + 2 * m, shown.len())?;
        let MotionMeasured { q, dq } = given.measured;
        let (own, d_own) = (&state[..reference], &mut d_state[..reference]);
        self.lead(work, given, own, d_own)?;
        let JointTrackingWork { robot, z, dz, s, yt_s, .. } = work;
        let theta_hat = if p > 0 { &state[reference..] } else { &self.estimate_start };
        let out = SlotineLiOutput { s: &mut *s, tau: input, yt_s: &mut *yt_s };
        self.law.output(&Called(&self.robot), robot, TwoVelocity { q, dq, z, dz }, theta_hat, out)?;
        if p > 0 {
            self.law.adaptation_rate(theta_hat, yt_s, &mut d_state[reference..]);
        }

        let (shown_reference, rest) = shown.split_at_mut(self.shown_reference());
        shown_reference[..m].copy_from_slice(z);
        shown_reference[m..2 * m].copy_from_slice(dz);
        shown_reference[2 * m..].copy_from_slice(&state[reference.min(2 * m)..reference]);
        rest[..m].copy_from_slice(s);
        rest[m..m + p].copy_from_slice(&state[reference..]);
        for (axis, jet) in given.target.iter().enumerate() {
            rest[m + p + axis] = q[axis] - jet[0];
        }
        Ok(())
    }

    fn settle(&self, _: &mut [f64]) {}

    fn trouble(&self, _: &[f64], _: &[f64]) -> Option<Singularity> {
        None
    }

    fn balance(
        &self,
        work: &mut Self::Scratch,
        truth: Truth<'_, Self::Plant>,
        _: ControllerInput<'_, Self>,
        state: &[f64],
        shown: &[f64],
    ) -> Result<Balance, LengthError> {
        let (m, p) = (self.robot.dof(), self.estimates());
        let (Mechanical { robot, theta }, first) = (truth.plant, self.shown_reference());
        LengthError::check("state of the plant", truth.plant.output_len(), truth.state.len())?;
        LengthError::check("state", self.reference_len() + p, state.len())?;
        LengthError::check("shown", first + p + 2 * m, shown.len())?;
        LengthError::check("theta", self.robot.parameter_count(), theta.len())?;
        let (q, s) = (&truth.state[..m], &shown[first..first + m]);
        let JointTrackingWork { robot: scratch, damped, mass, difference, inverse_gamma, yt_s, .. } = work;
        let robot = Called(robot);
        robot.mass_matrix(scratch, q, theta, mass)?;
        self.law.damping.apply(s, damped);
        let (dq, z) = (&truth.state[m..], &shown[..m]);
        robot.add_damping(scratch, TwoVelocity { q, dq, z, dz: z }, theta, damped)?;
        let (mut value, mut dissipation) = (0.0, 0.0);
        for (k, s_k) in s.iter().enumerate() {
            let momentum: f64 = mass[k * m..(k + 1) * m].iter().zip(s).map(|(mass, s)| mass * s).sum();
            value += 0.5 * s_k * momentum;
            dissipation += s_k * (damped[k] - truth.external.get(k).copied().unwrap_or(0.0));
        }
        if let Some(inverse) = inverse_gamma {
            let estimate = state[self.reference_len()..].iter().zip(theta);
            for (difference, (hat, theta)) in difference.iter_mut().zip(estimate) {
                *difference = hat - theta;
            }
            value += 0.5 * inverse.of(difference);
        }
        if let Some(bounds) = &self.law.bounds {
            let theta_hat = &state[self.reference_len()..];
            let (z, dz) = (&shown[..m], &shown[m..2 * m]);
            let motion = TwoVelocity { q, dq: &truth.state[m..], z, dz };
            robot.regressor_products(scratch, motion, theta_hat, s, damped, yt_s)?;
            dissipation += bounds.gained(theta_hat, theta, yt_s);
        }
        Ok(Balance { value, dissipation })
    }
}
