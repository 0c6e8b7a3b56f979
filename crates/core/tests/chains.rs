//! Laws for plants of any order: identities of the proofs at random states, and the literal equations.

use forwardstep_core::LengthError;
use forwardstep_core::controller::{
    AdaptiveBackstepping, BacksteppingGains, ChainError, Controller, ControllerInput, ControllerOutput, Following,
    Immersion, Jet, Jets, Linearising, ReferenceModel, ReferenceModelError, Singularity, Truth,
};
use forwardstep_core::expression::Expression;
use forwardstep_core::plant::{Cascade, CascadeError, CascadeTerms, Chain, Closures, Formulas, Plant, total};
use forwardstep_core::reference::{Consensus, Heard, Position, polynomial};

const W: f64 = 1.5;
const X_J: f64 = -0.7;
const DEGREE: [f64; 1] = [W];
const SUMS: [f64; 1] = [W * X_J];

/// Numbers within ±1.5, always the same.
fn numbers(seed: u64, count: usize) -> Vec<f64> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        3.0 * ((state >> 11) as f64 / (1_u64 << 53) as f64) - 1.5
    };
    (0..count).map(|_| next()).collect()
}

fn consensus(roots: &[f64]) -> ReferenceModel {
    ReferenceModel::Consensus(Consensus::<Position>::new([(roots, 0.0)]).unwrap())
}

fn tracking(roots: &[f64]) -> ReferenceModel {
    let mut alpha = polynomial(roots).unwrap();
    alpha.pop();
    ReferenceModel::Tracking { alpha }
}

fn following(guide: ReferenceModel) -> Following {
    Following { guide, gain_per_s: 1.7, floor: 1e-3 }
}

/// What a law asks for in a state, and what that does.
struct Result {
    input: f64,
    d_state: Vec<f64>,
    shown: Vec<f64>,
    d_x: Vec<f64>,
}

fn close<C>(law: &C, plant: &C::Plant, x: &[f64], state: &[f64], target: &[Jet]) -> Result
where
    C: Controller<Exchange = Position>,
{
    let mut scratch = law.scratch();
    let heard = Heard::new(&DEGREE, &SUMS, 1).unwrap();
    let given = ControllerInput { measured: law.see(x).unwrap(), heard, target: target.into() };
    let (mut input, mut d_state) = (vec![0.0], vec![f64::NAN; state.len()]);
    let mut shown = vec![f64::NAN; total(&law.shown())];
    let asked = ControllerOutput { input: &mut input, d_state: &mut d_state, shown: &mut shown };
    law.evaluate(&mut scratch, given, state, asked).unwrap();
    let mut d_x = vec![0.0; x.len()];
    plant.rate(&mut plant.scratch(), x, &input, &[], &mut d_x).unwrap();
    assert!(d_state.iter().chain(&shown).all(|value| value.is_finite()));
    Result { input: input[0], d_state, shown, d_x }
}

fn balance<C>(law: &C, plant: &C::Plant, x: &[f64], state: &[f64], shown: &[f64]) -> [f64; 2]
where
    C: Controller<Exchange = Position>,
{
    let heard = Heard::new(&DEGREE, &SUMS, 1).unwrap();
    let given = ControllerInput { measured: law.see(x).unwrap(), heard, target: Jets::NONE };
    let balance =
        law.balance(&mut law.scratch(), Truth { plant, state: x, external: &[] }, given, state, shown).unwrap();
    [balance.value, balance.dissipation]
}

fn near(got: f64, expected: f64) {
    assert!((got - expected).abs() <= 1e-12 * (1.0 + expected.abs()), "{got} is not {expected}");
}

fn x(r: usize) -> Expression {
    Expression::variable(r)
}

/// Order 3: χ₀ = −x³, φ = [sin ẋ, ẍ², x], ψ = 2 + cos x.
fn third_order() -> Formulas {
    let phi = vec![x(1).sin_of(), x(2).power(2.0), x(0)];
    Formulas::new(3, &(-x(0).power(3.0)), phi, &(x(0).cos_of() + 2.0)).unwrap()
}

const THETA: [f64; 3] = [0.8, -0.4, 1.1];
const GAMMA: [f64; 3] = [0.7, 1.9, 1.2];

