//! Joints that are held at a value.

use super::joint::Joint;
use super::notice::NoticeKind;
use super::problem::UrdfProblem;
use super::xml::{Reading, UrdfError};
use crate::wording::nearest;

/// The value at which each joint is held, for each joint of the file.
pub(super) fn locks(
    reading: &mut Reading<'_>,
    joints: &[Joint],
    wanted: &[(String, f64)],
) -> Result<Vec<Option<f64>>, UrdfError> {
    let mut held = vec![None; joints.len()];
    for (name, value) in wanted {
        let name = || name.clone();
        let Some(j) = joints.iter().position(|joint| joint.name == name()) else {
            let movable = joints.iter().filter(|joint| joint.motion.is_some()).map(|joint| joint.name.as_str());
            let nearest = nearest(&name(), movable);
            return Err(reading.error_overall(UrdfProblem::LockUnknown { joint: name(), nearest }));
        };
        let joint = &joints[j];
        let Some(motion) = &joint.motion else {
            return Err(reading.error(joint.span.clone(), UrdfProblem::LockFixed { joint: name() }));
        };
        if !value.is_finite() {
            let problem = UrdfProblem::LockNotFinite { joint: name(), value: *value };
            return Err(reading.error(joint.span.clone(), problem));
        }
        if let Some(first) = held[j] {
            let problem = UrdfProblem::LockTwice { joint: name(), first, second: *value };
            return Err(reading.error(joint.span.clone(), problem));
        }
        match motion.position_limits {
            Some(limits) if *value < limits[0] || *value > limits[1] => {
                reading.notice(&joint.span, NoticeKind::LockOutside { joint: name(), value: *value, limits });
            }
            _ => {}
        }
        held[j] = Some(*value);
    }
    Ok(held)
}
