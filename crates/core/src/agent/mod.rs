//! A controller that samples: the same reference dynamics and the same law, stepped.
//!
//! Between two samples nothing is measured and nothing is heard, so the inputs are held. Over such a period of length h
//!
//! ```text
//! reference state      ẋ = A x + b with b held: stepped exactly; one that is not affine by Runge–Kutta    (`hold`)
//! estimate             ϑ̂ ← Π(ϑ̂ − h Γ Yᵀs), Y of the sample before, s of this one, Π onto bounds if there are some
//! torque               computed once from the sample, then held
//! sign                 a value that suits the end of the period, with the neighbours held (`reference::sliding`)
//! ```
//!
//! **Why the estimate waits for s.** With M, Y and ż of a sample held, and w = Y Δϑ, a period does
//!
//! ```text
//! M (s⁺ − s) = h (w − K s),     w⁺ − w = −h P s⁺,     P = Y Γ Yᵀ
//! ```
//!
//! and a mode with the multiplier μ has M (μ − 1)² + h K (μ − 1) + h² P μ = 0. With k and p for hK and h²P along it, in units of M,
//! μ² − (2 − k − p) μ + 1 − k = 0, which is stable for k > 0 and 2k + p < 4. So it is enough that
//!
//! ```text
//! h λ_max(M⁻¹(K + ½ h Y Γ Yᵀ)) < 2
//! ```
//!
//! With s in place of s⁺ (Euler) the last coefficient is 1 − k + p, and p < k is needed besides. Worse, that goes wrong where Y
//! alternates from sample to sample, as it does when a sign chatters. Let Y = Ȳ ± Ỹ. Then s = s̄ ± s̃ with K s̄ = Ȳ Δϑ and
//! (2 M − h K) s̃ = −h Ỹ Δϑ, and on average
//!
//! ```text
//! Euler      Δϑ' = −Γ [Ȳᵀ K⁻¹ Ȳ − h Ỹᵀ (2 M − h K)⁻¹ Ỹ] Δϑ
//! here       Δϑ' = −Γ [Ȳᵀ K⁻¹ Ȳ + h Ỹᵀ (2 M − h K)⁻¹ Ỹ] Δϑ
//! ```
//!
//! since the s that Ỹ causes comes a sample later, when Ỹ has changed its sign. Euler lets what chatter excites grow
//! exponentially, at a rate proportional to h Γ: four arms under (110) with Γ = 50 ran away after five seconds at 1 kHz, whatever K.
//!
//! As h → 0 the loop becomes the continuous one, with an error proportional to h. An [`Agent`] knows no clock: it is told the
//! time of its sample. The simulator steps this very struct, so what runs there is what runs on a robot.

mod error;
mod hold;
mod kernels;
mod limiter;
mod velocity;

pub use error::StepError;
pub(crate) use error::{finite, later};
pub use limiter::{Clipped, Limiter, LimiterError};
pub use velocity::{FilterError, VelocityFilter};

use alloc::vec;
use alloc::vec::Vec;

use crate::law::SlotineLi;
use crate::reference::{Exchange, Measured, Reference};
use crate::robot::Lagrangian;
use crate::{LengthError, dispatch};
use hold::Hold;
use kernels::{Learn, Refer, Track};

/// What an agent knows of its neighbours at one instant: the sums that a linear design needs.
///
/// A message of an agent with m axes is [`Exchange::CHANNELS`] · m numbers: its positions, then its velocities if they are
/// sent, or what [`Agent::transmit`] makes of them; then what the sender's [`Agent::transmitted`] was at the sample before, if its design tells anything.
#[derive(Clone, Copy, Debug)]
pub struct Inbox<'a> {
    /// Σ_j w_ij.
    pub degree: f64,
    /// Σ_j w_ij · message_j, entry by entry.
    pub sums: &'a [f64],
}

