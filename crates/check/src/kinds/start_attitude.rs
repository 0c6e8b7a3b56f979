//! Whether the attitude of a tip starts half a turn from that of its target, by enclosures.
//!
//! Let R be the rotation matrix of the tip, p = (v, o) the quaternion of the target with any norm, and R_d its rotation. The scalar part of the
//! quaternion of R_dᵀR satisfies 4 Δq_o² = 1 + tr R_dᵀR, whichever of q and −q is meant. With
//! pᵀp R_d = (o² − vᵀv) 1 + 2 v vᵀ + 2 o S(v) and a = (R₃₂ − R₂₃, R₁₃ − R₃₁, R₂₁ − R₁₂) this is
//!
//! ```text
//! 4 pᵀp Δq_o² = (o² + vᵀv) + (o² − vᵀv) tr R + 2 vᵀR v + 2 o vᵀa
//! ```
//!
//! which needs no root and no choice of a sign. R is enclosed at the start posture, p at t = 0.

use std::sync::Arc;

use forwardstep_core::expression::Interval;
use forwardstep_core::robot::tree::{Follows, Tree};
use forwardstep_sim::trajectory::Trajectory;
use forwardstep_sim::{AgentSetup, Law, TaskSpaceLaw};

use crate::certificate::at_start;

/// Δq_o² at the start of a pose, enclosed; everything where nothing is known, and `None` for what is no pose.
pub(crate) fn scalar_squared(agent: &AgentSetup, law: &TaskSpaceLaw) -> Option<Interval> {
    if law.tip.follows() != Follows::Pose {
        return None;
    }
    let known = rotation(agent, law).zip(desired(agent, law));
    Some(known.map_or(Interval::WHOLE, |(rotation, desired)| squared(&rotation, &at_start(&desired))))
}

/// The rotation matrix of the tip.
fn rotation(agent: &AgentSetup, law: &TaskSpaceLaw) -> Option<[[Interval; 3]; 3]> {
    let tree: &Arc<Tree> = agent.robot.kind.downcast()?;
    law.tip.of_tree(tree)?.ok()?.enclosed_rotation(&agent.start.q).ok()?
}

/// The quaternion of the target of a pose.
pub(super) fn desired(agent: &AgentSetup, law: &TaskSpaceLaw) -> Option<Trajectory> {
    let first = law.interface(&agent.robot)?.coordinates?.quaternion?;
    agent.target.as_ref()?.quaternion(first)
}

fn squared(r: &[[Interval; 3]; 3], p: &[Interval]) -> Interval {
    let [v @ .., o] = p else { return Interval::WHOLE };
    let (zero, two) = (Interval::point(0.0), Interval::point(2.0));
    let sum = |terms: &mut dyn Iterator<Item = Interval>| terms.fold(zero, |sum, term| sum + term);
    // The square of what may have either sign.
    let square = |x: Interval| {
        let least = x.low.max(-x.high).max(0.0);
        let [least, most] = [least, x.size()].map(Interval::point).map(|end| end * end);
        Interval { low: least.low, high: most.high }
    };
    let vector = sum(&mut v.iter().map(|x| square(*x)));
    let scalar = square(*o);
    let trace = sum(&mut (0..3).map(|k| r[k][k]));
    let quadratic = sum(&mut v.iter().zip(r).flat_map(|(x, row)| v.iter().zip(row).map(|(y, entry)| *x * *entry * *y)));
    let apart = sum(&mut v.iter().enumerate().map(|(k, x)| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        *x * (r[j][i] - r[i][j])
    }));
    let norm = scalar + vector;
    let whole = norm + (scalar - vector) * trace + two * quadratic + two * *o * apart;
    let found = whole / (Interval::point(4.0) * norm);
    // The root of a part of one.
    if found.low <= found.high {
        Interval { low: found.low.max(0.0), high: found.high.min(1.0) }
    } else {
        Interval::WHOLE
    }
}

#[cfg(test)]
mod tests {
    use forwardstep_core::attitude::{Quaternion, dot, normalized, product, rotate};

    use super::*;

    fn points(rows: [[f64; 3]; 3]) -> [[Interval; 3]; 3] {
        rows.map(|row| row.map(Interval::point))
    }

    fn matrix(q: Quaternion) -> [[f64; 3]; 3] {
        let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|unit| rotate(q, unit));
        std::array::from_fn(|row| columns.map(|column| column[row]))
    }

    #[test]
    fn prop_the_square_of_the_scalar_part_is_that_of_the_quaternions() {
        let mut drawn = (1..).map(|k: u32| (f64::from(k) * 0.618_033_988_749_894_9).fract() * 2.0 - 1.0);
        for _ in 0..200 {
            let mut quaternion = || -> Quaternion { std::array::from_fn(|_| drawn.next().unwrap_or(0.0)) };
            let (own, p) = (normalized(quaternion()), quaternion().map(|x| 3.0 * x));
            let [x, y, z, o] = normalized(p);
            let expected = product([-x, -y, -z, o], own)[3];
            let found = squared(&points(matrix(own)), &p.map(Interval::point));
            assert!(found.high - found.low < 1e-12, "{found:?}");
            assert!((found.low - expected * expected).abs() < 1e-12, "{found:?} for {expected}, |p|² = {}", dot(p, p));
        }
    }

    #[test]
    fn half_a_turn_is_enclosed_exactly_where_all_numbers_are_exact() {
        let upright = points(matrix([0.0, 0.0, 0.0, 1.0]));
        for p in [[1.0, 0.0, 0.0, 0.0], [0.0, -2.0, 0.0, 0.0], [3.0, 4.0, 0.0, 0.0]] {
            assert_eq!(squared(&upright, &p.map(Interval::point)), Interval::point(0.0));
        }
        assert_eq!(squared(&upright, &[0.0; 4].map(Interval::point)), Interval::WHOLE);
    }
}
