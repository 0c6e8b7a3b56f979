//! What a robot has at its joints besides what its URDF tells of bodies: rotors and Coulomb friction.

use std::sync::Arc;

use forwardstep_core::robot::tree::{Drives, Friction, Tree};
use forwardstep_sim::quantity::{Path, QuantityError, as_many, each, not_negative, positive};

use super::UrdfRobot;

/// Rotors and friction, an entry per axis; none where it is zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointDrives {
    /// The inertia of the rotor behind the gear, kg m² or kg: n²J for a rotor that turns n times as fast as its joint. Empty for none.
    pub armature: Vec<f64>,
    /// The friction, if the model has some.
    pub friction: Option<JointFriction>,
}

/// Coulomb friction.
#[derive(Clone, Debug, PartialEq)]
pub struct JointFriction {
    /// F, N m or N.
    pub coulomb: Vec<f64>,
    /// ε, rad/s or m/s.
    pub width: Vec<f64>,
    /// The longest period over which the friction of the plant is held, s, if it is set-valued; smooth otherwise.
    pub dry_s: Option<f64>,
}

impl UrdfRobot {
    /// The same robot with these drives, whose parameters close ϑ.
    ///
    /// # Errors
    /// [`QuantityError`], at `armature` or in the table `friction`, for a list of another length and for a number without meaning.
    pub fn with_drives(mut self, drives: &JointDrives) -> Result<UrdfRobot, QuantityError> {
        let axes = self.robot.axes.len();
        let Some(tree) = self.robot.kind.downcast::<Arc<Tree>>().map(|tree| Tree::clone(tree)) else { return Ok(self) };
        let here = Path::default;
        let armature = if drives.armature.is_empty() { vec![0.0; axes] } else { drives.armature.clone() };
        as_many(here(), "armature", &armature, ("axes", axes))?;
        each(here(), "armature", &armature, not_negative)?;
        let mut own = Drives { geared: (0..axes).filter(|axis| armature[*axis] > 0.0).collect(), ..Drives::default() };
        let mut theta: Vec<f64> = own.geared.iter().map(|axis| armature[*axis]).collect();
        if let Some(JointFriction { coulomb, width, dry_s }) = &drives.friction {
            let place = || Path::default().key(if dry_s.is_some() { "friction.dry" } else { "friction.smooth" });
            as_many(place(), "coulomb", coulomb, ("axes", axes))?;
            as_many(place(), "width", width, ("axes", axes))?;
            each(place(), "coulomb", coulomb, not_negative)?;
            each(place(), "width", width, positive)?;
            if let Some(period_s) = dry_s {
                positive(place(), "period_s", *period_s)?;
            }
            let rubs = (0..axes).filter(|axis| coulomb[*axis] > 0.0);
            own.friction = rubs.map(|joint| Friction { joint, width: width[joint] }).collect();
            own.dry_s = dry_s.filter(|_| !own.friction.is_empty());
            theta.extend(own.friction.iter().map(|friction| coulomb[friction.joint]));
        }
        // Joints are in order, and all numbers were looked at.
        let Ok(tree) = tree.with_drives(own) else { return Ok(self) };
        let names: Vec<&str> = self.robot.axes.iter().map(|axis| axis.name.as_str()).collect();
        let first = tree.theta_len() - theta.len();
        if let Ok(all) = tree.theta_names(&names) {
            self.robot.theta_names.extend(all.into_iter().skip(first));
        }
        self.robot.theta.extend(theta);
        self.robot.kind = Arc::new(Arc::new(tree));
        Ok(self)
    }
}
