//! The metrics of a run, beside what one computes by hand, and the goals judged by them.

use crate::support::{agent, setup, two_arms};
use forwardstep_io::output::{Absence, Disagreement, DisagreementSeries, LimitKind, Metrics};
use forwardstep_io::scenario::Goal;
use forwardstep_sim::recording::{BreakdownCause, Column};
use forwardstep_sim::{AxisUnit, Breakdown, Ending, Outcome, Recording, Setup, Signal};

/// Two agents with one axis, by hand: q₁ = 0, 1, 1, 1 and q₂ = 2, 2, 1.5, 1.25 at t = 0, 1, 2, 3.
fn by_hand() -> (Setup, Recording) {
    let setup = setup(vec![agent("a", 1, 0), agent("b", 1, 0)], 3.0, 1.0);
    let column = |agent, signal, values: [f64; 4]| Column { agent, signal, axis: 0, values: values.to_vec() };
    let columns = vec![
        column(0, Signal::Position, [0.0, 1.0, 1.0, 1.0]),
        column(0, Signal::Velocity, [0.0, -4.0, 3.5, 0.25]),
        column(0, Signal::Torque, [10.0, -200.0, 160.0, 0.0]),
        column(0, Signal::Lyapunov, [4.0, 3.0, 2.0, 1.0]),
        column(0, Signal::Dissipation, [0.0, 1.0, 2.0, 3.0]),
        column(1, Signal::Position, [2.0, 2.0, 1.5, 1.25]),
        column(1, Signal::Velocity, [0.0, 1.0, 2.0, -0.5]),
        column(1, Signal::Torque, [0.0, 0.0, 7.0, -7.0]),
        column(1, Signal::Lyapunov, [2.0, 1.5, 1.0, 0.5]),
        column(1, Signal::Dissipation, [0.0, 0.5, 1.1, 1.5]),
    ];
    (setup, Recording { t_s: vec![0.0, 1.0, 2.0, 3.0], columns })
}

#[test]
fn metrics_are_what_one_computes_by_hand() {
    let (setup, recording) = by_hand();
    let m = Metrics::of(&setup, &recording, Some(&[1.0]), Some(Goal::DisagreementBelow(0.75)));
    assert_eq!(DisagreementSeries::of(&setup, &recording).unwrap().overall, [2.0, 1.0, 0.5, 0.25]);
    assert_eq!(m.disagreement, Disagreement::Measured { initial: 2.0, last: 0.25, largest: 2.0, passes: false });
    assert_eq!(m.settled_s, Some(2.0));
    let speed = m.speed.unwrap();
    assert_eq!((speed.largest.agent, speed.largest.t_s, speed.largest.value, speed.last), (0, 1.0, 4.0, 0.5));
    assert_eq!((m.peak_torques[0].t_s, m.peak_torques[0].value), (1.0, -200.0));
    assert_eq!((m.peak_torques[1].t_s, m.peak_torques[1].value), (2.0, 7.0), "the first of equals");
    let balance = m.balance_residual.unwrap();
    assert!((balance.relative - 0.05).abs() < 1e-15, "{}", balance.relative);
    assert_eq!((balance.agent, balance.t_s), (1, 2.0));
    let agreement = m.agreement.unwrap()[0];
    assert_eq!((agreement.predicted, agreement.reached, agreement.distance), (1.0, 1.125, 0.25));

    let found: Vec<_> = m.limits_reached.iter().map(|l| (l.agent, l.kind, l.first_t_s, l.worst, l.excess)).collect();
    let expected = [(0, LimitKind::Velocity, 1.0, -4.0, 1.0), (0, LimitKind::Effort, 1.0, -200.0, 50.0)];
    assert_eq!(found, expected);
    assert!(m.limits_reached.iter().all(|l| !l.enforced && l.share == 0.5));
}

#[test]
fn what_acts_without_an_axis_has_its_peaks() {
    let (setup, mut recording) = by_hand();
    for (agent, signal, axis, values) in [
        (0, Signal::Thrust, 0, [1.0, -3.0, 2.0, 3.0]),
        (1, Signal::WheelMomentum, 0, [0.1, 0.2, 0.3, 0.4]),
        (1, Signal::WheelMomentum, 1, [0.0, 0.0, -0.5, 0.0]),
    ] {
        recording.columns.push(Column { agent, signal, axis, values: values.to_vec() });
    }
    let loads = Metrics::of(&setup, &recording, None, None).peak_loads;
    let found: Vec<_> =
        loads.iter().map(|l| (l.peak.agent, l.words(), l.unit(&setup), l.peak.t_s, l.peak.value)).collect();
    let expected = [
        (0, "thrust".to_owned(), "N".to_owned(), 1.0, -3.0),
        (1, "momentum of wheel 1".to_owned(), "N m s".to_owned(), 3.0, 0.4),
        (1, "momentum of wheel 2".to_owned(), "N m s".to_owned(), 2.0, -0.5),
    ];
    assert_eq!(found, expected, "a second wheel, of an agent with one axis");
    assert!(loads.iter().all(|load| load.limit.is_none()));
}

