//! `[[agents]]` → [`AgentSetup`]s.

use std::collections::{BTreeSet, HashMap};
use std::ops::Range;

use forwardstep_core::reference::RootSet;
use forwardstep_sim::leader::{Following, Leading as Led};
use forwardstep_sim::reference::{ReferenceDynamics, ReferenceFamily, Roots, Tracking};
use forwardstep_sim::{ActuatorLimits, AgentSetup, PositionKind, RobotSetup};

use super::at::At;
use super::attitude::{never_zero, rotation};
use super::document::{Document, KeyedLaw};
use super::fault::{Fault, count, fault, filled};
use super::file::{AgentFile, ScenarioFile};
use super::inputs::InputFolder;
use super::kinds::{AgentReferenceTable, Kinds, LawReader, ReferenceRead, RobotKind};
use super::notice::Notice;
use super::problem::ScenarioProblem;
use super::robots::{Body, RobotRead, Stop};
use super::roots::roots;
use super::spread::Spread;
use super::start::{FreeStart, Shared, StartReader, reject_unread};
use super::target::{Owner, target};
use super::unused::spare_roots;
use super::value_problem::ValueProblem;
use crate::SourceText;

/// Agents that are accepted.
pub(super) const MOST_AGENTS: u32 = 200_000;
/// Letters that a name may have, without the number that a population adds.
const LONGEST_NAME: usize = 64;

/// An entry of `[[agents]]` with the names that it stands for.
pub(super) struct Population<'a> {
    file: &'a AgentFile,
    names: Vec<String>,
    kind: Box<dyn RobotKind>,
    read: RobotRead,
    law: KeyedLaw,
    /// What it states of its own of its reference dynamics, with their key.
    reference: Option<(&'static str, AgentReferenceTable)>,
}

impl Population<'_> {
    /// The names that it stands for.
    pub(super) fn names(&self) -> &[String] {
        &self.names
    }

    /// What the axes of its robots are called.
    pub(super) fn axis_names(&self) -> Vec<String> {
        axis_names(&self.read.robot)
    }
}

/// All agents, and what else is known about them while a scenario is read.
pub(super) struct Agents {
    pub(super) agents: Vec<AgentSetup>,
    /// Where each agent can be held.
    pub(super) bodies: Vec<Body>,
    /// The entry of `[[agents]]` that stands for each agent.
    pub(super) entries: Vec<usize>,
    /// Counted populations by name, with their members.
    pub(super) populations: Vec<(String, Range<usize>)>,
}

/// What agents are read with.
pub(super) struct Source<'a> {
    pub(super) file: &'a ScenarioFile,
    pub(super) document: &'a Document<'a>,
    pub(super) kinds: &'a Kinds,
    pub(super) text: &'a SourceText,
    pub(super) end_s: f64,
}

/// The entries of `[[agents]]` with their robots; there is one at least.
pub(super) fn populations<'a>(source: &Source<'a>, folder: &mut InputFolder) -> Result<Vec<Population<'a>>, Stop> {
    let Source { file, document, kinds, text, .. } = *source;
    let mut populations: Vec<Population<'_>> = Vec::new();
    let mut seen = HashMap::new();
    let mut total = 0;
    for (number, entry) in filled("agents", &file.agents)?.iter().enumerate() {
        let names = names(&entry.value)?;
        total += names.len() as u64;
        if total > u64::from(MOST_AGENTS) {
            let problem = ScenarioProblem::TooManyAgents { total, most: u64::from(MOST_AGENTS) };
            return Err(fault(&file.agents, problem).into());
        }
        for name in &names {
            if let Some(start) = seen.insert(name.clone(), entry.value.name.span.start) {
                let (first_line, _) = text.line_column(start);
                let problem = ScenarioProblem::AgentTwice { name: name.clone(), first_line };
                return Err(fault(&entry.value.name, problem).into());
            }
        }
        let (usual_law, kind) = document.robot(number, kinds)?;
        let read = kind.read(folder).map_err(|stop| document.in_robot(number, stop))?;
        let law = match document.law(number, kinds)? {
            Some(law) => law,
            None => kinds.usual_law(usual_law).map_err(|fault| fault.at(&entry.value.robot.span))?,
        };
        let reference = document.agent_reference(number, kinds)?;
        let population = Population { file: &entry.value, names, kind, read, law, reference };
        if let Some(first) = populations.first() {
            same_axes(first, &population)?;
        }
        populations.push(population);
    }
    Ok(populations)
}

