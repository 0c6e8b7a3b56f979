//! Laws from outside: what their authors say of them, reported as declared and never as shown.

use forwardstep_sim::system::{Declaration, Known};
use forwardstep_sim::{AgentSetup, Setup};

use super::{Claim, KindCheck};
use crate::hypothesis::{Hypothesis, Id, KindEvidence, Named, Subject};
use crate::theorem::Theorem;

pub(crate) struct DeclaredKind;

impl KindCheck for DeclaredKind {
    fn name(&self) -> &'static str {
        "declared"
    }

    fn treats(&self, agent: &AgentSetup) -> bool {
        declaration(agent).is_some()
    }

    fn treated(&self, _: &AgentSetup) -> &'static str {
        "laws from outside"
    }

    fn claim(&self, setup: &Setup) -> Option<Claim> {
        let Declaration { source, promises, .. } = declaration(setup.agents.first()?)?;
        Some(Claim { theorem: Theorem::Declared(source), promises })
    }

    fn hypotheses(&self, setup: &Setup, agents: &[usize]) -> Vec<Hypothesis> {
        let mut hypotheses = Vec::new();
        for index in agents {
            let claims = declaration(&setup.agents[*index]).map(|declaration| declaration.claims).unwrap_or_default();
            for claim in claims {
                let subject = Subject::Agent(Named::of(setup, *index));
                let evidence = KindEvidence::Declared { requires: claim.requires, because: claim.because };
                hypotheses.push(Hypothesis::about(Id::Declared, subject, evidence));
            }
        }
        hypotheses
    }

    /// Nothing is known of it, so as many as there are.
    fn target_derivatives(&self, _: &AgentSetup) -> usize {
        4
    }

    fn wants_common_order(&self) -> bool {
        true
    }
}

fn declaration(agent: &AgentSetup) -> Option<Declaration> {
    match agent.law.known() {
        Known::Checked => None,
        Known::Declared(declaration) => Some(declaration),
    }
}
