//! Own targets, and plants other than robots under (6)–(7): masses without velocity, chains, vehicles.

use std::sync::Arc;

use forwardstep_core::controller::{ReferenceModel, ReferenceModelInput};
use forwardstep_core::expression::Expression;
use forwardstep_core::plant::{Formulas, Plant, Vehicle};
use forwardstep_core::reference::{Consensus, Heard, Position, polynomial};
use forwardstep_sim::delay::Delay;
use forwardstep_sim::reference::Tracking;
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::trajectory::{Path, Sinusoid, Trajectory};
use forwardstep_sim::{ChainLaw, ChainModel, ChainStep, Exchange, Signal, ThrustKind};

use super::families::{
    ROWS, STEP_S, assert_all, at, each_case, evaluate, links, moment, motion, own_start, recorded_reference, short,
    weight,
};
use super::moment::Jets;
use crate::common::{edge, kinds, masses, noise, run};

/// z^(ℓ) of a guide for a plant of order k.
fn guided(guide: &ReferenceModel, k: usize, measured: &[f64], z: &[f64], heard: [f64; 2], target: &[[f64; 5]]) -> f64 {
    let mut rate = vec![0.0; z.len()];
    let sums = [heard[1]];
    let leads = ReferenceModelInput {
        measured,
        state: z,
        heard: Heard::new(&heard[..1], &sums, 1).unwrap(),
        target: target.into(),
    };
    guide.rate(k, 1, leads, &mut guide.work(1), &mut rate).unwrap();
    *rate.last().unwrap()
}

fn target() -> Path {
    Path::Sinusoids { offset: 0.2, waves: vec![Sinusoid { amplitude: 0.5, rad_per_s: 1.3, phase_rad: 0.4 }] }
}

/// α₀ … α_{N−1}.
fn tracked(roots: &[f64]) -> ReferenceModel {
    let mut alpha = polynomial(roots).unwrap();
    alpha.pop();
    ReferenceModel::Tracking { alpha }
}

#[test]
fn eq_identities_of_own_targets_hold_along_real_runs() {
    for order in 2..=4 {
        let (schedule, delays) = (Schedule::fixed(Vec::new()), Vec::new());
        let mut setup = short(masses(Exchange::Position, order, schedule, delays));
        setup.reference = Arc::new(Tracking);
        for agent in &mut setup.agents {
            agent.target = Some(Trajectory::new(vec![target(); 2]).unwrap());
        }
        own_start(&mut setup, order - 1);
        let outcome = run(&setup);
        each_case(&setup, |case, agent| {
            for row in ROWS {
                let jets = |agent: usize, row: usize| {
                    let own = motion(&setup, &outcome, agent, 0, row);
                    let followed = target().jet(row as f64 * STEP_S);
                    let mut z = recorded_reference(&outcome, [agent, 0, row], order - 1);
                    z.push(guided(
                        &tracked(&setup.agents[agent].roots_per_s.real),
                        2,
                        &own[..2],
                        &z,
                        [0.0; 2],
                        &[followed],
                    ));
                    Jets { followed: followed.to_vec(), ..Jets::new(row + agent, &own, &z) }
                };
                assert_all(case, &format!("target, {order} roots"), &moment(&setup, agent, row, &jets));
            }
        });
    }
}

