//! V of one agent under any controller that samples, and what changes it at an instant, cause by cause.
//!
//! Derived for this software. Between two samples the state c of the controller stands still and the plant moves by ẋ = f(x, u, w) under the command in
//! force, with w from outside. The proof has V(t, x, c) with V̇ = −D where ċ = F(t, x, c) and u = u_ideal, so that with ∂V·v for the derivative along v
//!
//! ```text
//! V̇ = −D                                                       dissipated
//!    + ∂_x V·(f(u_held) − f(u_ideal)) − ∂_c V·F                  held, with the jumps of V at samples
//!    + ∂_x V·(f(u_reconstructed) − f(u_held))                    reconstructed
//!    + ∂_x V·(f(u_computed) − f(u_reconstructed))                measured
//!    + ∂_x V·(f(u_applied) − f(u_computed))                      limited
//!    + ∂_x V·(f(u_applied, w) − f(u_applied, 0))                 pushed
//! ```
//!
//! u_ideal is the law at x and c of the instant, u_held the law at the x of the sample whose command is in force, u_reconstructed the same with velocities that
//! the filter makes of exact positions, u_computed with what was measured. D, F and u_ideal hear what was heard at the last sample, which drops out
//! of their sum. All is computed by the plant, the controller and its balance, as they run; derivatives along a direction are
//! central differences, extrapolated, which are exact where V is quadratic.

use forwardstep_core::LengthError;
use forwardstep_core::agent::VelocityFilter;
use forwardstep_core::controller::{Balance, ControllerOutput};

use super::pair::{Lengths, Outside, Pair};

/// V of an agent, and what changes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Energy {
    /// V by the proof, with the controller's state as it stands.
    pub value: f64,
    /// The parts of V̇.
    pub powers: Powers,
}

/// The parts of V̇ under digital control, in the order in which commands are traced from the ideal law to the plant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Powers {
    /// What the proof takes away, negative.
    pub dissipated: f64,
    /// The command and the controller's state stand still.
    pub held: f64,
    /// Velocities are filtered differences of positions.
    pub reconstructed: f64,
    /// Measurements have noise and are rounded.
    pub measured: f64,
    /// The command is limited and rounded.
    pub limited: f64,
    /// Something acts from outside.
    pub pushed: f64,
}

/// What commands of one agent came from.
pub(super) struct Tracing {
    lengths: Lengths,
    /// Velocities of exact positions, and of those that were measured.
    filters: Option<[VelocityFilter; 2]>,
    last_s: Option<f64>,
    /// The plant's output at the last sample.
    pub(super) exact: Vec<f64>,
    /// The law at the exact output, with the filter's velocity, and with what was measured: of the last sample, and of the command in force.
    coming: [Vec<f64>; 3],
    in_force: [Vec<f64>; 3],
}

/// A plant and its controller, as they are asked here.
struct Asking<'a> {
    pair: &'a mut dyn Pair,
    lengths: Lengths,
}

/// What a controller asks for, how its state moves, and what it shows.
struct Answer {
    input: Vec<f64>,
    d_state: Vec<f64>,
    shown: Vec<f64>,
}

/// Inputs are the same if they differ by less, relative to the largest.
const ROUNDING: f64 = 1e-12;

/// The input that is applied, with what differs from the computed one by rounding alone as it was computed.
fn as_computed(computed: &[f64], applied: &[f64]) -> Vec<f64> {
    let rounding = ROUNDING * computed.iter().fold(1.0, |size: f64, input| size.max(input.abs()));
    let same =
        |(computed, applied): (&f64, &f64)| if (applied - computed).abs() > rounding { *applied } else { *computed };
    computed.iter().zip(applied).map(same).collect()
}

/// How far an entry is moved to take a derivative, relative to 1 + |value|.
const STEP: f64 = 1.0 / 256.0;

impl Tracing {
    pub(super) fn new(filter: Option<VelocityFilter>, lengths: Lengths) -> Self {
        let none = || core::array::from_fn(|_| vec![0.0; lengths.input]);
        Tracing {
            lengths,
            filters: filter.map(|filter| [filter.clone(), filter]),
            last_s: None,
            exact: vec![0.0; lengths.output],
            coming: none(),
            in_force: none(),
        }
    }

    /// Traces the command of a sample, in the state `own` of its controller; `measured` is the output as the sensors saw it. It begins with
    /// positions, and as many velocities follow where there is a filter.
    pub(super) fn sampled(
        &mut self,
        pair: &mut dyn Pair,
        now_s: f64,
        own: &[f64],
        measured: &[f64],
        outside: Outside<'_>,
    ) -> Result<(), LengthError> {
        let axes = pair.axes();
        let mut asking = Asking { pair, lengths: self.lengths };
        let mut outputs = [self.exact.clone(), self.exact.clone(), measured.to_vec()];
        if let Some([exact, seen]) = &mut self.filters {
            let passed_s = self.last_s.map_or(0.0, |last_s| now_s - last_s);
            for (filter, output) in [exact, seen].into_iter().zip(&mut outputs[1..]) {
                let velocity = filter.feed(passed_s, &output[..axes])?.to_vec();
                output[axes..2 * axes].copy_from_slice(&velocity);
            }
        }
        self.last_s = Some(now_s);
        for (command, output) in self.coming.iter_mut().zip(&outputs) {
            *command = asking.asked(output, own, outside)?.input;
        }
        Ok(())
    }

