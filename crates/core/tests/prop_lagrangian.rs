//! Properties 1–3 of Lagrangian robots, and that all methods of one robot tell the same story: trees, the planar arm, the
//! point mass.

use crate::common::dual::{Dual, constants, duals};
use crate::common::random::Random;
use crate::common::{dot, error, times, transpose_times};
use forwardstep_core::robot::tree::{Assembled, JointKind, LinkJoint, LinkSpec, Placement, Tree, inertia_about_frame};
use forwardstep_core::robot::{
    Driven, Drives, Friction, Lagrangian, PlanarArm, PlanarLinks, PlanarTip, PointMass, SMOOTHING_LOSS, Ship,
    TwoVelocity,
};
use proptest::prelude::*;

const TOLERANCE: f64 = 1.0e-11;

/// Positions, velocities, reference, s and τ for a robot.
struct Case {
    q: Vec<f64>,
    dq: Vec<f64>,
    z: Vec<f64>,
    dz: Vec<f64>,
    s: Vec<f64>,
}

impl Case {
    fn new(random: &mut Random, n: usize) -> Self {
        let mut column = |scale| random.column(n, scale);
        Case { q: column(3.0), dq: column(2.0), z: column(2.0), dz: column(5.0), s: column(3.0) }
    }

    fn motion(&self) -> TwoVelocity<'_, f64> {
        TwoVelocity { q: &self.q, dq: &self.dq, z: &self.z, dz: &self.dz }
    }
}

/// Yϑ and Yᵀs.
fn products<R: Lagrangian<f64>>(robot: &R, case: &Case, theta: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let (mut y_theta, mut yt_s) = (vec![0.0; robot.dof()], vec![0.0; robot.parameter_count()]);
    let motion = case.motion();
    robot.regressor_products(&mut robot.scratch(), motion, theta, &case.s, &mut y_theta, &mut yt_s).unwrap();
    (y_theta, yt_s)
}

/// Everything a robot claims, for parameters ϑ that need not be physical.
fn consistent<R: Lagrangian<f64> + Lagrangian<Dual>>(robot: &R, case: &Case, theta: &[f64]) {
    let n = Lagrangian::<f64>::dof(robot);
    let width = Lagrangian::<f64>::parameter_count(robot);
    let mut scratch = Lagrangian::<f64>::scratch(robot);
    let (y_theta, yt_s) = products(robot, case, theta);

    // Linear in ϑ: Y ϑ with Y itself; and Yᵀs.
    let mut y = vec![0.0; n * width];
    robot.regressor(&mut scratch, case.motion(), &mut y).unwrap();
    assert!(error(&times(&y, theta), &y_theta) < TOLERANCE, "Yϑ");
    assert!(error(&transpose_times(&y, &case.s), &yt_s) < TOLERANCE, "Yᵀs");
    let (left, right) = (dot(&case.s, &y_theta), dot(theta, &yt_s));
    assert!((left - right).abs() < TOLERANCE * (1.0 + left.abs()), "sᵀYϑ");

    // M ż + C z + g + D z.
    let (mut m, mut c, mut g) = (vec![0.0; n * n], vec![0.0; n * n], vec![0.0; n]);
    robot.mass_matrix(&mut scratch, &case.q, theta, &mut m).unwrap();
    robot.coriolis_matrix(&mut scratch, &case.q, &case.dq, theta, &mut c).unwrap();
    robot.gravity(&mut scratch, &case.q, theta, &mut g).unwrap();
    let (inertial, coriolis) = (times(&m, &case.dz), times(&c, &case.z));
    let mut sum: Vec<f64> = (0..n).map(|i| inertial[i] + coriolis[i] + g[i]).collect();
    let still = vec![0.0; n];
    let resisted = TwoVelocity { q: &case.q, dq: &case.z, z: &still, dz: &still };
    robot.add_damping(&mut scratch, resisted, theta, &mut sum).unwrap();
    assert!(error(&sum, &y_theta) < TOLERANCE, "M ż + C z + g + D z");

    // Symmetry of M; skew-symmetry of Ṁ − 2C, from which Ṁ = C + Cᵀ with the symmetry of M.
    let transposed: Vec<f64> = (0..n * n).map(|k| m[k % n * n + k / n]).collect();
    assert!(error(&m, &transposed) < TOLERANCE, "M − Mᵀ");
    let mut dm = vec![Dual { value: 0.0, slope: 0.0 }; n * n];
    let mut dual_scratch = Lagrangian::<Dual>::scratch(robot);
    robot.mass_matrix(&mut dual_scratch, &duals(&case.q, &case.dq), &constants(theta), &mut dm).unwrap();
    let rate: Vec<f64> = dm.iter().map(|m| m.slope).collect();
    let sum: Vec<f64> = (0..n * n).map(|k| c[k] + c[k % n * n + k / n]).collect();
    assert!(error(&sum, &rate) < TOLERANCE, "Ṁ − C − Cᵀ");

    // The Coriolis matrix is the one of Christoffel symbols: C(q, x) y = C(q, y) x.
    let mut other = vec![0.0; n * n];
    robot.coriolis_matrix(&mut scratch, &case.q, &case.z, theta, &mut other).unwrap();
    assert!(error(&times(&other, &case.dq), &coriolis) < TOLERANCE, "C(q, z) q̇ − C(q, q̇) z");
}

