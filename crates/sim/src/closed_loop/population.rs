//! Agents of one kind, side by side in columns.
//!
//! The state of a population of n agents with m axes, order ℓ and p parameters is a block of columns of n numbers,
//!
//! ```text
//! q [m]   q̇ [m]   z, ż, …, z^(ℓ−1) [ℓ·m]   ϑ̂ [p, if adapted]   ∫ sᵀ(K+D)s − sᵀτ_ext [1, if the ledger is on]
//! ```
//!
//! and its right-hand side is computed in stages: heard → reference dynamics (which give ż) → τ and Yᵀs → q̈ → rates.
//! There is no algebraic loop, since z̈ never enters τ.

use forwardstep_core::law::{SlotineLi, SlotineLiOutput};
use forwardstep_core::reference::{Consensus, Exchange, Heard, Measured};
use forwardstep_core::robot::{Lagrangian, TwoVelocity};
use forwardstep_core::{Kernel, LengthError, dispatch};

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
    /// Torque limits to be enforced, one entry per axis.
    pub(crate) effort_limits: Option<Vec<f64>>,
}

/// What the closed loop asks of a population, whatever its robots and its exchange.
pub(crate) trait Columns {
    /// Numbers of state.
    fn state_len(&self) -> usize;
    /// d/dt of the block `x`; `degree` and `sums` are the population's part of what is heard.
    fn rates(&mut self, x: &[f64], degree: &[f64], sums: &[f64], dx: &mut [f64]);
    /// The signals of every member in turn, in the order of [`Columns::signals`].
    fn record(&mut self, x: &[f64], degree: &[f64], sums: &[f64], write: &mut dyn FnMut(usize, &[f64]));
    /// Signals and axes of one member, in the order in which they are recorded.
    fn signals(&self) -> Vec<(Signal, usize)>;
    /// Which member, signal and axis a state of the block is.
    fn locate(&self, state: usize) -> (usize, Signal, usize);
}

/// A population of robots `R` that exchange `X`.
pub(crate) struct Population<R: Lagrangian<f64>, X: Exchange> {
    robot: R,
    members: Vec<Member>,
    consensus: Consensus<X>,
    adaptive: bool,
    ledger: bool,
    work: Work<R::Scratch>,
}

/// Working memory: one agent at a time, entries next to each other.
#[derive(Debug)]
struct Work<T> {
    scratch: T,
    q: Vec<f64>,
    dq: Vec<f64>,
    z: Vec<f64>,
    dz: Vec<f64>,
    s: Vec<f64>,
    tau: Vec<f64>,
    applied: Vec<f64>,
    ddq: Vec<f64>,
    damped: Vec<f64>,
    theta_hat: Vec<f64>,
    yt_s: Vec<f64>,
    d_theta_hat: Vec<f64>,
    mass: Vec<f64>,
    d_reference: Vec<f64>,
    row: Vec<f64>,
}

/// Where the parts of a block begin.
#[derive(Clone, Copy, Debug)]
struct Layout {
    n: usize,
    m: usize,
    p: usize,
    order: usize,
    dq: usize,
    reference: usize,
    theta_hat: usize,
    ledger: usize,
    len: usize,
}

impl<R: Lagrangian<f64>, X: Exchange> Population<R, X> {
    pub(crate) fn new(robot: R, members: Vec<Member>, consensus: Consensus<X>, adaptive: bool, ledger: bool) -> Self {
        let (m, p, n, order) = (robot.dof(), robot.parameter_count(), members.len(), consensus.order());
        let vector = || vec![0.0; m];
        let parameters = || vec![0.0; p];
        let work = Work {
            scratch: robot.scratch(),
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
            mass: vec![0.0; m * m],
            d_reference: vec![0.0; order * m * n],
            row: Vec::new(),
        };
        let mut population = Population { robot, members, consensus, adaptive, ledger, work };
        population.work.row = vec![0.0; population.signals().len()];
        population
    }

    fn layout(&self) -> Layout {
        let (m, p, n, order) =
            (self.robot.dof(), self.robot.parameter_count(), self.members.len(), self.consensus.order());
        let dq = m * n;
        let reference = 2 * m * n;
        let theta_hat = reference + order * m * n;
        let ledger = theta_hat + if self.adaptive { p * n } else { 0 };
        let len = ledger + if self.ledger { n } else { 0 };
        Layout { n, m, p, order, dq, reference, theta_hat, ledger, len }
    }

