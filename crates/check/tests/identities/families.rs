//! All families of reference dynamics, with sizes and orders that no scenario has.

use std::sync::Arc;

use forwardstep_check::derivation::cascade::Upper;
use forwardstep_check::derivation::case::{Case, cases};
use forwardstep_check::derivation::form::Letter;
use forwardstep_core::controller::{Guide, Leads};
use forwardstep_core::expression::Expression;
use forwardstep_core::plant::{Formulas, Plant, Vehicle};
use forwardstep_core::reference::{
    Choice, Consensus, Exchange as Told, Heard, Measured, Position, PositionVelocity, PureIntegral, Reference,
    ReferenceOut, SmoothFollowing, polynomial,
};
use forwardstep_sim::delay::Delay;
use forwardstep_sim::graph::Edge;
use forwardstep_sim::leader::{Following, FollowingDesign, Leader, Leading};
use forwardstep_sim::reference::{PureIntegral as PureIntegralData, Tracking};
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::trajectory::{Path, Sinusoid, Trajectory};
use forwardstep_sim::{ChainLaw, ChainModel, ChainStep, Exchange, Method, Outcome, Setup, Signal, ThrustKind};

use super::moment::{Jets, Moment};
use crate::common::{column, edge, kinds, masses, noise, run};

/// Steps and rows, s. Delays and phases are whole numbers of them, so that rows are ends of steps.
const STEP_S: f64 = 0.005;
/// Rows at which everything is compared.
const ROWS: [usize; 4] = [61, 100, 143, 199];

/// Short, with fixed steps.
fn short(mut setup: Setup) -> Setup {
    setup.time.end_s = 1.0;
    setup.time.record_every_s = STEP_S;
    setup.solver.method = Method::Fixed { step_s: STEP_S };
    setup
}

/// The links in force at a row, along which an agent hears, each with the row at which it was sent.
fn links(setup: &Setup, agent: usize, row: usize) -> Vec<(Edge, usize)> {
    let t_s = row as f64 * STEP_S;
    let segment = setup.network.schedule.segments().find(|segment| segment.end_s > t_s + 1e-9).unwrap();
    let edges = setup.network.schedule.graphs[segment.graph].iter().filter(|edge| edge.to == agent);
    let sent = |edge: &Edge| row - (setup.network.delays[edge.delay].value(t_s) / STEP_S).round() as usize;
    edges.map(|edge| (*edge, sent(edge))).collect()
}

fn weight(edge: &Edge) -> f64 {
    edge.weight.constant().unwrap()
}

/// Two graphs that alternate among five, with delays that jump between whole numbers of steps.
fn switching() -> (Schedule, Vec<Delay>) {
    let one = vec![edge(0, 1, 1.5, 0), edge(1, 2, 0.7, 1), edge(2, 0, 1.1, 0), edge(3, 1, 0.3, 1)];
    let other =
        vec![edge(2, 3, 0.4, 1), edge(3, 4, 2.0, 0), edge(4, 0, 0.9, 0), edge(0, 4, 0.2, 1), edge(1, 3, 0.8, 0)];
    let phases = [one, other].map(|edges| Phase { edges, dwell_s: 0.15 });
    (Schedule::periodic(phases.to_vec()), vec![Delay::constant(0.04), Delay::constant(0.0)])
}

fn at(outcome: &Outcome, agent: usize, signal: Signal, axis: usize, row: usize) -> f64 {
    column(outcome, agent, signal, axis)[row]
}

/// q, q̇ and q̈ of a mass.
fn motion(setup: &Setup, outcome: &Outcome, agent: usize, axis: usize, row: usize) -> [f64; 3] {
    let get = |signal| at(outcome, agent, signal, axis, row);
    [get(Signal::Position), get(Signal::Velocity), get(Signal::Torque) / setup.agents[agent].robot.theta[0]]
}

fn recorded_reference(outcome: &Outcome, [agent, axis, row]: [usize; 3], count: usize) -> Vec<f64> {
    (0..count).map(|k| at(outcome, agent, Signal::Reference(k as u8), axis, row)).collect()
}

