//! Whether limits of torques and of their rates change what a law asks for, by a trial of the loop as it is deployed.
//!
//! Not from the paper, derived for this software. While a command is clipped ṡ = −M⁻¹(C + K) s has a term more of which no bound is known, and a
//! predicted course is one of robots that follow. A trial shows one run of them, and no other.

use forwardstep_sim::{ClippedSamples, RecordAt, Setup, TimeSpan};

use super::PracticalAnswer;
use crate::prediction::trial;

/// Periods that are tried at most.
const PERIODS: f64 = 2048.0;
/// Work for them, in nanoseconds, roughly.
const WORK: f64 = 2e8;
/// As many as that are a moment, after which the loop is what it was.
const MOMENT: f64 = 0.01;
/// Where more are, limits and not the law drive the robots.
const MOST: f64 = 0.5;

/// How many commands were changed in a trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClippedCommands {
    /// Commands of all agents, and those that limits changed.
    pub of: ClippedSamples,
    /// How long the trial was, s.
    pub until_s: f64,
}

impl ClippedCommands {
    /// Of a setup that samples and has limits; `None` where it has none, or where the trial takes too much work.
    pub(super) fn of(setup: &Setup) -> Option<ClippedCommands> {
        let control = setup.control.as_ref()?;
        let actuators = &control.actuators;
        if actuators.torque_limit.is_none() && actuators.torque_rate_limit.is_none() {
            return None;
        }
        let until_s = setup.time.end_s.min(PERIODS / control.sample_hz);
        let time = TimeSpan { end_s: until_s, record_every_s: until_s, record_at: RecordAt::Intervals };
        let of = trial(&Setup { time, ..setup.clone() }, WORK)?.statistics.clipped?;
        Some(ClippedCommands { of, until_s })
    }

    /// Commands that were changed, as a part of all.
    pub fn share(&self) -> f64 {
        (self.of.torque + self.of.rate) as f64 / self.of.samples.max(1) as f64
    }

    /// Whether what is said of the law is said of the loop.
    pub fn answer(&self) -> PracticalAnswer {
        match self.share() {
            0.0 => PracticalAnswer::Adequate,
            share if share <= MOMENT => PracticalAnswer::Marginal,
            share if share <= MOST => PracticalAnswer::NotShown,
            _ => PracticalAnswer::Inadequate,
        }
    }
}
