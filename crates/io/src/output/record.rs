//! Everything that is known about a finished run.

use forwardstep_check::hypothesis::Subject;
use forwardstep_check::{Answer, Footing, Ground, Hypothesis, Id, Practical, Report};
use forwardstep_sim::recording::{BreakdownCause, Ending, Outcome, Recording, Signal};
use forwardstep_sim::setup::Setup;

use super::digital::DigitalCost;
use super::injected::{Injected, InjectedCourse};
use super::metrics::{Gap, Metrics};
use super::names;
use super::prediction::Predictions;
use super::text::{self, number};
use crate::scenario::{Goal, InputFile};
use crate::shapes::Shapes;

/// A finished run with all that was said about it before: what [`super::write_run`] writes.
#[derive(Clone, Debug)]
pub struct RunRecord<'a> {
    /// The scenario's title, for headings.
    pub title: &'a str,
    /// The scenario's name: its file or the name of a built-in one.
    pub scenario_name: &'a str,
    /// The scenario's text as it was read; copied to `scenario.toml`.
    pub scenario_text: &'a str,
    /// The files that the scenario names; copied to `inputs/`.
    pub inputs: &'a [InputFile],
    /// The version of forwardstep.
    pub version: &'a str,
    /// What was simulated.
    pub setup: &'a Setup,
    /// What came out.
    pub outcome: &'a Outcome,
    /// What was promised before the run.
    pub verdicts: &'a Report,
    /// What was said before the run of the loop as it is deployed.
    pub practical: Practical,
    /// The value the agents are predicted to agree on, per axis, when a theorem or a certificate tells.
    pub predicted_agreement: Option<Vec<f64>>,
    /// What was predicted for s ≡ 0; `None` where nothing is, or it was interrupted.
    pub prediction: Option<Predictions>,
    /// The scenario's goal and whether it was met.
    pub goal: Option<GoalOutcome>,
    /// What digital control cost, when there was any and the run was not interrupted.
    pub digital: Option<DigitalCost>,
    /// What changed V, by each agent whose law has a proof here, with `run --balance`; empty without it, and in continuous time.
    pub injected: Vec<Injected>,
    /// The same over time, of all agents together.
    pub injected_course: Option<InjectedCourse>,
    /// Remarks for the reader of the report.
    pub notices: Vec<String>,
    /// What the robots look like, if that was read.
    pub shapes: Option<&'a Shapes>,
}

