//! Nothing panics, and nothing goes on for ever, of what `simulate` refuses; where the parts do not fit together, nothing is promised or predicted.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};

use forwardstep::check::derivation::explain;
use forwardstep::check::manipulability::Manipulability;
use forwardstep::check::prediction::guaranteed::WORK;
use forwardstep::check::prediction::{CascadeSpread, course, guaranteed_rate, period_rate, rate, told_before};
use forwardstep::check::smoothness::smoothness;
use forwardstep::check::{
    Answer, Footing, ReferenceGains, SamplingMargin, Theorem, WholeLoop, along, certify, check, fastest_damping, ideal,
    practical, predict,
};
use forwardstep::io::scenario::{SHIPPED_SCENARIOS, open_scenario};
use forwardstep::sim::graph::{Edge, Weight};
use forwardstep::sim::schedule::Schedule;
use forwardstep::sim::{Exchange, Method, Outcome, RecordAt, Setup, check_setup, check_shape, simulate};

use crate::support::{is_long, some};

/// A change that leaves some setup without a meaning, or none.
type Change = (&'static str, fn(&mut Setup, &Setup));

/// An edge more from somewhere to somewhere.
fn edge(setup: &mut Setup, edge: Edge) {
    let mut graphs = setup.network.schedule.graphs.iter().map(|graph| graph.iter().copied().chain([edge]).collect());
    setup.network.schedule = Schedule::fixed(graphs.next_back().unwrap_or_default());
}

fn to(setup: &mut Setup, to: usize) {
    edge(setup, Edge { from: 0, to, weight: Weight::Constant(1.0), delay: 0 });
}

fn shorter<T>(all: &mut Vec<T>) {
    all.truncate(all.len().saturating_sub(1));
}

const CHANGES: &[Change] = &[
    ("no agents", |setup, _| setup.agents.clear()),
    ("an agent too few", |setup, _| shorter(&mut setup.agents)),
    ("an agent too many", |setup, _| setup.agents.push(setup.agents[0].clone())),
    ("vertices without agents", |setup, _| setup.network.agents += 3),
    ("no vertices", |setup, _| setup.network.agents = 0),
    ("a position too short", |setup, _| shorter(&mut setup.agents[0].start.q)),
    ("no position", |setup, _| setup.agents[0].start.q.clear()),
    ("a position that is no number", |setup, _| setup.agents[0].start.q[0] = f64::NAN),
    ("a velocity too short", |setup, _| shorter(&mut setup.agents[0].start.dq)),
    ("a velocity too long", |setup, _| setup.agents[0].start.dq.push(1.0)),
    ("no further states", |setup, _| setup.agents[0].start.rest.clear()),
    ("a further state", |setup, _| setup.agents[0].start.rest.push(1.0)),
    ("starts of a reference that has none", |setup, _| {
        (0..60).for_each(|_| setup.agents[0].start.reference.push(vec![0.0]));
    }),
    ("a start of a reference that is too short", |setup, _| setup.agents[0].start.reference = vec![Vec::new()]),
    ("a parameter too few", |setup, _| shorter(&mut setup.agents[0].robot.theta)),
    ("no parameters", |setup, _| setup.agents[0].robot.theta.clear()),
    ("a parameter too many", |setup, _| setup.agents[0].robot.theta.push(1.0)),
    ("parameters that are no numbers", |setup, _| setup.agents[0].robot.theta.fill(f64::NAN)),
    ("parameters below zero", |setup, _| setup.agents[0].robot.theta.iter_mut().for_each(|own| *own = -*own)),
    ("an axis too few", |setup, _| shorter(&mut setup.agents[0].robot.axes)),
    ("no axes", |setup, _| setup.agents[0].robot.axes.clear()),
    ("no axes of all", |setup, _| setup.agents.iter_mut().for_each(|agent| agent.robot.axes.clear())),
    ("no roots", |setup, _| setup.agents.iter_mut().for_each(|agent| agent.roots_per_s = Vec::new().into())),
    ("a root below zero", |setup, _| setup.agents[0].roots_per_s = vec![-1.0, 2.0].into()),
    ("a root that is no number", |setup, _| setup.agents[0].roots_per_s = vec![f64::NAN].into()),
    ("many roots", |setup, _| setup.agents[0].roots_per_s = vec![1.0; 200].into()),
    ("a λ that is no number", |setup, _| setup.agents[0].manipulability = f64::NAN),
    ("no horizon", |setup, _| setup.time.end_s = 0.0),
    ("an endless horizon", |setup, _| setup.time.end_s = f64::INFINITY),
    ("rows at no time", |setup, _| setup.time.record_every_s = 0.0),
    ("rows at no rate", |setup, _| setup.time.record_at = RecordAt::Rate { hz: f64::NAN }),
    ("rows behind the end", |setup, _| setup.time.record_at = RecordAt::Times([1e12].into())),
    ("rows that fall", |setup, _| setup.time.record_at = RecordAt::Times([2.0, 1.0].into())),
    ("a link to nowhere", |setup, _| to(setup, 999)),
    ("a link to itself", |setup, _| to(setup, 0)),
    ("a link from nowhere", |setup, _| {
        edge(setup, Edge { from: 999, to: 0, weight: Weight::Constant(1.0), delay: 0 });
    }),
    ("a link with no such delay", |setup, _| {
        edge(setup, Edge { from: 0, to: 1, weight: Weight::Constant(1.0), delay: 99 });
    }),
    ("a link with no such weight", |setup, _| {
        edge(setup, Edge { from: 0, to: 1, weight: Weight::Formula(99), delay: 0 });
    }),
    ("a weight that is no number", |setup, _| {
        edge(setup, Edge { from: 0, to: 1, weight: Weight::Constant(f64::NAN), delay: 0 });
    }),
    ("no graphs", |setup, _| setup.network.schedule.graphs.clear()),
    ("no delays", |setup, _| setup.network.delays.clear()),
    ("no samples", |setup, _| {
        if let Some(control) = &mut setup.control {
            control.sample_hz = 0.0;
        }
    }),
    ("no targets", |setup, _| setup.agents.iter_mut().for_each(|agent| agent.target = None)),
    ("another target", |setup, other| setup.agents[0].target.clone_from(&other.agents[0].target)),
    ("another law", |setup, other| setup.agents[0].law = other.agents[0].law.clone()),
    ("another robot", |setup, other| setup.agents[0].robot.kind = other.agents[0].robot.kind.clone()),
    ("another reference", |setup, other| setup.reference = other.reference.clone()),
    ("another network", |setup, other| setup.network = other.network.clone()),
    ("other agents", |setup, other| setup.agents.clone_from(&other.agents)),
    ("positions", |setup, _| setup.exchange = Exchange::Position),
    ("velocities", |setup, _| setup.exchange = Exchange::PositionVelocity),
    ("composites", |setup, _| setup.exchange = Exchange::Composite),
    ("estimates", |setup, _| setup.exchange = Exchange::Estimates),
    ("no tolerance", |setup, _| setup.solver.method = Method::Adaptive { rtol: f64::NAN, atol: f64::NAN }),
];

/// Asks everybody, and holds what they say against whether the parts fit together.
fn asked(refused: &Setup, run: &Outcome) {
    let on = &mut |_: forwardstep::sim::Progress| ControlFlow::Continue(());
    let report = check(refused);
    let unfit = check_shape(refused).is_err();
    assert_eq!(matches!(report.theorem, Theorem::Refused(_)), unfit, "{}", report.theorem);
    let certificate = certify(refused, &report);
    let footing = Footing::of(refused, &report);
    assert!(certificate.statements.is_empty());
    assert!(!unfit || report.worst() == Answer::NotCovered && footing == Footing::default());
    assert!(explain(refused).designs.is_empty());
    assert!(practical(refused).findings.is_empty());
    assert!(course(refused, on).is_err() && smoothness(refused, on).is_err());
    assert!(SamplingMargin::of(refused).is_none() && WholeLoop::of(refused).is_none());
    let predictions = [
        ideal(refused).is_err(),
        predict(refused).is_err(),
        rate(refused).is_err(),
        period_rate(refused, on).is_err(),
        guaranteed_rate(refused, WORK).is_err(),
        Manipulability::of(refused, 0, 0).is_err(),
        ReferenceGains::of(refused).is_err(),
        fastest_damping(refused).is_none(),
    ];
    assert!(!unfit || predictions == [true; 8], "{predictions:?}");
    // Of a run that belongs to another.
    let _ = (along(refused, &run.recording).states, CascadeSpread::of(refused, &run.recording).is_ok());
    let _ = told_before(refused, refused);
}

#[test]
fn regress_what_simulate_refuses_makes_nobody_panic() {
    let names: Vec<&str> = SHIPPED_SCENARIOS.iter().map(|scenario| scenario.name).collect();
    let (mut refused, mut unfit, mut failed) = (0, 0, Vec::new());
    for (k, name) in some(names.iter().enumerate(), 18) {
        let setup = open_scenario(name).unwrap().setup;
        let run = simulate(&setup, &mut |_| ControlFlow::Break(())).unwrap();
        for other in some([7, 22, 41], 3) {
            let other = open_scenario(names[(k + other) % names.len()]).unwrap().setup;
            for (what, change) in CHANGES {
                let mut changed = setup.clone();
                change(&mut changed, &other);
                if check_setup(&changed).is_err() {
                    let done = catch_unwind(AssertUnwindSafe(|| asked(&changed, &run)));
                    failed.extend(done.is_err().then(|| format!("{name}: {what}")));
                    refused += 1;
                    unfit += usize::from(check_shape(&changed).is_err());
                }
            }
        }
    }
    assert!(failed.is_empty(), "{failed:#?}");
    let [most, some_unfit] = if is_long() { [200, 80] } else { [100, 40] };
    assert!(refused > most && unfit > some_unfit && unfit < refused, "{unfit} of {refused}");
}
