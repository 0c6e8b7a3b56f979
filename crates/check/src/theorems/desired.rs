//! Desired dynamics that a user writes down (Section IV-B).
//!
//! Where they are a design of the paper, its theorem speaks, with all that it asks for. Of other ones the cascade, its degree and its
//! reduction are derived by `forwardstep explain`; that 𝒵 does what it is for where s ≡ 0 is shown for targets alone, by the
//! criterion of Routh and Hurwitz: what is left is A(p)(x − x_d) = 0, and what s adds to it is square-integrable once its derivatives are
//! absorbed, if s is.
//!
//! Of a nonlinear protocol its author says what is needed: that its dynamics are globally exponentially stable without s, and input-to-state
//! stable from s, which is bounded and vanishes by the law. That is reported as declared, and runs may refute it.

use forwardstep_core::reference::WrittenIn;
use forwardstep_sim::Setup;
use forwardstep_sim::reference::{Desired, DesiredPolynomial, Protocol};
use num_rational::BigRational;
use num_traits::{Signed, Zero};

use super::own_targets;
use super::tried::tried;
use crate::derivation::polynomial_of;
use crate::fixed::fixed;
use crate::graphs::dwell_time;
use crate::hypothesis::{Hypothesis, Id, KindEvidence, ReferenceEvidence};
use crate::instance::{design, designed, name};
use crate::links::{bounded_delays, bounded_weights};
use crate::report::Report;
use crate::theorem::Theorem;

/// The setup that has the design of the paper in place of desired dynamics that are one, and that they are.
pub(super) fn recognised(setup: &Setup) -> Option<(Setup, Hypothesis)> {
    let (found, roots) = design(setup)?;
    let evidence = ReferenceEvidence::Design { design: name(found, setup.exchange), order: roots.len() };
    Some((designed(setup)?, Hypothesis::new(Id::DesiredDesign, evidence)))
}

/// What is promised under desired dynamics that are no design of the paper.
pub(super) fn check(setup: &Setup, desired: &Desired) -> Report {
    let said = match &desired.protocol {
        Some(protocol) => nonlinear(setup, protocol),
        None if desired.follows_target => vec![Hypothesis::new(Id::DesiredDynamics, stability(desired))],
        None => vec![Hypothesis::new(Id::DesiredDynamics, unknown(setup, desired))],
    };
    if desired.follows_target && !setup.network.has_edges() {
        let report = own_targets::check(setup);
        return Report { hypotheses: said.into_iter().chain(report.hypotheses).collect(), ..report };
    }
    // With a target besides, what neighbours add is part of the protocol, and what is asked of links is asked all the same.
    let mut hypotheses = said;
    hypotheses.extend([dwell_time(setup), bounded_delays(setup)]);
    hypotheses.extend(bounded_weights(setup));
    let promises = "what the desired dynamics do without s, as s vanishes".into();
    Report { theorem: Theorem::Desired, promises, hypotheses }
}

/// What the author of a nonlinear protocol says, and what runs say of that.
fn nonlinear(setup: &Setup, protocol: &Protocol) -> Vec<Hypothesis> {
    let declared = |requires: &str, because: &Option<String>| {
        let because = because.clone().unwrap_or_else(|| "nothing is said of it".into());
        KindEvidence::Declared { requires: requires.into(), because }
    };
    let stable = declared("without s they are globally exponentially stable", &protocol.stable_because);
    let robust = declared("they are input-to-state stable from s", &protocol.input_to_state_stable_because);
    let of = |evidence| Hypothesis::new(Id::DesiredDynamics, evidence);
    vec![of(stable), of(robust), Hypothesis::new(Id::DesiredDynamics, tried(setup))]
}

/// Why nothing is known of a 𝒵 in which agents hear each other.
fn unknown(setup: &Setup, desired: &Desired) -> ReferenceEvidence {
    match desired.written {
        WrittenIn::Measured => ReferenceEvidence::NoDesign {
            steady: fixed(&setup.network).is_ok(),
            by_roots: matches!(desired.polynomial, DesiredPolynomial::Roots { .. }),
        },
        WrittenIn::Z | WrittenIn::X => ReferenceEvidence::NoDesignInThese,
    }
}

/// Whether A is Hurwitz.
fn stability(desired: &Desired) -> ReferenceEvidence {
    let mut ascending = polynomial_of(&desired.polynomial, true).coefficients().to_vec();
    ascending.reverse();
    match routh(&ascending) {
        Some(row) => ReferenceEvidence::Unstable { row, order: desired.polynomial.order() },
        None => ReferenceEvidence::Stable { order: desired.polynomial.order() },
    }
}

/// The first row of the array of Routh, from zero, whose first entry is not positive; `None` where there is none, so that every root of
/// the polynomial lies to the left of the axis. Its coefficients are listed from the highest power on, and the first is one.
fn routh(descending: &[BigRational]) -> Option<usize> {
    let part = |first: usize| descending.iter().skip(first).step_by(2).cloned().collect::<Vec<_>>();
    let entry = |of: &[BigRational], at: usize| of.get(at).cloned().unwrap_or_else(BigRational::zero);
    let (mut above, mut row) = (part(0), part(1));
    for number in 1..descending.len() {
        let lead = entry(&row, 0);
        if !lead.is_positive() {
            return Some(number);
        }
        let share = entry(&above, 0) / lead;
        let next = (1..above.len()).map(|at| entry(&above, at) - &share * entry(&row, at)).collect();
        (above, row) = (row, next);
    }
    None
}

#[cfg(test)]
mod tests {
    use forwardstep_core::expression::Number;

    use super::*;

    fn row(descending: &[f64]) -> Option<usize> {
        routh(&descending.iter().map(|number| Number::written(*number)).collect::<Vec<_>>())
    }

    /// Beside roots that are known: (p + 1)(p + 2)(p + 3), p⁴ + … with a pair on the axis, a pair to the right of it.
    #[test]
    fn the_array_of_routh_tells_polynomials_with_roots_to_the_left() {
        assert_eq!(row(&[1.0, 6.0, 11.0, 6.0]), None);
        // (p² + 1)(p + 1)(p + 2): a row of zeros.
        assert_eq!(row(&[1.0, 3.0, 3.0, 3.0, 2.0]), Some(3));
        // (p² − 0.2 p + 1)(p + 1)².
        assert_eq!(row(&[1.0, 1.8, 1.6, 1.8, 1.0]), Some(3));
        assert_eq!(row(&[1.0, 1.0, 0.5]), None);
        assert_eq!(row(&[1.0, 0.0, 1.0]), Some(1));
        assert_eq!(row(&[1.0, 2.0, -1e-300]), Some(2));
        assert_eq!(row(&[1.0, 3.0]), None);
        // A root at zero.
        assert_eq!(row(&[1.0, 3.0, 2.0, 0.0]), Some(3));
    }
}
