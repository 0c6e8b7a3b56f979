//! A formula with its first four derivatives, at one time or enclosed on an interval of time.
//!
//! A step keeps the Taylor coefficients c₀ … c₄ of its value about the time at hand, so that the k-th derivative is k! cₖ.
//! Sums and products follow at once, and a quotient from c b = a. A function f of a = a₀ + δ is composed,
//!
//! ```text
//! f(a) = g₀ + g₁ δ + g₂ δ² + g₃ δ³ + g₄ δ⁴,     gⱼ = f⁽ʲ⁾(a₀)/j!,     δ = a₁ τ + a₂ τ² + …
//! ```
//!
//! where each gⱼ is written such that its enclosure is finite wherever f⁽ʲ⁾ is bounded. The same body works on numbers and
//! on intervals: what is computed for numbers lies within what is computed for intervals that hold them.
//!
//! |a|, min and max have the derivatives of the branch that is active. On an interval where the branch may change the first
//! derivative jumps between those of the branches, and of higher ones nothing is claimed.

use super::{CLOSE, Formula, FormulaStep, Interval, MOST_WAITING, power, search, sine, whole};

/// Coefficients that are kept.
pub(super) const ORDERS: usize = 5;
/// k!.
const FACTORIALS: [f64; ORDERS] = [1.0, 1.0, 2.0, 6.0, 24.0];

/// What Taylor coefficients are made of.
trait Term: Copy {
    const ZERO: Self;
    fn of(value: f64) -> Self;
    fn is_zero(self) -> bool;
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn neg(self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    fn power(self, exponent: f64) -> Self;
    fn sqrt(self) -> Self;
    fn sin_cos(self) -> [Self; 2];
    fn exp_of(self) -> Self;
    fn log_of(self) -> Self;
    fn tanh_of(self) -> Self;
    fn atan_of(self) -> Self;
    /// The jet of |a|, and below which derivative it can be relied upon.
    fn abs(a: [Self; ORDERS]) -> ([Self; ORDERS], usize);
    /// The same for the smaller of a and b.
    fn min(a: [Self; ORDERS], b: [Self; ORDERS]) -> ([Self; ORDERS], usize);

    fn scaled(self, by: f64) -> Self {
        self.mul(Self::of(by))
    }
}

impl Term for f64 {
    const ZERO: f64 = 0.0;

    fn of(value: f64) -> Self {
        value
    }
    fn is_zero(self) -> bool {
        self == 0.0
    }
    fn add(self, other: Self) -> Self {
        self + other
    }
    fn sub(self, other: Self) -> Self {
        self - other
    }
    fn neg(self) -> Self {
        -self
    }
    fn mul(self, other: Self) -> Self {
        self * other
    }
    fn div(self, other: Self) -> Self {
        self / other
    }
    fn power(self, exponent: f64) -> Self {
        power(self, exponent)
    }
    fn sqrt(self) -> Self {
        libm::sqrt(self)
    }
    fn sin_cos(self) -> [Self; 2] {
        sine(self).into()
    }
    fn exp_of(self) -> Self {
        libm::exp(self)
    }
    fn log_of(self) -> Self {
        libm::log(self)
    }
    fn tanh_of(self) -> Self {
        libm::tanh(self)
    }
    fn atan_of(self) -> Self {
        libm::atan(self)
    }
    fn abs(a: [Self; ORDERS]) -> ([Self; ORDERS], usize) {
        let mut out = if a[0] < 0.0 { a.map(|c| -c) } else { a };
        // |−0| is 0.
        out[0] = a[0].abs();
        (out, ORDERS)
    }
    fn min(a: [Self; ORDERS], b: [Self; ORDERS]) -> ([Self; ORDERS], usize) {
        // Not-a-number is let through.
        (if b[0] < a[0] || b[0].is_nan() { b } else { a }, ORDERS)
    }
}

/// Either of two branches: any value between, a slope of one or the other, and no claim beyond.
fn either(a: [Interval; ORDERS], b: [Interval; ORDERS], value: Interval) -> ([Interval; ORDERS], usize) {
    let mut jet = [Interval::WHOLE; ORDERS];
    jet[0] = value;
    jet[1] = Interval::new(a[1].low.min(b[1].low), a[1].high.max(b[1].high));
    (jet, 2)
}

impl Term for Interval {
    const ZERO: Interval = Interval { low: 0.0, high: 0.0 };

