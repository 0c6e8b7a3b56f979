//! How smooth the torque is: the jumps of its derivatives at every switch of the graph and every jump of a delay.
//!
//! Not from the paper, which says *ℓ − 1 times differentiable*; derived for this software, and E2 in PAPER.md says in which sense.
//! At a switch or a jump of a delay at t* an agent hears something else just after than just before. Its state (q, q̇, z, ż, …, z^(ℓ−1), ϑ̂) does not
//! jump. Under (6)–(7) with reference dynamics of order ℓ
//!
//! ```text
//! τ⁽ʳ⁾ is a function of   q … q⁽ʳ⁺¹⁾,  z … z⁽ʳ⁺¹⁾,  ϑ̂ … ϑ̂⁽ʳ⁾
//! q⁽ᵏ⁺²⁾ by (1) from τ⁽ᵏ⁾,   ϑ̂⁽ᵏ⁺¹⁾ by (7) from z⁽ᵏ⁺¹⁾,   z⁽ˡ⁾ by the reference dynamics from what is heard
//! ```
//!
//! so that τ … τ⁽ˡ⁻²⁾ do not know what is heard at t*, and do not jump. τ⁽ˡ⁻¹⁾ knows its *value*, through z⁽ˡ⁾, and jumps by M(q, ϑ̂) Δz⁽ˡ⁾, with
//! the inertia matrix of the estimates; from τ⁽ˡ⁾ on derivatives of what is heard enter. Both sides are computed order by order in
//! truncated Taylor arithmetic ([`Taylor`](forwardstep_core::Taylor)) with the models and the reference dynamics that run, so nothing of this is put in:
//! derivatives of what is heard are not-a-number, and the first derivative of the torque that would need one is the first not
//! reported. (6)–(7) under [`Backstepping`](forwardstep_sim::reference::Backstepping) have none that does not jump: z itself does.
//!
//! What acts from outside is held at its value just before. It moves q̈ on both sides alike, and no jump up to τ⁽ˡ⁻¹⁾ depends on its
//! derivatives; a push that begins at t* is not the network's doing.
//!
//! - `expansion`: one agent's torque around t*.
//! - `covered`: of which agents, and why not of the others.
//! - `orders`: the same network under reference dynamics of several orders.
//! - `filters`: the same under the backstepping baseline, with several filters.

mod covered;
mod expansion;
mod filters;
mod orders;

use std::ops::ControlFlow;

use forwardstep_core::LengthError;
use forwardstep_sim::recording::Outcome;
use forwardstep_sim::{Ending, NetworkJump, Progress, Setup, SetupError, simulate_jumps};
use thiserror::Error;

pub use covered::{Covered, NotCovered};
pub use filters::{FilteredJump, Filters, NoFilters, filters};
pub use orders::{NoOrders, OfOrder, Trace, orders, traces};

use expansion::Expansion;

/// The jumps of the torque along one run.
#[derive(Clone, Debug)]
pub struct Smoothness {
    /// Of every agent, what was looked at.
    pub agents: Vec<Result<Covered, NotCovered>>,
    /// Instants at which the graph switched.
    pub switches: usize,
    /// Other instants at which delays jumped, or might have.
    pub delay_jumps: usize,
    /// Every instant at which what an agent hears jumped, in the order of time.
    pub jumps: Vec<TorqueJump>,
    /// The run.
    pub outcome: Outcome,
}

/// What the torque of one agent did at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct TorqueJump {
    /// Index of the agent.
    pub agent: usize,
    /// The instant, s.
    pub t_s: f64,
    /// Whether the graph changed; otherwise a delay jumped.
    pub switched: bool,
    /// The r-th derivative on every axis, for r = 0, 1, ….
    pub derivatives: Vec<Vec<Sides>>,
}

/// A derivative of the torque on both sides of an instant, N m/sʳ or N/sʳ. Where something acts from outside they are those under its value just before,
/// held; their difference is not concerned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sides {
    /// Just before.
    pub before: f64,
    /// Just after.
    pub after: f64,
}

impl Sides {
    /// How far it jumps.
    pub fn jump(self) -> f64 {
        self.after - self.before
    }
}

/// The largest jump of one derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LargestJump {
    /// Index of the agent.
    pub agent: usize,
    /// Index of the axis.
    pub axis: usize,
    /// The instant, s.
    pub t_s: f64,
    /// Whether the graph changed; otherwise a delay jumped.
    pub switched: bool,
    /// How large it is, N m/sʳ or N/sʳ.
    pub size: f64,
}

/// Why there are no jumps to report.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoSmoothness {
    /// Control is digital.
    #[error(
        "the controllers sample: a held torque jumps at every sample, whatever the order; leave `control` out to see what the design does"
    )]
    Sampled,
    /// The setup has no meaning.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The dynamics of a robot do not have the size that the robot states.
    #[error(transparent)]
    Length(#[from] LengthError),
    /// No agent is covered.
    #[error("{name}: {reason}")]
    NoAgent {
        /// The first agent.
        name: String,
        /// Why it is not.
        reason: NotCovered,
    },
    /// The run did not come to its end.
    #[error("the run ends early, at {t_s} s; see what `forwardstep run` says of it")]
    Early {
        /// When, s.
        t_s: f64,
    },
    /// A derivative is not finite.
    #[error(
        "derivative {derivative} of the torque of {name} is not finite at {t_s} s: the motion is too violent for numbers"
    )]
    NotFinite {
        /// The agent.
        name: String,
        /// The instant, s.
        t_s: f64,
        /// The order of the derivative.
        derivative: usize,
    },
}

