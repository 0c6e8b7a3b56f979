//! What agents obey that agree with their leader on one vector: what is told and what a robot is led by are two equations.

use num_rational::BigRational;

use super::case::Case;
use super::explanation::{Explained, Section, Subject};
use super::form::{Combination, Form, Letter, Quantity, Term};
use super::formula::{At, Formula};
use super::lower::Rubbing;
use super::places::Places;
use super::polynomial::Polynomial;
use super::words;

/// α, β and γ.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Composite {
    pub(super) alpha: BigRational,
    pub(super) beta: BigRational,
    pub(super) gamma: BigRational,
}

/// y.
pub(super) fn told() -> Quantity {
    Quantity::own(Letter::Composite)
}

impl Composite {
    /// ẏ = −Σ_j w_ij (y_i − y_j) − γ ς.
    pub(super) fn agreement(&self) -> Form {
        let sign = Combination::of(Quantity::own(Letter::Term(Term::Sign)), Polynomial::number(-&self.gamma));
        let one = Polynomial::one();
        let differences = Combination::of(told(), one.clone()).plus(Quantity::heard(Letter::Composite), &-&one);
        Form::own(sign).less(&Form::network(differences))
    }

    /// ż = y − β z − α q.
    pub(super) fn reference(&self) -> Form {
        Form::own(self.filtered(Quantity::own(Letter::Reference), 0))
    }

    /// q̈ = y − β q̇ − α q + ṡ + β s, which has a derivative of s in it.
    pub(super) fn cascade(&self) -> [Form; 2] {
        let (q, s) = (Quantity::own(Letter::Position), Quantity::own(Letter::Error));
        let right = self.filtered(q, 1).plus(s, &Polynomial::factor(&self.beta));
        [Form::own(Combination::of(q, Polynomial::power(2))), Form::own(right)]
    }

    /// q̇ = z + s, which has none.
    pub(super) fn reduced(&self) -> [Form; 2] {
        let one = Polynomial::one();
        let right = Combination::of(Quantity::own(Letter::Reference), one.clone());
        let left = Combination::of(Quantity::own(Letter::Position), Polynomial::power(1));
        [Form::own(left), Form::own(right.plus(Quantity::own(Letter::Error), &one))]
    }

    /// y − β p^k `of` − α q.
    fn filtered(&self, of: Quantity, k: usize) -> Combination {
        let damped = Polynomial::power(k).scaled(&-&self.beta);
        Combination::of(told(), Polynomial::one())
            .plus(of, &damped)
            .plus(Quantity::own(Letter::Position), &Polynomial::number(-&self.alpha))
    }
}

/// The explanation.
pub(super) fn explained(case: &Case<'_>, composite: &Composite) -> Explained {
    let (notation, places) = (case.notation(), Places::of(case, 2));
    let z = Quantity::own(Letter::Reference);
    let equal = |[left, right]: [Form; 2]| Formula::equal(notation.form(&left), notation.form(&right));
    let mut reference = Section::new(Subject::ReferenceDynamics)
        .words("Every agent holds one vector y, tells it, and hears those of others; the leader, vertex 0, tells that of its own motion.")
        .formula(notation.equation(told(), 1, &composite.agreement()), "");
    reference = case.signs(reference, &notation);
    reference = reference
        .words("z is led by it, and z̈ with the sign in it is integrated twice; nothing is differentiated.")
        .formula(notation.equation(z, 1, &composite.reference()), "")
        .words(words::links(case.setup, case.heard()));
    let mut sections = vec![reference, case.controller(&notation, &places)];
    let mut system = vec![equal(composite.cascade())];
    if let Some(lower) = case.lower() {
        system.push(Formula::equal(notation.form(&lower.left), notation.form(&lower.right)));
    }
    let cascade = Section::new(Subject::Cascade)
        .words("No robot enters y. The upper subsystem is a robot that is led by it, driven by s and its derivative.")
        .system(system, "")
        .words("The derivative of s is of order one: the cascade is of degree 1. With z for q̇ − s it is gone, and the degree is 0:")
        .system(vec![equal(composite.reduced()), notation.equation(z, 1, &composite.reference())], "");
    sections.push(cascade);
    let last = if case.outside().rubbing == Some(Rubbing::Dry) {
        "Since s need not vanish, qᵢ stays away from the leader by up to the largest s that is left, behind that filter: the derivation does not \
         cover this, and `forwardstep check` says how large s stays."
    } else {
        "qᵢ − q₀ is what is left of y and s behind a stable filter, and falls to what they fall to, as its derivative does."
    };
    let reached = match case.heard() {
        At::Now => "and vanishes in finite time",
        _ => "until it is as small as the delays let it be, which `forwardstep check` says",
    };
    sections.push(Section::new(Subject::Convergence).words(words::of_s(case)).words(format!(
        "y obeys what (110) makes of robots without s: its largest difference to the leader's falls at a rate of γ less the largest size of what \
         drives the leader, {reached}. {last}"
    )));
    Explained { agents: case.agents.clone(), order: Some(3), degrees: Some([1, 0]), sections }
}