/// What an agent asks of its robot until the next sample.
#[derive(Clone, Copy, Debug)]
pub struct Command<'a> {
    /// τ, N m or N per axis, within the limits.
    pub tau: &'a [f64],
    /// The reference velocity z.
    pub z: &'a [f64],
    /// The reference acceleration ż.
    pub dz: &'a [f64],
    /// s = q̇ − z.
    pub s: &'a [f64],
}

/// One robot's controller: reference dynamics and tracking law, stepped at samples.
///
/// **Source**: (5), (6), (7) with any [`Reference`] for one agent.
/// **Measures**: q, q̇ (see [`VelocityFilter`] when there are only encoders). **Transmits**: what the reference says.
/// **Requires**: dynamics that are affine in their own state, the same for each axis, as all of the paper's are, or a period that is
/// short beside what they do; a period h with h · λ_max(M⁻¹(K + ½ h Y Γ Yᵀ)) well below 2, beyond which the held damping itself is unstable, see the head of the file.
/// **Guarantees**: no allocation and no panic in [`Agent::step`]; the continuous law in the limit of short periods.
/// Nothing that the paper states for a fixed period. Numbers beyond 1e308 on the way give a torque that is not finite.
///
/// ```
/// use forwardstep_core::agent::{Agent, Inbox, Limiter};
/// use forwardstep_core::law::SlotineLi;
/// use forwardstep_core::reference::{Consensus, Measured, Position};
/// use forwardstep_core::robot::PointMass;
/// use forwardstep_core::Gain;
///
/// let reference = Consensus::<Position>::new([(&[1.0, 2.0][..], 0.0)]).expect("two positive roots");
/// let damping = Gain::Number(8.0).resolve(1, &[]).expect("a positive gain");
/// let law = SlotineLi { damping, adaptation: None, bounds: None };
/// let mut agent = Agent::new(PointMass { dimension: 1 }, reference, law, vec![2.0], Limiter::none(1))?;
///
/// // One neighbour stands at 1 m and counts 0.5. The agent is at rest at 0 m, and nothing jumps.
/// let inbox = Inbox { degree: 0.5, sums: &[0.5 * 1.0] };
/// let at_rest = Measured { q: &[0.0], dq: &[0.0] };
/// assert_eq!(agent.step(0.0, at_rest, inbox)?.tau, [0.0]);
/// // A period later it has begun to accelerate towards the neighbour.
/// assert!(agent.step(0.001, at_rest, inbox)?.tau[0] > 0.0);
/// # Ok::<(), forwardstep_core::agent::StepError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Agent<R: Lagrangian<f64>, F> {
    robot: R,
    scratch: R::Scratch,
    reference: F,
    law: SlotineLi,
    limiter: Limiter,
    /// Time of the last sample, s.
    last_s: Option<f64>,
    /// The actuators were told something else than the last torque, at this time, s.
    overridden_s: Option<f64>,
    /// The reference state was set from outside.
    started: bool,
    /// z(0), ż(0), …, as many as are wanted.
    wanted: Vec<Vec<f64>>,
    state: Vec<f64>,
    theta_hat: Vec<f64>,
    /// What was measured and heard at the last sample.
    held: Held,
    out: Out,
    /// What the torque of the last sample was computed from.
    applied: Applied,
    hold: Hold,
}

/// The arguments of Y at the last sample.
#[derive(Clone, Debug)]
struct Applied {
    q: Vec<f64>,
    dq: Vec<f64>,
    z: Vec<f64>,
    dz: Vec<f64>,
}

/// Inputs of the last sample.
#[derive(Clone, Debug)]
struct Held {
    q: Vec<f64>,
    dq: Vec<f64>,
    degree: [f64; 1],
    sums: Vec<f64>,
    time_s: f64,
}

/// What followed from them.
#[derive(Clone, Debug)]
struct Out {
    z: Vec<f64>,
    dz: Vec<f64>,
    d_state: Vec<f64>,
    s: Vec<f64>,
    tau: Vec<f64>,
    yt_s: Vec<f64>,
    d_theta_hat: Vec<f64>,
    /// For a set-valued sign: q̈ or ż, and what the sign is taken of.
    transmitted: Vec<f64>,
    e: Vec<f64>,
}

