//! An agent that leads the others: what drives it away from them, watched along the run.
//!
//! For a motion that is given, bounds of ξ̇₀ are known before the run. An agent goes where its law takes it, so they are looked at
//! here, at the end of every step: q̇₀ and q̈₀ as the closed loop has them, and q⃛₀ as the difference of q̈₀ over a step, which is a mean
//! of it, so that its size never exceeds the largest.

use crate::leader::{Following, Leading};
use crate::recording::Drive;

/// What is known of an agent that leads.
pub(super) struct Driven {
    pub(super) agent: usize,
    /// Coefficients of q₀, q̇₀, …, q₀⁗ in what drives it.
    drive: [f64; 5],
    gamma: f64,
    /// q̇₀ and q̈₀ when the closed loop was last evaluated.
    rates: Vec<f64>,
    /// When they were last looked at, and q̈₀ then.
    before: Option<(f64, Vec<f64>)>,
    seen: Option<Drive>,
}

impl Driven {
    /// Nothing where no agent leads.
    pub(super) fn new(following: &Following, axes: usize) -> Option<Self> {
        let Leading::Agent(agent) = following.leader else { return None };
        let (drive, gamma) = (following.drive(), following.gain);
        Some(Driven { agent, drive, gamma, rates: vec![0.0; 2 * axes], before: None, seen: None })
    }

    /// Takes note of its rates, which begin with q̇₀ and q̈₀.
    pub(super) fn evaluated(&mut self, t_s: f64, dx: &[f64]) {
        let n = self.rates.len();
        self.rates.copy_from_slice(&dx[..n]);
        if self.before.is_none() {
            self.look(t_s);
        }
    }

    /// Looks at what was evaluated last, at the end of a step.
    pub(super) fn look(&mut self, t_s: f64) {
        let m = self.rates.len() / 2;
        let passed_s = self.before.as_ref().map_or(0.0, |(before_s, _)| t_s - before_s);
        let (dq, ddq) = self.rates.split_at(m);
        let [_, velocity, acceleration, jerk, _] = self.drive;
        let mut size = 0.0_f64;
        for c in 0..m {
            let dddq = match &self.before {
                Some((_, before)) if passed_s > 0.0 => (ddq[c] - before[c]) / passed_s,
                _ => 0.0,
            };
            size = size.max((velocity * dq[c] + acceleration * ddq[c] + jerk * dddq).abs());
        }
        let seen = self.seen.get_or_insert(Drive { peak: size, peak_s: t_s, exceeds_until_s: None });
        if size > seen.peak {
            (seen.peak, seen.peak_s) = (size, t_s);
        }
        if size >= self.gamma {
            seen.exceeds_until_s = Some(t_s);
        }
        match &mut self.before {
            Some((before_s, before)) => {
                *before_s = t_s;
                before.copy_from_slice(ddq);
            }
            None => self.before = Some((t_s, ddq.to_vec())),
        }
    }

    /// What was seen.
    pub(super) fn seen(&self) -> Option<Drive> {
        self.seen
    }
}
