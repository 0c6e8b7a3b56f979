//! Agents of one kind, side by side in columns.
//!
//! The state of a population of n agents with m axes, order ℓ and p parameters is a block of columns of n numbers,
//!
//! ```text
//! q [m]   q̇ [m]   z, ż, …, z^(ℓ−1) [ℓ·m]   ϑ̂ [p, if adapted]   ∫ sᵀ(K+D)s − sᵀτ_ext [1, if the ledger is on]
//! ```
//!
//! and its right-hand side is computed in stages: heard → reference dynamics (which give ż) → τ and Yᵀs → q̈ → rates.
//! There is no algebraic loop, since z̈ never enters τ. Robots are worked on in [`Squad`]s, as many at once as the scalar
//! `S` has lanes; the bits do not depend on how many that is.

use forwardstep_core::law::{SlotineLi, SlotineLiOutput};
use forwardstep_core::reference::{Consensus, Exchange, Heard, Measured};
use forwardstep_core::robot::{Lagrangian, TwoVelocity};
use forwardstep_core::{InverseQuadratic, Kernel, LengthError, Packed, ResolvedGain, dispatch};

use crate::recording::Signal;

/// One agent of a population.
#[derive(Debug)]
pub(crate) struct Member {
    /// Index among all agents.
    pub(crate) agent: usize,
    /// The true ϑ.
    pub(crate) theta: Vec<f64>,
    /// D, one entry per axis.
    pub(crate) viscous: Vec<f64>,
    /// Its law.
    pub(crate) law: SlotineLi,
    /// xᵀ Γ⁻¹ x, when ϑ is adapted.
    pub(crate) estimate_cost: Option<InverseQuadratic>,
    /// Torque limits to be enforced, one entry per axis.
    pub(crate) effort_limits: Option<Vec<f64>>,
}

/// What the closed loop asks of a population, whatever its robots and its exchange.
pub(crate) trait Columns {
    /// Numbers of state.
    fn state_len(&self) -> usize;
    /// d/dt of the block `x`; `degree` and `sums` are the population's part of what is heard.
    fn rates(&mut self, x: &[f64], degree: &[f64], sums: &[f64], dx: &mut [f64]);
    /// Hands the signals of every member in turn to `write`, in the order of [`Columns::signals`].
    fn record(&mut self, x: &[f64], degree: &[f64], sums: &[f64], write: &mut dyn FnMut(usize, &[f64]));
    /// Signals and axes of one member, in the order in which they are recorded.
    fn signals(&self) -> Vec<(Signal, usize)>;
    /// Which member, signal and axis a state of the block is.
    fn locate(&self, state: usize) -> (usize, Signal, usize);
}

/// Where the parts of a block begin.
#[derive(Clone, Copy, Debug)]
struct Layout {
    /// Agents, axes, parameters, order.
    n: usize,
    m: usize,
    p: usize,
    order: usize,
    /// First entries.
    dq: usize,
    reference: usize,
    theta_hat: usize,
    ledger: usize,
    len: usize,
    adaptive: bool,
    ledger_on: bool,
}

/// A population of robots `R` that exchange `X`, worked on in lanes of `S`.
pub(crate) struct Population<R: Lagrangian<f64> + Lagrangian<S>, X: Exchange, S: Packed> {
    robot: R,
    members: Vec<Member>,
    squads: Vec<Squad<S>>,
    consensus: Consensus<X>,
    layout: Layout,
    work: Work<S, <R as Lagrangian<S>>::Scratch>,
    record: RecordWork<<R as Lagrangian<f64>>::Scratch>,
}

/// The constants of as many neighbouring members as `S` has lanes. Lanes beyond the last member repeat it.
struct Squad<S> {
    /// Index of the first member.
    first: usize,
    law: SlotineLi<S>,
    theta: Vec<S>,
    viscous: Vec<S>,
    effort_limits: Option<Vec<S>>,
}

/// Working memory of one squad.
struct Work<S, T> {
    scratch: T,
    q: Vec<S>,
    dq: Vec<S>,
    z: Vec<S>,
    dz: Vec<S>,
    s: Vec<S>,
    tau: Vec<S>,
    applied: Vec<S>,
    ddq: Vec<S>,
    damped: Vec<S>,
    theta_hat: Vec<S>,
    yt_s: Vec<S>,
    d_theta_hat: Vec<S>,
}

/// Working memory of recording, one member at a time.
struct RecordWork<T> {
    scratch: T,
    d_reference: Vec<f64>,
    q: Vec<f64>,
    s: Vec<f64>,
    mass: Vec<f64>,
    delta: Vec<f64>,
    row: Vec<f64>,
}

