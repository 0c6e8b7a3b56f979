//! Verdicts about what agents share: κ₀, orders, graphs, weights, limits.

use crate::common::kinds::{alone, blind_mass, chain};
use crate::common::{About, answer, answers, arm, edge, setup};
use forwardstep_check::{Answer, Source, Theorem, check};
use forwardstep_core::expression::Expression;
use forwardstep_sim::delay::{Delay, SawTooth};
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::{Edge, Weight};
use forwardstep_sim::reference::PureIntegral;
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::{Actuators, Control, Exchange, Sensors, Setup, VelocitySensor};
use std::sync::Arc;

/// Two arms with κ₀ of their own over these edges.
fn pair(first_roots: [f64; 2], edges: Vec<Edge>) -> Setup {
    let agents = (0..2).map(|k| arm(k, &[first_roots[k], 2.0])).collect();
    setup(agents, Exchange::PositionVelocity, Schedule::fixed(edges), vec![Delay::constant(0.1)], 10.0)
}

fn both_ways() -> Vec<Edge> {
    vec![edge(0, 1, 1.0, 0), edge(1, 0, 1.0, 0)]
}

fn with_varying_weight(mut setup: Setup) -> Setup {
    let swing = Expression::variable(0).sin_of() * 0.5 + 1.0;
    setup.network.weights = vec![BoundedFormula::new(swing, setup.time.end_s)];
    {
        let edges = &mut setup.network.schedule.graphs[0];
        edges[0].weight = Weight::Formula(0);
    }
    setup
}

fn with_varying_delay(mut setup: Setup) -> Setup {
    setup.network.delays = vec![Delay::new(SawTooth { min_s: 0.0, max_s: 0.1, period_s: 1.0, offset_s: 0.0 })];
    setup
}

fn switching(mut setup: Setup) -> Setup {
    let phase = |edge: Edge| Phase { edges: vec![edge], dwell_s: 1.0 };
    {
        let edges = setup.network.schedule.graphs[0].clone();
        setup.network.schedule = Schedule::periodic(edges.iter().copied().map(phase).collect());
    }
    setup
}

#[test]
fn thm3_unequal_first_roots_hold_only_where_nothing_varies() {
    let said = |setup: Setup| answer(&setup, About::CommonFirstRoot);
    let changes: [fn(Setup) -> Setup; 4] = [|setup| setup, with_varying_delay, with_varying_weight, switching];
    let in_a_cycle = changes.map(|change| said(change(pair([1.0, 1.5], both_ways()))));
    assert_eq!(in_a_cycle, [Answer::Holds, Answer::NotCovered, Answer::NotCovered, Answer::NotCovered]);
    let equal = changes.map(|change| said(change(pair([1.5, 1.5], both_ways()))));
    assert_eq!(equal, [Answer::Holds; 4]);
    // Components cascade: one that is heard only may have another.
    let cascaded = changes.map(|change| said(change(pair([1.0, 1.5], vec![edge(0, 1, 1.0, 0)]))));
    assert_eq!(cascaded, [Answer::Holds; 4]);
    // The first root is meant, and (24) has no such condition.
    let mut setup = with_varying_delay(pair([1.0, 1.0], both_ways()));
    setup.agents[1].roots_per_s.real[1] = 3.0;
    assert_eq!(said(setup.clone()), Answer::Holds);
    setup.agents[1].roots_per_s.real[0] = 1.5;
    setup.exchange = Exchange::Position;
    assert_eq!(answers(&check(&setup), About::CommonFirstRoot), []);
}

#[test]
fn thm3_a_component_is_looked_at_to_its_end() {
    // Three in a ring, of which the last differs; two more beside them, each by itself.
    let agents = [1.0, 1.0, 1.5, 7.0, 8.0].iter().enumerate().map(|(k, root)| arm(k, &[*root, 2.0])).collect();
    let edges = [(0, 1), (1, 2), (2, 0), (2, 3), (3, 4)].map(|(from, to)| edge(from, to, 1.0, 0)).to_vec();
    let delays = vec![Delay::constant(0.1)];
    let mut ring = setup(agents, Exchange::PositionVelocity, Schedule::fixed(edges), delays, 10.0);
    assert_eq!(answer(&with_varying_delay(ring.clone()), About::CommonFirstRoot), Answer::NotCovered);
    ring.agents[2].roots_per_s.real[0] = 1.0;
    assert_eq!(answer(&with_varying_delay(ring), About::CommonFirstRoot), Answer::Holds);
}

#[test]
fn eq_3_and_23_need_a_graph_and_weights_that_stay() {
    for exchange in [Exchange::PositionVelocity, Exchange::Position] {
        let integral = |change: fn(Setup) -> Setup| {
            let mut setup = change(pair([1.0, 1.0], both_ways()));
            (setup.reference, setup.exchange) = (Arc::new(PureIntegral), exchange);
            answer(&setup, About::FixedGraph)
        };
        assert_eq!(integral(|setup| setup), Answer::Holds);
        assert_eq!(integral(with_varying_delay), Answer::Holds, "delays are in the graph's terms, and may vary");
        assert_eq!(integral(with_varying_weight), Answer::NotCovered);
        assert_eq!(integral(switching), Answer::NotCovered);
        // A weight that no edge has does not vary anything.
        assert_eq!(
            integral(|setup| {
                let mut setup = with_varying_weight(setup);
                setup.network.schedule = Schedule::fixed(both_ways());
                setup
            }),
            Answer::Holds
        );
    }
}

