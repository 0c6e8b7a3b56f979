//! What intervals hold: what `f64` computes, and the real value.

use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

use super::*;

#[test]
fn bounds_are_tight_where_x_appears_once() {
    for third in [Expression::number(0.3), written("0.3")] {
        let swing = third.clone() + third * x().sin_of();
        assert_eq!(swing.bounds(0.0, f64::INFINITY).low, 0.0);
        assert!((swing.bounds(0.0, f64::INFINITY).high - 0.6).abs() <= 2e-16);
        assert_eq!(swing.bounds(0.0, 20.0).low, 0.0);
        assert!(swing.is_bounded(0.0, f64::INFINITY) && swing.is_bounded(0.0, 1.0));
        let part = swing.bounds(0.0, 1.0);
        assert!(part.low >= 0.3 - 1e-12 && part.high <= 0.3 + 0.3 * 1.0_f64.sin() + 1e-12, "{part:?}");
    }
    let fading = (-x()).exp_of();
    assert_eq!(fading.bounds(0.0, f64::INFINITY).low, 0.0);
    assert!((fading.bounds(0.0, 2.0).low - (-2.0_f64).exp()).abs() < 1e-12);
    assert_eq!(x().bounds(0.0, f64::INFINITY), Interval { low: 0.0, high: f64::INFINITY });
    assert!(!(Expression::number(1.0) / (x() - 3.0)).bounds(0.0, 10.0).is_finite());
    assert!(!(x() - 1.0).sqrt_of().bounds(0.0, 10.0).is_finite());
    assert!(!(x() - 1.0).sqrt_of().tanh_of().is_bounded(0.0, 10.0));
    // 1 / (x² − 2 x + 2), whose divisor one pass does not tell from zero.
    let hill = Expression::number(1.0) / (x().power(2.0) - x() * 2.0 + 2.0);
    assert!(!hill.enclose(Interval { low: 0.0, high: 10.0 }).is_finite() && hill.is_bounded(0.0, 10.0));
}

#[test]
fn cutting_narrows_what_one_pass_overestimates() {
    // x² − 6 x + 10 ≥ 1, where one pass over [0, 10] says ≥ −50.
    let parabola = x().power(2.0) - x() * 6.0 + 10.0;
    assert_eq!(parabola.enclose(Interval { low: 0.0, high: 10.0 }).low, -50.0);
    let bounds = parabola.bounds(0.0, 10.0);
    assert!(bounds.low > 0.9 && bounds.low <= 1.0 && bounds.high >= 50.0 && bounds.high < 50.1, "{bounds:?}");
}

#[test]
fn a_slope_tells_the_sign_of_what_begins_or_ends_at_zero_and_narrows_what_cancels() {
    let rising = x().under(Unary::Atan) + x().sin_of();
    assert_eq!(rising.bounds(0.0, 60.0).low, 0.0);
    assert_eq!((-rising).bounds(0.0, 60.0).high, 0.0);
    let falling = Expression::number(1.0) - x().power(3.0) + (Expression::number(1.0) - x()).sin_of();
    assert_eq!(falling.bounds(0.0, 1.0).low, 0.0);
    assert_eq!(x().cos_of().bounds_of_derivatives(&[0.0, -1.0], 0.0, 3.0).low, 0.0);
    // √(x² + 1) − x comes to 0.0083 at 60.
    let left = ((x().power(2.0) + 1.0).sqrt_of() - x()).bounds(0.0, 60.0);
    assert!(left.low > 0.008 && left.low < 0.0084 && left.high < 1.001, "{left:?}");
    // What rises on both sides of a pole is not bounded by its ends, nor an arctangent of it.
    for pole in [Expression::number(-1.0) / (x() - 3.0), (x() - 3.0).power(-1.0), (x() - 3.0).power(-3.0)] {
        assert!(!pole.bounds(0.0, 10.0).is_finite() && !pole.under(Unary::Atan).bounds(0.0, 10.0).is_finite());
    }
}

