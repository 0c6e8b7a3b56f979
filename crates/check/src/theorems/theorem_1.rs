//! Theorem 1 for (3), and Remark 3 for (23): reference dynamics that contain accelerations.

use forwardstep_sim::Setup;

use super::theorem_3::real_roots;
use super::{agreement, orders};
use crate::graphs::fixed_graph;
use crate::hypothesis::Hypothesis;
use crate::kinds::Claim;
use crate::theorem::Theorem;

pub(super) fn claim(setup: &Setup) -> Claim {
    let theorem = if setup.exchange.has_velocities() { Theorem::Theorem1 } else { Theorem::Remark3 };
    Claim { theorem, promises: agreement(setup, orders(setup).0) }
}

pub(super) fn hypotheses(setup: &Setup) -> Vec<Hypothesis> {
    vec![fixed_graph(setup), real_roots(setup)]
}
