//! The network over time, for pictures: which graph is in force when, and how delays move.

use forwardstep_sim::delay::{Delay, DelayPiece};
use forwardstep_sim::graph::Edge;
use forwardstep_sim::network::Network;
use forwardstep_sim::schedule::Segment;
use forwardstep_sim::setup::Setup;

/// No picture shows more phases, or more jumps of delays.
pub(crate) const MOST_SPANS: usize = 4000;

/// With more arrivals of packets than this they are no jumps that a picture could show one by one.
const MOST_ARRIVALS: usize = 400;

/// The schedule unrolled over [0, `until_s`].
pub(crate) struct Timeline<'a> {
    pub(crate) graphs: &'a [Vec<Edge>],
    /// Which graph is in force when; cut at `until_s`.
    pub(crate) spans: Vec<Segment>,
    /// Jumps of the delays that edges use, rising; without arrivals of packets where these are very many.
    pub(crate) delay_jumps: Vec<f64>,
    /// When pushes begin and end.
    pub(crate) push_edges: Vec<f64>,
    /// More happened than [`MOST_SPANS`].
    pub(crate) cut: bool,
}

impl<'a> Timeline<'a> {
    pub(crate) fn of(network: &'a Network, until_s: f64) -> Self {
        let mut spans: Vec<Segment> = network
            .schedule
            .segments()
            .take_while(|span| span.start_s < until_s)
            .take(MOST_SPANS + 1)
            .map(|span| Segment { end_s: span.end_s.min(until_s), ..span })
            .collect();
        let used = || network.used_delays().map(|index| &network.delays[index]);
        let arrived: usize = used().map(|delay| arrivals(delay, until_s)).sum();
        let shown = used().filter(|delay| arrived <= MOST_ARRIVALS || delay.first_piece().held_s.is_none());
        let mut delay_jumps: Vec<f64> = shown.flat_map(|delay| jumps(delay, until_s)).collect();
        delay_jumps.sort_by(f64::total_cmp);
        delay_jumps.dedup();
        let cut = spans.len() > MOST_SPANS || delay_jumps.len() > MOST_SPANS;
        spans.truncate(MOST_SPANS);
        delay_jumps.truncate(MOST_SPANS);
        Timeline { graphs: &network.schedule.graphs, spans, delay_jumps, push_edges: Vec::new(), cut }
    }

    /// The same with the edges of all pushes.
    pub(crate) fn of_setup(setup: &'a Setup, until_s: f64) -> Self {
        let mut timeline = Timeline::of(&setup.network, until_s);
        let pushes = setup.agents.iter().flat_map(|agent| &agent.pushes);
        let edges = pushes.map(|push| push.span_s()).filter(|[begins_s, ends_s]| begins_s < ends_s).flatten();
        timeline.push_edges = edges.filter(|t_s| *t_s > 0.0 && *t_s < until_s).take(MOST_SPANS).collect();
        timeline
    }

    /// Times at which the graph changes.
    pub(crate) fn switches(&self) -> impl Iterator<Item = f64> + '_ {
        self.spans.windows(2).filter(|pair| pair[0].graph != pair[1].graph).map(|pair| pair[1].start_s)
    }

    /// Switches, jumps of delays and edges of pushes together, rising.
    pub(crate) fn break_points(&self) -> Vec<f64> {
        let mut times: Vec<f64> =
            self.switches().chain(self.delay_jumps.iter().chain(&self.push_edges).copied()).collect();
        times.sort_by(f64::total_cmp);
        times.dedup_by(|b, a| *b - *a <= 1e-9);
        times
    }
}

/// Times in (0, `until_s`) at which a delay jumps, a little more than [`MOST_SPANS`] of them at most.
fn jumps(delay: &Delay, until_s: f64) -> impl Iterator<Item = f64> + '_ {
    pieces(delay).map(|piece| piece.end_s).take_while(move |end_s| *end_s < until_s).take(MOST_SPANS + 1)
}

/// How many messages are held one after another until `until_s`, as far as they are counted.
fn arrivals(delay: &Delay, until_s: f64) -> usize {
    let pieces = pieces(delay).take_while(|piece| piece.held_s.is_some() && piece.start_s <= until_s);
    pieces.filter(|piece| piece.held_s.is_some_and(f64::is_finite)).take(MOST_ARRIVALS + 1).count()
}

fn pieces(delay: &Delay) -> impl Iterator<Item = DelayPiece> + '_ {
    let next = |piece: &DelayPiece| piece.end_s.is_finite().then(|| delay.next_piece(*piece));
    std::iter::successors(Some(delay.first_piece()), next)
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
    let spacing_s = until_s / SAMPLES as f64;
    let sampled = |delay: &Delay| -> Vec<f32> {
        let dense = arrivals(delay, until_s) > MOST_ARRIVALS;
        let value = |(place, (t, side)): (usize, &(f64, f64))| {
            if dense { extreme(delay, *t, spacing_s, place % 2 == 0) } else { delay.value((t + side).max(0.0)) }
        };
        places.iter().enumerate().map(|place| value(place) as f32).collect()
    };
    let values = delays.iter().map(sampled).collect();
    (places.iter().map(|(t, _)| *t).collect(), values)
}

