//! Reference dynamics from one function of one axis, for those of one's own.

use core::marker::PhantomData;

use super::{Exchange, Heard, Measured, PositionVelocity, Reference, ReferenceOut, Sliding, begin, check};
use crate::LengthError;

/// Reference dynamics that a function states for one axis of one agent.
///
/// State: as many numbers per axis as `vectors` says, of which the first `derivatives` are z, ż, ….
///
/// **Requires**: rates ẋ = A x + b with an A that depends on Σ_j w_ij alone and is the same for each axis, unless
/// [`PerAxis::nonlinear`] says otherwise.
/// **Guarantees**: what is heard is what `X` says; nothing about the long run.
///
/// z̈ = −3 ż − 2 q̇ − Σ_j w_ij (q − q_j(t−T_ij)), in a way of its own:
///
/// ```
/// use forwardstep_core::reference::{AxisInput, AxisOutput, Heard, Measured, PerAxis, Position, Reference, ReferenceOut};
///
/// let design = PerAxis::<Position, _>::new([1, 2, 2], |given: AxisInput<'_, '_, Position>, asked: &mut AxisOutput<'_, '_>| {
///     let (z, dz) = (given.state(0), given.state(1));
///     let ddz = -3.0 * dz - 2.0 * given.dq() - (given.degree() * given.q() - given.heard_position());
///     asked.reference(z, dz);
///     asked.rate(0, dz);
///     asked.rate(1, ddz);
/// });
/// let (mut z, mut dz, mut rate) = ([0.0], [0.0], [0.0; 2]);
/// let out = ReferenceOut { z: &mut z, dz: &mut dz, d_state: &mut rate };
/// design.evaluate(1, Measured { q: &[0.3], dq: &[0.5] }, &[0.4, 0.1], Heard::new(&[2.0], &[1.8], 1)?, out)?;
/// assert_eq!((z, dz), ([0.4], [0.1]));
/// assert!((rate[1] - (-0.3 - 1.0 - (0.6 - 1.8))).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PerAxis<X, F> {
    exchange: PhantomData<X>,
    agents: usize,
    vectors: usize,
    derivatives: usize,
    affine: bool,
    function: F,
}

impl<X, F> PerAxis<X, F>
where
    X: Exchange,
    F: Fn(AxisInput<'_, '_, X>, &mut AxisOutput<'_, '_>),
{
    /// For so many agents, with so many numbers of state per axis, of which so many are z, ż, ….
    pub fn new([agents, vectors, derivatives]: [usize; 3], function: F) -> Self {
        PerAxis { exchange: PhantomData, agents, vectors, derivatives, affine: true, function }
    }

    /// The same for any rates: sampled agents step them by the classical Runge–Kutta method, with what they measured and heard held.
    pub fn nonlinear(self) -> Self {
        PerAxis { affine: false, ..self }
    }
}

/// What is known at one axis of one agent.
#[derive(Clone, Copy, Debug)]
pub struct AxisInput<'a, 'h, X: Exchange> {
    measured: Measured<'a>,
    state: &'a [f64],
    heard: Heard<'h, X>,
    /// Where the axis of the agent stands in a block, and the length of a block.
    entry: usize,
    block: usize,
    agent: usize,
    axis: usize,
}

impl<X: Exchange> AxisInput<'_, '_, X> {
    /// The place of the agent among those that the dynamics were built for.
    pub fn agent(&self) -> usize {
        self.agent
    }

    /// The axis.
    pub fn axis(&self) -> usize {
        self.axis
    }

    /// q, rad or m.
    pub fn q(&self) -> f64 {
        self.measured.q[self.entry]
    }

    /// q̇.
    pub fn dq(&self) -> f64 {
        self.measured.dq[self.entry]
    }

    /// A number of the state; not a number where there is none.
    pub fn state(&self, vector: usize) -> f64 {
        let entry = vector.checked_mul(self.block).and_then(|first| first.checked_add(self.entry));
        entry.and_then(|entry| self.state.get(entry)).copied().unwrap_or(f64::NAN)
    }

    /// The time, s.
    pub fn time_s(&self) -> f64 {
        self.heard.time_s
    }

    /// Σ_j w_ij.
    pub fn degree(&self) -> f64 {
        self.heard.degree[self.agent]
    }

    /// Σ_j w_ij q_j(t − T_ij).
    pub fn heard_position(&self) -> f64 {
        X::position(self.heard.sums, self.entry)
    }
}

impl AxisInput<'_, '_, PositionVelocity> {
    /// Σ_j w_ij q̇_j(t − T_ij).
    pub fn heard_velocity(&self) -> f64 {
        self.heard.sums.dq[self.entry]
    }
}

/// What is asked for at one axis of one agent.
#[derive(Debug)]
pub struct AxisOutput<'a, 'o> {
    out: &'a mut ReferenceOut<'o>,
    entry: usize,
    block: usize,
}

impl AxisOutput<'_, '_> {
    /// z and ż.
    pub fn reference(&mut self, z: f64, dz: f64) {
        (self.out.z[self.entry], self.out.dz[self.entry]) = (z, dz);
    }

    /// The rate of a number of the state; it is zero where none is stated.
    pub fn rate(&mut self, vector: usize, value: f64) {
        let entry = vector.checked_mul(self.block).and_then(|first| first.checked_add(self.entry));
        if let Some(rate) = entry.and_then(|entry| self.out.d_state.get_mut(entry)) {
            *rate = value;
        }
    }
}

impl<X, F> Reference for PerAxis<X, F>
where
    X: Exchange,
    F: Fn(AxisInput<'_, '_, X>, &mut AxisOutput<'_, '_>) + Send + Sync + 'static,
{
    type Exchange = X;

    fn agents(&self) -> usize {
        self.agents
    }

    fn vectors(&self) -> usize {
        self.vectors
    }

    fn derivatives(&self) -> usize {
        self.derivatives
    }

    fn sliding(&self) -> Option<&Sliding> {
        None
    }

    fn is_affine(&self) -> bool {
        self.affine
    }

    #[inline(always)]
    fn evaluate(
        &self,
        axes: usize,
        measured: Measured<'_>,
        state: &[f64],
        heard: Heard<'_, X>,
        mut out: ReferenceOut<'_>,
    ) -> Result<(), LengthError> {
        let n = self.agents;
        check([axes, n, self.vectors], measured, state, heard, &out)?;
        let block = axes * n;
        out.z.fill(0.0);
        out.dz.fill(0.0);
        out.d_state.fill(0.0);
        for entry in 0..block {
            let given = AxisInput { measured, state, heard, entry, block, agent: entry % n, axis: entry / n };
            (self.function)(given, &mut AxisOutput { out: &mut out, entry, block });
        }
        Ok(())
    }

    /// z(0), ż(0), … become what is given; the rest of the state is zero.
    fn start(
        &self,
        axes: usize,
        _: Measured<'_>,
        given: &[f64],
        _: Heard<'_, X>,
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        let block = axes * self.agents;
        begin([self.derivatives, self.vectors].map(|vectors| vectors * block), given, state)
    }
}
