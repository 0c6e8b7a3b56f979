//! A filter of the attitude error in the place of Theorem 7: what V loses, and the term that wheels leave.

use crate::common::looped::{Looped, polynomial};
use crate::common::random::Random;
use forwardstep_core::attitude::{Desired, cross, difference, dot, normalized, rate, rotate_back, times};
use forwardstep_core::controller::{Jet, PassivityFilter};
use forwardstep_core::plant::{Spacecraft, Wheel, Wheels};
use forwardstep_core::{Gain, LengthError};

const INERTIA: [[f64; 3]; 3] = [[10.0, 0.5, -0.3], [0.5, 8.0, 0.2], [-0.3, 0.2, 6.0]];

fn pyramid() -> Wheels {
    let wheel = |axis| Wheel { axis, torque_limit_n_m: None, momentum_limit_n_m_s: None };
    Wheels::new(&[[1.0, 0.0, 0.8], [-1.0, 0.0, 0.8], [0.0, 1.0, 0.8], [0.0, -1.0, 0.8]].map(wheel)).unwrap()
}

fn symmetric(random: &mut Random) -> Gain {
    let factor = random.column(16, 1.0);
    let mut entries = vec![0.0; 16];
    for row in 0..4 {
        for column in 0..4 {
            entries[4 * row + column] = (0..4).map(|k| factor[4 * row + k] * factor[4 * column + k]).sum();
        }
        entries[5 * row] += 0.5;
    }
    Gain::Matrix(entries)
}

fn law(plant: &Spacecraft, state: &[f64], [filter, damping]: [&Gain; 2]) -> PassivityFilter {
    PassivityFilter {
        inertia: *plant.inertia(),
        momentum_inertial: plant.momentum_inertial(state).unwrap(),
        wheels: plant.wheels().clone(),
        error_gain: 2.5,
        filter: filter.resolve(4, &[]).unwrap(),
        damping: damping.resolve(4, &[]).unwrap(),
    }
}

fn random_state(random: &mut Random) -> Vec<f64> {
    let q: [f64; 4] = random.column(4, 1.0).try_into().unwrap();
    [normalized(q).to_vec(), random.column(7, 1.0)].concat()
}

fn off(q: [f64; 4], omega: [f64; 3], desired: &Desired) -> ([f64; 3], [f64; 3]) {
    let omega_d = rotate_back(q, desired.omega);
    (omega_d, core::array::from_fn(|k| omega[k] - omega_d[k]))
}

/// V̇ as the head of the law derives it, with its term without a sign, at states that no run would reach, pushed or not; and that term is
/// all that wheels leave.
#[test]
fn prop_a_passivity_filter_beside_wheels_loses_and_gains_what_is_derived() {
    let mut random = Random::new(11);
    let mut signs = [false; 2];
    for index in 0..60 {
        let plant = Spacecraft::new(INERTIA, pyramid(), false).unwrap();
        let mut x = random_state(&mut random);
        let gains = [symmetric(&mut random), symmetric(&mut random)];
        let law = law(&plant, &x, [&gains[0], &gains[1]]);
        let filter = law.filter.clone();
        let path: [Jet; 4] = core::array::from_fn(|_| random.column(5, 1.0).try_into().unwrap());
        let mut system = Looped::new(plant, law, |t| path.iter().map(|jet| polynomial(jet, t)).collect());
        x.extend(random.column(4, 1.0));
        if index % 3 == 0 {
            // A torque from outside has moved h away from what the law takes it for.
            system.external = random.column(3, 1.0);
            x[4] += 0.3;
        }
        let balance = system.balance(0.0, &x);
        let slope = system.slope(0.0, &x, |system, t, x| system.balance(t, x).value);
        let size = 1.0 + balance.value + balance.dissipation.abs();
        assert!((slope + balance.dissipation).abs() < 1e-7 * size, "{slope} against {}", -balance.dissipation);

        let dx = system.rate(0.0, &x);
        let (q, omega): ([f64; 4], [f64; 3]) = (x[..4].try_into().unwrap(), x[4..7].try_into().unwrap());
        let desired = Desired::from_path(&path);
        let (omega_d, delta) = off(q, omega, &desired);
        let left = dot(times(&INERTIA, delta), cross(delta, omega_d));
        if system.external.is_empty() {
            let dy: [f64; 4] = dx[11..].try_into().unwrap();
            let mut lost = [0.0; 4];
            filter.apply(&dy, &mut lost);
            assert!((balance.dissipation - dot(dy, lost) + left).abs() < 1e-12 * size);
            signs[usize::from(left > 0.0)] = true;
        }
        // Δq̇ = D(Δq) Δω
        let at = |k: f64| {
            let h = 1e-5 * k;
            let q: [f64; 4] = core::array::from_fn(|i| x[i] + h * dx[i]);
            difference(q, Desired::from_path(&path.map(|jet| polynomial(&jet, h))).q)
        };
        let want = rate(difference(q, desired.q), delta);
        for k in 0..4 {
            let slope = (at(1.0)[k] - at(-1.0)[k]) / 2e-5;
            assert!((slope - want[k]).abs() < 1e-7 * (1.0 + dot(omega_d, omega_d)), "{slope} {}", want[k]);
        }
    }
    assert_eq!(signs, [true; 2]);
}

