//! Arms and masses that follow a leader.

use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::reference::Choice;
use forwardstep_core::robot::{PlanarArm, PlanarLinks, PointMass};
use forwardstep_sim::delay::Delay;
use forwardstep_sim::graph::Edge;
use forwardstep_sim::leader::{Following, FollowingDesign, Leader, Leading};
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::trajectory::{Path, Sinusoid, Trajectory};
use forwardstep_sim::{
    Adaptive, AgentSetup, AxisUnit, Exchange, Known, Method, Network, RobotSetup, Setup, Solver, Start, TimeSpan,
};

use super::axes;

pub const SWARM: FollowingDesign = FollowingDesign::Swarm { coupling: 12.0 };
pub const COMPOSITE: FollowingDesign = FollowingDesign::Composite;
pub const OBSERVER: FollowingDesign = FollowingDesign::Observer { kappa: 2.5 };
pub const DESIGNS: [FollowingDesign; 6] = [
    FollowingDesign::Continuous,
    FollowingDesign::Differentiable,
    FollowingDesign::WithoutAcceleration,
    SWARM,
    COMPOSITE,
    OBSERVER,
];

/// Whether ξ̂ stands in the place of ξ.
pub fn observes(design: FollowingDesign) -> bool {
    matches!(design, FollowingDesign::Observer { .. })
}

/// What is told.
pub fn exchange(design: FollowingDesign) -> Exchange {
    match design {
        FollowingDesign::Observer { .. } => Exchange::Estimates,
        FollowingDesign::Composite => Exchange::Composite,
        _ => Exchange::PositionVelocity,
    }
}

pub fn arm(index: usize, q: [f64; 2], estimate: f64) -> AgentSetup {
    let links = PlanarLinks::uniform([2.0 + 0.2 * index as f64, 1.5], [1.0, 0.8]);
    let theta = links.theta().to_vec();
    AgentSetup {
        name: format!("arm-{index}"),
        robot: RobotSetup {
            kind: Arc::new(PlanarArm),
            theta_names: (0..theta.len()).map(|k| format!("theta{k}")).collect(),
            axes: axes(&["shoulder", "elbow"], AxisUnit::Radian),
            theta: theta.clone(),
        },
        roots_per_s: Vec::new().into(),
        manipulability: 0.0,
        law: Arc::new(Adaptive {
            damping: Gain::Number(20.0),
            adaptation: Gain::Number(10.0),
            estimate_start: theta.iter().map(|theta| estimate * theta).collect(),
            bounds: None,
        }),
        target: None,
        start: Start { q: q.to_vec(), dq: vec![0.0; 2], rest: Vec::new(), reference: Vec::new() },
        enforce_limits: false,
        pushes: Vec::new(),
    }
}

/// Four arms; the leader, vertex 4, is heard by the first alone.
pub fn arms(design: FollowingDesign, choice: Choice, estimate: f64, end_s: f64) -> Setup {
    let starts = [[0.6, -0.3], [-0.5, 0.4], [0.2, 0.8], [-0.8, -0.6]];
    let wave = |amplitude, rad_per_s, phase_rad| Sinusoid { amplitude, rad_per_s, phase_rad };
    let path = |offset, waves| Path::Sinusoids { offset, waves };
    let trajectory =
        Trajectory::new(vec![path(0.3, vec![wave(0.6, 0.8, 0.0)]), path(-0.2, vec![wave(0.4, 1.1, 0.5)])]).unwrap();
    let edge = |from, to, weight: f64| Edge { from, to, weight: weight.into(), delay: 0 };
    let following = Following {
        leader: Leading::Motion(Leader { name: "leader".into(), trajectory }),
        design,
        alpha: 1.0,
        beta: 2.0,
        gain: 2.0,
        choice,
        period_s: 1e-3,
    };
    Setup {
        agents: starts.iter().enumerate().map(|(k, q)| arm(k + 1, *q, estimate)).collect(),
        reference: Arc::new(following),
        exchange: exchange(design),
        network: Network {
            agents: 5,
            schedule: Schedule::fixed(vec![
                edge(4, 0, 1.0),
                edge(0, 1, 1.0),
                edge(1, 2, 1.0),
                edge(2, 3, 1.0),
                edge(3, 0, 1.0),
                // A swarm needs links that lead both ways; the others do not mind them.
                edge(1, 0, 1.0),
                edge(2, 1, 1.0),
                edge(3, 2, 1.0),
                edge(0, 3, 1.0),
                edge(4, 2, 1.0),
            ]),
            delays: vec![Delay::constant(0.0)],
            weights: Vec::new(),
            coupling: Default::default(),
        },
        time: TimeSpan { end_s, record_every_s: 0.01, record_at: forwardstep_sim::RecordAt::Intervals },
        solver: Solver { method: Method::Adaptive { rtol: 1e-7, atol: 1e-9 }, ..Solver::default() },
        control: None,
    }
}

