//! The law (6) of one agent at one instant, from a row of its run.

use forwardstep_core::robot::TwoVelocity;
use forwardstep_sim::recording::Signal;
use forwardstep_sim::{AgentSetup, Evaluator, ProductsAt};
use nalgebra::DVector;

use super::super::rates::Gains;
use crate::surroundings::smoothed_friction;

/// Where signals stand in a row.
#[derive(Clone, Copy)]
pub(super) struct Places {
    pub(super) velocity: usize,
    pub(super) z: usize,
    pub(super) dz: usize,
    pub(super) torque: usize,
    pub(super) estimate: Option<usize>,
    pub(super) lyapunov: usize,
    pub(super) external: Option<usize>,
}

impl Places {
    pub(super) fn of(signals: &[Signal]) -> Option<Places> {
        let at = |wanted| signals.iter().position(|signal| *signal == wanted);
        Some(Places {
            velocity: at(Signal::Velocity)?,
            z: at(Signal::Reference(0))?,
            dz: at(Signal::Reference(1))?,
            torque: at(Signal::Torque)?,
            estimate: at(Signal::Estimate),
            lyapunov: at(Signal::Lyapunov)?,
            external: at(Signal::External),
        })
    }
}

/// One agent at one instant.
pub(super) struct State {
    pub(super) q: Vec<f64>,
    pub(super) dq: Vec<f64>,
    pub(super) z: Vec<f64>,
    pub(super) dz: Vec<f64>,
    pub(super) s: DVector<f64>,
    pub(super) theta_hat: Option<Vec<f64>>,
}

/// (6) of one agent.
pub(super) struct Law<'a> {
    pub(super) agent: &'a AgentSetup,
    pub(super) gains: Gains,
    pub(super) places: Places,
    pub(super) evaluator: Box<dyn Evaluator>,
}

impl Law<'_> {
    pub(super) fn state(&self, values: &[f64]) -> Option<State> {
        let (m, p) = (self.agent.robot.axes.len(), self.agent.robot.theta.len());
        let part = |from: usize, n: usize| values.get(from..from + n).map(<[f64]>::to_vec);
        // Positions come first.
        let (q, dq, z) = (part(0, m)?, part(self.places.velocity, m)?, part(self.places.z, m)?);
        let s = DVector::from_iterator(m, dq.iter().zip(&z).map(|(dq, z)| dq - z));
        let theta_hat = match self.places.estimate {
            Some(from) => Some(part(from, p)?),
            None => None,
        };
        Some(State { q, dq, z, dz: part(self.places.dz, m)?, s, theta_hat })
    }

    /// The products at a state, with the parameters `theta`.
    pub(super) fn products(&mut self, theta: &[f64], state: &State, s: &DVector<f64>) -> Option<&ProductsAt> {
        let State { q, dq, z, dz, .. } = state;
        self.evaluator.at(theta, TwoVelocity { q, dq, z, dz }, s.as_slice()).ok()
    }

    /// sᵀF tanh(z/ε), W: what Y has in place of dry friction; zero where there is none.
    pub(super) fn smoothed_w(&self, state: &State) -> f64 {
        match smoothed_friction(self.agent, &state.z) {
            Some((rubs, false)) => rubs.iter().zip(state.s.iter()).map(|(rubs, s)| rubs * s).sum(),
            Some((_, true)) | None => 0.0,
        }
    }

    /// Y ϑ̂ − K s at a state, with `q` and `dq` for what is measured.
    pub(super) fn torque(&mut self, state: &State, q: &[f64], dq: &[f64]) -> Option<DVector<f64>> {
        let motion = TwoVelocity { q, dq, z: &state.z, dz: &state.dz };
        let s = DVector::from_iterator(dq.len(), dq.iter().zip(&state.z).map(|(dq, z)| dq - z));
        let theta = state.theta_hat.as_ref().unwrap_or(&self.agent.robot.theta);
        let model = &self.evaluator.at(theta, motion, s.as_slice()).ok()?.model;
        Some(DVector::from_column_slice(model) - &self.gains.damping * s)
    }
}
