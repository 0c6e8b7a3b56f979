//! `law` of an agent → [`Law`].

use std::sync::Arc;

use forwardstep_core::robot::PointMass;
use forwardstep_core::robot::tree::Tree;
use forwardstep_core::{Gain, GainError};
use forwardstep_sim::{Adaptive, ChainModel, Known, Law, PositionOnlyLaw, RobotSetup, SpacecraftModel};

use super::agents::Body;
use super::at::At;
use super::chain;
use super::chain_file::{AdaptiveBacksteppingFile, LinearAdaptiveFile};
use super::fault::{Fault, fault, length, not_negative_or, positive, positive_or, values};
use super::file::{AdaptiveFile, DampingFile, EstimateStartFile, KnownFile, LawFile};
use super::spacecraft;
use super::spacecraft_file::AttitudeFile;
use super::system_problem::SystemProblem;
use super::systems_file::PositionOnlyFile;
use super::task;
use super::value_problem::ValueProblem;
use super::values::{GainFile, GainOrBandwidth, Item};
use super::vehicle;
use super::vehicle_file::ThrustFile;

/// The gains of arms from a URDF, whose inertias span decades.
const DAMPING_BANDWIDTH_PER_S: f64 = 20.0;
const ADAPTATION_BANDWIDTH_PER_S: f64 = 5.0;
/// The gains of planar arms and point masses, as in the paper.
const DAMPING_GAIN: f64 = 8.0;
const ADAPTATION_GAIN: f64 = 10.0;
/// Of the filter that stands in for a velocity.
const FILTER_PER_S: f64 = 10.0;

/// Builds the law of `agent`; without a file, the usual one for its robot with default gains.
pub(super) fn law(
    file: Option<&At<LawFile>>,
    agent: &str,
    robot: &RobotSetup,
    body: &Body,
) -> Result<Arc<dyn Law>, Fault> {
    match file {
        None => build(&usual(robot), agent, robot, body),
        Some(file) => build(&file.value, agent, robot, body).map_err(|fault| fault.at(&file.span)),
    }
}

fn usual(robot: &RobotSetup) -> LawFile {
    let kind = &robot.kind;
    match kind.downcast() {
        Some(ChainModel::Derivatives(_)) => LawFile::LinearAdaptive(LinearAdaptiveFile::default()),
        Some(ChainModel::Cascade(_)) => LawFile::AdaptiveBackstepping(AdaptiveBacksteppingFile::default()),
        None if kind.is::<SpacecraftModel>() => LawFile::Attitude(AttitudeFile::default()),
        None if kind.lagrangian().is_none() => LawFile::Thrust(ThrustFile::default()),
        None => LawFile::Adaptive(AdaptiveFile::default()),
    }
}

/// A law beside a robot that it is not made for.
pub(super) fn of_another(law: &'static str, made_for: &'static str, agent: &str, robot: &RobotSetup) -> Fault {
    let kind = &robot.kind;
    let laws = match kind.downcast() {
        Some(ChainModel::Derivatives(_)) => "`linearising`, `linear_adaptive` and `immersion`",
        Some(ChainModel::Cascade(_)) => "`adaptive_backstepping`",
        None if kind.is::<SpacecraftModel>() => "`attitude`",
        None if kind.is::<PointMass>() => "`adaptive`, `known` and `position_only`",
        None if kind.lagrangian().is_none() => "`thrust`",
        None => "`adaptive`, `known` and `task_space`",
    };
    Fault::new(SystemProblem::LawOfAnother { agent: agent.to_owned(), law, made_for, laws })
}