#[test]
fn thm3_robots_and_chains_may_have_orders_of_their_own() {
    let mut arms = pair([1.0, 1.0], both_ways());
    arms.exchange = Exchange::Position;
    assert_eq!(answer(&arms, About::CommonOrder), Answer::Holds);
    assert_eq!(answers(&check(&arms), About::OwnOrders), []);
    // One more, then one in the middle.
    arms.agents[1].roots_per_s.real.push(3.0);
    let mut three = arms.clone();
    three.agents.insert(1, three.agents[0].clone());
    three.network.agents = 3;
    for (setup, exchange) in [(arms, Exchange::PositionVelocity), (three, Exchange::Position)] {
        let setup = Setup { exchange, ..setup };
        let report = check(&setup);
        assert_eq!(answer(&setup, About::OwnOrders), Answer::Holds);
        assert_eq!(answers(&report, About::CommonOrder), []);
        assert_eq!(report.theorem, Theorem::OwnOrders { exchange, least: 2, most: 3 });
        assert_eq!(report.theorem.source(), Source::Derived, "the paper has one order for all");
        // As smooth as the torque of the lowest order.
        assert!(report.promises.contains("the torque stays continuous through"), "{}", report.promises);
    }
    let mut chains = alone(chain(&Expression::number(1.0), 0, false));
    assert_eq!(answer(&chains, About::CommonOrder), Answer::Holds);
    chains.agents.push(chains.agents[0].clone());
    chains.agents[1].roots_per_s.real.push(3.0);
    chains.network.agents = 2;
    assert_eq!(answer(&chains, About::OwnOrders), Answer::Holds);
    assert_eq!(answer(&chains, About::RealRoots), Answer::Holds);
    // Nor need it be shared with what is no chain.
    chains.agents.push(blind_mass(1.0, 1.0));
    chains.network.agents = 3;
    assert_eq!(answer(&chains, About::OwnOrders), Answer::Holds);
    assert_eq!(answer(&chains, About::OneKind), Answer::NotCovered);
}

#[test]
fn thm3_a_root_that_is_not_positive_is_violated() {
    for roots in [[1.0, 0.0], [-1.0, 2.0]] {
        let mut setup = pair([1.0, 1.0], both_ways());
        setup.agents[1].roots_per_s = roots.to_vec().into();
        assert_eq!(answer(&setup, About::RealRoots), Answer::Violated);
    }
}

fn sampled(change: impl Fn(&mut Control)) -> Setup {
    let mut setup = pair([1.0, 1.0], both_ways());
    let (sensors, actuators) = (Sensors::default(), Actuators::default());
    let mut control =
        Control { sample_hz: 1000.0, computation_delay_s: 0.0, sensors, actuators, failures: Default::default() };
    change(&mut control);
    setup.control = Some(control);
    setup
}

#[test]
fn thm_a_torque_that_is_limited_is_not_the_one_that_the_law_asks_for() {
    let mut limited = pair([1.0, 1.0], both_ways());
    assert_eq!(answer(&limited, About::FullTorque), Answer::Holds);
    limited.agents[1].enforce_limits = true;
    assert_eq!(answer(&limited, About::FullTorque), Answer::NotCovered);
    let said =
        |change: fn(&mut Actuators)| answer(&sampled(|control| change(&mut control.actuators)), About::FullTorque);
    assert_eq!(said(|_| {}), Answer::Holds);
    assert_eq!(said(|actuators| actuators.torque_limit = Some(vec![9.0; 2])), Answer::NotCovered);
    assert_eq!(said(|actuators| actuators.torque_rate_limit = Some(vec![9.0; 2])), Answer::NotCovered);
    assert_eq!(said(|actuators| actuators.torque_quantum = 0.1), Answer::NotCovered);
}

#[test]
fn thm_measurements_that_are_not_exact_are_not_covered() {
    let said =
        |change: fn(&mut Sensors)| answers(&check(&sampled(|control| change(&mut control.sensors))), About::Measured);
    assert_eq!(said(|_| {}), []);
    assert_eq!(said(|sensors| sensors.position_noise = 1e-3), [Answer::NotCovered]);
    assert_eq!(said(|sensors| sensors.velocity_noise = 1e-3), [Answer::NotCovered]);
    assert_eq!(said(|sensors| sensors.position_quantum = 1e-3), [Answer::NotCovered]);
    assert_eq!(said(|sensors| sensors.velocity_quantum = 1e-3), [Answer::NotCovered]);
    assert_eq!(said(|sensors| sensors.velocity = VelocitySensor::Filtered { cut_off_hz: 50.0 }), [Answer::NotCovered]);
    // Nobody says anything of sensors in continuous time.
    assert_eq!(answers(&check(&pair([1.0, 1.0], both_ways())), About::Measured), []);
}
