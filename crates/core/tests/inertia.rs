//! Property 1: bounds of M(q) that hold at every q.

use crate::common::models;
use crate::common::random::Random;
use forwardstep_core::expression::Interval;
use forwardstep_core::robot::tree::{
    Anchor, Assembled, Follows, JointKind, LinkJoint, LinkPoint, LinkSpec, Placement, Tree, TreeTip, Uncertain,
    inertia_about_frame,
};
use forwardstep_core::robot::{
    Definiteness, Drives, InertiaBound, Lagrangian, PlanarArm, PlanarLinks, PointMass, Ship, TipKinematics,
};
use forwardstep_core::{Gain, ResolvedGain, Scalar};
use proptest::prelude::*;

/// As many as a verdict allows.
const PIECES: usize = 4096;
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// Whether A − λ B is positive definite, by Cholesky's factor.
fn exceeds(n: usize, a: &[f64], lambda: f64, b: &[f64]) -> bool {
    let mut l = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..=i {
            let mut sum = a[i * n + j] - lambda * b[i * n + j];
            for k in 0..j {
                sum -= l[i * n + k] * l[j * n + k];
            }
            if i == j && sum <= 0.0 {
                return false;
            }
            l[i * n + j] = if i == j { sum.sqrt() } else { sum / l[j * n + j] };
        }
    }
    true
}

/// The smallest λ with det(A − λ B) = 0.
fn least(n: usize, a: &[f64], b: &[f64]) -> f64 {
    let (mut low, mut high) = (0.0, 1e6);
    for _ in 0..120 {
        let middle = 0.5 * (low + high);
        *(if exceeds(n, a, middle, b) { &mut low } else { &mut high }) = middle;
    }
    low
}

fn identity(n: usize) -> Vec<f64> {
    (0..n * n).map(|k| if k % (n + 1) == 0 { 1.0 } else { 0.0 }).collect()
}

fn mass<R: Lagrangian<f64>>(robot: &R, q: &[f64], theta: &[f64]) -> Vec<f64> {
    let mut m = vec![0.0; q.len() * q.len()];
    robot.mass_matrix(&mut robot.scratch(), q, theta, &mut m).unwrap();
    m
}

/// A random positive definite gain, as a matrix and resolved.
fn gain(random: &mut Random, n: usize) -> (Vec<f64>, ResolvedGain) {
    let a = random.column(n * n, 2.0);
    let entry = |i: usize, j: usize| (0..n).map(|k| a[i * n + k] * a[j * n + k]).sum::<f64>();
    let k: Vec<f64> = (0..n * n)
        .map(|at| entry(at / n, at % n).min(entry(at % n, at / n)) + if at % (n + 1) == 0 { 0.5 } else { 0.0 })
        .collect();
    let resolved = Gain::Matrix(k.clone()).resolve(n, &[]).unwrap();
    (k, resolved)
}

