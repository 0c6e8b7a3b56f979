//! One period of one agent under digital control, as a map, and its Jacobian by central differences.
//!
//! The state of the map is that of the plant and of the controller at a sample, as the sampled controller carries it on, and the
//! command before where commands come late. Everything else that a controller remembers of its last sample follows from these: built
//! anew from its recipe with that state, it takes the sample again. The map is that of the run itself, with exact measurements, no
//! limits and no pushes; the agent is by itself and hears nothing.

use super::assembly::Assembly;
use super::columns::{Columns, Inputs};
use super::error::SetupError;
use super::probe::alone_under;
use super::recipes::built;
use super::valid::message_len;
use crate::network::Network;
use crate::schedule::Schedule;
use crate::setup::{Actuators, Control, Failures, Sensors, Setup, Solver, VelocitySensor};

/// Steps of the classical Runge–Kutta method before a late command, and after it.
const STEPS: u32 = 24;
/// How far a state is moved to both sides, relative to its size.
const APART: f64 = 1e-6;

/// How the state at a sample depends on that at the sample before.
#[derive(Clone, Debug, PartialEq)]
pub struct SampledJacobian {
    /// Numbers of state.
    pub size: usize,
    /// Row by row.
    pub entries: Vec<f64>,
}

/// The Jacobian of one period of agent `index` of `setup`, at its start; `None` when control is continuous, where velocities are
/// filtered differences, whose memory is not part of the state, and where something is not finite.
///
/// # Errors
/// [`SetupError`] when the law cannot build the agent.
pub fn sampled_jacobian(setup: &Setup, index: usize) -> Result<Option<SampledJacobian>, SetupError> {
    let (Some(control), Some(own)) = (&setup.control, setup.agents.get(index)) else { return Ok(None) };
    match control.sensors.velocity {
        VelocitySensor::Measured => {}
        VelocitySensor::Filtered { .. } => return Ok(None),
    }
    let mut own = own.clone();
    own.enforce_limits = false;
    own.pushes.clear();
    let exact = Control {
        sensors: Sensors::default(),
        actuators: Actuators::default(),
        failures: Failures::default(),
        ..control.clone()
    };
    let alone = Setup {
        agents: vec![own],
        reference: alone_under(setup, index),
        exchange: setup.exchange,
        network: Network::switching(1, Schedule::fixed(Vec::new()), Vec::new()),
        time: setup.time.clone(),
        solver: Solver { balance: false, ..setup.solver },
        control: Some(exact.clone()),
    };
    let law = alone.agents[0].law.clone();
    let block = law.block(&Assembly::new(&alone, &[0]))?;
    let sums = vec![0.0; message_len(&alone)];
    Period { columns: block.0, setup: &alone, control: exact, sums }.jacobian()
}

/// What makes a period pass.
struct Period<'a> {
    columns: Box<dyn Columns>,
    setup: &'a Setup,
    control: Control,
    /// What is heard: nothing.
    sums: Vec<f64>,
}

impl Period<'_> {
    fn jacobian(mut self) -> Result<Option<SampledJacobian>, SetupError> {
        let mut x = Vec::new();
        self.columns.append_start(&self.setup.agents, &mut x);
        let sums = self.sums.clone();
        let agent = &self.setup.agents[0].name;
        let error = |error| SetupError::Length { agent: agent.clone(), error };
        self.columns.start(&self.setup.agents, &mut x, &[0.0], &sums).map_err(error)?;
        let states = x.len();
        let (_, command) = self.pass(&x, None)?;
        if self.control.computation_delay_s > 0.0 {
            x.extend(command);
        }
        let n = x.len();
        let mut entries = vec![0.0; n * n];
        for column in 0..n {
            let apart = APART * (1.0 + x[column].abs());
            let mut moved = |by: f64| {
                let mut x = x.clone();
                x[column] += by;
                let before = (n > states).then(|| x.split_off(states));
                let (mut next, command) = self.pass(&x, before.as_deref())?;
                if n > states {
                    next.extend(command);
                }
                Ok::<_, SetupError>(next)
            };
            let (above, below) = (moved(apart)?, moved(-apart)?);
            for (row, (above, below)) in above.iter().zip(&below).enumerate() {
                entries[row * n + column] = (above - below) / (2.0 * apart);
            }
        }
        Ok(entries.iter().all(|entry| entry.is_finite()).then_some(SampledJacobian { size: n, entries }))
    }

    /// The state a period after `x`, and the command at its beginning; `before` is what the actuators held until then.
    fn pass(&mut self, x: &[f64], before: Option<&[f64]>) -> Result<(Vec<f64>, Vec<f64>), SetupError> {
        let period_s = 1.0 / self.control.sample_hz;
        let late_s = self.control.computation_delay_s;
        let recipes = self.columns.recipes(self.setup, x)?;
        let agent = &self.setup.agents[0].name;
        let controllers: Result<Vec<_>, _> = recipes.iter().map(|(_, recipe)| built(recipe, agent)).collect();
        self.columns.sample(&self.control, controllers?);
        let mut x = x.to_vec();
        self.take(0.0, &mut x);
        let mut command = Vec::new();
        self.columns.taken(&mut |digital| command.extend_from_slice(digital.taken(0, 0.0).command));
        if let Some(before) = before {
            self.columns.hold(before);
            self.flow(&mut x, [0.0, late_s]);
        }
        self.columns.apply();
        self.flow(&mut x, [if before.is_some() { late_s } else { 0.0 }, period_s]);
        self.take(period_s, &mut x);
        Ok((x, command))
    }

    /// A sample.
    fn take(&mut self, now_s: f64, x: &mut [f64]) {
        let mut sent = self.sums.clone();
        self.columns.sense(now_s, x, &mut sent);
        let inputs = Inputs { degree: &[0.0], sums: &self.sums, external: None };
        self.columns.command(now_s, inputs, x);
    }

    /// The plant moves under what the actuators hold.
    fn flow(&mut self, x: &mut [f64], [from_s, until_s]: [f64; 2]) {
        let h = (until_s - from_s) / f64::from(STEPS);
        let inputs = Inputs { degree: &[0.0], sums: &self.sums, external: None };
        let n = x.len();
        let (mut k, mut stage, mut sum) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for step in 0..STEPS {
            let t_s = from_s + h * f64::from(step);
            sum.fill(0.0);
            stage.copy_from_slice(x);
            for (when, weight, next) in [(0.0, 1.0, 0.5), (0.5, 2.0, 0.5), (0.5, 2.0, 1.0), (1.0, 1.0, 0.0)] {
                self.columns.rates(t_s + when * h, &stage, inputs, &mut k);
                for i in 0..n {
                    sum[i] += weight * k[i];
                    stage[i] = x[i] + next * h * k[i];
                }
            }
            x.iter_mut().zip(&sum).for_each(|(x, sum)| *x += h / 6.0 * sum);
            self.columns.settle(x);
        }
    }
}
