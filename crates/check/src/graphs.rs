//! What is found of graphs and their schedule.

use std::collections::{BTreeSet, HashMap};

use forwardstep_sim::Setup;
use forwardstep_sim::graph::{Edge, SpanningTree, Weight, spanning_tree as tree};
use forwardstep_sim::leader::Following;
use forwardstep_sim::schedule::{Dwell, Extent, KnownSwitching, Schedule, Window};

use crate::hypothesis::{GraphEvidence, Hypothesis, Id, Named};
use crate::links::varying_weights;

/// What refutes the author of a switching signal from outside.
fn refuted(setup: &Setup) -> Option<GraphEvidence> {
    let schedule = &setup.network.schedule;
    let fault = schedule.probe(setup.time.end_s).err()?;
    Some(GraphEvidence::RefutedSwitching { words: schedule.words(), fault })
}

fn once(setup: &Setup, wait_s: f64, start_s: f64) -> GraphEvidence {
    GraphEvidence::Once { wait_s, start_s, end_s: setup.time.end_s }
}

/// The smallest uniform window, or the groups that cut the network.
pub(crate) fn spanning_tree(setup: &Setup) -> Hypothesis {
    if let Some(evidence) = refuted(setup) {
        return Hypothesis::new(Id::SpanningTree, evidence);
    }
    let network = &setup.network;
    let evidence = match network.schedule.window(network.agents, setup.time.end_s) {
        Window::Uniform { length_s, worst_start_s, roots, for_all_time } => GraphEvidence::Window {
            length_s,
            worst_start_s,
            roots: Named::all(setup, &roots),
            for_all_time,
            drawn: network.schedule.known().extent == Extent::Drawn,
        },
        Window::Once { wait_s, start_s } => once(setup, wait_s, start_s),
        Window::EveryGraph => GraphEvidence::EveryGraph { graphs: network.schedule.graphs.len() },
        Window::Missing { start_s, for_ever, closed_groups } => GraphEvidence::Cut {
            start_s,
            until_s: (!for_ever).then_some(setup.time.end_s),
            closed_groups: closed_groups.iter().map(|group| Named::all(setup, group)).collect(),
        },
    };
    Hypothesis::new(Id::SpanningTree, evidence)
}

/// A spanning tree whose root is the leader: since no edge leads to the leader, any tree has it as its root.
pub(crate) fn leader_reaches_all(setup: &Setup) -> Hypothesis {
    if let Some(evidence) = refuted(setup) {
        return Hypothesis::new(Id::LeaderReachesAll, evidence);
    }
    let network = &setup.network;
    let evidence = match network.schedule.window(network.agents, setup.time.end_s) {
        Window::Uniform { length_s, for_all_time, .. } => GraphEvidence::Reached { length_s, for_all_time },
        Window::Once { wait_s, start_s } => once(setup, wait_s, start_s),
        Window::EveryGraph => GraphEvidence::Reached { length_s: 0.0, for_all_time: true },
        Window::Missing { start_s, for_ever, closed_groups } => {
            let until_s = (!for_ever).then_some(setup.time.end_s);
            let cut = closed_groups.iter().find(|group| setup.leader().is_none_or(|leader| !group.contains(&leader)));
            let closed_group = cut.map_or_else(Vec::new, |group| Named::all(setup, group));
            GraphEvidence::Unreached { start_s, until_s, closed_group }
        }
    };
    Hypothesis::new(Id::LeaderReachesAll, evidence)
}

/// The same of each graph by itself: what is heard now and then is not enough where a sign takes neighbours together in the meantime.
pub(crate) fn leader_in_every_graph(setup: &Setup) -> Hypothesis {
    if let Some(evidence) = refuted(setup) {
        return Hypothesis::new(Id::LeaderInEveryGraph, evidence);
    }
    let network = &setup.network;
    let for_all_time = network.schedule.known().extent != Extent::Horizon;
    let graphs = network.schedule.recurring_graphs();
    let before = network.schedule.graphs.len() - graphs.len();
    let unheard = graphs.iter().enumerate().find_map(|(at, graph)| match tree(network.agents, graph) {
        SpanningTree::Rooted { .. } => None,
        SpanningTree::Missing { closed_groups } => {
            let cut = closed_groups.iter().find(|group| setup.leader().is_none_or(|leader| !group.contains(&leader)));
            let closed_group = cut.map_or_else(Vec::new, |group| Named::all(setup, group));
            Some(GraphEvidence::Unheard { phase: before + at + 1, closed_group, for_all_time })
        }
    });
    let evidence = unheard.unwrap_or(GraphEvidence::InEveryGraph { graphs: graphs.len(), for_all_time });
    Hypothesis::new(Id::LeaderInEveryGraph, evidence)
}

