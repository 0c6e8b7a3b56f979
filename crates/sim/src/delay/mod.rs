//! Communication delays T(t), evaluated at reception.
//!
//! A [`Delay`] is one [`DelayFunction`], which is smooth on *pieces*; it may jump from one to the next. The integrator lands on
//! every piece's end and keeps to one piece during a step, so that a jump has a left and a right side.
//!
//! Links that carry packets hold the newest message that has arrived until a newer one does ([`packets`]): a saw-tooth of
//! slope one, drawn for every edge from a stream of its own. So are the values of a [`RandomHold`].
//!
//! A delay from outside comes through the same trait. What its author says of it is [`Basis::Declared`], is probed
//! ([`Delay::probe`]), and a value outside the declared bounds is no delay: the run breaks down there.
//!
//! ```
//! use forwardstep_sim::quantity::QuantityError;
//! use forwardstep_sim::delay::{Arrivals, Delay, DelayFunction, DelayPiece, Known};
//!
//! /// T = 0.2 + 0.1 sin t².
//! #[derive(Debug, PartialEq)]
//! struct Chirp;
//!
//! impl DelayFunction for Chirp {
//!     fn words(&self) -> &'static str {
//!         "a chirp"
//!     }
//!     fn validate(&self, _: f64) -> Result<(), QuantityError> {
//!         Ok(())
//!     }
//!     fn piece(&self, _: u64) -> DelayPiece {
//!         DelayPiece::WHOLE
//!     }
//!     fn value(&self, _: &DelayPiece, t_s: f64) -> f64 {
//!         0.2 + 0.1 * (t_s * t_s).sin()
//!     }
//!     fn known(&self) -> Known {
//!         Known::declared([0.1, 0.3])
//!     }
//!     fn arrivals(&self, search: &mut Arrivals<'_>) {
//!         let [_, to] = search.span_s();
//!         search.within_slope(0.2 * to);
//!     }
//! }
//!
//! let chirp = Delay::new(Chirp);
//! assert_eq!(chirp.probe(10.0), Ok(()));
//! let mut heard = Vec::new();
//! chirp.arrivals(1.0, 10.0, &mut heard);
//! assert!(heard.iter().all(|t| (t - chirp.value(*t) - 1.0).abs() < 1e-12) && !heard.is_empty());
//! ```

mod arrivals;
mod constant;
mod course;
mod formula;
mod hold_log;
mod known;
pub mod packets;
mod piecewise_constant;
mod probe;
mod random_hold;
mod saw_tooth;
mod sinusoid;

use std::any::{Any, TypeId};
use std::fmt::Debug;
use std::sync::Arc;

use crate::formula::BoundedFormula;
use crate::quantity::{QuantityError, not_negative, such};
use crate::same::Same;
pub use arrivals::Arrivals;
pub use constant::Constant;
pub use course::SentOver;
pub use hold_log::HoldLog;
pub use known::{Basis, Known, Refuted, Unknown};
pub use packets::{Drawn, Loss, Packet, PacketLink, Trace};
pub use piecewise_constant::PiecewiseConstant;
pub use probe::DelayFault;
pub use random_hold::RandomHold;
pub use saw_tooth::SawTooth;
pub use sinusoid::Sinusoid;

/// The delays that come with forwardstep. What any other says of itself is declared by its author.
fn is_shipped(function: TypeId) -> bool {
    [
        TypeId::of::<Constant>(),
        TypeId::of::<Sinusoid>(),
        TypeId::of::<PiecewiseConstant>(),
        TypeId::of::<SawTooth>(),
        TypeId::of::<BoundedFormula>(),
        TypeId::of::<RandomHold>(),
        TypeId::of::<HoldLog>(),
        TypeId::of::<Trace>(),
    ]
    .contains(&function)
}

/// A delay as a function of time, the same whenever it is asked; all of its values are non-negative and finite.
pub trait DelayFunction: Same + Debug + Send + Sync {
    /// What it is called in messages, as in `a saw-tooth`.
    fn words(&self) -> &'static str;

