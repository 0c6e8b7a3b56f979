//! What was transmitted, as self-contained polynomial pieces.
//!
//! One piece per accepted step, holding r₁ … r₅ of every transmitted number and nothing else: memory grows with what is
//! sent, not with the state. A piece needs none of its neighbours, so at a break-point the past has a left and a right
//! side for free. A piece is dropped when a step begins so late that nothing in it can be heard any more, not at its end:
//! rows recorded within a step hear what its start does. The ring grows by doubling, within a budget, and then stays.

use super::kernels::continue_piece;

/// A piece is continued over at most so many times its length.
const LONGEST_CONTINUED: f64 = 1000.0;

/// Reading this far beyond the end of the last piece is reading its end, s.
const SLACK_S: f64 = 1e-12;

/// Pieces that fit at first.
const USUAL_CAPACITY: usize = 16;

/// A piece and the draft of the next one, which may continue it.
const LEAST_CAPACITY: usize = 2;

/// What a ring of so many pieces of `width` numbers takes.
fn bytes(width: usize, capacity: usize) -> u64 {
    const NUMBER: u64 = size_of::<f64>() as u64;
    (capacity as u64).saturating_mul((width as u64).saturating_mul(NUMBER).saturating_add(SPAN))
}

/// What the times of a piece take.
const SPAN: u64 = size_of::<[f64; 3]>() as u64;

/// A place to read from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Place {
    /// Before t = 0: the initial message.
    Before,
    /// In a kept piece: where its numbers begin, and θ ∈ [0, 1] within it.
    Piece {
        /// Offset into [`History::data`].
        offset: usize,
        /// Position within the piece.
        theta: f64,
    },
    /// After the last piece.
    Ahead,
}

/// The pieces in a ring; they are numbered from the start of the run.
#[derive(Debug)]
pub(crate) struct History {
    /// Numbers per piece.
    width: usize,
    /// Pieces that fit, a power of two.
    capacity: usize,
    /// Bytes that all pieces may take, those of the old ring included while a larger one is filled.
    budget_bytes: u64,
    data: Vec<f64>,
    /// Start, end and inverse length of each piece, s.
    spans: Vec<[f64; 3]>,
    /// Number of the first piece kept.
    first: u64,
    /// Number of the piece to come.
    next: u64,
    /// End of the last piece, s.
    end_s: f64,
}

impl History {
    /// An empty history of pieces of `width` numbers, which takes the [least](History::least_bytes) or stays within
    /// `budget_bytes`.
    pub(crate) fn new(width: usize, budget_bytes: u64) -> Self {
        let mut capacity = USUAL_CAPACITY;
        while capacity > LEAST_CAPACITY && bytes(width, capacity) > budget_bytes {
            capacity /= 2;
        }
        History {
            width,
            capacity,
            budget_bytes,
            data: vec![0.0; width * capacity],
            spans: vec![[0.0; 3]; capacity],
            first: 0,
            next: 0,
            end_s: 0.0,
        }
    }

    /// What the smallest history of pieces of `width` numbers takes.
    pub(crate) fn least_bytes(width: usize) -> u64 {
        bytes(width, LEAST_CAPACITY)
    }

    /// The budget that would hold all that is sent within `span_s` in pieces as long as those that are kept.
    pub(crate) fn need_bytes(&self, span_s: f64) -> f64 {
        let (pieces, mut capacity) = (span_s / self.mean_length_s() + 2.0, self.capacity as f64);
        while capacity < pieces {
            capacity *= 2.0;
        }
        // The ring before the last doubling is half as large.
        1.5 * capacity * bytes(self.width, 1) as f64
    }

    /// The mean length of the pieces that are kept, s.
    pub(crate) fn mean_length_s(&self) -> f64 {
        let [start_s, _, _] = self.spans[self.slot(self.first)];
        (self.end_s - start_s) / (self.next - self.first).max(1) as f64
    }

    /// All numbers; see [`Place::Piece`] for where a piece begins.
    pub(crate) fn data(&self) -> &[f64] {
        &self.data
    }

    fn slot(&self, number: u64) -> usize {
        (number & (self.capacity as u64 - 1)) as usize
    }

    /// The piece to come, to be filled before it is [committed](History::commit), and where it begins.
    pub(crate) fn draft(&mut self) -> (usize, &mut [f64]) {
        let offset = self.slot(self.next) * self.width;
        (offset, &mut self.data[offset..offset + self.width])
    }

    /// Drafts a piece of length `h` from `t_s` on by continuing the last one; `width` numbers per coefficient. False, and nothing done,
    /// when there is none or `h` is so many times its length that a polynomial says nothing there: beside a kink of a delay that
    /// nearly vanishes pieces are as short as the delay.
    pub(crate) fn extrapolate(&mut self, width: usize, t_s: f64, h: f64) -> bool {
        if self.next == self.first {
            return false;
        }
        let (last, draft) = (self.slot(self.next - 1) * self.width, self.slot(self.next) * self.width);
        let [start, _, inverse] = self.spans[last / self.width];
        if h * inverse > LONGEST_CONTINUED {
            return false;
        }
        // The ring has at least two places, so one lies before the other.
        let (low, high) = self.data.split_at_mut(last.max(draft));
        let (last, draft) = if last < draft {
            (&low[last..last + self.width], &mut high[..self.width])
        } else {
            (&high[..self.width], &mut low[draft..draft + self.width])
        };
        continue_piece(last, draft, width, (t_s - start) * inverse, h * inverse);
        true
    }

