//! Reads the problems and trajectories under `validation/trajectories/cases`.

#![allow(unreachable_pub, dead_code, reason = "shared by several tests, none of which uses all of it")]

use forwardstep_sim::reference::{Backstepping, Consensus, PureIntegral};
use std::path::PathBuf;
use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::robot::{PlanarArm, PointMass};
use forwardstep_sim::delay::{Delay, PiecewiseConstant, SawTooth, Sinusoid};
use forwardstep_sim::graph::Edge;
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::{
    Adaptive, AgentSetup, Axis, AxisUnit, Exchange, Known, Law, Network, Robot, RobotSetup, Setup, Solver, Start,
    TimeSpan,
};
use serde::Deserialize;

#[derive(Clone, Deserialize)]
pub struct Case {
    pub name: String,
    pub end_s: f64,
    pub exchange: String,
    /// The consensus family where a case says nothing.
    #[serde(default)]
    pub reference: ReferenceCase,
    pub agents: Vec<AgentCase>,
    pub schedule: ScheduleCase,
    pub samples: Samples,
}

#[derive(Clone, Default, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum ReferenceCase {
    #[default]
    Consensus,
    PureIntegral,
    Backstepping {
        filter_s: f64,
    },
}

#[derive(Clone, Deserialize)]
pub struct AgentCase {
    pub robot: RobotCase,
    pub roots: Vec<f64>,
    #[serde(default)]
    pub lambda: f64,
    #[serde(rename = "K")]
    pub k: GainCase,
    #[serde(rename = "Gamma")]
    pub gamma: Option<GainCase>,
    pub knows_theta: bool,
    pub start: StartCase,
}

#[derive(Clone, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum RobotCase {
    PlanarArm { theta: Vec<f64> },
    PointMass { dimension: usize, theta: Vec<f64> },
}

#[derive(Clone, Deserialize)]
#[serde(untagged)]
pub enum GainCase {
    Number(f64),
    Diagonal(Vec<f64>),
    Matrix(Vec<Vec<f64>>),
}

#[derive(Clone, Deserialize)]
pub struct StartCase {
    q: Vec<f64>,
    dq: Vec<f64>,
    reference: Vec<Vec<f64>>,
    theta_hat: Vec<f64>,
}

#[derive(Clone, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum ScheduleCase {
    Fixed { edges: Vec<EdgeCase> },
    Repeat { phases: Vec<PhaseCase> },
    Once { phases: Vec<PhaseCase> },
}

#[derive(Clone, Deserialize)]
pub struct PhaseCase {
    dwell_s: f64,
    edges: Vec<EdgeCase>,
}

#[derive(Clone, Deserialize)]
pub struct EdgeCase {
    from: usize,
    to: usize,
    weight: f64,
    delay: DelayCase,
}

#[derive(Clone, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum DelayCase {
    Constant { s: f64 },
    Sinusoid { mean_s: f64, amplitude_s: f64, period_s: f64, phase_rad: f64 },
    PiecewiseConstant { times_s: Vec<f64>, values_s: Vec<f64>, period_s: Option<f64> },
    SawTooth { min_s: f64, max_s: f64, period_s: f64, offset_s: f64 },
}

#[derive(Clone, Deserialize)]
pub struct Samples {
    pub times_s: Vec<f64>,
    pub agents: Vec<AgentSamples>,
}

#[derive(Clone, Deserialize)]
pub struct AgentSamples {
    pub q: Vec<Vec<f64>>,
    pub dq: Vec<Vec<f64>>,
    pub reference: Vec<Vec<Vec<f64>>>,
    pub theta_hat: Vec<Vec<f64>>,
}

/// All cases, by name.
pub fn cases() -> Vec<Case> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../validation/trajectories/cases");
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.iter().map(|path| serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()).collect()
}

