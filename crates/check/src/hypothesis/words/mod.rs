//! Evidence in sentences. This is the only place where they are made.

mod change;
mod following;
mod graph;
mod kinds;
mod links;
mod motion;
pub(crate) mod numbers;
mod reference;
mod robots;
mod surroundings;

use forwardstep_sim::leader::FollowingDesign;

use super::{Evidence, Id, Named, Subject};

pub(super) use change::change;
pub(crate) use kinds::counterexample;

/// What is required, of whom.
pub(super) fn requires(id: Id, subject: &Subject) -> String {
    id.sentence().replacen('…', &of(subject), 1)
}

/// The evidence.
pub(super) fn because(evidence: &Evidence) -> String {
    match evidence {
        Evidence::Graph(evidence) => graph::words(evidence),
        Evidence::Links(evidence) => links::words(evidence),
        Evidence::Reference(evidence) => reference::words(evidence),
        Evidence::Following(evidence) => following::words(evidence),
        Evidence::Loop(evidence) => surroundings::words(evidence),
        Evidence::Motion(evidence) => motion::words(evidence),
        Evidence::Kind(evidence) => kinds::words(evidence),
        Evidence::Robot(evidence) => robots::words(evidence),
    }
}

/// `first`, …, `ninth`, `10th`.
fn ordinal(number: usize) -> String {
    const WORDS: [&str; 10] =
        ["zeroth", "first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth"];
    WORDS.get(number).map_or_else(|| format!("{number}{}", suffix(number)), |word| (*word).to_owned())
}

fn suffix(number: usize) -> &'static str {
    match (number % 10, number % 100) {
        (_, 11..=13) => "th",
        (1, _) => "st",
        (2, _) => "nd",
        (3, _) => "rd",
        _ => "th",
    }
}

/// What stands for `…` in what is required.
fn of(subject: &Subject) -> String {
    match subject {
        Subject::Setup => String::new(),
        Subject::Reference => "the reference dynamics".into(),
        Subject::Agent(agent) => agent.name.clone(),
        Subject::Targets { agents, derivatives, travels: true } => {
            format!(
                "the derivatives of the target of {}, which may travel, up to the {}",
                names(agents),
                ordinal(*derivatives)
            )
        }
        Subject::Targets { agents, derivatives, travels: false } => {
            format!("the target of {} and its derivatives up to the {}", names(agents), ordinal(*derivatives))
        }
        Subject::Offsets { agents, derivatives } => {
            format!("the derivatives of the offset of {} up to the {}", names(agents), ordinal(*derivatives))
        }
        Subject::Drive(design) => match design {
            FollowingDesign::Continuous | FollowingDesign::Observer { .. } => "q̈₀ + α q̇₀",
            FollowingDesign::Swarm { .. } => "q⃛₀",
            FollowingDesign::Differentiable | FollowingDesign::WithoutAcceleration | FollowingDesign::Composite => {
                "q⃛₀ + β q̈₀ + α q̇₀"
            }
        }
        .into(),
    }
}

/// Names for a sentence; long lists are cut.
fn names(agents: &[Named]) -> String {
    const SHOWN: usize = 6;
    let shown: Vec<&str> = agents.iter().take(SHOWN).map(|agent| agent.name.as_str()).collect();
    let rest = agents.len().saturating_sub(SHOWN);
    if rest > 0 { format!("{} and {rest} more", shown.join(", ")) } else { shown.join(", ") }
}
