//! `[[agents]]` → [`AgentSetup`]s.

use std::collections::HashMap;
use std::ops::Range;
use std::rc::Rc;

use forwardstep_core::robot::PlanarTip;
use forwardstep_core::robot::tree::Anchor;
use forwardstep_sim::{AgentSetup, RobotSetup, SpacecraftModel};

use super::at::At;
use super::fault::{Fault, count, fault, filled, positive};
use super::file::{AgentFile, AgentReferenceFile, ReferenceFile, ScenarioFile};
use super::inputs::InputFolder;
use super::law::law;
use super::leader_file::LeaderDesignFile;
use super::notice::Notice;
use super::problem::ScenarioProblem;
use super::robots::{ReadRobot, Stop, robot};
use super::spacecraft::{points_somewhere, short_way};
use super::spread::{spread, tip};
use super::start::{Shared, Starter, start};
use super::systems_file::TrackingFile;
use super::target::{Owner, target};
use super::value_problem::ValueProblem;
use crate::SourceText;

/// Agents that are accepted.
const MOST_AGENTS: u32 = 10_000;
/// Letters that a name may have, without the number that a population adds.
const LONGEST_NAME: usize = 64;
/// The highest order of reference dynamics that is accepted.
const MOST_ROOTS: usize = 32;

/// An entry of `[[agents]]` with the names that it stands for.
struct Population<'a> {
    file: &'a AgentFile,
    names: Vec<String>,
    read: ReadRobot,
}

/// All agents, and what else is known about them while a scenario is read.
pub(super) struct Agents {
    pub(super) agents: Vec<AgentSetup>,
    /// Where each agent can be held.
    pub(super) bodies: Vec<Body>,
    /// Counted populations by name, with their members.
    pub(super) populations: Vec<(String, Range<usize>)>,
}

/// Where a robot can be held.
pub(super) struct Body {
    /// The links of a URDF.
    pub(super) links: Rc<[(String, Anchor)]>,
    /// The tip of a planar arm.
    pub(super) tip: Option<PlanarTip>,
}

/// Builds all agents, in the order of the file.
pub(super) fn agents(
    file: &ScenarioFile,
    source: &SourceText,
    folder: &mut InputFolder,
    notices: &mut Vec<Notice>,
    end_s: f64,
) -> Result<Agents, Stop> {
    let mut populations: Vec<Population<'_>> = Vec::new();
    let mut seen = HashMap::new();
    let mut total = 0;
    for entry in filled("agents", &file.agents)? {
        let names = names(&entry.value)?;
        total += names.len() as u64;
        if total > u64::from(MOST_AGENTS) {
            let problem = ScenarioProblem::TooManyAgents { total, most: u64::from(MOST_AGENTS) };
            return Err(fault(&file.agents, problem).into());
        }
        for name in &names {
            if let Some(start) = seen.insert(name.clone(), entry.value.name.span.start) {
                let (first_line, _) = source.line_column(start);
                let problem = ScenarioProblem::AgentTwice { name: name.clone(), first_line };
                return Err(fault(&entry.value.name, problem).into());
            }
        }
        let read = robot(&entry.value.robot, folder)?;
        let population = Population { file: &entry.value, names, read };
        if let Some(first) = populations.first() {
            same_axes(first, &population)?;
        }
        populations.push(population);
    }

    let mut agents = Vec::with_capacity(total as usize);
    let (mut bodies, mut counted) = (Vec::with_capacity(total as usize), Vec::new());
    for Population { file: entry, names, read } in populations {
        let span = match names.as_slice() {
            [first, .., last] => format!("{first} … {last}"),
            _ => names.concat(),
        };
        notices.extend(
            read.notices.iter().cloned().map(|notice| Notice::Robot { agents: span.clone(), notice: Box::new(notice) }),
        );
        let enforce_limits = limits(entry, &names, &read)?;
        let (index, of) = (agents.len(), total as usize);
        if entry.count.is_some() {
            counted.push((entry.name.value.clone(), index..index + names.len()));
        }
        for (k, name) in names.iter().enumerate() {
            let body = Body { links: Rc::clone(&read.links), tip: tip(entry, k)? };
            let robot = &spread(entry, &read.robot, k, name)?;
            let Design { roots_per_s, manipulability, free_derivatives } = design(file, entry, name)?;
            let own = entry.start.as_ref().map(|file| Shared { file, index: k, of: names.len() });
            let common = file.start.as_ref().map(|file| Shared { file, index: index + k, of });
            let law = law(entry.law.as_ref().or(file.law.as_ref()), name, robot, &body)?;
            // Where something else than its axes follows the target, the law names it.
            let axes = law.coordinates().map_or_else(|| axis_names(robot), |named| named.names);
            let owner = Owner { name, axes: &axes, end_s };
            let target = entry.target.as_ref().map(|file| target(file, &owner, folder)).transpose()?;
            let mut start = start(Starter { name, robot, order: free_derivatives }, own, common)?;
            if let (true, Some(target), Some(place)) = (robot.kind.is::<SpacecraftModel>(), &target, &entry.target) {
                points_somewhere(place, target, end_s)?;
                short_way(&mut start, target);
            }
            agents.push(AgentSetup {
                law,
                start,
                robot: robot.clone(),
                roots_per_s,
                manipulability,
                enforce_limits,
                target,
                pushes: Vec::new(),
                name: name.clone(),
            });
            bodies.push(body);
        }
    }
    Ok(Agents { agents, bodies, populations: counted })
}

