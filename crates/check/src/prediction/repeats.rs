//! Whether a network repeats itself exactly, and after how long.

use forwardstep_core::expression::Number;
use forwardstep_sim::Setup;
use forwardstep_sim::delay::{Delay, PiecewiseConstant, SawTooth, Sinusoid};
use forwardstep_sim::schedule::{Extent, Periodic};
use num_rational::BigRational;
use num_traits::ToPrimitive;
use thiserror::Error;

/// The common period is no longer than this many times the longest one.
pub(super) const MOST_ROUNDS: u32 = 60;

/// After how long a network is what it was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Repeats {
    /// It never changes.
    Always,
    /// After so long, s.
    Every(f64),
}

/// Why a network is not known to repeat itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum NoRepeat {
    /// Graphs are drawn, come from a table or switch once.
    #[error("graphs do not come in turns that repeat themselves")]
    Graphs,
    /// A weight is a formula.
    #[error("a weight is a formula of the time, whose period is not looked for")]
    Weights,
    /// A delay of this kind, by its own words: no period of it is known.
    #[error("delays include {0}, of which no period is known")]
    Delays(&'static str),
    /// Periods have no common multiple that is short enough.
    #[error("switching and delays have no common period of at most {MOST_ROUNDS} rounds")]
    NoMultiple,
    /// There is nothing that repeats itself.
    #[error("nothing in the network changes")]
    NothingChanges,
}

impl Repeats {
    /// From the numbers as they are written.
    pub(crate) fn of(setup: &Setup) -> Result<Repeats, NoRepeat> {
        let network = &setup.network;
        // What an author says of a signal reaches as far as it was tried.
        if network.schedule.known().extent == Extent::Horizon {
            return Err(NoRepeat::Graphs);
        }
        if network.schedule.graphs.iter().flatten().any(|edge| edge.weight.constant().is_none()) {
            return Err(NoRepeat::Weights);
        }
        let mut periods: Vec<BigRational> = Vec::new();
        if network.schedule.constant_graph().is_none() {
            let periodic = network.schedule.downcast::<Periodic>().ok_or(NoRepeat::Graphs)?;
            periods.push(periodic.dwell_s.iter().copied().map(Number::written).sum());
        }
        for delay in network.used_delays().map(|index| &network.delays[index]) {
            if !delay.is_constant() {
                periods.push(Number::written(period_of(delay).ok_or(NoRepeat::Delays(delay.words()))?));
            }
        }
        let Some(longest) = periods.iter().max() else { return Ok(Repeats::Always) };
        let fits = |whole: &BigRational| periods.iter().all(|period| (whole / period).is_integer());
        let rounds = (1..=MOST_ROUNDS).map(|rounds| longest * BigRational::from_integer(rounds.into()));
        rounds.into_iter().find(fits).and_then(|whole| whole.to_f64()).map(Repeats::Every).ok_or(NoRepeat::NoMultiple)
    }
}

fn period_of(delay: &Delay) -> Option<f64> {
    if let Some(saw) = delay.downcast::<SawTooth>() {
        return Some(saw.period_s);
    }
    if let Some(wave) = delay.downcast::<Sinusoid>() {
        return Some(wave.period_s);
    }
    delay.downcast::<PiecewiseConstant>()?.period_s
}
