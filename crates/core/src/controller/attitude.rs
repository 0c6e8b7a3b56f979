//! Attitude tracking of a spacecraft with reaction wheels, without angular velocity: (97)–(105).
//!
//! ```text
//! ż = Rᵀω̇_d^I − S(z) ω_d − α₂ (z − ω_d) − α₁ Δq_v,   ω_d = Rᵀω_d^I                      (97)
//! τ = M ż − S(h) z − D(Δq*)ᵀ K ẏ,   h = Rᵀ h_I                                           (99)
//! ẏ + Λ_f y = K Δq*                                                                     (100)
//! D(Δq*) = ½ [ Δq_o* I + S(Δq_v*) ;  −Δq_v*ᵀ ]
//! q̇_z: the attitude that turns with z, in inertial coordinates R z                        (104), (105)
//! ```
//!
//! Δq is the quaternion of R_dᵀR and Δq* that of R_zᵀR. Both R and R_z turn, seen from the body with ω and z, so
//! Δq̇* = D(Δq*)(ω − z), which is (106). Nothing here contains ω: ẏ stands in for it.
//!
//! (94) minus (99) is M(ω̇ − ż) = S(h)(ω − z) − Dᵀ K ẏ, and (100) gives ÿ = −Λ_f ẏ + K D (ω − z). S(h) is skew and K symmetric, so
//! with V = ½ (ω − z)ᵀM(ω − z) + ½ ẏᵀẏ
//!
//! ```text
//! V̇ = −(ω − z)ᵀDᵀK ẏ + ẏᵀK D(ω − z) − ẏᵀΛ_f ẏ = −ẏᵀΛ_f ẏ
//! ```
//!
//! A torque n from outside adds sᵀn with s = ω − z, and moves the true h away from Rᵀ h_I, which the law goes on taking for it:
//! V̇ = −ẏᵀΛ_f ẏ + sᵀn + sᵀ S(h − Rᵀ h_I) z. The last term stays when the torque has ended.
//!
//! From ω̇_d = Rᵀω̇_d^I − S(ω) ω_d and (97) the error Δω = ω − ω_d obeys
//!
//! ```text
//! Δω̇ = −α₂ Δω − α₁ Δq_v + (ω̇ − ż) + α₂ (ω − z) + S(ω − z) ω_d                          (107)
//! ```
//!
//! The paper prints −S(ω − z) ω_d here and −S(h)(ω − z) in the equation of ω̇ − ż; neither changes the law or V̇.
//!
//! q and −q are one attitude, but (97) leads to Δq_o = 1: a start with Δq_o < 0 takes the long way round. The sign of the
//! quaternion at the start chooses between the two: Δq_o ≥ 0 is the short way.
//!
//! Nothing above asks where z, R_z and y start: V̇ is what it is for every start, and V(0) has ½ ẏᵀẏ besides the energy of ω − z
//! where y(0) ≠ Λ_f⁻¹ K Δq*(0).

use alloc::vec;
use alloc::vec::Vec;

use super::{Balance, Controller, ControllerInput, ControllerOutput, Jet, Singularity, Truth};
use crate::attitude::{
    Desired, Quaternion, angle, cross, difference, dot, normalized, rate_inertial, rotate, rotate_back, times,
};
use crate::plant::{Plant, Spacecraft, Wheels};
use crate::reference::Position;
use crate::signal::{Block, Signal};
use crate::{LengthError, ResolvedGain};

/// The attitude of a spacecraft.
#[derive(Clone, Copy, Debug)]
pub struct AttitudeMeasured<'a> {
    /// (q_v, q_o). A norm that is not one does no harm.
    pub q: &'a [f64; 4],
}

