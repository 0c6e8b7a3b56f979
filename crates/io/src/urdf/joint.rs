//! `<joint>`: which two links it connects, and how the second may move.

use std::ops::Range;

use super::ignored::IgnoreReason;
use super::link::{Origin, read_origin};
use super::notice::NoticeKind;
use super::problem::UrdfProblem;
use super::subject::Owner;
use super::xml::{Element, Located, Reading, UrdfError};
use crate::wording::nearest;

/// A joint as the file states it.
#[derive(Clone, Debug)]
pub(super) struct Joint {
    pub(super) name: String,
    /// Bytes of the name.
    pub(super) span: Range<usize>,
    pub(super) parent: Located<String>,
    pub(super) child: Located<String>,
    pub(super) origin: Origin,
    /// `None` for a fixed joint.
    pub(super) motion: Option<Motion>,
}

/// What a joint that is not fixed may do.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    pub(super) kind: MotionKind,
    /// Of unit length.
    pub(super) axis: [f64; 3],
    pub(super) position_limits: Option<[f64; 2]>,
    pub(super) velocity_limit: Option<f64>,
    pub(super) effort_limit: Option<f64>,
    pub(super) damping: f64,
    /// Coulomb friction, where it is not zero.
    pub(super) friction: Option<Located<f64>>,
    /// Bytes of `<mimic` and the joint it names.
    pub(super) mimic: Option<Located<Option<String>>>,
}

/// The type of a joint that moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionKind {
    /// Turns about its axis, usually between limits.
    Revolute,
    /// Turns about its axis without end.
    Continuous,
    /// Slides along its axis.
    Prismatic,
}

const TYPES: [&str; 7] = ["revolute", "continuous", "prismatic", "fixed", "floating", "planar", "spherical"];

/// Reads a `<joint>`; `is_locked` tells whether its motion will be taken away, so that its limits do not matter.
pub(super) fn read_joint(
    reading: &mut Reading<'_>,
    element: Element<'_>,
    is_locked: impl Fn(&str) -> bool,
) -> Result<Joint, UrdfError> {
    let name = element.required_text(reading, "name", "joint")?;
    let (span, name) = (name.span, name.value.to_owned());
    let element = element.owned_by(Owner::Joint(name.clone()));
    let given = element.required_text(reading, "type", "joint")?;
    element.only_attributes(reading, &["name", "type"]);
    let kind = match given.value {
        "revolute" => Some(MotionKind::Revolute),
        "continuous" => Some(MotionKind::Continuous),
        "prismatic" => Some(MotionKind::Prismatic),
        "fixed" => None,
        other => {
            let given_type = other.chars().take(40).collect();
            let problem = match other {
                "floating" | "planar" | "spherical" | "ball" => {
                    UrdfProblem::UnsupportedJointType { joint: name, given: given_type }
                }
                _ => UrdfProblem::UnknownJointType { joint: name, given: given_type, nearest: nearest(other, TYPES) },
            };
            return Err(reading.error(given.span, problem));
        }
    };

    let [parent, child, origin, axis, limit, dynamics, mimic] = element.children_once(
        reading,
        ["parent", "child", "origin", "axis", "limit", "dynamics", "mimic"],
        |name| match name {
            "calibration" | "safety_controller" => Some(IgnoreReason::Controller),
            "sensor" => Some(IgnoreReason::Sensor),
            "gazebo" => Some(IgnoreReason::Simulator),
            _ => None,
        },
    )?;
    let parent = read_end(reading, &element, parent, "parent")?;
    let child = read_end(reading, &element, child, "child")?;
    let origin = read_origin(reading, origin)?;
    let motion = match kind {
        Some(kind) => {
            let notices_before = reading.notices.len();
            let mut motion = Motion {
                kind,
                axis: read_axis(reading, axis, &name, &span)?,
                position_limits: None,
                velocity_limit: None,
                effort_limit: None,
                damping: 0.0,
                friction: None,
                mimic: None,
            };
            read_limit(reading, limit, &name, &span, &mut motion)?;
            if let Some(dynamics) = dynamics {
                dynamics.only_attributes(reading, &["damping", "friction"]);
                motion.damping = dynamics.non_negative(reading, "damping", "dynamics")?.map_or(0.0, |d| d.value);
                motion.friction = dynamics.non_negative(reading, "friction", "dynamics")?.filter(|f| f.value != 0.0);
            }
            if let Some(mimic) = mimic {
                let leader = mimic.text(reading, "joint")?.map(|located| located.value.to_owned());
                motion.mimic = Some(Located { value: leader, span: mimic.span() });
            }
            if is_locked(&name) {
                reading.notices.truncate(notices_before);
            }
            Some(motion)
        }
        None => {
            for useless in [axis, limit, dynamics, mimic].into_iter().flatten() {
                useless.ignore(reading, &[], |_| Some(IgnoreReason::FixedJoint));
            }
            None
        }
    };
    Ok(Joint { name, span, parent, child, origin, motion })
}

