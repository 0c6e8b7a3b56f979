//! Sampled controllers as the simulator wires them: sensors before them, actuators behind them.

use std::ops::Range;

use forwardstep_core::agent::{Clipped, Inbox, StepError};
use forwardstep_core::plant::total;
use forwardstep_core::sampled::Sampled;
use forwardstep_core::signal::{Block, Signal};
use forwardstep_core::sine_and_cosine;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::columns::Inputs;
use super::robot_batch::Drive;
use crate::recording::SampleTaken;
use crate::setup::{Control, Sensors};

/// One agent: its sensors, its controller, and what its actuators hold.
pub(crate) struct Digital {
    agent: usize,
    sensor: Sensor,
    controller: Box<dyn Sampled>,
    torque_quantum: f64,
    /// Numbers of a position, and of the velocity that follows.
    axes: [usize; 2],
    /// Where the measured velocity of a tip stands in the output.
    tip_velocity: Range<usize>,
    /// Which part of the plant's output the controller takes: first entries there and here, and how many.
    parts: Vec<[usize; 3]>,
    /// The plant's output as the sensors see it.
    output: Vec<f64>,
    measured: Vec<f64>,
    /// What was sent and heard at the last sample.
    message: Vec<f64>,
    degree: f64,
    sums: Vec<f64>,
    /// Where the torques stand among the inputs.
    torque: Range<usize>,
    commanded: Vec<f64>,
    held: Vec<f64>,
    /// Whether a stated safe command stands where a step fails; else the run ends there.
    safe: bool,
    /// Steps that failed.
    failed: u64,
    samples: u64,
}

impl Digital {
    /// Puts `controller` between the sensors of agent number `agent`, whose plant has these `outputs`, and its actuators.
    pub(crate) fn new(control: &Control, agent: usize, outputs: &[Block], controller: Box<dyn Sampled>) -> Self {
        let count = |at: usize, wanted| outputs.get(at).filter(|(signal, _)| *signal == wanted).map_or(0, |(_, n)| *n);
        let (mut parts, mut first) = (Vec::new(), 0);
        let measured = controller.measures();
        let mut tip_velocity = 0..0;
        for &(signal, n) in outputs {
            if signal == Signal::TaskVelocity {
                tip_velocity = first..first + n;
            }
            if let Some(at) = measured.iter().position(|(wanted, _)| *wanted == signal) {
                parts.push([first, total(&measured[..at]), n]);
            }
            first += n;
        }
        let inputs = controller.inputs();
        let at = inputs.iter().position(|(signal, _)| *signal == Signal::Torque);
        let torque = total(&inputs[..at.unwrap_or(0)]);
        let message = || vec![0.0; controller.message_len()];
        Digital {
            agent,
            message: message(),
            degree: 0.0,
            sums: message(),
            sensor: Sensor::new(control.sensors, agent),
            torque_quantum: control.actuators.torque_quantum,
            axes: [count(0, Signal::Position), count(1, Signal::Velocity)],
            tip_velocity,
            parts,
            output: vec![0.0; first],
            measured: vec![0.0; total(measured)],
            torque: torque..torque + at.map_or(0, |at| inputs[at].1),
            commanded: vec![0.0; total(inputs)],
            held: vec![0.0; total(inputs)],
            safe: control.failures.safe_command.is_some(),
            failed: 0,
            samples: 0,
            controller,
        }
    }

    /// The controller.
    pub(crate) fn controller(&self) -> &dyn Sampled {
        &*self.controller
    }

