//! How smooth inputs are: the jumps of their derivatives at every switch of the graph and every jump of a delay.
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
//! The inputs of other plants, of other laws, and of robots whose reference dynamics cannot be expanded, jump as the first variation of the closed loop
//! says, [`InputJump`]: that needs no series, and says nothing of the values on both sides.
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
use forwardstep_sim::recording::{Outcome, Signal};
use forwardstep_sim::{
    Ending, InputJump, NetworkJump, Observers, Progress, Setup, SetupError, check_setup, input_orders, simulate_with,
};
use thiserror::Error;

pub use covered::{Covered, NotCovered};
pub use filters::{FilteredJump, Filters, NoFilters, filters};
pub use orders::{NoOrders, OfOrder, Trace, orders, traces};

use covered::covered;
use expansion::Expansion;

/// The jumps of the inputs along one run.
#[derive(Clone, Debug)]
pub struct Smoothness {
    /// Of every agent, its inputs that were looked at.
    pub agents: Vec<Result<Vec<Covered>, NotCovered>>,
    /// Instants at which the graph switched.
    pub switches: usize,
    /// Other instants at which delays jumped, or might have.
    pub delay_jumps: usize,
    /// Every instant at which what an agent hears jumped, in the order of time.
    pub jumps: Vec<Jump>,
    /// The run.
    pub outcome: Outcome,
}

/// What an input of one agent did at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Jump {
    /// Index of the agent.
    pub agent: usize,
    /// The input.
    pub signal: Signal,
    /// The instant, s.
    pub t_s: f64,
    /// Whether the graph changed; otherwise a delay jumped.
    pub switched: bool,
    /// The r-th derivative of every entry, for r = 0, 1, ….
    pub derivatives: Vec<Vec<Change>>,
}

/// What a derivative of an input did at an instant, in the unit of the input over sʳ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// How far it jumps.
    pub jump: f64,
    /// What it jumps from and to, of a robot under (6)–(7) whose torque was expanded.
    pub sides: Option<Sides>,
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

/// The largest jump of one derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LargestJump {
    /// Index of the agent.
    pub agent: usize,
    /// The input.
    pub signal: Signal,
    /// Its entry.
    pub axis: usize,
    /// The instant, s.
    pub t_s: f64,
    /// Whether the graph changed; otherwise a delay jumped.
    pub switched: bool,
    /// How large it is, in the unit of the input over sʳ.
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
    /// The dynamics of a robot, or of its reference, do not have the size that is stated.
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
        "derivative {derivative} of the input of {name} is not finite at {t_s} s: the motion is too violent for numbers"
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

/// Simulates `setup` and reports what the derivatives of every input do where the network jumps; `observer` as that of
/// [`forwardstep_sim::simulate`].
///
/// # Errors
/// [`NoSmoothness`].
pub fn smoothness(
    setup: &Setup,
    observer: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Smoothness, NoSmoothness> {
    check_setup(setup)?;
    if setup.control.is_some() {
        return Err(NoSmoothness::Sampled);
    }
    let mut agents = Vec::new();
    let mut expansions = Vec::new();
    for (agent, orders) in input_orders(setup)?.into_iter().enumerate() {
        let expansion = Expansion::new(setup, agent)?;
        agents.push(covered(setup, agent, expansion.as_ref().map(Expansion::derivatives), &orders));
        expansions.push(expansion);
    }
    if let (Some(Err(reason)), true) = (agents.first(), agents.iter().all(Result::is_err)) {
        return Err(NoSmoothness::NoAgent { name: setup.agents[0].name.clone(), reason: *reason });
    }
    let said = agents.iter().map(Result::is_ok).collect();
    let mut seen = Seen { expansions, said, ..Seen::default() };
    let outcome = simulate_with(
        setup,
        observer,
        Observers { jumps: Some(&mut |jump| seen.look(&jump)), ..Observers::default() },
    )?;
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
        Ending::Interrupted { t_s } | Ending::CutOff { t_s } => Err(NoSmoothness::Early { t_s: *t_s }),
        Ending::BrokeDown(breakdown) => Err(NoSmoothness::Early { t_s: breakdown.t_s }),
    }
}

impl Smoothness {
    /// The inputs of which something is reported, by what they are, how many derivatives that is and what is promised of them: each kind once.
    pub fn kinds(&self) -> Vec<Covered> {
        let mut kinds: Vec<Covered> = self.agents.iter().flatten().flatten().copied().collect();
        kinds.sort_by_key(|covered| (covered.signal, covered.derivatives, covered.continuous));
        kinds.dedup();
        kinds
    }