impl<R, X, S> Population<R, X, S>
where
    R: Lagrangian<f64> + Lagrangian<S>,
    X: Exchange,
    S: Packed,
{
    /// `members` share the robot and the order; all adapt or none.
    pub(crate) fn new(robot: R, members: Vec<Member>, consensus: Consensus<X>, ledger_on: bool) -> Self {
        let (m, p) = (Lagrangian::<f64>::dof(&robot), Lagrangian::<f64>::parameter_count(&robot));
        let adaptive = members.iter().all(|member| member.law.adaptation.is_some());
        let layout = Layout::new([members.len(), m, p, consensus.order()], adaptive, ledger_on);
        let squads = (0..members.len()).step_by(S::WIDTH).map(|first| Squad::new(first, &members)).collect();
        let (vector, parameters) = (|| vec![S::ZERO; m], || vec![S::ZERO; p]);
        let work = Work {
            scratch: Lagrangian::<S>::scratch(&robot),
            q: vector(),
            dq: vector(),
            z: vector(),
            dz: vector(),
            s: vector(),
            tau: vector(),
            applied: vector(),
            ddq: vector(),
            damped: vector(),
            theta_hat: parameters(),
            yt_s: parameters(),
            d_theta_hat: parameters(),
        };
        let record = RecordWork {
            scratch: Lagrangian::<f64>::scratch(&robot),
            d_reference: vec![0.0; layout.theta_hat - layout.reference],
            q: vec![0.0; m],
            s: vec![0.0; m],
            mass: vec![0.0; m * m],
            delta: vec![0.0; p],
            row: Vec::new(),
        };
        let mut population = Population { robot, members, squads, consensus, layout, work, record };
        population.record.row = vec![0.0; population.signals().len()];
        population
    }

    /// Reference rates of everybody, then everything else squad by squad.
    #[inline(always)]
    fn rates_inlined(&mut self, x: &[f64], degree: &[f64], sums: &[f64], dx: &mut [f64]) -> Result<(), LengthError> {
        let l = self.layout;
        LengthError::check("state", l.len, x.len())?;
        LengthError::check("rate", l.len, dx.len())?;
        let block = l.m * l.n;
        let (q, dq, reference) = (&x[..block], &x[l.dq..l.reference], &x[l.reference..l.theta_hat]);
        let Some(sums) = X::split(sums, block) else { return Ok(()) };
        let heard = Heard::<f64, X> { degree, sums };

        dx[..block].copy_from_slice(dq);
        self.consensus.rate(l.m, Measured { q, dq }, reference, heard, &mut dx[l.reference..l.theta_hat])?;
        for squad in &self.squads {
            // ż is a state but for order one, where it is the rate just computed.
            let dz = if l.order == 1 { &dx[l.reference..][..block] } else { &reference[block..2 * block] };
            self.work.read(l, squad.first, x, dz);
            squad.act(l, &self.robot, &mut self.work)?;
            self.work.write(l, squad, dx);
        }
        Ok(())
    }

    /// Fills the row of the member in one lane of the squad whose signals are in the working memory.
    fn fill_row(&mut self, l: Layout, member: usize, lane: usize, x: &[f64]) -> Result<(), LengthError> {
        let (w, r) = (&self.work, &mut self.record);
        let mut at = 0;
        let mut put = |values: &mut dyn Iterator<Item = f64>| {
            for value in values {
                r.row[at] = value;
                at += 1;
            }
        };
        for (own, squad) in r.q.iter_mut().zip(&w.q).chain(r.s.iter_mut().zip(&w.s)) {
            *own = squad.lane(lane);
        }
        put(&mut r.q.iter().copied());
        put(&mut w.dq.iter().map(|v| v.lane(lane)));
        put(&mut w.z.iter().map(|v| v.lane(lane)));
        put(&mut w.dz.iter().map(|v| v.lane(lane)));
        put(&mut (2 * l.m..l.order * l.m).map(|column| x[l.reference + column * l.n + member]));
        put(&mut r.s.iter().copied());
        put(&mut w.applied.iter().map(|v| v.lane(lane)));
        if l.adaptive {
            put(&mut w.theta_hat.iter().map(|v| v.lane(lane)));
        }

        let agent = &mut self.members[member];
        Lagrangian::<f64>::mass_matrix(&self.robot, &mut r.scratch, &r.q, &agent.theta, &mut r.mass)?;
        let mut lyapunov = 0.0;
        for (row, s_row) in r.mass.chunks_exact(l.m).zip(&r.s) {
            for (mass, s_column) in row.iter().zip(&r.s) {
                lyapunov += 0.5 * mass * s_row * s_column;
            }
        }
        if let Some(cost) = &mut agent.estimate_cost {
            for ((delta, estimate), truth) in r.delta.iter_mut().zip(&w.theta_hat).zip(&agent.theta) {
                *delta = estimate.lane(lane) - truth;
            }
            lyapunov += 0.5 * cost.of(&r.delta);
        }
        put(&mut std::iter::once(lyapunov));
        if l.ledger_on {
            put(&mut std::iter::once(x[l.ledger + member]));
        }
        Ok(())
    }

    fn try_record(
        &mut self,
        x: &[f64],
        degree: &[f64],
        sums: &[f64],
        write: &mut dyn FnMut(usize, &[f64]),
    ) -> Result<(), LengthError> {
        let l = self.layout;
        let block = l.m * l.n;
        let (q, dq, reference) = (&x[..block], &x[l.dq..l.reference], &x[l.reference..l.theta_hat]);
        if let Some(sums) = X::split(sums, block) {
            let heard = Heard::<f64, X> { degree, sums };
            self.consensus.rate(l.m, Measured { q, dq }, reference, heard, &mut self.record.d_reference)?;
        }
        for at in 0..self.squads.len() {
            let squad = &self.squads[at];
            let first = squad.first;
            let dz = if l.order == 1 { &self.record.d_reference[..block] } else { &reference[block..2 * block] };
            self.work.read(l, first, x, dz);
            squad.act(l, &self.robot, &mut self.work)?;
            for lane in 0..S::WIDTH.min(l.n - first) {
                self.fill_row(l, first + lane, lane, x)?;
                write(self.members[first + lane].agent, &self.record.row);
            }
        }
        Ok(())
    }
}

