//! All families of reference dynamics, with sizes and orders that no scenario has.

use std::sync::Arc;

use forwardstep_check::derivation::cascade::Upper;
use forwardstep_check::derivation::case::{Case, cases};
use forwardstep_check::derivation::dynamics::declared;
use forwardstep_check::derivation::form::{Letter, Quantity};
use forwardstep_check::derivation::formula::Formula;
use forwardstep_check::derivation::polynomial::Polynomial;
use forwardstep_check::derivation::{Line, explain};
use forwardstep_core::reference::{
    Choice, Consensus, Exchange as Exchanged, Heard, Measured, Position, PositionVelocity, PureIntegral, Reference,
    ReferenceOut, SmoothFollowing,
};
use forwardstep_sim::delay::Delay;
use forwardstep_sim::graph::Edge;
use forwardstep_sim::leader::{Following, FollowingDesign, Leader, Leading};
use forwardstep_sim::reference::PureIntegral as PureIntegralData;
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::trajectory::{Path, Sinusoid, Trajectory};
use forwardstep_sim::{Exchange, Method, Outcome, Setup, Signal};

use super::moment::{Jets, Moment, to_f64};
use crate::common::{column, edge, masses, noise, run};

/// Steps and rows, s. Delays and phases are whole numbers of them, so that rows are ends of steps.
pub(super) const STEP_S: f64 = 0.005;
/// Rows at which everything is compared.
pub(super) const ROWS: [usize; 4] = [61, 100, 143, 199];

/// Short, with fixed steps.
pub(super) fn short(mut setup: Setup) -> Setup {
    setup.time.end_s = 1.0;
    setup.time.record_every_s = STEP_S;
    setup.solver.method = Method::Fixed { step_s: STEP_S };
    setup
}

/// The links in force at a row, along which an agent hears, each with the row at which it was sent.
pub(super) fn links(setup: &Setup, agent: usize, row: usize) -> Vec<(Edge, usize)> {
    let t_s = row as f64 * STEP_S;
    let segment = setup.network.schedule.segments().find(|segment| segment.end_s > t_s + 1e-9).unwrap();
    let edges = setup.network.schedule.graphs[segment.graph].iter().filter(|edge| edge.to == agent);
    let sent = |edge: &Edge| row - (setup.network.delays[edge.delay].value(t_s) / STEP_S).round() as usize;
    edges.map(|edge| (*edge, sent(edge))).collect()
}

