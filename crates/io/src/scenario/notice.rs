//! What the author of an accepted scenario should know.

use std::fmt;

use forwardstep_check::{SampledDamping, sampled_damping};
use forwardstep_sim::{AgentSetup, Axis, Setup};

use crate::urdf;
use crate::wording::{about, enumerate, number};

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
    /// Held damping that overshoots.
    CoarseSampling {
        /// The agent whose damping is fastest.
        agent: String,
        /// h · λ_max(M⁻¹K) at its start.
        value: f64,
        /// Above this it overshoots.
        overshoots_above: f64,
        /// Above this it is unstable.
        unstable_above: f64,
        /// A sample rate that would be enough without a delay of the torque, Hz.
        enough_hz: f64,
    },
    /// A log has packets of edges that the network does not have.
    UnusedInLog {
        /// The log.
        file: String,
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
    /// A push that has no effect on the run.
    IdlePush {
        /// Its line in the scenario.
        line: usize,
    },
}

/// Times of a run at which a target is held against position limits.
const LOOKS: u32 = 1000;

impl Notice {
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

    /// Digital control whose period is too long for its gain K.
    pub(super) fn coarse_sampling(setup: &Setup) -> Option<Notice> {
        let SampledDamping { value, overshoots_above, unstable_above, agent, period_s } = sampled_damping(setup)?;
        (value > overshoots_above).then(|| Notice::CoarseSampling {
            agent: setup.agents[agent].name.clone(),
            value,
            overshoots_above,
            unstable_above,
            // A little more, since it is shown rounded.
            enough_hz: 1.05 * value / overshoots_above / period_s,
        })
    }
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Notice::Robot { agents, notice } => write!(f, "{agents}: {notice}"),
            Notice::CoarseSampling { agent, value, overshoots_above, unstable_above, enough_hz } => write!(
                f,
                "`sample_hz` is low for the gain K: h · λ_max(M⁻¹K) is {value:.3} for {agent}; above {overshoots_above:.3} the \
                 held damping overshoots, above {unstable_above:.3} it is unstable; sample at {} Hz, or let K be smaller",
                about(*enough_hz)
            ),
            Notice::UnusedDwell { line } => write!(f, "`dwell_s` on line {line} is not used"),
            Notice::UnusedInLog { file, links } => {
                write!(f, "the packets of {} in `{file}` are not used: the network has no such edge", named(links))
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
            Notice::IdlePush { line } => write!(f, "the push on line {line} does not act during the run"),
        }
    }
}

/// "a → b and c → d".
fn named(links: &[(String, String)]) -> String {
    enumerate(links.iter().map(|(from, to)| format!("{from} → {to}")))
}
