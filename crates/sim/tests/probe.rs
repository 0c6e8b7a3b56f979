//! What authors say of their robots and laws is refuted where it is wrong, and of ours it is right.

use std::any::type_name;
use std::sync::Arc;

use forwardstep_core::robot::{Definiteness, Drives, Lagrangian, PointMass, Ship, TwoVelocity};
use forwardstep_core::{LengthError, Scalar};
use forwardstep_sim::probe::{Identity, STATES};
use forwardstep_sim::system::{Robot, RobotInterface};
use forwardstep_sim::{LagrangianRobot, RobotModel, RobotSetup};

/// M ≻ 0, D + Dᵀ ⪰ 0, nothing is zero.
const THETA: [f64; 9] = [25.8, 33.8, 6.2, 2.76, 12.0, 17.0, 0.2, 0.5, 0.5];

/// A ship with one part of its kernel spoilt.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Spoilt(Option<Identity>);

impl Spoilt {
    fn adds<S: Scalar>(self, identity: Identity, out: &mut [S], entry: usize, value: f64) {
        if self.0 == Some(identity) {
            out[entry] = out[entry] + S::splat(value);
        }
    }
}

impl<S: Scalar> Lagrangian<S> for Spoilt {
    type Scratch = ();

    fn dof(&self) -> usize {
        3
    }

    fn parameter_count(&self) -> usize {
        9
    }

    fn scratch(&self) {}

    fn regressor_products(
        &self,
        (): &mut (),
        motion: TwoVelocity<'_, S>,
        theta: &[S],
        s: &[S],
        y_theta: &mut [S],
        yt_s: &mut [S],
    ) -> Result<(), LengthError> {
        Ship.regressor_products(&mut (), motion, theta, s, y_theta, yt_s)?;
        self.adds(Identity::Products, yt_s, 8, 1e-3);
        Ok(())
    }

    fn forward_dynamics(
        &self,
        (): &mut (),
        q: &[S],
        dq: &[S],
        theta: &[S],
        tau: &[S],
        ddq: &mut [S],
    ) -> Result<(), LengthError> {
        Ship.forward_dynamics(&mut (), q, dq, theta, tau, ddq)?;
        self.adds(Identity::Acceleration, ddq, 1, 1e-3);
        if type_name::<S>() != type_name::<f64>() {
            self.adds(Identity::Lanes, ddq, 2, 1e-3);
        }
        Ok(())
    }

    fn mass_matrix(&self, (): &mut (), q: &[S], theta: &[S], m: &mut [S]) -> Result<(), LengthError> {
        Ship.mass_matrix(&mut (), q, theta, m)?;
        self.adds(Identity::Symmetric, m, 1, 1e-3);
        self.adds(Identity::Positive, m, 8, -2.0);
        Ok(())
    }

    fn coriolis_matrix(&self, (): &mut (), q: &[S], dq: &[S], theta: &[S], c: &mut [S]) -> Result<(), LengthError> {
        Ship.coriolis_matrix(&mut (), q, dq, theta, c)?;
        self.adds(Identity::Skew, c, 0, 1e-2);
        Ok(())
    }

    fn add_damping(
        &self,
        (): &mut (),
        motion: TwoVelocity<'_, S>,
        theta: &[S],
        out: &mut [S],
    ) -> Result<(), LengthError> {
        Ship.add_damping(&mut (), motion, theta, out)?;
        if self.0 == Some(Identity::Damping) {
            out[0] = out[0] - S::splat(1e4) * (motion.dq[0] - motion.z[0]);
        }
        Ok(())
    }

    fn gravity(&self, (): &mut (), q: &[S], theta: &[S], g: &mut [S]) -> Result<(), LengthError> {
        Ship.gravity(&mut (), q, theta, g)?;
        // What no parameter multiplies.
        self.adds(Identity::Linear, g, 2, 1e-2);
        Ok(())
    }

    fn regressor(&self, (): &mut (), motion: TwoVelocity<'_, S>, y: &mut [S]) -> Result<(), LengthError> {
        Ship.regressor(&mut (), motion, y)
    }

