//! Enforced limits: torques keep to them, and the Lyapunov balance counts what they take away.

use forwardstep_sim::reference::Consensus;
use std::ops::ControlFlow;
use std::sync::Arc;

use crate::common::{axes, balance_residual, column, run, setup, silent};
use forwardstep_core::Gain;
use forwardstep_core::robot::{PlanarArm, PlanarLinks};
use forwardstep_sim::push::{Course, Effect, Function, Push};
use forwardstep_sim::recording::{Breakdown, BreakdownCause};
use forwardstep_sim::{
    Adaptive, AgentSetup, AxisUnit, Ending, Exchange, Known, Law, RobotSetup, Setup, Signal, Start, simulate,
};

/// A planar arm whose motors are too weak for it.
fn arm(index: usize, limits: Option<[f64; 2]>, adaptive: bool) -> AgentSetup {
    let links = PlanarLinks::uniform([1.0 + 0.3 * index as f64, 1.0], [1.0, 0.8]);
    let mut both = axes(&["shoulder", "elbow"], AxisUnit::Radian);
    if let Some(limits) = limits {
        both.iter_mut().zip(limits).for_each(|(axis, limit)| axis.effort_limit = Some(limit));
    }
    let damping = Gain::Number(8.0);
    let adaptation = Gain::Number(10.0);
    AgentSetup {
        name: format!("arm-{index}"),
        robot: RobotSetup {
            kind: Arc::new(PlanarArm),
            theta: links.theta().to_vec(),
            theta_names: vec![String::new(); 5],
            axes: both,
        },
        roots_per_s: vec![1.0, 2.0].into(),
        manipulability: 0.0,
        law: if adaptive {
            Arc::new(Adaptive { damping, adaptation, estimate_start: vec![0.0; 5], bounds: None })
        } else {
            Arc::new(Known { damping }) as Arc<dyn Law>
        },
        target: None,
        start: Start { q: vec![0.4, 0.3], dq: vec![1.0, -2.0], rest: Vec::new(), reference: vec![vec![0.5, 1.0]] },
        enforce_limits: limits.is_some(),
        pushes: Vec::new(),
    }
}

fn alone(agents: Vec<AgentSetup>) -> Setup {
    let network = silent(agents.len());
    let mut setup = setup(agents, Arc::new(Consensus), network, 3.0);
    setup.exchange = Exchange::PositionVelocity;
    setup.time.record_every_s = 0.01;
    setup
}

/// The part of the rows in which the torque of an axis is at its limit.
fn saturated(torque: &[f64], limit: f64) -> f64 {
    assert!(torque.iter().all(|tau| tau.abs() <= limit), "{limit}");
    torque.iter().filter(|tau| tau.abs() == limit).count() as f64 / torque.len() as f64
}

#[test]
fn thm_the_balance_counts_what_limits_take_away() {
    for adaptive in [true, false] {
        // One by itself, then several side by side with limits of their own and one without.
        let limits = [Some([9.0, 2.0]), Some([12.0, 1.5]), None, Some([7.0, 30.0])];
        for count in [1, 2, 4] {
            let setup = alone((0..count).map(|k| arm(k, limits[k], adaptive)).collect());
            let outcome = run(&setup);
            for (agent, limits) in limits.iter().take(count).enumerate() {
                let error = balance_residual(&outcome, agent, 0.0);
                assert!(error < 1e-6, "{adaptive}, {count}, agent {agent}: {error:e}");
                let Some(limits) = limits else { continue };
                let parts = [0, 1].map(|axis| saturated(column(&outcome, agent, Signal::Torque, axis), limits[axis]));
                assert!(parts[0] > 0.1 && parts[0] < 1.0, "agent {agent}: {parts:?} of the run");
            }
        }
    }
}

#[test]
fn thm_the_balance_counts_limits_and_pushes_at_once() {
    let mut setup = alone(vec![arm(0, Some([9.0, 2.0]), true)]);
    let push = [Function::Constant(6.0), Function::Constant(-1.0)].to_vec();
    setup.agents[0].pushes = vec![Push { effect: Effect::Torque(Course::Each(push)), from_s: 0.5, until_s: 2.0 }];
    let outcome = run(&setup);
    assert!(saturated(column(&outcome, 0, Signal::Torque, 0), 9.0) > 0.1);
    assert!(balance_residual(&outcome, 0, 0.0) < 1e-6, "{:e}", balance_residual(&outcome, 0, 0.0));
}

/// An axis at its end stops the run; the other end, and an axis just inside, do not.
#[test]
fn an_axis_beyond_its_range_ends_the_run_where_limits_are_enforced() {
    let ending = |range: [f64; 2], enforced: bool| {
        let mut setup = alone(vec![arm(0, Some([1e3, 1e3]), true)]);
        setup.agents[0].enforce_limits = enforced;
        setup.agents[0].robot.axes[1].position_limits = Some(range);
        simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap()
    };
    let free = ending([-100.0, 100.0], true);
    assert_eq!(free.ending, Ending::Completed);
    let q = column(&free, 0, Signal::Position, 1);
    let (low, high) = q.iter().fold((f64::MAX, f64::MIN), |(low, high), q| (low.min(*q), high.max(*q)));
    assert!(high - low > 0.3, "{low} {high}");
    assert_eq!(ending([low - 1e-3, high + 1e-3], true).ending, Ending::Completed);
    for (range, end) in [([low - 1.0, high - 0.05], high - 0.05), ([low + 0.05, high + 1.0], low + 0.05)] {
        let outcome = ending(range, true);
        let Ending::BrokeDown(Breakdown { agent, signal, axis, cause, .. }) = &outcome.ending else {
            panic!("{:?}", outcome.ending)
        };
        assert_eq!((*agent, *signal, *axis), (0, Signal::Position, 1));
        let BreakdownCause::PositionLimit { value, limits } = cause else { panic!("{cause:?}") };
        assert!(*limits == range && (value - end).abs() < 0.05, "{cause:?}");
        assert_eq!(ending(range, false).ending, Ending::Completed);
    }
}

#[test]
fn regress_limits_that_cannot_be_enforced_are_refused() {
    let refused = |setup: &Setup| simulate(setup, &mut |_| ControlFlow::Continue(())).unwrap_err().to_string();
    for value in [0.0, -1.0, f64::NAN] {
        let weak = alone(vec![arm(0, Some([5.0, value]), false)]);
        for setup in [weak.clone(), weak.sampled(100.0)] {
            let said = refused(&setup);
            assert!(
                said.contains(&format!("the effort limit of `elbow` is {value}, but it must be positive")),
                "{said}"
            );
        }
    }
    // No torque but zero lies within 0.2 in steps of 0.5.
    let mut coarse = alone(vec![arm(0, None, false)]).sampled(100.0);
    let actuators = &mut coarse.control.as_mut().unwrap().actuators;
    (actuators.torque_limit, actuators.torque_quantum) = (Some(vec![9.0, 0.2]), 0.5);
    let said = refused(&coarse);
    assert!(said.contains("axis 1 has the torque limit 0.2, which is below the step of the torques, 0.5"), "{said}");
}

#[test]
fn regress_a_robot_without_axes_is_refused() {
    let robot = RobotSetup::point_mass(0, 1.0);
    let agents = vec![AgentSetup::new("nobody", robot, Known::gain(1.0)).roots([1.0, 2.0])];
    let said = simulate(&alone(agents), &mut |_| ControlFlow::Continue(())).unwrap_err().to_string();
    assert!(said.contains("`nobody` has no axes"), "{said}");
}