/// The shortest time for which a graph stays.
pub(crate) fn dwell_time(setup: &Setup) -> Hypothesis {
    let schedule = &setup.network.schedule;
    if schedule.constant_graph().is_some() {
        let evidence = refuted(setup).unwrap_or(GraphEvidence::NeverSwitches);
        return Hypothesis::new(Id::DwellTime, evidence);
    }
    let KnownSwitching { extent, dwell } = schedule.known();
    let evidence = match dwell {
        Dwell::NeverSwitches if extent == Extent::Horizon => GraphEvidence::LoggedPhases { dwell_s: None },
        Dwell::Shortest(dwell_s) if extent == Extent::Horizon => GraphEvidence::LoggedPhases { dwell_s: Some(dwell_s) },
        Dwell::NeverSwitches => GraphEvidence::NeverSwitches,
        Dwell::Shortest(dwell_s) => GraphEvidence::ShortestPhase { dwell_s },
        Dwell::Drawn(least_s) => GraphEvidence::DrawnPhases { least_s },
        Dwell::Declared(least_s) => refuted(setup).unwrap_or(GraphEvidence::DeclaredPhases { least_s }),
    };
    Hypothesis::new(Id::DwellTime, evidence)
}

/// Whether w_ij(t) never changes, as what (3) and (23) integrate asks for; delays may.
pub(crate) fn laplacian_stays(setup: &Setup) -> bool {
    let schedule = &setup.network.schedule;
    let one_graph = schedule.constant_graph().is_some() || only_delays_change(schedule);
    one_graph && varying_weights(setup).next().is_none()
}

/// Whether one graph stays for ever, as the reference dynamics that contain accelerations need. It may hear by other delays after a while.
pub(crate) fn fixed_graph(setup: &Setup) -> Hypothesis {
    let schedule = &setup.network.schedule;
    let stays = schedule.constant_graph().is_some();
    let evidence = match setup.following() {
        Some(_) if stays => GraphEvidence::Stays,
        Some(Following { design, .. }) => GraphEvidence::SwitchesUnderLeader { design: *design },
        // Delays may jump under (3) and (23), whenever that is.
        None if !(stays || only_delays_change(schedule)) => {
            GraphEvidence::Switches { graphs: schedule.graphs.len(), exchange: setup.exchange }
        }
        None if varying_weights(setup).next().is_some() => GraphEvidence::VaryingWeight,
        None => GraphEvidence::Stays,
    };
    Hypothesis::new(Id::FixedGraph, evidence)
}

/// Whether all graphs have the same edges with the same weights.
fn only_delays_change(schedule: &Schedule) -> bool {
    let undelayed = |graph: &Vec<Edge>| {
        let mut edges: Vec<Edge> = graph.iter().map(|edge| Edge { delay: 0, ..*edge }).collect();
        edges.sort_by_key(|edge| (edge.to, edge.from));
        edges
    };
    let mut all = schedule.graphs.iter().map(undelayed);
    all.next().is_some_and(|first| all.all(|other| other == first))
}

/// The edges among agents, without those from the leader.
pub(crate) fn mutual_weights(setup: &Setup) -> Hypothesis {
    let leader = setup.leader();
    let among = |edge: &&Edge| Some(edge.from) != leader;
    let one_way = setup.network.schedule.graphs.iter().flat_map(|graph| {
        let weights: HashMap<(usize, usize), Weight> =
            graph.iter().map(|edge| ((edge.from, edge.to), edge.weight)).collect();
        let returned = move |edge: &&Edge| weights.get(&(edge.to, edge.from)) == Some(&edge.weight);
        graph.iter().filter(among).filter(move |edge| !returned(edge))
    });
    let edges: BTreeSet<(usize, usize)> = one_way.map(|edge| (edge.from, edge.to)).collect();
    let named = |(from, to)| [Named::of(setup, from), Named::of(setup, to)];
    let evidence = if edges.is_empty() {
        GraphEvidence::Mutual
    } else {
        GraphEvidence::OneWay { edges: edges.into_iter().map(named).collect() }
    };
    Hypothesis::new(Id::MutualWeights, evidence)
}