    fn adaptation_scale(&self, q: &[f64], theta: &[f64]) -> Vec<f64> {
        Lagrangian::<f64>::adaptation_scale(&Ship, q, theta)
    }
}

impl Robot for Spoilt {
    fn interface(&self, axes: usize) -> RobotInterface {
        RobotInterface::mechanical(axes)
    }

    fn lagrangian(&self) -> Option<&dyn LagrangianRobot> {
        Some(self)
    }
}

impl RobotModel for Spoilt {
    type Kernel = Spoilt;

    fn kernel(&self) -> Spoilt {
        *self
    }

    fn shares_kernel(&self, other: &Self) -> bool {
        self == other
    }

    fn with_drives(&self, _: Drives) -> Option<Arc<dyn Robot>> {
        None
    }

    fn definiteness(&self, _: &[f64]) -> Option<Definiteness> {
        None
    }

    fn swung_axes(&self) -> Option<Vec<usize>> {
        None
    }
}

fn spoilt(identity: Option<Identity>) -> RobotSetup {
    let mut robot = RobotSetup::ship(THETA);
    robot.kind = Arc::new(Spoilt(identity));
    robot
}

#[test]
fn every_property_that_a_robot_lacks_is_found() {
    let sound = spoilt(None);
    let probe = sound.kind.lagrangian().unwrap().probe(&sound).unwrap();
    assert_eq!((probe.states, probe.found), (STATES, None));
    for identity in [
        Identity::Symmetric,
        Identity::Positive,
        Identity::Skew,
        Identity::Linear,
        Identity::Products,
        Identity::Damping,
        Identity::Acceleration,
        Identity::Lanes,
    ] {
        let robot = spoilt(Some(identity));
        let found = robot.kind.lagrangian().unwrap().probe(&robot).unwrap().found.unwrap();
        assert_eq!(found.identity, identity, "{found:?}");
        assert_eq!((found.t_s, found.state.len()), (0.0, 6));
        assert!((found.value - found.expected).abs() > 1e-5, "{found:?}");
    }
}

/// A limit on one side alone made every position infinite, and nothing was tried; one that is far away left differences without digits.
#[test]
fn regress_axes_are_tried_whatever_their_limits_are() {
    const ENDLESS: f64 = f64::INFINITY;
    for limits in
        [[0.5, ENDLESS], [-ENDLESS, -0.5], [-ENDLESS, ENDLESS], [-0.5, 0.5], [-1e9, 1e9], [f64::MIN, f64::MAX]]
    {
        let mut robot = spoilt(None);
        robot.axes[2].position_limits = Some(limits);
        let tried = robot.kind.lagrangian().unwrap().probe(&robot).unwrap();
        assert_eq!((tried.states, tried.found), (STATES, None), "{limits:?}");
        let mut robot = spoilt(Some(Identity::Skew));
        robot.axes[2].position_limits = Some(limits);
        let found = robot.kind.lagrangian().unwrap().probe(&robot).unwrap().found;
        let [low, high] = limits;
        assert!(found.is_some_and(|found| (low..=high).contains(&found.state[2])), "{limits:?}");
    }
}

#[test]
fn a_robot_with_the_wrong_number_of_parameters_or_axes_is_an_error() {
    let mut robot = spoilt(None);
    robot.theta.pop();
    assert!(robot.kind.lagrangian().unwrap().probe(&robot).is_err());
    let mut robot = spoilt(None);
    robot.axes.pop();
    assert!(robot.kind.lagrangian().unwrap().probe(&robot).is_err());
}

#[test]
fn what_is_not_a_number_is_not_tried() {
    let mut robot = RobotSetup::point_mass(2, 1.0);
    robot.kind = Arc::new(PointMass { dimension: 2 });
    robot.theta[0] = f64::NAN;
    let probe = robot.kind.lagrangian().unwrap().probe(&robot).unwrap();
    assert_eq!((probe.states, probe.found), (0, None));
}
