//! The period of an expression in one variable, where it has one that can be read off: all its sines and cosines are of linear
//! functions whose rates have a common measure.

use num_rational::Ratio;
use num_traits::{CheckedAdd, CheckedDiv, CheckedMul, ToPrimitive, Zero};

use super::{Algebra, Binary, Expression, Number, Unary};

/// A rational number, or one times π.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Rate {
    ratio: Ratio<i64>,
    pi: bool,
}

impl Rate {
    fn of(number: &Number) -> Option<Rate> {
        if *number == Number::PI {
            return Some(Rate { ratio: 1.into(), pi: true });
        }
        let exact = number.exact()?;
        let ratio = Ratio::new(exact.numer().to_i64()?, exact.denom().to_i64()?);
        Rate { ratio, pi: false }.usable()
    }

    /// Itself, unless it is so large that its size might overflow.
    fn usable(self) -> Option<Rate> {
        (*self.ratio.numer() > i64::MIN).then_some(self)
    }

    fn plus(self, other: Rate) -> Option<Rate> {
        let ratio = self.ratio.checked_add(&other.ratio)?;
        (self.pi == other.pi).then_some(Rate { ratio, ..self })?.usable()
    }

    fn times(self, other: Rate) -> Option<Rate> {
        let ratio = self.ratio.checked_mul(&other.ratio)?;
        (!(self.pi && other.pi)).then_some(Rate { ratio, pi: self.pi || other.pi })?.usable()
    }

    fn over(self, other: Rate) -> Option<Rate> {
        let ratio = self.ratio.checked_div(&other.ratio)?;
        (self.pi || !other.pi).then_some(Rate { ratio, pi: self.pi && !other.pi })?.usable()
    }

    fn neg(self) -> Rate {
        Rate { ratio: -self.ratio, ..self }
    }

    /// The largest of which both are multiples.
    fn common(self, other: Rate) -> Option<Rate> {
        let (a, b) = (self.ratio, other.ratio);
        let below = a.denom().checked_mul(b.denom())?;
        let (mut x, mut y) = (a.numer().checked_mul(b.denom())?, b.numer().checked_mul(a.denom())?);
        while y != 0 {
            (x, y) = (y, x.checked_rem(y)?);
        }
        (self.pi == other.pi).then(|| Rate { ratio: Ratio::new(x.saturating_abs(), below), ..self })
    }
}

/// What an expression is as a function of t.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Course {
    /// A constant, and which.
    Constant(Option<Rate>),
    /// This times t, and a constant.
    Linear(Rate),
    /// A function of waves whose angular rates are multiples of this.
    Waves(Rate),
    /// Anything else.
    Other,
}

impl Course {
    fn line(rate: Option<Rate>) -> Course {
        match rate {
            Some(rate) if rate.ratio.is_zero() => Course::Constant(None),
            Some(rate) => Course::Linear(rate),
            None => Course::Other,
        }
    }

    fn neg(self) -> Course {
        match self {
            Course::Constant(rate) => Course::Constant(rate.map(Rate::neg)),
            Course::Linear(rate) => Course::Linear(rate.neg()),
            same @ (Course::Waves(_) | Course::Other) => same,
        }
    }
}

/// The algebra of courses.
struct Courses;

impl Algebra for Courses {
    type Value = Course;

    fn number(&mut self, number: &Number) -> Course {
        Course::Constant(Rate::of(number))
    }

    fn variable(&mut self, _: usize) -> Course {
        Course::Linear(Rate { ratio: 1.into(), pi: false })
    }

    fn unary(&mut self, function: Unary, a: Course) -> Course {
        match (function, a) {
            (Unary::Negate, a) => a.neg(),
            (_, Course::Constant(_)) => Course::Constant(None),
            (Unary::Sin | Unary::Cos, Course::Linear(rate)) => Course::Waves(rate),
            (_, Course::Waves(rate)) => Course::Waves(rate),
            (_, Course::Linear(_) | Course::Other) => Course::Other,
        }
    }

    fn binary(&mut self, function: Binary, a: Course, b: Course) -> Course {
        use Course::{Constant, Linear, Other, Waves};
        let rates = |both: fn(Rate, Rate) -> Option<Rate>, a: Option<Rate>, b: Option<Rate>| both(a?, b?);
        match (function, a, b) {
            (Binary::Add, Constant(a), Constant(b)) => Constant(rates(Rate::plus, a, b)),
            (Binary::Subtract, Constant(a), Constant(b)) => Constant(rates(Rate::plus, a, b.map(Rate::neg))),
            (Binary::Multiply, Constant(a), Constant(b)) => Constant(rates(Rate::times, a, b)),
            (Binary::Divide, Constant(a), Constant(b)) => Constant(rates(Rate::over, a, b)),
            (Binary::Min | Binary::Max, Constant(_), Constant(_)) => Constant(None),
            (Binary::Add, Linear(a), Linear(b)) => Course::line(a.plus(b)),
            (Binary::Subtract, Linear(a), Linear(b)) => Course::line(a.plus(b.neg())),
            (Binary::Add | Binary::Subtract, Linear(a), Constant(_)) => Linear(a),
            (Binary::Add, Constant(_), Linear(b)) => Linear(b),
            (Binary::Subtract, Constant(_), Linear(b)) => Linear(b.neg()),
            (Binary::Multiply, Linear(a), Constant(b)) | (Binary::Multiply, Constant(b), Linear(a)) => {
                Course::line(rates(Rate::times, Some(a), b))
            }
            (Binary::Divide, Linear(a), Constant(b)) => Course::line(rates(Rate::over, Some(a), b)),
            (_, Waves(a), Waves(b)) => a.common(b).map_or(Other, Waves),
            (_, Waves(a), Constant(_)) | (_, Constant(_), Waves(a)) => Waves(a),
            _ => Other,
        }
    }

    fn power(&mut self, a: Course, _: &Number) -> Course {
        match a {
            Course::Constant(_) => Course::Constant(None),
            Course::Waves(rate) => Course::Waves(rate),
            Course::Linear(_) | Course::Other => Course::Other,
        }
    }
}

impl Expression {
    /// A stretch of its one variable that holds a period of it, longer by rounding alone; `None` unless all its variables stand in
    /// sines and cosines of angular rates with a common measure.
    pub fn period(&self) -> Option<f64> {
        let Course::Waves(rate) = self.fold(&mut Courses) else { return None };
        let turn = if rate.pi { 2.0 } else { core::f64::consts::TAU };
        // Longer than the period by more than what is rounded here.
        let period = turn / rate.ratio.to_f64()?.abs() * (1.0 + 1e-12);
        period.is_finite().then_some(period)
    }
}
