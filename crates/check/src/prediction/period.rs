//! The rate of agreement over a network that repeats itself: how much is left of a disagreement after one period.
//!
//! Over one common period of switching and delays the reference dynamics with s ≡ 0 are one linear operator on the cascaded
//! variables and the messages on their way. Applied again and again to a start that looks arbitrary it leaves what its largest
//! eigenvalue beside one leaves. The operator is the shipped engine, run over many periods on one axis; the size is the width of the interval of
//! all cascaded variables (`cascade`), which is a norm of what is not yet agreed upon.
//!
//! The mean of the factors of single periods is that eigenvalue where it is real and the others have died out. Few periods may be seen before
//! nothing is left, and a pair of complex eigenvalues makes the factors waver; so that what all positions do is fitted by a few eigenvalues
//! (Prony's method): with x_k the positions against the first over the k-th period, divided by the mean factor to the power of k, the smallest c
//! with x_(k+p) + Σ_j c_j x_(k+j) ≈ 0 makes a polynomial z^p + Σ_j c_j z^j whose largest root is the eigenvalue in units of the mean factor, and
//! whose other roots keep within the unit circle. How far single factors are from it is reported.

use std::ops::ControlFlow;

use forwardstep_sim::{AgentSetup, Axis, Method, Progress, Recording, Setup, Solver, Start, TimeSpan};
use nalgebra::{DMatrix, DVector};
use thiserror::Error;

use super::cascade::{CascadeSpread, NoCascade};
use super::course::positions;
use super::ideal::{NoIdeal, ideal};
use super::repeats::{NoRepeat, Repeats};
use super::roots::eigenvalues::eigenvalues;
use super::unfinished::{Unfinished, completed};
use crate::hypothesis::numbers::rounded;

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
    /// Nothing repeats itself that is known to.
    #[error(transparent)]
    NoPeriod(#[from] NoRepeat),
    /// Every period leaves less than the one before, as where several eigenvalues are about as large: the largest was not seen yet.
    #[error(
        "what a period leaves still falls, from {:.1} % to {:.1} % over those that were seen, as it does where several modes are about as slow", 100.0 * seen[0], 100.0 * seen[1]
    )]
    StillFalls {
        /// What a period leaves at the beginning and at the end, as a factor.
        seen: [f64; 2],
    },
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
    /// What falls first may still have been falling, or what turns slowly not have turned.
    #[error(
        "{periods} periods are too few to see what falls most slowly; a longer `time.end_s` lets more be looked at"
    )]
    Unsettled {
        /// How many.
        periods: usize,
    },
    /// The disagreement vanished within few periods.
    #[error("after {periods} common {} of {} s too little of the disagreement is left to see a factor", if *periods == 1 { "period" } else { "periods" }, rounded(*period_s))]
    Vanishes {
        /// How many.
        periods: usize,
        /// How long one is, s.
        period_s: f64,
    },
    /// The reference dynamics alone were not simulated to the end.
    #[error(transparent)]
    Unfinished(#[from] Unfinished),
}