impl Layout {
    fn new([n, m, p, order]: [usize; 4], adaptive: bool, ledger_on: bool) -> Self {
        let (dq, reference) = (m * n, 2 * m * n);
        let theta_hat = reference + order * m * n;
        let ledger = theta_hat + if adaptive { p * n } else { 0 };
        let len = ledger + if ledger_on { n } else { 0 };
        Layout { n, m, p, order, dq, reference, theta_hat, ledger, len, adaptive, ledger_on }
    }
}

impl<S: Packed> Squad<S> {
    fn new(first: usize, members: &[Member]) -> Self {
        let member = |lane: usize| &members[(first + lane).min(members.len() - 1)];
        let pack = |entries: fn(&Member) -> &[f64]| -> Vec<S> {
            (0..entries(member(0)).len()).map(|k| S::from_lanes(|lane| entries(member(lane))[k])).collect()
        };
        let adaptation = member(0)
            .law
            .adaptation
            .as_ref()
            .map(|own| ResolvedGain::pack(|lane| member(lane).law.adaptation.as_ref().unwrap_or(own)));
        let damping = ResolvedGain::pack(|lane| &member(lane).law.damping);
        // A member without limits beside one with limits has limits that are never reached.
        let limit = |lane: usize, k: usize| member(lane).effort_limits.as_ref().map_or(f64::INFINITY, |l| l[k]);
        let limited = (0..S::WIDTH).any(|lane| member(lane).effort_limits.is_some());
        let axes = member(0).viscous.len();
        Squad {
            first,
            law: SlotineLi { damping, adaptation },
            theta: pack(|member| &member.theta),
            viscous: pack(|member| &member.viscous),
            effort_limits: limited.then(|| (0..axes).map(|k| S::from_lanes(|lane| limit(lane, k))).collect()),
        }
    }

    /// s, τ, Yᵀs and q̈ of the squad whose q, q̇, z, ż and ϑ̂ are in the working memory.
    #[inline(always)]
    fn act<R: Lagrangian<S>>(&self, l: Layout, robot: &R, w: &mut Work<S, R::Scratch>) -> Result<(), LengthError> {
        let estimate = if l.adaptive { &w.theta_hat } else { &self.theta };
        let motion = TwoVelocity { q: &w.q, dq: &w.dq, z: &w.z, dz: &w.dz };
        let out = SlotineLiOutput { s: &mut w.s, tau: &mut w.tau, yt_s: &mut w.yt_s };
        self.law.output(robot, &mut w.scratch, motion, estimate, out)?;
        w.applied.copy_from_slice(&w.tau);
        if let Some(limits) = &self.effort_limits {
            for (tau, limit) in w.applied.iter_mut().zip(limits) {
                *tau = tau.saturate(*limit);
            }
        }
        robot.forward_dynamics(&mut w.scratch, &w.q, &w.dq, &self.theta, &w.applied, &mut w.ddq)
    }

    /// sᵀ(K + D)s − sᵀτ_ext. What a limit takes away from the torque acts like an external one.
    #[inline(always)]
    fn dissipation<T>(&self, l: Layout, w: &mut Work<S, T>) -> S {
        self.law.damping.apply(&w.s, &mut w.damped);
        let mut dissipation = S::ZERO;
        for k in 0..l.m {
            let external = w.applied[k] - w.tau[k];
            let damped = self.viscous[k].mul_add(w.s[k], w.damped[k] - external);
            dissipation = w.s[k].mul_add(damped, dissipation);
        }
        dissipation
    }
}

