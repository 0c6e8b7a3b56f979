//! `summary.json`: what was promised and what happened, for programs.

use std::io::Write;

use forwardstep_check::{Answer, Report};
use forwardstep_sim::recording::{BreakdownCause, Ending};
use forwardstep_sim::setup::Setup;
use serde::Serialize;

use super::metrics::Metrics;
use super::names;
use super::packets::Link;
use super::record::{Goal, RunRecord, ending_sentence};

/// The format of this document; it grows when fields change their meaning or vanish, not when some are added.
pub const FORMAT: u32 = 1;

/// The whole document. Numbers that are not finite are `null`.
#[derive(Clone, Debug, Serialize)]
pub struct Summary<'a> {
    /// [`FORMAT`].
    pub format: u32,
    /// The version of forwardstep.
    pub version: &'a str,
    /// The scenario's title.
    pub title: &'a str,
    /// The scenario.
    pub scenario: Scenario<'a>,
    /// The agents, in the order that indices refer to.
    pub agents: Vec<Agent<'a>>,
    /// How the run ended.
    pub ending: How,
    /// The scenario's goal, if it has one.
    pub goal: Option<GoalMet>,
    /// What was promised before the run.
    pub verdicts: Verdicts<'a>,
    /// What happened.
    pub metrics: &'a Metrics,
    /// Work of the integrator.
    pub solver: Solver,
    /// Links that carried packets; empty where none does.
    pub links: Vec<Link>,
    /// Remarks.
    pub notices: &'a [String],
    /// The only part that differs between two runs of the same scenario by the same version.
    pub timings: Timings,
}

/// Which scenario it was.
#[derive(Clone, Debug, Serialize)]
pub struct Scenario<'a> {
    /// Its name.
    pub name: &'a str,
    /// The BLAKE3 digest of its text, in hexadecimal.
    pub digest_blake3: String,
}

/// What indices of agents and axes refer to.
#[derive(Clone, Debug, Serialize)]
pub struct Agent<'a> {
    /// The agent's name.
    pub name: &'a str,
    /// The names of its axes, as in the column names of the tables.
    pub axes: Vec<String>,
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct How {
    /// `completed`, `interrupted` or `broke_down`.
    pub kind: EndingKind,
    /// The simulated time that was reached, s.
    pub t_s: f64,
    /// The horizon, s.
    pub end_s: f64,
    /// The ending in one sentence.
    pub sentence: String,
    /// What broke down, if anything did.
    pub breakdown: Option<BrokenSignal>,
}

/// The three endings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EndingKind {
    /// The horizon was reached.
    Completed,
    /// Stopped from outside.
    Interrupted,
    /// Stopped because of what happened inside.
    BrokeDown,
}

/// The signal that broke a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BrokenSignal {
    /// The agent.
    pub agent: usize,
    /// The signal's column in the tables.
    pub column: String,
    /// Why.
    pub cause: Cause,
}

/// Why a run broke down.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// A number was no longer finite.
    NotFinite,
    /// The error control asked for a step under the floor.
    StepUnderFloor {
        /// The step asked for, s.
        step_s: f64,
    },
    /// An enforced position limit was left.
    PositionLimit {
        /// The position, rad or m.
        value: f64,
        /// The limits.
        limits: [f64; 2],
    },
}

/// A goal and whether it was met.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GoalMet {
    /// Bound on the final disagreement.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub disagreement_below: Option<f64>,
    /// True when the run was expected to diverge.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub expect_diverges: bool,
    /// Whether it was met.
    pub met: bool,
}

/// A [`Report`] in words.
#[derive(Clone, Debug, Serialize)]
pub struct Verdicts<'a> {
    /// The theorem.
    pub theorem: &'a str,
    /// What it promises.
    pub promises: &'a str,
    /// The worst answer.
    pub worst: &'static str,
    /// Its hypotheses.
    pub hypotheses: Vec<Verdict<'a>>,
}

