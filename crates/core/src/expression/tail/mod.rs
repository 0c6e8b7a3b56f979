//! What an expression in one variable, t, does from some time T on, and as t → ∞.
//!
//! It is written as a sum of terms c(t) tᵖ (ln t)ᵠ whose coefficients c are enclosed for all t ≥ T. A quotient such as
//! t/(1 + t) is then t · 1/(t (1 + 1/t)), within 1/(1 + 1/T) and one, where intervals alone find nothing. Where the largest
//! scale grows and its coefficient keeps away from zero, the expression grows beyond every bound; where the largest fades and
//! its coefficient is bounded, it tends to zero. Both are proofs, whatever T is.
//!
//! Of a coefficient it is also known what it comes back to for ever: a sine of something continuous that grows takes every
//! value from −1 to 1 again and again. So t sin t is known to be unbounded, and 1 + cos t to come to zero.
//!
//! An exponential outgrows every power: e^a for a rising a is t⁸ times something of which only a lower bound is known, and
//! for a falling one t⁻⁸ times something bounded.

mod coefficient;
mod scale;
mod series;

use self::coefficient::{Coefficient, over, plus, times};
use self::scale::{Exponent, Scale, exponent, number};
pub(super) use self::series::Series;
use super::float::whole;
use super::interval::{Interval, Intervals};
use super::{Algebra, Binary, Branch, Branching, Number, Unary};

/// The power of t that stands for what an exponential outgrows.
const OUTGROWN: i32 = 8;
/// Whole powers up to this are multiplied out.
const MULTIPLIED: i32 = 4;

/// The algebra of series from a time on, which is at least 16.
pub(super) struct Tails {
    /// T.
    pub(super) from: f64,
}

impl Series {
    /// What it comes back to for ever, or tends to: its limit inferior is `low` at most, and its limit superior `high` at least.
    /// In the wrong order, infinite, where nothing is known.
    pub(super) fn comes_back_to(&self) -> Interval {
        let nothing = Interval { low: f64::INFINITY, high: f64::NEG_INFINITY };
        let Some((scale, first)) = self.leading() else {
            return if self.is_known() { Interval::point(0.0) } else { nothing };
        };
        match scale.cmp(&Scale::ONE) {
            core::cmp::Ordering::Greater => Interval {
                low: if first.below < 0.0 { f64::NEG_INFINITY } else { nothing.low },
                high: if first.above > 0.0 { f64::INFINITY } else { nothing.high },
            },
            core::cmp::Ordering::Equal => Interval { low: first.below, high: first.above },
            core::cmp::Ordering::Less if first.within.is_finite() => Interval::point(0.0),
            core::cmp::Ordering::Less => nothing,
        }
    }

    /// Whether it is zero nowhere, though it may fade.
    pub(super) fn keeps_from_zero(&self) -> bool {
        self.as_one().is_some_and(|(_, one)| !one.within.holds(0.0))
    }

    /// Whether it is bounded by what its terms say.
    pub(super) fn is_bounded(&self) -> bool {
        let bounded = |(scale, first): (Scale, Coefficient)| scale <= Scale::ONE && first.within.is_finite();
        self.is_known() && self.leading().is_none_or(bounded)
    }

    /// Whether it is bounded and tends to a limit.
    pub(super) fn settles(&self) -> bool {
        self.is_bounded() && self.leading().is_none_or(|(scale, first)| scale < Scale::ONE || first.still)
    }

    /// The bounded part c, and what fades: this is c + δ; `None` where something grows.
    fn bounded_parts(&self) -> Option<(Coefficient, Series)> {
        let none = Coefficient::constant(Interval::point(0.0));
        match self.leading() {
            _ if !self.is_bounded() => None,
            Some((scale, first)) if scale == Scale::ONE => Some((first, self.rest(Scale::ONE)?)),
            _ => Some((none, *self)),
        }
    }

    fn one(&self, coefficient: Coefficient) -> Series {
        Series::term(self.from(), Scale::ONE, coefficient)
    }

