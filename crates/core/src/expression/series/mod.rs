//! The algebra of truncated power series in several variables, laid out before any number is known.
//!
//! A series is the Taylor polynomial of a function about the point at hand,
//!
//! ```text
//! a(v + δ) = Σ_m a_m δᵐ,     |m| ≤ its degree
//! ```
//!
//! and which m may occur follows from how it is computed: x_1 has two, a product has sums, and ∂ takes one away. So the list of
//! all additions and multiplications is made once, when a law is built, and an evaluation runs through it. What does not depend
//! on a variable has no coefficients for it, a polynomial none beyond its degree, and what is zero has none at all.
//!
//! A graph of derivatives says the same, but names every derivative of every sub-expression anew: the derivative of a product is
//! two products, that of those is four. Here a product of degree d in n variables is at most one multiplication for each pair of
//! monomials whose product is kept, C(2n + d, d) of them, whatever is differentiated later.
//!
//! A function f of a = a₀ + δ is composed as g₀ + δ (g₁ + δ (g₂ + …)) with gⱼ = f⁽ʲ⁾(a₀)/j!.

mod outer;
mod program;
mod sums;
mod support;

use alloc::vec;
use alloc::vec::Vec;

pub(crate) use program::Program;
pub(crate) use sums::Term;

use self::outer::Outer;
use self::program::{Op, Part, Row, Source};
use self::support::{Gathered, Support};
use super::{Algebra, Binary, Expression, ExpressionError, Number, Unary};

/// Multiplications that one evaluation may take: some 5 ms on a desktop processor, and 4 bytes of memory for each.
pub(super) const MOST_PRODUCTS: u64 = 5_000_000;

/// A series: which one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Register(usize);

/// Where the coefficients of a series stand.
#[derive(Clone, Debug)]
struct Placed {
    at: usize,
    support: Support,
}

/// Series over numbered variables, being laid out.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    variables: usize,
    placed: Vec<Placed>,
    /// Constants where there are some; what is computed is zero.
    coefficients: Vec<f64>,
    ops: Vec<Op>,
    parts: Vec<Part>,
    rows: Vec<Row>,
    targets: Vec<u32>,
    sources: Vec<Source>,
    products: u64,
}

impl Series {
    /// Over `variables` variables.
    pub(crate) fn new(variables: usize) -> Self {
        let zero = Placed { at: 0, support: Support::default() };
        Series {
            variables,
            placed: vec![zero],
            coefficients: Vec::new(),
            ops: Vec::new(),
            parts: Vec::new(),
            rows: Vec::new(),
            targets: Vec::new(),
            sources: Vec::new(),
            products: 0,
        }
    }

    /// What one evaluation takes so far, in multiplications.
    pub(crate) fn products(&self) -> u64 {
        self.products
    }

    /// The one without coefficients.
    pub(crate) fn zero(&self) -> Register {
        Register(0)
    }

    pub(crate) fn is_zero(&self, a: Register) -> bool {
        self.placed[a.0].support.len() == 0
    }

    /// A new series with these monomials.
    fn place(&mut self, support: Support) -> Register {
        if support.len() == 0 {
            return self.zero();
        }
        let at = self.coefficients.len();
        self.coefficients.resize(at + support.len(), 0.0);
        self.placed.push(Placed { at, support });
        Register(self.placed.len() - 1)
    }

    fn unit(&self) -> Vec<u8> {
        vec![0; self.variables]
    }

    /// A constant.
    pub(crate) fn number(&mut self, value: f64) -> Register {
        if value == 0.0 {
            return self.zero();
        }
        let register = self.constant_place();
        let at = self.placed[register.0].at;
        self.coefficients[at] = value;
        register
    }

    /// A series of degree zero that is still to be computed.
    fn constant_place(&mut self) -> Register {
        let mut gathered = Gathered::up_to(0);
        gathered.add(&self.unit());
        self.place(gathered.support())
    }

    /// Variable `index`, read from entry `index` of what is given.
    pub(crate) fn variable(&mut self, index: usize) -> Result<Register, ExpressionError> {
        if index >= self.variables {
            return Err(ExpressionError::Variable { variable: index, count: self.variables });
        }
        let mut gathered = Gathered::up_to(1);
        let mut monomial = self.unit();
        gathered.add(&monomial);
        monomial[index] = 1;
        gathered.add(&monomial);
        let register = self.place(gathered.support());
        let at = self.placed[register.0].at;
        self.coefficients[at + 1] = 1.0;
        self.ops.push(Op::Read { to: at, entry: index, factor: 1.0 });
        Ok(register)
    }

    /// A function of variable `by` alone whose derivatives of order 0 … `degree` are given in the entries from `first` on.
    pub(crate) fn jet(&mut self, by: usize, first: usize, degree: usize) -> Register {
        let mut gathered = Gathered::up_to(degree);
        let mut monomial = self.unit();
        for exponent in 0..=degree {
            // Degrees are those of chains, which have fewer than 256 equations.
            monomial[by] = exponent as u8;
            gathered.add(&monomial);
        }
        let register = self.place(gathered.support());
        let (at, mut factor) = (self.placed[register.0].at, 1.0);
        for k in 0..=degree {
            factor /= k.max(1) as f64;
            self.ops.push(Op::Read { to: at + k, entry: first + k, factor });
        }
        register
    }

