use super::*;
use crate::graph::{SpanningTree, spanning_tree};

fn phase(dwell_s: f64, pairs: &[(usize, usize)]) -> Phase {
    Phase { dwell_s, edges: pairs.iter().map(|&(from, to)| Edge { from, to, weight: 1.0.into(), delay: 0 }).collect() }
}

#[test]
fn periodic_window_is_made_of_whole_phases() {
    let schedule = Schedule::periodic(vec![phase(1.0, &[(0, 1)]), phase(2.0, &[(1, 2)]), phase(0.5, &[])]);
    let Window::Uniform { length_s, roots, worst_start_s, for_all_time } = schedule.window(3, 10.0) else { panic!() };
    // From the second phase: 2 + 0.5 + 1.
    assert_eq!((length_s, worst_start_s, for_all_time), (3.5, 1.0, true));
    assert_eq!(roots, vec![0]);
}

#[test]
fn once_needs_a_tree_in_its_last_graph() {
    let schedule = Schedule::once(vec![phase(1.0, &[(0, 1), (1, 2)]), phase(1.0, &[(0, 1)])]);
    assert_eq!(
        schedule.window(3, 10.0),
        Window::Missing { start_s: 1.0, for_ever: true, closed_groups: vec![vec![0], vec![2]] }
    );
    let turned = Schedule::once(vec![phase(1.0, &[(0, 1)]), phase(1.0, &[(0, 1), (1, 2)])]);
    assert!(matches!(turned.window(3, 10.0), Window::Uniform { length_s: 1.0, for_all_time: true, .. }));
}

/// The length of the longest run that was needed, found the long way round.
fn longest_run_s(schedule: &Schedule, agents: usize, end_s: f64) -> f64 {
    let segments: Vec<Segment> = schedule.segments().take_while(|s| s.start_s < end_s).collect();
    let run_s = |first: usize| {
        (first..segments.len()).find_map(|last| {
            let union: Vec<Edge> =
                segments[first..=last].iter().flat_map(|s| schedule.graph(s.graph)).copied().collect();
            let rooted = matches!(spanning_tree(agents, &union), SpanningTree::Rooted { .. });
            rooted.then(|| segments[last].end_s.min(end_s) - segments[first].start_s)
        })
    };
    // What the end cuts off was needed as well.
    let needed_s = |first: usize| run_s(first).unwrap_or(end_s - segments[first].start_s);
    (0..segments.len()).map(needed_s).fold(0.0, f64::max)
}

#[test]
fn windows_are_those_found_the_long_way_round() {
    let graphs: Vec<Vec<Edge>> =
        [&[(0, 1)][..], &[(1, 2), (2, 1)], &[(2, 3)], &[], &[(3, 0)]].map(|pairs| phase(0.0, pairs).edges).into();
    for seed in 0..20 {
        let schedule = Schedule::random(graphs.clone(), [0.5, 1.5], seed);
        let Window::Uniform { length_s, .. } = schedule.window(4, 100.0) else { panic!("{seed}") };
        assert_eq!(length_s, longest_run_s(&schedule, 4, 100.0), "{seed}");
    }
}

#[test]
fn regress_a_million_switches_are_judged_at_once() {
    let graphs: Vec<Vec<Edge>> = vec![phase(0.0, &[(0, 1)]).edges, phase(0.0, &[]).edges];
    let schedule = Schedule::random(graphs, [1.0, 1.0], 3);
    let began = std::time::Instant::now();
    assert_eq!(
        schedule.window(3, 1e6),
        Window::Missing { start_s: 0.0, for_ever: true, closed_groups: vec![vec![0], vec![2]] }
    );
    assert!(matches!(schedule.window(2, 1e6), Window::Uniform { for_all_time: false, .. }));
    let took_s = began.elapsed().as_secs_f64();
    assert!(took_s < 10.0, "{took_s} s");
}

#[test]
fn periodic_times_do_not_drift() {
    let schedule = Schedule::periodic(vec![phase(0.1, &[]), phase(0.2, &[])]);
    let late = schedule.segments().nth(200_000).unwrap();
    assert!((late.start_s - 30_000.0).abs() < 1e-9);
}

