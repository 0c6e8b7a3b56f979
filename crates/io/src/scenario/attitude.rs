//! An attitude → a unit quaternion.

use forwardstep_core::Scalar;
use forwardstep_core::attitude::{Quaternion, difference, normalized};
use forwardstep_sim::Start;
use forwardstep_sim::trajectory::Trajectory;

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
    let [x, y, z, _] = direction(axis)?;
    let (sin, cos) = Scalar::sin_cos(0.5 * angle_rad.value);
    Ok([sin * x, sin * y, sin * z, cos])
}

/// Half a turn about an axis of any length.
pub(super) fn direction(axis: &At<[f64; 3]>) -> Result<Quaternion, Fault> {
    if axis.value.iter().all(|x| *x == 0.0) {
        let instead = "[0, 0, 1] is the third axis; for no turn let `angle_rad` be 0";
        return Err(fault(axis, SystemProblem::NoDirection { instead }));
    }
    let [x, y, z] = axis.value;
    Ok(normalized([x, y, z, 0.0]))
}

/// Refuses a target that is no attitude at some time.
pub(super) fn never_zero<T>(place: &At<T>, target: &Trajectory, end_s: f64) -> Result<(), Fault> {
    let nearest = target.least_norm(end_s);
    if nearest.vanishes() { Err(fault(place, SystemProblem::NoAttitude { t_s: nearest.t_s })) } else { Ok(()) }
}

/// Of the two quaternions of the attitude at the start, takes the one that is nearer to the target: the law leads to Δq_o = 1
/// and would otherwise take the long way round.
pub(super) fn shortest_rotation(start: &mut Start, target: &Trajectory) {
    let mut jets = [[0.0; 5]; 4];
    target.jets(0.0, &mut jets);
    if let Some(q) = start.q.first_chunk_mut::<4>()
        && difference(*q, jets.map(|jet| jet[0]))[3] < 0.0
    {
        *q = q.map(|x| -x);
    }
}
