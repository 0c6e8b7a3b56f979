//! Identities of the proofs, as algebra and along short runs.

mod accelerated;

use alloc::vec;
use alloc::vec::Vec;

use super::*;
use crate::Gain;
use crate::controller::{Controller, ControllerInput, ControllerOutput, Jet, Singularity, Truth};
use crate::plant::{Plant, Rotorcraft, total};

const MASS: f64 = 1.3;
const G: f64 = 9.81;
const DEGREE: f64 = 1.7;
const SUMS: [f64; 3] = [0.9, -2.0, 4.1];
const ROOTS: [f64; 3] = [1.0, 0.7, 1.6];

const CONTINUOUS: ThrustDesign = ThrustDesign::Continuous;
const DIFFERENTIABLE: ThrustDesign = ThrustDesign::Differentiable { alpha_star: 2.0, stiffness: 3.0 };
const ADAPTIVE: ThrustDesign = ThrustDesign::Adaptive { alpha_star: 2.0, gamma_star: 0.4 };

/// An offset that moves, with its derivatives.
fn offset(t: f64) -> [Jet; 3] {
    let wave = |size: f64, rate: f64| -> Jet {
        let (sin, cos) = sine_and_cosine(rate * t + 0.4);
        let r = rate;
        [size * sin, size * r * cos, -size * r * r * sin, -size * r * r * r * cos, size * r * r * r * r * sin]
    };
    [wave(1.1, 0.8), wave(-0.6, 1.3), wave(0.3, 0.5)]
}

fn vehicle(design: ThrustDesign) -> (Vehicle, Thrust) {
    // The adaptive law starts from a mass that is wrong.
    let known = if design.adapts() { 0.8 * MASS } else { MASS };
    let mut law = Thrust::new(design, &ROOTS[..design.order()], known, G).unwrap();
    law.yaw = Yaw { heading: 0.3, rate: 0.2, gain: 1.5 };
    (Vehicle { mass: MASS, gravity: G }, law)
}

fn rotorcraft(design: ThrustDesign) -> (Rotorcraft, ThrustCascade) {
    let (vehicle, outer) = vehicle(design);
    let inertia = Gain::Matrix(vec![0.02, 0.001, 0.0, 0.001, 0.03, -0.002, 0.0, -0.002, 0.04]);
    let plant = Rotorcraft::new(vehicle, &inertia, None).unwrap();
    let rates = RateLoop { inertia: *plant.inertia(), bandwidth_per_s: 25.0 };
    (plant, ThrustCascade { outer, rates })
}

/// A plant and its controller as one system, under messages that stay.
struct Closed<C: Controller<Exchange = Position>> {
    plant: C::Plant,
    law: C,
    moves: bool,
}

/// Everything at one instant.
struct Instant {
    rate: Vec<f64>,
    shown: Vec<f64>,
    balance: Balance,
}

impl<C: Controller<Exchange = Position>> Closed<C> {
    fn plant_len(&self) -> usize {
        total(&self.plant.states())
    }

    fn at(&self, t: f64, y: &[f64]) -> Instant {
        let jets = offset(t);
        let target = if self.moves { Jets::from(&jets) } else { Jets::NONE };
        let (state, own) = y.split_at(self.plant_len());
        let mut output = vec![0.0; self.plant.output_len()];
        self.plant.output(&mut self.plant.scratch(), state, &mut output).unwrap();
        let heard = Heard::new(&[DEGREE], &SUMS, 3).unwrap();
        let given = ControllerInput { measured: self.law.see(&output).unwrap(), heard, target };
        let mut rate = vec![0.0; y.len()];
        let mut shown = vec![0.0; total(&self.law.shown())];
        let mut input = vec![0.0; total(&self.plant.inputs())];
        let (d_state, d_own) = rate.split_at_mut(self.plant_len());
        let mut scratch = self.law.scratch();
        let asked = ControllerOutput { input: &mut input, d_state: d_own, shown: &mut shown };
        self.law.evaluate(&mut scratch, given, own, asked).unwrap();
        self.plant.rate(&mut self.plant.scratch(), state, &input, &[], d_state).unwrap();
        let truth = Truth { plant: &self.plant, state, external: &[] };
        let balance = self.law.balance(&mut scratch, truth, given, own, &shown).unwrap();
        Instant { rate, shown, balance }
    }

