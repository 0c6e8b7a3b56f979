//! All populations with what joins them: the right-hand side as a whole, and its events.

mod running;

use std::ops::Range;

use forwardstep_core::agent::Clipped;
use forwardstep_core::controller::Singularity;
use forwardstep_core::plant::total;
use forwardstep_core::sampled::Recipe;

use super::assembly::Assembly;
use super::columns::{Columns, Inputs};
use super::driven::Driven;
use super::error::SetupError;
use super::frictions::{Frictions, is_acted_on};
use super::injected::Energy;
use super::leader_block::LeaderBlock;
use super::members::batches;
use super::pushes::Pushes;
use super::recipes::built;
use super::references::Transmission;
use super::sampling::Sampling;
use super::sliding::{Place, Slider};
use super::valid::{message_len, validate};
use crate::engine::{Heard, Port, Refuted};
use crate::leader::{Following, FollowingDesign};
use crate::recording::{ClippedSamples, Drive, GainRates, SampleTaken, Signal};
use crate::setup::{Control, Setup};

/// All populations and where their blocks stand.
pub(crate) struct ClosedLoop<'a> {
    blocks: Vec<Block>,
    ports: Vec<Port>,
    entries: usize,
    start: Vec<f64>,
    /// When control is digital.
    sampling: Option<Sampling<'a>>,
    /// When there are set-valued signs and control is continuous.
    slider: Option<Slider<'a>>,
    /// Where q₀ stands in the state, when there is a leader.
    leader: Option<Port>,
    /// When it is an agent.
    driven: Option<Driven>,
    pushes: Pushes,
    /// When some agents have dry friction.
    frictions: Option<Frictions>,
    /// When a target has its next kink, s.
    kink_s: f64,
    /// A row of the recording of an agent that is pushed or follows a leader.
    row: Vec<f64>,
    axes: usize,
}

/// One population and its part of everything.
pub(super) struct Block {
    pub(super) columns: Box<dyn Columns>,
    pub(super) state: Range<usize>,
    pub(super) degree: Range<usize>,
    pub(super) sums: Range<usize>,
    /// Its part of what acts from outside.
    pub(super) external: Range<usize>,
}

impl Block {
    /// Its part of columns with an entry per axis.
    pub(super) fn columns_range(&self, axes: usize) -> Range<usize> {
        self.degree.start * axes..self.degree.end * axes
    }

    /// The population's part of what is heard, and of the external torques.
    pub(super) fn inputs<'a>(&self, heard: &'a Heard, external: Option<&'a [f64]>) -> Inputs<'a> {
        Inputs {
            degree: &heard.degree[self.degree.clone()],
            sums: &heard.sums[self.sums.clone()],
            external: external.map(|external| &external[self.external.clone()]).filter(|own| !own.is_empty()),
        }
    }
}

