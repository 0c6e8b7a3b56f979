//! Chains of Section IV: the identities of the proofs along real runs, agreement, and sampled control.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_core::expression::Expression;
use forwardstep_core::plant::{CascadeTerms, Formulas};
use forwardstep_sim::chain::{ChainLaw, ChainModel, ChainStep, Estimate};
use forwardstep_sim::coupling::Coupling;
use forwardstep_sim::delay::Delay;
use forwardstep_sim::graph::{Edge, Weight};
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::trajectory::{Path, Sinusoid, Trajectory};
use forwardstep_sim::{
    AgentSetup, Axis, AxisUnit, Control, Ending, Exchange, Law, Method, Network, Outcome, ReferenceKind, RobotKind,
    RobotSetup, Setup, Signal, Solver, Start, TimeSpan, simulate,
};

fn x(index: usize) -> Expression {
    Expression::variable(index)
}

fn number(value: f64) -> Expression {
    Expression::number(value)
}

fn estimate(gamma: &[f64]) -> Estimate {
    Estimate { adaptation: gamma.to_vec(), start: vec![0.0; gamma.len()] }
}

fn agent(index: usize, model: ChainModel, theta: &[f64], step: ChainStep, roots: &[f64], state: &[f64]) -> AgentSetup {
    let axis = Axis {
        name: "x".into(),
        unit: AxisUnit::Metre,
        position_limits: None,
        velocity_limit: None,
        effort_limit: None,
    };
    AgentSetup {
        name: format!("chain-{index}"),
        robot: RobotSetup {
            kind: RobotKind::Chain(model),
            theta: theta.to_vec(),
            theta_names: (1..=theta.len()).map(|k| format!("theta{k}")).collect(),
            axes: vec![axis],
        },
        roots_per_s: roots.to_vec(),
        manipulability: 0.0,
        law: Law::Chain(ChainLaw { step, floor: 1e-3 }),
        target: None,
        start: Start { q: vec![state[0]], dq: Vec::new(), rest: state[1..].to_vec(), reference: Vec::new() },
        enforce_limits: false,
        pushes: Vec::new(),
    }
}

/// ẍ = −x³ + θ₁ sin x + θ₂ ẋ² + (2 + cos x) u.
fn second_order() -> ChainModel {
    let phi = vec![x(0).sin_of(), x(1).power(2.0)];
    ChainModel::Derivatives(Arc::new(Formulas::new(2, &-x(0).power(3.0), phi, &(x(0).cos_of() + 2.0)).unwrap()))
}

/// d³x/dt³ = −ẋ ẍ + θ₁ x² + θ₂ sin ẍ + u.
fn third_order() -> ChainModel {
    let phi = vec![x(0).power(2.0), x(2).sin_of()];
    ChainModel::Derivatives(Arc::new(Formulas::new(3, &-(x(1) * x(2)), phi, &number(1.0)).unwrap()))
}

fn strict(order: usize) -> ChainModel {
    let all = [
        vec![x(0).power(2.0), number(0.0)],
        vec![x(0) * x(1), x(1).sin_of()],
        vec![number(0.0), x(2) * x(0)],
        vec![x(3).tanh_of(), x(0)],
    ];
    ChainModel::Cascade(Arc::new(CascadeTerms::strict(all[..order].to_vec()).unwrap()))
}

/// ẋ_1 = x_2 + 0.2 x_2³ + θ₁ x_1², ẋ_2 = u + θ₂ x_1 x_2 + θ₁ tanh x_2, where θ₁ also bends x_2 in the first equation.
fn pure() -> ChainModel {
    let known = vec![x(1) + x(1).power(3.0) * 0.2, number(0.0)];
    let regressors = vec![vec![x(0).power(2.0) + x(1).tanh_of() * 0.3, number(0.0)], vec![x(1).tanh_of(), x(0) * x(1)]];
    ChainModel::Cascade(Arc::new(CascadeTerms::new(known, regressors, number(1.0)).unwrap()))
}

