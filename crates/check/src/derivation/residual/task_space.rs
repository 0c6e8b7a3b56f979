//! The end-effector of a robot, (76)–(82): Ĵᵀ K* Δx, z_r, and the rate of θ̂ at an instant.
//!
//! Ĵ and its rate are those of the kinematics with θ̂ and θ̂' as they are integrated, so that ż_r is the derivative of the z_r of the run.

use forwardstep_core::ResolvedGain;
use forwardstep_core::attitude::{Desired, product};
use forwardstep_core::controller::NullSpace;
use forwardstep_core::law::ParameterBounds;
use forwardstep_core::robot::tree::Tree;
use forwardstep_core::robot::{Posture, TipKinematics};
use forwardstep_sim::{AgentSetup, Signal, TaskSpaceLaw, TipSetup};
use nalgebra::{DMatrix, DVector};

use super::super::case::Step;
use super::super::form::Term;
use super::Missing;
use super::moment::{At, Vector, exact};
use super::robot::{Model, times};

/// An end-effector and the gains of its law.
pub(super) struct Tip {
    kinematics: Box<dyn TipKinematics>,
    /// K*, or K_p and k_o.
    stiffness: ResolvedGain,
    attitude_gain: f64,
    /// Of redundant joints.
    null_space: Option<NullSpace>,
    /// Λ; `None` where θ̂ stays as it is.
    adaptation: Option<ResolvedGain>,
    /// What θ̂ is kept within.
    bounds: Option<ParameterBounds>,
}

impl Tip {
    pub(super) fn of(agent: &AgentSetup) -> Option<Tip> {
        let law: &TaskSpaceLaw = agent.law.downcast()?;
        let kinematics: Box<dyn TipKinematics> = match &law.tip {
            TipSetup::Planar(tip) => Box::new(*tip),
            TipSetup::Point { .. } => {
                Box::new(law.tip.of_tree(agent.robot.kind.downcast::<std::sync::Arc<Tree>>()?)?.ok()?)
            }
        };
        let stiffness = law.task_gain.resolve(kinematics.axes(), &[]).ok()?;
        let adaptation = match &law.kinematic_adaptation {
            Some(gain) => Some(gain.resolve(kinematics.parameter_count(), &[]).ok()?),
            None => None,
        };
        let (attitude_gain, null_space) = (law.attitude_gain, law.null_space.clone());
        Some(Tip { kinematics, stiffness, attitude_gain, null_space, adaptation, bounds: law.bounds.clone() })
    }
}

/// What the run says of an end-effector at an instant.
struct Seen {
    q: Vec<f64>,
    dq: Vec<f64>,
    /// θ̂ and θ̂'.
    estimate: [Vec<f64>; 2],
    /// x − x_d, or Δp.
    error: Vector,
    /// Δq_v of a pose, or nothing.
    turned: Vector,
    /// ẋ_d and ẍ_d, with ω_d and ω̇_d of a pose; by a measured velocity of the tip less αΔx and αΔẋ.
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
        let size = self.kinematics.rows() * self.kinematics.joints();
        let (mut j, mut dj) = (vec![0.0; size], vec![0.0; size]);
        let [theta, d_theta] = &seen.estimate;
        let posture = Posture { q: &seen.q, dq: &seen.dq, theta, d_theta };
        self.kinematics.jacobian(posture, &mut j, &mut dj).map_err(|_| Missing::Term)?;
        Ok([j, dj])
    }

    /// K* Δx, or e.
    fn weighted(&self, seen: &Seen) -> Vector {
        let turned = seen.turned.iter().map(|[value, size]| [self.attitude_gain * value, self.attitude_gain * size]);
        gained(&self.stiffness, &seen.error).into_iter().chain(turned).collect()
    }

    /// Ĵᵀ K* Δx.
    fn pulled(&self, seen: &Seen) -> Result<Vector, Missing> {
        let (m, n) = (self.kinematics.rows(), self.kinematics.joints());
        let [j, _] = self.jacobian(seen)?;
        let transposed: Vec<f64> = (0..m * n).map(|k| j[(k % m) * n + k / m]).collect();
        Ok(times(&transposed, &self.weighted(seen)))
    }

    /// z_r = Ĵ⁺ẋ_d + (I − Ĵ⁺Ĵ) φ, or its derivative by that of the pseudo-inverse Ĵ⁺ = ĴᵀA⁻¹; with a square Ĵ that is (77) and (78).
    fn leading(&self, seen: &Seen, k: usize) -> Result<Vector, Missing> {
        let (m, n) = (self.kinematics.rows(), self.kinematics.joints());
        let [j, dj] = self.jacobian(seen)?.map(|matrix| DMatrix::from_row_slice(m, n, &matrix));
        let [dx, ddx] = [0, 1].map(|k| DVector::from_column_slice(&seen.target[k]));
        if m == n {
            let factored = j.lu();
            let z_r = factored.solve(&dx).ok_or(Missing::Term)?;
            if k == 0 {
                return Ok(exact(z_r.iter().copied()));
            }
            let found = factored.solve(&(ddx - dj * z_r)).ok_or(Missing::Term)?;
            return Ok(exact(found.iter().copied()));
        }
        let a = (&j * j.transpose()).try_inverse().ok_or(Missing::Term)?;
        let plus = j.transpose() * &a;
        let [phi, d_phi] = self.wished(seen);
        let free = |v: &DVector<f64>| v - &plus * (&j * v);
        if k == 0 {
            return Ok(exact((&plus * dx + free(&phi)).iter().copied()));
        }
        let rate_of_a = &dj * j.transpose() + &j * dj.transpose();
        let d_plus = dj.transpose() * &a - &plus * rate_of_a * &a;
        let found = &d_plus * &dx + &plus * ddx - &d_plus * (&j * &phi) - &plus * (&dj * &phi) + free(&d_phi);
        Ok(exact(found.iter().copied()))
    }

    /// φ and φ̇.
    fn wished(&self, seen: &Seen) -> [DVector<f64>; 2] {
        let Some(NullSpace { rate_per_s, posture }) = &self.null_space else {
            return [DVector::zeros(seen.q.len()), DVector::zeros(seen.q.len())];
        };
        let apart = |k: usize| seen.q[k] - posture[k];
        let phi = DVector::from_fn(seen.q.len(), |k, _| -rate_per_s * apart(k) / libm::hypot(apart(k), 1.0));
        let d_phi = DVector::from_fn(seen.q.len(), |k, _| {
            let root = libm::hypot(apart(k), 1.0);
            -rate_per_s * seen.dq[k] / (root * root * root)
        });
        [phi, d_phi]
    }

    /// Λ Zᵀ K* Δx, slowed at the bounds if there are some.
    fn adapted(&self, seen: &Seen) -> Result<Vector, Missing> {
        let mut push = vec![0.0; self.kinematics.parameter_count()];
        let weighted = values(&self.weighted(seen));
        let found = self.kinematics.regressor_transposed(&seen.q, &seen.dq, &weighted, &mut push);
        found.map_err(|_| Missing::Term)?;
        match &self.adaptation {
            Some(lambda) => {
                let mut rates = gained(lambda, &exact(push));
                if let Some(bounds) = &self.bounds {
                    for (k, ([rate, _], hat)) in rates.iter_mut().zip(&seen.estimate[0]).enumerate() {
                        *rate = bounds.slowed(k, *hat, *rate);
                    }
                }
                Ok(rates)
            }
            None => Ok(exact(push.iter().map(|_| 0.0))),
        }
    }
}

