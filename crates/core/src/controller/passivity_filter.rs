//! Attitude tracking by a filter of the attitude error alone, with no reference velocity: what Remark 10 compares Theorem 7 with.
//!
//! In the manner of Akella and of Lizarralde and Wen, derived here for (94) with the letters of Theorem 7. Δq is the quaternion of R_dᵀR,
//! ω_d = Rᵀω_d^I and a = Rᵀω̇_d^I what the target does, seen from the body, and D the matrix of (98):
//!
//! ```text
//! τ = M a − S(h) ω_d − k Δq_v − D(Δq)ᵀ K ẏ,   h = Rᵀ h_I
//! ẏ + Λ_f y = K Δq
//! ```
//!
//! Nothing here contains ω: of Δω = ω − ω_d the filter knows through Δq̇ = D(Δq) Δω, and ẏ stands in for it.
//!
//! Seen from the body ω_d turns away with it: ω̇_d = a − S(ω) ω_d = a − S(Δω) ω_d. (94) less M ω̇_d is then
//!
//! ```text
//! M Δω̇ = S(h) Δω + M S(Δω) ω_d − k Δq_v − Dᵀ K ẏ,   ÿ = −Λ_f ẏ + K D Δω
//! ```
//!
//! and with V = ½ ΔωᵀM Δω + 2k (1 − Δq_o) + ½ ẏᵀẏ, since Δq̇_o = −½ Δq_vᵀΔω and S(h) is skew,
//!
//! ```text
//! V̇ = −ẏᵀΛ_f ẏ + ΔωᵀM S(Δω) ω_d
//! ```
//!
//! The last term is −½ Δωᵀ(M S(ω_d) − S(ω_d) M) Δω, a quadratic form without a trace: it has both signs unless it vanishes. It vanishes
//! where the target keeps still, ω_d = 0, and where M is a multiple of the identity. There V falls; ẏ → 0, then ÿ → 0, which leaves
//! K D Δω → 0 and, since DᵀD = ¼ I, Δω → 0; and from Δω̇ → 0 at last Δq_v → 0. Beside a target that keeps still the torque is
//! −k Δq_v − Dᵀ K ẏ, which needs neither M nor h_I. Elsewhere nothing is shown: the term is quadratic in Δω, which is not measured, and
//! what a torque made of the attitude adds to V̇ is linear in it.
//!
//! A rigid body that thrusters turn is another matter. There M ω̇ = −S(ω) M ω + τ, so that +S(ω_d) M ω_d stands in the place of −S(h) ω_d, and
//! what is left in V̇ is −Δωᵀ S(ω_d) M Δω − ΔωᵀM S(ω_d) Δω, which is zero since one is the transpose of the other with the sign reversed: V falls
//! for every target. That leans on h = M ω. Wheels carry a part of h which no equation of the error knows. Theorem 7 gives the reference its own
//! dynamics (97) instead, so that the error ω − z meets S(h) alone; see [`AttitudeTracking`](super::AttitudeTracking).
//!
//! A torque n from outside adds Δωᵀn, and moves the true h away from Rᵀ h_I, which adds Δωᵀ S(h − Rᵀ h_I) ω_d.

use alloc::vec;
use alloc::vec::Vec;

use super::attitude::{AttitudeMeasured, four, map_transposed, see, three};
use super::{Balance, Controller, ControllerInput, ControllerOutput, Jet, Jets, Singularity, Truth};
use crate::attitude::{Desired, angle, cross, difference, dot, normalized, rotate_back, times};
use crate::plant::{Plant, Spacecraft, Wheels};
use crate::reference::Position;
use crate::signal::{Block, Signal};
use crate::{LengthError, ResolvedGain};

