//! What a kind of system does not read is refused, with the reason, and never accepted without a word.

use forwardstep_sim::reference::{Backstepping, Consensus};
use std::ops::ControlFlow;
use std::sync::Arc;

use crate::common::{every_kind, masses, sampled, single, switching, vehicles};
use forwardstep_core::Gain;
use forwardstep_core::law::ParameterBounds;
use forwardstep_sim::{
    Adaptive, AgentSetup, LimitError, Outcome, Setup, SetupError, SpacecraftModel, TaskSpaceLaw, ThrustKind,
    VelocityQuantity, VelocitySensor, simulate,
};

fn outcome(setup: &Setup) -> Result<Outcome, SetupError> {
    let mut short = setup.clone();
    short.time.end_s = 1e-3;
    simulate(&short, &mut |_| ControlFlow::Break(()))
}

/// Every kind of system, with what `change` does to its last agent.
fn changed(change: impl Fn(&mut AgentSetup)) -> Vec<(String, Setup, Result<Outcome, SetupError>)> {
    let all = every_kind().into_iter().map(|(name, mut setup)| {
        assert!(outcome(&setup).is_ok(), "{name}: {:?}", outcome(&setup).err());
        change(setup.agents.last_mut().unwrap());
        let outcome = outcome(&setup);
        (name.to_owned(), setup, outcome)
    });
    all.collect()
}

#[test]
fn lambda_is_refused_wherever_it_is_not_in_the_equations() {
    for (name, setup, outcome) in changed(|agent| agent.manipulability = 0.5) {
        // None of these kinds is (3), (23), (a5) or (24) beside (6)–(7).
        let Err(SetupError::NoManipulability { agent, value, law }) = outcome else { panic!("{name}: {outcome:?}") };
        assert_eq!((&agent, value), (&setup.agents.last().unwrap().name, 0.5), "{name}");
        assert_eq!(law == "following a leader", name.starts_with("following"), "{name}: {law}");
    }
    let mut baseline = lagrangian();
    baseline.reference = Arc::new(Backstepping { filter_s: 0.01, acceleration_limit: None });
    baseline.agents[0].roots_per_s.clear();
    assert!(outcome(&baseline).is_ok());
    baseline.agents[0].manipulability = 0.5;
    assert!(matches!(outcome(&baseline), Err(SetupError::NoManipulability { law: "the backstepping baseline", .. })));
}

#[test]
fn lambda_is_read_beside_the_adaptive_law() {
    let mut setup = lagrangian();
    setup.agents[0].manipulability = 0.5;
    assert!(outcome(&setup).is_ok());
    setup.agents[0].manipulability = -0.5;
    assert!(matches!(outcome(&setup), Err(SetupError::Quantity(error)) if error.path.name() == "manipulability_gain"));
}

/// A mass under (24) with the adaptive law.
fn lagrangian() -> Setup {
    let mut setup = masses::consensus(2);
    setup.agents.truncate(1);
    setup.network = crate::common::silent(1);
    setup.agents[0].law = Arc::new(Adaptive {
        damping: Gain::Number(5.0),
        adaptation: Gain::Number(5.0),
        estimate_start: vec![0.0],
        bounds: None,
    });
    setup
}

#[test]
fn roots_are_refused_where_reference_dynamics_have_none() {
    for (name, setup, outcome) in changed(|agent| agent.roots_per_s = vec![1.0; agent.roots_per_s.len().max(1)].into())
    {
        let rootless = ["tip", "spacecraft", "passivity", "following"].iter().any(|kind| name.starts_with(kind));
        match outcome {
            Err(SetupError::RootCount { error, .. }) => {
                assert!(rootless && error.need == 0 && error.got == 1, "{name}")
            }
            other => assert!(!rootless && other.is_ok(), "{name}: {other:?}, {:?}", setup.reference),
        }
    }
    let mut baseline = lagrangian();
    baseline.reference = Arc::new(Backstepping { filter_s: 0.01, acceleration_limit: None });
    assert!(matches!(outcome(&baseline), Err(SetupError::RootCount { error, .. }) if error.need == 0));
}

#[test]
fn a_start_of_z_has_no_more_entries_than_the_state_has() {
    for (name, setup, _) in changed(|_| {}) {
        let agent = setup.agents.last().unwrap();
        let axes = agent.robot.velocity_len().max(1).min(agent.robot.axes.len());
        let columns = outcome(&setup).unwrap().recording.columns;
        let own = columns.iter().filter(|column| column.agent + 1 == setup.agents.len() && column.axis == 0);
        let shown = own.filter(|column| matches!(column.signal, forwardstep_sim::Signal::Reference(_))).count();
        // A rate that is shown is no state.
        let rates = usize::from(["tip", "spacecraft", "following-110"].iter().any(|kind| name.starts_with(kind)));
        let derivatives = (shown - rates).min(setup.reference.free_derivatives(agent.roots_per_s.len()));
        // After z and its derivatives come the starts that a law has besides.
        let further = agent.interface().unwrap().further_starts;
        let accepted = (1..=6).take_while(|count| {
            let mut setup = setup.clone();
            let length = |k: usize| k.checked_sub(derivatives).and_then(|k| further.get(k)).copied().unwrap_or(axes);
            setup.agents.last_mut().unwrap().start.reference = (0..*count).map(|k| vec![0.1; length(k)]).collect();
            match outcome(&setup) {
                Ok(_) => true,
                Err(SetupError::StartOfReference { error, .. }) => {
                    assert_eq!((error.need, error.got), (count - 1, *count), "{name}");
                    false
                }
                Err(other) => panic!("{name}: {other}"),
            }
        });
        assert_eq!(accepted.count(), derivatives + further.len(), "{name}");
    }
}

