//! Formulas in t: delays, weights and pushes that change continuously.
//!
//! A formula is a short programme for a stack of numbers, in the order in which a pocket calculator would be given it. It is
//! evaluated without allocating and with the same bits on every machine, and enclosed on intervals of time, which is how
//! a delay is shown never to be negative and a weight to stay positive.

mod interval;
mod jet;
mod uniform;
mod variables;

use forwardstep_core::Scalar;
use thiserror::Error;

pub use interval::Interval;
pub(crate) use jet::weighted;
use uniform::Part;
pub use variables::expression;

/// Steps that a formula may have.
pub const MOST_STEPS: usize = 256;
/// Numbers that may wait on the stack at once.
pub const MOST_WAITING: usize = 32;
/// Whole exponents up to this are products.
const MOST_POWER: f64 = 64.0;
/// Evaluations that one search for bounds may cost.
const SEARCH: usize = 2000;
/// Bounds this close to values that are taken are close enough, as a part of the range.
const CLOSE: f64 = 1e-4;

/// One step of a formula. Each takes its operands from the stack and leaves its value there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FormulaStep {
    /// A constant.
    Number(f64),
    /// t, s.
    Time,
    /// A variable, numbered from zero; only in what becomes an [`expression`].
    Variable(usize),
    /// −a.
    Negate,
    /// a + b.
    Add,
    /// a − b.
    Subtract,
    /// a b.
    Multiply,
    /// a / b.
    Divide,
    /// aᶜ for a constant c; a must not be negative unless c is a whole number.
    Power(f64),
    /// sin a.
    Sin,
    /// cos a.
    Cos,
    /// eᵃ.
    Exp,
    /// The natural logarithm of a.
    Log,
    /// √a.
    Sqrt,
    /// |a|.
    Abs,
    /// The smaller of a and b.
    Min,
    /// The larger of a and b.
    Max,
    /// tanh a.
    Tanh,
    /// arctan a.
    Atan,
}

impl FormulaStep {
    /// How many numbers it takes from the stack.
    pub fn operands(self) -> usize {
        use FormulaStep::{Add, Divide, Max, Min, Multiply, Number, Subtract, Time, Variable};
        match self {
            Number(_) | Time | Variable(_) => 0,
            Add | Subtract | Multiply | Divide | Min | Max => 2,
            _ => 1,
        }
    }

    /// Whether it has no value for some operands.
    fn is_partial(self) -> bool {
        matches!(self, FormulaStep::Divide | FormulaStep::Log | FormulaStep::Sqrt | FormulaStep::Power(_))
    }

    /// What its value keeps within when its operands keep within `a` and `b`.
    fn enclose(self, a: Interval, b: Interval, time_s: Interval) -> Interval {
        use FormulaStep as S;
        match self {
            S::Number(value) => Interval::new(value, value),
            S::Time => time_s,
            S::Variable(_) => Interval::WHOLE,
            S::Negate => a.neg(),
            S::Add => a.add(b),
            S::Subtract => a.sub(b),
            S::Multiply => a.mul(b),
            S::Divide => a.div(b),
            S::Power(exponent) => match whole(exponent) {
                Some(n) => a.powi_of(n),
                None => a.powf_of(exponent),
            },
            S::Sin => a.sin_of(),
            S::Cos => a.cos_of(),
            S::Exp => a.exp_of(),
            S::Log => a.log_of(),
            S::Sqrt => a.sqrt_of(),
            S::Abs => a.abs(),
            S::Min => a.min(b),
            S::Max => a.max(b),
            S::Tanh => a.tanh_of(),
            S::Atan => a.atan_of(),
        }
    }
}

/// A formula in t. All of its functions are continuous where they are defined.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    steps: Vec<FormulaStep>,
}

