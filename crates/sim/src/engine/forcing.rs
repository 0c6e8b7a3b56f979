//! What enters as a function of time, and how long a step may be that does not pass over what it does.
//!
//! Error control sees a function of time at the stages of a step and nowhere else. Where everything rests, steps grow to many
//! seconds, and a pulse that lies between two stages has never been: nothing tells that the run is wrong. So before a step every such
//! function f is asked whether it looks like a polynomial of degree three over it. With dₖ the largest size of its k-th derivative
//! over h seconds, enclosed,
//!
//! ```text
//! |d₄| h⁴/24  ≤  ½ max(|d₁| h, |d₂| h²/2, |d₃| h³/6),
//! ```
//!
//! or less than the absolute tolerance. A constant part says nothing of how fast it changes, so d₀ does not count. A wave passes up to
//! ω h = 2.3, a bump of width w up to h of about w: what is left is smooth enough for the stages to see, and the error control does
//! the rest. Steps that are shorter by themselves keep their bits.
//!
//! An enclosure of a long stretch may say nothing though one of a short one does: exp(−u u) with u of both signs. Where that of a
//! short one says nothing either, as beside a root, values decide: 32 for each step, against the cubic through four. So they do
//! for a function whose kinks cannot be told apart.

use forwardstep_core::expression::Interval;

use super::timeline::merge_until;
use crate::trajectory::Path;

/// A stretch so many times as long as a step is looked at, so that not every step looks.
const AHEAD: f64 = 8.0;
/// After so many halvings of a stretch values decide where enclosures say nothing, and after as many more the error control.
const HALVINGS: u32 = 40;
/// After a stretch that had to be short, so many times as much is tried.
const REGROWTH: f64 = 4.0;
/// A stretch is looked at without so much at its ends, as a part of it and as a part of the time, s: a kink where a step begins or
/// ends does not count, and is known as exactly as that.
const INSIDE: [f64; 2] = [1e-9, 1e-11];
/// Values that are looked at where enclosures say nothing, and those of them that a cubic is laid through.
const VALUES: usize = 257;
const NODES: [usize; 4] = [0, 85, 171, VALUES - 1];

/// A function of time, and when it is in force.
#[derive(Debug)]
pub(crate) struct Shape {
    path: Path,
    span_s: [f64; 2],
    /// Where it has kinks, s, rising: what is before one says nothing of what is behind. `None` where they cannot be told apart.
    kinks_s: Option<Vec<f64>>,
}

impl Shape {
    pub(crate) fn new(path: Path, span_s: [f64; 2], kinks_s: Option<Vec<f64>>) -> Self {
        Shape { path, span_s, kinks_s }
    }

    /// The same function, in force at the same time.
    pub(crate) fn is(&self, path: &Path, span_s: [f64; 2]) -> bool {
        self.span_s == span_s && self.path == *path
    }

    /// The first kink behind `t`, s; infinite where there is none.
    fn next_kink_s(&self, t: f64) -> f64 {
        let Some(kinks_s) = &self.kinks_s else { return f64::INFINITY };
        kinks_s.get(kinks_s.partition_point(|kink_s| *kink_s <= merge_until(t))).copied().unwrap_or(f64::INFINITY)
    }

