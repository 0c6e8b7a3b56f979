//! (71)–(82): the tip of an arm with uncertain lengths, without its velocity.

mod lengths;
mod measured;

use crate::common::looped::{Looped, polynomial};
use crate::common::random::{Random, inertia_of};
use forwardstep_core::attitude::{dot, product, rotate};
use forwardstep_core::controller::{Controller, Jet, NullSpace, Singularity, TaskSpace};
use forwardstep_core::law::ParameterBounds;
use forwardstep_core::law::SlotineLi;
use forwardstep_core::plant::{Mechanical, TaskArm};
use forwardstep_core::robot::tree::{
    Assembled, Follows, JointKind, LinkJoint, LinkPoint, LinkSpec, Placement, TipError, Tree, TreeTip, Uncertain,
};
use forwardstep_core::robot::{Lagrangian, PlanarArm, PlanarLinks, PlanarTip, Posture, TipKinematics};
use forwardstep_core::signal::Signal;
use forwardstep_core::{Gain, ResolvedGain};

fn gain(random: &mut Random, n: usize) -> ResolvedGain {
    let factor = random.column(n * n, 1.0);
    let mut entries = vec![0.0; n * n];
    for row in 0..n {
        for column in 0..n {
            entries[n * row + column] = (0..n).map(|k| factor[n * row + k] * factor[n * column + k]).sum();
        }
        entries[(n + 1) * row] += 0.5;
    }
    Gain::Matrix(entries).resolve(n, &[]).unwrap()
}

/// One chain of three joints, some of them slides, with a tool.
fn chain(random: &mut Random, slides: bool) -> (Assembled, LinkPoint) {
    chain_of(3, random, slides)
}

/// One chain of joints, some of them slides, with a tool.
fn chain_of(joints: usize, random: &mut Random, slides: bool) -> (Assembled, LinkPoint) {
    let mut links: Vec<LinkSpec> = Vec::new();
    for link in 0..joints {
        let kind = if slides && random.chance(0.4) { JointKind::Prismatic } else { JointKind::Revolute };
        let axis = loop {
            let axis = if random.chance(0.5) { [0.0, -1.0, 0.0] } else { random.vector(1.0) };
            let norm = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
            if norm > 0.3 {
                break axis.map(|x| x / norm);
            }
        };
        links.push(LinkSpec {
            parent: link.checked_sub(1),
            x_parent_joint: random.placement(),
            joint: LinkJoint::Moving { kind, axis, damping: if link == 1 { 0.7 } else { 0.0 } },
            inertia: inertia_of(&random.cloud()),
        });
    }
    let assembled = Tree::assemble(&links, random.vector(9.81)).unwrap();
    let point = LinkPoint { link: assembled.anchors[joints - 1], at: random.vector(0.5) };
    (assembled, point)
}

fn tip(assembled: &Assembled, point: &LinkPoint, uncertain: Uncertain) -> TreeTip {
    TreeTip::new(assembled.tree.clone(), point, &[0, 1, 2], Follows::Position, uncertain).unwrap()
}

/// J and dJ/dt.
fn jacobian(tip: &impl TipKinematics, q: &[f64], dq: &[f64], theta: &[f64], d_theta: &[f64]) -> [Vec<f64>; 2] {
    let size = tip.rows() * tip.joints();
    let (mut j, mut dj) = (vec![0.0; size], vec![0.0; size]);
    tip.jacobian(Posture { q, dq, theta, d_theta }, &mut j, &mut dj).unwrap();
    [j, dj]
}

fn along(x: &[f64], dx: &[f64], h: f64) -> Vec<f64> {
    x.iter().zip(dx).map(|(x, dx)| x + h * dx).collect()
}

