//! What a formula keeps within from some time on, in one pass and by the rules that a checker has.

use forwardstep_core::expression::{Algebra, Binary, Expression, Interval, Number, Step, Unary};
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
    /// Itself once products are multiplied out: the sum of these.
    terms: Vec<Damped>,
    /// Sines and cosines of one angle each, by what they are multiplied with; and what the rest keeps within.
    waves: Vec<(Ratio, [Interval; 2])>,
    rest: Interval,
    constant: bool,
}

/// A product: a quotient of polynomials, the exponential of one, and what keeps within bounds.
#[derive(Clone, Debug)]
struct Damped {
    over: Option<Ratio>,
    power: Option<Ratio>,
    rest: Interval,
}

/// What `formula` does from `from_s` on.
pub(super) fn late(formula: &Expression, from_s: f64) -> Late {
    formula.fold(&mut Lates { from_s })
}

/// The algebra of what formulas do from a time on.
struct Lates {
    from_s: f64,
}

/// Terms of a sum that are kept apart.
const MOST_TERMS: usize = 32;
const ONE: Interval = Interval { low: 1.0, high: 1.0 };
const ZERO: Interval = Interval { low: 0.0, high: 0.0 };

impl Lates {
    /// With what the quotient of polynomials tells, where the part is one.
    fn part(&self, within: Interval, ratio: Option<Ratio>) -> Late {
        let known = ratio.as_ref().filter(|_| self.from_s > 0.0).and_then(|ratio| ratio.from(self.from_s));
        let within = both(within, known);
        let plain = Damped { over: None, power: None, rest: within };
        let term = ratio.clone().map_or(plain, |over| Damped { over: Some(over), power: None, rest: ONE });
        Late { within, ratio, terms: vec![term], waves: Vec::new(), rest: within, constant: false }
    }

    /// The same by the sum of `terms`, of which exponentials that fall make more than their ends tell.
    fn multiplied_out(&self, part: Late, terms: Option<Vec<Damped>>) -> Late {
        let Some(terms) = terms.filter(|terms| part.ratio.is_none() && terms.len() <= MOST_TERMS) else { return part };
        if terms.iter().all(|term| term.power.is_none()) {
            return Late { terms, ..part };
        }
        let sum = terms.iter().try_fold(ZERO, |sum, term| Some(sum + term.within(self.from_s)?));
        let within = both(part.within, sum);
        Late { within, rest: within, terms, ..part }
    }

    fn product(&self, within: Interval, ratio: Option<Ratio>, [a, b]: [&[Damped]; 2]) -> Late {
        let pairs = || a.iter().flat_map(|a| b.iter().map(move |b| a.times(b)));
        let terms = (a.len() * b.len() <= MOST_TERMS).then(|| pairs().collect()).flatten();
        self.multiplied_out(self.part(within, ratio), terms)
    }

    /// A sum, of which sines of one angle make less than each by itself.
    fn sum(&self, within: Interval, ratio: Option<Ratio>, [a, b]: [&Late; 2], sign: Interval) -> Late {
        let (mut waves, rest) = (a.waves.clone(), a.rest + sign * b.rest);
        for (angle, scales) in &b.waves {
            let scales = scales.map(|scale| sign * scale);
            match waves.iter_mut().find(|(known, _)| known == angle) {
                Some((_, sum)) => *sum = [sum[0] + scales[0], sum[1] + scales[1]],
                None => waves.push((angle.clone(), scales)),
            }
        }
        let terms = a.terms.iter().cloned().chain(b.terms.iter().map(|term| term.scaled(sign))).collect();
        let part = self.multiplied_out(self.part(within, ratio), Some(terms));
        if waves.is_empty() || self.from_s == 0.0 {
            return part;
        }
        let size = |[sine, cosine]: &[Interval; 2]| {
            of(
                Step::Unary(Unary::Sqrt),
                Interval::point(sine.size()) * Interval::point(sine.size())
                    + Interval::point(cosine.size()) * Interval::point(cosine.size()),
            )
            .high
        };
        let most = waves.iter().map(|(_, scales)| size(scales)).fold(0.0, |sum, size| (sum + size).next_up());
        let swinging = rest + Interval { low: -most, high: most };
        let within = both(part.within, Some(swinging));
        Late { within, waves, rest, ..part }
    }

    /// The same, multiplied with a number.
    fn scaled(part: Late, a: &Late, by: Interval) -> Late {
        if a.waves.is_empty() {
            return part;
        }
        let waves = a.waves.iter().map(|(angle, scales)| (angle.clone(), scales.map(|scale| by * scale))).collect();
        Late { waves, rest: by * a.rest, ..part }
    }
}

