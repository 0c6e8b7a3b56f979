//! A constant matrix N that is at least M(q)⁻¹ at every q, for any tree, however far its prismatic joints reach.
//!
//! Let v_i be the velocity of the centre of mass of body i, ω_i its angular velocity, m_i and I_i its mass and its inertia about that
//! centre. Twice the kinetic energy is q̇ᵀM q̇ = Σ m_i |v_i|² + ω_iᵀI_i ω_i = ξᵀW ξ for ξ = B(q) q̇ that stacks all v_i and ω_i. If
//! G B(q) = 1, then q̇ = G ξ, and by Cauchy and Schwarz
//!
//! ```text
//! (uᵀq̇)² = (uᵀG ξ)² ≤ (uᵀG W⁻¹Gᵀu) (ξᵀW ξ)   for all u, q̇,   hence   M(q)⁻¹ ⪯ N = G W⁻¹Gᵀ
//! ```
//!
//! G is chosen so that N does not depend on q. With a the axis of joint i, which body i and the body p that carries it both see at
//! rest:
//!
//! - revolute: ω_i = ω_p + a q̇_i, so q̇_i = a·ω_i − a·ω_p;
//! - prismatic: v_i = v_p + ω_p × (d + a q_i) + a q̇_i, where d leads from one centre of mass to the other at q_i = 0. In the direction
//!   of a the extension drops out, since a·(ω_p × a) = 0: q̇_i = a·v_i − a·v_p − (d × a)·ω_p.
//!
//! Bodies that prismatic joints connect turn together. They are a *group* with one ω and the sum of their inertias, constant in the
//! axes of the group, in which every a and d is constant too. The entries of N are sums over what two joints share (ω of a group, v of
//! a body) of products of vectors that one and the same group sees at rest: constants. Whatever no joint uses is left out of ξᵀW ξ,
//! which may only make it smaller, as no mass is negative. Where more is known, more is used:
//!
//! - the base stands still, and so does ω of the group that it carries;
//! - the group of a revolute joint on the base, or on what only slides, turns about a fixed direction: ω = a q̇_i, and of its inertia
//!   the moment about a counts. If the base carries the joint itself, that body turns about a fixed line, and its moment about that
//!   line counts, with which its v is used up;
//! - the rotor of a joint with an armature J turns with the rate q̇_i whatever the bodies do: q̇_i is in ξ with the weight J, and is taken
//!   from there where the bodies say less. A body that is left out so must have no negative moment;
//! - a group whose moments about two axes vanish or are not known, as those of a thin rod may, still has one about its joint, which is
//!   enough where all joints on it are parallel and nothing couples that axis to the others.
//!
//! N is computed by intervals from ϑ and the tree. Its matrices that should be rotations are so but for rounding: what is bounded is M
//! of the robot with the rotation nearest to each, whose joint axis is exactly the one that is stored.

use alloc::vec;
use alloc::vec::Vec;

use super::model::{Body, Tree};
use super::physical::about_centre;
use super::spatial::{Inertia, Mat3, Sym3, Vec3};
use super::{JointKind, Placement};
use crate::LengthError;
use crate::expression::Interval;
use crate::robot::enclosed::Enclosed;
use crate::robot::inertia_bound::InertiaBound;

type Vector = Vec3<Interval>;

/// A body in the axes of its group, all prismatic joints at zero.
struct Part {
    group: usize,
    /// From the inner frame of the body.
    rotation: Mat3<Interval>,
    /// Of the inner frame, from the origin of the group.
    origin: Vector,
    centre: Vector,
    mass: Interval,
    /// Whether it turns about a line that stands still, through the origin of its group.
    anchored: bool,
}

/// Bodies that turn together.
struct Group {
    /// About the centres of mass of its bodies.
    inertia: Sym3<Interval>,
    /// The moment about its z axis, if it turns about nothing else.
    about_axis: Option<Interval>,
}

/// What a joint's velocity is made of.
#[derive(Clone, Copy, PartialEq)]
enum Source {
    /// v of a body.
    Slide(usize),
    /// ω of a group.
    Turn(usize),
    /// q̇ of a joint, as its rotor has it; of vectors, the z axis stands for it.
    Rotor(usize),
}

/// A row of G: what is taken of each source.
type Row = Vec<(Source, Vector)>;