/// Why steps make no formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum FormulaError {
    /// An operand is missing, or values are left over.
    #[error("the steps do not make one value")]
    Unbalanced,
    /// Too many steps.
    #[error("the formula has {steps} steps, but at most {MOST_STEPS} are accepted")]
    TooLong {
        /// How many there are.
        steps: usize,
    },
    /// Too many numbers wait for their operator.
    #[error("the formula is nested too deeply: {waiting} numbers wait at once, but at most {MOST_WAITING} may")]
    TooDeep {
        /// How many wait.
        waiting: usize,
    },
    /// A constant that is no number.
    #[error("a constant of the formula is not finite")]
    NotFinite,
    /// A variable in a formula in t.
    #[error("a formula in t has no other variables")]
    Variable,
    /// t in a formula in other variables.
    #[error("a formula in the states of a plant must not depend on t")]
    Time,
}

impl Formula {
    /// A formula from its steps, operands before operators.
    ///
    /// ```
    /// use forwardstep_sim::formula::{Formula, FormulaStep::*};
    /// // 0.2 + 0.1 sin t
    /// let formula = Formula::new(vec![Number(0.2), Number(0.1), Time, Sin, Multiply, Add])?;
    /// assert_eq!(formula.eval(0.0), 0.2);
    /// let bounds = formula.bounds(0.0, f64::INFINITY);
    /// assert!(bounds.low >= 0.1 - 1e-12 && bounds.high <= 0.3 + 1e-12);
    /// # Ok::<(), forwardstep_sim::formula::FormulaError>(())
    /// ```
    ///
    /// # Errors
    /// [`FormulaError`] when the steps do not make one value, or are too many.
    pub fn new(steps: Vec<FormulaStep>) -> Result<Self, FormulaError> {
        if steps.len() > MOST_STEPS {
            return Err(FormulaError::TooLong { steps: steps.len() });
        }
        let mut waiting = 0_usize;
        for step in &steps {
            match step {
                FormulaStep::Number(value) | FormulaStep::Power(value) if !value.is_finite() => {
                    return Err(FormulaError::NotFinite);
                }
                FormulaStep::Variable(_) => return Err(FormulaError::Variable),
                _ => {}
            }
            waiting = waiting.checked_sub(step.operands()).ok_or(FormulaError::Unbalanced)? + 1;
            if waiting > MOST_WAITING {
                return Err(FormulaError::TooDeep { waiting });
            }
        }
        if waiting == 1 { Ok(Formula { steps }) } else { Err(FormulaError::Unbalanced) }
    }

    /// Its steps.
    pub fn steps(&self) -> &[FormulaStep] {
        &self.steps
    }

    /// Whether t does not appear in it.
    pub fn is_constant(&self) -> bool {
        !self.steps.contains(&FormulaStep::Time)
    }

    /// Its value at `t_s`; not-a-number or infinite where it has none.
    pub fn eval(&self, t_s: f64) -> f64 {
        use FormulaStep as S;
        let mut stack = [0.0; MOST_WAITING];
        let mut top = 0;
        for step in &self.steps {
            // The constructor has counted: `top` never passes either end.
            let first = top - step.operands();
            let (a, b) = (stack[first], stack[(first + 1).min(MOST_WAITING - 1)]);
            stack[first] = match *step {
                S::Number(value) => value,
                S::Time => t_s,
                // The constructor lets none in.
                S::Variable(_) => f64::NAN,
                S::Negate => -a,
                S::Add => a + b,
                S::Subtract => a - b,
                S::Multiply => a * b,
                S::Divide => a / b,
                S::Power(exponent) => power(a, exponent),
                S::Sin => sine(a).0,
                S::Cos => sine(a).1,
                S::Exp => libm::exp(a),
                S::Log => libm::log(a),
                S::Sqrt => libm::sqrt(a),
                S::Abs => a.abs(),
                // Unlike f64::min, these let not-a-number through.
                S::Min => {
                    if b < a || b.is_nan() {
                        b
                    } else {
                        a
                    }
                }
                S::Max => {
                    if b > a || b.is_nan() {
                        b
                    } else {
                        a
                    }
                }
                S::Tanh => libm::tanh(a),
                S::Atan => libm::atan(a),
            };
            top = first + 1;
        }
        stack[0]
    }

