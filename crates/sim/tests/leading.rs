//! An agent of the network that leads the others.

use std::sync::Arc;

use crate::common::chains;
use crate::common::following::{COMPOSITE, DESIGNS, led_by_agent, masses, observes};
use crate::common::{column, run, sampled};
use forwardstep_core::reference::Choice;
use forwardstep_sim::graph::Edge;
use forwardstep_sim::leader::{Following, FollowingDesign, Leading};
use forwardstep_sim::push::{Course, Effect, Function, Push};
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::{
    AgentSetup, LagrangianRobot, PositionKind, Robot, RobotInterface, Setup, SetupError, Signal, VelocitySensor,
    simulate,
};

/// Designs that an agent can lead under: q̈, which nothing measures, is no part of what it tells.
fn led_by_agents() -> impl Iterator<Item = FollowingDesign> {
    DESIGNS.into_iter().filter(|design| *design != COMPOSITE)
}

#[test]
fn prop_an_agent_that_is_on_its_target_leads_like_the_motion() {
    for design in led_by_agents() {
        for choice in [Choice::Layer { width: 0.1 }, Choice::Implicit] {
            let mut setup = masses(design);
            setup.time.record_every_s = 0.1;
            assert!(setup.change_reference(|following: &mut Following| {
                (following.choice, following.period_s) = (choice, 0.01);
            }));
            let expected = run(&setup);
            for (place, roots) in [(3, &[2.0][..]), (0, &[2.0, 1.0]), (1, &[1.0, 3.0])] {
                let led = led_by_agent(setup.clone(), roots, place);
                let outcome = run(&led);
                for column in &expected.recording.columns {
                    let agent = column.agent + usize::from(column.agent >= place);
                    let values = outcome.recording.values(agent, column.signal, column.axis).unwrap();
                    // A value of a set-valued sign may be any where its argument is zero but for rounding.
                    let within = if choice == Choice::Implicit { 1e-3 } else { 1e-6 };
                    for (a, b) in values.iter().zip(&column.values) {
                        assert!(
                            (a - b).abs() < within * (1.0 + b.abs()),
                            "{design:?} {choice:?} {place}: {:?} {a} {b}",
                            column.signal
                        );
                    }
                }
                // Its own error is that from its target.
                let error = outcome.recording.values(place, Signal::Error, 0).unwrap();
                assert!(error.iter().all(|error| error.abs() < 1e-6));
            }
        }
    }
}

/// max |α q̇ + q̈| and so on, of the motion itself.
fn drive_of_motion(setup: &Setup) -> f64 {
    let following = setup.following().unwrap();
    setup.following().unwrap().motion().unwrap().trajectory.sampled_peak(&following.drive(), setup.time.end_s, 4000)
}

/// The last time at which what drives the motion is `gain` or more.
fn last_at_least(setup: &Setup, gain: f64) -> Option<f64> {
    let following = setup.following().unwrap();
    let (trajectory, drive) = (&following.motion().unwrap().trajectory, following.drive());
    let mut jets = vec![[0.0; 5]; trajectory.axes()];
    let mut size = |t_s: f64| {
        trajectory.jets(t_s, &mut jets);
        let of = |jet: &[f64; 5]| jet.iter().zip(drive).map(|(value, weight)| weight * value).sum::<f64>().abs();
        jets.iter().map(of).fold(0.0, f64::max)
    };
    (0..=8000).rev().map(|k| f64::from(k) / 8000.0 * setup.time.end_s).find(|t_s| size(*t_s) >= gain)
}

#[test]
fn a_leader_that_catches_up_with_its_target_is_watched_from_the_start() {
    let mut led = led_by_agent(masses(FollowingDesign::Continuous), &[2.0], 3);
    // s(0) = 2 e(0), and the mass of 3 kg is braked by K s with K = 5.
    led.agents[3].start.q[0] += 1.5;
    let drive = run(&led).statistics.drive.unwrap();
    assert_eq!(drive.peak_s, 0.0);
    assert!((drive.peak - 5.0).abs() < 2.0, "{drive:?}");
}

