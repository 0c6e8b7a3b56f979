//! From forms to formulas: letters for the quantities, in the order in which the paper has them.

use num_rational::BigRational;
use num_traits::{One, Signed};

use super::cascade::Upper;
use super::dynamics::Dynamics;
use super::factors::Factors;
use super::form::{Combination, Form, Letter, Operator, Quantity, Term, Vertex};
use super::formula::{At, Formula, Sign, Symbol};
use super::polynomial::Polynomial;
use super::reduction::{Name, Reduced};

/// How the quantities of one design are written.
#[derive(Clone, Debug, PartialEq)]
pub struct Notation {
    /// The letter for q: `q`, or `x`.
    pub position: &'static str,
    /// The letter for s: `s`, or `s*` of a vehicle.
    pub starred_error: bool,
    /// The mark of Δq*, which is Δq where a law has no reference attitude: `∗`, or nothing.
    pub apart: &'static str,
    /// The index of an agent: `i`, or nothing for one by itself.
    pub own: &'static str,
    /// How late messages are: what is heard is taken at t − T_ij.
    pub heard: At,
    /// Whether weights change: w_ij(t).
    pub weights: At,
    /// The names of variables.
    pub variables: Vec<Name>,
}

impl Notation {
    /// With names for the variables of a reduced system.
    pub fn naming(&self, reduced: &Reduced) -> Notation {
        let variables = reduced.variables.iter().map(|variable| variable.name).collect();
        Notation { variables, ..self.clone() }
    }

