//! What every agent is and hears where the network jumps: just before and just after every switch and every jump of a delay.

mod variation;

pub use variation::{InputJump, InputOrder};

use variation::Variation;

use crate::closed_loop::{ClosedLoop, SetupError};
use crate::engine::{Heard, Integrator, Passed, Port, Step};
use crate::recording::Signal;
use crate::setup::Setup;

/// One agent at an instant at which what it hears may jump. Its state does not: only what is heard has two sides.
#[derive(Clone, Copy, Debug)]
pub struct NetworkJump<'a> {
    /// Index of the agent.
    pub agent: usize,
    /// The instant, s.
    pub t_s: f64,
    /// Whether the graph changed; otherwise only delays did.
    pub switched: bool,
    /// What its entries of state are: signal and axis, those of q and q̇ first, then its controller's.
    pub signals: &'a [(Signal, usize)],
    /// Its state, as many entries.
    pub state: &'a [f64],
    /// What it hears just before.
    pub before: HeardAt<'a>,
    /// What it hears just after.
    pub after: HeardAt<'a>,
    /// What acts on it from outside just before; empty when it is never pushed.
    pub external: &'a [f64],
    /// What derivatives of its inputs do, input by input.
    pub inputs: &'a [InputJump],
}

/// What one agent hears at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeardAt<'a> {
    /// Σ_j w_ij.
    pub degree: f64,
    /// Σ_j w_ij · message_j(t − T_ij), an entry per axis and channel, channel by channel.
    pub sums: &'a [f64],
}

/// Of every agent, how its inputs depend on what it hears; orders may be lower than found here where a run comes to states in which a law does
/// something else. Nothing depends on it under digital control, and where a set-valued sign is part of the reference dynamics nothing is said.
///
/// # Errors
/// [`SetupError`] when the setup has no meaning.
pub fn input_orders(setup: &Setup) -> Result<Vec<Vec<InputOrder>>, SetupError> {
    let mut closed_loop = ClosedLoop::new(setup)?;
    Ok(Variation::new(&mut closed_loop, setup.agents.len()).inputs())
}

/// Keeps what is heard at the end of every step, to set beside it what is heard at the start of the next.
pub(crate) struct JumpWatch<'a> {
    jump: &'a mut dyn FnMut(NetworkJump<'_>),
    agents: Vec<Agent>,
    variation: Variation,
    /// What all heard at the end of the last step.
    before: Heard,
    dx: Vec<f64>,
}

/// Where the numbers of one agent stand, and what they were.
struct Agent {
    port: Port,
    states: Vec<usize>,
    signals: Vec<(Signal, usize)>,
    state: Vec<f64>,
    before: Sums,
    after: Sums,
    external: Vec<f64>,
}

#[derive(Default)]
struct Sums {
    degree: f64,
    sums: Vec<f64>,
}

impl Sums {
    fn read(&mut self, heard: &Heard, port: Port) {
        self.degree = heard.degree[port.degree];
        for (c, sum) in self.sums.iter_mut().enumerate() {
            *sum = heard.sums[port.entry + c * port.stride];
        }
    }

    fn at(&self) -> HeardAt<'_> {
        HeardAt { degree: self.degree, sums: &self.sums }
    }
}

impl<'a> JumpWatch<'a> {
    /// Of the first `agents` vertices, which are not the leader.
    pub(crate) fn new(
        closed_loop: &mut ClosedLoop<'_>,
        agents: usize,
        jump: &'a mut dyn FnMut(NetworkJump<'_>),
    ) -> Self {
        let variation = Variation::new(closed_loop, agents);
        let (ports, entries) = closed_loop.ports();
        let before = Heard { degree: vec![0.0; ports.len()], sums: vec![0.0; ports.len() * entries] };
        let sums = || Sums { degree: 0.0, sums: vec![0.0; entries] };
        let agent = |port: Port| Agent {
            port,
            states: Vec::new(),
            signals: Vec::new(),
            state: Vec::new(),
            before: sums(),
            after: sums(),
            external: Vec::new(),
        };
        let mut agents: Vec<Agent> = ports.into_iter().take(agents).map(agent).collect();
        for state in 0..closed_loop.start().len() {
            let (agent, signal, axis) = closed_loop.locate(state);
            // The balance is no part of the motion.
            if let Some(agent) = agents.get_mut(agent).filter(|_| signal != Signal::Dissipation) {
                agent.states.push(state);
                agent.signals.push((signal, axis));
            }
        }
        let dx = vec![0.0; closed_loop.start().len()];
        JumpWatch { jump, agents, variation, before, dx }
    }

    /// Looks at `step`, the last that was made.
    pub(crate) fn look(&mut self, integrator: &mut Integrator<'_>, closed_loop: &mut ClosedLoop<'_>, step: Step) {
        if closed_loop.samples().is_some() {
            return;
        }
        let Passed { switched, jumped } = integrator.passed();
        if jumped {
            let (x, heard) = integrator.look_inside(step.start_s);
            let jumps = self.variation.jumps(closed_loop, step.start_s, x, [&self.before, heard]);
            for (index, agent) in self.agents.iter_mut().enumerate() {
                agent.after.read(heard, agent.port);
                agent.state.clear();
                agent.state.extend(agent.states.iter().map(|state| x[*state]));
                (self.jump)(NetworkJump {
                    agent: index,
                    t_s: step.start_s,
                    switched,
                    signals: &agent.signals,
                    state: &agent.state,
                    before: agent.before.at(),
                    after: agent.after.at(),
                    external: &agent.external,
                    inputs: &jumps[index],
                });
            }
        }
        let (x, heard) = integrator.look_inside(step.end_s);
        if jumped {
            // What is asked of the last evaluation is asked of the end of the step.
            closed_loop.rates_inside(step.end_s, x, heard, &mut self.dx);
        }
        self.before.degree.clone_from(&heard.degree);
        self.before.sums.clone_from(&heard.sums);
        closed_loop.push(step.end_s, x);
        for (index, agent) in self.agents.iter_mut().enumerate() {
            agent.before.read(heard, agent.port);
            agent.external.clear();
            agent.external.extend_from_slice(closed_loop.external_on(index));
        }
    }
}
