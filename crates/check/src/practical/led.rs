//! States that references lead robots through before any robot is simulated: along the linear reference dynamics with s ≡ 0, along the
//! motion of a leader, along a target. A sample, no proof.

use forwardstep_core::controller::Jet;
use forwardstep_sim::Setup;
use forwardstep_sim::busy::busy_rows;
use forwardstep_sim::recording::Signal;
use forwardstep_sim::trajectory::Trajectory;

use super::along::Columns;
use crate::kinds::is_lagrangian;
use crate::prediction::{reference_alone, reference_behind, reference_closely};

/// States that are looked at in all, and of one agent.
const MOST: usize = 1024;
const MOST_OF_ONE: usize = 200;

/// The same where integrals are taken over them.
const MOST_CLOSE: usize = 40_000;
const MOST_CLOSE_OF_ONE: usize = 2000;

/// Work for the reference dynamics, in nanoseconds, roughly: what they reach with it is looked at.
const WORK: f64 = 2e8;

/// A state: q, z = q̇ and ż, which in a motion that is followed lacks what the sign adds.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Led {
    pub(super) agent: usize,
    pub(super) t_s: f64,
    pub(super) q: Vec<f64>,
    pub(super) dq: Vec<f64>,
    pub(super) dz: Vec<f64>,
    /// Whether the sign of a reference that follows a leader is in ż.
    pub(super) has_sign: bool,
    /// Where it is a moment later, which tells how fast all of it changes: the next state of a way may be far.
    pub(super) soon: Option<Box<Led>>,
}

impl Led {
    /// The state of an agent with so many axes in a row, where that has all that is needed.
    pub(super) fn recorded(columns: &Columns<'_>, t_s: &[f64], [agent, axes]: [usize; 2], row: usize) -> Option<Led> {
        let state = |row: usize| {
            let signal = |signal| columns.at(agent, signal, axes, row);
            let [q, dq, dz] = [Signal::Position, Signal::Velocity, Signal::Reference(1)].map(signal);
            Some(Led { agent, t_s: *t_s.get(row)?, q: q?, dq: dq?, dz: dz?, has_sign: true, soon: None })
        };
        Some(Led { soon: state(row + 1).map(Box::new), ..state(row)? })
    }

    /// The setup as it would start if its agent were here.
    pub(super) fn put_into(&self, setup: &Setup) -> Setup {
        let mut there = setup.clone();
        let tracks = setup.tracks(self.agent);
        let agent = &mut there.agents[self.agent];
        (agent.start.q, agent.start.dq) = (self.q.clone(), self.dq.clone());
        // Left out, z is q̇ and what follows is zero, as at rest. A target of as many roots leads to one derivative less.
        let states = if tracks { agent.roots_per_s.len().saturating_sub(1) } else { 0 };
        agent.start.reference = [&self.dq, &self.dz].into_iter().take(states).cloned().collect();
        there
    }
}

/// How states are taken from a recording.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Pace {
    /// At even times.
    Even,
    /// Close to each other where much happens, so that what is passed through can be integrated: a start that takes ten seconds of an hour is in
    /// no state of an even pace.
    Close,
}

/// States of all agents under (6)–(7) on their way. It takes a run of the reference dynamics: worked out once, and handed to whoever looks.
pub(super) fn way(setup: &Setup, pace: Pace) -> Vec<Led> {
    let those: Vec<usize> = (0..setup.agents.len()).filter(|agent| is_lagrangian(&setup.agents[*agent])).collect();
    states(setup, &those, pace)
}

