//! Where branches change.

use core::f64::consts::PI;

use super::*;

fn kinks(expression: &Expression, to: f64) -> Vec<f64> {
    let switches = expression.switches(0.0, to).unwrap_or_else(|error| panic!("{expression:?}: {error}"));
    let mut all: Vec<f64> = switches.iter().flat_map(|switch| switch.at().to_vec()).collect();
    all.sort_by(f64::total_cmp);
    all
}

#[test]
fn kinks_are_found_to_the_last_bit() {
    let found = kinks(&x().sin_of().abs_of(), 100.0);
    assert_eq!(found.len(), 31);
    assert!(found.iter().zip(1..).all(|(at, k)| (at - PI * f64::from(k)).abs() <= 2e-14), "{found:?}");
    // A trapezium from four branches; each value is one of them.
    let trapezium = x().smaller(1.0).smaller(Expression::number(3.5) - x()).larger(0.0);
    assert_eq!(kinks(&trapezium, 10.0), [1.0, 2.5, 3.5]);
    assert_eq!(kinks(&(x() - 0.3).abs_of().sqrt_of(), 1.0), [0.3]);
    assert_eq!(kinks(&(x() - 1.0).power(3.0).abs_of(), 4.0).len(), 1);
    // Nested: the outer argument has kinks of its own.
    let nested = kinks(&((x() - 2.0).abs_of() - 1.0).abs_of(), 10.0);
    assert!(nested.len() == 3 && nested.iter().zip([1.0, 2.0, 3.0]).all(|(a, b)| (a - b).abs() < 1e-15), "{nested:?}");
}

#[test]
fn what_keeps_its_branch_has_no_kink() {
    for smooth in [
        x().power(2.0).abs_of(),
        (Expression::number(1.0) - x().cos_of()).abs_of(),
        (x().sin_of() - 1.0).larger(0.0),
        // It touches zero, and falls before and rises after.
        (x().power(2.0) - x() * 2.0 + 1.0).abs_of(),
        x().larger(x()),
        Expression::number(0.0).abs_of(),
        (x().sin_of() + 1.5).abs_of() + x().exp_of(),
        x().sin_of().larger(2.0),
    ] {
        assert!(kinks(&smooth, 50.0).is_empty(), "{smooth:?}");
    }
    // The ends are no kinks of what is between them.
    assert!(kinks(&x().sin_of().abs_of(), 3.0).is_empty());
}

/// Value and four derivatives on the piece that begins at `since`.
fn on_piece(expression: &Expression, switches: &[Switch], since: f64, at: f64) -> [f64; 5] {
    let mut jet = [0.0; 5];
    expression.derivatives_on(switches, since, at, &mut jet);
    jet
}

#[test]
fn a_piece_has_the_derivatives_of_its_side() {
    let bounce = x().sin_of().abs_of();
    let switches = bounce.switches(0.0, 10.0).unwrap();
    let at = switches[0].at()[0];
    let (before, after) = (on_piece(&bounce, &switches, 0.0, at), on_piece(&bounce, &switches, at, at));
    assert!((before[1] + 1.0).abs() < 1e-15 && (after[1] - 1.0).abs() < 1e-15, "{before:?} {after:?}");
    for (since, t) in [(0.0, 1.0), (0.0, 3.0), (at, 3.3), (at, 6.0)] {
        assert_eq!(on_piece(&bounce, &switches, since, t), bounce.jet(t));
    }
    // Every switch has a place of its own, in the order of the text.
    let both = (x() - 1.0).abs_of() + x().smaller(2.0) * (x() - 3.0).larger(0.0);
    let switches = both.switches(0.0, 5.0).unwrap();
    for (since, slope) in [(0.0, -1.0), (1.0, 1.0), (2.0, 1.0), (3.0, 3.0)] {
        assert_eq!(on_piece(&both, &switches, since, since)[1], slope, "{since}");
    }
}

#[test]
fn kinks_that_cannot_be_told_apart_are_refused() {
    let unclear = [
        // Accumulating, and staying at zero in a way that only algebra shows.
        (x() * (Expression::number(1.0) / (x() + 1e-9)).sin_of()).abs_of(),
        (x().sin_of().power(2.0) + x().cos_of().power(2.0) - 1.0).abs_of(),
    ];
    for expression in unclear {
        let error = expression.switches(0.0, 3.0).expect_err(&format!("{expression:?}"));
        assert!(matches!(error, KinkError::Unclear { near } if (0.0..3.0).contains(&near)), "{error}");
    }
    let many = (x() * 1e5).sin_of().abs_of().switches(0.0, 1.0).unwrap_err();
    assert_eq!(many, KinkError::TooMany);
}

proptest! {
    #[test]
    fn prop_between_kinks_the_pieces_are_the_expression(expression in any_expression(), shares in prop::collection::vec(0.0..1.0_f64, 20)) {
        let Ok(switches) = expression.switches(0.0, 4.0) else { return Ok(()) };
        for share in shares {
            let at = 4.0 * share;
            let (piece, jet) = (on_piece(&expression, &switches, at, at), expression.jet(at));
            let near = |switch: &Switch| switch.at().iter().any(|kink| (kink - at).abs() < 1e-9);
            let stable = expression.enclose_jet(Interval::point(at))[4].is_finite();
            if stable && !switches.iter().any(near) {
                prop_assert_eq!(piece, jet);
            }
        }
    }
}
