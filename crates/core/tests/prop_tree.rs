//! What is particular to trees: lumping, locking, lengths, bits, and that nothing is allocated. One file, since every other would compile the
//! kernels for all instruction sets again.

use crate::common::error;
use crate::common::random::{Random, inertia_of};
use forwardstep_core::robot::tree::{
    Anchor, Axes, JointKind, LinkJoint, LinkPoint, LinkSpec, Placement, PointWrench, Tree, TreeScratch,
};
use forwardstep_core::robot::{Called, Lagrangian, TwoVelocity};
use forwardstep_core::{Kernel, Lanes, LengthError, Scalar, Vectors, dispatch};
use proptest::prelude::*;

const TOLERANCE: f64 = 1.0e-11;
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// q, dq, z, dz, s.
type Columns<S> = [Vec<S>; 5];

fn columns(random: &mut Random, n: usize) -> Columns<f64> {
    [random.column(n, 3.0), random.column(n, 2.0), random.column(n, 2.0), random.column(n, 5.0), random.column(n, 3.0)]
}

fn motion<S>([q, dq, z, dz, _]: &Columns<S>) -> TwoVelocity<'_, S> {
    TwoVelocity { q, dq, z, dz }
}

/// Yϑ, Yᵀs and q̈.
struct Outputs<'a, S> {
    tree: &'a Tree,
    x: &'a Columns<S>,
    theta: &'a [S],
}

impl<S: Scalar> Kernel for Outputs<'_, S> {
    type Output = [Vec<S>; 3];

    #[inline(always)]
    fn run(self) -> Self::Output {
        let Outputs { tree, x, theta } = self;
        let n = tree.joint_count();
        let mut scratch = tree.scratch();
        let [mut y_theta, mut yt_s, mut ddq] = [vec![S::ZERO; n], vec![S::ZERO; theta.len()], vec![S::ZERO; n]];
        tree.regressor_products(&mut scratch, motion(x), theta, &x[4], &mut y_theta, &mut yt_s).unwrap();
        tree.forward_dynamics(&mut scratch, &x[0], &x[1], theta, &x[4], &mut ddq).unwrap();
        [y_theta, yt_s, ddq]
    }
}

/// With run-time dispatch.
fn dispatched<S: Scalar>(tree: &Tree, x: &Columns<S>, theta: &[S]) -> [Vec<S>; 3] {
    dispatch(Outputs { tree, x, theta })
}

/// The same compiled for the baseline instruction set, where a multiply-add is a call of software.
#[inline(never)]
fn plain<S: Scalar>(tree: &Tree, x: &Columns<S>, theta: &[S]) -> [Vec<S>; 3] {
    Outputs { tree, x, theta }.run()
}

/// The same where there are vectors, as the simulation works on lanes; nothing elsewhere.
fn in_vectors<S: Scalar>(tree: &Tree, x: &Columns<S>, theta: &[S]) -> Option<[Vec<S>; 3]> {
    Vectors::of_this_processor().map(|vectors| vectors.run(Outputs { tree, x, theta }))
}

fn bits(x: &[f64]) -> Vec<u64> {
    x.iter().map(|x| x.to_bits()).collect()
}