/// States of `agents` on their way; none where nothing is known of it, or there are too many.
fn states(setup: &Setup, agents: &[usize], pace: Pace) -> Vec<Led> {
    let each = match pace {
        Pace::Even => (MOST / agents.len().max(1)).min(MOST_OF_ONE),
        Pace::Close => (MOST_CLOSE / agents.len().max(1)).min(MOST_CLOSE_OF_ONE),
    };
    if each < 2 {
        return Vec::new();
    }
    let leader = setup.following().and_then(|following| Some(&following.motion()?.trajectory));
    let alone = if agents.iter().all(|agent| setup.tracks(*agent)) {
        None
    } else if setup.following().is_some() {
        reference_behind(setup, WORK)
    } else {
        match pace {
            Pace::Even => reference_alone(setup, WORK),
            Pace::Close => reference_closely(setup, WORK),
        }
    };
    let columns = alone.as_ref().map(|recording| (Columns::of(recording), &recording.t_s));
    let end_s = setup.time.end_s;
    let step_s = setup.control.as_ref().map(|control| 1.0 / control.sample_hz);
    let mut found = Vec::new();
    for &agent in agents {
        let own = &setup.agents[agent];
        let axes = own.robot.axes.len();
        let (motion, columns) = match setup.tracks(agent) {
            true => (own.target.as_ref(), None),
            false => (leader, columns.as_ref()),
        };
        let rows = if columns.is_some() && motion.is_some() { (each / 2).max(2) } else { each };
        found.extend(columns.iter().flat_map(|(columns, t_s)| recorded(columns, t_s, [agent, axes], rows, pace)));
        // Who follows a leader is with it where work did not lead.
        let reached_s = found.last().filter(|led| led.agent == agent).map_or(f64::NEG_INFINITY, |led| led.t_s);
        let motion = motion.filter(|motion| motion.axes() == axes);
        found.extend(
            motion
                .iter()
                .flat_map(|motion| along(motion, agent, end_s, rows, step_s))
                .filter(|led| led.t_s > reached_s),
        );
    }
    found
}

/// A motion at `each` times up to the end, and so much later.
fn along(motion: &Trajectory, agent: usize, end_s: f64, each: usize, step_s: Option<f64>) -> impl Iterator<Item = Led> {
    let mut jets = vec![Jet::default(); motion.axes()];
    let mut state = move |t_s: f64| {
        motion.jets(t_s, &mut jets);
        let derivative = |r: usize| jets.iter().map(|jet| jet[r]).collect();
        Led { agent, t_s, q: derivative(0), dq: derivative(1), dz: derivative(2), has_sign: false, soon: None }
    };
    (0..each).map(move |step| {
        let t_s = end_s * step as f64 / (each - 1) as f64;
        Led { soon: step_s.map(|step_s| Box::new(state(t_s + step_s))), ..state(t_s) }
    })
}

/// An agent with so many axes at `each` rows of so many, where they have all that is needed.
fn recorded(columns: &Columns<'_>, t_s: &[f64], [agent, axes]: [usize; 2], each: usize, pace: Pace) -> Vec<Led> {
    let last = t_s.len().saturating_sub(1);
    let mut rows: Vec<usize> = match pace {
        Pace::Even => (0..each).map(|k| k * last / (each - 1)).collect(),
        Pace::Close => busy(columns, t_s.len(), [agent, axes], each),
    };
    rows.dedup();
    rows.into_iter().filter_map(|row| Led::recorded(columns, t_s, [agent, axes], row)).collect()
}

/// Rows of one of so many agents that are close enough for integrals.
pub(super) fn close_rows(columns: &Columns<'_>, rows: usize, [agent, axes]: [usize; 2], agents: usize) -> Vec<usize> {
    busy(columns, rows, [agent, axes], (MOST_CLOSE / agents.max(1)).clamp(2, MOST_CLOSE_OF_ONE))
}

/// At most so many rows, close to each other where q̇ and ż of an agent change.
fn busy(columns: &Columns<'_>, rows: usize, [agent, axes]: [usize; 2], each: usize) -> Vec<usize> {
    let signals = [Signal::Velocity, Signal::Reference(1)];
    let all =
        signals.into_iter().flat_map(|signal| (0..axes).filter_map(move |axis| columns.column(agent, signal, axis)));
    busy_rows(rows, each, all)
}