impl RunRecord<'_> {
    /// The BLAKE3 digest of the scenario's text, in hexadecimal.
    pub fn digest(&self) -> String {
        blake3::hash(self.scenario_text.as_bytes()).to_hex().to_string()
    }

    /// Where all positions will be, per axis, if that is predicted; nothing where they are to differ by offsets.
    pub fn predicted_position(&self) -> Option<&[f64]> {
        self.predicted_agreement.as_deref().filter(|_| !self.keeps_offsets())
    }

    /// Whether agents agree on where they are less offsets of their own.
    pub(crate) fn keeps_offsets(&self) -> bool {
        Gap::keeps_offsets(self.setup)
    }

    /// Whether all agreed: what is left is at most 1 % of the largest disagreement, and what the goal asks for is met.
    pub fn is_agreed(&self, metrics: &Metrics) -> bool {
        let missed =
            self.goal.is_some_and(|outcome| matches!(outcome.goal, Goal::DisagreementBelow(_)) && !outcome.met);
        metrics.disagreement.is_agreement() && !missed
    }

    /// Whether somebody ended the run before its horizon, so that nothing is known of what would have come.
    pub fn is_undecided(&self) -> bool {
        matches!(self.outcome.ending, Ending::Interrupted { .. } | Ending::CutOff { .. })
    }

    /// That a hypothesis that is watched during the run failed in it, and when, as a clause; `None` where it did not.
    pub(crate) fn failed(&self, hypothesis: &Hypothesis) -> Option<String> {
        if hypothesis.id == Id::SignGain {
            let until_s = self.outcome.statistics.drive?.exceeds_until_s?;
            return Some(format!("γ was too small until t = {} s, and large enough from then on", number(until_s)));
        }
        let Ending::BrokeDown(breakdown) = &self.outcome.ending else { return None };
        let is_cause = match breakdown.signal {
            Signal::Thrust => hypothesis.id == Id::NonzeroThrust,
            Signal::Divisor => hypothesis.id == Id::InputFactor,
            _ => hypothesis.id == Id::RegularJacobian,
        };
        let is_whose = match &hypothesis.subject {
            Subject::Agent(agent) => agent.index == breakdown.agent,
            _ => true,
        };
        let vanished = matches!(breakdown.cause, BreakdownCause::Vanished { .. });
        (vanished && is_cause && is_whose).then(|| format!("it failed, at t = {} s", number(breakdown.t_s)))
    }

    /// How near what a hypothesis keeps from zero came to it in the rows of the run, as a clause; `None` where nothing that is recorded tells.
    pub(crate) fn nearest(&self, hypothesis: &Hypothesis) -> Option<String> {
        let signals: &[Signal] = match hypothesis.id {
            Id::NonzeroThrust => &[Signal::Thrust],
            Id::InputFactor => &[Signal::Divisor],
            Id::RegularJacobian => &[Signal::Determinant, Signal::SingularValue],
            _ => return None,
        };
        let is_of = |agent: usize| match &hypothesis.subject {
            Subject::Agent(named) => named.index == agent,
            _ => true,
        };
        let Recording { t_s, columns, .. } = &self.outcome.recording;
        let those = columns.iter().filter(|column| signals.contains(&column.signal) && is_of(column.agent));
        let all = those.flat_map(|column| t_s.iter().zip(&column.values).map(move |(t_s, value)| (column, t_s, value)));
        let (column, t_s, value) = all.min_by(|a, b| a.2.abs().total_cmp(&b.2.abs()))?;
        let unit = names::unit(self.setup, column.agent, column.signal, column.axis);
        let unit =
            if matches!(unit.as_str(), "" | "1" | "SI") { String::new() } else { format!(" {}", text::unit(&unit)) };
        let whose = match self.setup.agents.len() {
            1 => String::new(),
            _ => format!(", of {}", self.setup.agents.get(column.agent)?.name),
        };
        Some(format!("the smallest in this run was {}{unit}{whose}, at t = {} s", number(*value), number(*t_s)))
    }

    /// What the derivation rests on; what failed in the run is among what it lacks.
    pub(crate) fn footing(&self) -> Footing {
        let mut footing = Footing::of(self.setup, self.verdicts);
        for hypothesis in &self.verdicts.hypotheses {
            if let Some(words) = self.failed(hypothesis) {
                footing.breaks.retain(|ground| ground.id != hypothesis.id);
                let words = format!("{}; in this run {words}", hypothesis.requires());
                footing.lacks.push(Ground { id: hypothesis.id, words });
            }
        }
        footing
    }

    /// Of the hypotheses that are watched during the run those that failed in it, with when.
    pub fn failures(&self) -> Vec<String> {
        let watched = self.verdicts.hypotheses.iter().filter(|hypothesis| hypothesis.answer() == Answer::Watched);
        let named = |hypothesis: &Hypothesis| Some(format!("[{}]: {}", hypothesis.id.name(), self.failed(hypothesis)?));
        watched.filter_map(named).collect()
    }

    /// What became of its goal: `met`, `missed` or `undecided`.
    pub fn goal_word(&self, goal: GoalOutcome) -> &'static str {
        match goal.met {
            true => "met",
            false if self.is_undecided() => "undecided",
            false => "missed",
        }
    }
}

impl Goal {
    /// Whether `outcome` meets the goal.
    ///
    /// A run diverges when it breaks down without leaving an enforced limit or its memory budget, or when its disagreement is no
    /// longer finite, or exceeds in the last quarter of the run everything seen in the first quarter.
    pub fn is_met(&self, setup: &Setup, outcome: &Outcome, metrics: &Metrics) -> bool {
        match *self {
            Goal::DisagreementBelow(bound) | Goal::ErrorBelow(bound) => {
                outcome.ending == Ending::Completed && metrics.disagreement.last().is_some_and(|last| last < bound)
            }
            Goal::ExpectDiverges => {
                let grows = || super::disagreement::grows(setup, &outcome.recording);
                match &outcome.ending {
                    Ending::BrokeDown(breakdown) => match breakdown.cause {
                        BreakdownCause::PositionLimit { .. } | BreakdownCause::Delay { .. } => false,
                        // Short steps alone are no divergence.
                        BreakdownCause::MemoryFull { .. } => grows(),
                        BreakdownCause::NotFinite
                        | BreakdownCause::StepUnderFloor { .. }
                        | BreakdownCause::RanAway { .. }
                        | BreakdownCause::Vanished { .. } => true,
                    },
                    Ending::Completed | Ending::Interrupted { .. } | Ending::CutOff { .. } => grows(),
                }
            }
        }
    }
}

/// A goal and whether it was met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GoalOutcome {
    /// What was asked.
    pub goal: Goal,
    /// What happened.
    pub met: bool,
}
