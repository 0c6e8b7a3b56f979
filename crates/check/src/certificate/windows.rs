//! Windows of whole phases with spanning trees, and groups that cut a network.

use std::collections::{HashMap, VecDeque};

use forwardstep_core::expression::Number;
use forwardstep_sim::Setup;
use forwardstep_sim::graph::{SpanningTree, spanning_tree as tree};
use forwardstep_sim::schedule::{Dwell, Extent, Logged, Schedule};
use num_rational::BigRational;
use num_traits::Zero;

use super::producers::Claim;
use super::proof::{DrawnPhase, Proof, TreeWindow};
use crate::{Answer, Id};

/// Phases of a drawn sequence that a certificate holds.
const MOST_DRAWN: usize = 50_000;
/// Phases of a period up to which the windows are as short as they can be; beyond it one window is the whole period.
const MOST_PHASES: usize = 2000;

pub(super) fn spanning_tree(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    let schedule = &setup.network.schedule;
    if claim.answer == Answer::HoldsOnHorizon {
        return along(setup);
    }
    let recurring = recurring(schedule)?;
    match claim.answer {
        Answer::Holds if claim.id == Id::SpanningTree && drawn(schedule) => every_phase(setup, &recurring),
        Answer::Holds => Some(Proof::Windows(tiles(setup, &recurring)?)),
        Answer::Violated => cut(setup, &recurring, claim.id),
        Answer::HoldsOnHorizon | Answer::Watched | Answer::NotShown | Answer::NotCovered => None,
    }
}

/// The phases that are in force again and again, or for ever; nothing where those of a run tell nothing about later ones.
fn recurring(schedule: &Schedule) -> Option<Vec<usize>> {
    match schedule.known().extent {
        Extent::Whole => Some(vec![schedule.graphs.len().checked_sub(1)?]),
        Extent::Period(_) | Extent::Drawn => Some((0..schedule.graphs.len()).collect()),
        Extent::Horizon => None,
    }
}

fn drawn(schedule: &Schedule) -> bool {
    schedule.graphs.len() > 1 && schedule.known().extent == Extent::Drawn
}

/// Windows along `phases`, each as short as it can be but the last, which takes what is left.
fn tiles(setup: &Setup, phases: &[usize]) -> Option<Vec<TreeWindow>> {
    let step = if phases.len() > MOST_PHASES { phases.len() } else { 1 };
    let (mut found, mut from): (Vec<TreeWindow>, usize) = (Vec::new(), 0);
    let mut to = 0;
    while to < phases.len() {
        to = (to + step).min(phases.len());
        if let Some(window) = window(setup, phases.get(from..to)?) {
            found.push(window);
            from = to;
        }
    }
    if from < to {
        let start = match found.pop() {
            Some(last) => from - last.phases.len(),
            None => from,
        };
        found.push(window(setup, phases.get(start..)?)?);
    }
    Some(found)
}

/// A spanning tree of the union of some phases, found breadth first.
fn window(setup: &Setup, phases: &[usize]) -> Option<TreeWindow> {
    let (schedule, vertices) = (&setup.network.schedule, setup.network.agents);
    let edges = || phases.iter().flat_map(|phase| schedule.graph(*phase).iter().map(|edge| (*phase, edge)));
    let SpanningTree::Rooted { roots } = tree(vertices, edges().map(|(_, edge)| edge)) else { return None };
    let root = *roots.first()?;
    let mut heard_by: HashMap<usize, Vec<(usize, usize)>> = HashMap::new();
    for (phase, edge) in edges() {
        heard_by.entry(edge.from).or_default().push((edge.to, phase));
    }
    let mut reached = vec![false; vertices];
    *reached.get_mut(root)? = true;
    let (mut queue, mut arborescence) = (VecDeque::from([root]), Vec::with_capacity(vertices));
    while let Some(from) = queue.pop_front() {
        for (to, phase) in heard_by.remove(&from).unwrap_or_default() {
            let known = reached.get_mut(to)?;
            if !*known {
                *known = true;
                arborescence.push((from, to, phase));
                queue.push_back(to);
            }
        }
    }
    Some(TreeWindow { phases: phases.to_vec(), root, arborescence })
}

fn every_phase(setup: &Setup, phases: &[usize]) -> Option<Proof> {
    phases.iter().map(|phase| window(setup, &[*phase])).collect::<Option<_>>().map(Proof::EveryPhase)
}