/// How much smaller the bound is than the smallest eigenvalue at any of `samples` postures, and the rate of any gain.
fn sharpness<R: Lagrangian<f64>>(robot: &R, theta: &[f64], bound: &InertiaBound, samples: usize, seed: u64) -> f64 {
    let (n, mut random) = (robot.dof(), Random::new(seed));
    let (k, resolved) = gain(&mut random, n);
    let fastest = bound.fastest(&resolved, 0.0).unwrap().unwrap();
    let mut seen = f64::INFINITY;
    for _ in 0..samples {
        let m = mass(robot, &random.column(n, 4.0), theta);
        let own = least(n, &m, &identity(n));
        assert!(bound.least() <= own * (1.0 + 1e-9), "{} exceeds {own}", bound.least());
        let slowest = least(n, &m, &k);
        assert!(fastest * slowest >= 1.0 - 1e-9, "{fastest} of at most {}", 1.0 / slowest);
        seen = seen.min(own);
    }
    bound.least() / seen
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn prop_the_bound_of_a_random_tree_holds_at_every_posture(seed in any::<u64>(), joints in 1_usize..8) {
        let mut random = Random::new(seed);
        let assembled = Tree::assemble(&random.links(joints), GRAVITY).unwrap();
        let bound = assembled.tree.inertia_bound(&assembled.theta).unwrap().unwrap();
        let ratio = sharpness(&assembled.tree, &assembled.theta, &bound, 60, seed);
        prop_assert!(ratio > 0.02, "{ratio}");
    }

    /// Bodies without mass and inertia behind some of the rotors.
    #[test]
    fn prop_the_bound_of_a_tree_with_rotors_holds_at_every_posture(seed in any::<u64>(), joints in 1_usize..8) {
        let mut random = Random::new(seed);
        let mut links = random.links(joints);
        let geared: Vec<usize> = (0..joints).filter(|_| random.chance(0.7)).collect();
        let hollow = |random: &mut Random| random.chance(0.4);
        for (joint, link) in links.iter_mut().enumerate() {
            if geared.contains(&joint) && hollow(&mut random) {
                link.inertia = [0.0; 10];
            }
        }
        let armatures: Vec<f64> = geared.iter().map(|_| 0.01 + 2.0 * random.number().abs()).collect();
        let Assembled { tree, theta, .. } = Tree::assemble(&links, GRAVITY).unwrap();
        let without = tree.inertia_bound(&theta).unwrap();
        let all_geared = geared.len() == joints;
        let drives = Drives { geared, ..tree.drives().clone() };
        let (bodies, tree) = (theta.clone(), tree.with_drives(drives).unwrap());
        let theta = [theta, armatures.clone()].concat();
        let with = tree.inertia_bound(&theta).unwrap();
        prop_assert!(with.is_some() || (without.is_none() && !all_geared));
        if let Some(bound) = &with {
            let ratio = sharpness(&tree, &theta, bound, 60, seed);
            prop_assert!(ratio > 0.01, "{ratio}");
            let hollow = bodies.chunks(10).any(|body| body.iter().all(|entry| *entry == 0.0));
            prop_assert!(hollow || bound.least() >= 0.999 * without.map_or(0.0, |bound| bound.least()));
        }
    }

    #[test]
    fn prop_kernels_on_intervals_hold_what_they_compute_of_numbers(seed in any::<u64>(), joints in 1_usize..7, room in 0.0..0.5) {
        let mut random = Random::new(seed);
        let assembled = random.tree(joints);
        let (tree, theta) = (&assembled.tree, &assembled.theta);
        let middle = random.column(joints, 4.0);
        let wide: Vec<Interval> = middle.iter().map(|q| Interval::point(*q).with_room(room)).collect();
        let fixed: Vec<Interval> = theta.iter().map(|entry| Interval::point(*entry)).collect();
        let mut held = vec![Interval::point(0.0); joints * joints];
        tree.mass_matrix(&mut Lagrangian::<Interval>::scratch(tree), &wide, &fixed, &mut held).unwrap();
        for _ in 0..20 {
            let q: Vec<f64> = middle.iter().map(|q| q + room * random.number()).collect();
            for (held, entry) in held.iter().zip(mass(tree, &q, theta)) {
                // What is enclosed is the real entry, and this one is rounded.
                prop_assert!(held.with_room(1e-13 * (1.0 + entry.abs())).holds(entry), "{held:?} without {entry}");
            }
        }
        // Nothing is known of an angle that may be anything.
        prop_assert_eq!(Interval::WHOLE.sin_cos().0, Interval { low: -1.0, high: 1.0 });
    }

    #[test]
    fn prop_extensions_change_the_dynamics_exactly_where_a_joint_is_swung(seed in any::<u64>(), joints in 1_usize..6) {
        let mut random = Random::new(seed);
        let mut links = random.links(joints);
        // Directions that random ones do not have: all joints along one axis, in frames that are turned about it.
        if random.chance(0.5) {
            for link in &mut links {
                let turn = [0.0, 0.0, 3.0 * random.number()];
                link.x_parent_joint = Placement::from_xyz_rpy(link.x_parent_joint.translation, turn);
                if let LinkJoint::Moving { axis, .. } = &mut link.joint {
                    *axis = if random.chance(0.8) { Z } else { X };
                }
            }
        }
        let Assembled { tree, theta, .. } = Tree::assemble(&links, random.vector(9.81)).unwrap();
        let swung = tree.swung_joints();
        let q = random.column(joints, 3.0);
        let dynamics = |q: &[f64]| {
            let (mut scratch, mut g) = (Lagrangian::<f64>::scratch(&tree), vec![0.0; joints]);
            tree.gravity(&mut scratch, q, &theta, &mut g).unwrap();
            [mass(&tree, q, &theta), g].concat()
        };
        let before = dynamics(&q);
        for (joint, kind) in tree.joint_kinds().enumerate() {
            let mut far = q.clone();
            far[joint] += 10.0;
            let after = dynamics(&far);
            let change = before.iter().zip(&after).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            if kind == JointKind::Prismatic {
                prop_assert_eq!(change > 1e-9, swung.contains(&joint), "joint {} of {:?}: {}", joint, &swung, change);
            } else {
                prop_assert!(!swung.contains(&joint));
            }
        }
    }

    #[test]
    fn prop_no_tip_is_farther_than_its_reach(seed in any::<u64>(), joints in 2_usize..4) {
        let mut random = Random::new(seed);
        let mut links = random.links(joints);
        for (index, link) in links.iter_mut().enumerate() {
            link.parent = index.checked_sub(1);
            if let LinkJoint::Moving { kind, .. } = &mut link.joint {
                *kind = JointKind::Revolute;
            }
        }
        let tree = Tree::assemble(&links, GRAVITY).unwrap().tree;
        let point = LinkPoint { link: Anchor { body: Some(joints - 1), x_body_link: Placement::IDENTITY }, at: random.vector(0.5) };
        let coordinates: Vec<usize> = (0..joints).collect();
        let tip = TreeTip::new(tree, &point, &coordinates, Follows::Position, Uncertain::Tool).unwrap();
        let (first, [least, most]) = tip.reach().unwrap();
        for _ in 0..30 {
            let mut x = vec![0.0; joints];
            tip.position(&random.column(joints, 4.0), &tip.parameters(), &mut x).unwrap();
            let squares = x.iter().zip(first).map(|(x, first)| (x - first) * (x - first));
            let distance = squares.sum::<f64>().sqrt();
            prop_assert!(least <= distance && distance <= most);
        }
        if let LinkJoint::Moving { kind, .. } = &mut links[1].joint {
            *kind = JointKind::Prismatic;
        }
        let tree = Tree::assemble(&links, GRAVITY).unwrap().tree;
        prop_assert_eq!(TreeTip::new(tree, &point, &coordinates, Follows::Position, Uncertain::Tool).unwrap().reach(), None);
    }

    #[test]
    fn prop_the_bound_of_a_planar_arm_is_attained(seed in any::<u64>()) {
        let mut random = Random::new(seed);
        let mut positive = || 1.1 + random.number();
        let links = PlanarLinks {
            mass_kg: [positive(), positive()],
            length_m: [positive(), positive()],
            com_m: [positive(), positive()],
            inertia_kg_m2: [positive(), positive()],
            gravity_m_s2: 9.81,
        };
        let theta = links.theta();
        let bound = PlanarArm.inertia_bound(&theta).unwrap().unwrap();
        sharpness(&PlanarArm, &theta, &bound, 100, seed);
        let ends = [0.0, std::f64::consts::PI].map(|q2| least(2, &mass(&PlanarArm, &[0.3, q2], &theta), &identity(2)));
        let worst = ends[0].min(ends[1]);
        prop_assert!((bound.least() / worst - 1.0).abs() < 1e-5, "{} of {worst}", bound.least());
    }

    #[test]
    fn prop_the_bound_of_a_ship_is_attained(seed in any::<u64>()) {
        let mut random = Random::new(seed);
        let mut theta = random.column(9, 1.0).iter().map(|entry| 1.5 + entry).collect::<Vec<_>>();
        theta[2] = 0.9 * random.number() * (theta[1] * theta[3]).sqrt();
        let bound = Ship.inertia_bound(&theta).unwrap().unwrap();
        let ratio = sharpness(&Ship, &theta, &bound, 50, seed);
        prop_assert!(ratio > 1.0 - 1e-5, "{ratio}");
    }
}