    /// The agents that have an input of this kind.
    pub fn agents_of(&self, kind: Covered) -> Vec<usize> {
        let has = |agent: &usize| self.agents[*agent].as_ref().is_ok_and(|inputs| inputs.contains(&kind));
        (0..self.agents.len()).filter(has).collect()
    }

    /// The largest jump of the derivative of order `r` among the inputs of one of the [`Smoothness::kinds`]; `None` where nothing they hear ever jumps,
    /// or their derivatives end below. Torques in N m and forces in N are compared as the numbers that they are.
    pub fn largest(&self, kind: Covered, r: usize) -> Option<LargestJump> {
        let of_kind = |jump: &&Jump| self.of(jump) == Some(kind);
        let sizes = |jump: &Jump| -> Vec<LargestJump> {
            let Jump { agent, signal, t_s, switched, .. } = *jump;
            let each = |(axis, change): (usize, &Change)| {
                let size = change.jump.abs();
                LargestJump { agent, signal, axis, t_s, switched, size }
            };
            jump.derivatives.get(r).into_iter().flatten().enumerate().map(each).collect()
        };
        let all = self.jumps.iter().filter(of_kind).flat_map(sizes);
        // The first of several that are as large.
        all.reduce(|most, next| if next.size > most.size { next } else { most })
    }

    /// Whether no derivative jumps that must not.
    pub fn kept(&self) -> bool {
        self.jumps.iter().all(|jump| {
            let continuous = self.of(jump).and_then(|covered| covered.continuous).unwrap_or(0);
            jump.derivatives.iter().take(continuous).flatten().all(|change| change.jump == 0.0)
        })
    }

    fn of(&self, jump: &Jump) -> Option<Covered> {
        let inputs = self.agents.get(jump.agent)?.as_ref().ok()?;
        inputs.iter().copied().find(|covered| covered.signal == jump.signal)
    }
}

/// What a run shows.
#[derive(Default)]
struct Seen {
    /// Of every agent, where its torque is expanded; of the others the first variation is reported.
    expansions: Vec<Option<Expansion>>,
    /// Whether something is said of an agent.
    said: Vec<bool>,
    switches: usize,
    delay_jumps: usize,
    /// The last instant counted, s.
    counted_s: f64,
    jumps: Vec<Jump>,
    /// The first that could not be computed: agent, instant, why.
    trouble: Option<(usize, f64, Trouble)>,
}

enum Trouble {
    Length(LengthError),
    /// The order of the derivative.
    NotFinite(usize),
}

impl Seen {
    fn look(&mut self, jump: &NetworkJump<'_>) {
        if jump.t_s > self.counted_s {
            self.counted_s = jump.t_s;
            if jump.switched { self.switches += 1 } else { self.delay_jumps += 1 }
        }
        let NetworkJump { agent, t_s, switched, .. } = *jump;
        let said = self.said.get(agent).copied().unwrap_or(false);
        // From the same numbers both sides would compute the same.
        if !said || self.trouble.is_some() || jump.before == jump.after {
            return;
        }
        let changes = match self.expansions.get_mut(agent).and_then(Option::as_mut) {
            Some(expansion) => expanded(expansion, jump).map(|changes| vec![(Signal::Torque, changes)]),
            None => Ok(jump.inputs.iter().map(varied).collect()),
        };
        match changes {
            Ok(changes) => changes.into_iter().for_each(|(signal, derivatives)| {
                let infinite = |changes: &Vec<Change>| changes.iter().any(|change| !change.jump.is_finite());
                match derivatives.iter().position(infinite) {
                    Some(r) => self.trouble = Some((agent, t_s, Trouble::NotFinite(r))),
                    None => self.jumps.push(Jump { agent, signal, t_s, switched, derivatives }),
                }
            }),
            Err(error) => self.trouble = Some((agent, t_s, Trouble::Length(error))),
        }
    }
}

/// Every derivative of a torque, from its series on both sides.
fn expanded(expansion: &mut Expansion, jump: &NetworkJump<'_>) -> Result<Vec<Vec<Change>>, LengthError> {
    let (before, after) = (expansion.torque(jump, jump.before)?, expansion.torque(jump, jump.after)?);
    let change = |r: usize| {
        let sides = before.iter().zip(&after).map(move |(before, after)| (before.derivative(r), after.derivative(r)));
        let of = |(before, after)| Change { jump: after - before, sides: Some(Sides { before, after }) };
        sides.map(of).collect()
    };
    Ok((0..expansion.derivatives()).map(change).collect())
}

/// Every derivative of an input, from the first variation.
fn varied(input: &InputJump) -> (Signal, Vec<Vec<Change>>) {
    let change = |jump: &f64| Change { jump: *jump, sides: None };
    (input.signal, input.derivatives.iter().map(|entries| entries.iter().map(change).collect()).collect())
}