/// The inverse of the weight of a source.
enum Inverse {
    /// 1/m.
    Number(Interval),
    /// 1/J, for the z axis alone.
    Axis(Interval),
    /// I⁻¹.
    Full(Sym3<Interval>),
}

impl Tree {
    /// A bound of M(q) for all q, by the derivation at the head of this file; `None` where it needs masses or inertias that are not
    /// positive. What remains then is to look at ranges of q.
    ///
    /// # Errors
    /// [`LengthError`] when `theta` has the wrong length.
    pub fn inertia_bound(&self, theta: &[f64]) -> Result<Option<InertiaBound>, LengthError> {
        LengthError::check("theta", self.theta_len(), theta.len())?;
        let bound = |moving: &Moving| InertiaBound::by_inverses(vec![moving.inverse_bound()?]);
        Ok(Moving::of(self, theta).and_then(|moving| {
            let by_bodies = bound(&moving);
            let with_rotors = moving.with_rotors().and_then(|moving| bound(&moving));
            let (least, most) =
                (by_bodies.as_ref().map(InertiaBound::least), with_rotors.as_ref().map(InertiaBound::least));
            if most > least { with_rotors } else { by_bodies }
        }))
    }
}

/// The bodies, their groups and the rows of G.
struct Moving {
    parts: Vec<Part>,
    /// The first is the base.
    groups: Vec<Group>,
    rows: Vec<Row>,
    /// The armatures of the joints, where there are any.
    armatures: Vec<Option<f64>>,
}

impl Moving {
    fn of(tree: &Tree, theta: &[f64]) -> Option<Self> {
        let base = Group { inertia: Sym3::ZERO, about_axis: None };
        let armatures = tree.bodies.iter().map(|body| theta.get(body.armature?).copied()).collect();
        let mut moving = Moving { parts: Vec::new(), groups: vec![base], rows: Vec::new(), armatures };
        for (body, pi) in tree.bodies.iter().zip(theta.as_chunks::<10>().0) {
            match body.kind {
                JointKind::Revolute => moving.turn(body, pi)?,
                JointKind::Prismatic => moving.slide(body, pi)?,
            }
        }
        Some(moving)
    }

    /// The group, the rotation and the origin of what carries a body.
    fn carrier(&self, body: &Body) -> (usize, Mat3<Interval>, Vector) {
        match body.parent_slot.checked_sub(1).and_then(|parent| self.parts.get(parent)) {
            Some(Part { group, rotation, origin, .. }) => (*group, *rotation, *origin),
            None => (0, Mat3::splat(&Placement::IDENTITY.rotation), Vec3::ZERO),
        }
    }

    /// A body on a revolute joint: a group of its own.
    fn turn(&mut self, body: &Body, pi: &[f64; 10]) -> Option<()> {
        let inertia = body.enclosed_inertia(pi);
        let (centre, central) = central(&inertia)?;
        let (carrier, rotation, _) = self.carrier(body);
        let axis = rotation.times(enclosed_rotation(&body.rotation).z);
        let sign = Interval::point(body.sign);
        let (group, anchored) = (self.groups.len(), body.parent_slot == 0);
        let mut row = vec![(Source::Turn(group), Vec3::new(Interval::point(0.0), Interval::point(0.0), sign))];
        if carrier > 0 {
            row.push((Source::Turn(carrier), axis.scaled(-sign)));
        }
        self.rows.push(row);
        let moment = if anchored { inertia.i.zz } else { central.zz };
        self.groups.push(Group { inertia: central, about_axis: (carrier == 0).then_some(moment) });
        let rotation = Mat3::splat(&Placement::IDENTITY.rotation);
        self.parts.push(Part { group, rotation, origin: Vec3::ZERO, centre, mass: inertia.m, anchored });
        Some(())
    }