/// The sharpness of the bound of every model that Pinocchio has computed, at thousands of postures.
#[test]
fn val_pinocchio_the_bounds_of_its_models_hold() {
    let mut ratios = Vec::new();
    for model in models() {
        let assembled = model.assemble();
        let bound = assembled.tree.inertia_bound(&model.theta).unwrap();
        let Some(bound) = bound else { panic!("{}", model.name) };
        for state in &model.states {
            let own = least(state.q.len(), &state.mass_matrix, &identity(state.q.len()));
            assert!(bound.least() <= own, "{}: {} exceeds {own}", model.name, bound.least());
        }
        let samples = if model.states[0].q.len() > 10 { 100 } else { 3000 };
        let ratio = sharpness(&assembled.tree, &model.theta, &bound, samples, 7);
        ratios.push((model.name, ratio));
    }
    let of = |name: &str| ratios.iter().find(|(model, _)| model == name).unwrap().1;
    assert!(of("ur5e-like") > 0.95 && of("panda-like") > 0.25, "{ratios:?}");
    assert!(ratios.iter().all(|(_, ratio)| *ratio > 0.1), "{ratios:?}");
}

/// A body on a joint at `at` of its parent, in whose frame its inertia is stated.
fn link(parent: Option<usize>, at: [f64; 3], kind: JointKind, axis: [f64; 3], inertia: [f64; 10]) -> LinkSpec {
    let x_parent_joint = Placement { translation: at, ..Placement::IDENTITY };
    LinkSpec { parent, x_parent_joint, joint: LinkJoint::Moving { kind, axis, damping: 0.0 }, inertia }
}

