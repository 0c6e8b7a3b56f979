//! Reference dynamics.

use crate::hypothesis::ReferenceEvidence;

pub(super) fn words(evidence: &ReferenceEvidence) -> String {
    match evidence {
        ReferenceEvidence::Roots { smallest_per_s } => {
            format!("roots −κ were given; the smallest κ is {smallest_per_s} per second")
        }
        ReferenceEvidence::ComplexRoots { agent, pair } => format!(
            "{} has the complex roots −{} ± {}i per second. What it tells the others is then no average of what it is told, and networks \
             that switch or delay can diverge",
            agent.name, pair.real, pair.imaginary
        ),
        ReferenceEvidence::Hurwitz { slowest_per_s } => {
            format!("the real part of every root is −{slowest_per_s} per second at most")
        }
        ReferenceEvidence::Order(order) => format!("the order is {order}"),
        ReferenceEvidence::Orders([(a, order_a), (b, order_b)]) => {
            format!(
                "{} has order {order_a} and {} has order {order_b}, each in steps of its own, as in (30)",
                a.name, b.name
            )
        }
        ReferenceEvidence::FirstRootCommon => "κ₀ is common wherever agents hear each other in a cycle".into(),
        ReferenceEvidence::FirstRootsOverConstants => "κ₀ differs, but the graph and the delays are constant".into(),
        ReferenceEvidence::FirstRoots([(a, kappa_a), (b, kappa_b)]) => format!(
            "{} has κ₀ = {kappa_a} and {} has κ₀ = {kappa_b} per second, and each reaches the other; such networks can \
             diverge. Give them one κ₀, or exchange positions only: (24) has no such condition",
            a.name, b.name
        ),
        ReferenceEvidence::FilteredDerivative { filter_s } => {
            format!("it is estimated by a filter with the time constant {filter_s} s")
        }
        ReferenceEvidence::Manipulability { largest } => {
            format!("the largest λ is {largest}; tracking errors move the value agreed upon")
        }
    }
}
