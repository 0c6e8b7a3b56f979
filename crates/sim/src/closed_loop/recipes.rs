//! From agents to the recipes of their sampled controllers, which the simulator builds like everybody else.

use forwardstep_core::LengthError;
use forwardstep_core::sampled::{EncoderFilter, Limits, Recipe, RecipeError, Sampled};

use super::assemble::ClosedLoop;
use super::assembly::effort_limits;
use super::error::SetupError;
use super::limit_error::LimitError;
use crate::setup::{AgentSetup, Control, Failures, Setup, VelocitySensor};

/// The sampled controller of one agent as plain data: what the simulator steps under [`Setup::control`], for a program of
/// one's own. Without [`Setup::control`] velocities are measured, and limits are those of the robot if they are enforced.
///
/// Its state begins as in a run, with what is heard at t = 0 before any message; where that is not known,
/// set [`Recipe::start`] to begin with the first sample.
///
/// ```
/// use forwardstep_core::agent::Inbox;
/// use forwardstep_core::sampled::Sampled;
/// use forwardstep_sim::{AgentSetup, Known, Network, RobotSetup, Setup, recipe};
///
/// let cart = AgentSetup::new("cart", RobotSetup::point_mass(1, 2.0), Known::gain(4.0)).roots([1.0]).at(&[1.0]);
/// let setup = Setup::consensus([cart], Network::silent(1), 1.0);
/// let recipe = recipe(&setup, 0)?;
/// let mut controller = recipe.build().expect("a recipe that was checked");
/// controller.step(0.0, &[1.0, 0.2], Inbox { degree: 0.0, sums: &[0.0, 0.0] }).expect("numbers");
/// assert!(controller.command()[0] < 0.0);
/// # Ok::<(), forwardstep_sim::SetupError>(())
/// ```
///
/// # Errors
/// [`SetupError`] when the setup has no meaning, or no agent of this number.
pub fn recipe(setup: &Setup, agent: usize) -> Result<Recipe, SetupError> {
    let agents = setup.agents.len();
    recipes(setup)?.into_iter().nth(agent).ok_or(SetupError::NoAgent { agent, agents })
}

/// The sampled controllers of all agents, in order; see [`recipe`].
///
/// # Errors
/// [`SetupError`] when the setup has no meaning.
pub fn recipes(setup: &Setup) -> Result<Vec<Recipe>, SetupError> {
    ClosedLoop::new(setup)?.recipes(setup)
}

/// `recipe` as it is used by an agent with so many torques.
pub(super) fn used(mut recipe: Recipe, setup: &Setup, agent: usize, torques: usize) -> Result<Recipe, SetupError> {
    if let Some(Control { failures: Failures { safe_command: Some(safe), .. }, .. }) = &setup.control {
        recipe.safe = safe.clone();
    }
    recipe.limits = limits(&setup.agents[agent], setup.control.as_ref(), torques)?;
    recipe.filter = match &setup.control {
        Some(Control { sensors, sample_hz, .. }) => match sensors.velocity {
            VelocitySensor::Measured => None,
            VelocitySensor::Filtered { cut_off_hz } => Some(EncoderFilter {
                cut_off_rad_s: core::f64::consts::TAU * cut_off_hz,
                period_s: Some(1.0 / sample_hz),
            }),
        },
        None => None,
    };
    Ok(recipe)
}

/// What the actuators can do, and what the robot's axes can bear where that is enforced.
fn limits(own: &AgentSetup, control: Option<&Control>, torques: usize) -> Result<Option<Limits>, SetupError> {
    let actuators = control.map(|control| &control.actuators);
    let refused = |error| SetupError::Limit { agent: own.name.clone(), error };
    let given = |values: Option<&Vec<f64>>, what: &'static str, of: fn(LengthError) -> LimitError| {
        let values = values.cloned().unwrap_or_else(|| vec![f64::INFINITY; torques]);
        LengthError::check(what, torques, values.len()).map_err(|error| refused(of(error)))?;
        Ok::<_, SetupError>(values)
    };
    let torque = actuators.and_then(|actuators| actuators.torque_limit.as_ref());
    let rate = actuators.and_then(|actuators| actuators.torque_rate_limit.as_ref());
    let mut torque = given(torque, "the limit of torques", LimitError::Torques)?;
    let rate = given(rate, "the limit of torque rates", LimitError::Rates)?;
    for (limit, effort) in torque.iter_mut().zip(effort_limits(own, torques)?.iter().flatten()) {
        *limit = limit.min(*effort);
    }
    // A rounded torque must not exceed its limit either.
    if let Some(actuators) = actuators {
        for (axis, limit) in torque.iter_mut().enumerate() {
            let (given, step) = (*limit, actuators.torque_quantum);
            *limit = actuators.largest_within(given);
            if *limit == 0.0 && given > 0.0 {
                return Err(refused(LimitError::BelowStep { axis, limit: given, step }));
            }
        }
    }
    let unlimited = torque.iter().chain(&rate).all(|limit| limit.is_infinite());
    Ok((!unlimited).then_some(Limits { torque, rate }))
}

/// Builds a recipe of the agent with this name.
pub(super) fn built(recipe: &Recipe, agent: &str) -> Result<Box<dyn Sampled>, SetupError> {
    recipe.build().map_err(|error| {
        let agent = agent.to_owned();
        match error {
            RecipeError::Length(error) => SetupError::Length { agent, error },
            RecipeError::Limiter(error) => SetupError::Limit { agent, error: LimitError::Limiter(error) },
            RecipeError::Filter(error) => SetupError::VelocityFilter(error),
            error => SetupError::Recipe { agent, error },
        }
    })
}
