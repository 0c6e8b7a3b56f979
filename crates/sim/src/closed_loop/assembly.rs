//! What a law builds its agents with.

use forwardstep_core::controller::{ChainError, Controller, Guide, JointTracking};
use forwardstep_core::plant::{Mechanical, Plant, total};
use forwardstep_core::reference::polynomial;
use forwardstep_core::signal::Block as Signals;
use forwardstep_core::{Gain, LengthError, ResolvedGain};

use super::columns::Columns;
use super::error::SetupError;
use super::members;
use super::robot_batch::Member;
use super::solo::{Solo, Target};
use super::valid::too_many;
use crate::agents::{Adaptive, RobotModel};
use crate::quantity::Path;
use crate::recording::Signal;
use crate::reference::ReferenceDynamics;
use crate::setup::{AgentSetup, Axis, Setup};
use crate::system::{LawWords, Robot};
use crate::trajectory::Pieces;

/// Agents as a part of the closed loop.
pub struct Block(pub(super) Box<dyn Columns>);

/// The agents that a [`Law`](crate::system::Law) is asked to build, and what it needs to know of the run.
#[derive(Clone, Copy, Debug)]
pub struct Assembly<'a> {
    setup: &'a Setup,
    /// Never empty; one agent unless laws share batches.
    agents: &'a [usize],
}

impl<'a> Assembly<'a> {
    pub(super) fn new(setup: &'a Setup, agents: &'a [usize]) -> Self {
        Assembly { setup, agents }
    }