const Z: [f64; 3] = [0.0, 0.0, 1.0];
const X: [f64; 3] = [1.0, 0.0, 0.0];

/// A rod of length one along x, 2 kg, as thin as a line.
fn rod() -> [f64; 10] {
    inertia_about_frame(2.0, [0.5, 0.0, 0.0], [0.0, 0.0, 1.0 / 6.0, 0.0, 0.0, 1.0 / 6.0])
}

/// 1.5 kg in one point, one metre from its joint.
fn at_the_end() -> [f64; 10] {
    inertia_about_frame(1.5, X, [0.0; 6])
}

fn definiteness(links: &[LinkSpec]) -> (Tree, Vec<f64>, Definiteness) {
    let assembled = Tree::assemble(links, GRAVITY).unwrap();
    let found = assembled.tree.definiteness(&assembled.theta, PIECES).unwrap();
    (assembled.tree, assembled.theta, found)
}

#[test]
fn thin_rods_in_a_plane_have_a_bound_without_cutting() {
    use JointKind::Revolute;
    let links = [link(None, [0.0; 3], Revolute, Z, rod()), link(Some(0), X, Revolute, Z, rod())];
    let (tree, theta, _) = definiteness(&links);
    let bound = tree.inertia_bound(&theta).unwrap().unwrap();
    let ratio = sharpness(&tree, &theta, &bound, 500, 3);
    assert!(ratio > 0.3, "{ratio}");
    // Off the plane the rod turns about its own line, where it has no inertia; M is definite but for some postures.
    let skew = [link(None, [0.0; 3], Revolute, Z, rod()), link(Some(0), X, Revolute, [0.0, 0.6, 0.8], rod())];
    let assembled = Tree::assemble(&skew, GRAVITY).unwrap();
    assert_eq!(assembled.tree.inertia_bound(&assembled.theta).unwrap(), None);
}

#[test]
fn point_masses_have_a_bound_by_cutting_full_turns() {
    use JointKind::Revolute;
    let links = [link(None, [0.0; 3], Revolute, Z, at_the_end()), link(Some(0), X, Revolute, Z, at_the_end())];
    let (tree, theta, found) = definiteness(&links);
    assert_eq!(tree.inertia_bound(&theta).unwrap(), None);
    let Definiteness::Uniform(bound) = found else { panic!("{found:?}") };
    let ratio = sharpness(&tree, &theta, &bound, 500, 3);
    assert!((0.2..=0.26).contains(&ratio), "{ratio}");
    // With no budget there is no answer.
    assert!(matches!(tree.definiteness(&theta, 1).unwrap(), Definiteness::Unknown { .. }));
}

#[test]
fn a_link_without_mass_is_found_with_a_posture_and_a_direction() {
    use JointKind::{Prismatic, Revolute};
    let cases = [
        // The last link weighs nothing.
        vec![link(None, [0.0; 3], Revolute, Z, rod()), link(Some(0), X, Revolute, Z, [0.0; 10])],
        vec![link(None, [0.0; 3], Revolute, Z, rod()), link(Some(0), X, Prismatic, X, [0.0; 10])],
        // The first does, and when both are in line, and the mass in one point of that line, the elbow is free.
        vec![link(None, [0.0; 3], Revolute, Z, [0.0; 10]), link(Some(0), X, Revolute, Z, at_the_end())],
        // A moment that is negative by itself.
        vec![link(None, [0.0; 3], Revolute, Z, inertia_about_frame(1.0, [0.0; 3], [1.0, 0.0, 1.0, 0.0, 0.0, -0.1]))],
    ];
    for links in cases {
        let (tree, theta, found) = definiteness(&links);
        let Definiteness::Not { q, direction } = found else { panic!("{found:?}") };
        let m = mass(&tree, &q, &theta);
        let n = q.len();
        let energy: f64 = (0..n * n).map(|at| direction[at / n] * m[at] * direction[at % n]).sum();
        assert!(
            energy <= 1e-15 && direction.iter().any(|entry| entry.abs() >= 1.0),
            "{energy} by {direction:?} at {q:?}"
        );
    }
}