/// A tree of each graph that recurs, or the group that one of them cuts off.
pub(super) fn in_every_graph(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    let recurring = recurring(&setup.network.schedule)?;
    match claim.answer {
        Answer::Holds => every_phase(setup, &recurring),
        Answer::Violated => {
            let cut_off = |phase: usize| match tree(setup.network.agents, setup.network.schedule.graph(phase)) {
                SpanningTree::Missing { closed_groups } => without_leader(setup, closed_groups),
                SpanningTree::Rooted { .. } => None,
            };
            recurring.into_iter().find_map(|phase| Some(Proof::Unheard { phase, group: cut_off(phase)? }))
        }
        Answer::HoldsOnHorizon | Answer::Watched | Answer::NotShown | Answer::NotCovered => None,
    }
}

/// Windows along the sequence that was drawn, which is given, or that of a log, until no further one is complete.
fn along(setup: &Setup) -> Option<Proof> {
    let (schedule, end_s) = (&setup.network.schedule, setup.time.end_s);
    let logged = schedule.downcast::<Logged>().is_some();
    if !drawn(schedule) && !logged {
        return None;
    }
    let segments: Vec<_> =
        schedule.segments().take_while(|segment| segment.start_s < end_s).take(MOST_DRAWN + 1).collect();
    if segments.len() > MOST_DRAWN {
        return None;
    }
    let given = segments
        .iter()
        .map(|segment| DrawnPhase { phase: segment.graph, until_s: Number::written(segment.end_s) })
        .collect();
    let phases: Vec<usize> = segments.iter().map(|segment| segment.graph).collect();
    let times: Vec<BigRational> =
        std::iter::once(0.0).chain(segments.iter().map(|s| s.end_s)).map(Number::written).collect();
    let (mut windows, mut from, mut longest_s) = (Vec::new(), 0, BigRational::zero());
    for to in 1..=phases.len() {
        if let Some(window) = window(setup, phases.get(from..to)?) {
            windows.push(window);
            longest_s = longest_s.max(times.get(to)? - times.get(from)?);
            from = to;
        }
    }
    longest_s = longest_s.max(Number::written(end_s) - times.get(from)?);
    if windows.is_empty() {
        return None;
    }
    Some(if logged { Proof::Logged { windows, longest_s } } else { Proof::Drawn { given, windows, longest_s } })
}

/// The closed groups of the union of all that recurs.
fn cut(setup: &Setup, phases: &[usize], id: Id) -> Option<Proof> {
    let schedule = &setup.network.schedule;
    let edges = phases.iter().flat_map(|phase| schedule.graph(*phase));
    let SpanningTree::Missing { closed_groups } = tree(setup.network.agents, edges) else { return None };
    if id == Id::SpanningTree {
        return Some(Proof::Cut(closed_groups));
    }
    without_leader(setup, closed_groups).map(|group| Proof::Cut(vec![group]))
}

fn without_leader(setup: &Setup, closed_groups: Vec<Vec<usize>>) -> Option<Vec<usize>> {
    closed_groups.into_iter().find(|group| setup.leader().is_none_or(|leader| !group.contains(&leader)))
}

pub(super) fn dwell_time(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    let schedule = &setup.network.schedule;
    match claim.answer {
        Answer::Holds => {}
        Answer::HoldsOnHorizon => return shortest_logged(schedule),
        Answer::Violated | Answer::Watched | Answer::NotShown | Answer::NotCovered => return None,
    }
    match schedule.known().dwell {
        Dwell::NeverSwitches => Some(Proof::NeverSwitches),
        Dwell::Shortest(dwell_s) | Dwell::Drawn(dwell_s) => Some(Proof::ShortestPhase(Number::written(dwell_s))),
        Dwell::Declared(_) => None,
    }
}

/// The shortest phase of a log but for the last, which the end of the table may cut short, from times as they are written.
fn shortest_logged(schedule: &Schedule) -> Option<Proof> {
    let log: &Logged = schedule.downcast()?;
    let times: Vec<BigRational> = log.starts_s.iter().copied().map(Number::written).collect();
    let shortest_s = times.windows(2).map(|pair| &pair[1] - &pair[0]).min();
    Some(Proof::ShortestPhase(shortest_s.unwrap_or_else(|| Number::written(log.until_s))))
}

pub(super) fn fixed_graph(_: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    (claim.answer == Answer::Holds).then_some(Proof::OneGraph)
}
