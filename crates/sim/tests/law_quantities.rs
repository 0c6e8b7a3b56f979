//! Numbers of laws and of their robots out of range: each is refused under the path that it has in a scenario file.

use std::ops::ControlFlow;
use std::sync::Arc;

use crate::common::{chains, masses, single, vehicles};
use forwardstep_core::Gain;
use forwardstep_core::controller::Floor;
use forwardstep_core::law::ParameterBounds;
use forwardstep_core::plant::Rotors;
use forwardstep_sim::{
    AttitudeLaw, ChainLaw, Law, ModelReferenceLaw, PassivityFilterLaw, PositionOnlyLaw, RotorcraftModel, Setup,
    SetupError, TaskSpaceLaw, ThrustKind, ThrustLaw, VehicleModel, simulate,
};

/// The path of what is refused, of agent 0.
fn refused(mut setup: Setup, change: impl FnOnce(&mut Setup)) -> String {
    change(&mut setup);
    match simulate(&setup, &mut |_| ControlFlow::Break(())) {
        Err(error @ (SetupError::Quantity(_) | SetupError::Entries { .. } | SetupError::Gain { .. })) => {
            error.path(&setup).to_string()
        }
        other => panic!("{:?}", other.map(|outcome| outcome.ending)),
    }
}

fn law<L: Law + Clone>(setup: Setup, change: impl FnOnce(&mut L)) -> String {
    refused(setup, |setup| assert!(setup.agents[0].change_law(change)))
}

const BAD: [f64; 4] = [-1.0, f64::NAN, f64::INFINITY, 1e300];

#[test]
fn numbers_of_thrust_laws_are_refused_under_their_keys() {
    let of = |design| vehicles::three(&vehicles::vehicle(), design, false, 1.0);
    let (known, adaptive) = (of(vehicles::DIFFERENTIABLE), of(vehicles::ADAPTIVE));
    let changed =
        |setup: &Setup, change: &dyn Fn(&mut ThrustLaw)| law(setup.clone(), |law: &mut ThrustLaw| change(law));
    for bad in BAD {
        let differentiable = |alpha_star, stiffness| {
            changed(&known, &|law| law.design = ThrustKind::Differentiable { alpha_star, stiffness })
        };
        assert_eq!(differentiable(bad, 1.0), "agents[0].law.design.differentiable.damping_per_s");
        assert_eq!(differentiable(1.0, bad), "agents[0].law.design.differentiable.stiffness");
        let adapted = |alpha_star, gamma_star, estimate_start| {
            changed(&adaptive, &|law| {
                law.design = ThrustKind::Adaptive { alpha_star, gamma_star, estimate_start, bounds: None }
            })
        };
        let measured = |numbers: [f64; 3], bias: f64| {
            let [alpha_star, gamma_star, estimate_start] = numbers;
            changed(&known, &|law| {
                let bias = [0.0, bias, 0.0];
                law.design = ThrustKind::ByAcceleration { alpha_star, gamma_star, estimate_start, bounds: None, bias }
            })
        };
        assert_eq!(measured([bad, 1.0, 1.0], 0.0), "agents[0].law.design.by_acceleration.damping_per_s");
        assert_eq!(measured([1.0, bad, 1.0], 0.0), "agents[0].law.design.by_acceleration.adaptation_gain");
        assert_eq!(measured([1.0, 1.0, bad], 0.0), "agents[0].law.design.by_acceleration.estimate_start_kg");
        if !bad.is_finite() {
            assert_eq!(measured([1.0; 3], bad), "agents[0].law.design.by_acceleration.bias_m_s2[1]");
        }
        assert_eq!(adapted(bad, 1.0, 1.0), "agents[0].law.design.adaptive.damping_per_s");
        assert_eq!(adapted(1.0, bad, 1.0), "agents[0].law.design.adaptive.adaptation_gain");
        assert_eq!(adapted(1.0, 1.0, bad), "agents[0].law.design.adaptive.estimate_start_kg");
        assert_eq!(changed(&known, &|law| law.floor = Floor::Stops(bad)), "agents[0].law.floor.stops_n");
        let kept = |floor, approach_s| changed(&known, &|law| law.floor = Floor::Kept { floor, approach_s });
        assert_eq!(kept(bad, 1.0), "agents[0].law.floor.kept.thrust_n");
        assert_eq!(kept(1.0, bad), "agents[0].law.floor.kept.approach_s");
        assert_eq!(changed(&known, &|law| law.yaw.gain = bad), "agents[0].law.yaw.gain_per_s");
        assert_eq!(changed(&known, &|law| law.thrust_start = Some(bad)), "agents[0].law.thrust_start_n");
        let robot = |change: &dyn Fn(&mut Setup)| refused(known.clone(), change);
        assert_eq!(
            robot(&|setup| setup.agents[0].robot.kind = Arc::new(VehicleModel { gravity: bad })),
            "agents[0].robot.gravity_m_s2"
        );
    }
    let mass = refused(known, |setup| setup.agents[0].robot.theta[0] = -1.0);
    assert_eq!(mass, "agents[0].robot.mass_kg");
}

