//! What the author of an accepted scenario should know.

use std::fmt;

use forwardstep_check::{
    FastestDamping, MarginAt, PracticalAnswer, RECOMMENDED_MARGIN, SamplingMargin, WholeLoop, fastest_damping,
};
use forwardstep_sim::quantity::MOST_EVENTS;
use forwardstep_sim::{AgentSetup, Axis, AxisUnit, Method, PositionKind, Setup};

use super::attitude::turn_rad;
use crate::urdf;
use crate::wording::{about, beginning, enumerate, number};

/// Something in an accepted scenario that the user should know about.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Notice {
    /// A remark of the reader of a robot file.
    Robot {
        /// The agent that has this robot, or the first and last of a population.
        agents: String,
        /// The remark.
        notice: Box<urdf::Notice>,
    },
    /// A `dwell_s` that has no effect: of the last phase of a network that switches once, or under random switching.
    UnusedDwell {
        /// Its line in the scenario.
        line: usize,
    },
    /// A sampling margin beyond what is recommended.
    CoarseSampling {
        /// The agent for which it is worst.
        agent: String,
        /// σ at its start, or at a posture between the starts.
        sigma: f64,
        /// A sample rate that would be enough, Hz; `None` where the torque comes too late for any.
        enough_hz: Option<f64>,
        /// Whether a run of this length may have so many samples.
        is_allowed: bool,
        /// The gain that is to be smaller.
        too_large: &'static str,
    },
    /// A log has packets of edges that the network does not have.
    UnusedInLog {
        /// The log.
        file: String,
        /// Names of sender and receiver.
        links: Vec<(String, String)>,
    },
    /// Links whose delay is stated for all graphs, and which no graph has.
    UnusedLinkDelay {
        /// Names of sender and receiver.
        links: Vec<(String, String)>,
    },
    /// Links on which no packet arrives before the end of the run.
    NothingArrives {
        /// Names of sender and receiver.
        links: Vec<(String, String)>,
    },
    /// A target that leads an axis beyond its position limits.
    TargetBeyondLimits {
        /// The agent.
        agent: String,
        /// The axis.
        axis: String,
        /// When it does so first among the times looked at, s.
        at_s: f64,
        /// Where it is then, in the unit of the axis.
        value: f64,
        /// What the axis keeps within.
        limits: [f64; 2],
    },
    /// Which way round spacecraft turn to their targets.
    Rotation {
        /// The one that turns by the largest angle.
        agent: String,
        /// That angle at the start, degrees: up to 180 the short way, beyond the long way.
        degrees: f64,
        /// How many others there are.
        more: usize,
    },
    /// Agents that start beyond position limits.
    StartBeyondLimits {
        /// The first of them.
        agent: String,
        /// Its axis.
        axis: String,
        /// Where it starts, with its unit.
        value: String,
        /// What the axis keeps within, in that unit.
        limits: [f64; 2],
        /// How many other axes of agents do so.
        more: usize,
        /// Whether the run ends there.
        enforced: bool,
    },
    /// Steps that are too long for the damping, so that the integration is unstable.
    LongSteps {
        /// The agent whose damping is fastest.
        agent: String,
        /// λ_max(M⁻¹K) at its start, 1/s.
        per_s: f64,
        /// The fixed step, s.
        step_s: f64,
        /// A little less than the longest that would do at the start, s.
        enough_s: f64,
    },
    /// Damping that is so fast that a run takes very many steps.
    StiffDamping {
        /// The agent whose damping is fastest.
        agent: String,
        /// λ_max(M⁻¹K) at its start, 1/s.
        per_s: f64,
        /// About as many steps does a run take.
        steps: f64,
    },
    /// A push that has no effect on the run.
    IdlePush {
        /// Its line in the scenario.
        line: usize,
    },
}

/// Times of a run at which a target is held against position limits.
const LOOKS: u32 = 1000;

/// h λ up to which the classical Runge–Kutta method is stable along the negative real axis.
const STABLE_FIXED: f64 = 2.785;
/// The same of the Dormand–Prince pair.
const STABLE_ADAPTIVE: f64 = 3.3;
/// Steps of a run that its author should know of.
const MANY_STEPS: f64 = 1e6;

