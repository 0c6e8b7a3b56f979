//! `robot.planar_arm`: the two-link planar arm in closed form.

use std::rc::Rc;

use forwardstep_core::robot::{PlanarLinks, PlanarTip};
use forwardstep_sim::{RobotSetup, Start};
use schemars::JsonSchema;
use serde::Deserialize;
use thiserror::Error;

use super::drives::{StatedFrictionFile, driven};
use super::{
    At, AxisValues, Body, Fault, InputFolder, LawTemplate, Mistake, RobotKind, RobotRead, RobotTable, RobotTemplate,
    Spread, StartReader, Stop, TaskTemplate, not_negative, positive,
};
use crate::scenario::values::{NotNegative, NotNegativeEach, Positive};

/// An arm whose mass matrix is not positive definite.
#[derive(Debug, Error)]
#[error("the mass matrix of this arm is not positive definite: its second link resists no torque")]
struct LimpArm;

impl Mistake for LimpArm {
    fn help(&self) -> Option<String> {
        Some("give the second link inertia, or a centre of mass off its joint".into())
    }
}

/// Masses and lengths of a two-link planar arm.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlanarArmFile {
    /// Mass of each link, in kg.
    #[schemars(with = "[Positive; 2]")]
    pub mass_kg: [At<f64>; 2],
    /// Length of each link, in m.
    #[schemars(with = "[Positive; 2]")]
    pub length_m: [At<f64>; 2],
    /// From each joint to the centre of mass of its link, in m. Default: the middle of the link.
    pub com_m: Option<[At<f64>; 2]>,
    /// Inertia of each link about its centre of mass, in kg m². Default: that of a uniform rod, m l²/12.
    #[schemars(with = "Option<[NotNegative; 2]>")]
    pub inertia_kg_m2: Option<[At<f64>; 2]>,
    /// Gravity, pointing down, in m/s². Default: 9.81.
    #[schemars(range(min = 0))]
    pub gravity_m_s2: Option<At<f64>>,
    /// Viscous damping of both joints or of each, in N m s. Default: none.
    #[schemars(with = "Option<NotNegativeEach>")]
    pub damping: Option<At<AxisValues>>,
    /// The inertia of the rotors behind the gears, for both joints or for each, in kg m²: n²J for a rotor with the inertia J that turns n
    /// times as fast as its joint. Default: none.
    #[schemars(with = "Option<NotNegativeEach>")]
    pub armature: Option<At<AxisValues>>,
    /// Coulomb friction. Default: none.
    pub friction: Option<StatedFrictionFile>,
}

impl RobotKind for PlanarArmFile {
    fn table() -> RobotTable {
        RobotTable {
            key: "planar_arm",
            description: "The two-link planar arm in closed form: the first angle from the horizontal, the second relative to the first link.",
            usual_law: "adaptive",
            template: Some(RobotTemplate {
                name: "arm",
                line: "robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8] }".into(),
                says: "uniform links",
                starts: vec![[-1.0, 1.0]; 2],
                law: LawTemplate::Adaptive,
                dry_friction: Some("friction.dry = { coulomb = 0.5 }"),
                task: TaskTemplate::LAGRANGIAN,
            }),
        }
    }

    fn read(&self, _: &mut InputFolder) -> Result<RobotRead, Stop> {
        let (robot, body) = arm(&links(self)?)?;
        let robot = driven(robot, self.damping.as_ref(), self.armature.as_ref(), self.friction.as_ref())?;
        Ok(RobotRead { robot, body, notices: Vec::new() })
    }

    fn spread(&self, read: &mut RobotRead, spread: &Spread<'_>) -> Result<(), Fault> {
        let (factors, mut links) = (spread.factors(4), links(self)?);
        for (k, (mass, length)) in factors[..2].iter().zip(&factors[2..]).enumerate() {
            links.mass_kg[k] *= mass;
            links.length_m[k] *= length;
            links.com_m[k] *= length;
            links.inertia_kg_m2[k] *= mass * length * length;
        }
        // What acts at the joints stays.
        let (robot, body) = arm(&links).map_err(|_| spread.unsound())?;
        read.robot = driven(robot, self.damping.as_ref(), self.armature.as_ref(), self.friction.as_ref())?;
        read.body = body;
        Ok(())
    }

    fn start(&self, _: &RobotSetup, given: &mut StartReader<'_>) -> Result<Start, Fault> {
        given.position_and_velocity()
    }
}

/// The links of a planar arm as its table says.
fn links(file: &PlanarArmFile) -> Result<PlanarLinks, Fault> {
    let pair = |key, [first, second]: &[At<f64>; 2]| Ok::<_, Fault>([positive(key, first)?, positive(key, second)?]);
    let mut links = PlanarLinks::uniform(pair("mass_kg", &file.mass_kg)?, pair("length_m", &file.length_m)?);
    if let Some([first, second]) = &file.com_m {
        links.com_m = [first.value, second.value];
    }
    if let Some([first, second]) = &file.inertia_kg_m2 {
        links.inertia_kg_m2 = [not_negative("inertia_kg_m2", first)?, not_negative("inertia_kg_m2", second)?];
    }
    if let Some(gravity) = &file.gravity_m_s2 {
        links.gravity_m_s2 = not_negative("gravity_m_s2", gravity)?;
    }
    Ok(links)
}

/// The arm with these links, and its end.
fn arm(links: &PlanarLinks) -> Result<(RobotSetup, Body), Fault> {
    let theta = links.theta();
    // det M = ϑ₂(ϑ₁ − ϑ₂) − ϑ₃² cos² q₂, smallest where the arm is straight.
    let [whole, outer, coupling, ..] = theta;
    let determinant = outer * (whole - outer) - coupling * coupling;
    if !(outer > 0.0 && determinant > 0.0 && theta.iter().all(|entry| entry.is_finite())) {
        return Err(Fault::new(LimpArm));
    }
    let robot = RobotSetup::planar_arm(links);
    Ok((robot, Body { links: Rc::new([]), tip: Some(PlanarTip { length_m: links.length_m }), urdf: None }))
}