fn build(file: &LawFile, agent: &str, robot: &RobotSetup, body: &Body) -> Result<Arc<dyn Law>, Fault> {
    match file {
        LawFile::Known(_) | LawFile::Adaptive(_) if robot.kind.lagrangian().is_none() => {
            let law = if let LawFile::Known(_) = file { "known" } else { "adaptive" };
            Err(of_another(law, "arms and point masses", agent, robot))
        }
        LawFile::Known(KnownFile { damping }) => {
            Ok(Arc::new(Known { damping: self::damping(damping.as_ref(), agent, robot)? }))
        }
        LawFile::PositionOnly(file) => position_only(file, agent, robot),
        LawFile::Thrust(file) => vehicle::thrust(file, agent, robot),
        LawFile::TaskSpace(file) => task::task_space(file, agent, robot, body),
        LawFile::Attitude(file) => spacecraft::attitude(file, agent, robot),
        LawFile::Linearising(file) => chain::linearising(file, agent, robot),
        LawFile::LinearAdaptive(file) => chain::linear_adaptive(file, agent, robot),
        LawFile::Immersion(file) => chain::immersion(file, agent, robot),
        LawFile::AdaptiveBackstepping(file) => chain::backstepping(file, agent, robot),
        LawFile::Adaptive(file) => Ok(Arc::new(Adaptive {
            damping: damping(file.damping.as_ref(), agent, robot)?,
            adaptation: adaptation(file.adaptation_gain.as_ref(), agent, robot)?,
            estimate_start: estimate(file.estimate_start.as_ref(), agent, robot)?,
        })),
    }
}

/// (a8), with gains that suit a mass of about a kilogram.
fn position_only(file: &PositionOnlyFile, agent: &str, robot: &RobotSetup) -> Result<Arc<dyn Law>, Fault> {
    let PositionOnlyFile { damping, filter_per_s, adaptation_gain, estimate_start_kg } = file;
    if !robot.kind.is::<PointMass>() {
        return Err(of_another("position_only", "point masses", agent, robot));
    }
    Ok(Arc::new(PositionOnlyLaw {
        damping: positive_or("damping", damping, DAMPING_GAIN)?,
        filter_per_s: positive_or("filter_per_s", filter_per_s, FILTER_PER_S)?,
        adaptation: not_negative_or("adaptation_gain", adaptation_gain, ADAPTATION_GAIN)?,
        estimate_start: estimate_start_kg.as_ref().map_or(0.0, |start| start.value),
    }))
}

pub(super) fn damping(file: Option<&DampingFile>, agent: &str, robot: &RobotSetup) -> Result<Gain, Fault> {
    match file {
        Some(DampingFile::Gain(place)) => gain("damping.gain", &place.value, place, agent, robot.axes.len()),
        Some(DampingFile::BandwidthPerS(bandwidth)) => {
            Ok(Gain::Bandwidth(positive("damping.bandwidth_per_s", bandwidth)?))
        }
        None if is_tree(robot) => Ok(Gain::Bandwidth(DAMPING_BANDWIDTH_PER_S)),
        None => Ok(Gain::Number(DAMPING_GAIN)),
    }
}

pub(super) fn adaptation(file: Option<&At<GainOrBandwidth>>, agent: &str, robot: &RobotSetup) -> Result<Gain, Fault> {
    let Some(place) = file else {
        let (tree, other) = (Gain::Bandwidth(ADAPTATION_BANDWIDTH_PER_S), Gain::Number(ADAPTATION_GAIN));
        return Ok(if is_tree(robot) { tree } else { other });
    };
    match &place.value {
        GainOrBandwidth::Gain(file) => gain("adaptation_gain", file, place, agent, robot.theta.len()),
        GainOrBandwidth::Bandwidth(file) => Ok(Gain::Bandwidth(positive("bandwidth_per_s", &file.bandwidth_per_s)?)),
    }
}

fn is_tree(robot: &RobotSetup) -> bool {
    robot.kind.is::<Arc<Tree>>()
}

/// A gain without a bandwidth, or the usual number.
pub(super) fn gain_or(
    key: &'static str,
    file: &Option<At<GainFile>>,
    usual: f64,
    agent: &str,
    size: usize,
) -> Result<Gain, Fault> {
    file.as_ref().map_or(Ok(Gain::Number(usual)), |place| gain(key, &place.value, place, agent, size))
}

/// Reads a gain and checks that it is symmetric positive definite and of the right size.
pub(super) fn gain<T>(
    key: &'static str,
    file: &GainFile,
    place: &At<T>,
    agent: &str,
    size: usize,
) -> Result<Gain, Fault> {
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

pub(super) fn estimate(file: Option<&EstimateStartFile>, agent: &str, robot: &RobotSetup) -> Result<Vec<f64>, Fault> {
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
