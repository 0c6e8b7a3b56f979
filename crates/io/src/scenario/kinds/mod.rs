//! The kinds of robots, laws, reference dynamics, delays and switching that scenario files know, in one list, which a program of one's own can add
//! to.
//!
//! A kind is the struct of its table in a file. It derives `Deserialize` and `JsonSchema`, whose doc comments become the schema,
//! holds what can be wrong as [`At`], which knows its place, and implements [`RobotKind`], [`LawKind`], [`ReferenceKind`],
//! [`DelayKind`] or [`ScheduleKind`]; what it finds wrong is a [`Mistake`] of its own. [`Kinds`] has them by their keys; near matches, messages and
//! the schema come from there.
//!
//! - `urdf`, `planar_arm`, `point_mass`: robots under (6)–(7); `adaptive`: these laws; a mass without velocity is with it.
//! - `drives`: friction at their joints; `bounds`: what estimates are kept within.
//! - `task_space`: the end-effector of a robot.
//! - `thrust`: vehicles with one thrust; `spacecraft`: an attitude.
//! - `chain`, `vector_chain`, `cascade`: Section IV.
//! - `references`: what leads the agents.
//! - `delays`, `schedules`: how late a message is, and which graph is in force.

pub mod adaptive;
pub mod bounds;
pub mod cascade;
pub mod chain;
pub mod delays;
pub mod drives;
mod kind;
pub mod planar_arm;
pub mod point_mass;
mod problem;
pub mod references;
pub mod schedules;
pub mod ship;
pub mod spacecraft;
mod table;
pub mod task_space;
pub mod thrust;
pub mod urdf;
pub mod vector_chain;

use std::sync::Arc;

use forwardstep_sim::Law;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::DeserializeOwned;
use thiserror::Error;

use super::de::ValueDe;
use super::document::{KeyedLaw, with_empty};
use super::file::ScenarioFile;
use super::system_problem::SystemProblem;

pub use self::delays::{DelayKind, DelayPlan, Link, LinkDelays};
pub use self::kind::{KindTable, LawKind, LawReader, LawTable, RobotKind, RobotTable};
pub use self::problem::{KindProblem, Mistake};
pub use self::references::{AgentReferenceTable, ReferenceKind, ReferenceRead, ReferenceReader, ReferenceTable};
pub use self::schedules::ScheduleKind;
use self::table::{LawEntry, ReferenceEntry, RobotEntry, Table, choice, chosen, delay, schedule, word};
pub use super::at::At;
pub use super::fault::{
    Fault, between, count, fault, filled, length, not_negative, not_negative_or, number_or, positive, positive_or,
    values,
};
pub use super::gains::{DampingFile, EstimateStartFile, adaptation, damping, estimate, gain, gain_or};
pub use super::inputs::InputFolder;
pub use super::network::{NetworkReader, PhaseReader};
pub use super::robots::{Body, RobotRead, Stop, axis};
pub use super::roots::{RootFile, RootsFile};
pub use super::spread::Spread;
pub use super::start::StartReader;
pub use super::systems_file::TargetFile;
pub use super::template::{LawTemplate, RobotTemplate, TaskTemplate};
pub use super::values::{AxisValues, GainFile, GainOrBandwidth};

/// A key that is taken.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("there is a {what} `{key}` already; choose another key")]
pub struct KindError {
    /// What has it: `robot`, `law`, `reference`, `delay` or `switching`.
    pub what: &'static str,
    /// The key.
    pub key: &'static str,
}

