//! Where what is heard over a cell of time was sent: points through which, and between which, a lower bound has to pass.
//!
//! What is sent is bounded from below by a straight line on every cell that is past. What is heard over a cell, t − T(t) for all t in it, is
//! then bounded by pieces of such lines; a straight line below all of these lies below them where one of them begins or ends.

use forwardstep_sim::delay::{Delay, DelayPiece, SentOver};

/// Where a message was sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place {
    /// Before the first cell.
    History,
    /// In a past cell, by its number since the first, at this part of it.
    Past(u64, f64),
    /// In the cell that is made, at this part of it.
    Current(f64),
}

/// At this part of a cell what is heard is no less than the bound at this place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    pub(super) at: f64,
    pub(super) place: Place,
}

/// From which side a time is approached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Left,
    Right,
}

/// A part of a unit in the last place that times are off by, generously.
const TIME: f64 = 8.0 * f64::EPSILON;

/// The cells so far, and the one that is made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid<'a> {
    /// Where the past cells begin that are kept, rising, s.
    pub(super) starts_s: &'a [f64],
    /// The number of the first of them.
    pub(super) number: u64,
    /// When the first cell of all began, s.
    pub(super) begin_s: f64,
    /// The cell that is made, s.
    pub(super) cell_s: [f64; 2],
}

/// t − T(t) between two times, as two straight lines that it lies between.
struct Band {
    span_s: [f64; 2],
    earliest_s: [f64; 2],
    latest_s: [f64; 2],
}

impl Grid<'_> {
    /// All points of a cell under a delay; `piece` goes on to the piece in force at its end.
    pub(super) fn points(&self, delay: &Delay, piece: &mut DelayPiece, points: &mut Vec<Point>) {
        points.clear();
        let [from_s, to_s] = self.cell_s;
        while piece.end_s <= from_s {
            *piece = delay.next_piece(*piece);
        }
        loop {
            let span_s = [piece.start_s.max(from_s), piece.end_s.min(to_s)];
            if span_s[1] > span_s[0] {
                self.band(&band(delay.sent_over(*piece, span_s), span_s), points);
            }
            if piece.end_s >= to_s {
                return;
            }
            *piece = delay.next_piece(*piece);
        }
    }

    fn band(&self, band: &Band, points: &mut Vec<Point>) {
        let [at, to] = band.span_s.map(|t_s| self.part(t_s));
        self.line(band, band.earliest_s, points);
        if band.earliest_s == band.latest_s {
            return;
        }
        self.line(band, band.latest_s, points);
        for (end, at) in [(0, at), (1, to)] {
            let between = [band.earliest_s[end], band.latest_s[end]];
            self.knots(between, |_| at, points);
        }
    }

    /// The points of what goes along one line.
    fn line(&self, band: &Band, [first_s, last_s]: [f64; 2], points: &mut Vec<Point>) {
        let [from_s, to_s] = band.span_s;
        let (leaves, enters) = if last_s >= first_s { (Side::Right, Side::Left) } else { (Side::Left, Side::Right) };
        points.push(Point { at: self.part(from_s), place: self.place(first_s, leaves) });
        points.push(Point { at: self.part(to_s), place: self.place(last_s, enters) });
        let inverse = |knot_s: f64| self.part(from_s + (knot_s - first_s) / (last_s - first_s) * (to_s - from_s));
        self.knots([first_s.min(last_s), first_s.max(last_s)], inverse, points);
    }

    /// Both sides of every boundary of cells strictly between two times.
    fn knots(&self, [low_s, high_s]: [f64; 2], at: impl Fn(f64) -> f64, points: &mut Vec<Point>) {
        let first = self.starts_s.partition_point(|start_s| *start_s <= low_s);
        // Fast roots make cells so short that a window holds hundreds of thousands.
        let past = self.starts_s[first..].iter().copied().take_while(|knot_s| *knot_s < high_s);
        let current = Some(self.cell_s[0]).filter(|knot_s| *knot_s > low_s && *knot_s < high_s);
        for knot_s in past.chain(current) {
            let at = at(knot_s);
            points.push(Point { at, place: self.place(knot_s, Side::Left) });
            points.push(Point { at, place: self.place(knot_s, Side::Right) });
        }
    }

    fn part(&self, t_s: f64) -> f64 {
        let [from_s, to_s] = self.cell_s;
        ((t_s - from_s) / (to_s - from_s)).clamp(0.0, 1.0)
    }

    fn place(&self, sent_s: f64, side: Side) -> Place {
        // What may have been sent before the first cell was.
        if sent_s <= self.begin_s + TIME * (self.cell_s[1].abs() + 1.0) && side == Side::Left || sent_s < self.begin_s {
            return Place::History;
        }
        let [from_s, _] = self.cell_s;
        if sent_s > from_s || (sent_s == from_s && side == Side::Right) {
            return Place::Current(self.part(sent_s));
        }
        let after = match side {
            Side::Left => self.starts_s.partition_point(|start_s| *start_s < sent_s),
            Side::Right => self.starts_s.partition_point(|start_s| *start_s <= sent_s),
        };
        let Some(index) = after.checked_sub(1) else { return Place::History };
        let (start_s, end_s) = (self.starts_s[index], self.starts_s.get(after).copied().unwrap_or(from_s));
        Place::Past(self.number + index as u64, ((sent_s - start_s) / (end_s - start_s)).clamp(0.0, 1.0))
    }
}

fn band(sent: SentOver, span_s: [f64; 2]) -> Band {
    let [from_s, to_s] = span_s;
    match sent {
        // The initial message was sent again, one may say, at t = 0.
        SentOver::Held(sent_s) => {
            let sent_s = [sent_s.max(0.0).min(from_s); 2];
            Band { span_s, earliest_s: sent_s, latest_s: sent_s }
        }
        SentOver::Line([first_s, last_s]) => {
            let sent_s = [from_s - first_s.max(0.0), to_s - last_s.max(0.0)];
            Band { span_s, earliest_s: sent_s, latest_s: sent_s }
        }
        SentOver::Within([low_s, high_s]) => Band {
            span_s,
            earliest_s: [from_s - high_s.max(0.0), to_s - high_s.max(0.0)],
            latest_s: [from_s - low_s.max(0.0), to_s - low_s.max(0.0)],
        },
    }
}