/// The largest or the least delay around `t_s`: a line through both in turn covers the band in which a delay moves that
/// jumps more often than there are samples.
fn extreme(delay: &Delay, t_s: f64, spacing_s: f64, largest: bool) -> f64 {
    let (from, to) = ((t_s - spacing_s).max(0.0), t_s + spacing_s);
    let mut piece = delay.piece_at(from);
    let mut extreme = delay.value_on(piece, from);
    loop {
        for t in [piece.start_s.max(from), piece.end_s.min(to)] {
            let value = delay.value_on(piece, t);
            extreme = if largest { extreme.max(value) } else { extreme.min(value) };
        }
        if piece.end_s >= to {
            return extreme;
        }
        piece = delay.next_piece(piece);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use forwardstep_sim::delay::{PiecewiseConstant, SawTooth};
    use forwardstep_sim::schedule::{Phase, Schedule};

    fn network(schedule: Schedule, delay: Delay) -> Network {
        Network { agents: 2, schedule, delays: vec![delay], weights: Vec::new(), coupling: Default::default() }
    }

    fn phase(dwell_s: f64) -> Phase {
        Phase { edges: vec![Edge { from: 0, to: 1, weight: 1.0.into(), delay: 0 }], dwell_s }
    }

    fn starts(timeline: &Timeline<'_>) -> Vec<(f64, usize)> {
        timeline.spans.iter().map(|span| (span.start_s, span.graph)).collect()
    }

    #[test]
    fn schedules_are_unrolled_up_to_the_end() {
        let constant = Delay::constant(0.1);
        let periodic = network(Schedule::periodic(vec![phase(1.0), phase(2.0)]), constant.clone());
        let timeline = Timeline::of(&periodic, 5.0);
        assert_eq!(starts(&timeline), [(0.0, 0), (1.0, 1), (3.0, 0), (4.0, 1)]);
        assert_eq!(timeline.spans[3].end_s, 5.0);
        assert_eq!(timeline.break_points(), [1.0, 3.0, 4.0]);

        let once = network(Schedule::once(vec![phase(1.0), phase(2.0)]), constant.clone());
        assert_eq!(starts(&Timeline::of(&once, 5.0)), [(0.0, 0), (1.0, 1)]);

        let random = Schedule::random(vec![vec![], vec![]], [0.1, 0.2], 1);
        let random = network(random, constant);
        assert!((25..=50).contains(&Timeline::of(&random, 5.0).spans.len()));
    }

    #[test]
    fn schedules_that_hardly_move_on_are_cut() {
        let network = network(Schedule::periodic(vec![phase(1e-9)]), Delay::constant(0.0));
        let timeline = Timeline::of(&network, 1e6);
        assert!(timeline.cut && timeline.spans.len() == MOST_SPANS);
    }

    #[test]
    fn many_packets_are_drawn_as_a_band() {
        let link = forwardstep_sim::delay::PacketLink {
            every_s: 0.01,
            first_s: 0.0,
            latency_s: 0.05,
            jitter_s: 0.0,
            loss: forwardstep_sim::delay::Loss::Never,
            most_in_a_row: None,
            seed: 1,
        };
        let delay = Delay::new(link.trace((0, 1), 100.0).unwrap());
        let network = network(Schedule::fixed(phase(1.0).edges), delay.clone());
        let timeline = Timeline::of(&network, 100.0);
        assert!(timeline.delay_jumps.is_empty() && !timeline.cut);
        let (t_s, values) = sample_delays(&[delay], &timeline.delay_jumps, 100.0);
        assert_eq!(t_s.len(), values[0].len());
        for (k, value) in values[0].iter().enumerate().skip(2).take(700) {
            let wanted = if k % 2 == 0 { 0.06 } else { 0.05 };
            assert!((value - wanted).abs() < 1e-6, "{k}: {value}");
        }
    }

    #[test]
    fn delays_jump_where_they_should() {
        let saw = Delay::new(SawTooth { min_s: 0.1, max_s: 0.5, period_s: 2.0, offset_s: 0.5 });
        assert_eq!(jumps(&saw, 6.0).collect::<Vec<_>>(), [1.5, 3.5, 5.5]);
        let steps =
            Delay::new(PiecewiseConstant { times_s: vec![0.0, 1.0], values_s: vec![0.2, 0.4], period_s: Some(3.0) });
        assert_eq!(jumps(&steps, 5.0).collect::<Vec<_>>(), [1.0, 3.0, 4.0]);
        let (t_s, values) = sample_delays(&[saw], &[1.5, 3.5, 5.5], 6.0);
        let at = t_s.iter().position(|t| *t == 1.5).unwrap();
        assert_eq!(t_s[at + 1], 1.5);
        assert!((values[0][at] - 0.5).abs() < 1e-6 && (values[0][at + 1] - 0.1).abs() < 1e-6);
    }
}