    /// The last sample.
    pub(crate) fn taken(&self, sample: u64, now_s: f64) -> SampleTaken<'_> {
        SampleTaken {
            agent: self.agent,
            sample,
            now_s,
            measured: &self.measured,
            message: &self.message,
            inbox: self.inbox(),
            command: &self.commanded,
        }
    }

    /// What was heard at the last sample.
    pub(crate) fn inbox(&self) -> Inbox<'_> {
        Inbox { degree: self.degree, sums: &self.sums }
    }

    /// Whether the run goes on where a step fails, and how many have.
    pub(crate) fn failures(&self) -> (bool, u64) {
        (self.safe, self.failed)
    }

    /// Samples that were taken, and how many commands the limits changed.
    pub(crate) fn clipped(&self) -> (u64, Clipped) {
        (self.samples, self.controller.clipped())
    }

    /// The plant's output as the sensors saw it at the last sample; velocities of their own, where they are measured.
    pub(crate) fn output(&self) -> &[f64] {
        &self.output
    }

    /// What the actuators hold.
    pub(crate) fn held(&self) -> &[f64] {
        &self.held
    }

    /// Measures the plant's `output` and puts the message into `sent`.
    pub(crate) fn sense(&mut self, now_s: f64, output: &[f64], sent: &mut [f64]) {
        self.output.copy_from_slice(output);
        let [axes, velocities] = self.axes;
        let (q, rest) = self.output.split_at_mut(axes);
        self.sensor.measure(q, &mut rest[..velocities]);
        self.sensor.watch(&mut self.output[self.tip_velocity.clone()]);
        for &[first, from, n] in &self.parts {
            self.measured[from..from + n].copy_from_slice(&self.output[first..first + n]);
        }
        // Only numbers that are not finite cannot be sent; whoever hears this cannot step either.
        if self.controller.message(now_s, &self.measured, &mut self.message).is_err() {
            self.message.fill(f64::NAN);
        }
        sent.copy_from_slice(&self.message);
    }

    /// Steps the controller. Where that fails the safe command stands, if one is stated. Otherwise, where something is no longer
    /// finite, the command is not finite either: the run then breaks down there.
    pub(crate) fn command(&mut self, now_s: f64, degree: f64, sums: &[f64]) {
        self.degree = degree;
        self.samples += 1;
        let own = self.sums.len().min(sums.len());
        self.sums[..own].copy_from_slice(&sums[..own]);
        let inbox = Inbox { degree: self.degree, sums: &self.sums };
        match self.controller.step(now_s, &self.measured, inbox) {
            Ok(()) => self.commanded.copy_from_slice(self.controller.command()),
            Err(_) if self.safe => {
                self.failed += 1;
                self.commanded.copy_from_slice(self.controller.command());
            }
            // The run ends by what the law says of itself.
            Err(StepError::Singular { .. }) => {}
            Err(StepError::Length(_) | StepError::Time { .. } | StepError::NotFinite { .. }) => {
                self.commanded.fill(f64::NAN);
            }
        }
    }

    /// Makes the actuators hold `command` instead.
    pub(crate) fn hold(&mut self, command: &[f64]) {
        self.held.copy_from_slice(command);
    }

    /// Hands the command to the actuators.
    pub(crate) fn apply(&mut self) {
        self.held.copy_from_slice(&self.commanded);
        for torque in &mut self.held[self.torque.clone()] {
            *torque = quantise(*torque, self.torque_quantum);
        }
    }
}

/// The agents of a population. Columns are laid out as everywhere: `axis · n + member`.
pub(crate) struct Sampler {
    agents: Vec<Digital>,
    /// Asked for at the last sample.
    z: Vec<f64>,
    dz: Vec<f64>,
    /// Applied now.
    torque: Vec<f64>,
    /// One agent's q, q̇, and one agent's message or sums.
    output: Vec<f64>,
    message: Vec<f64>,
}

/// What one agent measures with.
struct Sensor {
    draw: ChaCha8Rng,
    kind: Sensors,
}

impl Sensor {
    /// The sensor of agent number `agent`; every agent has noise of its own.
    fn new(kind: Sensors, agent: usize) -> Self {
        let mut draw = ChaCha8Rng::seed_from_u64(kind.seed);
        draw.set_stream(agent as u64);
        Sensor { draw, kind }
    }

    /// Replaces the truth by what is measured; there may be no velocity.
    fn measure(&mut self, q: &mut [f64], dq: &mut [f64]) {
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
        dq.iter_mut().for_each(|dq| *dq = quantise(*dq, kind.velocity_quantum));
    }
}

impl Sensor {
    /// Adds the noise of the velocity of a tip, of which nothing is drawn where there is none.
    fn watch(&mut self, dx: &mut [f64]) {
        if self.kind.tip_velocity_noise > 0.0 {
            dx.iter_mut().for_each(|dx| *dx += self.kind.tip_velocity_noise * normal(&mut self.draw)[0]);
        }
    }
}