#[test]
fn limits_that_nothing_has_cannot_be_enforced() {
    for (name, setup, outcome) in changed(|agent| agent.enforce_limits = true) {
        let wheels = setup.agents[0].robot.kind.is::<SpacecraftModel>();
        match outcome {
            Err(SetupError::Limit { error: LimitError::NoEffortLimit { .. }, .. }) => assert!(!wheels, "{name}"),
            other => assert!(wheels && other.is_ok(), "{name}: {other:?}"),
        }
    }
    // An effort limit of an axis is no limit of a thrust.
    let mut craft = vehicles::three(&vehicles::vehicle(), ThrustKind::Continuous, false, 1.0);
    for agent in &mut craft.agents {
        agent.robot.axes.iter_mut().for_each(|axis| axis.effort_limit = Some(10.0));
        agent.enforce_limits = true;
    }
    assert!(matches!(outcome(&craft), Err(SetupError::Limit { error: LimitError::NoEffortLimit { .. }, .. })));
}

#[test]
fn agents_with_targets_of_their_own_hear_nobody() {
    let mut setup = masses::tracking();
    let mut other = setup.agents[0].clone();
    other.name = "other".into();
    setup.agents.extend([other.clone(), AgentSetup { name: "third".into(), ..other }]);
    setup.network = crate::common::silent(3);
    assert!(outcome(&setup).is_ok());
    setup.network = switching();
    assert!(matches!(outcome(&setup), Err(SetupError::UnusedEdges { edges: 4 })));
}

#[test]
fn laws_that_only_track_do_not_go_with_consensus() {
    for mut setup in
        [single::planar(None, 0.3), single::craft(single::half_a_turn([0.0; 3]), single::targets().remove(0), 5.0)]
    {
        setup.reference = Arc::new(Consensus);
        assert!(matches!(outcome(&setup), Err(SetupError::OnlyTracks { .. })));
        setup.agents[0].target = None;
        assert!(matches!(outcome(&setup), Err(SetupError::OnlyTracks { .. })));
    }
}

#[test]
fn bounds_of_lengths_that_are_not_adapted_are_refused() {
    let bounds = ParameterBounds::new(vec![0.5, 0.5], vec![1.5, 1.5], 0.1);
    for (adapted, bounds, accepted) in
        [(true, Some(bounds.clone()), true), (false, None, true), (false, Some(bounds), false)]
    {
        let mut setup = single::planar(bounds, 0.3);
        let keep =
            |law: &mut TaskSpaceLaw| law.kinematic_adaptation = law.kinematic_adaptation.take().filter(|_| adapted);
        assert!(setup.agents[0].change_law(keep));
        match outcome(&setup) {
            Ok(_) => assert!(accepted),
            Err(error) => assert!(!accepted && matches!(error, SetupError::BoundsOfKnown { .. }), "{error}"),
        }
    }
}

#[test]
fn what_is_said_of_velocities_counts_only_where_they_are_measured() {
    let mut unmeasured = 0;
    for (name, setup) in every_kind() {
        // A leader's sign by its own period, and neither, are for continuous time; what is sampled here is the sensor.
        let base = sampled(setup, 100.0);
        assert!(outcome(&base).is_ok(), "{name}: {:?}", outcome(&base).err());
        let with = |noise, step, filter: bool| {
            let mut setup = base.clone();
            let sensors = &mut setup.control.as_mut().unwrap().sensors;
            (sensors.velocity_noise, sensors.velocity_quantum) = (noise, step);
            if filter {
                sensors.velocity = VelocitySensor::Filtered { cut_off_hz: 30.0 };
            }
            match outcome(&setup) {
                Ok(_) => None,
                Err(SetupError::VelocityUnused { quantity, filtered, .. }) => Some((quantity, filtered)),
                Err(other) => panic!("{name}: {other}"),
            }
        };
        let kinds = ["masses", "spacecraft", "passivity", "chains-strict", "chains-pure"];
        let blind = kinds.iter().any(|kind| name.starts_with(kind));
        unmeasured += usize::from(blind);
        let never = |quantity| blind.then_some((quantity, false));
        assert_eq!(with(1e-3, 0.0, false), never(VelocityQuantity::Noise), "{name}");
        assert_eq!(with(0.0, 1e-3, false), never(VelocityQuantity::Step), "{name}");
        assert_eq!(with(0.0, 0.0, true), never(VelocityQuantity::CutOff), "{name}");
        if !blind {
            assert_eq!(with(1e-3, 0.0, true), Some((VelocityQuantity::Noise, true)), "{name}");
            assert_eq!(with(0.0, 1e-3, true), Some((VelocityQuantity::Step, true)), "{name}");
        }
    }
    assert_eq!(unmeasured, 7);
}
