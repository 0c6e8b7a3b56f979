//! A run in a few numbers.

use forwardstep_sim::recording::{Outcome, Recording, Signal};
use forwardstep_sim::reference::Backstepping;
use forwardstep_sim::{LineValue, Setup};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use forwardstep_check::prediction::only_passes;

use super::disagreement::greater;
pub use super::disagreement::{Absence, Disagreement, DisagreementSeries, Gap};
use super::loads::{Load, loads, rotor_thrusts};
use super::number;
use super::practical::Watched;
use super::table::Table;
use crate::scenario::Goal;
use crate::wording::{about, count};

/// V(0) is not taken to be smaller than this, in J, when the residual of the balance is put in relation to it: an agent that
/// starts without any error has V(0) = 0.
pub const BALANCE_FLOOR_J: f64 = 1e-6;

/// What a run comes to. Agents and axes are indices from zero; numbers that are not finite are `null` in JSON.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Metrics {
    /// Rows of the recording.
    pub rows: usize,
    /// Time of the last row, s.
    pub last_t_s: Option<f64>,
    /// How far the agents are apart.
    pub disagreement: Disagreement,
    /// The time from which on the disagreement stays below the goal until the end, s.
    pub settled_s: Option<f64>,
    /// When the disagreement exceeds 1 % of its start for the last time, s; absent where it still does at the last row.
    #[serde(default)]
    pub settled_to_1_percent_s: Option<f64>,
    /// The mean of the positions less their offsets at the last row, one entry per axis; absent where agents cannot be compared.
    #[serde(default)]
    pub final_means: Option<Vec<f64>>,
    /// The largest |s| at the last row, over all agents and axes; absent where s is not recorded.
    #[serde(default)]
    pub final_tracking_error: Option<f64>,
    /// Largest and final speed over all agents and axes.
    pub speed: Option<Speed>,
    /// The largest |τ| of every agent and axis, at the rows that are recorded.
    pub peak_torques: Vec<Peak>,
    /// The same of what acts or is taken up without an axis: thrusts, rotors, wheels.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub peak_loads: Vec<Load>,
    /// Limits that were exceeded, or reached where they are enforced, at the rows that are recorded.
    pub limits_reached: Vec<LimitReached>,
    /// How well V + ∫ dissipation = V(0) holds; absent where the balance is not computed.
    #[serde(alias = "ledger_error")]
    pub balance_residual: Option<BalanceResidual>,
    /// Predicted beside reached value, per axis; absent without a prediction or where the agents' axes differ.
    pub agreement: Option<Vec<Agreement>>,
    /// The sampling margin and static torques along the run; absent where there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub watched: Option<Watched>,
}

/// A value, where and when.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Peak {
    /// The agent.
    pub agent: usize,
    /// The axis.
    pub axis: usize,
    /// When, s.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub t_s: f64,
    /// The value.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub value: f64,
}

/// The speeds of a run, rad/s or m/s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Speed {
    /// The largest |q̇|, at the rows that are recorded.
    pub largest: Peak,
    /// The largest |q̇| at the last row.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub last: f64,
}

/// The limit that was reached. In JSON it is `position`, `velocity`, `effort` or the symbol of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitKind {
    /// Lowest or highest position.
    Position,
    /// Highest speed.
    Velocity,
    /// Highest torque or force.
    Effort,
    /// Lowest or highest thrust of a rotor; the axis is its number.
    Rotor,
    /// A limit of the plant's own, of this signal.
    Signal(Signal),
    /// The same, read back from a file, which has the symbol only.
    Unknown,
}

impl Serialize for LimitKind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            LimitKind::Position => serializer.serialize_str("position"),
            LimitKind::Velocity => serializer.serialize_str("velocity"),
            LimitKind::Effort => serializer.serialize_str("effort"),
            LimitKind::Rotor => serializer.serialize_str("rotor"),
            LimitKind::Signal(signal) => serializer.serialize_str(&signal.name()),
            LimitKind::Unknown => serializer.serialize_str("unknown"),
        }
    }
}

