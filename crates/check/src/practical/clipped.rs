//! Whether limits of torques and of their rates change what a law asks for, by a trial of the loop as it is deployed.
//!
//! Not from the paper, derived for this software. While a command is clipped ṡ = −M⁻¹(C + K) s has a term more of which no bound is known, and a
//! predicted course is one of robots that follow. A trial shows one run of them, and no other.

use forwardstep_sim::{ClippedSamples, RecordAt, Setup, TimeSpan};

use super::PracticalAnswer;
use crate::prediction::trial;

/// Work for a trial to the end of the run, in nanoseconds, roughly.
const WORK: f64 = 4e8;
/// Periods that are tried where that is not enough.
const PERIODS: f64 = 2048.0;
/// Up to this share limits act in a short transient only.
const TRANSIENT: f64 = 0.01;
/// Above this share the limits, not the law, determine the motion.
const MOST: f64 = 0.5;

/// How many commands were changed in a trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClippedCommands {
    /// Commands of all agents, and those that limits changed.
    pub of: ClippedSamples,
    /// How long the trial was, s.
    pub until_s: f64,
    /// Whether that is as long as the run.
    pub is_whole: bool,
}

impl ClippedCommands {
    /// Of a setup that samples and has limits; `None` where it has none, or where the trial takes too much work.
    pub(super) fn of(setup: &Setup) -> Option<ClippedCommands> {
        let control = setup.control.as_ref()?;
        let actuators = &control.actuators;
        if actuators.torque_limit.is_none() && actuators.torque_rate_limit.is_none() {
            return None;
        }
        let end_s = setup.time.end_s;
        let tried = |until_s: f64| {
            let time = TimeSpan { end_s: until_s, record_every_s: until_s, record_at: RecordAt::Intervals };
            let of = trial(&Setup { time, ..setup.clone() }, WORK)?.statistics.clipped?;
            Some(ClippedCommands { of, until_s, is_whole: until_s == end_s })
        };
        tried(end_s).or_else(|| tried(end_s.min(PERIODS / control.sample_hz)))
    }

    /// Commands that were changed, as a part of all; at least so many, where some meet both limits.
    pub fn share(&self) -> f64 {
        self.of.torque.max(self.of.rate) as f64 / self.of.samples.max(1) as f64
    }

    /// Whether what is said of the law is said of the loop.
    pub fn answer(&self) -> PracticalAnswer {
        match self.share() {
            share if share > MOST => PracticalAnswer::Inadequate,
            // What acts later, such as a push, was not seen.
            _ if !self.is_whole => PracticalAnswer::NotShown,
            0.0 => PracticalAnswer::Adequate,
            share if share <= TRANSIENT => PracticalAnswer::Marginal,
            _ => PracticalAnswer::NotShown,
        }
    }
}
