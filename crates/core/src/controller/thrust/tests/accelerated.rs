//! The law by a measured acceleration.

use super::*;
use crate::plant::AcceleratedVehicle;

const ALPHA_STAR: f64 = 2.0;
/// Where σ stands in the state of the plant.
const SIGMA: usize = 10;
/// Where z, ż and m̂ less m̂(0) stand behind it.
const Z: usize = 11;
const LEARNT: usize = Z + 7;

fn accelerated(bias: [f64; 3]) -> Closed<ThrustByAcceleration> {
    let mut law = ThrustByAcceleration::new([ALPHA_STAR, 0.4], &ROOTS[..2], 0.8 * MASS, G).unwrap();
    law.yaw = Yaw { heading: 0.3, rate: 0.2, gain: 1.5 };
    let plant = AcceleratedVehicle { vehicle: Vehicle { mass: MASS, gravity: G }, bias };
    Closed { plant, law, moves: true }
}

/// As the [`states`] of the others, with the thrust in the plant.
fn flying(closed: &Closed<ThrustByAcceleration>) -> impl Iterator<Item = Vec<f64>> + '_ {
    states(closed, 0).enumerate().map(|(n, mut y)| {
        y[Z] = 0.1 * f64::from(n as u32) - 3.0;
        y[SIGMA] = 9.0 + 4.0 * y[SIGMA];
        y
    })
}

#[test]
fn own_lyapunov_identity_with_and_without_offset_bias_and_bounds() {
    let range = Range { lower: 0.9 * MASS, upper: 1.1 * MASS };
    for (moves, bias, bounds) in [
        (false, [0.0; 3], None),
        (true, [0.0; 3], None),
        (true, [0.0; 3], Some(range)),
        (false, [0.2, -0.1, 0.3], None),
        (true, [0.2, -0.1, 0.3], Some(range)),
    ] {
        let mut closed = Closed { moves, ..accelerated(bias) };
        closed.law.bounds = bounds;
        let mut passed = 0;
        for y in flying(&closed) {
            let now = closed.at(0.3, &y);
            // V has no second derivative where an estimate passes a bound.
            let close = |end: f64| (0.8 * MASS + y[LEARNT] - end).abs() < 2e-4 * now.rate[LEARNT].abs();
            if bounds.is_some_and(|range| close(range.lower) || close(range.upper)) {
                continue;
            }
            let [slope] = closed.derivative(0.3, &y, |t, y| [closed.at(t, y).balance.value]);
            near(slope, -now.balance.dissipation, 10.0 * (now.balance.value + now.balance.dissipation.abs()), "V");
            assert!(now.balance.value > 0.0 && (bias != [0.0; 3] || now.balance.dissipation >= 0.0));
            let (mass, mu) = (now.shown[9], 0.8 * MASS + y[LEARNT]);
            assert_eq!(mass, bounds.map_or(mu, |range| range.nearest(mu)));
            passed += usize::from(mass != mu);
        }
        assert_eq!(passed > 10, bounds.is_some(), "{passed} estimates beyond a bound");
    }
}

#[test]
fn eq_57_and_eq_24_of_order_two_are_their_literal_forms() {
    for moves in [false, true] {
        let closed = Closed { moves, ..accelerated([0.0; 3]) };
        let (alpha, beta) = (ROOTS[0], ROOTS[1]);
        for y in flying(&closed) {
            let (now, jets) = (closed.at(0.3, &y), offset(0.3));
            let d = |k: usize, r: usize| if moves { jets[k][r] } else { 0.0 };
            let d_error = |t: f64, y: &[f64]| -> [f64; 3] {
                let (ddx, jets) = (closed.at(t, y).rate, offset(t));
                core::array::from_fn(|k| ddx[3 + k] - y[Z + 3 + k] - if moves { jets[k][2] } else { 0.0 })
            };
            let (dds, ds) = (closed.derivative(0.3, &y, d_error), d_error(0.3, &y));
            let mut learns = 0.0;
            for k in 0..3 {
                let (x, dx, dz) = (y[k] - d(k, 0), y[3 + k] - d(k, 1), y[Z + 3 + k]);
                let pair = alpha * beta;
                let own = (alpha + beta) * dz + pair * dx;
                let ddz = -own - DEGREE * (dz + (alpha + beta) * dx + pair * x) + pair * SUMS[k];
                near(now.rate[Z + 3 + k], ddz, 50.0, "(24) of order two");
                let falls = if k == 2 { ALPHA_STAR * G } else { 0.0 };
                let w = ddz + d(k, 3) + ALPHA_STAR * (dz + d(k, 2)) - falls;
                let wrong = now.shown[9] - MASS;
                near(MASS * dds[k], -ALPHA_STAR * MASS * ds[k] + wrong * w, 300.0, "m s̈");
                near(now.shown[6 + k], dx - y[Z + k], 1.0, "s");
                assert_eq!(now.shown[10 + k], now.rate[3 + k]);
                learns -= 0.4 * w * ds[k];
            }
            near(now.rate[LEARNT], learns, learns, "m̂'");
            assert_eq!(now.shown[13], y[SIGMA]);
        }
    }
}

