//! `[control]` → [`Control`].

use forwardstep_core::sampled::SafeCommand;
use forwardstep_sim::{Actuators, Control, Failures, Sensors, VelocitySensor};

use super::at::At;
use super::control_file::{ControlFile, SafeCommandFile, VelocityFile};
use super::fault::{Fault, filled, seed, values};
use super::values::AxisValues;

/// Reads how the controllers of agents with `axes` axes sample.
pub(super) fn control(file: &ControlFile, axes: usize) -> Result<Control, Fault> {
    let or_zero = |number: Option<&At<f64>>| number.map_or(0.0, |number| number.value);
    let (noise, steps) = (file.noise.as_ref(), file.quantisation.as_ref());
    let limits = |values: &Option<At<AxisValues>>| values.as_ref().map(|values| values.value.each(axes));
    Ok(Control {
        sample_hz: file.sample_hz.value,
        computation_delay_s: or_zero(file.computation_delay_s.as_ref()),
        sensors: Sensors {
            velocity: match file.velocity.as_ref().map(|velocity| &velocity.value) {
                None | Some(VelocityFile::Measured) => VelocitySensor::Measured,
                Some(VelocityFile::FilteredDifference(filter)) => {
                    VelocitySensor::Filtered { cut_off_hz: filter.cut_off_hz.value }
                }
            },
            position_noise: or_zero(noise.and_then(|noise| noise.position.as_ref())),
            velocity_noise: or_zero(noise.and_then(|noise| noise.velocity.as_ref())),
            tip_velocity_noise: or_zero(noise.and_then(|noise| noise.tip_velocity.as_ref())),
            seed: noise.map_or(Ok(0), |noise| seed(&noise.seed))?,
            position_quantum: or_zero(steps.and_then(|steps| steps.position.as_ref())),
            velocity_quantum: or_zero(steps.and_then(|steps| steps.velocity.as_ref())),
        },
        actuators: Actuators {
            torque_limit: limits(&file.torque_limit),
            torque_rate_limit: limits(&file.torque_rate_limit_per_s),
            torque_quantum: or_zero(steps.and_then(|steps| steps.torque.as_ref())),
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
    Ok(Failures { safe_command, message_timeout_s: file.message_timeout_s.as_ref().map(|timeout| timeout.value) })
}