/// What the axes are called in tables.
pub(super) fn axis_names(robot: &RobotSetup) -> Vec<String> {
    robot.axes.iter().map(|axis| axis.name.clone()).collect()
}

/// A name that can stand in tables.
pub(super) fn checked_name(name: &At<String>) -> Result<&str, Fault> {
    let length = name.value.chars().count();
    if !(1..=LONGEST_NAME).contains(&length)
        || !name.value.chars().all(|c| c.is_alphanumeric() || matches!(c, '-' | '_'))
    {
        return Err(fault(name, ScenarioProblem::AgentName { name: name.value.clone() }));
    }
    Ok(&name.value)
}

/// The names of a population: its own, or numbered from one when it is counted.
pub(super) fn names(file: &AgentFile) -> Result<Vec<String>, Fault> {
    let name = &file.name;
    checked_name(name)?;
    Ok(match &file.count {
        None => vec![name.value.clone()],
        Some(number) => {
            let number = count("count", number, MOST_AGENTS)?;
            (1..=number).map(|k| format!("{}-{k}", name.value)).collect()
        }
    })
}

/// Positions that are to agree need the same length.
fn same_axes(first: &Population<'_>, other: &Population<'_>) -> Result<(), Fault> {
    let (first_axes, other_axes) = (first.read.robot.axes.len(), other.read.robot.axes.len());
    if first_axes == other_axes {
        return Ok(());
    }
    let name = |population: &Population<'_>| population.names.first().cloned().unwrap_or_default();
    let problem = ScenarioProblem::AxesDiffer { first: name(first), first_axes, other: name(other), other_axes };
    Err(fault(&other.file.robot, problem))
}

/// Whether limits are enforced, which needs limits.
fn limits(entry: &AgentFile, names: &[String], read: &ReadRobot) -> Result<bool, Fault> {
    let Some(place @ At { value: true, .. }) = &entry.enforce_limits else { return Ok(false) };
    // The limits of a spacecraft are those of its wheels.
    if read.robot.kind.is::<SpacecraftModel>() {
        return Ok(true);
    }
    match read.robot.axes.iter().find(|axis| axis.effort_limit.is_none()) {
        None => Ok(true),
        Some(axis) => {
            let (agent, axis) = (names.first().cloned().unwrap_or_default(), axis.name.clone());
            Err(fault(place, ScenarioProblem::NoEffortLimit { agent, axis }))
        }
    }
}

