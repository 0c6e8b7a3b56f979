//! The kinds of systems, each with its law, one line per kind; and what setups made of them fall under.

use forwardstep_sim::{AgentSetup, Setup};

use crate::hypothesis::{Evidence, Hypothesis, Id, KindEvidence};
use crate::kinds::{
    Chain, Claim, DeclaredKind, FilteredSpacecraft, KindCheck, LagrangianRobot, ModelledMass, PositionOnlyMass,
    Rotorcraft, Spacecraft, TaskSpaceRobot, Vehicle,
};
use crate::theorem::Theorem;

/// All kinds, in the order in which their hypotheses are listed.
const KINDS: [&dyn KindCheck; 10] = [
    &PositionOnlyMass,   // (a8)
    &ModelledMass,       // Remark 7
    &Vehicle,            // Section V-B
    &Rotorcraft,         // the same with a body
    &TaskSpaceRobot,     // Theorem 6
    &Spacecraft,         // Theorem 7
    &FilteredSpacecraft, // Remark 10
    &Chain,              // Section IV
    &LagrangianRobot,    // (6) and (7)
    &DeclaredKind,       // laws from outside
];

/// The kind of an agent; that of a law from outside is what it says of itself.
pub(crate) fn kind_of(agent: &AgentSetup) -> &'static dyn KindCheck {
    KINDS.into_iter().find(|kind| kind.treats(agent)).unwrap_or(&DeclaredKind)
}

/// The theorem or remark that speaks about the kinds of a setup; nothing for (6)–(7), which Section III treats by its reference
/// dynamics.
pub(crate) fn claim(setup: &Setup) -> Option<Claim> {
    let treated = treated(setup);
    if treated.len() < 2 {
        return kind_of(setup.agents.first()?).claim(setup);
    }
    Some(if setup.all_track() {
        let theorem = Theorem::Targets(side_by_side(setup).into_iter().map(|claim| claim.theorem).collect());
        Claim { theorem, promises: "every agent reaches its own target".into() }
    } else {
        let promises = if setup.agents.iter().any(|agent| agent.target.is_some()) {
            "with y = x − offset all agents agree on y, and it comes to rest: yᵢ − yⱼ → 0 and ẏᵢ → 0"
        } else {
            "all agents agree and come to rest: xᵢ − xⱼ → 0 and ẋᵢ → 0"
        };
        Claim { theorem: Theorem::Mixture(treated), promises: promises.into() }
    })
}

/// What is said of the agents of each place where they are treated, as if there were no others.
fn side_by_side(setup: &Setup) -> Vec<Claim> {
    let claim = |treated: &'static str| {
        let own = setup.agents.iter().filter(|agent| kind_of(agent).treated(agent) == treated);
        let own = Setup { agents: own.cloned().collect(), ..setup.clone() };
        kind_of(own.agents.first()?).claim(&own)
    };
    treated(setup).into_iter().filter_map(claim).collect()
}

/// What the laws themselves ask for.
pub(crate) fn hypotheses(setup: &Setup) -> Vec<Hypothesis> {
    let mut hypotheses: Vec<Hypothesis> = one_kind(setup).into_iter().collect();
    for kind in KINDS {
        let is_it = |agent: &usize| kind_of(&setup.agents[*agent]).name() == kind.name();
        let agents: Vec<usize> = (0..setup.agents.len()).filter(is_it).collect();
        if agents.is_empty() {
            continue;
        }
        for mut hypothesis in kind.hypotheses(setup, &agents) {
            if goes_on(setup) && ends_a_run(&hypothesis) {
                hypothesis.evidence = KindEvidence::SafeCommand.into();
            }
            // Vehicles and rotorcraft share an outer law, and may say the same of it.
            if !hypotheses.contains(&hypothesis) {
                hypotheses.push(hypothesis);
            }
        }
    }
    hypotheses
}

/// Whether a run goes on where a step of a controller fails.
fn goes_on(setup: &Setup) -> bool {
    setup.control.as_ref().is_some_and(|control| control.failures.safe_command.is_some())
}

/// Whether the evidence is that a run would end where the hypothesis fails.
fn ends_a_run(hypothesis: &Hypothesis) -> bool {
    use KindEvidence::{Determinant, FactorFloor, SingularValue, ThrustFloor};
    let watched = |evidence: &KindEvidence| {
        matches!(evidence, ThrustFloor { .. } | FactorFloor { .. } | Determinant { .. } | SingularValue { .. })
    };
    matches!(&hypothesis.evidence, Evidence::Kind(evidence) if watched(evidence))
}

/// Agents that agree with each other should fall under one theorem.
fn one_kind(setup: &Setup) -> Option<Hypothesis> {
    let treated = treated(setup);
    let mixture = treated.len() > 1 && !setup.all_track();
    mixture.then(|| Hypothesis::new(Id::OneKind, KindEvidence::Mixture(treated)))
}

/// Where the agents are treated, each place once.
fn treated(setup: &Setup) -> Vec<&'static str> {
    // Who leads does not agree with anybody.
    let led = setup.agents.iter().enumerate().filter(|(agent, _)| setup.leader() != Some(*agent));
    let mut treated: Vec<&str> = led.map(|(_, agent)| kind_of(agent).treated(agent)).collect();
    treated.sort_unstable();
    treated.dedup();
    treated
}