#[test]
fn agents_in_formation_agree_on_where_they_are_less_their_offsets() {
    let (setup, mut recording) = by_hand();
    for (agent, values) in [(0, [0.5, 0.5, -0.5, -1.0]), (1, [0.0, 0.0, 0.0, -0.75])] {
        recording.columns.push(Column { agent, signal: Signal::Offset, axis: 0, values: values.to_vec() });
    }
    let metrics = Metrics::of(&setup, &recording, Some(&[1.5]), None);
    // Both end at 2.
    assert_eq!(metrics.disagreement.last(), Some(0.0));
    assert_eq!(metrics.final_means, Some(vec![2.0]));
    let [agreement] = metrics.agreement.unwrap()[..] else { panic!("one axis") };
    assert_eq!([agreement.predicted, agreement.reached, agreement.distance], [1.5, 2.0, 0.5]);
}

#[test]
fn a_torque_clipped_at_an_enforced_limit_counts_as_reached() {
    let (mut setup, mut recording) = by_hand();
    setup.agents[0].enforce_limits = true;
    recording.columns[2].values = vec![10.0, -150.0, 150.0, 0.0];
    let m = Metrics::of(&setup, &recording, None, None);
    let effort = m.limits_reached.iter().find(|l| l.kind == LimitKind::Effort).unwrap();
    assert_eq!((effort.enforced, effort.first_t_s, effort.excess, effort.share), (true, 1.0, 0.0, 0.5));
}

#[test]
fn agents_that_cannot_be_compared_have_no_disagreement() {
    let (mut setup, recording) = by_hand();
    let disagreement = |setup: &Setup, recording| Metrics::of(setup, recording, Some(&[1.0]), None).disagreement;
    setup.agents[1].robot.axes[0].unit = AxisUnit::Metre;
    assert!(disagreement(&setup, &recording).last().is_some(), "numbers agree, whatever their units");
    let axis = setup.agents[1].robot.axes[0].clone();
    setup.agents[1].robot.axes.push(axis);
    let different = Disagreement::Absent(Absence::DifferentAxes { first: 0, other: 1 });
    assert_eq!(disagreement(&setup, &recording), different);
    setup.agents.truncate(1);
    assert_eq!(disagreement(&setup, &recording), Disagreement::Absent(Absence::FewerThanTwoAgents));
    let (setup, _) = by_hand();
    assert_eq!(disagreement(&setup, &Recording::default()), Disagreement::Absent(Absence::NoRows));
}

#[test]
fn numbers_that_are_not_finite_show_in_the_metrics() {
    let (setup, mut recording) = by_hand();
    recording.columns[0].values[3] = f64::NAN;
    recording.columns[1].values[3] = f64::NAN;
    let m = Metrics::of(&setup, &recording, None, Some(Goal::DisagreementBelow(10.0)));
    assert!(m.disagreement.last().unwrap().is_nan());
    assert_eq!(m.settled_s, None);
    assert!(m.speed.unwrap().largest.value.is_nan());
}

#[test]
fn goals_are_judged() {
    let (setup, outcome) = two_arms();
    let mut run = Outcome { recording: by_hand().1, ..outcome };
    let setup = Setup { agents: by_hand().0.agents, ..setup };
    let met =
        |goal: Goal, run: &Outcome| goal.is_met(&setup, run, &Metrics::of(&setup, &run.recording, None, Some(goal)));
    assert!(met(Goal::DisagreementBelow(0.3), &run));
    assert!(!met(Goal::DisagreementBelow(0.25), &run));
    assert!(!met(Goal::ExpectDiverges, &run));
    run.ending = Ending::Interrupted { t_s: 3.0 };
    assert!(!met(Goal::DisagreementBelow(0.3), &run), "an interrupted run has not met a goal for its end");
    run.recording.columns[0].values.reverse();
    run.recording.columns[5].values.reverse();
    run.recording.columns[0].values[3] = -1.0;
    assert!(met(Goal::ExpectDiverges, &run));
    let mut breakdown =
        Breakdown { t_s: 1.0, agent: 1, signal: Signal::Estimate, axis: 0, cause: BreakdownCause::NotFinite };
    run.ending = Ending::BrokeDown(breakdown.clone());
    assert!(met(Goal::ExpectDiverges, &run));
    breakdown.cause = BreakdownCause::PositionLimit { value: 3.0, limits: [-2.0, 2.0] };
    run.ending = Ending::BrokeDown(breakdown.clone());
    assert!(!met(Goal::ExpectDiverges, &run));
    // Short steps alone are no divergence: what was recorded decides.
    breakdown.cause = BreakdownCause::MemoryFull { step_s: 1e-9, need_bytes: 1e12, stiffness: None };
    run.ending = Ending::BrokeDown(breakdown);
    assert!(met(Goal::ExpectDiverges, &run));
    run.recording.columns[0].values.reverse();
    run.recording.columns[5].values.reverse();
    assert!(!met(Goal::ExpectDiverges, &run));
}
