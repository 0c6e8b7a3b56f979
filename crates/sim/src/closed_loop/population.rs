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

use forwardstep_core::LengthError;
use forwardstep_core::controller::Singularity;
use forwardstep_core::reference::{Choice, Derived, Measured, ReferenceOut, Sliding};
use forwardstep_core::robot::TwoVelocity;
use forwardstep_core::sampled::{Recipe, Sampled, StartState};

use super::asked::{Layer, add_sign_terms_now, argument, evaluate};
use super::assembly::Assembly;
use super::columns::{Columns, Inputs};
use super::error::SetupError;
use super::injected::Energy;
use super::recipes::used;
use super::references::dynamics;
use super::robot_batch::{Drive, Layout, Member, Robots, Seen};
use super::sampler::{Digital, Sampler, take};
use crate::agents::Adaptive;
use crate::recording::{GainRates, Signal};
use crate::reference::Dynamics;
use crate::setup::{AgentSetup, Control, Setup};

/// A population of like robots that follow reference dynamics.
pub(crate) struct Population {
    members: Vec<Member>,
    reference: Dynamics,
    robots: Box<dyn Robots>,
    layout: Layout,
    output: Output,
    /// When control is digital.
    sampler: Option<Sampler>,
    /// When its signs are functions of the instant.
    layer: Option<Layer>,
    record: RecordWork,
}

/// What the reference asks for at the instant at hand.
struct Output {
    z: Vec<f64>,
    dz: Vec<f64>,
}

/// Working memory of recording, one member at a time.
struct RecordWork {
    d_reference: Vec<f64>,
    seen: Seen,
    mass: Vec<f64>,
    delta: Vec<f64>,
    row: Vec<f64>,
}

impl Population {
    /// `members` share the robot and the reference dynamics; all adapt or none. With `sampled` control will be digital.
    pub(crate) fn new(
        members: Vec<Member>,
        reference: Dynamics,
        robots: Box<dyn Robots>,
        layout: Layout,
        sampled: bool,
    ) -> Self {
        let record = RecordWork {
            d_reference: vec![0.0; layout.theta_hat - layout.reference],
            seen: Seen::default(),
            mass: vec![0.0; layout.m * layout.m],
            delta: vec![0.0; layout.p],
            row: Vec::new(),
        };
        let output = Output { z: vec![0.0; layout.block()], dz: vec![0.0; layout.block()] };
        let layer = match reference.sliding() {
            Some(Sliding { choice: Choice::Layer { width }, .. }) if !sampled => {
                Some(Layer { width: *width, selection: vec![0.0; layout.block()] })
            }
            _ => None,
        };
        let mut population = Population { members, reference, robots, layout, output, sampler: None, layer, record };
        population.record.row = vec![0.0; population.signals().len()];
        population
    }

    /// The reference of everybody, then everything else pack by pack.
    fn try_rates(&mut self, t_s: f64, x: &[f64], inputs: Inputs<'_>, dx: &mut [f64]) -> Result<(), LengthError> {
        let l = self.layout;
        LengthError::check("state", l.len, x.len())?;
        LengthError::check("rate", l.len, dx.len())?;
        dx[..l.block()].copy_from_slice(&x[l.dq..l.reference]);
        let drive = match &self.sampler {
            Some(sampler) => {
                dx[l.reference..].fill(0.0);
                sampler.drive(inputs.external)
            }
            None => {
                let (Output { z, dz }, reference) = (&mut self.output, &self.reference);
                let d_state = &mut dx[l.reference..l.theta_hat];
                evaluate(reference, l, (t_s, x), inputs, ReferenceOut { z, dz, d_state: &mut *d_state })?;
                add_sign_terms_now(reference, &mut self.layer, l, x, inputs, dz, d_state)?;
                Drive { z, dz, held: None, external: inputs.external }
            }
        };
        self.robots.rates(x, drive, dx)
    }