/// Rows of a period.
const ROWS: usize = 32;
/// Periods of the first and of the longest attempt.
const PERIODS: [usize; 2] = [16, 512];
/// Times the horizon of the run that the longest attempt may cover, unless the first one does more.
const HORIZONS: f64 = 10.0;
/// Periods of any attempt.
const MOST_PERIODS: usize = 1 << 16;
/// A rate that was seen before the work ran out is taken where single blocks of periods are no farther from it.
const SURE: f64 = 0.02;
/// A rate that is seen before nearly all has fallen is one where only this share of the start is left: what falls slowly has fallen as well by then. A
/// slow pair of roots that has not yet turned once looks like a fast one, and has left more.
const LEFT: f64 = 1e-2;
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
    let period_s = match Repeats::of(setup)? {
        Repeats::Every(period_s) => period_s,
        Repeats::Always => return Err(NoRepeat::NothingChanges.into()),
    };
    let [mut periods, most] = PERIODS;
    let agents = alone.agents.len();
    let recorded = MOST_NUMBERS / (ROWS * COLUMNS * agents.max(1));
    if recorded < periods {
        return Err(NoPeriodRate::TooLarge { agents });
    }
    let (least, most) = (periods, most.min(recorded));
    // Where that is not enough, so many periods are taken for one: their operator has the power of its eigenvalues.
    let mut together = 1;
    let mut seen_before = None;
    loop {
        let block_s = period_s * together as f64;
        alone.time = TimeSpan {
            end_s: block_s * periods as f64,
            record_every_s: block_s / ROWS as f64,
            record_at: forwardstep_sim::RecordAt::Intervals,
        };
        let recording = match completed(&alone, None, &mut work, observer) {
            Ok(recording) => recording,
            // What was seen in less time is better than nothing, where much of it had fallen.
            Err(Unfinished::TooMuchWork { .. }) if let Some(found) = seen_before.take() => return Ok(found),
            Err(unfinished) => return Err(unfinished.into()),
        };
        let widths = CascadeSpread::of(&alone, &recording)?.widths();
        let each: Vec<f64> = (0..=periods).filter_map(|k| widths.get(k * ROWS)).copied().collect();
        let start = each.first().copied().unwrap_or(0.0);
        // The first is the start.
        let seen = each.iter().skip(1).take_while(|width| **width > FLOOR * start).count();
        let ends = 2.0 * alone.time.end_s > HORIZONS * setup.time.end_s || 2 * together * periods > MOST_PERIODS;
        let found = factor(&each[..=seen], &apart(&recording), period_s, together);
        if seen < periods || each[periods] < FALLEN * start {
            return found;
        }
        let is_clear = each[seen] < LEFT * start;
        if ends {
            return match found {
                Ok(_) if !is_clear => Err(NoPeriodRate::Unsettled { periods: together * seen }),
                found => found,
            };
        }
        seen_before =
            found.ok().filter(|found| libm::pow(1.0 + found.wavers, together as f64) - 1.0 < SURE && is_clear);
        if 2 * periods <= most {
            periods *= 2;
        } else {
            together *= 2 * periods / least;
            periods = least;
        }
    }
}

/// The positions of all agents against that of the first, period by period.
fn apart(recording: &Recording) -> Vec<DVector<f64>> {
    let columns: Vec<&[f64]> = positions(recording, 0).collect();
    let Some((first, others)) = columns.split_first() else { return Vec::new() };
    let of_period = |from: usize| {
        let rows = from..from + ROWS;
        let each = others.iter().flat_map(|other| rows.clone().map(|row| other[row] - first[row]));
        DVector::from_iterator(ROWS * others.len(), each)
    };
    (0..(recording.t_s.len() - 1) / ROWS).map(|k| of_period(k * ROWS)).collect()
}

/// By the mean over the second half of what was seen, and by the largest eigenvalue that fits all periods, so many of which are taken `together`.
fn factor(widths: &[f64], apart: &[DVector<f64>], period_s: f64, together: usize) -> Result<PeriodRate, NoPeriodRate> {
    let seen = widths.len() - 1;
    let first = seen / 2;
    let periods = seen - first;
    if periods < 3 {
        return Err(NoPeriodRate::Vanishes { periods: together * (seen + 1), period_s });
    }
    let total = libm::log(widths[seen] / widths[first]);
    // A fall within rounding is none.
    if total > -1e-6 {
        return Err(NoPeriodRate::Stays { periods: together * seen });
    }
    let mean = libm::exp(total / periods as f64);
    let clear = widths.iter().take_while(|width| **width > FALLEN * widths[0]).count().min(apart.len());
    let factor = fitted(&apart[clear.saturating_sub(FITTED).max(1).min(clear)..clear], mean).unwrap_or(mean);
    let off = |pair: &[f64]| (pair[1] / pair[0] / factor - 1.0).abs();
    let wavers = widths[first..].windows(2).map(off).fold(0.0, f64::max);
    let wavers = match drift(widths) {
        Some(Drift { seen, comes_to }) => {
            let still = FARTHER * (factor / comes_to - 1.0).abs();
            if still > MOST_DRIFT {
                return Err(NoPeriodRate::StillFalls { seen });
            }
            wavers.max(still)
        }
        None => wavers,
    };
    let rate_per_s = libm::log(factor) / (period_s * together as f64);
    let factor = libm::pow(factor, 1.0 / together as f64);
    // So far are the factors of single periods from it where those of so many together are.
    let wavers = libm::pow(1.0 + wavers, 1.0 / together as f64) - 1.0;
    Ok(PeriodRate { period_s, factor, rate_per_s, wavers, periods: together * periods })
}

