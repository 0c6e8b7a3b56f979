//! Whatever the lengths of the slices and whatever the numbers in them: a result or a `LengthError`, never a panic.

use forwardstep_core::law::{SlotineLi, SlotineLiOutput};
use forwardstep_core::robot::tree::{JointKind, LinkJoint, LinkSpec, Placement, Tree};
use forwardstep_core::robot::{Driven, Drives, Friction, Lagrangian, PlanarArm, PointMass, Ship, TwoVelocity};
use forwardstep_core::{Gain, LengthError, ResolvedGain};

const LONGEST: usize = 40;

/// Calls `call` with every choice of one length for each of N slices, and with values that are no numbers too. It must
/// succeed when all lengths are those needed, and only then.
fn every_length<const N: usize>(
    what: &str,
    need: [usize; N],
    mut call: impl FnMut([&[f64]; N]) -> Result<(), LengthError>,
) {
    for value in [0.3, f64::NAN, f64::INFINITY, 1e300] {
        let column = [value; LONGEST];
        for choice in 0..4_usize.pow(N as u32) {
            let length = |k: usize| match choice / 4_usize.pow(k as u32) % 4 {
                0 => need[k],
                1 => need[k].saturating_sub(1),
                2 => need[k] + 1,
                _ => 0,
            };
            let fits = (0..N).all(|k| length(k) == need[k]);
            let slices: [&[f64]; N] = std::array::from_fn(|k| &column[..length(k)]);
            let result = call(slices);
            assert_eq!(result.is_ok(), fits, "{what} with {:?} for {need:?}", slices.map(<[f64]>::len));
        }
    }
}

fn every_method_checks<R: Lagrangian<f64>>(name: &str, robot: &R) {
    let (m, p) = (robot.dof(), robot.parameter_count());
    let scratch = &mut robot.scratch();
    let out = &mut [0.0; LONGEST];
    let more = &mut [0.0; LONGEST];
    every_length(name, [m, m, m, m, p, m, m, p], |[q, dq, z, dz, theta, s, torque, gradient]| {
        let motion = TwoVelocity { q, dq, z, dz };
        let (torque, gradient) = (&mut out[..torque.len()], &mut more[..gradient.len()]);
        robot.regressor_products(scratch, motion, theta, s, torque, gradient)
    });
    every_length(name, [m, m, p, m, m], |[q, dq, theta, tau, ddq]| {
        robot.forward_dynamics(scratch, q, dq, theta, tau, &mut out[..ddq.len()])
    });
    every_length(name, [m, p, m * m], |[q, theta, mass]| robot.mass_matrix(scratch, q, theta, &mut out[..mass.len()]));
    every_length(name, [m, m, p, m * m], |[q, dq, theta, c]| {
        robot.coriolis_matrix(scratch, q, dq, theta, &mut out[..c.len()])
    });
    every_length(name, [m, m, m, m, p, m], |[q, dq, z, dz, theta, d]| {
        robot.add_damping(scratch, TwoVelocity { q, dq, z, dz }, theta, &mut out[..d.len()])
    });
    every_length(name, [m, p, m], |[q, theta, g]| robot.gravity(scratch, q, theta, &mut out[..g.len()]));
    let y = &mut [0.0; 100];
    every_length(name, [m, m, m, m], |[q, dq, z, dz]| {
        robot.regressor(scratch, TwoVelocity { q, dq, z, dz }, &mut y[..m * p])
    });
    for length in 0..LONGEST {
        let column = [0.3; LONGEST];
        robot.adaptation_scale(&column[..length], &column[..length]);
    }

    let law = SlotineLi { damping: gain(m), adaptation: Some(gain(p)), bounds: None };
    every_length(name, [m, m, m, m, p, m, m, p], |[q, dq, z, dz, theta_hat, s, tau, yt_s]| {
        let (mut s, mut tau, mut yt_s) = (s.to_vec(), tau.to_vec(), yt_s.to_vec());
        let out = SlotineLiOutput { s: &mut s, tau: &mut tau, yt_s: &mut yt_s };
        law.output(robot, scratch, TwoVelocity { q, dq, z, dz }, theta_hat, out)
    });
}

fn gain(size: usize) -> ResolvedGain {
    Gain::Number(2.0).resolve(size, &[]).unwrap()
}

fn two_joints() -> Tree {
    let link = |parent, kind, axis, damping| LinkSpec {
        parent,
        x_parent_joint: Placement::from_xyz_rpy([0.1, 0.2, 0.3], [0.4, 0.5, 0.6]),
        joint: LinkJoint::Moving { kind, axis, damping },
        inertia: [2.0, 0.1, 0.2, 0.3, 1.0, 0.01, 1.1, 0.02, 0.03, 1.2],
    };
    let links = [
        link(None, JointKind::Revolute, [0.0, 1.0, 0.0], 0.2),
        link(Some(0), JointKind::Prismatic, [0.6, 0.8, 0.0], 0.0),
    ];
    Tree::assemble(&links, [0.0, 0.0, -9.81]).unwrap().tree
}

#[test]
fn prop_robots_and_law_check_every_length() {
    every_method_checks("planar arm", &PlanarArm);
    every_method_checks("point mass", &PointMass { dimension: 2 });
    every_method_checks("ship", &Ship);
    let friction = vec![Friction { joint: 0, width: 0.1 }];
    for geared in [vec![], vec![1]] {
        let drives = Drives { damped: vec![0], geared, friction: friction.clone(), dry_s: None };
        every_method_checks("planar arm with drives", &Driven::new(PlanarArm, drives).unwrap());
    }
    every_method_checks("tree", &two_joints());
}
