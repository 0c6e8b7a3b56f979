//! Windows of schedules against the long way round, and how dwell times are drawn.

use forwardstep_sim::graph::{Edge, SpanningTree, spanning_tree};
use forwardstep_sim::schedule::{Phase, Schedule, Segment, Window};

fn edges(pairs: &[(usize, usize)]) -> Vec<Edge> {
    pairs.iter().map(|&(from, to)| Edge { from, to, weight: 1.0.into(), delay: 0 }).collect()
}

/// Numbers in [0, 1), without a pattern.
struct Draw(u64);

impl Draw {
    fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, end: usize) -> usize {
        (self.share() * end as f64) as usize
    }

    fn phases(&mut self, agents: usize) -> Vec<Phase> {
        let count = 1 + self.below(4);
        (0..count)
            .map(|_| {
                let pairs: Vec<(usize, usize)> =
                    (0..agents * agents).map(|k| (k / agents, k % agents)).filter(|(a, b)| a != b).collect();
                let pairs: Vec<_> = pairs.into_iter().filter(|_| self.share() < 0.25).collect();
                Phase { edges: edges(&pairs), dwell_s: 0.25 * (1 + self.below(8)) as f64 }
            })
            .collect()
    }
}

/// For every phase as the first: when it begins, and how long a run of whole phases lasts until its union has a tree.
fn runs(phases: &[Phase], agents: usize, repeats: bool) -> Vec<(f64, Option<f64>)> {
    let mut starts = Vec::new();
    let mut start_s = 0.0;
    for first in 0..phases.len() {
        let (mut union, mut run_s, mut found) = (Vec::new(), 0.0, None);
        let last = if repeats { first + phases.len() } else { phases.len() };
        for k in first..last {
            let phase = &phases[k % phases.len()];
            union.extend(phase.edges.iter().copied());
            let stays = !repeats && k + 1 == phases.len();
            run_s += if stays { 0.0 } else { phase.dwell_s };
            if matches!(spanning_tree(agents, &union), SpanningTree::Rooted { .. }) {
                found = Some(run_s);
                break;
            }
        }
        starts.push((start_s, found));
        start_s += phases[first].dwell_s;
    }
    starts
}

#[test]
fn windows_of_phases_are_those_found_the_long_way_round() {
    let mut draw = Draw(7);
    let (mut uniform, mut missing, mut worst_is_last) = (0, 0, 0);
    for _ in 0..2000 {
        let agents = 1 + draw.below(4);
        let phases = draw.phases(agents);
        for repeats in [true, false] {
            let found = runs(&phases, agents, repeats);
            let schedule = if repeats { Schedule::periodic(phases.clone()) } else { Schedule::once(phases.clone()) };
            match schedule.window(agents, 100.0) {
                Window::Uniform { length_s, for_all_time, .. } if schedule.constant_graph().is_some() => {
                    assert_eq!((length_s, for_all_time), (0.0, true), "one graph stays for ever: {schedule:?}");
                    assert!(found.iter().all(|(_, run)| run.is_some()));
                }
                Window::Uniform { length_s, worst_start_s, for_all_time, .. } => {
                    assert!(for_all_time, "a schedule of phases is known for ever");
                    let longest = found.iter().map(|(_, run)| run.unwrap()).fold(0.0, f64::max);
                    assert_eq!(length_s, longest, "{schedule:?}");
                    let worst = found.iter().find(|(_, run)| *run == Some(longest)).unwrap();
                    assert_eq!(worst_start_s, worst.0, "the first of the longest: {schedule:?}");
                    uniform += 1;
                    let others = found.iter().take(found.len() - 1).filter(|(_, run)| *run == Some(longest));
                    worst_is_last += usize::from(others.count() == 0 && found.len() > 1);
                }
                Window::EveryGraph | Window::Once { .. } => panic!("nothing is drawn, and all is known for ever"),
                Window::Missing { .. } => {
                    assert!(found.iter().any(|(_, run)| run.is_none()), "{schedule:?}");
                    missing += 1;
                }
            }
        }
    }
    assert!(uniform > 300 && missing > 300 && worst_is_last > 50, "{uniform} {missing} {worst_is_last}");
}

#[test]
fn a_period_can_be_worst_from_its_last_phase() {
    let phase = |dwell_s, pairs: &[(usize, usize)]| Phase { edges: edges(pairs), dwell_s };
    let schedule = Schedule::periodic(vec![phase(3.0, &[(0, 1)]), phase(1.0, &[(0, 1), (1, 2)]), phase(2.0, &[])]);
    let Window::Uniform { length_s, worst_start_s, .. } = schedule.window(3, 100.0) else { panic!() };
    assert_eq!((length_s, worst_start_s), (6.0, 4.0), "from the last phase, over the turn of the period");
}

#[test]
fn random_dwells_are_uniform_between_their_bounds_and_graphs_equally_likely() {
    let graphs = vec![edges(&[(0, 1)]), edges(&[(1, 0)]), edges(&[])];
    let (low, high) = (0.5, 2.5);
    let schedule = Schedule::random(graphs, [low, high], 11);
    let drawn: Vec<Segment> = schedule.segments().take(9000).collect();
    let shares: Vec<f64> = drawn.iter().map(|s| (s.end_s - s.start_s - low) / (high - low)).collect();
    let n = shares.len() as f64;
    // Five standard errors each: of the mean, of the part below any quantile, of the part that each graph has.
    let mean = shares.iter().sum::<f64>() / n;
    assert!((mean - 0.5).abs() < 5.0 / (12.0 * n).sqrt(), "{mean}");
    for tenth in 1..10 {
        let p = f64::from(tenth) / 10.0;
        let part = shares.iter().filter(|share| **share < p).count() as f64 / n;
        assert!((part - p).abs() < 5.0 * (p * (1.0 - p) / n).sqrt(), "{part} below {p}");
    }
    assert!(shares.iter().all(|share| (-1e-9..=1.0 + 1e-9).contains(share)));
    for graph in 0..3 {
        let part = drawn.iter().filter(|s| s.graph == graph).count() as f64 / n;
        assert!((part - 1.0 / 3.0).abs() < 5.0 * (2.0 / 9.0 / n).sqrt(), "{part}");
    }
    // One follows the other without a gap.
    assert!(drawn.windows(2).all(|pair| pair[0].end_s == pair[1].start_s) && drawn[0].start_s == 0.0);
    let fixed = Schedule::random(vec![edges(&[])], [1.5, 1.5], 1);
    assert!(fixed.segments().take(20).enumerate().all(|(k, s)| s.end_s == 1.5 * (k + 1) as f64));
}
