//! Agents of one kind, side by side in columns.
//!
//! The state of a population of n agents with m axes, order ℓ and p parameters is a block of columns of n numbers,
//!
//! ```text
//! q [m]   q̇ [m]   reference state [v·m]   ϑ̂ [p, if adapted]   ∫ sᵀ(K+D)s − sᵀτ_ext [1, if the balance is on]
//! ```
//!
//! (v = ℓ and z, ż, …, z^(ℓ−1) for the consensus family), and its right-hand side is computed in stages: heard → reference
//! dynamics (which give z and ż) → τ and Yᵀs → q̈ → rates.
//! There is no algebraic loop, since z̈ never enters τ.
//!
//! Under digital control q and q̇ flow and everything else stands still between two samples, when it jumps.

use std::ops::Range;

use forwardstep_core::controller::Trouble;
use forwardstep_core::reference::{Choice, Derived, Heard, Measured, Reference, ReferenceOut, Sliding};
use forwardstep_core::robot::{Lagrangian, TwoVelocity};
use forwardstep_core::sampled::{Recipe, Sampled, StartState};
use forwardstep_core::{LengthError, Packed};

use super::asked::{Layer, add_sign_terms_now, argument, evaluate};
use super::assembly::Assembly;
use super::columns::{Columns, Inputs};
use super::error::SetupError;
use super::gain_rates::gain_rates;
use super::injected::Energy;
use super::recipes::used;
use super::references::{AnyReference, Transmits, reference};
use super::robot_batch::{Drive, Layout, Member, RobotBatch};
use super::sampler::{Digital, Sampler, take};
use crate::agents::Adaptive;
use crate::recording::{GainRates, Signal};
use crate::setup::{AgentSetup, Control, Setup};

/// A population of robots `R` that follow reference dynamics that hear `X`, worked on in lanes of `S`.
pub(crate) struct Population<R: Lagrangian<f64> + Lagrangian<S>, X: Transmits, S: Packed> {
    members: Vec<Member>,
    reference: AnyReference<X>,
    robots: RobotBatch<R, S>,
    output: Output,
    /// When control is digital.
    sampler: Option<Sampler>,
    /// When its signs are functions of the instant.
    layer: Option<Layer>,
    record: RecordWork<<R as Lagrangian<f64>>::Scratch>,
}

