//! The designs in a setup: agents with the same roots, gains and kind of law, and what links they have.

use forwardstep_core::expression::Number;
use forwardstep_core::reference::{RootSet, WrittenIn};
use forwardstep_core::robot::TwoVelocity;
use forwardstep_sim::graph::Weight;
use forwardstep_sim::leader::{Following, FollowingDesign};
use forwardstep_sim::probe::{Counterexample, probe_reference};
use forwardstep_sim::reference::{Backstepping, Consensus, Desired, LinearReference, PureIntegral};
use forwardstep_sim::{
    Adaptive, AgentSetup, AttitudeLaw, ChainLaw, ChainModel, ChainStep, Known, ModelReferenceLaw, PassivityFilterLaw,
    PositionOnlyLaw, Setup, TaskSpaceLaw, ThrustKind, ThrustLaw,
};
use num_rational::BigRational;

use super::dynamics::Heard;
use super::factors::Factors;
use super::form::Links;
use super::formula::At;
use super::laplacian::RootsOfAll;
use super::lower::{Outside, Rubbing};
use crate::instance::{Design, design};
use crate::surroundings::smoothed_friction;

/// A design, with what an explanation needs of the setup.
#[derive(Clone, Debug)]
pub struct Case<'a> {
    /// The setup.
    pub setup: &'a Setup,
    /// The agents, by their numbers.
    pub agents: Vec<usize>,
    /// What leads them.
    pub led: Led,
    /// Their kind of law.
    pub step: Step,
    /// The roots of (25), as they are written.
    pub roots: Factors,
    /// λ.
    pub lambda: BigRational,
    /// What the roots of all agents have in common.
    pub roots_of_all: RootsOfAll,
    /// The desired dynamics that a user wrote down, whether they are a design of the paper or not.
    pub desired: Option<&'a Desired>,
    /// Whether all agents have plants of one order and the same order of reference dynamics.
    pub alike: bool,
}

/// What leads a design.
#[derive(Clone, Debug, PartialEq)]
pub enum Led {
    /// The consensus family.
    Consensus(Heard),
    /// (3), (23), (31).
    PureIntegral(Heard),
    /// The baseline.
    Backstepping,
    /// A leader, with α, β, γ as they are written.
    Leader(FollowingDesign, [BigRational; 3]),
    /// A target of its own.
    Target,
    /// Desired dynamics that are no design of the paper.
    Desired(Desired),
    /// Reference dynamics from outside, and what their author says that they are.
    Outside(&'static str, Option<LinearReference>),
    /// The same, where at some state they are not what their author says.
    Refuted(&'static str, Counterexample),
}

/// A kind of law, with the numbers that the lower subsystem has.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// (6)–(7), or with known parameters.
    Robot {
        /// Whether ϑ is known.
        known: bool,
    },
    /// (a8), with k and λ_f.
    PositionOnly([BigRational; 2]),
    /// A model and a high gain in the place of (a8), with λ_f.
    ModelReference(BigRational),
    /// Section V-B, with α* and k or γ*; zeros under continuous control.
    Thrust(ThrustStep, [BigRational; 2]),
    /// (99).
    Attitude([BigRational; 2]),
    /// A filter of the attitude error, with its k.
    PassivityFilter(BigRational),
    /// (80), with κ and α.
    TaskSpace([BigRational; 2]),
    /// The same with a measured velocity of the tip.
    TipVelocity([BigRational; 2]),
    /// (43) for a chain of this order with this gain.
    Chain(usize, ChainStepKind, BigRational),
    /// A law from outside.
    Outside(&'static str),
}

/// Which control of a vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThrustStep {
    /// (46).
    Continuous,
    /// (50).
    Differentiable,
    /// (57).
    Adaptive,
    /// The same with a measured acceleration.
    ByAcceleration,
}

impl ThrustStep {
    /// Whether the mass is adapted.
    pub fn adapts(self) -> bool {
        matches!(self, ThrustStep::Adaptive | ThrustStep::ByAcceleration)
    }
}

/// Which second step of Section IV.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChainStepKind {
    /// χ is known.
    Linearising,
    /// Adaptation.
    Adaptive,
    /// Immersion and invariance.
    Immersion,
    /// Adaptive backstepping: z follows x₁.
    Backstepping,
}

