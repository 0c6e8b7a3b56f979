//! The dynamics of a robot at a state, without friction and damping.

use std::sync::Arc;

use forwardstep::core::LengthError;
use forwardstep::core::robot::tree::Tree;
use forwardstep::core::robot::{Called, Lagrangian, TwoVelocity};
use forwardstep::io::UrdfRobot;
use forwardstep::io::robot::{Dynamics, JointState};
use thiserror::Error;

/// Why there are no numbers.
#[derive(Clone, Debug, PartialEq, Error)]
pub(crate) enum DynamicsError {
    /// The robot was not read from a URDF.
    #[error("only robots from a URDF have these dynamics")]
    NotATree,
    /// A state of another robot.
    #[error(transparent)]
    Length(#[from] LengthError),
    /// The state is so large that a number overflows, or so odd that M cannot be solved for.
    #[error("`{quantity}` of joint `{joint}` comes out as {value}, which is not finite")]
    NotFinite {
        /// `M`, `g`, `tau` or `ddq`.
        quantity: &'static str,
        /// The joint.
        joint: String,
        /// What was computed.
        value: f64,
    },
}

impl DynamicsError {
    /// What the user can do about it.
    pub(crate) fn help(&self) -> Option<&'static str> {
        match self {
            DynamicsError::NotFinite { .. } => Some("give smaller numbers in the state"),
            DynamicsError::NotATree | DynamicsError::Length(_) => None,
        }
    }
}

/// M, g, τ = M ż + C(q, q̇) z + g and the acceleration under τ.
pub(crate) fn dynamics(robot: &UrdfRobot, state: &JointState) -> Result<Dynamics, DynamicsError> {
    let Some(tree) = robot.robot.kind.downcast::<Arc<Tree>>() else { return Err(DynamicsError::NotATree) };
    let n = tree.joint_count();
    let mut theta = robot.robot.theta.clone();
    // Ten inertial parameters per body, then the damping.
    theta.iter_mut().skip(10 * n).for_each(|damping| *damping = 0.0);

    let JointState { q, dq, z, dz } = state;
    let mut scratch = tree.scratch::<f64>();
    let (mut mass, mut gravity, mut tau, mut ddq) = (vec![0.0; n * n], vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    tree.mass_matrix(&mut scratch, q, &theta, &mut mass)?;
    tree.gravity(&mut scratch, q, &theta, &mut gravity)?;
    let (still, mut unused) = (vec![0.0; n], vec![0.0; theta.len()]);
    let motion = TwoVelocity { q, dq, z, dz };
    Called(&**tree).regressor_products(&mut scratch, motion, &theta, &still, &mut tau, &mut unused)?;
    Called(&**tree).forward_dynamics(&mut scratch, q, dq, &theta, &tau, &mut ddq)?;

    let joints: Vec<String> = robot.robot.axes.iter().map(|axis| axis.name.clone()).collect();
    for (quantity, numbers) in [("M", &mass), ("g", &gravity), ("tau", &tau), ("ddq", &ddq)] {
        if let Some(k) = numbers.iter().position(|number| !number.is_finite()) {
            // The mass matrix has a row per joint.
            let row = k / (numbers.len() / n).max(1);
            let (joint, value) = (joints.get(row).cloned().unwrap_or_default(), numbers[k]);
            return Err(DynamicsError::NotFinite { quantity, joint, value });
        }
    }
    let mass_matrix = mass.chunks(n).map(<[f64]>::to_vec).collect();
    Ok(Dynamics { joints, mass_matrix, gravity, tau, ddq })
}
