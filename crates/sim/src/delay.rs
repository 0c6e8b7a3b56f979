//! Communication delays T(t), evaluated at reception.
//!
//! A delay is smooth on *pieces*; it may jump from one to the next. The integrator lands on every piece's end and keeps
//! to one piece during a step, so that a jump has a left and a right side.

use forwardstep_core::Scalar;

/// A delay as a function of time; all of its values are non-negative and finite.
#[derive(Clone, Debug, PartialEq)]
pub enum Delay {
    /// T = s.
    Constant {
        /// In s; may be zero.
        s: f64,
    },
    /// T = mean + amplitude · sin(2π t / period + phase).
    Sinusoid {
        /// In s; at least the amplitude.
        mean_s: f64,
        /// In s.
        amplitude_s: f64,
        /// In s.
        period_s: f64,
        /// In rad.
        phase_rad: f64,
    },
    /// T = `values_s[k]` from `times_s[k]` until the next time.
    PiecewiseConstant {
        /// Rising, the first is zero, s.
        times_s: Vec<f64>,
        /// As many values, s.
        values_s: Vec<f64>,
        /// Repeat after this long, s; more than the last time.
        period_s: Option<f64>,
    },
    /// T = min + (max − min) · frac((t + offset) / period): rises, then drops. A slope of one is a packet held until the
    /// next.
    SawTooth {
        /// In s.
        min_s: f64,
        /// In s.
        max_s: f64,
        /// In s.
        period_s: f64,
        /// In s.
        offset_s: f64,
    },
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
}

impl Delay {
    /// Checks the parameters; the error is (parameter, value, what it must be).
    pub(crate) fn validate(&self) -> Result<(), (&'static str, f64, &'static str)> {
        const NON_NEGATIVE: &str = "must be finite and not negative";
        const POSITIVE: &str = "must be positive and finite";
        let non_negative = |name, value: f64| {
            if value >= 0.0 && value.is_finite() { Ok(()) } else { Err((name, value, NON_NEGATIVE)) }
        };
        let positive =
            |name, value: f64| if value > 0.0 && value.is_finite() { Ok(()) } else { Err((name, value, POSITIVE)) };
        match self {
            Delay::Constant { s } => non_negative("the delay", *s),
            Delay::Sinusoid { mean_s, amplitude_s, period_s, phase_rad } => {
                positive("the period", *period_s)?;
                non_negative("the mean", *mean_s)?;
                non_negative("the size of the phase", phase_rad.abs())?;
                if amplitude_s.abs() <= *mean_s {
                    Ok(())
                } else {
                    Err(("the amplitude", *amplitude_s, "must not exceed the mean, or the delay would become negative"))
                }
            }
            Delay::PiecewiseConstant { times_s, values_s, period_s } => {
                if times_s.len() != values_s.len() || times_s.is_empty() {
                    return Err((
                        "the number of values",
                        values_s.len() as f64,
                        "must be that of the times, and not zero",
                    ));
                }
                values_s.iter().try_for_each(|value| non_negative("a value", *value))?;
                if times_s[0] != 0.0 {
                    return Err(("the first time", times_s[0], "must be zero"));
                }
                for pair in times_s.windows(2) {
                    if !(pair[1] > pair[0] && pair[1].is_finite()) {
                        return Err(("a time", pair[1], "must be finite and later than the one before"));
                    }
                }
                match (period_s, times_s.last()) {
                    (Some(period), Some(last)) if !(period > last && period.is_finite()) => {
                        Err(("the period", *period, "must be finite and longer than the last time"))
                    }
                    _ => Ok(()),
                }
            }
            Delay::SawTooth { min_s, max_s, period_s, offset_s } => {
                positive("the period", *period_s)?;
                non_negative("the minimum", *min_s)?;
                non_negative("the maximum", *max_s)?;
                non_negative("the size of the offset", offset_s.abs())?;
                if max_s >= min_s { Ok(()) } else { Err(("the maximum", *max_s, "must not be below the minimum")) }
            }
        }
    }

    /// The piece that holds t = 0 from the right.
    pub fn first_piece(&self) -> DelayPiece {
        self.piece(0)
    }

    /// The piece after this one; its own copy when it is the last.
    pub fn next_piece(&self, piece: DelayPiece) -> DelayPiece {
        if piece.end_s.is_infinite() { piece } else { self.piece(piece.index + 1) }
    }

