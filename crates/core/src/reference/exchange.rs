//! What agents tell each other, as types: a design that must not see its neighbours' velocities cannot read them.

use crate::signal::Signal;
use crate::{LengthError, Scalar};

/// What an agent transmits and what the sums over its neighbours look like on the receiving side.
///
/// Agents transmit raw measurements, or blocks of their reference state; the receiver applies its own coefficients. A sender's
/// message of m axes has [`Exchange::CHANNELS`] · m numbers.
pub trait Exchange: Copy + Send + Sync + 'static {
    /// What a message holds, vectors of ℝᵐ.
    const SIGNALS: &'static [Signal];

    /// How many these are.
    const CHANNELS: usize = Self::SIGNALS.len();

    /// Where a message stands: `None` where it is measured, q, or q and q̇. Otherwise it is [`Exchange::CHANNELS`] blocks of the
    /// sender's reference state, from this one on.
    const HELD: Option<usize>;

    /// Σ_j w_ij · message_j(t − T_ij), one column per axis and channel.
    type Sums<'a>: Copy + core::fmt::Debug;

    /// Reads the sums out of one buffer that holds the channels one after the other, `channel` entries each.
    ///
    /// `None` when the buffer is too short.
    fn split(buffer: &[f64], channel: usize) -> Option<Self::Sums<'_>>;

    /// The block of the reference state that is `signal`, if a message holds it as such.
    fn held(signal: Signal) -> Option<usize> {
        Some(Self::HELD? + Self::SIGNALS.iter().position(|held| *held == signal)?)
    }

    /// Checks that every channel has `channel` entries.
    ///
    /// # Errors
    /// [`LengthError`] for the first that has not.
    fn check(sums: Self::Sums<'_>, channel: usize) -> Result<(), LengthError>;

    /// Σ_j w_ij q_j(t − T_ij) of entry `k`.
    fn position(sums: Self::Sums<'_>, k: usize) -> f64;

    /// The part of the receiver's law that these sums enter, on entry `k`: α₀ Σ w q_j, and (α₀/κ₀) Σ w q̇_j if it is sent.
    fn term(sums: Self::Sums<'_>, k: usize, alpha_0: f64, alpha_0_over_kappa_0: f64) -> f64;
}

/// Everything a linear design needs to know of its neighbours: Σ_j w_ij and the weighted sums of their messages.
#[derive(Clone, Copy, Debug)]
pub struct Heard<'a, X: Exchange> {
    /// Σ_j w_ij, one entry per agent.
    pub degree: &'a [f64],
    /// Σ_j w_ij · message_j(t − T_ij).
    pub sums: X::Sums<'a>,
    /// When, t in s, for a protocol that says so. Zero in a population of robots, whose dynamics are the same at all times.
    pub time_s: f64,
}

impl<'a, X: Exchange> Heard<'a, X> {
    /// Reads `sums`, channels of `channel` entries one after the other, at t = 0.
    ///
    /// # Errors
    /// [`LengthError`] when they are too few.
    #[inline(always)]
    pub fn new(degree: &'a [f64], sums: &'a [f64], channel: usize) -> Result<Self, LengthError> {
        let too_short = LengthError { what: "sums heard", need: X::CHANNELS * channel, got: sums.len() };
        Ok(Heard { degree, sums: X::split(sums, channel).ok_or(too_short)?, time_s: 0.0 })
    }

    /// The same at another time.
    #[inline(always)]
    pub fn at(self, time_s: f64) -> Self {
        Heard { time_s, ..self }
    }
}

/// Transmits q_j.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Position;

/// Transmits q_j and q̇_j.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PositionVelocity;

/// Transmits x̂_j and v̂_j, where agent j believes the leader to be and how fast: no measurement, so that none can stand in for it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Estimates;

/// Transmits y_j, in which a reference velocity, its derivative and a position stand together: one number per axis, and no
/// measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Composite;

/// Σ_j w_ij q_j(t − T_ij).
///
/// A design that hears positions only has nothing else to read:
///
/// ```compile_fail,E0609
/// let heard = forwardstep_core::reference::PositionSums { q: &[0.0] };
/// let velocities = heard.dq;
/// ```
#[derive(Clone, Copy, Debug)]
pub struct PositionSums<'a> {
    /// One column per axis.
    pub q: &'a [f64],
}

/// Σ_j w_ij q_j(t − T_ij) and Σ_j w_ij q̇_j(t − T_ij).
#[derive(Clone, Copy, Debug)]
pub struct PositionVelocitySums<'a> {
    /// One column per axis.
    pub q: &'a [f64],
    /// One column per axis.
    pub dq: &'a [f64],
}

