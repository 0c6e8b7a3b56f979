//! What can be said of M(q) for all q where bodies are degenerate: point masses, links without mass.
//!
//! M does not depend on a joint that the base carries, as turning or shifting all that hangs on it changes no kinetic energy, nor on a
//! prismatic joint that no revolute joint carries, as all axes and arms stay what they are. If revolute joints are all that is left, q
//! runs through a cube of full turns. Cut small enough, M − μ 1 is positive definite on each piece by intervals, or a q is
//! found where M is not positive definite.

use alloc::vec;
use alloc::vec::Vec;

use super::model::Tree;
use super::physical::even_steps;
use super::{JointKind, TreeScratch};
use crate::LengthError;
use crate::expression::Interval;
use crate::robot::Lagrangian;
use crate::robot::enclosed::Enclosed;
use crate::robot::inertia_bound::InertiaBound;

/// Whether M(q) is positive definite uniformly.
#[derive(Clone, Debug, PartialEq)]
pub enum Definiteness {
    /// It is, by a bound.
    Uniform(InertiaBound),
    /// It is not, at this q: `direction` · M(q) `direction` ≤ 0, by intervals.
    Not {
        /// Joint positions, rad or m.
        q: Vec<f64>,
        /// Velocities that have no kinetic energy, or a negative one.
        direction: Vec<f64>,
    },
    /// Neither is shown. Of the postures that were looked at, M is closest to singular at this one.
    Unknown {
        /// Joint positions, rad or m.
        q: Vec<f64>,
        /// What every eigenvalue of M exceeds there; zero where that is not known.
        least: f64,
    },
}

/// Postures that are looked at.
const SAMPLES: usize = 64;
/// The bound that is tried, as a part of the smallest eigenvalue seen.
const PART: f64 = 0.25;
/// More than π.
const HALF_TURN: f64 = 3.141_592_653_589_793_6;

impl Tree {
    /// Whether M(q) is positive definite uniformly in q: by [`Tree::inertia_bound`], else by cutting the joints' full turns into
    /// at most `pieces`.
    ///
    /// # Errors
    /// [`LengthError`] when `theta` has the wrong length.
    pub fn definiteness(&self, theta: &[f64], pieces: usize) -> Result<Definiteness, LengthError> {
        if let Some(bound) = self.inertia_bound(theta)? {
            return Ok(Definiteness::Uniform(bound));
        }
        let mut at =
            At { tree: self, scratch: self.scratch(), theta: theta.iter().copied().map(Interval::point).collect() };
        let (mut lowest, mut seen) = (vec![0.0; self.joint_count()], f64::INFINITY);
        for q in postures(self.joint_count()) {
            let m = at.mass(&point(&q))?;
            if let Some(direction) = against(&m) {
                return Ok(Definiteness::Not { q, direction });
            }
            let least = m.least().unwrap_or(0.0);
            if least < seen {
                (lowest, seen) = (q, least);
            }
        }
        let shown = at.exceeds(PART * seen, pieces)?;
        let bound = if shown { InertiaBound::by_least(PART * seen, self.joint_count()) } else { None };
        Ok(bound.map_or(Definiteness::Unknown { q: lowest, least: seen }, Definiteness::Uniform))
    }

    /// The joints that M(q) depends on.
    fn shaping(&self) -> Vec<usize> {
        let mut turned: Vec<bool> = Vec::with_capacity(self.bodies.len());
        let mut shaping = Vec::new();
        for (joint, body) in self.bodies.iter().enumerate() {
            let parent = body.parent_slot.checked_sub(1);
            let carried = parent.and_then(|parent| turned.get(parent)).is_some_and(|turned| *turned);
            match body.kind {
                JointKind::Revolute if parent.is_some() => shaping.push(joint),
                JointKind::Prismatic if carried => shaping.push(joint),
                JointKind::Revolute | JointKind::Prismatic => {}
            }
            turned.push(carried || body.kind == JointKind::Revolute);
        }
        shaping
    }
}

/// M by intervals.
struct At<'a> {
    tree: &'a Tree,
    scratch: TreeScratch<Interval>,
    theta: Vec<Interval>,
}