    /// Whether it looks like a cubic over a stretch, or differs from one by less than `room`; by its values where nothing is
    /// enclosed, unless that counts as `strict`.
    fn is_plain(&self, [from_s, to_s]: [f64; 2], room: f64, strict: bool) -> bool {
        let (from_s, to_s) = (from_s.max(self.span_s[0]), to_s.min(self.span_s[1]));
        let h = to_s - from_s;
        let inside_s = INSIDE[0] * h + INSIDE[1] * (1.0 + to_s.abs());
        // Not in force, or too short to be told apart from a kink.
        if h.is_nan() || h <= 8.0 * inside_s {
            return true;
        }
        let (first, last) = (from_s + inside_s, to_s - inside_s);
        if self.kinks_s.is_none() {
            return self.looks_plain([first, last], room);
        }
        let jet = self.path.enclose_jet(Interval { low: first, high: last });
        // What hardly varies is plain, whatever is known of its derivatives: of tanh(exp t), which has settled, they are products of what is rounded to
        // zero and what grows without bound.
        if jet[0].high - jet[0].low <= room {
            return true;
        }
        let [_, one, two, three, four] = jet.map(Interval::size);
        let rest = four * h * h * h * h / 24.0;
        if rest.is_finite() {
            let lower = (one * h).max(two * h * h / 2.0).max(three * h * h * h / 6.0);
            return rest <= 0.5 * lower || rest <= room;
        }
        !strict && self.looks_plain([first, last], room)
    }

    /// The same by values.
    fn looks_plain(&self, [from_s, to_s]: [f64; 2], room: f64) -> bool {
        let at = |k: usize| k as f64 / (VALUES - 1) as f64;
        let values: [f64; VALUES] = std::array::from_fn(|k| self.path.jet(from_s + at(k) * (to_s - from_s))[0]);
        // Where it has no value the run says so.
        if values.iter().any(|value| !value.is_finite()) {
            return true;
        }
        let cubic = |x: f64| {
            let part = |i: usize| {
                let others = NODES.iter().filter(|j| **j != i);
                values[i] * others.map(|j| (x - at(*j)) / (at(i) - at(*j))).product::<f64>()
            };
            NODES.iter().map(|i| part(*i)).sum::<f64>()
        };
        let of_nodes = NODES.map(|k| values[k]);
        let range = of_nodes.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b))
            - of_nodes.iter().fold(f64::INFINITY, |a, b| a.min(*b));
        (0..VALUES).all(|k| (values[k] - cubic(at(k))).abs() <= (0.5 * range).max(room))
    }
}

/// All that enters as a function of time.
#[derive(Debug)]
pub(crate) struct Forcing {
    shapes: Vec<Shape>,
    /// Until here all were found plain, s.
    until_s: f64,
    /// How long the last stretch was over which they were, s; infinite where a longer one had not been tried.
    plain_s: f64,
    /// What does not count.
    room: f64,
}

impl Forcing {
    pub(crate) fn new(shapes: Vec<Shape>, room: f64) -> Self {
        Forcing { shapes, until_s: 0.0, plain_s: f64::INFINITY, room }
    }

    /// How long a step from `t` may be, s, of which `proposed_s` is proposed.
    pub(crate) fn longest_step_s(&mut self, t: f64, proposed_s: f64) -> f64 {
        if self.shapes.is_empty() || t + proposed_s <= self.until_s {
            return f64::INFINITY;
        }
        // Steps end at kinks by themselves; to come closer and closer to one would be without end.
        let kink_s = self.shapes.iter().map(|shape| shape.next_kink_s(t)).fold(f64::INFINITY, f64::min);
        let most = (AHEAD * proposed_s).min(REGROWTH * self.plain_s).min(kink_s - t);
        let strict = self.plain_from(t, most, true);
        let length = strict.or_else(|| self.plain_from(t, most, false)).unwrap_or(proposed_s);
        self.until_s = t + length;
        self.plain_s = if length < most { length } else { f64::INFINITY };
        if t + length >= kink_s { f64::INFINITY } else { length }
    }

    /// How long a stretch from `t` is over which all are plain: `length`, or as many halvings of it as it takes.
    fn plain_from(&mut self, t: f64, mut length: f64, strict: bool) -> Option<f64> {
        for _ in 0..HALVINGS {
            let odd = self.shapes.iter().position(|shape| !shape.is_plain([t, t + length], self.room, strict));
            let Some(odd) = odd else { return Some(length) };
            // Who objects will object again.
            self.shapes.swap(0, odd);
            length *= 0.5;
        }
        None
    }
}
