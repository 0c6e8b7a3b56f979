//! The smallest change that would make a hypothesis hold: an edge, γ, κ₀, a rate. Nothing where it holds.
//!
//! It is sufficient for that hypothesis, not always necessary, and says nothing of the others. No match has an arm for the rest:
//! evidence that is new has to say its change.

mod systems;

use forwardstep_core::reference::Choice;
use forwardstep_sim::delay::{Basis, Refuted, Unknown};
use forwardstep_sim::leader::FollowingDesign;
use forwardstep_sim::quantity::MOST_EVENTS;

use super::numbers::{bound, rounded_down, rounded_up};
use crate::hypothesis::evidence::{MOST_HELD, MOST_LEFT};
use crate::hypothesis::{
    Answer, Evidence, FollowingEvidence, GraphEvidence, Inexact, Limited, LinkEvidence, LoopEvidence, Named,
    ReferenceEvidence, WeightFault,
};

/// Agents that are named.
const NAMES: usize = 20;
/// A rate is that of a design for which somebody else answers.
const SHIPPED: &str = "one of the shipped kinds, of which the parameters tell";

/// A delay that is a formula and is known for all time.
const STEADY: &str =
    "a formula that stays bounded with its slope, such as one in sines of multiples of t, or one constant";

/// What to change; `None` where the hypothesis holds.
pub(in crate::hypothesis) fn change(evidence: &Evidence) -> Option<String> {
    if evidence.answer() == Answer::Holds {
        return None;
    }
    match evidence {
        Evidence::Graph(evidence) => graph(evidence),
        Evidence::Links(evidence) => links(evidence),
        Evidence::Reference(evidence) => reference(evidence),
        Evidence::Following(evidence) => following(evidence),
        Evidence::Loop(evidence) => surroundings(evidence),
        Evidence::Motion(evidence) => systems::motion(evidence),
        Evidence::Kind(evidence) => systems::kind(evidence),
        Evidence::Robot(evidence) => systems::robot(evidence),
    }
}

fn graph(evidence: &GraphEvidence) -> Option<String> {
    Some(match evidence {
        GraphEvidence::Window { .. } | GraphEvidence::Reached { .. } => {
            "a spanning tree in each of the graphs that are drawn, or graphs that repeat".into()
        }
        GraphEvidence::Cut { closed_groups, .. } => joined(closed_groups),
        GraphEvidence::Unreached { closed_group, .. } => {
            let to = closed_group.first().map_or("", |agent| agent.name.as_str());
            format!("an edge to {to} from the leader, or from an agent that hears it, in a graph that recurs")
        }
        GraphEvidence::DeclaredPhases { .. } | GraphEvidence::RefutedSwitching { .. } => SHIPPED.into(),
        GraphEvidence::VaryingWeight => "weights that are constant".into(),
        GraphEvidence::Switches { exchange, .. } => match exchange.has_velocities() {
            true => "one graph, or `reference.consensus` with two roots, which is (a1)".into(),
            false => "one graph, or `reference.consensus`, which is (24)".into(),
        },
        GraphEvidence::InEveryGraph { .. } => "graphs that repeat".into(),
        GraphEvidence::Once { .. } => {
            "graphs that repeat, or a run that is twice as long as what it needs to bring all together".into()
        }
        GraphEvidence::Unheard { phase, closed_group, .. } => {
            let to = closed_group.first().map_or("", |agent| agent.name.as_str());
            format!("in phase {phase} an edge to {to} from the leader, or from an agent that hears it")
        }
        GraphEvidence::SwitchesUnderLeader { design } => match design {
            FollowingDesign::Continuous | FollowingDesign::Composite | FollowingDesign::Observer { .. } => {
                "one graph, or links without delay".into()
            }
            FollowingDesign::Differentiable | FollowingDesign::WithoutAcceleration => {
                "one graph, or the design `continuous`, which is (110), or `composite`, whose torques are differentiable".into()
            }
            FollowingDesign::Swarm { .. } => "one graph".into(),
        },
        GraphEvidence::OneWay { edges } => {
            let named = edges.iter().take(NAMES).map(|[from, to]| format!("from {} to {}", to.name, from.name));
            let named = named.collect::<Vec<_>>().join(", ");
            match edges.len() {
                1 => format!("an edge {named} with the weight of the one that leads back"),
                2..=NAMES => format!("edges {named}, each with the weight of the one that leads back"),
                all => format!("edges {named}, and {} more, each with the weight of the one that leads back", all - NAMES),
            }
        }
        GraphEvidence::LoggedPhases { .. } => "phases that repeat, or end with one that stays".into(),
        GraphEvidence::EveryGraph { .. }
        | GraphEvidence::NeverSwitches
        | GraphEvidence::ShortestPhase { .. }
        | GraphEvidence::DrawnPhases { .. }
        | GraphEvidence::Stays
        | GraphEvidence::Mutual => return None,
    })
}