#[test]
fn what_is_neither_shown_nor_refuted_is_not_known() {
    use JointKind::{Prismatic, Revolute};
    // A point mass slides through the axis that turns it: M is singular there, at no posture that is looked at.
    let links = [
        link(None, [0.0; 3], Revolute, Z, [0.0; 10]),
        link(Some(0), [0.37, 0.0, 0.0], Prismatic, X, inertia_about_frame(1.5, [0.0; 3], [0.0; 6])),
    ];
    let (tree, theta, found) = definiteness(&links);
    let Definiteness::Unknown { q, least: shown } = found else { panic!("{found:?}") };
    assert!(shown > 0.0 && shown <= least(2, &mass(&tree, &q, &theta), &identity(2)), "{shown} at {q:?}");
    // With a moment of its own about that axis the carrier makes M definite, however far the mass slides.
    let heavy = link(None, [0.0; 3], Revolute, Z, inertia_about_frame(1.0, [0.0; 3], [0.1, 0.0, 0.1, 0.0, 0.0, 0.1]));
    let (tree, theta, found) = definiteness(&[heavy, links[1]]);
    let Definiteness::Uniform(bound) = found else { panic!("{found:?}") };
    assert!(bound.least() <= 0.1 && bound.least() > 0.09, "{}", bound.least());
    sharpness(&tree, &theta, &bound, 500, 3);
    for far in [-1e9, -0.37, 1e3] {
        let own = least(2, &mass(&tree, &[0.1, far], &theta), &identity(2));
        assert!(bound.least() <= own);
    }
}

#[test]
fn degenerate_parameters_have_no_bound() {
    assert_eq!(PlanarArm.inertia_bound(&[1.0, 1.0, 0.0, 0.0, 0.0]).unwrap(), None);
    assert_eq!(
        PlanarArm.inertia_bound(&[3.0, 1.0, 1.5, 0.0, 0.0]).unwrap(),
        None,
        "indefinite where the arm is stretched"
    );
    assert_eq!(PointMass { dimension: 3 }.inertia_bound(&[0.0]).unwrap(), None);
    assert_eq!(Ship.inertia_bound(&[1.0, 2.0, 2.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0]).unwrap(), None);
    assert!(PlanarArm.inertia_bound(&[1.0]).is_err() && Ship.inertia_bound(&[]).is_err());
    let not = |found: Definiteness| matches!(found, Definiteness::Not { q, direction } if q.len() == direction.len());
    assert!(not(PlanarArm.definiteness(&[1.0, 1.0, 0.0, 0.0, 0.0]).unwrap()));
    assert!(not(PlanarArm.definiteness(&[3.0, 1.0, 1.5, 0.0, 0.0]).unwrap()));
    assert!(not(PointMass { dimension: 3 }.definiteness(&[0.0]).unwrap()));
    assert!(not(Ship.definiteness(&[1.0, 2.0, 2.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0]).unwrap()));
    assert!(matches!(PointMass { dimension: 3 }.definiteness(&[2.0]).unwrap(), Definiteness::Uniform(_)));
    let bound = PointMass { dimension: 3 }.inertia_bound(&[2.0]).unwrap().unwrap();
    assert_eq!(bound.least(), 2.0);
    let gain = Gain::Diagonal(vec![1.0, 3.0, 2.0]).resolve(3, &[]).unwrap();
    let fastest = bound.fastest(&gain, 0.0).unwrap().unwrap();
    assert!((1.5..1.500_01).contains(&fastest), "{fastest}");
    assert_eq!(bound.fastest(&gain, 1.6).unwrap(), Some(1.6), "a bound that is given already");
    assert!((1.5..1.500_01).contains(&bound.fastest(&gain, 1.4).unwrap().unwrap()), "what is given is no bound");
    assert!(bound.fastest(&Gain::Number(1.0).resolve(2, &[]).unwrap(), 0.0).is_err());
}

