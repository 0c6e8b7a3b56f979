//! The shipped robots with Properties 1 to 3 as data: trees, planar arms, point masses, and the latter two with drives.

use std::sync::Arc;

use forwardstep_core::Lanes;
use forwardstep_core::robot::tree::Tree;
use forwardstep_core::robot::{Definiteness, Driven, Drives, Lagrangian, PlanarArm, PointMass};

use super::lagrangian::{LagrangianRobot, RobotModel};
use super::series::Series;
use crate::system::{Attachments, Robot, RobotInterface};

/// Pieces into which the turns of degenerate trees may be cut.
const PIECES: usize = 4096;

/// A fixed-base tree of rigid bodies, for example from a URDF.
impl Robot for Arc<Tree> {
    fn interface(&self, axes: usize) -> RobotInterface {
        let (attachments, drives) = (Attachments::Links(Arc::clone(self)), self.drives().clone());
        RobotInterface { attachments, drives, ..RobotInterface::mechanical(axes) }
    }

    #[inline(never)]
    fn lagrangian(&self) -> Option<&dyn LagrangianRobot> {
        Some(self)
    }
}

impl RobotModel for Arc<Tree> {
    type Kernel = Tree;

    fn kernel(&self) -> Tree {
        Tree::clone(self)
    }

    fn shares_kernel(&self, other: &Self) -> bool {
        Arc::ptr_eq(self, other)
    }

    fn with_drives(&self, drives: Drives) -> Option<Arc<dyn Robot>> {
        let tree = Tree::clone(self).with_drives(drives).ok()?;
        Some(Arc::new(Arc::new(tree)))
    }

    fn definiteness(&self, theta: &[f64]) -> Option<Definiteness> {
        Tree::definiteness(self, theta, PIECES).ok()
    }

    fn swung_axes(&self) -> Option<Vec<usize>> {
        Some(self.swung_joints())
    }
}

/// The two-link planar arm in closed form.
impl Robot for PlanarArm {
    fn interface(&self, axes: usize) -> RobotInterface {
        RobotInterface { attachments: Attachments::PlanarTip, ..RobotInterface::mechanical(axes) }
    }

    #[inline(never)]
    fn lagrangian(&self) -> Option<&dyn LagrangianRobot> {
        Some(self)
    }
}

impl RobotModel for PlanarArm {
    type Kernel = PlanarArm;

    fn kernel(&self) -> PlanarArm {
        *self
    }

    fn shares_kernel(&self, _: &Self) -> bool {
        true
    }

    fn with_drives(&self, drives: Drives) -> Option<Arc<dyn Robot>> {
        driven(*self, drives)
    }

    fn definiteness(&self, theta: &[f64]) -> Option<Definiteness> {
        PlanarArm::definiteness(*self, theta).ok()
    }

    fn swung_axes(&self) -> Option<Vec<usize>> {
        Some(Vec::new())
    }
}

/// A point mass in ℝᵐ.
impl Robot for PointMass {
    fn interface(&self, axes: usize) -> RobotInterface {
        RobotInterface { numbered_axes: true, ..RobotInterface::mechanical(axes) }
    }

    #[inline(never)]
    fn lagrangian(&self) -> Option<&dyn LagrangianRobot> {
        Some(self)
    }
}

impl RobotModel for PointMass {
    type Kernel = PointMass;

    fn kernel(&self) -> PointMass {
        *self
    }

    fn shares_kernel(&self, other: &Self) -> bool {
        self == other
    }

    fn with_drives(&self, drives: Drives) -> Option<Arc<dyn Robot>> {
        driven(*self, drives)
    }

    fn definiteness(&self, theta: &[f64]) -> Option<Definiteness> {
        PointMass::definiteness(*self, theta).ok()
    }

    fn swung_axes(&self) -> Option<Vec<usize>> {
        Some(Vec::new())
    }
}

/// A robot in closed form with what acts at its joints.
impl<M: ClosedForm> Robot for Driven<M> {
    fn interface(&self, axes: usize) -> RobotInterface {
        RobotInterface { drives: self.drives().clone(), ..self.inner().interface(axes) }
    }

    #[inline(never)]
    fn lagrangian(&self) -> Option<&dyn LagrangianRobot> {
        Some(self)
    }
}

impl<M: ClosedForm> RobotModel for Driven<M> {
    type Kernel = Driven<M>;

    fn kernel(&self) -> Driven<M> {
        self.clone()
    }

    fn shares_kernel(&self, other: &Self) -> bool {
        self.drives() == other.drives() && self.inner().shares_kernel(other.inner())
    }

    fn with_drives(&self, drives: Drives) -> Option<Arc<dyn Robot>> {
        RobotModel::with_drives(self.inner(), drives)
    }

    fn definiteness(&self, theta: &[f64]) -> Option<Definiteness> {
        let bodies = theta.len().checked_sub(self.drives().count())?;
        let inner = RobotModel::definiteness(self.inner(), &theta[..bodies])?;
        Some(Driven::definiteness(self, inner))
    }

    fn swung_axes(&self) -> Option<Vec<usize>> {
        RobotModel::swung_axes(self.inner())
    }
}

/// A model that is its own kernel and knows no drives.
pub trait ClosedForm:
    RobotModel<Kernel = Self> + Lagrangian<f64, Scratch: Send> + Lagrangian<Lanes<8>> + Lagrangian<Series>
{
}

impl ClosedForm for PlanarArm {}
impl ClosedForm for PointMass {}

/// A robot with drives; itself without any.
fn driven<M: ClosedForm>(inner: M, drives: Drives) -> Option<Arc<dyn Robot>> {
    if drives.count() == 0 {
        return Some(Arc::new(inner));
    }
    Some(Arc::new(Driven::new(inner, drives).ok()?))
}