/// One edge fewer than there are groups makes one agent reach all.
fn joined(groups: &[Vec<Named>]) -> String {
    let mut first = groups.iter().filter_map(|group| group.first());
    let Some(root) = first.next() else { return "an edge that joins the groups".into() };
    let others: Vec<&str> = first.map(|agent| agent.name.as_str()).collect();
    let (named, more) = others.split_at(others.len().min(NAMES));
    let more = match more.len() {
        0 => String::new(),
        more => format!(", and to one agent of each of {more} more groups"),
    };
    let what = if others.len() == 1 { "an edge" } else { "edges" };
    format!("{what} from {} to {}{more}, in a graph that recurs", root.name, named.join(", "))
}

fn links(evidence: &LinkEvidence) -> Option<String> {
    Some(match evidence {
        LinkEvidence::Delays { basis: Basis::Declared, .. } => SHIPPED.into(),
        LinkEvidence::Delays { unknown, bound_s, .. } => {
            let each: Vec<String> = unknown.iter().map(|reason| known(*reason, *bound_s)).collect();
            each.join("; ")
        }
        LinkEvidence::RefutedDelay { .. } => SHIPPED.into(),
        LinkEvidence::RefutedBound(refuted) => match refuted {
            Refuted::Unbounded { steep: true, .. } => STEADY.into(),
            Refuted::Unbounded { steep: false, .. } => "an end of the formula T, such as min(T, 1)".into(),
            Refuted::Negative(_) => "max(T, 0) in the place of the formula T".into(),
            Refuted::EveryPacketLost => {
                "a `probability` of loss below 1, with `most_consecutive` losses in a row".into()
            }
        },
        LinkEvidence::Ages { bound_s: Some(bound_s), .. } => {
            format!("`message_timeout_s` of at least {}", bound(*bound_s))
        }
        LinkEvidence::Ages { bound_s: None, .. } => {
            "delays with a bound, such as by `most_consecutive`, and `message_timeout_s` above it".into()
        }
        LinkEvidence::Late { .. } => "no delays".into(),
        LinkEvidence::Weights { bounded_for_ever: true, .. } => {
            "a formula whose slope stays bounded, such as one in sines and cosines of multiples of t".into()
        }
        LinkEvidence::Weights { low, high, .. } => format!(
            "ends of the formula w, such as min(max(w, {}), {}), and a bounded slope",
            rounded_down(*low),
            rounded_up(*high)
        ),
        LinkEvidence::RefutedWeight { fault, .. } => match fault {
            WeightFault::Fades => "a floor of the formula w, such as max(w, c) with a constant c > 0".into(),
            WeightFault::Grows => {
                "an end of the formula w, such as min(w, c) with a constant c, and a bounded slope".into()
            }
            WeightFault::Negative => {
                "ends of the formula w, such as min(max(w, c), d) with constants 0 < c < d, and a bounded slope".into()
            }
        },
        LinkEvidence::VaryingWeights { lags: true, .. } => "weights that are constant".into(),
        LinkEvidence::VaryingWeights { lags: false, .. } => {
            "weights that are constant, or `design = \"composite\"`, whose torques are differentiable too".into()
        }
        LinkEvidence::Prompt | LinkEvidence::Coupling { .. } | LinkEvidence::ConstantWeights => return None,
    })
}