/// The kinds of robots, laws, reference dynamics, delays and switching that scenario files may name.
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
    references: Vec<ReferenceEntry>,
    delays: Vec<Table<dyn DelayKind>>,
    schedules: Vec<Table<dyn ScheduleKind>>,
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
                RobotEntry::of::<vector_chain::VectorChainFile>(),
                RobotEntry::of::<cascade::StrictFeedbackFile>(),
                RobotEntry::of::<cascade::PureFeedbackFile>(),
            ],
            laws: vec![
                LawEntry::of::<adaptive::AdaptiveFile>(),
                LawEntry::of::<adaptive::KnownFile>(),
                LawEntry::of::<point_mass::PositionOnlyFile>(),
                LawEntry::of::<point_mass::ModelReferenceFile>(),
                LawEntry::of::<thrust::ThrustFile>(),
                LawEntry::of::<task_space::TaskSpaceFile>(),
                LawEntry::of::<spacecraft::AttitudeFile>(),
                LawEntry::of::<spacecraft::PassivityFilterFile>(),
                LawEntry::of::<chain::LinearisingFile>(),
                LawEntry::of::<chain::LinearAdaptiveFile>(),
                LawEntry::of::<chain::ImmersionFile>(),
                LawEntry::of::<cascade::AdaptiveBacksteppingFile>(),
            ],
            references: vec![
                ReferenceEntry::of::<references::consensus::ConsensusFile>(),
                ReferenceEntry::of::<references::consensus::PureIntegralFile>(),
                ReferenceEntry::of::<references::backstepping::BacksteppingFile>(),
                ReferenceEntry::of::<references::leader::LeaderReferenceFile>(),
                ReferenceEntry::of::<references::tracking::TrackingFile>(),
                ReferenceEntry::of::<references::desired::DesiredFile>(),
            ],
            delays: vec![
                delay::<delays::constant::ConstantFile>(),
                delay::<delays::sinusoid::SinusoidFile>(),
                delay::<delays::piecewise_constant::PiecewiseConstantFile>(),
                delay::<delays::saw_tooth::SawToothFile>(),
                delay::<delays::formula::FormulaFile>(),
                delay::<delays::random_hold::RandomHoldFile>(),
                delay::<delays::packets::PacketsFile>(),
                delay::<delays::log::LogFile>(),
                delay::<delays::hold_log::HoldLogFile>(),
            ],
            schedules: vec![
                word::<schedules::repeat::RepeatFile>(),
                word::<schedules::once::OnceFile>(),
                schedule::<schedules::random::RandomSwitchingFile>(),
                schedule::<schedules::log::SwitchingLogFile>(),
            ],
        }
    }

    /// Adds a kind of robot.
    ///
    /// # Errors
    /// [`KindError`] when its key is taken.
    pub fn add_robot<F: RobotKind + DeserializeOwned + JsonSchema + 'static>(&mut self) -> Result<(), KindError> {
        let entry = RobotEntry::of::<F>();
        free("robot", &self.robot_keys(), entry.table.key)?;
        self.robots.push(entry);
        Ok(())
    }

    /// Adds a kind of law.
    ///
    /// # Errors
    /// [`KindError`] when its key is taken.
    pub fn add_law<F: LawKind + DeserializeOwned + JsonSchema + 'static>(&mut self) -> Result<(), KindError> {
        let entry = LawEntry::of::<F>();
        free("law", &self.law_keys(), entry.table.key)?;
        self.laws.push(entry);
        Ok(())
    }

    /// Adds a kind of reference dynamics.
    ///
    /// # Errors
    /// [`KindError`] when its key is taken.
    pub fn add_reference<F: ReferenceKind + DeserializeOwned + JsonSchema + 'static>(
        &mut self,
    ) -> Result<(), KindError> {
        let entry = ReferenceEntry::of::<F>();
        free("reference", &self.reference_keys(), entry.table.key)?;
        self.references.push(entry);
        Ok(())
    }

    /// Adds a kind of delay.
    ///
    /// # Errors
    /// [`KindError`] when its key is taken.
    pub fn add_delay<F: DelayKind + DeserializeOwned + JsonSchema + 'static>(&mut self) -> Result<(), KindError> {
        let table = delay::<F>();
        free("delay", &self.delay_keys(), table.key)?;
        self.delays.push(table);
        Ok(())
    }

    /// Adds a kind of switching.
    ///
    /// # Errors
    /// [`KindError`] when its key is taken.
    pub fn add_schedule<F: ScheduleKind + DeserializeOwned + JsonSchema + 'static>(&mut self) -> Result<(), KindError> {
        let table = schedule::<F>();
        free("switching", &self.schedule_keys(), table.key)?;
        self.schedules.push(table);
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

    /// The keys of all reference dynamics.
    pub fn reference_keys(&self) -> Vec<&'static str> {
        self.references.iter().map(|entry| entry.table.key).collect()
    }

    /// The keys of all delays.
    pub fn delay_keys(&self) -> Vec<&'static str> {
        self.delays.iter().map(|table| table.key).collect()
    }

    /// The keys of all kinds of switching.
    pub fn schedule_keys(&self) -> Vec<&'static str> {
        self.schedules.iter().map(|table| table.key).collect()
    }

    /// What `forwardstep new` writes for the robot of this key, if it offers one.
    pub fn template(&self, key: &str) -> Option<RobotTemplate> {
        self.robots.iter().find(|entry| entry.table.key == key).and_then(|entry| entry.template.clone())
    }

    /// The JSON schema of scenario files, for editors.
    pub fn schema(&self) -> Schema {
        let mut generator = SchemaGenerator::default();
        let robots = choice("The robots that can be simulated.", self.robots.iter().map(|e| &e.table), &mut generator);
        let says = "How the velocity is made to follow the reference velocity.";
        let laws = choice(says, self.laws.iter().map(|entry| &entry.table), &mut generator);
        let says = "The reference dynamics of all agents.";
        let references = choice(says, self.references.iter().map(|entry| &entry.table), &mut generator);
        let says = "What an agent states of its own, under the key of everybody's reference dynamics.";
        let own: Vec<_> = self.references.iter().filter_map(|entry| entry.of_agents).collect();
        let own = choice(says, own.iter(), &mut generator);
        let delays = choice("How old a message is when it is heard.", self.delays.iter(), &mut generator);
        let says = "How the phases of a network follow each other.";
        let schedules = choice(says, self.schedules.iter(), &mut generator);
        let mut schema = generator.into_root_schema_for::<ScenarioFile>();
        if let Some(parts) = schema.get_mut("$defs").and_then(|parts| parts.as_object_mut()) {
            parts.insert("RobotFile".into(), robots.to_value());
            parts.insert("LawFile".into(), laws.to_value());
            parts.insert("ReferenceFile".into(), references.to_value());
            parts.insert("AgentReferenceFile".into(), own.to_value());
            parts.insert("DelayFile".into(), delays.to_value());
            parts.insert("SwitchingFile".into(), schedules.to_value());
        }
        schema
    }

    /// The robot at `place` in the tree of a file, with the key of its default law.
    pub(super) fn robot(&self, place: ValueDe<'_, '_>) -> Result<(&'static str, Box<dyn RobotKind>), Fault> {
        let (key, robot) = chosen(self.robots.iter().map(|entry| &entry.table), place)?;
        let entry = self.robots.iter().find(|entry| entry.table.key == key);
        Ok((entry.map_or(key, |entry| entry.usual_law), robot))
    }

    /// The law at `place` in the tree of a file.
    pub(super) fn law(&self, place: ValueDe<'_, '_>) -> Result<KeyedLaw, Fault> {
        chosen(self.laws.iter().map(|entry| &entry.table), place)
    }

    /// The reference dynamics at `place` in the tree of a file.
    pub(super) fn reference(&self, place: ValueDe<'_, '_>) -> Result<(&'static str, Box<dyn ReferenceKind>), Fault> {
        chosen(self.references.iter().map(|entry| &entry.table), place)
    }

    /// Whether agents may state something of their own under this key of reference dynamics.
    pub(super) fn agents_may_state(&self, key: &str) -> bool {
        self.references.iter().any(|entry| entry.table.key == key && entry.of_agents.is_some())
    }

    /// What an agent states of its own, at `place` in the tree of a file.
    pub(super) fn agent_reference(
        &self,
        place: ValueDe<'_, '_>,
    ) -> Result<(&'static str, Box<AgentReferenceTable>), Fault> {
        chosen(self.references.iter().filter_map(|entry| entry.of_agents.as_ref()), place)
    }

    /// The delay at `place` in the tree of a file.
    pub(super) fn delay(&self, place: ValueDe<'_, '_>) -> Result<(&'static str, Box<dyn DelayKind>), Fault> {
        chosen(self.delays.iter(), place)
    }

    /// The switching at `place` in the tree of a file.
    pub(super) fn schedule(&self, place: ValueDe<'_, '_>) -> Result<(&'static str, Box<dyn ScheduleKind>), Fault> {
        chosen(self.schedules.iter(), place)
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

/// A key that none of `keys` is.
fn free(what: &'static str, keys: &[&'static str], key: &'static str) -> Result<(), KindError> {
    if keys.contains(&key) { Err(KindError { what, key }) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_is_taken_twice() {
        let kinds = Kinds::shipped();
        for mut keys in
            [kinds.robot_keys(), kinds.law_keys(), kinds.reference_keys(), kinds.delay_keys(), kinds.schedule_keys()]
        {
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
        let taken = kinds.add_reference::<references::tracking::TrackingFile>().unwrap_err();
        assert_eq!(taken.to_string(), "there is a reference `tracking` already; choose another key");
        let taken = kinds.add_delay::<delays::saw_tooth::SawToothFile>().unwrap_err();
        assert_eq!(taken.to_string(), "there is a delay `saw_tooth` already; choose another key");
        let taken = kinds.add_schedule::<schedules::random::RandomSwitchingFile>().unwrap_err();
        assert_eq!(taken.to_string(), "there is a switching `random` already; choose another key");
    }
}