pub(super) fn weight(edge: &Edge) -> f64 {
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

pub(super) fn at(outcome: &Outcome, agent: usize, signal: Signal, axis: usize, row: usize) -> f64 {
    column(outcome, agent, signal, axis)[row]
}

/// q, q̇ and q̈ of a mass.
pub(super) fn motion(setup: &Setup, outcome: &Outcome, agent: usize, axis: usize, row: usize) -> [f64; 3] {
    let get = |signal| at(outcome, agent, signal, axis, row);
    [get(Signal::Position), get(Signal::Velocity), get(Signal::Torque) / setup.agents[agent].robot.theta[0]]
}

pub(super) fn recorded_reference(outcome: &Outcome, [agent, axis, row]: [usize; 3], count: usize) -> Vec<f64> {
    (0..count).map(|k| at(outcome, agent, Signal::Reference(k as u8), axis, row)).collect()
}

/// Rate of the state of one agent on one axis, and ż.
pub(super) fn evaluate<R: Reference>(
    law: &R,
    [q, dq]: [f64; 2],
    state: &[f64],
    degree: f64,
    sums: &[f64],
) -> (Vec<f64>, f64) {
    let (mut z, mut dz, mut rate) = ([0.0], [0.0], vec![0.0; state.len()]);
    let heard = Heard::new(std::slice::from_ref(&degree), sums, 1).unwrap();
    let out = ReferenceOut { z: &mut z, dz: &mut dz, d_state: &mut rate };
    law.evaluate(1, Measured { q: &[q], dq: &[dq] }, state, heard, out).unwrap();
    (rate, dz[0])
}

/// Everything about one agent and one axis.
pub(super) fn assert_all(case: &Case<'_>, what: &str, moment: &Moment) -> Upper {
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
fn consensus_jets<X: Exchanged>(setup: &Setup, outcome: &Outcome, at_row: [usize; 3]) -> Jets {
    let [agent, axis, row] = at_row;
    let own = motion(setup, outcome, agent, axis, row);
    let roots = &setup.agents[agent].roots_per_s;
    let mut z = recorded_reference(outcome, at_row, roots.len());
    let heard = links(setup, agent, row);
    let sum = |k: usize| -> f64 {
        heard.iter().map(|(edge, sent)| weight(edge) * motion(setup, outcome, edge.from, axis, *sent)[k]).sum()
    };
    let degree = heard.iter().map(|(edge, _)| weight(edge)).sum();
    let law = Consensus::<X>::new([(roots, setup.agents[agent].manipulability)]).unwrap();
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
pub(super) fn moment(setup: &Setup, agent: usize, row: usize, jets: &dyn Fn(usize, usize) -> Jets) -> Moment {
    let heard = links(setup, agent, row).iter().map(|(edge, sent)| (weight(edge), jets(edge.from, *sent))).collect();
    Moment { own: jets(agent, row), heard }
}

pub(super) fn own_start(setup: &mut Setup, derivatives: usize) {
    for (i, agent) in setup.agents.iter_mut().enumerate() {
        let entry = |k: usize| vec![0.4 * noise(50 + 7 * i + k), 0.4 * noise(70 + 7 * i + k)];
        agent.start.reference = (0..derivatives).map(entry).collect();
    }
}

pub(super) fn each_case(setup: &Setup, mut check: impl FnMut(&Case<'_>, usize)) {
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
                agent.roots_per_s.real.iter_mut().for_each(|root| *root += 0.3 + apart);
            }
            own_start(&mut setup, order);
            let outcome = run(&setup);
            each_case(&setup, |case, agent| {
                for (axis, row) in (0..2).flat_map(|axis| ROWS.map(|row| (axis, row))) {
                    let jets = |agent: usize, row: usize| match exchange {
                        Exchange::Position => consensus_jets::<Position>(&setup, &outcome, [agent, axis, row]),
                        Exchange::PositionVelocity | Exchange::Estimates | Exchange::Composite => {
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
fn eq_shipped_reference_dynamics_say_of_themselves_what_is_derived() {
    for (order, exchange, pure) in [
        (1, Exchange::PositionVelocity, false),
        (2, Exchange::Position, true),
        (2, Exchange::PositionVelocity, true),
        (4, Exchange::Position, false),
        (5, Exchange::PositionVelocity, false),
    ] {
        let mut setup = masses(exchange, order, Schedule::fixed(Vec::new()), Vec::new());
        if pure {
            setup.reference = Arc::new(PureIntegralData);
        }
        setup.agents.iter_mut().for_each(|agent| agent.manipulability = 0.7);
        let case = &cases(&setup)[0];
        let derived = case.dynamics().unwrap();
        let said = declared(&setup.reference.linear(&setup.agents[0], exchange).unwrap());
        assert_eq!((said.order, said.plant), (derived.order, derived.plant));
        // λ (q̇ − z) on one side is λ s on the other.
        let s = [(Letter::Position, Polynomial::power(1)), (Letter::Reference, -&Polynomial::one())];
        let rest = said.right.less(&derived.right.with(Letter::Error, &Polynomial::one(), &s));
        let sizes =
            [&rest.own, &rest.network].into_iter().flat_map(|all| all.terms()).flat_map(|(_, a)| a.coefficients());
        assert!(sizes.map(|c| to_f64(c).abs()).fold(0.0, f64::max) < 1e-12, "{order} {exchange:?}: {rest:?}");
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
            let chain = forwardstep_check::derivation::laplacian::chain(&case.roots.real, first, case.roots_of_all);
            let laplacian = upper.laplacian(chain).unwrap();
            for row in ROWS {
                let jets = |agent: usize, row: usize| {
                    let jets = match exchange {
                        Exchange::Position => consensus_jets::<Position>(&setup, &outcome, [agent, 0, row]),
                        Exchange::PositionVelocity | Exchange::Estimates | Exchange::Composite => {
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
        setup.agents.iter_mut().for_each(|agent| agent.roots_per_s.real[0] += 0.3);
        own_start(&mut setup, 2);
        let outcome = run(&setup);
        each_case(&setup, |case, agent| {
            for (axis, row) in (0..2).flat_map(|axis| ROWS.map(|row| (axis, row))) {
                let told = |agent: usize, row: usize| motion(&setup, &outcome, agent, axis, row);
                let jets = |agent: usize, row: usize| {
                    let design = [(&setup.agents[agent].roots_per_s, setup.agents[agent].manipulability)];
                    let place = [agent, axis, row];
                    match exchange {
                        Exchange::Position => {
                            let law = PureIntegral::<Position>::new(design).unwrap();
                            integrated_jets(&law, &setup, &outcome, place, &told, &[])
                        }
                        Exchange::PositionVelocity | Exchange::Estimates | Exchange::Composite => {
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
    use FollowingDesign::{Composite, Continuous, Differentiable, Observer, Swarm, WithoutAcceleration};
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
                        Composite | Observer { .. } => panic!("no cascade"),
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

#[test]
fn with_roots_of_their_own_agents_share_neither_variables_nor_a_matrix() {
    // κ₀ differs, or only κ₁ does, or nothing.
    for (apart, shares, matrix) in [([0.2, 0.0], false, false), ([0.0, 0.2], true, false), ([0.0; 2], true, true)] {
        let mut setup = masses(
            Exchange::PositionVelocity,
            2,
            Schedule::fixed(vec![edge(0, 1, 1.0, 0)]),
            vec![Delay::constant(0.0)],
        );
        setup.agents[1].roots_per_s.real.iter_mut().zip(apart).for_each(|(root, apart)| *root += apart);
        let case = &cases(&setup)[0];
        let dynamics = case.dynamics().unwrap();
        let reduced = case.upper(&dynamics).reduced(case.xi_variables(&dynamics)).unwrap();
        let heard = reduced.rates[1].network.polynomial(Quantity::heard(Letter::Variable(0)));
        assert_eq!(heard.is_zero(), !shares, "{apart:?}");
        let explanation = explain(&setup);
        let lines =
            || explanation.designs.iter().flat_map(|design| &design.sections).flat_map(|section| &section.lines);
        let is_matrix = |line: &Line| matches!(line, Line::Formula(Formula::Equal(_, right), _) if matches!(**right, Formula::Matrix(_)));
        assert_eq!(lines().any(is_matrix), matrix, "{apart:?}");
        let refused = |line: &Line| matches!(line, Line::Words(words) if words.contains("no Laplacian form"));
        assert_eq!(lines().any(refused), !shares, "{apart:?}");
    }
}
