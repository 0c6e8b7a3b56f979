//! What acts from outside enters every plant where its equations say: forces over masses, torques over inertias, disturbances as
//! they are.

use forwardstep_core::Gain;
use forwardstep_core::expression::Expression;
use forwardstep_core::plant::{
    Cascade, CascadeTerms, Chain, Formulas, Mechanical, Plant, Rotorcraft, Spacecraft, TaskArm, Vehicle, Wheels, total,
};
use forwardstep_core::robot::{Lagrangian, PlanarArm, PlanarLinks, PlanarTip};

/// What `external` adds to the rate of a state, and that other lengths are refused.
fn added<P: Plant>(plant: &P, external: &[f64]) -> Vec<f64> {
    let wave = |k: usize| (1.7 * k as f64 + 0.4).sin();
    let state: Vec<f64> = (0..total(&plant.states())).map(wave).collect();
    let input: Vec<f64> = (0..total(&plant.inputs())).map(|k| 2.0 * wave(k + 9)).collect();
    let rate = |external: &[f64]| {
        let mut rate = vec![f64::NAN; state.len()];
        plant.rate(&mut plant.scratch(), &state, &input, external, &mut rate).map(|()| rate)
    };
    for wrong in [external.len() - 1, external.len() + 1] {
        assert!(wrong == 0 || rate(&vec![0.0; wrong]).is_err(), "{wrong}");
    }
    assert_eq!(rate(&[]).unwrap(), rate(&vec![0.0; external.len()]).unwrap());
    rate(external).unwrap().iter().zip(rate(&[]).unwrap()).map(|(with, without)| with - without).collect()
}

fn close(got: &[f64], want: &[f64]) {
    assert_eq!(got.len(), want.len());
    assert!(got.iter().zip(want).all(|(got, want)| (got - want).abs() < 1e-12), "{got:?} is not {want:?}");
}

const INERTIA: [[f64; 3]; 3] = [[10.0, 0.5, -0.3], [0.5, 8.0, 0.2], [-0.3, 0.2, 6.0]];

fn times(matrix: [[f64; 3]; 3], x: &[f64]) -> Vec<f64> {
    matrix.iter().map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum()).collect()
}

#[test]
fn torques_move_an_arm_by_its_inertia() {
    let links = PlanarLinks::uniform([2.0, 1.0], [1.0, 0.8]);
    let arm = Mechanical { robot: PlanarArm, theta: links.theta().to_vec() };
    let got = added(&arm, &[3.0, -2.0]);
    let (q, mut mass) = ([0.4_f64.sin(), 2.1_f64.sin()], [0.0; 4]);
    Lagrangian::<f64>::mass_matrix(&PlanarArm, &mut (), &q, &arm.theta, &mut mass).unwrap();
    let [a, b] = [got[2], got[3]];
    close(&[got[0], got[1], mass[0] * a + mass[1] * b, mass[2] * a + mass[3] * b], &[0.0, 0.0, 3.0, -2.0]);
    let task = TaskArm { arm, tip: PlanarTip { length_m: links.length_m }, tip_theta: links.length_m.to_vec() };
    close(&added(&task, &[3.0, -2.0]), &got);
}

#[test]
fn forces_move_vehicles_by_their_mass_and_torques_turn_bodies_by_their_inertia() {
    let vehicle = Vehicle { mass: 1.6, gravity: 9.81 };
    let got = added(&vehicle, &[3.2, -1.6, 0.8]);
    close(&got, &[0.0, 0.0, 0.0, 2.0, -1.0, 0.5, 0.0, 0.0, 0.0, 0.0]);
    let craft = Rotorcraft::new(vehicle, &Gain::Matrix(INERTIA.as_flattened().to_vec()), None).unwrap();
    let turned = added(&craft, &[3.2, -1.6, 0.8, 0.3, -0.2, 0.5]);
    close(&turned[..10], &got);
    close(&times(INERTIA, &turned[10..]), &[0.3, -0.2, 0.5]);
    let spacecraft = Spacecraft::new(INERTIA, Wheels::orthogonal(), false).unwrap();
    let got = added(&spacecraft, &[0.3, -0.2, 0.5]);
    close(&times(INERTIA, &got[4..7]), &[0.3, -0.2, 0.5]);
    assert!(got[..4].iter().chain(&got[7..]).all(|rate| *rate == 0.0), "{got:?}");
}

#[test]
fn disturbances_enter_equations_as_they_are() {
    let x = Expression::variable;
    let terms = Formulas::new(3, &x(0), vec![x(1).sin_of()], &(x(2).cos_of() + 2.0)).unwrap();
    close(&added(&Chain { terms, theta: vec![0.7] }, &[0.25]), &[0.0, 0.0, 0.25]);
    let terms = CascadeTerms::strict(vec![vec![x(0).power(2.0)], vec![x(1)], vec![x(2)]]).unwrap();
    close(&added(&Cascade::new(terms, vec![0.7]).unwrap(), &[0.25, -0.5, 1.0]), &[0.25, -0.5, 1.0]);
}