impl At<'_> {
    fn mass(&mut self, q: &[Interval]) -> Result<Enclosed, LengthError> {
        let n = q.len();
        let mut m = vec![Interval::point(0.0); n * n];
        self.tree.mass_matrix(&mut self.scratch, q, &self.theta, &mut m)?;
        Ok(Enclosed::from_rows(n, m).unwrap_or(Enclosed::zero(n)))
    }

    /// Whether no eigenvalue of M(q) is below `least` > 0 at any q, shown with `pieces` at most.
    fn exceeds(&mut self, least: f64, pieces: usize) -> Result<bool, LengthError> {
        let shaping = self.tree.shaping();
        let turns = |joint: &usize| self.tree.bodies[*joint].kind == JointKind::Revolute;
        if least.is_nan() || least <= 0.0 || !shaping.iter().all(turns) {
            return Ok(false);
        }
        let mut whole = vec![Interval::point(0.0); self.tree.joint_count()];
        for joint in &shaping {
            whole[*joint] = Interval { low: -HALF_TURN, high: HALF_TURN };
        }
        let (mut waiting, mut left) = (vec![whole], pieces);
        while let Some(piece) = waiting.pop() {
            if left == 0 {
                return Ok(false);
            }
            left -= 1;
            if self.mass(&piece)?.exceeds(least) {
                continue;
            }
            let width = |joint: &usize| piece[*joint].high - piece[*joint].low;
            let Some(widest) = shaping.iter().copied().max_by(|a, b| width(a).total_cmp(&width(b))) else {
                return Ok(false);
            };
            let Interval { low, high } = piece[widest];
            let middle = 0.5 * (low + high);
            for half in [Interval { low, high: middle }, Interval { low: middle, high }] {
                let mut part = piece.clone();
                part[widest] = half;
                waiting.push(part);
            }
        }
        Ok(true)
    }
}

/// Zero, where sines and cosines are exact, and others spread evenly over full turns.
fn postures(n: usize) -> impl Iterator<Item = Vec<f64>> {
    let step = even_steps(n);
    (0..SAMPLES).map(move |sample| {
        let share = |step: &f64| 0.5 + sample as f64 * step;
        step.iter().map(|step| 2.0 * HALF_TURN * (share(step) - libm::floor(share(step)) - 0.5)).collect()
    })
}

fn point(q: &[f64]) -> Vec<Interval> {
    q.iter().copied().map(Interval::point).collect()
}

/// A direction v with vᵀM v ≤ 0: a joint by itself, or one with those before it as they follow without a torque.
fn against(m: &Enclosed) -> Option<Vec<f64>> {
    let n = m.size();
    let unit = |joint: usize| (0..n).map(|k| if k == joint { 1.0 } else { 0.0 }).collect::<Vec<f64>>();
    if let Some(joint) = (0..n).find(|joint| m.at(*joint, *joint).high <= 0.0) {
        return Some(unit(joint));
    }
    let middle = |i: usize, j: usize| 0.5 * (m.at(i, j).low + m.at(i, j).high);
    // Rows of L of L D Lᵀ, one by one; v solves Lᵀv = e_k.
    let mut l = vec![0.0; n * n];
    let mut pivots: Vec<f64> = Vec::with_capacity(n);
    for k in 0..n {
        for j in 0..k {
            let known = (0..j).map(|i| l[k * n + i] * l[j * n + i] * pivots[i]).sum::<f64>();
            l[k * n + j] = (middle(k, j) - known) / pivots[j];
        }
        let pivot = middle(k, k) - (0..k).map(|i| l[k * n + i] * l[k * n + i] * pivots[i]).sum::<f64>();
        let mut v = unit(k);
        for j in (0..k).rev() {
            v[j] = -(j + 1..=k).map(|i| l[i * n + j] * v[i]).sum::<f64>();
        }
        if quadratic(m, &v).high <= 0.0 {
            return Some(v);
        }
        if pivot.is_nan() || pivot <= 0.0 {
            return None;
        }
        pivots.push(pivot);
    }
    None
}

/// vᵀM v.
fn quadratic(m: &Enclosed, v: &[f64]) -> Interval {
    let mut sum = Interval::point(0.0);
    for (i, a) in v.iter().enumerate() {
        for (j, b) in v.iter().enumerate() {
            sum = sum + Interval::point(*a) * m.at(i, j) * Interval::point(*b);
        }
    }
    sum
}
