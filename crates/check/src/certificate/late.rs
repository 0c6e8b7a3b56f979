//! What a formula keeps within from some time on, in one pass and by the rules that a checker has.

use forwardstep_core::expression::{Algebra, Binary, Expression, Interval, Intervals, Number, Unary};
use num_rational::BigRational;
use num_traits::{One, ToPrimitive};

use super::ratio::Ratio;

/// A part of a formula from a time on.
#[derive(Clone, Debug)]
pub(super) struct Late {
    /// What it keeps within.
    pub(super) within: Interval,
    /// Itself, where it is a quotient of polynomials.
    pub(super) ratio: Option<Ratio>,
    /// Its square, where it is a root of one, or a power of such a root.
    square: Option<Ratio>,
    /// Itself once products are multiplied out: the sum of these.
    terms: Vec<Damped>,
    /// Itself where factors stay together: sines and cosines, and what the rest keeps within.
    waves: Waves,
    rest: Interval,
    constant: bool,
}

/// A product: a quotient of polynomials, roots of such, the exponential of one, a sine or cosine, and what keeps within bounds.
#[derive(Clone, Debug)]
struct Damped {
    /// The angle of a sine, or of a cosine.
    wave: Option<(Ratio, Wave)>,
    over: Option<Ratio>,
    /// The square of all roots.
    root: Option<Ratio>,
    /// The sign of quotients and roots, by what a checker knows: that of each of them.
    sign: Interval,
    power: Option<Ratio>,
    rest: Interval,
}

#[derive(Clone, Copy, Debug)]
enum Wave {
    Sine,
    Cosine,
}

/// Sines and cosines of one angle each, by what that keeps within which they are multiplied with.
#[derive(Clone, Debug, Default)]
struct Waves(Vec<(Ratio, [Interval; 2])>);

impl Waves {
    fn add(&mut self, angle: &Ratio, scales: [Interval; 2]) {
        match self.0.iter_mut().find(|(known, _)| known == angle) {
            Some((_, sum)) => *sum = [sum[0] + scales[0], sum[1] + scales[1]],
            None => self.0.push((angle.clone(), scales)),
        }
    }

    fn scaled(&self, by: Interval) -> Waves {
        Waves(self.0.iter().map(|(angle, scales)| (angle.clone(), scales.map(|scale| by * scale))).collect())
    }

    /// a sin φ + b cos φ is at most √(a² + b²), whatever a and b do.
    fn within(&self) -> Interval {
        let square = |scale: &Interval| Interval::point(scale.size()) * Interval::point(scale.size());
        let size = |[sine, cosine]: &[Interval; 2]| of(Unary::Sqrt, square(sine) + square(cosine)).high;
        let most = self.0.iter().map(|(_, scales)| size(scales)).fold(0.0, |sum, size| (sum + size).next_up());
        Interval { low: -most, high: most }
    }
}

/// What `formula` does from `from_s` on.
pub(super) fn late(formula: &Expression, from_s: f64) -> Late {
    let found = formula.fold(&mut Lates { from_s });
    let within = if found.within.low <= found.within.high { found.within } else { Interval::WHOLE };
    Late { within, ..found }
}

/// The algebra of what formulas do from a time on.
struct Lates {
    from_s: f64,
}

/// Terms of a sum that are kept apart.
const MOST_TERMS: usize = 64;
const ONE: Interval = Interval { low: 1.0, high: 1.0 };
const ZERO: Interval = Interval { low: 0.0, high: 0.0 };
const EITHER: Interval = Interval { low: -1.0, high: 1.0 };

impl Lates {
    /// With what the quotient of polynomials tells, where the part is one.
    fn part(&self, within: Interval, ratio: Option<Ratio>) -> Late {
        let known = ratio.as_ref().filter(|_| self.from_s > 0.0).and_then(|ratio| ratio.from(self.from_s));
        let within = both(within, known);
        let term = match &ratio {
            Some(over) => Damped { over: Some(over.clone()), sign: sign_of(within), ..Damped::bounded(ONE) },
            None => Damped::bounded(within),
        };
        Late { within, ratio, square: None, terms: vec![term], waves: Waves::default(), rest: within, constant: false }
    }

    /// What has this square, a quotient of polynomials, and a value throughout.
    fn rooted(&self, part: Late, square: Option<Ratio>) -> Late {
        let Some(root) = square.filter(|_| part.ratio.is_none() && part.within.low.is_finite()) else { return part };
        let known = Damped { root: Some(root.clone()), sign: sign_of(part.within), ..Damped::bounded(ONE) };
        let within = both(part.within, known.within(self.from_s));
        Late { within, rest: within, square: Some(root), terms: vec![known], ..part }
    }