#[test]
fn random_draws_are_reproducible_and_only_judged_on_the_horizon() {
    let graphs: Vec<Vec<Edge>> = vec![phase(0.0, &[(0, 1)]).edges, phase(0.0, &[(1, 2)]).edges];
    let schedule = Schedule::random(graphs, [0.5, 1.5], 3);
    let first: Vec<Segment> = schedule.segments().take(50).collect();
    assert_eq!(first, schedule.segments().take(50).collect::<Vec<_>>());
    assert!(first.iter().all(|s| (0.5..=1.5).contains(&(s.end_s - s.start_s))));
    assert!(matches!(schedule.window(3, 50.0), Window::Uniform { for_all_time: false, .. }));
}

#[test]
fn a_graph_that_is_written_twice_is_one() {
    let edges = phase(1.0, &[(0, 1), (1, 2)]);
    let mut turned = edges.clone();
    turned.edges.reverse();
    let same =
        [Schedule::periodic(vec![edges.clone(), turned.clone()]), Schedule::once(vec![turned.clone(), edges.clone()])];
    for schedule in same {
        assert_eq!(schedule.constant_graph().map(<[Edge]>::len), Some(2));
    }
    let drawn = Schedule::random(vec![edges.edges.clone(), turned.edges.clone()], [1.0, 2.0], 4);
    assert!(drawn.constant_graph().is_some());
    let mut heavier = turned.clone();
    heavier.edges[0].weight = 2.0.into();
    let mut later = turned.clone();
    later.edges[1].delay = 1;
    for other in [heavier, later, phase(1.0, &[(0, 1)]), phase(1.0, &[(0, 1), (2, 1)])] {
        assert_eq!(Schedule::periodic(vec![edges.clone(), edges.clone(), other]).constant_graph(), None);
    }
}

#[test]
fn what_is_drawn_is_judged_by_what_can_be_drawn() {
    let graphs = |pairs: &[&[(usize, usize)]]| pairs.iter().map(|pairs| phase(0.0, pairs).edges).collect::<Vec<_>>();
    let window = |pairs: &[&[(usize, usize)]], end_s| Schedule::random(graphs(pairs), [1.0, 1.5], 9).window(3, end_s);
    assert_eq!(window(&[&[(0, 1), (1, 2)], &[(2, 1), (1, 0)]], 5.0), Window::EveryGraph);
    // What nothing ever brings is missing for ever, and what was not drawn yet may come.
    let never = window(&[&[(0, 1)], &[(1, 0)]], 5.0);
    assert_eq!(never, Window::Missing { start_s: 0.0, for_ever: true, closed_groups: vec![vec![0, 1], vec![2]] });
    assert!(matches!(window(&[&[(0, 1)], &[(1, 2)]], 0.5), Window::Missing { for_ever: false, .. }));
    assert!(matches!(window(&[&[(0, 1)], &[(1, 2)]], 50.0), Window::Uniform { for_all_time: false, .. }));
}

/// What a schedule that ends had before its last graph never comes back.
#[test]
fn regress_the_groups_of_a_schedule_that_ends_are_those_of_its_last_graph() {
    let missing = |pairs: &[&[(usize, usize)]]| {
        Schedule::once(pairs.iter().map(|pairs| phase(1.0, pairs)).collect()).window(3, 40.0)
    };
    let closed_groups = vec![vec![0], vec![1], vec![2]];
    assert_eq!(missing(&[&[(0, 1)], &[]]), Window::Missing { start_s: 1.0, for_ever: true, closed_groups });
    let closed_groups = vec![vec![0], vec![1]];
    assert_eq!(missing(&[&[(0, 1)], &[(0, 2)]]), Window::Missing { start_s: 1.0, for_ever: true, closed_groups });
}

