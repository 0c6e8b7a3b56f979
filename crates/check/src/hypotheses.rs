//! The hypotheses of Theorems 1 to 3, one function each.

use forwardstep_sim::graph::{Edge, strong_components};
use forwardstep_sim::push::Push;
use forwardstep_sim::schedule::{Schedule, Window};
use forwardstep_sim::{ChainLaw, Exchange, Known, ReferenceKind, Setup};

use crate::laws;
use crate::leader;
use crate::links;
use crate::sampled::{digital, limited_actuators};
use crate::tracking::{self, bounded_targets, is_tracking};
use crate::verdict::{Answer, Hypothesis, Report};

/// Which theorem speaks about `setup`, and whether its hypotheses hold.
///
/// `setup` should be one that [`forwardstep_sim::simulate`] accepts; what makes a setup meaningless is not looked at again.
///
/// **Source**: Theorem 1 for (3), Remark 3 for (23), Theorem 2 for (a1), Theorem 3 for (a5) and (24); Section III-A for
/// (aa10), which is (a5) of order one, and for the baseline (aa6), about which the paper promises nothing.
pub fn check(setup: &Setup) -> Report {
    if is_tracking(setup) {
        return tracking::check(setup);
    }
    if let Some(following) = setup.following() {
        return leader::check(setup, following);
    }
    let order = setup.agents.iter().map(|agent| agent.roots_per_s.len()).max().unwrap_or(0);
    let mut hypotheses = vec![spanning_tree(setup), dwell_time(setup), links::bounded_delays(setup)];
    hypotheses.extend(links::bounded_weights(setup));
    hypotheses.extend(links::coupling(setup));
    match &setup.reference {
        // Chains of different orders agree: nothing in the argument for (24) compares orders.
        ReferenceKind::Consensus if setup.agents.iter().all(|agent| agent.law.is::<ChainLaw>()) => {
            hypotheses.push(real_roots(setup));
        }
        ReferenceKind::Consensus => hypotheses.extend([real_roots(setup), common_order(setup)]),
        ReferenceKind::PureIntegral => hypotheses.extend([fixed_graph(setup), real_roots(setup)]),
        ReferenceKind::Backstepping { filter_s, .. } => hypotheses.push(differentiable(*filter_s)),
        ReferenceKind::Tracking | ReferenceKind::Following(_) => {}
    }
    hypotheses.extend(manipulability(setup));
    hypotheses.extend(external_torques(setup));
    if setup.exchange == Exchange::PositionVelocity {
        hypotheses.push(common_first_root(setup));
    }
    hypotheses.extend(bounded_targets(setup));
    hypotheses.extend(laws::of_laws(setup));
    if setup.agents.iter().any(|agent| laws::is_lagrangian(agent)) {
        hypotheses.push(gains(setup));
    }
    hypotheses.push(unlimited_torque(setup));
    hypotheses.extend(digital(setup));
    let (theorem, promises) = laws::theorem(setup).unwrap_or_else(|| (theorem(setup, order), promises(setup, order)));
    Report { theorem, promises, hypotheses }
}

fn theorem(setup: &Setup, order: usize) -> String {
    match (&setup.reference, setup.exchange) {
        (ReferenceKind::PureIntegral, Exchange::PositionVelocity) => return "Theorem 1, reference dynamics (3)".into(),
        (ReferenceKind::PureIntegral, Exchange::Position) => return "Remark 3, reference dynamics (23)".into(),
        (ReferenceKind::Backstepping { .. }, _) => return "no theorem: the backstepping baseline (aa6)".into(),
        (ReferenceKind::Consensus | ReferenceKind::Tracking | ReferenceKind::Following(_), _) => {}
    }
    match (setup.exchange, order) {
        (Exchange::PositionVelocity, 1) => "Theorem 3 with (a5) of order 1, which is (aa10)".into(),
        (Exchange::PositionVelocity, 2) if same_roots(setup) => "Theorem 2, reference dynamics (a1)".into(),
        (Exchange::PositionVelocity, order) => format!("Theorem 3, reference dynamics (a5) of order {order}"),
        (Exchange::Position, order) => format!("Theorem 3, reference dynamics (24) of order {order}"),
    }
}

