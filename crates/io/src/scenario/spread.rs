//! `parameter_variation` of a population → what its robots differ by.

use super::at::At;
use super::fault::{Fault, between, fault, seed};
use super::file::{AgentFile, SpreadFile};
use super::problem::ScenarioProblem;
use super::random::{Stream, draws};

/// The largest spread: nothing may weigh next to nothing.
const MOST_RELATIVE: f64 = 0.9;

/// How the robot of one agent differs from what its population's table says.
#[derive(Clone, Debug)]
pub struct Spread<'a> {
    place: &'a At<SpreadFile>,
    relative: f64,
    seed: u64,
    agent: &'a str,
    index: usize,
}

impl<'a> Spread<'a> {
    /// That of `agent`, number `index` of the population of `entry`; none where its robots do not differ.
    pub(super) fn of(entry: &'a AgentFile, agent: &'a str, index: usize) -> Result<Option<Self>, Fault> {
        let Some(place) = &entry.parameter_variation else { return Ok(None) };
        if entry.count.is_none() {
            return Err(fault(place, ScenarioProblem::SpreadOfOne));
        }
        let relative = between("relative", &place.value.relative, 0.0, MOST_RELATIVE)?;
        Ok(Some(Spread { place, relative, seed: seed(&place.value.seed)?, agent, index }))
    }

    /// So many random factors around one. Ask once: every call gives the same ones.
    pub fn factors(&self, length: usize) -> Vec<f64> {
        let units = draws(self.seed, Stream::Spread, self.index, length);
        units.map(|unit| 1.0 + self.relative * (2.0 * unit - 1.0)).collect()
    }

    /// Multiplies every parameter by a factor of its own.
    pub fn scale_each(&self, theta: &mut [f64]) {
        let factors = self.factors(theta.len());
        theta.iter_mut().zip(factors).for_each(|(entry, factor)| *entry *= factor);
    }

    /// There is no robot with these factors: its mass matrix would not be positive definite.
    pub fn unsound(&self) -> Fault {
        fault(self.place, ScenarioProblem::SpreadMassMatrix { agent: self.agent.to_owned() })
    }
}