    fn of(value: f64) -> Self {
        Interval::new(value, value)
    }
    fn is_zero(self) -> bool {
        self == Self::ZERO
    }
    fn add(self, other: Self) -> Self {
        self.add(other)
    }
    fn sub(self, other: Self) -> Self {
        self.sub(other)
    }
    fn neg(self) -> Self {
        self.neg()
    }
    fn mul(self, other: Self) -> Self {
        self.mul(other)
    }
    fn div(self, other: Self) -> Self {
        self.div(other)
    }
    fn power(self, exponent: f64) -> Self {
        match whole(exponent) {
            Some(n) => self.powi_of(n),
            None => self.powf_of(exponent),
        }
    }
    fn sqrt(self) -> Self {
        self.sqrt_of()
    }
    fn sin_cos(self) -> [Self; 2] {
        [self.sin_of(), self.cos_of()]
    }
    fn exp_of(self) -> Self {
        self.exp_of()
    }
    fn log_of(self) -> Self {
        self.log_of()
    }
    fn tanh_of(self) -> Self {
        self.tanh_of()
    }
    fn atan_of(self) -> Self {
        self.atan_of()
    }
    fn abs(a: [Self; ORDERS]) -> ([Self; ORDERS], usize) {
        let minus = a.map(Interval::neg);
        if a[0].low > 0.0 {
            (a, ORDERS)
        } else if a[0].high < 0.0 {
            (minus, ORDERS)
        } else {
            either(a, minus, a[0].abs())
        }
    }
    fn min(a: [Self; ORDERS], b: [Self; ORDERS]) -> ([Self; ORDERS], usize) {
        if a[0].high < b[0].low {
            (a, ORDERS)
        } else if b[0].high < a[0].low {
            (b, ORDERS)
        } else {
            either(a, b, a[0].min(b[0]))
        }
    }
}

fn multiplied<T: Term>(a: &[T; ORDERS], b: &[T; ORDERS]) -> [T; ORDERS] {
    let mut c = [T::ZERO; ORDERS];
    for (k, c) in c.iter_mut().enumerate() {
        // One product less than a sum from zero, so that c₀ is a₀ b₀ to the bit.
        *c = a[0].mul(b[k]);
        for i in 1..=k {
            *c = c.add(a[i].mul(b[k - i]));
        }
    }
    c
}

fn divided<T: Term>(a: &[T; ORDERS], b: &[T; ORDERS]) -> [T; ORDERS] {
    let mut c = [T::ZERO; ORDERS];
    for k in 0..ORDERS {
        let mut left = a[k];
        for i in 1..=k {
            left = left.sub(b[i].mul(c[k - i]));
        }
        c[k] = left.div(b[0]);
    }
    c
}

/// g(a) by Horner's rule in δ.
fn composed<T: Term>(g: [T; ORDERS], a: &[T; ORDERS]) -> [T; ORDERS] {
    let mut delta = *a;
    delta[0] = T::ZERO;
    let mut c = [T::ZERO; ORDERS];
    // A constant stays one even where f has no slope, as √0.
    if delta.iter().all(|d| d.is_zero()) {
        c[0] = g[0];
        return c;
    }
    c[0] = g[ORDERS - 1];
    for j in (0..ORDERS - 1).rev() {
        c = multiplied(&delta, &c);
        c[0] = g[j];
    }
    c
}

/// gⱼ of a function at `a`.
fn expanded<T: Term>(step: FormulaStep, a: T) -> [T; ORDERS] {
    let one = T::of(1.0);
    match step {
        FormulaStep::Sin | FormulaStep::Cos => {
            let [sin, cos] = a.sin_cos();
            let (f, d) = if step == FormulaStep::Sin { (sin, cos) } else { (cos, sin.scaled(-1.0)) };
            [f, d, f.scaled(-1.0 / 2.0), d.scaled(-1.0 / 6.0), f.scaled(1.0 / 24.0)]
        }
        FormulaStep::Exp => {
            let f = a.exp_of();
            [f, f, f.scaled(1.0 / 2.0), f.scaled(1.0 / 6.0), f.scaled(1.0 / 24.0)]
        }
        FormulaStep::Log => {
            let power = |k: i32| one.div(a.power(f64::from(k)).scaled(f64::from(k)));
            [a.log_of(), power(1), power(2).scaled(-1.0), power(3), power(4).scaled(-1.0)]
        }
        FormulaStep::Tanh => {
            // u' = 1 − u², and so on.
            let u = a.tanh_of();
            let square = u.power(2.0);
            let d = one.sub(square);
            let third = square.scaled(6.0).sub(T::of(2.0));
            let fourth = u.mul(T::of(16.0).sub(square.scaled(24.0)));
            [u, d, u.mul(d).scaled(-1.0), d.mul(third).scaled(1.0 / 6.0), d.mul(fourth).scaled(1.0 / 24.0)]
        }
        FormulaStep::Atan => {
            // With φ = arctan a, 1/(1 + a²) = cos²φ and a/√(1 + a²) = sin φ.
            let angle = a.atan_of();
            let [sin, cos] = angle.sin_cos();
            let (s2, c2) = (sin.power(2.0), cos.power(2.0));
            let second = sin.mul(cos.power(3.0)).scaled(-1.0);
            let third = cos.power(4.0).mul(s2.scaled(3.0).sub(c2)).scaled(1.0 / 3.0);
            let fourth = sin.mul(cos.power(5.0)).mul(c2.sub(s2));
            [angle, c2, second, third, fourth]
        }
        FormulaStep::Sqrt => {
            let mut g = binomial(a, 0.5);
            g[0] = a.sqrt();
            g
        }
        FormulaStep::Power(exponent) => binomial(a, exponent),
        _ => [a, one, T::ZERO, T::ZERO, T::ZERO],
    }
}

/// gⱼ of aᶜ: c (c−1) … / j! · a^(c−j).
fn binomial<T: Term>(a: T, exponent: f64) -> [T; ORDERS] {
    let mut factor = 1.0;
    let mut g = [T::ZERO; ORDERS];
    for (j, g) in g.iter_mut().enumerate() {
        if factor == 0.0 {
            break;
        }
        let left = exponent - j as f64;
        *g = a.power(left).scaled(factor);
        factor *= left / (j + 1) as f64;
    }
    g
}

/// The jet of a step whose operands have the jets `a` and `b`, and below which derivative it can be relied upon.
fn after<T: Term>(step: FormulaStep, a: &[T; ORDERS], b: &[T; ORDERS], time_s: T) -> ([T; ORDERS], usize) {
    use FormulaStep as S;
    let constant = |value: T, slope: T| {
        let mut c = [T::ZERO; ORDERS];
        (c[0], c[1]) = (value, slope);
        c
    };
    let both = |f: fn(T, T) -> T| {
        let mut c = *a;
        c.iter_mut().zip(b).for_each(|(c, b)| *c = f(*c, *b));
        c
    };
    let minus = |jet: &[T; ORDERS]| jet.map(T::neg);
    let jet = match step {
        S::Number(value) => constant(T::of(value), T::ZERO),
        S::Time => constant(time_s, T::of(1.0)),
        S::Variable(_) => constant(T::of(f64::NAN), T::ZERO),
        S::Negate => minus(a),
        S::Add => both(T::add),
        S::Subtract => both(T::sub),
        S::Multiply => multiplied(a, b),
        S::Divide => divided(a, b),
        S::Abs => return T::abs(*a),
        S::Min => return T::min(*a, *b),
        S::Max => {
            let (jet, orders) = T::min(minus(a), minus(b));
            return (minus(&jet), orders);
        }
        _ => composed(expanded(step, a[0]), a),
    };
    (jet, ORDERS)
}

impl Formula {
    /// The value and the first four derivatives at `t_s`; not-a-number or infinite where there are none.
    pub fn jet(&self, t_s: f64) -> [f64; 5] {
        let mut stack = [[0.0; ORDERS]; MOST_WAITING];
        let mut top = 0;
        for step in self.steps() {
            let first = top - step.operands();
            let (a, b) = (stack[first], stack[(first + 1).min(MOST_WAITING - 1)]);
            stack[first] = after(*step, &a, &b, t_s).0;
            top = first + 1;
        }
        let mut jet = stack[0];
        jet.iter_mut().zip(FACTORIALS).for_each(|(c, factorial)| *c *= factorial);
        jet
    }

