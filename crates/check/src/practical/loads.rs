//! Static torques against limits: what it takes to hold a posture at rest.
//!
//! Not from the paper, derived for this software. At rest τ = g(q) = Y(q, 0, 0, 0) ϑ with the true ϑ. Where |g_j(q)| exceeds its limit the
//! posture cannot be held, whatever the controller does; where it does not, motion may still ask for more. A rotorcraft hovers by σ = m g, which four
//! rotors have to give.

use std::collections::HashMap;

use forwardstep_core::robot::TwoVelocity;
use forwardstep_sim::{Axis, Evaluator, RotorcraftModel, Setup};

use super::PracticalAnswer;
use super::led::Led;
use super::postures::each_posture;
use crate::hypothesis::Named;
use crate::kinds::is_lagrangian;

/// What the thrust of a rotorcraft is called, beside the names of axes.
const THRUST: &str = "thrust";

/// The axis that comes closest to its limit, or is farthest beyond it.
#[derive(Clone, Debug, PartialEq)]
pub struct StaticLoad {
    /// The agent.
    pub agent: Named,
    /// Its axis.
    pub axis: usize,
    /// The name of that.
    pub axis_name: String,
    /// |g_j(q)|.
    pub torque: f64,
    /// In `N m` or `N`.
    pub unit: &'static str,
    /// Its limit: of the actuators or, where it is tighter, of the robot.
    pub limit: f64,
    /// Postures that were looked at.
    pub postures: usize,
    /// Whether a push that does not end before the run does acts on somebody whose limits are known: what it asks for is not counted.
    pub pushed: bool,
}

impl StaticLoad {
    /// Of the agents of a setup under (6)–(7), with states on their way, and of rotorcraft; `None` where no limit is known.
    pub(super) fn on(setup: &Setup, way: &[Led]) -> Option<StaticLoad> {
        let those: Vec<usize> = (0..setup.agents.len()).filter(|agent| limits(setup, *agent).is_some()).collect();
        let mut worst = hovering(setup);
        let (mut postures, mut evaluators) = (0, HashMap::new());
        let mut look = |agent: usize, q: &[f64]| {
            postures += 1;
            let robot = &setup.agents[agent].robot.kind;
            let evaluator =
                evaluators.entry(agent).or_insert_with(|| robot.lagrangian().map(|robot| robot.evaluator()));
            let found = evaluator.as_mut().and_then(|evaluator| load(setup, agent, &mut **evaluator, q));
            worst = match (worst.take(), found) {
                (Some(worst), Some(found)) => Some(worse(worst, found)),
                (worst, found) => worst.or(found),
            };
        };
        each_posture(setup, &those, |agent, q, _| look(agent, q));
        // A way may lead where no start is.
        way.iter().filter(|led| those.contains(&led.agent)).for_each(|led| look(led.agent, &led.q));
        let is_pushed = |agent: usize| {
            let own = &setup.agents[agent];
            let limited = those.contains(&agent) || own.robot.kind.is::<RotorcraftModel>();
            limited && own.pushes.iter().any(|push| push.span_s()[1] >= setup.time.end_s)
        };
        let pushed = (0..setup.agents.len()).any(is_pushed);
        worst.map(|found| StaticLoad { postures, pushed, ..found })
    }

    /// Whether it is the thrust of a rotorcraft, whatever its posture.
    pub(super) fn is_thrust(&self) -> bool {
        self.axis_name == THRUST
    }

    /// |g_j(q)| as a part of the limit.
    pub fn share(&self) -> f64 {
        self.torque / self.limit
    }

    /// Whether the limits suffice to stand still.
    pub fn answer(&self) -> PracticalAnswer {
        match self.share() < 1.0 {
            true if self.pushed => PracticalAnswer::NotShown,
            true => PracticalAnswer::Adequate,
            false => PracticalAnswer::Inadequate,
        }
    }
}

/// That of one agent at `q`, with what works out its dynamics.
pub(super) fn load(setup: &Setup, agent: usize, evaluator: &mut dyn Evaluator, q: &[f64]) -> Option<StaticLoad> {
    let own = &setup.agents[agent];
    let rest = vec![0.0; q.len()];
    let motion = TwoVelocity { q, dq: &rest, z: &rest, dz: &rest };
    let gravity = &evaluator.at(&own.robot.theta, motion, &rest).ok()?.model;
    let limits = limits(setup, agent)?;
    let limited = gravity.iter().map(|g| g.abs()).zip(limits).enumerate().filter(|(_, (_, limit))| limit.is_finite());
    let share = |(_, (torque, limit)): &(usize, (f64, f64))| torque / limit;
    let worst = limited.reduce(|one, other| if share(&other) > share(&one) { other } else { one });
    let (axis, (torque, limit)) = worst?;
    let Axis { name, unit, .. } = own.robot.axes.get(axis)?;
    let (agent, axis_name, unit) = (Named::of(setup, agent), name.clone(), unit.effort());
    Some(StaticLoad { agent, axis, axis_name, torque, unit, limit, postures: 1, pushed: false })
}

fn worse(one: StaticLoad, other: StaticLoad) -> StaticLoad {
    if other.share() > one.share() { other } else { one }
}

/// The rotorcraft with the least thrust to spare.
fn hovering(setup: &Setup) -> Option<StaticLoad> {
    let load = |(index, agent): (usize, &forwardstep_sim::AgentSetup)| {
        let model = agent.robot.kind.downcast::<RotorcraftModel>()?;
        let [_, most] = model.rotors.as_ref()?.thrust;
        let (agent, torque) = (Named::of(setup, index), agent.robot.theta.first()? * model.gravity);
        Some(StaticLoad {
            agent,
            axis: 0,
            axis_name: THRUST.to_owned(),
            torque,
            unit: "N",
            limit: 4.0 * most,
            postures: 1,
            pushed: false,
        })
    };
    setup.agents.iter().enumerate().filter_map(load).reduce(worse)
}

/// The limits of the torques of an agent under (6)–(7), infinite where there is none; `None` where none is known.
pub(super) fn limits(setup: &Setup, agent: usize) -> Option<Vec<f64>> {
    let own = &setup.agents[agent];
    if !is_lagrangian(own) {
        return None;
    }
    let stated = setup.control.as_ref().and_then(|control| control.actuators.torque_limit.as_ref());
    let axes = own.robot.axes.iter().enumerate();
    let all: Vec<f64> = axes
        .map(|(axis, own)| {
            let stated = stated.and_then(|limits| limits.get(axis)).copied().unwrap_or(f64::INFINITY);
            own.effort_limit.unwrap_or(f64::INFINITY).min(stated)
        })
        .collect();
    all.iter().any(|limit| limit.is_finite()).then_some(all)
}
