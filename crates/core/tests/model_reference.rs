//! A mass by a model and a high gain in the place of (a8) and (a9): what V loses, and where its error goes.

use crate::common::looped::{Looped, polynomial};
use crate::common::random::Random;
use forwardstep_core::controller::{Controller, ControllerInput, ControllerOutput, Jet, Jets, ModelReference};
use forwardstep_core::plant::Mechanical;
use forwardstep_core::reference::Heard;
use forwardstep_core::robot::PointMass;

fn plant(dimension: usize, mass: f64) -> Mechanical<PointMass> {
    Mechanical { robot: PointMass { dimension }, theta: vec![mass] }
}

/// V̇ as the head of the law derives it, at states that no run would reach, pushed or not, for any mass, model and number of axes.
#[test]
fn prop_v_of_model_reference_control_loses_what_is_derived() {
    let mut random = Random::new(21);
    let mut sizes = [false; 3];
    for index in 0..90 {
        let axes = 1 + index % 3;
        let positive = |random: &mut Random, scale: f64| scale * (1.1 + random.number());
        let mass = positive(&mut random, 2.0);
        let law = ModelReference {
            axes,
            alpha: [positive(&mut random, 3.0), positive(&mut random, 2.0)],
            filter_per_s: positive(&mut random, 5.0),
            // A mass that is known needs no estimate.
            adaptation: if index % 5 == 0 { 0.0 } else { positive(&mut random, 4.0) },
            estimate_start: 0.0,
        };
        let still = law.adaptation == 0.0;
        let path: Vec<Jet> = (0..axes).map(|_| random.column(5, 1.0).try_into().unwrap()).collect();
        let mut system =
            Looped::new(plant(axes, mass), law, |t| path.iter().map(|jet| polynomial(jet, t)).collect::<Vec<_>>());
        let mut x = random.column(5 * axes, 1.0);
        x.push(if still { mass } else { 2.0 * random.number() });
        if index % 2 == 0 {
            system.external = random.column(axes, 1.0);
        }
        let balance = system.balance(0.0, &x);
        let slope = system.slope(0.0, &x, |system, t, x| system.balance(t, x).value);
        let size = 1.0 + balance.value + balance.dissipation.abs();
        assert!((slope + balance.dissipation).abs() < 1e-7 * size, "{slope} against {}", -balance.dissipation);
        assert!(balance.value >= 0.0);
        if system.external.is_empty() {
            assert!(balance.dissipation >= 0.0, "V falls: {}", balance.dissipation);
            sizes[axes - 1] = true;
        }
    }
    assert_eq!(sizes, [true; 3]);
}

/// From any start, also one that moves, behind a target that swings, with a mass that was thought to be none.
#[test]
fn model_reference_control_reaches_a_target_that_swings() {
    let target = |t: f64| -> Vec<Jet> {
        let wave = |rate: f64, phase: f64| -> Jet {
            core::array::from_fn(|k| {
                rate.powi(k as i32) * (rate * t + phase + core::f64::consts::FRAC_PI_2 * k as f64).sin()
            })
        };
        vec![wave(0.7, 0.0), wave(1.1, 1.0)]
    };
    let law = ModelReference { axes: 2, alpha: [2.0, 3.0], filter_per_s: 10.0, adaptation: 10.0, estimate_start: 0.0 };
    let mut system = Looped::new(plant(2, 2.5), law, target);
    let mut x = system.start(&[1.0, -0.5, 0.4, -0.3], &[]);
    assert_eq!(x[4..], [1.0, -0.5, 0.0, 0.0, 0.0, 0.0, 0.0], "y, η and φ are zero");
    let h = 0.01;
    for step in 0..6000 {
        system.step(f64::from(step) * h, h, &mut x);
    }
    system.rate(60.0, &x);
    let [y0, y1, m_hat, e0, e1] = system.shown[..] else { panic!() };
    assert!(e0.abs() < 1e-4 && e1.abs() < 1e-4, "{e0} and {e1}");
    // What swings tells the mass, and δ, which the start gave a value, has vanished.
    assert!((m_hat - 2.5).abs() < 1e-3, "{m_hat}");
    let delta = [x[6] - 2.5 * (x[2] - y0), x[7] - 2.5 * (x[3] - y1)];
    assert!(delta.iter().all(|delta| delta.abs() < 1e-9), "{delta:?}");
}