#[test]
fn eq_identities_of_a9_and_of_remark_7_hold_along_real_runs() {
    for tracks in [true, false] {
        let agents = 4;
        let mut setup = kinds::tracking(kinds::blind_mass(3.0, 1.4), vec![target()]);
        if !tracks {
            setup = kinds::alone(kinds::blind_mass(3.0, 1.4));
            setup.agents = (0..agents).map(|i| setup.agents[0].clone_with(i)).collect();
            setup.network.agents = agents;
            let edges = vec![edge(0, 1, 1.5, 0), edge(1, 2, 0.7, 1), edge(2, 3, 1.1, 0), edge(3, 0, 0.3, 1)];
            setup.network.schedule = Schedule::fixed(edges);
            setup.network.delays = vec![Delay::constant(0.04), Delay::constant(0.0)];
        }
        let setup = short(setup);
        let outcome = run(&setup);
        each_case(&setup, |case, agent| {
            for row in ROWS {
                let jets = |agent: usize, row: usize| {
                    let own = motion(&setup, &outcome, agent, 0, row);
                    let followed = target().jet(row as f64 * STEP_S);
                    let roots = &setup.agents[agent].roots_per_s;
                    let mut z = recorded_reference(&outcome, [agent, 0, row], if tracks { 2 } else { 3 });
                    let heard = links(&setup, agent, row);
                    let sum = heard
                        .iter()
                        .map(|(edge, sent)| weight(edge) * motion(&setup, &outcome, edge.from, 0, *sent)[0]);
                    let told = [heard.iter().map(|(edge, _)| weight(edge)).sum(), sum.sum()];
                    let guide = match tracks {
                        true => tracked(&roots.real),
                        false => ReferenceModel::Consensus(Consensus::new([(roots, 0.0)]).unwrap()),
                    };
                    z.push(guided(&guide, 2, &own[..1], &z, told, &[followed]));
                    let y = at(&outcome, agent, Signal::Filter, 0, row);
                    let jets = Jets::new(row + agent, &own, &z);
                    let dy = 20.0 * (jets.s[0] - y);
                    Jets { followed: followed.to_vec(), ..jets.filtered(row + agent, [y, dy], 20.0) }
                };
                assert_all(case, if tracks { "(a9)" } else { "Remark 7" }, &moment(&setup, agent, row, &jets));
            }
        });
    }
}

trait CloneWith {
    fn clone_with(&self, index: usize) -> Self;
}

impl CloneWith for forwardstep_sim::AgentSetup {
    fn clone_with(&self, index: usize) -> Self {
        let mut agent = self.clone();
        agent.name = format!("agent-{index}");
        agent.start.q.iter_mut().enumerate().for_each(|(k, q)| *q += noise(17 * index + k));
        agent
    }
}

#[test]
fn eq_identities_of_43_hold_along_real_runs_of_chains_of_any_order() {
    // d^k x/dt^k = −x³ + 2 u, k = 1 … 4, alike or not, with targets or over a network.
    for (orders, tracks) in [([1; 3], false), ([2; 3], false), ([4; 3], false), ([1, 2, 3], false), ([1, 2, 4], true)] {
        let agent = |i: usize| {
            let k = orders[i];
            let x = || Expression::variable(0);
            let terms = Formulas::new(k, &(-(x() * x() * x())), Vec::new(), &Expression::number(2.0)).unwrap();
            let mut agent = kinds::chain(&Expression::number(2.0), 0, false).clone_with(i);
            agent.robot.kind = Arc::new(ChainModel::Derivatives(Arc::new(terms)));
            agent.law = Arc::new(ChainLaw { step: ChainStep::Linearising { gain_per_s: 2.0 }, floor: 1e-3 });
            let entry = |r: usize| 0.2 * noise(200 + 11 * i + r);
            agent.start.dq = (1..k.min(2)).map(entry).collect();
            agent.start.rest = (2..k).map(entry).collect();
            let count = if tracks { 4 } else { k + 1 };
            agent.roots_per_s = (0..count).map(|r| 0.8 + 0.3 * r as f64).collect::<Vec<_>>().into();
            agent.target = tracks.then(|| Trajectory::new(vec![target()]).unwrap());
            agent
        };
        let mut setup = kinds::alone(agent(0));
        setup.agents = (0..3).map(agent).collect();
        setup.network.agents = 3;
        if tracks {
            setup.reference = Arc::new(Tracking);
        } else {
            setup.network.schedule = Schedule::fixed(vec![edge(0, 1, 1.5, 0), edge(1, 2, 0.7, 1), edge(2, 0, 1.1, 0)]);
            setup.network.delays = vec![Delay::constant(0.04), Delay::constant(0.0)];
        }
        let setup = short(setup);
        let outcome = run(&setup);
        let state = |agent: usize, row: usize| -> Vec<f64> {
            let signal = |r: usize| match r {
                0 => Signal::Position,
                1 => Signal::Velocity,
                r => Signal::Derivative(r as u8),
            };
            (0..orders[agent]).map(|r| at(&outcome, agent, signal(r), 0, row)).collect()
        };
        each_case(&setup, |case, agent| {
            for row in ROWS {
                let jets = |agent: usize, row: usize| {
                    let (k, mut x) = (orders[agent], state(agent, row));
                    let roots = &setup.agents[agent].roots_per_s;
                    let followed = target().jet(row as f64 * STEP_S);
                    let count = if tracks { roots.len() + 1 - k } else { roots.len() + 2 - k };
                    let mut z = recorded_reference(&outcome, [agent, 0, row], count);
                    let heard = links(&setup, agent, row);
                    let sum = heard.iter().map(|(edge, sent)| weight(edge) * state(edge.from, *sent)[0]);
                    let told = [heard.iter().map(|(edge, _)| weight(edge)).sum(), sum.sum()];
                    let guide = match tracks {
                        true => tracked(&roots.real),
                        false => ReferenceModel::Consensus(Consensus::new([(roots, 0.0)]).unwrap()),
                    };
                    z.push(guided(&guide, k, &x, &z, told, &[followed]));
                    x.push(-x[0] * x[0] * x[0] + 2.0 * at(&outcome, agent, Signal::Torque, 0, row));
                    Jets { followed: followed.to_vec(), ..Jets::new(row + agent, &x, &z) }
                };
                assert_all(case, &format!("chains {orders:?}"), &moment(&setup, agent, row, &jets));
            }
        });
    }
}