/// The setup of a case, with the default solver and one row every second.
pub fn setup(case: &Case) -> Setup {
    let mut delays = Vec::new();
    let schedule = match &case.schedule {
        ScheduleCase::Fixed { edges } => Schedule::fixed(wire(edges, &mut delays)),
        ScheduleCase::Repeat { phases } => Schedule::periodic(turns(phases, &mut delays)),
        ScheduleCase::Once { phases } => Schedule::once(turns(phases, &mut delays)),
    };
    Setup {
        agents: case.agents.iter().enumerate().map(agent).collect(),
        reference: match case.reference {
            ReferenceCase::Consensus => Arc::new(Consensus),
            ReferenceCase::PureIntegral => Arc::new(PureIntegral),
            ReferenceCase::Backstepping { filter_s } => Arc::new(Backstepping { filter_s, acceleration_limit: None }),
        },
        exchange: match case.exchange.as_str() {
            "position" => Exchange::Position,
            "position_velocity" => Exchange::PositionVelocity,
            other => panic!("exchange {other}"),
        },
        network: Network {
            agents: case.agents.len(),
            schedule,
            delays,
            weights: Vec::new(),
            coupling: Default::default(),
        },
        time: TimeSpan { end_s: case.end_s, record_every_s: 1.0, record_at: forwardstep_sim::RecordAt::Intervals },
        solver: Solver::default(),
        control: None,
    }
}

fn turns(phases: &[PhaseCase], delays: &mut Vec<Delay>) -> Vec<Phase> {
    phases.iter().map(|phase| Phase { edges: wire(&phase.edges, delays), dwell_s: phase.dwell_s }).collect()
}

fn wire(edges: &[EdgeCase], delays: &mut Vec<Delay>) -> Vec<Edge> {
    let edge = |edge: &EdgeCase| {
        let kind = delay(&edge.delay);
        let index = delays.iter().position(|known| *known == kind).unwrap_or_else(|| {
            delays.push(kind);
            delays.len() - 1
        });
        Edge { from: edge.from, to: edge.to, weight: edge.weight.into(), delay: index }
    };
    edges.iter().map(edge).collect()
}

fn delay(delay: &DelayCase) -> Delay {
    match delay.clone() {
        DelayCase::Constant { s } => Delay::constant(s),
        DelayCase::Sinusoid { mean_s, amplitude_s, period_s, phase_rad } => {
            Delay::new(Sinusoid { mean_s, amplitude_s, period_s, phase_rad })
        }
        DelayCase::PiecewiseConstant { times_s, values_s, period_s } => {
            Delay::new(PiecewiseConstant { times_s, values_s, period_s })
        }
        DelayCase::SawTooth { min_s, max_s, period_s, offset_s } => {
            Delay::new(SawTooth { min_s, max_s, period_s, offset_s })
        }
    }
}

fn agent((index, case): (usize, &AgentCase)) -> AgentSetup {
    let (kind, theta): (Arc<dyn Robot>, _) = match &case.robot {
        RobotCase::PlanarArm { theta } => (Arc::new(PlanarArm), theta.clone()),
        RobotCase::PointMass { dimension, theta } => (Arc::new(PointMass { dimension: *dimension }), theta.clone()),
    };
    let axis = |k| Axis {
        name: format!("{k}"),
        unit: AxisUnit::Radian,
        position_limits: None,
        velocity_limit: None,
        effort_limit: None,
    };
    let damping = gain(&case.k);
    let law: Arc<dyn Law> = match &case.gamma {
        Some(gamma) if !case.knows_theta => Arc::new(Adaptive {
            damping,
            adaptation: gain(gamma),
            estimate_start: case.start.theta_hat.clone(),
            bounds: None,
        }),
        _ => Arc::new(Known { damping }),
    };
    AgentSetup {
        name: format!("agent-{index}"),
        robot: RobotSetup {
            kind,
            theta_names: (0..theta.len()).map(|k| format!("theta{k}")).collect(),
            theta,
            axes: (1..=case.start.q.len()).map(axis).collect(),
        },
        roots_per_s: case.roots.clone().into(),
        manipulability: case.lambda,
        law,
        start: Start {
            q: case.start.q.clone(),
            dq: case.start.dq.clone(),
            rest: Vec::new(),
            reference: case.start.reference.clone(),
        },
        enforce_limits: false,
        target: None,
        pushes: Vec::new(),
    }
}

fn gain(gain: &GainCase) -> Gain {
    match gain {
        GainCase::Number(k) => Gain::Number(*k),
        GainCase::Diagonal(k) => Gain::Diagonal(k.clone()),
        GainCase::Matrix(rows) => Gain::Matrix(rows.concat()),
    }
}