    fn piece(&self, index: u64) -> DelayPiece {
        let (start_s, end_s) = match self {
            Delay::Constant { .. } | Delay::Sinusoid { .. } => (0.0, f64::INFINITY),
            Delay::PiecewiseConstant { times_s, period_s, .. } => {
                let (repeat, k) = self.repeat_of(index, times_s.len());
                match period_s {
                    Some(period) => {
                        let base = repeat as f64 * period;
                        let end = times_s.get(k + 1).map_or((repeat + 1) as f64 * period, |t| base + t);
                        (base + times_s[k], end)
                    }
                    None => (times_s[k], times_s.get(k + 1).copied().unwrap_or(f64::INFINITY)),
                }
            }
            Delay::SawTooth { period_s, offset_s, .. } => {
                (tooth_start(*period_s, *offset_s, index), tooth_start(*period_s, *offset_s, index + 1))
            }
        };
        DelayPiece { index, start_s, end_s }
    }

    /// Which repetition and which entry of a piecewise constant delay a piece is.
    fn repeat_of(&self, index: u64, entries: usize) -> (u64, usize) {
        match self {
            Delay::PiecewiseConstant { period_s: Some(_), .. } => {
                (index / entries as u64, (index % entries as u64) as usize)
            }
            _ => (0, (index as usize).min(entries - 1)),
        }
    }

    /// T(t) by the formula of `piece`, which also gives the one-sided values at its ends.
    pub fn value_on(&self, piece: DelayPiece, t_s: f64) -> f64 {
        match self {
            Delay::Constant { s } => *s,
            Delay::Sinusoid { mean_s, amplitude_s, period_s, phase_rad } => {
                let angle = Scalar::mul_add(core::f64::consts::TAU / period_s, t_s, *phase_rad);
                // Rounding must not make a delay whose amplitude equals its mean negative.
                Scalar::mul_add(*amplitude_s, Scalar::sin_cos(angle).0, *mean_s).max(0.0)
            }
            Delay::PiecewiseConstant { times_s, values_s, .. } => {
                values_s[self.repeat_of(piece.index, times_s.len()).1]
            }
            Delay::SawTooth { min_s, max_s, period_s, .. } => {
                Scalar::mul_add((max_s - min_s) / period_s, t_s - piece.start_s, *min_s).clamp(*min_s, *max_s)
            }
        }
    }

    /// t − T(t), when what is heard at `t_s` was sent, by the formula of `piece`.
    pub fn sent_on(&self, piece: DelayPiece, t_s: f64) -> f64 {
        t_s - self.value_on(piece, t_s)
    }

    /// T(t), from the right where it jumps.
    pub fn value(&self, t_s: f64) -> f64 {
        self.value_on(self.piece_at(t_s), t_s)
    }

    /// The piece in force at `t_s` ≥ 0, from the right.
    pub fn piece_at(&self, t_s: f64) -> DelayPiece {
        let guess = match self {
            Delay::Constant { .. } | Delay::Sinusoid { .. } => 0,
            Delay::PiecewiseConstant { times_s, period_s, .. } => {
                let repeat = period_s.map_or(0.0, |period| (t_s / period).floor().max(0.0));
                let within = t_s - repeat * period_s.unwrap_or(0.0);
                repeat as u64 * times_s.len() as u64 + times_s.partition_point(|start| *start <= within) as u64
            }
            Delay::SawTooth { period_s, offset_s, .. } => {
                (((t_s + offset_s) / period_s).floor() - (offset_s / period_s).floor()).max(0.0) as u64
            }
        };
        // The quotient may be off by one in either direction; the piece's own ends decide.
        let mut piece = self.piece(guess.saturating_sub(2));
        while piece.end_s <= t_s {
            piece = self.next_piece(piece);
        }
        piece
    }

    /// An upper bound of T over all time, s.
    pub fn max_s(&self) -> f64 {
        match self {
            Delay::Constant { s } => *s,
            Delay::Sinusoid { mean_s, amplitude_s, .. } => mean_s + amplitude_s.abs(),
            Delay::PiecewiseConstant { values_s, .. } => values_s.iter().copied().fold(0.0, f64::max),
            Delay::SawTooth { max_s, .. } => *max_s,
        }
    }

