//! Communication delays T(t), evaluated at reception.

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
    /// T = min + (max − min) · frac((t + offset) / period): rises, then drops. A slope of one is a packet held until the next.
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
