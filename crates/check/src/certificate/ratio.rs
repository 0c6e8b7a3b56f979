//! Quotients of polynomials in t, and what they do for large t.
//!
//! Intervals alone make ∞/∞ of t/(1 + t). With d the larger degree and u = 1/t, P(t)/Q(t) is (Σ pₖ u^(d−k))/(Σ qₖ u^(d−k)), and u
//! keeps within [0, 1/T] from T on.

use forwardstep_core::expression::{Interval, Number};
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

/// Polynomials have at most this degree.
const MOST_DEGREE: usize = 24;
/// Powers are multiplied out up to this one.
const MOST_POWER: i64 = 8;

/// P/Q, by coefficients from t⁰ on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ratio {
    over: Vec<BigRational>,
    under: Vec<BigRational>,
}

fn convolved(a: &[BigRational], b: &[BigRational]) -> Vec<BigRational> {
    let mut found = vec![BigRational::zero(); (a.len() + b.len()).saturating_sub(1)];
    for (i, x) in a.iter().enumerate() {
        for (entry, y) in found.iter_mut().skip(i).zip(b) {
            *entry += x * y;
        }
    }
    found
}

fn added(a: &[BigRational], b: &[BigRational]) -> Vec<BigRational> {
    let zero = BigRational::zero();
    let at = |list: &[BigRational], k: usize| list.get(k).unwrap_or(&zero).clone();
    (0..a.len().max(b.len())).map(|k| at(a, k) + at(b, k)).collect()
}

fn derivative(a: &[BigRational]) -> Vec<BigRational> {
    let scaled = a.iter().enumerate().skip(1).map(|(k, x)| x * BigRational::from_integer(k.into()));
    scaled.collect()
}

fn trimmed(mut a: Vec<BigRational>) -> Vec<BigRational> {
    while a.last().is_some_and(Zero::is_zero) {
        a.pop();
    }
    a
}

/// What a polynomial, by coefficients from the highest power on, keeps within from 0 to an end: its Bernstein coefficients there,
/// bⱼ = Σₖ C(j, k)/C(n, k) cₖ endᵏ.
fn bernstein(falling: &[BigRational], end: f64) -> Interval {
    let Some(end) = BigRational::from_float(end) else { return Interval::WHOLE };
    let n = falling.len().saturating_sub(1);
    // cₖ endᵏ/C(n, k), of which b₀ is the first; each difference scheme adds the neighbour once: that is C(j, k).
    let (mut row, mut power, mut choices) = (Vec::new(), BigRational::one(), BigRational::one());
    for (k, c) in falling.iter().rev().enumerate() {
        row.push(c * &power / &choices);
        power *= &end;
        choices = choices * BigRational::from_integer((n - k).into()) / BigRational::from_integer((k + 1).into());
    }
    let mut found: Option<Interval> = None;
    while let Some(first) = row.first() {
        let within = Number::rational(first.clone()).within();
        found = Some(found.map_or(within, |found| found.hull(within)));
        row = row.windows(2).map(|pair| &pair[0] + &pair[1]).collect();
    }
    found.unwrap_or(Interval::point(0.0))
}

impl Ratio {
    fn new(over: Vec<BigRational>, under: Vec<BigRational>) -> Option<Ratio> {
        let [over, under] = [trimmed(over), trimmed(under)];
        (over.len().max(under.len()) <= MOST_DEGREE + 1).then_some(Ratio { over, under })
    }

    pub(super) fn number(number: BigRational) -> Ratio {
        Ratio { over: trimmed(vec![number]), under: vec![BigRational::one()] }
    }

    pub(super) fn negated(&self) -> Ratio {
        Ratio { over: self.over.iter().map(|x| -x).collect(), under: self.under.clone() }
    }

    pub(super) fn plus(&self, other: &Ratio) -> Option<Ratio> {
        let over = added(&convolved(&self.over, &other.under), &convolved(&other.over, &self.under));
        Ratio::new(over, convolved(&self.under, &other.under))
    }

    pub(super) fn times(&self, other: &Ratio) -> Option<Ratio> {
        Ratio::new(convolved(&self.over, &other.over), convolved(&self.under, &other.under))
    }

    /// Q/P as Q²/(P Q), so that no pole is lost.
    pub(super) fn inverse(&self) -> Option<Ratio> {
        Ratio::new(convolved(&self.under, &self.under), convolved(&self.over, &self.under))
    }

    pub(super) fn power(&self, exponent: i64) -> Option<Ratio> {
        let base = if exponent < 0 { self.inverse()? } else { self.clone() };
        let times = |so_far: Ratio, _| so_far.times(&base);
        (exponent.abs() <= MOST_POWER).then_some(())?;
        (0..exponent.abs()).try_fold(Ratio::number(BigRational::one()), times)
    }