/// The tree with an armature on each of `geared`, and what is known of it.
fn with_rotors(links: &[LinkSpec], geared: &[(usize, f64)]) -> Definiteness {
    let Assembled { tree, theta, .. } = Tree::assemble(links, GRAVITY).unwrap();
    let (joints, armatures): (Vec<usize>, Vec<f64>) = geared.iter().copied().unzip();
    let drives = Drives { geared: joints, ..tree.drives().clone() };
    tree.with_drives(drives).unwrap().definiteness(&[theta, armatures].concat(), PIECES).unwrap()
}

#[test]
fn rotors_are_inertia_enough_unless_a_body_takes_more_than_they_give() {
    use JointKind::{Prismatic, Revolute};
    let least = |found: &Definiteness| match found {
        Definiteness::Uniform(bound) => bound.least(),
        Definiteness::Not { .. } | Definiteness::Unknown { .. } => 0.0,
    };
    let hollow = |parent, kind| link(parent, X, kind, Z, [0.0; 10]);
    let chain: Vec<LinkSpec> = (0..6_usize).map(|k| hollow(k.checked_sub(1), Revolute)).collect();
    let all: Vec<(usize, f64)> = (0..6).map(|k| (k, 0.1 + k as f64)).collect();
    assert!((least(&with_rotors(&chain, &all)) - 0.1).abs() < 1e-5);
    assert!(matches!(with_rotors(&chain, &all[1..]), Definiteness::Not { .. }));
    assert!((least(&with_rotors(&[hollow(None, Prismatic)], &[(0, 3.0)])) - 3.0).abs() < 1e-5);
    // Of a body with enough of its own, a rotor that gives less is not needed.
    let body = |moment: f64| inertia_about_frame(5.0, [0.0; 3], [moment, 0.0, moment, 0.0, 0.0, moment]);
    let heavy = [link(None, [0.0; 3], Revolute, Z, body(2.0))];
    assert!((least(&with_rotors(&heavy, &[(0, 0.5)])) - 2.0).abs() < 1e-5);
    assert!((least(&with_rotors(&heavy, &[(0, 8.0)])) - 8.0).abs() < 1e-5);
    // Moments that no body has.
    let negative = [0.0, 0.0, 0.0, 0.0, -0.5, 0.0, -0.5, 0.0, 0.0, -0.5];
    let first = link(None, [0.0; 3], Revolute, Z, negative);
    assert!(matches!(with_rotors(&[first], &[(0, 0.3)]), Definiteness::Not { .. }));
    for inertia in [negative, [0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.5, 0.0, 0.0, -0.5]] {
        let carried = [link(None, [0.0; 3], Revolute, X, body(2.0)), link(Some(0), X, Revolute, Z, inertia)];
        assert!(matches!(with_rotors(&carried, &[(1, 0.3)]), Definiteness::Not { .. }), "{inertia:?}");
    }
}

#[test]
fn moments_count_where_nothing_couples_them_and_for_all_that_turns_together() {
    use JointKind::{Prismatic, Revolute};
    // A rod that leans between x and z may turn about its own line, which has a part along z, without energy.
    let leaning = inertia_about_frame(2.0, [0.0; 3], [0.1, 0.0, 0.2, -0.1, 0.0, 0.1]);
    let links = [link(None, [0.0; 3], Revolute, Z, rod()), link(Some(0), X, Revolute, Z, leaning)];
    let assembled = Tree::assemble(&links, GRAVITY).unwrap();
    assert_eq!(assembled.tree.inertia_bound(&assembled.theta).unwrap(), None);
    // What slides adds its moment to that of its carrier: without it the bound would be 0.1.
    let body = |moment: f64| inertia_about_frame(5.0, [0.0; 3], [moment, 0.0, moment, 0.0, 0.0, moment]);
    let links = [link(None, [0.0; 3], Revolute, Z, body(0.1)), link(Some(0), [0.0; 3], Prismatic, Z, body(0.9))];
    let (_, _, found) = definiteness(&links);
    let Definiteness::Uniform(bound) = found else { panic!("{found:?}") };
    assert!((bound.least() - 1.0).abs() < 1e-5, "{}", bound.least());
}