    /// Reference rate into `d_reference`, then everything else agent by agent.
    #[inline(always)]
    fn rates_inlined(&mut self, x: &[f64], degree: &[f64], sums: &[f64], dx: &mut [f64]) -> Result<(), LengthError> {
        let l = self.layout();
        let block = l.m * l.n;
        LengthError::check("state", l.len, x.len())?;
        LengthError::check("rate", l.len, dx.len())?;
        let (q, dq) = (&x[..block], &x[l.dq..l.dq + block]);
        let reference = &x[l.reference..l.theta_hat];
        let Some(sums) = X::split(sums, block) else { return Ok(()) };
        let heard = Heard::<f64, X> { degree, sums };

        dx[..block].copy_from_slice(dq);
        self.consensus.rate(l.m, Measured { q, dq }, reference, heard, &mut dx[l.reference..l.theta_hat])?;
        for i in 0..l.n {
            // ż is a state but for order one, where it is the rate just computed.
            let z = &reference[..block];
            {
                let dz = if l.order == 1 { &dx[l.reference..][..block] } else { &reference[block..2 * block] };
                take(l, i, q, &mut self.work.q);
                take(l, i, dq, &mut self.work.dq);
                take(l, i, z, &mut self.work.z);
                take(l, i, dz, &mut self.work.dz);
            }
            let theta_hat = self.adaptive.then(|| &x[l.theta_hat..l.ledger]);
            let dissipation = self.act(l, i, theta_hat)?;
            give(l, i, &self.work.ddq, &mut dx[l.dq..l.dq + block]);
            if self.adaptive {
                self.members[i].law.adaptation_rate(&self.work.yt_s, &mut self.work.d_theta_hat);
                give(l, i, &self.work.d_theta_hat, &mut dx[l.theta_hat..l.ledger]);
            }
            if self.ledger {
                dx[l.ledger + i] = dissipation;
            }
        }
        Ok(())
    }

    /// s, τ, Yᵀs and q̈ of the member whose q, q̇, z, ż are in the working memory; returns sᵀ(K + D)s − sᵀτ_ext.
    #[inline(always)]
    fn act(&mut self, l: Layout, i: usize, theta_hat: Option<&[f64]>) -> Result<f64, LengthError> {
        let (member, w) = (&self.members[i], &mut self.work);
        let estimate = match theta_hat {
            Some(columns) => {
                take(l, i, columns, &mut w.theta_hat);
                &w.theta_hat[..]
            }
            None => &member.theta[..],
        };
        let motion = TwoVelocity { q: &w.q, dq: &w.dq, z: &w.z, dz: &w.dz };
        let out = SlotineLiOutput { s: &mut w.s, tau: &mut w.tau, yt_s: &mut w.yt_s };
        member.law.output(&self.robot, &mut w.scratch, motion, estimate, out)?;

        w.applied.copy_from_slice(&w.tau);
        if let Some(limits) = &member.effort_limits {
            for (tau, limit) in w.applied.iter_mut().zip(limits) {
                *tau = tau.clamp(-limit, *limit);
            }
        }
        self.robot.forward_dynamics(&mut w.scratch, &w.q, &w.dq, &member.theta, &w.applied, &mut w.ddq)?;

        member.law.damping.apply(&w.s, &mut w.damped);
        let mut dissipation = 0.0;
        for k in 0..l.m {
            // What a limit takes away acts like an external torque.
            let external = w.applied[k] - w.tau[k];
            let damped = member.viscous[k].mul_add(w.s[k], w.damped[k] - external);
            dissipation = w.s[k].mul_add(damped, dissipation);
        }
        Ok(dissipation)
    }

    fn record_member(&mut self, l: Layout, i: usize, x: &[f64]) -> Result<(), LengthError> {
        let block = l.m * l.n;
        let reference = &x[l.reference..l.theta_hat];
        take(l, i, &x[..block], &mut self.work.q);
        take(l, i, &x[l.dq..l.dq + block], &mut self.work.dq);
        take(l, i, &reference[..block], &mut self.work.z);
        let dz = if l.order == 1 { &self.work.d_reference[..block] } else { &reference[block..2 * block] };
        take(l, i, dz, &mut self.work.dz);
        let theta_hat = self.adaptive.then(|| &x[l.theta_hat..l.ledger]);
        self.act(l, i, theta_hat)?;

        let (member, w) = (&self.members[i], &mut self.work);
        let mut at = 0;
        let mut put = |values: &[f64]| {
            w.row[at..at + values.len()].copy_from_slice(values);
            at += values.len();
        };
        put(&w.q);
        put(&w.dq);
        put(&w.z);
        put(&w.dz);
        for r in 2..l.order {
            for axis in 0..l.m {
                put(&[reference[r * block + axis * l.n + i]]);
            }
        }
        put(&w.s);
        put(&w.applied);
        if self.adaptive {
            put(&w.theta_hat);
        }

        self.robot.mass_matrix(&mut w.scratch, &w.q, &member.theta, &mut w.mass)?;
        let mut v = 0.0;
        for (row, s_row) in w.mass.chunks_exact(l.m).zip(&w.s) {
            for (mass, s) in row.iter().zip(&w.s) {
                v += 0.5 * mass * s_row * s;
            }
        }
        if let Some(gamma) = &member.law.adaptation {
            for (delta, (estimate, truth)) in w.yt_s.iter_mut().zip(w.theta_hat.iter().zip(&member.theta)) {
                *delta = estimate - truth;
            }
            v += 0.5 * gamma.inverse_quadratic(&w.yt_s, &mut w.d_theta_hat);
        }
        put(&[v]);
        if self.ledger {
            put(&[x[l.ledger + i]]);
        }
        Ok(())
    }
}

