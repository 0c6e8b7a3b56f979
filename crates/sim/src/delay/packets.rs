//! Links that carry packets: sent at their own times, late, lost, overtaken.
//!
//! A receiver keeps the message with the latest *send* time among those that have arrived; a packet that was overtaken is
//! dropped when it comes. So what is heard only ever gets newer, and between two arrivals the delay grows like t.
//!
//! ```
//! use forwardstep_sim::delay::{Delay, Loss, PacketLink};
//!
//! let radio = PacketLink {
//!     every_s: 0.02,
//!     first_s: 0.0,
//!     latency_s: 0.03,
//!     jitter_s: 0.05,
//!     loss: Loss::Random { probability: 0.2 },
//!     most_in_a_row: None,
//!     seed: 7,
//! };
//! // The link from agent 0 to agent 1 for ten seconds.
//! let trace = radio.trace((0, 1), 10.0)?;
//! let statistics = trace.statistics();
//! assert_eq!(statistics.sent, 501);
//! assert!(statistics.lost > 40 && statistics.late > 40);
//! let delay = Delay::new(trace);
//! assert!(delay.value(5.0) >= 0.03);
//! # Ok::<(), forwardstep_sim::delay::packets::PacketError>(())
//! ```

use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use thiserror::Error;

use super::{Arrivals, Basis, DelayFunction, DelayPiece, Known, Refuted, Unknown};
use crate::quantity::{QuantityError, few, not_negative, positive, within};

/// A link as a random process. Every pair of agents has its own stream of random numbers, which depends on the seed and on
/// the two agents alone: neither other links nor the graph in force change it. Whether the k-th packet is lost depends on
/// `loss` and `most_in_a_row` besides, but on no time: not on the latency, the jitter, or when packets are sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PacketLink {
    /// From one packet to the next, s.
    pub every_s: f64,
    /// When the first is sent, s; at most `every_s`.
    pub first_s: f64,
    /// The least time that a packet takes, s.
    pub latency_s: f64,
    /// A packet takes up to this much longer, each time equally likely, s. When it exceeds `every_s` packets overtake each
    /// other.
    pub jitter_s: f64,
    /// How packets are lost.
    pub loss: Loss,
    /// No more packets than this are lost one after another; the next one then arrives.
    pub most_in_a_row: Option<u32>,
    /// The same seed gives the same packets.
    pub seed: u64,
}

/// How packets are lost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Loss {
    /// None is.
    Never,
    /// Each by itself.
    Random {
        /// From 0 to 1.
        probability: f64,
    },
    /// In bursts, as Gilbert described them: the link is good or bad, and loses every packet while it is bad. It is good
    /// before the first packet. In the long run enter / (enter + leave) of the packets are lost, 1 / leave at a time.
    Bursts {
        /// How likely a good link is bad at the next packet, from 0 to 1.
        enter: f64,
        /// How likely a bad link is good at the next packet, above 0, up to 1.
        leave: f64,
    },
}

/// One packet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Packet {
    /// When it was sent, s.
    pub send_s: f64,
    /// How long it took, s; none if it was lost.
    pub delay_s: Option<f64>,
}

/// Why packets make no link.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PacketError {
    /// A parameter out of its range.
    #[error(transparent)]
    Quantity(#[from] QuantityError),
    /// A packet whose times are no times.
    #[error("packet {packet} was sent at {send_s} s and took {delay_s} s; both must be finite and not negative")]
    Times {
        /// Its number from zero.
        packet: usize,
        /// When it was sent, s.
        send_s: f64,
        /// How long it took, s.
        delay_s: f64,
    },
    /// Packets that do not follow one another.
    #[error("packet {packet}, sent at {send_s} s, does not come after the one before it")]
    Order {
        /// Its number from zero.
        packet: usize,
        /// When it was sent, s.
        send_s: f64,
    },
}

/// Packets and values of random holds on all links of a network together; forty bytes each.
const MOST_DRAWN: f64 = 5e6;

/// How many packets and values of random holds the links of a network have so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drawn(f64);

