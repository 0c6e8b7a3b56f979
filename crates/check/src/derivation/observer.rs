//! What an observer of the leader obeys: it is no differential cascade, and its equations are said as they stand.

use num_rational::BigRational;

use super::case::Case;
use super::explanation::{Explained, Section, Subject};
use super::form::{Combination, Form, Letter, Quantity, Term};
use super::formula::{At, Formula};
use super::lower::Rubbing;
use super::places::Places;
use super::polynomial::Polynomial;
use super::words;

/// α, γ and κ of an observer.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Observer {
    pub(super) alpha: BigRational,
    pub(super) gamma: BigRational,
    pub(super) kappa: BigRational,
}

fn observed() -> Quantity {
    Quantity::own(Letter::Observed)
}

impl Observer {
    /// dv̂/dt = −α v̂ − Σ_j w_ij (ξ̂_i − ξ̂_j) − γ ς, with v̂ = p x̂ and ξ̂ = (p + α) x̂.
    pub(super) fn observer(&self) -> Form {
        let xi = Polynomial::factor(&self.alpha);
        let own = Combination::of(observed(), Polynomial::power(1).scaled(&-&self.alpha))
            .plus(Quantity::own(Letter::Term(Term::Sign)), &Polynomial::number(-&self.gamma));
        let differences = Combination::of(observed(), xi.clone()).plus(Quantity::heard(Letter::Observed), &-&xi);
        Form::own(own).less(&Form::network(differences))
    }

    /// z = v̂ − κ (q − x̂).
    pub(super) fn reference(&self) -> Form {
        let kappa = Polynomial::number(self.kappa.clone());
        let own = Combination::of(observed(), Polynomial::factor(&self.kappa));
        Form::own(own.plus(Quantity::own(Letter::Position), &-&kappa))
    }

    /// Its derivative, with the observer in it.
    pub(super) fn rate(&self) -> Form {
        let kappa = Polynomial::power(1).scaled(&self.kappa);
        let own = Combination::of(observed(), kappa.clone()).plus(Quantity::own(Letter::Position), &-&kappa);
        self.observer().sum(&Form::own(own))
    }

    /// p (q − x̂) = −κ (q − x̂) + s.
    pub(super) fn distance(&self) -> [Form; 2] {
        let apart = |factor: &Polynomial| {
            Combination::of(Quantity::own(Letter::Position), factor.clone()).plus(observed(), &-factor)
        };
        let s = Combination::of(Quantity::own(Letter::Error), Polynomial::one());
        let right = apart(&Polynomial::number(-&self.kappa)).sum(&s);
        [Form::own(apart(&Polynomial::power(1))), Form::own(right)]
    }
}

/// The explanation.
pub(super) fn explained(case: &Case<'_>, observer: &Observer) -> Explained {
    let (notation, places) = (case.notation(), Places::of(case, 1));
    let z = Quantity::own(Letter::Reference);
    let mut reference = Section::new(Subject::ReferenceDynamics)
        .words(
            "Every agent holds estimates, x̂ of where the leader is and its derivative v̂ of how fast it moves, tells them, and hears those of others; \
             the leader, vertex 0, tells its position and its velocity.",
        )
        .formula(notation.equation(observed(), 2, &observer.observer()), "");
    reference = case.signs(reference, &notation);
    reference = reference
        .words("z leads the robot to its own estimate. Its derivative is made of what is held and measured; nothing is differentiated.")
        .formula(notation.equation(z, 0, &observer.reference()), "")
        .formula(notation.equation(z, 1, &observer.rate()), "")
        .words(words::links(case.setup, case.heard()));
    let mut sections = vec![reference, case.controller(&notation, &places)];
    let mut cascade = Section::new(Subject::Cascade).words(
        "No robot enters the observer, so that nothing has to be reduced: the upper subsystem is the distance from the own estimate, driven by s.",
    );
    let [left, right] = observer.distance();
    let mut system = vec![Formula::equal(notation.form(&left), notation.form(&right))];
    if let Some(lower) = case.lower() {
        system.push(Formula::equal(notation.form(&lower.left), notation.form(&lower.right)));
    }
    cascade = cascade
        .system(system, "")
        .words("No derivative of s stands in the upper subsystem: the cascade is of degree 0.");
    sections.push(cascade);
    let (reached, there) = match case.heard() {
        At::Now => {
            ("and vanishes in finite time. Then the estimates come to the leader", ": qᵢ − q₀ → 0 with its derivative")
        }
        _ => (
            "until it is as small as the delays let it be, which `forwardstep check` says. Then the estimates come as near to the leader",
            "",
        ),
    };
    let last = if case.outside().rubbing == Some(Rubbing::Dry) {
        "Since s need not vanish, qᵢ stays away from its estimate by up to the largest s that is left, divided by κ: the derivation does not cover \
         this, and `forwardstep check` says how large s stays."
            .to_owned()
    } else {
        format!("qᵢ less its estimate is s behind a stable filter, and vanishes with it{there}.")
    };
    sections.push(Section::new(Subject::Convergence).words(words::of_s(case)).words(format!(
        "The estimates obey what (110) makes of robots without s: the largest difference of ξ̂ to the leader falls at a rate of γ less the largest \
         size of what drives the leader, {reached}, at a rate of α. {last}"
    )));
    Explained { agents: case.agents.clone(), order: None, degrees: Some([0, 0]), sections }
}
