//! A leader and how it is followed, as plain data.
//!
//! The leader has a motion and no robot, and is then the last vertex of the network; or it is an agent, which follows a target of
//! its own. It says its position and its velocity like everybody else, and has no neighbours.

use forwardstep_core::LengthError;
use forwardstep_core::reference::{self, Choice, CompositeFollowing, Derived, Sliding, SmoothFollowing};

use crate::closed_loop::{Assembly, SetupError};
use crate::quantity::{MOST_EVENTS, QuantityError, few, positive};
use crate::reference::{
    Dynamics, LinearReference, ReferenceDynamics, ReferenceFamily, ReferenceInterface, ReferenceWords, Roots,
};
use crate::setup::{AgentSetup, Exchange, Setup};
use crate::system::{Known, PositionKind};
use crate::trajectory::Trajectory;

/// What everybody follows.
#[derive(Clone, Debug, PartialEq)]
pub enum Leading {
    /// A motion without a robot.
    Motion(Leader),
    /// An agent of the network, by its number: it follows its target, and the others follow it.
    Agent(usize),
}

/// A motion that leads.
#[derive(Clone, Debug, PartialEq)]
pub struct Leader {
    /// Its name, used in tables and messages.
    pub name: String,
    /// Its motion.
    pub trajectory: Trajectory,
}

/// How it is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FollowingDesign {
    /// (110), Theorem 8: torques that jump unless the sign is solved for.
    Continuous,
    /// (119), Theorem 9: differentiable torques; accelerations are transmitted.
    Differentiable,
    /// (122), Remark 12: differentiable torques; reference accelerations are transmitted.
    WithoutAcceleration,
    /// Differences to neighbours only, over an undirected graph; our own derivation, see
    /// [`forwardstep_core::reference::SmoothFollowing::swarm`].
    Swarm {
        /// k.
        coupling: f64,
    },
    /// Everybody agrees with the leader on one vector, y = ż + β z + α q, and tells that alone: differentiable torques over graphs that
    /// switch and links that delay; our own derivation, see [`forwardstep_core::reference::CompositeFollowing`].
    Composite,
    /// Everybody estimates where the leader is and how fast it moves, tells its estimates, and follows them; our own derivation, see
    /// [`forwardstep_core::reference::Observer`].
    Observer {
        /// κ, 1/s.
        kappa: f64,
    },
}

/// A leader, and the design with its gains, which all agents share.
#[derive(Clone, Debug, PartialEq)]
pub struct Following {
    /// What is followed.
    pub leader: Leading,
    /// (110), (119), (122), swarm tracking, one vector to agree on or an observer of the leader.
    pub design: FollowingDesign,
    /// α: 1/s in (110) and observers, else 1/s².
    pub alpha: f64,
    /// β, 1/s; not used by (110) and observers.
    pub beta: f64,
    /// γ.
    pub gain: f64,
    /// How a value of the sign is chosen.
    pub choice: Choice,
    /// How often, s, in continuous time; sampled controllers do it at every sample.
    pub period_s: f64,
}

impl Following {
    /// The motion that is followed, if it is not that of an agent.
    pub fn motion(&self) -> Option<&Leader> {
        match &self.leader {
            Leading::Motion(leader) => Some(leader),
            Leading::Agent(_) => None,
        }
    }

    /// The sign as the reference dynamics have it.
    pub fn sliding(&self) -> Sliding {
        let (derived, beta) = match self.design {
            FollowingDesign::Continuous | FollowingDesign::Observer { .. } => (Derived::Nothing, 1.0),
            FollowingDesign::Differentiable => (Derived::Acceleration, self.beta),
            FollowingDesign::WithoutAcceleration | FollowingDesign::Swarm { .. } => {
                (Derived::ReferenceAcceleration, self.beta)
            }
            FollowingDesign::Composite => (Derived::Composite, self.beta),
        };
        Sliding { derived, alpha: self.alpha, beta, gamma: self.gain, choice: self.choice }
    }

    /// Checks its numbers, for a run of `end_s` whose signs are set in continuous time unless `sampled`.
    fn numbers(&self, end_s: f64, sampled: bool) -> Result<(), QuantityError> {
        let at = "reference.leader";
        // α and β come from the roots.
        positive(at, "alpha", self.alpha)?;
        match self.design {
            FollowingDesign::Continuous => {}
            FollowingDesign::Observer { kappa } => positive(at, "kappa", kappa)?,
            FollowingDesign::Differentiable | FollowingDesign::WithoutAcceleration | FollowingDesign::Composite => {
                positive(at, "beta", self.beta)?
            }
            FollowingDesign::Swarm { coupling } => {
                positive(at, "beta", self.beta)?;
                positive(at, "coupling", coupling)?;
            }
        }
        positive(at, "gain", self.gain)?;
        match self.choice {
            Choice::Layer { width } => positive("reference.leader.sign.boundary_layer", "width", width),
            Choice::Implicit | Choice::Explicit if !sampled => {
                positive(at, "sign_period_s", self.period_s)?;
                few(at, "sign_period_s", self.period_s, ("settings of the sign", end_s / self.period_s, MOST_EVENTS))
            }
            Choice::Implicit | Choice::Explicit => Ok(()),
        }
    }

    /// What drives the leader away from its followers, as a combination of the derivatives of q_0: ξ̇_0, or d³q_0 for a swarm.
    /// γ must exceed the largest size of it.
    pub fn drive(&self) -> [f64; 5] {
        match self.design {
            FollowingDesign::Continuous | FollowingDesign::Observer { .. } => [0.0, self.alpha, 1.0, 0.0, 0.0],
            FollowingDesign::Swarm { .. } => [0.0, 0.0, 0.0, 1.0, 0.0],
            FollowingDesign::Differentiable | FollowingDesign::WithoutAcceleration | FollowingDesign::Composite => {
                [0.0, self.alpha, self.beta, 1.0, 0.0]
            }
        }
    }

