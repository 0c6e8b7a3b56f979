//! The kinematics of an arm as the page evaluates them: joints in the frames of the bodies that carry them, and what is drawn
//! between them. Nothing here depends on time: the page holds joint values and computes the rest.
//!
//! The frames come from the tree's own kinematics. With all joints at zero, the places of a body's origin o and of the tips of its
//! axes give its frame R in the base; the velocities of these points at the unit rate of its own joint give the axis:
//!
//! ```text
//! revolute:   v_x = a × e_x,  v_y = a × e_y   ⇒   a = (v_y·e_z, −v_x·e_z, v_x·e_y)  in the axes of the body
//! prismatic:  a = Rᵀ v_o
//! ```
//!
//! so that T_k(q) = T_parent(q) · P_k · J(a_k, q_k), with P_k the frame at zero in that of the parent.

use forwardstep_core::LengthError;
use forwardstep_core::robot::tree::{Anchor, JointKind, LinkPoint, Placement, Tree};
use serde::Serialize;

use crate::shapes::Part;

/// Numbers of ϑ for every body: its mass, its mass times the centre of mass, its inertia.
const OF_BODY: usize = 10;
/// Shorter than this share of the whole arm, a link past its last joint would not be seen.
const SHORTEST: f64 = 0.04;

/// A joint with what it carries.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct JointScene {
    /// The joint before it; none on the base.
    parent: Option<usize>,
    /// Turns; slides otherwise.
    turns: bool,
    /// A unit vector in its own frame.
    axis: [f64; 3],
    /// Its frame at zero in that of the parent: rotation row by row, then translation.
    place: ([[f64; 3]; 3], [f64; 3]),
}

/// An arm without its joint values.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct ArmScene {
    joints: Vec<JointScene>,
    /// What a leaf ends in: its joint, and the end in the frame of that joint.
    ends: Vec<(usize, [f64; 3])>,
    /// The point whose path is drawn: a joint, and the point in its frame.
    tip: Option<(usize, [f64; 3])>,
    /// Whether where that is was estimated from the centre of mass.
    guessed: bool,
    /// The lengths of all links together, m.
    reach: f64,
    /// Whether it moves in one upright plane.
    planar: bool,
    /// What its links look like, as far as that is known.
    parts: Vec<Part>,
}

impl ArmScene {
    /// Of a tree; the tip is `tip` where the law has one, and the end of the last link otherwise: the last of what it holds, or as far beyond its
    /// centre of mass as a rod would end.
    pub(super) fn of_tree(tree: &Tree, theta: &[f64], tip: Option<(usize, [f64; 3])>) -> Result<ArmScene, LengthError> {
        let frames = (0..tree.joint_count()).map(|body| frame(tree, body)).collect::<Result<Vec<_>, _>>()?;
        let parents: Vec<Option<usize>> = tree.parents().collect();
        let kinds: Vec<JointKind> = tree.joint_kinds().collect();
        let joint = |body: usize| {
            let (own, axis) = &frames[body];
            let base = parents[body].and_then(|parent| frames.get(parent)).map_or(Placement::IDENTITY, |it| it.0);
            let place = base.inverse().compose(own);
            JointScene {
                parent: parents[body],
                turns: kinds[body] == JointKind::Revolute,
                axis: *axis,
                place: (place.rotation, place.translation),
            }
        };
        let joints: Vec<JointScene> = (0..frames.len()).map(joint).collect();
        let inner: f64 = joints.iter().map(|joint| size(joint.place.1)).sum();
        let guess = |body: usize| beyond_centre(theta.get(OF_BODY * body..OF_BODY * (body + 1)), inner);
        let leaves = (0..joints.len()).filter(|body| !parents.contains(&Some(*body)));
        let ends = leaves.map(|body| match tip {
            Some((carried, at)) if carried == body => (body, at),
            _ => (body, tree.end_of(body).unwrap_or_else(|| guess(body))),
        });
        let ends: Vec<(usize, [f64; 3])> = ends.collect();
        let outer: f64 = ends.iter().map(|end| size(end.1)).sum();
        let reach = inner + outer;
        let last = ends.last().copied();
        let guessed = tip.is_none() && last.is_some_and(|(body, _)| tree.end_of(body).is_none());
        Ok(ArmScene { joints, tip: tip.or(last), guessed, ends, reach, planar: false, parts: Vec::new() })
    }

