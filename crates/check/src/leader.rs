//! Following a leader: Theorems 8 and 9, Remark 12.

use forwardstep_core::Gain;
use forwardstep_core::reference::Choice;
use forwardstep_sim::delay::Delay;
use forwardstep_sim::graph::laplacian;
use forwardstep_sim::leader::{Following, FollowingDesign};
use forwardstep_sim::schedule::{Schedule, Window};
use forwardstep_sim::{Adaptive, AgentSetup, Setup};

use crate::hypotheses::{external_torques, gains, seconds, unlimited_torque};
use crate::links;
use crate::sampled::digital;
use crate::verdict::{Answer, Hypothesis, Report, rounded_up};

/// Times at which a leader is looked at whose bounds could not be shown.
const LOOKS: u32 = 20_000;

/// What is promised to agents that follow a leader.
pub(crate) fn check(setup: &Setup, following: &Following) -> Report {
    let theorem = match following.design {
        FollowingDesign::Continuous => "Theorem 8, reference dynamics (110)",
        FollowingDesign::Differentiable => "Theorem 9, reference dynamics (119)",
        FollowingDesign::WithoutAcceleration => "Remark 12, reference dynamics (122)",
        FollowingDesign::Swarm { .. } => {
            "no theorem of the paper: swarm tracking (Remark 11) as derived for this software"
        }
    };
    let torque = match following.design {
        FollowingDesign::Continuous => "the torque is as smooth as the value of the sign that is chosen",
        _ => "the torque is differentiable",
    };
    let mut hypotheses =
        vec![bounded_motion(setup, following), gain(setup, following), tree(setup), fixed(setup), prompt(setup)];
    if let FollowingDesign::Swarm { coupling } = following.design {
        hypotheses.push(Hypothesis {
            requires: "the paper prints the design".into(),
            answer: Answer::NotCovered,
            because: "Remark 11 names it; what it needs was derived for this software and follows".into(),
        });
        hypotheses.push(undirected(setup));
        hypotheses.push(coupled(setup, following, coupling));
    }
    hypotheses.extend(links::bounded_weights(setup));
    hypotheses.push(sign(following, setup));
    hypotheses.extend(external_torques(setup));
    hypotheses.push(gains(setup));
    hypotheses.push(known_start(setup, following));
    hypotheses.push(unlimited_torque(setup));
    hypotheses.extend(digital(setup));
    Report {
        theorem: theorem.into(),
        promises: format!("everybody follows {}: q_i − q_0 → 0 and dq_i − dq_0 → 0; {torque}", following.leader.name),
        hypotheses,
    }
}

/// The derivatives of the leader that the theorem wants bounded.
fn bounded_motion(setup: &Setup, following: &Following) -> Hypothesis {
    let trajectory = &following.leader.trajectory;
    let bounded = |end_s: Option<f64>| {
        (0..trajectory.axes()).all(|axis| (1..=3).all(|k| trajectory.hull(axis, k, end_s).is_finite()))
    };
    let (answer, because) = if bounded(None) {
        (Answer::Holds, "they are bounded for all time".to_owned())
    } else if bounded(Some(setup.time.end_s)) {
        (Answer::HoldsOnHorizon, "they are bounded on the run; for all time that could not be shown".to_owned())
    } else {
        (Answer::NotCovered, "they could not be shown to be bounded, not even on the run".to_owned())
    };
    let requires = "the velocity, acceleration and jerk of the leader are bounded".into();
    Hypothesis { requires, answer, because }
}

/// γ against sup |ξ̇₀|∞.
fn gain(setup: &Setup, following: &Following) -> Hypothesis {
    let drive = match following.design {
        FollowingDesign::Continuous => "ddq_0 + α dq_0",
        FollowingDesign::Swarm { .. } => "dddq_0",
        _ => "dddq_0 + β ddq_0 + α dq_0",
    };
    let requires = format!("γ exceeds the largest entry of |{drive}| at any time");
    let (gamma, end_s) = (following.gain, setup.time.end_s);
    let (for_ever, on_run) = (following.drive_bound(None), following.drive_bound(Some(end_s)));
    let seen = following.leader.trajectory.sampled_peak(&following.drive(), end_s, LOOKS);
    let (answer, because) = if seen >= gamma {
        (Answer::Violated, format!("γ is {gamma}, but it reaches {} on the run", rounded_up(seen)))
    } else if for_ever < gamma {
        (Answer::Holds, format!("γ is {gamma}, and it never exceeds {}", rounded_up(for_ever)))
    } else if on_run < gamma {
        let beyond = if for_ever.is_finite() {
            format!("for all time only {} could be shown", rounded_up(for_ever))
        } else {
            "for all time no bound could be shown".to_owned()
        };
        let because =
            format!("γ is {gamma}, and it does not exceed {} until {} s; {beyond}", rounded_up(on_run), seconds(end_s));
        (Answer::HoldsOnHorizon, because)
    } else {
        let because = format!(
            "γ is {gamma}, and by sampling, which is no proof, it reaches {} on the run; no bound below γ could be shown",
            rounded_up(seen)
        );
        (Answer::NotCovered, because)
    };
    Hypothesis { requires, answer, because }
}

