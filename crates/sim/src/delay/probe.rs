//! What a delay from outside says of itself, put to the test.
//!
//! Every piece of a run is visited; values are looked at on a raster, and where they move the most between two places of it
//! they are followed down to neighbouring numbers, which finds a jump. A raster can miss something, so a delay that passes
//! is not shown to be what its author says.

use thiserror::Error;

use super::{Basis, Delay, DelayPiece};

/// Pieces that are visited; each ends a step.
const MOST_PIECES: usize = 1_000_000;
/// Places on a piece.
const PLACES: usize = 256;
/// The same on the pieces after so many.
const PIECES_LOOKED_AT_CLOSELY: usize = 4096;
const FEW_PLACES: usize = 2;
/// What neighbouring numbers may differ by where T does not jump, as a part of the largest value.
const JUMP: f64 = 1e-6;

/// Why a delay is not what its author says.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum DelayFault {
    /// A piece that does not begin where the one before it ends; the first begins at or before zero.
    #[error("its piece {index} begins at {start_s} s, but the one before it ends at {before_s} s")]
    Gap {
        /// Its number.
        index: u64,
        /// Where it begins, s.
        start_s: f64,
        /// Where it should begin, s.
        before_s: f64,
    },
    /// A piece without a length.
    #[error("its piece {index} begins at {start_s} s and ends at {end_s} s, but a piece has a length")]
    Empty {
        /// Its number.
        index: u64,
        /// Where it begins, s.
        start_s: f64,
        /// Where it ends, s.
        end_s: f64,
    },
    /// Too many pieces for any run.
    #[error("it has more than {most} pieces until {t_s} s; each ends a step")]
    TooMany {
        /// How many are accepted.
        most: usize,
        /// Where the last of these ends, s.
        t_s: f64,
    },
    /// A value that is negative, no number, or outside the bounds.
    #[error("it is {value_s} s at t = {t_s} s, but is declared to stay from {low_s} s to {high_s} s")]
    Value {
        /// When, s.
        t_s: f64,
        /// The value, s.
        value_s: f64,
        /// The least value, s.
        low_s: f64,
        /// The largest value, s.
        high_s: f64,
    },
    /// A jump within a piece.
    #[error("it jumps by {by_s} s at t = {t_s} s within its piece {index}; a piece ends where a delay jumps")]
    Jump {
        /// The number of the piece.
        index: u64,
        /// When, s.
        t_s: f64,
        /// By how much, s.
        by_s: f64,
    },
    /// A message that is heard before it is sent.
    #[error("from t = {t_s} s on it holds what is sent at {sent_s} s, which is later")]
    TooEarly {
        /// When, s.
        t_s: f64,
        /// When the message is sent, s.
        sent_s: f64,
    },
}

impl Delay {
    /// Looks until `end_s` for what refutes its author. What forwardstep brings has been shown in other ways.
    ///
    /// # Errors
    /// The first [`DelayFault`] in time.
    pub fn probe(&self, end_s: f64) -> Result<(), DelayFault> {
        if self.known.basis != Basis::Declared {
            return Ok(());
        }
        let mut piece = self.first_piece();
        let mut before_s = 0.0;
        for count in 0..MOST_PIECES {
            let DelayPiece { index, start_s, end_s: next_s, .. } = piece;
            let follows = if count == 0 { start_s <= 0.0 } else { start_s == before_s };
            if !follows {
                return Err(DelayFault::Gap { index, start_s, before_s });
            }
            let has_length = next_s > start_s.max(0.0);
            if !has_length {
                return Err(DelayFault::Empty { index, start_s, end_s: next_s });
            }
            let places = if count < PIECES_LOOKED_AT_CLOSELY { PLACES } else { FEW_PLACES };
            self.probe_piece(piece, [start_s.max(0.0), next_s.min(end_s)], places)?;
            if next_s >= end_s {
                return Ok(());
            }
            before_s = next_s;
            piece = self.next_piece(piece);
        }
        Err(DelayFault::TooMany { most: MOST_PIECES, t_s: before_s })
    }

    fn probe_piece(&self, piece: DelayPiece, [from, to]: [f64; 2], places: usize) -> Result<(), DelayFault> {
        match piece.held_s {
            Some(sent_s) if sent_s.is_nan() || sent_s > from => return Err(DelayFault::TooEarly { t_s: from, sent_s }),
            _ => {}
        }
        let checked = |t_s: f64| {
            let value_s =
                if piece.held_s.is_some() { self.value_on(piece, t_s) } else { self.function.value(&piece, t_s) };
            let [low_s, high_s] = self.known.within_s;
            if self.known.confirmed(value_s).is_nan() {
                return Err(DelayFault::Value { t_s, value_s, low_s, high_s });
            }
            Ok(value_s)
        };
        let place = |k: usize| if k == places { to } else { from + (to - from) * (k as f64 / places as f64) };
        let mut steepest = ([from, from], 0.0);
        let mut last = (from, checked(from)?);
        for k in 1..=places {
            let next = (place(k), checked(place(k))?);
            let change = (next.1 - last.1).abs();
            if change > steepest.1 {
                steepest = ([last.0, next.0], change);
            }
            last = next;
        }
        let ([mut left, mut right], mut change) = steepest;
        loop {
            let middle = left + 0.5 * (right - left);
            if middle <= left || middle >= right {
                break;
            }
            let value_s = checked(middle)?;
            let (before, after) = ((value_s - checked(left)?).abs(), (checked(right)? - value_s).abs());
            if before >= after {
                (right, change) = (middle, before);
            } else {
                (left, change) = (middle, after);
            }
        }
        if change > JUMP * self.max_s() && piece.held_s.is_none() {
            return Err(DelayFault::Jump { index: piece.index, t_s: right, by_s: change });
        }
        Ok(())
    }
}