    /// Of the planar arm, whose plane stands upright.
    pub(super) fn planar([inner, outer]: [f64; 2]) -> ArmScene {
        // x along the link, z out of the plane: what is up in the plane is z of the base.
        let upright = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]];
        let flat = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let joint = |parent, rotation, x| JointScene {
            parent,
            turns: true,
            axis: [0.0, 0.0, 1.0],
            place: (rotation, [x, 0.0, 0.0]),
        };
        let end = (1, [outer, 0.0, 0.0]);
        ArmScene {
            joints: vec![joint(None, upright, 0.0), joint(Some(0), flat, inner)],
            ends: vec![end],
            tip: Some(end),
            guessed: false,
            reach: inner + outer,
            planar: true,
            parts: Vec::new(),
        }
    }

    /// With these shapes on its links.
    pub(super) fn with(self, parts: &[Part]) -> ArmScene {
        let joints = self.joints.len();
        let is_held = |part: &&Part| part.body.is_none_or(|body| body < joints);
        ArmScene { parts: parts.iter().filter(is_held).copied().collect(), ..self }
    }
}

/// The lengths of a planar arm of which only ϑ is known: of two uniform rods, under the usual gravity. Then ϑ₃ = ½ m₂ l₁ l₂,
/// ϑ₂ = ⅓ m₂ l₂² and ϑ₅ = ½ g m₂ l₂.
pub(super) fn uniform_lengths(theta: &[f64]) -> [f64; 2] {
    const GRAVITY: f64 = 9.81;
    let &[_, second, mixed, _, weight, ..] = theta else { return [1.0, 1.0] };
    let lengths = [GRAVITY * mixed / weight, 1.5 * GRAVITY * second / weight];
    let known = lengths.iter().all(|length| length.is_finite() && (1e-3..1e3).contains(length));
    if known { lengths } else { [1.0, 1.0] }
}

/// The frame of a body with all joints at zero, and the axis of its joint in that frame.
fn frame(tree: &Tree, body: usize) -> Result<(Placement, [f64; 3]), LengthError> {
    let n = tree.joint_count();
    let (q, mut dq, mut scratch) = (vec![0.0; n], vec![0.0; n], tree.scratch());
    dq[body] = 1.0;
    let link = Anchor { body: Some(body), x_body_link: Placement::IDENTITY };
    let mut motion = |at| {
        let point = tree.point_motion(&mut scratch, &q, &dq, &LinkPoint { link, at })?;
        Ok::<_, LengthError>((point.position, point.velocity))
    };
    let (origin, moves) = motion([0.0; 3])?;
    let mut columns = [[0.0; 3]; 3];
    let mut rates = [[0.0; 3]; 3];
    for k in 0..3 {
        let mut at = [0.0; 3];
        at[k] = 1.0;
        let (position, velocity) = motion(at)?;
        columns[k] = minus(position, origin);
        rates[k] = minus(velocity, moves);
    }
    let rotation = [0, 1, 2].map(|row| columns.map(|column| column[row]));
    let along = |k: usize, v: [f64; 3]| dot(columns[k], v);
    let axis = match tree.joint_kinds().nth(body) {
        Some(JointKind::Revolute) => [along(2, rates[1]), -along(2, rates[0]), along(1, rates[0])],
        _ => [along(0, moves), along(1, moves), along(2, moves)],
    };
    Ok((Placement { rotation, translation: origin }, axis))
}

