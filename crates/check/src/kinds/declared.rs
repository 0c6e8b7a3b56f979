//! Laws from outside: what their authors say of them, reported as declared and never as shown.

use forwardstep_sim::probe::probe_balance;
use forwardstep_sim::system::{Declaration, DeclaredClaim, Known};
use forwardstep_sim::{AgentSetup, Setup};

use super::{Claim, KindCheck};
use crate::hypothesis::{Hypothesis, Id, KindEvidence, Named, Subject};
use crate::theorem::Theorem;

pub(crate) struct DeclaredKind;

impl KindCheck for DeclaredKind {
    fn name(&self) -> &'static str {
        "declared"
    }

    /// All that no other kind treats: it comes last.
    fn treats(&self, _: &AgentSetup) -> bool {
        true
    }

    fn treated(&self, _: &AgentSetup) -> &'static str {
        "laws from outside"
    }

    fn claim(&self, setup: &Setup) -> Option<Claim> {
        let Declaration { source, promises, .. } = declaration(setup.agents.first()?.law.known());
        Some(Claim { theorem: Theorem::Declared(source), promises })
    }

    fn hypotheses(&self, setup: &Setup, agents: &[usize]) -> Vec<Hypothesis> {
        let mut hypotheses = Vec::new();
        for index in agents {
            let subject = || Subject::Agent(Named::of(setup, *index));
            for claim in declaration(setup.agents[*index].law.known()).claims {
                let evidence = KindEvidence::Declared { requires: claim.requires, because: claim.because };
                hypotheses.push(Hypothesis::about(Id::Declared, subject(), evidence));
            }
            // A setup that cannot be built is refused before anybody asks what is known of it.
            let probe = probe_balance(setup, *index).unwrap_or_default();
            let requires = "V changes as the law says that it does".into();
            hypotheses.push(Hypothesis::about(Id::Declared, subject(), KindEvidence::Probed { requires, probe }));
        }
        hypotheses
    }

    /// Nothing is known of it, so as many as there are.
    fn target_derivatives(&self, _: &AgentSetup) -> usize {
        4
    }
}

/// What the author says. Whoever says nothing, or that it is checked where it is not, must not be taken for one that has
/// shown all: then there is one claim, of which nothing is known.
pub(crate) fn declaration(known: Known) -> Declaration {
    let mut declaration = match known {
        Known::Declared(declaration) => declaration,
        Known::Checked => Declaration {
            source: "nothing, for it says that it is checked, and no kind here is this one".into(),
            promises: "nothing that is known here".into(),
            claims: Vec::new(),
        },
    };
    if declaration.claims.is_empty() {
        let requires = "what its convergence needs".into();
        declaration.claims.push(DeclaredClaim { requires, because: "nothing is said of it".into() });
    }
    declaration
}