#[test]
fn eq_identities_of_49_and_54_hold_along_real_runs_of_vehicles() {
    use forwardstep_core::controller::Floor;
    let designs = [
        ThrustKind::Differentiable { alpha_star: 3.0, stiffness: 4.0 },
        ThrustKind::Adaptive { alpha_star: 3.0, gamma_star: 0.2, estimate_start: 1.6, bounds: None },
        ThrustKind::ByAcceleration {
            alpha_star: 3.0,
            gamma_star: 0.2,
            estimate_start: 1.6,
            bounds: None,
            bias: [0.0; 3],
        },
    ];
    for design in designs {
        let mut setup = kinds::alone(kinds::vehicle(design, Floor::Stops(1.0)));
        setup.agents = (0..4).map(|i| setup.agents[0].clone_with(i)).collect();
        let order = design.order();
        setup.agents.iter_mut().for_each(|agent| agent.roots_per_s = [0.9, 1.4, 2.2][..order].into());
        setup.network.agents = 4;
        setup.network.schedule =
            Schedule::fixed(vec![edge(0, 1, 0.5, 0), edge(1, 2, 0.7, 1), edge(2, 0, 0.4, 0), edge(2, 3, 0.3, 1)]);
        setup.network.delays = vec![Delay::constant(0.04), Delay::constant(0.0)];
        let setup = short(setup);
        let outcome = run(&setup);
        let motion = |agent: usize, axis: usize, row: usize| -> [f64; 3] {
            let get = |signal, k| at(&outcome, agent, signal, k, row);
            let three = |signal| (0..3).map(|k| get(signal, k)).collect::<Vec<_>>();
            let attitude = (0..4).map(|k| get(Signal::Attitude, k)).collect();
            let state = [three(Signal::Position), three(Signal::Velocity), attitude].concat();
            let input = [vec![get(Signal::Thrust, 0)], three(Signal::AngularVelocity)].concat();
            let mut rate = vec![0.0; 10];
            Vehicle { mass: 2.0, gravity: 9.81 }.rate(&mut (), &state, &input, &[], &mut rate).unwrap();
            [state[axis], state[3 + axis], rate[3 + axis]]
        };
        each_case(&setup, |case, agent| {
            for (axis, row) in (0..3).flat_map(|axis| ROWS.map(|row| (axis, row))) {
                let jets = |agent: usize, row: usize| {
                    let own = motion(agent, axis, row);
                    let mut z = recorded_reference(&outcome, [agent, axis, row], order);
                    let heard = links(&setup, agent, row);
                    let sum: f64 =
                        heard.iter().map(|(edge, sent)| weight(edge) * motion(edge.from, axis, *sent)[0]).sum();
                    let degree = heard.iter().map(|(edge, _)| weight(edge)).sum();
                    let law = Consensus::<Position>::new([(&setup.agents[agent].roots_per_s, 0.0)]).unwrap();
                    z.push(*evaluate(&law, [own[0], own[1]], &z, degree, &[sum]).0.last().unwrap());
                    Jets::new(row + agent, &own, &z)
                };
                let upper = assert_all(case, &format!("{design:?}"), &moment(&setup, agent, row, &jets));
                assert_eq!(upper.degree(2), order - 1);
            }
        });
    }
}
