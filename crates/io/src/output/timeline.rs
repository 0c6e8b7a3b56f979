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

/// Times of very many graphs are added up as far as this.
const MOST_COUNTED: usize = 400_000;

/// The schedule unrolled over [0, `until_s`].
pub(crate) struct Timeline<'a> {
    pub(crate) graphs: &'a [Vec<Edge>],
    /// Which graph is in force when; cut at `until_s`.
    pub(crate) spans: Vec<Segment>,
    /// Until when `spans` go, where there are more than [`MOST_SPANS`].
    pub(crate) drawn_until_s: Option<f64>,
    /// How long each graph is in force.
    pub(crate) in_force_s: Vec<f64>,
    /// Until when that is, where it is not until the end.
    pub(crate) counted_until_s: Option<f64>,
    /// Jumps of the delays that edges use, rising; without those of bands.
    pub(crate) delay_jumps: Vec<f64>,
    /// Of each delay whether it changes too often to be drawn as it is, so that it is drawn as a band.
    pub(crate) bands: Vec<bool>,
    /// When pushes begin and end.
    pub(crate) push_edges: Vec<f64>,
}

impl<'a> Timeline<'a> {
    pub(crate) fn of(network: &'a Network, until_s: f64) -> Self {
        let segments = network.schedule.segments().take_while(|span| span.start_s < until_s);
        let mut spans: Vec<Segment> = Vec::new();
        let mut in_force_s = vec![0.0; network.schedule.graphs.len()];
        let (mut count, mut counted_until_s) = (0_usize, 0.0);
        for span in segments.take(MOST_COUNTED) {
            let span = Segment { end_s: span.end_s.min(until_s), ..span };
            counted_until_s = span.end_s;
            if let Some(in_force_s) = in_force_s.get_mut(span.graph) {
                *in_force_s += span.end_s - span.start_s;
            }
            count += 1;
            if count <= MOST_SPANS {
                spans.push(span);
            }
        }
        let drawn_until_s = spans.last().filter(|_| count > MOST_SPANS).map(|span| span.end_s);
        let bands = bands(network, until_s);
        let used = network.used_delays().filter(|index| !bands[*index]).map(|index| &network.delays[index]);
        let mut delay_jumps: Vec<f64> = used.flat_map(|delay| jumps(delay, until_s)).collect();
        delay_jumps.sort_by(f64::total_cmp);
        delay_jumps.dedup();
        Timeline {
            graphs: &network.schedule.graphs,
            spans,
            drawn_until_s,
            in_force_s,
            counted_until_s: Some(counted_until_s).filter(|counted_s| count >= MOST_COUNTED && *counted_s < until_s),
            delay_jumps,
            bands,
            push_edges: Vec::new(),
        }
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

/// Which delays are drawn as bands: held messages where very many arrive, what jumps so often that there is no room for all jumps, and what
/// swings between two samples.
fn bands(network: &Network, until_s: f64) -> Vec<bool> {
    let mut bands = vec![false; network.delays.len()];
    let mut used: Vec<usize> = network.used_delays().collect();
    used.sort_unstable();
    used.dedup();
    let held = |index: usize| network.delays[index].first_piece().held_s.is_some();
    let arrived: usize = used.iter().map(|index| arrivals(&network.delays[*index], until_s)).sum();
    let mut counted: Vec<(usize, usize)> =
        used.iter().map(|index| (jumps(&network.delays[*index], until_s).count(), *index)).collect();
    counted.sort_unstable();
    let mut room = MOST_SPANS;
    for (count, index) in counted {
        let is_band = if held(index) { arrived > MOST_ARRIVALS } else { count > room };
        bands[index] = is_band || swings(&network.delays[index], until_s);
        if !bands[index] {
            room = room.saturating_sub(count);
        }
    }
    bands
}

/// Whether a delay without jumps is between two samples far from the line through them.
fn swings(delay: &Delay, until_s: f64) -> bool {
    let piece = delay.first_piece();
    if piece.held_s.is_some() || piece.end_s < until_s {
        return false;
    }
    let at = |k: usize| delay.value_on(piece, until_s * k as f64 / (4 * SAMPLES) as f64);
    let values: Vec<f64> = (0..=4 * SAMPLES).map(at).collect();
    let (low, high) = values.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(*v), high.max(*v)));
    let off = values.windows(5).step_by(4).map(|w| {
        let beside = |k: usize| (w[k] - w[0] - (w[4] - w[0]) * k as f64 / 4.0).abs();
        beside(1).max(beside(2)).max(beside(3))
    });
    off.fold(0.0, f64::max) > STRAIGHT * (high - low)
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

/// Delays are seen at so many times, and between them on straight lines, which they leave by no more than a share of their range.
const SAMPLES: usize = 800;
const STRAIGHT: f64 = 0.1;

/// Delays sampled on common times; at a jump there are two samples at the same time. A band is its greatest and its least value in turn.
pub(crate) fn sample_delays(delays: &[Delay], timeline: &Timeline<'_>, until_s: f64) -> (Vec<f64>, Vec<Vec<f32>>) {
    let jumps = &timeline.delay_jumps;
    let aside = 1e-9 * until_s.max(1e-3);
    // The end is seen from the left.
    let even = (0..=SAMPLES).map(|k| (until_s * k as f64 / SAMPLES as f64, if k == SAMPLES { -aside } else { 0.0 }));
    let mut places: Vec<(f64, f64)> = even.chain(jumps.iter().flat_map(|t| [(*t, -aside), (*t, aside)])).collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    // An even sample on a jump has no side, so it goes.
    places.retain(|(t, side)| *side != 0.0 || jumps.binary_search_by(|jump| jump.total_cmp(t)).is_err());
    let spacing_s = until_s / SAMPLES as f64;
    let sampled = |(index, delay): (usize, &Delay)| -> Vec<f32> {
        let dense = timeline.bands.get(index).copied().unwrap_or(false);
        let value = |(place, (t, side)): (usize, &(f64, f64))| {
            if dense { extreme(delay, *t, spacing_s, place % 2 == 0) } else { delay.value((t + side).max(0.0)) }
        };
        places.iter().enumerate().map(|place| value(place) as f32).collect()
    };
    let values = delays.iter().enumerate().map(sampled).collect();
    (places.iter().map(|(t, _)| *t).collect(), values)
}

/// The largest or the least delay around `t_s`: a line through both in turn covers the band in which a delay moves that
/// jumps more often than there are samples.
fn extreme(delay: &Delay, t_s: f64, spacing_s: f64, largest: bool) -> f64 {
    let (from, to) = ((t_s - spacing_s).max(0.0), t_s + spacing_s);
    let mut piece = delay.piece_at(from);
    let mut extreme = delay.value_on(piece, from);
    loop {
        let (begin, end) = (piece.start_s.max(from), piece.end_s.min(to));
        // Held messages age on a line; others may swing on the way.
        let inside = if piece.held_s.is_some() || end - begin < 0.1 * spacing_s { 1 } else { 40 };
        for t in (0..=inside).map(|k| begin + (end - begin) * f64::from(k) / f64::from(inside)) {
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
        assert_eq!(timeline.spans.len(), MOST_SPANS);
        assert_eq!(timeline.drawn_until_s, timeline.spans.last().map(|span| span.end_s));
        assert!(timeline.counted_until_s.is_some_and(|counted_s| counted_s > timeline.drawn_until_s.unwrap()));
    }

    #[test]
    fn graphs_are_in_force_as_long_as_they_are_though_not_all_spans_are_drawn() {
        let network = network(Schedule::periodic(vec![phase(0.01), phase(0.02)]), Delay::constant(0.0));
        let timeline = Timeline::of(&network, 90.0);
        assert!(timeline.drawn_until_s.is_some_and(|drawn_s| (drawn_s - 60.0).abs() < 0.1));
        assert_eq!(timeline.counted_until_s, None);
        for (in_force_s, wanted) in timeline.in_force_s.iter().zip([30.0, 60.0]) {
            assert!((in_force_s - wanted).abs() < 1e-6, "{in_force_s}");
        }
    }

    #[test]
    fn delays_that_jump_or_swing_too_often_are_bands_and_others_are_not() {
        let saw = Delay::new(SawTooth { min_s: 0.05, max_s: 0.4, period_s: 0.6, offset_s: 0.0 });
        let swing = |period_s| {
            Delay::new(forwardstep_sim::delay::Sinusoid { mean_s: 0.2, amplitude_s: 0.1, period_s, phase_rad: 0.0 })
        };
        for (delay, is_band, ends) in
            [(saw, true, [0.05, 0.4]), (swing(1.0), true, [0.1, 0.3]), (swing(1000.0), false, [0.1, 0.3])]
        {
            let network = network(Schedule::fixed(phase(1.0).edges), delay.clone());
            let timeline = Timeline::of(&network, 3000.0);
            assert_eq!(timeline.bands, [is_band]);
            let (_, values) = sample_delays(&[delay], &timeline, 3000.0);
            if is_band {
                for pair in values[0].windows(2) {
                    let (low, high) = (f64::from(pair[0].min(pair[1])), f64::from(pair[0].max(pair[1])));
                    assert!((low - ends[0]).abs() < 2e-3 && (high - ends[1]).abs() < 2e-3, "{pair:?}");
                }
            }
        }
        // Few jumps stay what they are beside a band.
        let slow = Delay::new(SawTooth { min_s: 0.05, max_s: 0.4, period_s: 100.0, offset_s: 0.0 });
        let mut both = network(Schedule::fixed(phase(1.0).edges), slow);
        both.delays.push(Delay::new(SawTooth { min_s: 0.05, max_s: 0.4, period_s: 0.6, offset_s: 0.0 }));
        both.schedule = Schedule::fixed(vec![
            Edge { from: 0, to: 1, weight: 1.0.into(), delay: 0 },
            Edge { from: 1, to: 0, weight: 1.0.into(), delay: 1 },
        ]);
        let timeline = Timeline::of(&both, 3000.0);
        assert_eq!((timeline.bands.as_slice(), timeline.delay_jumps.len()), ([false, true].as_slice(), 29));
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
        assert!(timeline.delay_jumps.is_empty() && timeline.bands[0]);
        let (t_s, values) = sample_delays(&[delay], &timeline, 100.0);
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
        let network = network(Schedule::fixed(phase(1.0).edges), saw.clone());
        let (t_s, values) = sample_delays(&[saw], &Timeline::of(&network, 6.0), 6.0);
        let at = t_s.iter().position(|t| *t == 1.5).unwrap();
        assert_eq!(t_s[at + 1], 1.5);
        assert!((values[0][at] - 0.5).abs() < 1e-6 && (values[0][at + 1] - 0.1).abs() < 1e-6);
    }
}