fn read_end(
    reading: &mut Reading<'_>,
    joint: &Element<'_>,
    end: Option<Element<'_>>,
    which: &'static str,
) -> Result<Located<String>, UrdfError> {
    let Some(end) = end else {
        let owner = joint.owner.clone().unwrap_or(Owner::Robot);
        return Err(reading.error(joint.span(), UrdfProblem::MissingElement { owner, parent: None, element: which }));
    };
    end.only_attributes(reading, &["link"]);
    let link = end.required_text(reading, "link", which)?;
    Ok(Located { value: link.value.to_owned(), span: link.span })
}

/// The unit axis; x when none is stated.
fn read_axis(
    reading: &mut Reading<'_>,
    axis: Option<Element<'_>>,
    joint: &str,
    joint_span: &Range<usize>,
) -> Result<[f64; 3], UrdfError> {
    let Some(axis) = axis else {
        reading.notice(joint_span, NoticeKind::AxisDefault { joint: joint.to_owned() });
        return Ok([1.0, 0.0, 0.0]);
    };
    axis.only_attributes(reading, &["xyz"]);
    let Some(Located { value: given, span }) = axis.numbers::<3>(reading, "xyz", "axis")? else {
        reading.notice(&axis.span(), NoticeKind::AxisDefault { joint: joint.to_owned() });
        return Ok([1.0, 0.0, 0.0]);
    };
    // Scaled by the largest entry first: squares of very large or small numbers leave the range of f64.
    let largest = given.iter().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
    if largest == 0.0 {
        return Err(reading.error(span, UrdfProblem::ZeroAxis { joint: joint.to_owned() }));
    }
    let scaled = given.map(|entry| entry / largest);
    let length = scaled.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
    let used = scaled.map(|entry| entry / length);
    // Rounding to six digits is no mistake.
    if (length * largest - 1.0).abs() > 2e-6 {
        reading.notice(&span, NoticeKind::AxisNormalised { joint: joint.to_owned(), given, used });
    }
    Ok(used)
}

fn read_limit(
    reading: &mut Reading<'_>,
    limit: Option<Element<'_>>,
    name: &str,
    joint_span: &Range<usize>,
    motion: &mut Motion,
) -> Result<(), UrdfError> {
    let joint = || name.to_owned();
    let Some(limit) = limit else {
        if motion.kind != MotionKind::Continuous {
            reading.notice(joint_span, NoticeKind::LimitMissing { joint: joint() });
        }
        return Ok(());
    };
    let span = limit.span();
    limit.only_attributes(reading, &["lower", "upper", "effort", "velocity"]);
    for (quantity, slot) in [("effort", &mut motion.effort_limit), ("velocity", &mut motion.velocity_limit)] {
        match limit.non_negative(reading, quantity, "limit")? {
            Some(Located { value, span }) => {
                *slot = Some(value);
                if value == 0.0 {
                    reading.notice(&span, NoticeKind::LimitZero { joint: joint(), quantity });
                }
            }
            None => {
                reading.notice(&span, NoticeKind::LimitIncomplete { joint: joint(), missing: quantity, assumed: None });
            }
        }
    }
    if motion.kind == MotionKind::Continuous {
        limit.ignore_attribute(reading, "lower", IgnoreReason::ContinuousJoint);
        limit.ignore_attribute(reading, "upper", IgnoreReason::ContinuousJoint);
        return Ok(());
    }
    let lower = limit.number(reading, "lower", "limit")?;
    let upper = limit.number(reading, "upper", "limit")?;
    if lower.is_none() && upper.is_none() {
        reading.notice(&span, NoticeKind::RangeMissing { joint: joint() });
        return Ok(());
    }
    for (missing, _) in [("lower", &lower), ("upper", &upper)].into_iter().filter(|(_, given)| given.is_none()) {
        reading.notice(&span, NoticeKind::LimitIncomplete { joint: joint(), missing, assumed: Some(0.0) });
    }
    let [lower, upper] = [lower, upper].map(|limit| limit.map_or(0.0, |located| located.value));
    if lower > upper {
        return Err(reading.error(span, UrdfProblem::InvertedLimits { joint: joint(), lower, upper }));
    }
    if lower == upper {
        reading.notice(&span, NoticeKind::RangeEmpty { joint: joint(), at: lower });
    }
    motion.position_limits = Some([lower, upper]);
    Ok(())
}
