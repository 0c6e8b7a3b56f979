//! (94)–(107): a spacecraft with reaction wheels, and its attitude without angular velocity.

use crate::common::looped::{Looped, polynomial};
use crate::common::random::Random;
use forwardstep_core::attitude::{
    Desired, angle, cross, difference, dot, normalized, product, rate, rate_inertial, rotate, rotate_back, times,
};
use forwardstep_core::controller::{AttitudeTracking, Jet};
use forwardstep_core::plant::{Plant, Spacecraft, SpacecraftError, Wheel, Wheels};
use forwardstep_core::{Gain, GainError};

const INERTIA: [[f64; 3]; 3] = [[10.0, 0.5, -0.3], [0.5, 8.0, 0.2], [-0.3, 0.2, 6.0]];

fn pyramid() -> Wheels {
    let wheel = |axis| Wheel { axis, torque_limit_n_m: Some(0.4), momentum_limit_n_m_s: Some(5.0) };
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

fn controller(plant: &Spacecraft, state: &[f64], filter: &Gain, damping: &Gain) -> AttitudeTracking {
    AttitudeTracking {
        inertia: *plant.inertia(),
        momentum_inertial: plant.momentum_inertial(state).unwrap(),
        wheels: plant.wheels().clone(),
        alpha: [0.6, 1.1],
        filter: filter.resolve(4, &[]).unwrap(),
        damping: damping.resolve(4, &[]).unwrap(),
    }
}

fn random_quaternion(random: &mut Random) -> [f64; 4] {
    normalized(random.column(4, 1.0).try_into().unwrap())
}

fn difference_of<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn prop_quaternions_turn_vectors_and_move_as_the_paper_says() {
    let mut random = Random::new(1);
    for _ in 0..50 {
        let (a, b) = (random_quaternion(&mut random), random_quaternion(&mut random));
        let (v, omega) = (random.vector(1.0), random.vector(1.0));
        assert!(difference_of(rotate(product(a, b), v), rotate(a, rotate(b, v))) < 1e-14);
        assert!(difference_of(rotate_back(a, rotate(a, v)), v) < 1e-14);
        // A norm that is off leaves the rotation alone.
        assert!(difference_of(rotate(a.map(|x| 3.0 * x), v), rotate(a, v)) < 1e-14);
        // R_bᵀ R_a
        assert!(difference_of(rotate(difference(a, b), v), rotate_back(b, rotate(a, v))) < 1e-14);
        // The two equations after (94), and the same motion in inertial coordinates, (104) and (105).
        let dq = rate(a, omega);
        let turn = cross([a[0], a[1], a[2]], omega);
        let want = [0, 1, 2].map(|k| 0.5 * (a[3] * omega[k] + turn[k]));
        assert!(difference_of([dq[0], dq[1], dq[2]], want) < 1e-15);
        assert!((dq[3] + 0.5 * dot([a[0], a[1], a[2]], omega)).abs() < 1e-15);
        assert!(difference_of(rate_inertial(a, rotate(a, omega)), dq) < 1e-15);
        // Ṙ v = R (ω × v), by differences.
        let h = 1e-5;
        let moved = |k: f64| rotate([0, 1, 2, 3].map(|i| a[i] + k * h * dq[i]), v);
        let slope: [f64; 3] = core::array::from_fn(|k| (moved(1.0)[k] - moved(-1.0)[k]) / (2.0 * h));
        assert!(difference_of(slope, rotate(a, cross(omega, v))) < 1e-9);
    }
    let half = (core::f64::consts::PI - 1e-3) / 2.0;
    assert!((angle([half.sin(), 0.0, 0.0, -half.cos()]) - (core::f64::consts::PI - 1e-3)).abs() < 1e-12);
}

/// ω_d^I and its derivative of a path that is no unit quaternion, against differences.
#[test]
fn prop_desired_attitude_is_consistent_with_its_derivatives() {
    let mut random = Random::new(2);
    for _ in 0..30 {
        let path: [Jet; 4] = core::array::from_fn(|_| random.column(5, 1.0).try_into().unwrap());
        let at = |t: f64| Desired::from_path(&path.map(|jet| polynomial(&jet, t)));
        let (h, now) = (1e-4, at(0.0));
        let slope = |of: &dyn Fn(&Desired) -> Vec<f64>| -> Vec<f64> {
            let (near, far) = (of(&at(h)), of(&at(-h)));
            near.iter().zip(far).map(|(a, b)| (a - b) / (2.0 * h)).collect()
        };
        let size = 1.0 + dot(now.omega, now.omega) + dot(now.d_omega, now.d_omega);
        let dq = slope(&|d| d.q.to_vec());
        assert!(difference_of(rate_inertial(now.q, now.omega), dq.try_into().unwrap()) < 1e-5 * size * size);
        let d_omega = slope(&|d| d.omega.to_vec());
        assert!(difference_of(now.d_omega, d_omega.try_into().unwrap()) < 1e-5 * size * size);
    }
}

/// R (M ω + A h_w) stays whatever the motors do: the sign of τ = −A u and of S(h) ω.
#[test]
fn eq_94_total_angular_momentum_is_conserved_in_the_inertial_frame() {
    let plant = Spacecraft::new(INERTIA, pyramid(), false).unwrap();
    let mut state = [0.1, -0.2, 0.3, 0.9, 0.4, -0.3, 0.2, 1.0, -0.5, 0.7, 0.2];
    plant.settle(&mut state);
    let before = plant.momentum_inertial(&state).unwrap();
    let torque = |t: f64| [0.3 * t.sin(), -0.2 * (2.0 * t).cos(), 0.1, 0.25 * (0.7 * t).sin()];
    let rate = |t: f64, x: &[f64; 11]| {
        let mut dx = [0.0; 11];
        plant.rate(&mut (), x, &torque(t), &[], &mut dx).unwrap();
        dx
    };
    let along = |x: &[f64; 11], k: &[f64; 11], h: f64| core::array::from_fn(|i| x[i] + h * k[i]);
    let h = 0.01;
    for step in 0..2000 {
        let t = f64::from(step) * h;
        let k1 = rate(t, &state);
        let k2 = rate(t + h / 2.0, &along(&state, &k1, h / 2.0));
        let k3 = rate(t + h / 2.0, &along(&state, &k2, h / 2.0));
        let k4 = rate(t + h, &along(&state, &k3, h));
        for i in 0..11 {
            state[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
        }
        plant.settle(&mut state);
    }
    let after = plant.momentum_inertial(&state).unwrap();
    assert!(difference_of(before, after) < 1e-8, "{before:?} became {after:?}");
    // It did turn.
    assert!(angle(difference(state[..4].try_into().unwrap(), [0.1, -0.2, 0.3, 0.9])) > 0.1);
}

/// −A u = τ for every τ, and no shorter u does it.
#[test]
fn eq_94_allocation_makes_the_torque_with_the_shortest_motor_torques() {
    let (wheels, mut random) = (pyramid(), Random::new(3));
    for _ in 0..20 {
        let tau = random.vector(1.0);
        let mut u = [0.0; 4];
        wheels.allocate(tau, &mut u);
        assert!(difference_of(wheels.sum(&u).map(|x| -x), tau) < 1e-14);
        // What makes no torque is orthogonal to u.
        let idle = [1.0, 1.0, -1.0, -1.0];
        assert!(difference_of(wheels.sum(&idle), [0.0; 3]) < 1e-14 && dot(u, idle).abs() < 1e-14);
    }
}

#[test]
fn prop_limits_act_only_when_they_are_enforced() {
    let state = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 5.0, -5.0, 0.0, 0.0];
    let asked = [1.0, 1.0, -1.0, 0.1];
    for (enforced, want) in [(false, asked), (true, [0.0, 0.4, -0.4, 0.1])] {
        let mut u = asked;
        Spacecraft::new(INERTIA, pyramid(), enforced).unwrap().limit(&state, &mut u);
        assert_eq!(u, want);
    }
}

#[test]
fn prop_what_is_no_spacecraft_is_refused() {
    let flat = |axis| Wheel { axis, torque_limit_n_m: None, momentum_limit_n_m_s: None };
    let in_a_plane = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]].map(flat);
    assert!(matches!(Wheels::new(&in_a_plane), Err(SpacecraftError::Rank { wheels: 3, .. })));
    assert!(matches!(Wheels::new(&[]), Err(SpacecraftError::Rank { wheels: 0, .. })));
    assert!(matches!(Wheels::new(&[flat([0.0; 3])]), Err(SpacecraftError::Axis { wheel: 0, .. })));
    let limited = Wheel { torque_limit_n_m: Some(-1.0), ..flat([1.0, 0.0, 0.0]) };
    assert!(matches!(Wheels::new(&[limited]), Err(SpacecraftError::Limit { wheel: 0, .. })));
    let lopsided = [[1.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let refused = Spacecraft::new(lopsided, Wheels::orthogonal(), false);
    assert!(matches!(refused, Err(SpacecraftError::Inertia(GainError::NotSymmetric { .. }))));
}

/// V̇ = −ẏᵀΛ_f ẏ, (106) and (107) with the signs of the derivation, at states that no run would reach.
#[test]
fn eq_107_and_thm7_v_falls_as_the_proof_says_at_random_states() {
    let mut random = Random::new(4);
    for _ in 0..30 {
        let plant = Spacecraft::new(INERTIA, pyramid(), false).unwrap();
        let mut own = random_quaternion(&mut random).to_vec();
        own.extend(random.column(7, 1.0));
        let (filter, damping) = (symmetric(&mut random), symmetric(&mut random));
        let law = controller(&plant, &own, &filter, &damping);
        let path: [Jet; 4] = core::array::from_fn(|_| random.column(5, 1.0).try_into().unwrap());
        let mut system = Looped::new(plant, law, |t| path.iter().map(|jet| polynomial(jet, t)).collect());
        let mut x = own.clone();
        x.extend(random.vector(1.0));
        x.extend(random_quaternion(&mut random));
        x.extend(random.column(4, 1.0));

        let balance = system.balance(0.0, &x);
        let slope = system.slope(0.0, &x, |system, t, x| system.balance(t, x).value);
        let size = 1.0 + balance.value + balance.dissipation;
        assert!((slope + balance.dissipation).abs() < 1e-7 * size, "{slope} against {}", -balance.dissipation);

        // (107): Δω̇ = ω̇ − ω̇_d against its right side.
        let dx = system.rate(0.0, &x);
        let desired = Desired::from_path(&path);
        let (q, omega, z): ([f64; 4], [f64; 3], [f64; 3]) =
            (x[..4].try_into().unwrap(), x[4..7].try_into().unwrap(), x[11..14].try_into().unwrap());
        let omega_d = rotate_back(q, desired.omega);
        let pulled = rotate_back(q, desired.d_omega);
        let turned = cross(omega, omega_d);
        let error = difference(q, desired.q);
        let s: [f64; 3] = core::array::from_fn(|k| omega[k] - z[k]);
        let coupled = cross(s, omega_d);
        for k in 0..3 {
            let left = dx[4 + k] - (pulled[k] - turned[k]);
            let right =
                -1.1 * (omega[k] - omega_d[k]) - 0.6 * error[k] + (dx[4 + k] - dx[11 + k]) + 1.1 * s[k] + coupled[k];
            assert!((left - right).abs() < 1e-12 * (1.0 + left.abs()));
        }
        // (106), and the second line of (107): M(ω̇ − ż) = +S(h)(ω − z) − DᵀK ẏ.
        let (apart, d_apart) = (difference(q, x[14..18].try_into().unwrap()), {
            let at = |x: &[f64]| difference(x[..4].try_into().unwrap(), x[14..18].try_into().unwrap());
            let h = 1e-5;
            let moved = |k: f64| at(&x.iter().zip(&dx).map(|(x, dx)| x + k * h * dx).collect::<Vec<_>>());
            let (near, far) = (moved(1.0), moved(-1.0));
            [0, 1, 2, 3].map(|k| (near[k] - far[k]) / (2.0 * h))
        });
        assert!(difference_of(d_apart, rate(apart, s)) < 1e-8);
        let h = rotate_back(q, system.controller.momentum_inertial);
        let acceleration: [f64; 3] = core::array::from_fn(|k| dx[4 + k] - dx[11 + k]);
        let net = times(&INERTIA, acceleration);
        let dy: [f64; 4] = system.shown[10..14].try_into().unwrap();
        let mut g = [0.0; 4];
        system.controller.damping.apply(&dy, &mut g);
        let turn = cross([apart[0], apart[1], apart[2]], [g[0], g[1], g[2]]);
        let gyro = cross(h, s);
        for k in 0..3 {
            let right = gyro[k] - 0.5 * (apart[3] * g[k] - turn[k] - apart[k] * g[3]);
            assert!((net[k] - right).abs() < 1e-11 * (1.0 + right.abs()), "{} {right}", net[k]);
        }
    }
}

/// 179.9° away and at rest, far in a spin, and towards a tumbling target: the error vanishes.
#[test]
fn thm7_attitude_is_reached_from_half_a_turn_away_without_angular_velocity() {
    let half = 179.9_f64.to_radians() / 2.0;
    let still = |t: f64| -> Vec<Jet> { [0.0, 0.0, 0.0, 1.0].map(|p| [p, 0.0 * t, 0.0, 0.0, 0.0]).to_vec() };
    let coning = |t: f64| -> Vec<Jet> {
        let wave = |size: f64, rate: f64, phase: f64| -> Jet {
            core::array::from_fn(|k| {
                let turn = core::f64::consts::FRAC_PI_2 * k as f64;
                size * rate.powi(k as i32) * (rate * t + phase + turn).sin()
            })
        };
        let (inner, outer) = (0.25, 0.05);
        let lead = core::f64::consts::FRAC_PI_2;
        vec![wave(0.4, outer, lead), wave(0.4, outer, 0.0), wave(1.6, inner, 0.0), wave(1.6, inner, lead)]
    };
    let targets: [&dyn Fn(f64) -> Vec<Jet>; 2] = [&still, &coning];
    for (index, target) in targets.into_iter().enumerate() {
        for omega in [[0.0; 3], [0.2, -0.1, 0.15]] {
            let plant = Spacecraft::new(INERTIA, pyramid(), false).unwrap();
            let axis = [1.0, 2.0, -1.0].map(|x| x / 6.0_f64.sqrt());
            let q = [axis[0] * half.sin(), axis[1] * half.sin(), axis[2] * half.sin(), half.cos()];
            let own = [&q[..], &omega, &[0.3, -0.2, 0.1, 0.4]].concat();
            let law = controller(&plant, &own, &Gain::Number(1.0), &Gain::Number(3.0));
            let mut system = Looped::new(plant, law, target);
            let mut x = system.start(&own, &[]);
            let start = system.balance(0.0, &x);
            assert!((start.value - 0.5 * dot(omega, times(&INERTIA, omega))).abs() < 1e-12);
            let (h, end) = (0.02, 100.0);
            let mut lost = 0.0;
            let mut t = 0.0;
            while t < end {
                let before = system.balance(t, &x).dissipation;
                let mut middle = x.clone();
                system.step(t, h / 2.0, &mut middle);
                let between = system.balance(t + h / 2.0, &middle).dissipation;
                system.step(t, h, &mut x);
                t += h;
                lost += h / 6.0 * (before + 4.0 * between + system.balance(t, &x).dissipation);
            }
            let last = system.balance(t, &x);
            assert!((last.value + lost - start.value).abs() < 1e-5 * (1e-3 + start.value), "{last:?} {lost} {start:?}");
            let angle = system.shown[9];
            assert!(angle < 1e-3, "target {index}, spin {omega:?}: {angle} rad left");
        }
    }
}
