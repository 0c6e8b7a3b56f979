//! Desired dynamics that a user writes down: what x should do, of any order (Section IV-B).

use forwardstep_core::controller::ReferenceModel;
use forwardstep_core::expression::Expression;
use forwardstep_core::reference::{
    self, DesiredDynamics, DesiredError, Position, PositionVelocity, RootSet, WrittenIn, polynomial,
};

use super::{Dynamics, LinearReference, LinearTerms, ReferenceDynamics, ReferenceFamily, ReferenceInterface};
use super::{ReferenceWords, Roots};
use crate::agents::{ChainLaw, ChainModel, ChainStep};
use crate::closed_loop::{Assembly, SetupError};
use crate::setup::{AgentSetup, Exchange, Setup};
use crate::system::Known;

/// x^(N) + Σ γ_r x^(r) = what is heard, or what a target does: with A(p) of degree N and B(p) below,
///
/// ```text
/// A(p) (x_i − x_d) = −Σ_j w_ij [ B(p) x_i − c₀ x_j(t−T_ij) − c₁ ẋ_j(t−T_ij) ]
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Desired {
    /// A, of degree N, the order of the desired dynamics. Its leading coefficient is one, and not listed.
    pub polynomial: DesiredPolynomial,
    /// B; `None` for no neighbours.
    pub coupling: Option<DesiredPolynomial>,
    /// c₀, then c₁ where velocities are exchanged. Empty for B(0): at rest, like positions cancel.
    pub heard: Vec<f64>,
    /// Whether every agent follows a target x_d.
    pub follows_target: bool,
    /// The variables that 𝒵 is written in.
    pub written: WrittenIn,
    /// What is added to the right side, a nonlinear protocol.
    pub protocol: Option<Protocol>,
}

/// A nonlinear protocol f, with what its author says of the dynamics that it makes.
#[derive(Clone, Debug, PartialEq)]
pub struct Protocol {
    /// f of x, ẋ, …, x^(N−1), then Σ_j w_ij x_j(t−T_ij) and Σ_j w_ij, then x_d, ẋ_d, …, x_d^(N) where a target is followed, then t.
    pub term: Expression,
    /// Why agents agree, or targets are reached, exponentially and from everywhere, where s ≡ 0.
    pub stable_because: Option<String>,
    /// Why they are input-to-state stable from s.
    pub input_to_state_stable_because: Option<String>,
}

/// A polynomial in p = d/dt.
#[derive(Clone, Debug, PartialEq)]
pub enum DesiredPolynomial {
    /// Its coefficients from p⁰ on.
    Coefficients(Vec<f64>),
    /// p to a power, times ∏ (p + κ_r) ∏ ((p + a)² + b²).
    Roots {
        /// That power.
        integrators: usize,
        /// The other roots; there may be none.
        roots: RootSet,
    },
}

impl Desired {
    /// The number of the variable t of a protocol.
    pub(crate) fn protocol_time(&self) -> usize {
        let order = self.polynomial.order();
        order + 2 + if self.follows_target { order + 1 } else { 0 }
    }
}

impl DesiredPolynomial {
    /// Its coefficients, with a leading one where it is given by its roots.
    fn coefficients(&self) -> Result<Vec<f64>, forwardstep_core::reference::RootsError> {
        Ok(match self {
            DesiredPolynomial::Coefficients(list) => list.clone(),
            DesiredPolynomial::Roots { integrators, roots } => {
                let others = if roots.is_empty() { vec![1.0] } else { polynomial(roots)? };
                [vec![0.0; *integrators], others].concat()
            }
        })
    }

    /// Its degree, if the leading coefficient is one and not listed.
    pub fn order(&self) -> usize {
        match self {
            DesiredPolynomial::Coefficients(list) => list.len(),
            DesiredPolynomial::Roots { integrators, roots } => integrators + roots.len(),
        }
    }
}

/// k of an agent's plant: z follows x^(k−1), which under adaptive backstepping is x₁.
fn plant_order(agent: &AgentSetup) -> usize {
    let backstepping =
        agent.law.downcast().is_some_and(|law: &ChainLaw| matches!(law.step, ChainStep::Backstepping { .. }));
    match agent.robot.kind.downcast::<ChainModel>() {
        Some(model) if !backstepping => model.order(),
        Some(_) => 1,
        None => 2,
    }
}

impl Desired {
    /// Whether agents hear each other although they follow targets.
    pub fn hears_beside_target(&self) -> bool {
        self.follows_target && self.protocol.is_some()
    }

    fn hears_velocities(&self) -> bool {
        self.heard.len() > 1
    }

    /// What is exchanged for it.
    pub fn exchange(&self) -> Exchange {
        if self.hears_velocities() { Exchange::PositionVelocity } else { Exchange::Position }
    }

