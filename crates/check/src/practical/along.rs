//! What is watched along a run: the sampling margin and static torques at the postures that were reached, and how large s was.
//!
//! Not from the paper, derived for this software; the formulas are those of `margin`, `loads` and `power`, with M, Y and g at rows of the recording.

use std::collections::HashMap;

use forwardstep_core::robot::TwoVelocity;
use forwardstep_sim::recording::{Recording, Signal};
use forwardstep_sim::{Evaluator, Setup};
use nalgebra::{DMatrix, DVector};

use super::held::Hold;
use super::led::{Led, close_rows};
use super::loads::{StaticLoad, limits, load};
use super::margin::gains;
use super::power::{PowerBound, is_fed, pushed_w};
use super::rates::{Gains, Rates};
use super::resonance::Swing;
use crate::kinds::is_lagrangian;
use crate::surroundings::dry_loss_w;

/// States that are looked at in all, spread evenly over the rows, but two of every agent at least.
const MOST: usize = 20_000;
/// A time that is a whole number of periods, give or take rounding, is that number.
const SLACK_PERIODS: f64 = 1e-6;

/// What was found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Along {
    /// The largest σ, under digital control.
    pub margin: Option<MarginReached>,
    /// The static torque closest to its limit, where limits are known.
    pub load: Option<LoadReached>,
    /// The mean of Σ sᵀKs, where something feeds V for ever.
    pub power: Option<PowerReached>,
    /// States that were looked at for the first two.
    pub states: usize,
    /// Rows that these are of.
    pub rows: usize,
}

/// The mean of Σ sᵀKs over the rows of a run, and over the periods that they stand in, beside what it cannot exceed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerReached {
    /// The mean, W.
    pub mean_w: f64,
    /// The bound with the pushes, V and σ of the run itself; `None` where V was not recorded, and where a spring pulls a robot with dry
    /// friction: the recording has the sum of both.
    pub bound: Option<PowerBound>,
}

/// The largest σ that was reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarginReached {
    /// Index of the agent.
    pub agent: usize,
    /// When, s.
    pub t_s: f64,
    /// σ.
    pub sigma: f64,
    /// The fastest mode there, 1/s.
    pub fastest_per_s: f64,
}

/// The static torque that came closest to its limit.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadReached {
    /// When, s.
    pub t_s: f64,
    /// Where, and how much.
    pub load: StaticLoad,
}

/// The columns of a recording.
pub(super) struct Columns<'a>(HashMap<(usize, Signal, usize), &'a [f64]>);

impl<'a> Columns<'a> {
    pub(super) fn of(recording: &'a Recording) -> Columns<'a> {
        Columns(recording.columns.iter().map(|c| ((c.agent, c.signal, c.axis), &c.values[..])).collect())
    }

    /// A signal of an agent on one axis, row by row.
    pub(super) fn column(&self, agent: usize, signal: Signal, axis: usize) -> Option<&'a [f64]> {
        self.0.get(&(agent, signal, axis)).copied()
    }

    /// A signal of an agent at one row.
    pub(super) fn at(&self, agent: usize, signal: Signal, axes: usize, row: usize) -> Option<Vec<f64>> {
        (0..axes).map(|axis| self.0.get(&(agent, signal, axis))?.get(row).copied()).collect()
    }
}

/// Looks at `recording`, which a run of `setup` left behind.
pub fn along(setup: &Setup, recording: &Recording) -> Along {
    let columns = Columns::of(recording);
    let hold = setup.control.as_ref().map(|control| (Hold::of(control), 1.0 / control.sample_hz));
    let evaluator = |agent: usize| {
        limits(setup, agent)?;
        setup.agents[agent].robot.kind.lagrangian().map(|robot| robot.evaluator())
    };
    let mut sampled: Vec<_> = (0..setup.agents.len())
        .map(|agent| (agent, hold.and_then(|_| gains(setup, agent)), evaluator(agent)))
        .filter(|(_, gains, evaluator)| gains.is_some() || evaluator.is_some())
        .collect();
    let mut found = Along::default();
    for row in rows(recording.t_s.len(), sampled.len()) {
        let t_s = recording.t_s[row];
        found.rows += 1;
        for (agent, gains, evaluator) in &mut sampled {
            found.states += 1;
            if let (Some(gains), Some((hold, period_s))) = (gains, hold)
                && let Some(rates) = rates(setup, &columns, *agent, gains, row)
            {
                let sigma = rates.sigma(hold, period_s);
                if found.margin.is_none_or(|worst| sigma > worst.sigma) {
                    let fastest_per_s = rates.damping_per_s;
                    found.margin = Some(MarginReached { agent: *agent, t_s, sigma, fastest_per_s });
                }
            }
            if let Some(evaluator) = evaluator
                && let Some(load) = held(setup, &columns, *agent, &mut **evaluator, row)
                && found.load.as_ref().is_none_or(|worst| load.share() > worst.load.share())
            {
                found.load = Some(LoadReached { t_s, load });
            }
        }
    }
    let swing = hold
        .zip(found.margin)
        .map_or(Swing::NONE, |((hold, period_s), worst)| hold.swing_at(period_s, worst.fastest_per_s, worst.sigma));
    let grown = (found.margin.map_or(0.0, |margin| margin.sigma), swing);
    found.power = power(setup, &columns, &recording.t_s, grown);
    found
}

