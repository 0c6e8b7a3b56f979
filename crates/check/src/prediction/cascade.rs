//! The cascaded variables of the proofs of Theorems 2 and 3, and how far they are apart.
//!
//! With roots κ₀ … κ_{ℓ−1} let ψ₀ = q and ψ_{r+1} = ψ_r + ψ̇_r/κ_r, so that ψ_ℓ = X/α₀. With s ≡ 0, (24) and (a5) are
//!
//! ```text
//! ψ̇_r = −κ_r (ψ_r − ψ_{r+1}), r < ℓ        ψ̇_{ℓ,i} = −Σⱼ w_ij (ψ_{ℓ,i} − h_ij)
//! h_ij = q_j(t−T_ij)                        when positions are sent
//! h_ij = (q_j + q̇_j/κ₀ᵢ)(t−T_ij) = [(1 − κ₀ⱼ/κ₀ᵢ) q_j + (κ₀ⱼ/κ₀ᵢ) ψ_{1,j}](t−T_ij)   when velocities are sent as well
//! ```
//!
//! which is (a6) and (30) divided by its constants. Every variable moves towards others of its own time or of a window as long as the longest
//! delay, so none leaves the interval that all of them, and what is on its way, lie in: the interval never grows, whatever the graph and the delays
//! do, and the value agreed upon, if there is one, is inside. For velocities this needs κ₀ⱼ ≤ κ₀ᵢ where i hears j, which
//! within a strongly connected component is the common κ₀ of Theorem 2. Of vehicles in formation x₀ and x₁ are x − d and ẋ − ḋ.

use std::collections::VecDeque;

use forwardstep_sim::reference::PureIntegral;
use forwardstep_sim::{AgentSetup, Recording, Setup, Signal, ThrustLaw};
use thiserror::Error;

use crate::graphs::laplacian_stays;
use crate::instance::{designed, is_consensus};
use crate::kinds::{is_its_own_reference, is_lagrangian};

/// The interval of all cascaded variables and of all messages on their way, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct CascadeSpread {
    /// Its lower end, row by row for every axis, in the unit of the axis.
    pub low: Vec<Vec<f64>>,
    /// Its upper end.
    pub high: Vec<Vec<f64>>,
}

/// Why there is no such interval.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NoCascade {
    /// Reference dynamics other than those of consensus.
    #[error("the reference dynamics are no cascade towards consensus")]
    Reference,
    /// What (3) and (23) integrate is not the law where the Laplacian changes.
    #[error("(3) and (23) are for fixed graphs with constant weights")]
    PureIntegral,
    /// What is heard is no weighted mean.
    #[error("the coupling is nonlinear")]
    Coupling,
    /// A law whose columns are not those of a robot under (6)–(7).
    #[error("agent number {} is no robot under the adaptive or the known law, and no vehicle that a reference leads", agent + 1)]
    Law {
        /// Index of the agent.
        agent: usize,
    },
    /// There are no first-order averages between a position and what is sent.
    #[error("not all roots of agent number {} are real, so that there is no chain of averages", agent + 1)]
    ComplexRoots {
        /// Index of the agent.
        agent: usize,
    },
    /// Then messages are no weighted means of cascaded variables.
    #[error("agent number {} hears velocities of agent number {}, whose first root is larger", to + 1, from + 1)]
    FirstRoots {
        /// The sender.
        from: usize,
        /// The receiver.
        to: usize,
    },
    /// Agents have different numbers of axes.
    #[error("the agents do not have the same axes")]
    Axes,
    /// Velocities that do not follow a reference are heard to the end.
    #[error("velocities from before the start are still on their way at the end of the horizon")]
    StillOnItsWay,
    /// A column or a row is missing.
    #[error("not all derivatives of the reference were recorded")]
    NotRecorded,
}