impl Notice {
    /// Agents that start where their joints cannot be.
    pub(super) fn starts_beyond_limits(setup: &Setup) -> Option<Notice> {
        let outside = |agent: &AgentSetup, axis: usize| {
            let limits = agent.robot.axes.get(axis)?.position_limits?;
            let value = *agent.start.q.get(axis)?;
            (value < limits[0] || value > limits[1]).then_some((value, limits))
        };
        let all = || {
            let agents = setup.agents.iter();
            let each = agents.flat_map(|agent| (0..agent.robot.axes.len()).map(move |axis| (agent, axis)));
            each.filter_map(|(agent, axis)| outside(agent, axis).map(|(value, limits)| (agent, axis, value, limits)))
        };
        // One that ends the run comes first.
        let (agent, axis, value, limits) = all().find(|(agent, ..)| agent.enforce_limits).or_else(|| all().next())?;
        let unit = match agent.robot.axes[axis].unit {
            AxisUnit::Radian => " rad",
            AxisUnit::Metre => " m",
            AxisUnit::One | AxisUnit::Own => "",
        };
        Some(Notice::StartBeyondLimits {
            agent: agent.name.clone(),
            axis: agent.robot.axes[axis].name.clone(),
            value: format!("{}{unit}", number(value)),
            limits,
            more: all().count() - 1,
            enforced: agent.enforce_limits,
        })
    }

    /// Which of q and −q spacecraft with a target start with, in angles.
    pub(super) fn rotation(setup: &Setup) -> Option<Notice> {
        let turn = |agent: &AgentSetup| {
            let turns = agent.robot.interface().position == PositionKind::UnitQuaternion;
            let target = agent.target.as_ref().filter(|_| turns)?;
            Some((agent.name.clone(), turn_rad(&agent.start, target)?.to_degrees()))
        };
        let turns = || setup.agents.iter().filter_map(turn);
        let (agent, degrees) = turns().max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(Notice::Rotation { agent, degrees, more: turns().count() - 1 })
    }

    /// Damping that is fast beside the steps, or beside the length, of a run in continuous time.
    pub(super) fn stiff(setup: &Setup) -> Option<Notice> {
        if setup.control.is_some() {
            return None;
        }
        let FastestDamping { agent, at_start_per_s: per_s, .. } = fastest_damping(setup)?;
        let agent = setup.agents[agent].name.clone();
        match setup.solver.method {
            Method::Fixed { step_s } => (step_s * per_s > STABLE_FIXED).then(|| Notice::LongSteps {
                agent,
                per_s,
                step_s,
                // A little less, since it is shown rounded.
                enough_s: 0.95 * STABLE_FIXED / per_s,
            }),
            Method::Adaptive { .. } => {
                let steps = setup.time.end_s * per_s / STABLE_ADAPTIVE;
                (steps > MANY_STEPS).then_some(Notice::StiffDamping { agent, per_s, steps })
            }
        }
    }

    /// Targets that lead axes beyond their position limits, one notice per axis.
    pub(super) fn targets_beyond_limits(setup: &Setup) -> Vec<Notice> {
        let end_s = setup.time.end_s;
        let beyond = |(index, agent): (usize, &AgentSetup)| -> Vec<Notice> {
            let follows = setup.tracks(index) && agent.interface().is_some_and(|law| law.coordinates.is_none());
            let Some(target) = agent.target.as_ref().filter(|_| follows) else { return Vec::new() };
            let mut jets = vec![[0.0; 5]; target.axes()];
            let mut first = vec![None; target.axes()];
            for look in 0..=LOOKS {
                let at_s = end_s * f64::from(look) / f64::from(LOOKS);
                target.jets(at_s, &mut jets);
                for ((first, jet), axis) in first.iter_mut().zip(&jets).zip(&agent.robot.axes) {
                    let outside = axis.position_limits.is_some_and(|[low, high]| jet[0] < low || jet[0] > high);
                    *first = first.or(outside.then_some([at_s, jet[0]]));
                }
            }
            let notice = |(axis, first): (&Axis, Option<[f64; 2]>)| {
                let ([at_s, value], limits) = (first?, axis.position_limits?);
                Some(Notice::TargetBeyondLimits {
                    agent: agent.name.clone(),
                    axis: axis.name.clone(),
                    at_s,
                    value,
                    limits,
                })
            };
            agent.robot.axes.iter().zip(first).filter_map(notice).collect()
        };
        setup.agents.iter().enumerate().flat_map(beyond).collect()
    }

    /// Digital control whose period is too long for its gains.
    pub(super) fn coarse_sampling(setup: &Setup) -> Option<Notice> {
        let margin = SamplingMargin::of(setup)?;
        let SamplingMargin { worst: MarginAt { agent, sigma, .. }, recommended_s, .. } = &margin;
        // Beside references that are not slow, the loop as a whole may bear less, of which again half is recommended.
        let whole_s = || {
            let sampled = |period_s: f64| {
                let mut sampled = setup.clone();
                sampled.control.iter_mut().for_each(|control| control.sample_hz = 1.0 / period_s);
                sampled
            };
            margin.rival_per_s.and_then(|_| WholeLoop::longest_period_s(margin.period_s, sampled))
        };
        (margin.answer() > PracticalAnswer::Adequate).then(|| {
            // A little more, since it is shown rounded.
            let enough_hz = recommended_s.map(|period_s| {
                let whole_s = whole_s().map_or(f64::INFINITY, |whole_s| RECOMMENDED_MARGIN * whole_s);
                1.05 / period_s.min(whole_s)
            });
            Notice::CoarseSampling {
                agent: agent.name.clone(),
                sigma: *sigma,
                enough_hz,
                is_allowed: enough_hz.is_none_or(|enough_hz| enough_hz * setup.time.end_s <= MOST_EVENTS),
                too_large: margin.too_large(),
            }
        })
    }
}