/// For physical ϑ: forward dynamics undoes inverse dynamics, and M is positive definite.
fn invertible<R: Lagrangian<f64>>(robot: &R, case: &Case, theta: &[f64]) {
    let n = robot.dof();
    let mut scratch = robot.scratch();
    let mut ddq = vec![0.0; n];
    robot.forward_dynamics(&mut scratch, &case.q, &case.dq, theta, &case.s, &mut ddq).unwrap();
    let forward = Case { q: case.q.clone(), dq: case.dq.clone(), z: case.dq.clone(), dz: ddq, s: case.s.clone() };
    let (tau, _) = products(robot, &forward, theta);
    // By the residual, relative to the terms that cancel in it.
    let size = forward.dz.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
    let residual = tau.iter().zip(&case.s).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()));
    assert!(residual < 1.0e-10 * size, "{residual:e} of {size:e}");

    let mut m = vec![0.0; n * n];
    robot.mass_matrix(&mut scratch, &case.q, theta, &mut m).unwrap();
    let energy = dot(&case.s, &times(&m, &case.s));
    assert!(energy > 0.0, "sᵀMs = {energy}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn prop_tree_is_lagrangian(seed in any::<u64>(), joints in 1_usize..9) {
        let mut random = Random::new(seed);
        let assembled = random.tree(joints);
        let tree = &assembled.tree;
        let case = Case::new(&mut random, joints);
        consistent(tree, &case, &assembled.theta);
        invertible(tree, &case, &assembled.theta);
        // An estimate ϑ̂ may be anything.
        let estimate = random.column(assembled.theta.len(), 3.0);
        consistent(tree, &case, &estimate);
        consistent(tree, &case, &vec![0.0; estimate.len()]);
        let samples = tree.check_mass_matrix(&assembled.theta, &vec![[f64::NEG_INFINITY, f64::INFINITY]; joints], 20);
        prop_assert_eq!(samples, Ok(()));
    }

    #[test]
    fn prop_a_tree_with_rotors_and_smooth_friction_is_lagrangian(seed in any::<u64>(), joints in 1_usize..9) {
        let mut random = Random::new(seed);
        let assembled = random.driven_tree(joints, false);
        let case = Case::new(&mut random, joints);
        consistent(&assembled.tree, &case, &assembled.theta);
        invertible(&assembled.tree, &case, &assembled.theta);
        consistent(&assembled.tree, &case, &random.column(assembled.theta.len(), 3.0));
        let names: Vec<String> = (0..joints).map(|k| format!("b{k}")).collect();
        let names = assembled.tree.theta_names(&names.iter().map(String::as_str).collect::<Vec<_>>()).unwrap();
        prop_assert_eq!(names.len(), assembled.theta.len());
        let scale = Lagrangian::<f64>::adaptation_scale(&assembled.tree, &case.q, &assembled.theta);
        prop_assert_eq!(scale.len(), assembled.theta.len());
        prop_assert!(scale.iter().all(|scale| *scale > 0.0));
    }

    /// A rotor that turns with its joint is a body without mass that turns about the axis.
    #[test]
    fn prop_an_armature_is_an_inertia_about_the_axis_of_its_joint_that_no_other_joint_moves(seed in any::<u64>()) {
        let mut random = Random::new(seed);
        let mut assembled = random.tree(4);
        let case = Case::new(&mut random, 4);
        let n = 16;
        let (mut without, mut with) = (vec![0.0; n], vec![0.0; n]);
        assembled.tree.mass_matrix(&mut assembled.tree.scratch(), &case.q, &assembled.theta, &mut without).unwrap();
        let drives = Drives { geared: vec![1, 3], ..assembled.tree.drives().clone() };
        assembled.tree = assembled.tree.with_drives(drives).unwrap();
        assembled.theta.extend([0.7, 0.4]);
        assembled.tree.mass_matrix(&mut assembled.tree.scratch(), &case.q, &assembled.theta, &mut with).unwrap();
        for k in 0..n {
            let expected = if k == 5 { 0.7 } else if k == 15 { 0.4 } else { 0.0 };
            prop_assert!((with[k] - without[k] - expected).abs() < 1e-14 * with[k].abs().max(1.0), "{}", k);
        }
    }

    /// What (6)–(7) lose beside sᵀKs: the torque of the plant at q̇ less that of Y at z, times s.
    #[test]
    fn prop_friction_loses_what_the_plant_has_less_what_the_regressor_has(seed in any::<u64>(), joints in 1_usize..7) {
        for dry in [false, true] {
            let mut random = Random::new(seed);
            let Assembled { tree, theta, .. } = random.driven_tree(joints, dry);
            let case = Case::new(&mut random, joints);
            let mut lost = vec![0.0; joints];
            tree.add_damping(&mut tree.scratch(), case.motion(), &theta, &mut lost).unwrap();
            // M q̈ + C q̇ + g + D q̇ + F tanh(q̇/ε) of the plant, less M q̈ + C z + … of Y: without M and C what is lost.
            let torque = |z: &[f64], dz: &[f64]| {
                let motion = TwoVelocity { z, dz, ..case.motion() };
                let (mut torque, mut unused) = (vec![0.0; joints], vec![0.0; theta.len()]);
                tree.regressor_products(&mut tree.scratch(), motion, &theta, &case.s, &mut torque, &mut unused).unwrap();
                torque
            };
            let mut ddq = vec![0.0; joints];
            tree.forward_dynamics(&mut tree.scratch(), &case.q, &case.dq, &theta, &case.s, &mut ddq).unwrap();
            let (plant, law) = (case.s.clone(), torque(&case.z, &ddq));
            let mut coriolis = vec![0.0; joints * joints];
            tree.coriolis_matrix(&mut tree.scratch(), &case.q, &case.dq, &theta, &mut coriolis).unwrap();
            let s: Vec<f64> = case.dq.iter().zip(&case.z).map(|(dq, z)| dq - z).collect();
            let moved = times(&coriolis, &s);
            let size = ddq.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
            for k in 0..joints {
                prop_assert!((plant[k] - law[k] - moved[k] - lost[k]).abs() < 1e-9 * size, "{} {}", dry, k);
            }
            let power: f64 = s.iter().zip(&lost).map(|(s, lost)| s * lost).sum();
            prop_assert!(dry || power >= 0.0, "{}", power);
        }
    }

    /// With any σ ∈ Sgn q̇ the gain is at most κ ε F, and so much for some.
    #[test]
    fn prop_dry_friction_brings_at_most_what_its_width_allows(seed in any::<u64>()) {
        let mut random = Random::new(seed);
        for k in 0..200 {
            let (dq, z) = (if k % 3 == 0 { 0.0 } else { random.number() }, random.number());
            let sigma = if dq == 0.0 { random.number() } else { dq.signum() };
            prop_assert!((dq - z) * ((z / 0.1).tanh() - sigma) <= SMOOTHING_LOSS * 0.1);
        }
        let most = |z: f64| z * (1.0 - z.tanh());
        prop_assert!((most(0.639_232_271) - SMOOTHING_LOSS).abs() < 1e-9 && most(0.639_232_271) <= SMOOTHING_LOSS);
    }

    #[test]
    fn prop_planar_arm_is_lagrangian(seed in any::<u64>()) {
        let mut random = Random::new(seed);
        let case = Case::new(&mut random, 2);
        consistent(&PlanarArm, &case, &random.column(5, 3.0));
        let mut positive = || 1.5 + random.number();
        let arm = PlanarLinks::uniform([positive(), positive()], [positive(), positive()]);
        invertible(&PlanarArm, &case, &arm.theta());
    }

    #[test]
    fn prop_point_mass_is_lagrangian(seed in any::<u64>(), dimension in 1_usize..5) {
        let mut random = Random::new(seed);
        let case = Case::new(&mut random, dimension);
        let robot = PointMass { dimension };
        consistent(&robot, &case, &random.column(1, 3.0));
        invertible(&robot, &case, &[1.5 + random.number()]);
    }

    /// Two uniform rods that turn about −y, seen as a tree: x forward, z up, q₁ from the horizontal.
    #[test]
    fn prop_ship_is_lagrangian(seed in any::<u64>()) {
        let mut random = Random::new(seed);
        let case = Case::new(&mut random, 3);
        consistent(&Ship, &case, &random.column(9, 3.0));
        let coupling = 0.9 * random.column(1, 1.0)[0];
        let mut theta = vec![2.0, 3.0, coupling, 1.5];
        theta.extend(random.column(5, 1.0));
        invertible(&Ship, &case, &theta);
    }

    /// Against the same ship written down in the axes of its body: M ν̇ + C(ν) ν + D ν = Rᵀ τ with C after its textbook form.
    #[test]
    fn prop_ship_moves_as_in_the_axes_of_its_body(seed in any::<u64>()) {
        let mut random = Random::new(seed);
        let Case { q, dq, s: tau, .. } = Case::new(&mut random, 3);
        let theta = [2.0, 3.0, 0.7, 1.5, 0.3, 0.9, 0.2, -0.4, 0.8];
        let mut ddq = [0.0; 3];
        Ship.forward_dynamics(&mut (), &q, &dq, &theta, &tau, &mut ddq).unwrap();
        let (sin, cos) = q[2].sin_cos();
        let to_body = |a: &[f64]| [cos * a[0] + sin * a[1], cos * a[1] - sin * a[0], a[2]];
        let (nu, force, a) = (to_body(&dq), to_body(&tau), to_body(&ddq));
        let [u, v, r] = nu;
        // ν̇ = Rᵀ q̈ − ψ̇ J ν.
        let d_nu = [a[0] + r * v, a[1] - r * u, a[2]];
        let [m11, m22, m23, m33, d11, d22, d23, d32, d33] = theta;
        let lateral = m22 * v + m23 * r;
        let left = [
            m11 * d_nu[0] - lateral * r + d11 * u,
            m22 * d_nu[1] + m23 * d_nu[2] + m11 * u * r + d22 * v + d23 * r,
            m23 * d_nu[1] + m33 * d_nu[2] + lateral * u - m11 * u * v + d32 * v + d33 * r,
        ];
        prop_assert!(error(&left, &force) < 1e-9, "{:?} {:?}", left, force);
    }

    #[test]
    fn prop_planar_arm_is_a_tree(seed in any::<u64>()) {
        let mut random = Random::new(seed);
        let mut positive = || 1.5 + random.number();
        let links = PlanarLinks::uniform([positive(), positive()], [positive(), positive()]);
        let rod = |k: usize, parent, x: f64| {
            let (m, i, c) = (links.mass_kg[k], links.inertia_kg_m2[k], links.com_m[k]);
            LinkSpec {
                parent,
                x_parent_joint: Placement { translation: [x, 0.0, 0.0], ..Placement::IDENTITY },
                joint: LinkJoint::Moving { kind: JointKind::Revolute, axis: [0.0, -1.0, 0.0], damping: 0.0 },
                inertia: inertia_about_frame(m, [c, 0.0, 0.0], [0.0, 0.0, i, 0.0, 0.0, i]),
            }
        };
        let specs = [rod(0, None, 0.0), rod(1, Some(0), links.length_m[0])];
        let assembled = Tree::assemble(&specs, [0.0, 0.0, -links.gravity_m_s2]).unwrap();
        let case = Case::new(&mut random, 2);
        let (tree, _) = products(&assembled.tree, &case, &assembled.theta);
        let (closed, _) = products(&PlanarArm, &case, &links.theta());
        prop_assert!(error(&tree, &closed) < TOLERANCE);

        // With what acts at the joints: the same products, losses, accelerations and inertia.
        let drives = random_drives(&mut random, 2);
        let own = driving(&mut random, &drives);
        let with = |mut theta: Vec<f64>| { theta.extend(&own); theta };
        let tree = assembled.tree.with_drives(drives.clone()).unwrap();
        let (tree_theta, theta) = (with(assembled.theta), with(links.theta().to_vec()));
        let arm = Driven::new(PlanarArm, drives).unwrap();
        let [of_tree, closed] = [described(&tree, &case, &tree_theta), described(&arm, &case, &theta)];
        for (k, (one, other)) in of_tree.iter().zip(&closed).enumerate() {
            prop_assert!(error(one, other) < 1e-9, "{}: {:?} {:?}", k, one, other);
        }
        let (_, yt_s) = products(&tree, &case, &tree_theta);
        let (_, other) = products(&arm, &case, &theta);
        prop_assert!(error(&yt_s[20..], &other[5..]) < TOLERANCE);
    }

    #[test]
    fn prop_robots_in_closed_form_with_drives_are_lagrangian(seed in any::<u64>(), dimension in 1_usize..18) {
        let mut random = Random::new(seed);
        let case = Case::new(&mut random, dimension);
        let drives = random_drives(&mut random, dimension);
        let own = driving(&mut random, &drives);
        let mass = Driven::new(PointMass { dimension }, drives).unwrap();
        let mut theta = vec![1.5 + random.number()];
        theta.extend(&own);
        consistent(&mass, &case, &theta);
        invertible(&mass, &case, &theta);
        consistent(&mass, &case, &random.column(theta.len(), 3.0));
        let scale = Lagrangian::<f64>::adaptation_scale(&mass, &case.q, &theta);
        prop_assert!(scale.len() == theta.len() && scale.iter().all(|scale| *scale > 0.0), "{:?}", scale);

        // M of an arm and of a ship is no diagonal.
        let case = Case::new(&mut random, 2);
        let drives = Drives { geared: vec![1], dry_s: None, ..random_drives(&mut random, 2) };
        let mut theta = PlanarLinks::uniform([2.0, 1.5], [1.0, 0.8]).theta().to_vec();
        theta.extend(driving(&mut random, &drives));
        let arm = Driven::new(PlanarArm, drives).unwrap();
        consistent(&arm, &case, &theta);
        invertible(&arm, &case, &theta);
        let case = Case::new(&mut random, 3);
        let drives = Drives { geared: vec![0, 2], dry_s: None, ..random_drives(&mut random, 3) };
        let mut theta = vec![2.0, 3.0, 0.7, 1.5, 0.3, 0.9, 0.2, -0.4, 0.8];
        theta.extend(driving(&mut random, &drives));
        invertible(&Driven::new(Ship, drives).unwrap(), &case, &theta);
    }
}

