//! Task-space adaptive control without task-space velocity: (76)–(82).
//!
//! ```text
//! ż = ż_r − α (z − z_r) − Ĵᵀ K* Δx,   Δx = x − x_d                                       (76)
//! z_r = Ĵ⁻¹ ẋ_d,   ż_r = Ĵ⁻¹ (ẍ_d − (dĴ/dt) z_r)                                          (77), (78)
//! s = q̇ − z                                                                             (79)
//! τ = −K s − κ Ĵᵀ K* Δx + Y(q, q̇, z, ż) ϑ̂                                               (80)
//! ϑ̂' = −Γ Y(q, q̇, z, ż)ᵀ s,   θ̂' = Λ Z(q, q̇)ᵀ K* Δx                                       (81), (82)
//! ```
//!
//! dĴ/dt contains θ̂' of (82), so that ż_r is the derivative of z_r; nothing contains ẋ. With Ĵ q̇ − J q̇ = Z Δθ,
//!
//! ```text
//! d/dt (z − z_r) = −α (z − z_r) − ĴᵀK*Δx         d/dt Δx = Ĵ (z − z_r) + Ĵ s − Z Δθ
//! M ṡ + C s = −(K + D) s − κ ĴᵀK*Δx + Y Δϑ
//! ```
//!
//! and V = (κ/2) [|z − z_r|² + ΔxᵀK*Δx + ΔθᵀΛ⁻¹Δθ] + ½ sᵀM s + ½ ΔϑᵀΓ⁻¹Δϑ loses
//!
//! ```text
//! V̇ = −sᵀ(K + D) s − κ α |z − z_r|²
//! ```
//!
//! and gains sᵀτ_ext from what acts from outside
//! (the second subsystem of the paper's cascade prints Y(q, q̇, z_r, ż_r) in the adaptation; (81) is what V̇ needs).
//!
//! **With a measured velocity of the tip** z can be a function of what is measured: `measured.rs`, which the paper names for contrast.
//!
//! **Poses** and **redundant joints** are not in the paper; `pose.rs` and `null_space.rs` derive them. Both keep V̇: a pose has another
//! potential in the place of ½ ΔxᵀK*Δx, whose rate is eᵀ(J q̇ − ẋ_d) with another e in the place of K*Δx, and redundant joints
//! another z_r with Ĵ z_r = ẋ_d.
//!
//! **Projection** of θ̂ ([`ParameterBounds`]), when bounds are given and Λ is diagonal: with u = ZᵀK*Δx, V̇ has one more term,
//! κ Σ (c_k − 1) Δθ_k u_k ≤ 0. (81) is a gradient of the same kind: ϑ̂ is kept within the bounds of [`SlotineLi`], with the term that they
//! bring there.

mod balance;
mod measured;
mod null_space;
mod pose;
mod tip;

use alloc::vec;
use alloc::vec::Vec;

pub use measured::{TaskMotionMeasured, TaskSpaceByVelocity};
pub use null_space::NullSpace;
use tip::TaskWork;

use super::{Balance, Controller, ControllerInput, ControllerOutput, Singularity, Truth};
use crate::law::{ParameterBounds, SlotineLi, SlotineLiOutput};
use crate::plant::TaskArm;
use crate::reference::Position;
use crate::robot::{Called, Lagrangian, TipKinematics, TwoVelocity};
use crate::signal::{Block, Signal};
use crate::{LengthError, ResolvedGain};

/// A smallest singular value below this part of the largest is rounding.
const ROUNDING: f64 = 1e-6;

/// What is measured of a robot and its tip.
#[derive(Clone, Copy, Debug)]
pub struct TaskMeasured<'a> {
    /// q.
    pub q: &'a [f64],
    /// q̇.
    pub dq: &'a [f64],
    /// x, the position of the tip. Its orientation is known from q, for the directions of the joints are known.
    pub x: &'a [f64],
}