impl<'a> ClosedLoop<'a> {
    /// Checks a setup and builds its closed loop.
    pub(crate) fn new(setup: &'a Setup) -> Result<Self, SetupError> {
        validate(setup)?;
        let transmitted = Transmission::of(setup.exchange);
        let axes = setup.agents[0].robot.axes.len();
        let following = setup.following();
        let sliding = following.map(|following| following.sliding());
        let entries = message_len(setup);
        let mut closed_loop = ClosedLoop {
            blocks: Vec::new(),
            ports: vec![Port { state: 0, entry: 0, degree: 0, stride: 0 }; setup.network.agents],
            entries,
            start: Vec::new(),
            sampling: None,
            slider: None,
            leader: None,
            driven: following.and_then(|following| Driven::new(following, axes)),
            pushes: Pushes::default(),
            frictions: None,
            kink_s: f64::INFINITY,
            row: Vec::new(),
            axes,
        };
        let (mut placed, mut external) = (0, 0);
        for group in batches(setup) {
            let n = group.len();
            let columns = setup.agents[group[0]].law.block(&Assembly::new(setup, &group))?.0;
            let robot = &setup.agents[group[0]].robot;
            let pushed = group.iter().any(|agent| is_acted_on(&setup.agents[*agent]));
            let each = if pushed { total(&robot.interface().attachments.blocks(robot.axes.len())) } else { 0 };
            let outside = external..external + n * each;
            external = outside.end;
            let first = closed_loop.start.len();
            columns.append_start(&setup.agents, &mut closed_loop.start);
            let transmitted = first + columns.message();
            for (i, &agent) in group.iter().enumerate() {
                closed_loop.ports[agent] =
                    Port { state: transmitted + i, entry: placed * entries + i, degree: placed + i, stride: n };
            }
            closed_loop.blocks.push(Block {
                state: first..closed_loop.start.len(),
                degree: placed..placed + n,
                sums: placed * entries..(placed + n) * entries,
                external: outside,
                columns,
            });
            placed += n;
        }
        // An agent that leads tells where it is.
        closed_loop.leader = setup.leader().and_then(|vertex| closed_loop.ports.get(vertex)).copied();
        if let Some(leader) = following.and_then(Following::motion) {
            let transmitted = following.filter(|following| following.design == FollowingDesign::Composite);
            let composite = transmitted.map(|following| [following.alpha, following.beta]);
            let guide = Box::new(LeaderBlock::new(leader, composite, placed, setup.time.end_s)?);
            let first = closed_loop.start.len();
            guide.append_start(&setup.agents, &mut closed_loop.start);
            let transmitted = first + guide.message();
            let place = Port { state: first, entry: placed * entries, degree: placed, stride: 1 };
            closed_loop.leader = Some(place);
            closed_loop.ports[placed] = Port { state: transmitted, ..place };
            closed_loop.blocks.push(Block {
                state: first..closed_loop.start.len(),
                degree: placed..placed + 1,
                sums: placed * entries..(placed + 1) * entries,
                // Nothing acts on it.
                external: external..external,
                columns: guide,
            });
        }
        closed_loop.start_references(setup, transmitted.channels() * axes)?;
        if let (Some(following), Some(sliding), None) = (following, sliding, &setup.control) {
            let places = closed_loop.places();
            let states = closed_loop.start.len();
            closed_loop.slider = Some(Slider::new(&setup.network, sliding, following.period_s, axes, places, states));
        }
        if let Some(control) = &setup.control {
            for block in &mut closed_loop.blocks {
                let recipes = block.columns.recipes(setup, &closed_loop.start[block.state.clone()])?;
                let build = |(agent, recipe): (usize, Recipe)| built(&recipe, &setup.agents[agent].name);
                block.columns.sample(control, recipes.into_iter().map(build).collect::<Result<_, _>>()?);
            }
            let ClosedLoop { ports, start, .. } = &closed_loop;
            closed_loop.sampling = Some(Sampling::new(setup, control, ports.clone(), entries, start));
        }
        closed_loop.pushes = Pushes::new(setup, &closed_loop.ports, &closed_loop.blocks);
        closed_loop.frictions = Frictions::new(setup, &closed_loop.ports, &closed_loop.blocks);
        closed_loop.kink_s = closed_loop.next_kink_s(0.0);
        let longest = closed_loop.blocks.iter().map(|block| block.columns.signals().len()).max();
        closed_loop.row = Vec::with_capacity(longest.unwrap_or(0) + external + axes);
        Ok(closed_loop)
    }

    /// From the wanted z(0), ż(0), … to reference states, with what everybody hears at t = 0: the initial messages.
    /// Of every message as many entries are heard as flow.
    fn start_references(&mut self, setup: &Setup, flowing: usize) -> Result<(), SetupError> {
        let Heard { degree, sums } = self.heard_at_start(setup, flowing);
        for block in &mut self.blocks {
            let (degree, sums) = (&degree[block.degree.clone()], &sums[block.sums.clone()]);
            block
                .columns
                .start(&setup.agents, &mut self.start[block.state.clone()], degree, sums)
                .map_err(|error| SetupError::Length { agent: setup.agents[0].name.clone(), error })?;
        }
        Ok(())
    }

    /// What everybody hears if the messages are those of the start.
    fn heard_at_start(&self, setup: &Setup, flowing: usize) -> Heard {
        let graph = setup.network.schedule.segments().next().map_or(0, |segment| segment.graph);
        let mut degree = vec![0.0; self.ports.len()];
        let mut sums = vec![0.0; self.ports.len() * self.entries];
        let coupling = setup.network.coupling;
        for edge in setup.network.schedule.graph(graph) {
            let (from, to) = (self.ports[edge.from], self.ports[edge.to]);
            let weight = setup.network.weight_at(edge.weight, 0.0);
            degree[to.degree] += weight;
            for c in 0..flowing {
                let (own, sent) = (self.start[to.state + c * to.stride], self.start[from.state + c * from.stride]);
                let taken = if coupling.is_linear() { sent } else { coupling.taken(own, sent) };
                sums[to.entry + c * to.stride] += weight * taken;
            }
        }
        Heard { degree, sums }
    }