/// (72), (74) and the rate of Ĵ for any tip, against differences and against each other.
fn check_kinematics(tip: &impl TipKinematics, random: &mut Random) {
    let (n, m, p, h) = (tip.joints(), tip.axes(), tip.parameter_count(), 1e-5);
    let rows = tip.rows();
    assert_eq!(tip.parameter_names().len(), p);
    let [q, dq, xi] = [1.5, 1.0, 1.0].map(|scale| random.column(n, scale));
    let v = random.column(rows, 1.0);
    let [theta, d_theta] = [1.0, 1.0].map(|scale| random.column(p, scale));
    let [j, dj] = jacobian(tip, &q, &dq, &theta, &d_theta);

    // ẋ = J q̇
    let position = |q: &[f64]| {
        let mut x = vec![0.0; m];
        tip.position(q, &theta, &mut x).unwrap();
        x
    };
    let velocity = |row: usize| -> f64 { (0..n).map(|c| j[row * n + c] * dq[c]).sum() };
    let (near, far) = (position(&along(&q, &dq, h)), position(&along(&q, &dq, -h)));
    for row in 0..m {
        assert!((velocity(row) - (near[row] - far[row]) / (2.0 * h)).abs() < 1e-8);
    }
    // ω = 2 vec(dq/dt q⁻¹) of the quaternion, in coordinates of the base.
    if let (true, Some(now)) = (tip.turns(), tip.attitude(&q)) {
        let [near, far] = [h, -h].map(|h| tip.attitude(&along(&q, &dq, h)).unwrap());
        let rate = core::array::from_fn(|k| (near[k] - far[k]) / (2.0 * h));
        let turn = product(rate, [-now[0], -now[1], -now[2], now[3]]);
        for k in 0..3 {
            assert!((2.0 * turn[k] - velocity(m + k)).abs() < 1e-8);
        }
    }
    // vᵀJξ = (Zᵀv)ᵀθ + vᵀJ(0)ξ
    let known = jacobian(tip, &q, &dq, &vec![0.0; p], &vec![0.0; p]);
    let mut zt_v = vec![0.0; p];
    tip.regressor_transposed(&q, &xi, &v, &mut zt_v).unwrap();
    let paired = |j: &[f64]| -> f64 { (0..rows * n).map(|at| v[at / n] * j[at] * xi[at % n]).sum() };
    let linear: f64 = zt_v.iter().zip(&theta).map(|(z, theta)| z * theta).sum();
    assert!((paired(&j) - linear - paired(&known[0])).abs() < 1e-13 * (1.0 + paired(&j).abs()));
    // dĴ/dt with θ̂ moving.
    let still = vec![0.0; p];
    let at = |h: f64| jacobian(tip, &along(&q, &dq, h), &dq, &along(&theta, &d_theta, h), &still);
    let ([near, _], [far, _]) = (at(h), at(-h));
    for k in 0..rows * n {
        assert!((dj[k] - (near[k] - far[k]) / (2.0 * h)).abs() < 1e-8, "entry {k}");
    }
}

/// A tip of six joints with its orientation.
fn posed(assembled: &Assembled, point: &LinkPoint, uncertain: Uncertain) -> TreeTip {
    TreeTip::new(assembled.tree.clone(), point, &[0, 1, 2], Follows::Pose, uncertain).unwrap()
}

