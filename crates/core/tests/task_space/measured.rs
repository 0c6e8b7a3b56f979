//! The law with a measured velocity of the tip: its V, and its z as a function.

use forwardstep_core::controller::TaskSpaceByVelocity;
use forwardstep_core::plant::WatchedTaskArm;

use super::*;

/// A closed loop with random gains, by the measured velocity of the tip.
fn watched<R, T>(
    plant: TaskArm<R, T>,
    random: &mut Random,
    bounds: [Option<ParameterBounds>; 2],
) -> Looped<TaskSpaceByVelocity<R, T>, impl Fn(f64) -> Vec<Jet> + use<R, T>>
where
    R: Lagrangian<f64, Scratch: Send> + Clone + Send + Sync + 'static,
    T: TipKinematics + Clone,
{
    let [lengths, parameters] = bounds;
    let Looped { plant, mut controller, target, .. } = looped(plant, random, lengths);
    if parameters.is_some() {
        controller.law.adaptation = Some(Gain::Number(1.4).resolve(plant.arm.theta.len(), &[]).unwrap());
    }
    controller.law.bounds = parameters;
    Looped::new(WatchedTaskArm(plant), TaskSpaceByVelocity(controller), target)
}

fn planar() -> TaskArm<PlanarArm, PlanarTip> {
    let links = PlanarLinks::uniform([2.0, 1.0], [1.0, 0.8]);
    TaskArm {
        arm: Mechanical { robot: PlanarArm, theta: links.theta().to_vec() },
        tip: PlanarTip { length_m: links.length_m },
        tip_theta: links.length_m.to_vec(),
    }
}

#[test]
fn own_v_falls_by_a_measured_velocity_of_the_tip_at_random_states() {
    let mut random = Random::new(31);
    let mut checked = [0; 4];
    for round in 0..40 {
        checked[0] += usize::from(falls(watched(planar(), &mut random, [None, None]), &mut random, 2, 1));
        let lengths = ParameterBounds::new(vec![0.5, 0.5], vec![1.1, 0.9], 5.0);
        let system = watched(planar(), &mut random, [Some(lengths), None]);
        checked[1] += usize::from(falls(system, &mut random, 2, 1));
        let [lower, upper] = [-0.3, 0.3].map(|room| planar().arm.theta.iter().map(|theta| theta + room).collect());
        let parameters = ParameterBounds::new(lower, upper, 5.0);
        let system = watched(planar(), &mut random, [None, Some(parameters)]);
        checked[2] += usize::from(falls(system, &mut random, 2, 1));
        let (assembled, point) = chain(&mut random, round % 2 == 0);
        let tip = tip(&assembled, &point, if round % 4 < 2 { Uncertain::Tool } else { Uncertain::Chain });
        let tip_theta = tip.parameters();
        let arm = Mechanical { robot: assembled.tree, theta: assembled.theta };
        let system = watched(TaskArm { arm, tip, tip_theta }, &mut random, [None, None]);
        checked[3] += usize::from(falls(system, &mut random, 3, 1));
    }
    assert!(checked.iter().all(|checked| *checked > 10), "{checked:?}");
}

/// ż is the derivative of z along the motion, and Ĵ z = ẋ_d − α Δx.
#[test]
fn own_z_by_a_measured_velocity_is_a_function_and_its_derivative_is_shown() {
    let mut random = Random::new(32);
    for _ in 0..20 {
        let mut system = watched(planar(), &mut random, [None, None]);
        let mut x = system.start(&[0.2, 1.4, 0.5 * random.number(), 0.5 * random.number()], &[]);
        for state in &mut x[4..11] {
            *state += 0.1 * random.number();
        }
        system.rate(0.0, &x);
        let (shown, output) = (system.shown.clone(), system.output.clone());
        for k in 0..2 {
            let slope = system.slope(0.0, &x, |system, t, x| {
                system.rate(t, x);
                system.shown[k]
            });
            assert!((slope - shown[2 + k]).abs() < 1e-7 * (1.0 + slope.abs()), "{slope} {}", shown[2 + k]);
        }
        // s = q̇ − z, and what is seen stands behind Δx.
        assert!((0..2).all(|k| (shown[4 + k] - (x[2 + k] - shown[k])).abs() < 1e-15));
        assert_eq!(shown[shown.len() - 2..], output[6..]);
        let [j, _] = jacobian(&system.controller.0.tip, &x[..2], &x[2..4], &x[9..11], &[0.0; 2]);
        let (target, error) = ((system.target)(0.0), &shown[shown.len() - 4..]);
        for row in 0..2 {
            let led = target[row][1] - 1.7 * error[row];
            let found = j[2 * row] * shown[0] + j[2 * row + 1] * shown[1];
            assert!((led - found).abs() < 1e-12, "{led} {found}");
        }
    }
}

