//! The weighted sums of delayed messages at one instant, gathered for all agents at once.

use std::ops::Range;

use forwardstep_core::{Kernel, dispatch};

use super::history::{History, Place};
use super::kernels::{columns, evaluate, fma};
use super::tableau::basis;
use super::timeline::Timeline;
use crate::coupling::Coupling;
use crate::graph::{Edge, Weight};

/// Where an agent's message stands in the state and where its sums go.
///
/// Agents of one population are interleaved: entry c of an agent's message is at `state + c · stride`. In what is heard,
/// and in a column of a piece of history, it is at `entry + c · stride`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Port {
    /// Index of the first transmitted number in the state.
    pub(crate) state: usize,
    /// Index of the first entry among all that are sent, and among [`Heard::sums`].
    pub(crate) entry: usize,
    /// Index in [`Heard::degree`].
    pub(crate) degree: usize,
    /// Distance between consecutive entries.
    pub(crate) stride: usize,
}

/// What all agents hear.
#[derive(Clone, Debug)]
pub(crate) struct Heard {
    /// Σ_j w_ij.
    pub(crate) degree: Vec<f64>,
    /// Σ_j w_ij · message_j(t − T_ij).
    pub(crate) sums: Vec<f64>,
}

/// An edge with everything looked up.
#[derive(Clone, Copy, Debug)]
struct Link {
    sender: usize,
    receiver: usize,
    weight: f64,
    /// Index into [`DelayedInputs::sources`].
    source: usize,
}

/// One delay that is in use by the graph in force.
#[derive(Clone, Copy, Debug)]
struct Source {
    clock: usize,
    cursor: u64,
    read: Read,
}

/// Where the messages of one delay come from at the instant looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Read {
    Initial,
    /// No delay at all: the state itself.
    Now,
    Piece {
        offset: usize,
        basis: [f64; 4],
    },
    /// A message as it was sent.
    Sample {
        offset: usize,
    },
    /// It is too old: its sender does not count.
    Silent,
    /// A delay that is not what its author says.
    Nowhere,
}

/// A value of a delay outside of what its author says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Refuted {
    /// Index of the delay.
    pub(crate) delay: usize,
    /// When, s.
    pub(crate) t_s: f64,
}

/// Which messages an instant needs that are not history yet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Needs {
    /// Some delay is zero: the sums depend on the state handed over.
    pub(crate) present: bool,
    /// Some delay is shorter than the step: the sums depend on the draft of the current piece.
    pub(crate) draft: bool,
}

/// A receiver with a weight that changes.
#[derive(Debug)]
struct Varying {
    /// Index in [`Heard::degree`].
    degree: usize,
    /// Σ_j w_ij at the instant looked at.
    sum: f64,
    /// Its links.
    links: Range<usize>,
}

/// The network in force, ready to gather.
#[derive(Debug)]
pub(crate) struct DelayedInputs {
    ports: Vec<Port>,
    /// Entries of one message.
    entries: usize,
    /// States that are sent, in runs: (first state, first entry, how many).
    blocks: Vec<(usize, usize, usize)>,
    links: Vec<Link>,
    /// Receiver, sender and weight of each as the graph has them, if any weight changes.
    weights: Vec<(usize, usize, Weight)>,
    varying: Vec<Varying>,
    sources: Vec<Source>,
    initial: Vec<f64>,
    coupling: Coupling,
    refuted: Option<Refuted>,
}

