//! What columns, axes and units are called, everywhere: in tables, plots and messages.
//!
//! A column is called `<agent>.<signal>.<axis>`: [`Signal::name`], and the joint's name for arms, a number from one for
//! point masses, the parameter's name for `theta_hat`; `lyapunov` and `dissipation` have no axis part.

use std::collections::{BTreeSet, HashSet};

use forwardstep_core::signal::{Entries, Unit};
use forwardstep_sim::recording::{Recording, Signal};
use forwardstep_sim::{ActuatorLimits, AgentSetup, AxisUnit, ChainModel, ClippedSamples, RotorcraftModel, Setup};

use super::leader::LeaderColumn;

/// The name of an agent; a number when the setup has no such agent.
pub fn agent_name(setup: &Setup, agent: usize) -> String {
    setup.agents.get(agent).map_or_else(|| format!("agent-{}", agent + 1), |a| a.name.clone())
}

/// How many commands limits changed; `None` where there are no limits that change any.
pub fn clipped_words(setup: &Setup, clipped: ClippedSamples) -> Option<String> {
    let ClippedSamples { samples, torque, rate } = clipped;
    let by_itself = limits_by_itself(setup);
    let actuators = &setup.control.as_ref()?.actuators;
    let limited = actuators.torque_limit.is_some() || actuators.torque_rate_limit.is_some();
    if torque + rate > 0 {
        return Some(format!("{torque} by limits of torque, {rate} by limits of rate, of {samples} samples"));
    }
    match (by_itself, limited || setup.agents.iter().any(|agent| agent.enforce_limits)) {
        (true, _) => {
            Some(format!("none of {samples} samples by the controllers; what wheels and rotors limit is not counted"))
        }
        (false, true) => Some(format!("none of {samples} samples")),
        (false, false) => None,
    }
}

/// Whether an agent has actuators with limits of their own, wheels or rotors, of which controllers know nothing.
pub(crate) fn limits_by_itself(setup: &Setup) -> bool {
    setup.agents.iter().any(|agent| {
        let wheels = agent.enforce_limits && agent.robot.interface().actuator_limits == ActuatorLimits::Own;
        wheels || agent.robot.kind.downcast().is_some_and(|model: &RotorcraftModel| model.rotors.is_some())
    })
}

/// A reason that [`forwardstep_check`] gives, which knows agents by their number, with their names.
pub fn reason(setup: &Setup, error: &dyn std::error::Error) -> String {
    const NUMBERED: &str = "agent number ";
    let said = error.to_string();
    let mut parts = said.split(NUMBERED);
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |named, part| {
        let digits = part.find(|c: char| !c.is_ascii_digit()).unwrap_or(part.len());
        let (number, rest) = part.split_at(digits);
        match number.parse::<usize>().ok().and_then(|number| setup.agents.get(number.checked_sub(1)?)) {
            Some(agent) => format!("{named}{}{rest}", agent.name),
            None => format!("{named}{NUMBERED}{part}"),
        }
    })
}

/// More agents are not named one by one.
const MOST_NAMES: usize = 8;

/// Agents by name, as many as are read.
pub fn some_names(setup: &Setup, agents: &[usize]) -> String {
    let names: Vec<String> = agents.iter().take(MOST_NAMES).map(|agent| agent_name(setup, *agent)).collect();
    match agents.len().saturating_sub(MOST_NAMES) {
        0 => names.join(", "),
        more => format!("{}, and {more} more", names.join(", ")),
    }
}

/// The name of an axis of an agent: the joint's name for arms, a number from one for point masses.
pub fn axis_name(setup: &Setup, agent: usize, axis: usize) -> String {
    let robot = setup.agents.get(agent).map(|a| &a.robot);
    match robot {
        Some(robot) if !robot.interface().numbered_axes => robot.axes.get(axis).map(|a| a.name.clone()),
        _ => None,
    }
    .unwrap_or_else(|| (axis + 1).to_string())
}

/// The name of an axis in running text: `elbow_joint`, or `axis 2` where it has a number only.
pub fn axis_words(setup: &Setup, agent: usize, axis: usize) -> String {
    in_words(&axis_name(setup, agent, axis))
}

