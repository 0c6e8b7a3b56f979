//! Systems of Sections IV and V as setups, and what tests ask of their runs.

#![allow(unreachable_pub, dead_code, reason = "shared by several tests, none of which uses all of it")]

pub mod chains;
pub mod following;
pub mod masses;
pub mod single;
pub mod truth;
pub mod vehicles;

use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_sim::delay::{Delay, SawTooth};
use forwardstep_sim::graph::{Edge, Weight};
use forwardstep_sim::reference::ReferenceDynamics;
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::trajectory::{Path, Sinusoid};
use forwardstep_sim::{
    AgentSetup, Axis, AxisUnit, Column, Ending, Exchange, Known, Method, Network, Outcome, Setup, Signal, Solver,
    TimeSpan, simulate,
};

pub const RTOL: f64 = 1e-8;

/// Every so many of these, and all of them where `.ci/long` asks for that.
pub fn some<T>(all: impl IntoIterator<Item = T>, every: usize) -> impl Iterator<Item = T> {
    all.into_iter().step_by(if is_long() { 1 } else { every })
}

/// Whether tests may take as long as before a release.
pub fn is_long() -> bool {
    std::env::var_os("FORWARDSTEP_LONG").is_some()
}

pub fn axes(names: &[&str], unit: AxisUnit) -> Vec<Axis> {
    let axis = |name: &&str| Axis {
        name: (*name).into(),
        unit,
        position_limits: None,
        velocity_limit: None,
        effort_limit: None,
    };
    names.iter().map(axis).collect()
}

pub fn wave(offset: f64, amplitude: f64, rad_per_s: f64, phase_rad: f64) -> Path {
    Path::Sinusoids { offset, waves: vec![Sinusoid { amplitude, rad_per_s, phase_rad }] }
}

pub fn fixed(offset: f64) -> Path {
    Path::Sinusoids { offset, waves: Vec::new() }
}

/// Nobody talks.
pub fn silent(agents: usize) -> Network {
    Network::silent(agents)
}

/// Two graphs in turn, over which three agents agree, with a delay that grows and jumps back.
pub fn switching() -> Network {
    let edge = |from, to| Edge { from, to, weight: Weight::Constant(1.0), delay: 0 };
    let phase = |edges| Phase { dwell_s: 0.8, edges };
    Network {
        schedule: Schedule::periodic(vec![phase(vec![edge(0, 1), edge(1, 0)]), phase(vec![edge(1, 2), edge(2, 0)])]),
        delays: vec![Delay::new(SawTooth { min_s: 0.05, max_s: 0.3, period_s: 0.5, offset_s: 0.0 })],
        ..silent(3)
    }
}

pub fn setup(agents: Vec<AgentSetup>, reference: Arc<dyn ReferenceDynamics>, network: Network, end_s: f64) -> Setup {
    Setup {
        agents,
        reference,
        exchange: Exchange::Position,
        network,
        time: TimeSpan { end_s, record_every_s: 0.05, record_at: forwardstep_sim::RecordAt::Intervals },
        solver: Solver { method: Method::Adaptive { rtol: RTOL, atol: 1e-10 }, ..Solver::default() },
        control: None,
    }
}

/// Three masses under (6) that agree over a ring with a delay, all of them on edges that stay.
pub fn consensus_of_masses(end_s: f64) -> Setup {
    let mut all = masses::consensus(2);
    for agent in &mut all.agents {
        agent.law = Arc::new(Known { damping: Gain::Number(6.0) });
    }
    let edge = |from, to| Edge { from, to, weight: Weight::Constant(1.0), delay: 0 };
    all.network.schedule = Schedule::fixed(vec![edge(0, 1), edge(1, 2), edge(2, 0)]);
    all.network.delays = vec![Delay::constant(0.5)];
    all.time.end_s = end_s;
    all
}

pub fn sampled(setup: Setup, sample_hz: f64) -> Setup {
    setup.sampled(sample_hz)
}