/// Attitude tracking without angular velocity.
///
/// State: z (3), q_z (4), y (4). Shown: z, ż, Δq_v, the angle of R_dᵀR, ẏ, τ. The target is a [`Jet`] for each of the four entries of
/// a quaternion of any norm but zero, see [`Desired`].
///
/// The start is z(0) = 0, R_z(0) = R(0), and y(0) = Λ_f⁻¹ K Δq*(0), so that ẏ(0) = 0 and V(0) is the energy
/// ½ (ω − z)ᵀM(ω − z) alone. Others may be wanted: z(0), then the quaternion of R_z(0), of any norm, then y(0); what is empty or
/// missing starts as said.
///
/// **Source**: (97)–(105). **Measures**: attitude. **Transmits**: nothing.
/// **Requires**: α₁, α₂ positive; K and Λ_f symmetric positive definite; M and h_I known; R_d with two bounded derivatives; wheels
/// within their limits.
/// **Guarantees**: Δq_v → 0 and ω − ω_d → 0 from every start.
/// **Deviates from the paper**: several wheels, by (94) with τ = −A u; the signs in (107).
///
/// At the start V is the energy of ω − z, and z is driven by the error of the attitude alone when all is to rest:
///
/// ```
/// use forwardstep_core::Gain;
/// use forwardstep_core::controller::{ControllerOutput, AttitudeTracking, Controller, ControllerInput, Jets, Truth};
/// use forwardstep_core::plant::{Spacecraft, Wheels};
/// use forwardstep_core::reference::Heard;
///
/// let inertia = [[2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 4.0]];
/// let craft = Spacecraft::new(inertia, Wheels::orthogonal(), false)?;
/// // A quaternion, an angular velocity and the momenta of the wheels.
/// let state = [0.6, 0.0, 0.0, 0.8, 0.1, -0.2, 0.3, 0.0, 0.0, 0.0];
/// let law = AttitudeTracking {
///     inertia,
///     momentum_inertial: craft.momentum_inertial(&state)?,
///     wheels: Wheels::orthogonal(),
///     alpha: [1.5, 2.0],
///     filter: Gain::Number(4.0).resolve(4, &[])?,
///     damping: Gain::Number(8.0).resolve(4, &[])?,
/// };
/// let at = |entry: f64| [entry, 0.0, 0.0, 0.0, 0.0];
/// let target = [at(0.0), at(0.0), at(0.0), at(1.0)];
/// let given = ControllerInput { measured: law.see(&state)?, heard: Heard::new(&[0.0], &[0.0; 4], 4)?, target: Jets::from(&target) };
/// let (mut own, mut d_own, mut input, mut shown) = ([0.0; 11], [0.0; 11], [0.0; 3], [0.0; 17]);
/// law.start(&mut (), given, &[], &mut own)?;
/// law.evaluate(&mut (), given, &own, ControllerOutput { input: &mut input, d_state: &mut d_own, shown: &mut shown })?;
/// // (97): ż = −α₁ Δq_v
/// assert!((d_own[0] + 1.5 * 0.6).abs() < 1e-12 && d_own[1].abs() < 1e-12);
/// let balance = law.balance(&mut (), Truth { plant: &craft, state: &state, external: &[] }, given, &own, &shown)?;
/// assert!((balance.value - 0.5 * (2.0 * 0.01 + 3.0 * 0.04 + 4.0 * 0.09)).abs() < 1e-12);
/// assert!(balance.dissipation.abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct AttitudeTracking {
    /// M, kg m².
    pub inertia: [[f64; 3]; 3],
    /// h_I, N m s: the total angular momentum in inertial coordinates.
    pub momentum_inertial: [f64; 3],
    /// How the torque is shared out.
    pub wheels: Wheels,
    /// α₁ in 1/s², α₂ in 1/s.
    pub alpha: [f64; 2],
    /// Λ_f, 4 × 4, 1/s.
    pub filter: ResolvedGain,
    /// K, 4 × 4.
    pub damping: ResolvedGain,
}

/// Entries of the state.
const STATE: usize = 11;
/// Entries of what is shown before ẏ, and in all.
const BEFORE_DY: usize = 10;
const SHOWN: usize = 17;

pub(super) fn three(x: &[f64]) -> [f64; 3] {
    core::array::from_fn(|k| x[k])
}

pub(super) fn four(x: &[f64]) -> [f64; 4] {
    core::array::from_fn(|k| x[k])
}

/// D(Δq)ᵀ g, with S(Δq_v)ᵀ = −S(Δq_v).
pub(super) fn map_transposed(apart: Quaternion, g: [f64; 4]) -> [f64; 3] {
    let turn = cross(three(&apart), three(&g));
    core::array::from_fn(|k| 0.5 * (apart[3] * g[k] - turn[k] - apart[k] * g[3]))
}

/// The attitude in the output of a spacecraft with so many wheels.
pub(super) fn see<'a>(wheels: &Wheels, output: &'a [f64]) -> Result<AttitudeMeasured<'a>, LengthError> {
    LengthError::check("output", 7 + wheels.count(), output.len())?;
    let short = LengthError { what: "attitude", need: 4, got: output.len() };
    output.first_chunk().map(|q| AttitudeMeasured { q }).ok_or(short)
}

/// The start of one part of the state, if it is wanted.
fn stated<const N: usize>(
    wanted: &[Vec<f64>],
    part: usize,
    what: &'static str,
) -> Result<Option<[f64; N]>, LengthError> {
    let Some(given) = wanted.get(part).filter(|given| !given.is_empty()) else { return Ok(None) };
    let wrong = |_| LengthError { what, need: N, got: given.len() };
    given.as_slice().try_into().map(Some).map_err(wrong)
}

impl AttitudeTracking {
    /// ẏ of (100), for the attitude q.
    fn filter_rate(&self, q: Quaternion, q_z: Quaternion, y: &[f64]) -> ([f64; 4], [f64; 4]) {
        let error = difference(q, q_z);
        let mut dy = [0.0; 4];
        self.damping.apply(&error, &mut dy);
        self.filter.subtract_from(y, &mut dy);
        (error, dy)
    }
}

