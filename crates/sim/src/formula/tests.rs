use proptest::prelude::*;

use super::FormulaStep::{self, *};
use super::*;

fn formula(steps: &[FormulaStep]) -> Formula {
    Formula::new(steps.to_vec()).unwrap()
}

/// Any formula of a few steps.
fn any_formula() -> impl Strategy<Value = Formula> {
    let leaf = prop_oneof![
        Just(vec![Time]),
        (-3.0..3.0_f64).prop_map(|value| vec![Number(value)]),
        prop::sample::select(vec![0.0, 1.0, -1.0, 0.5]).prop_map(|value| vec![Number(value)]),
    ];
    let tree = leaf.prop_recursive(5, 40, 2, |inner| {
        let unary = prop::sample::select(vec![
            Negate,
            Sin,
            Cos,
            Exp,
            Log,
            Sqrt,
            Abs,
            Tanh,
            Atan,
            Power(2.0),
            Power(3.0),
            Power(-1.0),
            Power(-2.0),
            Power(0.5),
            Power(1.7),
        ]);
        let binary = prop::sample::select(vec![Add, Subtract, Multiply, Divide, Min, Max]);
        prop_oneof![
            (inner.clone(), unary).prop_map(|(mut a, f)| {
                a.push(f);
                a
            }),
            (inner.clone(), inner, binary).prop_map(|(mut a, b, f)| {
                a.extend(b);
                a.push(f);
                a
            }),
        ]
    });
    tree.prop_map(|steps| Formula::new(steps).unwrap())
}

#[test]
fn values_are_those_of_the_closed_forms() {
    for t in [0.0_f64, 0.3, 1.7, 12.5, 400.0] {
        let cases = [
            (vec![Number(0.2), Number(0.1), Time, Sin, Multiply, Add], 0.2 + 0.1 * t.sin()),
            (vec![Time, Negate, Exp, Time, Cos, Subtract], (-t).exp() - t.cos()),
            (vec![Time, Number(1.0), Add, Log, Time, Sqrt, Divide], (t + 1.0).ln() / t.sqrt()),
            (vec![Time, Number(5.0), Min, Time, Tanh, Max], t.min(5.0).max(t.tanh())),
            (vec![Time, Power(3.0), Time, Power(-2.0), Add, Atan], (t.powi(3) + t.powi(-2)).atan()),
            (vec![Number(3.0), Time, Subtract, Abs, Power(1.5)], (3.0 - t).abs().powf(1.5)),
        ];
        for (steps, wanted) in cases {
            let value = formula(&steps).eval(t);
            let same = value == wanted || (value.is_nan() && wanted.is_nan());
            assert!(same || (value - wanted).abs() <= 1e-14 * (1.0 + wanted.abs()), "{steps:?} {t}: {value} {wanted}");
        }
    }
}

#[test]
fn steps_that_make_no_value_are_refused() {
    assert_eq!(Formula::new(vec![]), Err(FormulaError::Unbalanced));
    assert_eq!(Formula::new(vec![Add]), Err(FormulaError::Unbalanced));
    assert_eq!(Formula::new(vec![Time, Time]), Err(FormulaError::Unbalanced));
    assert_eq!(Formula::new(vec![Number(f64::NAN)]), Err(FormulaError::NotFinite));
    assert_eq!(Formula::new(vec![Time; 300]), Err(FormulaError::TooLong { steps: 300 }));
    assert_eq!(Formula::new(vec![Time; 40]), Err(FormulaError::TooDeep { waiting: 33 }));
}

#[test]
fn bounds_are_tight_where_t_appears_once() {
    let swing = formula(&[Number(0.3), Number(0.3), Time, Sin, Multiply, Add]);
    assert_eq!(swing.bounds(0.0, f64::INFINITY), Interval { low: 0.0, high: 0.6 });
    assert!(swing.is_bounded(0.0, f64::INFINITY) && swing.is_bounded(0.0, 1.0));
    let part = swing.bounds(0.0, 1.0);
    assert!(part.low >= 0.3 - 1e-12 && part.high <= 0.3 + 0.3 * 1.0_f64.sin() + 1e-12, "{part:?}");
    let fading = formula(&[Time, Negate, Exp]);
    assert_eq!(fading.bounds(0.0, f64::INFINITY).low, 0.0);
    assert!((fading.bounds(0.0, 2.0).low - (-2.0_f64).exp()).abs() < 1e-12);
    assert_eq!(formula(&[Time]).bounds(0.0, f64::INFINITY), Interval { low: 0.0, high: f64::INFINITY });
    assert!(!formula(&[Number(1.0), Time, Number(3.0), Subtract, Divide]).bounds(0.0, 10.0).is_finite());
    assert!(!formula(&[Time, Number(1.0), Subtract, Sqrt]).bounds(0.0, 10.0).is_finite());
    assert!(!formula(&[Time, Number(1.0), Subtract, Sqrt]).is_bounded(0.0, 10.0));
    // 1 / (t² − 2 t + 2), whose divisor one pass does not tell from zero.
    let hill = [&[Number(1.0), Time, Power(2.0), Number(2.0), Time, Multiply, Subtract, Number(2.0), Add, Divide][..]];
    let hill = formula(&hill.concat());
    assert!(!hill.enclose(Interval { low: 0.0, high: 10.0 }).is_finite() && hill.is_bounded(0.0, 10.0));
}