    /// The whole setup.
    pub fn setup(&self) -> &'a Setup {
        self.setup
    }

    /// The agent to build; the first of several.
    pub fn agent(&self) -> &'a AgentSetup {
        &self.setup.agents[self.agents[0]]
    }

    /// The agents' numbers.
    pub fn agents(&self) -> &'a [usize] {
        self.agents
    }

    /// What leads it.
    pub fn reference(&self) -> &'a dyn ReferenceDynamics {
        self.setup.reference_of(self.agents[0])
    }

    /// Its robot as the model that the law is made for.
    ///
    /// # Errors
    /// [`SetupError::LawOfAnother`] when it is another.
    pub fn robot<R: Robot>(&self) -> Result<&'a R, SetupError> {
        self.agent().robot.kind.downcast().ok_or_else(|| self.law_of_another())
    }

    /// The law is made for another kind of robot.
    pub fn law_of_another(&self) -> SetupError {
        let own = self.agent();
        let LawWords { name, made_for } = own.law.words();
        SetupError::LawOfAnother { agent: own.name.clone(), law: name, made_for }
    }

    /// The reference dynamics do not lead the law.
    pub fn wrong_reference(&self) -> SetupError {
        SetupError::wrong_reference(self.reference(), self.agent())
    }

    /// Checks how many roots the agent has.
    ///
    /// # Errors
    /// [`SetupError::RootCount`] when it has another number.
    pub fn root_count(&self, need: usize) -> Result<(), SetupError> {
        LengthError::check("the list of roots", need, self.agent().roots_per_s.len())
            .map_err(|error| SetupError::RootCount { agent: self.agent().name.clone(), error })
    }

    /// Where its law stands, for the functions of [`quantity`](crate::quantity), which are told the keys of the law's table.
    pub fn of_law(&self) -> Path {
        self.of_agent().key("law")
    }

    /// Where its robot stands.
    pub fn of_robot(&self) -> Path {
        self.of_agent().key("robot")
    }

    fn of_agent(&self) -> Path {
        Path::from("agents").index(self.agents[0])
    }

    /// Checks the length of a vector of the agent.
    ///
    /// # Errors
    /// [`SetupError::Length`] when it has another.
    pub fn length(&self, what: &'static str, need: usize, got: usize) -> Result<(), SetupError> {
        LengthError::check(what, need, got)
            .map_err(|error| SetupError::Length { agent: self.agent().name.clone(), error })
    }

    /// A gain of `size` rows that is no bandwidth.
    ///
    /// # Errors
    /// [`SetupError::Gain`], which calls it `which`, when it has no meaning.
    pub fn gain(&self, gain: &Gain, which: &'static str, size: usize) -> Result<ResolvedGain, SetupError> {
        gain.resolve(size, &[]).map_err(|error| SetupError::Gain {
            agent: self.agent().name.clone(),
            gain: which,
            error,
        })
    }

    /// Any robot of Section II-B under (6)–(7): all agents of the assembly, side by side.
    ///
    /// # Errors
    /// [`SetupError`] when the agents have no meaning.
    pub fn lagrangian<M: RobotModel>(&self, model: &M) -> Result<Block, SetupError> {
        members::batch(model, self).map(Block)
    }

    /// A robot of Section II-B that follows a target of its own, one agent by itself.
    ///
    /// # Errors
    /// [`SetupError`] when the agent has no meaning.
    pub fn tracking<M: RobotModel>(&self, model: &M) -> Result<Block, SetupError> {
        let (own, robot) = (self.agent(), model.kernel());
        let Member { law, theta, .. } = members::member(&robot, own, self.agents[0])?;
        // One root at least, and no more than a trajectory has derivatives.
        let roots = Guide::Tracking { alpha: own.roots_per_s.clone() };
        let wrong = |error| SetupError::Chain { agent: own.name.clone(), error: ChainError::Guide(error) };
        roots.check(1, 1).map_err(wrong)?;
        let mut alpha =
            polynomial(&own.roots_per_s).map_err(|error| SetupError::Roots { agent: own.name.clone(), error })?;
        // The leading one is not listed.
        alpha.pop();
        let adaptive = own.law.downcast().map(|law: &Adaptive| law.estimate_start.clone());
        let estimate_start = adaptive.unwrap_or_else(|| theta.clone());
        let plant = Mechanical { robot: robot.clone(), theta };
        self.solo(plant, JointTracking { robot, alpha, law, estimate_start })
    }

    /// Any plant under any controller, one agent by itself.
    ///
    /// # Errors
    /// [`SetupError`] when the start, the target or the limits do not suit them.
    pub fn solo<C: Controller>(&self, plant: C::Plant, controller: C) -> Result<Block, SetupError> {
        let (setup, own) = (self.setup, self.agent());
        let start = &own.start;
        self.length("the start", total(&plant.states()), start.q.len() + start.dq.len() + start.rest.len())?;
        self.takes_pushes(&plant)?;
        let blocks = controller.states();
        let vectors = blocks.iter().filter(|(signal, _)| matches!(signal, Signal::Reference(_))).count();
        if start.reference.len() > vectors {
            return Err(too_many(own, vectors, start.reference.len()));
        }
        let is_offset = !setup.tracks(self.agents[0]);
        let target = match &own.target {
            None => None,
            Some(trajectory) => {
                self.length("the target", plant.axes(), trajectory.axes())?;
                let wrong = |error| SetupError::Trajectory { agent: own.name.clone(), error };
                let trajectory = Pieces::new(trajectory.clone(), setup.time.end_s).map_err(wrong)?;
                Some(Target { trajectory, is_offset })
            }
        };
        let torques = plant.inputs().iter().filter(|(signal, _)| *signal == Signal::Torque).map(|(_, n)| n).sum();
        let effort_limits = effort_limits(own, torques)?;
        // What a limit takes away is not what the balance balances.
        let balance = setup.solver.balance && !own.enforce_limits;
        Ok(Block(Box::new(Solo::new(
            self.agents[0],
            plant,
            controller,
            target,
            effort_limits,
            setup.control.is_some(),
            balance,
        ))))
    }

    /// Checks that a plant that is pushed takes what its robot says can act on it.
    fn takes_pushes<P: Plant>(&self, plant: &P) -> Result<(), SetupError> {
        let AgentSetup { name, robot, pushes, .. } = self.agent();
        if pushes.is_empty() {
            return Ok(());
        }
        let zeros = |blocks: &[Signals]| vec![0.0; total(blocks)];
        let (state, external) =
            (zeros(&plant.states()), zeros(&robot.interface().attachments.blocks(robot.axes.len())));
        plant
            .rate(&mut plant.scratch(), &state, &zeros(&plant.inputs()), &external, &mut state.clone())
            .map_err(|error| SetupError::Length { agent: name.clone(), error })
    }
}

/// The limits of the torques, if they are to be enforced.
pub(super) fn effort_limits(own: &AgentSetup, torques: usize) -> Result<Option<Vec<f64>>, SetupError> {
    // What is no torque of an axis is limited by the plant itself, if by anything.
    if !own.enforce_limits || torques == 0 {
        return Ok(None);
    }
    let limit = |axis: &Axis| {
        let (agent, axis_name) = (own.name.clone(), axis.name.clone());
        axis.effort_limit.ok_or(SetupError::NoEffortLimit { agent, axis: axis_name })
    };
    let limits: Vec<f64> = own.robot.axes.iter().map(limit).collect::<Result<_, _>>()?;
    LengthError::check("the effort limits", torques, limits.len())
        .map_err(|error| SetupError::Length { agent: own.name.clone(), error })?;
    Ok(Some(limits))
}
