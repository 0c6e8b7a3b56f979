//! From links and joints of the file to the robot that can be simulated.

use std::sync::Arc;

use forwardstep_core::LengthError;
use forwardstep_core::robot::Drives;
use forwardstep_core::robot::tree::{
    Anchor, Assembled, JointKind, LinkJoint, LinkSpec, MassMatrixError, Placement, Tree, TreeError, inertia_defects,
};
use forwardstep_sim::setup::{Axis, AxisUnit, RobotSetup};

use super::joint::{Joint, Motion, MotionKind};
use super::link::{Inertial, Link, Origin};
use super::notice::NoticeKind;
use super::problem::UrdfProblem;
use super::subject::Size;
use super::tree::Held;
use super::xml::{Located, Reading, UrdfError};
use super::{FrictionPolicy, UrdfOptions};

/// Moving joints accepted: the test of the mass matrix takes the third power of their number.
const MOST_MOVING: usize = 1000;

/// What moves.
pub(super) struct Moving {
    pub(super) robot: RobotSetup,
    /// The types of the joints, one per degree of freedom.
    pub(super) kinds: Vec<MotionKind>,
    /// Their Coulomb friction, N m or N.
    pub(super) coulomb: Vec<f64>,
    /// The links that moving joints carry, one per degree of freedom.
    pub(super) bodies: Vec<String>,
    /// The mass that is rigid with the base.
    pub(super) held_mass_kg: f64,
    /// Where the arranged links are held.
    pub(super) anchors: Vec<Anchor>,
}

/// A degree of freedom: where its link stands in the arranged list, and its joint.
struct Freedom<'a> {
    held: usize,
    joint: &'a Joint,
    motion: &'a Motion,
}

/// Builds the robot from the arranged links.
pub(super) fn build(
    reading: &mut Reading<'_>,
    links: &[Link],
    joints: &[Joint],
    arranged: &[Held],
    locks: &[Option<f64>],
    options: &UrdfOptions,
) -> Result<Moving, UrdfError> {
    let freedoms = freedoms(joints, arranged, locks);
    if freedoms.is_empty() {
        let locked = locks.iter().flatten().count();
        return Err(reading.error_overall(UrdfProblem::NothingMoves { fixed: joints.len() - locked, locked }));
    }
    if freedoms.len() > MOST_MOVING {
        let problem = UrdfProblem::TooLarge { size: Size::MovingJoints, most: MOST_MOVING };
        return Err(reading.error_overall(problem));
    }
    look_at_joints(reading, joints, locks, options.friction)?;

    let specs = link_specs(reading, links, joints, arranged, locks)?;
    let carrier = carriers(arranged, &freedoms);
    let held_mass_kg = look_at_base(reading, links, arranged, &carrier);
    let assembled = Tree::assemble(&specs, options.gravity)
        .map_err(|error| tree_error(reading, error, |spec| &links[arranged[spec].link]))?;
    if let Some(k) = assembled.theta.iter().position(|entry| !entry.is_finite()) {
        let link = &links[arranged[assembled.moving[k / 10]].link];
        return Err(reading.error(link.span.clone(), UrdfProblem::Overflow { link: link.name.clone() }));
    }
    let bodies: Vec<String> = assembled.moving.iter().map(|held| links[arranged[*held].link].name.clone()).collect();
    check_mass_matrix(reading, &assembled, &bodies, &freedoms, &options.armature)?;
    look_at_inertias(reading, links, arranged, &specs, &carrier);
    for (body, held) in assembled.moving.iter().enumerate() {
        if assembled.theta[10 * body] == 0.0 {
            let link = &links[arranged[*held].link];
            reading.notice(&link.span, NoticeKind::Massless { body: link.name.clone() });
        }
    }
    let theta_names =
        theta_names(&assembled, &bodies, &freedoms).map_err(|error| reading.error_overall(error.into()))?;
    let axes = freedoms.iter().map(|freedom| axis(freedom.joint, freedom.motion)).collect();
    let robot = RobotSetup { kind: Arc::new(Arc::new(assembled.tree)), theta: assembled.theta, theta_names, axes };
    let kinds = freedoms.iter().map(|freedom| freedom.motion.kind).collect();
    let coulomb =
        freedoms.iter().map(|freedom| freedom.motion.friction.as_ref().map_or(0.0, |friction| friction.value));
    let coulomb = coulomb.collect();
    Ok(Moving { robot, kinds, coulomb, bodies, held_mass_kg, anchors: assembled.anchors })
}

