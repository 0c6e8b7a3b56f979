//! The end-effector of a robot, (76)–(82): Ĵᵀ K* Δx, z_r, and the rate of θ̂ at an instant.
//!
//! Ĵ and its rate are those of the kinematics with θ̂ and θ̂' as they are integrated, so that ż_r is the derivative of the z_r of the run.

use forwardstep_core::ResolvedGain;
use forwardstep_core::robot::tree::{Tree, TreeTip};
use forwardstep_core::robot::{Posture, TipKinematics};
use forwardstep_sim::{AgentSetup, Signal, TaskSpaceLaw, TipSetup};
use nalgebra::{DMatrix, DVector};

use super::super::form::Term;
use super::Missing;
use super::moment::{At, Vector, exact};
use super::robot::{Model, times};

/// An end-effector and the gains of its law.
pub(super) struct Tip {
    kinematics: Box<dyn TipKinematics>,
    /// K*.
    stiffness: ResolvedGain,
    /// Λ; `None` where θ̂ stays as it is.
    adaptation: Option<ResolvedGain>,
    /// Whether θ̂ is kept within bounds, which (82) does not speak of.
    bounded: bool,
}

impl Tip {
    pub(super) fn of(agent: &AgentSetup) -> Option<Tip> {
        let law: &TaskSpaceLaw = agent.law.downcast()?;
        let kinematics: Box<dyn TipKinematics> = match &law.tip {
            TipSetup::Planar(tip) => Box::new(*tip),
            TipSetup::Point { point, coordinates, uncertain } => {
                let tree = agent.robot.kind.downcast::<std::sync::Arc<Tree>>()?;
                Box::new(TreeTip::new(Tree::clone(tree), point, coordinates, *uncertain).ok()?)
            }
        };
        let stiffness = law.task_gain.resolve(kinematics.axes(), &[]).ok()?;
        let adaptation = match &law.kinematic_adaptation {
            Some(gain) => Some(gain.resolve(kinematics.parameter_count(), &[]).ok()?),
            None => None,
        };
        Some(Tip { kinematics, stiffness, adaptation, bounded: law.bounds.is_some() })
    }
}

/// What the run says of an end-effector at an instant.
struct Seen {
    q: Vec<f64>,
    dq: Vec<f64>,
    /// θ̂ and θ̂'.
    estimate: [Vec<f64>; 2],
    /// x − x_d.
    error: Vector,
    /// ẋ_d and ẍ_d.
    target: [Vec<f64>; 2],
}

fn values(vector: &[[f64; 2]]) -> Vec<f64> {
    vector.iter().map(|[value, _]| *value).collect()
}

/// A gain times a vector.
fn gained(gain: &ResolvedGain, vector: &Vector) -> Vector {
    let column = |entry: usize| {
        let mut product = vec![0.0; vector.len()];
        gain.apply(&values(vector), &mut product);
        let mut size = vec![0.0; vector.len()];
        gain.apply(&vector.iter().map(|[_, size]| *size).collect::<Vec<f64>>(), &mut size);
        [product[entry], size[entry].abs()]
    };
    (0..vector.len()).map(column).collect()
}

impl Tip {
    /// Ĵ and its rate, row by row.
    fn jacobian(&self, seen: &Seen) -> Result<[Vec<f64>; 2], Missing> {
        let m = self.kinematics.axes();
        let (mut j, mut dj) = (vec![0.0; m * m], vec![0.0; m * m]);
        let [theta, d_theta] = &seen.estimate;
        let posture = Posture { q: &seen.q, dq: &seen.dq, theta, d_theta };
        self.kinematics.jacobian(posture, &mut j, &mut dj).map_err(|_| Missing::Term)?;
        Ok([j, dj])
    }

    /// Ĵᵀ K* Δx.
    fn pulled(&self, seen: &Seen) -> Result<Vector, Missing> {
        let m = self.kinematics.axes();
        let [j, _] = self.jacobian(seen)?;
        let transposed: Vec<f64> = (0..m * m).map(|k| j[(k % m) * m + k / m]).collect();
        Ok(times(&transposed, &gained(&self.stiffness, &seen.error)))
    }

    /// z_r = Ĵ⁻¹ ẋ_d, or ż_r = Ĵ⁻¹ (ẍ_d − (dĴ/dt) z_r).
    fn leading(&self, seen: &Seen, k: usize) -> Result<Vector, Missing> {
        let m = self.kinematics.axes();
        let [j, dj] = self.jacobian(seen)?.map(|matrix| DMatrix::from_row_slice(m, m, &matrix));
        let [dx, ddx] = [0, 1].map(|k| DVector::from_column_slice(&seen.target[k]));
        let factored = j.lu();
        let z_r = factored.solve(&dx).ok_or(Missing::Term)?;
        if k == 0 {
            return Ok(exact(z_r.iter().copied()));
        }
        let found = factored.solve(&(ddx - dj * z_r)).ok_or(Missing::Term)?;
        Ok(exact(found.iter().copied()))
    }

    /// Λ Zᵀ K* Δx.
    fn adapted(&self, seen: &Seen) -> Result<Vector, Missing> {
        if self.bounded {
            return Err(Missing::Limited);
        }
        let mut push = vec![0.0; self.kinematics.parameter_count()];
        let weighted = values(&gained(&self.stiffness, &seen.error));
        let found = self.kinematics.regressor_transposed(&seen.q, &seen.dq, &weighted, &mut push);
        found.map_err(|_| Missing::Term)?;
        match &self.adaptation {
            Some(lambda) => Ok(gained(lambda, &exact(push))),
            None => Ok(exact(push.iter().map(|_| 0.0))),
        }
    }
}

impl At<'_, '_> {
    fn seen(&self) -> Result<Seen, Missing> {
        let followed = self.case.setup.agents[self.moment.agent].target.as_ref();
        let [x_d, dx_d, ddx_d] = [self.jet(followed, 0)?, self.jet(followed, 1)?, self.jet(followed, 2)?];
        let x = self.recorded(Signal::TaskPosition).ok_or(Missing::Term)?;
        let error = x.iter().zip(x_d).map(|(x, [x_d, _])| [x - x_d, x.abs() + x_d.abs()]).collect();
        let estimate = |rates| self.state(Signal::KinematicEstimate, rates).ok_or(Missing::Term);
        Ok(Seen {
            q: self.position(0)?,
            dq: self.position(1)?,
            estimate: [estimate(false)?, estimate(true)?],
            error,
            target: [values(&dx_d), values(&ddx_d)],
        })
    }

    fn tip(&mut self) -> Result<&Tip, Missing> {
        match self.model()? {
            Model::Robot(robot) => robot.tip.as_ref().ok_or(Missing::Term),
            Model::Spacecraft(_) | Model::Chain(_) => Err(Missing::Term),
        }
    }

    /// Ĵᵀ K* Δx, z_r or ż_r.
    pub(super) fn task_term(&mut self, term: Term, k: usize) -> Result<Vector, Missing> {
        let seen = self.seen()?;
        match (term, k) {
            (Term::TaskForce, 0) => self.tip()?.pulled(&seen),
            (Term::JointReference, 0 | 1) => self.tip()?.leading(&seen, k),
            _ => Err(Missing::Derivative),
        }
    }

    /// θ̂' less what (82) makes it.
    pub(super) fn kinematic_estimate(&mut self) -> Result<Vector, Missing> {
        let seen = self.seen()?;
        let made = self.tip()?.adapted(&seen)?;
        let rates = seen.estimate[1].iter().zip(made);
        Ok(rates.map(|(rate, [value, size])| [rate - value, rate.abs() + size]).collect())
    }
}
