//! Where an expression in several variables has a value: everywhere, not at a point that is shown, or neither is known.
//!
//! One pass over the whole space shows most: 2 + cos x and 1 + x² are divided by nowhere near zero, and eˣ has a logarithm
//! though its infimum is zero. Else the space is cut, each variable x through x/(1 + |x|), up to infinity.
//!
//! Against it speaks a divisor that changes its sign between two points while what is divided keeps away from zero, or is
//! zero at a point; a logarithm, a root or a power of what is negative at a point.

use alloc::vec;
use alloc::vec::Vec;

use super::interval::{Interval, Intervals};
use super::operation::Operation;
use super::tail::{Series, Tails};
use super::{Algebra, Binary, Expression, Number, Step, Unary};

/// Boxes that are looked at.
const BOXES: usize = 4000;
/// Points that are looked at.
const POINTS: u32 = 600;
/// Sizes beyond which series may be used.
const TAIL: f64 = 16.0;
/// Halvings between two points.
const HALVINGS: u32 = 80;

/// What is known of where an expression has a value.
#[derive(Clone, Debug, PartialEq)]
pub enum Domain {
    /// Everywhere, and it is Lipschitz continuous on every bounded set.
    Everywhere,
    /// Not at this point, or not within rounding of it.
    Fails {
        /// The variables.
        at: Vec<f64>,
        /// Why.
        gap: Gap,
    },
    /// Neither is shown.
    NotShown,
}

/// Why there is no value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Gap {
    /// A divisor comes to zero, and the quotient exceeds every bound.
    Pole,
    /// A root, a power or a logarithm of what is negative.
    Negative,
    /// The logarithm of zero.
    ZeroLogarithm,
}

/// What holds of a sub-expression on a box, in exact arithmetic.
#[derive(Clone, Copy, Debug)]
struct Part {
    within: Interval,
    /// It is zero nowhere, though it may come close.
    nonzero: bool,
    /// It has a value everywhere, and bounded slopes on every bounded set.
    total: bool,
}

impl Part {
    fn new(within: Interval, nonzero: bool, total: bool) -> Self {
        // What overflows has a value all the same.
        let within = within.or_whole();
        Part { within, nonzero: nonzero || !within.holds(0.0), total }
    }

    fn is_positive(self) -> bool {
        self.within.low >= 0.0 && self.nonzero
    }

    fn is_negative(self) -> bool {
        self.within.high <= 0.0 && self.nonzero
    }
}

/// The algebra of parts, with a box.
struct Parts<'a>(&'a [Interval]);

impl Algebra for Parts<'_> {
    type Value = Part;

    fn number(&mut self, number: &Number) -> Part {
        Part::new(number.within(), false, true)
    }

    fn variable(&mut self, index: usize) -> Part {
        Part::new(self.0.get(index).copied().unwrap_or(Interval::WHOLE), false, true)
    }

    fn unary(&mut self, function: Unary, a: Part) -> Part {
        let within = Intervals(&[]).unary(function, a.within);
        match function {
            Unary::Negate | Unary::Abs | Unary::Tanh | Unary::Atan => Part::new(within, a.nonzero, a.total),
            Unary::Sin | Unary::Cos => Part::new(within, false, a.total),
            Unary::Exp => {
                Part::new(Interval { low: within.or_whole().low.max(0.0), ..within.or_whole() }, true, a.total)
            }
            Unary::Log => Part::new(within, false, a.total && a.is_positive()),
            Unary::Sqrt => Part::new(within, a.nonzero, a.total && a.is_positive()),
        }
    }

    fn binary(&mut self, function: Binary, a: Part, b: Part) -> Part {
        let within = Intervals(&[]).binary(function, a.within, b.within);
        let total = a.total && b.total;
        let alike = a.within.low >= 0.0 && b.within.low >= 0.0 || a.within.high <= 0.0 && b.within.high <= 0.0;
        match function {
            Binary::Add => Part::new(within, alike && (a.nonzero || b.nonzero), total),
            Binary::Subtract => Part::new(within, false, total),
            Binary::Multiply => Part::new(within, a.nonzero && b.nonzero, total),
            Binary::Divide => Part::new(quotient(a, b), a.nonzero, total && b.nonzero),
            Binary::Min | Binary::Max => Part::new(within, a.nonzero && b.nonzero, total),
        }
    }

    fn power(&mut self, a: Part, exponent: &Number) -> Part {
        let within = Intervals(&[]).power(a.within, exponent);
        let Interval { low: least, high: most } = exponent.within();
        let is_whole = least == most && libm::trunc(least) == least;
        let total = match is_whole {
            true => least >= 0.0 || a.nonzero,
            false => a.is_positive() || a.within.low >= 0.0 && least >= 1.0,
        };
        let within = match is_whole && least % 2.0 != 0.0 {
            true => within,
            // An even power, or a root.
            false => Interval { low: within.or_whole().low.max(0.0), ..within.or_whole() },
        };
        Part::new(within, a.nonzero || least == 0.0 && most == 0.0, a.total && total)
    }
}