#[test]
fn cutting_narrows_what_one_pass_overestimates() {
    // t² − 6 t + 10 ≥ 1, where one pass over [0, 10] says ≥ −50.
    let parabola = formula(&[Time, Power(2.0), Number(6.0), Time, Multiply, Subtract, Number(10.0), Add]);
    assert_eq!(parabola.enclose(Interval { low: 0.0, high: 10.0 }).low, -50.0);
    let bounds = parabola.bounds(0.0, 10.0);
    assert!(bounds.low > 0.9 && bounds.low <= 1.0 && bounds.high >= 50.0 && bounds.high < 50.1, "{bounds:?}");
}

#[test]
fn uniform_continuity_is_shown_or_not_claimed() {
    let swing = |argument: &[FormulaStep]| [&[Number(0.2), Number(0.1)], argument, &[Sin, Multiply, Add]].concat();
    let turns = [Number(2.0), Number(core::f64::consts::PI), Multiply, Time, Multiply, Number(3.0), Divide];
    let square = [Time, Time, Multiply];
    let shown = [
        vec![Number(0.3)],
        swing(&turns),
        swing(&[Time, Sqrt]),
        swing(&[Time, Number(1.0), Add, Log]),
        // Products and quotients of swings.
        [swing(&turns), swing(&[Time]), vec![Multiply]].concat(),
        [swing(&turns), swing(&[Time]), vec![Divide]].concat(),
        // Slopes without a bound at t = 0, or on the way: continuous, bounded and monotone.
        vec![Time, Sqrt, Negate, Exp],
        vec![Time, Power(2.0), Negate, Exp],
        [vec![Number(1.0), Number(1.0)], square.to_vec(), vec![Add, Divide]].concat(),
        [square.to_vec(), vec![Tanh, Cos]].concat(),
        vec![Number(5.0), Time, Number(2.0), Multiply, Subtract, Power(3.0), Atan],
    ];
    for steps in shown {
        assert!(formula(&steps).is_uniformly_continuous(), "{steps:?}");
    }
    let not = [
        swing(&square),
        swing(&[Time, Power(1.5)]),
        swing(&[Time, Exp]),
        swing(&[Time, Time, Sin, Multiply]),
        [swing(&square), swing(&[Time]), vec![Multiply]].concat(),
        vec![Time, Power(2.0), Cos, Power(2.0)],
        vec![Time, Power(2.0), Cos, Number(2.0), Add, Power(-1.0)],
        // Not bounded, or without a value.
        vec![Time],
        vec![Number(1.0), Time, Number(3.0), Subtract, Divide],
    ];
    for steps in not {
        assert!(!formula(&steps).is_uniformly_continuous(), "{steps:?}");
    }
}

proptest! {
    #[test]
    fn prop_a_value_is_always_within_the_bounds(
        formula in any_formula(),
        from in 0.0..20.0_f64,
        length in prop::sample::select(vec![0.0, 1e-9, 0.1, 3.0, 50.0, 1e6]),
        shares in prop::collection::vec(0.0..=1.0_f64, 12),
    ) {
        let to = from + length;
        let bounds = formula.bounds(from, to);
        let once = formula.enclose(Interval { low: from, high: to });
        prop_assert!(bounds.low >= once.low && bounds.high <= once.high, "{:?} {:?}", bounds, once);
        for share in shares {
            let value = formula.eval((from + share * length).min(to));
            for interval in [bounds, once] {
                let inside = (interval.low..=interval.high).contains(&value);
                // Where the formula has no value, no finite bound may be claimed.
                prop_assert!(inside || value.is_nan() && !interval.is_finite(), "{} {:?}", value, interval);
            }
        }
    }

    #[test]
    fn prop_bounds_for_ever_hold_at_any_time(formula in any_formula(), t in 0.0..1e7_f64) {
        let bounds = formula.bounds(0.0, f64::INFINITY);
        let value = formula.eval(t);
        // Zero times a number that has overflowed is none.
        prop_assert!(value.is_nan() || (bounds.low..=bounds.high).contains(&value), "{} {:?}", value, bounds);
    }
}

proptest! {
    #[test]
    fn prop_derivatives_are_always_within_their_bounds(
        formula in any_formula(),
        from in 0.0..20.0_f64,
        length in prop::sample::select(vec![0.0, 1e-9, 0.1, 3.0, 50.0]),
        shares in prop::collection::vec(0.0..=1.0_f64, 12),
    ) {
        let to = from + length;
        let bounds = formula.enclose_jet(Interval { low: from, high: to });
        for share in shares {
            let t = (from + share * length).min(to);
            let jet = formula.jet(t);
            prop_assert!(jet[0] == formula.eval(t) || jet[0].is_nan() && formula.eval(t).is_nan());
            for k in 0..5 {
                let inside = (bounds[k].low..=bounds[k].high).contains(&jet[k]);
                prop_assert!(inside || jet[k].is_nan() && !bounds[k].is_finite(), "{} {} {:?}", k, jet[k], bounds[k]);
            }
        }
    }
}