#[test]
fn eq_74_rows_of_the_orientation_are_its_rate_and_hold_no_length() {
    let mut random = Random::new(11);
    for round in 0..40 {
        let (assembled, point) = chain_of(6, &mut random, round % 2 == 0);
        let uncertain = if round % 4 < 2 { Uncertain::Tool } else { Uncertain::Chain };
        let tip = posed(&assembled, &point, uncertain);
        check_kinematics(&tip, &mut random);
        let q = random.column(6, 3.0);
        // What turns the link takes its points where the tree has them.
        let attitude = tip.attitude(&q).unwrap();
        let place = |at: [f64; 3]| {
            let point = LinkPoint { link: point.link, at };
            let motion = assembled.tree.point_motion(&mut assembled.tree.scratch(), &q, &[0.0; 6], &point);
            motion.unwrap().position
        };
        let (origin, arm) = (place([0.0; 3]), random.vector(1.0));
        for ((there, origin), turned) in place(arm).iter().zip(origin).zip(rotate(attitude, arm)) {
            assert!((there - origin - turned).abs() < 1e-13);
        }
        assert!((dot(attitude, attitude) - 1.0).abs() < 1e-14);
        // A joint that turns once changes the sign, and nothing jumps on the way.
        let mut before = attitude;
        for step in 1..=100 {
            let turning: Vec<f64> = q.iter().map(|q| q + core::f64::consts::TAU * f64::from(step) / 100.0).collect();
            let now = tip.attitude(&turning).unwrap();
            assert!(dot(before, now) > 0.8, "{before:?} {now:?}");
            before = now;
        }
        let (near, far) = (jacobian(&tip, &q, &[0.0; 6], &tip.parameters(), &vec![0.0; tip.parameter_count()]), {
            let longer: Vec<f64> = tip.parameters().iter().map(|length| length + 0.3).collect();
            jacobian(&tip, &q, &[0.0; 6], &longer, &vec![0.0; tip.parameter_count()])
        });
        assert_eq!(near[0][18..], far[0][18..]);
    }
    let (assembled, point) = chain_of(7, &mut random, true);
    let redundant =
        TreeTip::new(assembled.tree, &point, &[2, 0], Follows::RedundantPosition, Uncertain::Chain).unwrap();
    check_kinematics(&redundant, &mut random);
}

#[test]
fn eq_74_and_eq_78_jacobians_are_linear_in_lengths_and_their_rates_hold_that_of_the_estimate() {
    let mut random = Random::new(1);
    for round in 0..40 {
        check_kinematics(&PlanarTip { length_m: [1.0, 0.8] }, &mut random);
        let (assembled, point) = chain(&mut random, round % 2 == 0);
        for uncertain in [Uncertain::Tool, Uncertain::Chain] {
            let tip = tip(&assembled, &point, uncertain);
            check_kinematics(&tip, &mut random);
            // With the θ of the model, the tip is where the tree has it.
            let q = random.column(3, 1.5);
            let mut x = [0.0; 3];
            tip.position(&q, &tip.parameters(), &mut x).unwrap();
            let motion = assembled.tree.point_motion(&mut assembled.tree.scratch(), &q, &[0.0; 3], &point).unwrap();
            assert!(x.iter().zip(motion.position).all(|(a, b)| (a - b).abs() < 1e-13), "{x:?} {motion:?}");
        }
        // Without slides and with all translations unknown, Property 4 stands as printed.
        if round % 2 == 1 {
            let tip = tip(&assembled, &point, Uncertain::Chain);
            let [j, _] = jacobian(&tip, &random.column(3, 1.0), &[0.0; 3], &[0.0; 9], &[0.0; 9]);
            assert_eq!(j, [0.0; 9]);
        }
    }
}

/// Two joints about −y in the plane of x and z, z up, as a tree.
fn planar_tree(links: &PlanarLinks) -> (Assembled, LinkPoint) {
    let rod = |k: usize| {
        let ([m, c], i) = ([links.mass_kg[k], links.com_m[k]], links.inertia_kg_m2[k]);
        let about_joint = i + m * c * c;
        [m, m * c, 0.0, 0.0, 0.0, 0.0, about_joint, 0.0, 0.0, about_joint]
    };
    let joint = LinkJoint::Moving { kind: JointKind::Revolute, axis: [0.0, -1.0, 0.0], damping: 0.0 };
    let outer = Placement { translation: [links.length_m[0], 0.0, 0.0], ..Placement::IDENTITY };
    let specs = [
        LinkSpec { parent: None, x_parent_joint: Placement::IDENTITY, joint, inertia: rod(0) },
        LinkSpec { parent: Some(0), x_parent_joint: outer, joint, inertia: rod(1) },
    ];
    let assembled = Tree::assemble(&specs, [0.0, 0.0, -9.81]).unwrap();
    let point = LinkPoint { link: assembled.anchors[1], at: [links.length_m[1], 0.0, 0.0] };
    (assembled, point)
}

