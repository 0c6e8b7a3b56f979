//! What is said where messages time out, or a run goes on under a safe command.

use forwardstep_check::hypothesis::LinkEvidence;
use forwardstep_check::{Answer, Evidence, Id, check};
use forwardstep_core::controller::Floor;
use forwardstep_core::expression::Expression;
use forwardstep_core::robot::tree::{Follows, JointKind, Uncertain};
use forwardstep_core::sampled::SafeCommand;
use forwardstep_sim::delay::{Basis, Delay};
use forwardstep_sim::formula::BoundedFormula;
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
    // One of several whose bound is not known for ever is enough.
    let faster = Expression::variable(0).power(2.0).sin_of() * 0.05 + 0.1;
    let mut setup = pair([Delay::new(BoundedFormula::new(faster, 20.0)), constant()]);
    setup.control = control(0.0);
    setup.control.as_mut().unwrap().failures.message_timeout_s = Some(9.0);
    let found = check(&setup).hypotheses.into_iter().find(|h| h.id == Id::MessagesInTime).unwrap();
    assert_ne!(found.answer(), Answer::Holds);
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
