//! How far behind their leader agents stay under (110) when messages are late, on a fixed graph: our own derivation.
//!
//! With D = sup|ξ̇_0|∞ < γ, delays of at most T_ij on the edges, L the Laplacian of the followers with the weights to the leader and
//! L c = D Σ_j w_ij T_ij, the error of ξ_i comes to c_i or less, see the head of `reference/following.rs` in the core. L is a
//! nonsingular M-matrix where the leader reaches everybody, so that c is not negative, and whatever v has L v ≥ D Σ_j w_ij T_ij in
//! all components is no smaller than c.
//!
//! The sign is held for a period of δ, in continuous time as well as by controllers that sample: what it makes of a message at the end of the
//! period is as old as the message was at its beginning, T_ij + δ, and between two such ends ξ_i moves along a straight line, which adds
//! ½ δ D to what ξ_0 moves meanwhile. So T_ij + 1½ δ stands for T_ij throughout. Controllers that sample hear up to a period later
//! besides, and once more where what is told was held. With a path of n agents that is n δ D and not δ D, however short the delays are.
//!
//! All of this takes it that a sample shows what the sign did at the one before. (110) reads q̇ to set ż, and (119) q̈ to set z̈: where torques
//! come late, or velocities are filtered, it sees that later still, and turns back too late. It chatters then over several samples, with all of
//! γ and not with D, and nothing is said of what that leaves. The signs of all other designs read ż, or what is kept of the leader.
//!
//! Such a v is looked for by sweeping to and fro, in any precision, and verified with a bound on rounding.

use forwardstep_sim::graph::{SpanningTree, spanning_tree};
use forwardstep_sim::leader::{Following, FollowingDesign};
use forwardstep_sim::{Exchange, Setup};

use crate::practical::Hold;

/// Edges that may be visited by sweeping.
const MOST_VISITS: usize = 50_000_000;
/// A change that is no more than this part of the largest entry ends the sweeping.
const SETTLED: f64 = 1e-13;
/// What is asked for beyond what is needed, as a part of the largest: far more than sweeping and rounding leave.
const MORE: f64 = 1e-9;

/// Whether the sign sees what it did through torques that come late or a filter of velocities.
pub(crate) fn sign_lags(setup: &Setup, following: &Following) -> bool {
    let reads_motion = match following.design {
        FollowingDesign::Continuous | FollowingDesign::Differentiable => true,
        FollowingDesign::Observer { .. }
        | FollowingDesign::WithoutAcceleration
        | FollowingDesign::Composite
        | FollowingDesign::Swarm { .. } => false,
    };
    reads_motion && setup.control.as_ref().is_some_and(|control| !Hold::of(control).is_ideal())
}

/// A bound of what is left of q_i − q_0 behind a filter 1/(p + α), or one of two real roots whose product is α, in the unit of the axes;
/// nothing where none could be verified, as of a leader that is an agent, of a delay without a bound, of a weight that varies, or of a sign that lags.
pub(crate) fn behind(setup: &Setup, following: &Following) -> Option<f64> {
    if sign_lags(setup, following) {
        return None;
    }
    bound(following, &rows(setup, following, true)?)
}

/// About what held signs leave where every agent hears what its neighbours did a sign, or a sample, ago, however short delays are.
pub(crate) fn held(setup: &Setup, following: &Following) -> Option<f64> {
    bound(following, &rows(setup, following, false)?)
}

fn bound(following: &Following, rows: &[Row]) -> Option<f64> {
    let drive = following.drive_bound(None);
    let needed: Vec<f64> = rows.iter().map(|row| drive * row.weight_s).collect();
    let most = needed.iter().copied().fold(0.0, f64::max);
    if !most.is_finite() {
        return None;
    }
    let asked: Vec<f64> = rows.iter().zip(&needed).map(|(row, each)| each + MORE * most * row.degree).collect();
    let c = solved(rows, &asked)?;
    let exceeds = exceeds(rows, &c, &needed);
    let largest = c.into_iter().fold(0.0, f64::max);
    exceeds.then_some(largest / following.alpha * (1.0 + 4.0 * f64::EPSILON)).filter(|bound| bound.is_finite())
}

/// Whether L c ≥ `needed` in all components, whatever was rounded.
fn exceeds(rows: &[Row], c: &[f64], needed: &[f64]) -> bool {
    rows.iter().zip(c).zip(needed).all(|((row, own), needed)| {
        let heard: f64 = row.heard.iter().map(|(from, weight)| weight * c[*from]).sum();
        let terms = row.terms as f64 + 4.0;
        let rounding = terms * f64::EPSILON * (row.degree * own + heard + needed);
        row.degree * own - heard - rounding >= *needed
    })
}