    /// Checks the parameters for a run of `end_s`, under the keys that they have in scenario files.
    ///
    /// # Errors
    /// [`QuantityError`] for the first that makes no sense.
    fn validate(&self, end_s: f64) -> Result<(), QuantityError>;

    /// A stretch of time on which it is smooth; number zero holds t = 0, and each begins where the one before it ends. The
    /// last has no end, and stands for all numbers after its own.
    fn piece(&self, index: u64) -> DelayPiece;

    /// T(t), s, by the formula of `piece`, which also gives the one-sided values at its ends.
    fn value(&self, piece: &DelayPiece, t_s: f64) -> f64;

    /// What is known of all of its values.
    fn known(&self) -> Known;

    /// Finds every time on a part of one piece at which something that was sent at a given time is heard. `search` has the
    /// ways to look: [`Arrivals::monotone`] where T grows more slowly than t, or always faster, [`Arrivals::between`],
    /// [`Arrivals::within_slope`], [`Arrivals::enclosed`].
    fn arrivals(&self, search: &mut Arrivals<'_>);
}

/// A stretch of time on which a delay is smooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DelayPiece {
    /// Its number, counted from the piece that holds t = 0.
    pub index: u64,
    /// From here on, s.
    pub start_s: f64,
    /// Until here, s; infinite for the last.
    pub end_s: f64,
    /// When the one message was sent that is heard all the while, s; −∞ for the initial message. `None` where T is a value.
    pub held_s: Option<f64>,
}

impl DelayPiece {
    /// The only piece of a delay without jumps and kinks.
    pub const WHOLE: DelayPiece = DelayPiece { index: 0, start_s: 0.0, end_s: f64::INFINITY, held_s: None };

    /// The piece of this number.
    pub fn new(index: u64, start_s: f64, end_s: f64) -> Self {
        DelayPiece { index, start_s, end_s, held_s: None }
    }
}

/// The delay of one link or of several.
#[derive(Clone, Debug)]
pub struct Delay {
    function: Arc<dyn DelayFunction>,
    known: Known,
}

impl Delay {
    /// The delay that is this function.
    pub fn new<D: DelayFunction>(function: D) -> Delay {
        let mut known = function.known();
        if !is_shipped(TypeId::of::<D>()) {
            let Known { within_s, until_s, holds_packets, .. } = known;
            known = Known { until_s, holds_packets, ..Known::declared(within_s) };
        }
        Delay { function: Arc::new(function), known }
    }

    /// The function as a `D`, if it is one.
    pub fn downcast<D: DelayFunction>(&self) -> Option<&D> {
        (&*self.function as &dyn Any).downcast_ref()
    }

    /// The packets that are heard, where it is a link that carries packets.
    pub fn packets(&self) -> Option<&Trace> {
        self.downcast()
    }

    /// What was drawn or given for it, and what that is called.
    pub(crate) fn drawn(&self) -> (&'static str, usize) {
        let hold = self.downcast().map_or(0, |hold: &RandomHold| hold.times_s().len());
        self.packets().map_or(("jumps of the delay", hold), |trace| ("packets", trace.packets().len()))
    }