impl Drawn {
    /// Counts `more` of `what` besides.
    ///
    /// # Errors
    /// [`QuantityError`] when all of them together exceed any memory.
    pub fn add(&mut self, what: &'static str, more: f64) -> Result<(), QuantityError> {
        self.0 += more;
        few("", what, more, (what, self.0, MOST_DRAWN))
    }
}

impl PacketLink {
    /// Checks the parameters.
    ///
    /// # Errors
    /// [`QuantityError`] for the first that is out of its range.
    pub fn check(&self) -> Result<(), QuantityError> {
        let share = |at: &'static str, key, value| within(at, key, value, 0.0, 1.0);
        positive("", "period_s", self.every_s)?;
        within("", "first_s", self.first_s, 0.0, self.every_s)?;
        not_negative("", "latency_s", self.latency_s)?;
        not_negative("", "jitter_s", self.jitter_s)?;
        match self.loss {
            Loss::Never => Ok(()),
            Loss::Random { probability } => share("loss.random", "probability", probability),
            Loss::Bursts { enter, leave } => {
                share("loss.bursts", "enter", enter)?;
                positive("loss.bursts", "leave", leave)?;
                share("loss.bursts", "leave", leave)
            }
        }
    }

    /// How many packets are sent up to `until_s`, which counts.
    pub fn packets(&self, until_s: f64) -> f64 {
        if until_s < self.first_s { 0.0 } else { ((until_s - self.first_s) / self.every_s).floor() + 1.0 }
    }

    /// No message is older than this when it is heard, s; infinite when any number of packets may be lost in a row.
    ///
    /// With at most n lost in a row, packets that arrive were sent at most (n + 1) · every apart, the first of them at
    /// most (n + 1) · every after t = 0. Let s be the latest send time of those with s + latency + jitter ≤ t: that packet
    /// has arrived for sure, so what is heard is no older. The next that arrives, s' ≤ s + (n + 1) · every, has
    /// s' + latency + jitter > t. Hence t − s < (n + 1) · every + latency + jitter.
    pub fn bound_s(&self) -> f64 {
        let lost = match (self.loss, self.most_in_a_row) {
            (Loss::Never, _) => 0.0,
            (Loss::Random { probability: 0.0 }, _) | (Loss::Bursts { enter: 0.0, .. }, _) => 0.0,
            // Every burst ends with its first packet.
            (Loss::Bursts { leave: 1.0, .. }, most) => most.map_or(1.0, |most| f64::from(most).min(1.0)),
            (_, Some(most)) => f64::from(most),
            (_, None) => f64::INFINITY,
        };
        (lost + 1.0) * self.every_s + self.latency_s + self.jitter_s
    }

    /// Whether every packet is lost for ever.
    pub fn loses_all(&self) -> bool {
        let never = matches!(self.loss, Loss::Random { probability } if probability >= 1.0);
        never && self.most_in_a_row.is_none()
    }

    /// The packets of the link between two agents (from, to) up to `until_s`, which counts.
    ///
    /// # Errors
    /// [`PacketError`] when a parameter is out of its range, or there are more packets than any memory holds.
    pub fn trace(&self, (from, to): (usize, usize), until_s: f64) -> Result<Trace, PacketError> {
        self.check()?;
        let packets = self.packets(until_s);
        Drawn::default().add("packets", packets)?;
        let mut draw = stream(Kind::Packets, self.seed, from, to);
        let (mut bad, mut in_a_row) = (false, 0);
        let mut sent = Vec::with_capacity(packets as usize);
        for k in 0..packets as u64 {
            let send_s = self.first_s + k as f64 * self.every_s;
            // Two numbers per packet, used or not.
            let (fate, share): (f64, f64) = (draw.random(), draw.random());
            bad = match self.loss {
                Loss::Never => false,
                Loss::Random { probability } => fate < probability,
                Loss::Bursts { enter, .. } if !bad => fate < enter,
                Loss::Bursts { leave, .. } => fate >= leave,
            };
            if bad && self.most_in_a_row.is_some_and(|most| in_a_row >= most) {
                bad = false;
            }
            in_a_row = if bad { in_a_row + 1 } else { 0 };
            let delay_s = (!bad).then_some(self.latency_s + share * self.jitter_s);
            sent.push(Packet { send_s, delay_s });
        }
        let trace = Trace::new(sent, until_s)?;
        Ok(Trace { link: Some(*self), ..trace })
    }
}