    /// Where the columns of every vertex stand that have an entry per axis.
    fn places(&self) -> Vec<Place> {
        let place = |port: &Port| {
            let block = self.blocks.iter().find(|block| block.degree.contains(&port.degree));
            let start = block.map_or(0, |block| block.degree.start);
            Place { first: start * self.axes + port.degree - start, stride: port.stride, degree: port.degree }
        };
        self.ports.iter().map(place).collect()
    }

    /// The largest rest of the inclusion that the signs solve; `None` when there are no signs, or nothing is solved.
    pub(crate) fn sign_residual(&self) -> Option<f64> {
        self.slider.as_ref().and_then(Slider::residual)
    }

    fn next_kink_s(&self, after_s: f64) -> f64 {
        self.blocks.iter().map(|block| block.columns.next_event_s(after_s)).fold(f64::INFINITY, f64::min)
    }

    /// Who is in trouble in the state `x`, which has just been evaluated.
    pub(crate) fn trouble(&mut self, x: &[f64]) -> Option<(usize, Singularity)> {
        self.blocks.iter_mut().find_map(|block| block.columns.trouble(&x[block.state.clone()]))
    }

    /// The position and the velocity of an agent in the state `x`.
    pub(crate) fn motion(&mut self, agent: usize, t_s: f64, x: &[f64], q: &mut [f64], dq: &mut [f64]) {
        let degree = self.ports[agent].degree;
        if let Some(block) = self.blocks.iter_mut().find(|block| block.degree.contains(&degree)) {
            block.columns.motion(agent, t_s, &x[block.state.clone()], q, dq);
        }
    }

    /// Takes note of the end of a step, in a state that has just been evaluated.
    pub(crate) fn reached(&mut self, t_s: f64) {
        if let Some(driven) = &mut self.driven {
            driven.look(t_s);
        }
    }

    /// What drove an agent that leads the others.
    pub(crate) fn drive(&self) -> Option<Drive> {
        self.driven.as_ref().and_then(Driven::seen)
    }

    /// The last delay that was found, at a sample, not to be what its author says.
    pub(crate) fn refuted(&self) -> Option<Refuted> {
        self.sampling.as_ref()?.refuted()
    }

