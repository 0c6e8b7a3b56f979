//! `summary.json`: what was promised and what happened, for programs.
//!
//! The structs below are the format: they write the document and read it back. What a report shows and neither the tables nor
//! the scenario tell (how the run ended, what it cost, its notices) comes from here when a report is built anew.

use std::io::Write;
use std::time::Duration;

use forwardstep_sim::recording::{ClippedSamples, Drive, Statistics};
use schemars::{JsonSchema, Schema, schema_for};
use serde::{Deserialize, Serialize};

use super::digital::DigitalCost;
pub use super::how::{BrokenSignal, Cause, EndingKind, How, Rates};
use super::injected::{Injected, InjectedCourse};
use super::inputs;
use super::inputs::content_digest;
use super::metrics::Metrics;
use super::packets::Link;
use super::practical::PracticalVerdicts;
use super::prediction::Predictions;
use super::record::RunRecord;
pub use super::verdicts::{Verdict, Verdicts};
use super::{names, number};
use crate::scenario::Goal;

/// The format of this document; it grows when fields change their meaning or vanish, not when some are added.
pub const FORMAT: u32 = 2;

/// The whole document. Numbers that are not finite are `null`, and are NaN when read back.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "forwardstep summary.json")]
pub struct Summary {
    /// [`FORMAT`].
    pub format: u32,
    /// The version of forwardstep.
    pub version: String,
    /// The scenario's title.
    pub title: String,
    /// The scenario.
    pub scenario: Scenario,
    /// The agents, in the order that indices refer to.
    pub agents: Vec<Agent>,
    /// How the run ended.
    pub ending: How,
    /// The scenario's goal, if it has one.
    pub goal: Option<GoalMet>,
    /// The files that the scenario names, and their copies.
    pub inputs: Vec<Input>,
    /// The tables with every recorded number.
    pub tables: Vec<TableFile>,
    /// What was promised before the run.
    pub verdicts: Verdicts,
    /// What could be said of the loop as it is deployed; absent in documents of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub practical: Option<PracticalVerdicts>,
    /// What was predicted for robots that follow their references exactly, s ≡ 0.
    #[serde(default)]
    pub prediction: Option<Predictions>,
    /// What happened.
    pub metrics: Metrics,
    /// Work of the integrator.
    pub solver: Solver,
    /// Links that carried packets; empty where none does.
    #[serde(default)]
    pub links: Vec<Link>,
    /// What digital control cost, when there was any.
    #[serde(default)]
    pub digital: Option<DigitalCost>,
    /// What changed V, by each agent whose law has a proof here: with digital control and `run --balance`; absent otherwise, and in documents of
    /// older versions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub injected: Vec<Injected>,
    /// The same over time, of all agents together; absent where there is none, and in documents of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub injected_course: Option<InjectedCourse>,
    /// Remarks.
    pub notices: Vec<String>,
    /// The only part that differs between two runs of the same scenario by the same version.
    pub timings: Timings,
}

/// Which scenario it was.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Scenario {
    /// Its name.
    pub name: String,
    /// The BLAKE3 digest of its text, in hexadecimal.
    pub digest_blake3: String,
    /// The digest of what it says apart from its title: comments and layout do not enter.
    pub content_digest_blake3: Option<String>,
}

/// A file that the scenario names. Shipped robots are not among them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Input {
    /// Its name in the scenario.
    pub name: String,
    /// Its copy in the folder of the run.
    pub file: String,
    /// The BLAKE3 digest of the copy, in hexadecimal.
    pub digest_blake3: String,
}

/// A table of the run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct TableFile {
    /// Its name in the folder of the run.
    pub file: String,
    /// The BLAKE3 digest of the file, in hexadecimal.
    pub digest_blake3: String,
    /// How long the file is, in bytes; not said by earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bytes: Option<u64>,
}

/// What indices of agents and axes refer to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Agent {
    /// The agent's name.
    pub name: String,
    /// The names of its axes, as in the column names of the tables.
    pub axes: Vec<String>,
}

/// A goal and whether it was met.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GoalMet {
    /// Bound on the final disagreement.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disagreement_below: Option<f64>,
    /// Bound on the final error.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_below: Option<f64>,
    /// True when the run was expected to diverge.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub expect_diverges: bool,
    /// Whether it was met.
    pub met: bool,
    /// True when it was not, and the run ended before anybody could tell.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub undecided: bool,
}

/// Work of the integrator.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Solver {
    /// Accepted steps.
    pub steps: u64,
    /// Rejected steps.
    pub rejected: u64,
    /// Evaluations of the closed loop.
    pub evaluations: u64,
    /// Steps that ended on a break-point.
    pub break_points: u64,
    /// Steps of sampled controllers that failed, so that a safe command stood; absent where none did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed_steps: Option<u64>,
    /// Commands of sampled controllers that limits changed; absent in continuous time and in documents of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clipped: Option<Clipped>,
    /// The largest rest of the inclusions that set-valued signs solve; absent where none are solved for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sign_residual: Option<f64>,
    /// What drove an agent that leads the others; absent where none does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub leader_drive: Option<LeaderDrive>,
}