fn known(reason: Unknown, bound_s: f64) -> String {
    match reason {
        Unknown::FormulaSign => "max(T, 0) in the place of the formula T".into(),
        Unknown::FormulaBound => format!("an end of the formula T, such as min(T, {})", bound(bound_s)),
        Unknown::FormulaSteep | Unknown::FormulaContinuity => STEADY.into(),
        Unknown::PacketsInARow => "`most_consecutive` beside what draws the losses".into(),
        Unknown::NothingArrived => "packets that arrive before the run ends, and a bound of their losses".into(),
        Unknown::LaterHolds => "a rule, such as `delay.random_hold`, in the place of a log".into(),
        Unknown::LaterPackets => "a rule, such as `delay.packets`, in the place of a log".into(),
    }
}

fn reference(evidence: &ReferenceEvidence) -> Option<String> {
    Some(match evidence {
        ReferenceEvidence::Roots { .. } => "roots −κ with every κ above zero".into(),
        ReferenceEvidence::ComplexRoots { agent, pair } => {
            let kappa = rounded_up(libm::hypot(pair.real, pair.imaginary));
            format!("real roots for {}, such as {kappa} per second twice instead of this pair", agent.name)
        }
        ReferenceEvidence::Hurwitz { .. } => "roots with real parts below zero".into(),
        ReferenceEvidence::FirstRoots([(_, kappa), (other, _)]) => format!(
            "κ₀ = {kappa} per second, the first of its roots, for {} too, and for all who hear each other in a cycle; or \
             `exchange = \"position\"`",
            other.name
        ),
        ReferenceEvidence::FilteredDerivative { .. } => {
            "`reference.consensus` with one root, which is (aa10) and differentiates nothing".into()
        }
        ReferenceEvidence::Unstable { .. } => {
            "a polynomial whose roots have negative real parts, as `roots_per_s` states them".into()
        }
        ReferenceEvidence::NoDesign { .. } => {
            "`polynomial = { integrators = 1, roots_per_s = [...] }`, `coupling_polynomial` with the same roots and \
             no `heard`: this is (24), about which Theorem 3 speaks"
                .into()
        }
        ReferenceEvidence::Tried { found: Some(_), .. } => "a protocol whose runs converge from every state".into(),
        ReferenceEvidence::Tried { found: None, .. } => {
            "linear dynamics by their roots, of which `check` can tell".into()
        }
        ReferenceEvidence::NoDesignInThese => "`written_in = \"measured\"`".into(),
        ReferenceEvidence::Design { .. }
        | ReferenceEvidence::Stable { .. }
        | ReferenceEvidence::Order(_)
        | ReferenceEvidence::Orders(_)
        | ReferenceEvidence::FirstRootCommon
        | ReferenceEvidence::FirstRootsOverConstants
        | ReferenceEvidence::Manipulability { .. } => return None,
    })
}

