//! Setups, runs and columns that several tests of verdicts share.
#![allow(clippy::unwrap_used, clippy::panic, dead_code, unreachable_pub, reason = "each test uses its own part")]

pub mod kinds;

use forwardstep_sim::reference::Consensus;
use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_check::{Answer, Report, check};
use forwardstep_core::Gain;
use forwardstep_core::robot::{PlanarArm, PlanarLinks, PointMass};
use forwardstep_sim::delay::Delay;
use forwardstep_sim::graph::Edge;
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::{
    Adaptive, AgentSetup, Axis, AxisUnit, Ending, Exchange, Known, Method, Network, Outcome, RobotSetup, Setup, Signal,
    Solver, Start, TimeSpan, simulate,
};

/// A hypothesis that a test asks about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum About {
    SpanningTree,
    DwellTime,
    Delays,
    Weights,
    CommonFirstRoot,
    FixedGraph,
    CommonOrder,
    OwnOrders,
    RealRoots,
    FullTorque,
    PositionOnlyGains,
    ModelReferenceGains,
    ThrustGains,
    Thrust,
    AngularVelocity,
    Rotors,
    TaskSpaceGains,
    Determinant,
    Regressor,
    Lengths,
    Momentum,
    Path,
    Divisor,
    Regressors,
    Target,
    Offset,
    LeaderMotion,
    LeaderGain,
    LeaderReaches,
    LeaderFixed,
    Prompt,
    SetValued,
    Undirected,
    Coupling,
    OneKind,
    Measured,
    Manipulability,
    Derivative,
}

impl About {
    /// How it is found in a report: by a part of what it requires, which no other requires. Nothing else in these tests knows.
    fn requires(self) -> &'static str {
        match self {
            About::SpanningTree => "uniformly bounded windows",
            About::DwellTime => "positive dwell time",
            About::Delays => "delays are piecewise uniformly continuous",
            About::Weights => "weights are piecewise uniformly continuous",
            About::CommonFirstRoot => "κ₀ is common",
            About::FixedGraph | About::LeaderFixed => "the graph is fixed",
            About::CommonOrder => "of the same order",
            About::OwnOrders => "does not need the same for all",
            About::RealRoots => "Hurwitz with real roots",
            About::FullTorque => "the torque that the law asks for is applied",
            About::PositionOnlyGains => "k, λ_f and γ* are positive",
            About::ModelReferenceGains => "λ_f and γ* are positive",
            About::ThrustGains => "a mass that is not adapted is known",
            About::Thrust => "no thrust comes to zero",
            About::AngularVelocity => "the angular velocity is the one",
            About::Rotors => "every thrust and torque that is asked for can be produced",
            About::TaskSpaceGains => "K*, K, Γ and Λ are symmetric",
            About::Determinant => "stays away from singularity",
            About::Regressor => "depends on nothing uncertain",
            About::Lengths => "within the bounds of their estimates",
            About::Momentum => "angular momentum h_I",
            About::Path => "is never zero",
            About::Divisor => "the factor of the input",
            About::Regressors => "regressors and their derivatives are bounded",
            About::Target => "and its derivatives up to",
            About::Offset => "the derivatives of the offset",
            About::LeaderMotion => "jerk of the leader",
            About::LeaderGain => "γ exceeds",
            About::LeaderReaches => "the leader reaches everybody",
            About::Prompt => "messages arrive without delay",
            About::SetValued => "set-valued sgn",
            About::Undirected => "hear each other with the same weight",
            About::Coupling => "k λ > β",
            About::OneKind => "of the kind that one theorem",
            About::Measured => "q and q̇ are measured",
            About::Manipulability => "manipulability gain λ",
            About::Derivative => "has a derivative that can be measured",
        }
    }
}

/// The answers to all hypotheses of a report of this kind.
pub fn answers(report: &Report, about: About) -> Vec<Answer> {
    let found = report.hypotheses.iter().filter(|hypothesis| hypothesis.requires().contains(about.requires()));
    found.map(|hypothesis| hypothesis.answer()).collect()
}