impl DelayedInputs {
    /// `entries` numbers are sent by every agent; `x` is the state at t = 0, which everybody is taken to have sent before.
    pub(crate) fn new(ports: Vec<Port>, entries: usize, x: &[f64], coupling: Coupling) -> Self {
        let mut sent: Vec<(usize, usize)> =
            ports.iter().flat_map(|p| (0..entries).map(|c| (p.entry + c * p.stride, p.state + c * p.stride))).collect();
        sent.sort_unstable();
        let mut blocks: Vec<(usize, usize, usize)> = Vec::new();
        for &(entry, state) in &sent {
            match blocks.last_mut() {
                Some((first, _, n)) if *first + *n == state => *n += 1,
                _ => blocks.push((state, entry, 1)),
            }
        }
        // What sampled controllers compute is not in the state; their first messages are read as they are sent.
        let initial = sent.iter().map(|(_, state)| x.get(*state).copied().unwrap_or(0.0)).collect();
        DelayedInputs {
            ports,
            entries,
            blocks,
            links: Vec::new(),
            weights: Vec::new(),
            varying: Vec::new(),
            sources: Vec::new(),
            initial,
            coupling,
            refuted: None,
        }
    }

    /// What everybody sent before t = 0, where that is not the state at t = 0: a message of every agent.
    pub(crate) fn told_before(&mut self, messages: &[Vec<f64>]) {
        for (port, message) in self.ports.iter().zip(messages) {
            for (c, value) in message.iter().take(self.entries).enumerate() {
                self.initial[port.entry + c * port.stride] = *value;
            }
        }
    }

    /// The last value of a delay that was outside of what its author says. What is heard there is not a number.
    pub(crate) fn refuted(&self) -> Option<Refuted> {
        self.refuted
    }

    /// Numbers that are sent by all agents together: the height of a column of a piece of history.
    pub(crate) fn width(&self) -> usize {
        self.initial.len()
    }

    /// States that are sent, in runs: (first state, first entry, how many).
    pub(crate) fn blocks(&self) -> &[(usize, usize, usize)] {
        &self.blocks
    }

    /// Takes the edges of the graph in force.
    pub(crate) fn rewire(&mut self, timeline: &Timeline<'_>, edges: &[Edge], heard: &mut Heard) {
        self.links.clear();
        self.sources.clear();
        heard.degree.fill(0.0);
        for edge in edges {
            let Some(clock) = timeline.clock_of(edge.delay) else { continue };
            let source = self.sources.iter().position(|source| source.clock == clock).unwrap_or_else(|| {
                self.sources.push(Source { clock, cursor: u64::MAX, read: Read::Initial });
                self.sources.len() - 1
            });
            // A weight that changes is looked up anew at every instant.
            let weight = edge.weight.constant().unwrap_or(0.0);
            self.links.push(Link { sender: edge.from, receiver: edge.to, weight, source });
        }
        // Receivers in order, senders in order within: sums do not depend on how a file lists its edges.
        self.links.sort_by_key(|link| (link.receiver, link.sender));
        for link in &self.links {
            heard.degree[self.ports[link.receiver].degree] += link.weight;
        }
        self.rewire_varying(edges.iter().filter(|edge| timeline.clock_of(edge.delay).is_some()));
    }

