//! How fast the gains of (6)–(7) make one robot, to say which of them makes a closed loop stiff.
//!
//! With M, Y and the desired motion held, (1), (6) and (7) are
//!
//! ```text
//! M ṡ = −K s + Y Δϑ,   Δϑ' = −Γ Yᵀ s
//! ```
//!
//! By itself the damping has the rates of M⁻¹K, and the adaptation the frequencies √(M⁻¹ Y Γ Yᵀ). The robot has rates of its own, those
//! of M⁻¹D for its viscous damping D; at rest Y(q, 0, z, 0)ϑ = D z + g, since C(q, 0) = 0.

use forwardstep_core::robot::{Lagrangian, TwoVelocity};
use forwardstep_core::{LengthError, ResolvedGain};

use super::robot_batch::Member;
use crate::recording::GainRates;

/// Power iterations. M⁻¹A with M and A symmetric and not negative has real eigenvalues; half as many would do for two digits.
const ITERATIONS: u32 = 64;

/// The rates of `member` in this motion; `None` when they are not finite.
pub(super) fn gain_rates<R: Lagrangian<f64>>(
    robot: &R,
    scratch: &mut R::Scratch,
    member: &Member,
    motion: TwoVelocity<'_, f64>,
) -> Result<Option<GainRates>, LengthError> {
    let (m, p) = (robot.dof(), robot.parameter_count());
    let mut entries = vec![0.0; m * m];
    robot.mass_matrix(scratch, motion.q, &member.theta, &mut entries)?;
    let mass = ResolvedGain::Matrix { size: m, entries };
    let damping = &member.law.damping;
    let damping_per_s = largest(&mass, |s, force| damping.apply(s, force));
    let rest = vec![0.0; m];
    let torque = |scratch: &mut R::Scratch, z: &[f64]| {
        let mut y = vec![0.0; m * p];
        robot.regressor(scratch, TwoVelocity { q: motion.q, dq: &rest, z, dz: &rest }, &mut y)?;
        let dot = |row: &[f64]| row.iter().zip(&member.theta).map(|(y, theta)| y * theta).sum::<f64>();
        Ok::<_, LengthError>((0..m).map(|axis| dot(&y[axis * p..(axis + 1) * p])).collect::<Vec<_>>())
    };
    let gravity = torque(scratch, &rest)?;
    let mut viscous = Vec::with_capacity(m * m);
    for axis in 0..m {
        let z: Vec<f64> = (0..m).map(|other| f64::from(u8::from(other == axis))).collect();
        // Column by column; power iterations do not mind a transpose.
        viscous.extend(torque(scratch, &z)?.iter().zip(&gravity).map(|(all, g)| all - g));
    }
    let viscous_per_s = largest(&mass, |s, force| {
        for (row, force) in viscous.chunks_exact(m.max(1)).zip(force) {
            *force = row.iter().zip(s).map(|(d, s)| d * s).sum();
        }
    });
    let mut adaptation_per_s = None;
    if let Some(gamma) = &member.law.adaptation {
        let mut y = vec![0.0; m * p];
        robot.regressor(scratch, motion, &mut y)?;
        let (mut yt_s, mut learnt) = (vec![0.0; p], vec![0.0; p]);
        let squared = largest(&mass, |s, force| {
            for (k, entry) in yt_s.iter_mut().enumerate() {
                *entry = s.iter().enumerate().map(|(axis, s)| y[axis * p + k] * s).sum();
            }
            gamma.apply(&yt_s, &mut learnt);
            for (row, force) in y.chunks_exact(p.max(1)).zip(force) {
                *force = row.iter().zip(&learnt).map(|(y, learnt)| y * learnt).sum();
            }
        });
        adaptation_per_s = Some(squared.sqrt());
    }
    let finite = damping_per_s.is_finite() && viscous_per_s.is_finite() && adaptation_per_s.is_none_or(f64::is_finite);
    Ok(finite.then_some(GainRates { damping_per_s, viscous_per_s, adaptation_per_s }))
}

