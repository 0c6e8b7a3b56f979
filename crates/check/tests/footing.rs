//! What a derivation lacks, and what would break what holds.

use crate::common::{edge, masses, noise};
use forwardstep_check::{Footing, Id, check};
use forwardstep_sim::delay::Delay;
use forwardstep_sim::graph::{Edge, SpanningTree, spanning_tree};
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::{Exchange, Setup};

fn among_masses(schedule: Schedule) -> Setup {
    masses(Exchange::PositionVelocity, 2, schedule, vec![Delay::constant(0.1)])
}

/// What is said of the graphs.
fn of_graphs(setup: &Setup) -> Option<String> {
    Footing::of(setup, &check(setup)).breaks.into_iter().find(|one| one.id == Id::SpanningTree).map(|one| one.words)
}

#[test]
fn every_hypothesis_that_holds_says_once_what_would_break_it_and_no_other_does() {
    let setup = among_masses(Schedule::fixed(vec![edge(0, 1, 1.0, 0), edge(1, 2, 1.0, 0)]));
    let report = check(&setup);
    let mut fine: Vec<Id> = report.hypotheses.iter().filter(|one| one.answer().is_fine()).map(|one| one.id).collect();
    fine.dedup();
    let footing = Footing::of(&setup, &report);
    let found: Vec<Id> = footing.breaks.iter().map(|one| one.id).collect();
    assert_eq!((found, footing.lacks.len()), (fine, report.hypotheses.len() - footing.breaks.len()));
    let found: Vec<Id> = footing.breaks.iter().map(|one| one.id).collect();
    assert!(found.len() > 3 && found.contains(&Id::RealRoots));
    let cut = among_masses(Schedule::fixed(vec![edge(0, 1, 1.0, 0)]));
    assert_eq!(of_graphs(&cut), None, "what is violated is broken already");
    let lacks = Footing::of(&cut, &check(&cut)).lacks;
    assert_eq!(lacks.iter().map(|one| one.id).collect::<Vec<_>>(), [Id::SpanningTree]);
    assert!(lacks[0].words.starts_with("violated: the union of the graphs"), "{lacks:?}");
    assert!(Id::ALL.iter().all(|id| id.broken_by().len() > 20));
}

#[test]
fn prop_the_links_that_are_named_are_those_without_which_no_tree_is_left() {
    let agents = among_masses(Schedule::fixed(Vec::new())).agents.len();
    let name = |k: usize| among_masses(Schedule::fixed(Vec::new())).agents[k].name.clone();
    let pairs: Vec<(usize, usize)> =
        (0..agents).flat_map(|from| (0..agents).map(move |to| (from, to))).filter(|(from, to)| from != to).collect();
    let (mut none, mut some, mut trees) = (0, 0, 0);
    for seed in 0..200 {
        let drawn = |phase: usize| -> Vec<Edge> {
            let chosen = pairs.iter().enumerate().filter(|(k, _)| noise(seed * 100 + phase * 40 + k).abs() > 0.97);
            chosen.map(|(_, &(from, to))| edge(from, to, 1.0, 0)).collect()
        };
        let phases = [drawn(0), drawn(1)];
        let all: Vec<Edge> = phases.concat();
        let setup = among_masses(Schedule::periodic(phases.map(|edges| Phase { edges, dwell_s: 1.0 }).into()));
        let Some(words) = of_graphs(&setup) else {
            assert!(matches!(spanning_tree(agents, &all), SpanningTree::Missing { .. }));
            continue;
        };
        trees += 1;
        let is_needed = |(from, to): (usize, usize)| {
            let others = all.iter().filter(|one| (one.from, one.to) != (from, to));
            matches!(spanning_tree(agents, others), SpanningTree::Missing { .. })
        };
        let needed: Vec<String> = (pairs.iter().filter(|pair| is_needed(**pair)))
            .map(|&(from, to)| format!("{} → {}", name(from), name(to)))
            .collect();
        match needed.as_slice() {
            [] => none += 1,
            _ => some += 1,
        }
        let expected = match needed.as_slice() {
            [] => "no single link is indispensable".to_owned(),
            [link] => format!("losing one link breaks it: {link}"),
            links => format!("losing any one of these links breaks it: {}", links.join(", ")),
        };
        assert!(words.ends_with(&expected), "{words}, not {expected}");
    }
    assert!(none > 10 && some > 10 && trees < 200, "{none} {some} {trees}");
}