#[test]
fn exact_results_are_not_widened_and_others_are_on_the_side_of_the_truth() {
    let at = |e: &Expression| e.enclose(Interval::point(0.0));
    let tenth = || Expression::number(0.1);
    assert_eq!(at(&(Expression::number(0.5) * 0.25 + 2.0 - 1.0)), Interval::point(1.125));
    assert_eq!(at(&(Expression::number(9.0).sqrt_of() / 4.0)), Interval::point(0.75));
    // One neighbour, not two: the f64 0.1 is above 1/10, so that three of them are above 0.3.
    let three = at(&(tenth() * 3.0));
    assert_eq!(three.low.next_up(), three.high);
    assert!(at(&(Expression::number(1.0) / 3.0)).low < at(&(Expression::number(1.0) / 3.0)).high);
    // Beyond the largest f64 there are numbers still.
    let huge = Expression::number(f64::MAX) * x();
    let product = huge.fold(&mut Intervals(&[Interval { low: 2.0, high: f64::INFINITY }]));
    assert_eq!(product, Interval { low: f64::MAX, high: f64::INFINITY });
    assert_eq!(at(&(Expression::number(1e308) * 1e308)), Interval::WHOLE);
}

#[test]
fn functions_that_rise_stay_on_their_side_of_where_they_are_exact() {
    for (function, at, value) in
        [(Unary::Tanh, 0.0, 0.0), (Unary::Atan, 0.0, 0.0), (Unary::Log, 1.0, 0.0), (Unary::Exp, 0.0, 1.0)]
    {
        let of = |low: f64, high: f64| then(x(), Step::Unary(function)).bounds(low, high);
        assert_eq!((of(at, at + 3.0).low, of(at - 0.5, at).high), (value, value), "{function:?}");
        // On the other side, and across, they are widened as ever.
        let (below, across) = (of(at - 0.5, at - 0.25), of(at - 0.5, at + 0.5));
        assert!(below.high < value && across.low < value && across.high > value, "{function:?}");
    }
}

#[test]
fn without_a_value_nothing_is_claimed_whatever_is_done_with_it() {
    let on = |low, high| Interval { low, high };
    let cases = [
        (x().log_of(), on(0.0, 1.0)),
        (x().log_of(), on(-1.0, 1.0)),
        (x().sqrt_of(), on(-1e-300, 1.0)),
        (x().power(0.5), on(-1e-300, 1.0)),
        (x().power(-0.5), on(0.0, 1.0)),
        (x().power(-1.0), on(-1.0, 0.0)),
        (x().power(-2.0), on(-1.0, 1.0)),
        (Expression::number(1.0) / x(), on(0.0, 1.0)),
        (Expression::number(0.0) / x(), on(-1.0, 1.0)),
        (Expression::number(1.0) / (x() - x()), on(1.0, 2.0)),
        ((x() * 1000.0).exp_of(), on(1.0, 2.0)),
    ];
    for (inner, within) in cases {
        for outer in [inner.clone().tanh_of(), inner.clone().smaller(1.0), inner.clone() * 0.0, inner.cos_of()] {
            assert_eq!(outer.enclose(within), Interval::WHOLE, "{outer:?}");
            assert!(outer.enclose_jet(within).iter().all(|c| *c == Interval::WHOLE), "{outer:?}");
        }
    }
    assert_eq!(x().sqrt_of().enclose(on(0.0, 4.0)), on(0.0, 2.0));
    assert!(x().sqrt_of().enclose_jet(on(0.0, 4.0))[1] == Interval::WHOLE);
}