    /// The same by the sum of `terms`, of which quotients, exponentials that fall, and roots make more than their ends tell.
    fn multiplied_out(&self, part: Late, terms: Option<Vec<Damped>>) -> Late {
        let Some(terms) = terms.filter(|terms| part.ratio.is_none() && terms.len() <= MOST_TERMS) else { return part };
        // Of what is only bounded a sum tells no more than its ends.
        let plain =
            |term: &Damped| term.wave.is_none() && term.over.is_none() && term.root.is_none() && term.power.is_none();
        if terms.iter().all(plain) {
            return Late { terms, ..part };
        }
        let sum = self.total(&terms);
        let within = both(part.within, sum);
        Late { within, rest: within, terms, ..part }
    }

    /// What a sum keeps within, of which sines of one angle make less than each by itself.
    fn total(&self, terms: &[Damped]) -> Option<Interval> {
        let (mut waves, mut rest) = (Waves::default(), ZERO);
        for term in terms {
            let beside = term.beside_its_wave(self.from_s)?;
            match &term.wave {
                Some((angle, Wave::Sine)) => waves.add(angle, [beside, ZERO]),
                Some((angle, Wave::Cosine)) => waves.add(angle, [ZERO, beside]),
                None => rest = rest + beside,
            }
        }
        Some(rest + waves.within())
    }

    fn product(&self, within: Interval, ratio: Option<Ratio>, [a, b]: [&[Damped]; 2]) -> Late {
        let pairs = || a.iter().flat_map(|a| b.iter().map(move |b| a.times(b)));
        let terms = (a.len() * b.len() <= MOST_TERMS).then(|| pairs().collect()).flatten();
        self.multiplied_out(self.part(within, ratio), terms)
    }

    /// A sum, also with sines and cosines apart from what is left whole.
    fn sum(&self, within: Interval, ratio: Option<Ratio>, [a, b]: [&Late; 2], sign: Interval) -> Late {
        let (mut waves, rest) = (a.waves.clone(), a.rest + sign * b.rest);
        b.waves.scaled(sign).0.into_iter().for_each(|(angle, scales)| waves.add(&angle, scales));
        let terms = a.terms.iter().cloned().chain(b.terms.iter().map(|term| term.scaled(sign))).collect();
        let part = self.multiplied_out(self.part(within, ratio), Some(terms));
        if waves.0.is_empty() || self.from_s == 0.0 {
            return part;
        }
        let within = both(part.within, Some(rest + waves.within()));
        Late { within, waves, rest, ..part }
    }

    fn wave(part: Late, angle: &Ratio, wave: Wave, scales: [Interval; 2]) -> Late {
        let term = Damped { wave: Some((angle.clone(), wave)), ..Damped::bounded(ONE) };
        Late { terms: vec![term], waves: Waves(vec![(angle.clone(), scales)]), rest: ZERO, ..part }
    }

    /// The same, multiplied with what keeps within an interval.
    fn scaled(part: Late, a: &Late, by: Interval) -> Late {
        if a.waves.0.is_empty() {
            return part;
        }
        Late { waves: a.waves.scaled(by), rest: by * a.rest, ..part }
    }
}

impl Damped {
    fn bounded(rest: Interval) -> Damped {
        Damped { wave: None, over: None, root: None, sign: ONE, power: None, rest }
    }

    fn within(&self, from_s: f64) -> Option<Interval> {
        let swings = if self.wave.is_some() { EITHER } else { ONE };
        Some(self.beside_its_wave(from_s)? * swings)
    }

    /// |p| ≤ c tⁿ and g ≤ −r t make p exp(g) at most c tⁿ exp(−r t), which falls from n/r on.
    fn beside_its_wave(&self, from_s: f64) -> Option<Interval> {
        if from_s == 0.0 {
            return None;
        }
        let rest = self.rest.size();
        let Some(power) = &self.power else {
            return Some(self.factor(from_s)? * self.rest);
        };
        let falls = -power.times(&Ratio::time().inverse()?)?.from(from_s)?.high;
        let square = self.square()?;
        // n is half of the degree of the square, rounded up.
        let n = (square.degree().max(0) + 1) / 2;
        let most = square.times(&Ratio::time().power(-i64::from(2 * n))?)?.from(from_s)?.size().sqrt().next_up();
        if !(falls > 0.0 && falls.is_finite() && most.is_finite() && rest.is_finite()) {
            return None;
        }
        let start = from_s.max(f64::from(n) / falls);
        let size = most * rest * libm::pow(start, f64::from(n)) * libm::exp(-falls * start) * (1.0 + 1e-9);
        // What is too small for a number is not zero.
        let size = size.max(f64::MIN_POSITIVE);
        Some(Interval { low: -size, high: size })
    }