/// Simulates `setup` and reports what the derivatives of every torque do where the network jumps; `observer` as that of
/// [`forwardstep_sim::simulate`].
///
/// # Errors
/// [`NoSmoothness`].
pub fn smoothness(
    setup: &Setup,
    observer: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Smoothness, NoSmoothness> {
    if setup.control.is_some() {
        return Err(NoSmoothness::Sampled);
    }
    forwardstep_sim::validate(setup)?;
    let expansions: Vec<_> = (0..setup.agents.len()).map(|agent| Expansion::new(setup, agent)).collect();
    let known = |(agent, expansion): (usize, &Result<Expansion, NotCovered>)| match expansion {
        Ok(expansion) => Ok(Covered::of(setup, agent, expansion.derivatives())),
        Err(reason) => Err(reason.clone()),
    };
    let agents: Vec<Result<Covered, NotCovered>> = expansions.iter().enumerate().map(known).collect();
    if let (Some(Err(reason)), true) = (agents.first(), agents.iter().all(Result::is_err)) {
        return Err(NoSmoothness::NoAgent { name: setup.agents[0].name.clone(), reason: reason.clone() });
    }
    let mut seen = Seen { expansions, ..Seen::default() };
    let outcome = simulate_jumps(setup, observer, &mut |jump| seen.look(jump))?;
    if let Some((agent, t_s, trouble)) = seen.trouble {
        return Err(match trouble {
            Trouble::Length(error) => error.into(),
            Trouble::NotFinite(derivative) => {
                NoSmoothness::NotFinite { name: setup.agents[agent].name.clone(), t_s, derivative }
            }
        });
    }
    let Seen { switches, delay_jumps, jumps, .. } = seen;
    match &outcome.ending {
        Ending::Completed => Ok(Smoothness { agents, switches, delay_jumps, jumps, outcome }),
        Ending::Interrupted { t_s } => Err(NoSmoothness::Early { t_s: *t_s }),
        Ending::BrokeDown(breakdown) => Err(NoSmoothness::Early { t_s: breakdown.t_s }),
    }
}

impl Smoothness {
    /// The agents of which something is reported, by how many derivatives that are and what is promised of them: each kind once.
    pub fn kinds(&self) -> Vec<Covered> {
        let mut kinds: Vec<Covered> = self.agents.iter().flatten().copied().collect();
        kinds.sort_by_key(|covered| (covered.derivatives, covered.continuous));
        kinds.dedup();
        kinds
    }

    /// The largest jump of the derivative of order `r` among the agents of one of the [`Smoothness::kinds`]; `None` where nothing they hear ever jumps,
    /// or their derivatives end below. Torques in N m and forces in N are compared as the numbers that they are.
    pub fn largest(&self, kind: Covered, r: usize) -> Option<LargestJump> {
        let of_kind = |jump: &&TorqueJump| self.agents[jump.agent].as_ref() == Ok(&kind);
        let sizes = |jump: &TorqueJump| -> Vec<LargestJump> {
            let TorqueJump { agent, t_s, switched, .. } = *jump;
            let each =
                |(axis, sides): (usize, &Sides)| LargestJump { agent, axis, t_s, switched, size: sides.jump().abs() };
            jump.derivatives.get(r).into_iter().flatten().enumerate().map(each).collect()
        };
        let all = self.jumps.iter().filter(of_kind).flat_map(sizes);
        // The first of several that are as large.
        all.reduce(|most, next| if next.size > most.size { next } else { most })
    }

    /// Whether no derivative jumps that must not.
    pub fn kept(&self) -> bool {
        self.jumps.iter().all(|jump| {
            let continuous = self.agents[jump.agent].as_ref().ok().and_then(|covered| covered.continuous).unwrap_or(0);
            jump.derivatives.iter().take(continuous).flatten().all(|sides| sides.jump() == 0.0)
        })
    }
}

/// What a run shows.
#[derive(Default)]
struct Seen {
    expansions: Vec<Result<Expansion, NotCovered>>,
    switches: usize,
    delay_jumps: usize,
    /// The last instant counted, s.
    counted_s: f64,
    jumps: Vec<TorqueJump>,
    /// The first that could not be computed: agent, instant, why.
    trouble: Option<(usize, f64, Trouble)>,
}

enum Trouble {
    Length(LengthError),
    /// The order of the derivative.
    NotFinite(usize),
}

impl Seen {
    fn look(&mut self, jump: NetworkJump<'_>) {
        if jump.t_s > self.counted_s {
            self.counted_s = jump.t_s;
            if jump.switched { self.switches += 1 } else { self.delay_jumps += 1 }
        }
        let NetworkJump { agent, t_s, switched, .. } = jump;
        let Some(Ok(expansion)) = self.expansions.get_mut(agent) else { return };
        // From the same numbers both sides would compute the same.
        if self.trouble.is_some() || jump.before == jump.after {
            return;
        }
        let sides =
            expansion.torque(&jump, jump.before).and_then(|before| Ok((before, expansion.torque(&jump, jump.after)?)));
        let (before, after) = match sides {
            Ok(sides) => sides,
            Err(error) => {
                self.trouble = Some((agent, t_s, Trouble::Length(error)));
                return;
            }
        };
        let sides = |r: usize| {
            before
                .iter()
                .zip(&after)
                .map(move |(before, after)| Sides { before: before.derivative(r), after: after.derivative(r) })
        };
        let derivatives: Vec<Vec<Sides>> = (0..expansion.derivatives()).map(|r| sides(r).collect()).collect();
        if let Some(r) = derivatives.iter().position(|sides| sides.iter().any(|sides| !sides.jump().is_finite())) {
            self.trouble = Some((agent, t_s, Trouble::NotFinite(r)));
            return;
        }
        self.jumps.push(TorqueJump { agent, t_s, switched, derivatives });
    }
}
