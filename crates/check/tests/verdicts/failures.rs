//! What is said where messages time out, or a run goes on under a safe command.

use std::ops::ControlFlow;

use forwardstep_check::hypothesis::LinkEvidence;
use forwardstep_check::{Answer, Evidence, Id, NoCourse, NoIdeal, check, course};
use forwardstep_core::controller::Floor;
use forwardstep_core::expression::Expression;
use forwardstep_core::robot::tree::{Follows, JointKind, Uncertain};
use forwardstep_core::sampled::SafeCommand;
use forwardstep_sim::delay::{Basis, Delay, Loss, PacketLink, Sinusoid};
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::{Setup, ThrustKind, TipSetup};

use super::{constant, control, pair};
use crate::common::kinds::{alone, chain, change_tip, planar_tip, tree_tip, vehicle};

#[test]
fn messages_that_time_out_take_edges_away_that_the_graphs_have() {
    let said = |timeout_s: Option<f64>, delay: Delay| {
        let mut setup = pair([delay, Delay::constant(0.0)]);
        setup.control = control(0.0);
        setup.control.as_mut().unwrap().failures.message_timeout_s = timeout_s;
        check(&setup).hypotheses.iter().find(|h| h.id == Id::MessagesInTime).map(|h| h.answer())
    };
    let constant = || Delay::constant(0.3);
    assert_eq!(said(None, constant()), None);
    // The delay and a period of 0.1 s.
    assert_eq!(said(Some(0.41), constant()), Some(Answer::Holds));
    assert_eq!(said(Some(0.39), constant()), Some(Answer::NotShown));
    // Between the delay and that, what a sample hears may still be in time; below, nothing is.
    assert_eq!(said(Some(0.3), constant()), Some(Answer::NotShown));
    assert_eq!(said(Some(0.29), constant()), Some(Answer::Violated));
    // 0.2 + 0.1 is 0.3, though their doubles add to more.
    assert_eq!(said(Some(0.3), Delay::constant(0.2)), Some(Answer::Holds));
    // One of several whose bound is not known for ever is enough.
    let faster = Expression::variable(0).power(2.0).sin_of() * 0.05 + 0.1;
    let mut setup = pair([Delay::new(BoundedFormula::new(faster, 20.0)), constant()]);
    setup.control = control(0.0);
    setup.control.as_mut().unwrap().failures.message_timeout_s = Some(9.0);
    let found = check(&setup).hypotheses.into_iter().find(|h| h.id == Id::MessagesInTime).unwrap();
    assert_ne!(found.answer(), Answer::Holds);
}

#[test]
fn a_link_over_which_everything_is_too_old_is_told_by_its_ends() {
    let said = |delay: Delay, schedule: fn(Vec<Phase>) -> Schedule| {
        let mut setup = pair([delay, Delay::constant(0.0)]);
        let first = setup.network.schedule.graphs[0].clone();
        let last = first.iter().filter(|edge| edge.delay != 0).cloned().collect();
        let phases = [first, last].map(|edges| Phase { edges, dwell_s: 1.0 });
        setup.network.schedule = schedule(phases.into());
        setup.control = control(0.0);
        setup.control.as_mut().unwrap().failures.message_timeout_s = Some(0.25);
        let found = check(&setup).hypotheses.into_iter().find(|h| h.id == Id::MessagesInTime).unwrap();
        (found.answer(), found.because())
    };
    let (answer, because) = said(Delay::constant(0.3), Schedule::periodic);
    let expected =
        "arm-2 never hears arm-1: what comes is at least 0.3 s old, and what is older than 0.25 s does not count";
    assert_eq!((answer, because.as_str()), (Answer::Violated, expected));
    // What happens on a link that is gone soon says nothing.
    assert_eq!(said(Delay::constant(0.3), Schedule::once).0, Answer::NotShown);
    let swings = |mean_s| Delay::new(Sinusoid { mean_s, amplitude_s: 0.1, period_s: 2.0, phase_rad: 0.0 });
    assert_eq!(said(swings(0.36), Schedule::periodic).0, Answer::Violated);
    assert_eq!(said(swings(0.34), Schedule::periodic).0, Answer::NotShown);
    // Of a formula this is not asked.
    let wave = Expression::variable(0).sin_of() * 0.1 + 0.36;
    assert_eq!(said(Delay::new(BoundedFormula::new(wave, 20.0)), Schedule::periodic).0, Answer::NotShown);
    let radio = |latency_s: f64| {
        let loss = Loss::Never;
        let link =
            PacketLink { every_s: 0.02, first_s: 0.0, latency_s, jitter_s: 0.1, loss, most_in_a_row: None, seed: 1 };
        Delay::new(link.trace((0, 1), 20.0).unwrap())
    };
    assert_eq!(said(radio(0.26), Schedule::periodic).0, Answer::Violated);
    assert_eq!(said(radio(0.24), Schedule::periodic).0, Answer::NotShown);
}