#[test]
fn what_drives_the_leader_is_watched() {
    for design in led_by_agents() {
        let setup = masses(design);
        let truth = drive_of_motion(&setup);
        for gain in [2.5, 0.4 * truth] {
            let mut led = led_by_agent(setup.clone(), &[2.0], 3);
            led.solver.max_step_s = Some(2e-3);
            assert!(led.change_reference(|following: &mut Following| following.gain = gain));
            let drive = run(&led).statistics.drive.unwrap();
            assert!((drive.peak - truth).abs() < 5e-3 * truth, "{design:?}: {} {truth}", drive.peak);
            assert!(drive.peak_s > 0.0 && drive.peak_s <= led.time.end_s);
            assert_eq!(drive.exceeds_until_s.is_some(), gain < truth, "{design:?}");
            let until_s = last_at_least(&setup, gain);
            let apart = drive.exceeds_until_s.zip(until_s).map(|(seen_s, true_s)| (seen_s - true_s).abs());
            assert!(apart.is_none_or(|apart| apart < 0.02), "{design:?}: {:?} {until_s:?}", drive.exceeds_until_s);
        }
        assert_eq!(run(&setup).statistics.drive, None, "bounds of a motion are known before the run");
    }
}

#[test]
fn a_push_on_the_leader_is_seen_and_the_others_come_back() {
    let mut led = led_by_agent(masses(FollowingDesign::Continuous), &[2.0, 1.0], 0);
    led.time.end_s = 25.0;
    assert!(led.change_reference(|following: &mut Following| following.choice = Choice::Implicit));
    let calm = run(&led).statistics.drive.unwrap();
    let effect = Effect::Torque(Course::Each(vec![Function::Constant(20.0)]));
    led.agents[0].pushes = vec![Push { effect, from_s: 4.0, until_s: 4.5 }];
    let outcome = run(&led);
    let drive = outcome.statistics.drive.unwrap();
    // The mass is 3 kg: the push alone is 6.7 m/s².
    assert!(calm.exceeds_until_s.is_none() && drive.peak > 5.0 && (4.0..4.6).contains(&drive.peak_s), "{drive:?}");
    assert!((4.4..6.0).contains(&drive.exceeds_until_s.unwrap()), "{drive:?}");
    for agent in 1..4 {
        let error = column(&outcome, agent, Signal::Error, 0);
        assert!(error.iter().any(|error| error.abs() > 0.1) && error.last().unwrap().abs() < 1e-3);
    }
}

#[test]
fn sampled_followers_follow_an_agent_that_samples_whatever_its_velocity_comes_from() {
    let mut setup = masses(FollowingDesign::Continuous);
    assert!(setup.change_reference(|following: &mut Following| following.choice = Choice::Implicit));
    setup.time.end_s = 15.0;
    let led = led_by_agent(setup, &[2.0], 1);
    let last = |hz: f64, velocity| {
        let mut led = sampled(led.clone(), hz);
        led.control.as_mut().unwrap().sensors.velocity = velocity;
        let outcome = run(&led);
        assert!(outcome.statistics.drive.is_some());
        let errors =
            (0..4).filter(|agent| *agent != 1).map(|agent| outcome.recording.last(agent, Signal::Error, 0).abs());
        errors.fold(0.0, f64::max)
    };
    let [coarse, fine] = [100.0, 1000.0].map(|hz| last(hz, VelocitySensor::Measured));
    assert!(coarse < 0.05 && fine < 0.3 * coarse, "{coarse} {fine}");
    let filtered = last(1000.0, VelocitySensor::Filtered { cut_off_hz: 100.0 });
    assert!(filtered < 0.05, "{filtered}");
}

/// A robot whose position is a unit quaternion.
#[derive(Debug)]
struct Attitude;

impl Robot for Attitude {
    fn interface(&self, axes: usize) -> RobotInterface {
        RobotInterface { position: PositionKind::UnitQuaternion, ..RobotInterface::mechanical(axes) }
    }

