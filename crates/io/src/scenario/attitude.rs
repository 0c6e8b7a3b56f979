//! An attitude → a unit quaternion.

use forwardstep_core::Scalar;
use forwardstep_core::attitude::{Quaternion, normalized};

use super::at::At;
use super::attitude_file::{AttitudeStartFile, TurnFile};
use super::fault::{Fault, fault};
use super::system_problem::SystemProblem;

/// Either way of writing it.
pub(super) fn attitude(file: &At<AttitudeStartFile>) -> Result<Quaternion, Fault> {
    match &file.value {
        AttitudeStartFile::Quaternion(q) => quaternion(&At { value: *q, span: file.span.clone() }),
        AttitudeStartFile::Turn(TurnFile { axis, angle_rad }) => turn(axis, angle_rad),
    }
}

/// A quaternion of any length.
pub(super) fn quaternion(file: &At<Quaternion>) -> Result<Quaternion, Fault> {
    if file.value.iter().all(|x| *x == 0.0) {
        return Err(fault(file, SystemProblem::NoDirection { instead: "[0, 0, 0, 1] is no turn" }));
    }
    Ok(normalized(file.value))
}

/// A turn about an axis of any length.
pub(super) fn turn(axis: &At<[f64; 3]>, angle_rad: &At<f64>) -> Result<Quaternion, Fault> {
    if axis.value.iter().all(|x| *x == 0.0) {
        let instead = "[0, 0, 1] is the third axis; for no turn let `angle_rad` be 0";
        return Err(fault(axis, SystemProblem::NoDirection { instead }));
    }
    let [x, y, z] = axis.value;
    let [x, y, z, _] = normalized([x, y, z, 0.0]);
    let (sin, cos) = Scalar::sin_cos(0.5 * angle_rad.value);
    Ok([sin * x, sin * y, sin * z, cos])
}