impl<S: Packed, T> Work<S, T> {
    /// Loads the members from `first` on.
    #[inline(always)]
    fn read(&mut self, l: Layout, first: usize, x: &[f64], dz: &[f64]) {
        take(l, first, x, &mut self.q);
        take(l, first, &x[l.dq..], &mut self.dq);
        take(l, first, &x[l.reference..], &mut self.z);
        take(l, first, dz, &mut self.dz);
        if l.adaptive {
            take(l, first, &x[l.theta_hat..], &mut self.theta_hat);
        }
    }

    /// Stores q̈, ϑ̂' and the dissipation of `squad`; needs what [`Squad::act`] left.
    #[inline(always)]
    fn write(&mut self, l: Layout, squad: &Squad<S>, dx: &mut [f64]) {
        give(l, squad.first, &self.ddq, &mut dx[l.dq..]);
        if l.adaptive {
            squad.law.adaptation_rate(&self.yt_s, &mut self.d_theta_hat);
            give(l, squad.first, &self.d_theta_hat, &mut dx[l.theta_hat..]);
        }
        if l.ledger_on {
            let dissipation = squad.dissipation(l, self);
            dissipation.store(&mut dx[l.ledger + squad.first..l.ledger + l.n]);
        }
    }
}

/// Loads the members from `first` on out of a block of columns.
#[inline(always)]
fn take<S: Packed>(l: Layout, first: usize, columns: &[f64], out: &mut [S]) {
    for (k, out) in out.iter_mut().enumerate() {
        *out = S::load(&columns[k * l.n + first..(k + 1) * l.n]);
    }
}

/// Stores the members from `first` on into a block of columns.
#[inline(always)]
fn give<S: Packed>(l: Layout, first: usize, values: &[S], columns: &mut [f64]) {
    for (k, value) in values.iter().enumerate() {
        value.store(&mut columns[k * l.n + first..(k + 1) * l.n]);
    }
}

struct Rates<'a, R: Lagrangian<f64> + Lagrangian<S>, X: Exchange, S: Packed> {
    population: &'a mut Population<R, X, S>,
    x: &'a [f64],
    degree: &'a [f64],
    sums: &'a [f64],
    dx: &'a mut [f64],
}

impl<R: Lagrangian<f64> + Lagrangian<S>, X: Exchange, S: Packed> Kernel for Rates<'_, R, X, S> {
    type Output = Result<(), LengthError>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        self.population.rates_inlined(self.x, self.degree, self.sums, self.dx)
    }
}

impl<R, X, S> Columns for Population<R, X, S>
where
    R: Lagrangian<f64> + Lagrangian<S>,
    X: Exchange,
    S: Packed,
{
    fn state_len(&self) -> usize {
        self.layout.len
    }

    fn rates(&mut self, x: &[f64], degree: &[f64], sums: &[f64], dx: &mut [f64]) {
        let checked = dispatch(Rates { population: self, x, degree, sums, dx: &mut *dx });
        debug_assert_eq!(checked, Ok(()), "lengths are fixed when the population is built");
        if checked.is_err() {
            dx.fill(f64::NAN);
        }
    }

    fn record(&mut self, x: &[f64], degree: &[f64], sums: &[f64], write: &mut dyn FnMut(usize, &[f64])) {
        let checked = self.try_record(x, degree, sums, write);
        debug_assert_eq!(checked, Ok(()), "lengths are fixed when the population is built");
    }

    fn signals(&self) -> Vec<(Signal, usize)> {
        let l = self.layout;
        let mut signals = Vec::new();
        let mut axes = |signal, count| signals.extend((0..count).map(|axis| (signal, axis)));
        axes(Signal::Position, l.m);
        axes(Signal::Velocity, l.m);
        for r in 0..l.order.max(2) {
            axes(Signal::Reference(r as u8), l.m);
        }
        axes(Signal::TrackingError, l.m);
        axes(Signal::Torque, l.m);
        if l.adaptive {
            axes(Signal::Estimate, l.p);
        }
        axes(Signal::Lyapunov, 1);
        if l.ledger_on {
            axes(Signal::Dissipation, 1);
        }
        signals
    }

    fn locate(&self, state: usize) -> (usize, Signal, usize) {
        let l = self.layout;
        let agent = self.members[state % l.n].agent;
        let column = |first: usize| (state - first) / l.n;
        let (signal, axis) = if state >= l.ledger {
            (Signal::Dissipation, 0)
        } else if state >= l.theta_hat {
            (Signal::Estimate, column(l.theta_hat))
        } else if state >= l.reference {
            (Signal::Reference((column(l.reference) / l.m) as u8), column(l.reference) % l.m)
        } else if state >= l.dq {
            (Signal::Velocity, column(l.dq))
        } else {
            (Signal::Position, state / l.n)
        };
        (agent, signal, axis)
    }
}