    /// ∂ by variable `by`, of one degree less.
    pub(crate) fn slope(&mut self, of: Register, by: usize) -> Register {
        let Placed { at, support } = &self.placed[of.0];
        let (mut gathered, first) = (Gathered::up_to(support.degrees()), self.sources.len());
        for (index, monomial) in support.monomials().iter().enumerate() {
            if let Some(less) = monomial[by].checked_sub(1) {
                let mut lower = monomial.to_vec();
                lower[by] = less;
                gathered.add(&lower);
                // Those that are left keep their order.
                self.sources.push(Source { from: at + index, factor: f64::from(monomial[by]) });
            }
        }
        let slope = self.place(gathered.support());
        if !self.is_zero(slope) {
            self.ops.push(Op::Slope { to: self.placed[slope.0].at, sources: first..self.sources.len() });
        }
        slope
    }

    /// The series without its constant.
    fn varying(&mut self, a: Register) -> Register {
        let Placed { at, support } = &self.placed[a.0];
        let (at, support) = (at + support.up_to(0), support.varying());
        if support.len() == 0 {
            return self.zero();
        }
        self.placed.push(Placed { at, support });
        Register(self.placed.len() - 1)
    }

    /// Where the constant of a series stands, unless it is zero.
    fn constant(&self, a: Register) -> Option<usize> {
        let Placed { at, support } = &self.placed[a.0];
        (support.up_to(0) > 0).then_some(*at)
    }

    /// Whether it has no coefficient but the constant one.
    fn is_constant(&self, a: Register) -> bool {
        let support = &self.placed[a.0].support;
        support.up_to(0) == support.len()
    }

    /// f(a) up to a degree.
    fn composed(&mut self, outer: Outer, a: Register, degree: usize) -> Result<Register, ExpressionError> {
        let delta = self.varying(a);
        let degree = if self.is_zero(delta) { 0 } else { outer.degree().map_or(degree, |own| own.min(degree)) };
        if let (Outer::Function(Unary::Abs), 1..) = (outer, degree) {
            return Err(ExpressionError::NotSmooth { function: "abs" });
        }
        let first = self.coefficients.len();
        let g: Vec<Register> = (0..=degree).map(|_| self.constant_place()).collect();
        self.ops.push(Op::Outer { outer, from: self.constant(a), to: first, count: degree + 1 });
        let mut result = g[degree];
        for (k, g) in g[..degree].iter().enumerate().rev() {
            // δᵏ stands before it.
            result = self.sum(&[Term::Scaled(1.0, *g), Term::Product(1.0, delta, result)], degree - k)?;
        }
        Ok(result)
    }

    /// An expression up to a degree.
    pub(crate) fn import(&mut self, expression: &Expression, degree: usize) -> Result<Register, ExpressionError> {
        expression.fold(&mut Import { series: self, degree })
    }

    /// The list of all operations, and where the results are.
    pub(crate) fn program(self, outputs: &[Register]) -> Program {
        let outputs = outputs.iter().map(|register| self.constant(*register)).collect();
        let Series { coefficients, ops, parts, rows, targets, sources, .. } = self;
        Program { coefficients, ops, parts, rows, targets, sources, outputs }
    }
}

/// An expression as a series of some degree.
struct Import<'a> {
    series: &'a mut Series,
    degree: usize,
}

impl Algebra for Import<'_> {
    type Value = Result<Register, ExpressionError>;

    fn number(&mut self, number: &Number) -> Self::Value {
        Ok(self.series.number(number.value()))
    }
    fn variable(&mut self, index: usize) -> Self::Value {
        self.series.variable(index)
    }
    fn unary(&mut self, function: Unary, a: Self::Value) -> Self::Value {
        match function {
            Unary::Negate => self.series.sum(&[Term::Scaled(-1.0, a?)], self.degree),
            _ => self.series.composed(Outer::Function(function), a?, self.degree),
        }
    }
    fn binary(&mut self, function: Binary, a: Self::Value, b: Self::Value) -> Self::Value {
        let (series, degree, a, b) = (&mut *self.series, self.degree, a?, b?);
        match function {
            Binary::Add => series.sum(&[Term::Scaled(1.0, a), Term::Scaled(1.0, b)], degree),
            Binary::Subtract => series.sum(&[Term::Scaled(1.0, a), Term::Scaled(-1.0, b)], degree),
            Binary::Multiply => series.sum(&[Term::Product(1.0, a, b)], degree),
            Binary::Divide => {
                let inverse = series.composed(Outer::Power(-1.0), b, degree)?;
                series.sum(&[Term::Product(1.0, a, inverse)], degree)
            }
            Binary::Min | Binary::Max => {
                if degree > 0 && !(series.is_constant(a) && series.is_constant(b)) {
                    let function = if function == Binary::Min { "min" } else { "max" };
                    return Err(ExpressionError::NotSmooth { function });
                }
                let [a, b] = [a, b].map(|value| series.constant(value));
                let result = series.constant_place();
                let to = series.placed[result.0].at;
                series.ops.push(Op::Combine { function, to, a, b });
                Ok(result)
            }
        }
    }
    fn power(&mut self, a: Self::Value, exponent: &Number) -> Self::Value {
        self.series.composed(Outer::Power(exponent.value()), a?, self.degree)
    }
}
