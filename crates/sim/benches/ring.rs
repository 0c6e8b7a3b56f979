//! A directed ring with constant delays, 20 s: the network of `validation/peers/jitcdde_ring.py`.
//!
//! Prints one line of JSON per case: wall time per simulated second over repeated runs, and the error at the end
//! against a run with a tolerance of 1e-10. `validation/peers/ring.sh` runs this beside the peer and prints ratios.

use forwardstep_sim::reference::Consensus;
use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::robot::{PlanarArm, PlanarLinks, PointMass};
use forwardstep_sim::delay::Delay;
use forwardstep_sim::graph::Edge;
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::{
    Adaptive, AgentSetup, Axis, AxisUnit, Exchange, Known, Law, Method, Network, Outcome, Robot, RobotSetup, Setup,
    Signal, Solver, Start, TimeSpan, simulate,
};

const END_S: f64 = 20.0;
const REPEATS: usize = 9;

#[derive(Clone, Copy)]
enum Model {
    Linear,
    Arms,
}

fn ring(model: Model, n: usize, tolerance: f64) -> Setup {
    let axis = |k: usize| Axis {
        name: format!("{}", k + 1),
        unit: AxisUnit::Radian,
        position_limits: None,
        velocity_limit: None,
        effort_limit: None,
    };
    let agent = |i: usize| {
        let position = (i as f64).sin();
        let (kind, theta, m): (Arc<dyn Robot>, _, _) = match model {
            Model::Linear => (Arc::new(PointMass { dimension: 1 }), vec![1.0], 1),
            Model::Arms => (Arc::new(PlanarArm), PlanarLinks::uniform([1.0, 1.0], [1.0, 1.0]).theta().to_vec(), 2),
        };
        let damping = Gain::Number(8.0);
        let law: Arc<dyn Law> = match model {
            Model::Linear => Arc::new(Known { damping }),
            Model::Arms => Arc::new(Adaptive {
                damping,
                adaptation: Gain::Number(10.0),
                estimate_start: vec![0.0; theta.len()],
                bounds: None,
            }),
        };
        AgentSetup {
            name: format!("agent-{i}"),
            robot: RobotSetup {
                kind,
                theta_names: vec![String::new(); theta.len()],
                theta,
                axes: (0..m).map(axis).collect(),
            },
            roots_per_s: vec![1.0].into(),
            manipulability: 0.0,
            law,
            start: Start {
                q: (0..m).map(|k| if k == 0 { position } else { (i as f64).cos() }).collect(),
                dq: vec![0.0; m],
                rest: Vec::new(),
                reference: Vec::new(),
            },
            enforce_limits: false,
            target: None,
            pushes: Vec::new(),
        }
    };
    let edge = |i: usize| Edge { from: (i + n - 1) % n, to: i, weight: 1.0.into(), delay: i };
    let delay = |i: usize| Delay::constant(0.1 + 0.3 * (i % 7) as f64 / 7.0);
    Setup {
        agents: (0..n).map(agent).collect(),
        reference: Arc::new(Consensus),
        exchange: Exchange::PositionVelocity,
        network: Network {
            agents: n,
            schedule: Schedule::fixed((0..n).map(edge).collect()),
            delays: (0..n).map(delay).collect(),
            weights: Vec::new(),
            coupling: Default::default(),
        },
        time: TimeSpan { end_s: END_S, record_every_s: END_S, record_at: forwardstep_sim::RecordAt::Intervals },
        solver: Solver {
            method: Method::Adaptive { rtol: tolerance, atol: tolerance },
            balance: false,
            ..Solver::default()
        },
        control: None,
    }
}

fn run(setup: &Setup) -> Result<Outcome, forwardstep_sim::SetupError> {
    simulate(setup, &mut |_| ControlFlow::Continue(()))
}

fn positions(outcome: &Outcome) -> Vec<f64> {
    let positions = outcome.recording.columns.iter().filter(|c| c.signal == Signal::Position);
    positions.filter_map(|c| c.values.last().copied()).collect()
}

fn main() -> Result<(), forwardstep_sim::SetupError> {
    let tolerance = 1e-6;
    // cargo bench --bench ring -- [MODEL [AGENTS]]; cargo itself adds --bench.
    let wanted: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let wants = |position: usize, value: &str| wanted.get(position).is_none_or(|wanted| wanted == value);
    let cases = [(Model::Linear, "linear", &[4, 16, 64, 256][..]), (Model::Arms, "arms", &[4, 16, 64][..])];
    for (model, name, sizes) in cases {
        for &n in sizes.iter().filter(|n| wants(0, name) && wants(1, &n.to_string())) {
            let truth = positions(&run(&ring(model, n, 1e-10))?);
            let setup = ring(model, n, tolerance);
            let outcome = run(&setup)?;
            let error = positions(&outcome).iter().zip(&truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let mut times: Vec<f64> = Vec::new();
            // At least a tenth of a second, so that short runs are not at the mercy of one interruption.
            let started = std::time::Instant::now();
            while times.len() < REPEATS || started.elapsed().as_secs_f64() < 0.1 {
                let begun = std::time::Instant::now();
                run(&setup)?;
                times.push(begun.elapsed().as_secs_f64() * 1e3 / END_S);
            }
            times.sort_by(f64::total_cmp);
            println!(
                "{{\"model\": \"{name}\", \"agents\": {n}, \"end_s\": {END_S}, \"ms_per_simulated_second\": {:.6}, \
                 \"min\": {:.6}, \"max\": {:.6}, \"max_error\": {error:.3e}, \"steps\": {}, \"evaluations\": {}}}",
                times[times.len() / 2],
                times[0],
                times[times.len() - 1],
                outcome.statistics.steps,
                outcome.statistics.evaluations
            );
        }
    }
    Ok(())
}