/// The kernels' error, at the link it is about.
fn tree_error<'l>(reading: &Reading<'_>, error: TreeError, link_of: impl Fn(usize) -> &'l Link) -> UrdfError {
    let at = match error {
        TreeError::ParentOrder { link, .. }
        | TreeError::NotFinite { link, .. }
        | TreeError::NotRotation { link, .. }
        | TreeError::ZeroAxis { link }
        | TreeError::AxisLength { link, .. }
        | TreeError::NegativeDamping { link, .. } => Some(link_of(link)),
        TreeError::NothingMoves { .. } | TreeError::Gravity { .. } => None,
    };
    let problem = UrdfProblem::Tree { link: at.map(|link| link.name.clone()), error };
    match at {
        Some(link) => reading.error(link.span.clone(), problem),
        None => reading.error_overall(problem),
    }
}

/// Refuses a robot that some motion costs no energy, be it that of a rotor.
fn check_mass_matrix(
    reading: &Reading<'_>,
    assembled: &Assembled,
    bodies: &[String],
    freedoms: &[Freedom<'_>],
    armature: &[f64],
) -> Result<(), UrdfError> {
    // Whether there are as many as joints is for who gives the robot its drives.
    let own = |joint: usize| armature.get(if armature.len() == 1 { 0 } else { joint }).copied();
    let rotors = (0..freedoms.len()).filter_map(|joint| Some((joint, own(joint).filter(|armature| *armature > 0.0)?)));
    let (geared, armatures): (Vec<usize>, Vec<f64>) = rotors.unzip();
    let drives = Drives { geared, ..assembled.tree.drives().clone() };
    let tree = assembled.tree.clone().with_drives(drives).unwrap_or_else(|_| assembled.tree.clone());
    let theta = [&assembled.theta[..], &armatures].concat();
    let anywhere = [f64::NEG_INFINITY, f64::INFINITY];
    let range: Vec<[f64; 2]> = freedoms.iter().map(|f| f.motion.position_limits.unwrap_or(anywhere)).collect();
    let samples = if freedoms.len() <= 64 { 16 } else { 2 };
    match tree.check_mass_matrix(&theta, &range, samples) {
        Ok(()) => Ok(()),
        Err(MassMatrixError::NotPositiveDefinite { body, pivot, q, .. }) => {
            let Freedom { joint, motion, .. } = &freedoms[body];
            let unit = if motion.kind == MotionKind::Prismatic { "kg" } else { "kg m²" };
            let problem = UrdfProblem::NotPositiveDefinite {
                joint: joint.name.clone(),
                body: bodies[body].clone(),
                pivot,
                unit,
                q: q.into(),
            };
            Err(reading.error(joint.span.clone(), problem))
        }
        Err(MassMatrixError::Length(error)) => Err(reading.error_overall(error.into())),
    }
}

/// Notes implausible inertias of links that move.
fn look_at_inertias(
    reading: &mut Reading<'_>,
    links: &[Link],
    arranged: &[Held],
    specs: &[LinkSpec],
    carrier: &[Option<usize>],
) {
    // How large a link is: how far it reaches from the joint before it, or to any joint after it.
    let mut sizes = vec![0.0_f64; specs.len()];
    for (k, spec) in specs.iter().enumerate() {
        let [x, y, z] = spec.x_parent_joint.translation;
        let distance = x.hypot(y).hypot(z);
        sizes[k] = sizes[k].max(distance);
        if let Some(parent) = spec.parent {
            sizes[parent] = sizes[parent].max(distance);
        }
    }
    for (k, spec) in specs.iter().enumerate() {
        let link = &links[arranged[k].link];
        if let (Some(_), Some(inertial)) = (carrier[k], &link.inertial) {
            for defect in inertia_defects(&spec.inertia, sizes[k]) {
                reading.notice(&inertial.span, NoticeKind::Implausible { link: link.name.clone(), defect });
            }
        }
    }
}

/// Inertias are named after the link that leads the body, dampings after the joint.
fn theta_names(assembled: &Assembled, bodies: &[String], freedoms: &[Freedom<'_>]) -> Result<Vec<String>, LengthError> {
    let bodies: Vec<&str> = bodies.iter().map(String::as_str).collect();
    let mut names = assembled.tree.theta_names(&bodies)?;
    for (name, joint) in names.iter_mut().skip(10 * bodies.len()).zip(&assembled.tree.drives().damped) {
        if let Some(((_, quantity), freedom)) = name.rsplit_once('.').zip(freedoms.get(*joint)) {
            *name = format!("{}.{quantity}", freedom.joint.name);
        }
    }
    Ok(names)
}

/// The joints that move, in the order of their links.
fn freedoms<'a>(joints: &'a [Joint], arranged: &[Held], locks: &[Option<f64>]) -> Vec<Freedom<'a>> {
    let mut freedoms = Vec::new();
    for (held, Held { joint, .. }) in arranged.iter().enumerate() {
        let Some(j) = *joint else { continue };
        if let (Some(motion), None) = (&joints[j].motion, locks[j]) {
            freedoms.push(Freedom { held, joint: &joints[j], motion });
        }
    }
    freedoms
}

