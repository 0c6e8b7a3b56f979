//! An agent that leads: what is known of γ from its target.

use forwardstep_check::{Answer, Id, check};
use forwardstep_core::expression::Expression;
use forwardstep_sim::Setup;
use forwardstep_sim::leader::{Following, FollowingDesign};
use forwardstep_sim::push::{Course, Effect, Function, Push};
use forwardstep_sim::trajectory::Path;

use super::{led_by_agent, wave};
use crate::common::kinds::fading_power_of_time;

/// What is said of γ: the answer, and why.
fn gain(setup: &Setup) -> (Answer, String) {
    let report = check(setup);
    let found = report.hypotheses.iter().find(|hypothesis| hypothesis.id == Id::SignGain).unwrap();
    (found.answer(), found.because())
}

fn with_gain(design: FollowingDesign, path: Path, gain: f64) -> Setup {
    let mut setup = led_by_agent(design, path);
    assert!(setup.change_reference(|following: &mut Following| following.gain = gain));
    setup
}

#[test]
fn regress_gamma_below_what_the_target_of_an_agent_that_leads_asks_for_is_told_before_the_run() {
    // |q̈ + q̇| of ½ sin 2t is √5, |d³q + 2 q̈ + q̇| is 5.
    for (design, drive) in [(FollowingDesign::Continuous, 5.0_f64.sqrt()), (FollowingDesign::Differentiable, 5.0)] {
        let of = |gamma: f64| gain(&with_gain(design, wave(), gamma));
        assert_eq!(of(1.02 * drive).0, Answer::Watched, "the leader may be driven harder on its way");
        let (answer, because) = of(0.98 * drive);
        assert!(answer == Answer::NotShown && because.contains("mass-3 comes to keep to a target"), "{because}");
    }
    // Two rates with no common period come back all the same.
    let t = || Expression::variable(0);
    let waves = Path::Formula((t() * 2.0).sin_of() * 0.5 + (t() * 2.0_f64.sqrt()).sin_of() * 0.5);
    assert_eq!(gain(&with_gain(FollowingDesign::Continuous, waves, 1.5)).0, Answer::NotShown);
    // What fades may be over before the leader is there.
    let fading = fading_power_of_time(10.0, 4.0);
    assert_eq!(gain(&with_gain(FollowingDesign::Continuous, fading, 0.1)).0, Answer::Watched);
}

#[test]
fn a_leader_that_need_not_arrive_is_said_to_be_meant_to() {
    let mut setup = with_gain(FollowingDesign::Continuous, wave(), 0.1);
    let course = Course::Each(vec![Function::Constant(0.1)]);
    let push = |until_s| Push { effect: Effect::Torque(course.clone()), from_s: 1.0, until_s };
    setup.agents[0].pushes = vec![push(2.0)];
    assert_eq!(gain(&setup).0, Answer::NotShown);
    setup.agents[0].pushes = vec![push(f64::INFINITY)];
    let (answer, because) = gain(&setup);
    assert!(answer == Answer::NotShown && because.contains("mass-3 is to keep to a target"), "{because}");
}