#[test]
fn eq_43_with_order_three_and_two_differentiators_is_its_literal_form() {
    let (a, b, c) = (1.0, 2.0, 0.5);
    let (pairs, sum) = (a * b + a * c + b * c, a + b + c);
    let law = Linearising::new(third_order(), THETA.to_vec(), following(consensus(&[a, b, c]))).unwrap();
    let plant = Chain { terms: third_order(), theta: THETA.to_vec() };
    for seed in 1..50 {
        let (x, state) = (numbers(seed, 3), numbers(seed + 1000, 2));
        let Result { input, d_state, shown, d_x } = close(&law, &plant, &x, &state, &[]);
        let [x_0, dx, ddx] = x[..] else { panic!("three numbers") };
        let [z, dz] = state[..] else { panic!("two numbers") };
        // d⁴x/dt⁴ of (24), with ż for the third derivative.
        let ddz =
            -sum * dz - pairs * ddx - a * b * c * dx - W * (dz + sum * ddx + pairs * dx + a * b * c * (x_0 - X_J));
        near(d_state[0], dz);
        near(d_state[1], ddz);
        let chi = -x_0.powi(3) + THETA[0] * dx.sin() + THETA[1] * ddx * ddx + THETA[2] * x_0;
        near(d_x[2], chi + (2.0 + x_0.cos()) * input);
        // The second line: ṡ = χ − ż + ψ u = −k s.
        near(d_x[2] - dz, -1.7 * (ddx - z));
        near(shown[2], ddx - z);
        near(shown[3], 2.0 + x_0.cos());
    }
}

#[test]
fn eq_43_for_tracking_of_order_two_is_the_third_order_system_of_a9() {
    let terms = Closures {
        order: 2,
        parameters: 0,
        chi: |x: &[f64]| -x[0] * x[1],
        phi: |_: &[f64], _: &mut [f64]| {},
        psi: |x: &[f64]| 2.0 + x[0] * x[0],
    };
    let roots = [1.0, 2.0, 1.5];
    let alpha = polynomial(roots).unwrap();
    let law = Linearising::new(terms, Vec::new(), following(tracking(&roots))).unwrap();
    let plant = Chain { terms, theta: Vec::new() };
    let jet: Jet = [0.4, -0.3, 0.9, 1.4, -2.0];
    let (x, state) = (numbers(3, 2), numbers(4, 2));
    let Result { d_state, shown, d_x, .. } = close(&law, &plant, &x, &state, &[jet]);
    let ddz = jet[3] - alpha[2] * (state[1] - jet[2]) - alpha[1] * (x[1] - jet[1]) - alpha[0] * (x[0] - jet[0]);
    near(d_state[1], ddz);
    near(d_x[1] - state[1], -1.7 * (x[1] - state[0]));
    near(*shown.last().unwrap(), x[0] - jet[0]);
}

#[test]
fn eq_43_of_order_one_has_the_measured_position_at_its_foot() {
    // Two differentiators on ẋ = x² + u.
    let terms = Formulas::new(1, &x(0).power(2.0), Vec::new(), &Expression::number(1.0)).unwrap();
    let law = Linearising::new(terms.clone(), Vec::new(), following(consensus(&[2.0]))).unwrap();
    let plant = Chain { terms, theta: Vec::new() };
    let Result { d_state, d_x, .. } = close(&law, &plant, &[0.3], &[0.5, -0.2], &[]);
    near(d_state[1], -2.0 * -0.2 - W * (-0.2 + 2.0 * (0.3 - X_J)));
    near(d_x[0] - -0.2, -1.7 * (0.3 - 0.5));
}

#[test]
fn eq_lyapunov_of_linearisation_and_of_adaptation_loses_k_s_squared() {
    let plant = Chain { terms: third_order(), theta: THETA.to_vec() };
    let known = Linearising::new(third_order(), THETA.to_vec(), following(consensus(&[1.0, 2.0]))).unwrap();
    let adaptive =
        Linearising::adaptive(third_order(), following(consensus(&[1.0, 2.0])), GAMMA.to_vec(), vec![0.0; 3]).unwrap();
    for seed in 1..100 {
        let (x, state) = (numbers(seed, 3), numbers(seed + 1000, 4));
        let run = close(&known, &plant, &x, &state[..1], &[]);
        let s = x[2] - state[0];
        near(s * (run.d_x[2] - run.d_state[0]), -balance(&known, &plant, &x, &state[..1], &run.shown)[1]);

        let run = close(&adaptive, &plant, &x, &state, &[]);
        let mut d_v = s * (run.d_x[2] - run.d_state[0]);
        let mut v = 0.5 * s * s;
        for j in 0..3 {
            let delta = state[1 + j] - THETA[j];
            d_v += delta * run.d_state[1 + j] / GAMMA[j];
            v += 0.5 * delta * delta / GAMMA[j];
        }
        let [value, dissipation] = balance(&adaptive, &plant, &x, &state, &run.shown);
        near(v, value);
        near(d_v, -dissipation);
        near(dissipation, 1.7 * s * s);
    }
}

