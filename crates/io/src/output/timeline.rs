//! The network over time, for pictures: which graph is in force when, and how delays move.

use forwardstep_sim::delay::Delay;
use forwardstep_sim::graph::Edge;
use forwardstep_sim::network::Network;
use forwardstep_sim::schedule::{Phase, Schedule};

/// No picture shows more phases, or more jumps of delays.
pub(crate) const MOST_SPANS: usize = 4000;

/// A graph in force for a while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    pub(crate) start_s: f64,
    pub(crate) end_s: f64,
    /// Index into [`Timeline::graphs`].
    pub(crate) graph: usize,
}

/// The schedule unrolled over [0, `until_s`].
pub(crate) struct Timeline<'a> {
    pub(crate) graphs: Vec<&'a [Edge]>,
    /// Nothing for a random schedule whose draws are not known.
    pub(crate) spans: Option<Vec<Span>>,
    /// Jumps of the delays that edges use, rising.
    pub(crate) delay_jumps: Vec<f64>,
    /// More happened than [`MOST_SPANS`].
    pub(crate) cut: bool,
}

impl<'a> Timeline<'a> {
    pub(crate) fn of(network: &'a Network, drawn: Option<&[(f64, usize)]>, until_s: f64) -> Self {
        let (graphs, spans): (Vec<&[Edge]>, _) = match &network.schedule {
            Schedule::Fixed(edges) => {
                (vec![edges.as_slice()], Some(vec![Span { start_s: 0.0, end_s: until_s, graph: 0 }]))
            }
            Schedule::Periodic(phases) => (graphs_of(phases), Some(unroll(phases, true, until_s))),
            Schedule::Once(phases) => (graphs_of(phases), Some(unroll(phases, false, until_s))),
            Schedule::Random { graphs, .. } => {
                (graphs.iter().map(Vec::as_slice).collect(), drawn.map(|drawn| spans_of(drawn, until_s)))
            }
        };
        let mut spans = spans;
        let mut cut = false;
        if let Some(spans) = &mut spans {
            spans.retain(|span| span.graph < graphs.len() && span.end_s > span.start_s);
            cut = spans.len() > MOST_SPANS;
            spans.truncate(MOST_SPANS);
        }
        let used = |k: usize| graphs.iter().any(|edges| edges.iter().any(|edge| edge.delay == k));
        let mut delay_jumps: Vec<f64> =
            network.delays.iter().enumerate().filter(|(k, _)| used(*k)).flat_map(|(_, d)| jumps(d, until_s)).collect();
        delay_jumps.sort_by(f64::total_cmp);
        delay_jumps.dedup();
        cut |= delay_jumps.len() > MOST_SPANS;
        delay_jumps.truncate(MOST_SPANS);
        Timeline { graphs, spans, delay_jumps, cut }
    }

    /// Times at which the graph changes.
    pub(crate) fn switches(&self) -> impl Iterator<Item = f64> + '_ {
        let spans = self.spans.as_deref().unwrap_or_default();
        spans.windows(2).filter(|pair| pair[0].graph != pair[1].graph).map(|pair| pair[1].start_s)
    }

    /// Switches and jumps together, rising.
    pub(crate) fn break_points(&self) -> Vec<f64> {
        let mut times: Vec<f64> = self.switches().chain(self.delay_jumps.iter().copied()).collect();
        times.sort_by(f64::total_cmp);
        times.dedup_by(|b, a| *b - *a <= 1e-9);
        times
    }
}

fn graphs_of(phases: &[Phase]) -> Vec<&[Edge]> {
    phases.iter().map(|phase| phase.edges.as_slice()).collect()
}

fn unroll(phases: &[Phase], again: bool, until_s: f64) -> Vec<Span> {
    let mut spans = Vec::new();
    let round: f64 = phases.iter().map(|phase| phase.dwell_s).sum();
    let mut round_start_s = 0.0;
    for k in 0_u32.. {
        round_start_s = if k == 0 { round_start_s } else { f64::from(k) * round };
        let mut start_s = round_start_s;
        for (graph, phase) in phases.iter().enumerate() {
            let last_for_ever = !again && graph + 1 == phases.len();
            let end_s = if last_for_ever { until_s } else { (start_s + phase.dwell_s).min(until_s) };
            spans.push(Span { start_s, end_s, graph });
            start_s = end_s;
        }
        if !again || round.is_nan() || round <= 0.0 || start_s >= until_s || spans.len() > MOST_SPANS {
            break;
        }
    }
    spans
}

fn spans_of(drawn: &[(f64, usize)], until_s: f64) -> Vec<Span> {
    let ends = drawn.iter().skip(1).map(|(start_s, _)| *start_s).chain(std::iter::once(until_s));
    drawn
        .iter()
        .zip(ends)
        .map(|(&(start_s, graph), end_s)| Span { start_s, end_s: end_s.min(until_s), graph })
        .collect()
}

/// T(t).
pub(crate) fn delay_at(delay: &Delay, t_s: f64) -> f64 {
    match delay {
        Delay::Constant { s } => *s,
        Delay::Sinusoid { mean_s, amplitude_s, period_s, phase_rad } => {
            mean_s + amplitude_s * (std::f64::consts::TAU * t_s / period_s + phase_rad).sin()
        }
        Delay::PiecewiseConstant { times_s, values_s, period_s } => {
            let t_s = period_s.map_or(t_s, |period_s| t_s.rem_euclid(period_s));
            let piece = times_s.partition_point(|start_s| *start_s <= t_s).saturating_sub(1);
            values_s.get(piece).copied().unwrap_or(f64::NAN)
        }
        Delay::SawTooth { min_s, max_s, period_s, offset_s } => {
            min_s + (max_s - min_s) * ((t_s + offset_s) / period_s).rem_euclid(1.0)
        }
    }
}