fn setup(agents: Vec<AgentSetup>, reference: ReferenceKind, end_s: f64) -> Setup {
    let n = agents.len();
    let edge = |from, to| Edge { from, to, weight: Weight::Constant(1.0), delay: 0 };
    let phase = |edges| Phase { dwell_s: 0.8, edges };
    let (schedule, delays) = if reference == ReferenceKind::Tracking {
        (Schedule::Fixed(Vec::new()), Vec::new())
    } else {
        (
            Schedule::Periodic(vec![phase(vec![edge(0, 1), edge(1, 0)]), phase(vec![edge(1, 2), edge(2, 0)])]),
            vec![Delay::SawTooth { min_s: 0.05, max_s: 0.3, period_s: 0.5, offset_s: 0.0 }],
        )
    };
    Setup {
        agents,
        reference,
        exchange: Exchange::Position,
        network: Network { agents: n, schedule, delays, weights: Vec::new(), coupling: Default::default() },
        time: TimeSpan { end_s, record_every_s: 0.05 },
        solver: Solver { method: Method::Adaptive { rtol: 1e-8, atol: 1e-10 }, ..Solver::default() },
        control: None,
    }
}

/// Linearisation, adaptation, and immersion side by side, of orders two and three.
fn derivatives() -> Setup {
    let antiderivatives = vec![x(1) * x(0).sin_of(), x(1).power(3.0) / 3.0];
    let steps = [
        ChainStep::Linearising { gain_per_s: 2.0 },
        ChainStep::Adaptive { gain_per_s: 2.0, estimate: estimate(&[2.0, 2.0]) },
        ChainStep::Immersion { gain_per_s: 2.0, estimate: estimate(&[2.0, 2.0]), antiderivatives },
    ];
    let [known, adaptive, immersion] = steps;
    let agents = vec![
        agent(1, second_order(), &[0.8, -0.4], known, &[1.0, 2.0], &[1.0, 0.2]),
        agent(2, third_order(), &[0.5, 0.6], adaptive, &[1.0, 2.0, 1.5], &[-0.5, 0.1, 0.3]),
        agent(3, second_order(), &[0.8, -0.4], immersion, &[1.5, 2.0], &[-1.0, 0.3]),
    ];
    setup(agents, ReferenceKind::Consensus, 40.0)
}

/// Strict-feedback chains of orders two, three and four.
fn cascades() -> Setup {
    let of = |index: usize, order: usize, state: &[f64]| {
        let step = ChainStep::Backstepping { gains_per_s: vec![1.0; order], estimate: estimate(&[1.0, 1.0]) };
        agent(index, strict(order), &[0.3, -0.2], step, &[1.0, 2.0, 1.5, 1.2][..order], state)
    };
    let agents = vec![of(1, 2, &[0.6, 0.0]), of(2, 3, &[-0.4, 0.1, 0.0]), of(3, 4, &[0.2, 0.0, 0.1, 0.0])];
    setup(agents, ReferenceKind::Consensus, 60.0)
}

/// Pure-feedback chains.
fn pure_feedback() -> Setup {
    let of = |index: usize, state: &[f64]| {
        let step = ChainStep::Backstepping { gains_per_s: vec![1.0; 2], estimate: estimate(&[1.0, 1.0]) };
        agent(index, pure(), &[0.4, -0.3], step, &[1.0, 2.0], state)
    };
    setup(vec![of(1, &[0.6, 0.1]), of(2, &[-0.5, 0.0]), of(3, &[0.1, -0.2])], ReferenceKind::Consensus, 60.0)
}

/// A chain of each kind that follows a trajectory.
fn tracking() -> Setup {
    let step = ChainStep::Backstepping { gains_per_s: vec![1.0; 3], estimate: estimate(&[1.0, 1.0]) };
    let adaptive = ChainStep::Adaptive { gain_per_s: 2.0, estimate: estimate(&[5.0, 5.0]) };
    let known = ChainStep::Linearising { gain_per_s: 2.0 };
    let mut agents = vec![
        agent(1, strict(3), &[0.3, -0.2], step, &[1.0, 2.0, 1.5], &[0.6, 0.0, 0.0]),
        agent(2, third_order(), &[0.5, 0.6], adaptive, &[1.0, 2.0, 1.5, 1.2], &[-0.5, 0.1, 0.3]),
        agent(3, second_order(), &[0.8, -0.4], known, &[1.0, 2.0], &[1.0, 0.2]),
    ];
    for agent in &mut agents {
        let wave = Sinusoid { amplitude: 0.5, rad_per_s: 0.8, phase_rad: 0.4 };
        agent.target = Some(Trajectory::new(vec![Path::Sinusoids { offset: 0.1, waves: vec![wave] }]).unwrap());
    }
    setup(agents, ReferenceKind::Tracking, 100.0)
}

