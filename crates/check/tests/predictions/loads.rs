//! Static torques against limits.

use crate::common::arm;
use crate::common::kinds::{formula, rest_at, tracking};
use forwardstep_check::{Finding, practical};
use forwardstep_core::expression::Expression;
use forwardstep_sim::Setup;

use super::two_arms;

#[test]
fn an_arm_that_its_motors_cannot_hold_is_told() {
    let mut setup = two_arms();
    let said = |setup: &Setup| {
        practical(setup).findings.first().map(|finding| (finding.name(), finding.answer().words(), finding.because()))
    };
    assert_eq!(said(&setup), None, "no limit is known");
    setup.agents[1].robot.axes[0].effort_limit = Some(10.0);
    setup.agents[1].robot.axes[1].effort_limit = Some(1e4);
    setup.agents[0].start.q = vec![1.4, 0.1];
    setup.agents[1].start.q = vec![0.2, 0.1];
    let (name, answer, because) = said(&setup).unwrap();
    assert_eq!((name, answer), ("static-load", "inadequate"));
    assert!(because.contains(" of 10 N m (arm-2, shoulder)"), "{because}");
    setup.agents[1].robot.axes[0].effort_limit = Some(1e3);
    assert_eq!(said(&setup).unwrap().1, "adequate");
    // Those of the actuators count where they are tighter.
    let load_of = |setup: &Setup| -> Finding {
        practical(setup).findings.into_iter().find(|finding| finding.name() == "static-load").unwrap()
    };
    setup = setup.sampled(500.0);
    setup.control.as_mut().unwrap().actuators.torque_limit = Some(vec![1e3, 0.5]);
    let load = load_of(&setup);
    assert!(load.answer().words() == "inadequate" && load.because().contains(" of 0.5 N m (arm-"), "{load:?}");
    // And where both limit one axis, the tighter of them.
    setup.control.as_mut().unwrap().actuators.torque_limit = Some(vec![3.0, 1e3]);
    let load = load_of(&setup);
    assert!(load.because().contains(" of 3 N m (arm-2, shoulder)"), "{load:?}");
}

/// It hangs at its start, and its target leads it through the horizontal, where its shoulder is loaded most.
#[test]
fn regress_a_load_on_the_way_to_a_target_counts() {
    let said = |swing: f64| {
        let mut agent = arm(0, &[1.0, 2.0]);
        agent.start.q = vec![-core::f64::consts::FRAC_PI_2, 0.0];
        agent.robot.axes[0].effort_limit = Some(5.0);
        let path = rest_at(-core::f64::consts::FRAC_PI_2);
        let raised = formula((Expression::variable(0) * 0.1).sin_of() * swing - core::f64::consts::FRAC_PI_2);
        let setup = tracking(agent, vec![if swing > 0.0 { raised } else { path }, rest_at(0.0)]);
        let load = practical(&setup).findings.into_iter().find(|finding| finding.name() == "static-load");
        load.unwrap().answer().words()
    };
    assert_eq!([said(0.0), said(1.6)], ["adequate", "inadequate"]);
}
