//! The algebra of intervals with rational ends: +, −, ×, ÷ and whole powers are exact, and nothing is lost to rounding where
//! 0.3 + 0.3 sin t touches zero.

use alloc::vec::Vec;

use num_rational::BigRational;
use num_traits::{One, Zero};

use super::float::whole;
use super::interval::{Interval, Intervals};
use super::number::enclosed;
use super::{Algebra, Binary, Expression, Number, Step, Unary};

/// Rational numbers with more bits than this are rounded outwards.
const MOST_BITS: u64 = 4096;

/// With an interval that holds the variable.
pub(super) struct Exact(pub(super) Interval);

/// What a sub-expression keeps within.
#[derive(Clone, Debug)]
pub(super) enum Range {
    Rational([BigRational; 2]),
    Rounded(Interval),
}

impl Range {
    pub(super) fn rounded(&self) -> Interval {
        match self {
            Range::Rational([low, high]) => Interval::new(enclosed(low).low, enclosed(high).high),
            Range::Rounded(within) => *within,
        }
    }

    fn one_number(&self) -> Option<Number> {
        self.rational().filter(|[low, high]| low == high).map(|[number, _]| Number::rational(number))
    }

    fn rational(&self) -> Option<[BigRational; 2]> {
        match self {
            Range::Rational(ends) => Some(ends.clone()),
            Range::Rounded(within) => {
                Some([BigRational::from_float(within.low)?, BigRational::from_float(within.high)?])
            }
        }
    }

    /// The smallest range that holds these numbers.
    fn of(numbers: &[BigRational]) -> Option<Self> {
        let range = Range::Rational([numbers.iter().min()?.clone(), numbers.iter().max()?.clone()]);
        let fits = |number: &BigRational| number.numer().bits() + number.denom().bits() <= MOST_BITS;
        Some(if numbers.iter().all(fits) { range } else { Range::Rounded(range.rounded()) })
    }
}

fn combined(function: Binary, [a, b]: [BigRational; 2], [c, d]: [BigRational; 2]) -> Option<Range> {
    match function {
        Binary::Add => Range::of(&[a + c, b + d]),
        Binary::Subtract => Range::of(&[a - d, b - c]),
        Binary::Multiply => Range::of(&[&a * &c, &a * &d, &b * &c, b * d]),
        Binary::Divide if c <= BigRational::zero() && d >= BigRational::zero() => None,
        Binary::Divide => Range::of(&[&a / &c, &a / &d, &b / &c, b / d]),
        Binary::Min => Range::of(&[a.min(c), b.min(d)]),
        Binary::Max => Range::of(&[a.max(c), b.max(d)]),
    }
}

fn raised([a, b]: [BigRational; 2], n: i32) -> Option<Range> {
    let zero = BigRational::zero();
    let inside = a < zero && b > zero;
    if (n < 0 && a <= zero && b >= zero) || (a.numer().bits().max(b.denom().bits())) * 64 > MOST_BITS {
        return None;
    }
    let least = if inside && n % 2 == 0 { zero } else { a.pow(n) };
    Range::of(&[least, a.pow(n), b.pow(n)])
}

impl Algebra for Exact {
    type Value = Range;

    fn number(&mut self, number: &Number) -> Range {
        number.exact().map_or(Range::Rounded(number.within()), |exact| Range::Rational([exact.clone(), exact]))
    }
    fn variable(&mut self, _: usize) -> Range {
        Range::Rounded(self.0)
    }
    fn unary(&mut self, function: Unary, a: Range) -> Range {
        let minus = |[low, high]: &[BigRational; 2]| [-high, -low];
        match (function, a.rational()) {
            (Unary::Negate, Some(ends)) => Range::Rational(minus(&ends)),
            (Unary::Abs, Some(ends)) if ends[0] >= BigRational::zero() => Range::Rational(ends),
            (Unary::Abs, Some(ends)) if ends[1] <= BigRational::zero() => Range::Rational(minus(&ends)),
            _ => Range::Rounded(Intervals(&[]).unary(function, a.rounded())),
        }
    }
    fn binary(&mut self, function: Binary, a: Range, b: Range) -> Range {
        let exact = a.rational().zip(b.rational()).and_then(|(a, b)| combined(function, a, b));
        exact.unwrap_or_else(|| Range::Rounded(Intervals(&[]).binary(function, a.rounded(), b.rounded())))
    }
    fn power(&mut self, a: Range, exponent: &Number) -> Range {
        let n = exponent.exact().filter(|exact| exact.denom().is_one()).and_then(|_| whole(exponent.value()));
        let exact = n.zip(a.rational()).and_then(|(n, a)| raised(a, n));
        exact.unwrap_or_else(|| Range::Rounded(Intervals(&[]).power(a.rounded(), exponent)))
    }
}

/// Puts the exact number in the place of the value without variables that begins at `first`, where floating point does not compute that.
fn exactly(steps: &mut Vec<Step>, first: usize) {
    let value = Expression { steps: steps[first..].to_vec() };
    let exact = value.constant().filter(|number| number.exact().is_some());
    if let Some(exact) = exact.filter(|exact| exact.value().to_bits() != value.value(&[]).to_bits()) {
        steps.truncate(first);
        steps.push(Step::Number(exact));
    }
}

impl Expression {
    /// What it is where it has no variables: the exact number if it is rational and small enough, an enclosure otherwise, and
    /// `None` where there may be no value.
    pub fn constant(&self) -> Option<Number> {
        if self.variables() > 0 {
            return None;
        }
        let range = self.fold(&mut Exact(Interval::UNDEFINED));
        range.one_number().or_else(|| Number::enclosed(self.value(&[]), range.rounded()))
    }

    /// The same with each part that has no variable and a rational value as that number, where floating point computes another from it: 0.1 + 0.2
    /// − 0.3 is zero in a check, and so it is in a run.
    #[must_use]
    pub fn with_exact_constants(&self) -> Expression {
        let mut steps: Vec<Step> = Vec::with_capacity(self.steps.len());
        // Where each value that waits for its operator begins, and whether it has no variable.
        let mut waiting: Vec<(usize, bool)> = Vec::new();
        for step in &self.steps {
            let value = match step {
                Step::Number(_) => (steps.len(), true),
                Step::Variable(_) => (steps.len(), false),
                Step::Unary(_) | Step::Power(_) => waiting.pop().unwrap_or_default(),
                Step::Binary(_) => {
                    let (second, first) = (waiting.pop().unwrap_or_default(), waiting.pop().unwrap_or_default());
                    (first.0, first.1 && second.1)
                }
            };
            steps.push(step.clone());
            if value.1 {
                exactly(&mut steps, value.0);
            }
            waiting.push(value);
        }
        Expression { steps }
    }

    /// The one rational number that it is for all values of its variables within `range`, where one pass shows that: 0.3 + 0 t.
    pub fn constant_over(&self, range: Interval) -> Option<Number> {
        self.fold(&mut Exact(range)).one_number()
    }
}
