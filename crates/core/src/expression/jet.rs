//! An expression in one variable with its first derivatives, over any algebra that can tell branches apart: at a point in `f64`,
//! or enclosed on an interval.
//!
//! A value is a list of `N` Taylor coefficients c₀ … about the point at hand, five at least, so that the k-th derivative is
//! k! cₖ. Sums and products follow at once, and a quotient from c b = a. A function f of a = a₀ + δ is composed,
//!
//! ```text
//! f(a) = g₀ + g₁ δ + g₂ δ² + …,     gⱼ = f⁽ʲ⁾(a₀)/j!,     δ = a₁ τ + a₂ τ² + …
//! ```
//!
//! where each gⱼ is written such that its enclosure is finite wherever f⁽ʲ⁾ is bounded. Up to g₄ they are written out, which
//! encloses them more tightly; from there on
//!
//! ```text
//! sin, cos   gⱼ = −gⱼ₋₂ / (j (j−1))            exp   gⱼ = gⱼ₋₁ / j
//! tanh       gⱼ = −(g₀ gⱼ₋₁ + … + gⱼ₋₁ g₀) / j          from u' = 1 − u²
//! arctan     gⱼ = cosʲφ sin(j (φ + π/2)) / j            φ = arctan a₀
//! ```
//!
//! |a|, min and max have the derivatives of the branch that is active. On an interval where the branch may change the first
//! derivative jumps between those of the branches, and of higher ones nothing is claimed.

use super::{Algebra, Binary, Number, Unary};

/// The derivatives that an expression gives at most: up to there k! and 1/k! are numbers with all their digits.
pub const MOST_DERIVATIVES: usize = 128;

/// k! times a value.
pub(super) fn times_factorial<A: Algebra>(algebra: &mut A, value: A::Value, k: usize) -> A::Value {
    // The last that is an `f64`.
    const EXACT: usize = 22;
    let product: f64 = (2..=k.min(EXACT)).map(|j| j as f64).product();
    let product = algebra.number(&product.into());
    (EXACT + 1..=k).fold(algebra.binary(Binary::Multiply, value, product), |value, j| {
        let j = algebra.number(&(j as f64).into());
        algebra.binary(Binary::Multiply, value, j)
    })
}

/// Which operand |a| = max(a, −a), min and max give.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// The first.
    First,
    /// The second.
    Second,
    /// One here and the other there.
    Either,
}

/// An algebra over which jets can be formed.
pub trait Branching: Algebra<Value: Copy> {
    /// Which branch is active: the first where `larger` is not below `smaller`.
    fn branch(&mut self, larger: Self::Value, smaller: Self::Value) -> Branch;
    /// A value that stands for both.
    fn either(&mut self, a: Self::Value, b: Self::Value) -> Self::Value;
    /// A value of which nothing is known.
    fn unknown(&self) -> Self::Value;
    /// Whether it is exactly zero.
    fn is_zero(&self, a: Self::Value) -> bool;
}

/// The algebra of jets of `N` coefficients over another one, where `N` is five at least.
#[derive(Debug)]
pub struct Taylor<A, const N: usize>(pub A);

type Jet<A, const N: usize> = [<A as Algebra>::Value; N];

impl<A: Branching, const N: usize> Taylor<A, N> {
    const ENOUGH: () = assert!(N >= 5, "g₀ … g₄ are written out");

    fn of(&mut self, value: f64) -> A::Value {
        self.0.number(&value.into())
    }

    fn times(&mut self, a: A::Value, b: A::Value) -> A::Value {
        self.0.binary(Binary::Multiply, a, b)
    }

    fn minus(&mut self, a: A::Value, b: A::Value) -> A::Value {
        self.0.binary(Binary::Subtract, a, b)
    }

    fn scaled(&mut self, a: A::Value, by: f64) -> A::Value {
        let by = self.of(by);
        self.times(a, by)
    }

    /// `above`/`below` times a value.
    fn part(&mut self, a: A::Value, above: f64, below: f64) -> A::Value {
        // Only halves are exact.
        let ratio = above / below;
        let ratio = if below <= 2.0 { ratio.into() } else { Number::near(ratio) };
        let ratio = self.0.number(&ratio);
        self.times(a, ratio)
    }

    fn raised(&mut self, a: A::Value, n: f64) -> A::Value {
        self.0.power(a, &n.into())
    }

    fn each(&mut self, function: Unary, mut a: Jet<A, N>) -> Jet<A, N> {
        a.iter_mut().for_each(|c| *c = self.0.unary(function, *c));
        a
    }

    fn multiplied(&mut self, a: &Jet<A, N>, b: &Jet<A, N>) -> Jet<A, N> {
        let mut c = [self.of(0.0); N];
        for (k, c) in c.iter_mut().enumerate() {
            // One product less than a sum from zero, so that c₀ is a₀ b₀ to the bit.
            *c = self.times(a[0], b[k]);
            for i in 1..=k {
                let term = self.times(a[i], b[k - i]);
                *c = self.0.binary(Binary::Add, *c, term);
            }
        }
        c
    }

