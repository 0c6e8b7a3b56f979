//! Estimates that are kept within bounds: V changes as each proof says, on either side of every bound, and what is used keeps to them.

use forwardstep_core::controller::{
    AdaptiveBackstepping, BacksteppingGains, Balance, ChainError, Controller, ControllerInput, ControllerOutput,
    Following, Immersion, Jets, Linearising, PositionOnly, ReferenceModel, Thrust, ThrustDesign, Truth,
};
use forwardstep_core::expression::Expression;
use forwardstep_core::law::{ParameterBounds, Range};
use forwardstep_core::plant::{Cascade, CascadeTerms, Chain, Formulas, Mechanical, Plant, Vehicle};
use forwardstep_core::reference::{Consensus, Heard, Position};
use forwardstep_core::robot::PointMass;

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

/// What a plant and its law do in a state.
struct Instant {
    balance: Balance,
    d_plant: Vec<f64>,
    d_law: Vec<f64>,
    shown: Vec<f64>,
}

fn size(blocks: &[(forwardstep_core::signal::Signal, usize)]) -> usize {
    blocks.iter().map(|(_, n)| n).sum()
}

fn at<C: Controller<Exchange = Position>>(law: &C, plant: &C::Plant, m: usize, x: &[f64], state: &[f64]) -> Instant {
    let (degree, sums) = (vec![0.8; 1], vec![0.5; m]);
    let mut output = vec![0.0; plant.output_len()];
    output.copy_from_slice(&x[..plant.output_len()]);
    let given = ControllerInput {
        measured: law.see(&output).unwrap(),
        heard: Heard::new(&degree, &sums, m).unwrap(),
        target: Jets::NONE,
    };
    let (mut input, mut d_law) = (vec![0.0; size(&plant.inputs())], vec![0.0; state.len()]);
    let (mut shown, mut d_plant) = (vec![0.0; size(&law.shown())], vec![0.0; x.len()]);
    let mut work = law.scratch();
    let asked = ControllerOutput { input: &mut input, d_state: &mut d_law, shown: &mut shown };
    law.evaluate(&mut work, given, state, asked).unwrap();
    plant.rate(&mut plant.scratch(), x, &input, &[], &mut d_plant).unwrap();
    let truth = Truth { plant, state: x, external: &[] };
    let balance = law.balance(&mut work, truth, given, state, &shown).unwrap();
    Instant { balance, d_plant, d_law, shown }
}

fn moved(x: &[f64], dx: &[f64], h: f64) -> Vec<f64> {
    x.iter().zip(dx).map(|(x, dx)| x + h * dx).collect()
}

/// V̇ by differences is −dissipation, and dissipation is at least `paper`; what is shown.
fn balances<C: Controller<Exchange = Position>>(
    law: &C,
    plant: &C::Plant,
    m: usize,
    x: &[f64],
    state: &[f64],
) -> Instant {
    let now = at(law, plant, m, x, state);
    let fastest = now.d_plant.iter().chain(&now.d_law).fold(1.0_f64, |most, rate| most.max(rate.abs()));
    let h = 3e-3 / fastest;
    let value = |h: f64| at(law, plant, m, &moved(x, &now.d_plant, h), &moved(state, &now.d_law, h)).balance.value;
    let difference = |h: f64| (value(h) - value(-h)) / (2.0 * h);
    let slope = (4.0 * difference(h / 2.0) - difference(h)) / 3.0;
    let close = 3e-4 * (1.0 + now.balance.dissipation.abs() + now.balance.value.abs());
    assert!((slope + now.balance.dissipation).abs() < close, "{slope} is not -{}", now.balance.dissipation);
    now
}

fn x(index: usize) -> Expression {
    Expression::variable(index)
}

const THETA: [f64; 2] = [0.4, -0.3];

fn bounds() -> ParameterBounds {
    ParameterBounds::new(vec![0.1, -0.7], vec![0.6, 0.2], 0.05)
}

fn guide(roots: &[f64]) -> ReferenceModel {
    ReferenceModel::Consensus(Consensus::new([(roots, 0.0)]).unwrap())
}

fn second_order() -> Formulas {
    Formulas::new(2, &x(0).sin_of(), vec![x(0) * x(1), x(0).cos_of()], &(x(0).power(2.0) + 1.5)).unwrap()
}

#[test]
fn eq_lyapunov_of_adaptation_of_chains_loses_what_the_projection_withholds() {
    let following = Following { guide: guide(&[1.0, 2.0]), gain_per_s: 1.7, floor: 0.1 };
    let law = Linearising::adaptive(second_order(), following, vec![0.8, 1.3], vec![0.0; 2]).unwrap();
    let law = law.bounded(bounds()).unwrap();
    let plant = Chain { terms: second_order(), theta: THETA.to_vec() };
    let mut withheld = 0;
    for seed in 1..200 {
        let (x, mut state) = (numbers(seed, 2), numbers(seed + 500, 4));
        // Within the margins too.
        (state[2], state[3]) = (0.35 + 0.2 * state[2], -0.25 + 0.35 * state[3]);
        let now = balances(&law, &plant, 1, &x, &state);
        let s = x[1] - state[0];
        let more = now.balance.dissipation - 1.7 * s * s;
        assert!(more >= -1e-12, "{more}");
        withheld += i32::from(more > 1e-9);
    }
    assert!(withheld > 5, "{withheld}");
    let error = Linearising::adaptive(
        second_order(),
        Following { guide: guide(&[1.0, 2.0]), gain_per_s: 1.7, floor: 0.1 },
        vec![1.0; 2],
        vec![0.0; 2],
    );
    assert!(matches!(error.unwrap().bounded(ParameterBounds::anywhere(1)), Err(ChainError::Length(_))));
}