/// The mean of Σ sᵀKs over all rows, with σ and the swing as large as they became.
fn power(setup: &Setup, columns: &Columns<'_>, t_s: &[f64], grown: (f64, Swing)) -> Option<PowerReached> {
    if !is_fed(setup) {
        return None;
    }
    let (rows, [first_s, .., last_s]) = (t_s.len(), t_s) else { return None };
    let span_s = last_s - first_s;
    let (mut mean_w, mut start_j, mut push_w) = (0.0, Some(0.0), Some(0.0));
    let mut parts = PowerBound::of_none(setup, span_s, grown);
    for agent in (0..setup.agents.len()).filter(|agent| is_lagrangian(&setup.agents[*agent])) {
        let gains = Gains::of(&setup.agents[agent])?;
        let axes = gains.damping.nrows();
        let compliance = gains.damping.clone().cholesky()?.inverse();
        let dry_w = dry_loss_w(&setup.agents[agent]);
        let mut own_w = 0.0;
        for row in 0..rows {
            let signal = |signal| columns.at(agent, signal, axes, row).map(DVector::from_vec);
            let s = signal(Signal::TrackingError)?;
            let moves = setup.control.as_ref().zip(signal(Signal::Reference(1)));
            mean_w += moves.map_or_else(
                || s.dot(&(&gains.damping * &s)),
                |(control, dz)| over_period(&gains.damping, &s, &dz, t_s[row], 1.0 / control.sample_hz),
            ) / rows as f64;
            own_w += signal(Signal::External).map_or(0.0, |d| d.dot(&(&compliance * &d)) / rows as f64);
        }
        // Dry friction is a part of what was recorded, and no push.
        let own_w = dry_w.map_or(Some(own_w), |_| pushed_w(&setup.agents[agent], &gains, [*first_s, *last_s]));
        push_w = push_w.zip(own_w).map(|(all, own)| all + own);
        let energy_j = columns.at(agent, Signal::Lyapunov, 1, 0).and_then(|v| v.first().copied());
        start_j = start_j.zip(energy_j).map(|(all, own)| all + own);
        let close = close_rows(columns, rows, [agent, axes], setup.agents.len());
        let way: Vec<Led> = close.iter().filter_map(|row| Led::recorded(columns, t_s, [agent, axes], *row)).collect();
        let way: Vec<&Led> = way.iter().collect();
        parts.add(setup, agent, &gains, &way)?;
    }
    let bound = |(start_j, push_w): (f64, f64)| PowerBound { start_w: start_j / span_s, push_w, ..parts }.worked_out();
    (parts.agents > 0 && mean_w.is_finite())
        .then(|| PowerReached { mean_w, bound: start_j.zip(push_w).and_then(bound) })
}

/// The mean of sᵀKs over the period of a row, which begins with a sample: z is held until the next one, and q̇ goes on as the reference does.
/// Rows may all stand at samples, where s is what is left of it.
fn over_period(damping: &DMatrix<f64>, s: &DVector<f64>, dz: &DVector<f64>, t_s: f64, period_s: f64) -> f64 {
    // A row at a sample is one just after it, whatever rounding makes of its time.
    let periods = t_s / period_s;
    let whole = (periods + SLACK_PERIODS).floor();
    let since_s = ((periods - whole) * period_s).max(0.0);
    let middle = s + dz * (0.5 * period_s - since_s);
    middle.dot(&(damping * &middle)) + dz.dot(&(damping * dz)) * period_s * period_s / 12.0
}

/// Rows that are looked at: the first, the last and others between them.
fn rows(rows: usize, agents: usize) -> Vec<usize> {
    if agents == 0 || rows == 0 {
        return Vec::new();
    }
    let most = (MOST / agents).clamp(2, rows.max(2)) - 1;
    let mut chosen: Vec<usize> = (0..=most).map(|k| k * (rows - 1) / most).collect();
    chosen.dedup();
    chosen
}

/// M and P of an agent at one row.
fn rates(setup: &Setup, columns: &Columns<'_>, agent: usize, gains: &Gains, row: usize) -> Option<Rates> {
    let robot = &setup.agents[agent].robot;
    let axes = robot.axes.len();
    let signal = |signal| columns.at(agent, signal, axes, row);
    let (q, dq) = (signal(Signal::Position)?, signal(Signal::Velocity)?);
    let (z, dz) = (signal(Signal::Reference(0))?, signal(Signal::Reference(1))?);
    let motion = TwoVelocity { q: &q, dq: &dq, z: &z, dz: &dz };
    gains.rates(&robot.kind.lagrangian()?.dynamics_at(&robot.theta, motion).ok()?)
}

/// The static torque of an agent at one row.
fn held(
    setup: &Setup,
    columns: &Columns<'_>,
    agent: usize,
    evaluator: &mut dyn Evaluator,
    row: usize,
) -> Option<StaticLoad> {
    let q = columns.at(agent, Signal::Position, setup.agents[agent].robot.axes.len(), row)?;
    load(setup, agent, evaluator, &q).filter(|load| load.torque.is_finite())
}