/// Rate of the state of one agent on one axis, and ż.
fn evaluate<R: Reference>(law: &R, [q, dq]: [f64; 2], state: &[f64], degree: f64, sums: &[f64]) -> (Vec<f64>, f64) {
    let (mut z, mut dz, mut rate) = ([0.0], [0.0], vec![0.0; state.len()]);
    let heard = Heard::new(std::slice::from_ref(&degree), sums, 1).unwrap();
    let out = ReferenceOut { z: &mut z, dz: &mut dz, d_state: &mut rate };
    law.evaluate(1, Measured { q: &[q], dq: &[dq] }, state, heard, out).unwrap();
    (rate, dz[0])
}

/// Everything about one agent and one axis.
fn assert_all(case: &Case<'_>, what: &str, moment: &Moment) -> Upper {
    let dynamics = case.dynamics().unwrap();
    moment.assert(what, Letter::Reference, dynamics.order, &dynamics.right);
    moment.assert(what, Letter::Error, 0, &dynamics.definition_of_error());
    moment.assert(what, Letter::Position, dynamics.total_order(), &dynamics.loop_with_reference());
    if let Some(filter) = dynamics.filter() {
        moment.assert(what, Letter::Reference, dynamics.order, &filter);
    }
    let upper = case.upper(&dynamics);
    moment.assert(what, upper.state, upper.order, &upper.right);
    for reduced in upper.steps(0) {
        moment.assert_reduced(what, &upper, &reduced);
    }
    let others = case.has_xi(&dynamics).then(|| case.xi_variables(&dynamics)).or(case.followed_variables(&upper));
    if let Some(variables) = others {
        moment.assert_reduced(what, &upper, &upper.reduced(variables).unwrap());
    }
    if let Some(shifted) = upper.shifted() {
        moment.assert_reduced(what, &upper, &shifted);
    }
    upper
}

/// The jets of a mass in the consensus family, whose z^(ℓ) the core gives.
fn consensus_jets<X: Told>(setup: &Setup, outcome: &Outcome, at_row: [usize; 3]) -> Jets {
    let [agent, axis, row] = at_row;
    let own = motion(setup, outcome, agent, axis, row);
    let roots = &setup.agents[agent].roots_per_s;
    let mut z = recorded_reference(outcome, at_row, roots.len());
    let heard = links(setup, agent, row);
    let sum = |k: usize| -> f64 {
        heard.iter().map(|(edge, sent)| weight(edge) * motion(setup, outcome, edge.from, axis, *sent)[k]).sum()
    };
    let degree = heard.iter().map(|(edge, _)| weight(edge)).sum();
    let law = Consensus::<X>::new([(&roots[..], setup.agents[agent].manipulability)]).unwrap();
    let (rate, _) = evaluate(&law, [own[0], own[1]], &z, degree, &[sum(0), sum(1)]);
    z.push(*rate.last().unwrap());
    if roots.len() == 1 {
        // The run recorded it.
        let recorded = at(outcome, agent, Signal::Reference(1), axis, row);
        assert!((z[1] - recorded).abs() < 1e-12 * recorded.abs().max(1.0), "{} {recorded}", z[1]);
    }
    Jets::new(97 * agent + 31 * axis + row, &own, &z)
}

/// Neighbours as they were when they sent.
fn moment(setup: &Setup, agent: usize, row: usize, jets: &dyn Fn(usize, usize) -> Jets) -> Moment {
    let heard = links(setup, agent, row).iter().map(|(edge, sent)| (weight(edge), jets(edge.from, *sent))).collect();
    Moment { own: jets(agent, row), heard }
}

fn own_start(setup: &mut Setup, derivatives: usize) {
    for (i, agent) in setup.agents.iter_mut().enumerate() {
        let entry = |k: usize| vec![0.4 * noise(50 + 7 * i + k), 0.4 * noise(70 + 7 * i + k)];
        agent.start.reference = (0..derivatives).map(entry).collect();
    }
}

