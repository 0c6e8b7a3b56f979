//! Whether two nodes of a graph are the same function, as far as the algebra of polynomials tells.
//!
//! Every node is written as a sum of products of real powers of *atoms*: variables, functions of such sums, and sums in a power that is no
//! whole number. Sums, products, whole powers and quotients by a single product are carried out. What is left of the difference of two
//! nodes is then zero, but for rounding of its coefficients, only if they agree wherever both have values. The converse does not hold:
//! sin² + cos² is not known to be 1.

use alloc::collections::BTreeMap;
use alloc::vec;
use alloc::vec::Vec;

use super::graph::{Graph, Node, Op};
use super::{Binary, Unary};

/// Coefficients this small, as a part of the largest, are rounding.
const ROUNDING: f64 = 1e-12;
/// Terms of a sum beyond which it is not carried out.
const MOST_TERMS: usize = 4000;
/// The largest power of a sum that is carried out.
const MOST_POWER: f64 = 16.0;

/// Atoms by their numbers with their exponents, as bits, none of which is zero.
type Product = Vec<(usize, u64)>;
type Sum = BTreeMap<Product, f64>;
/// A sum with its coefficients as bits.
type Key = Vec<(Product, u64)>;

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Atom {
    Variable(usize),
    Base(Key),
    Unary(Unary, Key),
    Binary(Binary, Key, Key),
}

#[derive(Default)]
struct Atoms(BTreeMap<Atom, usize>);

impl Graph {
    /// Whether `a` and `b` are shown to agree wherever both have values; the coefficients of sums may differ by rounding.
    pub fn agree(&self, a: Node, b: Node) -> bool {
        let mut atoms = Atoms::default();
        let mut sums: Vec<Option<Sum>> = Vec::new();
        for node in self.below(&[a, b]) {
            sums.resize(node.0, None);
            let sum = atoms.sum(self.ops()[node.0], &sums);
            sums.push(sum);
        }
        let of = |node: Node| sums.get(node.0).and_then(Option::as_ref);
        let Some((a, b)) = of(a).zip(of(b)) else { return false };
        let largest = a.values().chain(b.values()).fold(0.0_f64, |most, c| most.max(c.abs()));
        added(a, b, -1.0).is_some_and(|left| left.values().all(|c| c.abs() <= ROUNDING * largest))
    }
}

impl Atoms {
    fn sum(&mut self, op: Op, known: &[Option<Sum>]) -> Option<Sum> {
        let of = |node: Node| known.get(node.0)?.as_ref();
        match op {
            Op::Number(bits) => Some(constant(f64::from_bits(bits))),
            Op::Variable(index) => Some(self.atom(Atom::Variable(index), 1.0)),
            Op::Unary(Unary::Negate, a) => added(&Sum::new(), of(a)?, -1.0),
            Op::Unary(Unary::Sqrt, a) => self.power(of(a)?, 0.5),
            Op::Unary(function, a) => Some(self.atom(Atom::Unary(function, key(of(a)?)), 1.0)),
            Op::Power(a, bits) => self.power(of(a)?, f64::from_bits(bits)),
            Op::Binary(Binary::Add, a, b) => added(of(a)?, of(b)?, 1.0),
            Op::Binary(Binary::Subtract, a, b) => added(of(a)?, of(b)?, -1.0),
            Op::Binary(Binary::Multiply, a, b) => multiplied(of(a)?, of(b)?),
            Op::Binary(Binary::Divide, a, b) => multiplied(of(a)?, &self.power(of(b)?, -1.0)?),
            Op::Binary(function, a, b) => Some(self.atom(Atom::Binary(function, key(of(a)?), key(of(b)?)), 1.0)),
        }
    }

    fn atom(&mut self, atom: Atom, exponent: f64) -> Sum {
        let next = self.0.len();
        let number = *self.0.entry(atom).or_insert(next);
        [(vec![(number, exponent.to_bits())], 1.0)].into()
    }

    fn power(&mut self, base: &Sum, exponent: f64) -> Option<Sum> {
        let whole = exponent == libm::trunc(exponent);
        match base.iter().next() {
            None => (exponent > 0.0).then(Sum::new),
            Some((product, c)) if whole && base.len() == 1 => {
                let raised = |(atom, e): &(usize, u64)| (*atom, (f64::from_bits(*e) * exponent).to_bits());
                Some([(product.iter().map(raised).collect(), libm::pow(*c, exponent))].into())
            }
            Some(_) if whole && exponent > 0.0 && exponent <= MOST_POWER => {
                (1..exponent as u32).try_fold(base.clone(), |sum, _| multiplied(&sum, base))
            }
            Some(_) => Some(self.atom(Atom::Base(key(base)), exponent)),
        }
    }
}