/// As far beyond the centre of mass as the joint is before it: where a uniform rod ends.
fn beyond_centre(body: Option<&[f64]>, reach: f64) -> [f64; 3] {
    let least = SHORTEST * if reach > 0.0 { reach } else { 1.0 };
    match body {
        Some(&[mass, x, y, z, ..]) if mass > 0.0 => {
            let end = [x, y, z].map(|moment| 2.0 * moment / mass);
            if end.iter().all(|entry| entry.is_finite()) && size(end) > least { end } else { [0.0; 3] }
        }
        _ => [0.0; 3],
    }
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn size(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use forwardstep_core::robot::{PlanarLinks, PlanarTip};

    /// Where the tip is, as the page computes it.
    fn tip(arm: &ArmScene, q: &[f64]) -> [f64; 3] {
        let mut frames: Vec<Placement> = Vec::new();
        for (joint, value) in arm.joints.iter().zip(q) {
            let parent = joint.parent.map_or(Placement::IDENTITY, |parent| frames[parent]);
            let kind = if joint.turns { JointKind::Revolute } else { JointKind::Prismatic };
            let place = Placement { rotation: joint.place.0, translation: joint.place.1 };
            frames.push(parent.compose(&place).compose(&Placement::of_joint(kind, joint.axis, *value)));
        }
        let (body, at) = arm.tip.unwrap();
        frames[body].point(at)
    }

    fn near(a: [f64; 3], b: [f64; 3]) {
        assert!(size(minus(a, b)) < 1e-13, "{a:?} {b:?}");
    }

    #[test]
    fn trees_are_drawn_where_they_are() {
        for name in ["ur5e", "panda"] {
            let text = crate::urdf::shipped_robot(name).unwrap();
            let robot = crate::read_urdf(&crate::SourceText::new(name, text), &crate::UrdfOptions::default()).unwrap();
            let (tree, theta) =
                (robot.robot.kind.downcast::<std::sync::Arc<Tree>>().unwrap().clone(), robot.robot.theta);
            let n = tree.joint_count();
            let at = [0.03, -0.2, 0.1];
            let arm = ArmScene::of_tree(&tree, &theta, Some((n - 1, at))).unwrap();
            let link = Anchor { body: Some(n - 1), x_body_link: Placement::IDENTITY };
            for seed in 0..20 {
                let q: Vec<f64> = (0..n).map(|k| 3.0 * ((7 * seed + 3 * k + 1) as f64).sin()).collect();
                let point = LinkPoint { link, at };
                let true_motion = tree.point_motion(&mut tree.scratch(), &q, &vec![0.0; n], &point).unwrap();
                near(tip(&arm, &q), true_motion.position);
            }
        }
    }

    /// The flange of a UR5e is 0.0996 m from its last joint, where a rod of its last link would end at twice that.
    #[test]
    fn regress_an_arm_ends_at_its_flange() {
        let text = crate::urdf::shipped_robot("ur5e").unwrap();
        let robot = crate::read_urdf(&crate::SourceText::new("ur5e", text), &crate::UrdfOptions::default()).unwrap();
        let tree = robot.robot.kind.downcast::<std::sync::Arc<Tree>>().unwrap().clone();
        let arm = ArmScene::of_tree(&tree, &robot.robot.theta, None).unwrap();
        let (body, at) = arm.tip.unwrap();
        assert_eq!(body, tree.joint_count() - 1);
        assert!((size(at) - 0.0996).abs() < 1e-12 && !arm.guessed, "{at:?}");
        assert!((0..body).all(|body| tree.end_of(body).is_none()));
    }

    #[test]
    fn planar_arms_are_drawn_upright() {
        let (length_m, q) = ([1.0, 0.8], [0.4, -1.1]);
        let ([x, y], _) = PlanarTip { length_m }.motion(q, [0.0, 0.0]);
        near(tip(&ArmScene::planar(length_m), &q), [x, 0.0, y]);
    }

    #[test]
    fn lengths_are_read_from_the_parameters_of_uniform_rods() {
        let theta = PlanarLinks::uniform([2.0, 1.5], [1.0, 0.8]).theta();
        let [inner, outer] = uniform_lengths(&theta);
        assert!((inner - 1.0).abs() < 1e-12 && (outer - 0.8).abs() < 1e-12, "{inner} {outer}");
        assert_eq!(uniform_lengths(&[1.0, 1.0, 1.0, 0.0, 0.0]), [1.0, 1.0], "no gravity");
    }

    #[test]
    fn a_rod_ends_as_far_beyond_its_centre_of_mass() {
        assert_eq!(beyond_centre(Some(&[2.0, 0.0, 0.0, -1.0]), 0.0), [0.0, 0.0, -1.0]);
        assert_eq!(beyond_centre(Some(&[0.0, 0.0, 0.0, -1.0]), 0.0), [0.0; 3]);
        assert_eq!(beyond_centre(None, 1.0), [0.0; 3]);
    }
}