pub fn run(setup: &Setup) -> Outcome {
    let outcome = simulate(setup, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(outcome.ending, Ending::Completed);
    outcome
}

pub fn column(outcome: &Outcome, agent: usize, signal: Signal, axis: usize) -> &[f64] {
    let is_it = |c: &&Column| c.agent == agent && c.signal == signal && c.axis == axis;
    let found = outcome.recording.columns.iter().find(is_it);
    &found.unwrap_or_else(|| panic!("agent {agent} has no {signal:?} {axis}")).values
}

pub fn columns(outcome: &Outcome, signal: Signal) -> Vec<&[f64]> {
    let wanted = outcome.recording.columns.iter().filter(|column| column.signal == signal);
    wanted.map(|column| &column.values[..]).collect()
}

pub fn last(outcome: &Outcome, agent: usize, signal: Signal, axis: usize) -> f64 {
    *column(outcome, agent, signal, axis).last().unwrap()
}

/// max |V + ∫ dissipation − V(0)| as a part of V(0), or of `least` where V(0) is below it.
pub fn balance_residual(outcome: &Outcome, agent: usize, least: f64) -> f64 {
    let v = column(outcome, agent, Signal::Lyapunov, 0);
    let lost = column(outcome, agent, Signal::Dissipation, 0);
    v.iter().zip(lost).map(|(now, lost)| (now + lost - v[0]).abs() / v[0].max(least)).fold(0.0, f64::max)
}

/// The largest difference of positions at the end.
pub fn apart(a: &Outcome, b: &Outcome) -> f64 {
    let ends = |outcome| columns(outcome, Signal::Position).into_iter().map(|x: &[f64]| *x.last().unwrap());
    ends(a).zip(ends(b)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// A short run of every kind of system.
pub fn every_kind() -> Vec<(&'static str, Setup)> {
    use forwardstep_core::reference::Choice;
    use forwardstep_core::robot::tree::Uncertain;
    use forwardstep_sim::ThrustKind;
    use forwardstep_sim::leader::FollowingDesign;
    let vehicle = vehicles::vehicle();
    let spin = single::half_a_turn([0.1, -0.05, 0.08]);
    let arms = |design, choice| following::arms(design, choice, 0.8, 4.0);
    let mut all = vec![
        ("chains-of-derivatives", chains::derivatives()),
        ("chains-of-all-orders", chains::adaptive()),
        ("chains-strict-feedback", chains::cascades()),
        ("chains-pure-feedback", chains::pure_feedback()),
        ("chains-tracking", chains::tracking()),
        ("masses-tracking", masses::tracking()),
        ("masses-by-a-model", masses::by_model()),
        ("masses-consensus", masses::consensus(3)),
        ("vehicles-continuous", vehicles::three(&vehicle, ThrustKind::Continuous, false, 4.0)),
        ("vehicles-differentiable", vehicles::three(&vehicle, vehicles::DIFFERENTIABLE, true, 4.0)),
        ("vehicles-adaptive", vehicles::three(&vehicle, vehicles::ADAPTIVE, false, 4.0)),
        ("vehicles-by-acceleration", vehicles::three(&vehicle, vehicles::by_acceleration([0.0, 0.1, -0.2]), true, 4.0)),
        ("rotorcraft", vehicles::three(&vehicles::rotorcraft(), vehicles::ADAPTIVE, true, 4.0)),
        ("tip-of-a-planar-arm", single::planar(None, 0.3)),
        ("tip-of-a-tree", single::anthropomorphic(Uncertain::Chain)),
        ("spacecraft", single::craft(spin, single::targets().swap_remove(2), 5.0)),
        (
            "passivity-filter",
            single::filtered_craft(single::half_a_turn([0.1, -0.05, 0.08]), single::targets().swap_remove(2)),
        ),
        ("following-110", arms(FollowingDesign::Continuous, Choice::Implicit)),
        ("following-119", arms(FollowingDesign::Differentiable, Choice::Implicit)),
        ("following-122", arms(FollowingDesign::WithoutAcceleration, Choice::Implicit)),
        ("following-as-a-swarm", arms(following::SWARM, Choice::Explicit)),
        ("following-by-one-vector", following::on_its_way(arms(following::COMPOSITE, Choice::Implicit))),
        ("following-by-an-observer", arms(following::OBSERVER, Choice::Implicit)),
        (
            "following-110-an-agent",
            following::led_by_agent(arms(FollowingDesign::Continuous, Choice::Implicit), &[2.0, 1.5], 1),
        ),
        ("following-in-a-layer", arms(FollowingDesign::Differentiable, Choice::Layer { width: 0.05 })),
    ];
    for (_, setup) in &mut all {
        setup.time = TimeSpan { end_s: 4.0, record_every_s: 0.01, record_at: forwardstep_sim::RecordAt::Intervals };
    }
    all
}

/// Sampled runs, at this rate and twice and four times as often, come closer to the continuous one in proportion to the period.
pub fn assert_first_order(setup: &Setup, sample_hz: f64) {
    let continuous = run(setup);
    let gaps = [1.0, 2.0, 4.0].map(|often| apart(&run(&sampled(setup.clone(), often * sample_hz)), &continuous));
    for pair in gaps.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((0.7..1.3).contains(&order), "{}: {gaps:?}", setup.agents[0].law.words().name);
    }
}
