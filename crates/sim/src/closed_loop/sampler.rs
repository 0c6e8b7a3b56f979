//! The sampled controllers of a population, with their sensors and what they hold.

use forwardstep_core::Scalar;
use forwardstep_core::agent::{Agent, Inbox, StepError, VelocityFilter};
use forwardstep_core::reference::Measured;
use forwardstep_core::robot::Lagrangian;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::fleet::Drive;
use super::population::Inputs;
use super::references::{AnyReference, Transmits};
use crate::setup::{Control, Sensors};

/// Controllers and sensors of n agents with m axes. Columns are laid out as everywhere: `axis · n + member`.
pub(crate) struct Sampler<R: Lagrangian<f64>, X: Transmits> {
    agents: Vec<Agent<R, AnyReference<X>>>,
    sensors: Vec<Sensor>,
    period_s: f64,
    torque_quantum: f64,
    axes: usize,
    started: bool,
    /// Measured at the last sample: q, then q̇.
    measured: Vec<f64>,
    /// Asked for at the last sample.
    z: Vec<f64>,
    dz: Vec<f64>,
    commanded: Vec<f64>,
    /// Applied now.
    torque: Vec<f64>,
    /// One agent's vectors.
    own: Own,
}

/// One agent's part of the columns.
struct Own {
    q: Vec<f64>,
    dq: Vec<f64>,
    sums: Vec<f64>,
    state: Vec<f64>,
}

/// What one agent measures with.
pub(crate) struct Sensor {
    draw: ChaCha8Rng,
    filter: Option<VelocityFilter>,
    kind: Sensors,
}

impl Sensor {
    /// The sensor of agent number `agent`; every agent has noise of its own.
    pub(crate) fn new(kind: Sensors, agent: usize, filter: Option<VelocityFilter>) -> Self {
        let mut draw = ChaCha8Rng::seed_from_u64(kind.seed);
        draw.set_stream(agent as u64);
        Sensor { draw, filter, kind }
    }

    /// Replaces the truth by what is measured; there may be no velocity.
    pub(crate) fn measure(&mut self, period_s: f64, q: &mut [f64], dq: &mut [f64]) {
        let kind = self.kind;
        if kind.position_noise > 0.0 || kind.velocity_noise > 0.0 {
            for (k, q) in q.iter_mut().enumerate() {
                let [first, second] = normal(&mut self.draw);
                *q += kind.position_noise * first;
                if let Some(dq) = dq.get_mut(k) {
                    *dq += kind.velocity_noise * second;
                }
            }
        }
        q.iter_mut().for_each(|q| *q = quantise(*q, kind.position_quantum));
        match &mut self.filter {
            // The lengths are those of one robot.
            Some(filter) => {
                if let Ok(velocity) = filter.feed(period_s, q)
                    && dq.len() == velocity.len()
                {
                    dq.copy_from_slice(velocity);
                }
            }
            None => dq.iter_mut().for_each(|dq| *dq = quantise(*dq, kind.velocity_quantum)),
        }
    }
}

/// Two independent normal numbers with mean 0 and variance 1, after Box and Muller. Not from a crate: those take their
/// logarithms from the standard library, whose last bit depends on the processor.
fn normal(draw: &mut ChaCha8Rng) -> [f64; 2] {
    let radius = libm::sqrt(-2.0 * libm::log(1.0 - draw.random::<f64>()));
    let (sine, cosine) = Scalar::sin_cos(core::f64::consts::TAU * draw.random::<f64>());
    [radius * cosine, radius * sine]
}

/// The nearest multiple of `quantum`, if there is one.
pub(crate) fn quantise(value: f64, quantum: f64) -> f64 {
    if quantum > 0.0 { quantum * libm::rint(value / quantum) } else { value }
}