/// What the end of a log cuts off is a window that is not complete, and the run has to be twice as long as what it needs.
#[test]
fn regress_a_tail_without_a_tree_is_held_against_a_log() {
    let link: &[(usize, usize)] = &[(0, 1)];
    let window = |starts: &[(f64, usize)], end_s: f64| {
        let graphs = vec![phase(0.0, link).edges, phase(0.0, &[]).edges];
        let (starts_s, which) = starts.iter().copied().unzip();
        Schedule::logged(graphs, Logged { starts_s, graphs: which, until_s: end_s }).window(2, end_s)
    };
    let once = |wait_s, start_s| Window::Once { wait_s, start_s };
    assert_eq!(window(&[(0.0, 0), (0.05, 1)], 60.0), once(59.95, 0.05));
    assert_eq!(window(&[(0.0, 1), (30.5, 0)], 60.0), once(30.5, 0.0));
    // One graph with a tree may stay as long as it likes.
    assert!(matches!(window(&[(0.0, 0)], 60.0), Window::Uniform { for_all_time: false, .. }));
    // Heard every ten seconds, up to the end and until long before.
    let starts = |k: u32| [(10.0 * f64::from(k), 0), (10.0 * f64::from(k) + 1.0, 1)];
    let every: Vec<(f64, usize)> = (0..6).flat_map(starts).collect();
    assert!(matches!(window(&every, 60.0), Window::Uniform { length_s: 10.0, for_all_time: false, .. }));
    assert!(matches!(window(&every, 75.0), Window::Uniform { length_s: 24.0, worst_start_s: 51.0, .. }));
    assert_eq!(window(&every, 120.0), once(69.0, 51.0));
}

/// What comes once in each half has not come back, and nothing that is drawn lasts beyond the run.
#[test]
fn regress_a_run_shows_what_comes_back_in_less_than_half_of_it_and_no_window_beyond_its_end() {
    let graphs = || vec![phase(0.0, &[(0, 1)]).edges, phase(0.0, &[(1, 2)]).edges];
    let window = |starts: &[f64], end_s: f64| {
        let which = (0..starts.len()).map(|k| k % 2).collect();
        Schedule::logged(graphs(), Logged { starts_s: starts.to_vec(), graphs: which, until_s: end_s }).window(3, end_s)
    };
    assert_eq!(window(&[0.0, 30.0], 60.0), Window::Once { wait_s: 30.0, start_s: 0.0 });
    assert!(matches!(window(&[0.0, 10.0, 30.0, 50.0], 60.0), Window::Uniform { length_s: 40.0, .. }));
    let mut cut = 0;
    for seed in 0..200 {
        match Schedule::random(graphs(), [15.0, 29.0], seed).window(3, 100.0) {
            Window::Uniform { length_s, worst_start_s, .. } => {
                assert!(worst_start_s + length_s <= 100.0, "{seed}: {length_s} {worst_start_s}");
                cut += u32::from(worst_start_s + length_s == 100.0);
            }
            Window::Once { wait_s, start_s } => assert!(wait_s >= 50.0 && start_s + wait_s <= 100.0, "{seed}"),
            Window::Missing { start_s, .. } => assert!(start_s >= 0.0),
            Window::EveryGraph => panic!("no graph has a tree by itself"),
        }
    }
    assert!(cut > 0);
}

#[test]
fn only_the_last_graph_of_a_schedule_that_ends_recurs() {
    let phases = vec![phase(1.0, &[(0, 1)]), phase(1.0, &[(1, 2)])];
    assert_eq!(Schedule::once(phases.clone()).recurring_graphs(), [phases[1].edges.clone()]);
    assert_eq!(Schedule::periodic(phases.clone()).recurring_graphs().len(), 2);
}

#[test]
fn regress_as_many_graphs_as_phases_are_judged_in_seconds() {
    let (agents, phases) = (50, 100_000);
    let edge = |k: usize| ((k * 7919 + k / 50) % agents, (k * 104_729 + 13) % agents);
    let pairs = (0..).map(edge).filter(|(from, to)| from != to);
    let schedule = Schedule::periodic(pairs.take(phases).map(|pair| phase(0.1, &[pair])).collect());
    let began = std::time::Instant::now();
    assert!(matches!(schedule.window(agents, 1e4), Window::Uniform { for_all_time: true, .. }));
    let took_s = began.elapsed().as_secs_f64();
    assert!(took_s < 10.0, "{took_s} s");
}
