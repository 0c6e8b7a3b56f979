//! Plants with several axes and a matrix ψ: V along the loop at random states, one axis against the law for one, a ψ without an inverse.

use forwardstep_core::LengthError;
use forwardstep_core::controller::{
    ChainError, Controller, ControllerInput, ControllerOutput, Following, Jet, Jets, Linearising, ReferenceModel,
    Singularity, Truth, VectorLinearising,
};
use forwardstep_core::expression::Expression;
use forwardstep_core::law::ParameterBounds;
use forwardstep_core::plant::{CascadeError, Chain, Formulas, Plant, VectorChain, VectorFormulas, total};
use forwardstep_core::reference::{Consensus, Heard, Position, polynomial};
use forwardstep_core::signal::Signal;

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

fn following(guide: ReferenceModel) -> Following {
    Following { guide, gain_per_s: 1.7, floor: 1e-3 }
}

fn consensus(roots: &[f64]) -> ReferenceModel {
    ReferenceModel::Consensus(Consensus::<Position>::new([(roots, 0.0)]).unwrap())
}

fn tracking(roots: &[f64]) -> ReferenceModel {
    let mut alpha = polynomial(roots).unwrap();
    alpha.pop();
    ReferenceModel::Tracking { alpha }
}

fn x(index: usize) -> Expression {
    Expression::variable(index)
}

fn constant(value: f64) -> Expression {
    Expression::number(value)
}

/// Two axes of order two, with every letter somewhere: x1, x2, dx1, dx2 are variables 0 to 3.
fn coupled() -> VectorFormulas {
    let chi = vec![x(2) * x(1), x(3).sin_of() + x(0)];
    let regressor = vec![vec![x(2), x(0) * x(1)], vec![x(3).cos_of(), constant(0.5)]];
    let psi = vec![vec![constant(0.3) * x(0), constant(2.0)], vec![constant(-1.5), x(3)]];
    VectorFormulas::new(2, chi, regressor, psi).unwrap()
}

struct Loop {
    input: Vec<f64>,
    d_state: Vec<f64>,
    shown: Vec<f64>,
    d_x: Vec<f64>,
}

fn close<C>(law: &C, plant: &C::Plant, at: (&[f64], &[f64]), target: &[Jet], w: &[f64], axes: usize) -> Loop
where
    C: Controller<Exchange = Position>,
{
    let (x, state) = at;
    let sums: Vec<f64> = numbers(99, axes);
    let given = ControllerInput {
        measured: law.see(x).unwrap(),
        heard: Heard::new(&[1.2], &sums, axes).unwrap(),
        target: target.into(),
    };
    let (mut input, mut d_state) = (vec![f64::NAN; axes], vec![f64::NAN; state.len()]);
    let (mut shown, mut d_x) = (vec![f64::NAN; total(&law.shown())], vec![f64::NAN; x.len()]);
    let asked = ControllerOutput { input: &mut input, d_state: &mut d_state, shown: &mut shown };
    law.evaluate(&mut law.scratch(), given, state, asked).unwrap();
    plant.rate(&mut plant.scratch(), x, &input, w, &mut d_x).unwrap();
    Loop { input, d_state, shown, d_x }
}

