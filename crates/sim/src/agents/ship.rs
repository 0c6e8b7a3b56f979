//! A fully actuated surface ship: q = (x, y, ψ) in the earth frame, under (6)–(7).

use forwardstep_core::robot::Ship;

use super::lagrangian::{LagrangianRobot, RobotModel};
use crate::setup::{Axis, AxisUnit, RobotSetup};
use crate::system::{ActuatorLimits, Attachments, Line, Naming, Robot};

impl RobotSetup {
    /// A ship with the true ϑ of [`Ship`]: m₁₁, m₂₂, m₂₃, m₃₃, d₁₁, d₂₂, d₂₃, d₃₂, d₃₃. M must be positive definite and
    /// D + Dᵀ positive semidefinite.
    pub fn ship(theta: [f64; 9]) -> Self {
        let axes = [("x", AxisUnit::Metre), ("y", AxisUnit::Metre), ("psi", AxisUnit::Radian)];
        let axes = axes.map(|(name, unit)| Axis::new(name, unit));
        RobotSetup::new(Ship, theta, axes).named(&["m11", "m22", "m23", "m33", "d11", "d22", "d23", "d32", "d33"])
    }
}

impl Robot for Ship {
    fn velocity_len(&self, axes: usize) -> usize {
        axes
    }

    fn rest_len(&self) -> usize {
        0
    }

    fn moves_in_space(&self) -> bool {
        false
    }

    fn same_model(&self, other: &dyn Robot) -> bool {
        other.is::<Ship>()
    }

    fn lagrangian(&self) -> Option<&dyn LagrangianRobot> {
        Some(self)
    }

    fn attachments(&self) -> Attachments<'_> {
        Attachments::Axes
    }

    fn actuator_limits(&self) -> ActuatorLimits {
        ActuatorLimits::Axes
    }

    fn naming(&self) -> Naming {
        Naming { numbered_axes: false, torques_on_body: false }
    }

    fn lines(&self) -> Vec<Line> {
        Vec::new()
    }
}

impl RobotModel for Ship {
    type Kernel = Ship;

    fn kernel(&self) -> Ship {
        *self
    }
}