    fn started(&self, state: &[f64]) -> Vec<f64> {
        let jets = offset(0.0);
        let target = if self.moves { Jets::from(&jets) } else { Jets::NONE };
        let heard = Heard::new(&[DEGREE], &SUMS, 3).unwrap();
        let mut output = vec![0.0; self.plant.output_len()];
        self.plant.output(&mut self.plant.scratch(), state, &mut output).unwrap();
        let given = ControllerInput { measured: self.law.see(&output).unwrap(), heard, target };
        let mut own = vec![0.0; total(&self.law.states())];
        self.law.start(&mut self.law.scratch(), given, &[], &mut own).unwrap();
        [state, &own].concat()
    }

    /// d/dt of a quantity along the flow, by a difference of order four.
    fn derivative<const N: usize>(&self, t: f64, y: &[f64], of: impl Fn(f64, &[f64]) -> [f64; N]) -> [f64; N] {
        let h = 5e-5;
        let rate = self.at(t, y).rate;
        // A straight line has the right derivative, whatever its bend.
        let along = |step: f64| of(t + step, &y.iter().zip(&rate).map(|(y, r)| y + step * r).collect::<Vec<_>>());
        let [near, back, far, far_back] = [along(h), along(-h), along(2.0 * h), along(-2.0 * h)];
        core::array::from_fn(|k| (8.0 * (near[k] - back[k]) - (far[k] - far_back[k])) / (12.0 * h))
    }

    fn step(&self, t: f64, h: f64, y: &mut [f64]) {
        let moved = |k: &[f64], by: f64, y: &[f64]| y.iter().zip(k).map(|(y, k)| y + by * k).collect::<Vec<_>>();
        let k1 = self.at(t, y).rate;
        let k2 = self.at(t + 0.5 * h, &moved(&k1, 0.5 * h, y)).rate;
        let k3 = self.at(t + 0.5 * h, &moved(&k2, 0.5 * h, y)).rate;
        let k4 = self.at(t + h, &moved(&k3, h, y)).rate;
        for i in 0..y.len() {
            y[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
        }
    }
}

/// Numbers in (−1, 1), without a pattern.
fn spread(n: usize, len: usize) -> Vec<f64> {
    let mut seed = 12_345 + 977 * n as u64;
    let mut draw = || {
        seed = (seed * 1_103_515_245 + 12_345) % (1 << 31);
        seed as f64 / f64::from(1_u32 << 30) - 1.0
    };
    (0..len).map(|_| draw()).collect()
}

/// As [`spread`], with a thrust well away from zero.
fn states<C: Controller<Exchange = Position>>(
    closed: &Closed<C>,
    sigma_at: usize,
) -> impl Iterator<Item = Vec<f64>> + '_ {
    let len = closed.plant_len() + total(&closed.law.states());
    let at = closed.plant_len() + sigma_at;
    (1..60).map(move |n| {
        let mut y = spread(n, len);
        y[at] = 9.0 + 4.0 * y[at];
        closed.plant.settle(&mut y[..closed.plant_len()]);
        y
    })
}

fn near(got: f64, want: f64, scale: f64, what: &str) {
    assert!((got - want).abs() < 1e-10 * (1.0 + scale.abs()), "{what}: {got} against {want}");
}

fn balances<C: Controller<Exchange = Position>>(closed: &Closed<C>) {
    for y in states(closed, 9) {
        let now = closed.at(0.3, &y);
        let [slope] = closed.derivative(0.3, &y, |t, y| [closed.at(t, y).balance.value]);
        let scale = now.balance.value + now.balance.dissipation.abs();
        near(slope, -now.balance.dissipation, 10.0 * scale, "the rate of V");
        assert!(now.balance.value > 0.0);
    }
}

#[test]
fn thm4_and_thm5_lyapunov_identities_of_a_vehicle() {
    for moves in [false, true] {
        for design in [DIFFERENTIABLE, ADAPTIVE] {
            let (plant, law) = vehicle(design);
            balances(&Closed { plant, law, moves });
        }
    }
}

