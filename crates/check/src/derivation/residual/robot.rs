//! Robots under (6)–(7): M, C, g, D and Y at an instant.

use forwardstep_core::robot::TwoVelocity;
use forwardstep_sim::{AgentSetup, DynamicsAt, Evaluator, Signal, SpacecraftModel, TaskSpaceLaw};

use super::super::case::Step;
use super::super::form::{Operator, Term};
use super::Missing;
use super::moment::{At, Vector, exact};
use super::task_space::Tip;
use crate::practical::Gains;
use crate::surroundings::smoothed_friction;

/// What an agent's nonlinear terms are computed with.
pub(super) enum Model<'a> {
    /// A robot with Properties 1 to 3.
    Robot(Robot<'a>),
    /// A spacecraft.
    Spacecraft(super::spacecraft::Craft),
    /// (33).
    Chain(super::plants::Chain),
}

/// A robot and its gains.
pub(super) struct Robot<'a> {
    agent: &'a AgentSetup,
    gains: Option<Gains>,
    evaluator: Box<dyn Evaluator>,
    /// Of a robot in task space.
    pub(super) tip: Option<Tip>,
    /// M and Y at the instant at hand, once they were asked for.
    found: Option<DynamicsAt>,
}

impl<'a> Model<'a> {
    pub(super) fn of(agent: &'a AgentSetup) -> Option<Model<'a>> {
        if let Some(model) = agent.robot.kind.downcast::<SpacecraftModel>() {
            return super::spacecraft::Craft::of(agent, model).map(Model::Spacecraft);
        }
        if let Some(chain) = super::plants::Chain::of(agent) {
            return Some(Model::Chain(chain));
        }
        let evaluator = agent.robot.kind.lagrangian()?.evaluator();
        let of_tip = |law: &TaskSpaceLaw| Gains::resolved(agent, &law.damping, Some(&law.adaptation));
        let gains = Gains::of(agent).or_else(|| of_tip(agent.law.downcast()?));
        Some(Model::Robot(Robot { agent, gains, evaluator, tip: Tip::of(agent), found: None }))
    }

    /// Forgets the instant before.
    pub(super) fn forget(&mut self) {
        if let Model::Robot(robot) = self {
            robot.found = None;
        }
    }
}

/// q, q̇, z and ż.
struct Motion {
    q: Vec<f64>,
    dq: Vec<f64>,
    z: Vec<f64>,
    dz: Vec<f64>,
}

impl Motion {
    fn view(&self) -> TwoVelocity<'_, f64> {
        TwoVelocity { q: &self.q, dq: &self.dq, z: &self.z, dz: &self.dz }
    }
}

