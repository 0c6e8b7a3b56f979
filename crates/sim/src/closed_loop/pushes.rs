//! Pushes in the closed loop: which piece of each is in force, and the external torque that it gives. Dry friction, which
//! [`super::frictions`] sets, is a part of it.

use std::sync::Arc;

use forwardstep_core::LengthError;
use forwardstep_core::plant::total;
use forwardstep_core::robot::tree::{Axes, PointWrench, Tree, TreeScratch};
use forwardstep_core::signal::Block as Signals;

use super::assemble::Block;
use super::frictions::is_acted_on;
use crate::engine::{EventOutcome, Port};
use crate::push::{AttachmentPoint, Between, Course, Effect, Push};
use crate::setup::{AgentSetup, Setup};
use crate::system::Attachments;

/// Everybody who is pushed.
#[derive(Debug, Default)]
pub(crate) struct Pushes {
    people: Vec<Placed>,
    /// What acts on all agents, a block of columns for every population; empty when no agent is pushed.
    external: Vec<f64>,
}

/// An agent that is pushed, and where its numbers stand.
#[derive(Debug)]
struct Placed {
    pushed: Pushed,
    /// Its block of the closed loop.
    block: usize,
    /// First entry in `external`.
    external: usize,
    /// Distance between two entries of its own there.
    stride: usize,
    q: Vec<f64>,
    dq: Vec<f64>,
    torque: Vec<f64>,
    /// What its dry friction takes, entry by entry, if it has any.
    rubbing: Vec<f64>,
}

impl Pushes {
    /// `ports` says where the agents' numbers stand in the `blocks`.
    pub(super) fn new(setup: &Setup, ports: &[Port], blocks: &[Block]) -> Self {
        let mut pushes = Pushes::default();
        for (index, (agent, port)) in setup.agents.iter().zip(ports).enumerate() {
            let Some(pushed) = Pushed::new(index, agent, setup.time.end_s) else { continue };
            let place = blocks.iter().enumerate().find(|(_, block)| block.degree.contains(&port.degree));
            let Some((at, block)) = place else { continue };
            pushes.people.push(Placed {
                block: at,
                external: block.external.start + (port.degree - block.degree.start),
                stride: port.stride,
                q: vec![0.0; agent.robot.axes.len()],
                dq: vec![0.0; agent.robot.velocity_len()],
                torque: vec![0.0; total(&pushed.signals)],
                rubbing: Vec::new(),
                pushed,
            });
        }
        if !pushes.people.is_empty() {
            pushes.external = vec![0.0; blocks.last().map_or(0, |block| block.external.end)];
        }
        // What begins at t = 0 is there from the start.
        let _ = pushes.happen(0.0);
        pushes
    }

    /// What acts on an agent that is pushed at some time, block by block.
    pub(crate) fn signals(&self, agent: usize) -> &[Signals] {
        let placed = self.people.iter().find(|placed| placed.pushed.agent == agent);
        placed.map_or(&[], |placed| &placed.pushed.signals)
    }

    /// Computes what acts on everybody at `t_s` in the state `x` of the `blocks`.
    pub(super) fn evaluate(&mut self, t_s: f64, x: &[f64], blocks: &mut [Block]) {
        for placed in &mut self.people {
            let Placed { pushed, block, external, stride, q, dq, torque, rubbing } = placed;
            let Block { columns, state, .. } = &mut blocks[*block];
            columns.motion(pushed.agent, t_s, &x[state.clone()], q, dq);
            let checked = pushed.torque(t_s, q, dq, torque);
            debug_assert_eq!(checked, Ok(()), "lengths are fixed when the closed loop is built");
            torque.iter_mut().zip(rubbing).for_each(|(torque, rubs)| *torque -= *rubs);
            for (k, torque) in torque.iter().enumerate() {
                self.external[*external + k * *stride] = *torque;
            }
        }
    }

    /// What [`Pushes::evaluate`] computed; `None` when no agent is ever pushed.
    pub(crate) fn external(&self) -> Option<&[f64]> {
        if self.people.is_empty() { None } else { Some(&self.external) }
    }

    /// What acts on an agent as [`Pushes::evaluate`] left it.
    pub(crate) fn external_on(&self, agent: usize) -> &[f64] {
        let placed = self.people.iter().find(|placed| placed.pushed.agent == agent);
        placed.map_or(&[], |placed| &placed.torque)
    }