#[test]
fn prop_planar_tip_is_the_tip_of_a_tree() {
    let links = PlanarLinks::uniform([2.0, 1.0], [1.0, 0.8]);
    let (assembled, point) = planar_tree(&links);
    let tree = TreeTip::new(assembled.tree, &point, &[0, 2], Follows::Position, Uncertain::Chain).unwrap();
    assert_eq!(tree.parameters(), [1.0, 0.0, 0.0, 0.8, 0.0, 0.0]);
    assert_eq!(tree.parameter_names()[0], "joint_2_x_m");
    assert_eq!(tree.parameter_names()[5], "tool_z_m");
    let planar = PlanarTip { length_m: links.length_m };
    let mut random = Random::new(2);
    for _ in 0..30 {
        let [q, dq, v, l, dl] = [2.0, 1.0, 1.0, 1.0, 1.0].map(|scale| random.column(2, scale));
        let spread = |l: &[f64]| [l[0], 0.0, 0.0, l[1], 0.0, 0.0];
        let ours = jacobian(&planar, &q, &dq, &l, &dl);
        let theirs = jacobian(&tree, &q, &dq, &spread(&l), &spread(&dl));
        for (ours, theirs) in ours.iter().flatten().zip(theirs.iter().flatten()) {
            assert!((ours - theirs).abs() < 1e-14);
        }
        let (mut ours, mut theirs) = ([0.0; 2], [0.0; 6]);
        planar.regressor_transposed(&q, &dq, &v, &mut ours).unwrap();
        tree.regressor_transposed(&q, &dq, &v, &mut theirs).unwrap();
        assert!((ours[0] - theirs[0]).abs() < 1e-14 && (ours[1] - theirs[3]).abs() < 1e-14);
        let (mut ours, mut theirs) = ([0.0; 2], [0.0; 2]);
        planar.position(&q, &l, &mut ours).unwrap();
        tree.position(&q, &spread(&l), &mut theirs).unwrap();
        assert!((ours[0] - theirs[0]).abs() < 1e-14 && (ours[1] - theirs[1]).abs() < 1e-14);
    }
}

#[test]
fn prop_a_jacobian_that_is_not_square_is_refused() {
    let mut random = Random::new(3);
    let (assembled, point) = chain(&mut random, false);
    let tree = || assembled.tree.clone();
    let refused = TreeTip::new(tree(), &point, &[0, 1], Follows::Position, Uncertain::Tool);
    assert_eq!(refused.err(), Some(TipError::Size { joints: 3, coordinates: 2 }));
    let refused = TreeTip::new(tree(), &point, &[0, 1, 1], Follows::Position, Uncertain::Tool);
    assert_eq!(refused.err(), Some(TipError::Coordinate { coordinate: 1 }));
    let refused = TreeTip::new(tree(), &point, &[0, 1, 3], Follows::Position, Uncertain::Tool);
    assert_eq!(refused.err(), Some(TipError::Coordinate { coordinate: 3 }));
    let of = |follows, coordinates: &[usize]| TreeTip::new(tree(), &point, coordinates, follows, Uncertain::Tool).err();
    let free = |coordinates| TipError::NotRedundant { joints: 3, coordinates };
    assert_eq!(of(Follows::RedundantPosition, &[0, 1, 2]), Some(free(3)));
    assert_eq!(of(Follows::RedundantPosition, &[]), Some(free(0)));
    assert_eq!(of(Follows::RedundantPosition, &[2, 0]), None);
    assert_eq!(of(Follows::Pose, &[0, 1, 2]), Some(TipError::PoseJoints { joints: 3 }));
    assert_eq!(of(Follows::Pose, &[0, 1]), Some(TipError::PoseCoordinates));
    assert_eq!(of(Follows::Pose, &[0, 2, 1]), Some(TipError::PoseCoordinates));
    let seven = chain_of(7, &mut random, false);
    let refused = TreeTip::new(seven.0.tree, &seven.1, &[0, 1, 2], Follows::Pose, Uncertain::Tool);
    assert_eq!(refused.err(), Some(TipError::PoseJoints { joints: 7 }));
    let many = chain_of(33, &mut random, false);
    let refused = TreeTip::new(many.0.tree, &many.1, &[0], Follows::RedundantPosition, Uncertain::Tool);
    assert_eq!(refused.err(), Some(TipError::TooManyJoints { joints: 33, most: 32 }));
    let inner = LinkPoint { link: assembled.anchors[1], at: [0.1, 0.0, 0.0] };
    let refused = TreeTip::new(tree(), &inner, &[0, 1, 2], Follows::Position, Uncertain::Tool);
    assert_eq!(refused.err(), Some(TipError::Beside { joint: 2 }));
}