/// A spanning tree whose root is the leader: since the leader hears nobody, any tree has it as its root.
fn tree(setup: &Setup) -> Hypothesis {
    let network = &setup.network;
    let requires = "the leader reaches everybody: the graph contains a directed spanning tree rooted at it".into();
    let (answer, because) = match network.schedule.window(network.agents, setup.time.end_s) {
        Window::Uniform { length_s, for_all_time, .. } => {
            let answer = if for_all_time { Answer::Holds } else { Answer::HoldsOnHorizon };
            let how = if length_s == 0.0 {
                "along the edges of the graph".to_owned()
            } else {
                format!("within every {} s along the edges of the graphs in force", seconds(length_s))
            };
            (answer, how)
        }
        Window::Missing { start_s, closed_groups } => {
            let leader = setup.agents.len();
            let cut = closed_groups.iter().find(|group| !group.contains(&leader));
            let names: Vec<&str> = cut.into_iter().flatten().take(6).map(|vertex| setup.vertex_name(*vertex)).collect();
            let when = seconds(start_s);
            (Answer::Violated, format!("from t = {when} s on nothing of the leader reaches [{}]", names.join(", ")))
        }
    };
    Hypothesis { requires, answer, because }
}

/// The edges among agents, without those from the leader.
fn undirected(setup: &Setup) -> Hypothesis {
    let agents = setup.agents.len();
    let requires = "agents hear each other with the same weight".into();
    for graph in setup.network.schedule.graphs() {
        for edge in graph.iter().filter(|edge| edge.from < agents && edge.to < agents) {
            if !graph.iter().any(|back| back.from == edge.to && back.to == edge.from && back.weight == edge.weight) {
                let [from, to] = [edge.from, edge.to].map(|vertex| setup.vertex_name(vertex));
                let because = format!("{to} hears {from}, but not the other way round with the same weight");
                return Hypothesis { requires, answer: Answer::NotCovered, because };
            }
        }
    }
    Hypothesis { requires, answer: Answer::Holds, because: "every edge among them leads both ways".into() }
}

/// k λ against what the derivation asks for: L − λ* is positive definite exactly if λ > λ*.
fn coupled(setup: &Setup, following: &Following, coupling: f64) -> Hypothesis {
    let requires = "k λ > β + κ₀⁴/(2 (β² − α) κ₁), λ the smallest eigenvalue of the followers' Laplacian".to_owned();
    let (alpha, beta) = (following.alpha, following.beta);
    let root = beta * beta - 4.0 * alpha;
    let not = |because: &str| Hypothesis {
        requires: requires.clone(),
        answer: Answer::NotCovered,
        because: because.to_owned(),
    };
    if root < -1e-12 * beta * beta {
        return not("p² + β p + α has no real roots");
    }
    let kappa = 0.5 * (beta - root.max(0.0).sqrt());
    let least = beta + kappa * kappa * kappa * kappa / (2.0 * (beta * beta - alpha) * (beta - kappa));
    let n = setup.agents.len();
    let Schedule::Fixed(edges) = &setup.network.schedule else { return not("the graph switches") };
    let Some(all) = laplacian(setup.network.agents, edges) else { return not("a weight varies with time") };
    let mut shifted = Vec::with_capacity(n * n);
    for row in 0..n {
        for column in 0..n {
            let shift = if row == column { least / coupling } else { 0.0 };
            shifted.push(all[row * setup.network.agents + column] - shift);
        }
    }
    match Gain::Matrix(shifted).resolve(n, &[]) {
        Ok(_) => Hypothesis { requires, answer: Answer::Holds, because: format!("k λ exceeds {}", rounded_up(least)) },
        Err(_) => not(&format!(
            "k λ could not be shown to exceed {}: a larger coupling or larger weights would",
            rounded_up(least)
        )),
    }
}

fn fixed(setup: &Setup) -> Hypothesis {
    let requires = "the graph is fixed".into();
    match &setup.network.schedule {
        Schedule::Fixed(_) => Hypothesis { requires, answer: Answer::Holds, because: "one graph for all time".into() },
        _ => Hypothesis {
            requires,
            answer: Answer::NotCovered,
            because: "the graph switches; the paper follows a leader over fixed graphs only".into(),
        },
    }
}

fn prompt(setup: &Setup) -> Hypothesis {
    let requires = "messages arrive without delay".into();
    let delays = || setup.network.used_delays().filter_map(|index| setup.network.delays.get(index));
    let longest_s = delays().map(Delay::max_s).fold(0.0, f64::max);
    if longest_s > 0.0 {
        let because =
            format!("a delay reaches {} s; the paper follows a leader without delays only", seconds(longest_s));
        Hypothesis { requires, answer: Answer::NotCovered, because }
    } else {
        Hypothesis { requires, answer: Answer::Holds, because: "no link has a delay".into() }
    }
}

fn sign(following: &Following, setup: &Setup) -> Hypothesis {
    let requires = "the sign is the set-valued sgn".into();
    let every = match &setup.control {
        None => format!("every {} s", seconds(following.period_s)),
        Some(_) => "at every sample".to_owned(),
    };
    let (answer, because) = match following.choice {
        Choice::Implicit => (Answer::Holds, format!("a value of it is solved for {every}")),
        Choice::Explicit => (Answer::NotCovered, format!("it is set to 1 or −1 {every}, and chatters at that rate")),
        Choice::Layer { width } => {
            (Answer::NotCovered, format!("it is replaced by sat(e/ε) with ε = {width}: an error of that size stays"))
        }
    };
    Hypothesis { requires, answer, because }
}

/// α and β are common by what a scenario can say; what is slow is said here.
fn known_start(setup: &Setup, following: &Following) -> Hypothesis {
    let zero = |agent: &AgentSetup| {
        agent.law.downcast().is_some_and(|law: &Adaptive| law.estimate_start.iter().all(|x| *x == 0.0))
    };
    let slow = following.design == FollowingDesign::Differentiable && setup.agents.iter().any(|agent| zero(agent));
    let because = if slow {
        "they belong to the design, not to an agent; note that (119) converges very slowly from an estimate of zero, since \
         its sign sees accelerations, which the estimated inertia scales"
    } else {
        "they belong to the design, not to an agent"
    };
    Hypothesis { requires: "all agents share α, β and γ".into(), answer: Answer::Holds, because: because.into() }
}