/// The algebra of parts of an expression in one variable beyond some size, to one side: what series say is known as well.
struct Beyond {
    tails: Tails,
    rising: bool,
}

impl Beyond {
    fn joined(series: Series, part: Part) -> (Series, Part) {
        if !series.is_known() {
            return (series, part);
        }
        let within = part.within.and(series.range());
        let nonzero = part.nonzero || series.keeps_from_zero();
        (series, Part::new(if within.low <= within.high { within } else { part.within }, nonzero, part.total))
    }
}

impl Algebra for Beyond {
    type Value = (Series, Part);

    fn number(&mut self, number: &Number) -> Self::Value {
        Beyond::joined(self.tails.number(number), Parts(&[]).number(number))
    }

    fn variable(&mut self, index: usize) -> Self::Value {
        let t = self.tails.variable(index);
        let x = if self.rising { t } else { self.tails.unary(Unary::Negate, t) };
        Beyond::joined(x, Parts(&[]).variable(index))
    }

    fn unary(&mut self, function: Unary, (series, part): Self::Value) -> Self::Value {
        Beyond::joined(self.tails.unary(function, series), Parts(&[]).unary(function, part))
    }

    fn binary(&mut self, function: Binary, a: Self::Value, b: Self::Value) -> Self::Value {
        Beyond::joined(self.tails.binary(function, a.0, b.0), Parts(&[]).binary(function, a.1, b.1))
    }

    fn power(&mut self, (series, part): Self::Value, exponent: &Number) -> Self::Value {
        Beyond::joined(self.tails.power(series, exponent), Parts(&[]).power(part, exponent))
    }
}

/// A quotient by what may come close to zero, but is on one side of it, has the sign that follows.
fn quotient(a: Part, b: Part) -> Interval {
    let divided = Intervals(&[]).binary(Binary::Divide, a.within, b.within);
    let (upper, lower) = (Interval { low: 0.0, high: f64::INFINITY }, Interval { low: f64::NEG_INFINITY, high: 0.0 });
    match () {
        () if divided.low <= divided.high => divided,
        () if a.within.low >= 0.0 && b.is_positive() || a.within.high <= 0.0 && b.is_negative() => upper,
        () if a.within.low >= 0.0 && b.is_negative() || a.within.high <= 0.0 && b.is_positive() => lower,
        () => Interval::WHOLE,
    }
}

impl Expression {
    /// Where it has a value, for any values of its variables.
    pub fn domain(&self) -> Domain {
        if self.shown(|part| part.total) {
            return Domain::Everywhere;
        }
        let found = self.operations().into_iter().filter_map(Place::of).find_map(|place| place.fails());
        found.map_or(Domain::NotShown, |(at, gap)| Domain::Fails { at, gap })
    }

    /// Whether so many derivatives are bounded on every bounded set, as far as powers go that are no whole numbers: each has a base that is
    /// positive everywhere, or an exponent as large. With a smaller one a derivative is a product of what is infinite and what is zero.
    pub fn bears_derivatives(&self, count: usize) -> bool {
        self.operations().into_iter().all(|operation| {
            let (base, exponent) = match operation {
                Operation::Power(base, exponent) if libm::trunc(exponent.value()) != exponent.value() => {
                    (base, exponent.within().low)
                }
                Operation::Unary(Unary::Sqrt, base) => (base, 0.5),
                Operation::Unary(..) | Operation::Binary(..) | Operation::Power(..) => return true,
            };
            let (within, nonzero) = Expression { steps: base.to_vec() }.everywhere();
            exponent >= count as f64 || within.low >= 0.0 && nonzero
        })
    }

