//! Derivatives of formulas as formulas, by the rules that a checker has: enclosed by its rules they tell what it will find.

use forwardstep_core::expression::{Algebra, Binary, Expression, Interval, Number, Unary};
use num_rational::BigRational;
use num_traits::{One, Zero};

/// A formula and its derivative by t; `None` where it has kinks.
#[derive(Clone, Debug)]
struct Slope {
    value: Expression,
    slope: Option<Expression>,
    /// Whether it is a quotient of polynomials, of which a checker knows the limits.
    rational: bool,
    form: Form,
}

/// What a formula is, as far as that matters for its slope under a root.
#[derive(Clone, Debug)]
enum Form {
    /// A number above zero.
    Positive(Number),
    /// x², by x.
    Square(Box<Slope>),
    /// c + x², c > 0, by c and x.
    Raised(Number, Box<Slope>),
    Other,
}

/// The derivative of a formula; `None` where it has kinks.
pub(super) fn slope(formula: &Expression) -> Option<Expression> {
    formula.fold(&mut Slopes).slope
}

/// A formula and its derivatives up to `order`; fewer where there are kinks.
pub(super) fn derivatives(formula: &Expression, order: usize) -> Vec<Expression> {
    std::iter::successors(Some(formula.clone()), slope).take(order + 1).collect()
}

/// What a formula keeps within on a bounded stretch of time: by one pass, and by the slope between its ends, or from the middle on.
pub(super) fn on_piece(formula: &Expression, slope: Option<&Expression>, t_s: Interval) -> Interval {
    let plain = formula.enclose(t_s);
    let Some(slope) = slope.map(|slope| slope.enclose(t_s)).filter(|_| plain.is_finite()) else { return plain };
    let at = |t_s: f64| formula.enclose(Interval::point(t_s));
    let middle = 0.5 * (t_s.low + t_s.high);
    let away = (t_s.high - middle).max(middle - t_s.low).next_up();
    let by_slope = match slope.low >= 0.0 || slope.high <= 0.0 {
        true => at(t_s.low).hull(at(t_s.high)),
        false => at(middle) + slope * Interval { low: -away, high: away },
    };
    let both = Interval { low: plain.low.max(by_slope.low), high: plain.high.min(by_slope.high) };
    if both.low <= both.high { both } else { plain }
}

/// The algebra of derivatives.
struct Slopes;

fn number(value: f64) -> Expression {
    Expression::number(value)
}

fn is(formula: &Expression, value: f64) -> bool {
    *formula == number(value)
}

fn plus(a: Expression, b: Expression) -> Expression {
    match () {
        () if is(&a, 0.0) => b,
        () if is(&b, 0.0) => a,
        () => a + b,
    }
}

fn times(a: Expression, b: Expression) -> Expression {
    match () {
        () if is(&a, 0.0) || is(&b, 0.0) => number(0.0),
        () if is(&a, 1.0) => b,
        () if is(&b, 1.0) => a,
        () => a * b,
    }
}

fn negated(a: Expression) -> Expression {
    if is(&a, 0.0) { a } else { -a }
}

impl Algebra for Slopes {
    type Value = Slope;

    fn number(&mut self, number_: &Number) -> Slope {
        let form = if number_.value() > 0.0 { Form::Positive(number_.clone()) } else { Form::Other };
        Slope { value: Expression::number(number_.clone()), slope: Some(number(0.0)), rational: true, form }
    }

    fn variable(&mut self, index: usize) -> Slope {
        Slope { value: Expression::variable(index), slope: Some(number(1.0)), rational: true, form: Form::Other }
    }

    fn unary(&mut self, function: Unary, a: Slope) -> Slope {
        let Slope { value: inner, slope, rational, form } = a;
        // Of √(c + x²) it is x' sin(atan(x/√c)), which stays bounded beside all that its own derivatives are made of.
        if let (Unary::Sqrt, Form::Raised(c, x)) = (function, form) {
            let angle = (x.value / Expression::number(c).sqrt_of()).under(Unary::Atan);
            let slope = x.slope.map(|slope| times(slope, angle.sin_of()));
            return Slope { value: inner.under(function), slope, rational: false, form: Form::Other };
        }
        let a = || inner.clone();
        let outer = match function {
            Unary::Negate => Some(number(-1.0)),
            Unary::Sin => Some(a().cos_of()),
            Unary::Cos => Some(-a().sin_of()),
            Unary::Exp => Some(a().exp_of()),
            Unary::Log => Some(number(1.0) / a()),
            Unary::Sqrt => Some(number(0.5) / a().sqrt_of()),
            Unary::Abs => None,
            Unary::Tanh => Some(number(1.0) - a().tanh_of().power(2.0)),
            Unary::Atan if rational => Some(number(1.0) / (number(1.0) + a().power(2.0))),
            // The same: as cos² it stays bounded beside all that its own derivatives are made of, whatever `a` does.
            Unary::Atan => Some(a().under(Unary::Atan).cos_of().power(2.0)),
        };
        let constant = slope.as_ref().is_some_and(|slope| is(slope, 0.0));
        let slope = if constant { slope } else { slope.zip(outer).map(|(slope, outer)| times(slope, outer)) };
        Slope {
            value: inner.under(function),
            slope,
            rational: rational && function == Unary::Negate,
            form: Form::Other,
        }
    }

