//! Whether a network repeats itself exactly, and after how long.

use forwardstep_core::expression::Number;
use forwardstep_sim::Setup;
use forwardstep_sim::delay::{Delay, PiecewiseConstant, SawTooth, Sinusoid};
use forwardstep_sim::schedule::{Extent, Periodic};
use num_rational::BigRational;
use num_traits::ToPrimitive;

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

impl Repeats {
    /// From the numbers as they are written; none where something is drawn, logged, a formula, or happens once, or periods have no
    /// common multiple that is short enough.
    pub(crate) fn of(setup: &Setup) -> Option<Repeats> {
        let network = &setup.network;
        // What an author says of a signal reaches as far as it was tried.
        let is_known = network.schedule.known().extent != Extent::Horizon;
        if !is_known || network.schedule.graphs.iter().flatten().any(|edge| edge.weight.constant().is_none()) {
            return None;
        }
        let mut periods: Vec<BigRational> = Vec::new();
        if network.schedule.constant_graph().is_none() {
            let periodic = network.schedule.downcast::<Periodic>()?;
            periods.push(periodic.dwell_s.iter().copied().map(Number::written).sum());
        }
        for delay in network.used_delays().map(|index| &network.delays[index]) {
            if !delay.is_constant() {
                periods.push(Number::written(period_of(delay)?));
            }
        }
        let Some(longest) = periods.iter().max() else { return Some(Repeats::Always) };
        let fits = |whole: &BigRational| periods.iter().all(|period| (whole / period).is_integer());
        let rounds = (1..=MOST_ROUNDS).map(|rounds| longest * BigRational::from_integer(rounds.into()));
        rounds.into_iter().find(fits)?.to_f64().map(Repeats::Every)
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