/// What random numbers are drawn for.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    Packets,
    Holds,
}

/// The random numbers of one ordered pair of agents, of one kind. The kind is part of the key, so that packets, holds and
/// whatever else is drawn with the same seed (the noise of sensors) have nothing in common.
pub(super) fn stream(kind: Kind, seed: u64, from: usize, to: usize) -> ChaCha8Rng {
    let name: &[u8; 8] = match kind {
        Kind::Packets => b"packets ",
        Kind::Holds => b"holds   ",
    };
    let mut key = [0; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8..16].copy_from_slice(name);
    let mut draw = ChaCha8Rng::from_seed(key);
    draw.set_stream((from as u64) << 32 | to as u64);
    draw
}

/// A stretch of time during which one message is heard.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Held {
    /// From its arrival on, s.
    from_s: f64,
    /// When it was sent, s; −∞ for the initial message.
    sent_s: f64,
}

/// The packets of one link up to the end of a run, and what is heard when.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    packets: Vec<Packet>,
    held: Vec<Held>,
    until_s: f64,
    max_s: f64,
    min_s: f64,
    link: Option<PacketLink>,
}

/// A link in a few numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkStatistics {
    /// Packets sent.
    pub sent: usize,
    /// Packets that never arrived.
    pub lost: usize,
    /// Packets that arrived until the end, but not before a newer one, and were dropped: after it or at the same instant.
    pub late: usize,
    /// The largest age of what was heard, s; before anything has arrived the initial message ages from t = 0.
    pub largest_age_s: f64,
}

impl Trace {
    /// Packets of one link in the order in which they were sent; those sent after `until_s`, the end of the run, are left
    /// out. A packet arrives at
    /// `send_s + delay_s` as floating-point numbers add.
    ///
    /// # Errors
    /// [`PacketError`] when a time is negative or not finite, or send times do not rise.
    pub fn new(mut packets: Vec<Packet>, until_s: f64) -> Result<Trace, PacketError> {
        for (packet, &Packet { send_s, delay_s }) in packets.iter().enumerate() {
            let delay_s = delay_s.unwrap_or(0.0);
            if !(send_s >= 0.0 && delay_s >= 0.0 && (send_s + delay_s).is_finite()) {
                return Err(PacketError::Times { packet, send_s, delay_s });
            }
            if packet > 0 && packets[packet - 1].send_s >= send_s {
                return Err(PacketError::Order { packet, send_s });
            }
        }
        packets.retain(|packet| packet.send_s <= until_s);
        let mut arrivals: Vec<Held> = packets
            .iter()
            .filter_map(|packet| Some(Held { from_s: packet.send_s + packet.delay_s?, sent_s: packet.send_s }))
            .filter(|held| held.from_s <= until_s)
            .collect();
        arrivals.sort_by(|a, b| a.from_s.total_cmp(&b.from_s).then(a.sent_s.total_cmp(&b.sent_s)));
        let mut held = vec![Held { from_s: 0.0, sent_s: f64::NEG_INFINITY }];
        for arrival in arrivals {
            let Some(last) = held.last_mut() else { break };
            if arrival.sent_s <= last.sent_s {
                continue;
            }
            // Of what arrives at one instant the newest counts.
            if arrival.from_s <= last.from_s { *last = arrival } else { held.push(arrival) }
        }
        let ends = held.iter().skip(1).map(|next| next.from_s).chain([until_s]);
        let ages = || held.iter().map(|held| held.from_s - held.sent_s.max(0.0));
        // Rounded up, so that no age computed on the way exceeds it.
        let oldest = ends.zip(&held).map(|(end_s, held)| end_s - held.sent_s.max(0.0)).fold(0.0, f64::max);
        let (max_s, min_s) = (oldest.next_up(), ages().fold(f64::INFINITY, f64::min));
        Ok(Trace { packets, held, until_s, max_s, min_s, link: None })
    }

