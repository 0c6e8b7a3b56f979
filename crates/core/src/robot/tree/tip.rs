//! The tip of a chain of joints as [`TipKinematics`]: which lengths are uncertain, and J by them.
//!
//! Let w_c be the translation from joint c to joint c + 1 in base coordinates, the last one from the last joint to the tip, and
//! a_c the axis of joint c. Then x = Σ_c w_c, and column c of J is
//!
//! ```text
//! revolute   a_c × W_c,   W_c = Σ of the w behind joint c         prismatic   a_c
//! ```
//!
//! w_c = E θ_c with E the orientation of the body that carries it, so J is linear in every translation, and with Ω the angular
//! velocity of that body
//!
//! ```text
//! ẇ_c = Ω × w_c + E θ_c'        ȧ_c = Ω × a_c        vᵀ J ξ by θ_c = Eᵀ (v × Ω(ξ))
//! ```
//!
//! where Ω(ξ) is Ω with ξ for q̇. What a prismatic joint adds to a translation is known. The place of the first joint on the
//! base is in x and not in J.
//!
//! Of a pose J has three rows more: column c is a_c for a revolute joint and zero for a prismatic one. They hold no length.
//!
//! # Which of these lengths the regressor holds
//!
//! Theorem 6 has unknown lengths and unknown ϑ apart: Y(q, q̇, z, ż) has to be known. Y of a tree holds the place p of each joint
//! in the frame of the body that carries it, and nothing else that could be θ: no body sits on the tool. In the recursion of
//! `motion` p stands in two places,
//!
//! ```text
//! a′ = Eᵀ(a + B p)          w′ = Eᵀ(w + σ × p)          B = [α] + ½ (u vᵀ + v uᵀ) − (u·v) 1
//! ```
//!
//! where σ, v, u, α belong to the carrying body. Let a_1 … a_r be the axes of the revolute joints up to that body; the angular
//! velocities σ, v, u are sums of them times numbers that are free, and α is such a sum and products of v with u.
//!
//! - r = 0: σ = v = u = α = 0, and no part of p is in Y.
//! - All a_k parallel, to a unit vector a that is then fixed in the carrying body (each of the joints turns about it): for p = a,
//!   σ × a = 0, α × a = 0, and ½ (u vᵀ + v uᵀ) a − (u·v) a = 0. So the part of p along a is not in Y, and any other part d is:
//!   let all joints rest but the last of them, s = ż; the coefficient of the mass behind, w·a, holds |σ × p|².
//! - Two axes that are not parallel: no direction is parallel to both, so every part of p is in Y by the same argument.
//!
//! Entry k of a translation is the part along axis k of the joint frame of the carrying body. It is not in Y exactly where r = 0 or
//! that axis is the common direction; see [`TreeTip::in_regressor`]. (Y itself is meant, for every ϑ. For some ϑ and without gravity
//! a wrong length can be made up for by another ϑ̂, but no theorem says so.)

use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use super::axes::Axes;
use super::follows::{Follows, MOST_JOINTS, TipError};
use super::model::{Body, Tree};
use super::motion::Seat;
use super::spatial::{Mat3, Vec3};
use super::turned::Turned;
use super::{JointKind, LinkPoint};
use crate::attitude::Quaternion;
use crate::expression::Interval;
use crate::robot::kinematics::{Posture, TipKinematics};
use crate::{Kernel, LengthError, dispatch, trig};

/// Which translations are θ.
///
/// The dynamics of a tree are stated with its geometry, so a law that is to be true to the robot knows all of it but a tool:
/// choose [`Uncertain::Tool`]. [`Uncertain::Chain`] is for kinematics that are learnt apart from the dynamics: the law's Y keeps the
/// true translations, and those of them that [`TreeTip::in_regressor`] marks it would have to know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Uncertain {
    /// From the last joint to the tip: three numbers.
    Tool,
    /// From each joint to the next as well: three numbers for each joint.
    Chain,
}

/// The tip of a tree that is one chain of joints.
#[derive(Clone, Debug)]
pub struct TreeTip {
    tree: Tree,
    /// From the last joint to the tip, in the joint frame of the last body.
    tool: [f64; 3],
    /// Which of the coordinates of the base frame are controlled.
    coordinates: Vec<usize>,
    uncertain: Uncertain,
    /// Of a pose.
    turned: Option<Turned>,
}