impl<R: Lagrangian<f64>, F: Reference> Agent<R, F> {
    /// Builds the controller of one robot. `theta_hat` is ϑ̂(0), or ϑ when `law` does not adapt.
    ///
    /// Until [`Agent::set_reference`] is called, the first sample sets z(0) = q̇(0) and the derivatives of z to zero.
    ///
    /// # Errors
    /// [`LengthError`] when the parts are not made for one agent with the robot's axes and parameters.
    pub fn new(
        robot: R,
        reference: F,
        law: SlotineLi,
        theta_hat: Vec<f64>,
        limiter: Limiter,
    ) -> Result<Self, LengthError> {
        let (m, p) = (robot.dof(), robot.parameter_count());
        LengthError::check("agents of the reference", 1, reference.agents())?;
        if m == 0 {
            // There is nothing to step.
            return Err(LengthError { what: "the axes of the robot", need: 1, got: 0 });
        }
        LengthError::check("gain K", m, law.damping.size())?;
        if let Some(gamma) = &law.adaptation {
            LengthError::check("gain Γ", p, gamma.size())?;
        }
        LengthError::check("theta", p, theta_hat.len())?;
        LengthError::check("limits", m, limiter.axes())?;
        let n = reference.vectors() * m;
        let transmitted = reference.sliding().map_or(0, |sliding| sliding.transmitted() * m);
        let vector = || vec![0.0; m];
        Ok(Agent {
            scratch: robot.scratch(),
            robot,
            law,
            limiter,
            last_s: None,
            overridden_s: None,
            started: false,
            wanted: Vec::new(),
            state: vec![0.0; n],
            theta_hat,
            held: Held {
                q: vector(),
                dq: vector(),
                degree: [0.0],
                sums: vec![0.0; <F::Exchange as Exchange>::CHANNELS * m + transmitted],
                time_s: 0.0,
            },
            out: Out {
                z: vector(),
                dz: vector(),
                d_state: vec![0.0; n],
                s: vector(),
                tau: vector(),
                yt_s: vec![0.0; p],
                d_theta_hat: vec![0.0; p],
                transmitted: vec![0.0; transmitted],
                e: vector(),
            },
            applied: Applied { q: vector(), dq: vector(), z: vector(), dz: vector() },
            hold: Hold::new(m, reference.vectors(), <F::Exchange as Exchange>::CHANNELS),
            reference,
        })
    }

    /// The state of the reference dynamics at the last sample, block by block.
    pub fn reference_state(&self) -> &[f64] {
        &self.state
    }

    /// ϑ̂ at the last sample.
    pub fn estimate(&self) -> &[f64] {
        &self.theta_hat
    }

    /// What is transmitted at the next sample besides what is measured then: q̈ for (119), ż for (122), else nothing.
    pub fn transmitted(&self) -> &[f64] {
        &self.out.transmitted
    }

    /// Turns q and q̇ as they are measured, an entry per axis each, into a message. Where messages are not measured it becomes
    /// blocks of the reference state as of the last sample; before the first, what they will start with: x̂ = q and what is wanted of
    /// z(0), or y of an agent at rest unless z(0) is wanted.
    ///
    /// # Errors
    /// [`LengthError`] when it has not as many entries as a message that is not measured.
    pub fn transmit(&self, message: &mut [f64]) -> Result<(), LengthError> {
        let Some(held) = <F::Exchange as Exchange>::HELD else { return Ok(()) };
        let m = self.held.q.len();
        let transmitted = <F::Exchange as Exchange>::CHANNELS * m;
        LengthError::check("message", transmitted, message.len())?;
        if self.started {
            message.copy_from_slice(&self.state[held * m..held * m + transmitted]);
        } else {
            self.reference.initial_message(&self.wanted, message);
        }
        Ok(())
    }

