//! Which theorem speaks about a setup, and whether its hypotheses hold: a file for each theorem or section.

mod baseline;
mod declared;
mod desired;
mod following;
mod own_targets;
pub(crate) mod swarm;
mod theorem_1;
mod theorem_3;
mod tried;

pub(crate) use following::certainly_slowest_per_s;
pub(crate) use own_targets::{hurwitz, lowest_asked};

use forwardstep_sim::reference::{Backstepping, Consensus, Desired, PureIntegral, Tracking};
use forwardstep_sim::{Setup, check_shape};

use crate::graphs::{dwell_time, spanning_tree};
use crate::hypothesis::{Hypothesis, Id, ReferenceEvidence};
use crate::kinds::Claim;
use crate::laws;
use crate::links::{bounded_delays, bounded_weights, coupling};
use crate::report::Report;
use crate::surroundings::surroundings;
use crate::theorem::{Extension, Theorem};

/// Which theorem speaks about `setup`, and whether its hypotheses hold.
///
/// Of a setup whose parts do not fit together ([`check_shape`]) it is [`Theorem::Refused`], without hypotheses.
///
/// **Source**: Theorem 1 for (3), Remark 3 for (23), Theorem 2 for (a1), Theorem 3 for (a5) and (24); Section III-A for
/// (aa10), which is (a5) of order one, and for the baseline (aa6), about which the paper promises nothing.
pub fn check(setup: &Setup) -> Report {
    if let Err(error) = check_shape(setup) {
        let theorem = Theorem::Refused(Box::new(error));
        return Report { theorem, promises: "nothing".to_owned(), hypotheses: Vec::new() };
    }
    match desired::recognised(setup) {
        Some((like, design)) => {
            let mut report = checked(&like);
            report.hypotheses.insert(0, design);
            report
        }
        None => checked(setup),
    }
}

/// Of a setup that has a meaning, and whose reference dynamics are what they are written as.
fn checked(setup: &Setup) -> Report {
    let Report { theorem, promises, mut hypotheses } = of_reference(setup);
    hypotheses.extend(own_targets::bounded(setup));
    hypotheses.extend(laws::hypotheses(setup));
    hypotheses.extend(surroundings(setup));
    Report { theorem, promises, hypotheses }
}

/// Which theorem speaks about the reference dynamics, and what it asks of them and of the network.
fn of_reference(setup: &Setup) -> Report {
    let reference = &setup.reference;
    if reference.is::<Consensus>() {
        consensus(setup, theorem_3::hypotheses(setup), theorem_3::claim)
    } else if reference.is::<PureIntegral>() {
        consensus(setup, theorem_1::hypotheses(setup), theorem_1::claim)
    } else if let Some(Backstepping { filter_s, .. }) = reference.downcast() {
        consensus(setup, vec![baseline::derivative(*filter_s)], |_| baseline::claim())
    } else if reference.is::<Tracking>() {
        own_targets::check(setup)
    } else if let Some(following) = setup.following() {
        following::check(setup, following)
    } else if let Some(desired) = reference.downcast::<Desired>() {
        desired::check(setup, desired)
    } else {
        declared::check(setup)
    }
}

/// Agents that agree with each other: `own` is what their reference dynamics add, `claim` what is said of Lagrangian robots.
fn consensus(setup: &Setup, own: Vec<Hypothesis>, claim: fn(&Setup) -> Claim) -> Report {
    let mut hypotheses = vec![spanning_tree(setup), dwell_time(setup), bounded_delays(setup)];
    hypotheses.extend(bounded_weights(setup));
    hypotheses.extend(coupling(setup));
    hypotheses.extend(own);
    hypotheses.extend(manipulability(setup));
    if setup.exchange.has_velocities() {
        hypotheses.push(theorem_3::common_first_root(setup));
    }
    let Claim { theorem, promises } = laws::claim(setup).unwrap_or_else(|| claim(setup));
    Report { theorem: theorem.extended(extensions(setup)), promises, hypotheses }
}

/// What agents that agree do that no theorem of the paper speaks about, though its argument goes through.
fn extensions(setup: &Setup) -> Vec<Extension> {
    let nonlinear = setup.network.coupling.size().is_some();
    let offsets = setup.agents.iter().any(|agent| agent.target.is_some());
    let each = [(nonlinear, Extension::NonlinearCoupling), (offsets, Extension::Offsets)];
    each.into_iter().filter(|(is, _)| *is).map(|(_, extension)| extension).collect()
}

/// Remark 4.
fn manipulability(setup: &Setup) -> Option<Hypothesis> {
    let largest = setup.agents.iter().map(|agent| agent.manipulability).fold(0.0, f64::max);
    (largest > 0.0).then(|| Hypothesis::new(Id::Manipulability, ReferenceEvidence::Manipulability { largest }))
}

/// What Theorems 1 to 3 promise Lagrangian robots under reference dynamics of this order at least.
fn agreement(setup: &Setup, order: usize) -> String {
    let smooth = match order {
        0 | 1 => "the torque jumps at switches and delay jumps but stays bounded".to_owned(),
        2 => "the torque stays continuous through switches and delay jumps".to_owned(),
        3 => "the torque stays once continuously differentiable through switches and delay jumps".to_owned(),
        order => {
            format!("the torque stays {} times continuously differentiable through switches and delay jumps", order - 2)
        }
    };
    let agents = if setup.agents.len() == 1 { "the agent comes to rest" } else { "all agents agree and come to rest" };
    format!("{agents}: qᵢ − qⱼ → 0 and q̇ᵢ → 0; {smooth}")
}

/// The lowest and the highest order of the reference dynamics.
fn orders(setup: &Setup) -> (usize, usize) {
    let orders = || setup.agents.iter().map(|agent| agent.roots_per_s.len());
    (orders().min().unwrap_or(0), orders().max().unwrap_or(0))
}