/// What the reference asks for at the instant at hand.
struct Output {
    z: Vec<f64>,
    dz: Vec<f64>,
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
    R: Lagrangian<f64> + Lagrangian<S> + Clone + Send + Sync + 'static,
    X: Transmits,
    S: Packed,
{
    /// `members` share the robot and the reference dynamics; all adapt or none. With `sampled` control will be digital.
    pub(crate) fn new(
        robot: R,
        processor: S::Processor,
        members: Vec<Member>,
        reference: AnyReference<X>,
        sampled: bool,
        balances: bool,
    ) -> Self {
        let (m, p) = (Lagrangian::<f64>::dof(&robot), Lagrangian::<f64>::parameter_count(&robot));
        let adaptive = members.iter().all(|member| member.law.adaptation.is_some());
        let layout = Layout::new([members.len(), m, p, reference.vectors()], adaptive, balances);
        let record = RecordWork {
            scratch: Lagrangian::<f64>::scratch(&robot),
            d_reference: vec![0.0; layout.theta_hat - layout.reference],
            q: vec![0.0; m],
            s: vec![0.0; m],
            mass: vec![0.0; m * m],
            delta: vec![0.0; p],
            row: Vec::new(),
        };
        let output = Output { z: vec![0.0; layout.block()], dz: vec![0.0; layout.block()] };
        let robots = RobotBatch::new(robot, processor, &members, layout);
        let layer = match reference.sliding() {
            Some(Sliding { choice: Choice::Layer { width }, .. }) if !sampled => {
                Some(Layer { width: *width, selection: vec![0.0; layout.block()] })
            }
            _ => None,
        };
        let mut population = Population { members, reference, robots, output, sampler: None, layer, record };
        population.record.row = vec![0.0; population.signals().len()];
        population
    }

    /// The reference of everybody, then everything else pack by pack.
    fn try_rates(&mut self, t_s: f64, x: &[f64], inputs: Inputs<'_>, dx: &mut [f64]) -> Result<(), LengthError> {
        let l = self.robots.layout;
        LengthError::check("state", l.len, x.len())?;
        LengthError::check("rate", l.len, dx.len())?;
        dx[..l.block()].copy_from_slice(&x[l.dq..l.reference]);
        let drive = match &self.sampler {
            Some(sampler) => {
                dx[l.reference..].fill(0.0);
                sampler.drive(inputs.external)
            }
            None => {
                let Output { z, dz } = &mut self.output;
                let d_state = &mut dx[l.reference..l.theta_hat];
                evaluate(&self.reference, l, (t_s, x), inputs, ReferenceOut { z, dz, d_state: &mut *d_state })?;
                add_sign_terms_now(&self.reference, &mut self.layer, l, x, inputs, dz, d_state)?;
                Drive { z, dz, held: None, external: inputs.external }
            }
        };
        (0..self.robots.packs()).try_for_each(|pack| self.robots.act(pack, x, drive, Some(&mut *dx)))
    }

    fn try_record(
        &mut self,
        t_s: f64,
        x: &[f64],
        inputs: Inputs<'_>,
        write: &mut dyn FnMut(usize, &[f64]),
    ) -> Result<(), LengthError> {
        let l = self.robots.layout;
        for pack in 0..self.robots.packs() {
            let drive = match &self.sampler {
                Some(sampler) => sampler.drive(inputs.external),
                None => {
                    let Output { z, dz } = &mut self.output;
                    if pack == 0 {
                        let d_state = &mut self.record.d_reference[..];
                        evaluate(&self.reference, l, (t_s, x), inputs, ReferenceOut { z, dz, d_state: &mut *d_state })?;
                        add_sign_terms_now(&self.reference, &mut self.layer, l, x, inputs, dz, d_state)?;
                    }
                    Drive { z, dz, held: None, external: inputs.external }
                }
            };
            self.robots.act(pack, x, drive, None)?;
            let first = self.robots.first(pack);
            for lane in 0..S::WIDTH.min(l.n - first) {
                self.fill_row(first + lane, lane, x)?;
                write(self.members[first + lane].agent, &self.record.row);
            }
        }
        Ok(())
    }

    /// Fills the row of the member in one lane of the pack whose signals are in the working memory.
    fn fill_row(&mut self, member: usize, lane: usize, x: &[f64]) -> Result<(), LengthError> {
        let (l, w, r) = (self.robots.layout, &self.robots.work, &mut self.record);
        for (own, pack) in r.q.iter_mut().zip(&w.q).chain(r.s.iter_mut().zip(&w.s)) {
            *own = pack.lane(lane);
        }
        let mut slots = r.row.iter_mut();
        let mut put = |value: f64| {
            if let Some(slot) = slots.next() {
                *slot = value;
            }
        };
        r.q.iter().copied().for_each(&mut put);
        w.dq.iter().chain(&w.z).chain(&w.dz).for_each(|v| put(v.lane(lane)));
        (2 * l.m..self.reference.derivatives() * l.m).for_each(|column| put(x[l.reference + column * l.n + member]));
        if let Some(held) = X::HELD {
            let first = l.reference + held * l.block();
            (0..X::CHANNELS * l.m).for_each(|column| put(x[first + column * l.n + member]));
        }
        if self.reference.sliding().is_some() {
            let held = &x[l.theta_hat - l.block()..l.theta_hat];
            let selection = self.layer.as_ref().map_or(held, |layer| &layer.selection);
            (0..l.m).for_each(|axis| put(selection[axis * l.n + member]));
        }
        r.s.iter().copied().for_each(&mut put);
        w.applied.iter().for_each(|v| put(v.lane(lane)));
        if l.adaptive {
            w.theta_hat.iter().for_each(|v| put(v.lane(lane)));
        }

        let agent = &mut self.members[member];
        let robot = &self.robots.robot;
        Lagrangian::<f64>::mass_matrix(robot, &mut r.scratch, &r.q, &agent.theta, &mut r.mass)?;
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
        put(lyapunov);
        if l.balances {
            put(x[l.balance + member]);
        }
        Ok(())
    }
}

impl<R, X, S> Columns for Population<R, X, S>
where
    R: Lagrangian<f64> + Lagrangian<S> + Clone + Send + Sync + 'static,
    X: Transmits,
    S: Packed,
{
    fn state_len(&self) -> usize {
        self.robots.layout.len
    }

    fn message(&self) -> usize {
        X::HELD.map_or(0, |held| self.robots.layout.reference + held * self.robots.layout.block())
    }

    fn append_start(&self, all: &[AgentSetup], x: &mut Vec<f64>) {
        let (first, l) = (x.len(), self.robots.layout);
        let agents = || self.members.iter().map(|member| &all[member.agent]);
        for axis in 0..l.m {
            x.extend(agents().map(|a| a.start.q[axis]));
        }
        for axis in 0..l.m {
            x.extend(agents().map(|a| a.start.dq[axis]));
        }
        // The wanted z(0), ż(0), …, for `start` to replace.
        for r in 0..self.reference.vectors() {
            for axis in 0..l.m {
                let default = |a: &AgentSetup| if r == 0 { a.start.dq[axis] } else { 0.0 };
                x.extend(agents().map(|a| a.start.reference.get(r).map_or(default(a), |z| z[axis])));
            }
        }
        for k in 0..l.p {
            x.extend(agents().filter_map(|a| a.law.downcast::<Adaptive>().map(|law| law.estimate_start[k])));
        }
        x.resize(first + l.len, 0.0);
    }

    fn start(&mut self, _: &[AgentSetup], x: &mut [f64], degree: &[f64], sums: &[f64]) -> Result<(), LengthError> {
        let l = self.robots.layout;
        let given = x[l.reference..l.theta_hat].to_vec();
        let (measured, state) = x[..l.theta_hat].split_at_mut(l.reference);
        let measured = Measured { q: &measured[..l.dq], dq: &measured[l.dq..] };
        self.reference.start(l.m, measured, &given, Heard::new(degree, sums, l.block())?, state)
    }

    fn rates(&mut self, t_s: f64, x: &[f64], inputs: Inputs<'_>, dx: &mut [f64]) {
        let checked = self.try_rates(t_s, x, inputs, dx);
        debug_assert_eq!(checked, Ok(()), "lengths are fixed when the population is built");
        if checked.is_err() {
            dx.fill(f64::NAN);
        }
    }

    fn record(&mut self, t_s: f64, x: &[f64], inputs: Inputs<'_>, write: &mut dyn FnMut(usize, &[f64])) {
        let checked = self.try_record(t_s, x, inputs, write);
        debug_assert_eq!(checked, Ok(()), "lengths are fixed when the population is built");
    }

    fn motion(&mut self, agent: usize, _: f64, x: &[f64], q: &mut [f64], dq: &mut [f64]) {
        let l = self.robots.layout;
        if let Some(member) = self.members.iter().position(|member| member.agent == agent) {
            take(l.n, member, x, q);
            take(l.n, member, &x[l.dq..], dq);
        }
    }

    fn sense(&mut self, t_s: f64, x: &[f64], sent: &mut [f64]) {
        let l = self.robots.layout;
        if let Some(sampler) = &mut self.sampler {
            sampler.sense(t_s, &x[..l.reference], sent);
        }
    }

    fn recipes(&self, setup: &Setup, x: &[f64]) -> Result<Vec<(usize, Recipe)>, SetupError> {
        let l = self.robots.layout;
        let recipe = |(i, member): (usize, &Member)| {
            let mut state = vec![0.0; (l.balance - l.reference) / l.n];
            take(l.n, i, &x[l.reference..l.balance], &mut state);
            let reference = reference::<X>(&Assembly::new(setup, &[member.agent]))?;
            let theta_hat = if l.adaptive { state[state.len() - l.p..].to_vec() } else { member.theta.clone() };
            let mut recipe = Recipe::lagrangian(self.robots.robot.clone(), reference, member.law.clone(), theta_hat);
            recipe.start = StartState::State(state);
            Ok((member.agent, used(recipe, setup, member.agent, l.m)?))
        };
        self.members.iter().enumerate().map(recipe).collect()
    }

    fn sample(&mut self, control: &Control, controllers: Vec<Box<dyn Sampled>>) {
        let m = self.robots.layout.m;
        let outputs = [(Signal::Position, m), (Signal::Velocity, m)];
        let agents = self.members.iter().zip(controllers);
        let agents = agents.map(|(member, controller)| Digital::new(control, member.agent, &outputs, controller));
        self.sampler = Some(Sampler::new(agents.collect(), m));
    }

    fn command(&mut self, now_s: f64, inputs: Inputs<'_>, x: &mut [f64]) {
        let l = self.robots.layout;
        if let Some(sampler) = &mut self.sampler {
            sampler.command(now_s, inputs, &mut x[l.reference..l.balance]);
        }
    }

    fn taken(&self, each: &mut dyn FnMut(&Digital)) {
        self.sampler.iter().flat_map(Sampler::agents).for_each(each);
    }

    // Robots in lanes have an account of their own, from rows alone.
    fn trace(&mut self, _: &Control) {}

    fn energies(&mut self, _: f64, _: &[f64], _: Inputs<'_>, _: &mut dyn FnMut(usize, Energy)) {}

    fn apply(&mut self) {
        if let Some(sampler) = &mut self.sampler {
            sampler.apply();
        }
    }

    fn hold(&mut self, commands: &[f64]) {
        if let Some(sampler) = &mut self.sampler {
            sampler.hold(commands);
        }
    }

    fn selection(&self) -> Option<Range<usize>> {
        let l = self.robots.layout;
        self.reference.sliding().map(|_| l.theta_hat - l.block()..l.theta_hat)
    }

    fn tell(&mut self, _: f64, dx: &[f64], told: &mut [f64]) {
        let l = self.robots.layout;
        match self.reference.sliding().map(|sliding| sliding.derived) {
            Some(Derived::Acceleration) => told.copy_from_slice(&dx[l.dq..l.reference]),
            Some(Derived::ReferenceAcceleration) => told.copy_from_slice(&self.output.dz),
            _ => {}
        }
    }

    fn argument(&mut self, x: &[f64], inputs: Inputs<'_>, told: [&[f64]; 2], e: &mut [f64]) {
        let checked = argument(&self.reference, self.robots.layout, x, inputs, told, e);
        debug_assert_eq!(checked, Ok(()), "lengths are fixed when the population is built");
    }

    fn add_sign_terms(&mut self, selection: &[f64], dx: &mut [f64]) {
        let l = self.robots.layout;
        if let (Some(sliding), Some(layer)) = (self.reference.sliding(), &mut self.layer) {
            layer.selection.copy_from_slice(selection);
            let leaning = l.theta_hat - 2 * l.block();
            for (rate, selection) in dx[leaning..].iter_mut().zip(selection) {
                *rate -= sliding.gamma * selection;
            }
        }
    }

    // The states are those of robots, free of constraints.
    fn settle(&mut self, _: &mut [f64]) {}

    // (6)–(7) are defined everywhere.
    fn trouble(&self, _: &[f64]) -> Option<(usize, Trouble)> {
        None
    }

    fn next_event_s(&self, _: f64) -> f64 {
        f64::INFINITY
    }

    fn pass_kink(&mut self, _: f64, _: &mut [f64]) {}

    fn signals(&self) -> Vec<(Signal, usize)> {
        let l = self.robots.layout;
        let mut signals = Vec::new();
        let mut axes = |signal, count| signals.extend((0..count).map(|axis| (signal, axis)));
        axes(Signal::Position, l.m);
        axes(Signal::Velocity, l.m);
        for r in 0..self.reference.derivatives().max(2) {
            axes(Signal::Reference(r as u8), l.m);
        }
        if X::HELD.is_some() {
            X::SIGNALS.iter().for_each(|held| axes(*held, l.m));
        }
        if self.reference.sliding().is_some() {
            axes(Signal::Selection, l.m);
        }
        axes(Signal::TrackingError, l.m);
        axes(Signal::Torque, l.m);
        if l.adaptive {
            axes(Signal::Estimate, l.p);
        }
        axes(Signal::Lyapunov, 1);
        if l.balances {
            axes(Signal::Dissipation, 1);
        }
        signals
    }

    fn inputs(&self) -> Vec<(Signal, Range<usize>)> {
        let signals = self.signals();
        let first = signals.iter().position(|(signal, _)| *signal == Signal::Torque).unwrap_or(signals.len());
        vec![(Signal::Torque, first..first + self.robots.layout.m)]
    }

    fn locate(&self, state: usize) -> (usize, Signal, usize) {
        let l = self.robots.layout;
        let agent = self.members[state % l.n].agent;
        let column = |first: usize| (state - first) / l.n;
        let (signal, axis) = if state >= l.balance {
            (Signal::Dissipation, 0)
        } else if state >= l.theta_hat {
            (Signal::Estimate, column(l.theta_hat))
        } else if self.selection().is_some_and(|selection| state >= selection.start) {
            (Signal::Selection, column(l.theta_hat - l.block()))
        } else if state >= l.reference {
            let (block, axis) = (column(l.reference) / l.m, column(l.reference) % l.m);
            let held = X::HELD.and_then(|held| X::SIGNALS.get(block.checked_sub(held)?));
            (held.copied().unwrap_or(Signal::Reference(block as u8)), axis)
        } else if state >= l.dq {
            (Signal::Velocity, column(l.dq))
        } else {
            (Signal::Position, state / l.n)
        };
        (agent, signal, axis)
    }

    fn gain_rates(&mut self, agent: usize, x: &[f64]) -> Option<GainRates> {
        let l = self.robots.layout;
        if self.sampler.is_some() {
            return None;
        }
        let index = self.members.iter().position(|member| member.agent == agent)?;
        let own = |columns: &[f64]| -> Vec<f64> { (0..l.m).map(|axis| columns[axis * l.n + index]).collect() };
        let Output { z, dz } = &self.output;
        let (q, dq, z, dz) = (own(x), own(&x[l.dq..]), own(z), own(dz));
        let motion = TwoVelocity { q: &q, dq: &dq, z: &z, dz: &dz };
        gain_rates(&self.robots.robot, &mut self.record.scratch, &self.members[index], motion).ok()?
    }
}
