//! One period of a network, or one horizon, cut into steps on which its graph and every delay are in one piece.

use std::rc::Rc;

use forwardstep_sim::{Network, Setup};

use super::NoReferenceGains;
use super::agent::{Agent, Step};

/// A step, for all agents.
#[derive(Clone, Debug)]
pub(super) struct Cut {
    pub(super) length_s: f64,
    /// By agent: its step, and what it hears as parts of positions at nodes.
    pub(super) agents: Vec<(Rc<Step>, Vec<Tap>)>,
}

/// `share` of the position of an agent, so many nodes before the beginning of the step; −1 for its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tap {
    pub(super) from: usize,
    pub(super) back: i64,
    pub(super) share: f64,
}

/// A delay has a slope no closer to one than this where velocities are heard.
const LEAST_RATE: f64 = 0.02;

/// Where the network is cut.
pub(super) struct Nodes {
    /// From zero to the end, s.
    t_s: Vec<f64>,
    /// Whether it repeats itself after the last.
    repeats: bool,
}

impl Nodes {
    /// At least as fine as `longest_s`, and cut where the graph or a delay jumps or has a kink; `None` when there would be more than `most`.
    pub(super) fn of(network: &Network, end_s: f64, repeats: bool, longest_s: f64, most: usize) -> Option<Nodes> {
        let mut breaks = vec![0.0, end_s];
        if network.schedule.constant_graph().is_none() {
            breaks
                .extend(network.schedule.segments().map(|segment| segment.end_s).take_while(|t| *t < end_s).take(most));
        }
        for delay in network.used_delays().map(|index| &network.delays[index]).filter(|delay| !delay.is_constant()) {
            let mut piece = delay.first_piece();
            while piece.end_s < end_s && breaks.len() <= 4 * most {
                breaks.push(piece.end_s);
                piece = delay.next_piece(piece);
            }
        }
        breaks.sort_by(f64::total_cmp);
        // What rounding leaves between two breaks that are one.
        breaks.dedup_by(|b, a| *b - *a < 1e-9 * end_s);
        let mut t_s = vec![0.0];
        for pair in breaks.windows(2) {
            let pieces = ((pair[1] - pair[0]) / longest_s).ceil().max(1.0);
            if t_s.len() as f64 + pieces > most as f64 {
                return None;
            }
            t_s.extend((1..=pieces as usize).map(|k| pair[0] + (pair[1] - pair[0]) * k as f64 / pieces));
        }
        (t_s.len() > 1).then_some(Nodes { t_s, repeats })
    }

    pub(super) fn steps(&self) -> usize {
        self.t_s.len() - 1
    }

    /// The node at or before `t_s` and the share of the next one; `None` before all of them.
    fn place(&self, t_s: f64) -> Option<(i64, f64)> {
        let (end_s, steps) = (self.t_s[self.steps()], self.steps());
        let round = if self.repeats { (t_s / end_s).floor() } else { 0.0 };
        if !(round.abs() < 1e12 && (self.repeats || t_s >= 0.0)) {
            return None;
        }
        // Rounding may leave it below zero.
        let within = (t_s - round * end_s).max(0.0);
        let node = self.t_s.partition_point(|t| *t <= within).clamp(1, steps) - 1;
        let share = (within - self.t_s[node]) / (self.t_s[node + 1] - self.t_s[node]);
        Some((round as i64 * steps as i64 + node as i64, share.clamp(0.0, 1.0)))
    }

    /// All steps.
    ///
    /// # Errors
    /// [`NoReferenceGains::Held`], and [`NoReferenceGains::Unclear`] for numbers that are none.
    pub(super) fn cuts(&self, setup: &Setup, agents: &[Agent]) -> Result<Vec<Cut>, NoReferenceGains> {
        let network = &setup.network;
        let fixed = network.schedule.constant_graph();
        let mut segments = network.schedule.segments().peekable();
        let mut known: Vec<(usize, f64, f64, Rc<Step>)> = Vec::new();
        let mut cuts = Vec::with_capacity(self.steps());
        for (k, pair) in self.t_s.windows(2).enumerate() {
            let [from_s, to_s] = [pair[0], pair[1]];
            let (middle_s, length_s) = (0.5 * (from_s + to_s), to_s - from_s);
            while segments.next_if(|segment| segment.end_s <= middle_s).is_some() {}
            let graph = segments.peek().map_or(0, |segment| segment.graph);
            let edges = fixed.unwrap_or_else(|| network.schedule.graph(graph));
            let (mut degree, mut taps) = (vec![0.0; agents.len()], vec![Vec::new(); agents.len()]);
            for edge in edges {
                let weight = network.weight_at(edge.weight, middle_s);
                let heard = agents.get(edge.to).ok_or(NoReferenceGains::Unclear)?.heard.map(|a| a * weight);
                let delay = network.delays.get(edge.delay).ok_or(NoReferenceGains::Unclear)?;
                let piece = delay.piece_at(middle_s);
                let sent = [from_s, to_s].map(|t_s| delay.sent_on(piece, t_s).min(t_s));
                degree[edge.to] += weight;
                self.hear(k, edge.from, heard, sent, length_s, &mut taps[edge.to])?;
            }
            let mut all = Vec::with_capacity(agents.len());
            for (index, taps) in taps.into_iter().enumerate() {
                let same = |(of, d, h, _): &&(usize, f64, f64, Rc<Step>)| {
                    agents[*of] == agents[index] && *d == degree[index] && (h - length_s).abs() < 1e-12 * length_s
                };
                let step = match known.iter().find(same) {
                    Some((.., step)) => Rc::clone(step),
                    None => {
                        let step =
                            Rc::new(agents[index].step(degree[index], length_s).ok_or(NoReferenceGains::Unclear)?);
                        known.truncate(64);
                        known.push((index, degree[index], length_s, Rc::clone(&step)));
                        step
                    }
                };
                all.push((step, taps));
            }
            cuts.push(Cut { length_s, agents: all });
        }
        Ok(cuts)
    }

    /// The mean over step `k` of a₀ q_j + a₁ q̇_j as it was between two instants: that of q by its ends, that of q̇ by their difference.
    fn hear(
        &self,
        k: usize,
        from: usize,
        [a0, a1]: [f64; 2],
        sent: [f64; 2],
        length_s: f64,
        taps: &mut Vec<Tap>,
    ) -> Result<(), NoReferenceGains> {
        let span = sent[1] - sent[0];
        if a1 != 0.0 && span <= LEAST_RATE * length_s {
            return Err(NoReferenceGains::Held);
        }
        let slope = if a1 == 0.0 { 0.0 } else { a1 / span };
        for (end_s, share) in sent.into_iter().zip([0.5 * a0 - slope, 0.5 * a0 + slope]) {
            if let Some((node, next)) = self.place(end_s) {
                let back = k as i64 - node;
                taps.push(Tap { from, back, share: share * (1.0 - next) });
                if next > 0.0 {
                    taps.push(Tap { from, back: back - 1, share: share * next });
                }
            }
        }
        Ok(())
    }
}
