//! What acts at the joints of a robot besides its bodies, axis by axis, as files and programs state it: damping, rotors, friction.
//!
//! ```
//! use forwardstep_core::robot::PlanarLinks;
//! use forwardstep_sim::RobotSetup;
//! use forwardstep_sim::drives::{JointDrives, JointFriction};
//!
//! let arm = RobotSetup::planar_arm(&PlanarLinks::uniform([2.0, 1.5], [1.0, 0.8]));
//! let friction = JointFriction { coulomb: vec![0.5, 0.0], width: vec![0.01; 2], dry_s: Some(1e-3) };
//! let drives = JointDrives { damping: None, armature: vec![0.2, 0.1], friction: Some(friction) };
//! let arm = arm.with_drives(&drives)?;
//! assert_eq!(arm.theta_names[5..], ["shoulder.armature_kg_m2", "elbow.armature_kg_m2", "shoulder.friction_n_m"]);
//! # Ok::<(), forwardstep_sim::quantity::QuantityError>(())
//! ```

use forwardstep_core::robot::{Drives, Friction};

use crate::quantity::{Path, QuantityError, as_many, each, not_negative, positive, such};
use crate::setup::{AxisUnit, RobotSetup};

/// Damping, rotors and friction, an entry per axis; where it is zero there is none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointDrives {
    /// The viscous damping, N m s or N s/m; `None` for what the robot has.
    pub damping: Option<Vec<f64>>,
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

/// The drives of a robot with the values of their parameters.
#[derive(Default)]
struct Valued {
    drives: Drives,
    dampings: Vec<f64>,
    armatures: Vec<f64>,
    frictions: Vec<f64>,
}

impl RobotSetup {
    /// The same robot with these drives, whose parameters close ϑ.
    ///
    /// # Errors
    /// [`QuantityError`], at `damping`, `armature` or in the table `friction`, for a list of another length, for a number without meaning,
    /// and where a robot cannot have any, as a ship.
    pub fn with_drives(mut self, drives: &JointDrives) -> Result<RobotSetup, QuantityError> {
        let before = self.interface().drives;
        let Valued { drives, dampings, armatures, frictions } = self.valued(&before, drives)?;
        let asked = !(dampings.is_empty() && armatures.is_empty() && frictions.is_empty());
        let driven = self.kind.lagrangian().and_then(|robot| robot.with_drives(drives.clone()));
        such(
            driven.is_some() || !asked,
            Path::default(),
            "armature",
            0.0,
            "must be left out: this robot has no joints",
        )?;
        let Some(kind) = driven else { return Ok(self) };
        let name = |joint: usize, [turning, sliding]: [&str; 2]| {
            let axis = self.axes.get(joint);
            let unit = if axis.is_some_and(|axis| axis.unit == AxisUnit::Radian) { turning } else { sliding };
            format!("{}.{unit}", axis.map_or("", |axis| &axis.name))
        };
        let named = drives.damped.iter().map(|joint| name(*joint, ["damping_n_m_s", "damping_n_s_m"]));
        let named = named.chain(drives.geared.iter().map(|joint| name(*joint, ["armature_kg_m2", "armature_kg"])));
        let named = named.chain(drives.friction.iter().map(|f| name(f.joint, ["friction_n_m", "friction_n"])));
        let named: Vec<String> = named.collect();
        let bodies = self.theta.len().saturating_sub(before.count());
        self.theta.truncate(bodies);
        self.theta_names.truncate(bodies);
        self.theta.extend(dampings.into_iter().chain(armatures).chain(frictions));
        self.theta_names.extend(named);
        self.kind = kind;
        Ok(self)
    }

    /// The viscous damping of every axis, N m s or N s/m, as far as it is a drive.
    pub fn damping(&self) -> Vec<f64> {
        let drives = self.interface().drives;
        let values = self.drive_parameters(&drives).map_or(&[][..], |[dampings, ..]| dampings);
        spread(self.axes.len(), drives.damped.iter().copied(), values)
    }

    /// The armature of every axis, kg m² or kg.
    pub fn armature(&self) -> Vec<f64> {
        let drives = self.interface().drives;
        let values = self.drive_parameters(&drives).map_or(&[][..], |[_, armatures, _]| armatures);
        spread(self.axes.len(), drives.geared.iter().copied(), values)
    }

    /// F of every axis, N m or N.
    pub fn coulomb(&self) -> Vec<f64> {
        let drives = self.interface().drives;
        let values = self.drive_parameters(&drives).map_or(&[][..], |[.., frictions]| frictions);
        spread(self.axes.len(), drives.friction.iter().map(|friction| friction.joint), values)
    }

    /// What `asked` says, checked.
    fn valued(&self, before: &Drives, asked: &JointDrives) -> Result<Valued, QuantityError> {
        let (axes, here) = (self.axes.len(), Path::default);
        let mut found = Valued::default();
        match &asked.damping {
            Some(damping) => {
                as_many(here(), "damping", damping, ("axes", axes))?;
                each(here(), "damping", damping, not_negative)?;
                found.drives.damped = (0..axes).filter(|axis| damping[*axis] > 0.0).collect();
                found.dampings = found.drives.damped.iter().map(|axis| damping[*axis]).collect();
            }
            None => {
                found.drives.damped.clone_from(&before.damped);
                found.dampings = self.drive_parameters(before).map_or_else(Vec::new, |[own, ..]| own.to_vec());
            }
        }
        let armature = if asked.armature.is_empty() { vec![0.0; axes] } else { asked.armature.clone() };
        as_many(here(), "armature", &armature, ("axes", axes))?;
        each(here(), "armature", &armature, not_negative)?;
        found.drives.geared = (0..axes).filter(|axis| armature[*axis] > 0.0).collect();
        found.armatures = found.drives.geared.iter().map(|axis| armature[*axis]).collect();
        if let Some(JointFriction { coulomb, width, dry_s }) = &asked.friction {
            let place = || here().key(if dry_s.is_some() { "friction.dry" } else { "friction.smooth" });
            as_many(place(), "coulomb", coulomb, ("axes", axes))?;
            as_many(place(), "width", width, ("axes", axes))?;
            each(place(), "coulomb", coulomb, not_negative)?;
            each(place(), "width", width, positive)?;
            if let Some(period_s) = dry_s {
                positive(place(), "period_s", *period_s)?;
            }
            let rubs = (0..axes).filter(|axis| coulomb[*axis] > 0.0);
            found.drives.friction = rubs.map(|joint| Friction { joint, width: width[joint] }).collect();
            found.drives.dry_s = dry_s.filter(|_| !found.drives.friction.is_empty());
            found.frictions = found.drives.friction.iter().map(|friction| coulomb[friction.joint]).collect();
        }
        Ok(found)
    }
}

/// The values at their joints, and zero elsewhere.
fn spread(axes: usize, joints: impl Iterator<Item = usize>, values: &[f64]) -> Vec<f64> {
    let mut all = vec![0.0; axes];
    for (joint, value) in joints.zip(values) {
        if let Some(own) = all.get_mut(joint) {
            *own = *value;
        }
    }
    all
}
