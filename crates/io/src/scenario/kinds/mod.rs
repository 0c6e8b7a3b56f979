//! The kinds of robots and laws that scenario files know, in one list, which a program of one's own can add to.
//!
//! A kind is the struct of its table in a file. It derives `Deserialize` and `JsonSchema`, whose doc comments become the schema,
//! holds what can be wrong as [`At`], which knows its place, and implements [`RobotKind`] or [`LawKind`]; what it finds wrong is a
//! [`Mistake`] of its own. [`Kinds`] has them by
//! their keys; near matches, messages and the schema come from there.
//!
//! - `urdf`, `planar_arm`, `point_mass`: robots under (6)–(7); `adaptive`: these laws; a mass without velocity is with it.
//! - `task_space`: the end-effector of a robot.
//! - `thrust`: vehicles with one thrust; `spacecraft`: an attitude.
//! - `chain`, `cascade`: Section IV.

pub mod adaptive;
pub mod cascade;
pub mod chain;
pub mod planar_arm;
pub mod point_mass;
mod problem;
pub mod ship;
pub mod spacecraft;
pub mod task_space;
pub mod thrust;
pub mod urdf;

use std::fmt;
use std::sync::Arc;

use forwardstep_sim::trajectory::Trajectory;
use forwardstep_sim::{Law, RobotSetup, Start};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::DeserializeOwned;
use thiserror::Error;

use super::de::ValueDe;
use super::document::{KeyedLaw, with_empty};
use super::file::ScenarioFile;
use super::system_problem::SystemProblem;

pub use self::problem::{KindProblem, Mistake};
pub use super::at::At;
pub use super::fault::{
    Fault, between, count, fault, filled, length, not_negative, not_negative_or, positive, positive_or, values,
};
pub use super::gains::{DampingFile, EstimateStartFile, adaptation, damping, estimate, gain, gain_or};
pub use super::inputs::InputFolder;
pub use super::robots::{Body, RobotRead, Stop, axis};
pub use super::spread::Spread;
pub use super::start::StartReader;
pub use super::systems_file::TargetFile;
pub use super::template::RobotTemplate;
pub use super::values::{AxisValues, GainFile, GainOrBandwidth};

/// A kind of robot in scenario files: its table, as it was read.
pub trait RobotKind: fmt::Debug {
    /// Its key in `robot`.
    fn key() -> &'static str
    where
        Self: Sized;

    /// What it is, in a sentence, for the schema.
    fn description() -> &'static str
    where
        Self: Sized;

    /// What `forwardstep new` writes for it; `None` where it offers none.
    fn template() -> Option<RobotTemplate>
    where
        Self: Sized;

    /// The robot. `folder` has the files that the table names.
    ///
    /// # Errors
    /// The first mistake, at its place.
    fn read(&self, folder: &mut InputFolder) -> Result<RobotRead, Stop>;

