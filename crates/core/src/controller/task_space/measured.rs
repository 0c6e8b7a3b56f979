//! The tip of a robot with uncertain lengths by a measured velocity of the tip. Not from the paper, whose Remark 9 names such laws for
//! contrast: a joint reference velocity is differentiated, and Δẋ stands in its derivative.
//!
//! In the manner of that literature, derived here. With Δẋ = ẋ − ẋ_d from the measured ẋ, and dĴ/dt with θ̂' as in (78),
//!
//! ```text
//! z = Ĵ⁻¹ (ẋ_d − α Δx)              ż = Ĵ⁻¹ (ẍ_d − α Δẋ − (dĴ/dt) z)              s = q̇ − z
//! τ = −K s − κ Ĵᵀ K* Δx + Y(q, q̇, z, ż) ϑ̂
//! ϑ̂' = −Γ Y(q, q̇, z, ż)ᵀ s,   θ̂' = Λ Z(q, q̇)ᵀ K* Δx
//! ```
//!
//! The second line and the third are (80)–(82): z alone is another. It is a function of what is measured in the place of a state:
//! z_r and ż_r of (77) and (78) for the path whose velocity is ẋ_d − α Δx. Where ẋ is measured right, ż is its derivative. With
//! Ĵ q̇ − J q̇ = Z Δθ
//!
//! ```text
//! Δẋ = Ĵ z + Ĵ s − Z Δθ − ẋ_d = −α Δx + Ĵ s − Z Δθ
//! M ṡ + C s = −(K + D) s − κ Ĵᵀ K* Δx + Y Δϑ
//! ```
//!
//! and V = ½ sᵀM s + ½ ΔϑᵀΓ⁻¹Δϑ + (κ/2) [ΔxᵀK*Δx + ΔθᵀΛ⁻¹Δθ] loses
//!
//! ```text
//! V̇ = −sᵀ(K + D) s − κ α ΔxᵀK*Δx
//! ```
//!
//! for κ ΔxᵀK*Ĵ s goes against −κ sᵀĴᵀK*Δx, and −κ ΔxᵀK*Z Δθ against κ ΔθᵀZᵀK*Δx. So s, Δx, Δϑ and Δθ are bounded, s and Δx are
//! square-integrable. Where Ĵ stays regular z is bounded, hence q̇, hence Δẋ, and Δx → 0; then ż is bounded, hence ṡ, and s → 0;
//! Δẍ is bounded too, and Δẋ → 0. Projection of the estimates changes V̇ as it does there.
//!
//! What this costs: ẋ stands in τ, as −α M̂ Ĵ⁻¹ẋ in Y(q, q̇, z, ż) ϑ̂. What is wrong with the measurement, noise or a lag, is multiplied by that
//! and is a torque at once, and where ẋ_d jumps τ does, by K and by Y. Under (76) neither passes but through an integral.
//!
//! Poses and redundant joints are not worked out here: z of a pose would hold Δq_v, whose rate takes ω and ω_d turned by R_e, and with
//! joints to spare the pseudo-inverse and φ would have to be differentiated beside α Δx. Theorem 6 has both.

use alloc::vec;
use alloc::vec::Vec;
use core::mem;

use super::tip::TaskWork;
use super::{TaskMeasured, TaskSpace};
use crate::LengthError;
use crate::controller::{Balance, Controller, ControllerInput, ControllerOutput, Jets, Singularity, Truth};
use crate::law::SlotineLiOutput;
use crate::plant::WatchedTaskArm;
use crate::reference::Position;
use crate::robot::{Lagrangian, TipKinematics, TwoVelocity};
use crate::signal::{Block, Signal};

/// What is measured of a robot and of the motion of its tip.
#[derive(Clone, Copy, Debug)]
pub struct TaskMotionMeasured<'a> {
    /// q, q̇ and x.
    pub at: TaskMeasured<'a>,
    /// ẋ.
    pub dx: &'a [f64],
}