#[test]
fn eq_lyapunov_of_immersion_and_invariance_loses_a_square_of_s_and_eta() {
    let antiderivatives = [x(2) * x(1).sin_of(), x(2).power(3.0) / 3.0, x(0) * x(2)];
    let guide = following(consensus(&[1.0, 2.0, 3.0]));
    let law = Immersion::new(third_order(), &antiderivatives, guide, GAMMA.to_vec(), vec![0.0; 3]).unwrap();
    let plant = Chain { terms: third_order(), theta: THETA.to_vec() };
    for seed in 1..100 {
        let (x, state) = (numbers(seed, 3), numbers(seed + 1000, 5));
        let Result { d_state, shown, d_x, .. } = close(&law, &plant, &x, &state, &[]);
        let (s, k) = (x[2] - state[0], 1.7);
        let phi = [x[1].sin(), x[2] * x[2], x[0]];
        let big_phi = [x[2] * x[1].sin(), x[2].powi(3) / 3.0, x[0] * x[2]];
        let moved = [phi[0] * d_x[2] + x[2] * x[1].cos() * d_x[1], phi[1] * d_x[2], phi[2] * d_x[2] + x[2] * d_x[0]];
        let (mut d_v, mut v, mut eta) = (s * (d_x[2] - d_state[0]), 0.5 * s * s, 0.0);
        for j in 0..3 {
            let zeta = state[2 + j] + GAMMA[j] * big_phi[j] - THETA[j];
            near(shown[4 + j], zeta + THETA[j]);
            eta += phi[j] * zeta;
            v += 0.5 * zeta * zeta / (k * GAMMA[j]);
            d_v += zeta * (d_state[2 + j] + GAMMA[j] * moved[j]) / (k * GAMMA[j]);
        }
        let [value, dissipation] = balance(&law, &plant, &x, &state, &shown);
        near(v, value);
        assert!((d_v + dissipation).abs() < 1e-11 * (1.0 + v));
        near(dissipation, 0.5 * k * s * s + 0.5 * k * (s + eta / k).powi(2) + 0.5 * eta * eta / k);
    }
}

#[test]
fn immersion_takes_no_antiderivative_that_is_none() {
    assert_eq!(Immersion::antiderivative(3, &x(1)), Some(x(1) * x(2)));
    assert_eq!(Immersion::antiderivative(3, &x(2)), None);
    let wrong = [x(2) * x(1).sin_of(), x(2).power(3.0), x(0) * x(2)];
    let guide = following(consensus(&[1.0, 2.0]));
    let error = Immersion::new(third_order(), &wrong, guide, GAMMA.to_vec(), vec![0.0; 3]).unwrap_err();
    assert!(matches!(error, ChainError::Antiderivative { parameter: 1, .. }));
}

fn strict() -> CascadeTerms {
    CascadeTerms::strict(vec![
        vec![x(0).power(2.0), Expression::number(0.0)],
        vec![x(0) * x(1), x(1).sin_of()],
        vec![Expression::number(0.0), x(2) * x(0)],
    ])
    .unwrap()
}

fn gains(n: usize, p: usize) -> BacksteppingGains {
    BacksteppingGains { gains_per_s: vec![1.0; n], adaptation: vec![0.5; p], floor: 1e-3 }
}