    /// A body on a prismatic joint: it joins the group that carries it.
    fn slide(&mut self, body: &Body, pi: &[f64; 10]) -> Option<()> {
        let inertia = body.enclosed_inertia(pi);
        let (centre, central) = central(&inertia)?;
        let (group, carrier, origin) = self.carrier(body);
        let rotation = carrier.product(&enclosed_rotation(&body.rotation));
        let origin = carrier.times_plus(Vec3::splat(body.translation), origin);
        let centre = rotation.times_plus(centre, origin);
        let axis = rotation.z.scaled(Interval::point(body.sign));
        let parent = body.parent_slot.checked_sub(1);
        let held = parent.and_then(|parent| self.parts.get(parent).filter(|part| !part.anchored).map(|_| parent));
        let mut row = vec![(Source::Slide(self.parts.len()), axis)];
        if let Some(parent) = held {
            row.push((Source::Slide(parent), axis.scaled(Interval::point(-1.0))));
        }
        if group > 0 {
            let from = held.map_or(Vec3::ZERO, |parent| self.parts[parent].centre);
            let d = centre.plus(from.scaled(Interval::point(-1.0)));
            row.push((Source::Turn(group), axis.cross(d)));
            let central = central.turned(&rotation);
            let whole = &mut self.groups[group];
            whole.inertia = whole.inertia.plus(&central);
            whole.about_axis = whole.about_axis.map(|moment| moment + central.zz);
        }
        self.rows.push(row);
        self.parts.push(Part { group, rotation, origin, centre, mass: inertia.m, anchored: false });
        Some(())
    }

    /// With the rates of rotors in the place of those of bodies, wherever N has less on its diagonal so, or nothing otherwise; `None`
    /// without rotors.
    fn with_rotors(mut self) -> Option<Self> {
        self.armatures.iter().flatten().next()?;
        for joint in 0..self.rows.len() {
            let unit = Vec3::new(Interval::point(0.0), Interval::point(0.0), Interval::point(1.0));
            let by_rotor = vec![(Source::Rotor(joint), unit)];
            let Some(least) = self.shared(&by_rotor, &by_rotor) else { continue };
            let by_bodies = self.shared(&self.rows[joint], &self.rows[joint]);
            if by_bodies.is_none_or(|own| own.high > least.high) {
                self.rows[joint] = by_rotor;
            }
        }
        Some(self)
    }

    /// Whether what no joint uses adds nothing negative to ξᵀW ξ.
    fn leaves_nothing_negative(&self) -> bool {
        let used = |group| self.rows.iter().flatten().any(|(source, _)| *source == Source::Turn(group));
        let sound = |Group { inertia, about_axis }: &Group| match about_axis {
            Some(moment) => moment.low >= 0.0,
            None => inverted(inertia).is_some() || (stands_alone(inertia) && inertia.zz.low >= 0.0),
        };
        self.groups.iter().enumerate().skip(1).all(|(group, own)| used(group) || sound(own))
    }

    /// What two rows have in common: Σ aᵀ W⁻¹ b over the sources of both.
    fn shared(&self, one: &Row, other: &Row) -> Option<Interval> {
        let mut sum = Interval::point(0.0);
        for (source, a) in one {
            for (_, b) in other.iter().filter(|(other, _)| other == source) {
                sum = sum + self.weight(*source)?.form(*a, *b);
            }
        }
        Some(sum)
    }

    /// N.
    fn inverse_bound(&self) -> Option<Enclosed> {
        let n = self.rows.len();
        let mut bound = Enclosed::zero(n);
        if !self.leaves_nothing_negative() {
            return None;
        }
        for i in 0..n {
            for k in 0..=i {
                bound.set(i, k, self.shared(&self.rows[i], &self.rows[k])?);
            }
        }
        Some(bound)
    }

    /// The inverse of the weight of a source, where it has one.
    fn weight(&self, source: Source) -> Option<Inverse> {
        let one = Interval::point(1.0);
        let positive = |weight: Interval| (weight.low > 0.0).then(|| one / weight);
        match source {
            Source::Slide(body) => positive(self.parts[body].mass).map(Inverse::Number),
            Source::Rotor(joint) => positive(Interval::point(self.armatures[joint]?)).map(Inverse::Number),
            Source::Turn(group) => {
                let Group { inertia, about_axis } = &self.groups[group];
                if let Some(moment) = about_axis {
                    return positive(*moment).map(Inverse::Axis);
                }
                match inverted(inertia) {
                    Some(inverse) => Some(Inverse::Full(inverse)),
                    None if self.uses_axis_alone(group) && stands_alone(inertia) => {
                        positive(inertia.zz).map(Inverse::Axis)
                    }
                    None => None,
                }
            }
        }
    }

