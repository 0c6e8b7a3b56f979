//! The laws of estimates and filters, which are what they are: nothing is derived of them.

use num_rational::BigRational;

use super::case::{Case, Step, ThrustStep};
use super::form::{Combination, Form, Letter, Quantity, Term};
use super::formula::{Formula, Sign, Symbol};
use super::notation::Notation;
use super::polynomial::Polynomial;

/// An estimate that is kept within bounds: Π of what it would be.
fn projected(law: Formula) -> Formula {
    match law {
        Formula::Equal(left, right) => {
            Formula::Equal(left, Box::new(Formula::Function(Symbol::new("Π"), vec![*right])))
        }
        other => other,
    }
}

/// The equations of a case's estimates and filters, each with its place in the paper.
pub(super) fn of(case: &Case<'_>, notation: &Notation) -> Vec<(Formula, &'static str)> {
    let index = notation.own;
    let symbol = |base| Symbol::new(base).below(index);
    let s = |k| notation.quantity(Quantity::own(Letter::Error), k);
    let z = |k| notation.quantity(Quantity::own(Letter::Reference), k);
    // estimate' = −gain gradient times an error; or of what is found, which comes back at a rate, and its part within bounds is used.
    let found = |estimate: Symbol, gain: Symbol, factors: Vec<Formula>, back: Symbol, place| {
        let found = symbol("μ");
        let product = Formula::product([Formula::from(gain)].into_iter().chain(factors));
        let beyond = Formula::bracket(Formula::sum([
            (Sign::Plus, found.clone().into()),
            (Sign::Minus, estimate.clone().into()),
        ]));
        let rate = [(Sign::Minus, product), (Sign::Minus, Formula::product([back.into(), beyond]))];
        let used = Formula::Function(Symbol::new("Π"), vec![found.clone().into()]);
        vec![(Formula::equal(found.derivative(1), Formula::sum(rate)), place), (Formula::equal(estimate, used), "")]
    };
    let gradient = |estimate: Symbol, gain: Symbol, factors: Vec<Formula>| {
        let product = [Formula::from(gain)].into_iter().chain(factors).collect();
        Formula::equal(estimate.derivative(1), Formula::minus(Formula::Product(product)))
    };
    let robot = |place| {
        let q = |k| notation.quantity(Quantity::own(Letter::Position), k);
        let regressor = Formula::Function(symbol("Y").above("T"), vec![q(0), q(1), z(0), z(1)]);
        let law = gradient(symbol("ϑ").hat(), symbol("Γ"), vec![regressor, s(0)]);
        (if case.is_bounded() { projected(law) } else { law }, place)
    };
    match &case.step {
        Step::Robot { known: false } => vec![robot("(7)")],
        Step::Robot { known: true } => Vec::new(),
        Step::TaskSpace(_) | Step::TipVelocity(_) => {
            let (law, place) = kinematic();
            vec![robot("(81)"), (if case.has_bounded_lengths() { projected(law) } else { law }, place)]
        }
        Step::PositionOnly([_, filter]) => {
            let y = Quantity::own(Letter::Filter);
            let rate = Polynomial::number(filter.clone());
            let right = Combination::of(Quantity::own(Letter::Error), rate.clone()).plus(y, &-&rate);
            let filtered = (notation.equation(y, 1, &Form::own(right)), "after (a9)");
            let (estimate, gain, factors) =
                (symbol("m").hat(), Symbol::new("γ").above("∗"), vec![transposed(z(1)), s(0)]);
            if case.is_bounded() {
                let found = found(estimate, gain, factors, Symbol::new("λ").below("f"), "after (a9)");
                return [filtered].into_iter().chain(found).collect();
            }
            vec![filtered, (gradient(estimate, gain, factors), "after (a9)")]
        }
        Step::Thrust(ThrustStep::Adaptive | ThrustStep::ByAcceleration, [alpha, _]) => {
            let number = |number: &BigRational| Polynomial::number(number.clone());
            let w = Combination::of(
                Quantity::own(Letter::Reference),
                &Polynomial::power(2) + &(&Polynomial::power(1) * &number(alpha)),
            )
            .plus(nonlinear(Term::Weight), &-&number(alpha));
            let w = (Formula::equal(symbol("w"), notation.form(&Form::own(w))), "");
            let (estimate, gain) = (symbol("m").hat(), Symbol::new("γ").above("∗"));
            let factors = vec![transposed(symbol("w").into()), s(1)];
            if case.is_bounded() {
                let found = found(estimate, gain, factors, Symbol::new("α").above("∗"), "(58)");
                return [w].into_iter().chain(found).collect();
            }
            vec![w, (gradient(estimate, gain, factors), "(58)")]
        }
        Step::Thrust(ThrustStep::Continuous | ThrustStep::Differentiable, _)
        | Step::ModelReference(_)
        | Step::Chain(..)
        | Step::Outside(_) => Vec::new(),
        Step::Attitude(_) | Step::PassivityFilter(_) => {
            let y = Symbol::new("y");
            let filtered = Formula::product([Symbol::new("Λ").below("f").into(), y.clone().into()]);
            let driven = Formula::product([Symbol::new("K").into(), Symbol::new("Δq").above(notation.apart).into()]);
            let left = Formula::sum([(Sign::Plus, y.derivative(1).into()), (Sign::Plus, filtered)]);
            let place = if matches!(case.step, Step::Attitude(_)) { "(100)" } else { "" };
            vec![(Formula::equal(left, driven), place)]
        }
    }
}

/// vᵀ of a vector.
fn transposed(vector: Formula) -> Formula {
    match vector {
        Formula::Symbol(symbol) => symbol.above("T").into(),
        other => other,
    }
}

/// (82).
fn kinematic() -> (Formula, &'static str) {
    let q = |k| Formula::from(Symbol::new("q").derivative(k));
    let factors = [
        Symbol::new("Λ").into(),
        Formula::Function(Symbol::new("Z").above("T"), vec![q(0), q(1)]),
        Symbol::new("K").above("∗").into(),
        Symbol::new("Δx").into(),
    ];
    (Formula::equal(Symbol::new("θ").hat().derivative(1), Formula::product(factors)), "(82)")
}

/// The letter of a nonlinear term.
pub(super) fn nonlinear(term: Term) -> Quantity {
    Quantity::own(Letter::Term(term))
}
