//! What is wrong with targets and leaders, and with the systems of Sections IV and V.

use forwardstep_core::expression::KinkError;
use forwardstep_sim::trajectory::{SplineError, TrajectoryError};
use thiserror::Error;

use crate::wording::{count, entry_count, enumerate, number};

/// Why one of these has no meaning.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SystemProblem {
    /// Sinusoids that make no trajectory.
    #[error(transparent)]
    Trajectory(TrajectoryError),
    /// Points and times that do not match.
    #[error("`positions` has {}, but `times_s` has {}", entry_count(*.points), entry_count(*.times))]
    PointsAndTimes {
        /// How many points.
        points: usize,
        /// How many times.
        times: usize,
    },
    /// Points that make no curve.
    #[error(transparent)]
    Points(SplineError),
    /// Followers without a leader.
    #[error("the agents are to follow a leader, but there is none")]
    NoLeader,
    /// A leader that is an agent, with another name.
    #[error("`{agent}` leads, and has a name already")]
    LeaderNamedTwice {
        /// The agent.
        agent: String,
    },
    /// A motion and an agent.
    #[error("there are two leaders, a motion and an agent")]
    TwoLeaders,
    /// A leader that goes nowhere.
    #[error("a leader needs a `motion`, or an `agent`")]
    NoMotion,
    /// A leader without followers.
    #[error("there is a leader, but `reference.{reference}` does not follow one")]
    LeaderUnused {
        /// The reference dynamics.
        reference: &'static str,
    },
    /// Something said of a nonlinear protocol where there is none.
    #[error("this is said of dynamics with a formula `nonlinear`, but there is none: of linear ones `check` finds it")]
    SaidOfLinear,
    /// A coupling where there is none.
    #[error("`coupling` belongs to the design `swarm`")]
    CouplingUnused,
    /// A period of the sign where nothing is set by it.
    #[error(
        "`sign_period_s` has no effect: {}",
        if *.layer { "a boundary layer has its value at every instant" } else { "sampled controllers set the sign at every sample" }
    )]
    SignPeriodUnused {
        /// Whether there is a boundary layer.
        layer: bool,
    },
    /// A quantity of a rotorcraft beside a vehicle.
    #[error("`rate_bandwidth_per_s` has no effect: the angular velocity of `{agent}` is the one that is asked for")]
    RateBandwidthUnused {
        /// The agent.
        agent: String,
    },
    /// A heading that nothing leads to.
    #[error("`heading_rad` has no effect beside `gain_per_s` = 0")]
    HeadingUnused,
    /// Rows at an interval and elsewhere.
    #[error("both `record_every_s` and `record_at` say when rows are recorded")]
    RowsTwice,
    /// Rows at samples that are not taken.
    #[error("rows are to be recorded at samples, but control is continuous")]
    NoSamples,
    /// A β for a design that has none.
    #[error("`continuous` has no β")]
    BetaUnused,
    /// α or β for a design that has roots.
    #[error("`observer` is given by its roots")]
    RootsAlone,
    /// As many roots as the design has.
    #[error("`roots_per_s` has {}, but this design needs {need}", count(*.found, "root"))]
    LeaderRoots {
        /// How many there are.
        found: usize,
        /// How many are needed.
        need: usize,
    },
    /// A target that has no value somewhere on the run.
    #[error("this has no finite value everywhere from 0 s to {end_s} s, or that could not be shown")]
    TargetValue {
        /// The end of the run, s.
        end_s: f64,
    },
    /// A formula with kinks that cannot be landed on.
    #[error("a motion must be smooth between kinks that are known, but {0}")]
    Kinks(KinkError),
    /// A desired attitude that is zero, as far as numbers tell.
    #[error("this is no attitude at {} s: {}", number(*.t_s), length(*.norm, *.beside, *.every_s))]
    NoAttitude {
        /// When, s.
        t_s: f64,
        /// How long it is then.
        norm: f64,
        /// How long it is beside it.
        beside: f64,
        /// How far beside it, s.
        every_s: f64,
    },
    /// A pose for what has none.
    #[error("`pose` is for an end-effector whose position and orientation follow the target")]
    NotAPose,
    /// A direction that is zero.
    #[error("this is zero and has no direction")]
    NoDirection {
        /// What would have one.
        instead: &'static str,
    },
    /// An initial value that an agent does not have.
    #[error("`{key}` says nothing about `{agent}`")]
    StartUnused {
        /// The key.
        key: &'static str,
        /// The agent.
        agent: String,
    },
    /// A law that is made for something else.
    #[error("agent `{agent}`: the law `{law}` is made for {made_for}")]
    LawOfAnother {
        /// The agent.
        agent: String,
        /// The law's key.
        law: &'static str,
        /// What it is made for, in words.
        made_for: &'static str,
        /// The keys of the laws that suit the agent's robot.
        laws: Vec<&'static str>,
    },
}

