//! Whether a formula is uniformly continuous for ever, shown step by step.
//!
//! On a bounded time every formula is, since its functions are continuous. For ever sin t² is not: it is bounded, but swings
//! faster and faster. Two rules show most of what is written in practice. What is made of uniformly continuous parts by
//! functions that are uniformly continuous where the parts are is so, too. And what is continuous, bounded and goes only
//! one way has a limit, and so is uniformly continuous whatever it is made of, such as 1 / (1 + t²).

use super::{FormulaStep, Interval, whole};

/// Which way a part of a formula goes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Trend {
    /// It is constant.
    Still,
    /// It never falls.
    Rising,
    /// It never rises.
    Falling,
    /// Nothing is known.
    Unknown,
}

impl Trend {
    fn flipped(self) -> Self {
        match self {
            Trend::Rising => Trend::Falling,
            Trend::Falling => Trend::Rising,
            same => same,
        }
    }

    fn flipped_if(self, flip: bool) -> Self {
        if flip { self.flipped() } else { self }
    }

    /// Of what rises when either of the two does.
    fn and(self, other: Self) -> Self {
        match (self, other) {
            (Trend::Still, trend) | (trend, Trend::Still) => trend,
            (one, two) if one == two => one,
            _ => Trend::Unknown,
        }
    }
}

/// A part of a formula as it is for ever.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// What it keeps within.
    within: Interval,
    trend: Trend,
    uniform: bool,
}

impl Part {
    /// Of which nothing is known.
    pub(super) const UNKNOWN: Part = Part { within: Interval::WHOLE, trend: Trend::Unknown, uniform: false };

    /// Whether it is shown to be uniformly continuous.
    pub(super) fn is_uniform(self) -> bool {
        self.uniform
    }

    /// The value of a step whose operands are `a` and `b`, of which it may need none; it keeps within `within`.
    pub(super) fn after(step: FormulaStep, a: Part, b: Part, within: Interval) -> Part {
        let trend = trend(step, a, b);
        Part { within, trend, uniform: composed(step, a, b) || trend != Trend::Unknown && within.is_finite() }
    }

    fn is_still(self) -> bool {
        self.trend == Trend::Still
    }

    fn is_never_negative(self) -> bool {
        self.within.low >= 0.0
    }

    fn is_never_positive(self) -> bool {
        self.within.high <= 0.0
    }

    /// Whether it keeps away from zero on one side of it.
    fn is_away_from_zero(self) -> bool {
        self.within.low > 0.0 || self.within.high < 0.0
    }
}

/// Whether the step makes something uniformly continuous because its operands are.
fn composed(step: FormulaStep, a: Part, b: Part) -> bool {
    use FormulaStep as S;
    let both = a.uniform && b.uniform;
    let bounded = |part: Part| part.within.is_finite();
    match step {
        S::Number(_) | S::Time => true,
        S::Variable(_) => false,
        // Uniformly continuous wherever they are defined.
        S::Negate | S::Abs | S::Sin | S::Cos | S::Tanh | S::Atan | S::Sqrt => a.uniform,
        S::Add | S::Subtract | S::Min | S::Max => both,
        // |a b − a′ b′| ≤ |a| |b − b′| + |b′| |a − a′|.
        S::Multiply => both && (a.is_still() || b.is_still() || bounded(a) && bounded(b)),
        // |1/b − 1/b′| ≤ |b − b′| / m² where |b| ≥ m, and then as a product.
        S::Divide => both && b.is_away_from_zero() && (b.is_still() || bounded(a)),
        S::Exp => a.uniform && a.within.high < f64::INFINITY,
        S::Log => a.uniform && a.within.low > 0.0,
        S::Power(0.0) => true,
        S::Power(exponent) if exponent < 0.0 => a.uniform && a.is_away_from_zero(),
        // A power up to one of what is not negative has the modulus of continuity |a − a′|ᶜ.
        S::Power(exponent) if exponent <= 1.0 => a.uniform,
        S::Power(_) => a.uniform && bounded(a),
    }
}

/// Which way the value of the step goes.
fn trend(step: FormulaStep, a: Part, b: Part) -> Trend {
    use FormulaStep as S;
    match step {
        S::Number(_) => Trend::Still,
        S::Time => Trend::Rising,
        S::Variable(_) => Trend::Unknown,
        S::Negate => a.trend.flipped(),
        S::Add | S::Min | S::Max => a.trend.and(b.trend),
        S::Subtract => a.trend.and(b.trend.flipped()),
        S::Multiply => product(a, b),
        // 1/b has the sign of b and goes the other way.
        S::Divide if b.is_away_from_zero() => product(a, Part { trend: b.trend.flipped(), ..b }),
        S::Exp | S::Log | S::Sqrt | S::Tanh | S::Atan => a.trend,
        S::Sin | S::Cos if a.is_still() => Trend::Still,
        S::Abs => even(a),
        S::Power(exponent) => power(a, exponent),
        S::Divide | S::Sin | S::Cos => Trend::Unknown,
    }
}

/// A product goes the way of its factors' sizes, if neither changes its sign; a constant factor may be known to have one
/// while the other has both.
fn product(a: Part, b: Part) -> Trend {
    let sign = |part: Part| part.is_never_negative() || part.is_never_positive();
    let scaled = |factor: Part, other: Trend| other.flipped_if(!factor.is_never_negative());
    match () {
        () if a.is_still() && sign(a) => scaled(a, b.trend),
        () if b.is_still() && sign(b) => scaled(b, a.trend),
        () if sign(a) && sign(b) => {
            let (minus_a, minus_b) = (!a.is_never_negative(), !b.is_never_negative());
            let sizes = a.trend.flipped_if(minus_a).and(b.trend.flipped_if(minus_b));
            sizes.flipped_if(minus_a != minus_b)
        }
        () => Trend::Unknown,
    }
}

/// Of a function that rises with the size of its argument.
fn even(a: Part) -> Trend {
    match () {
        () if a.is_still() || a.is_never_negative() => a.trend,
        () if a.is_never_positive() => a.trend.flipped(),
        () => Trend::Unknown,
    }
}

fn power(a: Part, exponent: f64) -> Trend {
    let positive = match whole(exponent) {
        Some(0) => return Trend::Still,
        Some(n) if n % 2 == 0 => even(a),
        _ => a.trend,
    };
    match () {
        () if exponent > 0.0 => positive,
        () if a.is_away_from_zero() => positive.flipped(),
        () => Trend::Unknown,
    }
}