    /// The robot of one agent of a population whose robots differ; `read` is the one that the table says.
    ///
    /// # Errors
    /// [`Spread::unsound`] when there is no such robot.
    fn spread(&self, read: &RobotRead, spread: &Spread<'_>) -> Result<(RobotSetup, Body), Fault>;

    /// Where an agent with `robot` starts. What is not asked of `given` is refused where the agent says it.
    ///
    /// # Errors
    /// The first mistake, at its place.
    fn start(&self, robot: &RobotSetup, given: &mut StartReader<'_>) -> Result<Start, Fault>;

    /// Checks the target of an agent that starts at `start`, until `end_s`, and may say the start in another way that suits
    /// the target.
    ///
    /// # Errors
    /// The mistake at `place`.
    fn target(&self, place: &At<TargetFile>, target: &Trajectory, end_s: f64, start: &mut Start) -> Result<(), Fault>;

    /// Whether the limits that are enforced are those of its axes; otherwise the plant has limits of its own.
    fn limits_of_axes(&self) -> bool;

    /// The key of the law of agents that have none. It is read from an empty table.
    fn usual_law(&self) -> &'static str;
}

/// A kind of law in scenario files: its table, as it was read.
pub trait LawKind: fmt::Debug {
    /// Its key in `law`.
    fn key() -> &'static str
    where
        Self: Sized;

    /// What it is, in a sentence, for the schema.
    fn description() -> &'static str
    where
        Self: Sized;

    /// What it is made for, in messages.
    fn made_for() -> &'static str
    where
        Self: Sized;

    /// Whether it is made for `robot`.
    fn suits(robot: &RobotSetup) -> bool
    where
        Self: Sized;

    /// The law of `agent`, whose robot it is made for.
    ///
    /// # Errors
    /// The first mistake, at its place.
    fn law(&self, agent: &LawReader<'_>) -> Result<Arc<dyn Law>, Fault>;
}

/// The agent that a law is read for.
#[derive(Clone, Copy, Debug)]
pub struct LawReader<'a> {
    /// Its name.
    pub agent: &'a str,
    /// Its robot.
    pub robot: &'a RobotSetup,
    /// Where the robot can be held.
    pub body: &'a Body,
    /// The robots of all agents under the same table of a law: what says nothing to any of them is refused.
    pub sharing: &'a [&'a RobotSetup],
}

/// A key that is taken.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("there is a {what} `{key}` already; choose another key")]
pub struct KindError {
    /// What has it, `robot` or `law`.
    pub what: &'static str,
    /// The key.
    pub key: &'static str,
}

/// The kinds of robots and laws that scenario files may name.
///
/// ```
/// use forwardstep_io::scenario::kinds::Kinds;
///
/// let kinds = Kinds::shipped();
/// assert!(kinds.robot_keys().contains(&"point_mass") && kinds.law_keys().contains(&"adaptive"));
/// ```
#[derive(Clone, Debug, Default)]
pub struct Kinds {
    robots: Vec<RobotEntry>,
    laws: Vec<LawEntry>,
}

impl Kinds {
    /// Those that come with forwardstep. This is the list: a kind is a line in it.
    pub fn shipped() -> Kinds {
        Kinds {
            robots: vec![
                RobotEntry::of::<urdf::UrdfFile>(),
                RobotEntry::of::<planar_arm::PlanarArmFile>(),
                RobotEntry::of::<point_mass::PointMassFile>(),
                RobotEntry::of::<ship::ShipFile>(),
                RobotEntry::of::<thrust::VehicleFile>(),
                RobotEntry::of::<thrust::RotorcraftFile>(),
                RobotEntry::of::<spacecraft::SpacecraftFile>(),
                RobotEntry::of::<chain::ChainFile>(),
                RobotEntry::of::<cascade::StrictFeedbackFile>(),
                RobotEntry::of::<cascade::PureFeedbackFile>(),
            ],
            laws: vec![
                LawEntry::of::<adaptive::AdaptiveFile>(),
                LawEntry::of::<adaptive::KnownFile>(),
                LawEntry::of::<point_mass::PositionOnlyFile>(),
                LawEntry::of::<thrust::ThrustFile>(),
                LawEntry::of::<task_space::TaskSpaceFile>(),
                LawEntry::of::<spacecraft::AttitudeFile>(),
                LawEntry::of::<chain::LinearisingFile>(),
                LawEntry::of::<chain::LinearAdaptiveFile>(),
                LawEntry::of::<chain::ImmersionFile>(),
                LawEntry::of::<cascade::AdaptiveBacksteppingFile>(),
            ],
        }
    }

    /// Adds a kind of robot.
    ///
    /// # Errors
    /// [`KindError`] when its key is taken.
    pub fn add_robot<F: RobotKind + DeserializeOwned + JsonSchema + 'static>(&mut self) -> Result<(), KindError> {
        if self.robot_keys().contains(&F::key()) {
            return Err(KindError { what: "robot", key: F::key() });
        }
        self.robots.push(RobotEntry::of::<F>());
        Ok(())
    }

    /// Adds a kind of law.
    ///
    /// # Errors
    /// [`KindError`] when its key is taken.
    pub fn add_law<F: LawKind + DeserializeOwned + JsonSchema + 'static>(&mut self) -> Result<(), KindError> {
        if self.law_keys().contains(&F::key()) {
            return Err(KindError { what: "law", key: F::key() });
        }
        self.laws.push(LawEntry::of::<F>());
        Ok(())
    }

    /// The keys of all robots.
    pub fn robot_keys(&self) -> Vec<&'static str> {
        self.robots.iter().map(|entry| entry.table.key).collect()
    }

    /// The keys of all laws.
    pub fn law_keys(&self) -> Vec<&'static str> {
        self.laws.iter().map(|entry| entry.table.key).collect()
    }

    /// What `forwardstep new` writes for the robot of this key, if it offers one.
    pub fn template(&self, key: &str) -> Option<RobotTemplate> {
        self.robots.iter().find(|entry| entry.table.key == key).and_then(|entry| (entry.template)())
    }

    /// The JSON schema of scenario files, for editors.
    pub fn schema(&self) -> Schema {
        let mut generator = SchemaGenerator::default();
        let robots = choice("The robots that can be simulated.", self.robots.iter().map(|e| &e.table), &mut generator);
        let says = "How the velocity is made to follow the reference velocity.";
        let laws = choice(says, self.laws.iter().map(|entry| &entry.table), &mut generator);
        let mut schema = generator.into_root_schema_for::<ScenarioFile>();
        if let Some(parts) = schema.get_mut("$defs").and_then(|parts| parts.as_object_mut()) {
            parts.insert("RobotFile".into(), robots.to_value());
            parts.insert("LawFile".into(), laws.to_value());
        }
        schema
    }

    /// The robot at `place` in the tree of a file.
    pub(super) fn robot(&self, place: ValueDe<'_, '_>) -> Result<(&'static str, Box<dyn RobotKind>), Fault> {
        chosen(self.robots.iter().map(|entry| &entry.table), place)
    }

    /// The law at `place` in the tree of a file.
    pub(super) fn law(&self, place: ValueDe<'_, '_>) -> Result<KeyedLaw, Fault> {
        chosen(self.laws.iter().map(|entry| &entry.table), place)
    }

    /// The law of this key, from an empty table.
    pub(super) fn usual_law(&self, key: &str) -> Result<KeyedLaw, Fault> {
        with_empty(key, self, |place| self.law(place))
    }

    /// Builds the law `key` of `agent`, if it is made for its robot.
    pub(super) fn build(&self, (key, law): &KeyedLaw, agent: &LawReader<'_>) -> Result<Arc<dyn Law>, Fault> {
        match self.laws.iter().find(|entry| entry.table.key == *key) {
            Some(entry) if !(entry.suits)(agent.robot) => {
                let (agent, robot) = (agent.agent.to_owned(), agent.robot);
                let laws = self.laws.iter().filter(|entry| (entry.suits)(robot)).map(|entry| entry.table.key).collect();
                Err(Fault::new(SystemProblem::LawOfAnother { agent, law: key, made_for: entry.made_for, laws }))
            }
            _ => law.law(agent),
        }
    }
}