    /// Whether nothing of the ω of a group is taken but along its z axis.
    fn uses_axis_alone(&self, group: usize) -> bool {
        let mut taken = self.rows.iter().flatten().filter(|(source, _)| *source == Source::Turn(group));
        taken.all(|(_, a)| is_zero(a.x) && is_zero(a.y))
    }
}

impl Inverse {
    /// aᵀ W⁻¹ b.
    fn form(&self, a: Vector, b: Vector) -> Interval {
        match self {
            Inverse::Number(number) => a.dot(b) * *number,
            Inverse::Axis(number) => a.z * b.z * *number,
            Inverse::Full(inverse) => a.dot(inverse.full().times(b)),
        }
    }
}

/// The centre of mass and the inertia about it; `None` for what no body has.
fn central(inertia: &Inertia<Interval>) -> Option<(Vector, Sym3<Interval>)> {
    let Inertia { m, h, i } = *inertia;
    if m.low > 0.0 {
        let centre = Vec3 { x: h.x / m, y: h.y / m, z: h.z / m };
        return Some((centre, about_centre(m, h, i)));
    }
    // Without mass there is no moment: about every point the inertia is the same.
    let nothing = is_zero(m) && [h.x, h.y, h.z].into_iter().all(is_zero);
    nothing.then_some((Vec3::ZERO, i))
}

/// The inverse of a positive definite matrix, by its minors.
fn inverted(a: &Sym3<Interval>) -> Option<Sym3<Interval>> {
    let rows = vec![a.xx, a.xy, a.xz, a.xy, a.yy, a.yz, a.xz, a.yz, a.zz];
    Enclosed::from_rows(3, rows).filter(Enclosed::is_positive)?;
    let minor = |p: Interval, q: Interval, r: Interval, s: Interval| p * q - r * s;
    let (xx, xy, xz) = (minor(a.yy, a.zz, a.yz, a.yz), minor(a.xz, a.yz, a.xy, a.zz), minor(a.xy, a.yz, a.xz, a.yy));
    let determinant = a.xx * xx + a.xy * xy + a.xz * xz;
    let by = |minor: Interval| minor / determinant;
    let inverse = Sym3 {
        xx: by(xx),
        xy: by(xy),
        xz: by(xz),
        yy: by(minor(a.xx, a.zz, a.xz, a.xz)),
        yz: by(minor(a.xy, a.xz, a.xx, a.yz)),
        zz: by(minor(a.xx, a.yy, a.xy, a.xy)),
    };
    (determinant.low > 0.0).then_some(inverse)
}

/// Whether ωᵀA ω ≥ A_zz ω_z²: nothing couples z to x and y, and these have no negative moment.
fn stands_alone(a: &Sym3<Interval>) -> bool {
    let apart = [a.xy, a.xz, a.yz].into_iter().all(is_zero);
    apart && a.xx.low >= 0.0 && a.yy.low >= 0.0
}

fn is_zero(x: Interval) -> bool {
    x == Interval::point(0.0)
}

/// Holds a rotation whose z axis is that of `rows` at length one, within the interval by which it is known.
///
/// With F = |EᵀE − 1| by Frobenius' norm, the z column is off the unit length by F at most, the other two off unit length and off its
/// normal plane by as much, and off each other's; taking these parts away in turn moves no entry by more than 4 F.
pub(super) fn enclosed_rotation(rows: &[[f64; 3]; 3]) -> Mat3<Interval> {
    let e = Mat3::<Interval>::splat(rows);
    let off = |dot: Interval, is: f64| (dot - Interval::point(is)).size();
    let on = off(e.x.dot(e.x), 1.0) + off(e.y.dot(e.y), 1.0) + off(e.z.dot(e.z), 1.0);
    let beside = off(e.x.dot(e.y), 0.0) + off(e.x.dot(e.z), 0.0) + off(e.y.dot(e.z), 0.0);
    // The sum of sizes exceeds Frobenius' norm by more than it is rounded, unless all are zero.
    let room = 4.0 * (on + 2.0 * beside) * (1.0 + 1e-12);
    let room = Interval { low: -room, high: room };
    let wide = |v: Vector| Vec3 { x: v.x + room, y: v.y + room, z: v.z + room };
    let length = e.z.dot(e.z).root();
    let z = Vec3 { x: e.z.x / length, y: e.z.y / length, z: e.z.z / length };
    Mat3 { x: wide(e.x), y: wide(e.y), z }
}
