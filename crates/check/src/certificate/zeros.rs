//! Zeros of a quaternion in the strict sense, which a checker can replay: what numbers that are rounded come close to is no proof.

use forwardstep_core::expression::{Algebra, Binary, Expression, Interval, Number, Step, Unary};
use forwardstep_sim::trajectory::{LeastNorm, Trajectory};
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

use super::courses::Course;
use super::enclosure::late_or_whole;
use super::late::whole;
use super::limit::{Limit, limit};
use super::proof::Proof;

const FOR_EVER: Interval = Interval { low: 0.0, high: f64::INFINITY };
/// Denominators of the times that are tried.
const MOST_UNDER: f64 = 1e6;
/// Halves of the stretches, as parts of a time, at whose ends signs are compared.
const APART: [f64; 4] = [1e-9, 1e-7, 1e-5, 1e-3];

/// That all entries of a quaternion go to zero, that they are zero at a rational time, or that one of them passes zero while the others
/// are zero for ever or follow it.
pub(crate) fn vanishing(target: &Trajectory, end_s: f64) -> Option<Proof> {
    let quaternion = target.quaternion(target.axes().saturating_sub(4))?;
    let courses = quaternion.paths().iter().map(Course::of);
    let entries: Vec<Expression> = courses.map(|course| course.formula().cloned()).collect::<Option<_>>()?;
    if entries.iter().all(|entry| limit(entry) == Limit::Near(Interval::point(0.0))) {
        return Some(Proof::Fades);
    }
    let least = Some(quaternion.least_norm(end_s)).filter(LeastNorm::vanishes);
    let t_s = least.or_else(|| quaternion.vanishes_later(end_s))?.t_s;
    let zero_at =
        |t_s: &BigRational| entries.iter().all(|entry| value(entry, t_s).is_some_and(|value| value.is_zero()));
    let at = near(t_s).into_iter().find(zero_at).map(|at_s| Proof::Vanishes { at_s });
    at.or_else(|| changes_sign(&entries, t_s))
}

fn changes_sign(entries: &[Expression], t_s: f64) -> Option<Proof> {
    let idle = |entry: &Expression| late_or_whole(entry, FOR_EVER) == Interval::point(0.0);
    let entry = entries.iter().position(|entry| !idle(entry))?;
    let turning = &entries[entry];
    if !entries.iter().all(|other| idle(other) || core(other.steps()) == core(turning.steps())) {
        return None;
    }
    APART.into_iter().find_map(|part| {
        let room_s = part * t_s.max(1.0);
        let ends = [(t_s - room_s).max(0.0), t_s + room_s];
        let [before, after] = ends.map(|end| turning.enclose(Interval::point(end)));
        let turns = (before.low > 0.0 && after.high < 0.0) || (before.high < 0.0 && after.low > 0.0);
        let [from_s, to_s] = ends.map(Number::written);
        turns.then_some(Proof::ChangesSign { entry, from_s, to_s })
    })
}

/// What is left of a formula without the numbers that it is multiplied with; of sums they are not taken away.
fn core(steps: &[Step]) -> &[Step] {
    match bare(steps) {
        [.., Step::Binary(Binary::Add | Binary::Subtract)] => steps,
        core => core,
    }
}

fn bare(steps: &[Step]) -> &[Step] {
    match steps {
        [rest @ .., Step::Unary(Unary::Negate)]
        | [rest @ .., Step::Number(_), Step::Binary(Binary::Multiply | Binary::Divide)] => bare(rest),
        [Step::Number(_), rest @ .., Step::Binary(Binary::Multiply)] if Expression::new(rest.to_vec()).is_ok() => {
            bare(rest)
        }
        _ => steps,
    }
}

/// Rational numbers near a time, simple ones first: its continued fraction, broken off.
fn near(t_s: f64) -> Vec<BigRational> {
    let (mut found, mut rest) = (Vec::new(), t_s);
    let [mut over, mut under] = [[1.0, 0.0], [0.0, 1.0]];
    while found.len() < 20 && rest.is_finite() {
        let part = rest.floor();
        over = [part * over[0] + over[1], over[0]];
        under = [part * under[0] + under[1], under[0]];
        if under[0] > MOST_UNDER {
            break;
        }
        found.extend(ratio(over[0], under[0]));
        rest = 1.0 / (rest - part);
    }
    found
}