/// Where messages may not count, the network of the prediction is not that of the run.
#[test]
fn regress_nothing_is_predicted_over_links_whose_messages_time_out() {
    let said = |timeout_s: f64| {
        let mut setup = pair([Delay::constant(0.3), Delay::constant(0.0)]);
        setup.control = control(0.0);
        setup.control.as_mut().unwrap().failures.message_timeout_s = Some(timeout_s);
        course(&setup, &mut |_| ControlFlow::Continue(())).map(|_| ())
    };
    assert_eq!(said(0.41), Ok(()));
    assert_eq!(said(0.39), Err(NoCourse::Ideal(NoIdeal::TimesOut)));
}

/// The bound of all links is known no better than that of any.
#[test]
fn messages_in_time_rest_on_the_weakest_of_all_delays() {
    let swings = || {
        let formula = Expression::variable(0).sin_of() * 0.1 + 0.2;
        Delay::new(BoundedFormula::new(formula, 20.0))
    };
    let basis = |delays: [Delay; 2]| {
        let mut setup = pair(delays);
        setup.control = control(0.0);
        setup.control.as_mut().unwrap().failures.message_timeout_s = Some(1.0);
        let found = check(&setup).hypotheses.into_iter().find(|h| h.id == Id::MessagesInTime).unwrap();
        let Evidence::Links(LinkEvidence::Ages { basis, .. }) = found.evidence else { panic!() };
        basis
    };
    assert_eq!(basis([constant(0.2), constant(0.1)]), Basis::Rule);
    assert_eq!(basis([swings(), constant(0.1)]), Basis::Enclosure);
    assert_eq!(basis([constant(0.2), swings()]), Basis::Enclosure);
}

#[test]
fn a_run_that_goes_on_under_a_safe_command_shows_nothing_about_what_the_law_divides_by() {
    let said = |safe_command| {
        let mut setup =
            alone(vehicle(ThrustKind::Differentiable { alpha_star: 3.0, stiffness: 4.0 }, Floor::Stops(1.0)));
        setup.control = control(0.0);
        setup.control.as_mut().unwrap().failures.safe_command = safe_command;
        let report = check(&setup);
        let of = |id| report.hypotheses.iter().find(|h| h.id == id).map(|h| h.answer()).unwrap();
        [of(Id::NonzeroThrust), of(Id::ThrustGains)]
    };
    // Of gains it says what it did.
    assert_eq!(said(None), [Answer::Watched, Answer::Holds]);
    assert_eq!(said(Some(SafeCommand::Zero)), [Answer::NotCovered, Answer::Holds]);
    // The same of the factor of an input, of a determinant and of a smallest singular value.
    const Y: [f64; 3] = [0.0, 1.0, 0.0];
    const Z: [f64; 3] = [0.0, 0.0, 1.0];
    let posed = {
        let mut agent = tree_tip([JointKind::Revolute; 6], [Z, Y, Y, Z, Y, Z], Uncertain::Tool);
        change_tip(&mut agent, |law| {
            if let TipSetup::Point { follows, .. } = &mut law.tip {
                *follows = Follows::Pose;
            }
        });
        agent
    };
    let fading = chain(&(Expression::variable(0).power(2.0) + 1.0).power(-1.0), 0, false);
    for (agent, id) in [(fading, Id::InputFactor), (planar_tip(), Id::RegularJacobian), (posed, Id::RegularJacobian)] {
        let mut setup = alone(agent);
        let answer = |setup: &Setup| check(setup).hypotheses.into_iter().find(|h| h.id == id).unwrap().answer();
        setup.control = control(0.0);
        assert_eq!(answer(&setup), Answer::Watched, "{id:?}");
        setup.control.as_mut().unwrap().failures.safe_command = Some(SafeCommand::Zero);
        assert_eq!(answer(&setup), Answer::NotCovered, "{id:?}");
    }
}
