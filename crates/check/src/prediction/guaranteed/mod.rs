//! A guaranteed rate of agreement: how much of the spread is left when, for certain.
//!
//! With s ≡ 0 the cascaded variables ψ are a network of first-order lags (see [`CascadeSpread`](super::CascadeSpread)): with non-negative
//! weights that sum to one, now and earlier values make later ones. If two later values have the parts aₘ and bₘ of ψₘ(0) for certain, they
//! differ by no more than 1 − Σₘ min(aₘ, bₘ) of the spread of what there was. The least Σₘ min(aₘ, bₘ) of all pairs of values, now and on
//! their way, is what the spread shrinks by at least: the coefficient of ergodicity of the operator, from lower bounds, which is no less
//! than Doeblin's Σₘ minₐ aₘ.
//!
//! - `network`: the components, what each moves towards, and how fast.
//! - `heard`: where what is heard over a cell of time was sent.
//! - `cells`: lower bounds of the operator, cell by cell, rounded downwards.
//! - `blocks`: how much is left when, over blocks of time.
//! - `class`: what is left under any delays up to the longest one, in closed form.

mod blocks;
mod cells;
mod class;
mod heard;
mod network;

use forwardstep_sim::Setup;
use forwardstep_sim::network::NetworkError;
use forwardstep_sim::schedule::Window;
use thiserror::Error;

use self::blocks::{Blocks, is_drawn, listed};
pub use self::class::ClassBound;
use self::network::{MOST_COMPONENTS, Network};
use super::cascade::NoCascade;
use super::ideal::NoIdeal;
use super::repeats::Repeats;
use super::settled::SHARE;

/// How much of the spread is left when, for certain, for s ≡ 0: of the interval of all cascaded variables and of all messages on their
/// way, on every axis.
#[derive(Clone, Debug, PartialEq)]
pub struct GuaranteedRate {
    /// What is left at most, later and later.
    pub falls: Vec<Fall>,
    /// From when on no more than 1 % is left, s; `None` where that is not shown.
    pub settled_s: Option<f64>,
    /// What is left after so long again and again, where the network repeats itself exactly.
    pub repeat: Option<Repeat>,
    /// The window of the graphs, s; `None` where windows may be as short as one likes.
    pub window_s: Option<f64>,
    /// What any delays up to the longest one leave; `None` where no closed form is known.
    pub class: Option<ClassBound>,
    /// Whether it is about the one course of graphs and delays that was drawn, logged or declared for this run.
    pub drawn: bool,
}

/// No more than a part is left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fall {
    /// From this time on, s.
    pub t_s: f64,
    /// As a part of what there was at the start.
    pub left: f64,
}

/// No more than a part is left, again and again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repeat {
    /// After so long, s.
    pub over_s: f64,
    /// As a part of what there was so long ago.
    pub left: f64,
}

/// Why no rate is guaranteed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoGuaranteedRate {
    /// The references depend on more than the network.
    #[error(transparent)]
    Ideal(#[from] NoIdeal),
    /// The cascaded variables bound nothing.
    #[error(transparent)]
    Cascade(#[from] NoCascade),
    /// The network has no meaning.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// There is nothing to compare.
    #[error("there are no two agents to compare")]
    Agents,
    /// The horizon is no time.
    #[error("the horizon must be positive and finite, but is {end_s} s")]
    Horizon {
        /// It, s.
        end_s: f64,
    },
    /// Roots that are none.
    #[error("the roots of agent number {} are not all positive", agent + 1)]
    Roots {
        /// Index of the agent.
        agent: usize,
    },
    /// There are more than the operator is followed for.
    #[error("there are {components} cascaded variables on an axis, more than {MOST_COMPONENTS}")]
    TooLarge {
        /// How many.
        components: usize,
    },
    /// Nothing makes all agree.
    #[error("no agent reaches all others again and again")]
    NoSpanningTree,
    /// Lower bounds show nothing on the horizon.
    #[error("lower bounds up to {until_s} s show no fall")]
    Nothing {
        /// How far was looked, s.
        until_s: f64,
    },
}

/// Work for a rate, in multiplications, roughly: about a tenth of a second.
pub const WORK: f64 = 5e7;

/// Guarantees a rate of agreement of `setup` for s ≡ 0, from outward-rounded lower bounds with so much `work`, such as [`WORK`].
///
/// **Guarantees**: for every solution of the reference dynamics with s ≡ 0, whatever its start, over the graphs, weights and delays as
/// the run has them.
///
/// # Errors
/// [`NoGuaranteedRate`] when there is none.
pub fn guaranteed_rate(setup: &Setup, work: f64) -> Result<GuaranteedRate, NoGuaranteedRate> {
    let network = Network::of(setup)?;
    let window = setup.network.schedule.window(setup.network.agents, setup.time.end_s);
    let window_s = match window {
        Window::Missing { .. } => return Err(NoGuaranteedRate::NoSpanningTree),
        Window::EveryGraph | Window::Once { .. } => None,
        Window::Uniform { length_s, .. } => Some(length_s).filter(|length_s| *length_s > 0.0),
    };
    let repeats = Repeats::of(&network.ideal).ok();
    let [short, long] = Blocks::of(&network, repeats, work);
    let is_settled = |falls: &[Fall]| falls.last().is_some_and(|last| last.left <= SHARE);
    let mut falls = listed(short.falls());
    if !is_settled(&falls) {
        falls.extend(long.falls());
        falls = listed(falls);
    }
    let Some(last) = falls.last().copied() else {
        return Err(NoGuaranteedRate::Nothing { until_s: setup.time.end_s });
    };
    let repeat = short.repeat().or_else(|| long.repeat());
    let later = |repeat: Repeat| repeat.settled_s(last, repeats);
    let settled_s = if is_settled(&falls) { Some(last.t_s) } else { repeat.and_then(later) };
    let class = ClassBound::of(&network, &window);
    Ok(GuaranteedRate { settled_s, falls, repeat, window_s, class, drawn: is_drawn(&network) })
}

impl Repeat {
    /// When no more than 1 % is left where so much is left at some time.
    fn settled_s(&self, from: Fall, repeats: Option<Repeats>) -> Option<f64> {
        let from_s = match repeats? {
            Repeats::Always => from.t_s,
            Repeats::Every(period_s) => period_s * (from.t_s / period_s).ceil(),
        };
        let times = (libm::log(SHARE / from.left) / libm::log(self.left)).ceil();
        Some(from_s + times * self.over_s).filter(|t_s| t_s.is_finite())
    }
}
