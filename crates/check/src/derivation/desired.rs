//! Desired dynamics that a user writes down, and what (43) makes of them: 𝒵, 𝓕 and the degree.

use forwardstep_core::expression::Number;
use forwardstep_core::reference::WrittenIn;
use forwardstep_sim::reference::{Desired, DesiredPolynomial};

use super::cascade::Upper;
use super::dynamics::{Dynamics, Measured};
use super::explanation::{Section, Subject};
use super::factors::Factors;
use super::form::{Combination, Form, Letter, Quantity, Term};
use super::formula::{Formula, Symbol};
use super::notation::Notation;
use super::polynomial::Polynomial;

/// A polynomial as it is written; `monic` where a leading coefficient of one is not listed.
pub fn polynomial_of(written: &DesiredPolynomial, monic: bool) -> Polynomial {
    match written {
        DesiredPolynomial::Coefficients(list) => {
            let listed = Polynomial::new(list.iter().map(|number| Number::written(*number)).collect());
            if monic { &listed + &Polynomial::power(list.len()) } else { listed }
        }
        DesiredPolynomial::Roots { integrators, roots } => {
            &Polynomial::power(*integrators) * &Factors::written(roots).product()
        }
    }
}

/// A(p)(q_i − q_d) = −Σ_j w_ij [B(p) q_i − (c₀ + c₁ p) q_j], in q alone.
fn wanted(desired: &Desired) -> Form {
    let a = polynomial_of(&desired.polynomial, true);
    let q = Quantity::own(Letter::Position);
    let mut own = Combination::of(q, &Polynomial::power(desired.polynomial.order()) - &a);
    if desired.follows_target {
        own = own.plus(Quantity::own(Letter::Target), &a);
    }
    let b = desired.coupling.as_ref().map_or_else(Polynomial::default, |written| polynomial_of(written, false));
    let heard = match &desired.heard[..] {
        [] => Polynomial::number(b.coefficient(0)),
        list => Polynomial::new(list.iter().map(|number| Number::written(*number)).collect()),
    };
    if desired.protocol.is_some() {
        own = own.plus(Quantity::own(Letter::Term(Term::Protocol)), &Polynomial::one());
    }
    let bracket = Combination::of(q, b).plus(Quantity::heard(Letter::Position), &-&heard);
    Form::own(own).less(&Form::network(bracket))
}

/// 𝒵 for a plant of order `plant`, in the variables it is written in; `None` where its order is below that.
pub fn dynamics(desired: &Desired, plant: usize) -> Option<Dynamics> {
    let total = desired.polynomial.order();
    let order = (total + 1).checked_sub(plant).filter(|order| *order > 0)?;
    let below = match desired.written {
        WrittenIn::Measured => plant,
        WrittenIn::Z => plant.saturating_sub(1),
        WrittenIn::X => total + 1,
    };
    Some(Measured { plant, below }.dynamics(order, &wanted(desired)))
}

/// What a user asks for, in x alone.
pub(super) fn asked(desired: &Desired, notation: &Notation) -> Section {
    let total = desired.polynomial.order();
    Section::new(Subject::ReferenceDynamics)
        .words("The scenario asks for the following, with p for d/dt, whatever the order of the plant:")
        .formula(notation.equation(Quantity::own(Letter::Position), total, &wanted(desired)), "Section IV-B")
}

/// 𝒵 rewritten in x, and 𝓕: the parts of the upper subsystem that do not hold s, and that do.
pub(super) fn parts(desired: &Desired, upper: &Upper, notation: &Notation, section: Section) -> Section {
    let in_x = upper.right.without(upper.input);
    let of_s = upper.right.less(&in_x);
    let why = match desired.written {
        WrittenIn::Measured | WrittenIn::X if upper.reference_order == 1 => {
            "All derivatives that 𝒵 holds are measured, so that 𝓕 is the first derivative of s alone."
        }
        WrittenIn::Measured => {
            "Derivatives that are not measured are those of z (Remark 6), so that 𝓕 holds lower derivatives of s besides the highest one."
        }
        WrittenIn::Z => {
            "From the highest derivative that is measured on those of z are taken (Remark 6), so that 𝓕 holds s itself and all derivatives up to the highest one."
        }
        WrittenIn::X => {
            "Derivatives that are not measured are avoided in the integration of z (Remark 6), so that 𝓕 is the highest derivative of s alone."
        }
    };
    section
        .words("In the form of (43) the upper subsystem is the sum of 𝒵, rewritten in x, and of 𝓕, which holds s:")
        .formula(Formula::equal(Symbol::new("𝒵"), notation.form(&in_x)), "(43)")
        .formula(Formula::equal(Symbol::new("𝓕"), notation.form(&of_s)), "(43)")
        .words(why)
        .words(match (&desired.protocol, desired.written) {
            (None, _) => "",
            (Some(_), WrittenIn::Measured) if upper.reference_order == 1 => {
                "f is the nonlinear protocol of the scenario. Its arguments are those that 𝒵 has: all are measured, and none holds s."
            }
            (Some(_), WrittenIn::X) => {
                "f is the nonlinear protocol of the scenario. Its arguments are those that 𝒵 has: derivatives of x, and none holds s."
            }
            (Some(_), WrittenIn::Measured | WrittenIn::Z) => {
                "f is the nonlinear protocol of the scenario. Its arguments are those that 𝒵 has: derivatives of z in it are those of x less those of s, so \
                 that it belongs to 𝓕 too; it holds none of s above the one before the highest."
            }
        })
}