    /// A function of which nothing but its bounds is used.
    fn hull_of(&self, function: Unary) -> Series {
        if !self.is_known() {
            return Series::unknown();
        }
        self.one(Coefficient::bounded(Intervals(&[]).unary(function, self.range())))
    }

    /// A smooth function of c + δ.
    fn smooth(&self, function: Unary) -> Option<Series> {
        let (c, rest) = self.bounded_parts()?;
        let slope = slope(function, self.range());
        slope.is_finite().then(|| rest.composed(c.unary(function), slope))
    }

    fn exponential(&self) -> Series {
        let Some((scale, one)) = self.as_one() else { return self.hull_of(Unary::Exp) };
        let steep = scale.exponent_of_t();
        let faster = steep > Exponent::from(0);
        if faster && one.within.low > 0.0 {
            // e^a ≥ t⁸ inf (e^a / t⁸).
            let fall = falling(scale, -one.within.low, self.from());
            let low = over(Interval::point(1.0), Interval::point(fall)).low.max(0.0);
            let rest = Coefficient::bounded(Interval { low, high: f64::INFINITY });
            return Series::term(self.from(), Scale::power_of_t(OUTGROWN), rest);
        }
        if faster && one.within.high < 0.0 {
            let high = falling(scale, one.within.high, self.from());
            let rest = Coefficient::bounded(Interval { low: 0.0, high });
            return Series::term(self.from(), Scale::power_of_t(-OUTGROWN), rest);
        }
        self.hull_of(Unary::Exp)
    }

    fn logarithm(&self) -> Series {
        let series = || {
            let ((scale, first), (_, one)) = (self.leading()?, self.as_one()?);
            let (power, rest) = (scale.pure()?, self.rest(scale)?);
            let slope = over(Interval::point(1.0), one.within);
            let defined = one.within.low > 0.0 && first.within.low > 0.0 && first.within.is_finite();
            let mut sum = defined.then(|| rest.composed(first.unary(Unary::Log), slope))?;
            sum.add(Scale::LOG, Coefficient::constant(number(power).within()));
            Some(sum)
        };
        series().unwrap_or_else(|| self.hull_of(Unary::Log))
    }

    /// Of what grows to one side: its limit is that of the function.
    fn levelling(&self, function: Unary) -> Series {
        let Some((_, first)) = self.leading().filter(|(scale, _)| *scale > Scale::ONE) else {
            return self.hull_of(function);
        };
        let within = Intervals(&[]).unary(function, self.range());
        let end = |infinite: f64| Intervals(&[]).unary(function, Interval::point(infinite));
        let limit = match () {
            () if first.within.low > 0.0 => end(f64::INFINITY),
            () if first.within.high < 0.0 => end(f64::NEG_INFINITY),
            () => return self.hull_of(function),
        };
        self.one(Coefficient { above: limit.low, below: limit.high, ..Coefficient::bounded(within) })
    }

    /// A sine takes every value again and again where its argument, which is continuous, grows beyond every bound.
    fn wave(&self, function: Unary) -> Series {
        let grows = |(scale, first): (Scale, Coefficient)| scale > Scale::ONE && !first.within.holds(0.0);
        if self.leading().is_some_and(grows) {
            self.one(Coefficient::swinging(Interval { low: -1.0, high: 1.0 }))
        } else {
            self.hull_of(function)
        }
    }

    fn absolute(&self) -> Series {
        let range = self.range();
        match self.as_one() {
            _ if !self.is_known() || range.low >= 0.0 => *self,
            _ if range.high <= 0.0 => self.neg(),
            Some((scale, one)) => Series::term(self.from(), scale, one.unary(Unary::Abs)),
            None => Series::unknown(),
        }
    }

