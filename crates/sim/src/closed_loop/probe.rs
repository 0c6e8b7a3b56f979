//! What is seen of an agent by itself: the Lyapunov balance that its law states, tried along short runs from random starts, and whether the
//! law can be evaluated where it starts.

use std::sync::Arc;

use forwardstep_core::controller::Singularity;

use super::assembly::Assembly;
use super::columns::{Columns, Inputs};
use super::error::SetupError;
use super::valid::message_len;
use crate::leader::{Following, Leading};
use crate::network::Network;
use crate::probe::{Counterexample, Draws, Identity, MOVE, Probe, STATES, apart};
use crate::recording::Signal;
use crate::reference::{ReferenceDynamics, Tracking};
use crate::schedule::Schedule;
use crate::setup::{Setup, Solver};

/// How far starts are drawn from the stated one, relative to its size.
const AROUND: f64 = 0.5;
/// Steps of a short run, and how far each moves a state, relative to its size.
const STEPS: usize = 20;
const STEP: f64 = 0.02;
/// A V that is not larger is the rounding of zero.
const ZERO: f64 = 1e-9;

/// Tries whether the Lyapunov-like function of the law of agent `index` changes as the law says. The agent starts at random
/// around its start and moves a little, since what a controller takes from its start (a momentum, a filter) is part of its
/// state; then V is held against what it loses. The plant is in continuous time, without limits or forces from outside, and hears
/// the same random messages all the time.
///
/// # Errors
/// [`SetupError`] when the law cannot build the agent.
pub fn probe_balance(setup: &Setup, index: usize) -> Result<Probe, SetupError> {
    let Some(mut alone) = alone(setup, index) else { return Ok(Probe::default()) };
    let (mut draws, mut probe) = (Draws::new(), Probe::default());
    let stated = alone.agents[0].start.clone();
    let sums = message_len(&alone);
    for _ in 0..STATES {
        let start = &mut alone.agents[0].start;
        *start = stated.clone();
        for x in start.q.iter_mut().chain(&mut start.dq).chain(&mut start.rest) {
            *x += AROUND * (1.0 + x.abs()) * draws.unit();
        }
        let law = alone.agents[0].law.clone();
        let mut block = law.block(&Assembly::new(&alone, &[0]))?;
        let sums: Vec<f64> = (0..sums).map(|_| draws.unit()).collect();
        let degree = [1.0 + draws.unit()];
        let heard = Inputs { degree: &degree, sums: &sums, external: None };
        let t_s = 0.5 * (1.0 + draws.unit()) * setup.time.end_s;
        match tried(&mut *block.0, &alone, heard, t_s) {
            None => {}
            Some(Ok(())) => probe.states += 1,
            Some(Err(counterexample)) => {
                probe.states += 1;
                probe.found = Some(counterexample);
                break;
            }
        }
    }
    Ok(probe)
}

/// What the law of agent `index` divides by where it starts, if that is closer to zero than it may be: a run ends there before it begins.
///
/// # Errors
/// [`SetupError`] when the law cannot build the agent. Whether its start has a meaning is for who simulates it to say.
pub fn singular_start(setup: &Setup, index: usize) -> Result<Option<Singularity>, SetupError> {
    let Some(alone) = alone(setup, index) else { return Ok(None) };
    let mut block = alone.agents[0].law.block(&Assembly::new(&alone, &[0]))?;
    let columns = &mut *block.0;
    let sums = vec![0.0; message_len(&alone)];
    let heard = Inputs { degree: &[0.0], sums: &sums, external: None };
    let mut x = Vec::new();
    columns.append_start(&alone.agents, &mut x);
    if columns.start(&alone.agents, &mut x, heard.degree, heard.sums).is_err() {
        return Ok(None);
    }
    columns.rates(0.0, &x, heard, &mut vec![0.0; columns.state_len()]);
    Ok(columns.trouble(&x).map(|(_, singularity)| singularity))
}

