//! Quantities out of their range, by the path of each; and where other errors stand.

use forwardstep_sim::reference::{Backstepping, Tracking};
use std::sync::Arc;

use forwardstep_core::reference::{Choice, RootPair};
use forwardstep_sim::coupling::Coupling;
use forwardstep_sim::delay::Delay;
use forwardstep_sim::leader::{Following, FollowingDesign, Leader, Leading};
use forwardstep_sim::quantity::positive;
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::trajectory::{Path, Trajectory};
use forwardstep_sim::{
    Actuators, AgentSetup, Control, Exchange, Failures, Known, Method, Network, RobotSetup, Sensors, Setup, SetupError,
    VelocitySensor, recipes, validate,
};

/// A change, and the path of what is wrong then.
type Case<'a> = (&'a dyn Fn(&mut Setup), &'a str);

fn setup() -> Setup {
    let cart = |name: &str| AgentSetup::new(name, RobotSetup::point_mass(1, 2.0), Known::gain(4.0)).roots([1.0]);
    let mut setup = Setup::consensus([cart("one").at(&[1.0]), cart("two").at(&[0.0])], Network::silent(2), 1.0);
    setup.exchange = Exchange::Position;
    setup.control = Some(Control {
        sample_hz: 100.0,
        computation_delay_s: 0.0,
        sensors: Sensors::default(),
        actuators: Actuators::default(),
        failures: Failures::default(),
    });
    setup
}

fn at_zero() -> Trajectory {
    Trajectory::new(vec![Path::Sinusoids { offset: 0.0, waves: Vec::new() }]).unwrap()
}

fn following(change: &dyn Fn(&mut Following)) -> impl Fn(&mut Setup) + use<> {
    let mut following = Following {
        leader: Leading::Motion(Leader { name: "leader".into(), trajectory: at_zero() }),
        design: FollowingDesign::Swarm { coupling: 1.0 },
        alpha: 1.0,
        beta: 1.0,
        gain: 1.0,
        choice: Choice::Implicit,
        period_s: 1e-3,
    };
    change(&mut following);
    move |setup| {
        setup.reference = Arc::new(following.clone());
        setup.agents.iter_mut().for_each(|agent| agent.roots_per_s.clear());
        setup.network = Network::silent(3);
        setup.exchange = Exchange::PositionVelocity;
        setup.control = None;
    }
}

/// The path of what is wrong with a changed setup.
fn wrong(change: &dyn Fn(&mut Setup)) -> String {
    let mut setup = setup();
    change(&mut setup);
    // How many torques a robot has is known where its plant is built.
    let checked = if setup.control.is_some() { recipes(&setup).map(drop) } else { validate(&setup) };
    checked.map_or_else(|error| error.path(&setup).to_string(), |()| "nothing".into())
}

fn controlled(change: impl Fn(&mut Control)) -> impl Fn(&mut Setup) {
    move |setup| setup.control.iter_mut().for_each(&change)
}

