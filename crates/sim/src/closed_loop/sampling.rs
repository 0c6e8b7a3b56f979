//! The instants at which digital controllers sample, and at which their torques change.

use super::assemble::Block;
use crate::engine::{EventOutcome, Heard, Port, Refuted, SampledChannel};
use crate::recording::SampleTaken;
use crate::setup::{Control, Setup};

/// The clock that all agents share: sample k is taken at k / `sample_hz`.
pub(crate) struct Sampling<'a> {
    sample_hz: f64,
    computation_delay_s: f64,
    radio: SampledChannel<'a>,
    heard: Heard,
    /// The sample to come.
    sample: u64,
    /// When the last commands reach the actuators, s; infinite when they have.
    apply_s: f64,
    /// Who wants to know what every sample held.
    watch: Option<&'a mut dyn FnMut(SampleTaken<'_>)>,
}

impl<'a> Sampling<'a> {
    /// `x` is the state at t = 0; the first sample is taken there.
    pub(super) fn new(setup: &'a Setup, control: &Control, ports: Vec<Port>, entries: usize, x: &[f64]) -> Self {
        Sampling {
            sample_hz: control.sample_hz,
            computation_delay_s: control.computation_delay_s,
            heard: Heard { degree: vec![0.0; ports.len()], sums: vec![0.0; ports.len() * entries] },
            radio: SampledChannel::new(
                &setup.network,
                setup.time.end_s,
                [control.sample_hz, control.failures.message_timeout_s.unwrap_or(f64::INFINITY)],
                ports,
                entries,
                x,
            ),
            sample: 0,
            apply_s: f64::INFINITY,
            watch: None,
        }
    }

    /// Hands every sample to `watch`.
    pub(super) fn watch(&mut self, watch: &'a mut dyn FnMut(SampleTaken<'_>)) {
        self.watch = Some(watch);
    }

    /// What was heard at the last sample.
    pub(super) fn heard(&self) -> &Heard {
        &self.heard
    }

    /// Samples taken so far.
    pub(super) fn taken(&self) -> u64 {
        self.sample
    }

    /// Number and time of the last sample, s.
    pub(super) fn last(&self) -> Option<(u64, f64)> {
        let sample = self.sample.checked_sub(1)?;
        Some((sample, sample as f64 / self.sample_hz))
    }

    fn sample_s(&self) -> f64 {
        self.sample as f64 / self.sample_hz
    }

    /// The next event, s.
    pub(super) fn next_s(&self) -> f64 {
        self.sample_s().min(self.apply_s)
    }

    /// Everything that is due until `until_s`: torques that were on their way first, then the sample.
    pub(super) fn happen(&mut self, until_s: f64, blocks: &mut [Block], x: &mut [f64]) -> EventOutcome {
        let mut happened = EventOutcome::Nothing;
        if self.apply_s <= until_s {
            self.apply_s = f64::INFINITY;
            blocks.iter_mut().for_each(|block| block.columns.apply());
            happened = EventOutcome::Sampled;
        }
        let now_s = self.sample_s();
        if now_s <= until_s {
            self.take_sample(now_s, blocks, x);
            self.sample += 1;
            self.apply_s = now_s + self.computation_delay_s;
            if self.apply_s <= until_s {
                self.apply_s = f64::INFINITY;
                blocks.iter_mut().for_each(|block| block.columns.apply());
            }
            happened = EventOutcome::Sampled;
        }
        happened
    }

    /// The last delay that was found not to be what its author says.
    pub(super) fn refuted(&self) -> Option<Refuted> {
        self.radio.refuted()
    }

    /// Everybody measures and sends, then hears and computes.
    fn take_sample(&mut self, now_s: f64, blocks: &mut [Block], x: &mut [f64]) {
        let sent = self.radio.sending(self.sample);
        for block in blocks.iter_mut() {
            block.columns.sense(now_s, &x[block.state.clone()], &mut sent[block.sums.clone()]);
        }
        self.radio.hear(self.sample, &mut self.heard);
        for block in blocks.iter_mut() {
            let inputs = block.inputs(&self.heard, None);
            block.columns.command(now_s, inputs, &mut x[block.state.clone()]);
        }
        if let Some(watch) = &mut self.watch {
            for block in blocks {
                block.columns.taken(&mut |digital| watch(digital.taken(self.sample, now_s)));
            }
        }
    }
}
