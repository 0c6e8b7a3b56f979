//! The rate of agreement over a fixed graph with constant delays: the rightmost characteristic root beside zero, how much of the start
//! goes into it, and when that and the next ones let the disagreement settle.
//!
//! - `characteristic`: the characteristic matrix and the Laplace transform of the start.
//! - `collocation`: where to look for roots.
//! - `eigenvalues`: of a dense matrix.
//! - `modes`: groups of roots and their parts of the solution.
//!
//! A root comes with the last step of Newton's method and the backward error of the matrix there. That no other root is further to the
//! right is what collocation says, which is not enclosed.

pub(crate) mod characteristic;
mod collocation;
pub(crate) mod eigenvalues;
mod modes;

use forwardstep_core::reference::RootSet;
use forwardstep_sim::Setup;
use forwardstep_sim::graph::{Edge, SpanningTree, spanning_tree};
use nalgebra::DMatrix;
use thiserror::Error;

use self::characteristic::{C, Characteristic, size};
use self::collocation::{candidates, unknowns};
use self::modes::{Mode, backward_error, modes};
use super::ideal::{NoIdeal, ideal};
use super::settled::{Settled, settled};
use crate::fixed::{Link, NotFixed, fixed};

/// The rate of agreement, for s ≡ 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    /// Real and imaginary part of the rightmost root beside zero, 1/s: in the long run the disagreement falls like e^(re t).
    pub root_per_s: [f64; 2],
    /// How many roots stand there.
    pub multiplicity: usize,
    /// The size of the last correction of it, by Newton's method or of the mean of several, 1/s.
    pub correction_per_s: f64,
    /// The relative change of the characteristic matrix that makes it exactly singular there.
    pub backward_error: f64,
    /// The largest disagreement that the start makes by it, in the unit of the axes: zero means that the start does not excite it, and
    /// the disagreement falls faster.
    pub excited: f64,
    /// When the disagreement settles, by this root and the next ones.
    pub settled: Settled,
}

/// Why no rate is predicted.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoRate {
    /// The references depend on more than the network.
    #[error(transparent)]
    Ideal(#[from] NoIdeal),
    /// There is nothing to compare, or agents have different numbers of axes.
    #[error("there are no two agents with the same axes to compare")]
    Agents,
    /// The network changes, or is not linear.
    #[error(transparent)]
    NotFixed(#[from] NotFixed),
    /// Zero is a root of several, and nothing makes all agree.
    #[error("no agent reaches all others")]
    NoSpanningTree,
    /// The eigenvalue problem is too large, and the network is not one whose Laplacian tells all.
    #[error(
        "its eigenvalue problem has {unknowns} unknowns, more than {MOST_UNKNOWNS}, and agents, weights or delays differ, or there are more \
         than {MOST_AGENTS} agents"
    )]
    TooLarge {
        /// Unknowns of the smallest collocation.
        unknowns: usize,
    },
    /// A root lies to the right of the axis, as it may where roots of the reference dynamics are complex.
    #[error("the disagreement grows: a characteristic root has the real part {per_s:.4} per second")]
    Grows {
        /// Its real part, 1/s.
        per_s: f64,
    },
    /// Roots that could not be told apart, or a setup without meaning.
    #[error("the characteristic roots could not be told apart")]
    Unclear,
}

/// An eigenvalue problem of this size takes about a second.
const MOST_UNKNOWNS: usize = 200;
/// A Laplacian of this size does.
const MOST_AGENTS: usize = 200;
/// Nodes per sender: at least, and at most.
const NODES: [usize; 2] = [6, 20];