    /// Intervals that hold the value and the first four derivatives at every time in `time_s`, in one pass; unbounded
    /// where nothing better could be shown, so also where a derivative may not exist.
    pub fn enclose_jet(&self, time_s: Interval) -> [Interval; 5] {
        let mut stack = [[Interval::WHOLE; ORDERS]; MOST_WAITING];
        let mut top = 0;
        let mut orders = ORDERS;
        for step in self.steps() {
            let first = top - step.operands();
            let (a, b) = (stack[first], stack[(first + 1).min(MOST_WAITING - 1)]);
            let (value, shown) = after(*step, &a, &b, time_s);
            orders = orders.min(shown);
            // As in `enclose`: what leaves the finite numbers has no value, whatever is done with it afterwards.
            let operands = &stack[first..first + step.operands()];
            for k in 0..ORDERS {
                let finite = operands.iter().all(|operand| operand[..=k].iter().all(|c| c.is_finite()));
                let lost = finite && !value[k].is_finite() || step.is_partial() && value[k] == Interval::WHOLE;
                if lost && *step != FormulaStep::Time {
                    orders = orders.min(k);
                }
            }
            stack[first] = value;
            top = first + 1;
        }
        let mut jet = stack[0];
        for (k, c) in jet.iter_mut().enumerate() {
            *c = if k < orders { c.mul(Interval::of(FACTORIALS[k])) } else { Interval::WHOLE };
        }
        jet
    }