impl Step {
    fn of(agent: &AgentSetup) -> Step {
        if agent.law.is::<Adaptive>() || agent.law.is::<Known>() {
            Step::Robot { known: agent.law.is::<Known>() }
        } else if let Some(law) = agent.law.downcast::<PositionOnlyLaw>() {
            Step::PositionOnly([law.damping, law.filter_per_s].map(Number::written))
        } else if let Some(law) = agent.law.downcast::<ModelReferenceLaw>() {
            Step::ModelReference(Number::written(law.filter_per_s))
        } else if let Some(law) = agent.law.downcast::<ThrustLaw>() {
            let (step, numbers) = match law.design {
                ThrustKind::Continuous => (ThrustStep::Continuous, [0.0; 2]),
                ThrustKind::Differentiable { alpha_star, stiffness } => {
                    (ThrustStep::Differentiable, [alpha_star, stiffness])
                }
                ThrustKind::Adaptive { alpha_star, gamma_star, .. } => (ThrustStep::Adaptive, [alpha_star, gamma_star]),
                ThrustKind::ByAcceleration { alpha_star, gamma_star, .. } => {
                    (ThrustStep::ByAcceleration, [alpha_star, gamma_star])
                }
            };
            Step::Thrust(step, numbers.map(Number::written))
        } else if let Some(law) = agent.law.downcast::<AttitudeLaw>() {
            Step::Attitude(law.alpha.map(Number::written))
        } else if let Some(law) = agent.law.downcast::<PassivityFilterLaw>() {
            Step::PassivityFilter(Number::written(law.error_gain_n_m))
        } else if let Some(law) = agent.law.downcast::<TaskSpaceLaw>() {
            let numbers = [law.kappa, law.alpha_per_s].map(Number::written);
            if law.by_velocity { Step::TipVelocity(numbers) } else { Step::TaskSpace(numbers) }
        } else if let (Some(law), Some(model)) =
            (agent.law.downcast::<ChainLaw>(), agent.robot.kind.downcast::<ChainModel>())
        {
            let (kind, gain) = match &law.step {
                ChainStep::Linearising { gain_per_s } => (ChainStepKind::Linearising, *gain_per_s),
                ChainStep::Adaptive { gain_per_s, .. } => (ChainStepKind::Adaptive, *gain_per_s),
                ChainStep::Immersion { gain_per_s, .. } => (ChainStepKind::Immersion, *gain_per_s),
                ChainStep::Backstepping { gains_per_s, .. } => {
                    (ChainStepKind::Backstepping, gains_per_s.first().copied().unwrap_or(0.0))
                }
            };
            Step::Chain(model.order(), kind, Number::written(gain))
        } else {
            Step::Outside(agent.law.words().name)
        }
    }

    /// k: z follows the (k − 1)-th derivative.
    pub fn plant(&self) -> usize {
        match self {
            Step::Chain(_, ChainStepKind::Backstepping, _) | Step::Attitude(_) | Step::PassivityFilter(_) => 1,
            Step::Chain(order, ChainStepKind::Linearising | ChainStepKind::Adaptive | ChainStepKind::Immersion, _) => {
                *order
            }
            Step::Robot { .. }
            | Step::PositionOnly(_)
            | Step::ModelReference(_)
            | Step::Thrust(..)
            | Step::TaskSpace(_)
            | Step::TipVelocity(_)
            | Step::Outside(_) => 2,
        }
    }
}