#[test]
fn eq_43_v_falls_as_the_proof_says_whatever_pulls_at_the_other_axis() {
    let theta = [0.4, -1.1];
    let plant = VectorChain { terms: coupled(), theta: theta.to_vec() };
    let gamma = [3.0, 0.7];
    let bounds = ParameterBounds::new(vec![-0.8, -1.2], vec![0.9, 0.3], 0.1);
    let free = |guide| VectorLinearising::adaptive(coupled(), following(guide), gamma.to_vec(), vec![0.0; 2]).unwrap();
    let known = |guide| VectorLinearising::new(coupled(), theta.to_vec(), following(guide)).unwrap();
    let held = |guide| free(guide).bounded(bounds.clone()).unwrap();
    let target = [[0.3, -0.2, 0.5, 0.1, 0.0], [-0.6, 0.4, 0.2, -0.3, 0.0]];
    let guides = [(consensus(&[1.0, 2.0]), 0, 4), (tracking(&[1.0, 2.0, 0.5]), 2, 4)];
    for (seed, (guide, targets, reference)) in (0..60).flat_map(|seed| guides.iter().map(move |guide| (seed, guide))) {
        for (law, estimates) in [(known(guide.clone()), 0), (free(guide.clone()), 2), (held(guide.clone()), 2)] {
            let drawn = numbers(seed + 1, 4 + reference + 2 + 2);
            let (x, state, w) = (&drawn[..4], &drawn[4..4 + reference + estimates], &drawn[reference + 6..]);
            let found = close(&law, &plant, (x, state), &target[..*targets], w, 2);
            let s: Vec<f64> = (0..2).map(|axis| x[2 + axis] - state[axis]).collect();
            let mut rate = 0.0;
            for axis in 0..2 {
                rate += s[axis] * (found.d_x[2 + axis] - found.d_state[axis]);
            }
            let mut value = 0.5 * (s[0] * s[0] + s[1] * s[1]);
            for j in 0..estimates {
                let delta = state[reference + j] - theta[j];
                rate += delta * found.d_state[reference + j] / gamma[j];
                value += 0.5 * delta * delta / gamma[j];
            }
            let sums = [0.0; 2];
            let given = ControllerInput {
                measured: law.see(x).unwrap(),
                heard: Heard::new(&[1.2], &sums, 2).unwrap(),
                target: Jets::from(&target[..*targets]),
            };
            let truth = Truth { plant: &plant, state: x, external: w };
            let balance = law.balance(&mut law.scratch(), truth, given, state, &found.shown).unwrap();
            assert!((balance.value - value).abs() < 1e-12, "{seed}: {} {value}", balance.value);
            let size = 1.0 + rate.abs() + found.input.iter().map(|u| u.abs()).fold(0.0, f64::max);
            assert!((balance.dissipation + rate).abs() < 1e-11 * size, "{seed}: {} {rate}", balance.dissipation);
            // Without bounds it is −k sᵀs + sᵀw.
            let power = s[0] * w[0] + s[1] * w[1];
            let promised = 1.7 * (s[0] * s[0] + s[1] * s[1]) - power;
            assert!(balance.dissipation >= promised - 1e-12, "{seed}");
        }
    }
}

#[test]
fn prop_one_axis_is_the_law_for_one_axis() {
    let (chi, phi, psi) = (x(0) * x(1), vec![x(1), x(0).sin_of()], constant(2.0) + x(0).cos_of());
    let scalar = Formulas::new(2, &chi, phi.clone(), &psi).unwrap();
    let vector = VectorFormulas::new(2, vec![chi], vec![phi], vec![vec![psi]]).unwrap();
    let theta = vec![0.4, -0.9];
    for (seed, tracks) in (0..40).zip([false, true].into_iter().cycle()) {
        let guide = if tracks { tracking(&[1.0, 2.0]) } else { consensus(&[1.0, 2.0]) };
        let reference = if tracks { 1 } else { 2 };
        let one =
            Linearising::adaptive(scalar.clone(), following(guide.clone()), vec![3.0, 0.7], vec![0.1; 2]).unwrap();
        let several =
            VectorLinearising::adaptive(vector.clone(), following(guide), vec![3.0, 0.7], vec![0.1; 2]).unwrap();
        let (plant, plants) = (
            Chain { terms: scalar.clone(), theta: theta.clone() },
            VectorChain { terms: vector.clone(), theta: theta.clone() },
        );
        assert_eq!((one.states(), one.shown()), (several.states(), several.shown()));
        assert_eq!(
            (plant.states(), plant.inputs(), plant.outputs()),
            (plants.states(), plants.inputs(), plants.outputs())
        );
        let drawn = numbers(seed + 7, 2 + reference + 2);
        let target: &[Jet] = if tracks { &[[0.3, -0.2, 0.5, 0.0, 0.0]] } else { &[] };
        let a = close(&one, &plant, (&drawn[..2], &drawn[2..]), target, &[0.3], 1);
        let b = close(&several, &plants, (&drawn[..2], &drawn[2..]), target, &[0.3], 1);
        for (a, b) in [(a.input, b.input), (a.d_state, b.d_state), (a.shown, b.shown), (a.d_x, b.d_x)] {
            assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-13 * (1.0 + a.abs())) && a.len() == b.len());
        }
    }
}