    /// What quotients and roots keep within together: but for its sign it is the root of their square, which is a quotient itself.
    /// Roots by themselves are ∞/∞ beside what they are divided by.
    fn factor(&self, from_s: f64) -> Option<Interval> {
        match (&self.over, &self.root) {
            (None, None) => Some(ONE),
            (Some(over), None) => over.from(from_s),
            (_, Some(_)) => {
                let square = self.square()?.from(from_s)?;
                Some(self.sign * of(Unary::Sqrt, Interval { low: square.low.max(0.0), ..square }))
            }
        }
    }

    /// The square of quotients and roots.
    fn square(&self) -> Option<Ratio> {
        let one = Ratio::number(BigRational::one());
        let over = self.over.as_ref().unwrap_or(&one);
        over.times(over)?.times(self.root.as_ref().unwrap_or(&one))
    }

    fn scaled(&self, by: Interval) -> Damped {
        Damped { rest: by * self.rest, ..self.clone() }
    }

    fn times(&self, other: &Damped) -> Option<Damped> {
        let joined = |a: &Option<Ratio>, b: &Option<Ratio>, f: fn(&Ratio, &Ratio) -> Option<Ratio>| match (a, b) {
            (Some(a), Some(b)) => f(a, b).map(Some),
            (one, other) => Some(one.clone().or_else(|| other.clone())),
        };
        // Of two waves one is kept.
        let swings = if self.wave.is_some() && other.wave.is_some() { EITHER } else { ONE };
        Some(Damped {
            wave: self.wave.clone().or_else(|| other.wave.clone()),
            over: joined(&self.over, &other.over, Ratio::times)?,
            root: joined(&self.root, &other.root, Ratio::times)?,
            sign: self.sign * other.sign,
            power: joined(&self.power, &other.power, Ratio::plus)?,
            rest: self.rest * other.rest * swings,
        })
    }
}

/// What lies in both, of which the first may be undefined.
fn both(a: Interval, b: Option<Interval>) -> Interval {
    b.map_or(a, |b| Interval { low: b.low.max(a.low), high: b.high.min(a.high) })
}

/// The sign of what keeps within an interval, between −1 and 1.
fn sign_of(within: Interval) -> Interval {
    match (within.low >= 0.0, within.high <= 0.0) {
        (true, false) => ONE,
        (false, true) => -ONE,
        (true, true) | (false, false) => EITHER,
    }
}

/// What a function makes of an interval; not-a-number, which absorbs, where it may have no value.
pub(super) fn of(function: Unary, a: Interval) -> Interval {
    Intervals(&[]).unary(function, a)
}

/// The same of a power.
pub(super) fn to_power(a: Interval, exponent: &Number) -> Interval {
    Intervals(&[]).power(a, exponent)
}

impl Algebra for Lates {
    type Value = Late;

    fn number(&mut self, number: &Number) -> Late {
        let part = self.part(number.within(), number.exact().map(Ratio::number));
        Late { constant: true, ..part }
    }

    fn variable(&mut self, _: usize) -> Late {
        let within = Interval { low: self.from_s, high: f64::INFINITY };
        Late { within, rest: within, ..self.part(within, Some(Ratio::time())) }
    }

    fn unary(&mut self, function: Unary, a: Late) -> Late {
        let within = of(function, a.within);
        let negated = || a.ratio.as_ref().map(Ratio::negated);
        let ratio = match function {
            Unary::Negate => negated(),
            Unary::Abs if a.within.low >= 0.0 => a.ratio.clone(),
            Unary::Abs if a.within.high <= 0.0 => negated(),
            _ => None,
        };
        let part = Late { constant: a.constant, ..self.part(within, ratio) };
        match (function, &a.ratio) {
            _ if a.constant => part,
            (Unary::Negate, _) => {
                let terms = a.terms.iter().map(|term| term.scaled(-ONE)).collect();
                Lates::scaled(self.multiplied_out(part, Some(terms)), &a, -ONE)
            }
            (Unary::Exp, Some(power)) => {
                Late { terms: vec![Damped { power: Some(power.clone()), ..Damped::bounded(ONE) }], ..part }
            }
            (Unary::Sqrt, Some(square)) if a.within.low >= 0.0 => self.rooted(part, Some(square.clone())),
            (Unary::Sin, Some(angle)) => Lates::wave(part, angle, Wave::Sine, [ONE, ZERO]),
            (Unary::Cos, Some(angle)) => Lates::wave(part, angle, Wave::Cosine, [ZERO, ONE]),
            _ => part,
        }
    }