fn each_case(setup: &Setup, mut check: impl FnMut(&Case<'_>, usize)) {
    for case in cases(setup) {
        for agent in case.agents.clone() {
            check(&case, agent);
        }
    }
}

#[test]
fn eq_identities_of_aa10_a1_a5_and_24_hold_along_real_runs_of_any_order() {
    for order in 1..=6 {
        for exchange in [Exchange::Position, Exchange::PositionVelocity] {
            let (schedule, delays) = switching();
            let mut setup = short(masses(exchange, order, schedule, delays));
            for (i, agent) in setup.agents.iter_mut().enumerate() {
                agent.manipulability = 0.1 * i as f64;
                let apart = if exchange == Exchange::Position { 0.15 * i as f64 } else { 0.0 };
                agent.roots_per_s.iter_mut().for_each(|root| *root += 0.3 + apart);
            }
            own_start(&mut setup, order);
            let outcome = run(&setup);
            each_case(&setup, |case, agent| {
                for (axis, row) in (0..2).flat_map(|axis| ROWS.map(|row| (axis, row))) {
                    let jets = |agent: usize, row: usize| match exchange {
                        Exchange::Position => consensus_jets::<Position>(&setup, &outcome, [agent, axis, row]),
                        Exchange::PositionVelocity => {
                            consensus_jets::<PositionVelocity>(&setup, &outcome, [agent, axis, row])
                        }
                    };
                    assert_all(case, &format!("{exchange:?} order {order}"), &moment(&setup, agent, row, &jets));
                }
            });
        }
    }
}

#[test]
fn eq_30_and_a6_hold_along_real_runs_without_s() {
    // z(0) = q̇(0) and ϑ known: s ≡ 0, to rounding.
    for (order, exchange) in [(1, Exchange::PositionVelocity), (3, Exchange::Position), (5, Exchange::PositionVelocity)]
    {
        let (schedule, delays) = switching();
        let setup = short(masses(exchange, order, schedule, delays));
        let outcome = run(&setup);
        each_case(&setup, |case, agent| {
            let first = usize::from(exchange == Exchange::PositionVelocity);
            let upper = case.upper(&case.dynamics().unwrap());
            let chain = forwardstep_check::derivation::laplacian::chain(&case.roots, first, case.roots_of_all);
            let laplacian = upper.laplacian(chain).unwrap();
            for row in ROWS {
                let jets = |agent: usize, row: usize| {
                    let jets = match exchange {
                        Exchange::Position => consensus_jets::<Position>(&setup, &outcome, [agent, 0, row]),
                        Exchange::PositionVelocity => {
                            consensus_jets::<PositionVelocity>(&setup, &outcome, [agent, 0, row])
                        }
                    };
                    assert!(jets.s[0].abs() < 1e-13 && jets.s[1].abs() < 1e-11, "{:?}", jets.s);
                    let q = [&jets.q[..1], &jets.z].concat();
                    Jets { q, s: vec![0.0; 12], ..jets }
                };
                let moment = moment(&setup, agent, row, &jets);
                moment.assert_reduced(&format!("{exchange:?} order {order}"), &upper, &laplacian.chain);
            }
        });
    }
}

/// The jets of a mass whose ż is integrated with η, z̈ being ż of the derivatives of all it holds, since it is linear in them.
fn integrated_jets<R: Reference>(
    law: &R,
    setup: &Setup,
    outcome: &Outcome,
    [agent, axis, row]: [usize; 3],
    told: &dyn Fn(usize, usize) -> [f64; 3],
    more: &[f64],
) -> Jets {
    let own = motion(setup, outcome, agent, axis, row);
    let heard = links(setup, agent, row);
    let sum = |k: usize| -> f64 { heard.iter().map(|(edge, sent)| weight(edge) * told(edge.from, *sent)[k]).sum() };
    let degree = heard.iter().map(|(edge, _)| weight(edge)).sum();
    let z = recorded_reference(outcome, [agent, axis, row], 2);
    let state = |z: f64, eta: f64| [&[z, eta], more].concat();
    let (_, without) = evaluate(law, [own[0], own[1]], &state(z[0], 0.0), degree, &[sum(0), sum(1)]);
    let eta = z[1] - without;
    let (rate, _) = evaluate(law, [own[0], own[1]], &state(z[0], eta), degree, &[sum(0), sum(1)]);
    let (_, ddz) = evaluate(law, [own[1], own[2]], &state(z[1], rate[1]), degree, &[sum(1), sum(2)]);
    let jets = Jets::new(97 * agent + 31 * axis + row, &own, &[z[0], z[1], ddz]);
    Jets { integral: eta, d_integral: rate[1], ..jets }
}

#[test]
fn eq_identities_of_3_23_and_31_hold_along_real_runs() {
    let edges =
        vec![edge(0, 1, 1.5, 0), edge(1, 2, 0.7, 1), edge(2, 0, 1.1, 0), edge(3, 1, 0.3, 1), edge(2, 4, 2.0, 0)];
    for exchange in [Exchange::Position, Exchange::PositionVelocity] {
        let delays = vec![Delay::constant(0.04), Delay::constant(0.0)];
        let mut setup = short(masses(exchange, 2, Schedule::fixed(edges.clone()), delays));
        setup.reference = Arc::new(PureIntegralData);
        setup.agents[1].manipulability = 0.4;
        setup.agents.iter_mut().for_each(|agent| agent.roots_per_s[0] += 0.3);
        own_start(&mut setup, 2);
        let outcome = run(&setup);
        each_case(&setup, |case, agent| {
            for (axis, row) in (0..2).flat_map(|axis| ROWS.map(|row| (axis, row))) {
                let told = |agent: usize, row: usize| motion(&setup, &outcome, agent, axis, row);
                let jets = |agent: usize, row: usize| {
                    let design = [(&setup.agents[agent].roots_per_s[..], setup.agents[agent].manipulability)];
                    let place = [agent, axis, row];
                    match exchange {
                        Exchange::Position => {
                            let law = PureIntegral::<Position>::new(design).unwrap();
                            integrated_jets(&law, &setup, &outcome, place, &told, &[])
                        }
                        Exchange::PositionVelocity => {
                            let law = PureIntegral::<PositionVelocity>::new(design).unwrap();
                            integrated_jets(&law, &setup, &outcome, place, &told, &[])
                        }
                    }
                };
                let moment = moment(&setup, agent, row, &jets);
                assert_all(case, &format!("{exchange:?}"), &moment);
                let integrated = case.dynamics().unwrap().integrated();
                moment.assert("integrated", Letter::Reference, 1, &integrated.dz);
                moment.assert("integrated", Letter::Integral, 1, &integrated.d_eta);
            }
        });
    }
}

#[test]
fn eq_identities_of_110_119_122_and_swarms_hold_along_real_runs() {
    use FollowingDesign::{Continuous, Differentiable, Swarm, WithoutAcceleration};
    let wave = |phase_rad| Path::Sinusoids {
        offset: 0.2,
        waves: vec![Sinusoid { amplitude: 0.5, rad_per_s: 2.0, phase_rad }],
    };
    let edges = vec![
        edge(5, 0, 1.0, 0),
        edge(0, 1, 1.5, 0),
        edge(1, 0, 1.5, 0),
        edge(1, 2, 0.7, 0),
        edge(2, 3, 0.4, 0),
        edge(5, 4, 2.0, 0),
    ];
    for design in [Continuous, Differentiable, WithoutAcceleration, Swarm { coupling: 2.5 }] {
        let mut setup =
            masses(Exchange::PositionVelocity, 1, Schedule::fixed(edges.clone()), vec![Delay::constant(0.0)]);
        setup.network.agents += 1;
        let trajectory = Trajectory::new(vec![wave(0.0), wave(1.0)]).unwrap();
        let leader = Leading::Motion(Leader { name: "leader".into(), trajectory: trajectory.clone() });
        let (alpha, beta, gain) = (1.2, 2.3, 3.4);
        let following =
            Following { leader, design, alpha, beta, gain, choice: Choice::Implicit, period_s: 2.0 * STEP_S };
        setup.reference = Arc::new(following.clone());
        setup.agents.iter_mut().for_each(|agent| agent.roots_per_s.clear());
        own_start(&mut setup, 1);
        let setup = short(setup);
        let outcome = run(&setup);
        each_case(&setup, |case, agent| {
            for (axis, row) in (0..2).flat_map(|axis| ROWS.map(|row| (axis, row))) {
                let followed = trajectory.paths()[axis].jet(row as f64 * STEP_S);
                let told = |agent: usize, row: usize| match agent {
                    5 => [followed[0], followed[1], followed[2]],
                    _ => motion(&setup, &outcome, agent, axis, row),
                };
                let jets = |agent: usize, row: usize| {
                    if agent == 5 {
                        return Jets::leader(&followed);
                    }
                    let sign = at(&outcome, agent, Signal::Selection, axis, row);
                    let place = [agent, axis, row];
                    let jets = match design {
                        Continuous => {
                            Jets::new(row + agent, &told(agent, row), &recorded_reference(&outcome, place, 2))
                        }
                        Swarm { coupling } => {
                            let law = SmoothFollowing::swarm(1, following.sliding(), coupling);
                            integrated_jets(&law, &setup, &outcome, place, &told, &[sign])
                        }
                        Differentiable | WithoutAcceleration => {
                            let law = SmoothFollowing::new(1, following.sliding());
                            integrated_jets(&law, &setup, &outcome, place, &told, &[sign])
                        }
                    };
                    Jets { sign, followed: followed.to_vec(), ..jets }
                };
                let moment = moment(&setup, agent, row, &jets);
                assert_all(case, &format!("{design:?}"), &moment);
                if let Some(smooth) = case.smooth() {
                    moment.assert("realised", Letter::Reference, 1, &smooth.realised().right);
                    moment.assert("realised", Letter::Integral, 1, &smooth.integral_rate());
                }
            }
        });
    }
}

/// z^(ℓ) of a guide for a plant of order k.
fn guided(guide: &Guide, k: usize, measured: &[f64], z: &[f64], heard: [f64; 2], target: &[[f64; 5]]) -> f64 {
    let mut rate = vec![0.0; z.len()];
    let sums = [heard[1]];
    let leads = Leads { measured, state: z, heard: Heard::new(&heard[..1], &sums, 1).unwrap(), target };
    guide.rate(k, 1, leads, &mut guide.work(1), &mut rate).unwrap();
    *rate.last().unwrap()
}

fn target() -> Path {
    Path::Sinusoids { offset: 0.2, waves: vec![Sinusoid { amplitude: 0.5, rad_per_s: 1.3, phase_rad: 0.4 }] }
}

/// α₀ … α_{N−1}.
fn tracked(roots: &[f64]) -> Guide {
    let mut alpha = polynomial(roots).unwrap();
    alpha.pop();
    Guide::Tracking { alpha }
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
                    z.push(guided(&tracked(&setup.agents[agent].roots_per_s), 2, &own[..2], &z, [0.0; 2], &[followed]));
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
                        true => tracked(roots),
                        false => Guide::Consensus(Consensus::new([(&roots[..], 0.0)]).unwrap()),
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
            agent.roots_per_s = (0..count).map(|r| 0.8 + 0.3 * r as f64).collect();
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
                        true => tracked(roots),
                        false => Guide::Consensus(Consensus::new([(&roots[..], 0.0)]).unwrap()),
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
        ThrustKind::Adaptive { alpha_star: 3.0, gamma_star: 0.2, estimate_start: 1.6 },
    ];
    for design in designs {
        let mut setup = kinds::alone(kinds::vehicle(design, Floor::Stops(1.0)));
        setup.agents = (0..4).map(|i| setup.agents[0].clone_with(i)).collect();
        setup.agents.iter_mut().for_each(|agent| agent.roots_per_s = vec![0.9, 1.4, 2.2]);
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
                    let mut z = recorded_reference(&outcome, [agent, axis, row], 3);
                    let heard = links(&setup, agent, row);
                    let sum: f64 =
                        heard.iter().map(|(edge, sent)| weight(edge) * motion(edge.from, axis, *sent)[0]).sum();
                    let degree = heard.iter().map(|(edge, _)| weight(edge)).sum();
                    let law = Consensus::<Position>::new([(&setup.agents[agent].roots_per_s[..], 0.0)]).unwrap();
                    z.push(*evaluate(&law, [own[0], own[1]], &z, degree, &[sum]).0.last().unwrap());
                    Jets::new(row + agent, &own, &z)
                };
                let upper = assert_all(case, &format!("{design:?}"), &moment(&setup, agent, row, &jets));
                assert_eq!(upper.degree(2), 2);
            }
        });
    }
}