    fn index(&self, vertex: Vertex) -> &'static str {
        match vertex {
            Vertex::Own => self.own,
            Vertex::Neighbour => "j",
            Vertex::Leader | Vertex::LateLeader => "0",
        }
    }

    /// The k-th derivative of a quantity.
    pub fn quantity(&self, quantity: Quantity, k: usize) -> Formula {
        let inner = self.letter(quantity.letter, quantity.vertex, k);
        match self.operator(quantity.operator, self.index(quantity.vertex)) {
            None => inner,
            Some(Operated::Factor(factor)) => Formula::product([factor, inner]),
            Some(Operated::Around(before, after)) => Formula::product([Formula::Function(before, vec![inner]), after]),
        }
    }

    fn letter(&self, letter: Letter, vertex: Vertex, k: usize) -> Formula {
        let at = if vertex.is_heard() { self.heard } else { At::Now };
        let index = self.index(vertex);
        let symbol = |base| Symbol::new(base).below(index).derivative(k).at(at);
        let formula = match letter {
            Letter::Reference => symbol("z"),
            Letter::ReferenceDeviation => symbol("Δz"),
            Letter::Position => symbol(self.position),
            Letter::Deviation => symbol(match self.position {
                "x" => "Δx",
                "ω" => "Δω",
                _ => "Δq",
            }),
            Letter::Target => {
                symbol(self.position).below(if index.is_empty() { "d".into() } else { format!("d,{index}") })
            }
            Letter::Observed if k == 0 => symbol("x").hat(),
            Letter::Observed => symbol("v").hat().derivative(k - 1),
            Letter::Composite => symbol("y"),
            Letter::Integral => symbol("η"),
            Letter::Error => symbol("s").above(if self.starred_error { "∗" } else { "" }),
            Letter::Filter => symbol("y"),
            Letter::Coupled => {
                let arguments = [Vertex::Own, Vertex::Neighbour].map(|vertex| self.letter(Letter::Position, vertex, 0));
                let [own, heard] = arguments;
                let difference = Formula::sum([(Sign::Plus, own), (Sign::Minus, heard)]);
                return Formula::Function(Symbol::new("φ").derivative(k), vec![difference]);
            }
            Letter::Variable(number) => {
                let name = self.variables.get(number).copied().unwrap_or(Name::Psi(number));
                return self.name(name, vertex, k);
            }
            Letter::Term(term) => return self.term(term, index, k),
        };
        formula.into()
    }

    /// A variable by its name, or its k-th derivative.
    pub fn name(&self, name: Name, vertex: Vertex, k: usize) -> Formula {
        let at = if vertex.is_heard() { self.heard } else { At::Now };
        let index = self.index(vertex);
        let numbered = |base, r: usize| {
            let below = if index.is_empty() { r.to_string() } else { format!("{index},{r}") };
            Symbol::new(base).below(below).derivative(k).at(at)
        };
        let symbol = |base| Symbol::new(base).below(index).derivative(k).at(at);
        match name {
            Name::Derivative(letter, r) => return self.letter(letter, vertex, r + k),
            Name::Xi => symbol("ξ"),
            Name::Y => symbol("y"),
            Name::Psi(r) => numbered("ψ", r),
            Name::Reduced(r) => numbered("Ψ", r),
            Name::DeltaXi => symbol("Δξ"),
            Name::RelativeXi | Name::RelativeXiStar => symbol("v"),
            Name::Shifted => symbol("x′"),
        }
        .into()
    }

    /// A nonlinear term by its letters.
    fn term(&self, term: Term, index: &'static str, k: usize) -> Formula {
        let symbol = |base| Symbol::new(base).below(index);
        let z = |k| self.letter(Letter::Reference, Vertex::Own, k);
        let regressor = |estimate: Symbol| {
            let q = |k| self.letter(Letter::Position, Vertex::Own, k);
            Formula::product([Formula::Function(symbol("Y"), vec![q(0), q(1), z(0), z(1)]), estimate.into()])
        };
        let formula = match term {
            Term::Sign => symbol("ς").derivative(k),
            Term::Torque => symbol("τ"),
            Term::Gravity => symbol("g"),
            Term::Friction | Term::ReferenceFriction => {
                let (letter, k) = if term == Term::Friction { (Letter::Position, 1) } else { (Letter::Reference, 0) };
                let argument = [Symbol::new("ε").above("−1").into(), self.letter(letter, Vertex::Own, k)];
                let smoothed = Formula::Function(Symbol::new("tanh"), vec![Formula::product(argument)]);
                return Formula::product([symbol("F").into(), smoothed]);
            }
            Term::Regressor => return regressor(symbol("ϑ").hat()),
            Term::RegressorError => return regressor(symbol("Δϑ")),
            Term::Input => symbol("u").above(if self.starred_error { "∗" } else { "" }),
            Term::Weight => return Formula::product([Symbol::new("g").into(), Symbol::new("e").below("3").into()]),
            Term::MassError => return Formula::product([symbol("Δm").into(), symbol("w").into()]),
            Term::MassEstimate => return Formula::product([symbol("m").hat().into(), symbol("w").into()]),
            Term::MassEstimateRate => return Formula::product([symbol("m").hat().into(), z(1)]),
            Term::MassErrorRate => return Formula::product([symbol("Δm").into(), z(1)]),
            Term::TaskForce => {
                let factors =
                    [Symbol::new("J").hat().above("T"), Symbol::new("K").above("∗"), Symbol::new("Δx").derivative(k)];
                return Formula::product(factors.map(Formula::from));
            }
            Term::JointReference => Symbol::new("z").below("r").derivative(k),
            Term::DesiredRate => Symbol::new("ω").below("d").derivative(k),
            Term::DesiredAcceleration => {
                let factors = [Symbol::new("R").above("T"), Symbol::new("ω").derivative(1).below("d").above("I")];
                return Formula::product(factors.map(Formula::from));
            }
            Term::AttitudeError => Symbol::new("Δq").below("v").derivative(k),
            Term::AttitudeDamping => {
                let factors = [Symbol::new("D").above("T"), Symbol::new("K"), Symbol::new("y").derivative(1)];
                return Formula::product(factors.map(Formula::from));
            }
            Term::AttitudeDifference => Symbol::new("Δq").above(self.apart).derivative(k),
            Term::GyroscopicPull => {
                let turned = vec![Symbol::new("Δω").into()];
                let factors = [
                    Symbol::new("M").into(),
                    Formula::Function(Symbol::new("S"), turned),
                    Symbol::new("ω").below("d").into(),
                ];
                return Formula::product(factors);
            }
            Term::External => {
                let below = if index.is_empty() { "ext".into() } else { format!("ext,{index}") };
                Symbol::new("τ").below(below).derivative(k)
            }
            Term::AttitudeErrorRate => {
                let apart = Symbol::new("Δq").above(self.apart).derivative(k);
                return Formula::product([Symbol::new("K").into(), apart.into()]);
            }
            Term::Disturbance => symbol("w"),
            Term::Drift => symbol("χ"),
            Term::Actuation => return Formula::product([symbol("ψ").into(), symbol("u").into()]),
            Term::ChainRegressorError => {
                return Formula::product([Symbol::new("φ").above("T").into(), symbol("Δθ").into()]);
            }
            Term::ImmersionError => return Formula::product([Symbol::new("φ").above("T").into(), symbol("ζ").into()]),
            Term::Constant => symbol("c"),
            Term::Protocol => symbol("f"),
        };
        formula.into()
    }

    /// A form as a sum; Σ_j w_ij […] stands after what an agent has by itself, and s at the end.
    pub fn form(&self, form: &Form) -> Formula {
        let mut terms = Vec::new();
        let late = |quantity: Quantity| {
            matches!(
                quantity.letter,
                Letter::Error | Letter::Filter | Letter::Term(Term::Sign | Term::Constant | Term::Protocol)
            )
        };
        self.terms(&form.own, |quantity| !late(quantity), &mut terms);
        if !form.network.is_zero() {
            terms.push(self.network(&form.network));
        }
        self.terms(&form.own, late, &mut terms);
        Formula::Sum(terms)
    }

    /// Σ_j w_ij […] with its sign, and the factor that all of the bracket has.
    fn network(&self, network: &Combination) -> (Sign, Formula) {
        let mut terms = Vec::new();
        let late = |quantity: Quantity| matches!(quantity.letter, Letter::Error | Letter::Filter);
        self.terms(network, |quantity| !late(quantity), &mut terms);
        self.terms(network, late, &mut terms);
        let sizes: Vec<BigRational> = network
            .terms()
            .flat_map(|(_, a)| a.coefficients())
            .filter(|c| !num_traits::Zero::is_zero(*c))
            .map(Signed::abs)
            .collect();
        let common = sizes.first().filter(|first| sizes.iter().all(|size| size == *first)).cloned();
        let factor = common.unwrap_or_else(BigRational::one);
        let negative = terms.first().is_some_and(|(sign, _)| *sign == Sign::Minus);
        let one = Polynomial::number(if negative { -factor.recip() } else { factor.recip() });
        let mut inside = Vec::new();
        let scaled = network.times(&one);
        self.terms(&scaled, |quantity| !late(quantity), &mut inside);
        self.terms(&scaled, late, &mut inside);
        let weight = Symbol::new("w").below("ij").at(self.weights).into();
        let mut factors = vec![Formula::NeighbourSum, weight];
        if !factor.is_one() {
            factors.insert(0, Formula::Number(factor));
        }
        factors.push(Formula::bracket(Formula::Sum(inside)));
        (if negative { Sign::Minus } else { Sign::Plus }, Formula::Product(factors))
    }

    /// The terms of some quantities: those with more derivatives first, and own before heard.
    fn terms(&self, all: &Combination, choose: impl Fn(Quantity) -> bool, to: &mut Vec<(Sign, Formula)>) {
        let mut found: Vec<(Vertex, std::cmp::Reverse<usize>, Quantity, usize, BigRational)> = Vec::new();
        for (quantity, a) in all.terms().filter(|(quantity, _)| choose(*quantity)) {
            for (k, c) in a.coefficients().iter().enumerate().filter(|(_, c)| !num_traits::Zero::is_zero(*c)) {
                let rank = std::cmp::Reverse(self.rank(quantity.letter) + k);
                found.push((quantity.vertex, rank, quantity, k, c.clone()));
            }
        }
        // Where it is the same, what has a plus comes first: q̇ − z.
        found.sort_by_key(|(vertex, rank, quantity, _, c)| (*vertex, *rank, c.is_negative(), *quantity));
        to.extend(found.iter().map(|(_, _, quantity, k, c)| Formula::term(c, self.quantity(*quantity, *k))));
    }

    /// How many derivatives of q a letter counts as, for the order of terms.
    fn rank(&self, letter: Letter) -> usize {
        match letter {
            Letter::Reference | Letter::ReferenceDeviation => 1,
            Letter::Variable(number) => number,
            Letter::Position
            | Letter::Deviation
            | Letter::Target
            | Letter::Observed
            | Letter::Composite
            | Letter::Integral
            | Letter::Error
            | Letter::Filter
            | Letter::Coupled
            | Letter::Term(_) => 0,
        }
    }

    /// The k-th derivative of a quantity is a form.
    pub fn equation(&self, quantity: Quantity, k: usize, right: &Form) -> Formula {
        Formula::equal(self.quantity(quantity, k), self.form(right))
    }

    /// The equations of a reduced system, with the names of its variables. Those that only name a derivative are left out.
    pub fn system(&self, reduced: &Reduced) -> Vec<Formula> {
        let named = self.naming(reduced);
        let each = reduced.variables.iter().zip(&reduced.rates);
        each.map(|(variable, rate)| (named.name(variable.name, Vertex::Own, 1), named.form(rate)))
            .filter(|(left, right)| *right != Formula::Sum(vec![(Sign::Plus, left.clone())]))
            .map(|(left, right)| Formula::equal(left, right))
            .collect()
    }

    /// What a variable is: its definition in q and s.
    pub fn definition(&self, upper: &Upper, state: &Polynomial, input: &Polynomial) -> Formula {
        let own = Combination::of(Quantity::own(upper.state), state.clone()).plus(Quantity::own(upper.input), &-input);
        self.form(&Form::own(own))
    }

    /// p^(k−1) q − z.
    pub fn definition_of_error(&self, dynamics: &Dynamics) -> Formula {
        let of = |letter| {
            let terms = dynamics.definition_of_error();
            let polynomial = terms.own.polynomial(Quantity::own(letter));
            Form::own(Combination::of(Quantity::own(letter), polynomial))
        };
        let mut all = Vec::new();
        for letter in [Letter::Position, Letter::Reference] {
            if let Formula::Sum(terms) = self.form(&of(letter)) {
                all.extend(terms);
            }
        }
        Formula::Sum(all)
    }

    /// A polynomial in p.
    pub fn polynomial(&self, polynomial: &Polynomial) -> Formula {
        let powers = polynomial.coefficients().iter().enumerate().rev();
        let terms = powers.filter(|(_, c)| !num_traits::Zero::is_zero(*c)).map(|(r, c)| match r {
            0 => Formula::signed(c),
            1 => Formula::term(c, Symbol::new("p").into()),
            _ => Formula::term(c, Symbol::new("p").above(power(r)).into()),
        });
        Formula::Sum(terms.collect())
    }

    /// ∏ (p + κ), and p² + 2 a p + a² + b² for pairs.
    pub fn factors(&self, roots: &Factors) -> Formula {
        let factor = |factor: Polynomial| Formula::Function(Symbol::new(""), vec![self.polynomial(&factor)]);
        Formula::Product(roots.factors().map(factor).collect())
    }

    /// What is written for an operator.
    fn operator(&self, operator: Operator, index: &'static str) -> Option<Operated> {
        let factor = |base| Some(Operated::Factor(Symbol::new(base).below(index).into()));
        match operator {
            Operator::Identity => None,
            Operator::Inertia => factor("M"),
            Operator::Coriolis => factor("C"),
            Operator::Damping => factor("K"),
            Operator::Mass => factor("m"),
            Operator::Viscous => factor("D"),
            Operator::AttitudeMap => {
                let of = vec![Symbol::new("Δq").above(self.apart).into()];
                Some(Operated::Factor(Formula::Function(Symbol::new("D"), of)))
            }
            Operator::Filter => Some(Operated::Factor(Symbol::new("Λ").below("f").into())),
            Operator::Momentum => {
                Some(Operated::Factor(Formula::Function(Symbol::new("S"), vec![Symbol::new("h").into()])))
            }
            Operator::Gyroscopic => Some(Operated::Around(Symbol::new("S"), Symbol::new("ω").below("d").into())),
        }
    }
}

/// An exponent: there are no more than 32 roots.
fn power(r: usize) -> &'static str {
    const POWERS: [&str; 34] = [
        "0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "11", "12", "13", "14", "15", "16", "17", "18", "19",
        "20", "21", "22", "23", "24", "25", "26", "27", "28", "29", "30", "31", "32", "33",
    ];
    POWERS.get(r).copied().unwrap_or("…")
}

/// How an operator is written.
enum Operated {
    /// In front.
    Factor(Formula),
    /// As a function, with something behind.
    Around(Symbol, Formula),
}