/// A closed loop with random gains, or those of a user.
fn looped<R, T>(
    plant: TaskArm<R, T>,
    random: &mut Random,
    bounds: Option<ParameterBounds>,
) -> Looped<TaskSpace<R, T>, impl Fn(f64) -> Vec<Jet> + use<R, T>>
where
    R: Lagrangian<f64, Scratch: Send> + Clone + Send + Sync + 'static,
    T: TipKinematics + Clone,
{
    let (n, m, p) = (plant.tip.joints(), plant.tip.axes(), plant.tip.parameter_count());
    let diagonal = Gain::Diagonal((0..p).map(|_| 1.0 + 0.5 * random.number()).collect());
    let lambda = if bounds.is_some() { diagonal.resolve(p, &[]).unwrap() } else { gain(random, p) };
    let controller = TaskSpace {
        robot: plant.arm.robot.clone(),
        tip: plant.tip.clone(),
        law: SlotineLi {
            damping: gain(random, n),
            adaptation: Some(gain(random, plant.arm.theta.len())),
            bounds: None,
        },
        task_gain: gain(random, m),
        attitude_gain: 1.3,
        null_space: Some(NullSpace { rate_per_s: 0.9, posture: random.column(n, 1.0) }),
        kappa: 0.8,
        alpha: 1.7,
        kinematic_adaptation: Some(lambda),
        bounds,
        estimate_start: random.column(plant.arm.theta.len(), 1.0),
        kinematic_start: plant.tip_theta.iter().map(|theta| theta + 0.2).collect(),
        determinant_floor: 0.01,
    };
    let entries = if controller.tip.turns() { m + 4 } else { m };
    let target: Vec<Jet> = (0..entries).map(|_| random.column(5, 0.5).try_into().unwrap()).collect();
    Looped::new(plant, controller, move |t| target.iter().map(|jet| polynomial(jet, t)).collect())
}

/// V̇ of Theorem 6 at a random state; false where Ĵ is close to singular there and nothing was checked.
fn check_balance<R, T>(plant: TaskArm<R, T>, random: &mut Random, bounds: Option<ParameterBounds>) -> bool
where
    R: Lagrangian<f64, Scratch: Send> + Clone + Send + Sync + 'static,
    T: TipKinematics + Clone,
{
    let (m, signs) = (plant.tip.joints(), usize::from(plant.tip.turns()));
    let system = looped(plant, random, bounds);
    falls(system, random, m, signs)
}