#[test]
fn every_quantity_is_refused_out_of_its_range_under_its_path() {
    assert_eq!(wrong(&|_| ()), "nothing");
    assert_eq!(wrong(&following(&|_| ())), "nothing");
    for value in [-1.0, f64::NAN, f64::INFINITY, 1e31] {
        let fixed = |step_s| Method::Fixed { step_s };
        let backstepping = |filter_s, limit| Arc::new(Backstepping { filter_s, acceleration_limit: limit });
        let cases: &[Case<'_>] = &[
            (&|s| s.time.end_s = value, "time.end_s"),
            (&|s| s.time.record_every_s = value, "time.record_every_s"),
            (&|s| s.solver.method = Method::Adaptive { rtol: value, atol: 1e-8 }, "solver.method.adaptive.rtol"),
            (&|s| s.solver.method = Method::Adaptive { rtol: 1e-6, atol: value }, "solver.method.adaptive.atol"),
            (&|s| s.solver.method = fixed(value), "solver.method.fixed.step_s"),
            (&|s| s.solver.max_step_s = Some(value), "solver.max_step_s"),
            (&|s| s.solver.min_step_s = value, "solver.min_step_s"),
            (&controlled(|c| c.sample_hz = value), "control.sample_hz"),
            (&controlled(|c| c.computation_delay_s = value), "control.computation_delay_s"),
            (&controlled(|c| c.failures.message_timeout_s = Some(value)), "control.message_timeout_s"),
            (&controlled(|c| c.sensors.position_noise = value), "control.noise.position"),
            (&controlled(|c| c.sensors.velocity_noise = value), "control.noise.velocity"),
            (&controlled(|c| c.sensors.tip_velocity_noise = value), "control.noise.tip_velocity"),
            (&controlled(|c| c.sensors.position_quantum = value), "control.quantisation.position"),
            (&controlled(|c| c.sensors.velocity_quantum = value), "control.quantisation.velocity"),
            (&controlled(|c| c.actuators.torque_quantum = value), "control.quantisation.torque"),
            (
                &controlled(|c| c.sensors.velocity = VelocitySensor::Filtered { cut_off_hz: value }),
                "control.velocity.filtered_difference.cut_off_hz",
            ),
            (&controlled(|c| c.actuators.torque_limit = Some(vec![value])), "control.torque_limit[0]"),
            (&controlled(|c| c.actuators.torque_rate_limit = Some(vec![value])), "control.torque_rate_limit_per_s[0]"),
            (&|s| s.agents[1].roots_per_s.real[0] = value, "agents[1].reference.consensus.roots_per_s[0]"),
            (
                &|s| s.agents[1].roots_per_s.pairs = vec![RootPair { real: value, imaginary: 1.0 }],
                "agents[1].reference.consensus.roots_per_s[1].real",
            ),
            (
                &|s| s.agents[1].roots_per_s.pairs = vec![RootPair { real: 1.0, imaginary: value }],
                "agents[1].reference.consensus.roots_per_s[1].imaginary",
            ),
            (&|s| s.agents[1].manipulability = value, "agents[1].reference.consensus.manipulability_gain"),
            (&|s| s.network.delays.push(Delay::constant(value)), "network.delays[0].constant_s"),
            (
                &|s| s.network.schedule = Schedule::random(vec![vec![]], [value, 1.0], 1),
                "network.switching.random.dwell_s[0]",
            ),
            (&|s| s.network.coupling = Coupling::Saturated { limit: value }, "network.coupling.saturated"),
            (&|s| s.network.coupling = Coupling::Tanh { scale: value }, "network.coupling.tanh"),
            (&|s| s.network.coupling = Coupling::Rational { scale: value }, "network.coupling.rational"),
            (&|s| s.reference = backstepping(value, None), "reference.backstepping.filter_s"),
            (&|s| s.reference = backstepping(0.1, Some(value)), "reference.backstepping.acceleration_limit"),
            (&following(&|f| f.alpha = value), "reference.leader.alpha"),
            (&following(&|f| f.beta = value), "reference.leader.beta"),
            (&following(&|f| f.gain = value), "reference.leader.gain"),
            (&following(&|f| f.design = FollowingDesign::Swarm { coupling: value }), "reference.leader.coupling"),
            (&following(&|f| f.period_s = value), "reference.leader.sign_period_s"),
            (&following(&|f| f.choice = Choice::Layer { width: value }), "reference.leader.sign.boundary_layer.width"),
        ];
        for (change, path) in cases {
            assert_eq!(wrong(change), *path, "{value}");
        }
    }
}

#[test]
fn quantities_are_held_against_each_other() {
    let cases: [Case<'_>; 6] = [
        (&|s| s.solver.max_step_s = Some(0.9e-12), "solver.max_step_s"),
        (&|s| s.solver.method = Method::Fixed { step_s: 0.9e-12 }, "solver.method.fixed.step_s"),
        (&controlled(|c| c.sample_hz = 1.1e7), "control.sample_hz"),
        (&controlled(|c| c.computation_delay_s = 0.0101), "control.computation_delay_s"),
        (&following(&|f| f.period_s = 0.9e-7), "reference.leader.sign_period_s"),
        (&controlled(|c| c.actuators.torque_rate_limit = Some(vec![1.0; 2])), "control.torque_rate_limit_per_s"),
    ];
    for (change, path) in cases {
        assert_eq!(wrong(change), path);
    }
    let fine: [&dyn Fn(&mut Setup); 4] = [
        // The run lasts a second: these are as many samples as are accepted.
        &controlled(|c| c.sample_hz = 1e7),
        &|s| s.solver.max_step_s = Some(1e-12),
        &controlled(|c| c.computation_delay_s = 0.01),
        &following(&|f| (f.design, f.beta) = (FollowingDesign::Continuous, -1.0)),
    ];
    assert!(fine.into_iter().all(|change| wrong(change) == "nothing"));
}

#[test]
fn errors_about_agents_lead_to_them() {
    let rootless = |s: &mut Setup| {
        s.agents.iter_mut().for_each(|agent| agent.roots_per_s.clear());
        s.exchange = Exchange::PositionVelocity;
        s.reference = Arc::new(Backstepping { filter_s: 0.1, acceleration_limit: None });
    };
    let cases: [Case<'_>; 6] = [
        (&|s| s.agents[1].start.reference = vec![vec![0.0]; 2], "agents[1].start.reference"),
        (&|s| s.reference = Arc::new(Tracking), "agents[0].name"),
        (&rootless, "reference"),
        (&|s| s.agents[1].target = Some(at_zero()), "agents[1].target"),
        (&|s| s.network.agents = 3, "network"),
        (&controlled(|c| c.actuators.torque_limit = Some(Vec::new())), "control.torque_limit"),
    ];
    for (change, path) in cases {
        assert_eq!(wrong(change), path);
    }
    let quantity = SetupError::from(positive("time", "end_s", 0.0).unwrap_err());
    assert_eq!(quantity.to_string(), "time.end_s: `end_s` is 0, but must be positive");
}