impl CascadeSpread {
    /// From the rows of a run: of [`crate::ideal`], whose intervals do not grow but for what happens between rows, or of
    /// robots, where they grow by what s does. `setup` is that of the run.
    ///
    /// # Errors
    /// [`NoCascade`] when the variables are not defined, or were not recorded.
    pub fn of(setup: &Setup, recording: &Recording) -> Result<CascadeSpread, NoCascade> {
        let designed = designed(setup);
        let setup = designed.as_ref().unwrap_or(setup);
        defined(setup)?;
        let rows = recording.t_s.len();
        let axes = setup.agents.first().map_or(0, |agent| agent.robot.axes.len());
        let window_s = setup.network.max_delay_s();
        let (mut low, mut high) = (Vec::new(), Vec::new());
        for axis in 0..axes {
            // What moves, and what is sent.
            let mut own = [vec![f64::INFINITY; rows], vec![f64::NEG_INFINITY; rows]];
            let mut sent = own.clone();
            for (agent, setup_of) in setup.agents.iter().enumerate() {
                let columns = derivatives(recording, agent, axis, setup_of.roots_per_s.len())?;
                let offset = setup_of.target.as_ref().and_then(|target| target.paths().get(axis));
                let mut x = vec![0.0; columns.len()];
                for row in 0..rows {
                    for (x, column) in x.iter_mut().zip(&columns) {
                        *x = column[row];
                    }
                    if let Some(offset) = offset {
                        // What follows are derivatives of the reference, which are of x − d already.
                        x.iter_mut().take(2).zip(offset.jet(recording.t_s[row])).for_each(|(x, d)| *x -= d);
                    }
                    let psi = cascade(&setup_of.roots_per_s.real, &mut x);
                    widen(&mut own, row, psi);
                    let told = if setup.exchange.has_velocities() { 2 } else { 1 };
                    widen(&mut sent, row, &psi[..told.min(psi.len())]);
                }
            }
            let [own_low, own_high] = own;
            let [sent_low, sent_high] = sent;
            low.push(over_window(&recording.t_s, window_s, &own_low, &sent_low, f64::min));
            high.push(over_window(&recording.t_s, window_s, &own_high, &sent_high, f64::max));
        }
        Ok(CascadeSpread { low, high })
    }

    /// The interval of the last row, for every axis.
    pub fn last(&self) -> Vec<[f64; 2]> {
        let ends = self.low.iter().zip(&self.high);
        ends.filter_map(|(low, high)| Some([*low.last()?, *high.last()?])).collect()
    }

    /// The largest length of the interval over all axes, row by row.
    pub fn widths(&self) -> Vec<f64> {
        let rows = self.low.first().map_or(0, Vec::len);
        let width = |row: usize| self.low.iter().zip(&self.high).map(move |(low, high)| high[row] - low[row]);
        (0..rows).map(|row| width(row).fold(0.0, f64::max)).collect()
    }
}

/// Whether the variables are defined and their interval never grows.
pub(super) fn defined(setup: &Setup) -> Result<(), NoCascade> {
    if !is_consensus(setup) {
        return Err(NoCascade::Reference);
    }
    if setup.reference.is::<PureIntegral>() && !laplacian_stays(setup) {
        return Err(NoCascade::PureIntegral);
    }
    if !setup.network.coupling.is_linear() {
        return Err(NoCascade::Coupling);
    }
    if let Some(agent) = setup.agents.iter().position(|agent| !has_columns(agent)) {
        return Err(NoCascade::Law { agent });
    }
    if let Some(agent) = setup.agents.iter().position(|agent| agent.roots_per_s.all_real().is_none()) {
        return Err(NoCascade::ComplexRoots { agent });
    }
    let axes = |agent: &AgentSetup| agent.robot.axes.len();
    if setup.agents.iter().any(|agent| axes(agent) != axes(&setup.agents[0])) {
        return Err(NoCascade::Axes);
    }
    let first_root = |agent: usize| setup.agents.get(agent).and_then(|agent| agent.roots_per_s.first_real());
    let larger = |from: usize, to: usize| first_root(from) > first_root(to);
    let mut edges = setup.network.schedule.graphs.iter().flatten();
    match edges.find(|edge| larger(edge.from, edge.to)) {
        Some(edge) if setup.exchange.has_velocities() => Err(NoCascade::FirstRoots { from: edge.from, to: edge.to }),
        Some(_) | None => Ok(()),
    }
}

/// Whether its positions, velocities and references are recorded.
fn has_columns(agent: &AgentSetup) -> bool {
    is_lagrangian(agent) || agent.law.is::<ThrustLaw>() && !is_its_own_reference(agent)
}

