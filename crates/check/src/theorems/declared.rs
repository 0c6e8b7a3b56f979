//! Reference dynamics from outside: what their author says of them, reported as declared and never as shown.

use forwardstep_sim::Setup;
use forwardstep_sim::probe::probe_reference;
use forwardstep_sim::system::{Declaration, DeclaredClaim};

use super::theorem_3::complex_roots;
use crate::graphs::dwell_time;
use crate::hypothesis::{Hypothesis, Id, KindEvidence, Subject};
use crate::kinds::declaration;
use crate::links::{bounded_delays, bounded_weights};
use crate::report::Report;
use crate::theorem::Theorem;

/// What the author promises, with what the network and the laws add to it.
pub(super) fn check(setup: &Setup) -> Report {
    let Declaration { source, promises, claims } = declaration(setup.reference.known());
    let declared = |evidence| Hypothesis::about(Id::Declared, Subject::Reference, evidence);
    let mut hypotheses: Vec<Hypothesis> = claims
        .into_iter()
        .map(|DeclaredClaim { requires, because }| declared(KindEvidence::Declared { requires, because }))
        .collect();
    // A setup that cannot be built is refused before anybody asks what is known of it.
    let probe = probe_reference(setup).unwrap_or_default();
    let requires = "they are what they are stepped as".into();
    hypotheses.push(declared(KindEvidence::Probed { requires, probe }));
    hypotheses.extend([dwell_time(setup), bounded_delays(setup)]);
    hypotheses.extend(bounded_weights(setup));
    // Their author knows of roots −κ.
    hypotheses.extend(complex_roots(setup));
    Report { theorem: Theorem::Declared(source), promises, hypotheses }
}