/// How the factors of single periods still fall.
struct Drift {
    /// From what to what.
    seen: [f64; 2],
    /// What they come to if they go on so.
    comes_to: f64,
}

/// Stretches of what was seen that are compared, and how many of them are behind the beginning.
const STRETCHES: usize = 6;
const BEHIND: usize = 4;
/// Periods of a stretch at least: factors of single ones waver.
const PERIODS_OF_A_STRETCH: usize = 2;
/// A fall of ln factor from one stretch to the next that is rounding.
const STEADY: f64 = 1e-4;
/// What factors come to is known no better than this many times the way there, and no rate is given where that is more than this part of it.
const FARTHER: f64 = 1.5;
const MOST_DRIFT: f64 = 0.1;

/// Of m equal eigenvalues ρ, or of some that are close, a disagreement falls like k^(m−1) ρ^k: the factor of the k-th period is about
/// ρ (1 + (m − 1)/k) and falls from period to period, ever more slowly, and no mean of it is ρ. It goes to where ln factor, as a line over 1/k, meets
/// 1/k = 0. `None` where the means of stretches do not fall one after the other.
fn drift(widths: &[f64]) -> Option<Drift> {
    let each = (widths.len() - 1) / STRETCHES;
    if each < PERIODS_OF_A_STRETCH {
        return None;
    }
    let from = widths.len() - 1 - BEHIND * each;
    let ends: Vec<usize> = (0..=BEHIND).map(|stretch| from + stretch * each).collect();
    let mean = |pair: &[usize]| libm::log(widths[pair[1]] / widths[pair[0]]) / each as f64;
    let means: Vec<f64> = ends.windows(2).map(mean).collect();
    let middle = |pair: &[usize]| 2.0 / (pair[0] + pair[1]) as f64;
    let over: Vec<f64> = ends.windows(2).map(middle).collect();
    let falls = means.windows(2).all(|pair| pair[0] - pair[1] > STEADY);
    let [first, .., before, last] = means[..] else { return None };
    let [.., wide, narrow] = over[..] else { return None };
    let comes_to = last - (before - last) / (wide - narrow) * narrow;
    falls.then(|| Drift { seen: [libm::exp(first), libm::exp(last)], comes_to: libm::exp(comes_to) })
}

/// Periods that are fitted at most, the last ones, and by how many eigenvalues.
const FITTED: usize = 24;
const EIGENVALUES: usize = 4;
/// What is smaller than the largest by this is noise.
const NOISE: f64 = 1e-5;

/// The largest eigenvalue in size; `None` where none fits that is below one.
fn fitted(apart: &[DVector<f64>], mean: f64) -> Option<f64> {
    let order = EIGENVALUES.min(apart.len() / 2);
    if order == 0 {
        return None;
    }
    let scaled: Vec<DVector<f64>> = apart.iter().enumerate().map(|(k, x)| x / libm::pow(mean, k as f64)).collect();
    let (size, equations) = (scaled[0].len(), scaled.len() - order);
    let mut system = DMatrix::zeros(size * equations, order);
    let mut right = DVector::zeros(size * equations);
    for k in 0..equations {
        for j in 0..order {
            system.view_mut((size * k, j), (size, 1)).copy_from(&scaled[k + j]);
        }
        right.rows_mut(size * k, size).copy_from(&-&scaled[k + order]);
    }
    // By the normal equations, which are small and have the same digits on every platform, raised by what is noise.
    let normal = system.transpose() * &system;
    let noise = NOISE * NOISE * normal.diagonal().max();
    let raised = normal + DMatrix::identity(order, order) * noise;
    let c = raised.cholesky()?.solve(&(system.transpose() * right));
    let companion = DMatrix::from_fn(order, order, |row, column| match column + 1 == order {
        true => -c[row],
        false => f64::from(u8::from(row == column + 1)),
    });
    let largest = eigenvalues(&companion)?.into_iter().map(|root| libm::hypot(root.re, root.im)).fold(0.0, f64::max);
    Some(mean * largest).filter(|factor| *factor > 0.0 && *factor < 1.0)
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