    /// An interval that holds every value from `from_s` to `to_s`, which may be infinite; unbounded where nothing better
    /// could be shown, so also where the formula has no value.
    ///
    /// For an infinite stretch that is what exact arithmetic would give; a number on the way may overflow all the same.
    ///
    /// The interval is narrowed by cutting the stretch of time until the bounds are close to values that are taken.
    pub fn bounds(&self, from_s: f64, to_s: f64) -> Interval {
        let whole = self.enclose(Interval::new(from_s, to_s));
        if !(to_s - from_s).is_finite() {
            return whole;
        }
        search(from_s, to_s, CLOSE, |from, to| self.enclose(Interval::new(from, to)), |t_s| self.eval(t_s))
    }

    /// Whether it is shown to have a finite value everywhere from `from_s` to `to_s`; cheaper than [`bounds`](Self::bounds),
    /// since mostly one look tells.
    pub fn is_bounded(&self, from_s: f64, to_s: f64) -> bool {
        self.enclose(Interval::new(from_s, to_s)).is_finite() || self.bounds(from_s, to_s).is_finite()
    }

    /// An interval that holds the value at every time in `time_s`, in one pass.
    pub fn enclose(&self, time_s: Interval) -> Interval {
        let mut stack = [Interval::WHOLE; MOST_WAITING];
        let mut top = 0;
        let mut defined = true;
        for step in &self.steps {
            let first = top - step.operands();
            let (a, b) = (stack[first], stack[(first + 1).min(MOST_WAITING - 1)]);
            let value = step.enclose(a, b, time_s);
            // What leaves the finite numbers may come back as not-a-number, and what has no value stays without one,
            // whatever is done with it: tanh √x is bounded, but not where x is negative.
            let operands = &stack[first..first + step.operands()];
            let finite = operands.iter().all(|operand| operand.is_finite());
            let partial = step.is_partial();
            if *step != FormulaStep::Time && (finite && !value.is_finite() || partial && value == Interval::WHOLE) {
                defined = false;
            }
            stack[first] = value;
            top = first + 1;
        }
        if defined { stack[0] } else { Interval::WHOLE }
    }

    /// Whether it is shown to be bounded and uniformly continuous on [0, ∞), as exact arithmetic would evaluate it.
    pub fn is_uniformly_continuous(&self) -> bool {
        let for_ever = Interval::new(0.0, f64::INFINITY);
        // Bounded also says that it has a value everywhere.
        if !self.enclose(for_ever).is_finite() {
            return false;
        }
        let mut stack = [(Interval::WHOLE, Part::UNKNOWN); MOST_WAITING];
        let mut top = 0;
        for step in &self.steps {
            let first = top - step.operands();
            let ((a, part), (b, other)) = (stack[first], stack[(first + 1).min(MOST_WAITING - 1)]);
            let within = step.enclose(a, b, for_ever);
            stack[first] = (within, Part::after(*step, part, other, within));
            top = first + 1;
        }
        stack[0].1.is_uniform()
    }
}

/// A formula with what it keeps within.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundedFormula {
    formula: Formula,
    until_s: f64,
    within: Interval,
    for_ever: Interval,
}

impl BoundedFormula {
    /// Encloses `formula` on [0, `until_s`], and for ever.
    pub fn new(formula: Formula, until_s: f64) -> Self {
        let within = formula.bounds(0.0, until_s);
        let for_ever = if formula.is_constant() { within } else { formula.bounds(0.0, f64::INFINITY) };
        BoundedFormula { formula, until_s, within, for_ever }
    }

    /// The formula.
    pub fn formula(&self) -> &Formula {
        &self.formula
    }

    /// Its bounds hold until here, s.
    pub fn until_s(&self) -> f64 {
        self.until_s
    }

    /// What it keeps within until [`until_s`](Self::until_s).
    pub fn within(&self) -> Interval {
        self.within
    }

    /// What it keeps within for ever, as far as that could be shown; see [`Formula::bounds`].
    pub fn for_ever(&self) -> Interval {
        self.for_ever
    }

