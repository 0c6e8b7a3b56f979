//! All agents together: columns of their variables, and matrices of numbers times those of the graph.

use num_rational::BigRational;
use num_traits::Zero;

use super::form::{Combination, Form, Letter, Quantity, Vertex};
use super::formula::{Formula, Sign, Symbol};
use super::laplacian::Block;
use super::notation::Notation;
use super::polynomial::Polynomial;
use super::reduction::{Name, Reduced};

/// A row of a reduced system, stacked: what every agent has by itself, what the network does to the variables, and how derivatives of s
/// enter.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Numbers times variables.
    pub own: Combination,
    /// What stands in Ψ_D, the column of Σ_j w_ij […].
    pub network: Combination,
    /// For each derivative of s: a I_n + b D_w times it.
    pub inputs: Vec<(usize, [BigRational; 2])>,
}

impl Reduced {
    /// The system of all agents: (12) and (a3). `None` where something of a neighbour other than its variables enters, as its s does.
    pub fn stacked(&self, input: Letter) -> Option<Vec<Row>> {
        self.rates.iter().map(|rate| row(rate, input)).collect()
    }
}

fn row(rate: &Form, input: Letter) -> Option<Row> {
    let split = |all: &Combination, of_input: bool| {
        let terms = all.terms().filter(|(quantity, _)| (quantity.letter == input) == of_input);
        terms.fold(Combination::default(), |sum, (quantity, a)| sum.plus(quantity, a))
    };
    let (own_input, network_input) = (split(&rate.own, true), split(&rate.network, true));
    if network_input.terms().any(|(quantity, _)| quantity.vertex != Vertex::Own) {
        return None;
    }
    let of = |all: &Combination| all.polynomial(Quantity::own(input));
    let (a, b) = (of(&own_input), of(&network_input));
    let len = a.coefficients().len().max(b.coefficients().len());
    let inputs = (0..len).map(|k| (k, [a.coefficient(k), b.coefficient(k)]));
    let inputs = inputs.filter(|(_, [a, b])| !a.is_zero() || !b.is_zero()).collect();
    Some(Row { own: split(&rate.own, false), network: split(&rate.network, false), inputs })
}

/// a I + b D_w + c W.
fn block(block: &Block) -> Formula {
    let each = [(&block.identity, "I", "n"), (&block.degrees, "D", "w"), (&block.weights, "W", "")];
    let terms: Vec<(Sign, Formula)> = (each.into_iter())
        .filter(|(number, ..)| !number.is_zero())
        .map(|(number, base, below)| Formula::term(number, Symbol::new(base).below(below).into()))
        .collect();
    if terms.is_empty() { Formula::Number(BigRational::zero()) } else { Formula::Sum(terms) }
}

/// The matrix of a Laplacian form.
pub fn matrix(blocks: &[Vec<Block>]) -> Formula {
    let rows = blocks.iter().map(|row| row.iter().map(block).collect()).collect();
    Formula::equal(Symbol::new("A"), Formula::Matrix(rows))
}

/// The equations of a stacked system. Its variables have no index, and what the network does is Ψ_D.
pub fn system(reduced: &Reduced, rows: &[Row], notation: &Notation, with_input: bool) -> Vec<Formula> {
    let columns = Notation { own: "", ..notation.naming(reduced) };
    let each = reduced.variables.iter().zip(rows).map(|(variable, row)| {
        let Formula::Sum(mut terms) = columns.form(&Form::own(row.own.clone())) else {
            return Formula::Sum(Vec::new());
        };
        if !row.network.is_zero() {
            terms.push((Sign::Minus, psi(row, &columns)));
        }
        if with_input {
            terms.extend(row.inputs.iter().map(|(k, numbers)| input(*k, numbers, &columns)));
        }
        Formula::equal(columns.name(variable.name, Vertex::Own, 1), Formula::Sum(terms))
    });
    each.collect()
}

/// Ψ_D of the variables in a row.
fn psi(row: &Row, columns: &Notation) -> Formula {
    let mut numbers: Vec<usize> = row.network.terms().filter_map(|(quantity, _)| variable(quantity)).collect();
    numbers.sort_unstable_by_key(|number| std::cmp::Reverse(*number));
    numbers.dedup();
    let name = |number: usize| columns.variables.get(number).copied().unwrap_or(Name::Psi(number));
    let arguments = numbers.into_iter().map(|number| columns.name(name(number), Vertex::Own, 0)).collect();
    Formula::Function(Symbol::new("Ψ").below("D"), arguments)
}

fn variable(quantity: Quantity) -> Option<usize> {
    match quantity.letter {
        Letter::Variable(number) => Some(number),
        Letter::Reference
        | Letter::Position
        | Letter::Deviation
        | Letter::ReferenceDeviation
        | Letter::Target
        | Letter::Observed
        | Letter::Composite
        | Letter::Integral
        | Letter::Error
        | Letter::Filter
        | Letter::Coupled
        | Letter::Term(_) => None,
    }
}

/// (a I_n + b D_w) times a derivative of s.
fn input(k: usize, [a, b]: &[BigRational; 2], columns: &Notation) -> (Sign, Formula) {
    let s = columns.quantity(Quantity::own(Letter::Error), k);
    if b.is_zero() {
        return Formula::term(a, s);
    }
    let negative = b < &BigRational::zero();
    let sign = |number: &BigRational| if negative { -number } else { number.clone() };
    let [a, b] = [sign(a), sign(b)];
    let matrices = [(a, "I", "n"), (b, "D", "w")];
    let terms = matrices.into_iter().filter(|(number, ..)| !number.is_zero());
    let terms = terms.map(|(number, base, below)| Formula::term(&number, Symbol::new(base).below(below).into()));
    let product = Formula::product([Formula::bracket(Formula::Sum(terms.collect())), s]);
    (if negative { Sign::Minus } else { Sign::Plus }, product)
}

/// The network part of a row as what Ψ_D is the column of.
pub fn column(row: &Row, reduced: &Reduced, notation: &Notation) -> Formula {
    let inside = notation.naming(reduced).form(&Form::network(row.network.times(&-&Polynomial::one())));
    let numbers = psi(row, &Notation { own: "", ..notation.naming(reduced) });
    Formula::equal(numbers, Formula::Function(Symbol::new("column"), vec![inside]))
}