    /// From now on dry friction takes this from the joints of an agent.
    pub(super) fn rub(&mut self, agent: usize, torque: &[f64]) {
        if let Some(placed) = self.people.iter_mut().find(|placed| placed.pushed.agent == agent) {
            placed.rubbing.clear();
            placed.rubbing.extend_from_slice(torque);
        }
    }

    /// What dry friction takes from the joints of every agent that has any.
    pub(super) fn rubs(&self) -> Vec<(usize, Vec<f64>)> {
        let rubbed = self.people.iter().filter(|placed| !placed.rubbing.is_empty());
        rubbed.map(|placed| (placed.pushed.agent, placed.rubbing.clone())).collect()
    }

    /// When a push begins, ends or enters another piece next, s.
    pub(crate) fn next_event_s(&self) -> f64 {
        let actions = self.people.iter().flat_map(|placed| &placed.pushed.actions);
        actions.map(Action::next_event_s).fold(f64::INFINITY, f64::min)
    }

    /// Lets everything happen that is due until `until_s`.
    pub(crate) fn happen(&mut self, until_s: f64) -> EventOutcome {
        let actions = self.people.iter_mut().flat_map(|placed| &mut placed.pushed.actions);
        actions.map(|action| action.pass(until_s)).max().unwrap_or(EventOutcome::Nothing)
    }
}

/// One agent with all that acts on it.
#[derive(Debug)]
pub(crate) struct Pushed {
    agent: usize,
    /// What its numbers are.
    signals: Vec<Signals>,
    actions: Vec<Action>,
    /// What carries forces to the joints, if the robot is a tree.
    tree: Option<(Arc<Tree>, TreeScratch<f64>)>,
}

impl Pushed {
    /// `None` when nothing ever acts on the agent.
    pub(crate) fn new(index: usize, agent: &AgentSetup, end_s: f64) -> Option<Self> {
        let actions: Vec<Action> = agent.pushes.iter().map(|push| Action::new(push.clone(), end_s)).collect();
        let attachments = agent.robot.interface().attachments;
        let signals = attachments.blocks(agent.robot.axes.len());
        let tree = match attachments {
            Attachments::Links(tree) => Some((Arc::clone(&tree), tree.scratch())),
            _ => None,
        };
        is_acted_on(agent).then_some(Pushed { agent: index, signals, actions, tree })
    }

    /// The sum of what all pushes do to the agent at `t_s`.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    pub(crate) fn torque(&mut self, t_s: f64, q: &[f64], dq: &[f64], torque: &mut [f64]) -> Result<(), LengthError> {
        torque.fill(0.0);
        for action in &self.actions {
            let Some(piece) = action.piece() else { continue };
            let tree = self.tree.as_mut().map(|(tree, scratch)| (&**tree, scratch));
            act(&action.push.effect, (piece, t_s), tree, (q, dq), torque)?;
        }
        Ok(())
    }
}

