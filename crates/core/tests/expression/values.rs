//! Values in `f64`, constants as they were written, and what makes no expression.

use super::*;

#[test]
fn values_are_those_of_the_closed_forms() {
    for t in [0.0_f64, 0.3, 1.7, 12.5, 400.0] {
        let cases = [
            (x().sin_of() * 0.1 + 0.2, 0.2 + 0.1 * t.sin()),
            ((-x()).exp_of() - x().cos_of(), (-t).exp() - t.cos()),
            ((x() + 1.0).log_of() / x().sqrt_of(), (t + 1.0).ln() / t.sqrt()),
            (x().smaller(5.0).larger(x().tanh_of()), t.min(5.0).max(t.tanh())),
            ((x().power(3.0) + x().power(-2.0)).atan_of(), (t.powi(3) + t.powi(-2)).atan()),
            ((Expression::number(3.0) - x()).abs_of().power(1.5), (3.0 - t).abs().powf(1.5)),
        ];
        for (expression, wanted) in cases {
            let value = expression.eval(t);
            assert!(close(value, wanted, 1e-14), "{expression:?} {t}: {value} {wanted}");
        }
    }
}

#[test]
fn steps_that_make_no_value_are_refused() {
    let number = || Step::Number(1.0.into());
    assert_eq!(Expression::new(vec![]), Err(ExpressionError::Unbalanced));
    assert_eq!(Expression::new(vec![Step::Binary(Add)]), Err(ExpressionError::Unbalanced));
    assert_eq!(Expression::new(vec![number(), number()]), Err(ExpressionError::Unbalanced));
    assert_eq!(Expression::new(vec![Step::Number(f64::NAN.into())]), Err(ExpressionError::NotFinite));
    assert_eq!(Expression::new(vec![number(); 600]), Err(ExpressionError::TooLong { steps: 600 }));
    assert_eq!(Expression::new(vec![number(); 40]), Err(ExpressionError::Unbalanced));
    // However many wait.
    let mut steps = vec![number(); 200];
    steps.extend(vec![Step::Binary(Add); 199]);
    let sum = Expression::new(steps).unwrap();
    assert_eq!(sum.value(&[]), 200.0);
}

#[test]
fn an_expression_of_any_depth_is_folded() {
    let deep = (0..100).fold(x(), |inner, k| Expression::number(f64::from(k)) - inner);
    assert_eq!(deep.eval(0.25), (0..100).fold(0.25, |inner, k| f64::from(k) - inner));
    assert_eq!(deep.variables(), 1);
}

#[test]
fn decimals_are_kept_as_they_are_written() {
    let number = |text: &str| Number::decimal(text).unwrap();
    for text in
        ["0.1", "0.30000000000000004", "1e-3", "2.5E2", "12345678901234567890123456789", "1e22", ".5", "3.", "4e-300"]
    {
        assert_eq!(number(text).value(), text.parse::<f64>().unwrap(), "{text}");
        assert!(number(text).within().holds(number(text).value()));
    }
    assert_eq!(number("0.1").exact().unwrap(), "1/10".parse().unwrap());
    assert_eq!(number("2.5e2").exact().unwrap(), "250".parse().unwrap());
    assert_eq!(number("0.5"), 0.5.into());
    assert_ne!(number("0.1"), 0.1.into());
    let tenth = number("0.1").within();
    assert_eq!((tenth.low, tenth.high), (0.1_f64.next_down(), 0.1));
    assert!(Number::PI.exact().is_none() && Number::PI.within().holds(Number::PI.value()));
    let long = "1".repeat(MOST_DIGITS + 1);
    for text in ["", ".", "e3", "1e", "1e301", "1e-9999999999", "-1", "+1", "1_0", "0x1", "1.2.3", long.as_str()] {
        assert!(Number::decimal(text).is_none(), "{text}");
    }
}

#[test]
fn every_number_was_written_as_its_shortest_decimal() {
    let ratio = |text: &str| text.parse().unwrap();
    for (value, places) in [(1e-320, 320), (5e-324, 324), (-1e-305, 305)] {
        let size = value / f64::abs(value);
        let digit = if places == 324 { 5.0 } else { 1.0 };
        assert_eq!(Number::written(value), ratio(&format!("{}/1{}", size * digit, "0".repeat(places))), "{value:e}");
    }
    // Sixteen places after the point as well.
    let places = "0".repeat(316);
    assert_eq!(Number::written(1.234_567_890_123_456_4e-300), ratio(&format!("12345678901234564/1{places}")));
    assert_eq!(Number::written(1e308), ratio(&format!("1{}", "0".repeat(308))));
    assert_eq!(Number::written(-0.1), ratio("-1/10"));
    assert!([0.0, -0.0, f64::NAN, f64::INFINITY].into_iter().all(|value| Number::written(value) == ratio("0")));
}

#[test]
fn constants_are_exact_where_they_are_rational() {
    let zero = written("0.1") + written("0.2") - written("0.3");
    assert!(zero.eval(0.0) > 0.0, "in f64 it is not zero");
    assert_eq!(zero.constant().unwrap(), 0.0.into());
    let ninth = (written("1") / written("3")).power(2.0).constant().unwrap();
    assert_eq!(ninth.exact().unwrap(), "1/9".parse().unwrap());
    assert_eq!((-written("2")).abs_of().power(-3.0).constant().unwrap(), 0.125.into());
    let root = written("2").sqrt_of().constant().unwrap();
    assert!(root.exact().is_none() && root.within().holds(core::f64::consts::SQRT_2));
    assert!((written("1") / zero).constant().is_none() && x().constant().is_none());
    // Rounded before it grows beyond measure.
    let large = (0..6).fold(written("0.3"), |a, _| a.power(64.0)).constant().unwrap();
    assert!(large.exact().is_none() && large.within().high < 1e-300);
}