/// Whether the joints of a robot lose anything: D(q) v at its start, for a v without a zero.
fn is_damped(agent: &AgentSetup) -> bool {
    let Some(robot) = agent.robot.kind.lagrangian() else { return false };
    let (q, v, still) = (&agent.start.q, vec![1.0; agent.start.q.len()], vec![0.0; agent.start.q.len()]);
    let motion = TwoVelocity { q, dq: &v, z: &still, dz: &still };
    let mut evaluator = robot.evaluator();
    let Ok(products) = evaluator.at(&agent.robot.theta, motion, &v) else { return false };
    let rubs = smoothed_friction(agent, &v)
        .filter(|(_, is_smooth)| *is_smooth)
        .map_or_else(|| still.clone(), |(rubs, _)| rubs);
    products.damped.iter().zip(rubs).any(|(lost, rubs)| *lost != rubs)
}

/// The designs of a setup, in the order of their first agents.
pub fn cases(setup: &Setup) -> Vec<Case<'_>> {
    let mut cases: Vec<Case<'_>> = Vec::new();
    let refuted = refuted(setup);
    let instance = design(setup);
    let desired = setup.reference.downcast::<Desired>();
    for (index, agent) in setup.agents.iter().enumerate() {
        let led = match (led(setup, index), &refuted) {
            (Led::Outside(name, Some(_)), Some(found)) => Led::Refuted(name, found.clone()),
            (led, _) => led,
        };
        let step = Step::of(agent);
        let roots = Factors::written(instance.as_ref().map_or(&agent.roots_per_s, |(_, roots)| roots));
        let lambda = Number::written(agent.manipulability);
        let same =
            |case: &&mut Case<'_>| case.led == led && case.step == step && case.roots == roots && case.lambda == lambda;
        if let Some(case) = cases.iter_mut().find(same) {
            case.agents.push(index);
            continue;
        }
        let (roots_of_all, alike) = (roots_of_all(setup), alike(setup));
        cases.push(Case { setup, agents: vec![index], led, step, roots, lambda, roots_of_all, desired, alike });
    }
    cases
}

/// Where reference dynamics from outside are not what their author says; nothing of those that are shipped.
fn refuted(setup: &Setup) -> Option<Counterexample> {
    let outside = |agent: usize| matches!(led(setup, agent), Led::Outside(_, Some(_)));
    // A setup that cannot be built is refused before anybody asks what follows from it.
    (0..setup.agents.len()).any(outside).then(|| probe_reference(setup).unwrap_or_default().found)?
}

fn led(setup: &Setup, agent: usize) -> Led {
    let reference = setup.reference_of(agent);
    let heard = match setup.exchange.has_velocities() {
        true => Heard::Velocities,
        false if setup.network.coupling.is_linear() => Heard::Positions,
        false => Heard::Coupled,
    };
    if let Some(desired) = reference.downcast::<Desired>() {
        match design(setup) {
            Some((Design::Consensus, _)) => Led::Consensus(heard),
            Some((Design::PureIntegral, _)) => Led::PureIntegral(heard),
            Some((Design::Tracking, _)) if desired.written == WrittenIn::Measured => Led::Target,
            Some((Design::Tracking, _)) | None => Led::Desired(desired.clone()),
        }
    } else if setup.tracks(agent) {
        Led::Target
    } else if reference.is::<Consensus>() {
        Led::Consensus(heard)
    } else if reference.is::<PureIntegral>() {
        Led::PureIntegral(heard)
    } else if reference.is::<Backstepping>() {
        Led::Backstepping
    } else if let Some(following) = reference.downcast::<Following>() {
        Led::Leader(following.design, [following.alpha, following.beta, following.gain].map(Number::written))
    } else {
        Led::Outside(reference.words().name, reference.linear(&setup.agents[agent], setup.exchange))
    }
}

/// Agents that agree with each other, which is not those with a target.
fn agreeing(setup: &Setup) -> impl Iterator<Item = &AgentSetup> {
    setup.agents.iter().enumerate().filter(|(index, _)| !setup.tracks(*index)).map(|(_, agent)| agent)
}

fn roots_of_all(setup: &Setup) -> RootsOfAll {
    let Some(first) = agreeing(setup).next().map(|agent| &agent.roots_per_s) else { return RootsOfAll::Same };
    let same = |is: fn(&RootSet, &RootSet) -> bool| agreeing(setup).all(|agent| is(&agent.roots_per_s, first));
    if same(RootSet::eq) {
        RootsOfAll::Same
    } else if same(|one, other| one.first_real() == other.first_real()) {
        RootsOfAll::SameFirst
    } else {
        RootsOfAll::Own
    }
}