    fn binary(&mut self, function: Binary, a: Late, b: Late) -> Late {
        let (x, y) = (a.within, b.within);
        let ratios = a.ratio.as_ref().zip(b.ratio.as_ref());
        let constant = a.constant && b.constant;
        let found = match function {
            Binary::Add => self.sum(x + y, ratios.and_then(|(a, b)| a.plus(b)), [&a, &b], ONE),
            Binary::Subtract => self.sum(x - y, ratios.and_then(|(a, b)| a.plus(&b.negated())), [&a, &b], -ONE),
            Binary::Multiply => {
                let part = self.product(x * y, ratios.and_then(|(a, b)| a.times(b)), [&a.terms, &b.terms]);
                if a.waves.0.is_empty() { Lates::scaled(part, &b, x) } else { Lates::scaled(part, &a, y) }
            }
            Binary::Divide => {
                let [over, root] = [&b.ratio, &b.square].map(|known| known.as_ref().and_then(Ratio::inverse));
                let divisor = match over.is_some() || root.is_some() {
                    true => [Damped { over, root, sign: sign_of(y), ..Damped::bounded(ONE) }],
                    false => [Damped::bounded(ONE / y)],
                };
                let part = self.product(x / y, ratios.and_then(|(a, b)| a.times(&b.inverse()?)), [&a.terms, &divisor]);
                Lates::scaled(part, &a, ONE / y)
            }
            Binary::Min | Binary::Max => {
                let within = Intervals(&[]).binary(function, x, y);
                let apart = self.sum(x - y, ratios.and_then(|(a, b)| a.plus(&b.negated())), [&a, &b], -ONE).within;
                let first = match function {
                    Binary::Min => (apart.high <= 0.0).then_some(true).or((apart.low >= 0.0).then_some(false)),
                    _ => (apart.low >= 0.0).then_some(true).or((apart.high <= 0.0).then_some(false)),
                };
                let ratio = first.and_then(|first| if first { a.ratio.clone() } else { b.ratio.clone() });
                self.part(within, ratio)
            }
        };
        Late { constant, ..found }
    }

    fn power(&mut self, a: Late, exponent: &Number) -> Late {
        let within = to_power(a.within, exponent);
        let part = self.part(within, a.ratio.as_ref().and_then(|ratio| ratio.power(whole(exponent)?)));
        // A root by another name, or a power of one.
        let square = match (&a.ratio, &a.square) {
            (Some(ratio), _) if a.within.low >= 0.0 => twice(exponent).and_then(|exponent| ratio.power(exponent)),
            (None, Some(square)) => whole(exponent).and_then(|exponent| square.power(exponent)),
            _ => None,
        };
        let found = if a.constant { part } else { self.rooted(part, square) };
        Late { constant: a.constant, ..found }
    }
}

/// Twice an exponent, where that is a whole number.
pub(super) fn twice(exponent: &Number) -> Option<i64> {
    let doubled = exponent.exact()? * BigRational::from_integer(2.into());
    if doubled.is_integer() { doubled.to_i64() } else { None }
}