    /// Keeps the draft as the piece of [`start_s`, `end_s`]. There is no room for another draft before
    /// [`History::make_room`].
    pub(crate) fn commit(&mut self, start_s: f64, end_s: f64) {
        let slot = self.slot(self.next);
        self.spans[slot] = [start_s, end_s, 1.0 / (end_s - start_s)];
        self.next += 1;
        self.end_s = end_s;
    }

    /// Makes room for the draft of the step to come, which reads nothing sent before `forget_s`: pieces that ended earlier go.
    /// False when there is none within the budget.
    #[must_use]
    pub(crate) fn make_room(&mut self, forget_s: f64) -> bool {
        while self.first + 1 < self.next {
            let [_, end, _] = self.spans[self.slot(self.first)];
            if end >= forget_s {
                break;
            }
            self.first += 1;
        }
        self.next - self.first < self.capacity as u64 || self.grow()
    }

    /// Doubles the ring, if the budget has room for the old one and the new one at once.
    fn grow(&mut self) -> bool {
        let capacity = 2 * self.capacity;
        if bytes(self.width, self.capacity).saturating_add(bytes(self.width, capacity)) > self.budget_bytes {
            return false;
        }
        let mut data = vec![0.0; self.width * capacity];
        let mut spans = vec![[0.0; 3]; capacity];
        for number in self.first..self.next {
            let (old, new) = (self.slot(number), (number & (capacity as u64 - 1)) as usize);
            data[new * self.width..(new + 1) * self.width]
                .copy_from_slice(&self.data[old * self.width..(old + 1) * self.width]);
            spans[new] = self.spans[old];
        }
        (self.capacity, self.data, self.spans) = (capacity, data, spans);
        true
    }

    /// Finds `t_s`, starting from where `cursor` left off.
    #[inline(always)]
    pub(crate) fn find(&self, t_s: f64, cursor: &mut u64) -> Place {
        if t_s < 0.0 {
            return Place::Before;
        }
        // A step as long as the delay reads its very end, give or take rounding.
        if t_s > self.end_s + SLACK_S || self.next == 0 {
            return Place::Ahead;
        }
        let mut number = (*cursor).clamp(self.first, self.next - 1);
        loop {
            let slot = self.slot(number);
            let [start, end, inverse] = self.spans[slot];
            if t_s < start && number > self.first {
                number -= 1;
            } else if t_s > end && number + 1 < self.next {
                number += 1;
            } else {
                *cursor = number;
                return Place::Piece { offset: slot * self.width, theta: ((t_s - start) * inverse).clamp(0.0, 1.0) };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::kernels::evaluate;
    use super::super::tableau::basis;
    use super::*;

    #[test]
    fn continuing_a_quartic_gives_the_same_quartic() {
        // r₁ … r₅ of a piece on [1, 1.5], continued on [1.5, 2.2] and compared where both speak.
        let r = [0.3, -1.2, 0.7, 2.0, -0.9];
        let mut history = History::new(5, u64::MAX);
        history.draft().1.copy_from_slice(&r);
        history.commit(1.0, 1.5);
        history.extrapolate(1, 1.5, 0.7);
        let continued: [f64; 5] = std::array::from_fn(|c| history.draft().1[c]);
        for t in [1.5, 1.7, 2.0, 2.2] {
            let (old, new) = (evaluate(r, basis((t - 1.0) / 0.5)), evaluate(continued, basis((t - 1.5) / 0.7)));
            assert!((old - new).abs() < 1e-12, "{old} {new} at {t}");
        }
    }

    #[test]
    fn old_pieces_go_and_the_ring_stays_small() {
        let mut history = History::new(1, u64::MAX);
        for k in 0..10_000 {
            let t = 0.01 * f64::from(k);
            history.draft().1[0] = f64::from(k);
            history.commit(t, t + 0.01);
            assert!(history.make_room(t + 0.01 - 0.5));
        }
        assert_eq!(history.capacity, 64);
        let mut cursor = 0;
        let Place::Piece { offset, theta } = history.find(99.755, &mut cursor) else { panic!() };
        assert_eq!(history.data()[offset], 9975.0);
        assert!((theta - 0.5).abs() < 1e-6);
        assert_eq!(history.find(-1e-9, &mut cursor), Place::Before);
        assert_eq!(history.find(100.5, &mut cursor), Place::Ahead);
    }

    /// Fills a history that forgets nothing until it is full: its greatest size in bytes, and how many pieces it took.
    fn filled(width: usize, budget_bytes: u64) -> (u64, u64) {
        let mut history = History::new(width, budget_bytes);
        let held = |history: &History| (8 * history.data.capacity() + 24 * history.spans.capacity()) as u64;
        let (mut before, mut most) = (0, held(&history));
        while history.make_room(0.0) {
            // While the ring grows the old one is there as well.
            let now = held(&history);
            most = most.max(if now > before { now + before } else { now });
            before = now;
            history.commit(history.next as f64, history.next as f64 + 1.0);
        }
        (most, history.next)
    }

    #[test]
    fn a_history_never_exceeds_its_budget_and_uses_a_third_of_it() {
        for width in [0, 1, 60, 1000] {
            for budget_bytes in (0..40).map(|k| History::least_bytes(width) + 1000 * k * k + k) {
                let (most, pieces) = filled(width, budget_bytes);
                assert!(most <= budget_bytes, "{width} {budget_bytes}: {most}");
                let needed = pieces * (8 * width as u64 + 24);
                assert!(3 * needed > budget_bytes, "{width} {budget_bytes}: {pieces} pieces");
            }
        }
    }
}