/// Builds all agents, in the order of the file.
pub(super) fn agents(
    source: &Source<'_>,
    populations: &[Population<'_>],
    reference: &Leading,
    folder: &mut InputFolder,
    notices: &mut Vec<Notice>,
) -> Result<Agents, Stop> {
    let file = source.file;
    let of = populations.iter().map(|population| population.names.len()).sum();
    let mut read =
        Agents { agents: Vec::with_capacity(of), bodies: Vec::new(), entries: Vec::new(), populations: Vec::new() };
    let mut asked = BTreeSet::new();
    for (number, population) in populations.iter().enumerate() {
        let Population { file: entry, names, .. } = population;
        let span = match names.as_slice() {
            [first, .., last] => format!("{first} … {last}"),
            _ => names.concat(),
        };
        notices.extend(
            (population.read.notices.iter().cloned())
                .map(|notice| Notice::Robot { agents: span.clone(), notice: Box::new(notice) }),
        );
        let first = read.agents.len();
        if entry.count.is_some() {
            read.populations.push((entry.name.value.clone(), first..first + names.len()));
        }
        let enforce_limits = limits(population)?;
        // Who has no law of its own shares that of all.
        let shares = |other: &&Population<'_>| match entry.law {
            Some(_) => std::ptr::eq(*other, population),
            None => other.file.law.is_none(),
        };
        let sharing: Vec<&RobotSetup> =
            populations.iter().filter(shares).map(|population| &population.read.robot).collect();
        for index in 0..names.len() {
            let member = Member { population, index, first, of, sharing: &sharing };
            let (agent, body) = member.read(source, reference, folder, enforce_limits, &mut asked)?;
            read.agents.push(agent);
            read.bodies.push(body);
            read.entries.push(number);
        }
    }
    if let (Some(start), Some(first)) = (&file.start, read.agents.first()) {
        reject_unread(&start.value, &asked, &first.name)?;
    }
    if reference.read.dynamics.interface().roots == Roots::ByLaw {
        let stated = populations.iter().map(|population| {
            let stated = population.reference.as_ref().is_some_and(|(_, own)| own.roots_per_s.is_some());
            (population.names.len(), stated)
        });
        spare_roots(&mut read.agents, stated);
    }
    Ok(read)
}

/// One agent of a population.
struct Member<'a> {
    population: &'a Population<'a>,
    /// Its place in the population.
    index: usize,
    /// The number of agents before the population, and of all.
    first: usize,
    of: usize,
    /// The robots under the same table of a law.
    sharing: &'a [&'a RobotSetup],
}

impl Member<'_> {
    fn read(
        &self,
        &Source { file, kinds, end_s, .. }: &Source<'_>,
        reference: &Leading,
        folder: &mut InputFolder,
        enforce_limits: bool,
        asked: &mut BTreeSet<&'static str>,
    ) -> Result<(AgentSetup, Body), Fault> {
        let Member { population, index, first, of, sharing } = *self;
        let Population { file: entry, names, kind, read, law, .. } = population;
        let name = &names[index];
        let mut read = read.clone();
        if let Some(spread) = Spread::of(entry, name, index)? {
            kind.spread(&mut read, &spread).map_err(|fault| fault.at(&entry.robot.span))?;
        }
        let RobotRead { robot, body, .. } = read;
        let Design { roots_per_s, manipulability, free_start } = design(reference, population, (first + index, name))?;
        let place = entry.law.as_ref().or(file.law.as_ref()).map_or(&entry.robot.span, |law| &law.span);
        let law = kinds.build(law, &LawReader { agent: name, robot: &robot, body: &body, sharing });
        let law = law.map_err(|fault| fault.at(place))?;
        // Where something else than its axes follows the target, the law names it.
        let coordinates = law.interface(&robot).and_then(|law| law.coordinates);
        let turns = robot.interface().position == PositionKind::UnitQuaternion;
        let quaternion = coordinates.as_ref().map_or(turns.then_some(0), |named| named.quaternion);
        let axes = coordinates.map_or_else(|| axis_names(&robot), |named| named.names);
        let owner = Owner { name, axes: &axes, quaternion, end_s };
        let target = entry.target.as_ref().map(|file| target(file, &owner, folder)).transpose()?;
        let own = entry.start.as_ref().map(|file| Shared { file, index, of: names.len() });
        let common = file.start.as_ref().map(|file| Shared { file, index: first + index, of });
        let mut given = StartReader::new(name, &robot, free_start, own, common);
        let mut start = kind.start(&robot, &mut given)?;
        if let (Some(target), Some(place), Some(first)) = (&target, &entry.target, quaternion)
            && let Some(attitude) = target.quaternion(first)
        {
            never_zero(place, &attitude, end_s)?;
            if turns {
                rotation(&mut start, target, given.rotation());
            }
        }
        given.reject_unused()?;
        asked.extend(given.asked());
        let agent = AgentSetup {
            law,
            start,
            robot,
            roots_per_s,
            manipulability,
            enforce_limits,
            target,
            pushes: Vec::new(),
            name: name.clone(),
        };
        Ok((agent, body))
    }
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
fn limits(population: &Population<'_>) -> Result<bool, Fault> {
    let Population { file, names, read, .. } = population;
    let Some(place @ At { value: true, .. }) = &file.enforce_limits else { return Ok(false) };
    let unlimited = || read.robot.axes.iter().find(|axis| axis.effort_limit.is_none());
    match unlimited().filter(|_| read.robot.interface().actuator_limits != ActuatorLimits::Own) {
        None => Ok(true),
        Some(axis) => {
            let (agent, axis) = (names.first().cloned().unwrap_or_default(), axis.name.clone());
            Err(fault(place, ScenarioProblem::NoEffortLimit { agent, axis }))
        }
    }
}

