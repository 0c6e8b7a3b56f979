//! From agents to the systems of Section V-C: a robot and its tip, a spacecraft and its attitude.

use forwardstep_core::controller::{AttitudeTracking, TaskSpace};
use forwardstep_core::plant::{Mechanical, Spacecraft, TaskArm, Wheels};
use forwardstep_core::robot::tree::{Tree, TreeTip};
use forwardstep_core::robot::{Lagrangian, PlanarArm, TipKinematics};
use forwardstep_core::{Gain, LengthError, ResolvedGain};

use super::members::tracking_law;
use super::population::Columns;
use super::systems::{positive, solo};
use super::valid::SetupError;
use crate::setup::{AgentSetup, AttitudeLaw, ReferenceKind, RobotKind, Setup, TaskSpaceLaw, TipSetup};

/// A robot whose tip follows a target.
pub(super) fn task_space(setup: &Setup, agent: usize, law: &TaskSpaceLaw) -> Result<Box<dyn Columns>, SetupError> {
    let own = &setup.agents[agent];
    only_tracks(setup, own)?;
    match (&own.robot.kind, &law.tip) {
        (RobotKind::PlanarArm, TipSetup::Planar(tip)) => {
            with_tip(setup, agent, law, PlanarArm, *tip, tip.length_m.to_vec())
        }
        (RobotKind::Tree(tree), TipSetup::Point { point, coordinates, uncertain }) => {
            let tip = TreeTip::new(Tree::clone(tree), point, coordinates, *uncertain)
                .map_err(|error| SetupError::Tip { agent: own.name.clone(), error })?;
            let theta = tip.parameters();
            with_tip(setup, agent, law, Tree::clone(tree), tip, theta)
        }
        _ => Err(SetupError::LawOfAnother {
            agent: own.name.clone(),
            law: own.law.words(),
            made_for: own.law.made_for(),
        }),
    }
}

fn with_tip<R, T>(
    setup: &Setup,
    agent: usize,
    law: &TaskSpaceLaw,
    robot: R,
    tip: T,
    tip_theta: Vec<f64>,
) -> Result<Box<dyn Columns>, SetupError>
where
    R: Lagrangian<f64, Scratch: Send> + Clone + Send + Sync + 'static,
    T: TipKinematics + Clone,
{
    let own = &setup.agents[agent];
    let length = |what, need, got| {
        LengthError::check(what, need, got).map_err(|error| SetupError::Length { agent: own.name.clone(), error })
    };
    let (m, p) = (tip.axes(), tip.parameter_count());
    length("the axes of the tip", own.robot.axes.len(), m)?;
    length("the start of the estimate", robot.parameter_count(), law.estimate_start.len())?;
    length("the start of the kinematic estimate", p, law.kinematic_start.len())?;
    length("the names of the kinematic parameters", p, law.kinematic_names.len())?;
    for (what, values) in [("ϑ̂(0)", &law.estimate_start), ("θ̂(0)", &law.kinematic_start)] {
        if let Some(value) = values.iter().find(|value| !value.is_finite()) {
            return Err(SetupError::NotFinite { agent: own.name.clone(), what, value: *value });
        }
    }
    positive(own, "κ", law.kappa)?;
    positive(own, "α", law.alpha_per_s)?;
    if !(0.0..1.0).contains(&law.determinant_floor) {
        let (what, value) = ("the floor of det Ĵ", law.determinant_floor);
        let requirement = "must be from 0 to below 1";
        return Err(SetupError::LawNumber { agent: own.name.clone(), what, value, requirement });
    }
    let kinematic_adaptation = law.kinematic_adaptation.as_ref().map(|gain| resolve(own, gain, "Λ", p)).transpose()?;
    if let Some(bounds) = &law.bounds {
        length("the lower bounds", p, bounds.lower.len())?;
        length("the upper bounds", p, bounds.upper.len())?;
        positive(own, "the margin of the bounds", bounds.margin)?;
        match kinematic_adaptation {
            None => return Err(SetupError::BoundsOfKnown { agent: own.name.clone() }),
            Some(ResolvedGain::Matrix { .. }) => {
                return Err(SetupError::ProjectionOfMatrix { agent: own.name.clone() });
            }
            Some(ResolvedGain::Diagonal(_)) => {}
        }
        for k in 0..p {
            let (low, high) = (bounds.lower[k], bounds.upper[k]);
            if !(low <= high && low.is_finite() && high.is_finite()) {
                let requirement = "must be finite and not above its upper bound";
                let what = "a lower bound";
                return Err(SetupError::LawNumber { agent: own.name.clone(), what, value: low, requirement });
            }
        }
    }
    let controller = TaskSpace {
        law: tracking_law(&robot, own, &law.damping, Some(&law.adaptation))?,
        task_gain: resolve(own, &law.task_gain, "K*", m)?,
        kappa: law.kappa,
        alpha: law.alpha_per_s,
        kinematic_adaptation,
        bounds: law.bounds.clone(),
        estimate_start: law.estimate_start.clone(),
        kinematic_start: law.kinematic_start.clone(),
        determinant_floor: law.determinant_floor,
        robot: robot.clone(),
        tip: tip.clone(),
    };
    let plant = TaskArm { arm: Mechanical { robot, theta: own.robot.theta.clone() }, tip, tip_theta };
    solo(setup, agent, plant, controller)
}

/// A spacecraft that follows an attitude.
pub(super) fn attitude(
    setup: &Setup,
    agent: usize,
    inertia: &[[f64; 3]; 3],
    wheels: &Wheels,
    law: &AttitudeLaw,
) -> Result<Box<dyn Columns>, SetupError> {
    let own = &setup.agents[agent];
    only_tracks(setup, own)?;
    let plant = Spacecraft::new(*inertia, wheels.clone(), own.enforce_limits)
        .map_err(|error| SetupError::Spacecraft { agent: own.name.clone(), error })?;
    positive(own, "α₁", law.alpha[0])?;
    positive(own, "α₂", law.alpha[1])?;
    let start: Vec<f64> = [&own.start.q[..], &own.start.dq, &own.start.rest].concat();
    let momentum_inertial =
        plant.momentum_inertial(&start).map_err(|error| SetupError::Length { agent: own.name.clone(), error })?;
    let controller = AttitudeTracking {
        inertia: *plant.inertia(),
        momentum_inertial,
        wheels: wheels.clone(),
        alpha: law.alpha,
        filter: resolve(own, &law.filter, "Λ_f", 4)?,
        damping: resolve(own, &law.damping, "K", 4)?,
    };
    solo(setup, agent, plant, controller)
}

/// Both laws have reference dynamics of their own, which lead to a target. (A target beside reference dynamics that agree would
/// be an offset, which `solo` refuses.)
fn only_tracks(setup: &Setup, own: &AgentSetup) -> Result<(), SetupError> {
    if setup.reference == ReferenceKind::Tracking || own.target.is_some() {
        return Ok(());
    }
    Err(SetupError::OnlyTracks { agent: own.name.clone(), law: own.law.words() })
}

fn resolve(own: &AgentSetup, gain: &Gain, which: &'static str, size: usize) -> Result<ResolvedGain, SetupError> {
    gain.resolve(size, &[]).map_err(|error| SetupError::Gain { agent: own.name.clone(), gain: which, error })
}