/// The columns of x₀ … x_ℓ: q, q̇, ż, z̈, ….
fn derivatives(recording: &Recording, agent: usize, axis: usize, order: usize) -> Result<Vec<&[f64]>, NoCascade> {
    let signal = |r: usize| match r {
        0 => Some(Signal::Position),
        1 => Some(Signal::Velocity),
        _ => u8::try_from(r - 1).ok().map(Signal::Reference),
    };
    let column = |r: usize| {
        let wanted = signal(r)?;
        let is =
            |column: &&forwardstep_sim::Column| (column.agent, column.signal, column.axis) == (agent, wanted, axis);
        recording.columns.iter().find(is).map(|column| column.values.as_slice())
    };
    let found: Option<Vec<&[f64]>> = (0..=order).map(column).collect();
    let rows = recording.t_s.len();
    found.filter(|found| found.iter().all(|column| column.len() == rows)).ok_or(NoCascade::NotRecorded)
}

/// ψ₀ … ψ_ℓ in the place of x₀ … x_ℓ.
pub(super) fn cascade<'a>(roots_per_s: &[f64], x: &'a mut [f64]) -> &'a [f64] {
    for (r, root) in roots_per_s.iter().enumerate() {
        // From entry r on stand ψ_r and its derivatives, from entry r + 1 on soon those of ψ_{r+1}.
        for k in (r + 1..x.len()).rev() {
            x[k] = x[k - 1] + x[k] / root;
        }
    }
    x
}

/// Lets the interval of a row hold `values`; a value that is not a number makes it unbounded.
fn widen([low, high]: &mut [Vec<f64>; 2], row: usize, values: &[f64]) {
    for value in values {
        if value.is_nan() {
            (low[row], high[row]) = (f64::NEG_INFINITY, f64::INFINITY);
        }
        low[row] = low[row].min(*value);
        high[row] = high[row].max(*value);
    }
}

/// The extreme of `own` at every row and of `sent` over the window before it, from the last row on that is no later than its
/// beginning.
fn over_window(t_s: &[f64], window_s: f64, own: &[f64], sent: &[f64], extreme: fn(f64, f64) -> f64) -> Vec<f64> {
    // Rows whose values are not passed by later ones, the extreme one first.
    let mut kept: VecDeque<usize> = VecDeque::new();
    let mut result = Vec::with_capacity(t_s.len());
    for (row, now_s) in t_s.iter().enumerate() {
        while kept.back().is_some_and(|last| extreme(sent[*last], sent[row]) == sent[row]) {
            kept.pop_back();
        }
        kept.push_back(row);
        let is_over = |first: &usize| t_s.get(first + 1).is_some_and(|next_s| *next_s <= now_s - window_s);
        while kept.len() > 1 && kept.front().is_some_and(is_over) {
            kept.pop_front();
        }
        result.push(kept.front().map_or(own[row], |first| extreme(own[row], sent[*first])));
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eq_30_cascaded_variables_are_filtered_backwards() {
        // q = e^t with roots 2 and 4: ψ₁ = (1 + 1/2) q, ψ₂ = (1 + 1/4) ψ₁.
        assert_eq!(cascade(&[2.0, 4.0], &mut [8.0; 3]), [8.0, 12.0, 15.0]);
        // q = t at t = 3.
        assert_eq!(cascade(&[2.0, 4.0], &mut [3.0, 1.0, 0.0]), [3.0, 3.5, 3.75]);
    }

    #[test]
    fn a_window_begins_with_the_row_before_it() {
        let t_s = [0.0, 1.0, 2.0, 3.0, 4.0];
        let (own, sent) = ([0.0, 0.0, 7.0, 0.0, 0.0], [5.0, 4.0, 1.0, 3.0, 2.0]);
        assert_eq!(over_window(&t_s, 1.5, &own, &sent, f64::max), [5.0, 5.0, 7.0, 4.0, 3.0]);
        assert_eq!(over_window(&t_s, 1.0, &own, &sent, f64::max), [5.0, 5.0, 7.0, 3.0, 3.0]);
        assert_eq!(over_window(&t_s, 0.0, &own, &sent, f64::min), [0.0, 0.0, 1.0, 0.0, 0.0]);
    }
}