#[test]
fn a_start_without_other_wishes_has_no_s_and_wishes_are_granted() {
    let law = VectorLinearising::adaptive(coupled(), following(consensus(&[1.0, 2.0])), vec![1.0; 2], vec![0.3, 0.4]);
    let law = law.unwrap();
    let x = [0.1, 0.2, 0.3, 0.4];
    let given = || ControllerInput {
        measured: law.see(&x).unwrap(),
        heard: Heard::new(&[1.2], &[0.0; 2], 2).unwrap(),
        target: Jets::NONE,
    };
    let mut state = [f64::NAN; 6];
    law.start(&mut law.scratch(), given(), &[], &mut state).unwrap();
    assert_eq!(state, [0.3, 0.4, 0.0, 0.0, 0.3, 0.4]);
    law.start(&mut law.scratch(), given(), &[vec![1.0, 2.0], vec![3.0, 4.0]], &mut state).unwrap();
    assert_eq!(state, [1.0, 2.0, 3.0, 4.0, 0.3, 0.4]);
    assert!(law.start(&mut law.scratch(), given(), &[vec![1.0]], &mut state).is_err());
}

#[test]
fn a_matrix_that_nears_one_without_an_inverse_is_told_by_its_smallest_singular_value() {
    // ψ has rows (x1, 1) and (1, x1): singular values |x1 + 1| and |x1 − 1|.
    let psi = vec![vec![x(0), constant(1.0)], vec![constant(1.0), x(0)]];
    let terms = VectorFormulas::new(1, vec![constant(0.0); 2], vec![Vec::new(); 2], psi).unwrap();
    let law =
        VectorLinearising::new(terms.clone(), Vec::new(), Following { floor: 0.05, ..following(consensus(&[1.0])) });
    let law = law.unwrap();
    let plant = VectorChain { terms, theta: Vec::new() };
    for (at, vanishes) in [(0.5, false), (0.94, false), (0.96, true), (1.04, true), (-0.97, true), (-1.5, false)] {
        let found = close(&law, &plant, (&[at, 0.0], &[0.1, 0.2, 0.0, 0.0]), &[], &[], 2);
        let smallest = (at.abs() - 1.0_f64).abs();
        assert!((found.shown[6] - smallest).abs() < 1e-12, "{at}: {:?}", found.shown);
        match law.trouble(&[0.1, 0.2, 0.0, 0.0], &found.shown) {
            Some(Singularity::Vanishes { signal: Signal::Divisor, value, floor, .. }) => {
                assert!(vanishes && value < floor, "{at}");
            }
            None => assert!(!vanishes, "{at}"),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let zero = || constant(0.0);
    let made = |chi: usize, psi: &[usize], regressor: &[usize]| {
        let rows = |lengths: &[usize]| lengths.iter().map(|columns| vec![zero(); *columns]).collect();
        VectorFormulas::new(1, vec![zero(); chi], rows(regressor), rows(psi)).map(|_| ())
    };
    assert_eq!(made(2, &[2, 2], &[1, 1]), Ok(()));
    assert_eq!(made(0, &[], &[]), Err(CascadeError::Empty));
    for (psi, regressor) in [(&[2][..], &[1, 1][..]), (&[2, 1], &[1, 1]), (&[2, 2], &[1]), (&[2, 2], &[1, 2])] {
        assert!(matches!(made(2, psi, regressor), Err(CascadeError::Length(_))), "{psi:?} {regressor:?}");
    }
    assert!(matches!(
        VectorFormulas::new(1, vec![x(1)], vec![Vec::new()], vec![vec![constant(1.0)]]),
        Err(CascadeError::Expression(_))
    ));
    assert_eq!(
        VectorFormulas::new(0, vec![zero()], vec![vec![]], vec![vec![zero()]]).map(|_| ()),
        Err(CascadeError::Empty)
    );

    let law = |gain_per_s, roots: &[f64], theta: usize| {
        let following = Following { gain_per_s, ..following(consensus(roots)) };
        VectorLinearising::new(coupled(), vec![0.0; theta], following).map(|_| ())
    };
    assert_eq!(law(1.0, &[1.0], 2), Ok(()));
    assert!(matches!(law(0.0, &[1.0], 2), Err(ChainError::Gain(_))));
    assert!(matches!(law(1.0, &[1.0], 1), Err(ChainError::Length(LengthError { .. }))));
    let plant = VectorChain { terms: coupled(), theta: vec![0.0; 2] };
    let rate = |state: usize, input: usize, w: usize| {
        plant.rate(&mut plant.scratch(), &vec![0.0; state], &vec![0.0; input], &vec![0.0; w], &mut vec![0.0; state])
    };
    assert_eq!((rate(4, 2, 0), rate(4, 2, 2)), (Ok(()), Ok(())));
    assert!(rate(3, 2, 0).is_err() && rate(4, 1, 0).is_err() && rate(4, 2, 1).is_err());
}
