//! What is asked of a kind of robot and of a kind of law, whoever wrote them.

use std::fmt;
use std::sync::Arc;

use forwardstep_sim::{Law, RobotSetup, Start};

use super::{Body, Fault, InputFolder, RobotRead, RobotTemplate, Spread, StartReader, Stop};

/// A kind of robot in scenario files: its table, as it was read.
pub trait RobotKind: fmt::Debug {
    /// What the list says of it.
    fn table() -> RobotTable
    where
        Self: Sized;

    /// The robot. `folder` has the files that the table names.
    ///
    /// # Errors
    /// The first mistake, at its place.
    fn read(&self, folder: &mut InputFolder) -> Result<RobotRead, Stop>;

    /// Makes of `read`, which is the robot that the table says, that of one agent of a population whose robots differ.
    ///
    /// # Errors
    /// [`Spread::unsound`] when there is no such robot.
    fn spread(&self, read: &mut RobotRead, spread: &Spread<'_>) -> Result<(), Fault>;

    /// Where an agent with `robot` starts. What is not asked of `given` is refused where the agent says it.
    ///
    /// # Errors
    /// The first mistake, at its place.
    fn start(&self, robot: &RobotSetup, given: &mut StartReader<'_>) -> Result<Start, Fault>;
}

/// What the list of kinds says of a robot.
#[derive(Clone, Debug)]
pub struct RobotTable {
    /// Its key in `robot`.
    pub key: &'static str,
    /// What it is, in a sentence, for the schema.
    pub description: &'static str,
    /// The key of the law of agents that have none. It is read from an empty table.
    pub usual_law: &'static str,
    /// What `forwardstep new` writes for it; `None` where it offers none.
    pub template: Option<RobotTemplate>,
}

/// A kind of law in scenario files: its table, as it was read.
pub trait LawKind: fmt::Debug {
    /// What the list says of it.
    fn table() -> LawTable
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

/// What the list of kinds says of a delay, or of a kind of switching.
#[derive(Clone, Copy, Debug)]
pub struct KindTable {
    /// Its key.
    pub key: &'static str,
    /// What it is, in a sentence, for the schema.
    pub description: &'static str,
}

/// What the list of kinds says of a law.
#[derive(Clone, Copy, Debug)]
pub struct LawTable {
    /// Its key in `law`.
    pub key: &'static str,
    /// What it is, in a sentence, for the schema.
    pub description: &'static str,
    /// What it is made for, in messages.
    pub made_for: &'static str,
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