impl<R: Lagrangian<f64>, X: Transmits> Sampler<R, X> {
    /// `agents` and `sensors` in the order of the members.
    pub(crate) fn new(
        agents: Vec<Agent<R, AnyReference<X>>>,
        sensors: Vec<Sensor>,
        control: &Control,
        axes: usize,
    ) -> Self {
        let block = || vec![0.0; axes * agents.len()];
        let told = agents.first().map_or(0, |agent| agent.told().len());
        let state = agents.first().map_or(0, |agent| agent.reference_state().len());
        Sampler {
            sensors,
            period_s: 1.0 / control.sample_hz,
            torque_quantum: control.actuators.torque_quantum,
            axes,
            started: false,
            measured: vec![0.0; 2 * axes * agents.len()],
            z: block(),
            dz: block(),
            commanded: block(),
            torque: block(),
            own: Own {
                q: vec![0.0; axes],
                dq: vec![0.0; axes],
                sums: vec![0.0; X::CHANNELS * axes + told],
                state: vec![0.0; state],
            },
            agents,
        }
    }

    /// What moves the robots until the next event.
    pub(crate) fn drive<'a>(&'a self, external: Option<&'a [f64]>) -> Drive<'a> {
        Drive { z: &self.z, dz: &self.dz, held: Some(&self.torque), external }
    }

    /// Measures q and q̇ and sends what the reference transmits.
    pub(crate) fn sense(&mut self, q: &[f64], dq: &[f64], sent: &mut [f64]) {
        let n = self.agents.len();
        for (i, sensor) in self.sensors.iter_mut().enumerate() {
            take(n, i, q, &mut self.own.q);
            take(n, i, dq, &mut self.own.dq);
            sensor.measure(self.period_s, &mut self.own.q, &mut self.own.dq);
            give(n, i, &self.own.q, &mut self.measured[..self.axes * n]);
            give(n, i, &self.own.dq, &mut self.measured[self.axes * n..]);
        }
        // A message is positions, then velocities if they are sent, then what was computed at the last sample, if anything.
        let told = self.own.sums.len() - X::CHANNELS * self.axes;
        let (measured, computed) = sent.split_at_mut(sent.len().saturating_sub(told * n));
        measured.copy_from_slice(&self.measured[..measured.len()]);
        if told > 0 {
            for (i, agent) in self.agents.iter().enumerate() {
                give(n, i, agent.told(), computed);
            }
        }
    }

    /// Steps every controller; `reference` and `theta_hat` are the columns of their states, read at the first sample and
    /// written at all others. What cannot be stepped any more, since something is no longer finite, asks for a torque that
    /// is not either: the run then breaks down there.
    pub(crate) fn command(&mut self, now_s: f64, inputs: Inputs<'_>, reference: &mut [f64], theta_hat: &mut [f64]) {
        if self.try_command(now_s, inputs, reference, theta_hat).is_err() {
            self.commanded.fill(f64::NAN);
        }
    }

    fn try_command(
        &mut self,
        now_s: f64,
        inputs: Inputs<'_>,
        reference: &mut [f64],
        theta_hat: &mut [f64],
    ) -> Result<(), StepError> {
        let n = self.agents.len();
        let Own { q, dq, sums, state } = &mut self.own;
        for (i, agent) in self.agents.iter_mut().enumerate() {
            if !self.started {
                take(n, i, reference, state);
                agent.set_reference(state)?;
            }
            take(n, i, &self.measured, q);
            take(n, i, &self.measured[self.axes * n..], dq);
            take(n, i, inputs.sums, sums);
            let inbox = Inbox { degree: inputs.degree[i], sums };
            let command = agent.step(now_s, Measured { q, dq }, inbox)?;
            give(n, i, command.z, &mut self.z);
            give(n, i, command.dz, &mut self.dz);
            give(n, i, command.tau, &mut self.commanded);
            give(n, i, agent.reference_state(), reference);
            if !theta_hat.is_empty() {
                give(n, i, agent.estimate(), theta_hat);
            }
        }
        self.started = true;
        Ok(())
    }