/// An angle in whole degrees, or with the digits of a small one.
fn of_degrees(degrees: f64) -> String {
    if degrees < 10.0 { about(degrees).to_string() } else { format!("{degrees:.0}") }
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Notice::Robot { agents, notice } => write!(f, "{agents}: {notice}"),
            Notice::CoarseSampling { agent, sigma, enough_hz, is_allowed, too_large } => {
                write!(
                    f,
                    "`sample_hz` is low for the gains: the sampling margin σ is {sigma:.3} for {agent}; at most \
                     {RECOMMENDED_MARGIN} is recommended, and from 1 on it is not shown to be stable; "
                )?;
                match enough_hz {
                    Some(_) if !is_allowed => {
                        write!(f, "no rate that a run may have is enough; let {too_large} be smaller")
                    }
                    Some(enough_hz) => {
                        write!(f, "sample at {} Hz, or let {too_large} be smaller", about(*enough_hz).typed())
                    }
                    None => {
                        write!(f, "with these gains the torque comes too late for any rate; let {too_large} be smaller")
                    }
                }
            }
            Notice::UnusedDwell { line } => write!(f, "`dwell_s` on line {line} is not used"),
            Notice::UnusedInLog { file, links } => {
                write!(f, "the packets of {} in `{file}` are not used: the network has no such edge", named(links))
            }
            Notice::UnusedLinkDelay { links } => {
                write!(f, "`link_delays` states a delay for {}, but the network has no such edge", named(links))
            }
            Notice::NothingArrives { links } => {
                write!(
                    f,
                    "no packet of {} arrives before the end of the run: the initial message is heard",
                    named(links)
                )
            }
            Notice::TargetBeyondLimits { agent, axis, at_s, value, limits: [low, high] } => write!(
                f,
                "the target of `{agent}` leads `{axis}` beyond its position limits: it is at {} at t = {} s, but {} to {} are allowed",
                number(*value),
                number(*at_s),
                number(*low),
                number(*high)
            ),
            Notice::StartBeyondLimits { agent, axis, value, limits: [low, high], more, enforced } => {
                let (low, high) = (number(*low), number(*high));
                write!(
                    f,
                    "`{axis}` of `{agent}` starts at {value}, beyond its position limits: {low} to {high} are allowed"
                )?;
                if *enforced {
                    write!(f, ", and the run ends there")?;
                }
                match more {
                    0 => Ok(()),
                    1 => write!(f, "; so does 1 more axis"),
                    more => write!(f, "; so do {more} more axes of all agents"),
                }
            }
            Notice::Rotation { agent, degrees, more } => {
                let way = if *degrees > 180.0 { "long" } else { "short" };
                let [turn, other] = match [*degrees, 360.0 - degrees] {
                    // Close to half a turn a whole degree does not tell which way is shorter.
                    each if each[0] != each[1] && of_degrees(each[0]) == of_degrees(each[1]) => {
                        each.map(|degrees| format!("{degrees:.2}"))
                    }
                    each => each.map(of_degrees),
                };
                write!(f, "{agent} turns by {turn}° to its target, ")?;
                if turn == other {
                    write!(f, "which is as far either way")?;
                } else {
                    write!(f, "the {way} way; from −q it would be {other}°")?;
                }
                match more {
                    0 => Ok(()),
                    1 => write!(f, "; 1 more spacecraft turns by no more"),
                    more => write!(f, "; {more} more spacecraft turn by no more"),
                }
            }
            Notice::LongSteps { agent, per_s, step_s, enough_s } => write!(
                f,
                "`solver.step_s` is {} s, which is too long for the gain K: at the start of {agent} s decays at {} per second, which \
                 longer steps than {} s make unstable; take shorter ones, or the adaptive method",
                number(*step_s),
                about(*per_s),
                about(*enough_s).typed()
            ),
            Notice::StiffDamping { agent, per_s, steps } => write!(
                f,
                "the gain K is stiff: at the start of {agent} s decays at {} per second, and a run in continuous time takes \
                 about {} steps to follow that; let K be smaller, or the run shorter",
                about(*per_s),
                about(*steps)
            ),
            Notice::IdlePush { line } => write!(f, "the push on line {line} does not act during the run"),
        }
    }
}

/// "a → b and c → d".
/// Letters of a name that are shown.
const MOST_LETTERS: usize = 80;

fn named(links: &[(String, String)]) -> String {
    let short = |name| beginning(name, MOST_LETTERS);
    enumerate(links.iter().map(|(from, to)| format!("{} → {}", short(from), short(to))))
}