    /// An interval that holds its value everywhere, and whether it is shown to be zero nowhere.
    pub fn everywhere(&self) -> (Interval, bool) {
        let part = self.fold(&mut Parts(&vec![Interval::WHOLE; self.variables()]));
        let size = |part: Part| part.within.low.max(-part.within.high);
        if !part.total || size(part) > 0.0 || self.variables() == 0 {
            return (part.within, part.total && part.nonzero);
        }
        (part.within, self.shown(|part| part.total && part.nonzero))
    }

    /// A point at which it is zero, as far as that can be told in `f64`: it is so by interval arithmetic, or changes its sign.
    pub fn zero(&self) -> Option<Vec<f64>> {
        Place { of: Some(Expression::number(1.0)), inner: self.clone(), kind: Kind::Divisor }.fails().map(|(at, _)| at)
    }

    /// What holds on a box.
    fn on(&self, within: &[Interval]) -> Part {
        let mut used = within.iter().enumerate().filter(|(index, _)| self.has(*index)).map(|(_, within)| *within);
        let (Some(only), None) = (used.next(), used.next()) else { return self.fold(&mut Parts(within)) };
        // To both sides of the variable that is there alone.
        let (from, rising) = if only.high == f64::INFINITY { (only.low, true) } else { (-only.high, false) };
        let far = from.is_finite() && from >= TAIL && (rising || only.low == f64::NEG_INFINITY);
        if far { self.fold(&mut Beyond { tails: Tails { from }, rising }).1 } else { self.fold(&mut Parts(within)) }
    }

    /// Whether something is shown on every box of a division of the whole space.
    fn shown(&self, good: impl Fn(Part) -> bool) -> bool {
        let variables = self.variables();
        let mut waiting = vec![vec![[-1.0_f64, 1.0]; variables]];
        for _ in 0..BOXES {
            let Some(part) = waiting.pop() else { return true };
            let within: Vec<Interval> = part.iter().map(|ends| stretched(*ends)).collect();
            if good(self.on(&within)) {
                continue;
            }
            let used = (0..variables).filter(|index| self.has(*index));
            let width = |index: &usize| part[*index][1] - part[*index][0];
            let Some(widest) = used.max_by(|a, b| width(a).total_cmp(&width(b))) else { return false };
            if width(&widest) < 1e-3 {
                return false;
            }
            let [low, high] = part[widest];
            let middle = 0.5 * (low + high);
            for ends in [[low, middle], [middle, high]] {
                let mut half = part.clone();
                half[widest] = ends;
                waiting.push(half);
            }
        }
        false
    }
}

/// x where x/(1 + |x|) is between these.
fn stretched([low, high]: [f64; 2]) -> Interval {
    let x = |u: f64| if u.abs() >= 1.0 { f64::INFINITY.copysign(u) } else { u / (1.0 - u.abs()) };
    Interval { low: x(low), high: x(high) }
}

/// What an operation asks of its operand.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Divisor,
    Logarithm,
    Root,
}

/// An operation that may have no value.
#[derive(Clone, Debug)]
struct Place {
    /// What is divided.
    of: Option<Expression>,
    /// The operand in question.
    inner: Expression,
    kind: Kind,
}

impl Place {
    /// The operation, if it may have no value.
    fn of(operation: Operation<'_>) -> Option<Place> {
        let expression = |steps: &[Step]| Expression { steps: steps.to_vec() };
        let (of, inner, kind) = match operation {
            Operation::Binary(Binary::Divide, [a, b]) => (Some(expression(a)), b, Kind::Divisor),
            Operation::Unary(Unary::Log, a) => (None, a, Kind::Logarithm),
            Operation::Unary(Unary::Sqrt, a) => (None, a, Kind::Root),
            Operation::Power(a, exponent) if libm::trunc(exponent.value()) != exponent.value() => (None, a, Kind::Root),
            Operation::Power(a, exponent) if exponent.value() < 0.0 => (None, a, Kind::Divisor),
            Operation::Unary(..) | Operation::Binary(..) | Operation::Power(..) => return None,
        };
        Some(Place { of, inner: expression(inner), kind })
    }