#[test]
fn eq_backstepping_is_led_by_24_about_the_first_state() {
    let (a, b) = (1.0, 2.0);
    let law = AdaptiveBackstepping::new(&strict(), consensus(&[a, b]), gains(3, 2), vec![0.0; 2]).unwrap();
    let plant = Cascade::new(strict(), THETA[..2].to_vec()).unwrap();
    let (x, state) = (numbers(8, 3), numbers(9, 5));
    let Result { d_state, shown, .. } = close(&law, &plant, &x, &state, &[]);
    let (dz, ddz) = (state[1], state[2]);
    near(d_state[0], dz);
    near(d_state[1], ddz);
    near(d_state[2], -(a + b) * ddz - a * b * dz - W * (ddz + (a + b) * dz + a * b * (x[0] - X_J)));
    near(shown[3], x[0] - state[0]);
    // e_2 = x_2 − ż + e_1 + φ_1ᵀθ̂.
    near(shown[4], x[1] - dz + shown[3] + x[0] * x[0] * state[3]);
    near(shown[6], 1.0);
    // ė_1 with the true parameters.
    let d_e_1 = x[1] + x[0] * x[0] * THETA[0] - dz;
    near(d_e_1, -shown[3] + shown[4] - x[0] * x[0] * (state[3] - THETA[0]));
}

#[test]
fn chains_start_where_the_reference_follows_them() {
    let law = AdaptiveBackstepping::new(&strict(), consensus(&[1.0, 2.0]), gains(3, 2), vec![0.3, 0.4]).unwrap();
    let x = [0.9, 0.1, 0.2];
    let heard = Heard::new(&DEGREE, &SUMS, 1).unwrap();
    let given = ControllerInput { measured: law.see(&x).unwrap(), heard, target: Jets::NONE };
    let mut state = vec![f64::NAN; 5];
    law.start(&mut law.scratch(), given, &[], &mut state).unwrap();
    assert_eq!(state, [0.9, 0.0, 0.0, 0.3, 0.4]);
    law.start(&mut law.scratch(), given, &[vec![0.5], vec![0.6]], &mut state).unwrap();
    assert_eq!(state, [0.5, 0.6, 0.0, 0.3, 0.4]);
}

#[test]
fn a_factor_that_vanishes_is_told() {
    let terms = Formulas::new(1, &Expression::number(0.0), Vec::new(), &x(0)).unwrap();
    let law = Linearising::new(terms.clone(), Vec::new(), following(tracking(&[1.0]))).unwrap();
    let plant = Chain { terms, theta: Vec::new() };
    let shown = |at: f64| close(&law, &plant, &[at], &[0.1], &[[0.0; 5]]).shown;
    assert_eq!(law.trouble(&[0.1], &shown(0.5)), None);
    let Some(Singularity::Vanishes { value, floor, .. }) = law.trouble(&[0.1], &shown(-5e-4)) else {
        panic!("nothing told");
    };
    assert_eq!((value, floor), (-5e-4, 1e-3));
}

#[test]
fn what_does_not_fit_is_an_error_with_its_numbers() {
    let built = |guide, p| Linearising::adaptive(third_order(), following(guide), vec![1.0; p], vec![0.0; 3]);
    let few = ReferenceModelError::TooFew { least: 2, got: 1 };
    assert_eq!(built(consensus(&[1.0]), 3).unwrap_err(), ChainError::ReferenceModel(few));
    let few = ReferenceModelError::TooFew { least: 3, got: 2 };
    assert_eq!(built(tracking(&[1.0, 2.0]), 3).unwrap_err(), ChainError::ReferenceModel(few));
    assert_eq!(built(tracking(&[1.0; 5]), 3).unwrap().target_derivatives(), 5);
    let length = LengthError { what: "adaptation gains", need: 3, got: 2 };
    assert_eq!(built(consensus(&[1.0, 2.0]), 2).unwrap_err(), ChainError::Length(length));
    let few = ReferenceModelError::TooFew { least: 2, got: 1 };
    let law = AdaptiveBackstepping::new(&strict(), consensus(&[1.0]), gains(3, 2), vec![0.0; 2]);
    assert_eq!(law.unwrap_err(), ChainError::ReferenceModel(few));
    let above = CascadeTerms::strict(vec![vec![x(1)], vec![x(0)]]).unwrap_err();
    assert_eq!(above, CascadeError::Above { equation: 1, used: 2, most: 1 });
    let empty = CascadeTerms::new(Vec::new(), Vec::new(), Expression::number(1.0)).unwrap_err();
    assert_eq!(empty, CascadeError::Empty);
}