/// V̇ at a random state of a law whose last `signs` states are none.
fn falls<C: Controller>(
    mut system: Looped<C, impl Fn(f64) -> Vec<Jet>>,
    random: &mut Random,
    joints: usize,
    signs: usize,
) -> bool {
    let mut x = system.start(&random.column(2 * joints, 1.0), &[]);
    // Away from the start, where z = q̇.
    let plant_states = 2 * joints;
    let varied = x.len() - signs;
    for state in &mut x[plant_states..varied] {
        *state += 0.3 * random.number();
    }
    let balance = system.balance(0.0, &x);
    // Differences say nothing close to where Ĵ is singular.
    let shown = system.controller.shown();
    let before = shown.iter().take_while(|(signal, _)| !matches!(signal, Signal::Determinant | Signal::SingularValue));
    let determinant = system.shown[before.map(|(_, count)| count).sum::<usize>()];
    if determinant.abs() < 0.05 {
        return false;
    }
    let slope = system.slope(0.0, &x, |system, t, x| system.balance(t, x).value);
    let size = 1.0 + balance.value.abs() + slope.abs();
    assert!((slope + balance.dissipation).abs() < 1e-5 * size, "{slope} against {}", -balance.dissipation);
    assert!(balance.dissipation >= -1e-12 * size);
    true
}

#[test]
fn thm6_v_falls_as_the_proof_says_at_random_states() {
    let mut random = Random::new(4);
    let mut checked = [0; 3];
    for round in 0..40 {
        let links = PlanarLinks::uniform([2.0, 1.0], [1.0, 0.8]);
        let theta = links.theta().to_vec();
        let planar = || TaskArm {
            arm: Mechanical { robot: PlanarArm, theta: theta.clone() },
            tip: PlanarTip { length_m: links.length_m },
            tip_theta: links.length_m.to_vec(),
        };
        checked[0] += usize::from(check_balance(planar(), &mut random, None));
        // Estimates start beyond the upper bound, within the margin.
        let bounds = ParameterBounds::new(vec![0.5, 0.5], vec![1.1, 0.9], 5.0);
        checked[1] += usize::from(check_balance(planar(), &mut random, Some(bounds)));
        let (assembled, point) = chain(&mut random, round % 2 == 0);
        let tip = tip(&assembled, &point, if round % 4 < 2 { Uncertain::Tool } else { Uncertain::Chain });
        let tip_theta = tip.parameters();
        let arm = Mechanical { robot: assembled.tree, theta: assembled.theta };
        checked[2] += usize::from(check_balance(TaskArm { arm, tip, tip_theta }, &mut random, None));
    }
    assert!(checked.iter().all(|checked| *checked > 10), "{checked:?}");
}

/// The same with poses, and with more joints than coordinates: with slides and without, with bounds and without.
#[test]
fn thm6_v_falls_alike_for_poses_and_for_redundant_joints() {
    let mut random = Random::new(12);
    let mut checked = [0; 2];
    for round in 0..60 {
        let uncertain = if round % 4 < 2 { Uncertain::Tool } else { Uncertain::Chain };
        let arm = |assembled: Assembled, tip: TreeTip| {
            let tip_theta = tip.parameters();
            TaskArm { arm: Mechanical { robot: assembled.tree, theta: assembled.theta }, tip, tip_theta }
        };
        let (assembled, point) = chain_of(6, &mut random, round % 3 == 0);
        let tip = posed(&assembled, &point, uncertain);
        let plant = arm(assembled, tip);
        let bounds = (round % 5 == 0).then(|| {
            let [lower, upper] = [-0.1, 0.1].map(|room| plant.tip_theta.iter().map(|l| l + room).collect());
            ParameterBounds::new(lower, upper, 1.0)
        });
        checked[0] += usize::from(check_balance(plant, &mut random, bounds));
        let (assembled, point) = chain_of(5 + round % 3, &mut random, round % 3 == 0);
        let coordinates: &[usize] = [&[0, 1, 2][..], &[2, 0], &[1]][round % 3];
        let tip = TreeTip::new(assembled.tree.clone(), &point, coordinates, Follows::RedundantPosition, uncertain);
        checked[1] += usize::from(check_balance(arm(assembled, tip.unwrap()), &mut random, None));
    }
    assert!(checked.iter().all(|checked| *checked > 20), "{checked:?}");
}