/// What is agreed upon.
pub(crate) fn value_words(setup: &Setup) -> &'static str {
    if setup.agents.iter().any(|agent| agent.target.is_some()) { "Value less offsets" } else { "Value" }
}

/// The name of the axis of a torque in running text; that of a rotorcraft turns its body.
pub fn torque_words(setup: &Setup, agent: usize, axis: usize) -> String {
    if turns(setup, agent) {
        return format!("body axis {}", axis_name(setup, agent, axis));
    }
    axis_words(setup, agent, axis)
}

/// What an entry of what is to vanish is called in all agents that have it, or its number.
pub fn gap_words(setup: &Setup, entry: usize) -> String {
    let signal = gap_signal(setup);
    let owners = (0..setup.agents.len()).filter(|agent| entry < setup.agents[*agent].robot.axes.len());
    let words = |agent| entry_name(setup, agent, signal, entry).unwrap_or_default();
    shared(owners.map(words)).map_or_else(|| format!("axis {}", entry + 1), |name| in_words(&name))
}

/// The name of an axis if all agents that have it agree, its number otherwise, for headings.
pub(crate) fn shared_axis_words(setup: &Setup, axis: usize) -> String {
    shared_words(setup, axis, axis_words)
}

/// The same of other words for an axis.
pub(crate) fn shared_words(setup: &Setup, axis: usize, words: impl Fn(&Setup, usize, usize) -> String) -> String {
    let owners = (0..setup.agents.len()).filter(|agent| axis < setup.agents[*agent].robot.axes.len());
    shared(owners.map(|agent| words(setup, agent, axis))).unwrap_or_else(|| format!("axis {}", axis + 1))
}

/// The one name that all have, if there is one.
pub(crate) fn shared(mut names: impl Iterator<Item = String>) -> Option<String> {
    let first = names.next()?;
    names.all(|name| name == first).then_some(first)
}

/// `elbow_joint`, or `axis 2` for a number.
fn in_words(name: &str) -> String {
    if name.bytes().all(|b| b.is_ascii_digit()) { format!("axis {name}") } else { name.to_owned() }
}

/// The name of a parameter of an agent.
pub fn parameter_name(setup: &Setup, agent: usize, index: usize) -> String {
    setup
        .agents
        .get(agent)
        .and_then(|a| a.robot.theta_names.get(index).cloned())
        .unwrap_or_else(|| (index + 1).to_string())
}

/// What controllers ask for, in one word and in many: torques about axes, forces along them, or inputs without either.
pub fn input_words(setup: &Setup) -> (&'static str, &'static str) {
    let axes = |agent: usize| 0..setup.agents.get(agent).map_or(0, |agent| agent.robot.axes.len());
    let all = (0..setup.agents.len()).flat_map(|agent| axes(agent).map(move |axis| (agent, axis)));
    let units: BTreeSet<String> = all.map(|(agent, axis)| unit(setup, agent, Signal::Torque, axis)).collect();
    match units.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["N"] => ("force", "Forces"),
        ["N", "N m"] => ("torque or force", "Torques and forces"),
        [] | ["N m"] => ("torque", "Torques"),
        _ => ("input", "Inputs"),
    }
}

/// The same of what acts from outside of the law, and what that is.
pub(crate) fn external_words(
    setup: &Setup,
    acted_on: impl Iterator<Item = (usize, usize)>,
) -> (&'static str, &'static str) {
    let pushes = setup.agents.iter().any(|agent| !agent.pushes.is_empty());
    let drives = setup.agents.iter().map(|agent| agent.robot.interface().drives);
    let rubs = drives.into_iter().any(|drives| drives.dry_s.is_some() && !drives.friction.is_empty());
    match (pushes, rubs) {
        (false, true) => ("Dry friction", "τ_ext, by the joints themselves"),
        (true, true) => (push_words(setup, acted_on), "τ_ext, by pushes and dry friction"),
        (_, false) => (push_words(setup, acted_on), "τ_ext, by pushes"),
    }
}