/// Refuses or notes what is left out: Coulomb friction, unless it is read, and mimicry. In the order of the file.
fn look_at_joints(
    reading: &mut Reading<'_>,
    joints: &[Joint],
    locks: &[Option<f64>],
    policy: FrictionPolicy,
) -> Result<(), UrdfError> {
    if policy == FrictionPolicy::Refuse {
        let free = joints.iter().zip(locks).filter(|(_, lock)| lock.is_none());
        refuse_friction(reading, free.map(|(joint, _)| joint));
        reading.end()?;
    }
    let mut left_out = Vec::new();
    let mut first = None;
    for (joint, _) in joints.iter().zip(locks).filter(|(_, lock)| lock.is_none()) {
        let Some(motion) = &joint.motion else { continue };
        if let Some(friction) = &motion.friction {
            let (name, value) = (joint.name.clone(), friction.value);
            if policy == FrictionPolicy::Ignore {
                left_out.push((name, value));
                first.get_or_insert_with(|| friction.span.clone());
            }
        }
        if let Some(mimic) = &motion.mimic {
            let kind = NoticeKind::MimicFree { joint: joint.name.clone(), leader: mimic.value.clone() };
            reading.notice(&mimic.span, kind);
        }
    }
    if let Some(span) = first {
        reading.notice(&span, NoticeKind::FrictionIgnored { joints: left_out });
    }
    Ok(())
}

/// Notes all friction of these joints as mistakes.
pub(super) fn refuse_friction<'j>(reading: &mut Reading<'_>, joints: impl Iterator<Item = &'j Joint>) {
    for joint in joints {
        if let Some(Located { value, span }) = joint.motion.as_ref().and_then(|motion| motion.friction.clone()) {
            let problem = UrdfProblem::Friction { joint: joint.name.clone(), friction: value };
            reading.noted::<()>(Err(reading.error(span, problem)));
        }
    }
}