/// Two independent normal numbers with mean 0 and variance 1, after Box and Muller. Not from a crate: those take their
/// logarithms from the standard library, whose last bit depends on the processor.
fn normal(draw: &mut ChaCha8Rng) -> [f64; 2] {
    let radius = libm::sqrt(-2.0 * libm::log(1.0 - draw.random::<f64>()));
    let (sine, cosine) = sine_and_cosine(core::f64::consts::TAU * draw.random::<f64>());
    [radius * cosine, radius * sine]
}

/// The nearest multiple of `quantum`, if there is one.
fn quantise(value: f64, quantum: f64) -> f64 {
    if quantum > 0.0 { quantum * libm::rint(value / quantum) } else { value }
}

impl Sampler {
    /// `agents` in the order of the members, with `axes` axes each.
    pub(crate) fn new(agents: Vec<Digital>, axes: usize) -> Self {
        let block = || vec![0.0; axes * agents.len()];
        let message = agents.first().map_or(0, |agent| agent.controller.message_len());
        Sampler {
            z: block(),
            dz: block(),
            torque: block(),
            output: vec![0.0; 2 * axes],
            message: vec![0.0; message],
            agents,
        }
    }

    /// What moves the robots until the next event.
    pub(crate) fn drive<'a>(&'a self, external: Option<&'a [f64]>) -> Drive<'a> {
        Drive { z: &self.z, dz: &self.dz, held: Some(&self.torque), external }
    }

    /// Measures q and q̇, which stand in `motion`, and sends what the reference transmits.
    pub(crate) fn sense(&mut self, now_s: f64, motion: &[f64], sent: &mut [f64]) {
        let n = self.agents.len();
        for (i, agent) in self.agents.iter_mut().enumerate() {
            take(n, i, motion, &mut self.output);
            agent.sense(now_s, &self.output, &mut self.message);
            give(n, i, &self.message, sent);
        }
    }

    /// Steps every controller and writes what it carries on into `state`, the columns of references and estimates.
    pub(crate) fn command(&mut self, now_s: f64, inputs: Inputs<'_>, state: &mut [f64]) {
        let n = self.agents.len();
        for (i, agent) in self.agents.iter_mut().enumerate() {
            take(n, i, inputs.sums, &mut self.message);
            agent.command(now_s, inputs.degree[i], &self.message);
            let controller = agent.controller();
            give(n, i, controller.diagnostics(Signal::Reference(0)).unwrap_or_default(), &mut self.z);
            give(n, i, controller.diagnostics(Signal::Reference(1)).unwrap_or_default(), &mut self.dz);
            give(n, i, controller.state(), state);
        }
    }

    /// The agents with their last samples.
    pub(crate) fn agents(&self) -> &[Digital] {
        &self.agents
    }

    /// Makes the actuators hold these instead, agent by agent.
    pub(crate) fn hold(&mut self, commands: &[f64]) {
        let n = self.agents.len().max(1);
        for (i, (agent, command)) in
            self.agents.iter_mut().zip(commands.chunks_exact((commands.len() / n).max(1))).enumerate()
        {
            agent.hold(command);
            give(n, i, command, &mut self.torque);
        }
    }

    /// Hands the commands to the actuators.
    pub(crate) fn apply(&mut self) {
        let n = self.agents.len();
        for (i, agent) in self.agents.iter_mut().enumerate() {
            agent.apply();
            give(n, i, agent.held(), &mut self.torque);
        }
    }
}

/// Member `i` of `n` out of columns.
pub(super) fn take(n: usize, i: usize, columns: &[f64], out: &mut [f64]) {
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
        let mut sensors = [0, 1].map(|agent| Sensor::new(kind, agent));
        let mut rows: Vec<[f64; 4]> = Vec::new();
        for _ in 0..10_000 {
            let mut row = [0.0; 4];
            for (sensor, pair) in sensors.iter_mut().zip(row.chunks_exact_mut(2)) {
                let (q, dq) = pair.split_at_mut(1);
                sensor.measure(q, dq);
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
            Sensor::new(kind, 0).measure(&mut q, &mut dq);
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
