//! `start` → [`Start`].

use std::ops::Range;

use forwardstep_sim::{AxisUnit, ChainModel, Robot, RobotSetup, RotorcraftModel, SpacecraftModel, Start, VehicleModel};

use super::at::At;
use super::fault::{Fault, fault, length, seed, values};
use super::file::StartFile;
use super::problem::ScenarioProblem;
use super::random::{Stream, draws};
use super::spacecraft;
use super::system_problem::SystemProblem;
use super::value_problem::ValueProblem;
use super::values::{Item, RandomFile, StartValues};
use super::vehicle;

/// The `start` of one agent with the position of the agent among those that share it.
#[derive(Clone, Copy)]
pub(super) struct Shared<'a> {
    pub(super) file: &'a At<StartFile>,
    /// The agent's index among those that share this table.
    pub(super) index: usize,
    /// How many share it.
    pub(super) of: usize,
}

/// The agent that starts.
#[derive(Clone, Copy)]
pub(super) struct Starter<'a> {
    pub(super) name: &'a str,
    pub(super) robot: &'a RobotSetup,
    pub(super) order: usize,
}

/// A key of the start table and the unit that all axes must have for it.
type Key<'a> = (&'static str, Option<AxisUnit>, &'a Option<At<StartValues>>);

/// Takes each quantity from the agent's own table, else from the scenario's, else zero.
pub(super) fn start(agent: Starter<'_>, own: Option<Shared<'_>>, common: Option<Shared<'_>>) -> Result<Start, Fault> {
    use AxisUnit::{Metre, Radian};
    let tables = || [own, common].into_iter().flatten();
    own.map_or(Ok(()), |own| agent.all_counts(&own.file.value))?;
    if let Some(SpacecraftModel { wheels, .. }) = agent.robot.kind.downcast() {
        return spacecraft::start(tables().map(|table| &table.file.value), agent.name, wheels);
    }
    let quantity = |stream, keys: fn(&StartFile) -> [Key<'_>; 3]| {
        for table in tables() {
            if let Some(found) = agent.one_of(table, stream, keys(&table.file.value))? {
                return Ok(found);
            }
        }
        Ok(vec![0.0; agent.length(stream)])
    };
    let q = quantity(Stream::Position, |file| {
        [
            ("position_rad", Some(Radian), &file.position_rad),
            ("position_m", Some(Metre), &file.position_m),
            ("position", None, &file.position),
        ]
    })?;
    let dq = quantity(Stream::Velocity, |file| {
        [
            ("velocity_rad_s", Some(Radian), &file.velocity_rad_s),
            ("velocity_m_s", Some(Metre), &file.velocity_m_s),
            ("velocity", None, &file.velocity),
        ]
    })?;
    let rest = match (
        agent.robot.kind.is::<ChainModel>(),
        tables().find_map(|table| Some((table, table.file.value.higher_states.as_ref()?))),
    ) {
        (true, None) => vec![0.0; agent.length(Stream::Higher)],
        (_, Some((table, values))) => agent.vector("higher_states", values, table, Stream::Higher)?,
        _ => vehicle::rest(agent.robot, tables().map(|table| &table.file.value))?,
    };
    let mut reference = Vec::new();
    if let Some((table, state)) = tables().find_map(|table| Some((table, table.file.value.reference.as_ref()?))) {
        let derivatives = &state.value.derivatives;
        let z = state.value.z.as_ref().map(|z| agent.vector("z", z, table, Stream::Reference(0))).transpose()?;
        reference.push(z.unwrap_or_else(|| agent.led(&q, &dq, &rest)));
        for (k, derivative) in derivatives.iter().enumerate() {
            if k + 1 >= agent.order {
                let (found, name) = (derivatives.len(), agent.name.to_owned());
                let problem = ScenarioProblem::Derivatives { found, agent: name, order: agent.order };
                return Err(fault(derivative, problem));
            }
            reference.push(agent.vector("derivatives", derivative, table, Stream::Reference(k + 1))?);
        }
    }
    Ok(Start { q, dq, rest, reference })
}