impl<'de> Deserialize<'de> for LimitKind {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(match String::deserialize(deserializer)?.as_str() {
            "position" => LimitKind::Position,
            "velocity" => LimitKind::Velocity,
            "effort" => LimitKind::Effort,
            "rotor" => LimitKind::Rotor,
            _ => LimitKind::Unknown,
        })
    }
}

/// A limit of an axis that was exceeded at some row; for rotors, and for efforts of agents that enforce their limits, that was reached.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LimitReached {
    /// The agent.
    pub agent: usize,
    /// The axis, the entry of the signal, or the rotor.
    pub axis: usize,
    /// Which limit.
    #[schemars(with = "String")]
    pub kind: LimitKind,
    /// Whether the simulation kept to it; otherwise it is only reported.
    pub enforced: bool,
    /// The first row at which it was exceeded, s.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub first_t_s: f64,
    /// When it was exceeded most, s.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub worst_t_s: f64,
    /// The value then.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub worst: f64,
    /// The limit on that side.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub limit: f64,
    /// By how much.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub excess: f64,
    /// The share of rows at which it was exceeded, from 0 to 1.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub share: f64,
}

impl LimitReached {
    /// Before any row has been looked at.
    fn nowhere(agent: usize, axis: usize, kind: LimitKind, enforced: bool) -> Self {
        LimitReached {
            agent,
            axis,
            kind,
            enforced,
            first_t_s: 0.0,
            worst_t_s: 0.0,
            worst: 0.0,
            limit: 0.0,
            excess: 0.0,
            share: 0.0,
        }
    }
}

/// The largest |V + ∫ dissipation − V(0)| relative to V(0), but at least [`BALANCE_FLOOR_J`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BalanceResidual {
    /// Relative error.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub relative: f64,
    /// Of this agent.
    pub agent: usize,
    /// At this time, s.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub t_s: f64,
}

/// Predicted and reached value on one axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Agreement {
    /// The axis.
    pub axis: usize,
    /// What the agents were predicted to agree on.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub predicted: f64,
    /// The mean of their last positions, less their offsets.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub reached: f64,
    /// The largest distance of a last position, less its offset, from the prediction.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub distance: f64,
}

impl Metrics {
    /// Reduces a recording to its metrics. `predicted` is the agreement per axis, `goal` sets the bound for settling.
    pub fn of(setup: &Setup, recording: &Recording, predicted: Option<&[f64]>, goal: Option<Goal>) -> Metrics {
        let table = Table::new(setup, recording);
        let series = DisagreementSeries::of_table(&table);
        Metrics {
            rows: table.t_s.len(),
            last_t_s: table.t_s.last().copied(),
            settled_s: match (&series, goal) {
                (Ok(series), Some(goal)) => goal.bound().and_then(|bound| settled(table.t_s, &series.overall, bound)),
                _ => None,
            },
            settled_to_1_percent_s: series
                .as_ref()
                .ok()
                .and_then(|series| forwardstep_check::prediction::settled(table.t_s, &series.overall).time_s()),
            final_means: series.as_ref().ok().filter(|_| Gap::of(setup) == Gap::Disagreement).and_then(|series| {
                (0..series.per_axis.len())
                    .map(|axis| Some(last_positions(&table, axis)?.1).filter(|mean| mean.is_finite()))
                    .collect()
            }),
            final_tracking_error: final_tracking_error(&table),
            disagreement: match &series {
                Ok(DisagreementSeries { overall, .. }) => Disagreement::over(table.t_s, overall),
                Err(absence) => Disagreement::Absent(*absence),
            },
            speed: speed(&table),
            peak_torques: table.axes(Signal::Torque).filter_map(|(i, axis, tau)| peak(&table, i, axis, tau)).collect(),
            peak_loads: loads(&table),
            limits_reached: limits_reached(&table),
            balance_residual: balance_residual(&table),
            agreement: if series.is_ok() { predicted.and_then(|p| agreement(&table, p)) } else { None },
            watched: Watched::of(setup, recording),
        }
    }
}

