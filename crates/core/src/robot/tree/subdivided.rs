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
use crate::robot::inertia_bound::{Definiteness, InertiaBound};

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
            if let Some(direction) = m.against() {
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