    /// A point where there is no value, and why.
    fn fails(&self) -> Option<(Vec<f64>, Gap)> {
        let value = |at: &[f64]| {
            let point: Vec<Interval> = at.iter().map(|x| Interval::point(*x)).collect();
            self.inner.fold(&mut Intervals(&point)).or_whole()
        };
        let variables = self.inner.variables().max(self.of.as_ref().map_or(0, Expression::variables));
        let (mut below, mut above) = (None, None);
        for k in 0..POINTS {
            let at = point(k, variables);
            let found = value(&at);
            match self.kind {
                Kind::Logarithm | Kind::Root if found.high < 0.0 => return Some((at, Gap::Negative)),
                Kind::Logarithm if found == Interval::point(0.0) => return Some((at, Gap::ZeroLogarithm)),
                Kind::Logarithm | Kind::Root => {}
                Kind::Divisor if found == Interval::point(0.0) && self.stays(&at, 0.0) => return Some((at, Gap::Pole)),
                Kind::Divisor if found.low > 0.0 && above.is_none() => above = Some(at),
                Kind::Divisor if found.high < 0.0 && below.is_none() => below = Some(at),
                Kind::Divisor => {}
            }
            if let (Some(below), Some(above)) = (&below, &above) {
                return self.crossing(below.clone(), above.clone(), value);
            }
        }
        None
    }

    /// Where the divisor crosses zero between two points, if it is continuous there and what is divided is not zero.
    fn crossing(
        &self,
        below: Vec<f64>,
        above: Vec<f64>,
        value: impl Fn(&[f64]) -> Interval,
    ) -> Option<(Vec<f64>, Gap)> {
        let between: Vec<Interval> =
            below.iter().zip(&above).map(|(a, b)| Interval { low: a.min(*b), high: a.max(*b) }).collect();
        if !self.inner.fold(&mut Parts(&between)).total {
            return None;
        }
        let (mut below, mut above) = (below, above);
        for _ in 0..HALVINGS {
            let middle: Vec<f64> = below.iter().zip(&above).map(|(a, b)| a + 0.5 * (b - a)).collect();
            let found = value(&middle);
            match () {
                () if found.high < 0.0 => below = middle,
                () if found.low > 0.0 => above = middle,
                () => break,
            }
        }
        let at: Vec<f64> = below.iter().zip(&above).map(|(a, b)| a + 0.5 * (b - a)).collect();
        let reach = below.iter().zip(&above).map(|(a, b)| (a - b).abs()).fold(1e-12, f64::max);
        self.stays(&at, reach).then_some((at, Gap::Pole))
    }

    /// Whether what is divided keeps away from zero around a point.
    fn stays(&self, at: &[f64], reach: f64) -> bool {
        let around: Vec<Interval> = at.iter().map(|x| Interval::point(*x).with_room(reach)).collect();
        let holds = |of: &Expression| !of.fold(&mut Intervals(&around)).or_whole().holds(0.0);
        self.of.as_ref().is_none_or(holds)
    }
}

/// A point of a sequence that begins at the origin and along the axes, and then fills the space.
fn point(k: u32, variables: usize) -> Vec<f64> {
    const ALONG: u32 = 64;
    let axes = u32::try_from(variables).unwrap_or(u32::MAX);
    let along = k / 2;
    if axes > 0 && k < ALONG * axes.min(4) {
        let mut at = vec![0.0; variables];
        let size = f64::from(along / axes) * 0.25;
        at[(along % axes) as usize] = if k.is_multiple_of(2) { size } else { -size };
        return at;
    }
    const PRIMES: [u32; 8] = [2, 3, 5, 7, 11, 13, 17, 19];
    (0..variables).map(|index| 10.0 * (2.0 * radical(k, PRIMES[index % PRIMES.len()]) - 1.0)).collect()
}

/// The digits of a number behind the point, in reverse.
fn radical(mut k: u32, base: u32) -> f64 {
    let (mut value, mut scale) = (0.0, 1.0);
    while k > 0 {
        scale /= f64::from(base);
        value += scale * f64::from(k % base);
        k /= base;
    }
    value
}
