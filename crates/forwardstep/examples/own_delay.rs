//! A program of your own: `forwardstep` with a delay and a kind of switching that it does not have. Scenario files name them as
//! they name the shipped kinds:
//!
//! ```toml
//! [network]
//! delay.collatz = { step_s = 0.1, hold_s = 0.35 }
//! switching.thue_morse = { dwell_s = 0.5 }
//! ```

use std::process::ExitCode;

use forwardstep::io::scenario::kinds::{
    DelayKind, DelayPlan, Fault, KindError, KindTable, Kinds, NetworkReader, PhaseReader, ScheduleKind,
};
use forwardstep::sim::delay::{Arrivals, Delay, DelayFunction, DelayPiece, Known};
use forwardstep::sim::graph::Edge;
use forwardstep::sim::quantity::{MOST_EVENTS, QuantityError, few, positive, such};
use forwardstep::sim::schedule::{KnownSwitching, Schedule, Segment, Segments, SwitchingSignal};
use schemars::JsonSchema;
use serde::Deserialize;

fn main() -> Result<ExitCode, KindError> {
    Ok(forwardstep::program(&kinds()?))
}

/// The shipped kinds and these two.
///
/// # Errors
/// [`KindError`] when a key is taken.
pub fn kinds() -> Result<Kinds, KindError> {
    let mut kinds = Kinds::shipped();
    kinds.add_delay::<CollatzFile>()?;
    kinds.add_schedule::<ThueMorseFile>()?;
    Ok(kinds)
}

/// A staircase: on its k-th piece the delay is as many steps as the Collatz sequence of k takes to reach one, modulo four.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collatz {
    step_s: f64,
    hold_s: f64,
}

impl DelayFunction for Collatz {
    fn words(&self) -> &'static str {
        "a Collatz staircase"
    }

    fn validate(&self, end_s: f64) -> Result<(), QuantityError> {
        positive("", "step_s", self.step_s)?;
        positive("", "hold_s", self.hold_s)?;
        few("", "hold_s", self.hold_s, ("jumps of the delay", end_s / self.hold_s, MOST_EVENTS))
    }

    fn piece(&self, index: u64) -> DelayPiece {
        DelayPiece::new(index, index as f64 * self.hold_s, (index + 1) as f64 * self.hold_s)
    }

    fn value(&self, piece: &DelayPiece, _: f64) -> f64 {
        let next = |k: &u64| (*k > 1).then(|| if k.is_multiple_of(2) { k / 2 } else { 3 * k + 1 });
        let steps = std::iter::successors(Some(piece.index + 1), next).count();
        self.step_s * (steps % 4) as f64
    }

    fn known(&self) -> Known {
        Known::declared([0.0, 3.0 * self.step_s])
    }

    fn arrivals(&self, search: &mut Arrivals<'_>) {
        search.monotone();
    }
}

/// A staircase after Collatz.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CollatzFile {
    /// The height of a step, in s.
    pub step_s: f64,
    /// From jump to jump, in s.
    pub hold_s: f64,
}

impl DelayKind for CollatzFile {
    fn table() -> KindTable {
        KindTable { key: "collatz", description: "Jumps as the Collatz sequence does." }
    }

    fn plan(&self, _: &mut NetworkReader<'_>) -> Result<DelayPlan, Fault> {
        Ok(DelayPlan::Shared(Delay::new(Collatz { step_s: self.step_s, hold_s: self.hold_s })))
    }
}

/// Takes graph 0 or 1 by the parity of the ones in the binary digits of k: it never repeats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThueMorse {
    dwell_s: f64,
}

impl SwitchingSignal for ThueMorse {
    fn words(&self) -> &'static str {
        "switching after Thue and Morse"
    }

    fn validate(&self, graphs: usize, end_s: f64) -> Result<(), QuantityError> {
        such(graphs == 2, "phases", "the number of graphs", graphs as f64, "must be two")?;
        positive("switching.thue_morse", "dwell_s", self.dwell_s)?;
        few("switching.thue_morse", "dwell_s", self.dwell_s, ("switches", end_s / self.dwell_s, MOST_EVENTS))
    }

    fn segments(&self, _: usize) -> Segments<'_> {
        let start_s = |k: u32| f64::from(k) * self.dwell_s;
        let graph = |k: u32| (k.count_ones() % 2) as usize;
        Segments::new((0..).map(move |k| Segment { start_s: start_s(k), end_s: start_s(k + 1), graph: graph(k) }))
    }

    fn known(&self) -> KnownSwitching {
        KnownSwitching::declared(self.dwell_s)
    }
}

/// Two phases that take turns after Thue and Morse.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ThueMorseFile {
    /// How long a phase lasts, in s.
    pub dwell_s: f64,
}

impl ScheduleKind for ThueMorseFile {
    fn table() -> KindTable {
        KindTable { key: "thue_morse", description: "Two phases in turn, without a period." }
    }

    fn schedule(&self, graphs: Vec<Vec<Edge>>, phases: &mut PhaseReader<'_, '_>) -> Result<Schedule, Fault> {
        (0..phases.count()).for_each(|phase| phases.unused_dwell(phase));
        Ok(Schedule::new(graphs, ThueMorse { dwell_s: self.dwell_s }))
    }
}
