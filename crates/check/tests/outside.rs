//! Robots of which only their authors say that they have the three properties of Section II-B.

use std::sync::Arc;

use forwardstep_check::{Answer, Id, Rigour, check};
use forwardstep_core::robot::{Definiteness, Drives, PointMass};
use forwardstep_sim::delay::Delay;
use forwardstep_sim::system::{Robot, RobotInterface};
use forwardstep_sim::{AgentSetup, Known, LagrangianRobot, Network, RobotModel, RobotSetup, Setup, Signal, run};

/// A mass that somebody else models, with what is shipped inside.
#[derive(Clone, Debug)]
struct Sledge;

impl Robot for Sledge {
    fn interface(&self, axes: usize) -> RobotInterface {
        RobotInterface::mechanical(axes)
    }

    fn lagrangian(&self) -> Option<&dyn LagrangianRobot> {
        Some(self)
    }
}

impl RobotModel for Sledge {
    type Kernel = PointMass;

    fn kernel(&self) -> PointMass {
        PointMass { dimension: 1 }
    }

    fn shares_kernel(&self, _: &Self) -> bool {
        true
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

/// Two masses that agree, the left one somebody else's if asked.
fn masses(outside: bool) -> Setup {
    let mass = |name: &str, at: f64| {
        AgentSetup::new(name, RobotSetup::point_mass(1, 2.0), Known::gain(8.0)).roots([1.0, 2.0]).at(&[at])
    };
    let network = Network::fixed(2, [(0, 1), (1, 0)], Delay::constant(0.3));
    let mut setup = Setup::consensus([mass("left", 0.0), mass("right", 1.0)], network, 5.0);
    if outside {
        setup.agents[0].robot.kind = Arc::new(Sledge);
    }
    setup
}

#[test]
fn a_robot_from_outside_moves_like_the_shipped_one_but_its_properties_are_declared() {
    let [shipped, outside] = [false, true].map(masses);
    let at = |setup: &Setup| run(setup).unwrap().recording.values(0, Signal::Position, 0).unwrap().to_vec();
    assert!(at(&shipped).iter().zip(at(&outside)).all(|(one, other)| (one - other).abs() < 1e-9));

    assert_eq!(check(&shipped).worst(), Answer::Holds);
    let report = check(&outside);
    assert_eq!(report.worst(), Answer::NotShown);
    let declared: Vec<_> = report.hypotheses.iter().filter(|hypothesis| hypothesis.id == Id::Declared).collect();
    assert_eq!(declared.len(), 1, "of the left one alone");
    assert!(declared[0].requires().contains("left"), "{}", declared[0].requires());
}

#[test]
fn a_report_without_hypotheses_does_not_hold() {
    let mut report = check(&masses(false));
    report.hypotheses.clear();
    assert_eq!(report.worst(), Answer::NotCovered);
}

#[test]
fn a_robot_that_lacks_a_property_is_violated_with_the_state() {
    let mut setup = masses(true);
    // Its kernel has one axis and one parameter, which is a mass.
    setup.agents[0].robot.theta = vec![-2.0];
    let report = check(&setup);
    let declared = report.hypotheses.iter().find(|hypothesis| hypothesis.id == Id::Declared).unwrap();
    assert_eq!((declared.answer(), declared.rigour()), (Answer::Violated, Rigour::Sampled));
    let because = declared.because();
    assert!(because.contains("M ≻ 0") && because.contains("-2 in place of 0"), "{because}");
    assert_eq!(report.worst(), Answer::Violated);

    // With as many parameters as it does not have, nothing can be tried, which shows nothing.
    setup.agents[0].robot.theta = vec![2.0, 2.0];
    let declared = check(&setup).hypotheses.into_iter().find(|hypothesis| hypothesis.id == Id::Declared).unwrap();
    assert_eq!(declared.answer(), Answer::NotShown);
    assert!(declared.because().contains("could not be tried"), "{}", declared.because());
}