/// One hypothesis.
#[derive(Clone, Debug, Serialize)]
pub struct Verdict<'a> {
    /// What is required.
    pub requires: &'a str,
    /// `holds`, `holds on [0, end]`, `not covered by the paper` or `violated`.
    pub answer: &'static str,
    /// Certificate or witness.
    pub because: &'a str,
}

/// Work of the integrator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Solver {
    /// Accepted steps.
    pub steps: u64,
    /// Rejected steps.
    pub rejected: u64,
    /// Evaluations of the closed loop.
    pub evaluations: u64,
    /// Steps that ended on a break-point.
    pub break_points: u64,
}

/// Times that depend on the machine.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Timings {
    /// Time spent simulating, s.
    pub wall_s: f64,
    /// Simulated time per time spent.
    pub simulated_per_wall: f64,
}

impl<'a> Summary<'a> {
    /// The summary of a run; `metrics` are those of its recording.
    pub fn of(record: &'a RunRecord<'_>, metrics: &'a Metrics) -> Summary<'a> {
        let setup = record.setup;
        let statistics = &record.outcome.statistics;
        let ending = How::of(setup, &record.outcome.ending);
        let wall_s = statistics.wall.as_secs_f64();
        Summary {
            format: FORMAT,
            version: record.version,
            title: record.title,
            scenario: Scenario { name: record.scenario_name, digest_blake3: record.digest() },
            agents: (setup.agents.iter().enumerate())
                .map(|(i, agent)| Agent {
                    name: &agent.name,
                    axes: (0..agent.robot.axes.len()).map(|axis| names::axis_name(setup, i, axis)).collect(),
                })
                .collect(),
            goal: record.goal.map(|outcome| GoalMet {
                disagreement_below: match outcome.goal {
                    Goal::DisagreementBelow(bound) => Some(bound),
                    Goal::ExpectDiverges => None,
                },
                expect_diverges: outcome.goal == Goal::ExpectDiverges,
                met: outcome.met,
            }),
            verdicts: Verdicts::of(record.verdicts),
            metrics,
            solver: Solver {
                steps: statistics.steps,
                rejected: statistics.rejected,
                evaluations: statistics.evaluations,
                break_points: statistics.break_points,
            },
            links: Link::all(&setup.network),
            notices: &record.notices,
            timings: Timings { wall_s, simulated_per_wall: ending.t_s / wall_s },
            ending,
        }
    }

    /// Writes it as indented JSON.
    pub(crate) fn write(&self, out: &mut impl Write) -> serde_json::Result<()> {
        serde_json::to_writer_pretty(&mut *out, self)?;
        out.write_all(b"\n").map_err(serde_json::Error::io)
    }
}

impl How {
    fn of(setup: &Setup, ending: &Ending) -> How {
        let (kind, t_s, breakdown) = match ending {
            Ending::Completed => (EndingKind::Completed, setup.time.end_s, None),
            Ending::Interrupted { t_s } => (EndingKind::Interrupted, *t_s, None),
            Ending::BrokeDown(breakdown) => {
                let cause = match breakdown.cause {
                    BreakdownCause::NotFinite => Cause::NotFinite,
                    BreakdownCause::StepUnderFloor { step_s } => Cause::StepUnderFloor { step_s },
                    BreakdownCause::PositionLimit { value, limits } => Cause::PositionLimit { value, limits },
                };
                let column = names::column_name(setup, breakdown.agent, breakdown.signal, breakdown.axis);
                let broken = BrokenSignal { agent: breakdown.agent, column, cause };
                (EndingKind::BrokeDown, breakdown.t_s, Some(broken))
            }
        };
        How { kind, t_s, end_s: setup.time.end_s, sentence: ending_sentence(setup, ending), breakdown }
    }
}

impl<'a> Verdicts<'a> {
    fn of(report: &'a Report) -> Self {
        let worst: Answer = report.worst();
        Verdicts {
            theorem: &report.theorem,
            promises: &report.promises,
            worst: worst.words(),
            hypotheses: (report.hypotheses.iter())
                .map(|h| Verdict { requires: &h.requires, answer: h.answer.words(), because: &h.because })
                .collect(),
        }
    }
}