    /// What it is called in messages.
    pub fn words(&self) -> &'static str {
        self.function.words()
    }

    /// Checks the parameters for a run of `end_s`, under the keys that they have in scenario files.
    ///
    /// # Errors
    /// [`QuantityError`] for the first that makes no sense.
    pub fn check(&self, end_s: f64) -> Result<(), QuantityError> {
        self.function.validate(end_s)?;
        let [low, high] = self.known.within_s;
        not_negative("", "the least value", low)?;
        let bounded = high >= low && high.is_finite();
        such(bounded, "", "the largest value", high, "must be finite and not below the least")
    }

    /// What is known of all of its values.
    pub fn known(&self) -> Known {
        self.known
    }

    /// The piece that holds t = 0 from the right.
    pub fn first_piece(&self) -> DelayPiece {
        self.function.piece(0)
    }

    /// The piece after this one; its own copy when it is the last.
    pub fn next_piece(&self, piece: DelayPiece) -> DelayPiece {
        if piece.end_s.is_infinite() { piece } else { self.function.piece(piece.index + 1) }
    }

    /// The piece in force at `t_s` ≥ 0, from the right.
    pub fn piece_at(&self, t_s: f64) -> DelayPiece {
        let over = |index| self.function.piece(index).end_s <= t_s;
        // The first piece that is not over, between a number that is and one that is not.
        let (mut low, mut high) = (0, 0);
        while over(high) && high < 1 << 62 {
            (low, high) = (high + 1, 2 * high + 1);
        }
        while low < high {
            let middle = low + (high - low) / 2;
            if over(middle) { low = middle + 1 } else { high = middle }
        }
        self.function.piece(low)
    }

    /// T(t) by the formula of `piece`, s. Not a number where its author's bounds are refuted.
    pub fn value_on(&self, piece: DelayPiece, t_s: f64) -> f64 {
        if let Some(sent_s) = piece.held_s {
            // Before anything has arrived the initial message is heard, which was sent again, one may say, at t = 0.
            return (t_s - sent_s.max(0.0)).max(0.0);
        }
        let value_s = self.function.value(&piece, t_s);
        if self.known.basis == Basis::Declared { self.known.confirmed(value_s) } else { value_s }
    }

    /// When what is heard at `t_s` was sent, by the formula of `piece`: t − T(t), and exactly the packet's own time where
    /// packets are held; −∞ before any has arrived.
    #[inline]
    pub fn sent_on(&self, piece: DelayPiece, t_s: f64) -> f64 {
        piece.held_s.unwrap_or_else(|| t_s - self.value_on(piece, t_s))
    }

    /// T(t), from the right where it jumps, s.
    pub fn value(&self, t_s: f64) -> f64 {
        self.value_on(self.piece_at(t_s), t_s)
    }

    /// An upper bound of T over all time, or for as long as T is known, s.
    pub fn max_s(&self) -> f64 {
        self.known.within_s[1]
    }

    /// A lower bound of T over all time, or for as long as T is known, s.
    pub fn min_s(&self) -> f64 {
        self.known.within_s[0]
    }

    /// Whether T is known not to change with time, after the run either.
    pub fn is_constant(&self) -> bool {
        let stays = match self.known.basis {
            Basis::Rule | Basis::Numbers => true,
            Basis::Enclosure => self.known.unknown.is_none() && self.known.bound_s == self.max_s(),
            Basis::Declared => false,
        };
        stays && self.min_s() == self.max_s() && !self.known.holds_packets
    }

    /// Appends every t > `sent_s` at which something sent at `sent_s` is heard: the solutions of t − T(t) = `sent_s`.
    /// Nothing is looked for after `until_s`, since a delay may be longer than any run.
    ///
    /// A stretch on which t − T(t) stands still (a held packet) has no inner solutions: its ends are jumps of the delay
    /// and break-points anyway.
    pub fn arrivals(&self, sent_s: f64, until_s: f64, arrivals: &mut Vec<f64>) {
        if self.known.holds_packets {
            return;
        }
        // Rounded up, so that the arrival of a constant delay is inside the stretch searched.
        let last = (sent_s + self.max_s()).next_up().next_up().min(until_s);
        let mut piece = self.piece_at(sent_s.max(0.0));
        loop {
            let (from, to) = (piece.start_s.max(sent_s), piece.end_s.min(last));
            if to >= from && piece.held_s.is_none() {
                self.function.arrivals(&mut Arrivals::new(self, piece, [from, to], sent_s, arrivals));
            }
            if piece.end_s > last {
                break;
            }
            piece = self.next_piece(piece);
        }
    }
}

impl PartialEq for Delay {
    /// Whether both are the same function.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.function, &other.function) || self.function.same(&*other.function)
    }
}

impl<D: DelayFunction> From<D> for Delay {
    fn from(function: D) -> Self {
        Delay::new(function)
    }
}

#[cfg(test)]
mod tests;
