//! `start` → [`Start`].

use std::collections::BTreeSet;
use std::ops::Range;

use forwardstep_core::attitude::{IDENTITY, Quaternion};
use forwardstep_sim::{AxisUnit, RobotSetup, Start};

use super::at::At;
use super::attitude::attitude;
use super::fault::{Fault, fault, length, seed, values};
use super::file::{ReferenceStartFile, RotationFile, StartFile};
use super::problem::ScenarioProblem;
use super::random::{Stream, draws};
use super::system_problem::SystemProblem;
use super::value_problem::ValueProblem;
use super::values::{Item, RandomFile, StartValues, Within};

/// The `start` of one agent with the position of the agent among those that share it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shared<'a> {
    pub(super) file: &'a At<StartFile>,
    /// The agent's index among those that share this table.
    pub(super) index: usize,
    /// How many share it.
    pub(super) of: usize,
}

/// What a start may say of reference dynamics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FreeStart {
    /// So many of z(0), ż(0), ….
    Derivatives(usize),
    /// What their filter holds.
    Filter,
}

/// A key of the start table and the unit that all axes must have for it.
type Key<'a> = (&'static str, Option<AxisUnit>, &'a Option<At<StartValues>>);

/// Where an agent starts, quantity by quantity: from its own table, else from that of all agents, else zero. What is not asked
/// for is refused in the agent's own table; that of all may speak to others.
#[derive(Debug)]
pub struct StartReader<'a> {
    name: &'a str,
    robot: &'a RobotSetup,
    /// How many of z(0), ż(0), … may be given, or what a filter holds instead.
    free: FreeStart,
    own: Option<Shared<'a>>,
    common: Option<Shared<'a>>,
    asked: Vec<&'static str>,
}

impl<'a> StartReader<'a> {
    pub(super) fn new(
        name: &'a str,
        robot: &'a RobotSetup,
        free: FreeStart,
        own: Option<Shared<'a>>,
        common: Option<Shared<'a>>,
    ) -> Self {
        StartReader { name, robot, free, own, common, asked: Vec::new() }
    }