    /// An interval that holds Σₖ `weights[k]` · (k-th derivative) at every time from `from_s` to `to_s`, which may be
    /// infinite; as [`Formula::bounds`] is for the value.
    pub fn bounds_of_derivatives(&self, weights: &[f64; 5], from_s: f64, to_s: f64) -> Interval {
        let enclose = |from: f64, to: f64| weighted_interval(weights, &self.enclose_jet(Interval::new(from, to)));
        if !(to_s - from_s).is_finite() {
            return enclose(from_s, to_s);
        }
        search(from_s, to_s, CLOSE, enclose, |t_s| weighted(weights, &self.jet(t_s)))
    }
}

/// Σₖ wₖ · (k-th derivative).
pub(crate) fn weighted(weights: &[f64; 5], jet: &[f64; 5]) -> f64 {
    let used = weights.iter().zip(jet).filter(|(weight, _)| **weight != 0.0);
    used.fold(0.0, |sum, (weight, c)| sum + weight * c)
}

fn weighted_interval(weights: &[f64; 5], jet: &[Interval; 5]) -> Interval {
    let used = weights.iter().zip(jet).filter(|(weight, _)| **weight != 0.0);
    used.fold(Interval::of(0.0), |sum, (weight, c)| sum.add(Interval::of(*weight).mul(*c)))
}