    /// Its value at `t_s`. Beyond [`until_s`](Self::until_s) it is kept within the bounds.
    #[inline]
    pub fn value(&self, t_s: f64) -> f64 {
        // Not f64::clamp, which lets not-a-number through.
        self.formula.eval(t_s).max(self.within.low).min(self.within.high)
    }
}

/// An interval that holds every value from `from_s` to `to_s` of what `value` gives and `enclose` bounds on a stretch, close
/// to values that are taken by the part `close` of their range.
pub(crate) fn search(
    from_s: f64,
    to_s: f64,
    close: f64,
    enclose: impl Fn(f64, f64) -> Interval,
    value: impl Fn(f64) -> f64,
) -> Interval {
    let least = highest(from_s, to_s, close, |from, to| -enclose(from, to).low, |t_s| -value(t_s));
    let most = highest(from_s, to_s, close, |from, to| enclose(from, to).high, value);
    Interval::new(-least, most)
}

/// An upper bound: the stretch whose bound is highest is cut until that bound is close to a value that is taken, or the work
/// is done.
fn highest(from_s: f64, to_s: f64, close: f64, bound: impl Fn(f64, f64) -> f64, value: impl Fn(f64) -> f64) -> f64 {
    let mut taken = value(from_s).max(value(to_s));
    let mut least = taken;
    let mut stretches = std::collections::BinaryHeap::new();
    stretches.push(Stretch { bound: bound(from_s, to_s), from_s, to_s });
    for _ in 0..SEARCH {
        let Some(Stretch { bound: highest, from_s, to_s }) = stretches.peek().copied() else { break };
        let middle = from_s + 0.5 * (to_s - from_s);
        let gap = highest - taken;
        // What has no value somewhere has no gap either.
        if gap.is_nan() || gap <= close * (taken - least) || middle <= from_s || middle >= to_s {
            break;
        }
        stretches.pop();
        let value = value(middle);
        taken = taken.max(value);
        least = least.min(value);
        for (from_s, to_s) in [(from_s, middle), (middle, to_s)] {
            stretches.push(Stretch { bound: bound(from_s, to_s), from_s, to_s });
        }
    }
    stretches.peek().map_or(f64::INFINITY, |stretch| stretch.bound)
}

/// A stretch of time and what the formula does not exceed on it; ordered by that bound.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    bound: f64,
    from_s: f64,
    to_s: f64,
}

impl PartialEq for Stretch {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}
impl Eq for Stretch {}
impl PartialOrd for Stretch {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Stretch {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        // Of equal bounds the longest stretch first, so that a bound that is unbounded everywhere is cut evenly.
        let length = |stretch: &Self| stretch.to_s - stretch.from_s;
        self.bound.total_cmp(&other.bound).then(length(self).total_cmp(&length(other)))
    }
}

/// sin and cos, never larger than one.
fn sine(x: f64) -> (f64, f64) {
    let (sin, cos) = Scalar::sin_cos(x);
    (sin.clamp(-1.0, 1.0), cos.clamp(-1.0, 1.0))
}

/// The exponent, if it is a whole number small enough for products.
fn whole(exponent: f64) -> Option<i32> {
    (exponent.abs() <= MOST_POWER && exponent.fract() == 0.0).then_some(exponent as i32)
}

fn power(base: f64, exponent: f64) -> f64 {
    match whole(exponent) {
        Some(n) if n < 0 => 1.0 / powi(base, -n),
        Some(n) => powi(base, n),
        None => libm::pow(base, exponent),
    }
}

/// baseⁿ for n ≥ 0 by repeated squaring.
fn powi(base: f64, n: i32) -> f64 {
    let (mut result, mut square, mut left) = (1.0, base, n);
    while left > 0 {
        if left & 1 == 1 {
            result *= square;
        }
        left >>= 1;
        if left > 0 {
            square *= square;
        }
    }
    result
}

#[cfg(test)]
mod tests;