fn promises(setup: &Setup, order: usize) -> String {
    if matches!(setup.reference, ReferenceKind::Backstepping { .. }) {
        return "nothing: the torque is unbounded at switches and delay jumps but for the filter and its limit".into();
    }
    let smooth = match order {
        0 | 1 => "the torque jumps at switches and delay jumps but stays bounded".to_owned(),
        2 => "the torque stays continuous through switches and delay jumps".to_owned(),
        3 => "the torque stays once continuously differentiable through switches and delay jumps".to_owned(),
        order => {
            format!("the torque stays {} times continuously differentiable through switches and delay jumps", order - 2)
        }
    };
    let agents = if setup.agents.len() == 1 { "the agent comes to rest" } else { "all agents agree and come to rest" };
    format!("{agents}: q_i − q_j → 0 and dq_i → 0; {smooth}")
}

fn same_roots(setup: &Setup) -> bool {
    setup.agents.windows(2).all(|pair| pair[0].roots_per_s == pair[1].roots_per_s)
}

/// Names of agents for a sentence; long lists are cut.
pub(crate) fn names(setup: &Setup, agents: &[usize]) -> String {
    const SHOWN: usize = 6;
    let shown: Vec<&str> = agents.iter().take(SHOWN).map(|agent| setup.agents[*agent].name.as_str()).collect();
    let rest = agents.len().saturating_sub(SHOWN);
    if rest > 0 { format!("{} and {rest} more", shown.join(", ")) } else { shown.join(", ") }
}

/// A time without the digits that rounding left behind.
pub(crate) fn seconds(t_s: f64) -> f64 {
    (t_s * 1e6).round() / 1e6
}

fn spanning_tree(setup: &Setup) -> Hypothesis {
    let network = &setup.network;
    let requires = "the union of the graphs over uniformly bounded windows contains a directed spanning tree".into();
    let (answer, because) = match network.schedule.window(network.agents, setup.time.end_s) {
        Window::Uniform { length_s: 0.0, roots, for_all_time, .. } => (
            if for_all_time { Answer::Holds } else { Answer::HoldsOnHorizon },
            format!("one graph stays for ever and has a tree rooted at {}", names(setup, &roots)),
        ),
        Window::Uniform { length_s, worst_start_s, roots, for_all_time } => (
            if for_all_time { Answer::Holds } else { Answer::HoldsOnHorizon },
            format!(
                "the smallest uniform window lasts {} s (needed from t = {} s, rooted at {})",
                seconds(length_s),
                seconds(worst_start_s),
                names(setup, &roots)
            ),
        ),
        Window::Missing { start_s, closed_groups } => {
            let groups: Vec<String> =
                closed_groups.iter().take(3).map(|group| format!("[{}]", names(setup, group))).collect();
            let more =
                if closed_groups.len() > 3 { format!(" and {} more", closed_groups.len() - 3) } else { String::new() };
            // What random switching has not shown by the end of the run it may show later.
            let span = if matches!(network.schedule, Schedule::Random { .. }) {
                format!("from t = {} s to the end of the run at {} s", seconds(start_s), seconds(setup.time.end_s))
            } else {
                format!("from t = {} s on, whatever the window", seconds(start_s))
            };
            let groups = groups.join(" and ");
            (
                Answer::Violated,
                format!("{span}, no agent reaches all others: {groups}{more} hear nobody outside themselves"),
            )
        }
    };
    Hypothesis { requires, answer, because }
}

fn dwell_time(setup: &Setup) -> Hypothesis {
    let requires = "graphs stay for at least some positive dwell time".into();
    let because = match &setup.network.schedule {
        Schedule::Fixed(_) => "the graph never switches".into(),
        Schedule::Periodic(phases) => {
            format!("the shortest phase lasts {} s", phases.iter().map(|p| p.dwell_s).fold(f64::INFINITY, f64::min))
        }
        Schedule::Once(phases) if phases.len() == 1 => "the graph never switches".into(),
        Schedule::Once(phases) => {
            let phases = &phases[..phases.len() - 1];
            format!("the shortest phase lasts {} s", phases.iter().map(|p| p.dwell_s).fold(f64::INFINITY, f64::min))
        }
        Schedule::Random { dwell_s: [low, _], .. } => format!("no phase is shorter than {low} s"),
    };
    Hypothesis { requires, answer: Answer::Holds, because }
}

