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
    let Located { value: name, span } = element.own_name(reading, "joint");
    let element = element.owned_by(Owner::Joint(name.clone()));
    let given = element.required_text(reading, "type", "joint");
    element.only_attributes(reading, &["name", "type"]);
    let kind = match reading.noted(given) {
        Some(given) => match kind_of(reading, &given, &name) {
            Ok(kind) => kind,
            Err(error) => {
                // A slip: what it has of a joint that moves is read.
                let is_slip = matches!(error.problem, UrdfProblem::UnknownJointType { .. });
                reading.noted::<()>(Err(error));
                is_slip.then_some(MotionKind::Revolute)
            }
        },
        None => None,
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
    let [parent, child] = [(parent, "parent"), (child, "child")].map(|(end, which)| {
        let end = read_end(reading, &element, end, which);
        reading.noted(end).unwrap_or_else(|| {
            reading.has_gaps = true;
            Located { value: String::new(), span: element.span() }
        })
    });
    let origin = read_origin(reading, origin)?;
    let motion = match kind {
        Some(kind) => {
            let notices_before = reading.notices.len();
            let mut motion = Motion {
                kind,
                axis: {
                    let axis = read_axis(reading, axis, &name, &span);
                    reading.noted(axis).unwrap_or([1.0, 0.0, 0.0])
                },
                position_limits: None,
                velocity_limit: None,
                effort_limit: None,
                damping: 0.0,
                friction: None,
                mimic: None,
            };
            read_limit(reading, limit, &name, &span, &mut motion);
            if let Some(dynamics) = dynamics {
                dynamics.only_attributes(reading, &["damping", "friction"]);
                let [damping, friction] = ["damping", "friction"].map(|name| {
                    let read = dynamics.non_negative(reading, name, "dynamics");
                    reading.noted(read).flatten()
                });
                motion.damping = damping.map_or(0.0, |damping| damping.value);
                motion.friction = friction.filter(|friction| friction.value != 0.0);
            }
            if let Some(mimic) = mimic {
                let leader = mimic.text(reading, "joint");
                let leader = reading.noted(leader).flatten().map(|located| located.value.to_owned());
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

/// What a joint of this type may do; nothing when it is fixed.
fn kind_of(reading: &Reading<'_>, given: &Located<&str>, name: &str) -> Result<Option<MotionKind>, UrdfError> {
    match given.value {
        "revolute" => Ok(Some(MotionKind::Revolute)),
        "continuous" => Ok(Some(MotionKind::Continuous)),
        "prismatic" => Ok(Some(MotionKind::Prismatic)),
        "fixed" => Ok(None),
        other => {
            let (joint, given_type) = (name.to_owned(), other.chars().take(40).collect());
            let problem = match other {
                "floating" | "planar" | "spherical" | "ball" => {
                    UrdfProblem::UnsupportedJointType { joint, given: given_type }
                }
                _ => UrdfProblem::UnknownJointType { joint, given: given_type, nearest: nearest(other, TYPES) },
            };
            Err(reading.error(given.span.clone(), problem))
        }
    }
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

/// Whether these are whole numbers of degrees of which one makes no sense in rad, as 180: more than three turns to one side.
fn are_like_degrees(limits: [f64; 2]) -> bool {
    const THREE_TURNS: f64 = 3.0 * std::f64::consts::TAU;
    let is_angle = |limit: f64| limit.fract() == 0.0 && limit.abs() <= 360.0;
    limits.iter().all(|limit| is_angle(*limit)) && limits.iter().any(|limit| limit.abs() > THREE_TURNS)
}

fn read_limit(
    reading: &mut Reading<'_>,
    limit: Option<Element<'_>>,
    name: &str,
    joint_span: &Range<usize>,
    motion: &mut Motion,
) {
    let joint = || name.to_owned();
    let Some(limit) = limit else {
        if motion.kind != MotionKind::Continuous {
            reading.notice(joint_span, NoticeKind::LimitMissing { joint: joint() });
        }
        return;
    };
    let span = limit.span();
    limit.only_attributes(reading, &["lower", "upper", "effort", "velocity"]);
    for (quantity, slot) in [("effort", &mut motion.effort_limit), ("velocity", &mut motion.velocity_limit)] {
        let read = limit.non_negative(reading, quantity, "limit");
        match reading.noted(read) {
            Some(Some(Located { value, span })) => {
                *slot = Some(value);
                if value == 0.0 {
                    reading.notice(&span, NoticeKind::LimitZero { joint: joint(), quantity });
                }
            }
            Some(None) => {
                reading.notice(&span, NoticeKind::LimitIncomplete { joint: joint(), missing: quantity, assumed: None });
            }
            None => {}
        }
    }
    if motion.kind == MotionKind::Continuous {
        limit.ignore_attribute(reading, "lower", IgnoreReason::ContinuousJoint);
        limit.ignore_attribute(reading, "upper", IgnoreReason::ContinuousJoint);
        return;
    }
    let [lower, upper] = ["lower", "upper"].map(|name| {
        let read = limit.number(reading, name, "limit");
        reading.noted(read)
    });
    // Where one has no meaning, nothing is said of both.
    let (Some(lower), Some(upper)) = (lower, upper) else { return };
    if lower.is_none() && upper.is_none() {
        reading.notice(&span, NoticeKind::RangeMissing { joint: joint() });
        return;
    }
    for (missing, _) in [("lower", &lower), ("upper", &upper)].into_iter().filter(|(_, given)| given.is_none()) {
        reading.notice(&span, NoticeKind::LimitIncomplete { joint: joint(), missing, assumed: Some(0.0) });
    }
    let [lower, upper] = [lower, upper].map(|limit| limit.map_or(0.0, |located| located.value));
    if lower > upper {
        reading.noted::<()>(Err(reading.error(span, UrdfProblem::InvertedLimits { joint: joint(), lower, upper })));
        return;
    }
    if lower == upper {
        reading.notice(&span, NoticeKind::RangeEmpty { joint: joint(), at: lower });
    }
    if motion.kind == MotionKind::Revolute && are_like_degrees([lower, upper]) {
        reading.notice(&span, NoticeKind::LikeDegrees { joint: joint(), limits: [lower, upper] });
    }
    motion.position_limits = Some([lower, upper]);
}
