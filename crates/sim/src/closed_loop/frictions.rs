//! Dry friction in the closed loop: when σ ∈ Sgn q̇ is set, and from what.
//!
//! Set-valued friction is held over a period, as the set-valued signs of a leader's followers are, and set anew at every event between: a
//! torque that jumps moves a joint that sticks. See [`Stick`] for what is solved.

use forwardstep_core::robot::{Drives, Stick};

use super::assemble::Block;
use super::pushes::Pushes;
use crate::agents::Evaluator;
use crate::engine::{Heard, Port};
use crate::recording::Signal;
use crate::setup::{AgentSetup, Setup};

/// Instants that are closer than this share of a period are one.
const ROUNDING: f64 = 1e-9;

/// Everybody with dry friction.
pub(super) struct Frictions {
    each: Vec<Rubbed>,
    period_s: f64,
    /// How many regular instants have passed.
    set: u64,
    rates: Vec<f64>,
}

/// An agent with dry friction, and where its numbers stand.
struct Rubbed {
    agent: usize,
    block: usize,
    robot: Box<dyn Evaluator>,
    theta: Vec<f64>,
    /// F of each joint that rubs.
    forces: Vec<f64>,
    stick: Stick,
    /// Where q̇ stands in the state of its block, joint by joint.
    velocities: Vec<usize>,
    q: Vec<f64>,
    dq: Vec<f64>,
    ddq: Vec<f64>,
}

/// The drives of an agent and the longest period over which its dry friction is held, s; `None` when it has none.
pub(super) fn dry_friction(agent: &AgentSetup) -> Option<(Drives, f64)> {
    let drives = agent.robot.interface().drives;
    let period_s = drives.dry_s.filter(|_| !drives.friction.is_empty())?;
    Some((drives, period_s))
}

/// Whether something ever acts on an agent from outside of its law: a push or dry friction.
pub(super) fn is_acted_on(agent: &AgentSetup) -> bool {
    !agent.pushes.is_empty() || dry_friction(agent).is_some()
}

impl Frictions {
    /// `ports` says where the agents' numbers stand in the `blocks`; `None` when nothing rubs dryly.
    pub(super) fn new(setup: &Setup, ports: &[Port], blocks: &[Block]) -> Option<Self> {
        let mut each = Vec::new();
        let mut period_s = f64::INFINITY;
        for (index, (agent, port)) in setup.agents.iter().zip(ports).enumerate() {
            let (Some((drives, own_s)), Some(robot)) = (dry_friction(agent), agent.robot.kind.lagrangian()) else {
                continue;
            };
            let place = blocks.iter().enumerate().find(|(_, block)| block.degree.contains(&port.degree));
            let Some((block, Block { columns, state, .. })) = place else { continue };
            let n = agent.robot.axes.len();
            let forces = agent.robot.drive_parameters(&drives).map_or_else(Vec::new, |[.., forces]| forces.to_vec());
            let mut velocities = vec![0; n];
            for at in 0..state.len() {
                if let (found, Signal::Velocity, axis) = columns.locate(at)
                    && found == index
                {
                    velocities[axis] = at;
                }
            }
            period_s = period_s.min(own_s);
            let joints = || vec![0.0; n];
            each.push(Rubbed {
                agent: index,
                block,
                robot: robot.evaluator(),
                theta: agent.robot.theta.clone(),
                forces,
                stick: Stick::new(&drives, n),
                velocities,
                q: joints(),
                dq: joints(),
                ddq: joints(),
            });
        }
        let states = blocks.last().map_or(0, |block| block.state.end);
        (!each.is_empty()).then(|| Frictions { each, period_s, set: 0, rates: vec![0.0; states] })
    }

    /// When friction is set next, s.
    pub(super) fn next_s(&self) -> f64 {
        self.set as f64 * self.period_s
    }

    /// Sets friction at `now_s` in the state `x`, by what is `heard` then.
    pub(super) fn set(&mut self, now_s: f64, heard: &Heard, pushes: &mut Pushes, blocks: &mut [Block], x: &[f64]) {
        // The regular instants that this one is past or at.
        self.set = self.set.max((now_s / self.period_s) as u64);
        while self.next_s() <= now_s + ROUNDING * self.period_s {
            self.set += 1;
        }
        let h_s = self.next_s() - now_s;
        pushes.evaluate(now_s, x, blocks);
        // Agents that follow one another mostly share a block.
        let mut evaluated = None;
        for rubbed in &mut self.each {
            let Rubbed { agent, block, robot, theta, forces, stick, velocities, q, dq, ddq } = rubbed;
            let Some(own) = blocks.get_mut(*block) else { continue };
            if evaluated.replace(*block) != Some(*block) {
                let (inputs, rates) = (own.inputs(heard, pushes.external()), &mut self.rates[own.state.clone()]);
                own.columns.rates(now_s, &x[own.state.clone()], inputs, rates);
            }
            let Block { columns, state, .. } = own;
            columns.motion(*agent, now_s, &x[state.clone()], q, dq);
            for (ddq, at) in ddq.iter_mut().zip(velocities) {
                *ddq = self.rates[state.start + *at];
            }
            let checked = robot.mass(theta, q).and_then(|mass| stick.set(h_s, mass, forces, [dq, ddq]));
            debug_assert_eq!(checked, Ok(()), "lengths are fixed when the closed loop is built");
            pushes.rub(*agent, stick.torque());
        }
    }
}