#[test]
fn thm4_and_thm5_lyapunov_identities_of_a_rotorcraft_whose_rates_miss() {
    for moves in [false, true] {
        for design in [DIFFERENTIABLE, ADAPTIVE] {
            let (plant, law) = rotorcraft(design);
            balances(&Closed { plant, law, moves });
        }
    }
}

#[test]
fn eq_46_closed_loop_is_its_literal_form() {
    for moves in [false, true] {
        let (plant, law) = vehicle(CONTINUOUS);
        let closed = Closed { plant, law, moves };
        let (alpha, beta) = (1.0, 0.7);
        for y in states(&closed, 0) {
            let accelerate = |y: &[f64]| -> [f64; 3] {
                let (state, _) = VehicleState::read(y).unwrap();
                plant.acceleration(*state.attitude, y[10])
            };
            let dddx = closed.derivative(0.3, &y, |_, y| accelerate(y));
            let (ddx, jets) = (accelerate(&y), offset(0.3));
            for k in 0..3 {
                let d = |r: usize| if moves { jets[k][r] } else { 0.0 };
                let (x, dx, ddx) = (y[k] - d(0), y[3 + k] - d(1), ddx[k] - d(2));
                let pair = alpha * beta;
                let want = -(alpha + beta) * ddx - pair * dx - DEGREE * (ddx + (alpha + beta) * dx + pair * x)
                    + pair * SUMS[k];
                near(dddx[k], want + d(3), 50.0, "the third derivative");
            }
        }
    }
}

#[test]
fn eq_52_error_dynamics_are_linear_and_decoupled() {
    let (plant, law) = vehicle(DIFFERENTIABLE);
    let closed = Closed { plant, law, moves: true };
    for y in states(&closed, 9) {
        // s is shown; its first derivative is ẍ − ż − d̈.
        let d_error = |t: f64, y: &[f64]| -> [f64; 3] {
            let jets = offset(t);
            let (state, _) = VehicleState::read(y).unwrap();
            let ddx = plant.acceleration(*state.attitude, y[19]);
            core::array::from_fn(|k| ddx[k] - y[13 + k] - jets[k][2])
        };
        let dds = closed.derivative(0.3, &y, d_error);
        let (ds, s) = (d_error(0.3, &y), &closed.at(0.3, &y).shown[9..12]);
        for k in 0..3 {
            near(MASS * dds[k], -2.0 * MASS * ds[k] - 3.0 * s[k], 50.0, "(52)");
        }
    }
}

#[test]
fn eq_58_by_parts_is_direct_integration_and_the_printed_integral() {
    for moves in [false, true] {
        let (plant, law) = vehicle(ADAPTIVE);
        let closed = Closed { plant, law, moves };
        let mut y = closed.started(&[0.4, -0.2, 1.0, 0.3, 0.1, -0.2, 0.0, 0.0, 0.0, 1.0]);
        let (alpha_star, gamma_star) = (2.0, 0.4);
        // m̂' with the acceleration, and the integrand that the paper prints, with ż + d̈ for ż and so on.
        let pieces = |t: f64, y: &[f64]| {
            let jets = offset(t);
            let d = |k: usize, r: usize| if moves { jets[k][r] } else { 0.0 };
            let (now, z) = (closed.at(t, y), &y[10..19]);
            let dddz = &now.rate[16..19];
            let (mut direct, mut under, mut outside) = (0.0, 0.0, 0.0);
            for k in 0..3 {
                let (dz, ddz, dddz) = (z[3 + k] + d(k, 2), z[6 + k] + d(k, 3), dddz[k] + d(k, 4));
                let w = ddz + alpha_star * dz - if k == 2 { alpha_star * G } else { 0.0 };
                direct -= gamma_star * w * (now.rate[3 + k] - dz);
                under += gamma_star * (w * dz + (dddz + alpha_star * ddz) * y[3 + k]);
                outside -= gamma_star * w * y[3 + k];
            }
            (direct, under, outside, *now.shown.last().unwrap())
        };
        let h = 2e-3;
        let (_, _, outside_0, start) = pieces(0.0, &y);
        let (mut direct, mut printed) = (start, start - outside_0);
        for n in 0..2000_i32 {
            let t = f64::from(n) * h;
            // Simpson's rule over the step, with the middle from half a step.
            let mut middle = y.clone();
            closed.step(t, 0.5 * h, &mut middle);
            let a = pieces(t, &y);
            closed.step(t, h, &mut y);
            let (b, c) = (pieces(t + 0.5 * h, &middle), pieces(t + h, &y));
            direct += h / 6.0 * (a.0 + 4.0 * b.0 + c.0);
            printed += h / 6.0 * (a.1 + 4.0 * b.1 + c.1);
        }
        let (_, _, outside, by_parts) = pieces(4.0, &y);
        assert!((by_parts - start).abs() > 0.05, "something was learnt: {start} {by_parts}");
        assert!((direct - by_parts).abs() < 1e-9, "{direct} against {by_parts}");
        assert!((printed + outside - by_parts).abs() < 1e-9, "{} against {by_parts}", printed + outside);
    }
}