    fn divided(&mut self, a: &Jet<A, N>, b: &Jet<A, N>) -> Jet<A, N> {
        let mut c = [self.of(0.0); N];
        for k in 0..N {
            let mut left = a[k];
            for i in 1..=k {
                let term = self.times(b[i], c[k - i]);
                left = self.minus(left, term);
            }
            c[k] = self.0.binary(Binary::Divide, left, b[0]);
        }
        c
    }

    /// g(a) by Horner's rule in δ.
    fn composed(&mut self, g: Jet<A, N>, mut delta: Jet<A, N>) -> Jet<A, N> {
        let zero = self.of(0.0);
        delta[0] = zero;
        let mut c = [zero; N];
        // A constant stays one even where f has no slope, as √0.
        if delta.iter().all(|d| self.0.is_zero(*d)) {
            c[0] = g[0];
            return c;
        }
        c[0] = g[N - 1];
        for j in (0..N - 1).rev() {
            c = self.shifted(&delta, &c);
            c[0] = g[j];
        }
        c
    }

    /// δ c for a δ without a constant term, which no product is taken with: gⱼ enters no order below j, so that a derivative
    /// that does not exist leaves those below it alone. The constant term is left to be set.
    fn shifted(&mut self, delta: &Jet<A, N>, c: &Jet<A, N>) -> Jet<A, N> {
        let mut product = [delta[0]; N];
        for k in 1..N {
            product[k] = self.times(delta[1], c[k - 1]);
            for i in 2..=k {
                let term = self.times(delta[i], c[k - i]);
                product[k] = self.0.binary(Binary::Add, product[k], term);
            }
        }
        product
    }

    /// gⱼ of aᶜ: c (c−1) … / j! · a^(c−j).
    fn binomial(&mut self, a: A::Value, exponent: &Number) -> Jet<A, N> {
        let mut g = [self.of(0.0); N];
        let mut factor = self.of(1.0);
        for (j, g) in g.iter_mut().enumerate() {
            let left = exponent.minus(j as f64);
            let power = self.0.power(a, &left);
            *g = self.times(power, factor);
            if left.value() == 0.0 {
                break;
            }
            let (left, next) = (self.0.number(&left), self.of((j + 1) as f64));
            let ratio = self.0.binary(Binary::Divide, left, next);
            factor = self.times(factor, ratio);
        }
        g
    }

    /// gⱼ of sine or cosine with the derivative `d`.
    fn wave(&mut self, f: A::Value, d: A::Value) -> Jet<A, N> {
        let mut g = [f; N];
        (g[1], g[2], g[3], g[4]) = (d, self.scaled(f, -0.5), self.part(d, -1.0, 6.0), self.part(f, 1.0, 24.0));
        for j in 5..N {
            g[j] = self.part(g[j - 2], -1.0, (j * (j - 1)) as f64);
        }
        g
    }

    /// gⱼ of the exponential function.
    fn exponential(&mut self, a: A::Value) -> Jet<A, N> {
        let f = self.0.unary(Unary::Exp, a);
        let mut g = [f; N];
        (g[2], g[3], g[4]) = (self.scaled(f, 0.5), self.part(f, 1.0, 6.0), self.part(f, 1.0, 24.0));
        for j in 5..N {
            g[j] = self.part(g[j - 1], 1.0, j as f64);
        }
        g
    }

    /// gⱼ of the logarithm.
    fn logarithm(&mut self, a: A::Value) -> Jet<A, N> {
        let mut g = [self.0.unary(Unary::Log, a); N];
        for (k, g) in g.iter_mut().enumerate().skip(1) {
            let (one, power) = (self.of(1.0), self.raised(a, k as f64));
            let below = self.scaled(power, k as f64);
            let term = self.0.binary(Binary::Divide, one, below);
            *g = if k % 2 == 0 { self.0.unary(Unary::Negate, term) } else { term };
        }
        g
    }

    /// gⱼ of the hyperbolic tangent: u' = 1 − u², and so on.
    fn tangent(&mut self, a: A::Value) -> Jet<A, N> {
        let u = self.0.unary(Unary::Tanh, a);
        let (one, two, sixteen, square) = (self.of(1.0), self.of(2.0), self.of(16.0), self.raised(u, 2.0));
        let d = self.minus(one, square);
        let second = self.times(u, d);
        let third = self.scaled(square, 6.0);
        let third = self.minus(third, two);
        let third = self.times(d, third);
        let fourth = self.scaled(square, 24.0);
        let fourth = self.minus(sixteen, fourth);
        let fourth = self.times(u, fourth);
        let fourth = self.times(d, fourth);
        let mut g = [u; N];
        (g[1], g[2], g[3]) = (d, self.scaled(second, -1.0), self.part(third, 1.0, 6.0));
        g[4] = self.part(fourth, 1.0, 24.0);
        for j in 5..N {
            let first = self.times(g[0], g[j - 1]);
            let sum = (1..j).fold(first, |sum, i| {
                let term = self.times(g[i], g[j - 1 - i]);
                self.0.binary(Binary::Add, sum, term)
            });
            g[j] = self.part(sum, -1.0, j as f64);
        }
        g
    }