impl Starter<'_> {
    /// Refuses what an agent's own table says in vain. (The one of all may speak to others, see `unused`.)
    fn all_counts(&self, own: &StartFile) -> Result<(), Fault> {
        match unread(self.robot, own).into_iter().next() {
            None => Ok(()),
            Some((key, span)) => {
                let agent = self.name.to_owned();
                Err(Fault::new(SystemProblem::StartUnused { key, agent }).at(&span))
            }
        }
    }

    /// Numbers in one of its quantities.
    fn length(&self, stream: Stream) -> usize {
        length_of(self.robot, stream)
    }

    /// What z follows, at the start.
    fn led(&self, q: &[f64], dq: &[f64], rest: &[f64]) -> Vec<f64> {
        match self.robot.kind.downcast() {
            Some(ChainModel::Cascade(_)) => q.to_vec(),
            Some(ChainModel::Derivatives(_)) => [q, dq, rest].concat().last().map(|top| vec![*top]).unwrap_or_default(),
            None => dq.to_vec(),
        }
    }

    fn one_of(&self, table: Shared<'_>, stream: Stream, keys: [Key<'_>; 3]) -> Result<Option<Vec<f64>>, Fault> {
        let any = keys[2].0;
        let mut given = keys.into_iter().filter_map(|(key, unit, value)| Some((key, unit, value.as_ref()?)));
        let Some((key, unit, value)) = given.next() else { return Ok(None) };
        if let Some((second, _, place)) = given.next() {
            return Err(fault(place, ValueProblem::SameQuantity { first: key, second }));
        }
        if let Some(unit) = unit
            && let Some(axis) = self.robot.axes.iter().find(|axis| axis.unit != unit)
        {
            let unit = match axis.unit {
                AxisUnit::Radian => "rad",
                AxisUnit::Metre => "m",
                AxisUnit::One => "pure numbers",
            };
            let (agent, axis) = (self.name.to_owned(), axis.name.clone());
            return Err(fault(value, ScenarioProblem::Unit { key, agent, axis, unit, any }));
        }
        self.vector(key, value, table, stream).map(Some)
    }

    fn vector(
        &self,
        key: &'static str,
        value: &At<StartValues>,
        table: Shared<'_>,
        stream: Stream,
    ) -> Result<Vec<f64>, Fault> {
        let need = self.length(stream);
        let length = |found: usize, place: &Range<usize>| length(key, place, found, need, self.name);
        let rows = match &value.value {
            StartValues::Random(random) => return draw(random, stream, table.index, need),
            StartValues::Rows(rows) => rows,
        };
        let lists: Vec<_> = rows.iter().filter(|row| matches!(row.value, Item::List(_))).collect();
        if lists.is_empty() {
            length(rows.len(), &value.span)?;
            return Ok(rows.iter().filter_map(|row| row.value.number()).collect());
        }
        if lists.len() != rows.len() {
            return Err(fault(value, ValueProblem::MixedList { key }));
        }
        if rows.len() != table.of {
            return Err(fault(value, ValueProblem::ListPerAgent { key, found: rows.len(), agents: table.of }));
        }
        match rows.get(table.index).map(|row| (&row.value, &row.span)) {
            Some((Item::List(list), span)) => {
                length(list.len(), span)?;
                Ok(values(list))
            }
            _ => Ok(vec![0.0; need]),
        }
    }
}

/// Numbers in one quantity of a robot's start.
fn length_of(robot: &RobotSetup, stream: Stream) -> usize {
    match (robot.kind.downcast::<ChainModel>(), stream) {
        (Some(chain), Stream::Velocity) if !chain.has_velocity() => 0,
        (Some(chain), Stream::Higher) => chain.rest_len(),
        (None, Stream::Higher) => 0,
        _ => robot.axes.len(),
    }
}

/// The keys of a table that say nothing about a robot, and where they stand.
pub(super) fn unread(robot: &RobotSetup, table: &StartFile) -> Vec<(&'static str, Range<usize>)> {
    let craft = robot.kind.is::<SpacecraftModel>();
    let spins = craft || robot.kind.is::<RotorcraftModel>();
    let turns = spins || robot.kind.is::<VehicleModel>();
    let moves = !craft && length_of(robot, Stream::Velocity) > 0;
    let chain = length_of(robot, Stream::Higher) > 0;
    let span = |values: &Option<At<StartValues>>| values.as_ref().map(|values| values.span.clone());
    let all = [
        ("position_rad", !craft, span(&table.position_rad)),
        ("position_m", !craft, span(&table.position_m)),
        ("position", !craft, span(&table.position)),
        ("velocity_rad_s", moves, span(&table.velocity_rad_s)),
        ("velocity_m_s", moves, span(&table.velocity_m_s)),
        ("velocity", moves, span(&table.velocity)),
        ("attitude", turns, table.attitude.as_ref().map(|attitude| attitude.span.clone())),
        ("angular_velocity_rad_s", spins, table.angular_velocity_rad_s.as_ref().map(|rate| rate.span.clone())),
        ("spacecraft", craft, table.spacecraft.as_ref().map(|craft| craft.span.clone())),
        ("higher_states", chain, span(&table.higher_states)),
        ("reference", !craft, table.reference.as_ref().map(|reference| reference.span.clone())),
    ];
    all.into_iter().filter(|(_, counts, _)| !counts).filter_map(|(key, _, span)| Some((key, span?))).collect()
}

/// One number per axis, drawn uniformly.
fn draw(random: &RandomFile, stream: Stream, index: usize, length: usize) -> Result<Vec<f64>, Fault> {
    let [low, high] = random.within.value;
    if low > high {
        return Err(fault(&random.within, ValueProblem::Interval { key: "within", low, high }));
    }
    let units = draws(seed(&random.seed)?, stream, index, length);
    Ok(units.map(|unit| low * (1.0 - unit) + high * unit).collect())
}
