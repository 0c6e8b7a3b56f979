//! Gains and estimates of laws, as they are written and as they are read.

use forwardstep_core::{Gain, GainError};
use forwardstep_sim::{Attachments, RobotSetup};
use schemars::JsonSchema;
use serde::Deserialize;

use super::at::At;
use super::fault::{Fault, fault, length, positive, values};
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

/// K of `agent`, or the usual one for its robot.
///
/// # Errors
/// The first mistake, at its place.
pub fn damping(file: Option<&DampingFile>, agent: &LawReader<'_>) -> Result<Gain, Fault> {
    let LawReader { agent, robot, .. } = *agent;
    match file {
        Some(DampingFile::Gain(place)) => gain("damping.gain", &place.value, place, agent, robot.axes.len()),
        Some(DampingFile::BandwidthPerS(bandwidth)) => {
            Ok(Gain::Bandwidth(positive("damping.bandwidth_per_s", bandwidth)?))
        }
        None if has_scales(robot) => Ok(Gain::Bandwidth(DAMPING_BANDWIDTH_PER_S)),
        None => Ok(Gain::Number(DAMPING_GAIN)),
    }
}

/// Γ of `agent`, or the usual one for its robot.
///
/// # Errors
/// The first mistake, at its place.
pub fn adaptation(file: Option<&At<GainOrBandwidth>>, agent: &LawReader<'_>) -> Result<Gain, Fault> {
    let LawReader { agent, robot, .. } = *agent;
    let Some(place) = file else {
        let (tree, other) = (Gain::Bandwidth(ADAPTATION_BANDWIDTH_PER_S), Gain::Number(ADAPTATION_GAIN));
        return Ok(if has_scales(robot) { tree } else { other });
    };
    match &place.value {
        GainOrBandwidth::Gain(file) => gain("adaptation_gain", file, place, agent, robot.theta.len()),
        GainOrBandwidth::Bandwidth(file) => Ok(Gain::Bandwidth(positive("bandwidth_per_s", &file.bandwidth_per_s)?)),
    }
}

/// Whether the inertias of a robot span decades, so that its usual gains are bandwidths.
pub(super) fn has_scales(robot: &RobotSetup) -> bool {
    matches!(robot.interface().attachments, Attachments::Links(_))
}

/// A gain without a bandwidth, or the usual number.
///
/// # Errors
/// The mistake, at its place.
pub fn gain_or(
    key: &'static str,
    file: &Option<At<GainFile>>,
    usual: f64,
    agent: &str,
    size: usize,
) -> Result<Gain, Fault> {
    file.as_ref().map_or(Ok(Gain::Number(usual)), |place| gain(key, &place.value, place, agent, size))
}

/// Reads a gain and checks that it is symmetric positive definite and of the right size. Messages call it `key`.
///
/// # Errors
/// The mistake, at its place.
pub fn gain<T>(key: &'static str, file: &GainFile, place: &At<T>, agent: &str, size: usize) -> Result<Gain, Fault> {
    let rows = match file {
        GainFile::Number(value) => {
            let number = At { value: *value, span: place.span.clone() };
            return Ok(Gain::Number(positive(key, &number)?));
        }
        GainFile::Rows(rows) => rows,
    };
    let lists = rows.iter().filter(|row| matches!(row.value, Item::List(_))).count();
    let gain = match lists {
        0 => {
            let mut diagonal = Vec::with_capacity(rows.len());
            for row in rows {
                let number = At { value: row.value.number().unwrap_or_default(), span: row.span.clone() };
                diagonal.push(positive(key, &number)?);
            }
            Gain::Diagonal(diagonal)
        }
        lists if lists < rows.len() => return Err(fault(place, ValueProblem::MixedList { key })),
        _ => {
            let mut entries = Vec::new();
            for (k, row) in rows.iter().enumerate() {
                let Item::List(list) = &row.value else { continue };
                if list.len() != rows.len() {
                    let (rows, row_number, entries) = (rows.len(), k + 1, list.len());
                    return Err(fault(row, ValueProblem::NotSquare { key, rows, row: row_number, entries }));
                }
                entries.extend(values(list));
            }
            Gain::Matrix(entries)
        }
    };
    // It is no bandwidth, so no scale is needed.
    let Err(error) = gain.resolve(size, &[]) else { return Ok(gain) };
    let agent = agent.to_owned();
    let problem = match error {
        // Rows, as they were written, whether of a diagonal or of a matrix.
        GainError::Length(_) => ValueProblem::VectorLength { key, found: rows.len(), need: size, agent },
        error => ValueProblem::Gain { key, agent, error },
    };
    Err(fault(place, problem))
}

/// ϑ̂(0) of `agent`; zero without a file.
///
/// # Errors
/// [`ValueProblem::VectorLength`] when numbers are given, but not one for each parameter.
pub fn estimate(file: Option<&EstimateStartFile>, agent: &LawReader<'_>) -> Result<Vec<f64>, Fault> {
    let LawReader { agent, robot, .. } = *agent;
    match file {
        None => Ok(vec![0.0; robot.theta.len()]),
        Some(file) => known_or_given("estimate_start.given", file, agent, &robot.theta),
    }
}

/// An estimate of `theta` at the start.
pub(super) fn known_or_given(
    key: &'static str,
    file: &EstimateStartFile,
    agent: &str,
    theta: &[f64],
) -> Result<Vec<f64>, Fault> {
    match file {
        EstimateStartFile::Zero => Ok(vec![0.0; theta.len()]),
        EstimateStartFile::True => Ok(theta.to_vec()),
        EstimateStartFile::Scaled(factor) => Ok(theta.iter().map(|entry| factor.value * entry).collect()),
        EstimateStartFile::Given(list) => {
            length(key, &list.span, list.value.len(), theta.len(), agent)?;
            Ok(values(&list.value))
        }
    }
}