/// What one follower hears.
struct Row {
    /// Σ_j w_ij over all, the leader among them.
    degree: f64,
    /// How many they are.
    terms: usize,
    /// Σ_j w_ij (T_ij + 1½ δ) with what samples add, or as `held` has it.
    weight_s: f64,
    /// The followers among them, by their rows, with the weights.
    heard: Vec<(usize, f64)>,
}

/// With the delays of messages if they are `late`.
fn rows(setup: &Setup, following: &Following, late: bool) -> Option<Vec<Row>> {
    let edges = setup.network.schedule.constant_graph()?;
    if let SpanningTree::Missing { .. } = spanning_tree(setup.network.agents, edges) {
        return None;
    }
    let mut index = vec![None; setup.network.agents];
    let followers = (0..setup.network.agents).filter(|vertex| setup.leader() != Some(*vertex));
    let mut count = 0;
    for vertex in followers {
        index[vertex] = Some(count);
        count += 1;
    }
    let mut rows: Vec<Row> =
        (0..count).map(|_| Row { degree: 0.0, terms: 0, weight_s: 0.0, heard: Vec::new() }).collect();
    let sample_s = setup.control.as_ref().map(|control| 1.0 / control.sample_hz);
    // δ, and that controllers that sample hear up to a period later.
    let (hold_s, period_s) = (sample_s.unwrap_or(following.period_s), sample_s.unwrap_or(0.0));
    let holds = match setup.exchange {
        Exchange::Estimates | Exchange::Composite => true,
        Exchange::Position | Exchange::PositionVelocity => false,
    };
    for edge in edges {
        let Some(to) = *index.get(edge.to)? else { continue };
        let weight = edge.weight.constant()?;
        let known = setup.network.delays.get(edge.delay)?.known();
        if known.unknown.is_some() {
            return None;
        }
        let row = rows.get_mut(to)?;
        row.degree += weight;
        row.terms += 1;
        // What is told is what was held a sample ago, where it is not measured.
        let told_s = if holds && index.get(edge.from)?.is_some() { period_s } else { 0.0 };
        let message_s = if late {
            known.bound_s + period_s + 1.5 * hold_s
        } else {
            // A message that is late at all is heard a sample later.
            hold_s + if known.bound_s > 0.0 { period_s } else { 0.0 }
        };
        row.weight_s += weight * (message_s + told_s);
        row.heard.extend(index.get(edge.from)?.map(|from| (from, weight)));
    }
    Some(rows)
}

/// L c = `asked` by sweeping to and fro, from below.
fn solved(rows: &[Row], asked: &[f64]) -> Option<Vec<f64>> {
    let mut c = vec![0.0_f64; rows.len()];
    let visits: usize = rows.iter().map(|row| 1 + row.heard.len()).sum();
    for sweep in 0..MOST_VISITS / visits.max(1) {
        let mut change = 0.0_f64;
        let mut one = |i: usize| {
            let row = &rows[i];
            let heard: f64 = row.heard.iter().map(|(from, weight)| weight * c[*from]).sum();
            let value = (asked[i] + heard) / row.degree;
            change = change.max((value - c[i]).abs());
            c[i] = value;
        };
        if sweep % 2 == 0 {
            (0..rows.len()).for_each(&mut one)
        } else {
            (0..rows.len()).rev().for_each(&mut one)
        }
        let largest = c.iter().copied().fold(0.0, f64::max);
        if !largest.is_finite() {
            return None;
        }
        if change <= SETTLED * largest {
            break;
        }
    }
    Some(c)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A follower that hears the leader with weight one, and one that hears the first with a weight of three and has `terms` neighbours.
    fn rows(terms: usize) -> [Row; 2] {
        let row = |degree, terms, heard| Row { degree, terms, weight_s: 0.0, heard };
        [row(1.0, 1, Vec::new()), row(4.0, terms, vec![(0, 3.0)])]
    }

    #[test]
    fn a_bound_exceeds_what_is_needed_by_as_many_roundings_as_there_are_terms() {
        const STEP: f64 = f64::EPSILON;
        // One term, and four more, of 1 + 1: ten steps.
        let alone = |c: f64| exceeds(&rows(1)[..1], &[c], &[1.0]);
        assert_eq!([1.0, 1.0 + 9.0 * STEP, 1.0 + 11.0 * STEP].map(alone), [false, false, true]);
        // A hundred and four of 8 + 6 + 2.
        let both = |c: f64| exceeds(&rows(100), &[2.0, c], &[1.0, 2.0]);
        let least = 104.0 * 16.0 / 4.0 * STEP;
        assert_eq!([2.0, 2.0 + 0.99 * least, 2.0 + 1.01 * least].map(both), [false, false, true]);
        // The first is not exempt.
        assert!(!exceeds(&rows(1), &[0.5, 9.0], &[1.0, 2.0]));
    }
}