fn planar_law(links: &PlanarLinks, bounds: Option<ParameterBounds>) -> TaskSpace<PlanarArm, PlanarTip> {
    let number = |k: f64, n: usize| Gain::Number(k).resolve(n, &[]).unwrap();
    TaskSpace {
        robot: PlanarArm,
        tip: PlanarTip { length_m: links.length_m },
        law: SlotineLi { damping: number(20.0, 2), adaptation: Some(number(30.0, 5)), bounds: None },
        task_gain: number(20.0, 2),
        attitude_gain: 1.0,
        null_space: None,
        kappa: 5.0,
        alpha: 3.0,
        kinematic_adaptation: Some(number(0.3, 2)),
        bounds,
        estimate_start: vec![0.0; 5],
        kinematic_start: vec![1.2, 0.6],
        determinant_floor: 0.02,
    }
}

/// A circle in the plane: the tip follows it with wrong lengths and unknown masses, with and without bounds.
#[test]
fn thm6_tip_follows_a_circle_without_its_velocity() {
    let links = PlanarLinks::uniform([2.0, 1.0], [1.0, 0.8]);
    let circle = |t: f64| -> Vec<Jet> {
        let wave = |phase: f64, middle: f64| -> Jet {
            core::array::from_fn(|k| {
                let turn = core::f64::consts::FRAC_PI_2 * k as f64 + phase;
                0.3 * (t + turn).sin() + if k == 0 { middle } else { 0.0 }
            })
        };
        vec![wave(core::f64::consts::FRAC_PI_2, 0.8), wave(0.0, 0.6)]
    };
    let bounds = ParameterBounds::new(vec![0.9, 0.7], vec![1.1, 0.9], 0.05);
    for bounds in [None, Some(bounds)] {
        let plant = TaskArm {
            arm: Mechanical { robot: PlanarArm, theta: links.theta().to_vec() },
            tip: PlanarTip { length_m: links.length_m },
            tip_theta: links.length_m.to_vec(),
        };
        let bounded = bounds.is_some();
        let mut system = Looped::new(plant, planar_law(&links, bounds), circle);
        let mut x = system.start(&[0.0, 1.5, 0.0, 0.0], &[]);
        system.rate(0.0, &x);
        let error = |shown: &[f64]| shown[shown.len() - 2..].iter().map(|e| e * e).sum::<f64>().sqrt();
        let first = error(&system.shown);
        let h = 2e-3;
        let mut value = system.balance(0.0, &x).value;
        for step in 0..60_000 {
            system.step(f64::from(step) * h, h, &mut x);
            if step % 100 == 0 {
                let balance = system.balance(f64::from(step + 1) * h, &x);
                assert!(balance.value <= value * (1.0 + 1e-9), "V rose at {} s", f64::from(step) * h);
                value = balance.value;
            }
            assert_eq!(system.controller.trouble(&x[4..], &system.shown), None);
        }
        let last = error(&system.shown);
        println!("bounded {bounded}: {first} m at first, {last} m at the end, {:?}", &x[11..13]);
        assert!(last < 1e-2 * first, "{first} m at first, {last} m at the end");
    }
}

#[test]
fn thm6_a_determinant_that_vanishes_or_changes_sign_is_trouble() {
    let links = PlanarLinks::uniform([2.0, 1.0], [1.0, 0.8]);
    let law = planar_law(&links, None);
    for start in [0.8, -0.8] {
        for (value, fine) in [(0.5, true), (0.01, false), (0.016, false), (-0.5, false)] {
            let mut state = vec![0.0; 10];
            state[9] = start;
            let mut shown = vec![0.0; 18];
            shown[13] = value * start / 0.8;
            let trouble = law.trouble(&state, &shown);
            assert_eq!(trouble.is_none(), fine, "{start} {value}");
            if let Some(Singularity::Vanishes { floor, .. }) = trouble {
                assert!((floor - 0.02 * start).abs() < 1e-15);
            }
        }
    }
    assert!(law.trouble(&[0.0; 10], &[0.0; 18]).is_some(), "a start at zero");
}