/// The chain at one instant.
#[derive(Clone, Copy)]
struct Chain {
    /// w_c and its rate; entry 0 leads from the base to the first joint.
    w: [Vec3<f64>; MOST_JOINTS + 1],
    dw: [Vec3<f64>; MOST_JOINTS + 1],
    a: [Vec3<f64>; MOST_JOINTS],
    da: [Vec3<f64>; MOST_JOINTS],
}

impl TreeTip {
    /// For a point of a link; `coordinates` are numbers of axes of the base frame, x = 0, y = 1, z = 2.
    ///
    /// # Errors
    /// [`TipError`] when the joints are too few or too many for what is to follow, or one has no part in it.
    pub fn new(
        tree: Tree,
        point: &LinkPoint,
        coordinates: &[usize],
        follows: Follows,
        uncertain: Uncertain,
    ) -> Result<Self, TipError> {
        let joints = tree.bodies.len();
        follows.check(joints, coordinates)?;
        let mut carries = [false; MOST_JOINTS];
        let mut at = point.link.body.filter(|body| *body < joints);
        while let Some(body) = at {
            carries[body] = true;
            at = tree.bodies[body].parent_slot.checked_sub(1);
        }
        if let Some(joint) = carries.iter().take(joints).position(|carries| !carries) {
            return Err(TipError::Beside { joint });
        }
        // Every joint carries the tip, so each is held by the one before it.
        let turned = (follows == Follows::Pose).then(|| Turned::of(&tree, &point.link.x_body_link.rotation));
        let tool = point.link.x_body_link.point(point.at);
        Ok(TreeTip { tree, tool, coordinates: coordinates.to_vec(), uncertain, turned })
    }

    /// θ of the model itself.
    pub fn parameters(&self) -> Vec<f64> {
        let mut theta = Vec::with_capacity(self.parameter_count());
        if self.uncertain == Uncertain::Chain {
            for c in 1..self.tree.bodies.len() {
                let [x, y, z] = self.tree.bodies[c].translation;
                let held = self.tree.bodies[c - 1].outer_vector(Vec3 { x, y, z });
                theta.extend([held.x, held.y, held.z]);
            }
        }
        theta.extend(self.tool);
        theta
    }

    /// For each entry of θ whether Y(q, q̇, z, ż) of the tree depends on it, by the derivation at the head of this file.
    pub fn in_regressor(&self) -> Vec<bool> {
        let mut inside = Vec::with_capacity(self.parameter_count());
        let mut axes = Axes::Nothing;
        for c in 1..=self.tree.bodies.len() {
            let body = &self.tree.bodies[c - 1];
            axes = axes.carried_by(body);
            if self.place(c).is_none() {
                continue;
            }
            for k in 0..3 {
                let mut unit = [0.0; 3];
                unit[k] = 1.0;
                // Nothing sits on the tool.
                inside.push(c < self.tree.bodies.len() && axes.turn(body.inner_vector(Vec3::splat(unit))));
            }
        }
        inside
    }

    /// What the tip cannot leave: the place of the first joint in the frame of the base, m, and between which distances from it
    /// the tip is, m, rounded outwards. `None` where a joint slides.
    ///
    /// It is no farther than the sum of all lengths behind that joint, and no nearer than the longest less all others: lengths
    /// of a polygon. Where one coordinate is left out it may be nearer, unless all joints turn about that coordinate: then the
    /// lengths are those in the plane of the two others.
    pub fn reach(&self) -> Option<([f64; 3], [f64; 2])> {
        let bodies = &self.tree.bodies;
        let (first, rest) = bodies.split_first()?;
        let turning = bodies.iter().all(|body| body.kind == JointKind::Revolute);
        let flat = self.keeps_to_its_plane();
        let tool = bodies.last().map(|last| last.inner_vector(Vec3::splat(self.tool)))?;
        let (mut sum, mut longest) = (Interval::point(0.0), Interval::point(0.0));
        for [x, y, z] in rest.iter().map(|body| body.translation).chain([[tool.x, tool.y, tool.z]]) {
            let p = Vec3::<Interval>::splat([x, y, if flat { 0.0 } else { z }]);
            let length = p.dot(p).root();
            (sum, longest) = (sum + length, if length.low > longest.low { length } else { longest });
        }
        let least = if flat || self.coordinates.len() == 3 { (longest + longest - sum).low.max(0.0) } else { 0.0 };
        turning.then_some((first.translation, [least, sum.high]))
    }

