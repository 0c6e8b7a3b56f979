//! Ranges of what a run is asked to do: how long, in which steps, how it samples.

use crate::closed_loop::SetupError;
use crate::coupling::Coupling;
use crate::quantity::{MOST_EVENTS, Path, QuantityError, at_least, few, more_than, not_negative, positive, within};
use crate::setup::{Control, Method, RecordAt, Solver, TimeSpan, VelocitySensor};

impl TimeSpan {
    /// # Errors
    /// [`QuantityError`] for the first number that is out of its range.
    pub fn check(&self) -> Result<(), QuantityError> {
        positive("time", "end_s", self.end_s)?;
        positive("time", "record_every_s", self.record_every_s)?;
        match &self.record_at {
            RecordAt::Intervals => Ok(()),
            RecordAt::Rate { hz } => positive("time", "record_at", *hz),
            RecordAt::Times(times_s) => {
                let at = || Path::from("time.record_at.times_s");
                let mut before_s = -1.0;
                times_s.iter().enumerate().try_for_each(|(k, t_s)| {
                    within(at().index(k), "", *t_s, 0.0, self.end_s)?;
                    more_than(at().index(k), "", *t_s, ("the one before", std::mem::replace(&mut before_s, *t_s)))
                })
            }
        }
    }
}

/// Numbers that a recording may hold; eight bytes each.
const MOST_RECORDED: f64 = 1e8;

impl TimeSpan {
    /// Refuses a recording of so many columns beyond any memory, before anything is computed.
    pub(crate) fn check_recording(&self, columns: usize) -> Result<(), SetupError> {
        let rows = self.most_rows();
        if rows * columns as f64 <= MOST_RECORDED {
            return Ok(());
        }
        let least_s = self.end_s / (MOST_RECORDED / columns as f64 - 2.0);
        let least_s = (self.record_at == RecordAt::Intervals).then_some(least_s);
        Err(SetupError::RecordingTooLarge { rows, columns, most: MOST_RECORDED, least_s })
    }

    /// No recording has more rows.
    pub(crate) fn most_rows(&self) -> f64 {
        let between = match &self.record_at {
            RecordAt::Intervals => (self.end_s / self.record_every_s).floor(),
            RecordAt::Rate { hz } => (self.end_s * hz).floor(),
            RecordAt::Times(times_s) => times_s.len() as f64,
        };
        between + 2.0
    }
}

impl Solver {
    /// # Errors
    /// [`QuantityError`] for the first number that is out of its range.
    pub fn check(&self) -> Result<(), QuantityError> {
        let step = |at: &'static str, key, step_s| {
            positive(at, key, step_s)?;
            at_least(at, key, step_s, ("min_step_s", self.min_step_s))
        };
        positive("solver", "min_step_s", self.min_step_s)?;
        match self.method {
            Method::Adaptive { rtol, atol } => {
                // Below a few units in the last place no error estimate means anything.
                within("solver.method.adaptive", "rtol", rtol, 1e-14, 0.1)?;
                positive("solver.method.adaptive", "atol", atol)?;
            }
            Method::Fixed { step_s } => step("solver.method.fixed", "step_s", step_s)?,
        }
        self.max_step_s.map_or(Ok(()), |step_s| step("solver", "max_step_s", step_s))
    }
}

impl Control {
    /// Checks the numbers for a run of `end_s`.
    ///
    /// # Errors
    /// [`QuantityError`] for the first that is out of its range.
    pub fn check(&self, end_s: f64) -> Result<(), QuantityError> {
        let Control { sample_hz, computation_delay_s, sensors, actuators, failures } = self;
        positive("control", "sample_hz", *sample_hz)?;
        few("control", "sample_hz", *sample_hz, ("samples", end_s * sample_hz, MOST_EVENTS))?;
        // A computation must be done before the next begins.
        within("control", "computation_delay_s", *computation_delay_s, 0.0, 1.0 / sample_hz)?;
        if let Some(timeout_s) = failures.message_timeout_s {
            not_negative("control", "message_timeout_s", timeout_s)?;
        }
        if let VelocitySensor::Filtered { cut_off_hz } = sensors.velocity {
            positive("control.velocity.filtered_difference", "cut_off_hz", cut_off_hz)?;
        }
        for (key, limits) in
            [("torque_limit", &actuators.torque_limit), ("torque_rate_limit_per_s", &actuators.torque_rate_limit)]
        {
            for (axis, limit) in limits.iter().flatten().enumerate() {
                positive(Path::from("control").key(key).index(axis), "", *limit)?;
            }
        }
        not_negative("control", "noise.position", sensors.position_noise)?;
        not_negative("control", "noise.velocity", sensors.velocity_noise)?;
        not_negative("control", "noise.tip_velocity", sensors.tip_velocity_noise)?;
        not_negative("control", "quantisation.position", sensors.position_quantum)?;
        not_negative("control", "quantisation.velocity", sensors.velocity_quantum)?;
        not_negative("control", "quantisation.torque", actuators.torque_quantum)
    }
}

impl Coupling {
    /// # Errors
    /// [`QuantityError`] when its limit or scale is not positive.
    pub fn check(self) -> Result<(), QuantityError> {
        let (key, size) = match self {
            Coupling::Linear => return Ok(()),
            Coupling::Saturated { limit } => ("saturated", limit),
            Coupling::Tanh { scale } => ("tanh", scale),
            Coupling::Rational { scale } => ("rational", scale),
        };
        positive("network.coupling", key, size)
    }
}