/// An exponent that is a whole number.
pub(super) fn whole(exponent: &Number) -> Option<i64> {
    exponent.exact().filter(BigRational::is_integer)?.to_i64()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn t() -> Expression {
        Expression::variable(0)
    }

    fn within(formula: &Expression) -> [f64; 2] {
        let Interval { low, high } = late(formula, 1.0).within;
        [low, high]
    }

    /// Bounds that are met from outside, by rounding alone.
    fn is_sharp(formula: &Expression, [low, high]: [f64; 2]) -> bool {
        let found = within(formula);
        found[0] <= low && found[1] >= high && found[0] > low - 1e-9 && found[1] < high + 1e-9
    }

    #[test]
    fn waves_of_one_angle_add_up_as_vectors_whatever_stands_for_their_numbers() {
        let six = || Expression::number(2.0) * Expression::number(3.0);
        assert!(is_sharp(&(six() * t().sin_of() + t().cos_of() * 8.0), [-10.0, 10.0]));
        assert!(is_sharp(&(t().sin_of() * six() - t().cos_of() / Expression::number(0.125)), [-10.0, 10.0]));
        // Of an angle that has a number in it, which is no number itself.
        for angle in [t() + 1.0, Expression::number(1.0) + t(), t() * 2.0] {
            assert!(is_sharp(&(angle.clone().sin_of() * 3.0 + angle.cos_of() * 4.0), [-5.0, 5.0]));
        }
        // By what varies, too: 1 + 1/t is at most two from one second on.
        let varies = || Expression::number(1.0) / t() + 1.0;
        for product in [varies() * t().sin_of(), t().sin_of() * varies(), t().sin_of() / (t() / (t() + 1.0))] {
            assert!(is_sharp(&(product + t().cos_of()), [-5.0_f64.sqrt(), 5.0_f64.sqrt()]));
        }
        // Factors that are unbounded by themselves are weighed together first.
        assert!(is_sharp(&(t().cos_of() * t() / (t() + 1.0) + t().sin_of()), [-2.0_f64.sqrt(), 2.0_f64.sqrt()]));
        // Of two sines in one product one is taken.
        assert!(is_sharp(&(t().sin_of() * t().sin_of() * 3.0 + t().cos_of() * 4.0), [-5.0, 5.0]));
    }

    /// t e^−t is at most 1/e and falls from 1 s on, whatever swings beside it and whatever else is added before it is multiplied.
    #[test]
    fn sums_are_multiplied_out_before_exponentials_are_weighed() {
        let fall = || (-t()).exp_of();
        let e = core::f64::consts::E;
        let both = 2.0_f64.sqrt() / e;
        assert!(is_sharp(&((t() * t().sin_of() + t().cos_of()) * fall()), [-both, both]));
        assert!(is_sharp(&(fall() * (t().cos_of() - t() * t().sin_of())), [-both, both]));
        assert!(is_sharp(&-((t() * t().sin_of() + t() * t().cos_of()) * fall()), [-both, both]));
        // What is taken away keeps its sign.
        assert!(is_sharp(&(t() * t().sin_of() * fall() - 2.0), [-2.0 - 1.0 / e, -2.0 + 1.0 / e]));
        // What is a quotient of polynomials is kept whole: t − t²/(1 + t) is at most one.
        let bounded = t() - t().power(2.0) / (t() + 1.0);
        assert!(is_sharp(&(bounded * t().sin_of()), [-1.0, 1.0]));
        // What grows is not bounded by that.
        assert!(within(&((t() * t().sin_of() + t().cos_of()) * 2.0))[1].is_infinite());
        assert!(within(&((t() * t().sin_of() + t().cos_of()) * t().exp_of()))[1].is_infinite());
    }

    /// Each factor by itself is unbounded, or comes to zero.
    #[test]
    fn roots_are_weighed_against_what_they_are_divided_by_and_keep_their_sign() {
        let root = |c: f64| (t().power(2.0) + c).sqrt_of();
        // √(t² + 3)/t falls from 2 to 1, as does its square from 4.
        assert!(is_sharp(&(root(3.0) / t()), [1.0, 2.0]) && is_sharp(&-(root(3.0) / t()), [-2.0, -1.0]));
        assert!(is_sharp(&(t() / root(3.0)), [0.5, 1.0]) && is_sharp(&((t() - t() * 2.0) / root(3.0)), [-1.0, -0.5]));
        assert!(is_sharp(&(root(3.0).power(-2.0) * t().power(2.0)), [0.25, 1.0]));
        assert!(is_sharp(&((t().power(2.0) + 3.0).power(-0.5) * t()), [0.5, 1.0]));
        // Beside what swings the size counts, and an exponential overcomes a root: √t e^−t is at most 1/e from 1 s on.
        assert!(is_sharp(&(root(3.0) / t() * t().cos_of()), [-2.0, 2.0]));
        let e = core::f64::consts::E;
        let fall = within(&(t().sqrt_of() * (-t()).exp_of()));
        assert!(fall[1] >= 1.0 / e && fall[1] < 1.0 / e + 1e-9, "{fall:?}");
        // What is nowhere decided has either sign: t − 2 is negative at first.
        assert!(within(&((t() - 2.0) / root(3.0)))[0] < 0.0);
        // What has no value at first is not bounded, whatever is made of it, and what grows is not bounded.
        for formula in [(t() - 5.0).sqrt_of() / t(), (t() - 5.0).sqrt_of().sin_of(), t() / (t() - 5.0).sqrt_of()] {
            assert_eq!(within(&formula), [f64::NEG_INFINITY, f64::INFINITY], "{formula:?}");
        }
        assert!(within(&(root(3.0) * t().sin_of()))[1].is_infinite());
    }
}