/// Attitude tracking by a filter of the attitude error, without angular velocity and without reference dynamics.
///
/// State: y (4), which starts at Λ_f⁻¹ K Δq(0), so that ẏ(0) = 0. Shown: Δq_v, the angle of R_dᵀR, ẏ, τ. The target is a [`Jet`] for each of
/// the four entries of a quaternion of any norm but zero, see [`Desired`].
///
/// **Source**: Remark 10 speaks of it; derived at the head of this file. **Measures**: attitude. **Transmits**: nothing.
/// **Requires**: k positive; K and Λ_f symmetric positive definite; a target that keeps still, or equal moments of inertia. Then also M and h_I
/// known, and R_d with two bounded derivatives; wheels within their limits.
/// **Guarantees**: Δq_v → 0 and ω − ω_d → 0 from every start. Of other targets nothing is shown.
/// **Deviates from the paper**: it is no law of the paper.
///
/// At the start V is the energy of Δω and of the error, and a target that keeps still is met by k Δq_v alone:
///
/// ```
/// use forwardstep_core::Gain;
/// use forwardstep_core::controller::{ControllerOutput, Controller, ControllerInput, Jets, PassivityFilter, Truth};
/// use forwardstep_core::plant::{Spacecraft, Wheels};
/// use forwardstep_core::reference::Heard;
///
/// let inertia = [[2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 4.0]];
/// let craft = Spacecraft::new(inertia, Wheels::orthogonal(), false)?;
/// // A quaternion, an angular velocity and the momenta of the wheels.
/// let state = [0.6, 0.0, 0.0, 0.8, 0.1, -0.2, 0.3, 0.0, 0.0, 0.0];
/// let law = PassivityFilter {
///     inertia,
///     momentum_inertial: craft.momentum_inertial(&state)?,
///     wheels: Wheels::orthogonal(),
///     error_gain: 1.5,
///     filter: Gain::Number(4.0).resolve(4, &[])?,
///     damping: Gain::Number(8.0).resolve(4, &[])?,
/// };
/// let at = |entry: f64| [entry, 0.0, 0.0, 0.0, 0.0];
/// let target = [at(0.0), at(0.0), at(0.0), at(1.0)];
/// let given = ControllerInput { measured: law.see(&state)?, heard: Heard::new(&[0.0], &[0.0; 4], 4)?, target: Jets::from(&target) };
/// let (mut own, mut d_own, mut input, mut shown) = ([0.0; 4], [0.0; 4], [0.0; 3], [0.0; 11]);
/// law.start(&mut (), given, &[], &mut own)?;
/// law.evaluate(&mut (), given, &own, ControllerOutput { input: &mut input, d_state: &mut d_own, shown: &mut shown })?;
/// // The wheel takes what the body is given: u = −τ = k Δq_v.
/// assert!((input[0] - 1.5 * 0.6).abs() < 1e-12 && input[1].abs() < 1e-12);
/// let balance = law.balance(&mut (), Truth { plant: &craft, state: &state, external: &[] }, given, &own, &shown)?;
/// let energy = 0.5 * (2.0 * 0.01 + 3.0 * 0.04 + 4.0 * 0.09);
/// assert!((balance.value - energy - 2.0 * 1.5 * (1.0 - 0.8)).abs() < 1e-12);
/// assert!(balance.dissipation.abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PassivityFilter {
    /// M, kg m².
    pub inertia: [[f64; 3]; 3],
    /// h_I, N m s: the total angular momentum in inertial coordinates.
    pub momentum_inertial: [f64; 3],
    /// How the torque is shared out.
    pub wheels: Wheels,
    /// k, N m.
    pub error_gain: f64,
    /// Λ_f, 4 × 4, 1/s.
    pub filter: ResolvedGain,
    /// K, 4 × 4.
    pub damping: ResolvedGain,
}

/// Entries of the state.
const STATE: usize = 4;
/// Entries of what is shown before ẏ, and in all.
const BEFORE_DY: usize = 4;
const SHOWN: usize = 11;

/// What the target does at an instant.
fn desired(target: Jets<'_>) -> Result<Desired, LengthError> {
    LengthError::check("target", 4, target.len())?;
    let path: [Jet; 4] = core::array::from_fn(|k| target.jet(k));
    Ok(Desired::from_path(&path))
}

impl PassivityFilter {
    fn gains(&self) -> Result<(), LengthError> {
        LengthError::check("filter gain", 4, self.filter.size())?;
        LengthError::check("damping gain", 4, self.damping.size())
    }
}

impl Controller for PassivityFilter {
    type Plant = Spacecraft;
    type Exchange = Position;
    type Measured<'a> = AttitudeMeasured<'a>;
    type Scratch = ();