#[test]
fn eq_47_rate_asked_for_is_foreseen() {
    for moves in [false, true] {
        let (plant, law) = rotorcraft(DIFFERENTIABLE);
        let closed = Closed { plant, law, moves };
        for y in states(&closed, 9) {
            let now = closed.at(0.3, &y);
            let wanted = |t: f64, y: &[f64]| -> [f64; 3] {
                let shown = closed.at(t, y).shown;
                core::array::from_fn(|k| shown[shown.len() - 3 + k])
            };
            let (slope, asked) = (closed.derivative(0.3, &y, wanted), wanted(0.3, &y));
            for k in 0..3 {
                // ε̇ = −b ε
                near(now.rate[10 + k] - slope[k], -25.0 * (y[10 + k] - asked[k]), 1e3, "the rate of the miss");
            }
        }
    }
}

#[test]
fn prop_attitude_stays_a_rotation_and_the_heading_is_kept() {
    let (plant, mut law) = vehicle(DIFFERENTIABLE);
    law.yaw = Yaw { heading: 2.0, rate: 0.0, gain: 1.5 };
    let closed = Closed { plant, law, moves: false };
    let mut y = closed.started(&[1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    assert_eq!(y[19..21], [MASS * G, 2.0]);
    for n in 0..10_000_i32 {
        closed.step(f64::from(n) * 2e-3, 2e-3, &mut y);
    }
    let attitude = VehicleState::read(&y).unwrap().0.attitude;
    let norm = libm::sqrt(dot(*attitude, *attitude));
    assert!((norm - 1.0).abs() < 1e-9, "{norm}");
    let look = rotate(*attitude, [1.0, 0.0, 0.0]);
    assert!((libm::atan2(look[1], look[0]) - 2.0).abs() < 1e-6, "{look:?}");
    // The neighbours stand at SUMS / DEGREE, and the vehicle is drawn there.
    assert!((0..3).all(|k| (y[k] - SUMS[k] / DEGREE).abs() < 0.1), "{:?}", &y[..3]);
}

/// An upright vehicle that turns: its heading is ψ_r from the start on, not behind it by r/k_ψ.
#[test]
fn prop_a_heading_that_turns_is_followed_without_a_lag_and_without_a_gain_it_turns_at_the_rate() {
    for (gain, heading) in [(1.5, 0.0), (0.0, 0.7), (4.0, 0.0)] {
        let (plant, mut law) = vehicle(DIFFERENTIABLE);
        law.yaw = Yaw { heading, rate: 0.6, gain };
        let closed = Closed { plant, law, moves: false };
        // Where the neighbours are, so that it hovers.
        let place = SUMS.map(|sum| sum / DEGREE);
        let mut y = closed.started(&[place[0], place[1], place[2], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        for n in 1..=1000_i32 {
            closed.step(f64::from(n - 1) * 2e-3, 2e-3, &mut y);
            let t = f64::from(n) * 2e-3;
            let look = rotate(*VehicleState::read(&y).unwrap().0.attitude, [1.0, 0.0, 0.0]);
            assert!((libm::atan2(look[1], look[0]) - 0.6 * t).abs() < 1e-9, "gain {gain}: {look:?} at {t} s");
            assert!((y[20] - heading - 0.6 * t).abs() < 1e-12, "{}", y[20]);
        }
    }
}

/// The rate that a body is to turn with about its own axis is foreseen, with all that its heading does.
#[test]
fn eq_47_the_rate_of_the_heading_is_foreseen_term_by_term() {
    for yaw in [Yaw { heading: 0.9, rate: 0.0, gain: 2.0 }, Yaw { heading: -0.4, rate: 3.0, gain: 0.5 }] {
        for design in [CONTINUOUS, DIFFERENTIABLE, ADAPTIVE] {
            let (plant, mut law) = rotorcraft(design);
            law.outer.yaw = yaw;
            let closed = Closed { plant, law, moves: true };
            for y in states(&closed, design.reference_len()) {
                let now = closed.at(0.3, &y);
                let wanted = |t: f64, y: &[f64]| [*closed.at(t, y).shown.last().unwrap()];
                let ([slope], [asked]) = (closed.derivative(0.3, &y, wanted), wanted(0.3, &y));
                near(now.rate[12] - slope, -25.0 * (y[12] - asked), 1e3, "the rate of the miss about the third axis");
            }
        }
    }
}

#[test]
fn thrust_near_zero_is_trouble_or_kept_away() {
    let (plant, mut law) = vehicle(DIFFERENTIABLE);
    let floor = 0.1 * MASS * G;
    assert_eq!(law.floor, Floor::Stops(floor));
    // A neighbour far below: the law wants to fall faster than gravity allows.
    let drop = |law: &Thrust| {
        let closed = Closed { plant, law: law.clone(), moves: false };
        let mut y = closed.started(&[0.0, 0.0, -400.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        let mut least = f64::MAX;
        for n in 0..3000_i32 {
            closed.step(f64::from(n) * 1e-3, 1e-3, &mut y);
            least = least.min(y[19]);
            if let Some(trouble) = law.trouble(&y[10..], &[]) {
                return (least, Some(trouble));
            }
        }
        (least, None)
    };
    let (_, trouble) = drop(&law);
    let Some(Singularity::Vanishes { value, floor: at, .. }) = trouble else { panic!("{trouble:?}") };
    assert!(at == floor && value <= floor && value > 0.0, "seen before zero: {value}");
    law.floor = Floor::Kept { floor, approach_s: 0.1 };
    let (least, trouble) = drop(&law);
    assert!(trouble.is_none() && least > floor, "{least} {trouble:?}");
    assert!(law.trouble(&[f64::NAN; 11], &[]).is_some());
}

#[test]
fn wrong_lengths_are_errors() {
    let (plant, law) = vehicle(ADAPTIVE);
    assert!(law.see(&[0.0; 9]).is_err());
    let (_, cascade) = rotorcraft(ADAPTIVE);
    assert!(cascade.see(&[0.0; 12]).is_err() && cascade.see(&[0.0; 14]).is_err());
    let output = [0.0; 10];
    let heard = Heard::new(&[0.0], &[0.0; 3], 3).unwrap();
    let [first, second, _] = offset(0.0);
    let two = [first, second];
    let given = ControllerInput { measured: law.see(&output).unwrap(), heard, target: Jets::from(&two) };
    let mut state = vec![0.0; 12];
    let need = LengthError { what: "target", need: 3, got: 2 };
    assert_eq!(law.start(&mut (), given, &[], &mut state), Err(need));
    let jets = offset(0.0);
    let given = ControllerInput { target: Jets::from(&jets), ..given };
    assert!(law.start(&mut (), given, &[vec![0.0; 2]], &mut state).is_err());
    assert!(law.start(&mut (), given, &[vec![0.5; 3]], &mut state).is_ok());
    let asked = ControllerOutput { input: &mut [0.0; 3], d_state: &mut [0.0; 12], shown: &mut [0.0; 16] };
    assert!(law.evaluate(&mut (), given, &state, asked).is_err());
    assert!(plant.rate(&mut (), &output, &[0.0; 3], &[], &mut [0.0; 10]).is_err());
}