    /// Sets the state of the reference dynamics.
    ///
    /// # Errors
    /// [`LengthError`] when it is not [`Reference::vectors`] blocks of an entry per axis.
    pub fn set_reference(&mut self, state: &[f64]) -> Result<(), LengthError> {
        LengthError::check("reference state", self.state.len(), state.len())?;
        self.state.copy_from_slice(state);
        self.started = true;
        Ok(())
    }

    /// Lets the first sample set z(0), ż(0), … to `wanted`, as far as the dynamics leave them free; what is not given is as in
    /// [`Agent::new`].
    ///
    /// # Errors
    /// [`LengthError`] when there are more than the state has blocks besides a sign, or one has not an entry per axis.
    pub fn start_with(&mut self, wanted: Vec<Vec<f64>>) -> Result<(), LengthError> {
        let most = self.reference.vectors().saturating_sub(usize::from(self.reference.sliding().is_some()));
        LengthError::check("start of the reference", most.min(wanted.len()), wanted.len())?;
        for block in &wanted {
            LengthError::check("start of the reference", self.held.q.len(), block.len())?;
        }
        self.wanted = wanted;
        self.started = false;
        Ok(())
    }

    /// What followed from the last sample; zeros before the first.
    pub fn last(&self) -> Command<'_> {
        let Out { z, dz, s, tau, .. } = &self.out;
        Command { tau, z, dz, s }
    }

    /// How many of its torques were beyond a limit.
    pub fn clipped(&self) -> Clipped {
        self.limiter.clipped()
    }

    /// Says that since `now_s` the actuators hold `tau` in place of the last torque, so that the next one changes no faster
    /// from there than it may.
    ///
    /// # Errors
    /// [`LengthError`] when it has not an entry per axis.
    pub fn overridden(&mut self, now_s: f64, tau: &[f64]) -> Result<(), LengthError> {
        LengthError::check("tau", self.limiter.axes(), tau.len())?;
        self.limiter.hold(tau);
        self.overridden_s = later(self.last_s, now_s);
        Ok(())
    }

    /// Takes the sample of time `now_s` and says what to do until the next one.
    ///
    /// The state is moved from the last sample to this one with the inputs of the last, over the time that really passed;
    /// then the new inputs give the torque.
    ///
    /// # Errors
    /// [`StepError`], before anything has changed.
    pub fn step(&mut self, now_s: f64, measured: Measured<'_>, inbox: Inbox<'_>) -> Result<Command<'_>, StepError> {
        let m = self.held.q.len();
        LengthError::check("q", m, measured.q.len())?;
        LengthError::check("dq", m, measured.dq.len())?;
        LengthError::check("sums heard", self.held.sums.len(), inbox.sums.len())?;
        finite("time", &[now_s])?;
        finite("q", measured.q)?;
        finite("dq", measured.dq)?;
        finite("what is heard", &[inbox.degree])?;
        finite("what is heard", inbox.sums)?;
        let passed_s = match self.last_s {
            Some(last_s) if now_s > last_s => Some(now_s - last_s),
            Some(last_s) => return Err(StepError::Time { now_s, last_s }),
            None => None,
        };
        let Agent { robot, scratch, reference, law, limiter, state, theta_hat, held, out, applied, hold, .. } = self;
        let wanted = (!self.started).then_some(&self.wanted[..]);
        dispatch(Refer { reference, hold, wanted, passed_s, now_s, measured, inbox, state, held, out })?;
        self.started = true;
        if let (Some(h), Some(_)) = (passed_s, &law.adaptation) {
            dispatch(Learn { robot, scratch, law, h, applied, theta_hat, held, out })?;
        }
        dispatch(Track { robot, scratch, law, theta_hat, held, out })?;
        for (kept, now) in [
            (&mut applied.q, &held.q),
            (&mut applied.dq, &held.dq),
            (&mut applied.z, &out.z),
            (&mut applied.dz, &out.dz),
        ] {
            kept.copy_from_slice(now);
        }
        limiter
            .apply(self.overridden_s.take().map_or(passed_s, |from_s| Some((now_s - from_s).max(0.0))), &mut out.tau);
        self.last_s = Some(now_s);
        Ok(self.last())
    }
}