/// How many commands of sampled controllers limits changed, on one axis or more.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Clipped {
    /// Samples of all agents.
    pub samples: u64,
    /// Of these, at so many a torque was beyond its limit.
    pub torque: u64,
    /// At so many it would have changed faster than it may.
    pub rate: u64,
}

/// What drove an agent that leads away from those that follow it, in the unit of γ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LeaderDrive {
    /// Its largest size on any axis.
    pub peak: f64,
    /// When that was, s.
    pub peak_s: f64,
    /// When it was γ or more for the last time, s; null for never.
    pub exceeds_until_s: Option<f64>,
}

/// Times that depend on the machine.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Timings {
    /// Time spent simulating, s; null if it was not measured.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub wall_s: f64,
    /// Simulated time per time spent; null likewise.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub simulated_per_wall: f64,
}

impl Summary {
    /// The JSON schema of this document.
    pub fn schema() -> Schema {
        schema_for!(Summary)
    }

    /// The summary of a run; `metrics` are those of its recording, `tables` the files that were written from it.
    pub fn of(record: &RunRecord<'_>, metrics: Metrics, tables: Vec<TableFile>) -> Summary {
        let setup = record.setup;
        let statistics = &record.outcome.statistics;
        let ending = How::of(setup, &record.outcome.ending);
        let wall_s = statistics.wall.map_or(f64::NAN, |wall| wall.as_secs_f64());
        Summary {
            format: FORMAT,
            version: record.version.to_owned(),
            title: record.title.to_owned(),
            scenario: Scenario {
                name: record.scenario_name.to_owned(),
                digest_blake3: record.digest(),
                content_digest_blake3: content_digest(record.scenario_text),
            },
            inputs: inputs::copies(record.inputs).into_iter().map(|(input, _)| input).collect(),
            tables,
            agents: (setup.agents.iter().enumerate())
                .map(|(i, agent)| Agent {
                    name: agent.name.clone(),
                    axes: (0..agent.robot.axes.len()).map(|axis| names::axis_name(setup, i, axis)).collect(),
                })
                .collect(),
            goal: record.goal.map(|outcome| GoalMet {
                disagreement_below: match outcome.goal {
                    Goal::DisagreementBelow(bound) => Some(bound),
                    _ => None,
                },
                error_below: match outcome.goal {
                    Goal::ErrorBelow(bound) => Some(bound),
                    _ => None,
                },
                expect_diverges: outcome.goal == Goal::ExpectDiverges,
                met: outcome.met,
                undecided: record.goal_word(outcome) == "undecided",
            }),
            verdicts: Verdicts::of(record.verdicts),
            practical: Some(PracticalVerdicts::from(&record.practical)),
            prediction: record.prediction.clone(),
            metrics,
            solver: Solver {
                steps: statistics.steps,
                rejected: statistics.rejected,
                evaluations: statistics.evaluations,
                break_points: statistics.break_points,
                failed_steps: (statistics.failed_steps > 0).then_some(statistics.failed_steps),
                clipped: statistics.clipped.map(|ClippedSamples { samples, torque, rate }| Clipped {
                    samples,
                    torque,
                    rate,
                }),
                sign_residual: statistics.sign_residual.filter(|residual| residual.is_finite()),
                leader_drive: statistics.drive.filter(|drive| drive.peak.is_finite()).map(|drive| {
                    let Drive { peak, peak_s, exceeds_until_s } = drive;
                    LeaderDrive { peak, peak_s, exceeds_until_s }
                }),
            },
            links: Link::all(&setup.network, &record.outcome.ending),
            digital: record.digital.clone(),
            injected: record.injected.clone(),
            injected_course: record.injected_course.clone(),
            notices: record.notices.clone(),
            timings: Timings { wall_s, simulated_per_wall: ending.t_s / wall_s },
            ending,
        }
    }

    /// What the run cost.
    pub(crate) fn statistics(&self) -> Statistics {
        let Solver { steps, rejected, evaluations, break_points, failed_steps, clipped, sign_residual, leader_drive } =
            self.solver;
        let clipped = clipped.map(|Clipped { samples, torque, rate }| ClippedSamples { samples, torque, rate });
        let drive =
            leader_drive.map(|LeaderDrive { peak, peak_s, exceeds_until_s }| Drive { peak, peak_s, exceeds_until_s });
        let wall = Duration::try_from_secs_f64(self.timings.wall_s).ok();
        let failed_steps = failed_steps.unwrap_or(0);
        Statistics { steps, rejected, evaluations, break_points, sign_residual, drive, failed_steps, clipped, wall }
    }

    /// Writes it as indented JSON.
    pub(crate) fn write(&self, out: &mut impl Write) -> serde_json::Result<()> {
        serde_json::to_writer_pretty(&mut *out, self)?;
        out.write_all(b"\n").map_err(serde_json::Error::io)
    }
}
