//! References, sampled agents and laws at their edges: starts, signs, samples, limits, divisors.

use crate::common::looped::polynomial as moved;
use forwardstep_core::Gain;
use forwardstep_core::agent::{Agent, Inbox, Limiter, StepError};
use forwardstep_core::controller::{
    AdaptiveBackstepping, AttitudeTracking, BacksteppingGains, ChainError, Controller, ControllerInput,
    ControllerOutput, Floor, Following as ChainFollowing, Immersion, Jet, Jets, Linearising, PositionOnly,
    ReferenceModel, Singularity, Stepped, TaskSpace, Thrust, ThrustDesign,
};
use forwardstep_core::expression::Expression;
use forwardstep_core::law::{ParameterBounds, SlotineLi};
use forwardstep_core::plant::{CascadeTerms, Formulas, Mechanical, Plant, Spacecraft, Wheel, Wheels, total};
use forwardstep_core::reference::{
    Choice, Consensus, Derived, Heard, Measured, Position, PositionVelocitySums, Reference, ReferenceOut, Sliding,
    SlidingInputs, SmoothFollowing, polynomial,
};
use forwardstep_core::robot::{PlanarArm, PlanarLinks, PlanarTip, PointMass};
use forwardstep_core::signal::Signal;

const SIGN: Sliding =
    Sliding { derived: Derived::Acceleration, alpha: 1.3, beta: 0.6, gamma: 2.5, choice: Choice::Implicit };

#[test]
fn eq_119_122_and_swarm_start_with_the_wanted_reference_acceleration() {
    let (q, dq, z, dz, degree, sums) = ([0.3], [-0.7], 0.4, 2.5, [1.5], [0.8, -0.9]);
    for law in
        [SmoothFollowing::new(1, SIGN), SmoothFollowing::swarm(1, SIGN, 3.0), SmoothFollowing::swarm(1, SIGN, 0.2)]
    {
        let heard =
            || Heard { degree: &degree, sums: PositionVelocitySums { q: &sums[..1], dq: &sums[1..] }, time_s: 0.0 };
        let measured = Measured { q: &q, dq: &dq };
        let mut state = [0.0; 3];
        law.start(1, measured, &[z, dz, 0.0], heard(), &mut state).unwrap();
        let (mut out_z, mut out_dz, mut rate) = ([0.0], [0.0], [0.0; 3]);
        let out = ReferenceOut { z: &mut out_z, dz: &mut out_dz, d_state: &mut rate };
        law.evaluate(1, measured, &state, heard(), out).unwrap();
        assert!((out_dz[0] - dz).abs() < 1e-14 && out_z[0] == z, "{law:?}: {out_dz:?}");
    }
}