/// The robots of a vector, by `wide`, and each of them alone.
fn lanes_against_single<const N: usize>(
    tree: &Tree,
    random: &mut Random,
    wide: impl Fn(&Tree, &Columns<Lanes<N>>, &[Lanes<N>]) -> Option<[Vec<Lanes<N>>; 3]>,
) {
    let (n, width) = (tree.joint_count(), tree.theta_len());
    let robots: [Columns<f64>; N] = std::array::from_fn(|_| columns(random, n));
    let thetas: [Vec<f64>; N] = std::array::from_fn(|_| random.column(width, 3.0));
    let packed: Columns<Lanes<N>> =
        std::array::from_fn(|k| (0..n).map(|i| Lanes(std::array::from_fn(|robot| robots[robot][k][i]))).collect());
    let theta: Vec<_> = (0..width).map(|i| Lanes(std::array::from_fn(|robot| thetas[robot][i]))).collect();
    let Some(together) = wide(tree, &packed, &theta) else { return };
    for robot in 0..N {
        let (single, plain) =
            (dispatched(tree, &robots[robot], &thetas[robot]), plain(tree, &robots[robot], &thetas[robot]));
        for k in 0..3 {
            let lane = |result: &[Vec<Lanes<N>>; 3]| result[k].iter().map(|x| x.0[robot].to_bits()).collect::<Vec<_>>();
            assert_eq!(lane(&together), bits(&single[k]), "lanes, output {k}");
            assert_eq!(bits(&plain[k]), bits(&single[k]), "one robot without dispatch, output {k}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn prop_same_bits_in_every_lane_and_without_dispatch(seed in any::<u64>(), joints in 1_usize..8) {
        let mut random = Random::new(seed);
        let assembled = random.tree(joints);
        let driven = random.driven_tree(joints, joints % 2 == 0).tree;
        for tree in [&driven, &assembled.tree] {
            lanes_against_single::<8>(tree, &mut random, in_vectors);
            lanes_against_single::<2>(tree, &mut random, |tree, x, theta| Some(plain(tree, x, theta)));
        }
    }

    /// Half of every body's points are stated in a frame of their own, held rigidly, and once more rigidly by that.
    #[test]
    fn prop_lumping_a_fixed_link_changes_nothing(seed in any::<u64>(), joints in 1_usize..7) {
        let mut random = Random::new(seed);
        let mut whole = random.links(joints);
        let mut split = vec![LinkSpec {
            parent: None,
            x_parent_joint: random.placement(),
            joint: LinkJoint::Fixed,
            inertia: inertia_of(&random.cloud()),
        }];
        let base = split[0].x_parent_joint;
        let mut renumbered = Vec::new();
        for link in &mut whole {
            let (own, second, third) = (random.cloud(), random.cloud(), random.cloud());
            let (x_link_second, x_second_third) = (random.placement(), random.placement());
            let seen = |cloud: &[(f64, [f64; 3])], x: Placement| cloud.iter().map(|(m, r)| (*m, x.point(*r))).collect();
            let second_seen: Vec<_> = seen(&second, x_link_second);
            let third_seen: Vec<_> = seen(&third, x_link_second.compose(&x_second_third));
            link.inertia = inertia_of(&[own.clone(), second_seen, third_seen].concat());
            let at = split.len();
            split.push(LinkSpec {
                // What the base carries sits on its fixed link instead.
                parent: Some(link.parent.map_or(0, |parent| renumbered[parent])),
                x_parent_joint: match link.parent {
                    None => base.inverse().compose(&link.x_parent_joint),
                    Some(_) => link.x_parent_joint,
                },
                inertia: inertia_of(&own),
                ..*link
            });
            let held = |parent, x_parent_joint, cloud: &[_]| LinkSpec {
                parent: Some(parent),
                x_parent_joint,
                joint: LinkJoint::Fixed,
                inertia: inertia_of(cloud),
            };
            split.push(held(at, x_link_second, &second));
            split.push(held(at + 1, x_second_third, &third));
            renumbered.push(at);
        }
        let (whole, split) = (Tree::assemble(&whole, GRAVITY).unwrap(), Tree::assemble(&split, GRAVITY).unwrap());
        prop_assert!(error(&split.theta, &whole.theta) < TOLERANCE);
        prop_assert_eq!(&split.moving, &renumbered);
        let x = columns(&mut random, joints);
        let ours = dispatched(&split.tree, &x, &split.theta);
        let theirs = dispatched(&whole.tree, &x, &whole.theta);
        for k in 0..2 {
            prop_assert!(error(&ours[k], &theirs[k]) < TOLERANCE, "output {}", k);
        }
    }

    /// A joint locked at a value behaves as one that stands still there.
    #[test]
    fn prop_locking_a_joint_leaves_the_others(seed in any::<u64>(), joints in 2_usize..7) {
        let mut random = Random::new(seed);
        let mut links = random.links(joints);
        // A link lumped into the base would change no joint's torque, so the locked joint is not the first.
        links[1].parent = Some(0);
        let free = Tree::assemble(&links, GRAVITY).unwrap();
        let locked_at = 1 + random.below(joints - 1);
        let mut x = columns(&mut random, joints);
        links[locked_at] = links[locked_at].locked(x[0][locked_at]);
        let locked = Tree::assemble(&links, GRAVITY).unwrap();
        for column in &mut x[1..4] {
            column[locked_at] = 0.0;
        }
        let [mut torque, ..] = dispatched(&free.tree, &x, &free.theta);
        torque.remove(locked_at);
        for column in &mut x {
            column.remove(locked_at);
        }
        let [of_locked, ..] = dispatched(&locked.tree, &x, &locked.theta);
        prop_assert!(error(&of_locked, &torque) < TOLERANCE);
    }

    #[test]
    fn prop_placements_form_a_group(seed in any::<u64>()) {
        let mut random = Random::new(seed);
        let (a, b, point) = (random.placement(), random.placement(), random.vector(2.0));
        prop_assert!(error(&a.compose(&b).point(point), &a.point(b.point(point))) < 1e-14);
        prop_assert!(error(&a.inverse().point(a.point(point)), &point) < 1e-14);
        // Roll, pitch, yaw are turns about the fixed axes x, y, z, in this order.
        let [roll, pitch, yaw] = random.vector(3.0);
        let about = |axis, value| Placement::of_joint(JointKind::Revolute, axis, value);
        let turned = about([0.0, 0.0, 1.0], yaw)
            .compose(&about([0.0, 1.0, 0.0], pitch))
            .compose(&about([1.0, 0.0, 0.0], roll));
        let stated = Placement::from_xyz_rpy([0.0; 3], [roll, pitch, yaw]);
        prop_assert!(error(turned.rotation.as_flattened(), stated.rotation.as_flattened()) < 1e-14);
    }

    /// Whatever the numbers: no panic.
    #[test]
    fn prop_any_numbers_give_an_answer_or_an_error(
        numbers in proptest::collection::vec(any::<f64>(), 40),
        parents in proptest::collection::vec(proptest::option::of(0_usize..4), 3),
        kinds in proptest::collection::vec(0_u8..3, 3),
    ) {
        let mut numbers = numbers.into_iter().cycle();
        let mut next = || numbers.next().unwrap_or(0.0);
        let mut links = Vec::new();
        for (parent, kind) in parents.into_iter().zip(kinds) {
            links.push(LinkSpec {
                parent,
                x_parent_joint: Placement { translation: [next(), next(), next()], ..Placement::IDENTITY },
                joint: match kind {
                    0 => LinkJoint::Fixed,
                    1 => LinkJoint::Moving { kind: JointKind::Prismatic, axis: [0.0, 1.0, 0.0], damping: next().abs() },
                    _ => LinkJoint::Moving { kind: JointKind::Revolute, axis: [0.6, 0.0, 0.8], damping: 0.0 },
                },
                inertia: std::array::from_fn(|_| next()),
            });
        }
        if let Ok(assembled) = Tree::assemble(&links, GRAVITY) {
            let tree = &assembled.tree;
            let n = tree.joint_count();
            let x: Columns<f64> = std::array::from_fn(|_| (0..n).map(|_| next()).collect());
            dispatched(tree, &x, &assembled.theta);
            let _ = tree.check_mass_matrix(&assembled.theta, &vec![[next(), next()]; n], 3);
            let scale = Lagrangian::<f64>::adaptation_scale(tree, &x[0], &assembled.theta);
            prop_assert!(scale.iter().all(|x| *x >= 0.0));
        }
    }
}

/// Every slice of every method, one entry short and one too long.
#[test]
fn prop_wrong_lengths_are_errors() {
    let mut random = Random::new(5);
    let assembled = random.tree(4);
    let (tree, width) = (&assembled.tree, assembled.theta.len());
    let mut scratch = tree.scratch::<f64>();
    // [q, dq, z, dz, s, y_theta, theta, yt_s, matrix, regressor]
    let right = [4, 4, 4, 4, 4, 4, width, width, 16, 4 * width];
    for wrong in 0..right.len() {
        for by in [-1_isize, 1] {
            let mut lengths = right;
            lengths[wrong] = lengths[wrong].saturating_add_signed(by);
            let [q, dq, z, dz, s, mut out, theta, mut yt_s, mut matrix, mut y] =
                lengths.map(|length| vec![0.5; length]);
            let motion = TwoVelocity { q: &q, dq: &dq, z: &z, dz: &dz };
            let results: [(&[usize], Result<(), LengthError>); 6] = [
                (
                    &[0, 1, 2, 3, 4, 5, 6, 7],
                    Called(tree).regressor_products(&mut scratch, motion, &theta, &s, &mut out, &mut yt_s),
                ),
                (&[0, 1, 4, 5, 6], Called(tree).forward_dynamics(&mut scratch, &q, &dq, &theta, &s, &mut out)),
                (&[0, 6, 8], tree.mass_matrix(&mut scratch, &q, &theta, &mut matrix)),
                (&[0, 1, 6, 8], tree.coriolis_matrix(&mut scratch, &q, &dq, &theta, &mut matrix)),
                (&[0, 5, 6], tree.gravity(&mut scratch, &q, &theta, &mut out)),
                (&[0, 1, 2, 3, 9], tree.regressor(&mut scratch, motion, &mut y)),
            ];
            for (call, (uses, result)) in results.into_iter().enumerate() {
                assert_eq!(result.is_err(), uses.contains(&wrong), "call {call}, slice {wrong} {by:+}");
            }
        }
    }
}

/// The working memory of another tree is refused, larger or smaller.
#[test]
fn prop_foreign_scratch_is_an_error() {
    let mut random = Random::new(6);
    for joints in [3, 5] {
        let (assembled, other) = (random.tree(4), random.tree(joints));
        let tree = &assembled.tree;
        let mut scratch: TreeScratch<f64> = other.tree.scratch();
        let (x, theta) = (columns(&mut random, 4), &assembled.theta);
        let (mut out, mut yt_s, mut matrix) = (vec![0.0; 4], vec![0.0; theta.len()], vec![0.0; 16]);
        let mut y = vec![0.0; 4 * theta.len()];
        let want = Err(LengthError { what: "scratch", need: 4, got: joints });
        assert_eq!(Called(tree).regressor_products(&mut scratch, motion(&x), theta, &x[4], &mut out, &mut yt_s), want);
        assert_eq!(Called(tree).forward_dynamics(&mut scratch, &x[0], &x[1], theta, &x[4], &mut out), want);
        assert_eq!(tree.mass_matrix(&mut scratch, &x[0], theta, &mut matrix), want);
        assert_eq!(tree.coriolis_matrix(&mut scratch, &x[0], &x[1], theta, &mut matrix), want);
        assert_eq!(tree.gravity(&mut scratch, &x[0], theta, &mut out), want);
        assert_eq!(tree.regressor(&mut scratch, motion(&x), &mut y), want);
    }
}

/// Single precision follows double precision to its own accuracy.
#[test]
fn prop_single_precision_follows() {
    let mut random = Random::new(7);
    for _ in 0..20 {
        let assembled = random.tree(6);
        let x = columns(&mut random, 6);
        let narrow = |column: &Vec<f64>| column.iter().map(|x| *x as f32).collect::<Vec<_>>();
        let wide = |column: &Vec<f32>| column.iter().map(|x| f64::from(*x)).collect::<Vec<_>>();
        let single = dispatched(&assembled.tree, &x.each_ref().map(narrow), &narrow(&assembled.theta));
        let double = dispatched(&assembled.tree, &x, &assembled.theta);
        assert!(error(&wide(&single[0]), &double[0]) < 1e-5);
        assert!(error(&wide(&single[1]), &double[1]) < 1e-5);
    }
}

/// (Jᵀw)ᵀ q̇ = fᵀ v + mᵀ ω, where the moment's share is that of two opposite forces.
#[test]
fn prop_a_force_has_the_same_power_on_the_joints_as_at_its_point() {
    let mut random = Random::new(11);
    for joints in 1..12 {
        let assembled = random.tree(joints);
        let tree = &assembled.tree;
        let n = tree.joint_count();
        let link = assembled.anchors[random.below(assembled.anchors.len())];
        let (q, dq) = (random.column(n, 3.0), random.column(n, 2.0));
        let (at, force, lever) = (random.vector(0.5), random.vector(20.0), random.vector(0.3));
        let mut scratch = tree.scratch();
        let point = LinkPoint { link, at };
        let add = |scratch: &mut TreeScratch<f64>, at: [f64; 3], force: [f64; 3], moment: [f64; 3], axes| {
            let mut tau = vec![0.0; n];
            let wrench = PointWrench { force, moment, axes };
            tree.add_wrench(scratch, &q, &LinkPoint { link, at }, &wrench, &mut tau).unwrap();
            tau
        };
        let power = |tau: &[f64]| tau.iter().zip(&dq).map(|(tau, dq)| tau * dq).sum::<f64>();
        let tau = add(&mut scratch, at, force, [0.0; 3], Axes::Base);
        let motion = tree.point_motion(&mut scratch, &q, &dq, &point).unwrap();
        let spent: f64 = force.iter().zip(&motion.velocity).map(|(f, v)| f * v).sum();
        assert!((power(&tau) - spent).abs() < TOLERANCE * spent.abs().max(1.0), "{joints} joints");

        // A pair of forces ±f at ±l is the moment 2 l × f, in the axes of the link.
        let pair = [1.0, -1.0].map(|sign: f64| {
            let shifted = std::array::from_fn(|k| at[k] + sign * lever[k]);
            add(&mut scratch, shifted, force.map(|f| sign * f), [0.0; 3], Axes::Link)
        });
        let [l, f] = [lever.map(|l| 2.0 * l), force];
        let moment = [l[1] * f[2] - l[2] * f[1], l[2] * f[0] - l[0] * f[2], l[0] * f[1] - l[1] * f[0]];
        let pure = add(&mut scratch, at, [0.0; 3], moment, Axes::Link);
        let sum: Vec<f64> = pair[0].iter().zip(&pair[1]).map(|(a, b)| a + b).collect();
        assert!(error(&sum, &pure) < TOLERANCE, "{joints} joints");

        // Same bits in lanes.
        let lane = |x: &[f64]| x.iter().map(|x| Lanes([*x; 8])).collect::<Vec<_>>();
        let mut wide = vec![Lanes([0.0; 8]); n];
        let wrench =
            PointWrench { force: force.map(|f| Lanes([f; 8])), moment: [Lanes([0.0; 8]); 3], axes: Axes::Base };
        tree.add_wrench(&mut tree.scratch(), &lane(&q), &point, &wrench, &mut wide).unwrap();
        assert_eq!(bits(&wide.iter().map(|x| x.0[5]).collect::<Vec<_>>()), bits(&tau));
    }
}

#[test]
fn wrenches_check_lengths_and_the_base_feels_nothing() {
    let assembled = Random::new(5).tree(3);
    let tree = &assembled.tree;
    let mut scratch = tree.scratch::<f64>();
    let base = LinkPoint { link: Anchor { body: None, x_body_link: Placement::IDENTITY }, at: [1.0, 2.0, 3.0] };
    let wrench = PointWrench { force: [1.0; 3], moment: [1.0; 3], axes: Axes::Base };
    let mut tau = [0.5; 3];
    tree.add_wrench(&mut scratch, &[0.1; 3], &base, &wrench, &mut tau).unwrap();
    assert_eq!(tau, [0.5; 3]);
    let motion = tree.point_motion(&mut scratch, &[0.1; 3], &[0.2; 3], &base).unwrap();
    assert_eq!((motion.position, motion.velocity), ([1.0, 2.0, 3.0], [0.0; 3]));
    for length in [0, 2, 4] {
        let q = vec![0.1; length];
        assert!(tree.add_wrench(&mut scratch, &q, &base, &wrench, &mut tau).is_err());
        assert!(tree.add_wrench(&mut scratch, &[0.1; 3], &base, &wrench, &mut vec![0.0; length]).is_err());
        assert!(tree.point_motion(&mut scratch, &q, &[0.1; 3], &base).is_err());
        assert!(tree.point_motion(&mut scratch, &[0.1; 3], &q, &base).is_err());
    }
}

/// The kernels allocate nothing, not even the first time.
#[test]
fn alloc_kernels_of_a_tree() {
    let count = |run: &mut dyn FnMut()| allocation_counter::measure(run).count_total;
    // The counter counts.
    assert_eq!(count(&mut || drop(std::hint::black_box(vec![1.0]))), 1);
    let mut random = Random::new(3);
    let assembled = random.tree(7);
    let tree = &assembled.tree;
    let theta = assembled.theta.clone();
    let x = columns(&mut random, 7);
    let [q, dq, z, dz, s] = &x;
    let (mut out, mut yt_s, mut matrix) = (vec![0.0; 7], theta.clone(), vec![0.0; 49]);
    let mut scratch = tree.scratch::<f64>();
    let motion = TwoVelocity { q, dq, z, dz };
    let point = LinkPoint { link: assembled.anchors[assembled.anchors.len() - 1], at: [0.1, 0.2, 0.3] };
    let wrench = PointWrench { force: [1.0; 3], moment: [2.0; 3], axes: Axes::Base };
    let counted = count(&mut || {
        Called(tree).regressor_products(&mut scratch, motion, &theta, s, &mut out, &mut yt_s).unwrap();
        Called(tree).forward_dynamics(&mut scratch, q, dq, &theta, s, &mut out).unwrap();
        tree.mass_matrix(&mut scratch, q, &theta, &mut matrix).unwrap();
        tree.coriolis_matrix(&mut scratch, q, dq, &theta, &mut matrix).unwrap();
        tree.gravity(&mut scratch, q, &theta, &mut out).unwrap();
        tree.add_wrench(&mut scratch, q, &point, &wrench, &mut out).unwrap();
        tree.point_motion(&mut scratch, q, dq, &point).unwrap();
    });
    assert_eq!(counted, 0);

    // In lanes, what `Outputs` gives them to work with and no more.
    let lanes = |column: &Vec<f64>| column.iter().map(|value| Lanes::<8>::splat(*value)).collect::<Vec<_>>();
    let (x, theta) = (x.each_ref().map(lanes), lanes(&theta));
    let given = count(&mut || {
        drop(std::hint::black_box((tree.scratch::<Lanes<8>>(), [&x[0], &theta, &x[0]].map(Clone::clone))))
    });
    let counted = count(&mut || drop(std::hint::black_box(in_vectors(tree, &x, &theta))));
    assert_eq!(counted, if Vectors::of_this_processor().is_some() { given } else { 0 });
}
