//! The kernels allocate nothing, not even the first time.

#![allow(clippy::unwrap_used)] // In helpers too.

mod common;

use common::random::Random;
use forwardstep_core::robot::tree::{Axes, LinkPoint, PointWrench};
use forwardstep_core::robot::{Lagrangian, TwoVelocity};
use forwardstep_core::{Lanes, Scalar};

fn allocations<S: Scalar>(splat: impl Fn(f64) -> S) {
    let mut random = Random::new(3);
    let assembled = random.tree(7);
    let tree = &assembled.tree;
    let theta: Vec<S> = assembled.theta.iter().map(|x| splat(*x)).collect();
    let mut column = || random.column(7, 2.0).into_iter().map(&splat).collect::<Vec<S>>();
    let (q, dq, z, dz, s, mut out) = (column(), column(), column(), column(), column(), column());
    let (mut yt_s, mut matrix) = (theta.clone(), vec![S::ZERO; 49]);
    let mut scratch = tree.scratch::<S>();
    let motion = TwoVelocity { q: &q, dq: &dq, z: &z, dz: &dz };
    let point = LinkPoint { link: assembled.anchors[assembled.anchors.len() - 1], at: [0.1, 0.2, 0.3] };
    let wrench = PointWrench { force: [splat(1.0); 3], moment: [splat(2.0); 3], axes: Axes::Base };
    let counted = allocation_counter::measure(|| {
        tree.regressor_products(&mut scratch, motion, &theta, &s, &mut out, &mut yt_s).unwrap();
        tree.slotine_li(&mut scratch, motion, &theta, &s, &mut out, &mut yt_s).unwrap();
        tree.forward_dynamics(&mut scratch, &q, &dq, &theta, &s, &mut out).unwrap();
        tree.acceleration(&mut scratch, &q, &dq, &theta, &s, &mut out).unwrap();
        tree.mass_matrix(&mut scratch, &q, &theta, &mut matrix).unwrap();
        tree.coriolis_matrix(&mut scratch, &q, &dq, &theta, &mut matrix).unwrap();
        tree.gravity(&mut scratch, &q, &theta, &mut out).unwrap();
        tree.add_wrench(&mut scratch, &q, &point, &wrench, &mut out).unwrap();
        tree.point_motion(&mut scratch, &q, &dq, &point).unwrap();
    });
    assert_eq!(counted.count_total, 0);
}

#[test]
fn alloc_kernels_of_a_tree() {
    // The counter counts.
    assert_eq!(allocation_counter::measure(|| drop(std::hint::black_box(vec![1.0]))).count_total, 1);
    allocations(|x| x);
    allocations(|x| Lanes([x; 8]));
}