/// The largest |value| of a column with its sign, the first of equals; a value that is not a number wins.
pub(super) fn peak(table: &Table<'_>, agent: usize, axis: usize, values: &[f64]) -> Option<Peak> {
    let worse = |(_, best): (_, &f64), (_, next): (_, &f64)| next.abs() > best.abs() || next.is_nan() && !best.is_nan();
    let (t_s, value) = table.t_s.iter().zip(values).reduce(|best, next| if worse(best, next) { next } else { best })?;
    Some(Peak { agent, axis, t_s: *t_s, value: *value })
}

fn speed(table: &Table<'_>) -> Option<Speed> {
    let peaks = table.axes(Signal::Velocity).filter_map(|(agent, axis, dq)| peak(table, agent, axis, dq));
    let largest = peaks.reduce(|best, next| {
        if next.value.abs() > best.value.abs() || next.value.is_nan() && !best.value.is_nan() { next } else { best }
    })?;
    let last = table.axes(Signal::Velocity).filter_map(|(.., dq)| dq.last()).map(|dq| dq.abs()).fold(0.0, greater);
    Some(Speed { largest: Peak { value: largest.value.abs(), ..largest }, last })
}

fn final_tracking_error(table: &Table<'_>) -> Option<f64> {
    let last = table.axes(Signal::TrackingError).filter_map(|(.., s)| s.last().map(|s| s.abs()));
    last.reduce(greater).filter(|s| s.is_finite())
}

fn settled(t_s: &[f64], overall: &[f64], bound: f64) -> Option<f64> {
    // "not below" rather than "above or equal": a disagreement that is not a number has not settled.
    let above = |d: &f64| !matches!(d.partial_cmp(&bound), Some(std::cmp::Ordering::Less));
    let first_settled = overall.iter().rposition(above).map_or(0, |last_above| last_above + 1);
    t_s.get(first_settled).copied().filter(|_| !only_passes(t_s, overall, bound))
}

fn limits_reached(table: &Table<'_>) -> Vec<LimitReached> {
    let mut found = Vec::new();
    let actuators = table.setup.control.as_ref().map(|control| &control.actuators);
    let stated = actuators.and_then(|actuators| actuators.torque_limit.as_ref());
    for (agent, setup) in table.setup.agents.iter().enumerate() {
        for (axis, limits) in setup.robot.axes.iter().enumerate() {
            // The limit of the controllers is kept in any case; that of the robot where it is enforced, or only reported.
            let kept = stated.and_then(|limits| limits.get(axis)).copied();
            let kept = kept.filter(|kept| limits.effort_limit.is_none_or(|effort| *kept <= effort));
            let symmetric = |limit: Option<f64>| limit.map(|limit| [-limit, limit]);
            for (kind, signal, range) in [
                (LimitKind::Position, Signal::Position, limits.position_limits),
                (LimitKind::Velocity, Signal::Velocity, symmetric(limits.velocity_limit)),
                (LimitKind::Effort, Signal::Torque, symmetric(kept.or(limits.effort_limit))),
            ] {
                let (Some(range), Some(values)) = (range, table.column(agent, signal, axis)) else { continue };
                let enforced = match kind {
                    LimitKind::Position => setup.enforce_limits,
                    LimitKind::Effort => setup.enforce_limits || kept.is_some(),
                    LimitKind::Velocity | LimitKind::Rotor | LimitKind::Signal(_) | LimitKind::Unknown => false,
                };
                let place = LimitReached::nowhere(agent, axis, kind, enforced);
                let within = |limit| actuators.map_or(limit, |actuators| actuators.largest_within(limit));
                let clips = (kind == LimitKind::Effort).then(|| [-within(range[1]), within(range[1])]);
                found.extend(beyond(table.t_s, values, range, place, clips));
            }
        }
        for line in setup.robot.interface().lines {
            let (limit, clips) = match line.value {
                LineValue::Limit(limit) => (limit, None),
                LineValue::Clip(limit) => (limit, Some([-limit, limit])),
                LineValue::Floor(_) | LineValue::Truth(_) => continue,
            };
            let Some(values) = table.column(agent, line.signal, line.entry) else { continue };
            let place = LimitReached::nowhere(agent, line.entry, LimitKind::Signal(line.signal), setup.enforce_limits);
            found.extend(beyond(table.t_s, values, [-limit, limit], place, clips));
        }
        found.extend(rotors(table, agent));
    }
    found
}