/// Predicts the rate of agreement of `setup` for s ≡ 0, from its characteristic roots.
///
/// # Errors
/// [`NoRate`] when there are none, or they are too many.
pub fn rate(setup: &Setup) -> Result<Rate, NoRate> {
    let ideal = ideal(setup)?;
    let modes = all_modes(&ideal)?;
    let system = system(&ideal)?;
    // The one at zero is agreement itself.
    let slowest = modes.get(1).ok_or(NoRate::Unclear)?;
    Ok(Rate {
        root_per_s: [slowest.rightmost.re, slowest.rightmost.im],
        multiplicity: slowest.multiplicity,
        correction_per_s: slowest.correction,
        backward_error: backward_error(&system, slowest.rightmost),
        excited: slowest.excited(),
        settled: by_modes(&system, &modes),
    })
}

/// The rightmost modes of a setup in which everybody follows exactly, that at zero first.
fn all_modes(ideal: &Setup) -> Result<Vec<Mode>, NoRate> {
    let system = system(ideal)?;
    let roots: Vec<&RootSet> = ideal.agents.iter().map(|agent| &agent.roots_per_s).collect();
    let found = all_candidates(&system, &roots)?;
    let most = if system.agents() <= 60 { 8 } else { 3 };
    let modes = modes(&system, &found, most);
    let fastest = modes.iter().map(|mode| size(mode.root)).fold(0.0, f64::max);
    match &modes[..] {
        [zero, slowest, ..] if size(zero.root) <= 1e-6 * fastest && zero.members == 1 && slowest.root.re < 0.0 => {
            Ok(modes)
        }
        [first, ..] if first.root.re > 1e-6 * fastest => Err(NoRate::Grows { per_s: first.root.re }),
        _ => Err(NoRate::Unclear),
    }
}

fn system(ideal: &Setup) -> Result<Characteristic, NoRate> {
    let axes = |agent: &forwardstep_sim::AgentSetup| agent.robot.axes.len();
    if ideal.agents.len() < 2 || ideal.agents.iter().any(|agent| axes(agent) != axes(&ideal.agents[0])) {
        return Err(NoRate::Agents);
    }
    network(ideal)
}

/// The characteristic matrix of one agent or more.
pub(crate) fn network(ideal: &Setup) -> Result<Characteristic, NoRate> {
    let network = &ideal.network;
    let is_there = |edge: &Edge| edge.from.max(edge.to) < ideal.agents.len() && edge.delay < network.delays.len();
    if !network.schedule.graphs.iter().flatten().all(is_there) {
        return Err(NoRate::Unclear);
    }
    let (edges, links) = fixed(network)?;
    if !matches!(spanning_tree(ideal.agents.len(), edges), SpanningTree::Rooted { .. }) {
        return Err(NoRate::NoSpanningTree);
    }
    Characteristic::of(ideal, links).ok_or(NoRate::Unclear)
}

/// Where roots are, by the eigenvalues of one matrix, or of one for every eigenvalue of the Laplacian.
fn all_candidates(system: &Characteristic, roots: &[&RootSet]) -> Result<Vec<C>, NoRate> {
    let [states, late] = unknowns(system);
    let [least, most] = NODES;
    let smallest = states + least * late;
    if smallest <= MOST_UNKNOWNS {
        let nodes = (MOST_UNKNOWNS - states).checked_div(late).unwrap_or(most).min(most);
        return candidates(system, roots, nodes).ok_or(NoRate::Unclear);
    }
    if system.agents() > MOST_AGENTS || !is_uniform(system) {
        return Err(NoRate::TooLarge { unknowns: smallest });
    }
    by_laplacian(system, roots[0]).ok_or(NoRate::Unclear)
}

/// Whether all agents have the same roots and the same degree, and all messages are equally late.
fn is_uniform(system: &Characteristic) -> bool {
    let degree = system.degree[0];
    let same_agents = system.coefficients.iter().all(|a| *a == system.coefficients[0])
        && system.degree.iter().all(|d| (d - degree).abs() <= 1e-12 * degree);
    let delay_s = system.links.first().map(|link| link.delay_s);
    same_agents && system.links.iter().all(|link| Some(link.delay_s) == delay_s)
}