/// The answer to the one hypothesis of this kind about a setup.
pub fn answer(setup: &Setup, about: About) -> Answer {
    let report = check(setup);
    let answers = answers(&report, about);
    assert_eq!(answers.len(), 1, "{about:?}: {report:?}");
    answers[0]
}

/// Numbers that look arbitrary but are always the same.
pub fn noise(seed: usize) -> f64 {
    (12.9898 * seed as f64 + 0.7).sin()
}

pub fn arm(index: usize, roots_per_s: &[f64]) -> AgentSetup {
    let links = PlanarLinks::uniform([1.0 + 0.2 * index as f64, 1.0], [1.0, 0.8]);
    AgentSetup {
        name: format!("arm-{}", index + 1),
        robot: RobotSetup {
            kind: Arc::new(PlanarArm),
            theta: links.theta().to_vec(),
            theta_names: vec![String::new(); 5],
            axes: vec![axis("shoulder"), axis("elbow")],
        },
        roots_per_s: roots_per_s.to_vec().into(),
        manipulability: 0.0,
        law: Arc::new(Adaptive {
            damping: Gain::Number(8.0),
            adaptation: Gain::Number(10.0),
            estimate_start: vec![0.0; 5],
            bounds: None,
        }),
        start: Start {
            q: vec![noise(index), noise(index + 10)],
            dq: vec![0.3 * noise(index + 20), 0.3 * noise(index + 30)],
            rest: Vec::new(),
            reference: Vec::new(),
        },
        enforce_limits: false,
        target: None,
        pushes: Vec::new(),
    }
}

pub fn axis(name: &str) -> Axis {
    Axis { name: name.into(), unit: AxisUnit::Radian, position_limits: None, velocity_limit: None, effort_limit: None }
}

pub fn edge(from: usize, to: usize, weight: f64, delay: usize) -> Edge {
    Edge { from, to, weight: weight.into(), delay }
}

pub fn setup(agents: Vec<AgentSetup>, exchange: Exchange, schedule: Schedule, delays: Vec<Delay>, end_s: f64) -> Setup {
    Setup {
        network: Network { agents: agents.len(), schedule, delays, weights: Vec::new(), coupling: Default::default() },
        agents,
        reference: Arc::new(Consensus),
        exchange,
        time: TimeSpan { end_s, record_every_s: 0.01, record_at: forwardstep_sim::RecordAt::Intervals },
        solver: Solver { method: Method::Adaptive { rtol: 1e-9, atol: 1e-10 }, ..Solver::default() },
        control: None,
    }
}

pub fn run(setup: &Setup) -> Outcome {
    let outcome = simulate(setup, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(outcome.ending, Ending::Completed);
    outcome
}

pub fn column(outcome: &Outcome, agent: usize, signal: Signal, axis: usize) -> &[f64] {
    let found = outcome.recording.columns.iter().find(|c| (c.agent, c.signal, c.axis) == (agent, signal, axis));
    &found.unwrap().values
}

/// Five point masses in motion with ϑ known and z(0) = q̇(0), so that s ≡ 0.
pub fn masses(exchange: Exchange, order: usize, schedule: Schedule, delays: Vec<Delay>) -> Setup {
    let agents = (0..5)
        .map(|i| {
            let mut agent = arm(i, &(0..order).map(|r| 1.0 + 0.7 * r as f64).collect::<Vec<_>>());
            agent.robot.kind = Arc::new(PointMass { dimension: 2 });
            agent.robot.theta = vec![1.0 + i as f64];
            agent.robot.theta_names = vec!["mass".into()];
            agent.law = Arc::new(Known { damping: Gain::Number(5.0) });
            agent
        })
        .collect();
    let mut setup = setup(agents, exchange, schedule, delays, 12.0);
    setup.time.record_every_s = 0.004;
    setup
}