/// How far from its limit, over their distance, the thrust of a rotor may be that stands at it: it is worked out from σ and τ, which are rounded.
const ROTOR_ROUNDING: f64 = 1e-9;

/// The rotors of a rotorcraft that stood at their limits; they keep to them in any case.
fn rotors(table: &Table<'_>, agent: usize) -> Vec<LimitReached> {
    let Some((rotors, thrusts)) = rotor_thrusts(table, agent) else { return Vec::new() };
    let [least, most] = rotors.thrust;
    let slack = ROTOR_ROUNDING * (most - least);
    let reached = thrusts.iter().enumerate().filter_map(|(rotor, values)| {
        let place = LimitReached::nowhere(agent, rotor, LimitKind::Rotor, true);
        beyond(table.t_s, values, rotors.thrust, place, Some([least + slack, most - slack]))
    });
    reached.collect()
}

/// How far, as a part of it, rounding takes a command from a limit that is enforced.
const ROUNDED: f64 = 1e-14;

/// `place` with its numbers filled in, if any value lies outside of `range`, or where what is enforced `clips` it: on the border, or at the last
/// step within it of torques that are rounded.
fn beyond(
    t_s: &[f64],
    values: &[f64],
    [low, high]: [f64; 2],
    place: LimitReached,
    clips: Option<[f64; 2]>,
) -> Option<LimitReached> {
    let clips = clips.filter(|_| place.enforced);
    let mut result: Option<LimitReached> = None;
    let mut rows = 0_usize;
    for (&t_s, &value) in t_s.iter().zip(values) {
        let (limit, excess) = if value - high > low - value { (high, value - high) } else { (low, low - value) };
        // What is enforced may be off by what its sums are rounded.
        let excess = if place.enforced && excess <= ROUNDED * limit.abs() { 0.0 } else { excess };
        if excess > 0.0 || clips.is_some_and(|[low, high]| value <= low || value >= high) {
            rows += 1;
            let excess = excess.max(0.0);
            let seen = result.get_or_insert(LimitReached {
                first_t_s: t_s,
                worst_t_s: t_s,
                worst: value,
                limit,
                excess,
                ..place
            });
            if excess > seen.excess {
                *seen = LimitReached { worst_t_s: t_s, worst: value, limit, excess, ..*seen };
            }
        }
    }
    result.map(|seen| LimitReached { share: rows as f64 / t_s.len() as f64, ..seen })
}

fn balance_residual(table: &Table<'_>) -> Option<BalanceResidual> {
    let mut worst: Option<BalanceResidual> = None;
    for agent in 0..table.agents() {
        let Some(errors) = balance_residuals(table, agent) else { continue };
        for (&t_s, error) in table.t_s.iter().zip(errors) {
            let relative = error.abs();
            if worst.is_none_or(|w| relative > w.relative || relative.is_nan() && !w.relative.is_nan()) {
                worst = Some(BalanceResidual { relative, agent, t_s });
            }
        }
    }
    worst
}

/// Whether V loses what the law dissipates and no more: the filter of backstepping adds what its output is off by.
pub(crate) fn keeps_balance(setup: &Setup) -> bool {
    !setup.reference.is::<Backstepping>()
}

/// Steps between two rows, on the average, above which what lies between rows may be another.
const MANY_STEPS: f64 = 3.0;