/// The arranged links as the kernels want them: locked joints are fixed joints elsewhere.
fn link_specs(
    reading: &Reading<'_>,
    links: &[Link],
    joints: &[Joint],
    arranged: &[Held],
    locks: &[Option<f64>],
) -> Result<Vec<LinkSpec>, UrdfError> {
    let mut specs = Vec::with_capacity(arranged.len());
    for held in arranged {
        let link = &links[held.link];
        let inertia = link.inertial.as_ref().map_or([0.0; 10], inertia_about_link);
        if let (false, Some(inertial)) = (inertia.iter().all(|entry| entry.is_finite()), &link.inertial) {
            let problem = UrdfProblem::Overflow { link: link.name.clone() };
            return Err(reading.error(inertial.span.clone(), problem));
        }
        let (origin, joint, lock) = match held.joint {
            None => (Origin::default(), LinkJoint::Fixed, None),
            Some(j) => (joints[j].origin, joints[j].motion.as_ref().map_or(LinkJoint::Fixed, moving), locks[j]),
        };
        let x_parent_joint = Placement::from_xyz_rpy(origin.xyz, origin.rpy);
        let spec = LinkSpec { parent: held.parent, x_parent_joint, joint, inertia };
        specs.push(lock.map_or(spec, |value| spec.locked(value)));
    }
    Ok(specs)
}

/// π of a link about its own frame.
fn inertia_about_link(inertial: &Inertial) -> [f64; 10] {
    let [xx, xy, yy, xz, yz, zz] = inertial.inertia;
    let about_com = [inertial.mass, 0.0, 0.0, 0.0, xx, xy, yy, xz, yz, zz];
    Placement::from_xyz_rpy(inertial.origin.xyz, inertial.origin.rpy).inertia(&about_com)
}

fn moving(motion: &Motion) -> LinkJoint {
    let kind = match motion.kind {
        MotionKind::Prismatic => JointKind::Prismatic,
        MotionKind::Revolute | MotionKind::Continuous => JointKind::Revolute,
    };
    LinkJoint::Moving { kind, axis: motion.axis, damping: motion.damping }
}

fn axis(joint: &Joint, motion: &Motion) -> Axis {
    let unit = match motion.kind {
        MotionKind::Prismatic => AxisUnit::Metre,
        MotionKind::Revolute | MotionKind::Continuous => AxisUnit::Radian,
    };
    Axis {
        name: joint.name.clone(),
        unit,
        position_limits: motion.position_limits,
        velocity_limit: motion.velocity_limit,
        effort_limit: motion.effort_limit,
    }
}

/// For every arranged link the degree of freedom whose body it is part of; `None` for the base's.
fn carriers(arranged: &[Held], freedoms: &[Freedom<'_>]) -> Vec<Option<usize>> {
    let mut carrier: Vec<Option<usize>> = vec![None; arranged.len()];
    let mut next = 0;
    for (k, held) in arranged.iter().enumerate() {
        if freedoms.get(next).is_some_and(|freedom| freedom.held == k) {
            carrier[k] = Some(next);
            next += 1;
        } else {
            carrier[k] = held.parent.and_then(|parent| carrier[parent]);
        }
    }
    carrier
}

/// Notes the inertia that does not enter because it is rigid with the base, and adds up its mass.
fn look_at_base(reading: &mut Reading<'_>, links: &[Link], arranged: &[Held], carrier: &[Option<usize>]) -> f64 {
    let mut names = Vec::new();
    let mut mass = 0.0;
    let mut first = None;
    for (held, _) in arranged.iter().zip(carrier).filter(|(_, carrier)| carrier.is_none()) {
        if let Some(inertial) = links[held.link].inertial.as_ref().filter(|inertial| inertial.mass > 0.0) {
            names.push(links[held.link].name.clone());
            mass += inertial.mass;
            first.get_or_insert_with(|| inertial.span.clone());
        }
    }
    if let Some(span) = first {
        reading.notice(&span, NoticeKind::HeldByBase { links: names, mass });
    }
    mass
}
