//! Chains of Section IV and vehicles with one thrust: their nonlinear terms at an instant.

use std::sync::Arc;

use forwardstep_core::attitude::{cross, rotate};
use forwardstep_core::plant::{Formulas, Terms, VectorFormulas};
use forwardstep_sim::{AgentSetup, ChainModel, RotorcraftModel, Signal, ThrustKind, ThrustLaw, VehicleModel};

use super::super::case::{Step, ThrustStep};
use super::super::form::{Term, number};
use super::Missing;
use super::moment::{At, Vector, exact};
use super::robot::Model;

/// (33) with its true θ.
pub(super) struct Chain {
    terms: ChainTerms,
    theta: Vec<f64>,
}

enum ChainTerms {
    One(Arc<Formulas>),
    Several(Arc<VectorFormulas>),
}

impl ChainTerms {
    /// χ₀, ψ row by row and Y row by row.
    fn at(&self, x: &[f64]) -> Option<[Vec<f64>; 3]> {
        match self {
            ChainTerms::One(terms) => {
                let mut phi = vec![0.0; terms.parameters()];
                let (chi, psi) = terms.terms(&mut terms.scratch(), x, &mut phi).ok()?;
                Some([vec![chi], vec![psi], phi])
            }
            ChainTerms::Several(terms) => {
                let mut work = terms.work();
                terms.terms(&mut work, x).ok()?;
                Some([work.chi().to_vec(), work.psi().to_vec(), work.regressor().to_vec()])
            }
        }
    }
}

impl Chain {
    pub(super) fn of(agent: &AgentSetup) -> Option<Chain> {
        let terms = match agent.robot.kind.downcast::<ChainModel>()? {
            ChainModel::Derivatives(terms) => ChainTerms::One(terms.clone()),
            ChainModel::Vector(terms) => ChainTerms::Several(terms.clone()),
            ChainModel::Cascade(_) => return None,
        };
        Some(Chain { terms, theta: agent.robot.theta.clone() })
    }

    /// χ, ψ u, or Y times what an estimate lacks of θ.
    fn term(&self, term: Term, x: &[f64], [u, estimate]: [&[f64]; 2]) -> Option<Vector> {
        let [chi, psi, phi] = self.terms.at(x)?;
        let add = |[sum, size]: [f64; 2], term: f64| [sum + term, size + term.abs()];
        let (m, p) = (chi.len(), self.theta.len());
        let (psi, phi) = (|row: usize| &psi[row * m..][..m], |row: usize| &phi[row * p..][..p]);
        let entry = |row: usize| match term {
            Term::Drift => {
                let known = phi(row).iter().zip(&self.theta).map(|(phi, theta)| phi * theta);
                known.fold([chi[row], chi[row].abs()], add)
            }
            Term::Actuation => psi(row).iter().zip(u).map(|(psi, u)| psi * u).fold([0.0; 2], add),
            _ => {
                let missing = phi(row).iter().zip(estimate).zip(&self.theta);
                missing.flat_map(|((phi, hat), theta)| [phi * hat, -phi * theta]).fold([0.0; 2], add)
            }
        };
        (term != Term::Actuation || u.len() == m).then(|| (0..m).map(entry).collect())
    }
}

impl At<'_, '_> {
    pub(super) fn chain_term(&mut self, term: Term) -> Result<Vector, Missing> {
        let Step::Chain(order, ..) = self.case.step else { return Err(Missing::Term) };
        let mut x = Vec::new();
        for k in 0..order {
            x.extend(self.position(k)?);
        }
        let (u, estimate) = (self.recorded(Signal::Torque), self.recorded(Signal::Estimate));
        let known = [u.unwrap_or_default(), estimate.unwrap_or_default()];
        match self.model()? {
            Model::Chain(chain) => chain.term(term, &x, known).ok_or(Missing::Term),
            Model::Robot(_) | Model::Spacecraft(_) => Err(Missing::Term),
        }
    }

    fn vehicle(&self) -> Result<(f64, f64), Missing> {
        let kind = &self.case.setup.agents[self.moment.agent].robot.kind;
        let vehicle = kind.downcast().map(|model: &VehicleModel| model.gravity);
        let gravity = vehicle.or_else(|| kind.downcast().map(|model: &RotorcraftModel| model.gravity));
        Ok((self.mass()?, gravity.ok_or(Missing::Term)?))
    }

    /// Whether torques bring its angular velocity about, and not at once.
    fn is_rotorcraft(&self) -> bool {
        self.case.setup.agents[self.moment.agent].robot.kind.is::<RotorcraftModel>()
    }

