//! Which lengths of a tree its regressor holds.

use forwardstep_core::robot::tree::{JointKind, LinkJoint, LinkPoint, LinkSpec, Placement, Tree, Uncertain};
use forwardstep_core::robot::{Lagrangian, TwoVelocity};

use super::tip;
use crate::common::random::{Random, inertia_of};

/// A chain of three joints whose axes are often parallel, and whose frames are often not turned.
fn orderly(random: &mut Random) -> Vec<LinkSpec> {
    let link = |random: &mut Random, parent: Option<usize>| {
        let axes = [[0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.6, 0.8, 0.0]];
        let axis = axes[if random.chance(0.7) { 0 } else { 1 + (3.0 * random.number().abs()) as usize % 3 }];
        let turned = random.placement();
        let place = Placement { translation: turned.translation, ..Placement::IDENTITY };
        let kind = if random.chance(0.3) { JointKind::Prismatic } else { JointKind::Revolute };
        LinkSpec {
            parent,
            x_parent_joint: if random.chance(0.2) { turned } else { place },
            joint: LinkJoint::Moving { kind, axis, damping: 0.0 },
            inertia: inertia_of(&random.cloud()),
        }
    };
    [None, Some(0), Some(1)].map(|parent| link(random, parent)).to_vec()
}

/// Y of a tree without gravity or with it, at a random motion.
fn regressor(specs: &[LinkSpec], gravity: [f64; 3], motion: &[Vec<f64>; 4]) -> Vec<f64> {
    let tree = Tree::assemble(specs, gravity).unwrap().tree;
    let mut y = vec![0.0; 3 * tree.theta_len()];
    let [q, dq, z, dz] = motion;
    tree.regressor(&mut tree.scratch(), TwoVelocity { q, dq, z, dz }, &mut y).unwrap();
    y
}

#[test]
fn prop_y_of_a_tree_holds_exactly_the_lengths_that_are_said_to_be_in_it() {
    let mut random = Random::new(8);
    let mut seen = [0; 2];
    for round in 0..200 {
        let specs = orderly(&mut random);
        let gravity = if round % 2 == 0 { [0.0; 3] } else { random.vector(9.81) };
        let assembled = Tree::assemble(&specs, gravity).unwrap();
        let point = LinkPoint { link: assembled.anchors[2], at: random.vector(0.5) };
        let said = tip(&assembled, &point, Uncertain::Chain).in_regressor();
        assert_eq!(tip(&assembled, &point, Uncertain::Tool).in_regressor(), [false; 3]);
        assert_eq!(said[6..], [false; 3], "nothing sits on the tool");
        let motion = [1.5, 1.0, 1.0, 1.0].map(|scale| random.column(3, scale));
        let y = regressor(&specs, gravity, &motion);
        for joint in 1..3 {
            for k in 0..3 {
                let mut longer = specs.clone();
                longer[joint].x_parent_joint.translation[k] += 0.3;
                let longer = regressor(&longer, gravity, &motion);
                let apart = y.iter().zip(&longer).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                let inside = said[3 * (joint - 1) + k];
                assert_eq!(apart > 1e-6, inside, "round {round}, joint {joint}, entry {k}: {apart:e}, {specs:?}");
                assert!(inside || apart < 1e-12, "{apart:e}");
                seen[usize::from(inside)] += 1;
            }
        }
    }
    assert!(seen.iter().all(|seen| *seen > 300), "{seen:?}");
}