/// The same with z(0) and ż(0) of their own, and an α that is not one.
pub fn on_its_way(mut setup: Setup) -> Setup {
    assert!(setup.change_reference(|following: &mut Following| following.alpha = 1.4));
    for (k, agent) in setup.agents.iter_mut().enumerate() {
        let of = |scale: f64| vec![scale * (k as f64 + 1.0), -0.2];
        agent.start.reference = vec![of(0.1), of(-0.3)];
    }
    setup
}

/// The problem of `validation/trajectories/following.py`.
pub fn masses(design: FollowingDesign) -> Setup {
    let mut setup = arms(design, Choice::Layer { width: 0.1 }, 1.0, 8.0);
    let wave = |amplitude, rad_per_s, phase_rad| Sinusoid { amplitude, rad_per_s, phase_rad };
    let waves = vec![wave(0.6, 0.8, 0.0), wave(0.2, 1.7, 0.5)];
    let trajectory = Trajectory::new(vec![Path::Sinusoids { offset: 0.1, waves }]).unwrap();
    setup.reference = Arc::new(Following {
        leader: Leading::Motion(Leader { name: "leader".into(), trajectory }),
        design,
        alpha: 1.3,
        beta: 2.1,
        gain: 2.5,
        choice: Choice::Layer { width: 0.1 },
        period_s: 1e-3,
    });
    let (q, dq) = ([0.8, -0.5, 0.3], [0.1, 0.0, -0.2]);
    let (z, dz) = ([0.3, 0.1, 0.0], [0.0, 0.2, -0.1]);
    setup.agents.truncate(3);
    for (k, agent) in setup.agents.iter_mut().enumerate() {
        agent.robot.kind = Arc::new(PointMass { dimension: 1 });
        agent.robot.theta = vec![[1.0, 2.0, 1.5][k]];
        agent.robot.theta_names.truncate(1);
        agent.robot.axes.truncate(1);
        agent.law = Arc::new(Known { damping: Gain::Number(8.0) });
        let free = if design == FollowingDesign::Continuous || observes(design) { 1 } else { 2 };
        let reference = vec![vec![z[k]], vec![dz[k]]][..free].to_vec();
        agent.start = Start { q: vec![q[k]], dq: vec![dq[k]], rest: Vec::new(), reference };
    }
    let edge = |to, from, weight: f64| Edge { from, to, weight: weight.into(), delay: 0 };
    setup.network.agents = 4;
    setup.network.schedule = Schedule::fixed(vec![edge(0, 3, 1.0), edge(1, 0, 1.5), edge(2, 1, 0.7), edge(0, 2, 0.4)]);
    setup.solver.method = Method::Adaptive { rtol: 1e-9, atol: 1e-11 };
    setup.time.record_every_s = 1.0;
    setup
}

/// The same setup, with an agent in the place of the motion: it begins on its target and knows its mass, so that it stays
/// there. It is agent number `place`.
pub fn led_by_agent(mut setup: Setup, roots: &[f64], place: usize) -> Setup {
    let trajectory = setup.following().unwrap().motion().unwrap().trajectory.clone();
    let mut jets = vec![[0.0; 5]; trajectory.axes()];
    trajectory.jets(0.0, &mut jets);
    let of = |k: usize| jets.iter().map(|jet| jet[k]).collect::<Vec<f64>>();
    let mut pilot = AgentSetup::new("pilot", RobotSetup::point_mass(jets.len(), 3.0), Known::gain(5.0))
        .roots(roots)
        .following(trajectory);
    pilot.start.q = of(0);
    pilot.start.dq = of(1);
    pilot.start.reference = (1..roots.len()).map(of).collect();
    let motion = setup.agents.len();
    setup.agents.insert(place, pilot);
    let moved = |vertex: usize| match vertex {
        vertex if vertex == motion => place,
        vertex if vertex >= place => vertex + 1,
        vertex => vertex,
    };
    let edges = setup.network.schedule.graphs[0].iter();
    let edges = edges.map(|edge| Edge { from: moved(edge.from), to: moved(edge.to), ..*edge }).collect();
    setup.network.schedule = Schedule::fixed(edges);
    assert!(setup.change_reference(|following: &mut Following| following.leader = Leading::Agent(place)));
    setup
}