impl Robot<'_> {
    fn dynamics(&mut self, motion: &Motion) -> Result<&DynamicsAt, Missing> {
        if self.found.is_none() {
            let lagrangian = self.agent.robot.kind.lagrangian().ok_or(Missing::Term)?;
            let found = lagrangian.dynamics_at(&self.agent.robot.theta, motion.view());
            self.found = Some(found.map_err(|_| Missing::Term)?);
        }
        self.found.as_ref().ok_or(Missing::Term)
    }

    /// M a + C v + g + D v at a motion, for an acceleration and a velocity; and D v. Both without friction.
    fn torque(&mut self, motion: &Motion, [a, v]: [&[f64]; 2]) -> Result<[Vec<f64>; 2], Missing> {
        let motion = TwoVelocity { z: v, dz: a, ..motion.view() };
        let theta = &self.agent.robot.theta;
        let mut model = self.evaluator.at(theta, motion, v).map_err(|_| Missing::Term)?.model.clone();
        let still = vec![0.0; v.len()];
        let resisted = TwoVelocity { dq: v, z: &still, ..motion };
        let mut damped = self.evaluator.at(theta, resisted, v).map_err(|_| Missing::Term)?.damped.clone();
        if let Some((rubs, is_smooth)) = smoothed_friction(self.agent, v) {
            model.iter_mut().zip(&rubs).for_each(|(model, rubs)| *model -= rubs);
            if is_smooth {
                damped.iter_mut().zip(&rubs).for_each(|(damped, rubs)| *damped -= rubs);
            }
        }
        Ok([model, damped])
    }

    fn under(&mut self, motion: &Motion, operator: Operator, v: &Vector) -> Result<Vector, Missing> {
        let (values, zero): (Vec<f64>, Vec<f64>) = v.iter().map(|[value, _]| (*value, 0.0)).unzip();
        match operator {
            Operator::Inertia => Ok(times(&self.dynamics(motion)?.mass, v)),
            Operator::Damping => {
                let gains = self.gains.as_ref().ok_or(Missing::Term)?;
                Ok(times(gains.damping.transpose().as_slice(), v))
            }
            Operator::Viscous => Ok(exact(self.torque(motion, [&zero, &values])?[1].clone())),
            Operator::Coriolis => {
                let [whole, damped] = self.torque(motion, [&zero, &values])?;
                let [gravity, _] = self.torque(motion, [&zero, &zero])?;
                let each = whole.iter().zip(&damped).zip(&gravity);
                Ok(each.map(|((w, d), g)| [w - d - g, w.abs() + d.abs() + g.abs()]).collect())
            }
            Operator::Identity
            | Operator::Mass
            | Operator::Momentum
            | Operator::Gyroscopic
            | Operator::Filter
            | Operator::AttitudeMap => Err(Missing::Term),
        }
    }

    /// g, Y ϑ̂ or Y Δϑ.
    fn term(&mut self, motion: &Motion, term: Term, estimate: Option<&[f64]>) -> Result<Vector, Missing> {
        if let Some(v) = match term {
            Term::Friction => Some(&motion.dq),
            Term::ReferenceFriction => Some(&motion.z),
            _ => None,
        } {
            return smoothed_friction(self.agent, v).map(|(rubs, _)| exact(rubs)).ok_or(Missing::Term);
        }
        if term == Term::Gravity {
            let zero = vec![0.0; motion.q.len()];
            return Ok(exact(self.torque(motion, [&zero, &zero])?[0].clone()));
        }
        let theta = &self.agent.robot.theta;
        let estimate = estimate.unwrap_or(theta);
        let parameter: Vector = match term {
            Term::RegressorError => {
                estimate.iter().zip(theta).map(|(hat, theta)| [hat - theta, hat.abs() + theta.abs()]).collect()
            }
            _ => exact(estimate.to_vec()),
        };
        Ok(times(&self.dynamics(motion)?.regressor, &parameter))
    }

    /// −Γ Yᵀ s, slowed at the bounds if there are some.
    fn adapted(&mut self, motion: &Motion, estimate: Option<&[f64]>) -> Result<Vector, Missing> {
        let s: Vec<[f64; 2]> = motion.dq.iter().zip(&motion.z).map(|(dq, z)| [dq - z, dq.abs() + z.abs()]).collect();
        let p = self.agent.robot.theta.len();
        let y = self.dynamics(motion)?.regressor.clone();
        let column = |k: usize| {
            let each = s.iter().enumerate().map(|(row, s)| s.map(|s| y[row * p + k] * s));
            each.fold([0.0; 2], |sum, [value, size]| [sum[0] - value, sum[1] + size.abs()])
        };
        let pulled: Vector = (0..p).map(column).collect();
        let gamma = self.gains.as_ref().and_then(|gains| gains.adaptation.as_ref()).ok_or(Missing::Term)?;
        let mut rates = times(gamma.transpose().as_slice(), &pulled);
        let bounds = self.agent.law.kept_within();
        if let (Some(bounds), Some(estimate)) = (bounds, estimate) {
            for (k, ([rate, _], hat)) in rates.iter_mut().zip(estimate).enumerate() {
                *rate = bounds.slowed(k, *hat, *rate);
            }
        }
        Ok(rates)
    }
}

/// A matrix, row by row, times a vector.
pub(super) fn times(matrix: &[f64], vector: &Vector) -> Vector {
    let row = |row: &[f64]| {
        let each = row.iter().zip(vector).map(|(entry, [value, size])| [entry * value, (entry * size).abs()]);
        each.fold([0.0; 2], |sum, [value, size]| [sum[0] + value, sum[1] + size])
    };
    matrix.chunks(vector.len().max(1)).map(row).collect()
}

impl At<'_, '_> {
    fn motion(&self) -> Result<Motion, Missing> {
        Ok(Motion { q: self.position(0)?, dq: self.position(1)?, z: self.reference(0)?, dz: self.reference(1)? })
    }

    /// A vector under a matrix.
    pub(super) fn under(&mut self, operator: Operator, vector: &Vector) -> Result<Vector, Missing> {
        if let Step::Attitude(_) | Step::PassivityFilter(_) = self.case.step {
            return self.spacecraft_under(operator, vector);
        }
        if operator == Operator::Mass {
            let mass = self.mass()?;
            return Ok(vector.iter().map(|entry| entry.map(|x| x * mass)).collect());
        }
        let motion = self.motion()?;
        match self.model()? {
            Model::Robot(robot) => robot.under(&motion, operator, vector),
            Model::Spacecraft(_) | Model::Chain(_) => Err(Missing::Term),
        }
    }

    pub(super) fn robot_term(&mut self, term: Term) -> Result<Vector, Missing> {
        let (motion, estimate) = (self.motion()?, self.recorded(Signal::Estimate));
        match self.model()? {
            Model::Robot(robot) => robot.term(&motion, term, estimate),
            Model::Spacecraft(_) | Model::Chain(_) => Err(Missing::Term),
        }
    }

    pub(super) fn adapted(&mut self) -> Result<Vector, Missing> {
        let (motion, estimate) = (self.motion()?, self.recorded(Signal::Estimate));
        match self.model()? {
            Model::Robot(robot) => robot.adapted(&motion, estimate),
            Model::Spacecraft(_) | Model::Chain(_) => Err(Missing::Term),
        }
    }
}