#[test]
fn uniform_continuity_is_shown_or_not_claimed() {
    let swing = |argument: Expression| argument.sin_of() * 0.1 + 0.2;
    let one = || Expression::number(1.0);
    let turns = || Expression::number(2.0) * core::f64::consts::PI * x() / 3.0;
    let square = || x() * x();
    let shown = [
        Expression::number(0.3),
        swing(turns()),
        swing(x().sqrt_of()),
        swing((x() + 1.0).log_of()),
        // Products and quotients of swings.
        swing(turns()) * swing(x()),
        swing(turns()) / swing(x()),
        // Slopes without a bound at 0, or on the way: continuous, bounded and monotone.
        (-x().sqrt_of()).exp_of(),
        (-x().power(2.0)).exp_of(),
        one() / (one() + square()),
        square().tanh_of().cos_of(),
        (Expression::number(5.0) - x() * 2.0).power(3.0).atan_of(),
    ];
    for expression in shown {
        assert!(expression.is_uniformly_continuous(), "{expression:?}");
    }
    let not = [
        swing(square()),
        swing(x().power(1.5)),
        swing(x().exp_of()),
        swing(x() * x().sin_of()),
        swing(square()) * swing(x()),
        x().power(2.0).cos_of().power(2.0),
        (x().power(2.0).cos_of() + 2.0).power(-1.0),
        // Not bounded, or without a value.
        x(),
        one() / (x() - 3.0),
    ];
    for expression in not {
        assert!(!expression.is_uniformly_continuous(), "{expression:?}");
    }
}

/// The exact value of what has one.
struct Rationals(BigRational);

impl Algebra for Rationals {
    type Value = Option<BigRational>;

    fn number(&mut self, number: &Number) -> Self::Value {
        number.exact()
    }
    fn variable(&mut self, _: usize) -> Self::Value {
        Some(self.0.clone())
    }
    fn unary(&mut self, function: Unary, a: Self::Value) -> Self::Value {
        match function {
            Negate => a.map(|a| -a),
            Abs => a.map(|a| a.abs()),
            _ => None,
        }
    }
    fn binary(&mut self, function: Binary, a: Self::Value, b: Self::Value) -> Self::Value {
        let (a, b) = a.zip(b)?;
        match function {
            Add => Some(a + b),
            Subtract => Some(a - b),
            Multiply => Some(a * b),
            Divide => (!b.is_zero()).then(|| a / b),
            Min => Some(a.min(b)),
            Max => Some(a.max(b)),
        }
    }
    fn power(&mut self, a: Self::Value, exponent: &Number) -> Self::Value {
        a.filter(|a| !a.is_zero()).map(|a| a.pow(exponent.value() as i32))
    }
}

fn holds(within: Interval, exact: &BigRational) -> bool {
    let below = |low: f64| BigRational::from_float(low).is_none_or(|low| low <= *exact);
    let above = |high: f64| BigRational::from_float(high).is_none_or(|high| high >= *exact);
    below(within.low) && above(within.high)
}

/// Σ of a series whose terms shrink to at most half of the one before from some point on, with what is left.
fn series(mut term: BigRational, next: impl Fn(u32, BigRational) -> BigRational) -> [BigRational; 2] {
    let small = BigRational::new(One::one(), num_traits::pow(10.into(), 40));
    let (mut sum, mut k) = (BigRational::zero(), 0);
    while term.abs() > small {
        sum += &term;
        k += 1;
        term = next(k, term);
    }
    [&sum - &small * BigRational::from_integer(4.into()), sum + small * BigRational::from_integer(4.into())]
}

/// e^a, sin a, cos a, arctan a, log (1 + a) and tanh a for a small rational a, enclosed by series.
fn known(a: &BigRational) -> [(Unary, [BigRational; 2]); 6] {
    let integer = |k: u32| BigRational::from_integer(k.into());
    let square = a * a;
    let exp = series(One::one(), |k, term| term * a / integer(k));
    let sin = series(a.clone(), |k, term| -term * &square / integer(2 * k * (2 * k + 1)));
    let cos = series(One::one(), |k, term| -term * &square / integer(2 * k * (2 * k - 1)));
    let atan = series(a.clone(), |k, term| -term * &square * integer(2 * k - 1) / integer(2 * k + 1));
    let log = series(a.clone(), |k, term| -term * a * integer(k) / integer(k + 1));
    // 1 − 2/(e^2a + 1), which rises with e^a.
    let tanh = exp.clone().map(|e| {
        let square = &e * &e;
        (&square - integer(1)) / (square + integer(1))
    });
    [(Exp, exp), (Sin, sin), (Cos, cos), (Atan, atan), (Log, log), (Tanh, tanh)]
}