    /// gⱼ of arctan: with φ = arctan a, 1/(1 + a²) = cos²φ and a/√(1 + a²) = sin φ.
    fn arc_tangent(&mut self, a: A::Value) -> Jet<A, N> {
        let angle = self.0.unary(Unary::Atan, a);
        let (sin, cos) = (self.0.unary(Unary::Sin, angle), self.0.unary(Unary::Cos, angle));
        let [c2, c3, c4, c5] = [2.0, 3.0, 4.0, 5.0].map(|n| self.raised(cos, n));
        let s2 = self.raised(sin, 2.0);
        let second = self.times(sin, c3);
        let third = self.scaled(s2, 3.0);
        let third = self.minus(third, c2);
        let third = self.times(c4, third);
        let (fourth, rest) = (self.times(sin, c5), self.minus(c2, s2));
        let mut g = [angle; N];
        (g[1], g[2], g[3]) = (c2, self.scaled(second, -1.0), self.part(third, 1.0, 3.0));
        g[4] = self.times(fourth, rest);
        for (j, g) in g.iter_mut().enumerate().skip(5) {
            let turned = self.scaled(angle, j as f64);
            let wave = self.0.unary(if j % 2 == 0 { Unary::Sin } else { Unary::Cos }, turned);
            let power = self.raised(cos, j as f64);
            let product = self.times(power, wave);
            *g = self.part(product, if j % 4 < 2 { 1.0 } else { -1.0 }, j as f64);
        }
        g
    }

    /// The value of |a|, min or max, with the derivatives of the branch that is active.
    fn chosen(&mut self, value: A::Value, branch: Branch, a: Jet<A, N>, b: Jet<A, N>) -> Jet<A, N> {
        let mut jet = match branch {
            Branch::First => a,
            Branch::Second => b,
            Branch::Either => {
                let mut jet = [self.0.unknown(); N];
                jet[1] = self.0.either(a[1], b[1]);
                jet
            }
        };
        jet[0] = value;
        jet
    }
}

impl<A: Branching, const N: usize> Algebra for Taylor<A, N> {
    type Value = Jet<A, N>;

    fn number(&mut self, number: &Number) -> Jet<A, N> {
        let () = Self::ENOUGH;
        let mut jet = [self.of(0.0); N];
        jet[0] = self.0.number(number);
        jet
    }

    fn variable(&mut self, index: usize) -> Jet<A, N> {
        let mut jet = [self.of(0.0); N];
        (jet[0], jet[1]) = (self.0.variable(index), self.of(1.0));
        jet
    }

    fn unary(&mut self, function: Unary, a: Jet<A, N>) -> Jet<A, N> {
        let value = a[0];
        let g = match function {
            Unary::Negate => return self.each(Unary::Negate, a),
            Unary::Abs => {
                let (zero, value, minus) = (self.of(0.0), self.0.unary(Unary::Abs, value), self.each(Unary::Negate, a));
                let branch = self.0.branch(a[0], zero);
                return self.chosen(value, branch, a, minus);
            }
            Unary::Sin | Unary::Cos => {
                let (sin, cos) = (self.0.unary(Unary::Sin, value), self.0.unary(Unary::Cos, value));
                let minus = self.scaled(sin, -1.0);
                if function == Unary::Sin { self.wave(sin, cos) } else { self.wave(cos, minus) }
            }
            Unary::Exp => self.exponential(value),
            Unary::Log => self.logarithm(value),
            Unary::Sqrt => {
                let mut g = self.binomial(value, &0.5.into());
                g[0] = self.0.unary(Unary::Sqrt, value);
                g
            }
            Unary::Tanh => self.tangent(value),
            Unary::Atan => self.arc_tangent(value),
        };
        self.composed(g, a)
    }

    fn binary(&mut self, function: Binary, a: Jet<A, N>, b: Jet<A, N>) -> Jet<A, N> {
        match function {
            Binary::Add | Binary::Subtract => {
                let mut c = a;
                c.iter_mut().zip(b).for_each(|(c, b)| *c = self.0.binary(function, *c, b));
                c
            }
            Binary::Multiply => self.multiplied(&a, &b),
            Binary::Divide => self.divided(&a, &b),
            Binary::Min | Binary::Max => {
                let (larger, smaller) = if function == Binary::Max { (a[0], b[0]) } else { (b[0], a[0]) };
                let (value, branch) = (self.0.binary(function, a[0], b[0]), self.0.branch(larger, smaller));
                self.chosen(value, branch, a, b)
            }
        }
    }

    fn power(&mut self, a: Jet<A, N>, exponent: &Number) -> Jet<A, N> {
        let g = self.binomial(a[0], exponent);
        self.composed(g, a)
    }
}