/// Task-space adaptive control of a robot whose tip is seen.
///
/// State: z, ϑ̂, θ̂, det Ĵ(0). Shown: z, ż, s, ϑ̂, θ̂, det Ĵ, x, Δx. The target has two derivatives for each coordinate of x_d.
///
/// Of poses and redundant joints the smallest singular value of Ĵ stands in the place of det Ĵ. A pose has one state more, the
/// sign that Δq has throughout; what is shown goes on with Δq_v after Δp, Δq_o, the angle, and the quaternion of the tip; and its
/// target goes on with the four entries of a quaternion of any norm but zero, see [`Desired`](crate::attitude::Desired).
///
/// **Source**: (76)–(82). **Measures**: q, q̇, x. **Transmits**: nothing.
/// **Requires**: K*, K, Γ, Λ symmetric positive definite, κ and α positive; x_d with two bounded derivatives; Ĵ not singular
/// along the run.
/// **Guarantees**: Δx → 0 and Δẋ → 0.
/// **Deviates from the paper**: dĴ/dt is said to contain θ̂'; J may have a known part; projection may be asked for; z(0) = q̇(0)
/// unless another start is wanted. Poses and redundant joints are extensions with their own proofs.
///
/// V of the proof loses sᵀK s + κ α |z − z_r|², though neither ϑ nor the lengths are known:
///
/// ```
/// use forwardstep_core::Gain;
/// use forwardstep_core::controller::{ControllerOutput, Balance, Controller, ControllerInput, Jets, TaskSpace, Truth};
/// use forwardstep_core::law::SlotineLi;
/// use forwardstep_core::plant::{Mechanical, Plant, TaskArm};
/// use forwardstep_core::reference::Heard;
/// use forwardstep_core::robot::{PlanarArm, PlanarLinks, PlanarTip};
///
/// let number = |k: f64, size: usize| Gain::Number(k).resolve(size, &[]);
/// let tip = PlanarTip { length_m: [1.0, 0.8] };
/// let law = TaskSpace {
///     robot: PlanarArm,
///     tip,
///     law: SlotineLi { damping: number(8.0, 2)?, adaptation: Some(number(3.0, 5)?), bounds: None },
///     task_gain: number(20.0, 2)?,
///     attitude_gain: 1.0,
///     null_space: None,
///     kappa: 1.5,
///     alpha: 2.0,
///     kinematic_adaptation: Some(number(0.5, 2)?),
///     bounds: None,
///     estimate_start: vec![1.0; 5],
///     kinematic_start: vec![0.9, 0.9],
///     determinant_floor: 0.1,
/// };
/// let theta = PlanarLinks::uniform([2.0, 1.5], [1.0, 0.8]).theta().to_vec();
/// let plant = TaskArm { arm: Mechanical { robot: PlanarArm, theta }, tip, tip_theta: vec![1.0, 0.8] };
/// let target = [[0.9, 0.0, 0.0, 0.0, 0.0], [0.8, 0.0, 0.0, 0.0, 0.0]];
/// let total = |blocks: Vec<(_, usize)>| blocks.iter().map(|(_, n)| n).sum::<usize>();
/// let (size, shown_size) = (total(law.states()), total(law.shown()));
///
/// // V and its loss, and where plant and law are after a short time.
/// let after = |motion: &[f64], state: &[f64], h: f64| -> Result<(Balance, Vec<f64>, Vec<f64>), Box<dyn std::error::Error>> {
///     let mut output = [0.0; 6];
///     plant.output(&mut plant.scratch(), motion, &mut output)?;
///     let given = ControllerInput { measured: law.see(&output)?, heard: Heard::new(&[0.0], &[0.0; 2], 2)?, target: Jets::from(&target) };
///     let mut state = state.to_vec();
///     if state.is_empty() {
///         state.resize(size, 0.0);
///         law.start(&mut law.scratch(), given, &[vec![0.1, -0.2]], &mut state)?;
///     }
///     let mut scratch = law.scratch();
///     let (mut input, mut d_state, mut shown, mut rate) = ([0.0; 2], vec![0.0; size], vec![0.0; shown_size], [0.0; 4]);
///     let asked = ControllerOutput { input: &mut input, d_state: &mut d_state, shown: &mut shown };
///     law.evaluate(&mut scratch, given, &state, asked)?;
///     plant.rate(&mut plant.scratch(), motion, &input, &[], &mut rate)?;
///     let truth = Truth { plant: &plant, state: motion, external: &[] };
///     let balance = law.balance(&mut scratch, truth, given, &state, &shown)?;
///     let moved = |x: &[f64], dx: &[f64]| x.iter().zip(dx).map(|(x, dx)| x + h * dx).collect();
///     Ok((balance, moved(motion, &rate), moved(&state, &d_state)))
/// };
/// let (now, motion, state) = after(&[0.2, 1.1, 0.4, -0.3], &[], 1e-7)?;
/// let (then, ..) = after(&motion, &state, 0.0)?;
/// assert!(((then.value - now.value) / 1e-7 + now.dissipation).abs() < 1e-4 * now.dissipation);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct TaskSpace<R, T> {
    /// The robot, whose ϑ is unknown.
    pub robot: R,
    /// The tip, whose θ is unknown.
    pub tip: T,
    /// K and Γ.
    pub law: SlotineLi,
    /// K*, of a pose K_p: an entry per coordinate of the position.
    pub task_gain: ResolvedGain,
    /// k_o of a pose; counts for nothing where positions alone follow.
    pub attitude_gain: f64,
    /// What redundant joints do beside; counts for nothing where none is. Without it z_r is the shortest that leads the tip.
    pub null_space: Option<NullSpace>,
    /// κ.
    pub kappa: f64,
    /// α, 1/s.
    pub alpha: f64,
    /// Λ; `None` when θ is known and not adapted.
    pub kinematic_adaptation: Option<ResolvedGain>,
    /// Bounds for θ̂; they need a diagonal Λ and count for nothing with a full one.
    pub bounds: Option<ParameterBounds>,
    /// ϑ̂(0), or ϑ when it is known.
    pub estimate_start: Vec<f64>,
    /// θ̂(0), or θ when it is known.
    pub kinematic_start: Vec<f64>,
    /// The run is in trouble when det Ĵ, or the smallest singular value, falls below this share of its first value.
    pub determinant_floor: f64,
}