/// Task-space adaptive control of a robot the velocity of whose tip is measured.
///
/// State: ϑ̂, θ̂, det Ĵ(0). Shown: z, ż, s, ϑ̂, θ̂, det Ĵ, x, Δx, ẋ. The numbers are those of [`TaskSpace`], for positions of as many
/// coordinates as there are joints.
///
/// **Source**: own derivation, in the manner of what Remark 9 compares Theorem 6 with. **Measures**: q, q̇, x, ẋ. **Transmits**: nothing.
/// **Requires**: as [`TaskSpace`], and ẋ.
/// **Guarantees**: Δx → 0 and Δẋ → 0.
///
/// V loses sᵀK s + κ α ΔxᵀK*Δx, though neither ϑ nor the lengths are known:
///
/// ```
/// use forwardstep_core::Gain;
/// use forwardstep_core::controller::{ControllerOutput, Balance, Controller, ControllerInput, Jets, TaskSpace, TaskSpaceByVelocity, Truth};
/// use forwardstep_core::law::SlotineLi;
/// use forwardstep_core::plant::{Mechanical, Plant, TaskArm, WatchedTaskArm};
/// use forwardstep_core::reference::Heard;
/// use forwardstep_core::robot::{PlanarArm, PlanarLinks, PlanarTip};
///
/// let number = |k: f64, size: usize| Gain::Number(k).resolve(size, &[]);
/// let tip = PlanarTip { length_m: [1.0, 0.8] };
/// let law = TaskSpaceByVelocity(TaskSpace {
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
/// });
/// let theta = PlanarLinks::uniform([2.0, 1.5], [1.0, 0.8]).theta().to_vec();
/// let arm = Mechanical { robot: PlanarArm, theta };
/// let plant = WatchedTaskArm(TaskArm { arm, tip, tip_theta: vec![1.0, 0.8] });
/// let target = [[0.9, 0.1, 0.0, 0.0, 0.0], [0.8, 0.0, -0.2, 0.0, 0.0]];
/// let total = |blocks: Vec<(_, usize)>| blocks.iter().map(|(_, n)| n).sum::<usize>();
/// let (size, shown_size) = (total(law.states()), total(law.shown()));
///
/// // V and its loss, and where plant and law are after a time h; x is measured, and ẋ.
/// let after = |motion: &[f64], state: &[f64], h: f64| -> Result<(Balance, Vec<f64>, Vec<f64>), Box<dyn std::error::Error>> {
///     let mut output = [0.0; 8];
///     plant.output(&mut plant.scratch(), motion, &mut output)?;
///     let moved: Vec<[f64; 5]> = target.iter().map(|p| [p[0] + h * p[1], p[1] + h * p[2], p[2], 0.0, 0.0]).collect();
///     let given = ControllerInput { measured: law.see(&output)?, heard: Heard::new(&[0.0], &[0.0; 2], 2)?, target: Jets::from(&moved[..]) };
///     let mut state = state.to_vec();
///     if state.is_empty() {
///         state.resize(size, 0.0);
///         law.start(&mut law.scratch(), given, &[], &mut state)?;
///     }
///     let mut scratch = law.scratch();
///     let (mut input, mut d_state, mut shown, mut rate) = ([0.0; 2], vec![0.0; size], vec![0.0; shown_size], [0.0; 4]);
///     law.evaluate(&mut scratch, given, &state, ControllerOutput { input: &mut input, d_state: &mut d_state, shown: &mut shown })?;
///     plant.rate(&mut plant.scratch(), motion, &input, &[], &mut rate)?;
///     let balance = law.balance(&mut scratch, Truth { plant: &plant, state: motion, external: &[] }, given, &state, &shown)?;
///     let step = |x: &[f64], dx: &[f64]| x.iter().zip(dx).map(|(x, dx)| x + 1e-7 * dx).collect();
///     Ok((balance, step(motion, &rate), step(&state, &d_state)))
/// };
/// let (now, motion, state) = after(&[0.2, 1.1, 0.4, -0.3], &[], 0.0)?;
/// let (then, ..) = after(&motion, &state, 1e-7)?;
/// assert!(((then.value - now.value) / 1e-7 + now.dissipation).abs() < 1e-4 * now.dissipation);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct TaskSpaceByVelocity<R, T>(pub TaskSpace<R, T>);

/// Where the blocks of the state begin, after ϑ̂: θ̂, det Ĵ(0), and the end; and how much is shown.
struct Layout {
    kinematic: usize,
    determinant: usize,
    end: usize,
    shown: usize,
}

impl<R, T> TaskSpaceByVelocity<R, T>
where
    R: Lagrangian<f64> + Clone + Send + Sync + 'static,
    T: TipKinematics + Clone,
{
    fn layout(&self) -> Layout {
        let TaskSpace { robot, tip, .. } = &self.0;
        let kinematic = robot.parameter_count();
        let determinant = kinematic + tip.parameter_count();
        let end = determinant + 1;
        Layout { kinematic, determinant, end, shown: 3 * tip.joints() + end + 3 * tip.axes() }
    }

    /// Δx, z in the place of z_r and ż in that of ż_r, and θ̂', into the working memory; returns det Ĵ.
    fn task(
        &self,
        work: &mut TaskWork<R::Scratch>,
        TaskMotionMeasured { at, dx }: TaskMotionMeasured<'_>,
        target: Jets<'_>,
        theta_hat: &[f64],
    ) -> Result<f64, LengthError> {
        let law = &self.0;
        law.check()?;
        // A pose and joints to spare have no place here.
        LengthError::check("coordinates of the end-effector", law.tip.joints(), law.tip.axes())?;
        LengthError::check("rows of the Jacobian", law.tip.axes(), law.tip.rows())?;
        LengthError::check("x", law.tip.axes(), at.x.len())?;
        LengthError::check("dx", law.tip.axes(), dx.len())?;
        law.errors(work, at, target, None)?;
        for k in 0..law.tip.axes() {
            work.dd_target[k] -= law.alpha * (dx[k] - work.d_target[k]);
            work.d_target[k] -= law.alpha * work.error[k];
        }
        law.led(work, at, theta_hat)
    }
}