    fn lagrangian(&self) -> Option<&dyn LagrangianRobot> {
        None
    }
}

#[test]
fn who_cannot_lead_is_told_why() {
    let led = |design| led_by_agent(masses(design), &[2.0], 1);
    let refused = |setup: &Setup| simulate(setup, &mut |_| std::ops::ControlFlow::Continue(())).err();
    let changed = |change: &dyn Fn(&mut Setup)| {
        let mut setup = led(FollowingDesign::Continuous);
        change(&mut setup);
        refused(&setup)
    };
    assert_eq!(refused(&led(FollowingDesign::Continuous)), None);
    let said = changed(&|setup| {
        let mut edges = setup.network.schedule.graphs[0].clone();
        edges.push(Edge { from: 0, to: 1, weight: 1.0.into(), delay: 0 });
        setup.network.schedule = Schedule::fixed(edges);
    });
    assert_eq!(said, Some(SetupError::LeaderHears { leader: "pilot".into() }));
    let said = changed(&|setup| {
        setup.change_reference(|following: &mut Following| following.leader = Leading::Agent(4));
    });
    assert_eq!(said, Some(SetupError::NoAgent { agent: 4, agents: 4 }));
    assert_eq!(changed(&|setup| setup.agents[1].target = None), Some(SetupError::NoTarget { agent: "pilot".into() }));
    let said = changed(&|setup| setup.agents[1].roots_per_s.clear());
    assert!(matches!(said, Some(SetupError::Chain { agent, .. }) if agent == "pilot"));
    let said = changed(&|setup| setup.agents[2].roots_per_s = vec![1.0].into());
    assert!(matches!(said, Some(SetupError::RootCount { agent, .. }) if agent == setup_name(2)));
    let said = changed(&|setup| setup.agents[2].target = setup.agents[1].target.clone());
    assert!(matches!(said, Some(SetupError::NoOffsets { agent, .. }) if agent == setup_name(2)));
    for design in DESIGNS {
        let said = refused(&sampled(led(design), 100.0));
        let smooth = design != FollowingDesign::Continuous && !observes(design);
        assert_eq!(matches!(said, Some(SetupError::CannotLead { .. })), smooth, "{design:?}: {said:?}");
    }
    let said = refused(&led(COMPOSITE));
    assert!(matches!(&said, Some(SetupError::CannotLead { why, .. }) if why.contains("`observer`")), "{said:?}");
    // q and −q are one attitude, which a difference does not know.
    let said = changed(&|setup| setup.agents[1].robot.kind = Arc::new(Attitude));
    assert!(matches!(said, Some(SetupError::CannotLead { .. })), "{said:?}");
    // The second state of a chain in feedback form is no velocity.
    let mut single = led(FollowingDesign::Continuous);
    single.agents[1] = AgentSetup { name: "pilot".into(), ..chains::tracking().agents[0].clone() };
    assert!(matches!(refused(&single), Some(SetupError::CannotLead { agent, .. }) if agent == "pilot"));
}

/// A chain of order three and one of order two, whose laws adapt or know: both lead, and whoever follows reaches them.
#[test]
fn chains_with_a_velocity_lead() {
    for design in led_by_agents() {
        for chain in &chains::tracking().agents[1..] {
            let mut led = led_by_agent(masses(design), &[2.0], 1);
            led.agents[1] = chain.clone();
            led.time.end_s = 30.0;
            assert!(led.change_reference(|following: &mut Following| following.choice = Choice::Implicit));
            let outcome = run(&led);
            for agent in [0, 2, 3] {
                let error = outcome.recording.last(agent, Signal::Error, 0).abs();
                assert!(error < 2e-2, "{design:?} {}: {error}", chain.name);
            }
        }
    }
}

fn setup_name(agent: usize) -> String {
    led_by_agent(masses(FollowingDesign::Continuous), &[2.0], 1).agents[agent].name.clone()
}
