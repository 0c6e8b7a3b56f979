//! Desired dynamics that are a design of the paper.
//!
//! What a user writes down is A(p) x = what is heard, with the polynomials of (43) as it is meant there. By comparison with (24), (a5),
//! (3), (23) and (43) for tracking, all with exact numbers, it is one of these where
//!
//! ```text
//! consensus       A(p) = p K(p), B = K, c₀ = K(0), and c₁ = 0 or K(0)/κ₀       (24) or (a5) in what is measured; of order three, and
//!                                                                              in x, on Lagrangian robots, (23) or (3)
//! tracking        A = K, and a target                                          (43)
//! ```
//!
//! with a K that is given by its roots. Tracking is the same in whatever variables it is written: what differs is a sum of derivatives
//! of s, which drives a linear system that is exponentially stable. Consensus is not: written in z it holds s itself beside p K(p), whose
//! integral need not be bounded.

use std::sync::Arc;

use forwardstep_core::expression::Number;
use forwardstep_core::reference::{RootSet, WrittenIn};
use forwardstep_sim::reference::{Consensus, Desired, DesiredPolynomial, PureIntegral, Tracking};
use forwardstep_sim::{Exchange, ReferenceDynamics, Setup};

use crate::derivation::Factors;

/// Which design desired dynamics are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Design {
    /// (a5) or (24).
    Consensus,
    /// (3) or (23).
    PureIntegral,
    /// (43) for a target.
    Tracking,
}

/// The design that the desired dynamics of `setup` are, with its roots; `None` for other reference dynamics, and for none of the paper.
pub(crate) fn design(setup: &Setup) -> Option<(Design, RootSet)> {
    let desired: &Desired = setup.reference.downcast()?;
    if desired.protocol.is_some() {
        return None;
    }
    let DesiredPolynomial::Roots { integrators, roots } = &desired.polynomial else { return None };
    if roots.is_empty() {
        return None;
    }
    if desired.follows_target {
        let alone = *integrators == 0 && desired.coupling.is_none() && desired.heard.is_empty();
        return alone.then(|| (Design::Tracking, roots.clone()));
    }
    if *integrators != 1 || !couples_by(desired, roots) {
        return None;
    }
    let roots = hears(desired, roots)?;
    let design = match desired.written {
        WrittenIn::Measured => Design::Consensus,
        WrittenIn::X if roots.len() == 2 && lagrangian(setup) => Design::PureIntegral,
        WrittenIn::X | WrittenIn::Z => return None,
    };
    Some((design, roots))
}

fn lagrangian(setup: &Setup) -> bool {
    setup.agents.iter().all(|agent| agent.robot.kind.lagrangian().is_some())
}

/// Whether B has these roots, in whatever order.
fn couples_by(desired: &Desired, roots: &RootSet) -> bool {
    let Some(DesiredPolynomial::Roots { integrators: 0, roots: own }) = &desired.coupling else { return false };
    let product = |roots: &RootSet| Factors::written(roots).product();
    own.len() == roots.len() && product(own) == product(roots)
}

/// The roots where what is heard is α₀ x_j, or (α₀/κ₀)(p + κ₀) x_j with κ₀ for one of them, which then stands first.
fn hears(desired: &Desired, roots: &RootSet) -> Option<RootSet> {
    let alpha_0 = Factors::written(roots).product().coefficient(0);
    let heard: Vec<_> = desired.heard.iter().map(|number| Number::written(*number)).collect();
    match &heard[..] {
        [] => Some(roots.clone()),
        [position] => (*position == alpha_0).then(|| roots.clone()),
        [position, velocity] if *position == alpha_0 => {
            let first = roots.real.iter().position(|kappa| velocity * Number::written(*kappa) == alpha_0)?;
            let mut roots = roots.clone();
            roots.real[..=first].rotate_right(1);
            Some(roots)
        }
        _ => None,
    }
}

/// Whether what leads is (24) or (a5), of which (aa10) and (a1) are the first orders, or (3) or (23).
pub(crate) fn is_consensus(setup: &Setup) -> bool {
    setup.reference.is::<Consensus>() || setup.reference.is::<PureIntegral>()
}

/// `setup` with the design in the place of desired dynamics that are one; `None` where they are none.
pub(crate) fn designed(setup: &Setup) -> Option<Setup> {
    let (design, roots) = design(setup)?;
    let reference: Arc<dyn ReferenceDynamics> = match design {
        Design::Consensus => Arc::new(Consensus),
        Design::PureIntegral => Arc::new(PureIntegral),
        Design::Tracking => Arc::new(Tracking),
    };
    let mut setup = Setup { reference, ..setup.clone() };
    setup.agents.iter_mut().for_each(|agent| agent.roots_per_s = roots.clone());
    Some(setup)
}

/// What the design is called, with its equation.
pub(crate) fn name(design: Design, exchange: Exchange) -> &'static str {
    match (design, exchange.has_velocities()) {
        (Design::Consensus, false) => "(24)",
        (Design::Consensus, true) => "(a5)",
        (Design::PureIntegral, false) => "(23)",
        (Design::PureIntegral, true) => "(3)",
        (Design::Tracking, _) => "(43) for a target",
    }
}
