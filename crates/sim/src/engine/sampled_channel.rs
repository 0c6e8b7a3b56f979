//! What sampled controllers tell each other: sent at samples, heard at samples.
//!
//! At a sample everybody measures and sends before anybody hears. What is heard through a delay is the newest message that
//! was sent by then; before the first one everybody is taken to have sent it.

use super::delayed_inputs::{DelayedInputs, Heard, Port, Refuted};
use super::timeline::{Timeline, merge_until};
use crate::network::Network;

/// A delay that is a whole number of periods, give or take rounding, is that number.
const SLACK_PERIODS: f64 = 1e-6;

/// The messages of the last samples, as long as any delay.
#[derive(Debug)]
pub(crate) struct SampledChannel<'a> {
    network: &'a Network,
    timeline: Timeline<'a>,
    hearing: DelayedInputs,
    /// The graph has to be taken anew.
    rewire: bool,
    sample_hz: f64,
    /// A message that is older does not count, s; infinite for any age.
    timeout_s: f64,
    /// Something was too old at the last sample.
    silent: bool,
    /// Numbers that are sent at one sample.
    width: usize,
    /// The first sample, then a ring of the last ones.
    sent: Vec<f64>,
    ring: u64,
}

impl<'a> SampledChannel<'a> {
    /// For a run over [0, `end_s`] with samples at k / `sample_hz`, of which a message may be `timeout_s` old; `x` is the state at
    /// t = 0.
    pub(crate) fn new(
        network: &'a Network,
        end_s: f64,
        [sample_hz, timeout_s]: [f64; 2],
        ports: Vec<Port>,
        entries: usize,
        x: &[f64],
    ) -> Self {
        let timeline = Timeline::new(network, end_s, 0);
        let hearing = DelayedInputs::new(ports, entries, x, network.coupling);
        let width = hearing.width();
        let ring = ring(network, end_s, sample_hz);
        SampledChannel {
            network,
            timeline,
            hearing,
            rewire: true,
            sample_hz,
            timeout_s,
            silent: false,
            width,
            sent: vec![0.0; width * (ring as usize + 1)],
            ring,
        }
    }

    /// What the messages of all samples that may be heard take, `numbers` at each sample.
    pub(crate) fn bytes(network: &Network, end_s: f64, sample_hz: f64, numbers: usize) -> u64 {
        const NUMBER: u64 = size_of::<f64>() as u64;
        (numbers as u64).saturating_mul(NUMBER).saturating_mul(ring(network, end_s, sample_hz).saturating_add(1))
    }

    /// Room for what everybody sends at sample `k`, in the order of [`Port::entry`].
    pub(crate) fn sending(&mut self, k: u64) -> &mut [f64] {
        let offset = self.offset(k);
        &mut self.sent[offset..offset + self.width]
    }

    /// What everybody hears at sample `k`, once everybody has sent.
    pub(crate) fn hear(&mut self, k: u64, heard: &mut Heard) {
        let t_s = k as f64 / self.sample_hz;
        // What arrives a rounding later arrives now.
        if self.timeline.next_s() <= merge_until(t_s) {
            self.rewire |= self.timeline.pass(t_s).switched;
        }
        if self.rewire {
            let edges = self.network.schedule.graph(self.timeline.graph());
            self.hearing.rewire(&self.timeline, edges, heard);
            self.rewire = false;
        }
        let (rate, width, ring) = (self.sample_hz, self.width, self.ring);
        // Whole periods of age, give or take rounding.
        let oldest = self.timeout_s * rate + SLACK_PERIODS;
        let silent = self.hearing.look_at_samples(&self.timeline, t_s, |sent_s| {
            let sample = ((sent_s * rate + SLACK_PERIODS).floor().max(0.0) as u64).min(k);
            ((k - sample) as f64 <= oldest).then(|| offset_of(sample, ring, width))
        });
        self.hearing.gather_from(&self.sent, &[], Some(self.offset(k)), heard);
        if silent || self.silent {
            self.hearing.count(heard);
        }
        self.silent = silent;
    }

    /// The last delay that was found not to be what its author says.
    pub(crate) fn refuted(&self) -> Option<Refuted> {
        self.hearing.refuted()
    }

    fn offset(&self, k: u64) -> usize {
        offset_of(k, self.ring, self.width)
    }
}

/// How many samples may be heard. No message is older than the longest delay, nor than the run.
fn ring(network: &Network, end_s: f64, sample_hz: f64) -> u64 {
    ((network.max_delay_s().min(end_s) * sample_hz).ceil() as u64).saturating_add(2)
}

/// Where sample `k` stands: the first one apart, since it is heard until something newer arrives.
fn offset_of(k: u64, ring: u64, width: usize) -> usize {
    if k == 0 { 0 } else { (1 + k % ring) as usize * width }
}