#[test]
fn a_sign_that_one_agent_chooses_depends_on_its_period_only_where_it_is_solved_for() {
    let chosen = |choice, e: f64, period_s: f64| Sliding { choice, ..SIGN }.alone(e, 2.0, period_s);
    for period_s in [1e-3, 0.1] {
        assert_eq!([-1e-9, 0.0, 1e-9].map(|e| chosen(Choice::Explicit, e, period_s)), [-1.0, 0.0, 1.0]);
        let layer = Choice::Layer { width: 0.5 };
        assert_eq!([-1.0, -0.25, 0.1, 0.5].map(|e| chosen(layer, e, period_s)), [-1.0, -0.5, 0.2, 1.0]);
        // ς = sat(e/(hγ d)).
        let width = period_s * 2.5 * 2.0;
        let found = [-2.0, -0.3, 0.6, 1.5].map(|part| chosen(Choice::Implicit, part * width, period_s));
        assert!(found.iter().zip([-1.0, -0.3, 0.6, 1.0]).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
    }
}

/// A mass under (119), sampled.
fn sampled_follower(derived: Derived) -> Agent<PointMass, SmoothFollowing> {
    let law = SlotineLi { damping: Gain::Number(8.0).resolve(1, &[]).unwrap(), adaptation: None, bounds: None };
    let reference = SmoothFollowing::new(1, Sliding { derived, ..SIGN });
    Agent::new(PointMass { dimension: 1 }, reference, law, vec![2.0], Limiter::none(1)).unwrap()
}

#[test]
fn eq_119_a_sampled_agent_tells_its_acceleration_and_122_its_reference_acceleration() {
    let h = 0.02;
    for derived in [Derived::Acceleration, Derived::ReferenceAcceleration] {
        let mut agent = sampled_follower(derived);
        let (mut dq_before, mut dz_before) = (0.0, None);
        for k in 0..5 {
            let (q, dq) = (0.3 + 0.1 * f64::from(k), -0.4 + 0.3 * f64::from(k * k));
            let inbox = Inbox { degree: 1.5, sums: &[1.2, -0.6, 0.9] };
            let dz = agent.step(h * f64::from(k), Measured { q: &[q], dq: &[dq] }, inbox).unwrap().dz[0];
            let transmitted = agent.transmitted()[0];
            let want = match (derived, dz_before) {
                // q̈ is ż and what the velocity gained beyond the ż of before.
                (Derived::Acceleration, Some(before)) => dz + (dq - dq_before) / h - before,
                _ => dz,
            };
            assert!((transmitted - want).abs() < 1e-10, "{derived:?}, sample {k}: {transmitted} is not {want}");
            (dq_before, dz_before) = (dq, Some(dz));
        }
    }
}

#[test]
fn a_sample_that_does_not_come_later_is_refused_and_changes_nothing() {
    let inbox = Inbox { degree: 1.5, sums: &[1.2, -0.6, 0.9] };
    let at = Measured { q: &[0.3], dq: &[0.2] };
    let mut agent = sampled_follower(Derived::ReferenceAcceleration);
    agent.step(1.0, at, inbox).unwrap();
    let state = agent.reference_state().to_vec();
    for now_s in [1.0, 0.5] {
        assert_eq!(agent.step(now_s, at, inbox).unwrap_err(), StepError::Time { now_s, last_s: 1.0 });
        assert_eq!(agent.reference_state(), state);
    }
    assert!(agent.step(1.0 + 1e-9, at, inbox).is_ok());
    let mut stepped = blind();
    let jets = [[0.1; 5]];
    let inbox = Inbox { degree: 0.0, sums: &[0.0] };
    stepped.step(1.0, &[0.3, 0.0], inbox, Jets::from(&jets)).unwrap();
    let again = stepped.step(1.0, &[0.3, 0.0], inbox, Jets::from(&jets)).unwrap_err();
    assert_eq!(again, StepError::Time { now_s: 1.0, last_s: 1.0 });
}

/// (a8) and (a9) for one axis, sampled.
fn blind() -> Stepped<PositionOnly> {
    let mut alpha = polynomial([1.0, 1.5, 2.0]).unwrap();
    alpha.pop();
    let law = PositionOnly {
        axes: 1,
        guide: ReferenceModel::Tracking { alpha },
        damping: 3.0,
        filter_per_s: 2.0,
        adaptation: 0.5,
        estimate_start: 0.7,
        bounds: None,
    };
    let plant = Mechanical { robot: PointMass { dimension: 1 }, theta: vec![2.0] };
    let start = vec![0.1; total(&law.states())];
    Stepped::new(law, &plant, 1, &start).unwrap()
}

/// Between two samples what was measured stands still and the target goes on as its derivatives say.
#[test]
fn eq_a9_one_long_step_is_many_short_ones_along_the_target() {
    let derivatives: Jet = [0.3, -0.8, 1.7, -2.4, 5.0];
    let inbox = Inbox { degree: 0.0, sums: &[0.0] };
    let (h, output) = (0.05, [0.4, 0.0]);
    let after = |parts: u32| {
        let mut stepped = blind();
        for k in 0..=parts {
            let t_s = h * f64::from(k) / f64::from(parts);
            stepped.step(t_s, &output, inbox, Jets::from(&[moved(&derivatives, t_s)])).unwrap();
        }
        stepped.state().to_vec()
    };
    let (long, short) = (after(1), after(200));
    let still: f64 = long.iter().zip(&blind().state().to_vec()).map(|(a, b)| (a - b).abs()).sum();
    assert!(still > 0.01, "it moves");
    for (long, short) in long.iter().zip(&short) {
        assert!((long - short).abs() < 2e-6, "{long} and {short}");
    }
}

#[test]
fn eq_43_a_negative_factor_of_the_input_is_as_good_as_a_positive_one() {
    let plant = Formulas::new(2, &Expression::number(0.0), Vec::new(), &Expression::number(-2.0)).unwrap();
    let guide = ReferenceModel::Consensus(Consensus::<Position>::new([(&[1.0, 2.0][..], 0.0)]).unwrap());
    let law = Linearising::new(plant, Vec::new(), ChainFollowing { guide, gain_per_s: 1.0, floor: 0.1 }).unwrap();
    let state = vec![0.0; total(&law.states())];
    let transmitted = |psi: f64| {
        // z, ż, s, ψ.
        let mut shown = vec![0.0; total(&law.shown())];
        shown[3] = psi;
        law.trouble(&state, &shown).is_some()
    };
    assert_eq!(
        [-2.0, -0.1, -0.09, 0.0, 0.09, 0.1, 2.0].map(transmitted),
        [false, false, true, true, true, false, false]
    );
}

#[test]
fn immersion_notices_an_antiderivative_that_is_a_little_off() {
    let [x, v] = [Expression::variable(0), Expression::variable(1)];
    let plant = || {
        let phi = vec![x.clone() * v.clone().power(2.0)];
        Formulas::new(2, &Expression::number(0.0), phi, &Expression::number(1.0)).unwrap()
    };
    let guide = || ReferenceModel::Consensus(Consensus::<Position>::new([(&[1.0, 2.0][..], 0.0)]).unwrap());
    let made = |factor: f64| {
        let following = ChainFollowing { guide: guide(), gain_per_s: 1.0, floor: 0.1 };
        let antiderivative = x.clone() * v.clone().power(3.0) * factor;
        Immersion::new(plant(), &[antiderivative], following, vec![1.0], vec![0.0])
    };
    assert!(made(1.0 / 3.0).is_ok());
    assert!(made(1.0 / 3.0 + 1e-6).is_err());
    // A slip that is nothing at all points that are tried: within 0.2 of v = 3, and beyond v = 4.
    for slip in [((v.clone() - 3.0).power(2.0) * -100.0).exp_of() * 0.5, ((v.clone() - 10.0) * 20.0).exp_of() * 1e-40] {
        let following = ChainFollowing { guide: guide(), gain_per_s: 1.0, floor: 0.1 };
        let antiderivative = x.clone() * v.clone().power(3.0) / 3.0 + slip;
        let error = Immersion::new(plant(), &[antiderivative], following, vec![1.0], vec![0.0]).unwrap_err();
        assert!(
            matches!(error, ChainError::AntiderivativeNotShown { .. } | ChainError::Antiderivative { .. }),
            "{error}"
        );
    }
    // The estimate at the start is θ̂ + β, whatever β is there.
    let law = made(1.0 / 3.0).unwrap();
    let mut state = vec![0.0; total(&law.states())];
    let output = [0.8, -1.4];
    let given = || ControllerInput {
        measured: law.see(&output).unwrap(),
        heard: Heard::new(&[1.0], &[0.3], 1).unwrap(),
        target: Jets::NONE,
    };
    law.start(&mut law.scratch(), given(), &[], &mut state).unwrap();
    let (mut input, mut d_state, mut shown) = ([0.0], vec![0.0; state.len()], vec![0.0; total(&law.shown())]);
    let asked = ControllerOutput { input: &mut input, d_state: &mut d_state, shown: &mut shown };
    law.evaluate(&mut law.scratch(), given(), &state, asked).unwrap();
    assert!(shown.last().unwrap().abs() < 1e-15, "{shown:?}");
}

fn wheels(torque_limit_n_m: Option<f64>, momentum_limit_n_m_s: Option<f64>) -> Wheels {
    let wheel = |axis| Wheel { axis, torque_limit_n_m, momentum_limit_n_m_s };
    Wheels::new(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(wheel)).unwrap()
}

const INERTIA: [[f64; 3]; 3] = [[10.0, 0.5, 0.0], [0.5, 8.0, 0.2], [0.0, 0.2, 6.0]];

#[test]
fn eq_94_a_full_wheel_takes_no_more_momentum_but_gives_it_back() {
    let limited = |enforced| {
        let craft = Spacecraft::new(INERTIA, wheels(Some(0.5), Some(2.0)), enforced).unwrap();
        let state = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, -2.5, 1.9];
        [[0.3; 3], [-0.3; 3], [0.9; 3]].map(|mut u| {
            craft.limit(&state, &mut u);
            u
        })
    };
    assert_eq!(limited(true), [[0.0, 0.3, 0.3], [-0.3, 0.0, -0.3], [0.0, 0.5, 0.5]]);
    assert_eq!(limited(false), [[0.3; 3], [-0.3; 3], [0.9; 3]]);
}