/// Copies the entries of member `i` out of a block of columns.
#[inline(always)]
fn take(l: Layout, i: usize, columns: &[f64], out: &mut [f64]) {
    for (k, out) in out.iter_mut().enumerate() {
        *out = columns[k * l.n + i];
    }
}

/// Copies the entries of member `i` into a block of columns.
#[inline(always)]
fn give(l: Layout, i: usize, values: &[f64], columns: &mut [f64]) {
    for (k, value) in values.iter().enumerate() {
        columns[k * l.n + i] = *value;
    }
}

struct Rates<'a, R: Lagrangian<f64>, X: Exchange> {
    population: &'a mut Population<R, X>,
    x: &'a [f64],
    degree: &'a [f64],
    sums: &'a [f64],
    dx: &'a mut [f64],
}

impl<R: Lagrangian<f64>, X: Exchange> Kernel for Rates<'_, R, X> {
    type Output = Result<(), LengthError>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        self.population.rates_inlined(self.x, self.degree, self.sums, self.dx)
    }
}

impl<R, X> Columns for Population<R, X>
where
    R: Lagrangian<f64>,
    X: Exchange,
{
    fn state_len(&self) -> usize {
        self.layout().len
    }

    fn rates(&mut self, x: &[f64], degree: &[f64], sums: &[f64], dx: &mut [f64]) {
        let checked = dispatch(Rates { population: self, x, degree, sums, dx: &mut *dx });
        debug_assert_eq!(checked, Ok(()), "lengths are fixed when the population is built");
        if checked.is_err() {
            dx.fill(f64::NAN);
        }
    }

    fn record(&mut self, x: &[f64], degree: &[f64], sums: &[f64], write: &mut dyn FnMut(usize, &[f64])) {
        let l = self.layout();
        let block = l.m * l.n;
        if l.order == 1
            && let Some(sums) = X::split(sums, block)
        {
            let heard = Heard::<f64, X> { degree, sums };
            let measured = Measured { q: &x[..block], dq: &x[l.dq..l.dq + block] };
            let reference = &x[l.reference..l.theta_hat];
            let checked = self.consensus.rate(l.m, measured, reference, heard, &mut self.work.d_reference);
            debug_assert_eq!(checked, Ok(()), "lengths are fixed when the population is built");
        }
        for i in 0..l.n {
            let checked = self.record_member(l, i, x);
            debug_assert_eq!(checked, Ok(()), "lengths are fixed when the population is built");
            write(self.members[i].agent, &self.work.row);
        }
    }

    fn signals(&self) -> Vec<(Signal, usize)> {
        let l = self.layout();
        let mut signals = Vec::new();
        let mut axes = |signal, count| signals.extend((0..count).map(|axis| (signal, axis)));
        axes(Signal::Position, l.m);
        axes(Signal::Velocity, l.m);
        for r in 0..l.order.max(2) {
            axes(Signal::Reference(r as u8), l.m);
        }
        axes(Signal::TrackingError, l.m);
        axes(Signal::Torque, l.m);
        if self.adaptive {
            axes(Signal::Estimate, l.p);
        }
        axes(Signal::Lyapunov, 1);
        if self.ledger {
            axes(Signal::Dissipation, 1);
        }
        signals
    }

    fn locate(&self, state: usize) -> (usize, Signal, usize) {
        let l = self.layout();
        let (column, i) = (state / l.n, state % l.n);
        let agent = self.members[i].agent;
        let (signal, axis) = match state {
            state if state >= l.ledger => (Signal::Dissipation, 0),
            state if state >= l.theta_hat => (Signal::Estimate, column - l.theta_hat / l.n),
            state if state >= l.reference => {
                let column = column - l.reference / l.n;
                (Signal::Reference((column / l.m) as u8), column % l.m)
            }
            state if state >= l.dq => (Signal::Velocity, column - l.m),
            _ => (Signal::Position, column),
        };
        (agent, signal, axis)
    }
}