    /// Hands the commands to the actuators.
    pub(crate) fn apply(&mut self) {
        for (torque, commanded) in self.torque.iter_mut().zip(&self.commanded) {
            *torque = quantise(*commanded, self.torque_quantum);
        }
    }
}

/// Member `i` of `n` out of columns.
fn take(n: usize, i: usize, columns: &[f64], out: &mut [f64]) {
    for (k, out) in out.iter_mut().enumerate() {
        *out = columns[k * n + i];
    }
}

/// Member `i` of `n` into columns.
fn give(n: usize, i: usize, values: &[f64], columns: &mut [f64]) {
    for (k, value) in values.iter().enumerate() {
        columns[k * n + i] = *value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_normal() {
        let mut draw = ChaCha8Rng::seed_from_u64(7);
        let samples: Vec<f64> = (0..20_000).flat_map(|_| normal(&mut draw)).collect();
        let n = samples.len() as f64;
        let mean = samples.iter().sum::<f64>() / n;
        let variance = samples.iter().map(|x| x * x).sum::<f64>() / n;
        let within = samples.iter().filter(|x| x.abs() < 1.0).count() as f64 / n;
        // Five standard errors each.
        assert!(mean.abs() < 5.0 / n.sqrt(), "{mean}");
        assert!((variance - 1.0).abs() < 5.0 * (2.0 / n).sqrt(), "{variance}");
        assert!((within - 0.682_689).abs() < 5.0 * (0.25 / n).sqrt(), "{within}");
    }

    #[test]
    fn noise_of_positions_of_velocities_and_of_agents_is_independent() {
        let kind = Sensors { position_noise: 1.0, velocity_noise: 1.0, seed: 3, ..Sensors::default() };
        let mut sensors = [0, 1].map(|agent| Sensor::new(kind, agent, None));
        let mut rows: Vec<[f64; 4]> = Vec::new();
        for _ in 0..10_000 {
            let mut row = [0.0; 4];
            for (sensor, pair) in sensors.iter_mut().zip(row.chunks_exact_mut(2)) {
                let (q, dq) = pair.split_at_mut(1);
                sensor.measure(0.01, q, dq);
            }
            rows.push(row);
        }
        let n = rows.len() as f64;
        for a in 0..4 {
            for b in 0..4 {
                let mean = rows.iter().map(|row| row[a] * row[b]).sum::<f64>() / n;
                // Five standard errors.
                let (want, error) = if a == b { (1.0, (2.0 / n).sqrt()) } else { (0.0, 1.0 / n.sqrt()) };
                assert!((mean - want).abs() < 5.0 * error, "{a} and {b}: {mean}");
            }
        }
    }

    #[test]
    fn positions_and_velocities_have_steps_and_noise_of_their_own() {
        let measured = |kind: Sensors| {
            let (mut q, mut dq) = ([0.26], [0.26]);
            Sensor::new(kind, 0, None).measure(0.01, &mut q, &mut dq);
            [q[0], dq[0]]
        };
        let exact = Sensors::default();
        assert_eq!(measured(exact), [0.26, 0.26]);
        assert_eq!(measured(Sensors { position_quantum: 0.5, ..exact }), [0.5, 0.26]);
        assert_eq!(measured(Sensors { velocity_quantum: 0.125, ..exact }), [0.26, 0.25]);
        let [q, dq] = measured(Sensors { position_noise: 0.1, ..exact });
        assert!(q != 0.26 && dq == 0.26);
        let [q, dq] = measured(Sensors { velocity_noise: 0.1, ..exact });
        assert!(q == 0.26 && dq != 0.26);
    }

    #[test]
    fn quanta_are_rounded_to_the_nearest() {
        assert_eq!([0.26, -0.24, 0.74].map(|x| quantise(x, 0.5)), [0.5, 0.0, 0.5]);
        assert_eq!(quantise(0.123, 0.0), 0.123);
    }
}