    /// The name of the agent.
    pub fn agent(&self) -> &'a str {
        self.name
    }

    /// q(0), a number for every axis: `position_rad`, `position_m` or `position`.
    ///
    /// # Errors
    /// The first mistake, at its place.
    pub fn position(&mut self) -> Result<Vec<f64>, Fault> {
        use AxisUnit::{Metre, Radian};
        self.quantity(Stream::Position, |file| {
            [
                ("position_rad", Some(Radian), &file.position_rad),
                ("position_m", Some(Metre), &file.position_m),
                ("position", None, &file.position),
            ]
        })
    }

    /// q̇(0), a number for every axis: `velocity_rad_s`, `velocity_m_s` or `velocity`.
    ///
    /// # Errors
    /// The first mistake, at its place.
    pub fn velocity(&mut self) -> Result<Vec<f64>, Fault> {
        use AxisUnit::{Metre, Radian};
        self.quantity(Stream::Velocity, |file| {
            [
                ("velocity_rad_s", Some(Radian), &file.velocity_rad_s),
                ("velocity_m_s", Some(Metre), &file.velocity_m_s),
                ("velocity", None, &file.velocity),
            ]
        })
    }

    /// `need` numbers of `higher_states`; none are not asked for.
    ///
    /// # Errors
    /// The first mistake, at its place.
    pub fn higher_states(&mut self, need: usize) -> Result<Vec<f64>, Fault> {
        if need == 0 {
            return Ok(Vec::new());
        }
        self.asked.push("higher_states");
        let given = self.both().find_map(|table| Some((table, table.file.value.higher_states.as_ref()?)));
        given.map_or_else(
            || Ok(vec![0.0; need]),
            |(table, values)| self.vector("higher_states", values, table, Stream::Higher, need),
        )
    }

    /// The `attitude`, upright by default.
    ///
    /// # Errors
    /// The mistake, at its place.
    pub fn attitude(&mut self) -> Result<Quaternion, Fault> {
        let given = self.tables(&["attitude"]).find_map(|table| table.attitude.as_ref());
        given.map_or(Ok(IDENTITY), attitude)
    }

    /// `angular_velocity_rad_s`, in the axes of the body.
    pub fn angular_velocity(&mut self) -> [f64; 3] {
        let given = self.tables(&["angular_velocity_rad_s"]).find_map(|table| table.angular_velocity_rad_s.as_ref());
        given.map_or([0.0; 3], |given| given.value)
    }

    /// z(0), ż(0), … of `reference`, as far as they are given; z(0) is `led` where only derivatives are.
    ///
    /// # Errors
    /// The first mistake, at its place.
    pub fn reference(&mut self, led: &[f64]) -> Result<Vec<Vec<f64>>, Fault> {
        self.asked.push("reference");
        let given = self.both().find_map(|table| Some((table, table.file.value.reference.as_ref()?)));
        let Some((table, state)) = given else { return Ok(Vec::new()) };
        let need = self.robot.axes.len();
        let ReferenceStartFile { z, derivatives, attitude, filter } = &state.value;
        self.no_other("attitude", attitude)?;
        let order = match self.free {
            FreeStart::Filter => {
                self.no_other("z", z)?;
                self.no_other("derivatives", &derivatives.first().cloned())?;
                let filter = filter.as_ref().map(|filter| self.vector("filter", filter, table, Stream::Filter, need));
                return Ok(filter.transpose()?.into_iter().collect());
            }
            FreeStart::Derivatives(order) => order,
        };
        self.no_other("filter", filter)?;
        let z = z.as_ref().map(|z| self.vector("z", z, table, Stream::Reference(0), need)).transpose()?;
        let mut reference = vec![z.unwrap_or_else(|| led.to_vec())];
        for (k, derivative) in derivatives.iter().enumerate() {
            if k + 1 >= order {
                let (found, name) = (derivatives.len(), self.name.to_owned());
                let problem = ScenarioProblem::Derivatives { found, agent: name, order };
                return Err(fault(derivative, problem));
            }
            reference.push(self.vector("derivatives", derivative, table, Stream::Reference(k + 1), need)?);
        }
        Ok(reference)
    }

    /// z(0) of a spacecraft, the quaternion of R_z(0) and y(0), each empty where it is not given.
    ///
    /// # Errors
    /// The first mistake, at its place.
    pub(super) fn attitude_reference(&mut self) -> Result<Vec<Vec<f64>>, Fault> {
        self.asked.push("reference");
        let given = self.both().find_map(|table| Some((table, table.file.value.reference.as_ref()?)));
        let Some((table, state)) = given else { return Ok(Vec::new()) };
        let ReferenceStartFile { z, derivatives, attitude: attitude_z, filter } = &state.value;
        self.no_other("derivatives", &derivatives.first().cloned())?;
        let z = z.as_ref().map(|z| self.vector("z", z, table, Stream::Reference(0), 3)).transpose()?;
        let q_z = attitude_z.as_ref().map(attitude).transpose()?;
        let y = filter.as_ref().map(|filter| self.vector("filter", filter, table, Stream::Filter, 4)).transpose()?;
        Ok(vec![z.unwrap_or_else(|| vec![0.0; 3]), q_z.map_or_else(Vec::new, |q| q.to_vec()), y.unwrap_or_default()])
    }

    /// Which of the two quaternions of an attitude it starts with.
    pub(super) fn rotation(&mut self) -> RotationFile {
        let given = self.tables(&["rotation"]).find_map(|table| table.rotation.as_ref());
        given.map_or(RotationFile::Shortest, |given| given.value)
    }

    /// Refuses what the reference dynamics of this agent do not have.
    fn no_other<T>(&self, key: &'static str, stated: &Option<At<T>>) -> Result<(), Fault> {
        match stated {
            None => Ok(()),
            Some(place) => Err(fault(place, SystemProblem::StartUnused { key, agent: self.name.to_owned() })),
        }
    }

    /// Where a robot starts that has a position and nothing else.
    ///
    /// # Errors
    /// The first mistake, at its place.
    pub fn position_alone(&mut self) -> Result<Start, Fault> {
        Ok(Start { q: self.position()?, dq: Vec::new(), rest: Vec::new(), reference: Vec::new() })
    }

    /// Where a robot starts that has a position and a velocity, and nothing else.
    ///
    /// # Errors
    /// The first mistake, at its place.
    pub fn position_and_velocity(&mut self) -> Result<Start, Fault> {
        let (q, dq) = (self.position()?, self.velocity()?);
        Ok(Start { reference: self.reference(&dq)?, q, dq, rest: Vec::new() })
    }

    /// The tables as they are written, the agent's own first, to take `keys` from.
    pub(super) fn tables(&mut self, keys: &[&'static str]) -> impl Iterator<Item = &'a StartFile> + use<'a> {
        self.asked.extend(keys);
        self.both().map(|table| &table.file.value)
    }

    /// Refuses what the agent's own table says although it was not asked for.
    pub(super) fn reject_unused(&self) -> Result<(), Fault> {
        let keys = self.own.map(|own| keys(&own.file.value)).unwrap_or_default();
        match keys.into_iter().find(|(key, _)| !self.asked.contains(key)) {
            None => Ok(()),
            Some((key, span)) => {
                Err(Fault::new(SystemProblem::StartUnused { key, agent: self.name.to_owned() }).at(&span))
            }
        }
    }

    /// What was asked for.
    pub(super) fn asked(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.asked.iter().copied()
    }

    fn both(&self) -> impl Iterator<Item = Shared<'a>> + use<'a> {
        [self.own, self.common].into_iter().flatten()
    }

    /// Under one of three keys.
    fn quantity(&mut self, stream: Stream, keys: fn(&StartFile) -> [Key<'_>; 3]) -> Result<Vec<f64>, Fault> {
        self.asked.extend(keys(&StartFile::default()).map(|(key, ..)| key));
        for table in self.both() {
            if let Some(found) = self.one_of(table, stream, keys(&table.file.value))? {
                return Ok(found);
            }
        }
        Ok(vec![0.0; self.robot.axes.len()])
    }

    fn one_of(&self, table: Shared<'_>, stream: Stream, keys: [Key<'_>; 3]) -> Result<Option<Vec<f64>>, Fault> {
        let any = keys[2].0;
        let mut given = keys.into_iter().filter_map(|(key, unit, value)| Some((key, unit, value.as_ref()?)));
        let Some((key, unit, value)) = given.next() else { return Ok(None) };
        if let Some((second, _, place)) = given.next() {
            return Err(fault(place, ValueProblem::SameQuantity { first: key, second }));
        }
        if let Some(unit) = unit
            && let Some(axis) = self.robot.axes.iter().find(|axis| axis.unit != unit && axis.unit != AxisUnit::Own)
        {
            let unit = match axis.unit {
                AxisUnit::Radian => "rad",
                AxisUnit::Metre => "m",
                AxisUnit::One | AxisUnit::Own => "pure numbers",
            };
            let (agent, axis) = (self.name.to_owned(), axis.name.clone());
            return Err(fault(value, ScenarioProblem::Unit { key, agent, axis, unit, any }));
        }
        self.vector(key, value, table, stream, self.robot.axes.len()).map(Some)
    }

    fn vector(
        &self,
        key: &'static str,
        value: &At<StartValues>,
        table: Shared<'_>,
        stream: Stream,
        need: usize,
    ) -> Result<Vec<f64>, Fault> {
        let length = |found: usize, place: &Range<usize>| length(key, place, found, need, self.name);
        let rows = match &value.value {
            StartValues::Random(random) => return self.draw(random, stream, table.index, need),
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

    /// `need` numbers, each drawn uniformly.
    fn draw(&self, random: &RandomFile, stream: Stream, index: usize, need: usize) -> Result<Vec<f64>, Fault> {
        let within = match &random.within.value {
            Within::All(pair) => vec![*pair; need],
            Within::Each(pairs) => {
                length("within", &random.within.span, pairs.len(), need, self.name)?;
                pairs.clone()
            }
        };
        if let Some([low, high]) = within.iter().copied().find(|[low, high]| low > high) {
            return Err(fault(&random.within, ValueProblem::Interval { key: "within", low, high }));
        }
        let units = draws(seed(&random.seed)?, stream, index, need);
        Ok(units.zip(within).map(|(unit, [low, high])| low * (1.0 - unit) + high * unit).collect())
    }
}

/// Refuses a key of the table of all agents that none of them has `asked` for; `first` is one of them.
pub(super) fn reject_unread(common: &StartFile, asked: &BTreeSet<&'static str>, first: &str) -> Result<(), Fault> {
    match keys(common).into_iter().find(|(key, _)| !asked.contains(key)) {
        None => Ok(()),
        Some((key, span)) => Err(Fault::new(SystemProblem::StartUnused { key, agent: first.to_owned() }).at(&span)),
    }
}

/// The keys that a table has, and where they stand.
fn keys(file: &StartFile) -> Vec<(&'static str, Range<usize>)> {
    let span = |values: &Option<At<StartValues>>| values.as_ref().map(|values| values.span.clone());
    let all = [
        ("position_rad", span(&file.position_rad)),
        ("position_m", span(&file.position_m)),
        ("position", span(&file.position)),
        ("velocity_rad_s", span(&file.velocity_rad_s)),
        ("velocity_m_s", span(&file.velocity_m_s)),
        ("velocity", span(&file.velocity)),
        ("attitude", file.attitude.as_ref().map(|attitude| attitude.span.clone())),
        ("angular_velocity_rad_s", file.angular_velocity_rad_s.as_ref().map(|rate| rate.span.clone())),
        ("spacecraft", file.spacecraft.as_ref().map(|craft| craft.span.clone())),
        ("rotation", file.rotation.as_ref().map(|rotation| rotation.span.clone())),
        ("higher_states", span(&file.higher_states)),
        ("reference", file.reference.as_ref().map(|reference| reference.span.clone())),
    ];
    all.into_iter().filter_map(|(key, span)| Some((key, span?))).collect()
}