    /// Whether two coordinates are controlled, and all joints turn about the third, without rounding.
    fn keeps_to_its_plane(&self) -> bool {
        let along = |body: &Body, axis: usize| (0..3).all(|k| (body.rotation[k][2] != 0.0) == (k == axis));
        let Some((first, rest)) = self.tree.bodies.split_first() else { return false };
        let left = (0..3).find(|axis| !self.coordinates.contains(axis));
        self.coordinates.len() == 2
            && left.is_some_and(|left| along(first, left))
            && rest.iter().all(|body| along(body, 2))
    }

    /// Of a pose the rotation matrix of the tip in the base, row by row, by intervals that hold it for the angles as they are written.
    ///
    /// # Errors
    /// [`LengthError`] when `q` has the wrong length.
    pub fn enclosed_rotation(&self, q: &[f64]) -> Result<Option<[[Interval; 3]; 3]>, LengthError> {
        LengthError::check("q", self.joints(), q.len())?;
        Ok(self.turned.as_ref().map(|turned| turned.enclosed(&self.tree, q)))
    }

    /// Where the numbers of translation c stand in θ, if they are there.
    #[inline(always)]
    fn place(&self, c: usize) -> Option<usize> {
        match self.uncertain {
            Uncertain::Tool if c == self.tree.bodies.len() => Some(0),
            Uncertain::Chain if c > 0 => Some(3 * (c - 1)),
            _ => None,
        }
    }

    /// Translation c in the inner frame of the body that carries it, and its rate.
    #[inline(always)]
    fn translation(&self, c: usize, theta: &[f64], d_theta: &[f64]) -> (Vec3<f64>, Vec3<f64>) {
        let bodies = &self.tree.bodies;
        let of = |numbers: &[f64], at: usize| Vec3::new(numbers[at], numbers[at + 1], numbers[at + 2]);
        match (self.place(c), c.checked_sub(1)) {
            (Some(at), Some(holder)) => {
                (bodies[holder].inner_vector(of(theta, at)), bodies[holder].inner_vector(of(d_theta, at)))
            }
            _ => (Vec3::splat(bodies[c].translation), Vec3::ZERO),
        }
    }

    fn chain(&self, posture: Posture<'_>) -> Chain {
        dispatch(ChainAt { tip: self, posture })
    }

    #[inline(always)]
    fn chain_at(&self, posture: Posture<'_>) -> Chain {
        let Posture { q, dq, theta, d_theta } = posture;
        let still = Vec3::ZERO;
        let mut chain = Chain {
            w: [still; MOST_JOINTS + 1],
            dw: [still; MOST_JOINTS + 1],
            a: [still; MOST_JOINTS],
            da: [still; MOST_JOINTS],
        };
        let (mut e, mut omega) = (upright(), still);
        let joints = self.tree.bodies.len();
        for c in 0..=joints {
            let (t, dt) = self.translation(c, theta, d_theta);
            chain.w[c] = e.times(t);
            chain.dw[c] = omega.cross_plus(chain.w[c], e.times(dt));
            let Some(body) = self.tree.bodies.get(c) else { break };
            let (sin, cos) = trig::sin_cos(q[c]);
            e = e.product(&Seat::of(body, q[c], sin, cos).e);
            let a = e.z.scaled(body.sign);
            match body.kind {
                JointKind::Revolute => omega = a.scaled_plus(dq[c], omega),
                JointKind::Prismatic => {
                    let slide = a.scaled(q[c]);
                    chain.w[c] = chain.w[c].plus(slide);
                    chain.dw[c] = omega.cross_plus(slide, a.scaled_plus(dq[c], chain.dw[c]));
                }
            }
            chain.a[c] = a;
            chain.da[c] = omega.cross(a);
        }
        chain
    }
}

struct ChainAt<'a> {
    tip: &'a TreeTip,
    posture: Posture<'a>,
}

impl Kernel for ChainAt<'_> {
    type Output = Chain;

    #[inline(always)]
    fn run(self) -> Chain {
        self.tip.chain_at(self.posture)
    }
}

/// vᵀ J ξ by θ, lengths checked.
struct ByLengths<'a> {
    tip: &'a TreeTip,
    q: &'a [f64],
    xi: &'a [f64],
    v: [f64; 3],
    out: &'a mut [f64],
}

impl Kernel for ByLengths<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let v = Vec3::splat(self.v);
        let (mut e, mut omega) = (upright(), Vec3::ZERO);
        for (c, body) in self.tip.tree.bodies.iter().enumerate() {
            let (sin, cos) = trig::sin_cos(self.q[c]);
            e = e.product(&Seat::of(body, self.q[c], sin, cos).e);
            if body.kind == JointKind::Revolute {
                omega = e.z.scaled_plus(body.sign * self.xi[c], omega);
            }
            if let Some(at) = self.tip.place(c + 1) {
                let by = body.outer_vector(e.transpose_times(v.cross(omega)));
                self.out[at..at + 3].copy_from_slice(&[by.x, by.y, by.z]);
            }
        }
    }
}

