//! Gains as users state them.

use forwardstep_core::{Gain, GainError, InverseQuadratic, LengthError, ResolvedGain};

#[test]
fn regress_gains_resolve() {
    let diagonal = |k: &[f64]| Ok(ResolvedGain::Diagonal(k.to_vec()));
    assert_eq!(Gain::Number(8.0).resolve(3, &[]), diagonal(&[8.0; 3]));
    assert_eq!(Gain::Number(8.0).resolve(0, &[]), diagonal(&[]));
    assert_eq!(Gain::Diagonal(vec![1.0, 2.0]).resolve(2, &[]), diagonal(&[1.0, 2.0]));
    assert_eq!(Gain::Bandwidth(20.0).resolve(2, &[0.5, 0.1]), diagonal(&[10.0, 2.0]));
    let entries = vec![2.0, 1.0, 1.0, 2.0];
    let matrix = Gain::Matrix(entries.clone()).resolve(2, &[]).unwrap();
    assert_eq!(matrix, ResolvedGain::Matrix { size: 2, entries });
    assert_eq!(matrix.size(), 2);

    let mut out = [0.0; 2];
    matrix.apply(&[1.0, -3.0], &mut out);
    assert_eq!(out, [-1.0, -5.0]);
    // gain⁻¹ = [2 −1; −1 2] / 3
    assert!((InverseQuadratic::new(&matrix).unwrap().of(&[1.0, -3.0]) - 26.0 / 3.0).abs() < 1e-14);
    let diagonal = ResolvedGain::Diagonal(vec![2.0, 4.0]);
    diagonal.apply(&[1.0, -3.0], &mut out);
    assert_eq!(out, [2.0, -12.0]);
    assert_eq!(InverseQuadratic::new(&diagonal).unwrap().of(&[1.0, -3.0]), 0.5 + 2.25);
}

#[test]
fn regress_gains_that_are_none() {
    let wrong = |what, need, got| Err(GainError::Length(LengthError { what, need, got }));
    assert_eq!(Gain::Diagonal(vec![1.0]).resolve(2, &[]), wrong("gain diagonal", 2, 1));
    assert_eq!(Gain::Matrix(vec![1.0; 3]).resolve(2, &[]), wrong("gain matrix", 4, 3));
    assert_eq!(Gain::Number(0.0).resolve(2, &[]), Err(GainError::NotPositive { index: 0, value: 0.0 }));
    assert!(matches!(Gain::Number(f64::NAN).resolve(2, &[]), Err(GainError::NotPositive { index: 0, .. })));
    assert!(matches!(Gain::Number(f64::INFINITY).resolve(2, &[]), Err(GainError::NotPositive { index: 0, .. })));
    assert_eq!(Gain::Diagonal(vec![1.0, -2.0]).resolve(2, &[]), Err(GainError::NotPositive { index: 1, value: -2.0 }));
    assert_eq!(
        Gain::Matrix(vec![1.0, 0.5, 0.4, 1.0]).resolve(2, &[]),
        Err(GainError::NotSymmetric { row: 0, column: 1, upper: 0.5, lower: 0.4 })
    );
    let refuted = |entries: [f64; 4]| Gain::Matrix(entries.to_vec()).resolve(2, &[]).unwrap_err().to_string();
    let words = "the matrix is not positive definite: vᵀ A v =";
    assert_eq!(refuted([1.0, 2.0, 2.0, 1.0]), format!("{words} -3 for v = (-2, 1)"));
    assert_eq!(refuted([0.0, 0.0, 0.0, 1.0]), format!("{words} 0 for v = (1, 0)"));
    // Exactly singular, though every pivot of a factor in f64 may come out positive.
    assert_eq!(refuted([0.1, 0.3, 0.3, 0.9]), format!("{words} 0 for v = (-3, 1)"));
    // Positive definite, but not to rounding.
    let nearly = Gain::Matrix(vec![3.0, 1.0, 1.0, 0.33333333333333337]).resolve(2, &[]);
    assert_eq!(nearly, Err(GainError::NearlySingular { order: 2 }));
    assert!(Gain::Matrix(vec![f64::NAN; 4]).resolve(2, &[]).is_err());
    assert_eq!(
        Gain::Bandwidth(20.0).resolve(2, &[1.0]),
        Err(GainError::NoScale { bandwidth_per_s: 20.0, need: 2, got: 1 })
    );
    // Two negative factors do not make a gain.
    assert_eq!(Gain::Bandwidth(-20.0).resolve(1, &[-1.0]), Err(GainError::NotPositive { index: 0, value: -20.0 }));
    assert_eq!(Gain::Bandwidth(20.0).resolve(2, &[1.0, 0.0]), Err(GainError::NotPositive { index: 1, value: 0.0 }));
}

#[test]
fn regress_a_matrix_of_no_rows_does_nothing() {
    let none = Gain::Matrix(Vec::new()).resolve(0, &[]).unwrap();
    let mut out = [3.0];
    none.apply(&[], &mut out);
    none.subtract_from(&[], &mut out);
    none.solve(&mut out);
    assert_eq!((out, InverseQuadratic::new(&none).unwrap().of(&[2.0])), ([3.0], 0.0));
}