/// Beside neighbours that stand still a bias of the accelerometer leaves a mass and a height that are wrong by what the head of the file
/// says; without it neither is.
#[test]
fn own_a_bias_is_taken_for_a_mass_and_lifts_the_vehicle() {
    for bias in [0.0, 0.3, -0.2] {
        let closed = Closed { moves: false, ..accelerated([0.0, 0.0, bias]) };
        let place = SUMS.map(|sum| sum / DEGREE);
        let mut y = closed.started(&[place[0], place[1], place[2], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, MASS * G]);
        for n in 0..20_000_i32 {
            closed.step(f64::from(n) * 4e-3, 4e-3, &mut y);
        }
        let now = closed.at(80.0, &y);
        let (alpha, beta) = (ROOTS[0], ROOTS[1]);
        // ẋ = 0 and z̈ = 0 with ż = e leave 0 = −(α+β) e − d [e + αβ (x − x_j)].
        let height = place[2] - bias * ((alpha + beta) / DEGREE + 1.0) / (alpha * beta);
        assert!((now.shown[9] - MASS * G / (G - bias)).abs() < 1e-6, "{} at a bias of {bias}", now.shown[9]);
        assert!((y[2] - height).abs() < 1e-5, "{} against {height}", y[2]);
        assert!((y[Z + 5] - bias).abs() < 1e-6 && (0..2).all(|k| (y[k] - place[k]).abs() < 1e-6));
    }
}

#[test]
fn own_thrust_near_zero_is_trouble_or_kept_away_and_wrong_lengths_are_errors() {
    let mut closed = accelerated([0.0; 3]);
    let mut y = closed.started(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.4]);
    let floor = closed.law.floor.newtons();
    assert!((floor - 0.08 * MASS * G).abs() < 1e-12);
    let trouble =
        |closed: &Closed<ThrustByAcceleration>, y: &[f64]| closed.law.trouble(&y[Z..], &closed.at(0.0, y).shown);
    let seen = Some(Singularity::Vanishes { signal: Signal::Thrust, axis: 0, value: 0.4, floor });
    assert_eq!(trouble(&closed, &y), seen);
    y[SIGMA] = 2.0 * floor;
    assert_eq!(trouble(&closed, &y), None);
    // It wants to fall: the neighbours are far below.
    y[2] = -400.0;
    assert!(closed.at(0.0, &y).rate[SIGMA] < -20.0);
    closed.law.floor = Floor::Kept { floor, approach_s: 0.1 };
    assert!((closed.at(0.0, &y).rate[SIGMA] + floor / 0.1).abs() < 1e-12);
    y[SIGMA] = f64::NAN;
    assert!(trouble(&closed, &y).is_some());

    assert!(ThrustByAcceleration::new([1.0, 1.0], ROOTS, 1.0, G).is_err());
    assert!(closed.law.see(&[0.0; 13]).is_err() && closed.law.see(&[0.0; 15]).is_err());
    let output = [1.0; 14];
    let heard = Heard::new(&[0.0], &[0.0; 3], 3).unwrap();
    let given = ControllerInput { measured: closed.law.see(&output).unwrap(), heard, target: Jets::NONE };
    let mut state = [0.0; 8];
    assert!(closed.law.start(&mut (), given, &[], &mut state[1..]).is_err());
    assert!(closed.law.start(&mut (), given, &[vec![0.0; 2]], &mut state).is_err());
    closed.law.start(&mut (), given, &[vec![0.5; 3], vec![0.25; 3]], &mut state).unwrap();
    assert_eq!(state, [0.5, 0.5, 0.5, 0.25, 0.25, 0.25, 0.3, 0.0]);
    for [inputs, rates, shown] in [[3, 8, 14], [4, 7, 14], [4, 8, 13]] {
        let (mut input, mut d_state, mut shown) = (vec![0.0; inputs], vec![0.0; rates], vec![0.0; shown]);
        let asked = ControllerOutput { input: &mut input, d_state: &mut d_state, shown: &mut shown };
        assert!(closed.law.evaluate(&mut (), given, &state, asked).is_err());
    }
}