impl At<'_, '_> {
    fn seen(&self) -> Result<Seen, Missing> {
        let followed = self.case.setup.agents[self.moment.agent].target.as_ref();
        let [x_d, dx_d, ddx_d] = [self.jet(followed, 0)?, self.jet(followed, 1)?, self.jet(followed, 2)?];
        let x = self.recorded(Signal::TaskPosition).ok_or(Missing::Term)?;
        let error: Vector = x.iter().zip(x_d).map(|(x, [x_d, _])| [x - x_d, x.abs() + x_d.abs()]).collect();
        let estimate = |rates| self.state(Signal::KinematicEstimate, rates).ok_or(Missing::Term);
        let mut target = [values(&dx_d), values(&ddx_d)];
        let turned = self.turned_away(error.len(), &mut target)?;
        if matches!(self.case.step, Step::TipVelocity(_)) {
            self.led_back(&error, &mut target)?;
        }
        Ok(Seen {
            q: self.position(0)?,
            dq: self.position(1)?,
            estimate: [estimate(false)?, estimate(true)?],
            error,
            turned,
            target,
        })
    }

    /// ẋ_d − αΔx and ẍ_d − αΔẋ with the recorded ẋ in the place of ẋ_d and ẍ_d.
    fn led_back(&self, error: &Vector, target: &mut [Vec<f64>; 2]) -> Result<(), Missing> {
        let law = self.case.setup.agents[self.moment.agent].law.downcast::<TaskSpaceLaw>().ok_or(Missing::Term)?;
        let dx = self.recorded(Signal::TaskVelocity).ok_or(Missing::Term)?;
        let [velocity, acceleration] = target;
        for (k, ([error, _], dx)) in error.iter().zip(dx).enumerate() {
            acceleration[k] -= law.alpha_per_s * (dx - velocity[k]);
            velocity[k] -= law.alpha_per_s * error;
        }
        Ok(())
    }

    /// Δq_v of a pose, the quaternion of R R_dᵀ with the sign of the recorded Δq_o; in the place of the rates of the desired
    /// quaternion its angular velocity and acceleration.
    fn turned_away(&self, axes: usize, target: &mut [Vec<f64>; 2]) -> Result<Vector, Missing> {
        let Some([scalar]) = self.recorded(Signal::ErrorScalar) else { return Ok(Vec::new()) };
        let jets = self.target().ok_or(Missing::Term)?;
        let path = jets.get(axes..).and_then(|rest| rest.first_chunk::<4>()).ok_or(Missing::Term)?;
        let own: &[f64; 4] = self.recorded(Signal::Attitude).and_then(|q| q.first_chunk()).ok_or(Missing::Term)?;
        let Desired { q: [x, y, z, o], omega, d_omega } = Desired::from_path(path);
        let error = product(*own, [-x, -y, -z, o]);
        let sign = if error[3] * scalar < 0.0 { -1.0 } else { 1.0 };
        for (target, rates) in target.iter_mut().zip([omega, d_omega]) {
            target.truncate(axes);
            target.extend(rates);
        }
        Ok(error[..3].iter().map(|entry| [sign * entry, 1.0]).collect())
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