impl Controller for AttitudeTracking {
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
        vec![(Signal::Reference(0), 3), (Signal::ReferenceAttitude, 4), (Signal::Filter, 4)]
    }

    fn shown(&self) -> Vec<Block> {
        vec![
            (Signal::Reference(0), 3),
            (Signal::Reference(1), 3),
            (Signal::Error, 3),
            (Signal::Angle, 1),
            (Signal::FilterRate, 4),
            (Signal::Torque, 3),
        ]
    }

    fn reads(&self, signal: Signal) -> bool {
        signal == Signal::Position
    }

    fn see<'a>(&self, output: &'a [f64]) -> Result<AttitudeMeasured<'a>, LengthError> {
        see(&self.wheels, output)
    }

    fn start(
        &self,
        (): &mut (),
        given: ControllerInput<'_, Self>,
        wanted: &[Vec<f64>],
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        LengthError::check("state", STATE, state.len())?;
        LengthError::check("filter gain", 4, self.filter.size())?;
        LengthError::check("damping gain", 4, self.damping.size())?;
        state.fill(0.0);
        let q = normalized(*given.measured.q);
        let z = stated::<3>(wanted, 0, "the start of the reference")?.unwrap_or_default();
        let q_z = stated(wanted, 1, "the start of the reference attitude")?.map_or(q, normalized);
        let settled = || {
            let mut y = [0.0; 4];
            self.damping.apply(&difference(q, q_z), &mut y);
            self.filter.solve(&mut y);
            y
        };
        let y = stated(wanted, 2, "the start of the filter")?.unwrap_or_else(settled);
        state[..3].copy_from_slice(&z);
        state[3..7].copy_from_slice(&q_z);
        state[7..].copy_from_slice(&y);
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
        LengthError::check("filter gain", 4, self.filter.size())?;
        LengthError::check("damping gain", 4, self.damping.size())?;
        LengthError::check("target", 4, given.target.len())?;
        let path: [Jet; 4] = core::array::from_fn(|k| given.target.jet(k));
        let (q, desired) = (normalized(*given.measured.q), Desired::from_path(&path));
        let (z, q_z, y) = (three(state), four(&state[3..]), four(&state[7..]));

        let (omega_d, pull) = (rotate_back(q, desired.omega), rotate_back(q, desired.d_omega));
        let error = difference(q, desired.q);
        let swing = cross(z, omega_d);
        let dz = core::array::from_fn(|k| {
            pull[k] - swing[k] - self.alpha[1] * (z[k] - omega_d[k]) - self.alpha[0] * error[k]
        });

        let (apart, dy) = self.filter_rate(q, q_z, &y);
        let mut g = [0.0; 4];
        self.damping.apply(&dy, &mut g);
        let damped = map_transposed(apart, g);
        let inertial = times(&self.inertia, dz);
        let coupling = cross(rotate_back(q, self.momentum_inertial), z);
        let tau = core::array::from_fn(|k| inertial[k] - coupling[k] - damped[k]);
        self.wheels.allocate(tau, asked.input);

        asked.d_state[..3].copy_from_slice(&dz);
        asked.d_state[3..7].copy_from_slice(&rate_inertial(q_z, rotate(q, z)));
        asked.d_state[7..].copy_from_slice(&dy);

        asked.shown[..3].copy_from_slice(&z);
        asked.shown[3..6].copy_from_slice(&dz);
        asked.shown[6..9].copy_from_slice(&error[..3]);
        asked.shown[9] = angle(error);
        asked.shown[BEFORE_DY..14].copy_from_slice(&dy);
        asked.shown[14..].copy_from_slice(&tau);
        Ok(())
    }

    fn settle(&self, state: &mut [f64]) {
        if let Some(q_z) = state.get_mut(3..7) {
            let settled = normalized(four(q_z));
            q_z.copy_from_slice(&settled);
        }
    }

    fn trouble(&self, _: &[f64], _: &[f64]) -> Option<Singularity> {
        None
    }

    fn balance(
        &self,
        (): &mut (),
        truth: Truth<'_, Self::Plant>,
        _: ControllerInput<'_, Self>,
        state: &[f64],
        shown: &[f64],
    ) -> Result<Balance, LengthError> {
        LengthError::check("state of the plant", truth.plant.output_len(), truth.state.len())?;
        LengthError::check("state", STATE, state.len())?;
        LengthError::check("shown", SHOWN, shown.len())?;
        let s: [f64; 3] = core::array::from_fn(|k| truth.state[4 + k] - state[k]);
        let dy = four(&shown[BEFORE_DY..]);
        let mut lost = [0.0; 4];
        self.filter.apply(&dy, &mut lost);
        let value = 0.5 * (dot(s, times(truth.plant.inertia(), s)) + dot(dy, dy));
        let mut dissipation = dot(dy, lost);
        if let &[a, b, c] = truth.external {
            let (q, z) = (normalized(four(truth.state)), three(state));
            let (true_h, taken) = (truth.plant.momentum(truth.state)?, rotate_back(q, self.momentum_inertial));
            let apart = core::array::from_fn(|k| true_h[k] - taken[k]);
            dissipation -= dot(s, [a, b, c]) + dot(s, cross(apart, z));
        }
        Ok(Balance { value, dissipation })
    }
}