/// What robots and laws have in common: a key, and a table that is read.
struct Table<T: ?Sized> {
    key: &'static str,
    description: &'static str,
    read: fn(ValueDe<'_, '_>) -> Result<Box<T>, Fault>,
    schema: fn(&mut SchemaGenerator) -> Schema,
}

impl<T: ?Sized> Clone for Table<T> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<T: ?Sized> Copy for Table<T> {}

impl<T: ?Sized> fmt::Debug for Table<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.key)
    }
}

#[derive(Clone, Copy, Debug)]
struct RobotEntry {
    table: Table<dyn RobotKind>,
    template: fn() -> Option<RobotTemplate>,
}

impl RobotEntry {
    fn of<F: RobotKind + DeserializeOwned + JsonSchema + 'static>() -> Self {
        fn read<F: RobotKind + DeserializeOwned + 'static>(de: ValueDe<'_, '_>) -> Result<Box<dyn RobotKind>, Fault> {
            Ok(Box::new(F::deserialize(de)?))
        }
        let schema = SchemaGenerator::subschema_for::<F>;
        let table = Table { key: F::key(), description: F::description(), read: read::<F>, schema };
        RobotEntry { table, template: F::template }
    }
}

#[derive(Clone, Copy, Debug)]
struct LawEntry {
    table: Table<dyn LawKind>,
    made_for: &'static str,
    suits: fn(&RobotSetup) -> bool,
}

impl LawEntry {
    fn of<F: LawKind + DeserializeOwned + JsonSchema + 'static>() -> Self {
        fn read<F: LawKind + DeserializeOwned + 'static>(de: ValueDe<'_, '_>) -> Result<Box<dyn LawKind>, Fault> {
            Ok(Box::new(F::deserialize(de)?))
        }
        let schema = SchemaGenerator::subschema_for::<F>;
        let table = Table { key: F::key(), description: F::description(), read: read::<F>, schema };
        LawEntry { table, made_for: F::made_for(), suits: F::suits }
    }
}

/// What stands at `place`: the key of one of `tables`, with that table.
fn chosen<'t, T: ?Sized + 't>(
    tables: impl Iterator<Item = &'t Table<T>> + Clone,
    place: ValueDe<'_, '_>,
) -> Result<(&'static str, Box<T>), Fault> {
    let keys: Vec<&'static str> = tables.clone().map(|table| table.key).collect();
    let choice = place.choice(&keys)?;
    let body = choice.content()?;
    let mut tables = tables;
    match tables.find(|table| table.key == choice.key) {
        Some(table) => Ok((table.key, (table.read)(body).map_err(|fault| fault.at(&place.span()))?)),
        None => Err(choice.unknown(&keys)),
    }
}

/// A table with one of these keys.
fn choice<'t, T: ?Sized + 't>(
    description: &str,
    tables: impl Iterator<Item = &'t Table<T>>,
    generator: &mut SchemaGenerator,
) -> Schema {
    let one = |table: &Table<T>| {
        let Table { key, description, schema, .. } = table;
        json_schema!({
            "description": description,
            "type": "object",
            "properties": { *key: schema(generator) },
            "required": [key],
            "additionalProperties": false,
        })
    };
    let all: Vec<Schema> = tables.map(one).collect();
    json_schema!({ "description": description, "oneOf": all })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_is_taken_twice() {
        let kinds = Kinds::shipped();
        for mut keys in [kinds.robot_keys(), kinds.law_keys()] {
            let all = keys.len();
            keys.sort_unstable();
            keys.dedup();
            assert_eq!(keys.len(), all);
        }
        let mut kinds = kinds;
        let taken = kinds.add_robot::<point_mass::PointMassFile>().unwrap_err();
        assert_eq!(taken.to_string(), "there is a robot `point_mass` already; choose another key");
        let taken = kinds.add_law::<adaptive::KnownFile>().unwrap_err();
        assert_eq!(taken.to_string(), "there is a law `known` already; choose another key");
    }
}
