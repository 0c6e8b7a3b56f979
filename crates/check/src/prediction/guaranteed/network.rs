//! The positive network: every component moves towards others, whatever it is and whenever they were.

use forwardstep_core::expression::Interval;
use forwardstep_sim::Setup;
use forwardstep_sim::graph::Weight;

use super::super::cascade;
use super::super::ideal::ideal;
use super::NoGuaranteedRate;

/// Components that are followed from all of them.
pub(super) const MOST_COMPONENTS: usize = 96;
/// Weights below this count as nothing where they help, and as this where they hinder: no product of them is lost to underflow.
const LEAST_WEIGHT: f64 = 1e-60;

/// A network of first-order lags, ẋ = Σ a (u − x) with u the entries of other components, now or earlier: the cascaded variables of all
/// agents, one agent after the other, ψ₀ first.
#[derive(Debug)]
pub(super) struct Network {
    /// The setup in which every agent follows exactly.
    pub(super) ideal: Setup,
    /// The first component of every agent, and the number of all.
    pub(super) first: Vec<usize>,
    /// κ of the component where it follows the next one of its agent; none for the last of an agent.
    pub(super) kappa: Vec<Option<f64>>,
    /// How many components an agent sends, beginning with ψ₀.
    pub(super) sent: usize,
    /// No message is older, s.
    pub(super) window_s: f64,
}

/// What the last component of an agent moves towards: a part of what it hears.
#[derive(Clone, Copy, Debug)]
pub(super) struct Input {
    /// The component, of the sender.
    pub(super) of: usize,
    /// Index of its delay.
    pub(super) delay: usize,
    /// How strongly, over a stretch of time, 1/s.
    pub(super) rate: Interval,
}

impl Network {
    pub(super) fn of(setup: &Setup) -> Result<Network, NoGuaranteedRate> {
        let end_s = setup.time.end_s;
        let ideal = ideal(setup)?;
        cascade::defined(&ideal)?;
        if !(end_s > 0.0 && end_s.is_finite()) {
            return Err(NoGuaranteedRate::Horizon { end_s });
        }
        if ideal.agents.len() < 2 || ideal.agents.len() != ideal.network.agents {
            return Err(NoGuaranteedRate::Agents);
        }
        ideal.network.validate(end_s)?;
        ideal.network.lasts_until(end_s)?;
        let valid = |roots: &[f64]| !roots.is_empty() && roots.iter().all(|root| *root > 0.0 && root.is_finite());
        if let Some(agent) = ideal.agents.iter().position(|agent| !valid(&agent.roots_per_s.real)) {
            return Err(NoGuaranteedRate::Roots { agent });
        }
        let (mut first, mut kappa) = (Vec::new(), Vec::new());
        for agent in &ideal.agents {
            first.push(kappa.len());
            kappa.extend(agent.roots_per_s.real.iter().copied().map(Some));
            kappa.push(None);
        }
        if kappa.len() > MOST_COMPONENTS {
            return Err(NoGuaranteedRate::TooLarge { components: kappa.len() });
        }
        let sent = if ideal.exchange.has_velocities() { 2 } else { 1 };
        let window_s = ideal.network.max_delay_s();
        let network = Network { ideal, first, kappa, sent, window_s };
        Ok(network)
    }

    /// How many components there are.
    pub(super) fn components(&self) -> usize {
        self.kappa.len()
    }

    /// The components that are sent.
    pub(super) fn all_sent(&self) -> impl Iterator<Item = usize> + '_ {
        self.first.iter().flat_map(|first| *first..*first + self.sent)
    }

    /// The place of a component among those that are sent, of an agent that sends it.
    pub(super) fn place(&self, agent: usize, part: usize) -> usize {
        agent * self.sent + part
    }

    /// What every agent hears while a graph is in force, over a stretch of time: for every agent its inputs, with the sender.
    pub(super) fn inputs(&self, graph: usize, over: Interval) -> Vec<Vec<(usize, Input)>> {
        let mut inputs = vec![Vec::new(); self.first.len()];
        for edge in self.ideal.network.schedule.graph(graph) {
            let rate = self.weight(edge.weight, over);
            let input = |part: usize, share: f64| {
                let rate = Interval { low: share * rate.low, high: share * rate.high };
                (self.place(edge.from, part), Input { of: self.first[edge.from] + part, delay: edge.delay, rate })
            };
            if !self.ideal.exchange.has_velocities() {
                inputs[edge.to].push(input(0, 1.0));
                continue;
            }
            let root = |agent: usize| self.ideal.agents[agent].roots_per_s.real[0];
            let share = (root(edge.from) / root(edge.to)).min(1.0);
            inputs[edge.to].push(input(1, share));
            if share < 1.0 {
                inputs[edge.to].push(input(0, 1.0 - share));
            }
        }
        inputs
    }

    pub(super) fn weight(&self, weight: Weight, over: Interval) -> Interval {
        let Interval { low, high } = match weight {
            Weight::Constant(weight) => Interval::point(weight),
            Weight::Formula(index) => self.ideal.network.weights.get(index).map_or(Interval::WHOLE, |formula| {
                let all = if over.high.is_finite() { formula.within() } else { formula.for_ever().within };
                let within = formula.formula().enclose(over);
                Interval { low: within.low.max(all.low), high: within.high.min(all.high) }
            }),
        };
        Interval { low: if low < LEAST_WEIGHT { 0.0 } else { low }, high: high.max(LEAST_WEIGHT) }
    }

    /// Whether no weight changes.
    pub(super) fn has_constant_weights(&self) -> bool {
        self.ideal.network.schedule.graphs.iter().flatten().all(|edge| edge.weight.constant().is_some())
    }

    /// The fastest rate of any component while any graph is in force, over a stretch of time, 1/s.
    pub(super) fn fastest_per_s(&self, over: Interval) -> f64 {
        let lags = self.kappa.iter().flatten().copied().fold(0.0, f64::max);
        (0..self.ideal.network.schedule.graphs.len()).fold(lags, |most, graph| {
            let degree = |inputs: &Vec<(usize, Input)>| inputs.iter().map(|(_, input)| input.rate.high).sum::<f64>();
            self.inputs(graph, over).iter().map(degree).fold(most, f64::max)
        })
    }
}
