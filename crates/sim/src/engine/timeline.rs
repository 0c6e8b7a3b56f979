//! Switches, delay jumps and the arrival of their images, in order.
//!
//! A *primary* break-point is where the right-hand side itself jumps: t = 0, a switch, a jump or kink of a delay. What was
//! sent there is heard, through every delay, at its *images*; the right-hand side has a kink there. The first
//! generation of images is always landed on; the second when the tolerance is tight enough to see it, within a budget.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::delay::DelayPiece;
use crate::graph::Weight;
use crate::network::Network;
use crate::schedule::{Segment, Segments};

/// Events closer than this are one, s.
const MERGE_S: f64 = 1e-12;

/// The same at a time so late that neighbouring numbers are farther apart.
fn merge_s(t_s: f64) -> f64 {
    MERGE_S.max(4.0 * (t_s.next_up() - t_s))
}

/// Second-generation images waiting at once; beyond it they are left to the error control.
const SECOND_GENERATION_BUDGET: usize = 256;

/// Where every schedule and delay is now, and what comes next.
#[derive(Debug)]
pub(crate) struct Timeline<'a> {
    network: &'a Network,
    segments: Segments<'a>,
    segment: Segment,
    /// The delays in use, equal ones once, by the index of the first, with the piece each is on.
    clocks: Vec<(usize, DelayPiece)>,
    /// The clock of every delay.
    clock_of: Vec<Option<usize>>,
    images: BinaryHeap<Reverse<Image>>,
    second_waiting: usize,
    generations: u8,
    end_s: f64,
    arrivals: Vec<f64>,
    /// Where weights have kinks still to come, s, the next one last.
    kinks_s: Vec<f64>,
}

/// The arrival of a break-point through a delay. Ordered by time, then generation.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Image {
    t_s: f64,
    generation: u8,
}

impl Eq for Image {}
impl PartialOrd for Image {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Image {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.t_s.total_cmp(&other.t_s).then(self.generation.cmp(&other.generation))
    }
}

/// What happened at a break-point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Passed {
    /// The graph changed.
    pub(crate) switched: bool,
    /// The right-hand side may have jumped: a switch or a delay's piece ended.
    pub(crate) jumped: bool,
}

impl<'a> Timeline<'a> {
    /// Starts at t = 0. `generations` is how many generations of images to land on.
    pub(crate) fn new(network: &'a Network, end_s: f64, generations: u8) -> Self {
        let mut segments = network.schedule.segments();
        let for_ever = Segment { start_s: 0.0, end_s: f64::INFINITY, graph: 0 };
        let segment = segments.next().unwrap_or(for_ever);
        let mut clocks: Vec<(usize, DelayPiece)> = Vec::new();
        let mut clock_of = vec![None; network.delays.len()];
        for index in network.used_delays() {
            let delay = &network.delays[index];
            let clock = clocks.iter().position(|(known, _)| network.delays[*known] == *delay);
            clock_of[index] = Some(clock.unwrap_or_else(|| {
                clocks.push((index, delay.first_piece()));
                clocks.len() - 1
            }));
        }
        let mut timeline = Timeline {
            network,
            segments,
            segment,
            clocks,
            clock_of,
            images: BinaryHeap::new(),
            second_waiting: 0,
            generations,
            end_s,
            arrivals: Vec::new(),
            kinks_s: network.weights.iter().flat_map(|weight| weight.kinks_s().iter().copied()).collect(),
        };
        timeline.kinks_s.sort_by(|a, b| b.total_cmp(a));
        if generations > 0 {
            timeline.send_images(0.0, 0);
        }
        timeline
    }

    /// Index of the graph in force.
    pub(crate) fn graph(&self) -> usize {
        self.segment.graph
    }

    /// T(t) of one delay, by the formula in force.
    #[inline(always)]
    pub(crate) fn delay_s(&self, clock: usize, t_s: f64) -> f64 {
        let (index, piece) = self.clocks[clock];
        self.network.delays[index].value_on(piece, t_s)
    }

    /// The clock of a delay, by the delay's index.
    pub(crate) fn clock_of(&self, delay: usize) -> Option<usize> {
        *self.clock_of.get(delay)?
    }

    /// When what is heard at `t_s` through one delay was sent, by the formula in force.
    #[inline(always)]
    pub(crate) fn sent_s(&self, clock: usize, t_s: f64) -> f64 {
        let (index, piece) = self.clocks[clock];
        self.network.delays[index].sent_on(piece, t_s)
    }

    /// The index of the delay of a clock.
    pub(crate) fn delay_of(&self, clock: usize) -> usize {
        self.clocks[clock].0
    }

    /// Whether what is heard through a delay is older than the step that begins: held packets always are.
    pub(crate) fn is_held(&self, clock: usize) -> bool {
        self.clocks[clock].1.held_s.is_some()
    }

    /// The value of a weight at `t_s`.
    pub(crate) fn weight(&self, weight: Weight, t_s: f64) -> f64 {
        self.network.weight_at(weight, t_s)
    }

    /// The next break-point, s; the horizon when nothing comes before it. What rounding puts just before the horizon
    /// happens at the horizon, which is seen from the left.
    pub(crate) fn next_s(&self) -> f64 {
        let kink_s = self.kinks_s.last().copied().unwrap_or(f64::INFINITY);
        let mut next = self.end_s.min(self.segment.end_s).min(kink_s);
        for (_, piece) in &self.clocks {
            next = next.min(piece.end_s);
        }
        if let Some(Reverse(image)) = self.images.peek() {
            next = next.min(image.t_s);
        }
        self.or_horizon(next)
    }