proptest! {
    #[test]
    fn prop_a_value_is_always_within_the_bounds(
        expression in any_expression(),
        from in 0.0..20.0_f64,
        length in prop::sample::select(vec![0.0, 1e-9, 0.1, 3.0, 50.0, 1e6]),
        shares in prop::collection::vec(0.0..=1.0_f64, 12),
    ) {
        let to = from + length;
        let bounds = expression.bounds(from, to);
        let once = expression.enclose(Interval { low: from, high: to });
        prop_assert!(bounds.low >= once.low && bounds.high <= once.high, "{:?} {:?}", bounds, once);
        for share in shares {
            let at = (from + share * length).min(to);
            let value = expression.eval(at);
            // Where the expression has no value, no finite bound may be claimed.
            prop_assert!(once.holds(value) || value.is_nan() && !once.is_finite(), "{} {:?}", value, once);
            // A pass in rational numbers may be tighter than f64 is exact: there the real value counts.
            let real = expression.enclose(Interval::point(at));
            let meet = real.low <= bounds.high && real.high >= bounds.low;
            prop_assert!(meet && (!value.is_nan() || !bounds.is_finite()), "{} {:?} {:?}", value, real, bounds);
        }
    }

    #[test]
    fn prop_bounds_for_ever_hold_everywhere(expression in any_expression(), x in 0.0..1e7_f64) {
        let once = expression.enclose(Interval { low: 0.0, high: f64::INFINITY });
        let value = expression.eval(x);
        // Zero times a number that has overflowed is none.
        prop_assert!(value.is_nan() || once.holds(value), "{} {:?}", value, once);
    }

    #[test]
    fn prop_the_real_value_is_within_the_bounds(
        expression in any_of(
            [vec![Step::Unary(Negate), Step::Unary(Abs)], powers(&[2.0, 3.0, -1.0, -2.0])].concat(),
            vec![Add, Subtract, Multiply, Divide, Min, Max],
        ),
        at in any_decimal(),
    ) {
        let Some(exact) = expression.fold(&mut Rationals(at.exact().unwrap())) else { return Ok(()) };
        let within = at.within();
        prop_assert!(holds(expression.enclose(within), &exact), "{:?}", expression.enclose(within));
        prop_assert!(holds(expression.bounds(within.low, within.high), &exact));
        let jet = expression.enclose_jet(within)[0];
        prop_assert!(holds(jet, &exact), "{:?}", jet);
    }

    #[test]
    fn prop_functions_enclose_the_real_ones(digits in -500..=500_i32, places in 3..9_u32) {
        let a = BigRational::new(digits.into(), num_traits::pow(10.into(), places as usize));
        let argument = Number::rational(a.clone()).within();
        for (function, truth) in known(&a) {
            let expression = if function == Log { (x() + 1.0).log_of() } else { then(x(), Step::Unary(function)) };
            let within = expression.enclose(argument);
            // The truth is known to forty places; cos 0 is 1, and not a number above it.
            let around = |low, high| Interval { low, high };
            let holds = holds(around(within.low, f64::INFINITY), &truth[1])
                && holds(around(f64::NEG_INFINITY, within.high), &truth[0]);
            prop_assert!(holds, "{:?} {:?}", function, within);
            // And not by much more than needed.
            prop_assert!(within.high - within.low <= 1e-10, "{:?} {:?}", function, within);
        }
    }

    #[test]
    fn prop_derivatives_are_always_within_their_bounds(
        expression in any_expression(),
        from in 0.0..20.0_f64,
        length in prop::sample::select(vec![0.0, 1e-9, 0.1, 3.0, 50.0]),
        shares in prop::collection::vec(0.0..=1.0_f64, 12),
    ) {
        let to = from + length;
        let bounds = expression.enclose_jet(Interval { low: from, high: to });
        for share in shares {
            let at = (from + share * length).min(to);
            let (jet, value) = (expression.jet(at), expression.eval(at));
            prop_assert!(jet[0] == value || jet[0].is_nan() && value.is_nan());
            for k in 0..5 {
                let inside = bounds[k].holds(jet[k]);
                prop_assert!(inside || jet[k].is_nan() && !bounds[k].is_finite(), "{} {} {:?}", k, jet[k], bounds[k]);
            }
        }
    }
}