    /// g e₃ of a vehicle.
    pub(super) fn weight(&self) -> Result<[f64; 3], Missing> {
        Ok([0.0, 0.0, self.vehicle()?.1])
    }

    /// m of a vehicle.
    pub(super) fn mass(&self) -> Result<f64, Missing> {
        self.case.setup.agents[self.moment.agent].robot.theta.first().copied().ok_or(Missing::Term)
    }

    /// x⃛ = −(σ̇ R e₃ + σ R S(ω) e₃)/m, less that of an offset.
    pub(super) fn jerk(&self) -> Result<Vector, Missing> {
        if self.is_rotorcraft() {
            return Err(Missing::InnerLoop);
        }
        if self.is_pushed() {
            return Err(Missing::Pushed);
        }
        self.jerk_with(Signal::AngularVelocity)
    }

    /// The same with the angular velocity that stands in this column, whatever pushes.
    fn jerk_with(&self, angular_velocity: Signal) -> Result<Vector, Missing> {
        let (mass, _) = self.vehicle()?;
        let block = |signal, rates| self.state(signal, rates).ok_or(Missing::Term);
        let (sigma, d_sigma) = (block(Signal::Thrust, false)?, block(Signal::Thrust, true)?);
        let q = *block(Signal::Attitude, false)?.first_chunk().ok_or(Missing::Term)?;
        let omega = self.recorded(angular_velocity).and_then(|omega| omega.first_chunk()).ok_or(Missing::Term)?;
        let down = [0.0, 0.0, 1.0];
        let (along, turned) = (rotate(q, down), rotate(q, cross(*omega, down)));
        let offset = self.target().unwrap_or_else(|| vec![[0.0; 5]; 3]);
        let each = along.iter().zip(&turned).zip(&offset);
        let terms = each.map(|((a, t), jet)| [-d_sigma[0] * a / mass, -sigma[0] * t / mass, -jet[3]]);
        Ok(terms.map(|terms| [terms.iter().sum(), terms.iter().map(|term: &f64| term.abs()).sum()]).collect())
    }

    /// g e₃, w, m̂ w, Δm w, or u* = m (x⃛ + α* ẍ − α* g e₃), which the thrust and the angular velocity bring about.
    pub(super) fn vehicle_term(&mut self, term: Term) -> Result<Vector, Missing> {
        let Step::Thrust(_, [alpha, _]) = &self.case.step else { return Err(Missing::Term) };
        let ((mass, gravity), alpha) = (self.vehicle()?, number(alpha));
        let weight = [0.0, 0.0, gravity];
        let driven = |high: Vector, low: Vector| -> Vector {
            let each = high.into_iter().zip(low).zip(weight);
            each.map(|((high, low), weight)| {
                let (low, weight) = (low.map(|x| alpha * x), alpha * weight);
                [high[0] + low[0] - weight, high[1] + low[1] + weight.abs()]
            })
            .collect()
        };
        let factor = match term {
            Term::Weight => return Ok(exact(weight)),
            Term::Input => {
                let moved = if self.is_rotorcraft() { self.asked()? } else { [self.jerk()?, self.moved(2)?] };
                let moved = driven(moved[0].clone(), moved[1].clone());
                return Ok(moved.into_iter().map(|entry| entry.map(|x| mass * x)).collect());
            }
            Term::MassEstimate => exact(self.mass_estimated()?),
            _ => self.mass_estimated()?.map(|hat| [hat - mass, hat.abs() + mass.abs()]).to_vec(),
        };
        let w = driven(exact(self.reference(2)?), exact(self.reference(1)?));
        Ok(w.into_iter().map(|[value, size]| [factor[0][0] * value, factor[0][1] * size]).collect())
    }

    /// x⃛ and ẍ of a rotorcraft as its thrust and the angular velocity asked for would make them, with no push, less those of an offset.
    fn asked(&self) -> Result<[Vector; 2], Missing> {
        let (mass, gravity) = self.vehicle()?;
        let block = |signal| self.state(signal, false).ok_or(Missing::Term);
        let (sigma, q) = (block(Signal::Thrust)?, *block(Signal::Attitude)?.first_chunk().ok_or(Missing::Term)?);
        let offset = self.target().unwrap_or_else(|| vec![[0.0; 5]; 3]);
        let each = rotate(q, [0.0, 0.0, 1.0]).into_iter().zip([0.0, 0.0, gravity]).zip(&offset);
        let terms = each.map(|((along, weight), jet)| [weight, -sigma[0] * along / mass, -jet[2]]);
        let ddx = terms.map(|terms| [terms.iter().sum(), terms.iter().map(|term: &f64| term.abs()).sum()]).collect();
        Ok([self.jerk_with(Signal::AngularVelocityWanted)?, ddx])
    }

