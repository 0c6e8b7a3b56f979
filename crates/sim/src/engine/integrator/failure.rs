//! Why a step could not be made, and what is to blame.

use super::super::delayed_inputs::Refuted;
use super::super::stiffness::{Work, dominant_rate};
use super::{DelaySystem, Integrator};

/// Why a step could not be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Failure {
    /// Where it happened, s.
    pub(crate) t_s: f64,
    /// Index of the state to blame.
    pub(crate) state: usize,
    /// What happened.
    pub(crate) cause: FailureCause,
}

/// What happened when a step could not be made. A `rate_per_s` is the size of the largest eigenvalue of the Jacobian of the
/// right-hand side there, 1/s, with messages that are late held; `None` where it is not finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum FailureCause {
    /// The state is no longer finite.
    NotFinite,
    /// The error control asked for this step, under the floor.
    StepUnderFloor { step_s: f64, rate_per_s: Option<f64> },
    /// What is sent within the longest delay exceeds the memory budget, and would need this one, in steps of this mean length.
    HistoryFull { step_s: f64, need_bytes: f64, rate_per_s: Option<f64> },
}

impl Integrator<'_> {
    /// The last delay that was found not to be what its author says.
    pub(crate) fn refuted(&self) -> Option<Refuted> {
        self.hearing.refuted()
    }

    /// The state in which a step could not be made.
    pub(crate) fn failed_in(&self) -> &[f64] {
        &self.x0
    }

    /// There is no room for the step that begins at `t`.
    pub(super) fn history_is_full(&mut self, system: &mut impl DelaySystem, t: f64) -> Failure {
        let state = self.worst_state();
        self.x0.copy_from_slice(&self.x1);
        let (rate_per_s, fastest) = self.fastest(system, t);
        // Steps of a given length have no error to go by.
        let state = if self.tableau.error.is_empty() { fastest.unwrap_or(state) } else { state };
        let (step_s, need_bytes) =
            (self.history.mean_length_s(), self.history.need_bytes(self.forget_s.min(self.end_s)));
        let cause = FailureCause::HistoryFull { step_s, need_bytes, rate_per_s };
        Failure { t_s: t, state, cause }
    }

    /// The error control asked for too short a step from `t` on.
    pub(super) fn step_is_under_floor(&mut self, system: &mut impl DelaySystem, t: f64, step_s: f64) -> Failure {
        let state = self.worst_state();
        let (rate_per_s, _) = self.fastest(system, t);
        Failure { t_s: t, state, cause: FailureCause::StepUnderFloor { step_s, rate_per_s } }
    }

    /// The largest rate of the state `x0` at `t`, 1/s, and which state it moves most. Overwrites the stages.
    fn fastest(&mut self, system: &mut impl DelaySystem, t: f64) -> (Option<f64>, Option<usize>) {
        let offset = self.history.draft().0;
        self.hearing.look(&self.timeline, &self.history, t, (t, 1.0, offset));
        let Integrator { hearing, history, heard, x0, stage, k, rtol, atol, statistics, .. } = self;
        let mut field = |x: &[f64], dx: &mut [f64]| {
            hearing.gather(history, x, heard);
            system.rates(t, x, heard, dx);
            statistics.evaluations += 1;
        };
        let [_, rate, direction, moved_rate, ..] = k;
        let work = Work { rate, direction, moved: stage, moved_rate };
        dominant_rate(&mut field, x0, *atol / *rtol, work).unzip()
    }

    pub(super) fn first_not_finite(&self) -> usize {
        self.x1.iter().position(|x| !x.is_finite()).unwrap_or(0)
    }

    /// The state with the largest estimated error in the last attempt.
    fn worst_state(&self) -> usize {
        let ratio = |i: usize| {
            let error: f64 = self.tableau.error.iter().zip(&self.k).map(|(e, k)| e * k[i]).sum();
            error.abs() / (self.rtol * self.x0[i].abs() + self.atol)
        };
        (0..self.x0.len()).max_by(|a, b| ratio(*a).total_cmp(&ratio(*b))).unwrap_or(0)
    }
}