impl Damped {
    /// |p| ≤ c tⁿ and g ≤ −r t make p exp(g) at most c tⁿ exp(−r t), which falls from n/r on.
    fn within(&self, from_s: f64) -> Option<Interval> {
        if from_s == 0.0 {
            return None;
        }
        let rest = self.rest.size();
        let Some(power) = &self.power else {
            return Some(self.over.as_ref().map_or(Some(ONE), |over| over.from(from_s))? * self.rest);
        };
        let falls = -power.times(&Ratio::time().inverse()?)?.from(from_s)?.high;
        let number = Ratio::number(BigRational::one());
        let over = self.over.as_ref().unwrap_or(&number);
        let n = over.degree().max(0);
        let most = over.times(&Ratio::time().power(-i64::from(n))?)?.from(from_s)?.size();
        if !(falls > 0.0 && falls.is_finite() && most.is_finite() && rest.is_finite()) {
            return None;
        }
        let start = from_s.max(f64::from(n) / falls);
        let size = most * rest * libm::pow(start, f64::from(n)) * libm::exp(-falls * start) * (1.0 + 1e-9);
        // What is too small for a number is not zero.
        let size = size.max(f64::MIN_POSITIVE);
        Some(Interval { low: -size, high: size })
    }

    fn scaled(&self, by: Interval) -> Damped {
        Damped { rest: by * self.rest, ..self.clone() }
    }

    fn times(&self, other: &Damped) -> Option<Damped> {
        let joined = |a: &Option<Ratio>, b: &Option<Ratio>, f: fn(&Ratio, &Ratio) -> Option<Ratio>| match (a, b) {
            (Some(a), Some(b)) => f(a, b).map(Some),
            (one, other) => Some(one.clone().or_else(|| other.clone())),
        };
        let over = joined(&self.over, &other.over, Ratio::times)?;
        Some(Damped { over, power: joined(&self.power, &other.power, Ratio::plus)?, rest: self.rest * other.rest })
    }
}

/// What lies in both, of which the first may be undefined.
fn both(a: Interval, b: Option<Interval>) -> Interval {
    b.map_or(a, |b| Interval { low: b.low.max(a.low), high: b.high.min(a.high) })
}

/// What a function makes of an interval.
pub(super) fn of(step: Step, a: Interval) -> Interval {
    Expression::new(vec![Step::Variable(0), step]).map_or(Interval::WHOLE, |function| function.enclose(a))
}

fn smaller(a: Interval, b: Interval) -> Interval {
    Interval { low: a.low.min(b.low), high: a.high.min(b.high) }
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
        let within = of(Step::Unary(function), a.within);
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
                Late { terms: vec![Damped { over: None, power: Some(power.clone()), rest: ONE }], ..part }
            }
            (Unary::Sin, Some(angle)) => Late { waves: vec![(angle.clone(), [ONE, ZERO])], rest: ZERO, ..part },
            (Unary::Cos, Some(angle)) => Late { waves: vec![(angle.clone(), [ZERO, ONE])], rest: ZERO, ..part },
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
                match (a.constant, b.constant) {
                    (true, _) => Lates::scaled(part, &b, x),
                    (_, true) => Lates::scaled(part, &a, y),
                    _ => part,
                }
            }
            Binary::Divide => {
                let over = b.ratio.as_ref().and_then(Ratio::inverse);
                let rest = if over.is_some() { ONE } else { ONE / y };
                let divisor = [Damped { over, power: None, rest }];
                let part = self.product(x / y, ratios.and_then(|(a, b)| a.times(&b.inverse()?)), [&a.terms, &divisor]);
                if b.constant { Lates::scaled(part, &a, ONE / y) } else { part }
            }
            Binary::Min | Binary::Max => {
                let within = if function == Binary::Min { smaller(x, y) } else { -smaller(-x, -y) };
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
        let within = of(Step::Power(exponent.clone()), a.within);
        let part = self.part(within, a.ratio.as_ref().and_then(|ratio| ratio.power(whole(exponent)?)));
        Late { constant: a.constant, ..part }
    }
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
        // By what varies waves are not scaled: ±(1 + 1/t) is at most two from one second on.
        let varies = Expression::number(1.0) / t() + 1.0;
        let found = within(&(varies * t().sin_of() + t().cos_of()));
        assert!(found[0] <= -2.3 && found[1] >= 2.3, "{found:?}");
    }

    /// t e^−t is at most 1/e and falls from 1 s on, whatever swings beside it and whatever else is added before it is multiplied.
    #[test]
    fn sums_are_multiplied_out_before_exponentials_are_weighed() {
        let fall = || (-t()).exp_of();
        let e = core::f64::consts::E;
        assert!(is_sharp(&((t() * t().sin_of() + t().cos_of()) * fall()), [-2.0 / e, 2.0 / e]));
        assert!(is_sharp(&(fall() * (t().cos_of() - t() * t().sin_of())), [-2.0 / e, 2.0 / e]));
        assert!(is_sharp(&-((t() * t().sin_of() + t() * t().cos_of()) * fall()), [-2.0 / e, 2.0 / e]));
        // What is taken away keeps its sign.
        assert!(is_sharp(&(t() * t().sin_of() * fall() - 2.0), [-2.0 - 1.0 / e, -2.0 + 1.0 / e]));
        // What is a quotient of polynomials is kept whole: t − t²/(1 + t) is at most one.
        let bounded = t() - t().power(2.0) / (t() + 1.0);
        assert!(is_sharp(&(bounded * t().sin_of()), [-1.0, 1.0]));
        // Without an exponential there is nothing to gain, and with one that grows nothing is known.
        assert!(within(&((t() * t().sin_of() + t().cos_of()) * 2.0))[1].is_infinite());
        assert!(within(&((t() * t().sin_of() + t().cos_of()) * t().exp_of()))[1].is_infinite());
    }
}
