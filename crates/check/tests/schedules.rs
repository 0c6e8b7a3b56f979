//! What does not switch, what recurs and what is drawn; every *holds* is also run.

use std::sync::Arc;

use crate::common::{About, answer, column, edge, masses, run};
use forwardstep_check::hypothesis::{Evidence, GraphEvidence, ReferenceEvidence};
use forwardstep_check::{Answer, Hypothesis, Id, check, predict};
use forwardstep_sim::delay::{Delay, SawTooth};
use forwardstep_sim::graph::Edge;
use forwardstep_sim::reference::PureIntegral;
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::{Exchange, Method, Setup, Signal};

fn saw() -> Delay {
    Delay::new(SawTooth { min_s: 0.0, max_s: 0.4, period_s: 1.1, offset_s: 0.0 })
}

fn phase(dwell_s: f64, pairs: &[(usize, usize)]) -> Phase {
    Phase { dwell_s, edges: pairs.iter().map(|&(from, to)| edge(from, to, 1.0, 0)).collect() }
}

/// Three masses with s ≡ 0.
fn three(exchange: Exchange, order: usize, schedule: Schedule, delay: Delay) -> Setup {
    let mut setup = masses(exchange, order, schedule, vec![delay]);
    setup.agents.truncate(3);
    setup.network.agents = 3;
    setup.time.record_every_s = 0.5;
    setup.solver.method = Method::Adaptive { rtol: 1e-7, atol: 1e-9 };
    setup
}

fn found(setup: &Setup, id: Id) -> Hypothesis {
    check(setup).hypotheses.into_iter().find(|hypothesis| hypothesis.id == id).unwrap()
}

/// max |qᵢ − qⱼ| on the first axis at the first and at the last row of a run this long.
fn spread(setup: &Setup, end_s: f64) -> [f64; 2] {
    let mut setup = setup.clone();
    setup.time.end_s = end_s;
    let outcome = run(&setup);
    let q: Vec<&[f64]> = (0..setup.agents.len()).map(|agent| column(&outcome, agent, Signal::Position, 0)).collect();
    let last = q[0].len() - 1;
    [0, last].map(|row| {
        let at = q.iter().map(|q| q[row]);
        at.clone().fold(f64::MIN, f64::max) - at.fold(f64::MAX, f64::min)
    })
}

#[test]
fn regress_what_is_the_same_twice_does_not_switch() {
    let ring = [(0, 1), (1, 2), (2, 0)];
    let turned = [(2, 0), (1, 2), (0, 1)];
    let schedules = [
        Schedule::periodic(vec![phase(1.0, &ring)]),
        Schedule::once(vec![phase(1.0, &ring), phase(1.0, &turned)]),
        Schedule::periodic(vec![phase(0.3, &ring), phase(0.5, &turned)]),
        Schedule::random(vec![phase(0.0, &ring).edges, phase(0.0, &turned).edges], [0.2, 0.4], 3),
    ];
    let fixed = predict(&three(Exchange::Position, 2, Schedule::fixed(phase(0.0, &ring).edges), Delay::constant(0.2)));
    for schedule in schedules {
        let mut setup = three(Exchange::Position, 2, schedule, Delay::constant(0.2));
        assert_eq!(found(&setup, Id::DwellTime).evidence, Evidence::Graph(GraphEvidence::NeverSwitches));
        let Evidence::Graph(GraphEvidence::Window { length_s, for_all_time, .. }) =
            found(&setup, Id::SpanningTree).evidence
        else {
            panic!("{:?}", check(&setup))
        };
        assert_eq!((length_s, for_all_time), (0.0, true));
        assert_eq!(predict(&setup), fixed);
        setup.reference = Arc::new(PureIntegral);
        assert_eq!(answer(&setup, About::FixedGraph), Answer::Holds);
    }
}

