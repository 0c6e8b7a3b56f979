//! Friction at the joints of robots, as files state it: `robot.urdf.friction`, and that of robots in closed form.

use forwardstep_sim::RobotSetup;
use forwardstep_sim::drives::{JointDrives, JointFriction};
use schemars::JsonSchema;
use serde::Deserialize;

use super::{At, AxisValues, Fault, number_or};
use crate::scenario::values::{NotNegativeEach, Positive};

/// What to do with Coulomb friction.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FrictionFile {
    /// Simulate without it.
    Ignore,
    /// F sgn(q̇), set-valued, so that joints stick. The law compensates F tanh(z/ε); no theorem covers what is left.
    Dry(DryFile),
    /// F tanh(q̇/ε), which the theorems cover.
    Smooth(SmoothFile),
}

/// Dry friction.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DryFile {
    /// F for all joints or for each, in N m or N. Default: what the URDF states.
    #[schemars(with = "Option<NotNegativeEach>")]
    pub coulomb: Option<At<AxisValues>>,
    /// ε of the law, in rad/s or m/s. Default: 0.01.
    pub width: Option<At<AxisValues>>,
    /// The longest period over which the friction of the robot is held, in s. Default: 0.001.
    #[schemars(with = "Option<Positive>")]
    pub period_s: Option<At<f64>>,
}

/// Smooth friction.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SmoothFile {
    /// F for all joints or for each, in N m or N. Default: what the URDF states.
    #[schemars(with = "Option<NotNegativeEach>")]
    pub coulomb: Option<At<AxisValues>>,
    /// ε of robot and law, in rad/s or m/s. Default: 0.01.
    pub width: Option<At<AxisValues>>,
}

/// ε, rad/s or m/s.
const WIDTH: f64 = 0.01;
/// The longest period over which dry friction is held, s.
const PERIOD_S: f64 = 1e-3;

impl FrictionFile {
    /// The friction of a robot whose URDF states `stated`.
    pub(super) fn of(&self, stated: &[f64]) -> Option<JointFriction> {
        let (coulomb, width, dry_s) = match self {
            FrictionFile::Ignore => return None,
            FrictionFile::Dry(DryFile { coulomb, width, period_s }) => {
                (coulomb, width, Some(number_or(period_s, PERIOD_S)))
            }
            FrictionFile::Smooth(SmoothFile { coulomb, width }) => (coulomb, width, None),
        };
        Some(JointFriction { coulomb: each(coulomb.as_ref(), stated), width: widths(width, stated.len()), dry_s })
    }
}

/// Coulomb friction of a robot in closed form.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StatedFrictionFile {
    /// F sgn(q̇), set-valued, so that axes stick. The law compensates F tanh(z/ε); no theorem covers what is left.
    Dry(StatedDryFile),
    /// F tanh(q̇/ε), which the theorems cover.
    Smooth(StatedSmoothFile),
}

/// Dry friction of a robot in closed form.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StatedDryFile {
    /// F for all axes or for each, in N m or N.
    #[schemars(with = "NotNegativeEach")]
    pub coulomb: At<AxisValues>,
    /// ε of the law, in rad/s or m/s. Default: 0.01.
    pub width: Option<At<AxisValues>>,
    /// The longest period over which the friction of the robot is held, in s. Default: 0.001.
    #[schemars(with = "Option<Positive>")]
    pub period_s: Option<At<f64>>,
}

/// Smooth friction of a robot in closed form.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StatedSmoothFile {
    /// F for all axes or for each, in N m or N.
    #[schemars(with = "NotNegativeEach")]
    pub coulomb: At<AxisValues>,
    /// ε of robot and law, in rad/s or m/s. Default: 0.01.
    pub width: Option<At<AxisValues>>,
}

impl StatedFrictionFile {
    fn of(&self, axes: usize) -> JointFriction {
        let (coulomb, width, dry_s) = match self {
            StatedFrictionFile::Dry(StatedDryFile { coulomb, width, period_s }) => {
                (coulomb, width, Some(number_or(period_s, PERIOD_S)))
            }
            StatedFrictionFile::Smooth(StatedSmoothFile { coulomb, width }) => (coulomb, width, None),
        };
        JointFriction { coulomb: coulomb.value.each(axes), width: widths(width, axes), dry_s }
    }
}

/// `robot` in closed form with what its table says of its joints.
pub(super) fn driven(
    robot: RobotSetup,
    damping: Option<&At<AxisValues>>,
    armature: Option<&At<AxisValues>>,
    friction: Option<&StatedFrictionFile>,
) -> Result<RobotSetup, Fault> {
    let axes = robot.axes.len();
    let drives = JointDrives {
        damping: damping.map(|place| place.value.each(axes)),
        armature: each(armature, &vec![0.0; axes]),
        friction: friction.map(|friction| friction.of(axes)),
    };
    Ok(robot.with_drives(&drives)?)
}

/// ε of each axis.
fn widths(file: &Option<At<AxisValues>>, axes: usize) -> Vec<f64> {
    each(file.as_ref(), &vec![WIDTH; axes])
}

/// One number for each axis, or the default ones.
pub(super) fn each(file: Option<&At<AxisValues>>, usual: &[f64]) -> Vec<f64> {
    file.map_or_else(|| usual.to_vec(), |place| place.value.each(usual.len()))
}