    const MEASURES: &'static [&'static str] = &["attitude"];
    const KNOWS_OFFSETS: bool = false;

    fn target_derivatives(&self) -> usize {
        2
    }

    fn scratch(&self) {}

    fn states(&self) -> Vec<Block> {
        vec![(Signal::Filter, 4)]
    }

    fn shown(&self) -> Vec<Block> {
        vec![(Signal::Error, 3), (Signal::Angle, 1), (Signal::FilterRate, 4), (Signal::Torque, 3)]
    }

    fn reads(&self, signal: Signal) -> bool {
        signal == Signal::Position
    }

    fn see<'a>(&self, output: &'a [f64]) -> Result<AttitudeMeasured<'a>, LengthError> {
        see(&self.wheels, output)
    }

    /// `wanted` is not read: there is no z.
    fn start(
        &self,
        (): &mut (),
        given: ControllerInput<'_, Self>,
        _: &[Vec<f64>],
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        LengthError::check("state", STATE, state.len())?;
        self.gains()?;
        let error = difference(normalized(*given.measured.q), desired(given.target)?.q);
        self.damping.apply(&error, state);
        self.filter.solve(state);
        Ok(())
    }

    fn evaluate(
        &self,
        (): &mut (),
        given: ControllerInput<'_, Self>,
        state: &[f64],
        asked: ControllerOutput<'_>,
    ) -> Result<(), LengthError> {
        LengthError::check("state", STATE, state.len())?;
        LengthError::check("rate", STATE, asked.d_state.len())?;
        LengthError::check("input", self.wheels.count(), asked.input.len())?;
        LengthError::check("shown", SHOWN, asked.shown.len())?;
        self.gains()?;
        let (q, desired) = (normalized(*given.measured.q), desired(given.target)?);
        let (omega_d, pull) = (rotate_back(q, desired.omega), rotate_back(q, desired.d_omega));
        let error = difference(q, desired.q);

        let (mut dy, mut g) = ([0.0; 4], [0.0; 4]);
        self.damping.apply(&error, &mut dy);
        self.filter.subtract_from(state, &mut dy);
        self.damping.apply(&dy, &mut g);
        let (inertial, damped) = (times(&self.inertia, pull), map_transposed(error, g));
        let coupling = cross(rotate_back(q, self.momentum_inertial), omega_d);
        let tau = core::array::from_fn(|k| inertial[k] - coupling[k] - self.error_gain * error[k] - damped[k]);
        self.wheels.allocate(tau, asked.input);

        asked.d_state.copy_from_slice(&dy);
        asked.shown[..3].copy_from_slice(&error[..3]);
        asked.shown[3] = angle(error);
        asked.shown[BEFORE_DY..8].copy_from_slice(&dy);
        asked.shown[8..].copy_from_slice(&tau);
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
        LengthError::check("state of the plant", truth.plant.output_len(), truth.state.len())?;
        LengthError::check("state", STATE, state.len())?;
        LengthError::check("shown", SHOWN, shown.len())?;
        let (q, desired) = (normalized(four(truth.state)), desired(given.target)?);
        let omega_d = rotate_back(q, desired.omega);
        let off: [f64; 3] = core::array::from_fn(|k| truth.state[4 + k] - omega_d[k]);
        let (error, dy) = (difference(q, desired.q), four(&shown[BEFORE_DY..]));
        let mut lost = [0.0; 4];
        self.filter.apply(&dy, &mut lost);
        let carried = times(truth.plant.inertia(), off);
        let value = 0.5 * (dot(off, carried) + dot(dy, dy)) + 2.0 * self.error_gain * (1.0 - error[3]);
        // ΔωᵀM S(Δω) ω_d
        let mut dissipation = dot(dy, lost) - dot(carried, cross(off, omega_d));
        if let [_, _, _] = truth.external {
            let (true_h, taken) = (truth.plant.momentum(truth.state)?, rotate_back(q, self.momentum_inertial));
            let apart = core::array::from_fn(|k| true_h[k] - taken[k]);
            dissipation -= dot(off, three(truth.external)) + dot(off, cross(apart, omega_d));
        }
        Ok(Balance { value, dissipation })
    }
}