impl SystemProblem {
    pub(super) fn help(&self) -> Option<String> {
        let text = match self {
            SystemProblem::NoLeader => "add `[leader]` with a `motion`, or with the name of an `agent`".into(),
            SystemProblem::LeaderNamedTwice { .. } => "leave `name` out".into(),
            SystemProblem::TwoLeaders => {
                "leave `motion` or `agent` out; an agent that leads follows its own `target`".into()
            }
            SystemProblem::NoMotion => "write where it is over time, or which agent leads".into(),
            SystemProblem::SignPeriodUnused { .. } | SystemProblem::HeadingUnused => "leave it out".into(),
            SystemProblem::RateBandwidthUnused { .. } => "leave it out, or let the robot be a `rotorcraft`".into(),
            SystemProblem::LeaderUnused { .. } => "write `reference.leader`, or delete the leader".into(),
            SystemProblem::RowsTwice => "leave one of them out".into(),
            SystemProblem::NoSamples => "write `[control]` with `sample_hz`, or `record_at.times_s`".into(),
            SystemProblem::BetaUnused => "leave it out: (110) has α alone".into(),
            SystemProblem::RootsAlone => {
                "write `roots_per_s = [1.0, 2.0]`: the first for the estimates, the second for the robots".into()
            }
            SystemProblem::LeaderRoots { .. } => {
                "`continuous` has one root, which is real, `observer` has two real ones, the other designs have two, or a pair of complex ones"
                    .into()
            }
            SystemProblem::TargetValue { .. } => {
                "roots, logarithms and quotients need arguments that stay where they have values".into()
            }
            SystemProblem::Kinks(KinkError::TooMany) => {
                "shorten the run, or use something smooth such as `sin` or `tanh`".into()
            }
            SystemProblem::Kinks(KinkError::Unclear { .. }) => {
                "keep what `abs`, `min` and `max` compare apart except where it crosses, or write something smooth: \
                 `sqrt(x^2 + 0.01)` is close to `abs(x)`"
                    .into()
            }
            SystemProblem::LawOfAnother { laws, .. } if laws.is_empty() => return None,
            SystemProblem::LawOfAnother { laws, .. } => {
                format!("for this robot there is {}", enumerate(laws.iter().map(|law| format!("`{law}`"))))
            }
            SystemProblem::NoAttitude { .. } => {
                "a quaternion may have any length but zero, vector part first: [0, 0, 0, 1] is no turn".into()
            }
            SystemProblem::NotAPose => {
                "let `follows` of the law's `end_effector` be \"pose\", or write `formulas`, an entry for each axis"
                    .into()
            }
            SystemProblem::NoDirection { instead } => (*instead).into(),
            SystemProblem::StartUnused { key, .. } => match *key {
                "attitude" => "vehicles, rotorcraft and spacecraft have an attitude".into(),
                "angular_velocity_rad_s" => "rotorcraft and spacecraft have an angular velocity".into(),
                "spacecraft" => "only spacecraft start by it".into(),
                "rotation" => "only spacecraft with a target choose between q and -q".into(),
                "filter" => "only spacecraft and agents under `reference.backstepping` have a filter".into(),
                "z" | "derivatives" => {
                    "under `reference.backstepping` it follows from what is heard, and `filter` may be stated; spacecraft have `z` alone".into()
                }
                "higher_states" => {
                    "only chains of order two or more in feedback form, else of order three or more, have any".into()
                }
                key if key.starts_with("velocity") => {
                    "chains of order one or in feedback form have `higher_states`, spacecraft `angular_velocity_rad_s`"
                        .into()
                }
                _ => "spacecraft start by `attitude`, `angular_velocity_rad_s` and `spacecraft`".into(),
            },
            _ => return None,
        };
        Some(text)
    }
}

/// How long a quaternion is that is too short to tell a direction.
fn length(norm: f64, beside: f64, every_s: f64) -> String {
    if norm == 0.0 {
        return "its four entries are zero there".into();
    }
    let every_s = number(every_s);
    format!("its length comes to {norm:.1e} there, of {beside:.1e} {every_s} s beside it, and no direction can be told")
}