#[test]
fn numbers_of_rotorcraft_are_refused_under_their_keys() {
    let setup = vehicles::three(&vehicles::rotorcraft(), vehicles::ADAPTIVE, false, 1.0);
    let model: &RotorcraftModel = setup.agents[0].robot.kind.downcast().unwrap();
    let rotors = Rotors { offset: 0.2, drag: 0.02, thrust: [0.1, 8.0] };
    let changed = |change: &dyn Fn(&mut Rotors)| {
        let mut rotors = rotors;
        change(&mut rotors);
        let model = RotorcraftModel { rotors: Some(rotors), ..model.clone() };
        refused(setup.clone(), |setup| setup.agents[0].robot.kind = Arc::new(model))
    };
    for bad in BAD {
        assert_eq!(changed(&|rotors| rotors.offset = bad), "agents[0].robot.rotors.offset_m");
        assert_eq!(changed(&|rotors| rotors.drag = bad), "agents[0].robot.rotors.drag_m");
        assert_eq!(changed(&|rotors| rotors.thrust[0] = bad), "agents[0].robot.rotors.thrust_n[0]");
        assert_eq!(changed(&|rotors| rotors.thrust[1] = bad), "agents[0].robot.rotors.thrust_n[1]");
        let bandwidth = law(setup.clone(), |law: &mut ThrustLaw| law.bandwidth_per_s = bad);
        assert_eq!(bandwidth, "agents[0].law.rate_bandwidth_per_s");
    }
    assert_eq!(changed(&|rotors| rotors.thrust[1] = rotors.thrust[0]), "agents[0].robot.rotors.thrust_n[1]");
}