    fn try_record(
        &mut self,
        t_s: f64,
        x: &[f64],
        inputs: Inputs<'_>,
        write: &mut dyn FnMut(usize, &[f64]),
    ) -> Result<(), LengthError> {
        let l = self.layout;
        if self.sampler.is_none() {
            let (Output { z, dz }, reference) = (&mut self.output, &self.reference);
            let d_state = &mut self.record.d_reference[..];
            evaluate(reference, l, (t_s, x), inputs, ReferenceOut { z, dz, d_state: &mut *d_state })?;
            add_sign_terms_now(reference, &mut self.layer, l, x, inputs, dz, d_state)?;
        }
        for pack in 0..self.robots.packs() {
            let Output { z, dz } = &self.output;
            let drive = match &self.sampler {
                Some(sampler) => sampler.drive(inputs.external),
                None => Drive { z, dz, held: None, external: inputs.external },
            };
            self.robots.act(pack, x, drive)?;
            for (lane, member) in self.robots.members(pack).enumerate() {
                self.robots.see(lane, &mut self.record.seen);
                self.fill_row(member, x)?;
                write(self.members[member].agent, &self.record.row);
            }
        }
        Ok(())
    }

    /// Fills the row of the member that was just seen.
    fn fill_row(&mut self, member: usize, x: &[f64]) -> Result<(), LengthError> {
        let (l, r, reference) = (self.layout, &mut self.record, &self.reference);
        let (seen, transmitted) = (&r.seen, reference.transmitted());
        let mut slots = r.row.iter_mut();
        let mut put = |value: f64| {
            if let Some(slot) = slots.next() {
                *slot = value;
            }
        };
        seen.q.iter().chain(&seen.dq).chain(&seen.z).chain(&seen.dz).copied().for_each(&mut put);
        (2 * l.m..reference.derivatives() * l.m).for_each(|column| put(x[l.reference + column * l.n + member]));
        if let Some(held) = transmitted.held {
            let first = l.reference + held * l.block();
            (0..transmitted.channels() * l.m).for_each(|column| put(x[first + column * l.n + member]));
        }
        if reference.sliding().is_some() {
            let held = &x[l.theta_hat - l.block()..l.theta_hat];
            let selection = self.layer.as_ref().map_or(held, |layer| &layer.selection);
            (0..l.m).for_each(|axis| put(selection[axis * l.n + member]));
        }
        seen.s.iter().chain(&seen.applied).copied().for_each(&mut put);
        if l.adaptive {
            seen.theta_hat.iter().copied().for_each(&mut put);
        }

        let agent = &mut self.members[member];
        self.robots.mass_matrix(&seen.q, &agent.theta, &mut r.mass)?;
        let mut lyapunov = 0.0;
        for (row, s_row) in r.mass.chunks_exact(l.m).zip(&seen.s) {
            for (mass, s_column) in row.iter().zip(&seen.s) {
                lyapunov += 0.5 * mass * s_row * s_column;
            }
        }
        if let Some(cost) = &mut agent.estimate_cost {
            for ((delta, estimate), truth) in r.delta.iter_mut().zip(&seen.theta_hat).zip(&agent.theta) {
                *delta = estimate - truth;
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

impl Columns for Population {
    fn state_len(&self) -> usize {
        self.layout.len
    }

    fn message(&self) -> usize {
        let held = self.reference.transmitted().held;
        held.map_or(0, |held| self.layout.reference + held * self.layout.block())
    }

    fn append_start(&self, all: &[AgentSetup], x: &mut Vec<f64>) {
        let (first, l) = (x.len(), self.layout);
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
        let l = self.layout;
        let given = x[l.reference..l.theta_hat].to_vec();
        let (measured, state) = x[..l.theta_hat].split_at_mut(l.reference);
        let measured = Measured { q: &measured[..l.dq], dq: &measured[l.dq..] };
        self.reference.start(l.m, measured, &given, Inputs { degree, sums, external: None }, state)
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
        let l = self.layout;
        if let Some(member) = self.members.iter().position(|member| member.agent == agent) {
            take(l.n, member, x, q);
            take(l.n, member, &x[l.dq..], dq);
        }
    }

    fn sense(&mut self, t_s: f64, x: &[f64], sent: &mut [f64]) {
        let l = self.layout;
        if let Some(sampler) = &mut self.sampler {
            sampler.sense(t_s, &x[..l.reference], sent);
        }
    }

    fn recipes(&self, setup: &Setup, x: &[f64]) -> Result<Vec<(usize, Recipe)>, SetupError> {
        let l = self.layout;
        let recipe = |(i, member): (usize, &Member)| {
            let mut state = vec![0.0; (l.balance - l.reference) / l.n];
            take(l.n, i, &x[l.reference..l.balance], &mut state);
            let reference = dynamics(&Assembly::new(setup, &[member.agent]))?;
            let theta_hat = if l.adaptive { state[state.len() - l.p..].to_vec() } else { member.theta.clone() };
            let mut recipe = self.robots.recipe(reference, member.law.clone(), theta_hat);
            recipe.start = StartState::State(state);
            Ok((member.agent, used(recipe, setup, member.agent, l.m)?))
        };
        self.members.iter().enumerate().map(recipe).collect()
    }

    fn sample(&mut self, control: &Control, controllers: Vec<Box<dyn Sampled>>) {
        let m = self.layout.m;
        let outputs = [(Signal::Position, m), (Signal::Velocity, m)];
        let agents = self.members.iter().zip(controllers);
        let agents = agents.map(|(member, controller)| Digital::new(control, member.agent, &outputs, controller));
        self.sampler = Some(Sampler::new(agents.collect(), m));
    }

    fn command(&mut self, now_s: f64, inputs: Inputs<'_>, x: &mut [f64]) {
        let l = self.layout;
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
        let l = self.layout;
        self.reference.sliding().map(|_| l.theta_hat - l.block()..l.theta_hat)
    }

    fn transmit(&mut self, _: f64, dx: &[f64], transmitted: &mut [f64]) {
        let l = self.layout;
        match self.reference.sliding().map(|sliding| sliding.derived) {
            Some(Derived::Acceleration) => transmitted.copy_from_slice(&dx[l.dq..l.reference]),
            Some(Derived::ReferenceAcceleration) => transmitted.copy_from_slice(&self.output.dz),
            _ => {}
        }
    }

    fn argument(&mut self, x: &[f64], inputs: Inputs<'_>, transmitted: [&[f64]; 2], e: &mut [f64]) {
        let checked = argument(&self.reference, self.layout, x, inputs, transmitted, e);
        debug_assert_eq!(checked, Ok(()), "lengths are fixed when the population is built");
    }

    fn add_sign_terms(&mut self, selection: &[f64], dx: &mut [f64]) {
        let l = self.layout;
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
    fn trouble(&mut self, _: &[f64]) -> Option<(usize, Singularity)> {
        None
    }

    fn next_event_s(&self, _: f64) -> f64 {
        f64::INFINITY
    }

    fn pass_kink(&mut self, _: f64, _: &mut [f64]) {}

    fn signals(&self) -> Vec<(Signal, usize)> {
        let (l, reference) = (self.layout, &self.reference);
        let transmitted = reference.transmitted();
        let mut signals = Vec::new();
        let mut axes = |signal, count| signals.extend((0..count).map(|axis| (signal, axis)));
        axes(Signal::Position, l.m);
        axes(Signal::Velocity, l.m);
        for r in 0..reference.derivatives().max(2) {
            axes(Signal::Reference(r as u8), l.m);
        }
        if transmitted.held.is_some() {
            transmitted.signals.iter().for_each(|held| axes(*held, l.m));
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
        vec![(Signal::Torque, first..first + self.layout.m)]
    }

    fn locate(&self, state: usize) -> (usize, Signal, usize) {
        let l = self.layout;
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
            let transmitted = self.reference.transmitted();
            let held = transmitted.held.and_then(|held| transmitted.signals.get(block.checked_sub(held)?));
            (held.copied().unwrap_or(Signal::Reference(block as u8)), axis)
        } else if state >= l.dq {
            (Signal::Velocity, column(l.dq))
        } else {
            (Signal::Position, state / l.n)
        };
        (agent, signal, axis)
    }

    fn gain_rates(&mut self, agent: usize, x: &[f64]) -> Option<GainRates> {
        let l = self.layout;
        if self.sampler.is_some() {
            return None;
        }
        let index = self.members.iter().position(|member| member.agent == agent)?;
        let own = |columns: &[f64]| -> Vec<f64> { (0..l.m).map(|axis| columns[axis * l.n + index]).collect() };
        let Output { z, dz } = &self.output;
        let (q, dq, z, dz) = (own(x), own(&x[l.dq..]), own(z), own(dz));
        let motion = TwoVelocity { q: &q, dq: &dq, z: &z, dz: &dz };
        self.robots.gain_rates(&self.members[index], motion).ok()?
    }
}