    /// All packets, in the order in which they were sent, those that were lost among them.
    pub fn packets(&self) -> &[Packet] {
        &self.packets
    }

    /// The random process that they are drawn from; `None` for packets that were given.
    pub fn link(&self) -> Option<&PacketLink> {
        self.link.as_ref()
    }

    /// The end of the run that this was made for, s.
    pub fn until_s(&self) -> f64 {
        self.until_s
    }

    /// How many messages are heard, one after another; those that arrive late or after the end are not.
    pub fn arrivals(&self) -> usize {
        self.held.iter().filter(|held| held.sent_s >= 0.0).count()
    }

    /// What happened until the end of the run that this was made for.
    pub fn statistics(&self) -> LinkStatistics {
        let statistics = self.statistics_until(self.until_s);
        LinkStatistics { sent: self.packets.len(), largest_age_s: self.max_s, ..statistics }
    }

    /// What had happened by `t_s`, at which a run may have been stopped.
    pub fn statistics_until(&self, t_s: f64) -> LinkStatistics {
        let sent = self.packets.iter().take_while(|packet| packet.send_s <= t_s);
        let lost = sent.clone().filter(|packet| packet.delay_s.is_none()).count();
        let arrived = |packet: &&Packet| packet.delay_s.is_some_and(|delay_s| packet.send_s + delay_s <= t_s);
        let arrived = sent.clone().filter(arrived).count();
        let held = &self.held[..self.held.partition_point(|held| held.from_s <= t_s)];
        let heard = held.iter().filter(|held| held.sent_s >= 0.0).count();
        let ends = held.iter().skip(1).map(|next| next.from_s).chain([t_s]);
        let largest_age_s = ends.zip(held).map(|(end_s, held)| end_s - held.sent_s.max(0.0)).fold(0.0, f64::max);
        LinkStatistics { sent: sent.count(), lost, late: arrived.saturating_sub(heard), largest_age_s }
    }

    fn clamped(&self, index: u64) -> usize {
        (index as usize).min(self.held.len() - 1)
    }
}

impl DelayFunction for Trace {
    fn words(&self) -> &'static str {
        "packets"
    }

    /// It is made by a function that checks.
    fn validate(&self, _: f64) -> Result<(), QuantityError> {
        Ok(())
    }

    fn piece(&self, index: u64) -> DelayPiece {
        let k = self.clamped(index);
        let (held, end_s) = (self.held[k], self.held.get(k + 1).map_or(f64::INFINITY, |next| next.from_s));
        DelayPiece { held_s: Some(held.sent_s), ..DelayPiece::new(index, held.from_s, end_s) }
    }

    /// The age of the message that is held.
    fn value(&self, piece: &DelayPiece, t_s: f64) -> f64 {
        t_s - self.held[self.clamped(piece.index)].sent_s.max(0.0)
    }

    fn known(&self) -> Known {
        let run =
            Known { until_s: Some(self.until_s), holds_packets: true, ..Known::by_rule([self.min_s, self.max_s]) };
        let numbers = |unknown| Known { unknown: Some(unknown), basis: Basis::Numbers, ..run };
        match &self.link {
            Some(link) if link.bound_s().is_finite() => Known { bound_s: link.bound_s(), ..run },
            Some(link) if link.loses_all() => {
                Known { refuted: Some(Refuted::EveryPacketLost), ..numbers(Unknown::NothingArrived) }
            }
            _ if self.arrivals() == 0 => numbers(Unknown::NothingArrived),
            Some(_) => numbers(Unknown::PacketsInARow),
            None => numbers(Unknown::LaterPackets),
        }
    }

    /// What is held arrived when its piece began.
    fn arrivals(&self, _: &mut Arrivals<'_>) {}
}

#[cfg(test)]
mod tests;