/// What is wrong with ẋ is a torque at once: −α M̂ Ĵ⁻¹ times it.
#[test]
fn own_an_error_of_the_measured_velocity_is_a_torque_at_once() {
    let mut random = Random::new(33);
    let mut system = watched(planar(), &mut random, [None, None]);
    let x = system.start(&[0.2, 1.4, 0.3, -0.1], &[]);
    system.rate(0.0, &x);
    let (exact, output, law) = (system.input.clone(), system.output.clone(), system.controller.clone());
    let mut wrong = output.clone();
    wrong[6] += 0.01;
    let (mut input, mut d_state, mut shown) = (vec![0.0; 2], vec![0.0; 8], vec![0.0; system.shown.len()]);
    let target = (system.target)(0.0);
    let given = forwardstep_core::controller::ControllerInput {
        measured: law.see(&wrong).unwrap(),
        heard: forwardstep_core::reference::Heard::new(&[0.0], &[0.0; 2], 2).unwrap(),
        target: forwardstep_core::controller::Jets::from(&target[..]),
    };
    let asked =
        forwardstep_core::controller::ControllerOutput { input: &mut input, d_state: &mut d_state, shown: &mut shown };
    law.evaluate(&mut law.scratch(), given, &x[4..], asked).unwrap();
    // Y(q, 0, 0, a) − Y(q, 0, 0, 0) = M̂ a with ϑ̂ in the place of ϑ.
    let [j, _] = jacobian(&law.0.tip, &x[..2], &x[2..4], &x[9..11], &[0.0; 2]);
    let determinant = j[0] * j[3] - j[1] * j[2];
    let a = [-1.7 * 0.01 * j[3] / determinant, 1.7 * 0.01 * j[2] / determinant];
    let still = [0.0; 2];
    let torque = |dz: &[f64]| {
        let (mut torque, mut yt) = (vec![0.0; 2], vec![0.0; 5]);
        let motion = forwardstep_core::robot::TwoVelocity { q: &x[..2], dq: &still[..], z: &still[..], dz };
        PlanarArm.regressor_products(&mut (), motion, &x[4..9], &still, &mut torque, &mut yt).unwrap();
        torque
    };
    let (with, without) = (torque(&a), torque(&still));
    for k in 0..2 {
        let (found, expected) = (input[k] - exact[k], with[k] - without[k]);
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        assert!(expected.abs() > 1e-4);
    }
}

/// Poses and joints to spare are refused by their lengths, not by a panic.
#[test]
fn own_a_pose_is_no_tip_for_a_measured_velocity() {
    let mut random = Random::new(34);
    let (assembled, point) = chain_of(6, &mut random, false);
    let tip = posed(&assembled, &point, Uncertain::Tool);
    let tip_theta = tip.parameters();
    let plant = TaskArm { arm: Mechanical { robot: assembled.tree, theta: assembled.theta }, tip, tip_theta };
    let Looped { plant, controller, .. } = looped(plant, &mut random, None);
    let (law, plant) = (TaskSpaceByVelocity(controller), WatchedTaskArm(plant));
    let mut output = vec![0.0; forwardstep_core::plant::Plant::output_len(&plant)];
    let mut work = forwardstep_core::plant::Plant::scratch(&plant);
    forwardstep_core::plant::Plant::output(&plant, &mut work, &[0.1; 12], &mut output).unwrap();
    let target = [[0.0; 5]; 3];
    let given = forwardstep_core::controller::ControllerInput {
        measured: law.see(&output).unwrap(),
        heard: forwardstep_core::reference::Heard::new(&[0.0], &[0.0; 6], 6).unwrap(),
        target: forwardstep_core::controller::Jets::from(&target),
    };
    let mut state = vec![0.0; law.states().iter().map(|(_, n)| n).sum()];
    assert!(law.start(&mut law.scratch(), given, &[], &mut state).is_err());
}