#[test]
fn eq_lyapunov_of_immersion_holds_with_an_estimate_that_is_used_within_bounds() {
    let following = Following { guide: guide(&[1.0, 2.0]), gain_per_s: 1.7, floor: 0.1 };
    let phi = second_order().regressor().to_vec();
    let antiderivatives = [x(0) * x(1).power(2.0) * 0.5, x(0).cos_of() * x(1)];
    assert_eq!(phi.len(), 2);
    let law = Immersion::new(second_order(), &antiderivatives, following, vec![0.8, 1.3], vec![0.0; 2]).unwrap();
    let law = law.bounded(bounds()).unwrap();
    let plant = Chain { terms: second_order(), theta: THETA.to_vec() };
    for seed in 1..200 {
        let (x, state) = (numbers(seed, 2), numbers(seed + 500, 4));
        let now = balances(&law, &plant, 1, &x, &state);
        let s = x[1] - state[0];
        assert!(now.balance.dissipation >= 0.5 * 1.7 * s * s - 1e-12);
        for (k, used) in now.shown[4..6].iter().enumerate() {
            let Range { lower, upper } = bounds().range(k);
            assert!(lower <= *used && *used <= upper);
        }
    }
}

#[test]
fn eq_lyapunov_of_backstepping_keeps_its_rate_between_bounds_in_both_shapes() {
    for n in [2, 3, 5] {
        let zero = || Expression::number(0.0);
        let all = (0..n).map(|i| vec![x(i).sin_of() * 0.4, if i == 0 { x(0).power(2.0) * 0.3 } else { zero() }]);
        let terms = CascadeTerms::strict(all.collect()).unwrap();
        let plant = Cascade::new(terms.clone(), THETA.to_vec()).unwrap();
        let gains = || BacksteppingGains { gains_per_s: vec![1.2; n], adaptation: vec![0.8, 1.3], floor: 1e-3 };
        let roots: Vec<f64> = (1..n).map(|r| 1.0 + 0.3 * r as f64).collect();
        let start = vec![0.3, 0.1];
        let law = AdaptiveBackstepping::within(&terms, guide(&roots), gains(), start.clone(), Some(&bounds())).unwrap();
        for seed in 1..40 {
            // Of high order V is so steep that differences tell nothing far out.
            let scaled = |of: Vec<f64>| of.into_iter().map(|x| if n > 3 { 0.3 * x } else { x }).collect::<Vec<f64>>();
            let (x, state) = (scaled(numbers(seed, n)), scaled(numbers(seed + 500, n + 2)));
            let now = balances(&law, &plant, 1, &x, &state);
            let lost: f64 = now.shown[n..2 * n].iter().map(|e| 1.2 * e * e).sum();
            assert!((now.balance.dissipation - lost).abs() < 1e-12 * (1.0 + lost));
            for (k, used) in now.shown[2 * n + 1..2 * n + 3].iter().enumerate() {
                let Range { lower, upper } = bounds().range(k);
                assert!(lower < *used && *used < upper);
            }
        }
        // It starts where it is asked to, and not at a bound.
        let x = numbers(1, n);
        let given = ControllerInput {
            measured: law.see(&x).unwrap(),
            heard: Heard::new(&[0.8], &[0.5], 1).unwrap(),
            target: Jets::NONE,
        };
        let mut state = vec![0.0; n + 2];
        law.start(&mut law.scratch(), given, &[], &mut state).unwrap();
        let shown = at(&law, &plant, 1, &x, &state).shown;
        assert!(shown[2 * n + 1..2 * n + 3].iter().zip(&start).all(|(shown, start)| (shown - start).abs() < 1e-15));
        for (parameter, wrong) in [(0, vec![0.6, 0.1]), (1, vec![0.3, 0.9])] {
            let error =
                AdaptiveBackstepping::within(&terms, guide(&roots), gains(), wrong, Some(&bounds())).unwrap_err();
            assert!(
                matches!(error, ChainError::StartAtBound { parameter: found, .. } if found == parameter),
                "{error}"
            );
        }
    }
}

#[test]
fn eq_lyapunov_of_masses_found_by_parts_holds_with_bounds() {
    let range = Range { lower: 1.1, upper: 1.9 };
    let law = PositionOnly {
        axes: 2,
        guide: guide(&[1.0, 2.0]),
        damping: 3.0,
        filter_per_s: 2.5,
        adaptation: 0.7,
        estimate_start: 1.5,
        bounds: Some(range),
    };
    let plant = Mechanical { robot: PointMass { dimension: 2 }, theta: vec![1.3] };
    for seed in 1..200 {
        let (x, state) = (numbers(seed, 4), numbers(seed + 500, 7));
        let now = balances(&law, &plant, 2, &x, &state);
        let y: f64 = now.shown[4..6].iter().map(|y| 3.0 * y * y).sum();
        assert!(now.balance.dissipation >= y - 1e-12);
        assert!((range.lower..=range.upper).contains(&now.shown[6]));
    }
    let vehicle = Vehicle { mass: 1.3, gravity: 9.81 };
    let mut law =
        Thrust::new(ThrustDesign::Adaptive { alpha_star: 2.0, gamma_star: 0.4 }, [1.0, 0.7, 1.6], 1.5, 9.81).unwrap();
    law.bounds = Some(range);
    for seed in 1..200 {
        let (mut x, mut state) = (numbers(seed, 10), numbers(seed + 500, 12));
        let norm = x[6..].iter().map(|q| q * q).sum::<f64>().sqrt();
        x[6..].iter_mut().for_each(|q| *q /= norm);
        (state[9], state[11]) = (12.0 + state[9], 0.3 * state[11]);
        let now = balances(&law, &vehicle, 3, &x, &state);
        assert!((range.lower..=range.upper).contains(now.shown.last().unwrap()));
    }
}