    /// Finds the receivers with weights that change.
    fn rewire_varying<'a>(&mut self, edges: impl Iterator<Item = &'a Edge> + Clone) {
        self.weights.clear();
        self.varying.clear();
        if edges.clone().all(|edge| edge.weight.constant().is_some()) {
            return;
        }
        self.weights.extend(edges.map(|edge| (edge.to, edge.from, edge.weight)));
        self.weights.sort_unstable_by_key(|(to, from, _)| (*to, *from));
        let mut start = 0;
        for receiver in self.links.chunk_by(|a, b| a.receiver == b.receiver) {
            let links = start..start + receiver.len();
            start = links.end;
            if self.weights[links.clone()].iter().any(|(_, _, weight)| weight.constant().is_none()) {
                let degree = self.ports[receiver[0].receiver].degree;
                self.varying.push(Varying { degree, sum: 0.0, links });
            }
        }
    }

    /// Evaluates the weights that change.
    fn weigh(&mut self, timeline: &Timeline<'_>, t_s: f64) {
        for varying in &mut self.varying {
            varying.sum = 0.0;
            for (link, (_, _, weight)) in
                self.links[varying.links.clone()].iter_mut().zip(&self.weights[varying.links.clone()])
            {
                link.weight = timeline.weight(*weight, t_s);
                varying.sum += link.weight;
            }
        }
    }

    /// The shortest delay at `t_s` that is not zero; infinite when there is none.
    pub(crate) fn shortest_delay(&self, timeline: &Timeline<'_>, t_s: f64) -> f64 {
        let ahead = self.sources.iter().filter(|source| !timeline.is_held(source.clock));
        let delays = ahead.map(|source| timeline.delay_s(source.clock, t_s));
        delays.filter(|delay| *delay > 0.0).fold(f64::INFINITY, f64::min)
    }

    /// Looks up where every message comes from at `t_s`; `draft` is (start, length, offset) of the piece being made.
    #[inline(always)]
    pub(crate) fn look(
        &mut self,
        timeline: &Timeline<'_>,
        history: &History,
        t_s: f64,
        (start_s, length_s, offset): (f64, f64, usize),
    ) -> Needs {
        if !self.varying.is_empty() {
            self.weigh(timeline, t_s);
        }
        // A nonlinear coupling compares with what the receiver is now.
        let mut needs = Needs { present: !self.coupling.is_linear() && !self.links.is_empty(), draft: false };
        for source in &mut self.sources {
            let sent_s = timeline.sent_s(source.clock, t_s);
            // What arrives a rounding later is heard now, and was sent now.
            source.read = if sent_s.is_nan() {
                self.refuted = Some(Refuted { delay: timeline.delay_of(source.clock), t_s });
                Read::Nowhere
            } else if sent_s >= t_s {
                needs.present = true;
                Read::Now
            } else {
                match history.find(sent_s, &mut source.cursor) {
                    Place::Before => Read::Initial,
                    Place::Piece { offset, theta } => Read::Piece { offset, basis: basis(theta) },
                    Place::Ahead => {
                        needs.draft = true;
                        let theta = (sent_s - start_s) / length_s;
                        Read::Piece { offset, basis: basis(theta.clamp(0.0, 1.0)) }
                    }
                }
            };
        }
        needs
    }

    /// Looks up where every message comes from at the sample at `t_s`; `place` says where what was sent by then stands, unless it is
    /// too old. Whether anything is.
    pub(crate) fn look_at_samples(
        &mut self,
        timeline: &Timeline<'_>,
        t_s: f64,
        place: impl Fn(f64) -> Option<usize>,
    ) -> bool {
        if !self.varying.is_empty() {
            self.weigh(timeline, t_s);
        }
        for source in &mut self.sources {
            let sent_s = timeline.sent_s(source.clock, t_s);
            source.read = if sent_s.is_nan() {
                self.refuted = Some(Refuted { delay: timeline.delay_of(source.clock), t_s });
                Read::Nowhere
            } else {
                place(sent_s).map_or(Read::Silent, |offset| Read::Sample { offset })
            };
        }
        self.sources.iter().any(|source| source.read == Read::Silent)
    }

    /// Adds up the weights of all that count at the sample looked at.
    pub(crate) fn count(&self, heard: &mut Heard) {
        heard.degree.fill(0.0);
        for link in self.links.iter().filter(|link| self.sources[link.source].read != Read::Silent) {
            heard.degree[self.ports[link.receiver].degree] += link.weight;
        }
    }

    /// Adds up what was looked up; `x` is the state at that instant.
    pub(crate) fn gather(&self, history: &History, x: &[f64], heard: &mut Heard) {
        self.gather_from(history.data(), x, None, heard);
    }

    /// Adds up what was looked up in `data`, where at `own` everybody's present message stands if it is not in `x`.
    pub(crate) fn gather_from(&self, data: &[f64], x: &[f64], own: Option<usize>, heard: &mut Heard) {
        for varying in &self.varying {
            heard.degree[varying.degree] = varying.sum;
        }
        if !self.coupling.is_linear() {
            return self.gather_coupled(data, x, own, &mut heard.sums);
        }
        dispatch(Gather { hearing: self, data, x, sums: &mut heard.sums });
    }
}