#[inline(always)]
fn upright() -> Mat3<f64> {
    Mat3::splat(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
}

impl TipKinematics for TreeTip {
    fn joints(&self) -> usize {
        self.tree.bodies.len()
    }

    fn axes(&self) -> usize {
        self.coordinates.len()
    }

    fn attitude(&self, q: &[f64]) -> Option<Quaternion> {
        self.turned.as_ref().map(|turned| turned.attitude(&self.tree, q))
    }

    fn turns(&self) -> bool {
        self.turned.is_some()
    }

    fn parameter_count(&self) -> usize {
        match self.uncertain {
            Uncertain::Tool => 3,
            Uncertain::Chain => 3 * self.tree.bodies.len(),
        }
    }

    fn parameter_names(&self) -> Vec<String> {
        let mut names = Vec::with_capacity(self.parameter_count());
        for c in 1..=self.tree.bodies.len() {
            if self.place(c).is_none() {
                continue;
            }
            for axis in ["x", "y", "z"] {
                names.push(if c == self.tree.bodies.len() {
                    format!("tool_{axis}_m")
                } else {
                    format!("joint_{}_{axis}_m", c + 1)
                });
            }
        }
        names
    }

    fn position(&self, q: &[f64], theta: &[f64], x: &mut [f64]) -> Result<(), LengthError> {
        let still = [0.0; 3 * MOST_JOINTS];
        let (n, p) = (self.joints(), self.parameter_count());
        let posture = Posture { q, dq: &still[..n], theta, d_theta: &still[..p] };
        posture.check(n, p)?;
        LengthError::check("x", self.axes(), x.len())?;
        let sum = self.chain(posture).w.iter().fold(Vec3::ZERO, |sum, w| sum.plus(*w));
        for (x, coordinate) in x.iter_mut().zip(&self.coordinates) {
            *x = component(sum, *coordinate);
        }
        Ok(())
    }

    fn jacobian(&self, posture: Posture<'_>, j: &mut [f64], dj: &mut [f64]) -> Result<(), LengthError> {
        let (n, m) = (self.joints(), self.axes());
        posture.check(n, self.parameter_count())?;
        LengthError::check("Jacobian", self.rows() * n, j.len())?;
        LengthError::check("rate of the Jacobian", self.rows() * n, dj.len())?;
        let chain = self.chain(posture);
        let (mut behind, mut d_behind) = (Vec3::ZERO, Vec3::ZERO);
        for c in (0..n).rev() {
            behind = behind.plus(chain.w[c + 1]);
            d_behind = d_behind.plus(chain.dw[c + 1]);
            let (a, da) = (chain.a[c], chain.da[c]);
            let (column, d_column) = match self.tree.bodies[c].kind {
                JointKind::Revolute => (a.cross(behind), da.cross_plus(behind, a.cross(d_behind))),
                JointKind::Prismatic => (a, da),
            };
            for (row, coordinate) in self.coordinates.iter().enumerate() {
                j[row * n + c] = component(column, *coordinate);
                dj[row * n + c] = component(d_column, *coordinate);
            }
            if self.turns() {
                // What slides does not turn.
                let turning = f64::from(self.tree.bodies[c].kind == JointKind::Revolute);
                for k in 0..3 {
                    j[(m + k) * n + c] = turning * component(a, k);
                    dj[(m + k) * n + c] = turning * component(da, k);
                }
            }
        }
        Ok(())
    }

    fn regressor_transposed(&self, q: &[f64], xi: &[f64], v: &[f64], zt_v: &mut [f64]) -> Result<(), LengthError> {
        let n = self.joints();
        LengthError::check("q", n, q.len())?;
        LengthError::check("xi", n, xi.len())?;
        LengthError::check("v", self.rows(), v.len())?;
        LengthError::check("kinematic gradient", self.parameter_count(), zt_v.len())?;
        let mut full = [0.0; 3];
        for (v, coordinate) in v.iter().zip(&self.coordinates) {
            full[*coordinate] = *v;
        }
        dispatch(ByLengths { tip: self, q, xi, v: full, out: zt_v });
        Ok(())
    }
}

fn component(v: Vec3<f64>, coordinate: usize) -> f64 {
    match coordinate {
        0 => v.x,
        1 => v.y,
        _ => v.z,
    }
}