/// The term is zero where the target keeps still and where moments of inertia are equal, and there alone for every Δω.
#[test]
fn prop_the_term_without_a_sign_vanishes_at_rest_and_for_equal_moments_of_inertia() {
    let mut random = Random::new(12);
    let equal = core::array::from_fn(|row| core::array::from_fn(|column| if row == column { 7.0 } else { 0.0 }));
    for _ in 0..30 {
        let [omega_d, delta]: [[f64; 3]; 2] = [random.vector(1.0), random.vector(1.0)];
        let term = |inertia: &[[f64; 3]; 3], omega_d| dot(times(inertia, delta), cross(delta, omega_d));
        assert_eq!(term(&INERTIA, [0.0; 3]), 0.0);
        assert!(term(&equal, omega_d).abs() < 1e-14);
        assert!(term(&INERTIA, omega_d).abs() > 1e-9);
        // A rigid body under thrusters, M ω̇ = −S(ω) M ω + τ with S(ω_d) M ω_d in τ: what the error meets does no work.
        let omega: [f64; 3] = core::array::from_fn(|k| omega_d[k] + delta[k]);
        let spun = |v: [f64; 3]| cross(v, times(&INERTIA, v));
        let (own, fed) = (spun(omega), spun(omega_d));
        let pulled = times(&INERTIA, cross(delta, omega_d));
        let work = dot(delta, core::array::from_fn(|k| fed[k] - own[k] + pulled[k]));
        assert!(work.abs() < 1e-13, "{work}");
    }
}

#[test]
fn a_passivity_filter_starts_such_that_it_stands_still_and_refuses_wrong_lengths() {
    let plant = Spacecraft::new(INERTIA, pyramid(), false).unwrap();
    let own = [0.2, -0.4, 0.1, 0.88, 0.1, 0.2, 0.3, 0.0, 0.0, 0.0, 0.0];
    let gains = [Gain::Diagonal(vec![1.0, 2.0, 0.5, 3.0]), Gain::Number(3.0)];
    let still = |_: f64| -> Vec<Jet> { [0.1, 0.0, 0.0, 1.0].map(|p| [p, 0.0, 0.0, 0.0, 0.0]).to_vec() };
    let mut system = Looped::new(plant.clone(), law(&plant, &own, [&gains[0], &gains[1]]), still);
    let x = system.start(&own, &[]);
    let dx = system.rate(0.0, &x);
    assert!(dx[11..].iter().all(|dy| dy.abs() < 1e-14), "{dx:?}");
    use forwardstep_core::controller::Controller;
    let short: Result<_, LengthError> = system.controller.see(&own[..9]);
    assert!(short.is_err());
}

/// A spin of the target about the axis of its middle moment of inertia, at which the linearised error grows under wheels without bias; and the same
/// start beside a target that keeps still.
#[test]
fn a_passivity_filter_reaches_what_keeps_still_and_may_lose_what_turns() {
    let inertia = [[30.0, 0.0, 0.0], [0.0, 16.0, 0.0], [0.0, 0.0, 8.0]];
    let ends = |spin: f64| {
        let target = move |t: f64| -> Vec<Jet> {
            let wave = |phase: f64| -> Jet {
                core::array::from_fn(|k| {
                    let turn = core::f64::consts::FRAC_PI_2 * k as f64;
                    (0.5 * spin).powi(k as i32) * (0.5 * spin * t + phase + turn).sin()
                })
            };
            vec![[0.0; 5], wave(0.0), [0.0; 5], wave(core::f64::consts::FRAC_PI_2)]
        };
        let plant = Spacecraft::new(inertia, pyramid(), false).unwrap();
        let own = [0.05, 0.0, 0.05, 1.0, 0.0, spin, 0.0, 0.0, 0.0, 0.0, 0.0];
        let mut own = own.to_vec();
        let unit = normalized(own[..4].try_into().unwrap());
        own[..4].copy_from_slice(&unit);
        let gains = [Gain::Number(1.0), Gain::Number(3.0)];
        let mut system = Looped::new(
            plant.clone(),
            PassivityFilter { error_gain: 4.0, ..law(&plant, &own, [&gains[0], &gains[1]]) },
            target,
        );
        let mut x = system.start(&own, &[]);
        let (h, mut most) = (0.02, 0.0_f64);
        for step in 0..10_000 {
            system.step(f64::from(step) * h, h, &mut x);
            most = most.max(system.shown[3]);
        }
        (system.shown[3], most)
    };
    let (still, _) = ends(0.0);
    assert!(still < 0.01, "{still}");
    let (_, turning) = ends(0.5);
    assert!(turning > 1.0, "{turning}");
}