    fn mass_estimated(&self) -> Result<[f64; 1], Missing> {
        let shown = self.recorded(Signal::Estimate).and_then(|estimate| estimate.first_chunk());
        shown.copied().ok_or(Missing::Term)
    }

    /// (58) of a vehicle: m̂' + γ* wᵀṡ*, where m̂ is m̂(0) + I − γ* wᵀs*, from the rate of I; with bounds that is μ, which comes back.
    pub(super) fn vehicle_estimate(&mut self) -> Result<Vector, Missing> {
        let Step::Thrust(step, [alpha, gamma]) = &self.case.step else { return Err(Missing::Term) };
        let (alpha, gamma) = (number(alpha), number(gamma));
        match step {
            ThrustStep::Adaptive => {}
            ThrustStep::ByAcceleration => return self.mass_by_acceleration(alpha, gamma),
            ThrustStep::Continuous | ThrustStep::Differentiable => return Err(Missing::Term),
        }
        self.vehicle()?;
        let [dx, z, ddz, dddz] = [self.position(1)?, self.reference(0)?, self.reference(2)?, self.reference(3)?];
        let offset = self.target().unwrap_or_else(|| vec![[0.0; 5]; 3]);
        let mut sum = exact(self.state(Signal::Estimate, true).ok_or(Missing::Term)?);
        for k in 0..3.min(dx.len()) {
            let dw = [dddz[k], offset[k][4], alpha * ddz[k], alpha * offset[k][3]];
            for term in dw.into_iter().flat_map(|dw| [-gamma * dw * dx[k], gamma * dw * z[k]]) {
                sum[0] = [sum[0][0] + term, sum[0][1] + term.abs()];
            }
        }
        let law = self.case.setup.agents[self.moment.agent].law.downcast::<ThrustLaw>().map(|law| law.design);
        if let Some(ThrustKind::Adaptive { estimate_start, bounds: Some(range), .. }) = law {
            let (_, gravity) = self.vehicle()?;
            let (dz, integral) = (self.reference(1)?, self.state(Signal::Estimate, false).ok_or(Missing::Term)?);
            let weight = |k: usize| if k == 2 { alpha * gravity } else { 0.0 };
            let w = |k: usize| ddz[k] + offset[k][3] + alpha * (dz[k] + offset[k][2]) - weight(k);
            let ws: f64 = (0..3).map(|k| w(k) * (dx[k] - z[k] - offset[k][1])).sum();
            let back = alpha * range.beyond(estimate_start + integral[0] - gamma * ws);
            sum[0] = [sum[0][0] + back, sum[0][1] + back.abs()];
        }
        Ok(sum)
    }

    /// m̂' + γ* wᵀṡ* by the recorded acceleration; with bounds μ comes back.
    fn mass_by_acceleration(&self, alpha: f64, gamma: f64) -> Result<Vector, Missing> {
        let (_, gravity) = self.vehicle()?;
        let ddx = self.recorded(Signal::Acceleration).and_then(|ddx| ddx.first_chunk::<3>()).ok_or(Missing::Term)?;
        let [dz, ddz] = [self.reference(1)?, self.reference(2)?];
        let offset = self.target().unwrap_or_else(|| vec![[0.0; 5]; 3]);
        let mut sum = exact(self.state(Signal::Estimate, true).ok_or(Missing::Term)?);
        for k in 0..3 {
            let ds = ddx[k] - dz[k] - offset[k][2];
            let weight = if k == 2 { -alpha * gravity } else { 0.0 };
            let w = [ddz[k], offset[k][3], alpha * dz[k], alpha * offset[k][2], weight];
            for term in w.map(|w| gamma * w * ds) {
                sum[0] = [sum[0][0] + term, sum[0][1] + term.abs()];
            }
        }
        let law = self.case.setup.agents[self.moment.agent].law.downcast::<ThrustLaw>().map(|law| law.design);
        if let Some((range, start)) = law.and_then(|law| law.bounds().zip(law.estimate_start())) {
            let learnt = self.state(Signal::Estimate, false).ok_or(Missing::Term)?;
            let back = alpha * range.beyond(start + learnt[0]);
            sum[0] = [sum[0][0] + back, sum[0][1] + back.abs()];
        }
        Ok(sum)
    }
}