    fn raised(&self, exponent: &Number) -> Option<Series> {
        let power = self::exponent(exponent)?;
        let n = whole(exponent.value()).filter(|_| power.is_integer());
        match n {
            Some(0) => return Some(self.one(Coefficient::constant(Interval::point(1.0)))),
            Some(n) if n < 0 => return Some(self.raised(&f64::from(-n).into())?.inverse()),
            Some(n) if n <= MULTIPLIED && self.terms().len() != 1 => {
                return Some((1..n).fold(*self, |product, _| product.times(self)));
            }
            _ => {}
        }
        let (scale, one) = self.as_one()?;
        let apply = |a: Interval| Intervals(&[]).power(a, exponent);
        let rises = one.within.low >= 0.0 || n.is_some_and(|n| n % 2 == 1);
        let positive = power > Exponent::from(0);
        let coefficient = if positive && rises {
            one.rising(apply)
        } else {
            Coefficient { still: one.still, ..Coefficient::bounded(apply(one.within)) }
        };
        let scale = scale.raised(power)?;
        // c and δ apart, so that what is subtracted later cancels.
        let apart = || {
            let ((own, first), slope) = (self.leading()?, apply_slope(one.within, exponent));
            let usable = slope.is_finite() && first.within.low > 0.0 && one.within.low > 0.0 && positive;
            let sum = usable.then(|| Some(self.rest(own)?.composed(first.rising(apply), slope)))??;
            Some(sum.scaled(scale, |same| same))
        };
        Some(apart().unwrap_or_else(|| Series::term(self.from(), scale, coefficient)))
    }

    /// Both in units of the larger scale, as one term each.
    fn beside(&self, other: &Series) -> Option<(Scale, Coefficient, Coefficient)> {
        let nothing = (Scale::ONE, Coefficient::constant(Interval::point(0.0)));
        if !self.is_known() || !other.is_known() {
            return None;
        }
        let one = |series: &Series| if series.terms().is_empty() { Some(nothing) } else { series.as_one() };
        let ((p, a), (q, b)) = (one(self)?, one(other)?);
        let scale = p.max(q);
        let in_units = |own: Scale, coefficient: Coefficient| {
            if own == scale {
                return Some(coefficient);
            }
            Some(Coefficient::bounded(times(coefficient.within, own.over(scale)?.range(self.from()))))
        };
        Some((scale, in_units(p, a)?, in_units(q, b)?))
    }

    /// The larger of two, or, of both negated, minus the smaller.
    fn larger(&self, other: &Series) -> Series {
        let difference = self.plus(&other.neg()).range();
        if difference.low >= 0.0 {
            return *self;
        }
        if difference.high <= 0.0 {
            return *other;
        }
        let larger = |(scale, a, b): (Scale, Coefficient, Coefficient)| {
            let within = Intervals(&[]).binary(Binary::Max, a.within, b.within);
            let above = within.low.max(a.above).max(b.above);
            let coefficient = Coefficient { above, still: a.still && b.still, ..Coefficient::bounded(within) };
            Series::term(self.from(), scale, coefficient)
        };
        self.beside(other).map_or_else(Series::unknown, larger)
    }
}

/// The derivative of a function on an interval; infinite where it is not used.
fn slope(function: Unary, on: Interval) -> Interval {
    let mut intervals = Intervals(&[]);
    let one = Interval::point(1.0);
    match function {
        Unary::Sin => intervals.unary(Unary::Cos, on),
        Unary::Cos => {
            let sine = intervals.unary(Unary::Sin, on);
            intervals.unary(Unary::Negate, sine)
        }
        Unary::Exp => intervals.unary(Unary::Exp, on),
        Unary::Tanh | Unary::Atan => Interval { low: 0.0, high: 1.0 },
        Unary::Log if on.low > 0.0 => over(one, on),
        Unary::Negate | Unary::Abs | Unary::Sqrt | Unary::Log => Interval::WHOLE,
    }
}

/// c a^(c − 1).
fn apply_slope(a: Interval, exponent: &Number) -> Interval {
    times(exponent.within(), Intervals(&[]).power(a, &exponent.minus(1.0)))
}