/// That rows are so far apart beside the steps of a run that peaks and limits between them are not seen; `None` where they are not, and where
/// controllers sample, which ends steps that nothing else asks for.
pub fn coarse_rows(setup: &Setup, outcome: &Outcome) -> Option<String> {
    let (rows, steps) = (outcome.recording.t_s.len(), outcome.statistics.steps);
    let is_coarse = setup.control.is_none() && steps as f64 > MANY_STEPS * rows.max(1) as f64;
    let mean_s = outcome.recording.t_s.last()? / rows.saturating_sub(1).max(1) as f64;
    let what = "peaks and limits between rows are not seen, and times of settling are between rows";
    is_coarse.then(|| {
        format!(
            "{}, {} s apart on the average, beside {steps} steps: {what}; record more often",
            count(rows, "row"),
            about(mean_s)
        )
    })
}

/// (V + ∫ dissipation − V(0)) / V(0) row by row; as a part of the largest V where pushes put energy in.
pub(crate) fn balance_residuals(table: &Table<'_>, agent: usize) -> Option<Vec<f64>> {
    if !keeps_balance(table.setup) {
        return None;
    }
    let v = table.column(agent, Signal::Lyapunov, 0)?;
    let dissipated = table.column(agent, Signal::Dissipation, 0)?;
    let start = *v.first()?;
    let scale = balance_whole(table, agent)?.max(BALANCE_FLOOR_J);
    Some(v.iter().zip(dissipated).map(|(v, d)| (v + d - start) / scale).collect())
}

/// V(0) of an agent, or the largest V where pushes put energy in.
pub(crate) fn balance_whole(table: &Table<'_>, agent: usize) -> Option<f64> {
    let v = table.column(agent, Signal::Lyapunov, 0)?;
    let start = *v.first()?;
    let pushed = table.setup.agents.get(agent).is_some_and(|agent| !agent.pushes.is_empty());
    Some(if pushed { v.iter().copied().fold(start, f64::max) } else { start })
}

/// What all agents are to agree on on an axis, their positions less their offsets, at the last row, and the mean of it.
fn last_positions(table: &Table<'_>, axis: usize) -> Option<(Vec<f64>, f64)> {
    let last_of = |agent: usize, signal: Signal| table.column(agent, signal, axis)?.last().copied();
    let last: Option<Vec<f64>> = (0..table.agents())
        .map(|agent| Some(last_of(agent, Signal::Position)? - last_of(agent, Signal::Offset).unwrap_or(0.0)))
        .collect();
    let last = last.filter(|last| !last.is_empty())?;
    let mean = last.iter().sum::<f64>() / last.len() as f64;
    Some((last, mean))
}

fn agreement(table: &Table<'_>, predicted: &[f64]) -> Option<Vec<Agreement>> {
    predicted
        .iter()
        .enumerate()
        .map(|(axis, &predicted)| {
            let (last, reached) = last_positions(table, axis)?;
            let distance = last.iter().map(|q| (q - predicted).abs()).fold(0.0, greater);
            Some(Agreement { axis, predicted, reached, distance })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sum of what was kept to a limit may be a last digit above it.
    #[test]
    fn regress_a_limit_that_is_enforced_is_reached_and_not_exceeded_by_rounding() {
        let excess = |enforced: bool, value: f64| {
            let place = LimitReached::nowhere(0, 0, LimitKind::Effort, enforced);
            let clips = Some([-15.0, 15.0]);
            beyond(&[0.0, 1.0], &[1.0, value], [-15.0, 15.0], place, clips).map(|limit| limit.excess)
        };
        assert_eq!(
            (excess(true, 15.000_000_000_000_002), excess(true, -15.000_000_000_000_002)),
            (Some(0.0), Some(0.0))
        );
        assert!(excess(true, 15.000_000_1) > Some(0.0) && excess(false, 15.000_000_000_000_002) > Some(0.0));
        assert_eq!((excess(true, 14.9), excess(false, 15.0)), (None, None));
    }
}
