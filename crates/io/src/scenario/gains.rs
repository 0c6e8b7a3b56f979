//! Gains and estimates of laws, as they are written and as they are read.

use forwardstep_core::Gain;
use forwardstep_sim::{Attachments, RobotSetup};
use schemars::JsonSchema;
use serde::Deserialize;

use super::at::At;
use super::fault::{Fault, fault, values};
use super::kinds::LawReader;
use super::value_problem::ValueProblem;
use super::values::{GainFile, GainOrBandwidth, Item, Positive};

/// The gains of arms from a URDF, whose inertias span decades.
const DAMPING_BANDWIDTH_PER_S: f64 = 20.0;
const ADAPTATION_BANDWIDTH_PER_S: f64 = 5.0;
/// The gains of planar arms and point masses, as in the paper.
const DAMPING_GAIN: f64 = 8.0;
const ADAPTATION_GAIN: f64 = 10.0;

/// The gain K of the tracking law.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DampingFile {
    /// A number, the diagonal, or the rows of a symmetric positive definite matrix; in N m s/rad or N s/m.
    Gain(At<GainFile>),
    /// In 1/s; multiplied by the diagonal of the mass matrix at the start.
    BandwidthPerS(#[schemars(with = "Positive")] At<f64>),
}

/// The parameter estimate at the start.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EstimateStartFile {
    /// Nothing is known: all zero.
    Zero,
    /// The true parameters.
    True,
    /// The true parameters times this number.
    Scaled(At<f64>),
    /// These numbers.
    Given(At<Vec<At<f64>>>),
}

/// K of `agent`, or the default one for its robot.
///
/// # Errors
/// The first mistake, at its place.
pub fn damping(file: Option<&DampingFile>, agent: &LawReader<'_>) -> Result<Gain, Fault> {
    match file {
        Some(DampingFile::Gain(place)) => gain("damping.gain", &place.value, place),
        Some(DampingFile::BandwidthPerS(bandwidth)) => Ok(Gain::Bandwidth(bandwidth.value)),
        None if has_scales(agent.robot) => Ok(Gain::Bandwidth(DAMPING_BANDWIDTH_PER_S)),
        None => Ok(Gain::Number(DAMPING_GAIN)),
    }
}

/// Γ of `agent`, or the default one for its robot.
///
/// # Errors
/// The first mistake, at its place.
pub fn adaptation(file: Option<&At<GainOrBandwidth>>, agent: &LawReader<'_>) -> Result<Gain, Fault> {
    let Some(place) = file else {
        let (tree, other) = (Gain::Bandwidth(ADAPTATION_BANDWIDTH_PER_S), Gain::Number(ADAPTATION_GAIN));
        return Ok(if has_scales(agent.robot) { tree } else { other });
    };
    match &place.value {
        GainOrBandwidth::Gain(file) => gain("adaptation_gain", file, place),
        GainOrBandwidth::Bandwidth(file) => Ok(Gain::Bandwidth(file.bandwidth_per_s.value)),
    }
}

/// Whether the inertias of a robot span decades, so that its default gains are bandwidths.
pub(super) fn has_scales(robot: &RobotSetup) -> bool {
    matches!(robot.interface().attachments, Attachments::Links(_))
}

/// A gain without a bandwidth, or the default number.
///
/// # Errors
/// The mistake, at its place.
pub fn gain_or(key: &'static str, file: &Option<At<GainFile>>, usual: f64) -> Result<Gain, Fault> {
    file.as_ref().map_or(Ok(Gain::Number(usual)), |place| gain(key, &place.value, place))
}

/// Reads a gain; what it must be is checked where its law is built. Messages call it `key`.
///
/// # Errors
/// That it is no number, list of numbers or square, at its place.
pub fn gain<T>(key: &'static str, file: &GainFile, place: &At<T>) -> Result<Gain, Fault> {
    let rows = match file {
        GainFile::Number(value) => return Ok(Gain::Number(*value)),
        GainFile::Rows(rows) => rows,
    };
    let diagonal: Vec<f64> = rows.iter().filter_map(|row| row.value.number()).collect();
    if diagonal.len() == rows.len() {
        return Ok(Gain::Diagonal(diagonal));
    }
    let mut entries = Vec::new();
    for (k, row) in rows.iter().enumerate() {
        let Item::List(list) = &row.value else { return Err(fault(place, ValueProblem::MixedList { key })) };
        if list.len() != rows.len() && diagonal.is_empty() {
            let (rows, row_number, entries) = (rows.len(), k + 1, list.len());
            return Err(fault(row, ValueProblem::NotSquare { key, rows, row: row_number, entries }));
        }
        entries.extend(values(list));
    }
    Ok(Gain::Matrix(entries))
}

/// ϑ̂(0) of `agent`; zero without a file.
pub fn estimate(file: Option<&EstimateStartFile>, agent: &LawReader<'_>) -> Vec<f64> {
    known_or_given(file.unwrap_or(&EstimateStartFile::Zero), &agent.robot.theta)
}

/// An estimate of `theta` at the start.
pub(super) fn known_or_given(file: &EstimateStartFile, theta: &[f64]) -> Vec<f64> {
    match file {
        EstimateStartFile::Zero => vec![0.0; theta.len()],
        EstimateStartFile::True => theta.to_vec(),
        EstimateStartFile::Scaled(factor) => theta.iter().map(|entry| factor.value * entry).collect(),
        EstimateStartFile::Given(list) => values(&list.value),
    }
}