fn following(evidence: &FollowingEvidence) -> Option<String> {
    Some(match evidence {
        FollowingEvidence::Gain { unbounded: true, .. } => "a leader that does not accelerate more and more".into(),
        FollowingEvidence::Gain { for_ever, .. } if for_ever.is_finite() => format!("γ above {}", bound(*for_ever)),
        FollowingEvidence::Gain { seen, .. } => format!(
            "a leader whose motion has no kinks and can be bounded for all time, and γ above that bound, which is at least {}",
            rounded_down(*seen)
        ),
        FollowingEvidence::GainOverTarget { seen, .. } => {
            format!("γ above what drives the leader, which along its target is at least {}", rounded_down(*seen))
        }
        FollowingEvidence::GainOverAgent { .. } => "a leader whose motion is given before the run".into(),
        FollowingEvidence::Sign { lags: true, choice: Choice::Implicit, .. } => {
            "velocities that are measured and torques that come at once; or, as a `design` whose sign reads no motion, \"observer\" in the place of \
             \"continuous\" and \"without_acceleration\" in that of \"differentiable\""
                .into()
        }
        FollowingEvidence::Sign { choice, sampled, period_s, rate_per_s, left, scale, end_s, .. } => match choice {
            Choice::Implicit => {
                // What is left is in proportion to the period.
                let small_s = if left.is_finite() { period_s * MOST_LEFT * scale / left } else { f64::INFINITY };
                let longest_s = (MOST_HELD / rate_per_s).min(0.5 * end_s).min(small_s);
                match sampled {
                    _ if end_s / longest_s > MOST_EVENTS => {
                        "a leader that moves further or changes its motion less, since no period that a run may have is short enough"
                            .into()
                    }
                    true => format!("`sample_hz` of at least {}", rounded_up(1.0 / longest_s)),
                    false => format!("`sign_period_s` of at most {}", rounded_down(longest_s)),
                }
            }
            Choice::Explicit | Choice::Layer { .. } => "`sign = \"implicit\"`".into(),
        },
        FollowingEvidence::NotPrinted => "one of the designs that the paper prints".into(),
        FollowingEvidence::CouplingNotShown { enough: Some(enough), .. } => {
            format!("a `coupling` of at least {}", rounded_up(*enough))
        }
        FollowingEvidence::CouplingNotShown { enough: None, .. } => {
            "edges among agents that lead both ways with the same weight, and a leader that reaches everybody over them"
                .into()
        }
        FollowingEvidence::ComplexRoots => "two real roots".into(),
        FollowingEvidence::GraphSwitches => "one graph".into(),
        FollowingEvidence::WeightVaries => "weights that are constant".into(),
        FollowingEvidence::Shared { .. } | FollowingEvidence::CouplingExceeds { .. } => return None,
    })
}

fn surroundings(evidence: &LoopEvidence) -> Option<String> {
    Some(match evidence {
        LoopEvidence::Pushes { torques_for_ever, others_for_ever, springs_for_ever, .. }
            if [torques_for_ever, others_for_ever, springs_for_ever].iter().all(|all| all.is_empty()) =>
        {
            "a push whose formula has a value at all times until it ends, or an earlier end, `for_s`".into()
        }
        LoopEvidence::Pushes { .. } => "an end of every push, `for_s`".into(),
        LoopEvidence::Applied { enforced, limited } => {
            let is_rotors = |limited: &Limited| *limited == Limited::Thrust;
            let stated = match (limited.iter().all(is_rotors), enforced.is_empty()) {
                (true, true) => None,
                (true, false) => Some("limits that are reported, without `enforce_limits`"),
                (false, true) => Some("torques as the law asks for them: no limits and no steps in `control`"),
                (false, false) => Some("no limits and no steps of torques in `control`, and no `enforce_limits`"),
            };
            let rotors = limited.iter().any(is_rotors).then_some("thrusts without ends, as `every-wrench` says");
            stated.into_iter().chain(rotors).collect::<Vec<_>>().join("; ")
        }
        LoopEvidence::Sampling { .. } => {
            "continuous control, without `control`: no rate makes the theorem speak of samples".into()
        }
        LoopEvidence::Measurements(inexact) => {
            let without = inexact.iter().map(|inexact| match inexact {
                Inexact::Noise => "measurements without `noise`",
                Inexact::Quantum => "measurements without steps, `quantisation`",
                Inexact::Filter => "velocities that are measured, not filtered from positions",
            });
            without.collect::<Vec<_>>().join("; ")
        }
        LoopEvidence::Friction { .. } => {
            "`friction.smooth`; with dry friction a smaller `width` and estimated friction keep s smaller".into()
        }
        LoopEvidence::Gains { .. } => return None,
    })
}
