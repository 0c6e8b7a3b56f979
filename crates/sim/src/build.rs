//! Setups by hand, with defaults for everything that is not said. All fields stay public: what a function here sets can be
//! changed afterwards.
//!
//! ```
//! use forwardstep_sim::delay::Delay;
//! use forwardstep_sim::{AgentSetup, Known, Network, RobotSetup, Setup, Signal, run};
//!
//! let cart = |name: &str, x: f64| {
//!     AgentSetup::new(name, RobotSetup::point_mass(1, 2.0), Known::gain(8.0)).roots([1.0, 2.0]).at(&[x])
//! };
//! let network = Network::fixed(2, [(0, 1), (1, 0)], Delay::constant(0.1));
//! let setup = Setup::consensus([cart("left", 0.0), cart("right", 1.0)], network, 20.0);
//! let outcome = run(&setup)?;
//! let last = |agent| outcome.recording.last(agent, Signal::Position, 0);
//! assert!((last(0) - last(1)).abs() < 1e-3);
//! # Ok::<(), forwardstep_sim::SetupError>(())
//! ```

use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::reference::RootSet;
use forwardstep_core::robot::tree::Tree;
use forwardstep_core::robot::{PlanarArm, PlanarLinks, PointMass};

use crate::agents::{Adaptive, Known};
use crate::closed_loop::SetupError;
use crate::coupling::Coupling;
use crate::delay::Delay;
use crate::graph::{Edge, Weight};
use crate::network::Network;
use crate::recording::{Outcome, Recording, Signal};
use crate::reference::{Consensus, ReferenceDynamics, Tracking};
use crate::schedule::{Phase, Schedule};
use crate::setup::{
    Actuators, AgentSetup, Axis, AxisUnit, Control, Exchange, Failures, RECORD_EVERY_S, RecordAt, RobotSetup, Sensors,
    Setup, Solver, Start, TimeSpan,
};
use crate::simulate::simulate;
use crate::system::{Law, Robot};
use crate::trajectory::Trajectory;

/// Simulates `setup` to its end: [`simulate`] without anybody who watches.
///
/// # Errors
/// [`SetupError`] when the setup has no meaning.
pub fn run(setup: &Setup) -> Result<Outcome, SetupError> {
    simulate(setup, &mut |_| ControlFlow::Continue(()))
}

impl Axis {
    /// An axis without limits.
    pub fn new(name: impl Into<String>, unit: AxisUnit) -> Self {
        Axis { name: name.into(), unit, position_limits: None, velocity_limit: None, effort_limit: None }
    }
}

impl RobotSetup {
    /// A robot with the true parameters `theta`, which get numbers for names.
    pub fn new(kind: impl Robot, theta: impl Into<Vec<f64>>, axes: impl Into<Vec<Axis>>) -> Self {
        let theta = theta.into();
        let theta_names = (1..=theta.len()).map(|k| format!("theta{k}")).collect();
        RobotSetup { kind: Arc::new(kind), theta, theta_names, axes: axes.into() }
    }

    /// The same with names for its parameters, as many as there are.
    pub fn named(mut self, theta_names: &[&str]) -> Self {
        self.theta_names = theta_names.iter().map(|name| (*name).to_owned()).collect();
        self
    }

    /// A mass of `mass_kg` in ℝᵐ, m = `dimension`, pushed along every axis.
    pub fn point_mass(dimension: usize, mass_kg: f64) -> Self {
        let name = |k: usize| match (dimension <= 3, ["x", "y", "z"].get(k)) {
            (true, Some(letter)) => (*letter).to_owned(),
            _ => format!("x{}", k + 1),
        };
        let axes: Vec<Axis> = (0..dimension).map(|k| Axis::new(name(k), AxisUnit::Metre)).collect();
        RobotSetup::new(PointMass { dimension }, [mass_kg], axes).named(&["mass"])
    }

    /// The two-link planar arm with these links.
    pub fn planar_arm(links: &PlanarLinks) -> Self {
        let axes = [Axis::new("shoulder", AxisUnit::Radian), Axis::new("elbow", AxisUnit::Radian)];
        RobotSetup::new(PlanarArm, links.theta(), axes).named(&[
            "inertia.both_links",
            "inertia.outer_link",
            "inertia.coupling",
            "gravity.shoulder",
            "gravity.elbow",
        ])
    }

    /// A tree of rigid bodies with the true ϑ of its bodies and dampings.
    pub fn tree(tree: Tree, theta: Vec<f64>, axes: Vec<Axis>) -> Self {
        RobotSetup::new(Arc::new(tree), theta, axes)
    }
}

impl Adaptive {
    /// K and Γ as numbers, and ϑ̂(0) = 0 for `parameters` of them.
    pub fn gains(damping: f64, adaptation: f64, parameters: usize) -> Self {
        let (damping, adaptation) = (Gain::Number(damping), Gain::Number(adaptation));
        Adaptive { damping, adaptation, estimate_start: vec![0.0; parameters], bounds: None }
    }
}

impl Known {
    /// K as a number.
    pub fn gain(damping: f64) -> Self {
        Known { damping: Gain::Number(damping) }
    }
}