fn fixed_graph(setup: &Setup) -> Hypothesis {
    let requires = "the graph is fixed".into();
    let graphs = setup.network.schedule.graphs();
    let (answer, because) = match graphs.len() {
        1 if links::varying_weights(setup).next().is_some() => (
            Answer::NotCovered,
            "a weight changes with time: the torque that follows from it is not the one proved".to_owned(),
        ),
        1 => (Answer::Holds, "one graph stays for ever".to_owned()),
        graphs => {
            let instead = match setup.exchange {
                Exchange::PositionVelocity => "(a1), which is `reference.consensus` of order two",
                Exchange::Position => "(24), which is `reference.consensus`",
            };
            let because = format!(
                "{graphs} graphs take turns: the reference acceleration, and the torque with it, jumps at every switch; \
                 {instead}, is made for that"
            );
            (Answer::NotCovered, because)
        }
    };
    Hypothesis { requires, answer, because }
}

fn differentiable(filter_s: f64) -> Hypothesis {
    Hypothesis {
        requires: "what is heard has a derivative that can be measured".into(),
        answer: Answer::NotCovered,
        because: format!("it is estimated by a filter with the time constant {filter_s} s"),
    }
}

fn manipulability(setup: &Setup) -> Option<Hypothesis> {
    let largest = setup.agents.iter().map(|agent| agent.manipulability).fold(0.0, f64::max);
    (largest > 0.0).then(|| Hypothesis {
        requires: "the manipulability gain λ of Remark 4 is positive".into(),
        answer: Answer::Holds,
        because: format!("the largest λ is {largest}; tracking errors move the value agreed upon"),
    })
}

/// τ_ext feeds V by sᵀτ_ext. What ends leaves V finite, and from then on everything is as without it.
pub(crate) fn external_torques(setup: &Setup) -> Option<Hypothesis> {
    let acts = |push: &&Push| {
        let [begins_s, ends_s] = push.span_s();
        begins_s < ends_s
    };
    let pushed = |some: fn(&Push) -> bool| -> Vec<usize> {
        let agents = setup.agents.iter().enumerate();
        agents.filter(|(_, agent)| agent.pushes.iter().filter(acts).any(some)).map(|(index, _)| index).collect()
    };
    let all = pushed(|_| true);
    if all.is_empty() {
        return None;
    }
    let torques = pushed(|push| endless(push) && !push.is_hand());
    let hands = pushed(|push| endless(push) && push.is_hand());
    let requires = "external torques end, so that s is square-integrable all the same".into();
    let mut because = Vec::new();
    if !torques.is_empty() {
        because.push(format!(
            "{} pushed for ever: s does not vanish but, where parameters are known and the push settles, comes to rest at \
             K s = tau_ext",
            is_or_are(setup, &torques)
        ));
    }
    if !hands.is_empty() {
        because.push(format!(
            "a hand never lets go of {}: while its target stands still it takes energy out of the motion, but the proof counts \
             the power of torques with s and not with dq",
            names(setup, &hands)
        ));
    }
    let answer = if because.is_empty() { Answer::Holds } else { Answer::NotCovered };
    if because.is_empty() {
        let pushes = setup.agents.iter().flat_map(|agent| &agent.pushes).filter(acts);
        let last_s = pushes.map(|push| push.span_s()[1]).fold(0.0, f64::max);
        because.push(format!("{} pushed, and the last push ends at t = {} s", is_or_are(setup, &all), seconds(last_s)));
    }
    Some(Hypothesis { requires, answer, because: because.join("; ") })
}

fn endless(push: &Push) -> bool {
    push.span_s()[1] == f64::INFINITY
}

/// "a is", "a, b are".
fn is_or_are(setup: &Setup, agents: &[usize]) -> String {
    format!("{} {}", names(setup, agents), if agents.len() == 1 { "is" } else { "are" })
}

fn real_roots(setup: &Setup) -> Hypothesis {
    let smallest = setup.agents.iter().flat_map(|agent| &agent.roots_per_s).copied().fold(f64::INFINITY, f64::min);
    Hypothesis {
        requires: "the polynomial (25) is Hurwitz with real roots".into(),
        answer: if smallest > 0.0 { Answer::Holds } else { Answer::Violated },
        because: format!("roots −κ were given; the smallest κ is {smallest} per second"),
    }
}

