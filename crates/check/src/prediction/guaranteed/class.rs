//! The same for the whole class: whatever the delays up to the longest one do, in closed form.
//!
//! Let D be no less than the fastest rate of a component, and let all but one component be zero at t₀, and all that was sent before as well. That one
//! component, the last of an agent, is one. Say that a component has γ from a time on if it is no less than γ e^(−D (t − t₀)) from then on. The one
//! has γ = 1 from t₀ on.
//!
//! *A step.* If something has γ from a time on, and moves a component at the rate c or more for the time η, then y = e^(D (t − t₀)) x has
//! ẏ ≥ c γ, so that the component has c η γ from then on. A delay does no harm: what was sent at t − T is no less than
//! γ e^(−D (t − T − t₀)) ≥ γ e^(−D (t − t₀)), once a time T has passed.
//!
//! *An agent.* When its last component has γ, its first one has g γ after ℓ steps of 1/D each, g = Πᵣ min(1, κᵣ/D), and so has all that it
//! sends.
//!
//! *A hop.* Let a set of agents that hold a root have γ. Within a time V some graph is in force for η or longer that has an edge out of the set. So one more
//! agent has min(1, w̲ η) g γ after T + V + ℓ/D.
//!
//! *All.* After n − 1 hops if one agent is the root every time; after n (n − 2) + 1 if it may be another one each time, since one of n is the root in n − 1 of
//! them. Then, and a window T later, all components and all that is on its way have at least α = e^(−D H) g (min(1, w̲ η) g)^hops of the one, and
//! the spread is no more than 1 − α of what it was.

use forwardstep_core::expression::Interval;
use forwardstep_sim::schedule::{Dwell, Extent, Window};

use super::network::Network;
use crate::prediction::SHARE;

/// What is left of a spread for certain under any delays up to the longest one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClassBound {
    /// The delays do not exceed this, s.
    pub delay_s: f64,
    /// After so long, s, again and again,
    pub over_s: f64,
    /// log₁₀ of the part α by which the spread falls at least.
    pub log10_part: f64,
    /// log₁₀ of the time, s, after which no more than 1 % is left for certain.
    pub log10_settled_s: f64,
}

/// What is left is said of times that may be after the run.
const EVER: Interval = Interval { low: 0.0, high: f64::INFINITY };
/// Times the horizon beyond which a time is of no practical use.
const PRACTICAL: f64 = 100.0;
/// What rounding does to a logarithm, generously, as a part of what it is made of.
const ROUNDING: f64 = 1e-12;

impl ClassBound {
    /// Whether the time is one that somebody may wait for, beside a horizon, s.
    pub fn is_practical(&self, end_s: f64) -> bool {
        self.log10_settled_s <= libm::log10(PRACTICAL * end_s)
    }

    /// None where an edge, or a graph, may be in force for no time at all.
    pub(super) fn of(network: &Network, window: &Window) -> Option<ClassBound> {
        let (agents, fastest_per_s) = (network.first.len() as f64, network.fastest_per_s(EVER));
        let schedule = &network.ideal.network.schedule;
        let step_s = 1.0 / fastest_per_s;
        let dwell_s = match schedule.known().dwell {
            Dwell::NeverSwitches => f64::INFINITY,
            Dwell::Shortest(dwell_s) | Dwell::Drawn(dwell_s) | Dwell::Declared(dwell_s) => dwell_s,
        };
        // How long a hop may wait for its edge, how long that is there, and whether the root is always the same.
        let (waits_s, lasts_s, same_root) = match window {
            Window::Missing { .. } | Window::Once { .. } => return None,
            // Of a time as long as a graph is in force at least, one is in force for half.
            Window::EveryGraph => (dwell_s.min(2.0 * step_s), 0.5 * dwell_s.min(2.0 * step_s), false),
            // It stays for ever.
            Window::Uniform { .. } if schedule.known().extent == Extent::Whole || dwell_s.is_infinite() => {
                (step_s, step_s, true)
            }
            Window::Uniform { length_s, .. } => {
                let round_s = match schedule.known().extent {
                    Extent::Whole | Extent::Drawn | Extent::Horizon => None,
                    Extent::Period(count) => schedule.segments().nth(count.checked_sub(1)?).map(|last| last.end_s),
                };
                // Twice as long as what holds a tree from one switch to another, so that it holds one from any time on.
                let whole_s = round_s.unwrap_or(*length_s);
                if whole_s > 0.0 { (2.0 * whole_s, dwell_s, round_s.is_some()) } else { (step_s, step_s, true) }
            }
        };
        let hops = if same_root { agents - 1.0 } else { agents * (agents - 2.0) + 1.0 };
        let order = network.ideal.agents.iter().map(|agent| agent.roots_per_s.len()).max()? as f64;
        let chain = |roots: &[f64]| roots.iter().map(|root| libm::log((root * step_s).min(1.0))).sum::<f64>();
        let chain = network.ideal.agents.iter().map(|agent| chain(&agent.roots_per_s.real)).fold(0.0, f64::min);
        let hop = libm::log((network.least_weight() * lasts_s).min(1.0)) + chain;
        let delay_s = network.window_s;
        let over_s = (hops * (delay_s + waits_s + order * step_s) + order * step_s + delay_s).next_up();
        let sizes = fastest_per_s * over_s + chain.abs() + hops * hop.abs();
        let log_part = -fastest_per_s * over_s + chain + hops * hop - ROUNDING * sizes;
        let log10 = |log: f64| log / std::f64::consts::LN_10;
        // −ln(1 − α) ≥ α, and a part of the last time may be left.
        let settled = libm::log(over_s) + libm::log(-libm::log(SHARE)) - log_part + libm::log1p(libm::exp(log_part));
        let bound = ClassBound {
            delay_s,
            over_s,
            log10_part: log10(log_part),
            log10_settled_s: log10(settled) + ROUNDING * sizes,
        };
        (bound.log10_part.is_finite() && bound.log10_settled_s.is_finite()).then_some(bound)
    }
}

impl Network {
    /// The least weight of any edge of any graph, at any time, 1/s.
    fn least_weight(&self) -> f64 {
        let edges = self.ideal.network.schedule.recurring_graphs().iter().flatten();
        edges.map(|edge| self.weight(edge.weight, EVER).low).fold(f64::INFINITY, f64::min)
    }
}