/// Agent `index` without neighbours, pushes and limits, in continuous time and with its balance.
pub(super) fn alone(setup: &Setup, index: usize) -> Option<Setup> {
    let mut own = setup.agents.get(index)?.clone();
    own.enforce_limits = false;
    own.pushes.clear();
    Some(Setup {
        agents: vec![own],
        reference: alone_under(setup, index),
        exchange: setup.exchange,
        network: Network::switching(1, Schedule::fixed(Vec::new()), Vec::new()),
        time: setup.time.clone(),
        solver: Solver { balance: true, ..setup.solver },
        control: None,
    })
}

/// What leads the agent when it is by itself. It then has the number zero, which must not be taken for that of the leader.
pub(super) fn alone_under(setup: &Setup, index: usize) -> Arc<dyn ReferenceDynamics> {
    if setup.leader() == Some(index) {
        return Arc::new(Tracking);
    }
    match setup.following() {
        Some(following) => Arc::new(Following { leader: Leading::Agent(usize::MAX), ..following.clone() }),
        None => Arc::clone(&setup.reference),
    }
}

/// What is found after a short run from `t_s` on; nothing where something is not finite.
fn tried(
    columns: &mut dyn Columns,
    setup: &Setup,
    heard: Inputs<'_>,
    mut t_s: f64,
) -> Option<Result<(), Counterexample>> {
    let n = columns.state_len();
    let lost = (0..n).find(|state| columns.locate(*state).1 == Signal::Dissipation)?;
    let value = columns.signals().iter().position(|(signal, _)| *signal == Signal::Lyapunov)?;
    let mut x = Vec::new();
    columns.append_start(&setup.agents, &mut x);
    columns.start(&setup.agents, &mut x, heard.degree, heard.sums).ok()?;
    let moved = |x: &[f64], h: f64, dx: &[f64]| x.iter().zip(dx).map(|(x, dx)| x + h * dx).collect::<Vec<f64>>();
    // How fast the fastest state changes, 1/s: a step of a / fastest moves none by more than a of its size.
    let fastest =
        |x: &[f64], dx: &[f64]| dx.iter().zip(x).map(|(dx, x)| dx.abs() / (1.0 + x.abs())).fold(1.0, f64::max);
    let rate = |columns: &mut dyn Columns, t_s: f64, x: &[f64]| {
        let mut dx = vec![0.0; n];
        columns.rates(t_s, x, heard, &mut dx);
        dx
    };
    for _ in 0..STEPS {
        // The classical Runge–Kutta step.
        let k1 = rate(columns, t_s, &x);
        let h = STEP / fastest(&x, &k1);
        let k2 = rate(columns, t_s + 0.5 * h, &moved(&x, 0.5 * h, &k1));
        let k3 = rate(columns, t_s + 0.5 * h, &moved(&x, 0.5 * h, &k2));
        let k4 = rate(columns, t_s + h, &moved(&x, h, &k3));
        for (k, x) in x.iter_mut().enumerate() {
            *x += h / 6.0 * (k1[k] + 2.0 * (k2[k] + k3[k]) + k4[k]);
        }
        columns.settle(&mut x);
        t_s += h;
    }
    let dx = rate(columns, t_s, &x);
    let fastest = fastest(&x, &dx);
    let h = MOVE / fastest;
    let mut v = |h: f64| {
        let mut v = f64::NAN;
        columns
            .record(t_s + h, &moved(&x, h, &dx), heard, &mut |_, row| v = row.get(value).copied().unwrap_or(f64::NAN));
        v
    };
    let (before, here, after) = (v(-h), v(0.0), v(h));
    let (changes, said) = ((after - before) / (2.0 * h), -dx[lost]);
    if !(changes.is_finite() && said.is_finite()) {
        return None;
    }
    let identity = Identity::Balance;
    let found = || Counterexample { identity, t_s, state: x.clone(), value: said, expected: changes };
    Some(if apart(changes, said, (here.abs() + ZERO) * fastest) { Err(found()) } else { Ok(()) })
}
