//! What there is to say about a robot, for people and as JSON.

use forwardstep_sim::AxisUnit;
use serde::Serialize;

use crate::urdf::{MotionKind, UrdfRobot};

/// A robot in words and numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RobotDescription {
    /// The name the file gives it.
    pub name: String,
    /// The link that is fixed to the world.
    pub base: String,
    /// The degrees of freedom in order.
    pub joints: Vec<JointDescription>,
    /// The body that each of them moves.
    pub bodies: Vec<BodyDescription>,
    /// The mass of all bodies, in kg.
    pub moving_mass_kg: f64,
    /// The mass that is rigid with the base and does not enter, in kg.
    pub held_mass_kg: f64,
    /// What was left out, assumed or found odd.
    pub notices: Vec<String>,
}

/// A degree of freedom. Limits that the file does not state are absent.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JointDescription {
    /// Its name.
    pub name: String,
    /// `revolute`, `continuous` or `prismatic`.
    #[serde(rename = "type")]
    pub kind: &'static str,
    /// `rad` or `m`: that of positions; velocities are per s.
    pub unit: &'static str,
    /// `N m` or `N`.
    pub effort_unit: &'static str,
    /// Lowest and highest position.
    pub position_limits: Option<[f64; 2]>,
    /// Highest speed.
    pub velocity_limit: Option<f64>,
    /// Highest torque or force.
    pub effort_limit: Option<f64>,
    /// Viscous damping, in N m s/rad or N s/m.
    pub damping: f64,
    /// Coulomb friction as the file states it, in the unit of efforts.
    pub friction: f64,
}

/// What is rigid together and moves.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BodyDescription {
    /// The link that its joint carries.
    pub name: String,
    /// In kg.
    pub mass_kg: f64,
    /// In m, in the frame of that link; absent for a body without mass.
    pub centre_of_mass_m: Option<[f64; 3]>,
}

impl RobotDescription {
    /// Describes `robot`.
    pub fn new(robot: &UrdfRobot) -> Self {
        let theta = &robot.robot.theta;
        let losses = robot.robot.damping().into_iter().zip(&robot.coulomb);
        let kinds = robot.kinds.iter().zip(&robot.robot.axes).zip(losses);
        let joints = kinds.map(|((kind, axis), (damping, friction))| {
            let unit = match axis.unit {
                AxisUnit::Radian => "rad",
                AxisUnit::Metre => "m",
                AxisUnit::One | AxisUnit::Own => "1",
            };
            JointDescription {
                name: axis.name.clone(),
                kind: match kind {
                    MotionKind::Revolute => "revolute",
                    MotionKind::Continuous => "continuous",
                    MotionKind::Prismatic => "prismatic",
                },
                unit,
                effort_unit: axis.unit.effort(),
                position_limits: axis.position_limits,
                velocity_limit: axis.velocity_limit,
                effort_limit: axis.effort_limit,
                damping,
                friction: *friction,
            }
        });
        let parameters = theta.chunks_exact(10).zip(&robot.bodies);
        let bodies: Vec<_> = parameters
            .map(|(pi, name)| BodyDescription {
                name: name.clone(),
                mass_kg: pi[0],
                centre_of_mass_m: (pi[0] != 0.0).then(|| [pi[1] / pi[0], pi[2] / pi[0], pi[3] / pi[0]]),
            })
            .collect();
        RobotDescription {
            name: robot.name.clone(),
            base: robot.base.clone(),
            joints: joints.collect(),
            moving_mass_kg: bodies.iter().map(|body| body.mass_kg).sum(),
            bodies,
            held_mass_kg: robot.held_mass_kg,
            notices: robot.notices.iter().map(ToString::to_string).collect(),
        }
    }

    /// The description as one JSON object, numbers with all their digits.
    pub fn to_json(&self) -> String {
        to_json(self)
    }
}

/// The dynamics at a state, without friction and damping.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Dynamics {
    /// The degrees of freedom in order.
    pub joints: Vec<String>,
    /// The mass matrix M(q), row by row.
    #[serde(rename = "M")]
    pub mass_matrix: Vec<Vec<f64>>,
    /// The gravity torque g(q).
    #[serde(rename = "g")]
    pub gravity: Vec<f64>,
    /// τ = M ż + C(q, q̇) z + g.
    pub tau: Vec<f64>,
    /// The acceleration under τ.
    pub ddq: Vec<f64>,
}

impl Dynamics {
    /// The numbers as one JSON object, with all their digits.
    pub fn to_json(&self) -> String {
        to_json(self)
    }
}

/// Texts, lists and numbers always have a JSON.
fn to_json(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default()
}
