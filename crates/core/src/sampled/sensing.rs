//! From what is measured to what a law reads.
//!
//! A law reads a part of its plant's output. That part is measured, but for velocities where there are encoders only: those
//! are differenced and filtered here. What no law reads stays zero.

use alloc::vec;
use alloc::vec::Vec;

use super::recipe::{EncoderFilter, RecipeError};
use crate::LengthError;
use crate::agent::{StepError, VelocityFilter, finite, later};
use crate::plant::total;
use crate::signal::{Block, Signal};

/// What is measured, and the output of the plant as far as it is known from that.
#[derive(Clone, Debug)]
pub(super) struct Sensing {
    measures: Vec<Block>,
    /// Where each block goes: first entry in the output, first entry of what is measured, and how many.
    parts: Vec<[usize; 3]>,
    measured: usize,
    differenced: Option<Differenced>,
    output: Vec<f64>,
}

/// A velocity from positions.
#[derive(Clone, Debug)]
struct Differenced {
    filter: VelocityFilter,
    /// Its first entry in the output.
    first: usize,
    period_s: Option<f64>,
    last_s: Option<f64>,
}

impl Differenced {
    /// The time since the last sample; a whole number of periods where a period is stated. The first sample has none.
    fn passed_s(&self, now_s: f64) -> f64 {
        let passed_s = self.last_s.map_or(0.0, |last_s| now_s - last_s);
        match self.period_s {
            Some(period_s) if passed_s > 0.0 => period_s * libm::rint(passed_s / period_s).max(1.0),
            _ => passed_s,
        }
    }
}

impl Sensing {
    /// For a plant with these `outputs`, position first, of which `reads` says what the law reads, and of which the first
    /// `transmitted` numbers are sent.
    pub(super) fn new(
        outputs: &[Block],
        transmitted: usize,
        reads: impl Fn(Signal) -> bool,
        filter: Option<&EncoderFilter>,
    ) -> Result<Self, RecipeError> {
        let axes = outputs.first().map_or(0, |(_, count)| *count);
        let mut sensing = Sensing {
            measures: Vec::new(),
            parts: Vec::new(),
            measured: 0,
            differenced: None,
            output: vec![0.0; total(outputs)],
        };
        let mut first = 0;
        for &(signal, count) in outputs {
            let needed = reads(signal) || first < transmitted;
            match filter {
                Some(filter) if needed && (signal, count) == (Signal::Velocity, axes) => {
                    sensing.differenced = Some(Differenced {
                        filter: VelocityFilter::new(filter.cut_off_rad_s, axes)?,
                        first,
                        period_s: filter.period_s,
                        last_s: None,
                    });
                }
                _ if needed => {
                    sensing.measures.push((signal, count));
                    sensing.parts.push([first, sensing.measured, count]);
                    sensing.measured += count;
                }
                _ => {}
            }
            first += count;
        }
        Ok(sensing)
    }

    /// What is measured.
    pub(super) fn measures(&self) -> &[Block] {
        &self.measures
    }

    /// The output of the last sample.
    pub(super) fn output(&self) -> &[f64] {
        &self.output
    }

    /// A signal of the last sample that was measured, or a velocity made of what was.
    pub(super) fn known(&self, signal: Signal) -> Option<&[f64]> {
        if let (Some(Differenced { filter, first, .. }), Signal::Velocity) = (&self.differenced, signal) {
            return self.output.get(*first..*first + filter.axes());
        }
        let at = self.measures.iter().position(|(measured, _)| *measured == signal)?;
        let [first, _, count] = self.parts[at];
        self.output.get(first..first + count)
    }

    /// The first numbers of the output, as many as there is room for.
    pub(super) fn head(&self, now_s: f64, measured: &[f64], out: &mut [f64]) -> Result<(), StepError> {
        LengthError::check("what is measured", self.measured, measured.len())?;
        finite("time", &[now_s])?;
        finite("what is measured", measured)?;
        for &[first, from, count] in &self.parts {
            let end = (first + count).min(out.len());
            if first < end {
                out[first..end].copy_from_slice(&measured[from..from + end - first]);
            }
        }
        if let Some(differenced) = &self.differenced
            && let axes = differenced.filter.axes()
            && let Some(velocity) = out.get_mut(differenced.first..differenced.first + axes)
        {
            // Positions come first.
            differenced.filter.peek(differenced.passed_s(now_s), &measured[..axes], velocity)?;
        }
        Ok(())
    }

    /// The whole output, for [`Sensing::output`]; nothing else changes.
    pub(super) fn look(&mut self, now_s: f64, measured: &[f64]) -> Result<(), StepError> {
        let mut output = core::mem::take(&mut self.output);
        let looked = self.head(now_s, measured, &mut output);
        self.output = output;
        looked
    }

    /// The sample that was looked at has been used.
    pub(super) fn accept(&mut self, now_s: f64) -> Result<(), StepError> {
        if let Some(differenced) = &mut self.differenced {
            let passed_s = differenced.passed_s(now_s);
            differenced.filter.feed(passed_s, &self.output[..differenced.filter.axes()])?;
            differenced.last_s = later(differenced.last_s, now_s);
        }
        Ok(())
    }
}