fn key(sum: &Sum) -> Key {
    sum.iter().map(|(product, c)| (product.clone(), c.to_bits())).collect()
}

fn constant(c: f64) -> Sum {
    if c == 0.0 { Sum::new() } else { [(Vec::new(), c)].into() }
}

/// a + c b.
fn added(a: &Sum, b: &Sum, c: f64) -> Option<Sum> {
    let mut sum = a.clone();
    for (product, value) in b {
        *sum.entry(product.clone()).or_insert(0.0) += c * value;
    }
    sum.retain(|_, value| *value != 0.0);
    (sum.len() <= MOST_TERMS).then_some(sum)
}

fn multiplied(a: &Sum, b: &Sum) -> Option<Sum> {
    if a.len() * b.len() > MOST_TERMS {
        return None;
    }
    let mut sum = Sum::new();
    for ((p, x), (q, y)) in a.iter().flat_map(|a| b.iter().map(move |b| (a, b))) {
        let mut exponents: BTreeMap<usize, f64> = BTreeMap::new();
        for (atom, exponent) in p.iter().chain(q) {
            *exponents.entry(*atom).or_insert(0.0) += f64::from_bits(*exponent);
        }
        let product = exponents.into_iter().filter(|(_, e)| *e != 0.0).map(|(atom, e)| (atom, e.to_bits())).collect();
        *sum.entry(product).or_insert(0.0) += x * y;
    }
    sum.retain(|_, value| *value != 0.0);
    Some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expression::Expression;

    fn x(index: usize) -> Expression {
        Expression::variable(index)
    }

    fn agree(a: &Expression, b: &Expression) -> bool {
        let mut graph = Graph::new(2);
        let [a, b] = [a, b].map(|one| graph.import(one).unwrap());
        graph.agree(a, b)
    }

    /// ∂Φ/∂x₁ beside φ.
    fn is_slope(antiderivative: &Expression, of: &Expression) -> bool {
        let mut graph = Graph::new(2);
        let value = graph.import(antiderivative).unwrap();
        let (slope, of) = (graph.derivative(value, 1).unwrap(), graph.import(of).unwrap());
        graph.agree(slope, of)
    }

    #[test]
    fn what_is_the_same_is_known_however_it_is_written() {
        let (a, b) = (x(0), x(1));
        let square = |x: Expression| x.clone() * x;
        let cases = [
            (square(a.clone() + b.clone()), square(a.clone()) + a.clone() * b.clone() * 2.0 + square(b.clone())),
            ((a.clone() * 3.0 + b.clone()).sin_of() * 2.0, (b.clone() + a.clone() * 3.0).sin_of() * 2.0),
            (a.clone() / (a.clone() * b.clone()), b.clone().power(-1.0)),
            ((square(a.clone()) + 1.0).sqrt_of(), (square(a.clone()) + 1.0).power(0.5)),
        ];
        for (one, other) in &cases {
            assert!(agree(one, other), "{one:?} {other:?}");
            assert!(!agree(one, &(other.clone() + b.clone() * 1e-9)), "{one:?}");
            assert!(!agree(one, &(other.clone() * (1.0 + 1e-9))), "{one:?}");
        }
        assert!(!agree(&square(a.clone()).power(1.25), &a.clone().power(2.5)), "not where a is negative");
        assert!(!agree(&(a.sin_of()), &(b.sin_of())));
    }

    #[test]
    fn slopes_of_antiderivatives_are_known() {
        let (x0, v) = (x(0), x(1));
        let cases = [
            (v.clone().power(3.0) / 3.0, v.clone().power(2.0)),
            (v.clone() * x0.clone().sin_of(), x0.clone().sin_of()),
            (v.clone().cos_of() * -1.0, v.clone().sin_of()),
            ((v.clone() * 2.0).exp_of() / 2.0, (v.clone() * 2.0).exp_of()),
            (v.clone().sin_of() - v.clone() * v.clone().cos_of(), v.clone() * v.clone().sin_of()),
            ((v.clone().power(2.0) + 1.0).sqrt_of(), v.clone() / (v.clone().power(2.0) + 1.0).sqrt_of()),
            (v.clone().atan_of(), (v.clone().power(2.0) + 1.0).power(-1.0)),
        ];
        for (antiderivative, of) in &cases {
            assert!(is_slope(antiderivative, of), "{of:?}");
        }
        // A slip that is nowhere to be seen but near v = 3.
        let slip = ((v.clone() - 3.0) * 20.0).exp_of() * -0.01;
        assert!(!is_slope(&(v.clone() + slip), &Expression::number(1.0)));
        assert!(!is_slope(&(x0.clone() * 1e-9 * v.clone() + v.clone()), &Expression::number(1.0)));
    }
}
