//! Reference dynamics.

use super::numbers::as_it_is;
use crate::hypothesis::{ReferenceEvidence, TriedRun};

/// The first of these numbers.
fn list(numbers: &[f64]) -> String {
    let shown: Vec<String> = numbers.iter().take(6).map(|number| format!("{number:.4}")).collect();
    let more = if numbers.len() > shown.len() { ", …" } else { "" };
    format!("({}{more})", shown.join(", "))
}

pub(super) fn words(evidence: &ReferenceEvidence) -> String {
    match evidence {
        ReferenceEvidence::Roots { smallest_per_s } => {
            format!("roots −κ were given; the smallest κ is {} per second", as_it_is(*smallest_per_s))
        }
        ReferenceEvidence::ComplexRoots { agent, pair } => format!(
            "{} has the complex roots −{} ± {}i per second. What it tells the others is then no average of what it is told, and networks \
             that switch or delay can diverge",
            agent.name, pair.real, pair.imaginary
        ),
        ReferenceEvidence::Hurwitz { slowest_per_s } => {
            format!("the real part of every root is −{} per second at most", as_it_is(*slowest_per_s))
        }
        ReferenceEvidence::Order(order) => {
            format!("each has {order} {}", if *order == 1 { "root" } else { "roots" })
        }
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
        ReferenceEvidence::Design { design, order } => {
            let roots = if *order == 1 { "one root".to_owned() } else { format!("{order} roots") };
            format!("they are {design} with {roots}, by comparison of their polynomials with exact numbers")
        }
        ReferenceEvidence::Stable { order } => format!(
            "by the criterion of Routh and Hurwitz, with exact numbers, all {order} roots of their polynomial have negative real \
             parts"
        ),
        ReferenceEvidence::Unstable { row, order } => format!(
            "their polynomial is of degree {order}, and not Hurwitz: in the array of Routh the first entry of row {row}, counted from 0, is not \
             positive"
        ),
        ReferenceEvidence::NoDesign { steady, by_roots } => {
            let compared = match by_roots {
                true => "by comparison of polynomials the way in which agents hear each other is neither (24) nor (a5)",
                false => {
                    "the polynomial is given by coefficients, of which no roots are computed: whether the way in which agents hear each other is \
                     (24) or (a5) is seen where it is given by `roots_per_s`"
                }
            };
            let beside = match steady {
                true => {
                    "graph, weights and delays are constant, and roots of the loop would tell, which this program does not compute for desired dynamics"
                }
                false => "of other ways nothing is known of where they lead over graphs that switch and links that are late",
            };
            format!("{compared}; {beside}")
        }
        ReferenceEvidence::Tried { runs, found: None } => format!(
            "{runs} runs of these dynamics alone, from states that were drawn, half of them with an s that vanishes, came closer to what they are for; \
             that shows nothing of others"
        ),
        ReferenceEvidence::Tried { found: Some(run), .. } => {
            let TriedRun { start, disturbed, from, to, until_s } = run;
            let so = if run.diverges() {
                "as far as a computed run tells, they do not converge from there"
            } else {
                "that shows neither"
            };
            let with = if *disturbed { "with an s that vanishes" } else { "without s" };
            let end = if to.is_finite() {
                format!("is at {to:.3e} from it at {until_s} s")
            } else {
                "breaks down".into()
            };
            format!(
                "a run of these dynamics alone, {with}, from x = {}, is at most {from:.3e} from what they are for while it begins, and {end}; {so}",
                list(start)
            )
        }
        ReferenceEvidence::NoDesignInThese => {
            "in these variables s itself may stand beside what agents hear, or weights have to be constant; a proof is known of dynamics \
             in what is measured alone, and of those of order three in x, on robots"
                .into()
        }
    }
}
