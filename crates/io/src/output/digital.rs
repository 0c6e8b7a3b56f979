//! What going digital cost: a run under digital control beside the same run in continuous time.

use forwardstep_sim::recording::{Ending, Outcome, Recording, Signal};
use forwardstep_sim::setup::Setup;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::metrics::{Metrics, Peak};
use super::number;
use super::table::Table;
use crate::scenario::Goal;

/// A run under digital control against its continuous twin: the same robots, network and pushes, but exact measurements, no
/// limits, and the law in continuous time. Both are looked at until the earlier of their ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DigitalCost {
    /// Samples per second.
    pub sample_hz: f64,
    /// How the twin ended, when it did not reach the horizon.
    pub twin_ended_at_s: Option<f64>,
    /// The largest difference of positions, digital less continuous, rad or m; `None` without a common row.
    pub largest_gap: Option<Peak>,
    /// Both runs in numbers.
    pub digital: Figures,
    /// See `digital`.
    pub continuous: Figures,
}

/// A run in the numbers that digital control changes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Figures {
    /// Disagreement at the last row, rad or m.
    pub final_disagreement: Option<f64>,
    /// When it settled below the goal, s.
    pub settled_s: Option<f64>,
    /// The largest |τ|, N m or N.
    pub peak_torque: Option<f64>,
    /// The root of the mean of τ² over time, agents and axes, N m or N.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub rms_torque: f64,
    /// The same of s, rad/s or m/s.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub rms_tracking_error: f64,
}

impl DigitalCost {
    /// Compares `digital`, the outcome of `setup`, with the outcome of its continuous twin; `None` when control was not
    /// digital.
    pub fn of(setup: &Setup, digital: &Outcome, twin: &Outcome, goal: Option<Goal>) -> Option<DigitalCost> {
        let control = setup.control.as_ref()?;
        let twin_ended_at_s = match &twin.ending {
            Ending::Completed => None,
            Ending::Interrupted { t_s } | Ending::CutOff { t_s } => Some(*t_s),
            Ending::BrokeDown(breakdown) => Some(breakdown.t_s),
        };
        Some(DigitalCost {
            sample_hz: control.sample_hz,
            twin_ended_at_s,
            largest_gap: largest_gap(setup, digital, twin),
            digital: Figures::of(setup, &common(digital, twin), goal),
            continuous: Figures::of(setup, &common(twin, digital), goal),
        })
    }
}

/// `setup` with its law in continuous time and without limits, until `until_s`.
pub fn continuous_twin(setup: &Setup, until_s: f64) -> Setup {
    let mut twin = Setup { control: None, ..setup.clone() };
    twin.agents.iter_mut().for_each(|agent| agent.enforce_limits = false);
    twin.time.end_s = twin.time.end_s.min(until_s);
    twin
}

/// The rows of `one` that are rows of `other` too.
fn common(one: &Outcome, other: &Outcome) -> Recording {
    let rows = one.recording.t_s.len().min(other.recording.t_s.len());
    let mut recording = one.recording.clone();
    recording.t_s.truncate(rows);
    recording.columns.iter_mut().for_each(|column| column.values.truncate(rows));
    recording
}

fn largest_gap(setup: &Setup, digital: &Outcome, twin: &Outcome) -> Option<Peak> {
    let (digital, twin) = (Table::new(setup, &digital.recording), Table::new(setup, &twin.recording));
    let gaps = digital.axes(Signal::Position).flat_map(|(agent, axis, values)| {
        let other = twin.column(agent, Signal::Position, axis).unwrap_or_default();
        let rows = digital.t_s.iter().zip(values).zip(other);
        rows.map(move |((t_s, value), other)| Peak { agent, axis, t_s: *t_s, value: value - other })
    });
    gaps.filter(|gap| gap.value.is_finite()).reduce(|a, b| if b.value.abs() > a.value.abs() { b } else { a })
}

impl Figures {
    fn of(setup: &Setup, recording: &Recording, goal: Option<Goal>) -> Figures {
        let metrics = Metrics::of(setup, recording, None, goal);
        let table = Table::new(setup, recording);
        let rms = |signal| {
            let values = || table.axes(signal).flat_map(|(_, _, values)| values);
            // The sum of nothing has a sign.
            (values().map(|value| value * value).fold(0.0, |sum, square| sum + square) / values().count().max(1) as f64)
                .sqrt()
        };
        Figures {
            final_disagreement: metrics.disagreement.last(),
            settled_s: metrics.settled_s,
            peak_torque: metrics.peak_torques.iter().map(|peak| peak.value.abs()).reduce(f64::max),
            rms_torque: rms(Signal::Torque),
            rms_tracking_error: rms(Signal::TrackingError),
        }
    }
}
