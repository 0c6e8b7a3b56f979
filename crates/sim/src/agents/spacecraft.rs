//! (94), a spacecraft with reaction wheels, and its attitude without a measured angular velocity: (97)–(105), and the passivity filter that
//! Remark 10 compares them with.

use forwardstep_core::Gain;
use forwardstep_core::controller::{AttitudeTracking, PassivityFilter};
use forwardstep_core::plant::{Spacecraft, Wheels};

use super::LagrangianRobot;
use crate::closed_loop::{Assembly, Block, SetupError};
use crate::quantity::positive;
use crate::recording::Signal;
use crate::setup::RobotSetup;
use crate::system::{
    ActuatorLimits, Attachments, Interface, Known, Law, LawWords, Line, LineValue, PositionKind, Robot, RobotInterface,
};

/// A spacecraft. Its axes are the entries of a quaternion; the rest of its start holds the momenta of the wheels, N m s.
#[derive(Clone, Debug, PartialEq)]
pub struct SpacecraftModel {
    /// M, kg m².
    pub inertia_kg_m2: [[f64; 3]; 3],
    /// How its torque is shared out, and what the wheels can do.
    pub wheels: Wheels,
}

impl Robot for SpacecraftModel {
    fn interface(&self, axes: usize) -> RobotInterface {
        let limits = self.wheels.list().iter().enumerate().flat_map(|(entry, wheel)| {
            let (torque, momentum) = (wheel.torque_limit_n_m, wheel.momentum_limit_n_m_s);
            let line = move |signal, value| Line { signal, entry, value };
            let torque = torque.map(|limit| line(Signal::WheelTorque, LineValue::Clip(limit)));
            torque.into_iter().chain(momentum.map(|limit| line(Signal::WheelMomentum, LineValue::Limit(limit))))
        });
        RobotInterface {
            velocity_len: 3,
            rest_len: self.wheels.count(),
            position: PositionKind::UnitQuaternion,
            attachments: Attachments::Body,
            actuator_limits: ActuatorLimits::Own,
            lines: limits.collect(),
            ..RobotInterface::mechanical(axes)
        }
    }

    fn lagrangian(&self) -> Option<&dyn LagrangianRobot> {
        None
    }
}

/// (97)–(105) for a spacecraft; see [`AttitudeTracking`]. M and h_I are those of the spacecraft and its start.
#[derive(Clone, Debug, PartialEq)]
pub struct AttitudeLaw {
    /// α₁ in 1/s², α₂ in 1/s.
    pub alpha: [f64; 2],
    /// Λ_f, 4 × 4, 1/s.
    pub filter: Gain,
    /// K, 4 × 4.
    pub damping: Gain,
}

impl Law for AttitudeLaw {
    fn words(&self) -> LawWords {
        LawWords { name: "the law for an attitude", made_for: "spacecraft" }
    }

    fn interface(&self, robot: &RobotSetup) -> Option<Interface> {
        // q_z and y.
        let interface = || Interface { pushed: true, further_starts: &[4, 4], ..Interface::of::<AttitudeTracking>() };
        robot.kind.is::<SpacecraftModel>().then(interface)
    }

    fn known(&self) -> Known {
        Known::Checked
    }

    fn block(&self, assembly: &Assembly<'_>) -> Result<Block, SetupError> {
        let (plant, momentum_inertial) = spacecraft(assembly)?;
        positive(assembly.of_law(), "error_gain_per_s2", self.alpha[0])?;
        positive(assembly.of_law(), "rate_gain_per_s", self.alpha[1])?;
        let controller = AttitudeTracking {
            inertia: *plant.inertia(),
            momentum_inertial,
            wheels: plant.wheels().clone(),
            alpha: self.alpha,
            filter: assembly.gain(&self.filter, "filter_gain_per_s", 4)?,
            damping: assembly.gain(&self.damping, "damping", 4)?,
        };
        assembly.solo(plant, controller)
    }
}

/// The spacecraft of an agent, and h_I by its start.
fn spacecraft(assembly: &Assembly<'_>) -> Result<(Spacecraft, [f64; 3]), SetupError> {
    let own = assembly.agent();
    let SpacecraftModel { inertia_kg_m2, wheels } = assembly.robot()?;
    let path = assembly.of_robot().key("inertia_kg_m2");
    inertia_kg_m2.iter().enumerate().try_for_each(|(k, row)| positive(path.clone().index(k), "", row[k]))?;
    assembly.resolved(&Gain::Matrix(inertia_kg_m2.concat()), path, 3, &[])?;
    let plant = Spacecraft::new(*inertia_kg_m2, wheels.clone(), own.enforce_limits)
        .map_err(|error| SetupError::Spacecraft { agent: own.name.clone(), error })?;
    let start: Vec<f64> = [&own.start.q[..], &own.start.dq, &own.start.rest].concat();
    let momentum_inertial =
        plant.momentum_inertial(&start).map_err(|error| SetupError::Length { agent: own.name.clone(), error })?;
    Ok((plant, momentum_inertial))
}

/// A filter of the attitude error in the place of reference dynamics; see [`PassivityFilter`]. M and h_I are those of the spacecraft and its start.
#[derive(Clone, Debug, PartialEq)]
pub struct PassivityFilterLaw {
    /// k, N m.
    pub error_gain_n_m: f64,
    /// Λ_f, 4 × 4, 1/s.
    pub filter: Gain,
    /// K, 4 × 4.
    pub damping: Gain,
}

impl Law for PassivityFilterLaw {
    fn words(&self) -> LawWords {
        LawWords { name: "the passivity filter for an attitude", made_for: "spacecraft" }
    }

    fn interface(&self, robot: &RobotSetup) -> Option<Interface> {
        let interface = || Interface { pushed: true, ..Interface::of::<PassivityFilter>() };
        robot.kind.is::<SpacecraftModel>().then(interface)
    }

    fn known(&self) -> Known {
        Known::Checked
    }

    fn block(&self, assembly: &Assembly<'_>) -> Result<Block, SetupError> {
        let (plant, momentum_inertial) = spacecraft(assembly)?;
        positive(assembly.of_law(), "error_gain_n_m", self.error_gain_n_m)?;
        let controller = PassivityFilter {
            inertia: *plant.inertia(),
            momentum_inertial,
            wheels: plant.wheels().clone(),
            error_gain: self.error_gain_n_m,
            filter: assembly.gain(&self.filter, "filter_gain_per_s", 4)?,
            damping: assembly.gain(&self.damping, "damping", 4)?,
        };
        assembly.solo(plant, controller)
    }
}