impl<R, T> Controller for TaskSpace<R, T>
where
    R: Lagrangian<f64> + Clone + Send + Sync + 'static,
    T: TipKinematics + Clone,
{
    type Plant = TaskArm<R, T>;
    type Exchange = Position;
    type Measured<'a> = TaskMeasured<'a>;
    type Scratch = TaskWork<R::Scratch>;

    const MEASURES: &'static [&'static str] = &["position", "velocity", "task-space position"];
    const KNOWS_OFFSETS: bool = false;

    fn target_len(&self, _: usize) -> usize {
        self.followed()
    }

    fn target_derivatives(&self) -> usize {
        2
    }

    fn scratch(&self) -> Self::Scratch {
        self.work()
    }

    fn states(&self) -> Vec<Block> {
        let mut states = vec![
            (Signal::Reference(0), self.tip.joints()),
            (Signal::Estimate, self.robot.parameter_count()),
            (Signal::KinematicEstimate, self.tip.parameter_count()),
            (self.regularity(), 1),
        ];
        if self.tip.turns() {
            states.push((Signal::ErrorScalar, 1));
        }
        states
    }

    fn shown(&self) -> Vec<Block> {
        let n = self.tip.joints();
        let mut shown = vec![
            (Signal::Reference(0), n),
            (Signal::Reference(1), n),
            (Signal::TrackingError, n),
            (Signal::Estimate, self.robot.parameter_count()),
            (Signal::KinematicEstimate, self.tip.parameter_count()),
            (self.regularity(), 1),
            (Signal::TaskPosition, self.tip.axes()),
            (Signal::Error, self.tip.rows()),
        ];
        if self.tip.turns() {
            shown.extend([(Signal::ErrorScalar, 1), (Signal::Angle, 1), (Signal::Attitude, 4)]);
        }
        shown
    }

    fn reads(&self, signal: Signal) -> bool {
        matches!(signal, Signal::Position | Signal::Velocity | Signal::TaskPosition)
    }

    fn see<'a>(&self, output: &'a [f64]) -> Result<TaskMeasured<'a>, LengthError> {
        let n = self.tip.joints();
        LengthError::check("output", 2 * n + self.tip.axes(), output.len())?;
        Ok(TaskMeasured { q: &output[..n], dq: &output[n..2 * n], x: &output[2 * n..] })
    }

    fn start(
        &self,
        work: &mut Self::Scratch,
        given: ControllerInput<'_, Self>,
        wanted: &[Vec<f64>],
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        let l = self.layout();
        LengthError::check("state", l.end, state.len())?;
        self.check()?;
        let z = wanted.first().map_or(given.measured.dq, Vec::as_slice);
        LengthError::check("the start of the reference", l.theta, z.len())?;
        state[..l.theta].copy_from_slice(z);
        state[l.theta..l.kinematic].copy_from_slice(&self.estimate_start);
        state[l.kinematic..l.determinant].copy_from_slice(&self.kinematic_start);
        if self.tip.turns() {
            state[l.sign] = 1.0;
        }
        state[l.determinant] = self.task(work, given.measured, given.target, state)?;
        if self.tip.turns() {
            // Of the two quaternions of the error the nearer to no turn; with a right angle's half, this one.
            state[l.sign] = if work.error_scalar < 0.0 { -1.0 } else { 1.0 };
        }
        if self.regularity() == Signal::SingularValue {
            // Where Ĵ is singular from the start, rounding is no measure.
            state[l.determinant] = state[l.determinant].max(ROUNDING * work.largest);
        }
        Ok(())
    }

    fn evaluate(
        &self,
        work: &mut Self::Scratch,
        given: ControllerInput<'_, Self>,
        state: &[f64],
        asked: ControllerOutput<'_>,
    ) -> Result<(), LengthError> {
        let (m, l) = (self.tip.joints(), self.layout());
        LengthError::check("state", l.end, state.len())?;
        LengthError::check("rate", l.end, asked.d_state.len())?;
        LengthError::check("shown", l.shown, asked.shown.len())?;
        let z = &state[..m];
        let determinant = self.task(work, given.measured, given.target, state)?;
        let (dz, rest) = asked.d_state.split_at_mut(m);
        for k in 0..m {
            dz[k] = work.dz_r[k] - self.alpha * (z[k] - work.z_r[k]) - work.pulled[k];
        }
        let TaskMeasured { q, dq, x } = given.measured;
        let out = SlotineLiOutput { s: &mut work.s, tau: asked.input, yt_s: &mut work.yt_s };
        let motion = TwoVelocity { q, dq, z, dz };
        self.law.output(&Called(&self.robot), &mut work.robot, motion, &state[l.theta..l.kinematic], out)?;
        for k in 0..m {
            asked.input[k] -= self.kappa * work.pulled[k];
        }
        self.law.adaptation_rate(&state[l.theta..l.kinematic], &work.yt_s, &mut rest[..l.kinematic - m]);
        rest[l.kinematic - m..l.determinant - m].copy_from_slice(&work.d_theta_hat);
        rest[l.determinant - m..].fill(0.0);

        let (reference, rest) = asked.shown.split_at_mut(2 * m);
        reference[..m].copy_from_slice(z);
        reference[m..].copy_from_slice(dz);
        let (s, rest) = rest.split_at_mut(m);
        s.copy_from_slice(&work.s);
        let (estimates, rest) = rest.split_at_mut(l.determinant - m);
        estimates.copy_from_slice(&state[m..l.determinant]);
        rest[0] = determinant;
        let (position, rest) = rest[1..].split_at_mut(x.len());
        position.copy_from_slice(x);
        let (error, rest) = rest.split_at_mut(work.error.len());
        error.copy_from_slice(&work.error);
        work.show_attitude(rest);
        Ok(())
    }

    fn trouble(&self, state: &[f64], shown: &[f64]) -> Option<Singularity> {
        let l = self.layout();
        self.vanishing(*state.get(l.determinant)?, *shown.get(l.determinant + 2 * self.tip.joints())?)
    }

    fn settle(&self, _: &mut [f64]) {}

    fn balance(
        &self,
        work: &mut Self::Scratch,
        truth: Truth<'_, Self::Plant>,
        given: ControllerInput<'_, Self>,
        state: &[f64],
        _: &[f64],
    ) -> Result<Balance, LengthError> {
        let (m, l) = (self.tip.joints(), self.layout());
        LengthError::check("state", l.end, state.len())?;
        self.task(work, given.measured, given.target, state)?;
        let (z, mut strayed) = (&state[..m], 0.0);
        for k in 0..m {
            let apart = z[k] - work.z_r[k];
            strayed += apart * apart;
            work.dz_r[k] -= self.alpha * apart + work.pulled[k];
        }
        let estimates = [&state[l.theta..l.kinematic], &state[l.kinematic..l.determinant]];
        self.balanced(work, [truth.state, truth.external], truth.plant, (z, estimates), [strayed; 2])
    }
}