fn push_words(setup: &Setup, pushed: impl Iterator<Item = (usize, usize)>) -> &'static str {
    let units: BTreeSet<String> = pushed.map(|(agent, axis)| unit(setup, agent, Signal::External, axis)).collect();
    match units.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["N"] => "External forces",
        ["N m"] => "External torques",
        ["1"] => "External inputs",
        _ => "External torques and forces",
    }
}

/// What an entry of a signal is called; nothing for signals with a single entry.
pub fn entry_name(setup: &Setup, agent: usize, signal: Signal, entry: usize) -> Option<String> {
    let number = || (entry + 1).to_string();
    let coordinates = || setup.agents.get(agent)?.interface()?.coordinates;
    Some(match signal.row().entries {
        Entries::One => return None,
        Entries::Axes => axis_name(setup, agent, entry),
        Entries::Parameters => parameter_name(setup, agent, entry),
        Entries::Numbered(_) => number(),
        Entries::Named(names) => names.get(entry).map_or_else(number, |name| (*name).to_owned()),
        Entries::Coordinates => match coordinates() {
            Some(of) => of.names.get(entry).cloned().unwrap_or_else(number),
            None => axis_name(setup, agent, entry),
        },
        Entries::CoordinateParameters => {
            coordinates().and_then(|of| of.parameters.get(entry).cloned()).unwrap_or_else(number)
        }
    })
}

/// An entry of a signal in running text: `elbow_joint`, `axis 2` or `wheel 3`; nothing for signals with a single entry.
pub fn entry_words(setup: &Setup, agent: usize, signal: Signal, entry: usize) -> String {
    match signal.row().entries {
        Entries::Numbered(what) => format!("{what} {}", entry + 1),
        _ => entry_name(setup, agent, signal, entry).as_deref().map(in_words).unwrap_or_default(),
    }
}

/// The name of a recorded column.
pub fn column_name(setup: &Setup, agent: usize, signal: Signal, axis: usize) -> String {
    let (agent_name, signal_name) = (agent_name(setup, agent), signal.name());
    match entry_name(setup, agent, signal, axis) {
        Some(entry) => format!("{agent_name}.{signal_name}.{entry}"),
        None => format!("{agent_name}.{signal_name}"),
    }
}

/// The names of all columns of a table, `t_s` first and those of a leader that is no agent last. Should two be the same, later
/// ones get a `~2`, `~3`, … at the end, because tables need distinct names.
pub fn table_header(setup: &Setup, recording: &Recording) -> Vec<String> {
    let mut taken = HashSet::new();
    let recorded = recording.columns.iter().map(|c| column_name(setup, c.agent, c.signal, c.axis));
    let leads = LeaderColumn::all(setup).into_iter().map(|column| column.name);
    let mut header = Vec::new();
    for plain in std::iter::once("t_s".to_owned()).chain(recorded).chain(leads) {
        let mut name = plain.clone();
        let mut copy = 2;
        while !taken.insert(name.clone()) {
            name = format!("{plain}~{copy}");
            copy += 1;
        }
        header.push(name);
    }
    header
}

/// The unit of an axis of an agent, if the setup has it.
pub fn axis_unit(setup: &Setup, agent: usize, axis: usize) -> Option<AxisUnit> {
    setup.agents.get(agent)?.robot.axes.get(axis).map(|a| a.unit)
}

/// Whether the torques of an agent act about the axes of its body.
fn turns(setup: &Setup, agent: usize) -> bool {
    setup.agents.get(agent).is_some_and(|agent| agent.robot.interface().torques_on_body)
}

/// What is to vanish: distances from targets, or between agents.
fn gap_signal(setup: &Setup) -> Signal {
    if setup.all_track() { Signal::Error } else { Signal::Position }
}

/// The unit of what is to vanish in a run: of the distances between agents, or from their targets. Nothing for pure numbers;
/// `rad or m` where agents differ.
pub fn gap_unit(setup: &Setup) -> String {
    let signal = gap_signal(setup);
    // Redundant joints are more than the coordinates that follow.
    let entries = |agent: &AgentSetup| match agent.interface().and_then(|law| law.coordinates) {
        Some(of) if signal == Signal::Error => of.units.len(),
        _ => agent.robot.axes.len(),
    };
    let axes = |agent: usize| 0..setup.agents.get(agent).map_or(0, entries);
    let all = (0..setup.agents.len()).flat_map(|agent| axes(agent).map(move |axis| (agent, axis)));
    let units: BTreeSet<String> = all.map(|(agent, axis)| unit(setup, agent, signal, axis)).collect();
    let units: Vec<&str> = units.iter().map(String::as_str).collect();
    match units.as_slice() {
        [] | ["1"] => String::new(),
        [one] => (*one).to_owned(),
        ["1", "m"] => "m or 1".into(),
        _ => "rad or m".into(),
    }
}

