//! Where expressions have a value.

use super::*;

fn y() -> Expression {
    Expression::variable(1)
}

fn one() -> Expression {
    Expression::number(1.0)
}

#[test]
fn what_is_never_divided_by_zero_has_a_value_everywhere() {
    for total in [
        one() / (x().cos_of() + 2.0),
        x() / (one() + x().power(2.0)),
        (x().exp_of() + 1.0).log_of(),
        x().exp_of().log_of(),
        one() / (-x().power(2.0)).exp_of(),
        (x().power(2.0) + y().power(2.0) + 0.1).sqrt_of(),
        (x().abs_of() + 1e-9).power(0.3),
        one() / (x() * y().sin_of() * 0.0 + 1.0),
        x().power(101.0),
        -x().power(3.0) - y() * y().abs_of(),
    ] {
        assert_eq!(total.domain(), Domain::Everywhere, "{total:?}");
    }
    // One pass does not tell these from zero; cutting, and series far away to both sides, do.
    for cut in [
        x() / (x().power(2.0) - x() + 1.0),
        one() / (x() * 0.5 + x().abs_of() + 1.0),
        (y().power(4.0) - y().power(3.0) + 1.0).sqrt_of(),
    ] {
        assert_eq!(cut.domain(), Domain::Everywhere, "{cut:?}");
    }
}

#[test]
fn poles_and_missing_values_are_found_with_their_state() {
    let fails = |expression: Expression| match expression.domain() {
        Domain::Fails { at, gap } => (at, gap),
        other => panic!("{expression:?}: {other:?}"),
    };
    let (at, gap) = fails(one() / (x() - 0.7));
    assert!((at[0] - 0.7).abs() < 1e-12 && gap == Gap::Pole);
    let (at, gap) = fails((y() * 2.0) + one() / (x() + y() * 3.0 - 1.0).tanh_of());
    assert!((at[0] + 3.0 * at[1] - 1.0).abs() < 1e-9 && gap == Gap::Pole, "{at:?}");
    assert_eq!(fails(one() / x().power(2.0)), (vec![0.0], Gap::Pole));
    assert_eq!(fails(x().power(-3.0)), (vec![0.0], Gap::Pole));
    assert_eq!(fails(x().log_of()), (vec![0.0], Gap::ZeroLogarithm));
    for (expression, gap) in
        [((x() - 0.6).sqrt_of(), Gap::Negative), (x().power(1.5), Gap::Negative), ((x() - 9.0).log_of(), Gap::Negative)]
    {
        let (at, found) = fails(expression.clone());
        assert_eq!(found, gap, "{expression:?}");
        assert!(expression.value(&at).is_nan(), "{at:?}");
    }
}

#[test]
fn neither_is_claimed_of_a_root_that_touches_zero_or_a_quotient_of_zeros() {
    for unclear in [x().sin_of() / x(), x().abs_of().sqrt_of(), (x().power(2.0) - x() * 2.0 + 1.0).sqrt_of()] {
        assert_eq!(unclear.domain(), Domain::NotShown, "{unclear:?}");
    }
}

#[test]
fn what_is_zero_nowhere_is_told_from_what_is_zero_somewhere() {
    let (within, nonzero) = (x().cos_of() + 2.0).everywhere();
    assert!(within == Interval { low: 1.0, high: 3.0 } && nonzero);
    let (within, nonzero) = (-x().power(2.0)).exp_of().everywhere();
    assert!(within.low == 0.0 && nonzero);
    assert!(!x().everywhere().1 && !x().cos_of().everywhere().1 && !x().power(2.0).everywhere().1);
    assert!(!(x().exp_of() - 1.0).everywhere().1 && !(x().power(3.0) - x() + 1.0).everywhere().1);
    assert!((x().power(2.0) - x() + 1.0).everywhere().1);
    assert_eq!((x() - 0.5).zero(), Some(vec![0.5]));
    assert_eq!((x().power(2.0) + 1.0).zero(), None);
}

fn any_of_two() -> impl Strategy<Value = Expression> {
    let leaf = prop_oneof![2 => Just(x()), 2 => Just(y()), 2 => any_decimal().prop_map(Expression::number)];
    let exponents = prop::sample::select(vec![2.0, 3.0, -1.0, -2.0, 0.5, 1.5]);
    leaf.prop_recursive(4, 12, 2, move |inner| {
        let unary = prop::sample::select(vec![Negate, Sin, Cos, Exp, Log, Sqrt, Abs, Tanh, Atan]);
        let binary = prop::sample::select(vec![Add, Subtract, Multiply, Divide, Divide, Min, Max]);
        prop_oneof![
            (inner.clone(), unary).prop_map(|(a, function)| then(a, Step::Unary(function))),
            (inner.clone(), inner.clone(), binary).prop_map(|(a, b, function)| both(a, b, function)),
            (inner, exponents.clone()).prop_map(|(a, exponent)| a.power(exponent)),
        ]
    })
}

proptest! {
    #[test]
    fn prop_nothing_that_has_a_value_everywhere_lacks_one_where_it_is_looked_for(
        formula in any_of_two(), states in prop::collection::vec((-3.0..3.0_f64, -3.0..3.0_f64), 60)
    ) {
        let (within, nonzero) = formula.everywhere();
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.5, 0.5), (2.0, 2.0), (-1.0, 1.0)];
        match formula.domain() {
            Domain::Everywhere => for (a, b) in states.into_iter().chain(corners) {
                // What overflows is lost to f64 alone.
                let value = formula.value(&[a, b]);
                let lost = formula.fold(&mut Intervals(&[Interval::point(a), Interval::point(b)]));
                prop_assert!(value.is_finite() || !lost.is_finite(), "{a} {b}: {value}");
                prop_assert!(!value.is_finite() || within.with_room(1e-9 * value.abs()).holds(value), "{within:?} {value}");
                prop_assert!(!nonzero || !lost.is_finite() || lost != Interval::point(0.0));
            },
            Domain::Fails { at, .. } => {
                // Around it there is no bound, or no value.
                let near = at.iter().map(|x| Interval::point(*x).with_room(1e-6)).chain([Interval::WHOLE; 2]);
                let near: Vec<Interval> = near.take(2).collect();
                prop_assert!(!formula.fold(&mut Intervals(&near)).is_finite(), "{at:?}");
            }
            Domain::NotShown => {}
        }
    }
}