    /// A lower bound of T over all time, s.
    pub fn min_s(&self) -> f64 {
        match self {
            Delay::Constant { s } => *s,
            Delay::Sinusoid { mean_s, amplitude_s, .. } => (mean_s - amplitude_s.abs()).max(0.0),
            Delay::PiecewiseConstant { values_s, .. } => values_s.iter().copied().fold(f64::INFINITY, f64::min),
            Delay::SawTooth { min_s, .. } => *min_s,
        }
    }

    /// Whether T does not change with time.
    pub fn is_constant(&self) -> bool {
        self.min_s() == self.max_s()
    }

    /// Appends every t > `sent_s` at which something sent at `sent_s` is heard: the solutions of t − T(t) = `sent_s`.
    /// Nothing is looked for after `until_s`, since a delay may be longer than any run.
    ///
    /// A stretch on which t − T(t) stands still (a held packet) has no inner solutions: its ends are jumps of the delay
    /// and break-points anyway.
    pub fn arrivals(&self, sent_s: f64, until_s: f64, arrivals: &mut Vec<f64>) {
        if let Delay::Constant { s } = self {
            if *s > 0.0 {
                arrivals.push(sent_s + s);
            }
            return;
        }
        // Rounded up, so that the arrival of a constant delay is inside the stretch searched.
        let last = (sent_s + self.max_s()).next_up().next_up().min(until_s);
        let mut piece = self.piece_at(sent_s.max(0.0));
        loop {
            let from = piece.start_s.max(sent_s);
            let to = piece.end_s.min(last);
            if to >= from {
                self.arrivals_on(piece, [from, to], sent_s, arrivals);
            }
            if piece.end_s > last {
                break;
            }
            piece = self.next_piece(piece);
        }
    }

    fn arrivals_on(&self, piece: DelayPiece, [from, to]: [f64; 2], sent_s: f64, arrivals: &mut Vec<f64>) {
        // Between its turning points t − T(t) is monotone, so a change of sign brackets exactly one arrival.
        let early = |t: f64| t - self.value_on(piece, t) - sent_s;
        let mut left = from;
        let mut f_left = early(left);
        let mut visit = |right: f64| {
            let f_right = early(right);
            if f_left < 0.0 && f_right >= 0.0 || f_left > 0.0 && f_right <= 0.0 {
                let arrival = bisect(early, left, right, f_left < 0.0);
                if arrival > sent_s {
                    arrivals.push(arrival);
                }
            }
            (left, f_left) = (right, f_right);
        };
        if let Delay::Sinusoid { amplitude_s, period_s, phase_rad, .. } = self {
            // d/dt (t − T) = 1 − a ω cos(ω t + φ) vanishes where cos = 1/(a ω).
            let omega = core::f64::consts::TAU / period_s;
            let cosine = 1.0 / (amplitude_s * omega);
            if cosine.abs() < 1.0 {
                // Two families of turning points, one period apart each; taken in turn, the earlier first.
                let angle = libm::acos(cosine);
                let first = |sign: f64| {
                    let base = (sign * angle - phase_rad) / omega;
                    base + ((from - base) / period_s).ceil() * period_s
                };
                let mut next = [first(-1.0), first(1.0)];
                loop {
                    let earlier = usize::from(next[1] < next[0]);
                    if next[earlier] >= to {
                        break;
                    }
                    visit(next[earlier]);
                    next[earlier] += period_s;
                }
            }
        }
        visit(to);
    }
}

/// Where a saw-tooth's piece begins; piece 0 holds t = 0.
fn tooth_start(period_s: f64, offset_s: f64, index: u64) -> f64 {
    ((offset_s / period_s).floor() + index as f64) * period_s - offset_s
}