    /// A bound of its size from 0 to `end_s`, or for ever; infinite where nothing could be shown, as of an agent that leads.
    pub fn drive_bound(&self, end_s: Option<f64>) -> f64 {
        let Some(Leader { trajectory, .. }) = self.motion() else { return f64::INFINITY };
        let drive = self.drive();
        (0..trajectory.axes()).map(|axis| trajectory.bounds(axis, &drive, end_s).size()).fold(0.0, f64::max)
    }
}

/// (110), (119), (122), swarm tracking, one vector to agree on or an observer: everybody follows a leader, the last vertex of the network.
impl ReferenceDynamics for Following {
    fn words(&self) -> ReferenceWords {
        ReferenceWords { name: "following a leader", key: "leader" }
    }

    fn interface(&self) -> ReferenceInterface {
        ReferenceInterface {
            family: ReferenceFamily::Leader,
            exchanges: match self.design {
                FollowingDesign::Observer { .. } => &[Exchange::Estimates],
                FollowingDesign::Composite => &[Exchange::Composite],
                FollowingDesign::Continuous
                | FollowingDesign::Differentiable
                | FollowingDesign::WithoutAcceleration
                | FollowingDesign::Swarm { .. } => &[Exchange::PositionVelocity],
            },
            roots: Roots::None,
            manipulability: false,
            nonlinear_coupling: false,
        }
    }

    fn free_derivatives(&self, _: usize) -> usize {
        match self.design {
            FollowingDesign::Continuous | FollowingDesign::Observer { .. } => 1,
            FollowingDesign::Differentiable
            | FollowingDesign::WithoutAcceleration
            | FollowingDesign::Swarm { .. }
            | FollowingDesign::Composite => 2,
        }
    }

    fn known(&self) -> Known {
        Known::Checked
    }

    /// A sign is not linear.
    fn linear(&self, _: &AgentSetup, _: Exchange) -> Option<LinearReference> {
        None
    }

    fn check(&self, setup: &Setup) -> Result<(), SetupError> {
        self.numbers(setup.time.end_s, setup.control.is_some())?;
        let transmitted = self.sliding().transmitted() > 0;
        let vertex = match &self.leader {
            Leading::Motion(leader) => {
                let axes = setup.agents.first().map_or(0, |agent| agent.robot.axes.len());
                LengthError::check("the leader's trajectory", axes, leader.trajectory.axes())
                    .map_err(|error| SetupError::Length { agent: leader.name.clone(), error })?;
                setup.agents.len()
            }
            Leading::Agent(index) => {
                let (agent, agents) = (*index, setup.agents.len());
                let own = setup.agents.get(agent).ok_or(SetupError::NoAgent { agent, agents })?;
                leads(own, self.design, setup.control.is_some())?;
                agent
            }
        };
        for edge in setup.network.schedule.graphs.iter().flatten() {
            if edge.to == vertex {
                return Err(SetupError::LeaderHears { leader: setup.vertex_name(vertex).to_owned() });
            }
            let delay_s = setup.network.delays.get(edge.delay).map_or(0.0, |delay| delay.max_s());
            if transmitted && setup.control.is_none() && delay_s > 0.0 {
                return Err(SetupError::DelayedDerived { delay_s });
            }
        }
        Ok(())
    }

    fn dynamics(&self, assembly: &Assembly<'_>) -> Result<Dynamics, SetupError> {
        let (agents, sliding) = (assembly.agents().len(), self.sliding());
        Ok(match self.design {
            FollowingDesign::Continuous => Dynamics::position_velocity(reference::Following::new(agents, sliding)),
            FollowingDesign::Observer { kappa } => {
                Dynamics::estimates(reference::Observer::new(agents, sliding, kappa))
            }
            FollowingDesign::Composite => Dynamics::composite(CompositeFollowing::new(agents, sliding)),
            FollowingDesign::Swarm { coupling } => {
                Dynamics::position_velocity(SmoothFollowing::swarm(agents, sliding, coupling))
            }
            FollowingDesign::Differentiable | FollowingDesign::WithoutAcceleration => {
                Dynamics::position_velocity(SmoothFollowing::new(agents, sliding))
            }
        })
    }
}

/// Whether an agent can lead: it says a position and a velocity for every axis, and, where controllers that sample hear
/// accelerations, an acceleration, which no sensor measures. That stands in what it would tell for `composite` too.
fn leads(own: &AgentSetup, design: FollowingDesign, sampled: bool) -> Result<(), SetupError> {
    let robot = own.robot.interface();
    let samples_accelerations = sampled
        && match design {
            FollowingDesign::Differentiable | FollowingDesign::WithoutAcceleration | FollowingDesign::Swarm { .. } => {
                true
            }
            FollowingDesign::Continuous | FollowingDesign::Composite | FollowingDesign::Observer { .. } => false,
        };
    let why = if robot.velocity_len != own.robot.axes.len() || robot.position == PositionKind::UnitQuaternion {
        "its robot has not a velocity for every axis"
    } else if samples_accelerations {
        "its acceleration would have to be sampled, which nothing measures; take the design `continuous`, or continuous time"
    } else if design == FollowingDesign::Composite {
        "its acceleration would stand in what is told, and nothing measures it; take the design `continuous` or `observer`, or a leader with a motion of its own"
    } else {
        return Ok(());
    };
    Err(SetupError::CannotLead { agent: own.name.clone(), why })
}