/// Adds what one push does at `t_s` by the piece in force.
fn act(
    effect: &Effect,
    (piece, t_s): (usize, f64),
    tree: Option<(&Tree, &mut TreeScratch<f64>)>,
    (q, dq): (&[f64], &[f64]),
    torque: &mut [f64],
) -> Result<(), LengthError> {
    let at = |course: &Course, k: usize| course.value_on(piece, k, t_s);
    match effect {
        Effect::Torque(course) => {
            for (k, torque) in torque.iter_mut().enumerate() {
                *torque += at(course, k);
            }
        }
        Effect::SpringOnAxes { axes, stiffness, damping, target } => {
            for (k, axis) in axes.iter().enumerate() {
                torque[*axis] += stiffness[k] * (at(target, k) - q[*axis]) - damping[k] * dq[*axis];
            }
        }
        Effect::Wrench { at: AttachmentPoint::Tip(tip), wrench } => {
            let [shoulder, elbow] = tip.torques([q[0], q[1]], [at(wrench, 0), at(wrench, 1)], at(wrench, 2));
            torque[0] += shoulder;
            torque[1] += elbow;
        }
        Effect::SpringOnPoint { at: AttachmentPoint::Tip(tip), stiffness, damping, target } => {
            let (x, dx) = tip.motion([q[0], q[1]], [dq[0], dq[1]]);
            let pull = [0, 1].map(|k| stiffness * (at(target, k) - x[k]) - damping * dx[k]);
            let [shoulder, elbow] = tip.torques([q[0], q[1]], pull, 0.0);
            torque[0] += shoulder;
            torque[1] += elbow;
        }
        Effect::Wrench { at: AttachmentPoint::Link { point, axes }, wrench } => {
            let Some((tree, scratch)) = tree else { return Ok(()) };
            let [force, moment] = [0, 3].map(|first| [0, 1, 2].map(|k| at(wrench, first + k)));
            tree.add_wrench(scratch, q, point, &PointWrench { force, moment, axes: *axes }, torque)?;
        }
        Effect::SpringOnPoint { at: AttachmentPoint::Link { point, .. }, stiffness, damping, target } => {
            let Some((tree, scratch)) = tree else { return Ok(()) };
            let moves = tree.point_motion(scratch, q, dq, point)?;
            let force =
                [0, 1, 2].map(|k| stiffness * (at(target, k) - moves.position[k]) - damping * moves.velocity[k]);
            tree.add_wrench(scratch, q, point, &PointWrench { force, moment: [0.0; 3], axes: Axes::Base }, torque)?;
        }
    }
    Ok(())
}

/// A push and how far it has come.
#[derive(Debug)]
struct Action {
    push: Push,
    span_s: [f64; 2],
    /// Where its formulas have kinks still to come, s, the next one last.
    kinks_s: Vec<f64>,
    phase: Phase,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Waiting,
    /// Between these rows of its table, if it has one.
    Acting {
        piece: usize,
    },
    Over,
}

impl Action {
    fn new(push: Push, end_s: f64) -> Self {
        let span_s = push.span_s();
        let mut kinks_s = push.course().kinks_s([span_s[0], span_s[1].min(end_s)]);
        kinks_s.reverse();
        let phase = if span_s[0] < span_s[1] { Phase::Waiting } else { Phase::Over };
        Action { push, span_s, kinks_s, phase }
    }

    fn piece(&self) -> Option<usize> {
        match self.phase {
            Phase::Acting { piece } => Some(piece),
            Phase::Waiting | Phase::Over => None,
        }
    }

    fn next_event_s(&self) -> f64 {
        match (self.phase, self.push.course()) {
            (Phase::Waiting, _) => self.span_s[0],
            (Phase::Acting { piece }, Course::Table(table)) => table.times_s[piece + 1].min(self.span_s[1]),
            (Phase::Acting { .. }, Course::Each(_)) => {
                self.kinks_s.last().map_or(self.span_s[1], |kink_s| kink_s.min(self.span_s[1]))
            }
            (Phase::Over, _) => f64::INFINITY,
        }
    }

    fn pass(&mut self, until_s: f64) -> EventOutcome {
        let mut happened = EventOutcome::Nothing;
        while self.next_event_s() <= until_s {
            let ends = self.span_s[1] <= until_s;
            let (phase, what) = match (self.phase, self.push.course()) {
                (Phase::Waiting, Course::Table(table)) => {
                    let begun = table.times_s.partition_point(|t_s| *t_s <= self.span_s[0]);
                    (Phase::Acting { piece: begun.clamp(1, table.times_s.len() - 1) - 1 }, EventOutcome::Jumped)
                }
                (Phase::Waiting, Course::Each(_)) => (Phase::Acting { piece: 0 }, EventOutcome::Jumped),
                (Phase::Acting { piece }, Course::Table(table)) if !ends => {
                    // A polygon has a kink where rows meet: the rate is continuous there, and steps may stay long.
                    let what =
                        if table.between == Between::Linear { EventOutcome::Sampled } else { EventOutcome::Jumped };
                    (Phase::Acting { piece: piece + 1 }, what)
                }
                (Phase::Acting { piece }, Course::Each(_)) if !ends => {
                    self.kinks_s.pop();
                    (Phase::Acting { piece }, EventOutcome::Sampled)
                }
                _ => (Phase::Over, EventOutcome::Jumped),
            };
            self.phase = phase;
            happened = happened.max(what);
        }
        happened
    }
}
