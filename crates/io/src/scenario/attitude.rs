//! An attitude → a unit quaternion.

use std::f64::consts::TAU;

use forwardstep_core::Scalar;
use forwardstep_core::attitude::{Quaternion, angle, difference, normalized};
use forwardstep_sim::Start;
use forwardstep_sim::trajectory::{LeastNorm, Trajectory};

use super::at::At;
use super::attitude_file::{AttitudeStartFile, TurnFile};
use super::fault::{Fault, fault};
use super::file::RotationFile;
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

/// Refuses a target that is no attitude at some time, as far as the numbers of a run tell.
pub(super) fn never_zero<T>(place: &At<T>, target: &Trajectory, end_s: f64) -> Result<(), Fault> {
    let nearest = target.least_norm(end_s);
    if !nearest.vanishes() {
        return Ok(());
    }
    let LeastNorm { t_s, norm, beside, every_s } = nearest;
    Err(fault(place, SystemProblem::NoAttitude { t_s, norm, beside, every_s }))
}

/// Of the two quaternions of the attitude at the start, takes the one that is asked for: the law leads to Δq_o = 1, by the short
/// way from Δq_o ≥ 0 and else by the long way. R_z keeps its place beside it.
pub(super) fn rotation(start: &mut Start, target: &Trajectory, way: RotationFile) {
    let Some([.., cosine]) = error_at_start(start, target) else { return };
    let other = match way {
        RotationFile::Shortest => cosine < 0.0,
        RotationFile::Longest => cosine > 0.0,
        RotationFile::AsStated => false,
    };
    if other {
        start.q.iter_mut().chain(start.reference.get_mut(1).into_iter().flatten()).for_each(|x| *x = -*x);
    }
}

/// Δq(0), of any norm.
fn error_at_start(start: &Start, target: &Trajectory) -> Option<Quaternion> {
    let mut jets = [[0.0; 5]; 4];
    target.jets(0.0, &mut jets);
    start.q.first_chunk::<4>().map(|q| difference(*q, jets.map(|jet| jet[0])))
}

/// The angle by which the law turns a spacecraft from this start to where its target is then, from 0 to 2π, rad; it would turn −q by
/// what is left of 2π.
pub(super) fn turn_rad(start: &Start, target: &Trajectory) -> Option<f64> {
    let error = error_at_start(start, target)?;
    Some(if error[3] < 0.0 { TAU - angle(error) } else { angle(error) })
}
