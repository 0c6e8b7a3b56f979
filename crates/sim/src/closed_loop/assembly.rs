//! What a law builds its agents with.

use forwardstep_core::controller::{ChainError, Controller, JointTracking, ReferenceModel};
use forwardstep_core::law::{ParameterBounds, Range};
use forwardstep_core::plant::{Mechanical, Plant, total};
use forwardstep_core::reference::{WrittenIn, polynomial};
use forwardstep_core::signal::Block as Signals;
use forwardstep_core::{Gain, GainError, LengthError, ResolvedGain};

use super::columns::Columns;
use super::error::SetupError;
use super::limit_error::LimitError;
use super::members;
use super::pair::{Joined, Pair};
use super::robot_batch::Member;
use super::solo::{Solo, Target};
use super::valid::too_many;
use crate::agents::{Adaptive, RobotModel};
use crate::quantity::{LARGEST, Path, at_least, each, finite, positive, within};
use crate::recording::Signal;
use crate::reference::{Desired, ReferenceDynamics};
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

    pub(super) fn of_agent(&self) -> Path {
        Path::from("agents").index(self.agents[0])
    }

    /// Checks the length of the list `key` at `at`.
    ///
    /// # Errors
    /// [`SetupError::Entries`] when it has another.
    pub fn length(&self, at: Path, key: &'static str, need: usize, got: usize) -> Result<(), SetupError> {
        length(self.agent(), at.key(key), need, got)
    }

    /// Checks that the estimate `key` of the law's table has as many entries as there are parameters, and that all are finite.
    ///
    /// # Errors
    /// [`SetupError`], at that key, when it has not.
    pub fn estimate(&self, key: &'static str, estimate: &[f64], parameters: usize) -> Result<(), SetupError> {
        self.length(self.of_law(), key, parameters, estimate.len())?;
        Ok(each(self.of_law(), key, estimate, finite)?)
    }

    /// Checks `bounds` of what is estimated, whose lower and upper ends and margins have these `keys` in the table `bounds` of the law.
    ///
    /// # Errors
    /// [`SetupError`], at the key and entry of the first that has no meaning.
    pub fn bounds(
        &self,
        bounds: &ParameterBounds,
        keys: [&'static str; 3],
        parameters: usize,
    ) -> Result<(), SetupError> {
        self.bounds_at(self.of_law().key("bounds"), bounds, keys, parameters)
    }

    /// The same in the table at `place`.
    ///
    /// # Errors
    /// As [`Assembly::bounds`].
    pub(crate) fn bounds_at(
        &self,
        place: Path,
        bounds: &ParameterBounds,
        keys: [&'static str; 3],
        parameters: usize,
    ) -> Result<(), SetupError> {
        let [lower, upper, margin] = keys;
        self.length(place.clone(), lower, parameters, bounds.lower.len())?;
        self.length(place.clone(), upper, parameters, bounds.upper.len())?;
        self.length(place.clone(), margin, parameters, bounds.margin.len())?;
        for entry in &bounds.margin {
            positive(place.clone(), margin, *entry)?;
        }
        for (k, (low, high)) in bounds.lower.iter().zip(&bounds.upper).enumerate() {
            let [at_low, at_high] = [lower, upper].map(|key| place.clone().key(key).index(k));
            within(at_low, "", *low, -LARGEST, LARGEST)?;
            within(at_high.clone(), "", *high, -LARGEST, LARGEST)?;
            at_least(at_high, "", *high, (lower, *low))?;
        }
        Ok(())
    }

    /// Checks the bounds of one estimate, in the table at `place`, which has to be adapted with the gain `gamma`.
    ///
    /// # Errors
    /// [`SetupError`] when they have no meaning, or no effect.
    pub(crate) fn range(&self, place: Path, range: Option<Range>, gamma: f64) -> Result<(), SetupError> {
        let Some(Range { lower, upper }) = range else { return Ok(()) };
        let bounds = ParameterBounds::new(vec![lower], vec![upper], 1.0);
        self.bounds_at(place, &bounds, ["lower", "upper", "margin"], 1)?;
        if gamma == 0.0 {
            return Err(SetupError::BoundsOfKnown { agent: self.agent().name.clone() });
        }
        Ok(())
    }

    /// A gain of `size` rows that is no bandwidth, under the key that it has in the law's table.
    ///
    /// # Errors
    /// [`SetupError`], at that key, when it has no meaning.
    pub fn gain(&self, gain: &Gain, key: &'static str, size: usize) -> Result<ResolvedGain, SetupError> {
        self.resolved(gain, self.of_law().key(key), size, &[])
    }

    /// A gain, or what else must be symmetric and positive definite, at `path`; a bandwidth is multiplied by `scale`.
    ///
    /// # Errors
    /// [`SetupError`], at `path` or inside, when it has no meaning.
    pub(crate) fn resolved(
        &self,
        gain: &Gain,
        path: Path,
        size: usize,
        scale: &[f64],
    ) -> Result<ResolvedGain, SetupError> {
        match gain {
            Gain::Number(number) | Gain::Bandwidth(number) => positive(path.clone(), "", *number)?,
            Gain::Diagonal(list) => each(path.clone(), "", list, positive)?,
            Gain::Matrix(_) => {}
        }
        let agent = self.agent().name.clone();
        gain.resolve(size, scale).map_err(|error| match (error, gain) {
            // Counted in rows, where there are any.
            (GainError::Length(_), Gain::Matrix(entries)) if entries.len().isqrt().pow(2) == entries.len() => {
                SetupError::Entries { agent, path, need: size, got: entries.len().isqrt() }
            }
            (GainError::Length(LengthError { need, got, .. }), _) => SetupError::Entries { agent, path, need, got },
            (error, _) => SetupError::Gain { agent, path, error },
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
        let Member { law, theta, .. } = members::member(&robot, self)?;
        // One root at least.
        let wrong = |error| SetupError::Chain { agent: own.name.clone(), error: ChainError::ReferenceModel(error) };
        let suits = |order: usize| ReferenceModel::Tracking { alpha: vec![1.0; order] }.check(1, 1).map_err(wrong);
        let guide = if let Some(desired) = self.reference().downcast::<Desired>() {
            let dynamics = desired.dynamics_of(&own.name)?;
            if dynamics.written() != WrittenIn::Measured {
                let (agent, law) = (own.name.clone(), own.law.words().name);
                return Err(SetupError::DesiredVariables { agent, law });
            }
            suits(dynamics.order())?;
            if dynamics.is_linear() {
                ReferenceModel::Tracking { alpha: dynamics.own().to_vec() }
            } else {
                ReferenceModel::Desired(dynamics)
            }
        } else {
            suits(own.roots_per_s.len())?;
            let mut alpha =
                polynomial(&own.roots_per_s).map_err(|error| SetupError::Roots { agent: own.name.clone(), error })?;
            // The leading one is not listed.
            alpha.pop();
            ReferenceModel::Tracking { alpha }
        };
        let adaptive = own.law.downcast().map(|law: &Adaptive| law.estimate_start.clone());
        let estimate_start = adaptive.unwrap_or_else(|| theta.clone());
        let plant = Mechanical { robot: robot.clone(), theta };
        self.solo(plant, JointTracking { robot, guide, law, estimate_start })
    }

    /// Any plant under any controller, one agent by itself.
    ///
    /// # Errors
    /// [`SetupError`] when the start, the target or the limits do not suit them.
    pub fn solo<C: Controller>(&self, plant: C::Plant, controller: C) -> Result<Block, SetupError> {
        let (own, target_len) = (self.agent(), controller.target_len(plant.axes()));
        if own.target.is_some() && !self.setup.tracks(self.agents[0]) && !C::KNOWS_OFFSETS {
            return Err(SetupError::NoOffsets { agent: own.name.clone(), law: own.law.words().name });
        }
        self.alone(Box::new(Joined::new(plant, controller)), target_len)
    }

    /// The same, whatever they are; a target has so many entries.
    fn alone(&self, mut pair: Box<dyn Pair>, target_len: usize) -> Result<Block, SetupError> {
        let (setup, own) = (self.setup, self.agent());
        let [states, blocks] = pair.states();
        let (start, interface) = (&own.start, own.interface());
        let actuators = interface.as_ref().map_or(0, |interface| interface.actuator_start.len());
        self.length(
            self.of_agent(),
            "start",
            total(&states).saturating_sub(actuators),
            start.q.len() + start.dq.len() + start.rest.len(),
        )?;
        // What the robot says of itself is what neighbours, rows and messages go by.
        LengthError::check("the axes of the plant", own.robot.axes.len(), pair.axes())
            .map_err(|error| SetupError::Length { agent: own.name.clone(), error })?;
        self.takes_pushes(&mut *pair)?;
        let vectors = blocks
            .iter()
            .filter(|(signal, _)| matches!(signal, Signal::Reference(_) | Signal::ReferenceIntegral(_)))
            .count();
        let vectors = vectors + interface.map_or(0, |law| law.further_starts.len());
        if start.reference.len() > vectors {
            return Err(too_many(own, vectors, start.reference.len()));
        }
        let is_offset = !setup.tracks(self.agents[0]);
        let target = match &own.target {
            None => None,
            Some(trajectory) => {
                self.length(self.of_agent(), "target", target_len, trajectory.axes())?;
                let (need, known) = (pair.target_derivatives(), trajectory.known_derivatives());
                if need > known {
                    return Err(SetupError::TargetDerivatives { agent: own.name.clone(), need, known });
                }
                let wrong = |error| SetupError::Trajectory { agent: own.name.clone(), error };
                let trajectory = Pieces::new(trajectory.clone(), setup.time.end_s).map_err(wrong)?;
                Some(Target { trajectory, is_offset })
            }
        };
        let torques = pair.inputs().iter().filter(|(signal, _)| *signal == Signal::Torque).map(|(_, n)| n).sum();
        let effort_limits = effort_limits(own, torques)?;
        // What a limit takes away is not what the balance balances.
        let balance = setup.solver.balance && !own.enforce_limits;
        let sampled = setup.control.is_some();
        Ok(Block(Box::new(Solo::new(self.agents[0], pair, target, effort_limits, sampled, balance))))
    }

    /// Checks that a plant that is pushed takes what its robot says can act on it.
    fn takes_pushes(&self, pair: &mut dyn Pair) -> Result<(), SetupError> {
        let AgentSetup { name, robot, pushes, .. } = self.agent();
        if pushes.is_empty() {
            return Ok(());
        }
        let zeros = |blocks: &[Signals]| vec![0.0; total(blocks)];
        let ([states, _], external) = (pair.states(), robot.interface().attachments.blocks(robot.axes.len()));
        let state = zeros(&states);
        pair.rate(&state, [&zeros(&pair.inputs()), &zeros(&external)], &mut state.clone())
            .map_err(|error| SetupError::Length { agent: name.clone(), error })
    }
}

/// Checks the length of the list of `agent` at `path`.
pub(super) fn length(agent: &AgentSetup, path: Path, need: usize, got: usize) -> Result<(), SetupError> {
    if got == need { Ok(()) } else { Err(SetupError::Entries { agent: agent.name.clone(), path, need, got }) }
}

/// The limits of the torques, if they are to be enforced.
pub(super) fn effort_limits(own: &AgentSetup, torques: usize) -> Result<Option<Vec<f64>>, SetupError> {
    // What is no torque of an axis is limited by the plant itself, if by anything.
    if !own.enforce_limits || torques == 0 {
        return Ok(None);
    }
    let limit = |axis: &Axis| {
        let error = || LimitError::NoEffortLimit { axis: axis.name.clone() };
        axis.effort_limit.ok_or_else(|| SetupError::Limit { agent: own.name.clone(), error: error() })
    };
    let limits: Vec<f64> = own.robot.axes.iter().map(limit).collect::<Result<_, _>>()?;
    LengthError::check("the effort limits", torques, limits.len())
        .map_err(|error| SetupError::Length { agent: own.name.clone(), error })?;
    Ok(Some(limits))
}