    /// The horizon for what happens a rounding before it.
    pub(crate) fn or_horizon(&self, t_s: f64) -> f64 {
        if t_s >= self.end_s - merge_s(self.end_s) { self.end_s } else { t_s }
    }

    /// Moves past everything that happens at `t_s`.
    pub(crate) fn pass(&mut self, t_s: f64) -> Passed {
        let merge = merge_until(t_s);
        let mut passed = Passed::default();
        while self.segment.end_s <= merge {
            match self.segments.next() {
                Some(segment) => self.segment = segment,
                None => self.segment.end_s = f64::INFINITY,
            }
            passed = Passed { switched: true, jumped: true };
        }
        for (index, piece) in &mut self.clocks {
            while piece.end_s <= merge {
                *piece = self.network.delays[*index].next_piece(*piece);
                passed.jumped = true;
            }
        }
        // A weight is continuous: that a step ends here is enough.
        while self.kinks_s.pop_if(|kink_s| *kink_s <= merge).is_some() {}
        let mut generation = if passed.jumped { 0 } else { u8::MAX };
        while let Some(Reverse(image)) = self.images.peek().copied() {
            if image.t_s > merge {
                break;
            }
            self.images.pop();
            self.second_waiting -= usize::from(image.generation == 2);
            generation = generation.min(image.generation);
        }
        if generation < self.generations {
            self.send_images(t_s, generation);
        }
        passed
    }

    /// Notes when a break-point at `t_s` will be heard.
    pub(crate) fn send_images(&mut self, t_s: f64, generation: u8) {
        let generation = generation + 1;
        let mut arrivals = std::mem::take(&mut self.arrivals);
        for (index, _) in &self.clocks {
            arrivals.clear();
            self.network.delays[*index].arrivals(t_s, self.end_s, &mut arrivals);
            for &arrival in &arrivals {
                let budget_left = generation < 2 || self.second_waiting < SECOND_GENERATION_BUDGET;
                if arrival > t_s + MERGE_S && arrival < self.end_s && budget_left {
                    self.second_waiting += usize::from(generation == 2);
                    self.images.push(Reverse(Image { t_s: arrival, generation }));
                }
            }
        }
        self.arrivals = arrivals;
    }
}

/// What happens up to here happens at `t_s`.
pub(crate) fn merge_until(t_s: f64) -> f64 {
    t_s + merge_s(t_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::{Delay, PiecewiseConstant, SawTooth};
    use crate::graph::Edge;
    use crate::schedule::{Phase, Schedule};

    fn break_points(network: &Network, end_s: f64, generations: u8) -> Vec<f64> {
        let mut timeline = Timeline::new(network, end_s, generations);
        let mut out = Vec::new();
        loop {
            let next = timeline.next_s();
            if next >= end_s {
                return out;
            }
            out.push((next * 1e9).round() / 1e9);
            timeline.pass(next);
        }
    }

    fn network(delay: Delay) -> Network {
        let edge = |from, to| Edge { from, to, weight: 1.0.into(), delay: 0 };
        let schedule = Schedule::periodic(vec![
            Phase { edges: vec![edge(0, 1)], dwell_s: 1.0 },
            Phase { edges: vec![edge(1, 0)], dwell_s: 1.0 },
        ]);
        Network { agents: 2, schedule, delays: vec![delay], weights: Vec::new(), coupling: Default::default() }
    }

    #[test]
    fn switches_and_their_images_are_landed_on() {
        let network = network(Delay::constant(0.3));
        assert_eq!(break_points(&network, 2.5, 1), vec![0.3, 1.0, 1.3, 2.0, 2.3]);
        assert_eq!(break_points(&network, 2.5, 2), vec![0.3, 0.6, 1.0, 1.3, 1.6, 2.0, 2.3]);
    }

    #[test]
    fn regress_nothing_happens_a_rounding_before_the_horizon() {
        // What the first delay's jump at 3 · 1.7 + 0.8 sends is heard 0.5 s later, a rounding before 6.4, where the saw-tooth
        // jumps. Landing on it made the two one event, and the row at the horizon showed what is heard after the jump.
        let edge = |delay| Edge { from: 0, to: 1, weight: 1.0.into(), delay };
        let steps =
            Delay::new(PiecewiseConstant { times_s: vec![0.0, 0.8], values_s: vec![0.2, 0.5], period_s: Some(1.7) });
        let saw_tooth = Delay::new(SawTooth { min_s: 0.1, max_s: 0.3, period_s: 0.8, offset_s: 0.0 });
        let network = Network {
            agents: 2,
            schedule: Schedule::fixed(vec![edge(0), edge(1)]),
            delays: vec![steps, saw_tooth],
            weights: Vec::new(),
            coupling: Default::default(),
        };
        let mut longer = Timeline::new(&network, 10.0, 1);
        while longer.next_s() < 6.3 {
            longer.pass(longer.next_s());
        }
        assert!((6.4 - 1e-12..6.4).contains(&longer.next_s()));

        let mut timeline = Timeline::new(&network, 6.4, 1);
        while timeline.next_s() < 6.4 {
            assert!(timeline.next_s() < 6.4 - 1e-6);
            timeline.pass(timeline.next_s());
        }
        assert!((timeline.delay_s(1, 6.4) - 0.3).abs() < 1e-12);
    }

    #[test]
    fn coinciding_events_are_one() {
        // 0.1 + 0.2 is not 0.3 in binary; the image of 0 and the jump at 0.3 are one event all the same.
        let delay =
            Delay::new(PiecewiseConstant { times_s: vec![0.0, 0.1 + 0.2], values_s: vec![0.3, 0.3], period_s: None });
        assert_eq!(break_points(&network(delay), 0.9, 1), vec![0.3, 0.6]);
    }
}
