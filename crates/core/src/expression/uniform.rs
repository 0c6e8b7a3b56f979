//! Whether an expression in one variable is uniformly continuous on [0, ∞), shown step by step.
//!
//! On a bounded stretch every one is, since its functions are continuous. On [0, ∞) sin x² is not: it is bounded, but swings
//! faster and faster. Two rules show most of what is written in practice. What is made of uniformly continuous parts by
//! functions that are uniformly continuous where the parts are is so, too. And what is continuous, bounded and goes only
//! one way has a limit, and so is uniformly continuous whatever it is made of, such as 1 / (1 + x²).

use super::float::whole;
use super::interval::{Interval, Intervals};
use super::{Algebra, Binary, Expression, Number, Unary};

/// Which way a part of an expression goes.
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

/// [0, ∞).
const FOR_EVER: Interval = Interval { low: 0.0, high: f64::INFINITY };

impl Expression {
    /// Whether it is shown to be bounded and uniformly continuous on [0, ∞), as exact arithmetic would evaluate it.
    pub fn is_uniformly_continuous(&self) -> bool {
        // Bounded also says that it has a value everywhere.
        self.enclose(FOR_EVER).is_finite() && self.fold(&mut Parts).uniform
    }
}

/// The algebra of trends and moduli of continuity.
struct Parts;

/// A part of an expression as it is on [0, ∞).
#[derive(Clone, Copy, Debug)]
struct Part {
    /// What it keeps within.
    within: Interval,
    trend: Trend,
    uniform: bool,
}

impl Part {
    /// One that goes a certain way, and may be `composed` such that it is uniformly continuous because its operands are.
    fn new(within: Interval, trend: Trend, composed: bool) -> Self {
        Part { within, trend, uniform: composed || trend != Trend::Unknown && within.is_finite() }
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

impl Algebra for Parts {
    type Value = Part;

    fn number(&mut self, number: &Number) -> Part {
        Part::new(number.within(), Trend::Still, true)
    }

    fn variable(&mut self, _: usize) -> Part {
        Part::new(FOR_EVER, Trend::Rising, true)
    }

    fn unary(&mut self, function: Unary, a: Part) -> Part {
        let trend = match function {
            Unary::Negate => a.trend.flipped(),
            Unary::Exp | Unary::Log | Unary::Sqrt | Unary::Tanh | Unary::Atan => a.trend,
            Unary::Sin | Unary::Cos if a.is_still() => Trend::Still,
            Unary::Sin | Unary::Cos => Trend::Unknown,
            Unary::Abs => even(a),
        };
        let composed = match function {
            // Uniformly continuous wherever they are defined.
            Unary::Negate | Unary::Abs | Unary::Sin | Unary::Cos | Unary::Tanh | Unary::Atan | Unary::Sqrt => true,
            Unary::Exp => a.within.high < f64::INFINITY,
            Unary::Log => a.within.low > 0.0,
        };
        Part::new(Intervals(&[]).unary(function, a.within), trend, a.uniform && composed)
    }

    fn binary(&mut self, function: Binary, a: Part, b: Part) -> Part {
        let bounded = |part: Part| part.within.is_finite();
        let (trend, composed) = match function {
            Binary::Add | Binary::Min | Binary::Max => (a.trend.and(b.trend), true),
            Binary::Subtract => (a.trend.and(b.trend.flipped()), true),
            // |a b − a′ b′| ≤ |a| |b − b′| + |b′| |a − a′|.
            Binary::Multiply => (product(a, b), a.is_still() || b.is_still() || bounded(a) && bounded(b)),
            // |1/b − 1/b′| ≤ |b − b′| / m² where |b| ≥ m, and then as a product; 1/b has the sign of b and goes the other way.
            Binary::Divide if b.is_away_from_zero() => {
                (product(a, Part { trend: b.trend.flipped(), ..b }), b.is_still() || bounded(a))
            }
            Binary::Divide => (Trend::Unknown, false),
        };
        Part::new(Intervals(&[]).binary(function, a.within, b.within), trend, a.uniform && b.uniform && composed)
    }

    fn power(&mut self, a: Part, exponent: &Number) -> Part {
        let within = Intervals(&[]).power(a.within, exponent);
        let exponent = exponent.value();
        let composed = match exponent {
            0.0 => return Part::new(within, Trend::Still, true),
            _ if exponent < 0.0 => a.is_away_from_zero(),
            // A power up to one of what is not negative has the modulus of continuity |a − a′|ᶜ.
            _ => exponent <= 1.0 || a.within.is_finite(),
        };
        let positive = if whole(exponent).is_some_and(|n| n % 2 == 0) { even(a) } else { a.trend };
        let trend = match () {
            () if exponent > 0.0 => positive,
            () if a.is_away_from_zero() => positive.flipped(),
            () => Trend::Unknown,
        };
        Part::new(within, trend, a.uniform && composed)
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