#[test]
fn regress_only_first_roots_that_hear_each_other_again_and_again_are_compared() {
    let (cycle, tree) = (phase(2.0, &[(0, 1), (1, 0)]), phase(2.0, &[(0, 1), (1, 2)]));
    let setup = |schedule, delay| {
        let mut setup = three(Exchange::PositionVelocity, 2, schedule, delay);
        setup.agents[1].roots_per_s = vec![0.3, 2.0].into();
        setup
    };
    let ends = setup(Schedule::once(vec![cycle.clone(), tree.clone()]), saw());
    let holds = found(&ends, Id::CommonFirstRoot);
    assert_eq!(holds.evidence, Evidence::Reference(ReferenceEvidence::FirstRootCommon));
    let [first, last] = spread(&ends, 120.0);
    assert!(last < 1e-5 * first, "{first} {last}");
    let comes_back = setup(Schedule::periodic(vec![cycle.clone(), tree.clone()]), saw());
    assert_eq!(answer(&comes_back, About::CommonFirstRoot), Answer::NotCovered);
    // The cycle stays: constant delays are what is needed then, whatever was before.
    let cycle = phase(1.0, &[(0, 1), (1, 0), (1, 2)]);
    let stays = |delay| setup(Schedule::once(vec![tree.clone(), cycle.clone()]), delay);
    let holds = found(&stays(Delay::constant(0.2)), Id::CommonFirstRoot);
    assert_eq!(holds.evidence, Evidence::Reference(ReferenceEvidence::FirstRootsOverConstants));
    let [first, last] = spread(&stays(Delay::constant(0.2)), 120.0);
    assert!(last < 1e-5 * first, "{first} {last}");
    assert_eq!(answer(&stays(saw()), About::CommonFirstRoot), Answer::NotCovered);
    // A delay that varies before does not count either.
    let mut before = stays(Delay::constant(0.2));
    before.network.delays.push(saw());
    before.network.schedule.graphs[0][0].delay = 1;
    assert_eq!(answer(&before, About::CommonFirstRoot), Answer::Holds);
}

#[test]
fn regress_graphs_that_each_have_a_tree_hold_for_all_time_however_they_are_drawn() {
    let graphs = vec![phase(0.0, &[(0, 1), (1, 2)]).edges, phase(0.0, &[(2, 1), (1, 0)]).edges];
    for seed in 0..3 {
        let setup = three(Exchange::Position, 2, Schedule::random(graphs.clone(), [0.2, 5.0], seed), saw());
        let tree = found(&setup, Id::SpanningTree);
        assert_eq!(tree.evidence, Evidence::Graph(GraphEvidence::EveryGraph { graphs: 2 }));
        assert_eq!(tree.answer(), Answer::Holds);
        let [first, last] = spread(&setup, 150.0);
        assert!(last < 1e-4 * first, "{first} {last}");
    }
}

#[test]
fn what_is_said_of_draws_is_what_can_be_known_of_them() {
    let drawn = |graphs: &[&[(usize, usize)]], end_s| {
        let graphs: Vec<Vec<Edge>> = graphs.iter().map(|pairs| phase(0.0, pairs).edges).collect();
        let mut setup = three(Exchange::Position, 2, Schedule::random(graphs, [1.0, 1.5], 9), saw());
        setup.time.end_s = end_s;
        found(&setup, Id::SpanningTree)
    };
    let halves: &[&[(usize, usize)]] = &[&[(0, 1)], &[(1, 2)]];
    let seen = drawn(halves, 50.0);
    assert_eq!(seen.answer(), Answer::HoldsOnHorizon);
    assert!(seen.because().contains("almost surely no window is long enough for ever"), "{}", seen.because());
    let not_yet = drawn(halves, 0.5);
    assert_eq!(not_yet.answer(), Answer::NotShown);
    assert!(not_yet.because().contains("may bring the edges that are missing"), "{}", not_yet.because());
    let never = drawn(&[&[(0, 1)], &[(1, 0)]], 50.0);
    assert_eq!(never.answer(), Answer::Violated);
    assert!(never.because().contains("whatever the window"), "{}", never.because());
}

/// Pseudo-random numbers in [0, 1).
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The derivation is ours, so it is tried: orders, weights and phases at random, a delay that jumps; with s ≡ 0 the spread must go to zero.
#[test]
fn prop_agents_of_different_orders_agree() {
    let mut draw = Draw(0x1234_5678_9ABC_DEF1);
    for case in 0..16 {
        let exchange = [Exchange::Position, Exchange::PositionVelocity][case % 2];
        let mut phases = vec![phase(1.0, &[(0, 1)]), phase(0.7, &[(1, 2)]), phase(0.5, &[(2, 0), (2, 1)])];
        for edge in phases.iter_mut().flat_map(|phase| &mut phase.edges) {
            edge.weight = (0.5 + 3.0 * draw.next()).into();
        }
        let mut setup = three(exchange, 1, Schedule::periodic(phases), saw());
        for (agent, order) in setup.agents.iter_mut().zip([[1, 2, 4], [3, 1, 2], [2, 3, 1]][case % 3]) {
            // κ₀ is common, which (a5) needs and (24) does not.
            let own = |r: usize, x: f64| if r == 0 && case % 2 == 1 { 1.3 } else { 0.8 + 2.0 * x };
            agent.roots_per_s = (0..order).map(|r| own(r, draw.next())).collect::<Vec<_>>().into();
        }
        assert_eq!(check(&setup).worst(), Answer::Holds, "{:?}", check(&setup));
        let [first, last] = spread(&setup, 200.0);
        assert!(last < 1e-4 * first, "case {case}: {first} {last}");
    }
}