/// What one agent's reference dynamics are made of.
struct Design {
    roots_per_s: Vec<f64>,
    manipulability: f64,
    /// How many of z(0), ż(0), … a start may give.
    free_derivatives: usize,
}

/// The agent's own roots, else those of all; not all laws that track need any.
fn tracked(common: &TrackingFile, own: Option<&TrackingFile>) -> Result<Design, Fault> {
    let list = own.and_then(|own| own.roots_per_s.as_ref()).or(common.roots_per_s.as_ref());
    let roots_per_s = match list {
        None => Vec::new(),
        Some(list) => roots(list)?,
    };
    // Without roots there is z alone.
    Ok(Design { free_derivatives: roots_per_s.len().max(1), roots_per_s, manipulability: 0.0 })
}

/// Positive roots, as many as are accepted.
fn roots(list: &At<Vec<At<f64>>>) -> Result<Vec<f64>, Fault> {
    let roots = filled("roots_per_s", list)?;
    if roots.len() > MOST_ROOTS {
        return Err(fault(list, ValueProblem::Order { key: "roots_per_s", found: roots.len(), most: MOST_ROOTS }));
    }
    roots.iter().map(|root| positive("roots_per_s", root)).collect()
}

/// The agent's own roots and gain, else those of all.
fn design(file: &ScenarioFile, entry: &AgentFile, agent: &str) -> Result<Design, Fault> {
    let own = entry.reference.as_ref();
    let (common, own) = match (&file.reference.value, own.map(|own| &own.value)) {
        (ReferenceFile::Consensus(common) | ReferenceFile::PureIntegral(common), None) => (common, None),
        (ReferenceFile::Consensus(common), Some(AgentReferenceFile::Consensus(own)))
        | (ReferenceFile::PureIntegral(common), Some(AgentReferenceFile::PureIntegral(own))) => (common, Some(own)),
        (ReferenceFile::Backstepping(_), None) => {
            return Ok(Design { roots_per_s: Vec::new(), manipulability: 0.0, free_derivatives: 0 });
        }
        (ReferenceFile::Leader(common), None) => {
            let free_derivatives = if common.design.value == LeaderDesignFile::Continuous { 1 } else { 2 };
            return Ok(Design { roots_per_s: Vec::new(), manipulability: 0.0, free_derivatives });
        }
        (ReferenceFile::Tracking(common), None) => return tracked(common, None),
        (ReferenceFile::Tracking(common), Some(AgentReferenceFile::Tracking(own))) => {
            return tracked(common, Some(own));
        }
        (common, Some(_)) => {
            let problem = ScenarioProblem::ReferenceDiffers { agent: agent.to_owned(), common: common.key() };
            let span = own.map_or(0..0, |own| own.span.clone());
            return Err(Fault::new(problem).at(&span));
        }
    };
    let list = own.and_then(|own| own.roots_per_s.as_ref()).or(common.roots_per_s.as_ref());
    let Some(list) = list else {
        return Err(fault(&file.reference, ScenarioProblem::NoRoots { agent: agent.to_owned() }));
    };
    let roots_per_s = roots(list)?;
    if matches!(file.reference.value, ReferenceFile::PureIntegral(_)) && roots_per_s.len() != 2 {
        return Err(fault(list, ScenarioProblem::TwoRoots { found: roots_per_s.len() }));
    }
    let gain = own.and_then(|own| own.manipulability_gain.as_ref()).or(common.manipulability_gain.as_ref());
    let manipulability = match gain {
        None => 0.0,
        Some(gain) if gain.value == 0.0 => 0.0,
        Some(gain) => positive("manipulability_gain", gain)?,
    };
    Ok(Design { free_derivatives: roots_per_s.len(), roots_per_s, manipulability })
}