/// Σ_j w_ij x̂_j(t − T_ij) and Σ_j w_ij v̂_j(t − T_ij).
///
/// A design that hears estimates cannot read where its neighbours are:
///
/// ```compile_fail,E0609
/// let heard = forwardstep_core::reference::EstimateSums { x: &[0.0], v: &[0.0] };
/// let positions = heard.q;
/// ```
#[derive(Clone, Copy, Debug)]
pub struct EstimateSums<'a> {
    /// One column per axis.
    pub x: &'a [f64],
    /// One column per axis.
    pub v: &'a [f64],
}

/// Σ_j w_ij y_j(t − T_ij).
#[derive(Clone, Copy, Debug)]
pub struct CompositeSums<'a> {
    /// One column per axis.
    pub y: &'a [f64],
}

impl Exchange for Position {
    const SIGNALS: &'static [Signal] = &[Signal::Position];
    const HELD: Option<usize> = None;
    type Sums<'a> = PositionSums<'a>;

    #[inline(always)]
    fn split(buffer: &[f64], channel: usize) -> Option<PositionSums<'_>> {
        Some(PositionSums { q: buffer.get(..channel)? })
    }

    #[inline(always)]
    fn check(sums: PositionSums<'_>, channel: usize) -> Result<(), LengthError> {
        LengthError::check("sum of positions heard", channel, sums.q.len())
    }

    #[inline(always)]
    fn position(sums: PositionSums<'_>, k: usize) -> f64 {
        sums.q[k]
    }

    #[inline(always)]
    fn term(sums: PositionSums<'_>, k: usize, alpha_0: f64, _: f64) -> f64 {
        alpha_0 * sums.q[k]
    }
}

impl Exchange for PositionVelocity {
    const SIGNALS: &'static [Signal] = &[Signal::Position, Signal::Velocity];
    const HELD: Option<usize> = None;
    type Sums<'a> = PositionVelocitySums<'a>;

    #[inline(always)]
    fn split(buffer: &[f64], channel: usize) -> Option<PositionVelocitySums<'_>> {
        let (q, dq) = buffer.split_at_checked(channel)?;
        Some(PositionVelocitySums { q, dq: dq.get(..channel)? })
    }

    #[inline(always)]
    fn check(sums: PositionVelocitySums<'_>, channel: usize) -> Result<(), LengthError> {
        LengthError::check("sum of positions heard", channel, sums.q.len())?;
        LengthError::check("sum of velocities heard", channel, sums.dq.len())
    }

    #[inline(always)]
    fn position(sums: PositionVelocitySums<'_>, k: usize) -> f64 {
        sums.q[k]
    }

    #[inline(always)]
    fn term(sums: PositionVelocitySums<'_>, k: usize, alpha_0: f64, alpha_0_over_kappa_0: f64) -> f64 {
        Scalar::mul_add(alpha_0, sums.q[k], alpha_0_over_kappa_0 * sums.dq[k])
    }
}

impl Exchange for Estimates {
    const SIGNALS: &'static [Signal] = &[Signal::LeaderPosition, Signal::LeaderVelocity];
    const HELD: Option<usize> = Some(0);
    type Sums<'a> = EstimateSums<'a>;

    #[inline(always)]
    fn split(buffer: &[f64], channel: usize) -> Option<EstimateSums<'_>> {
        let (x, v) = buffer.split_at_checked(channel)?;
        Some(EstimateSums { x, v: v.get(..channel)? })
    }

    #[inline(always)]
    fn check(sums: EstimateSums<'_>, channel: usize) -> Result<(), LengthError> {
        LengthError::check("sum of estimated positions heard", channel, sums.x.len())?;
        LengthError::check("sum of estimated velocities heard", channel, sums.v.len())
    }

    #[inline(always)]
    fn position(sums: EstimateSums<'_>, k: usize) -> f64 {
        sums.x[k]
    }

    #[inline(always)]
    fn term(sums: EstimateSums<'_>, k: usize, alpha_0: f64, alpha_0_over_kappa_0: f64) -> f64 {
        Scalar::mul_add(alpha_0, sums.x[k], alpha_0_over_kappa_0 * sums.v[k])
    }
}

impl Exchange for Composite {
    const SIGNALS: &'static [Signal] = &[Signal::Composite];
    const HELD: Option<usize> = Some(1);
    type Sums<'a> = CompositeSums<'a>;

    #[inline(always)]
    fn split(buffer: &[f64], channel: usize) -> Option<CompositeSums<'_>> {
        Some(CompositeSums { y: buffer.get(..channel)? })
    }

    #[inline(always)]
    fn check(sums: CompositeSums<'_>, channel: usize) -> Result<(), LengthError> {
        LengthError::check("sum of composite vectors heard", channel, sums.y.len())
    }

    #[inline(always)]
    fn position(sums: CompositeSums<'_>, k: usize) -> f64 {
        sums.y[k]
    }

    #[inline(always)]
    fn term(sums: CompositeSums<'_>, k: usize, alpha_0: f64, _: f64) -> f64 {
        alpha_0 * sums.y[k]
    }
}