/// Drives of some joints; friction is smooth.
fn random_drives(random: &mut Random, joints: usize) -> Drives {
    let mut some = || (0..joints).filter(|_| random.chance(0.6)).collect::<Vec<usize>>();
    let [damped, geared, rubbing] = [some(), some(), some()];
    let friction = rubbing.into_iter().map(|joint| Friction { joint, width: 0.3 + 0.1 * joint as f64 }).collect();
    Drives { damped, geared, friction, dry_s: None }
}

/// Parameters of drives.
fn driving(random: &mut Random, drives: &Drives) -> Vec<f64> {
    (0..drives.count()).map(|_| 1.0 + 0.9 * random.number()).collect()
}

/// Yϑ, what is lost, q̈, M and g.
fn described<R: Lagrangian<f64>>(robot: &R, case: &Case, theta: &[f64]) -> [Vec<f64>; 5] {
    let (n, mut scratch) = (robot.dof(), robot.scratch());
    let [mut lost, mut ddq, mut g] = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
    let mut mass = vec![0.0; n * n];
    robot.add_damping(&mut scratch, case.motion(), theta, &mut lost).unwrap();
    robot.forward_dynamics(&mut scratch, &case.q, &case.dq, theta, &case.s, &mut ddq).unwrap();
    robot.mass_matrix(&mut scratch, &case.q, theta, &mut mass).unwrap();
    robot.gravity(&mut scratch, &case.q, theta, &mut g).unwrap();
    [products(robot, case, theta).0, lost, ddq, mass, g]
}

#[test]
fn prop_planar_tip_has_the_same_power_as_the_joints_and_moves_as_it_says() {
    let tip = PlanarTip { length_m: [1.1, 0.7] };
    let mut random = Random::new(8);
    for _ in 0..50 {
        let pair = |v: Vec<f64>| [v[0], v[1]];
        let (q, dq, force) = (pair(random.column(2, 3.0)), pair(random.column(2, 2.0)), pair(random.column(2, 9.0)));
        let moment = random.number();
        let tau = tip.torques(q, force, moment);
        let (position, velocity) = tip.motion(q, dq);
        let power = force[0] * velocity[0] + force[1] * velocity[1] + moment * (dq[0] + dq[1]);
        assert!((tau[0] * dq[0] + tau[1] * dq[1] - power).abs() < 1e-13 * power.abs().max(1.0));
        let h = 1e-6;
        let later = tip.motion([q[0] + h * dq[0], q[1] + h * dq[1]], dq).0;
        for k in 0..2 {
            assert!(((later[k] - position[k]) / h - velocity[k]).abs() < 1e-4);
        }
    }
}
