//! A fully actuated surface ship: q = (x, y, ψ) in the earth frame, under (6)–(7).

use std::sync::Arc;

use forwardstep_core::robot::{Definiteness, Drives, Ship};

use super::lagrangian::{LagrangianRobot, RobotModel};
use crate::setup::{Axis, AxisUnit, RobotSetup};
use crate::system::{Robot, RobotInterface};

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
    fn interface(&self, axes: usize) -> RobotInterface {
        RobotInterface::mechanical(axes)
    }

    #[inline(never)]
    fn lagrangian(&self) -> Option<&dyn LagrangianRobot> {
        Some(self)
    }
}

impl RobotModel for Ship {
    type Kernel = Ship;

    fn kernel(&self) -> Ship {
        *self
    }

    fn shares_kernel(&self, _: &Self) -> bool {
        true
    }

    /// It floats and has no joints: what water takes of its motion is D, and water has no dry friction.
    fn with_drives(&self, drives: Drives) -> Option<Arc<dyn Robot>> {
        (drives.count() == 0).then(|| Arc::new(*self) as Arc<dyn Robot>)
    }

    fn definiteness(&self, theta: &[f64]) -> Option<Definiteness> {
        Ship::definiteness(*self, theta).ok()
    }

    fn swung_axes(&self) -> Option<Vec<usize>> {
        Some(Vec::new())
    }
}