fn run(setup: &Setup) -> Outcome {
    let outcome = simulate(setup, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(outcome.ending, Ending::Completed);
    outcome
}

fn column(outcome: &Outcome, agent: usize, signal: Signal, axis: usize) -> &[f64] {
    let is_it = |c: &&forwardstep_sim::Column| c.agent == agent && c.signal == signal && c.axis == axis;
    &outcome.recording.columns.iter().find(is_it).unwrap().values
}

/// max |V + ∫ dissipation − V(0)| / V(0).
fn ledger_error(outcome: &Outcome, agent: usize) -> f64 {
    let v = column(outcome, agent, Signal::Lyapunov, 0);
    let lost = column(outcome, agent, Signal::Dissipation, 0);
    v.iter().zip(lost).map(|(now, lost)| (now + lost - v[0]).abs() / v[0].max(1.0)).fold(0.0, f64::max)
}

fn spread(outcome: &Outcome, row: usize) -> f64 {
    let x: Vec<f64> = (0..3).map(|agent| column(outcome, agent, Signal::Position, 0)[row]).collect();
    x.iter().fold(f64::MIN, |a, b| a.max(*b)) - x.iter().fold(f64::MAX, |a, b| a.min(*b))
}

#[test]
fn eq_lyapunov_identities_of_chains_hold_along_real_runs() {
    for setup in [derivatives(), cascades(), pure_feedback(), tracking()] {
        let outcome = run(&setup);
        for agent in 0..setup.agents.len() {
            let error = ledger_error(&outcome, agent);
            assert!(error <= 10.0 * 1e-8, "{}: {error}", setup.agents[agent].name);
        }
    }
}

#[test]
fn thm3_chains_of_different_orders_agree_over_switching_delayed_links() {
    for setup in [derivatives(), cascades(), pure_feedback()] {
        let outcome = run(&setup);
        let last = outcome.recording.columns[0].values.len() - 1;
        let (first, end) = (spread(&outcome, 0), spread(&outcome, last));
        assert!(end < 1e-3 * first, "{}: {first} to {end}", setup.agents[0].law.words());
    }
}

#[test]
fn eq_43_chains_reach_their_targets() {
    let outcome = run(&tracking());
    for agent in 0..3 {
        let error = column(&outcome, agent, Signal::Error, 0);
        assert!(error.last().unwrap().abs() < 1e-3 * error[0].abs(), "{agent}: {} {}", error[0], error.last().unwrap());
    }
}

#[test]
fn prop_sampled_chains_come_closer_to_continuous_ones_in_proportion_to_the_period() {
    let mut coupled = derivatives();
    coupled.network.coupling = Coupling::Tanh { scale: 0.3 };
    for setup in [derivatives(), coupled, cascades(), pure_feedback(), tracking()] {
        let mut setup = setup;
        setup.time.end_s = 3.0;
        let continuous = run(&setup);
        let gaps: Vec<f64> = [250.0, 500.0, 1000.0]
            .into_iter()
            .map(|sample_hz| {
                setup.control = Some(Control {
                    sample_hz,
                    computation_delay_s: 0.0,
                    sensors: Default::default(),
                    actuators: Default::default(),
                });
                let sampled = run(&setup);
                let end = |outcome: &Outcome| *column(outcome, 1, Signal::Position, 0).last().unwrap();
                (end(&sampled) - end(&continuous)).abs()
            })
            .collect();
        for pair in gaps.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((0.7..1.3).contains(&order), "{}: {gaps:?}", setup.agents[0].law.words());
        }
    }
}

#[test]
fn prop_a_coupling_that_never_saturates_is_the_linear_one() {
    let linear = run(&derivatives());
    let mut setup = derivatives();
    setup.network.coupling = Coupling::Saturated { limit: 100.0 };
    let wide = run(&setup);
    setup.network.coupling = Coupling::Saturated { limit: 0.1 };
    let narrow = run(&setup);
    let end = |outcome: &Outcome, agent: usize| *column(outcome, agent, Signal::Position, 0).last().unwrap();
    for agent in 0..3 {
        assert!((end(&linear, agent) - end(&wide, agent)).abs() < 1e-6);
    }
    // A narrow one brings them together too, but elsewhere and later.
    let last = narrow.recording.columns[0].values.len() - 1;
    assert!((end(&linear, 0) - end(&narrow, 0)).abs() > 1e-3);
    assert!(spread(&narrow, last) < 0.1 * spread(&narrow, 0));
    assert!(spread(&narrow, last / 4) > 3.0 * spread(&linear, last / 4));
}