    /// (P′Q − PQ′)/Q².
    pub(super) fn derivative(&self) -> Option<Ratio> {
        let minus: Vec<BigRational> = convolved(&self.over, &derivative(&self.under)).into_iter().map(|x| -x).collect();
        let over = added(&convolved(&derivative(&self.over), &self.under), &minus);
        Ratio::new(over, convolved(&self.under, &self.under))
    }

    /// t.
    pub(super) fn time() -> Ratio {
        Ratio { over: vec![Zero::zero(), One::one()], under: vec![One::one()] }
    }

    /// Its limit as t → ∞: what encloses it, else whether it rises above every bound; `None` where Q is zero.
    pub(super) fn limit(&self) -> Option<Result<Interval, bool>> {
        let (lead, below) = (self.over.last(), self.under.last()?);
        Some(match lead {
            Some(lead) if self.over.len() > self.under.len() => Err((lead / below).is_positive()),
            Some(_) | None => Ok(self.at(0.0)),
        })
    }

    /// Whether it is positive, and not negative, from some time on; `None` where it is zero, or has no value.
    pub(super) fn is_positive_late(&self) -> Option<bool> {
        Some((self.over.last()? / self.under.last()?).is_positive())
    }

    /// What it keeps within from `from_s` > 0 on, where that is known.
    pub(super) fn from(&self, from_s: f64) -> Option<Interval> {
        let found = self.at((1.0 / from_s).next_up());
        let degree = self.degree();
        if degree <= 0 || !found.is_finite() {
            return Some(found).filter(|found| found.is_finite());
        }
        let room = 1.0 - 1e-12;
        Some(found * Interval { low: libm::pow(from_s, f64::from(degree)) * room, high: f64::INFINITY })
    }

    /// By how much the degree of P exceeds that of Q.
    pub(super) fn degree(&self) -> i32 {
        self.over.len() as i32 - self.under.len() as i32
    }

    /// For 1/t from 0 to an end, divided by t to the degree where that is positive.
    fn at(&self, end: f64) -> Interval {
        let u = Interval { low: 0.0, high: end };
        let fall = (0..-self.degree()).fold(Interval::point(1.0), |power, _| power * u);
        bernstein(&self.over, end) * fall / bernstein(&self.under, end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coefficients from t⁰ on, above and below.
    fn ratio(over: &[i64], under: &[i64]) -> Option<Ratio> {
        let [over, under] =
            [over, under].map(|all| all.iter().map(|each| BigRational::from_integer((*each).into())).collect());
        Ratio::new(over, under)
    }

    fn limit(over: &[i64], under: &[i64]) -> Option<Result<[f64; 2], bool>> {
        Some(ratio(over, under)?.limit()?.map(|within| [within.low, within.high]))
    }

    #[test]
    fn what_grows_faster_than_what_it_is_divided_by_exceeds_every_bound_and_nothing_else_does() {
        assert_eq!(limit(&[0, 0, 1], &[5, 1]), Some(Err(true)));
        assert_eq!([limit(&[0, 0, -1], &[5, 1]), limit(&[0, 0, 1], &[5, -1])], [Some(Err(false)); 2]);
        // Of one degree it is the quotient of the first coefficients, of a lower one zero, as of nothing.
        let near = |found: Option<Result<[f64; 2], bool>>, expected: f64| matches!(found, Some(Ok([low, high])) if low <= expected && expected <= high && high - low < 1e-12);
        assert!(near(limit(&[1, 4], &[-3, 2]), 2.0));
        assert!(near(limit(&[7], &[0, 1]), 0.0) && near(limit(&[], &[1]), 0.0));
        assert_eq!(limit(&[1], &[]), None);
    }

    #[test]
    fn a_quotient_is_bounded_from_a_time_on_as_far_as_it_has_no_pole_later() {
        let from = |over: &[i64], under: &[i64], from_s| {
            ratio(over, under)?.from(from_s).map(|Interval { low, high }| [low, high])
        };
        let is = |found: Option<[f64; 2]>, [low, high]: [f64; 2]| {
            found.is_some_and(|found| {
                (low - 1e-9..=low).contains(&found[0]) && (found[1] == high || (high..high + 1e-9).contains(&found[1]))
            })
        };
        // t/(1 + t) from 1 on, 1/t from 2 on.
        assert!(is(from(&[0, 1], &[1, 1], 1.0), [0.5, 1.0]) && is(from(&[1], &[0, 1], 2.0), [0.0, 0.5]));
        // t² from 3 on; both are bounded by the power alone.
        assert!(is(from(&[0, 0, 1], &[1], 3.0), [9.0, f64::INFINITY]));
        let falls = from(&[0, 0, -1], &[1], 3.0);
        assert!(falls.is_some_and(|[low, high]| low == f64::NEG_INFINITY && (-9.0..-9.0 + 1e-9).contains(&high)));
        // With a pole at one second, before it and after.
        for over in [&[1][..], &[0, 1], &[0, 0, 1]] {
            assert_eq!(from(over, &[-1, 1], 0.5), None, "{over:?}");
            assert!(from(over, &[-1, 1], 1.5).is_some(), "{over:?}");
        }
    }
}