fn common_order(setup: &Setup) -> Hypothesis {
    let requires = "all agents have reference dynamics of the same order".into();
    let order = |agent: usize| setup.agents[agent].roots_per_s.len();
    match (1..setup.agents.len()).find(|agent| order(*agent) != order(0)) {
        None => Hypothesis { requires, answer: Answer::Holds, because: format!("the order is {}", order(0)) },
        Some(other) => Hypothesis {
            requires,
            answer: Answer::NotCovered,
            because: format!(
                "{} has order {} and {} has order {}",
                setup.agents[0].name,
                order(0),
                setup.agents[other].name,
                order(other)
            ),
        },
    }
}

/// The condition that the paper's Theorem 3 leaves out for (a5), of which (aa10) and (a1) are members.
///
/// What agent i hears is α₀[(κ₀ⱼ/κ₀ᵢ) ψ_j + (1 − κ₀ⱼ/κ₀ᵢ) q_j]: a weighting that is only convex when κ₀ⱼ ≤ κ₀ᵢ along j → i.
/// Around a cycle that means equality. With a fixed graph and constant delays p + κ₀ᵢ factors out and nothing is needed.
fn common_first_root(setup: &Setup) -> Hypothesis {
    let requires =
        "κ₀ is common within each strongly connected component of the union graph, unless graph and delays are constant".into();
    let graphs = setup.network.schedule.graphs();
    let constant_delays = setup.network.used_delays().all(|index| setup.network.delays[index].is_constant());
    let first_root = |agent: usize| setup.agents[agent].roots_per_s.first().copied().unwrap_or(f64::NAN);
    let edges: Vec<(usize, usize)> = graphs.iter().copied().flatten().map(|edge: &Edge| (edge.from, edge.to)).collect();
    let witness = strong_components(setup.network.agents, &edges).into_iter().find_map(|component| {
        let first = component[0];
        component.into_iter().find(|agent| first_root(*agent) != first_root(first)).map(|other| (first, other))
    });
    let (answer, because) = match witness {
        None => (Answer::Holds, "κ₀ is common wherever agents hear each other in a cycle".to_owned()),
        Some(_) if graphs.len() == 1 && constant_delays && links::varying_weights(setup).next().is_none() => {
            (Answer::Holds, "κ₀ differs, but the graph and the delays are constant".to_owned())
        }
        Some((a, b)) => (
            Answer::NotCovered,
            format!(
                "{} has κ₀ = {} and {} has κ₀ = {} per second, and each reaches the other; such networks can diverge. \
                 Give them one κ₀, or exchange positions only: (24) has no such condition",
                setup.agents[a].name,
                first_root(a),
                setup.agents[b].name,
                first_root(b)
            ),
        ),
    };
    Hypothesis { requires, answer, because }
}

pub(crate) fn gains(setup: &Setup) -> Hypothesis {
    let known = setup.agents.iter().filter(|agent| agent.law.is::<Known>()).count();
    let parameters = match known {
        0 => "parameters are adapted".to_owned(),
        known if known == setup.agents.len() => "parameters are known".to_owned(),
        known => format!("parameters are known to {known} of {} agents and adapted by the others", setup.agents.len()),
    };
    Hypothesis {
        requires: "K and Γ are symmetric positive definite".into(),
        answer: Answer::Holds,
        because: format!("checked when the gains were read; {parameters}"),
    }
}

pub(crate) fn unlimited_torque(setup: &Setup) -> Hypothesis {
    let limited: Vec<usize> = (0..setup.agents.len()).filter(|agent| setup.agents[*agent].enforce_limits).collect();
    let mut reasons: Vec<String> = limited_actuators(setup).into_iter().map(str::to_owned).collect();
    if !limited.is_empty() {
        reasons.push(format!("limits are enforced on {}", names(setup, &limited)));
    }
    let (answer, because) = if reasons.is_empty() {
        (Answer::Holds, "limits are reported, not enforced".to_owned())
    } else {
        (Answer::NotCovered, reasons.join(", "))
    };
    Hypothesis { requires: "the torque that the law asks for is applied".into(), answer, because }
}