/// The end of a bracket in which `f` changes sign, to the last bit; `rising` says from negative to positive.
fn bisect(f: impl Fn(f64) -> f64, mut left: f64, mut right: f64, rising: bool) -> f64 {
    loop {
        let middle = left + 0.5 * (right - left);
        if middle <= left || middle >= right {
            return right;
        }
        let value = f(middle);
        if value == 0.0 || (value > 0.0) == rising {
            right = middle;
        } else {
            left = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arrivals(delay: &Delay, sent_s: f64) -> Vec<f64> {
        let mut out = Vec::new();
        delay.arrivals(sent_s, f64::INFINITY, &mut out);
        for t in &out {
            assert!((t - delay.value(*t) - sent_s).abs() < 1e-12, "{t} is no arrival of {sent_s}");
        }
        out
    }

    #[test]
    fn constant_arrives_once() {
        assert_eq!(arrivals(&Delay::Constant { s: 0.25 }, 1.5), vec![1.75]);
        assert_eq!(arrivals(&Delay::Constant { s: 0.0 }, 1.5), Vec::<f64>::new());
    }

    #[test]
    fn steep_sinusoid_arrives_several_times() {
        // |dT/dt| up to 3: t − T(t) turns back, so one message is heard three times.
        let delay = Delay::Sinusoid { mean_s: 0.6, amplitude_s: 0.5, period_s: 1.0, phase_rad: 0.0 };
        let counts: Vec<usize> = (0..20).map(|k| arrivals(&delay, 5.0 + 0.05 * k as f64).len()).collect();
        assert!(counts.iter().all(|c| c % 2 == 1), "{counts:?}");
        assert!(counts.contains(&3), "{counts:?}");
    }

    #[test]
    fn a_delay_beyond_the_horizon_is_not_searched_to_its_end() {
        let until = |delay: Delay| {
            let mut out = Vec::new();
            delay.arrivals(0.5, 10.0, &mut out);
            out
        };
        let far = Delay::SawTooth { min_s: 0.0, max_s: 1e30, period_s: 0.6, offset_s: 0.0 };
        // From every tooth's start the delay rises past all that was sent since, but for the first instant.
        assert!(until(far).iter().all(|t| *t <= 10.0));
        let wide = Delay::Sinusoid { mean_s: 1e12, amplitude_s: 1e12, period_s: 0.1, phase_rad: 0.0 };
        assert!(until(wide).iter().all(|t| *t <= 10.0));
    }

    #[test]
    fn saw_tooth_and_piecewise_jump_where_they_say() {
        let saw = Delay::SawTooth { min_s: 0.05, max_s: 0.4, period_s: 0.6, offset_s: 0.2 };
        let piece = saw.piece_at(0.5);
        assert!((piece.start_s - 0.4).abs() < 1e-15 && (piece.end_s - 1.0).abs() < 1e-15);
        assert_eq!(saw.value_on(piece, piece.start_s), 0.05);
        assert!((saw.value_on(piece, piece.end_s) - 0.4).abs() < 1e-15);
        assert!((saw.value(0.0) - (0.05 + 0.35 / 3.0)).abs() < 1e-15);

        let steps = Delay::PiecewiseConstant { times_s: vec![0.0, 0.3], values_s: vec![0.1, 0.2], period_s: Some(1.0) };
        assert_eq!([0.0, 0.29, 0.3, 0.99, 1.0, 7.31].map(|t| steps.value(t)), [0.1, 0.1, 0.2, 0.2, 0.1, 0.2]);
        // Sent at 0.15: heard at 0.25 with the first value and at 0.35 with the second.
        let heard = arrivals(&steps, 0.15);
        assert_eq!(heard.len(), 2);
        let once = Delay::PiecewiseConstant { times_s: vec![0.0, 0.3], values_s: vec![0.1, 0.2], period_s: None };
        assert_eq!(once.value(50.0), 0.2);
        assert_eq!(once.piece_at(0.2).end_s, 0.3);
    }

    #[test]
    fn pieces_follow_one_another_without_gaps() {
        let delays = [
            Delay::SawTooth { min_s: 0.0, max_s: 0.1, period_s: 0.1, offset_s: 0.03 },
            Delay::PiecewiseConstant {
                times_s: vec![0.0, 0.1, 0.7],
                values_s: vec![0.3, 0.0, 0.2],
                period_s: Some(0.9),
            },
        ];
        for delay in delays {
            let mut piece = delay.first_piece();
            for _ in 0..10_000 {
                let next = delay.next_piece(piece);
                assert_eq!(piece.end_s, next.start_s);
                assert!(next.end_s > next.start_s);
                let middle = 0.5 * (next.start_s + next.end_s);
                assert_eq!(delay.piece_at(middle), next);
                assert_eq!(delay.piece_at(next.start_s), next);
                piece = next;
            }
        }
    }
}
