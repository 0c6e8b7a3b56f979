//! The sampling margin: which agent, which state, and what adaptation, delays and filters make of it.

use std::sync::Arc;

use super::{constant, control, pair};
use crate::common::arm;
use crate::common::kinds::{alone, rest_at, tracking};
use forwardstep_check::{PracticalAnswer, SamplingMargin, ideal, practical};
use forwardstep_core::Gain;
use forwardstep_sim::recording::Signal;
use forwardstep_sim::{Adaptive, Setup, VelocitySensor, run};

#[test]
fn eq_the_margin_is_that_of_the_worst_agent() {
    // Masses of 1 kg and 2 kg under K = 5: λ_max(M⁻¹K) is 5 and 2.5.
    for order in [[0, 1], [1, 0]] {
        let mut setup = pair([constant(0.0), constant(0.0)]);
        setup.agents = order.map(|k| setup.agents[k].clone()).to_vec();
        setup.control = control(0.0);
        let found = SamplingMargin::of(&setup).unwrap();
        assert!((found.start.sigma - 0.25).abs() < 1e-12 && found.start.agent.index == order[0], "{found:?}");
        assert_eq!((found.start.sigma, found.start.frozen_sigma), (found.start.damping_sigma, None), "nobody adapts");
        assert!((found.longest_s.unwrap() - 0.4).abs() < 1e-9 && (found.recommended_s.unwrap() - 0.2).abs() < 1e-9);
    }
}

#[test]
fn the_margin_is_adequate_up_to_a_half_and_inadequate_from_one_on() {
    let said = |sample_hz: f64, late: f64| {
        let mut setup = pair([constant(0.0), constant(0.0)]);
        setup.control = control(late / sample_hz);
        setup.control.as_mut().unwrap().sample_hz = sample_hz;
        let practical = practical(&setup);
        let finding = &practical.findings[0];
        assert_eq!(finding.name(), "sampling-margin");
        (finding.answer(), finding.because())
    };
    use PracticalAnswer::{Adequate, Inadequate, Marginal};
    // From one on it is inadequate, unless the loop as a whole decays: references answer s, and help for a little.
    let answers = [5.01, 4.99, 2.51, 2.49, 2.0, 1.0].map(|sample_hz| said(sample_hz, 0.0).0);
    assert_eq!(answers, [Adequate, Marginal, Marginal, Marginal, Marginal, Inadequate]);
    assert!(said(2.49, 0.0).1.contains("as a whole, with references that answer it, the loop decays"));
    // A torque that comes late by a quarter of a period: k up to 4.
    assert_eq!([1.26, 1.0].map(|sample_hz| said(sample_hz, 0.25).0), [Marginal, Inadequate]);
    let sentence = said(10.0, 0.0).1;
    let said_so = "σ = 0.25 at the start (arm-1), whose fastest mode has 5/s; it reaches 1 at a period of 400 ms; keep it below \
                   0.5, a period of 200 ms";
    assert!(sentence.starts_with(said_so), "{sentence}");
    let late = said(1.0, 0.9).1;
    assert!(late.contains("with torques 900 ms late; sampling is too slow"), "{late}");
    assert!(late.contains("no period is short enough for it"), "{late}");
    let mut setup = pair([constant(0.0), constant(0.0)]);
    assert_eq!(practical(&setup).worst(), None, "control is continuous");
    setup.control = control(0.0);
    setup.control.as_mut().unwrap().sensors.velocity = VelocitySensor::Filtered { cut_off_hz: 3.0 };
    assert!(practical(&setup).findings[0].because().contains("5/s, with velocities filtered at 3 Hz; it reaches 1"));
}

#[test]
fn eq_a_bandwidth_of_the_adaptation_counts_squared() {
    // Γ = ω² diag(scale): what is learnt goes with Γ, beside what the damping does, and counts for less the larger K is.
    let found = |omega: f64, k: f64| {
        let mut setup = pair([constant(0.0), constant(0.0)]);
        let adaptation = Gain::Bandwidth(omega);
        setup.agents[0] = arm(0, &[1.0, 2.0]);
        let damping = Gain::Number(k);
        setup.agents[0].law = Arc::new(Adaptive { damping, adaptation, estimate_start: vec![0.0; 5], bounds: None });
        setup.control = control(0.0);
        let found = SamplingMargin::of(&setup).unwrap();
        assert_eq!(found.start.agent.index, 0);
        found
    };
    let at = |omega: f64, k: f64| found(omega, k).start;
    let (one, two) = (at(1.0, 1e-9), at(2.0, 1e-9));
    let ratios = [two.frozen_sigma.unwrap() / one.frozen_sigma.unwrap(), two.sigma / one.sigma];
    assert!(one.sigma > 1.0 && ratios.iter().all(|ratio| (ratio - 4.0).abs() < 1e-4), "{ratios:?}");
    assert_eq!(found(1.0, 1e-9).answer(), PracticalAnswer::NotShown, "with Y frozen no mode is unstable");
    assert!(found(40.0, 1e-9).answer() == PracticalAnswer::Inadequate, "{:?}", found(40.0, 1e-9));
    assert!((at(1.0, 2.0).sigma - at(1.0, 2.0).damping_sigma) * 1.9e9 < one.sigma);
}

#[test]
fn the_adaptation_of_those_that_follow_targets_of_their_own_is_not_in_the_margin() {
    let margin = |tracks: bool| {
        let mut setup = if tracks {
            tracking(arm(0, &[1.0, 2.0]), vec![rest_at(0.1), rest_at(0.2)])
        } else {
            alone(arm(0, &[1.0, 2.0]))
        };
        setup.control = control(0.0);
        SamplingMargin::of(&setup).unwrap()
    };
    let [own, shared] = [true, false].map(margin);
    assert_eq!([own.adaptation_left_out, shared.adaptation_left_out], [1, 0]);
    let [own, shared] = [own.start, shared.start];
    assert!(own.sigma == own.damping_sigma && own.frozen_sigma.is_none(), "{own:?}");
    assert!(
        shared.sigma > 1.005 * shared.damping_sigma && shared.frozen_sigma > Some(shared.damping_sigma),
        "{shared:?}"
    );
}