#[test]
fn thm7_the_filter_starts_such_that_it_stands_still() {
    let resolve = |gain: Gain| gain.resolve(4, &[]).unwrap();
    let law = AttitudeTracking {
        inertia: INERTIA,
        momentum_inertial: [0.1, -0.2, 0.3],
        wheels: wheels(None, None),
        alpha: [0.5, 1.2],
        filter: resolve(Gain::Diagonal(vec![1.0, 2.0, 0.5, 3.0])),
        damping: resolve(Gain::Number(3.0)),
    };
    let output = [0.2, -0.4, 0.1, 0.88, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let target = [[0.1, 0.0, 0.0, 0.0, 0.0], [0.0; 5], [0.0; 5], [1.0, 0.0, 0.0, 0.0, 0.0]];
    let given = || ControllerInput {
        measured: law.see(&output).unwrap(),
        heard: Heard::new(&[0.0], &[0.0; 4], 4).unwrap(),
        target: Jets::from(&target[..]),
    };
    let mut state = vec![0.0; total(&law.states())];
    law.start(&mut (), given(), &[], &mut state).unwrap();
    let (mut input, mut rate, mut shown) = ([0.0; 3], vec![1.0; state.len()], vec![0.0; total(&law.shown())]);
    let asked = ControllerOutput { input: &mut input, d_state: &mut rate, shown: &mut shown };
    law.evaluate(&mut (), given(), &state, asked).unwrap();
    assert!(rate[7..].iter().all(|dy| dy.abs() < 1e-14), "{rate:?}");
}

#[test]
fn thm6_an_estimate_beyond_its_margin_stands_and_never_turns_round() {
    let links = PlanarLinks::uniform([2.0, 1.0], [1.0, 0.8]);
    let number = |k: f64, n: usize| Gain::Number(k).resolve(n, &[]).unwrap();
    let rates = |start: [f64; 2], error: f64| {
        let law = TaskSpace {
            robot: PlanarArm,
            tip: PlanarTip { length_m: links.length_m },
            law: SlotineLi { damping: number(20.0, 2), adaptation: Some(number(30.0, 5)), bounds: None },
            task_gain: number(20.0, 2),
            kappa: 5.0,
            alpha: 3.0,
            kinematic_adaptation: Some(number(0.3, 2)),
            bounds: Some(ParameterBounds::new(vec![0.9, 0.7], vec![1.1, 0.9], 0.1)),
            estimate_start: vec![0.0; 5],
            kinematic_start: start.to_vec(),
            determinant_floor: 0.02,
            attitude_gain: 1.0,
            null_space: None,
        };
        let output = [0.3, 1.2, 0.7, -0.4, 0.5 + error, 0.6 + error];
        let target = [[0.5, 0.0, 0.0, 0.0, 0.0], [0.6, 0.0, 0.0, 0.0, 0.0]];
        let given = ControllerInput {
            measured: law.see(&output).unwrap(),
            heard: Heard::new(&[0.0], &[0.0; 2], 2).unwrap(),
            target: Jets::from(&target[..]),
        };
        let mut state = vec![0.0; total(&law.states())];
        law.start(&mut law.scratch(), given, &[], &mut state).unwrap();
        let (mut input, mut rate, mut shown) = ([0.0; 2], vec![0.0; state.len()], vec![0.0; total(&law.shown())]);
        let asked = ControllerOutput { input: &mut input, d_state: &mut rate, shown: &mut shown };
        law.evaluate(&mut law.scratch(), given, &state, asked).unwrap();
        [rate[7], rate[8]]
    };
    for error in [0.1, -0.1] {
        let free = rates([1.0, 0.8], error);
        // Beyond either bound by half the margin, by all of it, and by far more: outwards nothing is left, inwards all is.
        for k in 0..2 {
            for (side, bound) in [(1.0, [1.1, 0.9][k]), (-1.0, [0.9, 0.7][k])] {
                for (beyond, left) in [(0.0, 1.0), (0.05, 0.5), (0.1, 0.0), (0.35, 0.0)] {
                    let mut start = [1.0, 0.8];
                    start[k] = bound + side * beyond;
                    let outwards = free[k] * side > 0.0;
                    let want = if outwards { left * free[k] } else { free[k] };
                    let got = rates(start, error)[k];
                    assert!((got - want).abs() < 1e-12, "{k} {side} {beyond}: {got} is not {want}");
                }
            }
        }
    }
}

#[test]
fn eq_45_a_thrust_that_is_kept_above_a_floor_is_trouble_only_where_it_is_none() {
    let mut law = Thrust::new(ThrustDesign::Continuous, [1.0, 0.7], 1.3, 9.81).unwrap();
    let transmitted = |law: &Thrust, sigma: f64| law.trouble(&[sigma, 0.0], &[]).is_some();
    law.floor = Floor::Stops(2.0);
    assert_eq!([2.1, 2.0, 1.0, -1.0].map(|sigma| transmitted(&law, sigma)), [false, true, true, true]);
    // It may start below its floor, and is led up to it.
    law.floor = Floor::Kept { floor: 2.0, approach_s: 0.1 };
    assert_eq!([2.1, 1.0, 1e-3, 0.0, -1.0].map(|sigma| transmitted(&law, sigma)), [false, false, false, true, true]);
    let Some(Singularity::Vanishes { value, floor, .. }) = law.trouble(&[-1.0, 0.0], &[]) else { panic!() };
    assert_eq!((value, floor), (-1.0, 0.0));
}

#[test]
fn eq_119_a_sampled_agent_solves_its_sign_for_the_period_that_passed() {
    let (h, degree) = (0.02, 1.5);
    let mut agent = sampled_follower(Derived::ReferenceAcceleration);
    // What is heard is close to its own state, so that the sign is not at its ends.
    let at = |k: f64| ([0.3 + 1e-3 * k], [0.05]);
    let mut seen = 0;
    for k in 0..6 {
        let (q, dq) = at(f64::from(k));
        let sums = [degree * 0.3, degree * 0.05, degree * agent.transmitted()[0]];
        let inbox = Inbox { degree, sums: &sums };
        agent.step(h * f64::from(k), Measured { q: &q, dq: &dq }, inbox).unwrap();
        let transmitted = [agent.transmitted()[0]];
        let own = [&q[..], &dq, &transmitted];
        let sums = [&sums[..1], &sums[1..2], &sums[2..]];
        let mut e = [0.0];
        let sign = Sliding { derived: Derived::ReferenceAcceleration, ..SIGN };
        sign.argument(1, SlidingInputs { own, degree: &[degree], sums }, &mut e).unwrap();
        let selection = *agent.reference_state().last().unwrap();
        if k > 0 {
            assert!((selection - sign.alone(e[0], degree, h)).abs() < 1e-12, "{selection} at sample {k}, e = {e:?}");
            seen += usize::from(selection.abs() < 1.0 && selection != 0.0);
        }
    }
    assert!(seen > 2, "signs between their ends: {seen}");
}

#[test]
fn a_factor_of_a_chain_in_feedback_form_is_the_one_that_is_watched() {
    let x = Expression::variable;
    let known = vec![x(1) + x(1).power(3.0) * 0.2, Expression::number(0.0)];
    let terms = CascadeTerms::new(known, vec![vec![x(0)], vec![x(0)]], Expression::number(1.0)).unwrap();
    let guide = ReferenceModel::Consensus(Consensus::<Position>::new([(&[1.0, 2.0][..], 0.0)]).unwrap());
    let gains = BacksteppingGains { gains_per_s: vec![1.0; 2], adaptation: vec![0.5], floor: 0.1 };
    let law = AdaptiveBackstepping::new(&terms, guide, gains, vec![0.0]).unwrap();
    let blocks = law.shown();
    let at = total(&blocks[..blocks.iter().position(|(signal, _)| *signal == Signal::Divisor).unwrap()]);
    let state = vec![0.0; total(&law.states())];
    for k in 0..total(&blocks) {
        let mut shown = vec![1.0; total(&blocks)];
        shown[k] = 0.05;
        assert_eq!(law.trouble(&state, &shown).is_some(), k == at, "entry {k}");
    }
}

#[test]
fn thm7_a_sampled_reference_attitude_stays_one() {
    let resolve = |gain: Gain| gain.resolve(4, &[]).unwrap();
    let law = AttitudeTracking {
        inertia: INERTIA,
        momentum_inertial: [0.0; 3],
        wheels: wheels(None, None),
        alpha: [0.5, 1.2],
        filter: resolve(Gain::Number(1.0)),
        damping: resolve(Gain::Number(3.0)),
    };
    let plant = Spacecraft::new(INERTIA, wheels(None, None), false).unwrap();
    let mut start = vec![0.0; total(&law.states())];
    // It turns fast, and steps are long.
    start[..3].copy_from_slice(&[2.0, -1.0, 1.5]);
    start[6] = 1.0;
    let mut stepped = Stepped::new(law, &plant, 4, &start).unwrap();
    let output = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let target = [[0.0; 5], [0.0; 5], [0.0; 5], [1.0, 0.0, 0.0, 0.0, 0.0]];
    for k in 0..5 {
        let inbox = Inbox { degree: 0.0, sums: &[0.0; 4] };
        stepped.step(0.4 * f64::from(k), &output, inbox, Jets::from(&target)).unwrap();
        let norm: f64 = stepped.state()[3..7].iter().map(|q| q * q).sum();
        assert!((norm - 1.0).abs() < 1e-14, "{norm}");
    }
}