    /// The command of the last sample is in force.
    pub(super) fn applied(&mut self) {
        self.in_force.clone_from(&self.coming);
    }

    /// V and V̇ in the state `x` of the plant and `own` of its controller, with the input that is `applied` and what acts from outside.
    pub(super) fn energy(
        &self,
        pair: &mut dyn Pair,
        [x, own]: [&[f64]; 2],
        outside: Outside<'_>,
        [applied, external]: [&[f64]; 2],
    ) -> Result<Energy, LengthError> {
        let mut asking = Asking { pair, lengths: self.lengths };
        let (ideal, d_own, Balance { value, dissipation }) = asking.balance(x, own, outside)?;
        let [held, reconstructed, computed] = &self.in_force;
        let applied = &as_computed(computed, applied);
        let rates: Vec<Vec<f64>> = [&ideal[..], held, reconstructed, computed, applied]
            .into_iter()
            .map(|input| asking.rate(x, input, &[]))
            .collect::<Result<_, _>>()?;
        let pushed = asking.rate(x, applied, external)?;
        let difference = |a: &[f64], b: &[f64]| b.iter().zip(a).map(|(b, a)| b - a).collect::<Vec<f64>>();
        let back: Vec<f64> = d_own.iter().map(|rate| -rate).collect();
        let still = vec![0.0; own.len()];
        let mut along = |from: &[f64], to: &[f64], own_rate: &[f64]| {
            asking.derivative([x, own], outside, [&difference(from, to), own_rate])
        };
        let powers = Powers {
            dissipated: -dissipation,
            held: along(&rates[0], &rates[1], &back)?,
            reconstructed: along(&rates[1], &rates[2], &still)?,
            measured: along(&rates[2], &rates[3], &still)?,
            limited: along(&rates[3], &rates[4], &still)?,
            pushed: along(&rates[4], &pushed, &still)?,
        };
        Ok(Energy { value, powers })
    }
}

impl Asking<'_> {
    /// What the controller says to an output of its plant.
    fn asked(&mut self, output: &[f64], own: &[f64], outside: Outside<'_>) -> Result<Answer, LengthError> {
        let Lengths { input, shown, controller, .. } = self.lengths;
        let [mut input, mut shown, mut d_state] = [input, shown, controller].map(|length| vec![0.0; length]);
        let asked = ControllerOutput { input: &mut input, d_state: &mut d_state, shown: &mut shown };
        self.pair.evaluate(output, outside, own, asked)?;
        Ok(Answer { input, d_state, shown })
    }

    /// The ideal input, the rate of the controller's state, V and what it loses.
    fn balance(
        &mut self,
        x: &[f64],
        own: &[f64],
        outside: Outside<'_>,
    ) -> Result<(Vec<f64>, Vec<f64>, Balance), LengthError> {
        let mut output = vec![0.0; self.lengths.output];
        self.pair.output(x, &mut output)?;
        let Answer { input, d_state, shown } = self.asked(&output, own, outside)?;
        let balance = self.pair.balance([x, &[]], &output, outside, own, &shown)?;
        Ok((input, d_state, balance))
    }

    fn rate(&mut self, x: &[f64], input: &[f64], external: &[f64]) -> Result<Vec<f64>, LengthError> {
        let mut rate = vec![0.0; x.len()];
        self.pair.rate(x, [input, external], &mut rate)?;
        Ok(rate)
    }

    /// The derivative of V along a direction of both states.
    fn derivative(&mut self, at: [&[f64]; 2], outside: Outside<'_>, along: [&[f64]; 2]) -> Result<f64, LengthError> {
        let entries = at.into_iter().flatten().zip(along.into_iter().flatten());
        let steps = entries.filter(|(_, rate)| **rate != 0.0).map(|(x, rate)| STEP * (1.0 + x.abs()) / rate.abs());
        let step = steps.fold(f64::INFINITY, f64::min);
        if !step.is_finite() {
            return Ok(0.0);
        }
        let mut value = |by: f64| {
            let moved =
                |part: usize| -> Vec<f64> { at[part].iter().zip(along[part]).map(|(x, rate)| x + by * rate).collect() };
            Ok(self.balance(&moved(0), &moved(1), outside)?.2.value)
        };
        let [wide, narrow] = [step, 0.5 * step].map(|by| Ok((value(by)? - value(-by)?) / (2.0 * by)));
        let (wide, narrow) = (wide?, narrow?);
        Ok(narrow + (narrow - wide) / 3.0)
    }
}