    /// γ, B and c with numbers.
    ///
    /// # Errors
    /// [`SetupError`] when they have no meaning.
    pub fn dynamics_of(&self, agent: &str) -> Result<DesiredDynamics, SetupError> {
        let roots = |error| SetupError::Roots { agent: agent.to_owned(), error };
        let wrong = |error| SetupError::Desired { error };
        let mut own = self.polynomial.coefficients().map_err(roots)?;
        if let DesiredPolynomial::Roots { .. } = self.polynomial {
            // The leading one is not listed.
            own.pop();
        }
        let coupled = self.coupling.as_ref().map_or(Ok(Vec::new()), DesiredPolynomial::coefficients).map_err(roots)?;
        let heard = [0, 1].map(|r| self.heard.get(r).copied().unwrap_or(0.0));
        let heard = if self.heard.is_empty() { [coupled.first().copied().unwrap_or(0.0), 0.0] } else { heard };
        let linear = DesiredDynamics::new(own, coupled, heard, self.follows_target, self.written).map_err(wrong)?;
        match &self.protocol {
            None => Ok(linear),
            Some(protocol) => linear.with_protocol(&protocol.term).map_err(wrong),
        }
    }

    /// The same for a law that has its reference dynamics inside.
    ///
    /// # Errors
    /// [`SetupError`] when they have no meaning.
    pub(crate) fn guide(&self, agent: &AgentSetup) -> Result<ReferenceModel, SetupError> {
        Ok(ReferenceModel::Desired(self.dynamics_of(&agent.name)?))
    }
}

impl ReferenceDynamics for Desired {
    fn words(&self) -> ReferenceWords {
        ReferenceWords { name: "the desired dynamics", key: "desired" }
    }

    fn interface(&self) -> ReferenceInterface {
        let exchanges: &[Exchange] =
            if self.hears_velocities() { &[Exchange::PositionVelocity] } else { &[Exchange::Position] };
        ReferenceInterface {
            family: if self.follows_target { ReferenceFamily::DesiredTarget } else { ReferenceFamily::Desired },
            exchanges,
            roots: Roots::None,
            manipulability: false,
            nonlinear_coupling: false,
        }
    }

    /// As if the plant were of order one; less for those of higher order, which is known where they are built.
    fn free_derivatives(&self, _: usize) -> usize {
        self.polynomial.order()
    }

    fn known(&self) -> Known {
        Known::Checked
    }

    fn linear(&self, agent: &AgentSetup, _: Exchange) -> Option<LinearReference> {
        let dynamics = self.dynamics_of(&agent.name).ok().filter(DesiredDynamics::is_linear)?;
        let (plant, order) = (plant_order(agent), dynamics.vectors(plant_order(agent)));
        let from = match self.written {
            WrittenIn::Measured => plant,
            WrittenIn::Z => plant - 1,
            WrittenIn::X => usize::MAX,
        };
        // x^(r) below `from`, z^(r−k+1) from there on.
        let terms = |numbers: &[f64]| {
            let at = from.min(numbers.len());
            let below = vec![0.0; (at + 1).saturating_sub(plant)];
            let above = numbers[at..].iter().map(|number| -number);
            let z = if at < numbers.len() { below.into_iter().chain(above).collect() } else { Vec::new() };
            LinearTerms { q: numbers[..at].iter().map(|number| -number).collect(), z }
        };
        let heard = dynamics.heard().map(|number| -number);
        let constant = self.follows_target;
        (order > 0).then(|| LinearReference {
            order,
            own: terms(dynamics.own()),
            constant,
            coupled: terms(dynamics.coupled()),
            heard,
        })
    }

    fn check(&self, setup: &Setup) -> Result<(), SetupError> {
        let dynamics = self.dynamics_of(setup.agents.first().map_or("", |agent| &agent.name))?;
        let linear = self.protocol.is_none();
        if linear && self.follows_target && (self.coupling.is_some() || !self.heard.is_empty()) {
            return Err(SetupError::Desired { error: DesiredError::TargetAndNeighbours });
        }
        for agent in &setup.agents {
            let (order, least) = (dynamics.order(), plant_order(agent));
            if self.hears_beside_target() && self.hears_velocities() && !agent.robot.kind.is::<ChainModel>() {
                return Err(SetupError::ProtocolHearsVelocities { agent: agent.name.clone() });
            }
            if order < least {
                return Err(SetupError::DesiredOrder { agent: agent.name.clone(), order, least });
            }
        }
        Ok(())
    }

    fn dynamics(&self, assembly: &Assembly<'_>) -> Result<Dynamics, SetupError> {
        let (agents, own) = (assembly.agents().len(), assembly.agent());
        let dynamics = self.dynamics_of(&own.name)?;
        if self.hears_velocities() {
            reference::Desired::<PositionVelocity>::new(agents, dynamics).map(Dynamics::position_velocity)
        } else {
            reference::Desired::<Position>::new(agents, dynamics).map(Dynamics::position)
        }
        .ok_or_else(|| assembly.wrong_reference())
    }
}
