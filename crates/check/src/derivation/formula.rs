//! Formulas as trees: what is written in a terminal, in LaTeX and in MathML from one source.

use num_rational::BigRational;
use num_traits::{One, Signed};

/// A formula.
#[derive(Clone, Debug, PartialEq)]
pub enum Formula {
    /// A number that is not negative.
    Number(BigRational),
    /// A letter with what hangs on it.
    Symbol(Symbol),
    /// Terms, each with its sign; zero if there are none.
    Sum(Vec<(Sign, Formula)>),
    /// Factors side by side.
    Product(Vec<Formula>),
    /// One in square brackets.
    Bracket(Box<Formula>),
    /// A function of others.
    Function(Symbol, Vec<Formula>),
    /// Σ over the neighbours j of i.
    NeighbourSum,
    /// d/dt in front of one.
    Rate(Box<Formula>),
    /// Two that are equal.
    Equal(Box<Formula>, Box<Formula>),
    /// One that is an element of another.
    Element(Box<Formula>, Box<Formula>),
    /// Rows.
    Matrix(Vec<Vec<Formula>>),
}

/// The sign of a term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// +.
    Plus,
    /// −.
    Minus,
}

/// A letter.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Symbol {
    /// The letter, or a word such as `sgn`.
    pub base: &'static str,
    /// Whether it has a hat: an estimate.
    pub hat: bool,
    /// How often it is differentiated.
    pub derivative: usize,
    /// The index below.
    pub below: String,
    /// What stands above: `∗`, `T`.
    pub above: &'static str,
    /// Its argument, where it is not t.
    pub at: At,
}

/// When a symbol is taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum At {
    /// At t, which is not written.
    #[default]
    Now,
    /// At t, which is written.
    Time,
    /// At t − T_ij.
    Late,
    /// At t − T_ij(t).
    VaryingLate,
}

impl Symbol {
    /// A letter alone.
    pub fn new(base: &'static str) -> Self {
        Symbol { base, ..Symbol::default() }
    }

    /// With an index.
    pub fn below(self, below: impl Into<String>) -> Self {
        Symbol { below: below.into(), ..self }
    }

    /// With something above.
    pub fn above(self, above: &'static str) -> Self {
        Symbol { above, ..self }
    }

    /// With a hat.
    pub fn hat(self) -> Self {
        Symbol { hat: true, ..self }
    }

    /// Differentiated so often.
    pub fn derivative(self, derivative: usize) -> Self {
        Symbol { derivative, ..self }
    }

    /// Taken then.
    pub fn at(self, at: At) -> Self {
        Symbol { at, ..self }
    }
}

impl From<Symbol> for Formula {
    fn from(symbol: Symbol) -> Self {
        Formula::Symbol(symbol)
    }
}

impl Formula {
    /// A number with its sign, as a term.
    pub fn signed(number: &BigRational) -> (Sign, Formula) {
        let sign = if number.is_negative() { Sign::Minus } else { Sign::Plus };
        (sign, Formula::Number(number.abs()))
    }

    /// A number times something, as a term; a factor of one is not written.
    pub fn term(number: &BigRational, what: Formula) -> (Sign, Formula) {
        let (sign, size) = Formula::signed(number);
        if number.abs().is_one() { (sign, what) } else { (sign, Formula::Product(vec![size, what])) }
    }

    /// Two that are equal.
    pub fn equal(left: impl Into<Formula>, right: impl Into<Formula>) -> Self {
        Formula::Equal(Box::new(left.into()), Box::new(right.into()))
    }

    /// The factors side by side.
    pub fn product(factors: impl IntoIterator<Item = Formula>) -> Self {
        Formula::Product(factors.into_iter().collect())
    }

    /// In square brackets.
    pub fn bracket(inside: Formula) -> Self {
        Formula::Bracket(Box::new(inside))
    }

    /// With a minus in front.
    pub fn minus(what: Formula) -> Self {
        Formula::Sum(vec![(Sign::Minus, what)])
    }

    /// Terms with a plus.
    pub fn sum(terms: impl IntoIterator<Item = (Sign, Formula)>) -> Self {
        Formula::Sum(terms.into_iter().collect())
    }
}