/// An upper bound of t⁸ e^(rate · scale) from `from` on, for a negative rate and a scale that grows like a power; infinite
/// where there is none.
fn falling(scale: Scale, rate: f64, from: f64) -> f64 {
    let (p, slower) = match scale.pure() {
        Some(p) => (p, Interval::point(1.0)),
        // tᵖ (ln t)ᵠ = tᵖᐟ² times something that grows.
        None => {
            let half = scale.exponent_of_t() / 2;
            let left = scale.over(Scale::ONE).and_then(|scale| {
                let root = Scale::T.raised(half)?;
                scale.over(root)
            });
            (half, left.map_or(Interval::UNDEFINED, |left| Interval::point(left.range(from).low)))
        }
    };
    // With m = −rate · slower: t⁸ e^(−m tᵖ) falls from where m p tᵖ = 8 on.
    let mut intervals = Intervals(&[]);
    let m = times(Interval::point(-rate), slower);
    let (power, eight) = (number(p), Interval::point(f64::from(OUTGROWN)));
    let turn = over(eight, times(m, power.within()));
    let start = intervals.power(Interval::point(from), &power);
    let at = if turn.high <= start.low { start } else { Interval { low: turn.low.max(start.low), high: turn.high } };
    if !(at.low > 0.0 && at.high >= at.low) {
        return f64::INFINITY;
    }
    // ln(t⁸ e^(−m tᵖ)) = (8/p) ln tᵖ − m tᵖ.
    let logarithm = times(over(eight, power.within()), intervals.unary(Unary::Log, at));
    let exponent = plus(logarithm, times(Interval { low: -m.high, high: -m.low }, at));
    let high = intervals.unary(Unary::Exp, exponent).high;
    if high.is_nan() { f64::INFINITY } else { high }
}

impl Algebra for Tails {
    type Value = Series;

    fn number(&mut self, number: &Number) -> Series {
        Series::term(self.from, Scale::ONE, Coefficient::constant(number.within()))
    }

    fn variable(&mut self, _: usize) -> Series {
        Series::term(self.from, Scale::T, Coefficient::constant(Interval::point(1.0)))
    }

    fn unary(&mut self, function: Unary, a: Series) -> Series {
        if !a.is_known() {
            return a;
        }
        let smooth = || a.smooth(function);
        match function {
            Unary::Negate => a.neg(),
            Unary::Abs => a.absolute(),
            Unary::Sqrt => a.raised(&0.5.into()).unwrap_or_else(|| a.hull_of(function)),
            Unary::Sin | Unary::Cos => smooth().unwrap_or_else(|| a.wave(function)),
            Unary::Exp => smooth().unwrap_or_else(|| a.exponential()),
            Unary::Log => smooth().unwrap_or_else(|| a.logarithm()),
            Unary::Tanh | Unary::Atan => smooth().unwrap_or_else(|| a.levelling(function)),
        }
    }

    fn binary(&mut self, function: Binary, a: Series, b: Series) -> Series {
        match function {
            Binary::Add => a.plus(&b),
            Binary::Subtract => a.plus(&b.neg()),
            Binary::Multiply => a.times(&b),
            Binary::Divide => a.times(&b.inverse()),
            Binary::Max => a.larger(&b),
            Binary::Min => a.neg().larger(&b.neg()).neg(),
        }
    }

    fn power(&mut self, a: Series, exponent: &Number) -> Series {
        if !a.is_known() {
            return a;
        }
        a.raised(exponent).unwrap_or_else(|| {
            let within = Intervals(&[]).power(a.range(), exponent);
            Series::term(self.from, Scale::ONE, Coefficient::bounded(within))
        })
    }
}

impl Branching for Tails {
    fn branch(&mut self, larger: Series, smaller: Series) -> Branch {
        let difference = larger.plus(&smaller.neg()).range();
        match () {
            () if difference.low > 0.0 => Branch::First,
            () if difference.high < 0.0 => Branch::Second,
            () => Branch::Either,
        }
    }
    fn either(&mut self, a: Series, b: Series) -> Series {
        let hull = |(scale, a, b): (Scale, Coefficient, Coefficient)| {
            Series::term(self.from, scale, Coefficient::bounded(a.within.hull(b.within)))
        };
        a.beside(&b).map_or_else(Series::unknown, hull)
    }
    fn unknown(&self) -> Series {
        Series::unknown()
    }
    fn is_zero(&self, a: Series) -> bool {
        a.is_known() && a.terms().is_empty()
    }
}