    fn binary(&mut self, function: Binary, a: Slope, b: Slope) -> Slope {
        let (x, y) = (|| a.value.clone(), || b.value.clone());
        let slope = a.slope.clone().zip(b.slope.clone()).and_then(|(da, db)| match function {
            Binary::Add => Some(plus(da, db)),
            Binary::Subtract => Some(plus(da, negated(db))),
            Binary::Multiply => Some(plus(times(da, y()), times(x(), db))),
            Binary::Divide => {
                let first = if is(&da, 0.0) { da } else { da / y() };
                Some(plus(first, negated(times(x(), times(db, y().power(-2.0))))))
            }
            Binary::Min | Binary::Max if is(&da, 0.0) && is(&db, 0.0) => Some(number(0.0)),
            Binary::Min | Binary::Max => None,
        });
        let rational = a.rational && b.rational && !matches!(function, Binary::Min | Binary::Max);
        let form = match (function, a.form, b.form) {
            (Binary::Add, Form::Positive(c), Form::Square(x)) | (Binary::Add, Form::Square(x), Form::Positive(c)) => {
                Form::Raised(c, x)
            }
            _ => Form::Other,
        };
        Slope { value: a.value.with(b.value, function), slope, rational, form }
    }

    fn power(&mut self, a: Slope, exponent: &Number) -> Slope {
        let value = a.value.clone().power(exponent.clone());
        let form = if exponent.value() == 2.0 { Form::Square(Box::new(a.clone())) } else { Form::Other };
        let rational = a.rational && exponent.exact().is_some_and(|exponent| exponent.is_integer());
        let slope = a.slope.zip(exponent.exact()).map(|(slope, exponent)| {
            let one = BigRational::one();
            let less = &exponent - &one;
            let outer = match () {
                () if less.is_zero() => number(1.0),
                () if less.is_one() => times(number(2.0), a.value),
                () => {
                    let factor = Expression::number(Number::rational(exponent));
                    times(factor, a.value.power(Number::rational(less)))
                }
            };
            times(slope, outer)
        });
        Slope { value, slope, rational, form }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_those_that_jets_have() {
        let t = || Expression::variable(0);
        let turning = (t() * 2.0).sin_of() - t();
        let formulas = [
            t().under(Unary::Atan),
            turning.under(Unary::Atan),
            (-t()).exp_of().under(Unary::Atan),
            (t().power(2.0) + 1.0).sqrt_of(),
            (number(0.3) + ((t() * 1.7).sin_of() - t()).power(2.0)).sqrt_of(),
            (t().power(2.0) - 0.001).sqrt_of(),
            (t().power(3.0) + 1.0).sqrt_of(),
            t().tanh_of() / (t().cos_of() + 2.0),
            (t() + 2.0).log_of() * t().exp_of(),
        ];
        for formula in formulas {
            let slope = slope(&formula);
            for at in [0.1, 0.7, 1.9, 5.3] {
                let (found, expected) = (slope.as_ref().map(|slope| slope.eval(at)), formula.jet(at)[1]);
                let close = |found: f64| (found - expected).abs() < 1e-12 * (1.0 + expected.abs());
                assert!(found.is_some_and(close), "{formula:?} at {at}: {found:?} {expected}");
            }
        }
    }

    /// So do those of √(c + x²), by the same.
    #[test]
    fn three_derivatives_of_a_root_of_a_raised_square_are_bounded_whatever_is_inside() {
        let t = || Expression::variable(0);
        for inside in [t(), t() * 3.0 + 1.0, (t() * 1.3).sin_of() - t()] {
            let found = derivatives(&(inside.power(2.0) + 0.7).sqrt_of(), 3);
            let ever = Interval { low: 0.0, high: f64::INFINITY };
            let bounded = |each: &Expression| super::super::enclosure::late_or_whole(each, ever).is_finite();
            assert!(found.len() == 4 && found[1..].iter().all(bounded), "{found:?}");
        }
    }

    /// Derivatives of arctangents stay bounded: of a quotient by its limit, of anything else by its cosine.
    #[test]
    fn three_derivatives_of_an_arctangent_are_bounded_whatever_is_inside() {
        let t = || Expression::variable(0);
        for inside in [t(), t() * 3.0 + 1.0, (t() * 1.3).sin_of() - t()] {
            let found = derivatives(&inside.under(Unary::Atan), 3);
            let ever = Interval { low: 0.0, high: f64::INFINITY };
            let bounded = |each: &Expression| super::super::enclosure::late_or_whole(each, ever).is_finite();
            assert!(found.len() == 4 && found.iter().all(bounded), "{found:?}");
        }
    }
}