/// The units that a signal has over all agents and axes, in words; nothing where any has none.
pub fn units(setup: &Setup, signal: Signal) -> String {
    let axes = |agent: usize| 0..setup.agents.get(agent).map_or(0, |agent| agent.robot.axes.len());
    let all = (0..setup.agents.len()).flat_map(|agent| axes(agent).map(move |axis| (agent, axis)));
    let units: BTreeSet<String> = all.map(|(agent, axis)| unit(setup, agent, signal, axis)).collect();
    if units.contains("") { String::new() } else { Vec::from_iter(units).join(" or ") }
}

/// The same of one axis of an agent, where others may have another unit.
pub fn gap_unit_on(setup: &Setup, agent: usize, axis: usize) -> String {
    let unit = unit(setup, agent, gap_signal(setup), axis);
    if unit == "1" { String::new() } else { unit }
}

/// The derivative of the position of a chain that z leads: the last one that is no input, and of a chain in feedback form the position.
fn followed(setup: &Setup, agent: usize) -> usize {
    match setup.agents.get(agent).and_then(|agent| agent.robot.kind.downcast()) {
        Some(model @ (ChainModel::Derivatives(_) | ChainModel::Vector(_))) => model.order().saturating_sub(1),
        Some(ChainModel::Cascade(_)) => 0,
        None => 1,
    }
}

/// The unit of a recorded column, for example `rad/s^2`; `SI` for parameters, whose units differ.
pub fn unit(setup: &Setup, agent: usize, signal: Signal, axis: usize) -> String {
    let own = axis_unit(setup, agent, axis);
    // A chain has all of its axes, and all that is recorded of it, in units of its own; but a signal of one's own says what it is in.
    if axis_unit(setup, agent, 0) == Some(AxisUnit::Own) {
        if let (Signal::Own(_), Unit::Fixed(unit)) = (signal, signal.row().unit) {
            return unit.into();
        }
        let derivative = match (signal, signal.row().unit) {
            (Signal::Reference(r), _) => followed(setup, agent) + usize::from(r),
            (Signal::TrackingError, _) => followed(setup, agent),
            (_, Unit::Axis(k)) => usize::from(k),
            _ => 0,
        };
        return match derivative {
            0 => "1".into(),
            1 => "1/s".into(),
            k => format!("1/s^{k}"),
        };
    }
    let letters = |unit: Option<AxisUnit>| match unit {
        Some(AxisUnit::Metre) => "m",
        Some(AxisUnit::One | AxisUnit::Own) => "1",
        Some(AxisUnit::Radian) | None => "rad",
    };
    // Rates of an attitude are those of angles.
    let length = if own == Some(AxisUnit::Metre) { "m" } else { "rad" };
    match signal.row().unit {
        Unit::Fixed(unit) => unit.into(),
        Unit::Axis(0) => letters(own).into(),
        Unit::Axis(1) => format!("{length}/s"),
        Unit::Axis(k) => format!("{length}/s^{k}"),
        Unit::Target => {
            let coordinates = setup.agents.get(agent).and_then(|agent| agent.interface()?.coordinates);
            letters(coordinates.map_or(own, |of| of.units.get(axis).copied())).into()
        }
        Unit::Torque if turns(setup, agent) => "N m".into(),
        Unit::Torque | Unit::Effort if length == "m" => "N".into(),
        Unit::Torque | Unit::Effort => "N m".into(),
        Unit::Volume => match setup.agents.get(agent).map_or(0, |agent| agent.robot.axes.len()) {
            0 | 1 => "m".into(),
            m => format!("m^{m}"),
        },
    }
}