impl DelayedInputs {
    /// The same under a nonlinear coupling: what is heard is taken to be nearer to the receiver.
    fn gather_coupled(&self, data: &[f64], x: &[f64], own: Option<usize>, sums: &mut [f64]) {
        let width = self.width();
        sums.fill(0.0);
        for link in &self.links {
            let (from, to) = (self.ports[link.sender], self.ports[link.receiver]);
            for c in 0..self.entries {
                let at = from.entry + c * from.stride;
                let heard = match self.sources[link.source].read {
                    Read::Piece { offset, basis } => {
                        let [r1, r2, r3, r4, r5] = columns(&data[offset..offset + 5 * width], width);
                        evaluate([r1[at], r2[at], r3[at], r4[at], r5[at]], basis)
                    }
                    Read::Sample { offset } => data[offset + at],
                    Read::Now => x[from.state + c * from.stride],
                    Read::Initial => self.initial[at],
                    Read::Nowhere => f64::NAN,
                    Read::Silent => continue,
                };
                let entry = to.entry + c * to.stride;
                let own = own.map_or_else(|| x[to.state + c * to.stride], |offset| data[offset + entry]);
                sums[entry] = fma(link.weight, self.coupling.taken(own, heard), sums[entry]);
            }
        }
    }
}

struct Gather<'a> {
    hearing: &'a DelayedInputs,
    data: &'a [f64],
    x: &'a [f64],
    sums: &'a mut [f64],
}

impl Kernel for Gather<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Gather { hearing, data, x, sums } = self;
        let width = hearing.width();
        sums.fill(0.0);
        for link in &hearing.links {
            let (from, to, w) = (hearing.ports[link.sender], hearing.ports[link.receiver], link.weight);
            match hearing.sources[link.source].read {
                Read::Piece { offset, basis } => {
                    let [r1, r2, r3, r4, r5] = columns(&data[offset..offset + 5 * width], width);
                    for c in 0..hearing.entries {
                        let at = from.entry + c * from.stride;
                        let value = evaluate([r1[at], r2[at], r3[at], r4[at], r5[at]], basis);
                        let sum = &mut sums[to.entry + c * to.stride];
                        *sum = fma(w, value, *sum);
                    }
                }
                Read::Sample { offset } => {
                    for c in 0..hearing.entries {
                        let sum = &mut sums[to.entry + c * to.stride];
                        *sum = fma(w, data[offset + from.entry + c * from.stride], *sum);
                    }
                }
                Read::Now => {
                    for c in 0..hearing.entries {
                        let sum = &mut sums[to.entry + c * to.stride];
                        *sum = fma(w, x[from.state + c * from.stride], *sum);
                    }
                }
                Read::Initial => {
                    for c in 0..hearing.entries {
                        let sum = &mut sums[to.entry + c * to.stride];
                        *sum = fma(w, hearing.initial[from.entry + c * from.stride], *sum);
                    }
                }
                Read::Nowhere => {
                    for c in 0..hearing.entries {
                        sums[to.entry + c * to.stride] = f64::NAN;
                    }
                }
                Read::Silent => {}
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn history_is_as_wide_as_what_is_sent() {
        // Two populations: two agents side by side with ten states each, then one with five; two numbers are sent.
        let port = |state, entry, degree, stride| Port { state, entry, degree, stride };
        let ports = vec![port(0, 0, 0, 2), port(1, 1, 1, 2), port(20, 4, 2, 1)];
        let hearing = DelayedInputs::new(ports, 2, &[0.0; 25], Coupling::Linear);
        assert_eq!(hearing.width(), 6);
        assert_eq!(hearing.blocks(), [(0, 0, 4), (20, 4, 2)]);
    }
}