/// Y is that of the start with its velocities, which adaptation makes of them what it does.
#[test]
fn the_margin_at_the_start_is_that_of_an_arm_that_moves() {
    let margin = |dq: [f64; 2]| {
        let mut setup = alone(arm(0, &[1.0, 2.0]));
        setup.agents[0].start.dq = dq.to_vec();
        setup.control = control(0.0);
        SamplingMargin::of(&setup).unwrap().start
    };
    let [rests, moves] = [[0.0; 2], [3.0, -2.0]].map(margin);
    assert!(rests.damping_sigma == moves.damping_sigma && moves.sigma > 1.001 * rests.sigma, "{rests:?} {moves:?}");
}

/// Masses of unknown mass have Y = ż and P = Γ ż żᵀ: nothing at rest, most where their references begin.
fn learning_pair(gamma: f64) -> Setup {
    let mut setup = pair([constant(0.1), constant(0.1)]);
    for agent in &mut setup.agents {
        agent.law = Arc::new(Adaptive {
            damping: Gain::Number(2.0),
            adaptation: Gain::Number(gamma),
            estimate_start: vec![0.5],
            bounds: None,
        });
        agent.start.dq = vec![0.0; 2];
        agent.start.reference = Vec::new();
    }
    setup.control = control(0.0);
    setup
}

#[test]
fn eq_the_margin_on_the_way_is_that_of_the_accelerations_of_references() {
    let setup = learning_pair(400.0);
    let found = SamplingMargin::of(&setup).unwrap();
    let led = run(&ideal(&setup).unwrap()).unwrap().recording;
    let squares = |agent: usize| {
        let of_agent =
            led.columns.iter().filter(|column| (column.agent, column.signal) == (agent, Signal::Reference(1)));
        let columns: Vec<&Vec<f64>> = of_agent.map(|column| &column.values).collect();
        let square = |row: usize| columns.iter().map(|values| values[row] * values[row]).sum();
        (0..led.t_s.len()).map(square).fold(0.0, f64::max)
    };
    let h = found.period_s;
    let sigma = |agent: usize| 0.5 * h * (2.0 / setup.agents[agent].robot.theta[0] + 400.0 * squares(agent) / 2.0);
    let expected = sigma(0).max(sigma(1));
    assert!(expected > 1.5 * found.start.sigma && found.led > 100, "{found:?}");
    assert!((found.worst.sigma - expected).abs() < 2e-3 * expected, "{expected}: {found:?}");
    assert!(found.worst.led_s.is_some() && found.start.led_s.is_none());
    let sentence = practical(&setup).findings[0].because();
    assert!(sentence.contains(" on the way that its reference leads (arm-"), "{sentence}");
    // The longest period is that of the same state.
    assert!((found.longest_s.unwrap() * expected / h - 1.0).abs() < 2e-3, "{expected}: {found:?}");
    let hold = |_| found.hold;
    assert_eq!(SamplingMargin::longest_period_s(&setup, h, hold), found.longest_s);
}

#[test]
fn a_margin_beyond_one_on_the_way_is_not_adequate_though_it_is_at_rest() {
    let said = |gamma: f64| SamplingMargin::of(&learning_pair(gamma)).unwrap();
    let [slow, quick] = [0.01, 4e4].map(said);
    assert_eq!([slow.answer(), quick.answer()], [PracticalAnswer::Adequate, PracticalAnswer::NotShown]);
    assert_eq!(slow.start, quick.start);
    assert!(quick.worst.sigma >= 1.0 && quick.recommended_s.unwrap() < 0.1 * slow.recommended_s.unwrap());
}

/// What is learnt gains nothing by a torque that is late by a quarter of a period, and loses by the filter of velocities.
#[test]
fn regress_a_late_torque_lets_nothing_be_learnt_faster() {
    let at = |late: f64, filtered: bool| {
        let mut setup = learning_pair(400.0);
        let control = setup.control.as_mut().unwrap();
        control.computation_delay_s = late / control.sample_hz;
        if filtered {
            control.sensors.velocity = VelocitySensor::Filtered { cut_off_hz: 1e6 };
        }
        let worst = SamplingMargin::of(&setup).unwrap().worst;
        worst.sigma - worst.damping_sigma
    };
    let ideal = at(0.0, false);
    for (late, filtered, times) in [(0.25, false, 1.5), (0.5, false, 2.0), (0.0, true, 2.0), (0.5, true, 3.0)] {
        let found = at(late, filtered);
        assert!((found / ideal / times - 1.0).abs() < 1e-6, "{late}, {filtered}: {found} {ideal}");
    }
}

/// An arm is led to where its fastest mode is faster.
#[test]
fn the_margin_looks_at_targets() {
    let at = |elbow: f64| {
        let mut setup = tracking(arm(0, &[1.0, 2.0]), vec![rest_at(0.1), rest_at(elbow)]);
        setup.agents[0].start.q = vec![0.1, 1.5];
        setup.control = control(0.0);
        SamplingMargin::of(&setup).unwrap()
    };
    let [stays, unfolds] = [1.5, 0.0].map(at);
    assert_eq!(stays.worst.sigma, stays.start.sigma);
    assert!(unfolds.worst.led_s.is_some() && unfolds.worst.sigma > 1.1 * unfolds.start.sigma, "{unfolds:?}");
}