/// λ_max(M⁻¹A), where A is symmetric and not negative.
fn largest(mass: &ResolvedGain, mut a: impl FnMut(&[f64], &mut [f64])) -> f64 {
    let m = mass.size();
    // No eigenvector is missed: the entries have nothing to do with each other.
    let mut s: Vec<f64> = (0..m).map(|axis| 0.25 + (axis as f64 * 0.618_033_988_749_894_9).fract()).collect();
    let (mut image, mut rate) = (vec![0.0; m], 0.0);
    for _ in 0..ITERATIONS {
        let size = s.iter().fold(0.0, |most: f64, s| most.max(s.abs()));
        if size == 0.0 {
            return 0.0;
        }
        s.iter_mut().for_each(|s| *s /= size);
        a(&s, &mut image);
        mass.solve(&mut image);
        rate = image.iter().fold(0.0, |most: f64, s| most.max(s.abs()));
        s.copy_from_slice(&image);
    }
    rate
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "helpers of tests")]

    use forwardstep_core::law::SlotineLi;
    use forwardstep_core::robot::{Driven, Drives, PlanarArm, PlanarLinks, PointMass};

    use super::*;

    fn rates<R: Lagrangian<f64>>(robot: &R, theta: &[f64], law: SlotineLi, motion: TwoVelocity<'_, f64>) -> GainRates {
        let (axes, theta) = (robot.dof(), theta.to_vec());
        let member = Member { agent: 0, axes, theta, law, estimate_cost: None, effort_limits: None };
        gain_rates(robot, &mut robot.scratch(), &member, motion).unwrap().unwrap()
    }

    #[test]
    fn rates_of_a_point_mass_are_those_of_its_oscillator() {
        // m ṡ = −K s + ż Δϑ: along ż the frequency is |ż| √(γ/m), across it there is none.
        let motion = TwoVelocity { q: &[0.0; 2], dq: &[1.0, 0.0], z: &[1.0, 0.0], dz: &[3.0, 4.0] };
        let damping = ResolvedGain::Diagonal(vec![6.0, 8.0]);
        let known = rates(
            &PointMass { dimension: 2 },
            &[2.0],
            SlotineLi { damping: damping.clone(), adaptation: None, bounds: None },
            motion,
        );
        assert!((known.damping_per_s - 4.0).abs() < 1e-3 && known.adaptation_per_s.is_none(), "{known:?}");
        assert_eq!(known.viscous_per_s, 0.0);
        let adaptation = Some(ResolvedGain::Diagonal(vec![18.0]));
        let adaptive =
            rates(&PointMass { dimension: 2 }, &[2.0], SlotineLi { damping, adaptation, bounds: None }, motion);
        assert!((adaptive.adaptation_per_s.unwrap() - 15.0).abs() < 1e-9, "{adaptive:?}");
    }

    #[test]
    fn the_damping_of_a_robot_has_a_rate_of_its_own() {
        let drives = Drives { damped: vec![0, 1], ..Drives::default() };
        let robot = Driven::new(PointMass { dimension: 2 }, drives).unwrap();
        let motion = TwoVelocity { q: &[0.3, 0.1], dq: &[2.0, 1.0], z: &[1.0, 0.0], dz: &[3.0, 4.0] };
        let law = SlotineLi { damping: ResolvedGain::Diagonal(vec![1.0; 2]), adaptation: None, bounds: None };
        let found = rates(&robot, &[2.0, 10.0, 30.0], law, motion);
        assert!((found.viscous_per_s - 15.0).abs() < 1e-9 && (found.damping_per_s - 0.5).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn the_rate_of_the_damping_of_an_arm_is_that_of_its_lightest_motion() {
        let theta = PlanarLinks::uniform([2.0, 1.5], [1.0, 0.8]).theta();
        let motion = TwoVelocity { q: &[0.3, 0.4], dq: &[0.0; 2], z: &[0.0; 2], dz: &[0.0; 2] };
        let law = SlotineLi { damping: ResolvedGain::Diagonal(vec![7.0; 2]), adaptation: None, bounds: None };
        let mut m = [0.0; 4];
        PlanarArm.mass_matrix(&mut Lagrangian::<f64>::scratch(&PlanarArm), motion.q, &theta, &mut m).unwrap();
        let (mean, determinant) = (0.5 * (m[0] + m[3]), m[0] * m[3] - m[1] * m[2]);
        let lightest = mean - (mean * mean - determinant).sqrt();
        let found = rates(&PlanarArm, &theta, law, motion).damping_per_s;
        assert!((found - 7.0 / lightest).abs() < 1e-6 * found, "{found} for {}", 7.0 / lightest);
    }
}