/// Times in (0, `until_s`) at which a delay jumps, a little more than [`MOST_SPANS`] of them at most.
fn jumps(delay: &Delay, until_s: f64) -> Vec<f64> {
    let repeat = |first: f64, period_s: f64| {
        let times = (0..=MOST_SPANS).map(move |k| first + k as f64 * period_s);
        times.skip_while(|t| *t <= 0.0).take_while(move |t| *t < until_s)
    };
    match delay {
        Delay::Constant { .. } | Delay::Sinusoid { .. } => Vec::new(),
        Delay::PiecewiseConstant { times_s, period_s, .. } => {
            let all = |first: &f64| match period_s {
                Some(period_s) => repeat(*first, *period_s).collect(),
                None => Vec::from_iter(Some(*first).filter(|t| *t > 0.0 && *t < until_s)),
            };
            times_s.iter().flat_map(all).collect()
        }
        Delay::SawTooth { period_s, offset_s, .. } => repeat(-offset_s.rem_euclid(*period_s), *period_s).collect(),
    }
}

/// Delays sampled on common times; at a jump there are two samples at the same time.
pub(crate) fn sample_delays(delays: &[Delay], jumps: &[f64], until_s: f64) -> (Vec<f64>, Vec<Vec<f32>>) {
    const SAMPLES: usize = 800;
    let aside = 1e-9 * until_s.max(1e-3);
    // The end is seen from the left.
    let even = (0..=SAMPLES).map(|k| (until_s * k as f64 / SAMPLES as f64, if k == SAMPLES { -aside } else { 0.0 }));
    let mut places: Vec<(f64, f64)> = even.chain(jumps.iter().flat_map(|t| [(*t, -aside), (*t, aside)])).collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    // An even sample on a jump has no side, so it goes.
    places.retain(|(t, side)| *side != 0.0 || jumps.binary_search_by(|jump| jump.total_cmp(t)).is_err());
    let values = delays.iter().map(|d| places.iter().map(|(t, side)| delay_at(d, t + side) as f32).collect());
    (places.iter().map(|(t, _)| *t).collect(), values.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn network(schedule: Schedule, delay: Delay) -> Network {
        Network { agents: 2, schedule, delays: vec![delay] }
    }

    fn phase(dwell_s: f64) -> Phase {
        Phase { edges: vec![Edge { from: 0, to: 1, weight: 1.0, delay: 0 }], dwell_s }
    }

    fn starts(timeline: &Timeline<'_>) -> Vec<(f64, usize)> {
        timeline.spans.iter().flatten().map(|span| (span.start_s, span.graph)).collect()
    }

    #[test]
    fn schedules_are_unrolled_up_to_the_end() {
        let constant = Delay::Constant { s: 0.1 };
        let periodic = network(Schedule::Periodic(vec![phase(1.0), phase(2.0)]), constant.clone());
        let timeline = Timeline::of(&periodic, None, 5.0);
        assert_eq!(starts(&timeline), [(0.0, 0), (1.0, 1), (3.0, 0), (4.0, 1)]);
        assert_eq!(timeline.spans.as_ref().unwrap()[3].end_s, 5.0);
        assert_eq!(timeline.break_points(), [1.0, 3.0, 4.0]);

        let once = network(Schedule::Once(vec![phase(1.0), phase(2.0)]), constant.clone());
        assert_eq!(starts(&Timeline::of(&once, None, 5.0)), [(0.0, 0), (1.0, 1)]);

        let random = Schedule::Random { graphs: vec![vec![], vec![]], dwell_s: [0.1, 0.2], seed: 1 };
        let random = network(random, constant);
        assert!(Timeline::of(&random, None, 5.0).spans.is_none());
        let drawn = [(0.0, 1), (2.5, 0), (3.0, 9)];
        assert_eq!(starts(&Timeline::of(&random, Some(&drawn), 5.0)), [(0.0, 1), (2.5, 0)]);
    }

    #[test]
    fn schedules_that_never_move_on_end() {
        for dwell_s in [0.0, 1e-9, f64::NAN] {
            let network = network(Schedule::Periodic(vec![phase(dwell_s)]), Delay::Constant { s: 0.0 });
            assert!(Timeline::of(&network, None, 1e6).spans.unwrap().len() <= MOST_SPANS);
        }
    }

    #[test]
    fn delays_jump_where_they_should() {
        let saw = Delay::SawTooth { min_s: 0.1, max_s: 0.5, period_s: 2.0, offset_s: 0.5 };
        assert_eq!(jumps(&saw, 6.0), [1.5, 3.5, 5.5]);
        assert!((delay_at(&saw, 0.5) - 0.3).abs() < 1e-15);
        let steps = Delay::PiecewiseConstant { times_s: vec![0.0, 1.0], values_s: vec![0.2, 0.4], period_s: Some(3.0) };
        assert_eq!(jumps(&steps, 5.0), [3.0, 1.0, 4.0]);
        assert_eq!([0.5, 1.0, 2.9, 3.0].map(|t| delay_at(&steps, t)), [0.2, 0.4, 0.4, 0.2]);
        let once = Delay::PiecewiseConstant { times_s: vec![0.0, 1.0], values_s: vec![0.2, 0.4], period_s: None };
        assert_eq!(jumps(&once, 5.0), [1.0]);
        let (t_s, values) = sample_delays(&[saw], &[1.5, 3.5, 5.5], 6.0);
        let at = t_s.iter().position(|t| *t == 1.5).unwrap();
        assert_eq!(t_s[at + 1], 1.5);
        assert!((values[0][at] - 0.5).abs() < 1e-6 && (values[0][at + 1] - 0.1).abs() < 1e-6);
    }
}
