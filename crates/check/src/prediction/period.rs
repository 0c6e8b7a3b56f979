//! The rate of agreement over a network that repeats itself: how much is left of a disagreement after one period.
//!
//! Over one common period of switching and delays the reference dynamics with s ≡ 0 are one linear operator on the cascaded
//! variables and the messages on their way. Applied again and again to a start that looks arbitrary it leaves what its largest
//! eigenvalue beside one leaves. The operator is the shipped engine, run over many periods on one axis; the size is the width of the interval of
//! all cascaded variables (`cascade`), which is a norm of what is not yet agreed upon. So a repeated or complex eigenvalue shows as a
//! factor that wavers from period to period, which is reported.

use std::ops::ControlFlow;

use forwardstep_sim::{AgentSetup, Axis, Method, Progress, Setup, Solver, Start, TimeSpan};
use thiserror::Error;

use super::cascade::{CascadeSpread, NoCascade};
use super::ideal::{NoIdeal, ideal};
use super::repeats::{MOST_ROUNDS, Repeats};
use super::unfinished::{Unfinished, completed};

/// What a period leaves of a disagreement, for s ≡ 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeriodRate {
    /// The common period of switching and delays, s.
    pub period_s: f64,
    /// What one period leaves, as a factor: the spectral radius of the operator beside agreement.
    pub factor: f64,
    /// ln(factor) over the period, 1/s: the disagreement falls like e^(rate t) in the long run.
    pub rate_per_s: f64,
    /// How far the factors of single periods are from it at most, relative, over those that it is the mean of.
    pub wavers: f64,
    /// How many periods it is the mean of.
    pub periods: usize,
}

/// Why no rate per period is predicted.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoPeriodRate {
    /// The references depend on more than the network.
    #[error(transparent)]
    Ideal(#[from] NoIdeal),
    /// The cascaded variables bound nothing.
    #[error(transparent)]
    Cascade(#[from] NoCascade),
    /// Something is drawn, logged, or switches once, or periods have no common multiple that is short enough.
    #[error("switching and delays have no common period of at most {MOST_ROUNDS} rounds")]
    NoPeriod,
    /// The recording of a few periods would be too large.
    #[error("there are {agents} agents, too many to record {least} periods of them", least = PERIODS[0])]
    TooLarge {
        /// How many.
        agents: usize,
    },
    /// What was left after many periods is what there was.
    #[error("{periods} periods leave all of the disagreement")]
    Stays {
        /// How many.
        periods: usize,
    },
    /// The disagreement vanished within few periods.
    #[error("the disagreement vanishes within {periods} periods, too few to see a factor")]
    Vanishes {
        /// How many.
        periods: usize,
    },
    /// The reference dynamics alone were not simulated to the end.
    #[error(transparent)]
    Unfinished(#[from] Unfinished),
}

/// Rows of a period.
const ROWS: usize = 32;
/// Periods of the first and of the longest attempt.
const PERIODS: [usize; 2] = [16, 512];
/// Times the horizon of the run that the longest attempt may cover, unless the first one does.
const HORIZONS: f64 = 10.0;
/// Columns of an agent on one axis, roughly, and how many numbers may be recorded.
const COLUMNS: usize = 8;
const MOST_NUMBERS: usize = 20_000_000;
/// Below this share of the start, rounding and the tolerance of the solver are seen.
const FLOOR: f64 = 1e-8;
/// Enough has fallen to see a factor.
const FALLEN: f64 = 1e-6;

/// Predicts what one period of a network that repeats itself leaves of a disagreement; `observer` as that of [`simulate`](forwardstep_sim::simulate),
/// for every attempt anew.
///
/// # Errors
/// [`NoPeriodRate`] when there is none.
pub fn period_rate(
    setup: &Setup,
    observer: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<PeriodRate, NoPeriodRate> {
    period_rate_within(setup, f64::INFINITY, observer)
}

/// The same with so much `work` for all attempts together, such as [`COURSE_WORK`](super::COURSE_WORK).
///
/// # Errors
/// [`NoPeriodRate`] when there is none, or it is more work.
pub fn period_rate_within(
    setup: &Setup,
    mut work: f64,
    observer: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<PeriodRate, NoPeriodRate> {
    let mut alone = on_one_axis(ideal(setup)?);
    let Some(Repeats::Every(period_s)) = Repeats::of(setup) else { return Err(NoPeriodRate::NoPeriod) };
    let [mut periods, most] = PERIODS;
    let agents = alone.agents.len();
    let recorded = MOST_NUMBERS / (ROWS * COLUMNS * agents.max(1));
    if recorded < periods {
        return Err(NoPeriodRate::TooLarge { agents });
    }
    let most = most.min(recorded).min((HORIZONS * setup.time.end_s / period_s) as usize);
    loop {
        alone.time = TimeSpan {
            end_s: period_s * periods as f64,
            record_every_s: period_s / ROWS as f64,
            record_at: forwardstep_sim::RecordAt::Intervals,
        };
        let widths = CascadeSpread::of(&alone, &completed(&alone, None, &mut work, observer)?)?.widths();
        let each: Vec<f64> = (0..=periods).filter_map(|k| widths.get(k * ROWS)).copied().collect();
        let start = each.first().copied().unwrap_or(0.0);
        // The first is the start.
        let seen = each.iter().skip(1).take_while(|width| **width > FLOOR * start).count();
        if seen < periods || each[periods] < FALLEN * start || 2 * periods > most {
            return factor(&each[..=seen], period_s);
        }
        periods *= 2;
    }
}

/// The mean factor over the second half of what was seen.
fn factor(widths: &[f64], period_s: f64) -> Result<PeriodRate, NoPeriodRate> {
    let seen = widths.len() - 1;
    let first = seen / 2;
    let periods = seen - first;
    if periods < 3 {
        return Err(NoPeriodRate::Vanishes { periods: seen });
    }
    let total = libm::log(widths[seen] / widths[first]);
    // A fall within rounding is none.
    if total > -1e-6 {
        return Err(NoPeriodRate::Stays { periods: seen });
    }
    let factor = libm::exp(total / periods as f64);
    let off = |pair: &[f64]| (pair[1] / pair[0] / factor - 1.0).abs();
    let wavers = widths[first..].windows(2).map(off).fold(0.0, f64::max);
    Ok(PeriodRate { period_s, factor, rate_per_s: total / periods as f64 / period_s, wavers, periods })
}

/// The same agents on one axis, with starts that look arbitrary, and a solver that sees small differences.
fn on_one_axis(setup: Setup) -> Setup {
    let noise = |k: usize| libm::sin(12.9898 * k as f64 + 0.7);
    let agent = |(i, agent): (usize, AgentSetup)| {
        let mut robot = agent.robot;
        robot.kind = std::sync::Arc::new(forwardstep_core::robot::PointMass { dimension: 1 });
        robot.axes.truncate(1);
        robot.axes.iter_mut().for_each(|axis: &mut Axis| axis.name = "x".into());
        let start = Start { q: vec![noise(i)], dq: vec![0.0], rest: Vec::new(), reference: Vec::new() };
        AgentSetup { robot, start, ..agent }
    };
    Setup {
        agents: setup.agents.into_iter().enumerate().map(agent).collect(),
        solver: Solver { method: Method::Adaptive { rtol: 1e-9, atol: 1e-12 }, ..setup.solver },
        ..setup
    }
}
