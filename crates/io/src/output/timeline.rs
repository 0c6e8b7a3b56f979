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
        if !again || !(round > 0.0) || start_s >= until_s || spans.len() > MOST_SPANS {
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
            times_s.iter().flat_map(|first| repeat(*first, period_s.unwrap_or(f64::INFINITY))).collect()
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