impl<R, T> Controller for TaskSpaceByVelocity<R, T>
where
    R: Lagrangian<f64> + Clone + Send + Sync + 'static,
    T: TipKinematics + Clone,
{
    type Plant = WatchedTaskArm<R, T>;
    type Exchange = Position;
    type Measured<'a> = TaskMotionMeasured<'a>;
    type Scratch = TaskWork<R::Scratch>;

    const MEASURES: &'static [&'static str] = &["position", "velocity", "task-space position", "task-space velocity"];
    const KNOWS_OFFSETS: bool = false;

    fn target_len(&self, _: usize) -> usize {
        self.0.tip.axes()
    }

    fn target_derivatives(&self) -> usize {
        2
    }

    fn scratch(&self) -> Self::Scratch {
        self.0.work()
    }

    fn states(&self) -> Vec<Block> {
        let TaskSpace { robot, tip, .. } = &self.0;
        vec![
            (Signal::Estimate, robot.parameter_count()),
            (Signal::KinematicEstimate, tip.parameter_count()),
            (Signal::Determinant, 1),
        ]
    }

    fn shown(&self) -> Vec<Block> {
        let tip = &self.0.tip;
        let (n, m) = (tip.joints(), tip.axes());
        let mut shown = vec![(Signal::Reference(0), n), (Signal::Reference(1), n), (Signal::TrackingError, n)];
        shown.extend(self.states());
        shown.extend([(Signal::TaskPosition, m), (Signal::Error, m), (Signal::TaskVelocity, m)]);
        shown
    }

    fn reads(&self, signal: Signal) -> bool {
        self.0.reads(signal) || signal == Signal::TaskVelocity
    }

    fn see<'a>(&self, output: &'a [f64]) -> Result<TaskMotionMeasured<'a>, LengthError> {
        let m = self.0.tip.axes();
        LengthError::check("output", 2 * (self.0.tip.joints() + m), output.len())?;
        let (at, dx) = output.split_at(output.len() - m);
        Ok(TaskMotionMeasured { at: self.0.see(at)?, dx })
    }

    fn start(
        &self,
        work: &mut Self::Scratch,
        given: ControllerInput<'_, Self>,
        _: &[Vec<f64>],
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        let l = self.layout();
        LengthError::check("state", l.end, state.len())?;
        self.0.check()?;
        state[..l.kinematic].copy_from_slice(&self.0.estimate_start);
        state[l.kinematic..l.determinant].copy_from_slice(&self.0.kinematic_start);
        state[l.determinant] = self.task(work, given.measured, given.target, &self.0.kinematic_start)?;
        Ok(())
    }

    fn evaluate(
        &self,
        work: &mut Self::Scratch,
        given: ControllerInput<'_, Self>,
        state: &[f64],
        asked: ControllerOutput<'_>,
    ) -> Result<(), LengthError> {
        let (law, n, l) = (&self.0, self.0.tip.joints(), self.layout());
        LengthError::check("state", l.end, state.len())?;
        LengthError::check("rate", l.end, asked.d_state.len())?;
        LengthError::check("shown", l.shown, asked.shown.len())?;
        let determinant = self.task(work, given.measured, given.target, &state[l.kinematic..l.determinant])?;
        let TaskMotionMeasured { at: TaskMeasured { q, dq, x }, dx } = given.measured;
        let TaskWork { robot, s, yt_s, z_r: z, dz_r: dz, pulled, d_theta_hat, error, .. } = work;
        let (motion, estimate) = (TwoVelocity { q, dq, z, dz }, &state[..l.kinematic]);
        law.law.output(&law.robot, robot, motion, estimate, SlotineLiOutput { s, tau: asked.input, yt_s })?;
        for k in 0..n {
            asked.input[k] -= law.kappa * pulled[k];
        }
        law.law.adaptation_rate(estimate, yt_s, &mut asked.d_state[..l.kinematic]);
        asked.d_state[l.kinematic..l.determinant].copy_from_slice(d_theta_hat);
        asked.d_state[l.determinant] = 0.0;

        let mut rest = asked.shown;
        for block in [z, dz, s, &state[..l.determinant], &[determinant], x, error, dx] {
            let (own, behind) = rest.split_at_mut(block.len());
            own.copy_from_slice(block);
            rest = behind;
        }
        Ok(())
    }

    fn trouble(&self, state: &[f64], shown: &[f64]) -> Option<Singularity> {
        let (n, l) = (self.0.tip.joints(), self.layout());
        self.0.vanishing(*state.get(l.determinant)?, *shown.get(l.determinant + 3 * n)?)
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
        let l = self.layout();
        LengthError::check("state", l.end, state.len())?;
        let (estimate, theta_hat) = state[..l.determinant].split_at(l.kinematic);
        self.task(work, given.measured, given.target, theta_hat)?;
        let z = mem::take(&mut work.z_r);
        let lost = 2.0 * self.0.potential(work);
        let carried = (&z[..], [estimate, theta_hat]);
        let balance = self.0.balanced(work, [truth.state, truth.external], &truth.plant.0, carried, [0.0, lost]);
        work.z_r = z;
        balance
    }
}