/// With everything uniform, every eigenvalue μ of the weights over the degree has the roots of (p + d) P − μ d (1 + v p/κ₀) e^(−pT). A
/// complex μ is two real agents that hear themselves and each other.
fn by_laplacian(system: &Characteristic, roots: &RootSet) -> Option<Vec<C>> {
    let n = system.agents();
    let mut shares = DMatrix::zeros(n, n);
    for link in &system.links {
        shares[(link.to, link.from)] += link.weight / system.degree[0];
    }
    let eigenvalues = eigenvalues::eigenvalues(&shares)?;
    let (degree, delay_s) = (system.degree[0], system.links.first()?.delay_s);
    let mut all = Vec::new();
    for mu in eigenvalues.iter().filter(|mu| mu.im >= 0.0) {
        let link = |from, to, weight: f64| Link { from, to, weight: weight * degree, delay_s };
        let pair = mu.im > 0.0;
        let links = if pair {
            vec![link(0, 0, mu.re), link(1, 0, -mu.im), link(0, 1, mu.im), link(1, 1, mu.re)]
        } else {
            vec![link(0, 0, mu.re)]
        };
        let agents = if pair { 2 } else { 1 };
        let reduced = Characteristic {
            coefficients: vec![system.coefficients[0].clone(); agents],
            first_root: vec![system.first_root[0]; agents],
            degree: vec![degree; agents],
            links,
            velocities: system.velocities,
            start: Vec::new(),
        };
        all.extend(candidates(&reduced, &vec![roots; agents], NODES[1])?);
    }
    Some(all)
}

/// Rows of the course that the modes give.
const ROWS: usize = 4000;

/// By how much the modes that are known may miss the disagreement at the start, as a part of it, to say when it settles.
const MISSED: f64 = 0.05;

/// When the disagreement of these modes settles, relative to that of the start; the first is agreement. Modes that are near to each other
/// are large and cancel, so that those which are left out count: then nothing is said.
fn by_modes(system: &Characteristic, modes: &[Mode]) -> Settled {
    let (agreement, modes) = (&modes[0], &modes[1..]);
    let starts = |axis: usize| system.start.iter().map(move |agent| agent[axis][0]);
    let spread = |values: &mut dyn Iterator<Item = f64>| {
        let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], q| [low.min(q), high.max(q)]);
        high - low
    };
    let start = (0..system.axes()).map(|axis| spread(&mut starts(axis))).fold(0.0, f64::max);
    if start.is_nan() || start <= 0.0 {
        return Settled::NoStart;
    }
    // Until every mode is well below 1 %.
    let last =
        |mode: &Mode| libm::log((1000.0 * mode.members as f64 * mode.excited() / start).max(1.0)) / -mode.root.re;
    let end_s = modes.iter().map(last).fold(0.0, f64::max);
    if !(end_s > 0.0 && end_s.is_finite()) {
        return Settled::At(0.0);
    }
    let t_s: Vec<f64> = (0..=ROWS).map(|row| end_s * row as f64 / ROWS as f64).collect();
    let at = |t_s: &f64| {
        let mut q = modes[0].at(*t_s);
        for mode in &modes[1..] {
            q += mode.at(*t_s);
        }
        q.column_iter().map(|axis| spread(&mut axis.iter().copied())).fold(0.0, f64::max)
    };
    let whole = modes.iter().fold(agreement.at(0.0), |sum, mode| sum + mode.at(0.0));
    let missed = |axis: usize| {
        starts(axis).zip(whole.column(axis).iter()).map(|(q, known)| (q - known).abs()).fold(0.0, f64::max)
    };
    let cancels = modes.iter().map(Mode::excited).fold(0.0, f64::max) > 10.0 * start;
    if cancels && (0..system.axes()).any(|axis| missed(axis) > MISSED * start) {
        return Settled::NotYet;
    }
    let mut disagreement: Vec<f64> = t_s.iter().map(at).collect();
    disagreement[0] = start;
    settled(&t_s, &disagreement)
}

#[cfg(test)]
mod tests;