fn ratio(over: f64, under: f64) -> Option<BigRational> {
    Some(BigRational::from_float(over)? / BigRational::from_float(under)?)
}

/// The rational number that a formula is at a rational time, where the rules of a checker give one.
fn value(formula: &Expression, t_s: &BigRational) -> Option<BigRational> {
    formula.fold(&mut Rationals(t_s))
}

/// The algebra of rational numbers.
struct Rationals<'a>(&'a BigRational);

impl Algebra for Rationals<'_> {
    type Value = Option<BigRational>;

    fn number(&mut self, number: &Number) -> Option<BigRational> {
        number.exact()
    }

    fn variable(&mut self, _: usize) -> Option<BigRational> {
        Some(self.0.clone())
    }

    fn unary(&mut self, function: Unary, a: Option<BigRational>) -> Option<BigRational> {
        let a = a?;
        match function {
            Unary::Negate => Some(-a),
            Unary::Abs => Some(a.abs()),
            Unary::Sin | Unary::Tanh | Unary::Atan => a.is_zero().then_some(a),
            Unary::Cos | Unary::Exp => a.is_zero().then(BigRational::one),
            Unary::Log => a.is_one().then(BigRational::zero),
            Unary::Sqrt => {
                let root = (!a.is_negative()).then(|| BigRational::new(a.numer().sqrt(), a.denom().sqrt()))?;
                (&root * &root == a).then_some(root)
            }
        }
    }

    fn binary(&mut self, function: Binary, a: Option<BigRational>, b: Option<BigRational>) -> Option<BigRational> {
        let (a, b) = (a?, b?);
        match function {
            Binary::Add => Some(a + b),
            Binary::Subtract => Some(a - b),
            Binary::Multiply => Some(a * b),
            Binary::Divide => (!b.is_zero()).then(|| a / b),
            Binary::Min => Some(a.min(b)),
            Binary::Max => Some(a.max(b)),
        }
    }

    fn power(&mut self, a: Option<BigRational>, exponent: &Number) -> Option<BigRational> {
        let (a, n) = (a?, whole(exponent)?.to_i32()?);
        (n.abs() <= 8 && (n >= 0 || !a.is_zero())).then(|| a.pow(n))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_tried_as_simple_numbers() {
        let ratio = |p: i64, q: i64| BigRational::new(p.into(), q.into());
        for (p, q) in [(30, 1), (90, 1), (100, 3), (1, 7), (0, 1), (12_345, 1000)] {
            assert!(near(p as f64 / q as f64 + 1e-13).contains(&ratio(p, q)), "{p}/{q}");
        }
    }

    #[test]
    fn numbers_before_a_formula_do_not_matter() {
        let wave = || (Expression::variable(0) * 0.1).cos_of();
        let plain = wave();
        for scaled in [wave() * 3.0, Expression::number(-2.0) * wave(), -(wave() / 7.0)] {
            assert_eq!(core(scaled.steps()), plain.steps());
        }
        assert_ne!(core((wave() + 1.0).steps()), plain.steps());
        assert_ne!(core((wave() * wave()).steps()), plain.steps());
    }

    #[test]
    fn a_zero_is_passed_only_where_signs_on_both_sides_are_clear_and_differ() {
        let t = || Expression::variable(0);
        let zero = || Expression::number(0.0);
        let passes = |entry: Expression, t_s: f64| changes_sign(&[zero(), entry], t_s).is_some();
        let wave = || (t() * 0.1).cos_of();
        let quarter_s = 5.0 * std::f64::consts::PI;
        // It falls through zero, and its opposite rises.
        assert!(passes(wave(), quarter_s) && passes(-wave(), quarter_s));
        // Where it is only touched, or not met at all, from above and from below.
        for at_s in [2.0 * quarter_s, 1.0] {
            assert!(!passes(wave() + 1.0, at_s) && !passes(-(wave() + 1.0), at_s), "{at_s}");
        }
        // What is zero at one end has not passed: from the start on, and from one second on.
        assert!(!passes(t(), 0.0) && !passes(-t(), 0.0));
        let steps = [(-t() + 1.0).steps(), zero().steps(), &[Step::Binary(Binary::Max)]].concat();
        let ends = Expression::new(steps).unwrap_or_else(|_| t());
        assert_eq!([0.5, 2.0].map(|t_s| ends.value(&[t_s])), [0.5, 0.0]);
        assert!(!passes(ends.clone(), 1.0) && !passes(-ends, 1.0));
    }
}