fn alike(setup: &Setup) -> bool {
    let mut all = agreeing(setup).map(|agent| (Step::of(agent).plant(), agent.roots_per_s.len()));
    let first = all.next();
    all.all(|one| Some(one) == first)
}

impl Case<'_> {
    /// What its agents' equations of motion have beside those of the paper.
    pub fn outside(&self) -> Outside {
        let agents = || self.agents.iter().map(|agent| &self.setup.agents[*agent]);
        let rubs = |agent: &AgentSetup| smoothed_friction(agent, &agent.start.dq).map(|(_, is_smooth)| is_smooth);
        let dry = agents().any(|agent| rubs(agent) == Some(false));
        let rubbing = match (dry, agents().any(|agent| rubs(agent) == Some(true))) {
            (true, _) => Some(Rubbing::Dry),
            (false, true) => Some(Rubbing::Smooth),
            (false, false) => None,
        };
        let pushed = dry || self.is_pushed();
        Outside { damped: agents().any(is_damped), pushed, rubbing }
    }

    /// Whether something pushes its agents; friction is none.
    pub fn is_pushed(&self) -> bool {
        self.agents.iter().any(|agent| !self.setup.agents[*agent].pushes.is_empty())
    }

    /// Whether a target is what leads it.
    pub fn is_led_to_target(&self) -> bool {
        match &self.led {
            Led::Target => true,
            Led::Desired(desired) => desired.follows_target,
            Led::Consensus(_)
            | Led::PureIntegral(_)
            | Led::Backstepping
            | Led::Leader(..)
            | Led::Outside(..)
            | Led::Refuted(..) => false,
        }
    }

    /// Whether estimates of ϑ are kept within bounds.
    pub fn is_bounded(&self) -> bool {
        self.agents.iter().any(|agent| self.setup.agents[*agent].law.kept_within().is_some())
    }

    /// Whether an accelerometer gives too much.
    pub fn is_biased(&self) -> bool {
        let laws = self.agents.iter().filter_map(|agent| self.setup.agents[*agent].law.downcast::<ThrustLaw>());
        laws.into_iter().any(|law| law.design.bias() != [0.0; 3])
    }

    /// Whether estimates of lengths are.
    pub fn has_bounded_lengths(&self) -> bool {
        let laws = self.agents.iter().filter_map(|agent| self.setup.agents[*agent].law.downcast::<TaskSpaceLaw>());
        laws.into_iter().any(|law| law.bounds.is_some())
    }

    /// Whether its reference dynamics add something that does not depend on the state.
    pub fn has_constant(&self) -> bool {
        matches!(&self.led, Led::Outside(_, Some(linear)) if linear.constant)
    }

    /// Whether weights and delays can be differentiated.
    pub fn links(&self) -> Links {
        let fixed = self.setup.network.schedule.constant_graph().is_some();
        if fixed && self.weights() == At::Now && self.heard() != At::VaryingLate {
            Links::Constant
        } else {
            Links::Varying
        }
    }

    /// Whether weights are written with their time.
    pub fn weights(&self) -> At {
        let network = &self.setup.network;
        let constant = |weight: Weight| weight.constant().is_some();
        let all = network.schedule.graphs.iter().flatten().all(|edge| constant(edge.weight));
        if all && network.schedule.constant_graph().is_some() { At::Now } else { At::Time }
    }

    /// When a neighbour's signals are taken.
    pub fn heard(&self) -> At {
        let network = &self.setup.network;
        let delays = || network.schedule.graphs.iter().flatten().filter_map(|edge| network.delays.get(edge.delay));
        if delays().all(|delay| delay.max_s() == 0.0) {
            At::Now
        } else if delays().all(|delay| delay.is_constant()) {
            At::Late
        } else {
            At::VaryingLate
        }
    }
}
