//! `[control]` → [`Control`].

use forwardstep_core::sampled::SafeCommand;
use forwardstep_sim::{Actuators, Control, Failures, Sensors, VelocitySensor};

use super::at::At;
use super::control_file::{ControlFile, NoiseFile, QuantisationFile, SafeCommandFile, VelocityFile};
use super::control_problem::ControlProblem;
use super::fault::{Fault, fault, filled, not_negative, not_negative_or, positive, seed, values};
use super::problem::ScenarioProblem;
use super::values::AxisValues;

/// Samples that are accepted.
const MOST_SAMPLES: f64 = 1e7;

/// Reads how the controllers of agents with `axes` axes sample in a run of `end_s`.
pub(super) fn control(file: &ControlFile, axes: usize, end_s: f64) -> Result<Control, Fault> {
    let sample_hz = positive("sample_hz", &file.sample_hz)?;
    let samples = end_s * sample_hz;
    if samples > MOST_SAMPLES {
        let problem = ScenarioProblem::TooManyEvents { what: "samples", events: samples.round(), most: MOST_SAMPLES };
        return Err(fault(&file.sample_hz, problem));
    }
    let computation_delay_s = match &file.computation_delay_s {
        None => 0.0,
        Some(delay) if delay.value > 1.0 / sample_hz => {
            let problem = ControlProblem::ComputationDelay { delay_s: delay.value, period_s: 1.0 / sample_hz };
            return Err(fault(delay, problem));
        }
        Some(delay) => not_negative("computation_delay_s", delay)?,
    };
    let limits = |key, values: &Option<At<AxisValues>>| values.as_ref().map(|v| per_axis(key, v, axes)).transpose();
    Ok(Control {
        sample_hz,
        computation_delay_s,
        sensors: sensors(file)?,
        actuators: Actuators {
            torque_limit: limits("torque_limit", &file.torque_limit)?,
            torque_rate_limit: limits("torque_rate_limit_per_s", &file.torque_rate_limit_per_s)?,
            torque_quantum: quantum(file, "quantisation.torque", |q| &q.torque)?,
        },
        failures: failures(file)?,
    })
}

fn failures(file: &ControlFile) -> Result<Failures, Fault> {
    let safe_command = match file.safe_command.as_ref().map(|safe| &safe.value) {
        None => None,
        Some(SafeCommandFile::Hold) => Some(SafeCommand::HoldLast),
        Some(SafeCommandFile::Zero) => Some(SafeCommand::Zero),
        Some(SafeCommandFile::Values(list)) => Some(SafeCommand::Values(values(filled("values", list)?))),
    };
    let timeout = file.message_timeout_s.as_ref();
    let message_timeout_s = timeout.map(|timeout| not_negative("message_timeout_s", timeout)).transpose()?;
    Ok(Failures { safe_command, message_timeout_s })
}

fn sensors(file: &ControlFile) -> Result<Sensors, Fault> {
    let mut sensors = Sensors::default();
    if let Some(NoiseFile { seed: draw, position, velocity }) = &file.noise {
        sensors.seed = seed(draw)?;
        sensors.position_noise = not_negative_or("noise.position", position, 0.0)?;
        sensors.velocity_noise = not_negative_or("noise.velocity", velocity, 0.0)?;
    }
    sensors.position_quantum = quantum(file, "quantisation.position", |q| &q.position)?;
    sensors.velocity_quantum = quantum(file, "quantisation.velocity", |q| &q.velocity)?;
    if let Some(At { value: VelocityFile::FilteredDifference(filter), .. }) = &file.velocity {
        sensors.velocity = VelocitySensor::Filtered { cut_off_hz: positive("cut_off_hz", &filter.cut_off_hz)? };
        let unused = [
            ("noise.velocity", file.noise.as_ref().and_then(|noise| noise.velocity.as_ref())),
            ("quantisation.velocity", file.quantisation.as_ref().and_then(|steps| steps.velocity.as_ref())),
        ];
        for (key, place) in unused {
            if let Some(place) = place {
                return Err(fault(place, ControlProblem::VelocityNotMeasured { key }));
            }
        }
    }
    Ok(sensors)
}

/// A step of rounding; zero for none.
fn quantum(
    file: &ControlFile,
    key: &'static str,
    of: impl Fn(&QuantisationFile) -> &Option<At<f64>>,
) -> Result<f64, Fault> {
    match file.quantisation.as_ref().map(of) {
        Some(Some(step)) => positive(key, step),
        _ => Ok(0.0),
    }
}

/// One number for all axes, or one for each.
fn per_axis(key: &'static str, values: &At<AxisValues>, axes: usize) -> Result<Vec<f64>, Fault> {
    match &values.value {
        AxisValues::All(value) => Ok(vec![positive(key, &At { value: *value, span: values.span.clone() })?; axes]),
        AxisValues::Each(list) if list.len() == axes => list.iter().map(|value| positive(key, value)).collect(),
        AxisValues::Each(list) => Err(fault(values, ControlProblem::AxisCount { key, found: list.len(), need: axes })),
    }
}