    /// Hands every sample that is taken to `watch`.
    pub(crate) fn watch(&mut self, watch: &'a mut dyn FnMut(SampleTaken<'_>)) {
        if let Some(sampling) = &mut self.sampling {
            sampling.watch(watch);
        }
    }

    /// The recipes of the sampled controllers of all agents, in order.
    pub(crate) fn recipes(&self, setup: &Setup) -> Result<Vec<Recipe>, SetupError> {
        let mut all = Vec::new();
        for block in &self.blocks {
            all.extend(block.columns.recipes(setup, &self.start[block.state.clone()])?);
        }
        all.sort_by_key(|(agent, _)| *agent);
        Ok(all.into_iter().map(|(_, recipe)| recipe).collect())
    }

    /// Steps of sampled controllers that failed, where a safe command stands then.
    pub(crate) fn failed_steps(&self) -> u64 {
        let mut failed = 0;
        for block in &self.blocks {
            block.columns.taken(&mut |digital| failed += digital.failures().1);
        }
        failed
    }

    /// Commands of sampled controllers that their limits changed.
    pub(crate) fn clipped(&self) -> ClippedSamples {
        let mut all = ClippedSamples::default();
        for block in &self.blocks {
            block.columns.taken(&mut |digital| {
                let (samples, Clipped { torque, rate }) = digital.clipped();
                all.samples += samples;
                all.torque += torque;
                all.rate += rate;
            });
        }
        all
    }

    /// The initial state.
    pub(crate) fn start(&self) -> Vec<f64> {
        self.start.clone()
    }

    /// Where the messages that flow stand, and how many numbers one has: none when control is digital.
    pub(crate) fn ports(&self) -> (Vec<Port>, usize) {
        (self.ports.clone(), if self.sampling.is_some() { 0 } else { self.entries })
    }

    /// Agent, signal and axis of a state.
    pub(crate) fn locate(&self, state: usize) -> (usize, Signal, usize) {
        let block = self.blocks.iter().find(|block| block.state.contains(&state));
        block.map_or((0, Signal::Position, 0), |block| block.columns.locate(state - block.state.start))
    }

    /// The rates of the gains of one agent in the state `x`, which has just been evaluated; `None` for other laws than (6)–(7),
    /// and for gains that act at samples.
    pub(crate) fn gain_rates(&mut self, agent: usize, x: &[f64]) -> Option<GainRates> {
        let degree = self.ports.get(agent)?.degree;
        let block = self.blocks.iter_mut().find(|block| block.degree.contains(&degree))?;
        block.columns.gain_rates(agent, &x[block.state.clone()])
    }

    /// Samples taken so far; `None` when control is continuous.
    pub(crate) fn samples(&self) -> Option<u64> {
        self.sampling.as_ref().map(Sampling::taken)
    }

    /// The last sample of every agent; nothing when control is continuous or none was taken.
    pub(crate) fn last_samples(&self, each: &mut dyn FnMut(SampleTaken<'_>)) {
        if let Some((sample, now_s)) = self.sampling.as_ref().and_then(Sampling::last) {
            self.blocks.iter().for_each(|block| block.columns.taken(&mut |digital| each(digital.taken(sample, now_s))));
        }
    }

    /// Agent, axis and value of the largest velocity in the state `x`.
    pub(crate) fn fastest(&self, x: &[f64]) -> Option<(usize, usize, f64)> {
        let velocities = x.iter().enumerate().filter_map(|(state, value)| match self.locate(state) {
            (agent, Signal::Velocity, axis) => Some((agent, axis, *value)),
            _ => None,
        });
        velocities.reduce(|a, b| if b.2.abs() > a.2.abs() { b } else { a })
    }

    /// The signals of every agent, in the order of agents.
    pub(crate) fn signals(&self, agents: usize) -> Vec<Vec<(Signal, usize)>> {
        let mut signals = vec![Vec::new(); agents];
        for block in &self.blocks {
            for (agent, port) in self.ports.iter().enumerate().take(agents) {
                if block.degree.contains(&port.degree) {
                    signals[agent] = block.columns.signals();
                }
            }
        }
        for (agent, signals) in signals.iter_mut().enumerate() {
            let external = self.pushes.signals(agent).iter();
            signals.extend(external.flat_map(|(signal, n)| (0..*n).map(|entry| (*signal, entry))));
        }
        if self.leader.is_some() {
            // An agent that leads has an error of its own.
            let leads = self.driven.as_ref().map(|driven| driven.agent);
            let followers = signals.iter_mut().enumerate().filter(|(agent, _)| Some(*agent) != leads);
            followers.for_each(|(_, signals)| signals.extend((0..self.axes).map(|axis| (Signal::Error, axis))));
        }
        signals
    }

    /// The inputs of every agent's plant, and where each stands in a row of [`ClosedLoop::record`].
    pub(crate) fn inputs(&self, agents: usize) -> Vec<Vec<(Signal, Range<usize>)>> {
        let of = |port: &Port| self.blocks.iter().find(|block| block.degree.contains(&port.degree));
        let inputs = |port| of(port).map_or_else(Vec::new, |block| block.columns.inputs());
        self.ports.iter().take(agents).map(inputs).collect()
    }

    /// Traces commands under digital control to what they came from.
    pub(crate) fn trace(&mut self, control: &Control) {
        self.blocks.iter_mut().for_each(|block| block.columns.trace(control));
    }

    /// Hands V and the parts of V̇ of every agent whose commands are traced to `each`, by its number.
    pub(crate) fn energies(&mut self, t_s: f64, x: &[f64], heard: &Heard, each: &mut dyn FnMut(usize, Energy)) {
        let heard = self.sampling.as_ref().map_or(heard, Sampling::heard);
        self.pushes.evaluate(t_s, x, &mut self.blocks);
        for block in &mut self.blocks {
            let inputs = block.inputs(heard, self.pushes.external());
            block.columns.energies(t_s, &x[block.state.clone()], inputs, each);
        }
    }

    /// What dry friction takes from the joints of every agent that has any.
    pub(crate) fn rubs(&self) -> Vec<(usize, Vec<f64>)> {
        self.pushes.rubs()
    }

    /// Whether set-valued signs are set in continuous time.
    pub(crate) fn has_signs(&self) -> bool {
        self.slider.is_some()
    }
}
