//! Expressions in `f64`, with the same bits on every machine.

use super::{Algebra, Binary, Branch, Branching, Number, Switch, Unary};
use crate::sine_and_cosine;

/// Whole exponents up to this are products.
const MOST_POWER: f64 = 64.0;

/// The algebra of `f64`: not-a-number or infinite where there is no value.
#[derive(Debug)]
pub struct Floats<'a> {
    variables: &'a [f64],
    /// Which branches of |a|, min and max are taken, in order, where it is not the values that decide: those of the piece that
    /// begins at the time given.
    pieces: Option<(&'a [Switch], f64)>,
}

impl<'a> Floats<'a> {
    /// With the values of the variables.
    pub fn new(variables: &'a [f64]) -> Self {
        Floats { variables, pieces: None }
    }

    pub(super) fn on_piece(variables: &'a [f64], switches: &'a [Switch], since: f64) -> Self {
        Floats { variables, pieces: Some((switches, since)) }
    }
}

impl Algebra for Floats<'_> {
    type Value = f64;

    fn number(&mut self, number: &Number) -> f64 {
        number.value()
    }
    fn variable(&mut self, index: usize) -> f64 {
        self.variables.get(index).copied().unwrap_or(f64::NAN)
    }
    fn unary(&mut self, function: Unary, a: f64) -> f64 {
        apply(function, a)
    }
    fn binary(&mut self, function: Binary, a: f64, b: f64) -> f64 {
        combine(function, a, b)
    }
    fn power(&mut self, a: f64, exponent: &Number) -> f64 {
        power(a, exponent.value())
    }
}

impl Branching for Floats<'_> {
    fn branch(&mut self, larger: f64, smaller: f64) -> Branch {
        let first = match &mut self.pieces {
            Some((switches, since)) => match switches.split_first() {
                Some((switch, rest)) => {
                    *switches = rest;
                    switch.is_first(*since)
                }
                None => larger >= smaller,
            },
            None => larger >= smaller,
        };
        if first { Branch::First } else { Branch::Second }
    }
    fn either(&mut self, a: f64, _: f64) -> f64 {
        a
    }
    fn unknown(&self) -> f64 {
        f64::NAN
    }
    fn is_zero(&self, a: f64) -> bool {
        a == 0.0
    }
}

pub(super) fn apply(function: Unary, a: f64) -> f64 {
    match function {
        Unary::Negate => -a,
        Unary::Sin => sine_and_cosine(a).0.clamp(-1.0, 1.0),
        Unary::Cos => sine_and_cosine(a).1.clamp(-1.0, 1.0),
        Unary::Exp => libm::exp(a),
        Unary::Log => libm::log(a),
        Unary::Sqrt => libm::sqrt(a),
        Unary::Abs => a.abs(),
        Unary::Tanh => libm::tanh(a),
        Unary::Atan => libm::atan(a),
    }
}

pub(super) fn combine(function: Binary, a: f64, b: f64) -> f64 {
    match function {
        Binary::Add => a + b,
        Binary::Subtract => a - b,
        Binary::Multiply => a * b,
        Binary::Divide => a / b,
        // Unlike f64::min, these let not-a-number through.
        Binary::Min if b < a || b.is_nan() => b,
        Binary::Max if b > a || b.is_nan() => b,
        Binary::Min | Binary::Max => a,
    }
}

/// The exponent, if it is a whole number small enough for products.
pub(super) fn whole(exponent: f64) -> Option<i32> {
    let n = exponent as i32;
    (exponent.abs() <= MOST_POWER && f64::from(n) == exponent).then_some(n)
}

/// aᶜ; a product when c is a small whole number.
pub(super) fn power(base: f64, exponent: f64) -> f64 {
    match whole(exponent) {
        Some(n) if n < 0 => 1.0 / repeated(base, n.unsigned_abs(), |a, b| a * b),
        Some(n) => repeated(base, n.unsigned_abs(), |a, b| a * b),
        None => libm::pow(base, exponent),
    }
}

/// baseⁿ by repeated squaring.
pub(super) fn repeated(base: f64, n: u32, times: impl Fn(f64, f64) -> f64) -> f64 {
    let (mut result, mut square, mut left) = (1.0, base, n);
    while left > 0 {
        if left & 1 == 1 {
            result = times(result, square);
        }
        left >>= 1;
        if left > 0 {
            square = times(square, square);
        }
    }
    result
}
