//! The same bits from hardware and software, with and without dispatch, in lanes and alone.
#![allow(clippy::unwrap_used)]

use forwardstep_core::robot::tree::{JointKind, LinkJoint, LinkSpec, Placement, Tree};
use forwardstep_core::robot::{Lagrangian, TwoVelocity};
use forwardstep_core::{Lanes, Packed, Scalar};

/// Numbers of every size and sign, always the same ones.
fn numbers(seed: u64) -> impl Iterator<Item = f64> {
    let mut state = seed;
    std::iter::repeat_with(move || {
        // SplitMix64
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        f64::from_bits(z ^ (z >> 31))
    })
    .filter(|x| x.is_finite())
}

/// Numbers a robot might see.
fn moderate(seed: u64) -> impl Iterator<Item = f64> {
    numbers(seed).map(|x| 4.0 * (x.to_bits() >> 11) as f64 / (1_u64 << 53) as f64 - 2.0)
}

#[test]
fn digest_software_multiply_add_is_that_of_the_hardware() {
    let same = |a: f64, b: f64, c: f64| {
        let (hard, soft) = (Scalar::mul_add(a, b, c), libm::fma(a, b, c));
        assert!(hard.to_bits() == soft.to_bits() || hard.is_nan() && soft.is_nan(), "{a:e} · {b:e} + {c:e}");
    };
    let (mut wide, mut narrow) = (numbers(1), moderate(2));
    for _ in 0..300_000 {
        let (a, b) = (wide.next().unwrap(), wide.next().unwrap());
        same(a, b, wide.next().unwrap());
        let (a, b) = (narrow.next().unwrap(), narrow.next().unwrap());
        same(a, b, narrow.next().unwrap());
        // What is left when almost everything cancels.
        same(a, b, -(a * b));
        same(a, b, (-(a * b)).next_up());
    }
}

#[test]
fn digest_sine_and_cosine_are_the_same_in_every_lane() {
    let mut angles = moderate(3);
    for scale in [1.0, 1e3, 1e5, 1e9] {
        for _ in 0..20_000 {
            let x = Lanes::<8>::from_lanes(|_| scale * angles.next().unwrap());
            let (sin, cos) = x.sin_cos();
            for lane in 0..8 {
                let alone = Scalar::sin_cos(x.lane(lane));
                let bits = |(sin, cos): (f64, f64)| (sin.to_bits(), cos.to_bits());
                assert_eq!(bits((sin.lane(lane), cos.lane(lane))), bits(alone), "{:e}", x.lane(lane));
            }
        }
    }
}

/// A chain of both kinds of joints about all kinds of axes, with damping.
fn chain() -> (Tree, Vec<f64>) {
    let axes = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.6, 0.0, 0.8], [0.48, 0.64, 0.6]];
    let links: Vec<LinkSpec> = axes
        .into_iter()
        .enumerate()
        .map(|(k, axis)| LinkSpec {
            parent: k.checked_sub(1),
            x_parent_joint: Placement::from_xyz_rpy([0.1, 0.3, 0.2], [0.4, -0.5, 0.1 * k as f64]),
            joint: LinkJoint::Moving {
                kind: if k == 2 { JointKind::Prismatic } else { JointKind::Revolute },
                axis,
                damping: 0.1 * k as f64,
            },
            inertia: [2.0, 0.1, 0.2, 0.3, 1.0, 0.01, 1.1, 0.02, 0.03, 1.2],
        })
        .collect();
    let assembled = Tree::assemble(&links, [0.0, 0.0, -9.81]).unwrap();
    (assembled.tree, assembled.theta)
}

#[test]
fn digest_kernels_give_the_same_bits_dispatched_and_in_lanes() {
    let (tree, theta) = chain();
    let (n, p) = (tree.joint_count(), tree.theta_len());
    let mut random = moderate(4);
    for _ in 0..500 {
        // q, q̇, z, ż, s, τ of eight robots.
        let states: Vec<Vec<[f64; 8]>> =
            (0..6).map(|_| (0..n).map(|_| std::array::from_fn(|_| random.next().unwrap())).collect()).collect();
        let packed: Vec<Vec<Lanes<8>>> = states.iter().map(|state| state.iter().map(|x| Lanes(*x)).collect()).collect();
        let theta_lanes: Vec<Lanes<8>> = theta.iter().map(|x| Lanes::splat(*x)).collect();
        let zero = Lanes::<8>::ZERO;
        let (mut torque, mut gradient, mut ddq) = (vec![zero; n], vec![zero; p], vec![zero; n]);
        let mut scratch = tree.scratch();
        let motion = TwoVelocity { q: &packed[0], dq: &packed[1], z: &packed[2], dz: &packed[3] };
        tree.slotine_li(&mut scratch, motion, &theta_lanes, &packed[4], &mut torque, &mut gradient).unwrap();
        tree.acceleration(&mut scratch, &packed[0], &packed[1], &theta_lanes, &packed[5], &mut ddq).unwrap();
        let in_lanes = |lane| torque.iter().chain(&gradient).chain(&ddq).map(move |x| x.lane(lane).to_bits());

        for lane in 0..8 {
            let own: Vec<Vec<f64>> = states.iter().map(|state| state.iter().map(|x| x[lane]).collect()).collect();
            let motion = TwoVelocity { q: &own[0], dq: &own[1], z: &own[2], dz: &own[3] };
            for dispatched in [false, true] {
                let mut out = vec![0.0; n + p + n];
                let (torque, rest) = out.split_at_mut(n);
                let (gradient, ddq) = rest.split_at_mut(p);
                let mut scratch = tree.scratch();
                if dispatched {
                    tree.slotine_li(&mut scratch, motion, &theta, &own[4], torque, gradient).unwrap();
                    tree.acceleration(&mut scratch, &own[0], &own[1], &theta, &own[5], ddq).unwrap();
                } else {
                    tree.regressor_products(&mut scratch, motion, &theta, &own[4], torque, gradient).unwrap();
                    tree.forward_dynamics(&mut scratch, &own[0], &own[1], &theta, &own[5], ddq).unwrap();
                }
                assert!(out.iter().map(|x| x.to_bits()).eq(in_lanes(lane)), "lane {lane}, dispatched: {dispatched}");
            }
        }
    }
}