/// What one agent's reference dynamics are made of.
struct Design {
    roots_per_s: RootSet,
    manipulability: f64,
    /// What a start may say of it.
    free_start: FreeStart,
}

/// The reference dynamics of all agents, as they were read.
pub(super) struct Leading {
    pub(super) key: &'static str,
    pub(super) read: ReferenceRead,
    /// Whether agents may state roots of their own.
    pub(super) own_roots: bool,
    /// Where they stand.
    pub(super) span: Range<usize>,
}

/// The agent's own roots and gain, else those of all.
fn design(reference: &Leading, population: &Population<'_>, (index, agent): (usize, &str)) -> Result<Design, Fault> {
    let Leading { key, read, own_roots, span } = reference;
    let leads = read.dynamics.downcast().is_some_and(|following: &Following| following.leader == Led::Agent(index));
    // Who leads follows a target, and has nothing in common with those that follow.
    let (dynamics, roots_of_all, gain_of_all): (&dyn ReferenceDynamics, _, _) = if leads {
        (&Tracking, None, None)
    } else {
        (&*read.dynamics, read.roots_per_s.as_ref(), read.manipulability_gain.as_ref())
    };
    let (common, own_roots) = if leads { (dynamics.words().key, true) } else { (*key, *own_roots) };
    let interface = dynamics.interface();
    let own = population.reference.as_ref();
    if let (Some(_), Some(at)) = (own.filter(|(key, _)| *key != common), &population.file.reference) {
        let problem = ScenarioProblem::ReferenceDiffers { agent: agent.to_owned(), common, own_roots };
        return Err(fault(at, problem));
    }
    let own = own.map(|(_, own)| own);
    let list = own.and_then(|own| own.roots_per_s.as_ref()).or(roots_of_all);
    let roots_per_s = match list {
        Some(list) => roots(list)?,
        None if interface.roots == Roots::Every => {
            return Err(Fault::new(ScenarioProblem::NoRoots { agent: agent.to_owned(), common }).at(span));
        }
        None => RootSet::default(),
    };
    let own_gain = own.and_then(|own| own.manipulability_gain.as_ref());
    if let (Some(gain), false) = (own_gain, interface.manipulability) {
        let problem = ValueProblem::UnknownKey { key: "manipulability_gain".into(), allowed: vec!["roots_per_s"] };
        return Err(fault(gain, problem));
    }
    let manipulability = own_gain.or(gain_of_all).map_or(0.0, |gain| gain.value);
    let free_start = match interface.family {
        ReferenceFamily::Backstepping => FreeStart::Filter,
        ReferenceFamily::Consensus
        | ReferenceFamily::PureIntegral
        | ReferenceFamily::Leader
        | ReferenceFamily::Target
        | ReferenceFamily::Desired
        | ReferenceFamily::DesiredTarget
        | ReferenceFamily::Own => FreeStart::Derivatives(dynamics.free_derivatives(roots_per_s.len())),
    };
    Ok(Design { free_start, roots_per_s, manipulability })
}
