//! The same network and the same gains under reference dynamics of several orders: higher is smoother and slower.

use std::ops::ControlFlow;

use forwardstep_sim::recording::Outcome;
use forwardstep_sim::reference::Consensus;
use forwardstep_sim::{AgentSetup, Progress, Setup, simulate, validate};
use thiserror::Error;

use super::covered::{MOST, refused};
use super::{LargestJump, NoSmoothness, NotCovered, Smoothness, smoothness};
use crate::kinds::is_lagrangian;
use crate::prediction::{disagreement, settled};

/// Rows of a trace on either side.
const ROWS: f64 = 400.0;

/// What one order gives.
#[derive(Clone, Debug, PartialEq)]
pub struct OfOrder {
    /// ℓ.
    pub order: usize,
    /// When the disagreement has settled to 1 % of its start, s; `None` when it has not by the end of the run.
    pub settled_s: Option<f64>,
    /// The largest jump of the derivative of order ℓ − 1 of the torque, N m/sˡ⁻¹ or N/sˡ⁻¹; `None` where nothing that is heard jumps.
    pub jump: Option<LargestJump>,
    /// Whether no derivative below jumps.
    pub kept: bool,
    /// When the rows of the recording are, s.
    pub t_s: Vec<f64>,
    /// The largest difference of two positions at each of them, rad or m.
    pub disagreement: Vec<f64>,
}

/// The torque of one axis around one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// ℓ.
    pub order: usize,
    /// Instants, s.
    pub t_s: Vec<f64>,
    /// The torque at each of them, N m or N.
    pub torque: Vec<f64>,
}

/// Why orders cannot be compared.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoOrders {
    /// The reference dynamics are others.
    #[error("{reference} has no order to change; give a scenario under the consensus family")]
    Family {
        /// What leads the agents.
        reference: &'static str,
    },
    /// An order that is not computed.
    #[error("the order {order} is not one from 1 to {MOST}")]
    Order {
        /// ℓ.
        order: usize,
    },
    /// An agent whose order is not free.
    #[error("all agents must be under (6)–(7) with reference dynamics of any order, but not {name}: {reason}")]
    Agent {
        /// The agent.
        name: String,
        /// Why.
        reason: NotCovered,
    },
    /// A pair of complex roots cannot be taken apart or repeated.
    #[error("not all roots of {name} are real: which of them an order keeps is not defined")]
    ComplexRoots {
        /// The agent.
        name: String,
    },
    /// There are no jumps to report.
    #[error(transparent)]
    Smoothness(#[from] NoSmoothness),
}

/// Simulates `setup` with each of the `orders`: an agent keeps its first roots, and its last one repeats where there are too few.
///
/// # Errors
/// [`NoOrders`].
pub fn orders(
    setup: &Setup,
    orders: &[usize],
    observer: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Vec<OfOrder>, NoOrders> {
    if !setup.reference.is::<Consensus>() {
        return Err(NoOrders::Family { reference: setup.reference.words().name });
    }
    if let Some(order) = orders.iter().copied().find(|order| !(1..=MOST).contains(order)) {
        return Err(NoOrders::Order { order });
    }
    if let Some(agent) = setup.agents.iter().find(|agent| agent.roots_per_s.all_real().is_none()) {
        return Err(NoOrders::ComplexRoots { name: agent.name.clone() });
    }
    let setups: Vec<(usize, Setup)> = orders.iter().map(|order| (*order, of_order(setup, *order))).collect();
    if let Some((name, reason)) = uncovered(setups.iter().map(|(_, setup)| setup))? {
        return Err(NoOrders::Agent { name, reason });
    }
    setups.iter().map(|(order, setup)| Ok(found(*order, &smoothness(setup, observer)?, setup))).collect()
}

/// The first agent of some setup that is not a robot under (6)–(7) in a network, and why.
///
/// # Errors
/// [`NoSmoothness::Setup`] when there is none and some setup has no meaning.
pub(super) fn uncovered<'a>(
    setups: impl Iterator<Item = &'a Setup> + Clone,
) -> Result<Option<(String, NotCovered)>, NoSmoothness> {
    let other = |own: &AgentSetup| NotCovered::Law { law: own.law.words().name };
    for setup in setups.clone() {
        for (agent, own) in setup.agents.iter().enumerate() {
            let reason = refused(setup, agent).or_else(|| (!is_lagrangian(own)).then(|| other(own)));
            if let Some(reason) = reason {
                return Ok(Some((own.name.clone(), reason)));
            }
        }
    }
    for setup in setups {
        validate(setup)?;
    }
    Ok(None)
}

fn of_order(setup: &Setup, order: usize) -> Setup {
    let mut setup = setup.clone();
    for agent in &mut setup.agents {
        if let Some(last) = agent.roots_per_s.real.last().copied() {
            agent.roots_per_s.real.resize(order, last);
        }
        agent.start.reference.truncate(order);
    }
    setup
}

/// The torque of the agent and axis of `at` under each of the `orders`, at instants up to `within_s` around that of `at`, which are
/// closer together than the rows of `setup`.
///
/// # Errors
/// [`NoOrders`].
pub fn traces(
    setup: &Setup,
    orders: &[usize],
    at: LargestJump,
    within_s: f64,
    observer: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Vec<Trace>, NoOrders> {
    let trace = |order: &usize| {
        let mut setup = of_order(setup, *order);
        setup.time.end_s = setup.time.end_s.min(at.t_s + within_s);
        setup.time.record_every_s = within_s / ROWS;
        let Outcome { recording, .. } = simulate(&setup, observer).map_err(NoSmoothness::Setup)?;
        let torque = recording.values(at.agent, at.signal, at.axis).unwrap_or(&[]);
        let near = recording.t_s.iter().zip(torque).filter(|(t_s, _)| (**t_s - at.t_s).abs() <= within_s);
        let (t_s, torque) = near.map(|(t_s, torque)| (*t_s, *torque)).unzip();
        Ok(Trace { order: *order, t_s, torque })
    };
    orders.iter().map(trace).collect()
}

fn found(order: usize, smoothness: &Smoothness, setup: &Setup) -> OfOrder {
    let recording = &smoothness.outcome.recording;
    let axes = setup.agents.first().map_or(0, |agent| agent.robot.axes.len());
    let jumps = smoothness.kinds().into_iter().filter_map(|kind| smoothness.largest(kind, order - 1));
    let disagreement = disagreement(recording, axes);
    OfOrder {
        order,
        settled_s: settled(&recording.t_s, &disagreement).time_s(),
        jump: jumps.reduce(|most, next| if next.size > most.size { next } else { most }),
        kept: smoothness.kept(),
        t_s: recording.t_s.clone(),
        disagreement,
    }
}