#[test]
fn numbers_of_the_other_laws_are_refused_under_their_keys() {
    let spin = single::half_a_turn([0.1, -0.05, 0.08]);
    let craft = single::craft(spin.clone(), single::targets().swap_remove(2), 1.0);
    let bounds = |lower: [f64; 2], upper: [f64; 2], margin| {
        let bounds = ParameterBounds::new(lower.to_vec(), upper.to_vec(), margin);
        refused(single::planar(Some(bounds), 0.3), |_| {})
    };
    let tip = |change: &dyn Fn(&mut TaskSpaceLaw)| law(single::planar(None, 0.3), |law: &mut TaskSpaceLaw| change(law));
    for bad in BAD {
        let mass =
            |change: &dyn Fn(&mut PositionOnlyLaw)| law(masses::tracking(), |law: &mut PositionOnlyLaw| change(law));
        assert_eq!(mass(&|law| law.damping = bad), "agents[0].law.damping");
        assert_eq!(mass(&|law| law.filter_per_s = bad), "agents[0].law.filter_per_s");
        assert_eq!(mass(&|law| law.adaptation = bad), "agents[0].law.adaptation_gain");
        let model = |change: &dyn Fn(&mut ModelReferenceLaw)| {
            law(masses::by_model(), |law: &mut ModelReferenceLaw| change(law))
        };
        assert_eq!(model(&|law| law.filter_per_s = bad), "agents[0].law.filter_per_s");
        assert_eq!(model(&|law| law.adaptation = bad), "agents[0].law.adaptation_gain");
        assert_eq!(law(craft.clone(), |law: &mut AttitudeLaw| law.alpha[0] = bad), "agents[0].law.error_gain_per_s2");
        assert_eq!(law(craft.clone(), |law: &mut AttitudeLaw| law.alpha[1] = bad), "agents[0].law.rate_gain_per_s");
        let filtered = single::filtered_craft(spin.clone(), single::targets().swap_remove(2));
        let gain = law(filtered, |law: &mut PassivityFilterLaw| law.error_gain_n_m = bad);
        assert_eq!(gain, "agents[0].law.error_gain_n_m");
        assert_eq!(tip(&|law| law.kappa = bad), "agents[0].law.torque_share");
        assert_eq!(tip(&|law| law.alpha_per_s = bad), "agents[0].law.reference_gain_per_s");
        assert_eq!(tip(&|law| law.determinant_floor = bad), "agents[0].law.determinant_floor");
        assert_eq!(bounds([0.5, 0.5], [1.5, 1.5], bad), "agents[0].law.bounds.margin_m");
        assert_eq!(law(chains::adaptive(), |law: &mut ChainLaw| law.floor = bad), "agents[0].law.floor");
    }
    assert_eq!(bounds([0.5, 1.6], [1.5, 1.5], 0.01), "agents[0].law.bounds.upper_m[1]");
    assert_eq!(bounds([f64::NAN, 0.5], [1.5, 1.5], 0.01), "agents[0].law.bounds.lower_m[0]");
    assert_eq!(bounds([0.5, 0.5], [1.5, f64::INFINITY], 0.01), "agents[0].law.bounds.upper_m[1]");
}

#[test]
fn gains_and_lists_are_refused_under_their_keys() {
    let spin = single::half_a_turn([0.1, -0.05, 0.08]);
    let craft = single::craft(spin, single::targets().swap_remove(2), 1.0);
    let turn = |change: &dyn Fn(&mut AttitudeLaw)| law(craft.clone(), |law: &mut AttitudeLaw| change(law));
    let tip = |change: &dyn Fn(&mut TaskSpaceLaw)| law(single::planar(None, 0.3), |law: &mut TaskSpaceLaw| change(law));
    let crooked = || Gain::Matrix(vec![1.0, 2.0, 2.0, 1.0]);
    assert_eq!(turn(&|law| law.filter = Gain::Diagonal(vec![1.0; 3])), "agents[0].law.filter_gain_per_s");
    assert_eq!(turn(&|law| law.damping = Gain::Number(-1.0)), "agents[0].law.damping");
    assert_eq!(tip(&|law| law.damping = Gain::Bandwidth(-1.0)), "agents[0].law.damping.bandwidth_per_s");
    assert_eq!(tip(&|law| law.damping = crooked()), "agents[0].law.damping.gain");
    assert_eq!(tip(&|law| law.adaptation = Gain::Number(0.0)), "agents[0].law.adaptation_gain");
    assert_eq!(tip(&|law| law.task_gain = Gain::Diagonal(vec![1.0, -1.0])), "agents[0].law.task_gain[1]");
    assert_eq!(tip(&|law| law.kinematic_adaptation = Some(crooked())), "agents[0].law.kinematic_gain");
    assert_eq!(tip(&|law| law.estimate_start.clear()), "agents[0].law.estimate_start.given");
    assert_eq!(tip(&|law| law.kinematic_start[1] = f64::NAN), "agents[0].law.kinematic_start.given[1]");
    let bounds = |lower: &[f64], upper: &[f64]| {
        let bounds = ParameterBounds::new(lower.to_vec(), upper.to_vec(), 0.01);
        refused(single::planar(Some(bounds), 0.3), |_| {})
    };
    assert_eq!(bounds(&[0.5], &[1.5, 1.5]), "agents[0].law.bounds.lower_m");
    assert_eq!(bounds(&[0.5, 0.5], &[1.5]), "agents[0].law.bounds.upper_m");
    assert_eq!(refused(craft.clone(), |s| s.agents[0].start.q[2] = f64::NAN), "agents[0].start.position[2]");
    assert_eq!(refused(craft, |s| s.agents[0].start.dq.clear()), "agents[0].start.velocity");
}