impl AgentSetup {
    /// An agent at rest at zero, without roots.
    pub fn new(name: impl Into<String>, robot: RobotSetup, law: impl Law) -> Self {
        let axes = robot.axes.len();
        let (dq, rest) = (vec![0.0; robot.velocity_len()], vec![0.0; robot.interface().rest_len]);
        AgentSetup {
            name: name.into(),
            robot,
            roots_per_s: RootSet::default(),
            manipulability: 0.0,
            law: Arc::new(law),
            target: None,
            start: Start { q: vec![0.0; axes], dq, rest, reference: Vec::new() },
            enforce_limits: false,
            pushes: Vec::new(),
        }
    }

    /// Reference dynamics with these κ₀ … κ_{ℓ−1}, 1/s, or with pairs of complex roots too.
    pub fn roots(mut self, roots_per_s: impl Into<RootSet>) -> Self {
        self.roots_per_s = roots_per_s.into();
        self
    }

    /// Where it starts, rad or m.
    pub fn at(mut self, q: &[f64]) -> Self {
        self.start.q = q.to_vec();
        self
    }

    /// How fast it starts, rad/s or m/s.
    pub fn moving(mut self, dq: &[f64]) -> Self {
        self.start.dq = dq.to_vec();
        self
    }

    /// Where it should be, or its offset from where all agree.
    pub fn following(mut self, target: Trajectory) -> Self {
        self.target = Some(target);
        self
    }
}

impl Network {
    /// A network without edges.
    pub fn silent(agents: usize) -> Self {
        Network::switching(agents, Schedule::fixed(Vec::new()), Vec::new())
    }

    /// One graph for ever: `edges` lead from who speaks to who hears, all with weight one and the same `delay`.
    pub fn fixed(agents: usize, edges: impl IntoIterator<Item = (usize, usize)>, delay: Delay) -> Self {
        Network::switching(agents, Schedule::fixed(unweighted(edges)), vec![delay])
    }

    /// Graphs that take turns, each for its dwell time, s.
    pub fn periodic(agents: usize, graphs: impl IntoIterator<Item = (f64, Vec<(usize, usize)>)>, delay: Delay) -> Self {
        let phase = |(dwell_s, edges)| Phase { edges: unweighted(edges), dwell_s };
        Network::switching(agents, Schedule::periodic(graphs.into_iter().map(phase).collect()), vec![delay])
    }

    pub(crate) fn switching(agents: usize, schedule: Schedule, delays: Vec<Delay>) -> Self {
        Network { agents, schedule, delays, weights: Vec::new(), coupling: Coupling::Linear }
    }
}

/// Edges of weight one through the first delay.
fn unweighted(edges: impl IntoIterator<Item = (usize, usize)>) -> Vec<Edge> {
    edges.into_iter().map(|(from, to)| Edge { from, to, weight: Weight::Constant(1.0), delay: 0 }).collect()
}

impl Setup {
    /// Agents that agree on a position over `network` until `end_s`: (a5) where all their laws can exchange velocities, else
    /// (24).
    pub fn consensus(agents: impl Into<Vec<AgentSetup>>, network: Network, end_s: f64) -> Self {
        let agents = agents.into();
        let both = |agent: &AgentSetup| {
            agent.interface().is_some_and(|interface| interface.exchanges.contains(&Exchange::PositionVelocity))
        };
        let exchange = if agents.iter().all(both) { Exchange::PositionVelocity } else { Exchange::Position };
        Setup::new(agents, Arc::new(Consensus), exchange, network, end_s)
    }

    /// Agents each of which follows a target of its own until `end_s`.
    pub fn tracking(agents: impl Into<Vec<AgentSetup>>, end_s: f64) -> Self {
        let agents = agents.into();
        let network = Network::silent(agents.len());
        Setup::new(agents, Arc::new(Tracking), Exchange::Position, network, end_s)
    }

    /// Agents under any reference dynamics, in continuous time.
    pub fn new(
        agents: Vec<AgentSetup>,
        reference: Arc<dyn ReferenceDynamics>,
        exchange: Exchange,
        network: Network,
        end_s: f64,
    ) -> Self {
        let time = TimeSpan { end_s, record_every_s: RECORD_EVERY_S, record_at: RecordAt::Intervals };
        Setup { agents, reference, exchange, network, time, solver: Solver::default(), control: None }
    }

    /// The same under digital control: `sample_hz` samples per second, without noise, computation delay and limits.
    pub fn sampled(mut self, sample_hz: f64) -> Self {
        let (sensors, actuators) = (Sensors::default(), Actuators::default());
        self.control =
            Some(Control { sample_hz, computation_delay_s: 0.0, sensors, actuators, failures: Failures::default() });
        self
    }
}

impl Recording {
    /// The rows of one entry of an agent's signal, if it was recorded.
    pub fn values(&self, agent: usize, signal: Signal, axis: usize) -> Option<&[f64]> {
        let is_it = |column: &&crate::Column| (column.agent, column.signal, column.axis) == (agent, signal, axis);
        self.columns.iter().find(is_it).map(|column| &column.values[..])
    }

    /// Its last row; not a number where there is none.
    pub fn last(&self, agent: usize, signal: Signal, axis: usize) -> f64 {
        self.values(agent, signal, axis).and_then(<[f64]>::last).copied().unwrap_or(f64::NAN)
    }
}