/// Remark 7 calls its gain nonlinear: it goes with the square of what the target's acceleration makes of φ.
#[test]
fn the_gain_on_the_error_grows_with_the_square_of_phi() {
    let law = ModelReference { axes: 1, alpha: [2.0, 3.0], filter_per_s: 10.0, adaptation: 4.0, estimate_start: 1.0 };
    let gain = |phi: f64| {
        let input = |x: f64| {
            let output = [x, 0.0];
            let given = ControllerInput {
                measured: law.see(&output).unwrap(),
                heard: Heard::new(&[0.0], &[0.0], 1).unwrap(),
                target: Jets::from(&[[0.0; 5]]),
            };
            let (mut input, mut d_state, mut shown) = ([0.0], [0.0; 4], [0.0; 3]);
            let asked = ControllerOutput { input: &mut input, d_state: &mut d_state, shown: &mut shown };
            law.evaluate(&mut (), given, &[x, 0.0, phi, 1.0], asked).unwrap();
            input[0]
        };
        input(1.0) - input(0.0)
    };
    // p = 6/13, as an explanation of the same model has it too.
    let given = ControllerInput {
        measured: law.see(&[0.0; 2]).unwrap(),
        heard: Heard::new(&[0.0], &[0.0], 1).unwrap(),
        target: Jets::from(&[[0.0; 5]]),
    };
    let mut d_state = [0.0; 4];
    let asked = ControllerOutput { input: &mut [0.0], d_state: &mut d_state, shown: &mut [0.0; 3] };
    law.evaluate(&mut (), given, &[0.0, 0.0, 13.0, 1.0], asked).unwrap();
    assert!((d_state[2] + 6.0).abs() < 1e-12);
    assert!((gain(0.0) + 2.0).abs() < 1e-12, "α₀ m̂ alone");
    assert!((gain(3.0) - gain(0.0) + 4.0 * 9.0).abs() < 1e-12 && (gain(6.0) - gain(0.0) + 4.0 * 36.0).abs() < 1e-12);
}

#[test]
fn model_reference_control_refuses_wrong_lengths() {
    let law = ModelReference { axes: 2, alpha: [2.0, 3.0], filter_per_s: 10.0, adaptation: 4.0, estimate_start: 1.0 };
    assert!(law.see(&[0.0; 3]).is_err());
    let rests = [[0.0; 5]; 2];
    let given = |target: &'static [Jet]| ControllerInput {
        measured: law.see(&[0.0; 4]).unwrap(),
        heard: Heard::new(&[0.0], &[0.0; 2], 2).unwrap(),
        target: Jets::from(target),
    };
    let rests: &'static [Jet; 2] = Box::leak(Box::new(rests));
    let refused = |target, [state, rate, input, shown]: [usize; 4]| {
        let (mut d_state, mut u, mut transmitted) = (vec![0.0; rate], vec![0.0; input], vec![0.0; shown]);
        let asked = ControllerOutput { input: &mut u, d_state: &mut d_state, shown: &mut transmitted };
        law.evaluate(&mut (), given(target), &vec![0.0; state], asked).is_err()
    };
    assert!(!refused(rests, [7, 7, 2, 5]));
    for wrong in [[6, 7, 2, 5], [7, 8, 2, 5], [7, 7, 1, 5], [7, 7, 2, 4]] {
        assert!(refused(rests, wrong), "{wrong:?}");
    }
    assert!(refused(&rests[..1], [7, 7, 2, 5]));
    assert!(law.start(&mut (), given(rests), &[], &mut [0.0; 6]).is_err());
}
