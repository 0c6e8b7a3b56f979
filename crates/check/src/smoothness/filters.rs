//! The same network under the backstepping baseline: what it differentiates jumps, and the torque by the more the narrower the filter is.
//!
//! z is what is heard, so it jumps by some Δz, and ż = (z − f)/ε by Δz/ε. The torque of (6) jumps by
//! M(q, ϑ̂) Δz/ε + C(q, q̇, ϑ̂) Δz + K Δz: over ε the first is a line of slope −1 in a log-log plot, and for small ε the others are small beside it.

use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_sim::reference::Backstepping;
use forwardstep_sim::{Exchange, Progress, Setup};
use thiserror::Error;

use super::orders::uncovered;
use super::{LargestJump, NoSmoothness, NotCovered, smoothness};

/// The largest jump of the torque with one filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilteredJump {
    /// ε, s.
    pub filter_s: f64,
    /// The jump of the torque, N m or N.
    pub jump: LargestJump,
}

/// Those of several filters.
#[derive(Clone, Debug, PartialEq)]
pub struct Filters {
    /// In the order asked for.
    pub jumps: Vec<FilteredJump>,
    /// The slope of ln |jump| over ln ε: that of the straight line with the least squares.
    pub slope: f64,
}

/// Why there is no slope.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoFilters {
    /// A straight line needs two points.
    #[error("a slope needs at least two different filters")]
    TooFew,
    /// Nothing jumps.
    #[error("nothing that is heard jumps: neither does the graph switch nor a delay jump while agents disagree")]
    NoJump,
    /// An agent whose torque is not looked at.
    #[error("all agents must be under (6)–(7), but not {name}: {reason}")]
    Agent {
        /// The agent.
        name: String,
        /// Why.
        reason: NotCovered,
    },
    /// There are no jumps to report.
    #[error(transparent)]
    Smoothness(#[from] NoSmoothness),
}

/// Simulates the agents of `setup` under the baseline with each of the time constants `filters_s` of its filter, without a limit of ż. They exchange
/// positions and keep their tracking laws.
///
/// # Errors
/// [`NoFilters`].
pub fn filters(
    setup: &Setup,
    filters_s: &[f64],
    observer: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Filters, NoFilters> {
    let setups: Vec<(f64, Setup)> = filters_s.iter().map(|filter_s| (*filter_s, filtered(setup, *filter_s))).collect();
    if let Some((name, reason)) = uncovered(setups.iter().map(|(_, setup)| setup))? {
        return Err(NoFilters::Agent { name, reason });
    }
    if filters_s.iter().all(|filter_s| Some(filter_s) == filters_s.first()) {
        return Err(NoFilters::TooFew);
    }
    let jump = |(filter_s, setup): &(f64, Setup)| {
        let found = smoothness(setup, observer)?;
        let jumps = found.kinds().into_iter().filter_map(|kind| found.largest(kind, 0));
        let jump = jumps.filter(|jump| jump.size > 0.0).reduce(|a, b| if b.size > a.size { b } else { a });
        let jump = jump.ok_or(NoFilters::NoJump)?;
        Ok(FilteredJump { filter_s: *filter_s, jump })
    };
    let jumps: Vec<FilteredJump> = setups.iter().map(jump).collect::<Result<_, NoFilters>>()?;
    Ok(Filters { slope: slope(&jumps), jumps })
}

fn filtered(setup: &Setup, filter_s: f64) -> Setup {
    let mut setup = setup.clone();
    setup.reference = Arc::new(Backstepping { filter_s, acceleration_limit: None });
    setup.exchange = Exchange::Position;
    for agent in &mut setup.agents {
        agent.roots_per_s.clear();
        agent.start.reference.clear();
        agent.manipulability = 0.0;
    }
    setup
}

fn slope(jumps: &[FilteredJump]) -> f64 {
    let points = || jumps.iter().map(|found| (libm::log(found.filter_s), libm::log(found.jump.size)));
    let n = jumps.len() as f64;
    let (x, y) = points().fold((0.0, 0.0), |(x, y), (a, b)| (x + a / n, y + b / n));
    let (xx, xy) = points().fold((0.0, 0.0), |(xx, xy), (a, b)| (xx + (a - x) * (a - x), xy + (a - x) * (b - y)));
    xy / xx
}
