//! What the theorems promise for a setup, and how it is shown.

use std::ops::ControlFlow;

use forwardstep::check::prediction::guaranteed::WORK;
use forwardstep::check::prediction::{COURSE_WORK, NoRate, course_within, guaranteed_rate, period_rate_within, rate};
use forwardstep::check::{
    self, Answer, NoPrediction, NotFixed, Practical, PracticalAnswer, Prediction, Report, Source,
};
use forwardstep::io::output::{Predictions, Remark, RunRecord, SavedRun, names};
use forwardstep::io::scenario::Scenario;
use forwardstep::sim::{Progress, Setup};

use crate::console::{BAD, BOLD, Console, DIM, FAIR, GOOD};

/// What was promised before a run.
pub(crate) struct Promise {
    pub(crate) report: Report,
    /// What can be said of the loop as it is deployed.
    pub(crate) practical: Practical,
    /// The value that the agents will agree on, or why it is not known.
    pub(crate) agreement: Result<Prediction, NoPrediction>,
}

impl Promise {
    /// The value that the agents will agree on, per axis, if it is known.
    pub(crate) fn value(&self) -> Option<&[f64]> {
        self.agreement.as_ref().ok().map(|prediction| prediction.value.as_slice())
    }

    /// The same for people, with the digits that are known.
    pub(crate) fn known_value(&self) -> String {
        self.agreement.as_ref().map_or_else(|_| String::new(), |prediction| first(&prediction.known_digits()))
    }

    /// What is to be said of a run that was read back, for which this is promised now.
    pub(crate) fn remarks(&self, run: &SavedRun) -> Vec<Remark> {
        run.remarks(&self.report, env!("CARGO_PKG_VERSION"))
    }

    /// Its record, with these remarks.
    pub(crate) fn record<'a>(&'a self, run: &'a SavedRun, remarks: &[Remark]) -> RunRecord<'a> {
        run.record(&self.report, self.practical.clone(), self.value().map(<[f64]>::to_vec), remarks)
    }
}

/// Looks at the hypotheses.
pub(crate) fn promise(setup: &Setup) -> Promise {
    Promise { report: check::check(setup), practical: check::practical(setup), agreement: check::predict(setup) }
}

/// Simulates the reference dynamics alone, with as much work as is spent on a prediction, or `thorough`, with all that it takes; nothing where there is
/// nothing to predict, or `observer` interrupts.
pub(crate) fn predictions(
    setup: &Setup,
    thorough: bool,
    observer: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Option<Predictions> {
    let work = if thorough { f64::INFINITY } else { COURSE_WORK };
    let (course, rate) = (course_within(setup, work, observer), rate(setup));
    let repeats = matches!(rate, Err(NoRate::NotFixed(NotFixed::Switching | NotFixed::VaryingDelay)));
    let period = (repeats && course.is_ok()).then(|| period_rate_within(setup, work, observer));
    Predictions::of(setup, &course, &rate, period.as_ref(), &guaranteed_rate(setup, WORK))
}

/// Whether predictions take a fraction of a second. They simulate the reference dynamics of every axis over the horizon, and those of one axis over
/// up to ten horizons for the rate: of robots with heavy dynamics a small part of a run, of many light ones a multiple.
pub(crate) fn predicts_quickly(setup: &Setup) -> bool {
    /// Seconds of one axis of one agent that are simulated at most.
    const MOST_AXIS_SECONDS: f64 = 2e4;
    /// What the rate takes, in horizons of one axis.
    const RATE: usize = 10;
    let axes: usize = setup.agents.iter().map(|agent| agent.robot.axes.len() + RATE).sum();
    axes as f64 * setup.time.end_s <= MOST_AXIS_SECONDS
}

/// What is predicted, in a few lines.
pub(crate) fn show_predictions(setup: &Setup, predictions: &Predictions, console: &mut Console) {
    if predictions.is_of_one_alone(setup) {
        return;
    }
    console.line(format_args!("{BOLD}Predicted{BOLD:#} for robots that follow their references exactly, s ≡ 0:"));
    for sentence in predictions.sentences(setup) {
        console.line(format_args!("  {sentence}"));
    }
}

/// The scenario in one line, and the verdicts.
pub(crate) fn show(scenario: &Scenario, promise: &Promise, console: &mut Console) {
    let Promise { report, practical, agreement } = promise;
    console.line(format_args!("{BOLD}{}{BOLD:#}", scenario.title));
    console.line("");
    console.line(format_args!("{BOLD}{}{BOLD:#}: {}", report.theorem, report.promises));
    for hypothesis in &report.hypotheses {
        let (style, words) = (style(hypothesis.answer()), hypothesis.answer().words());
        let (requires, name) = (hypothesis.requires(), hypothesis.id.name());
        // What the paper asks for is the rule, and needs no mark.
        let not_paper = if hypothesis.source() == Source::Derived { ", not in the paper" } else { "" };
        console.line(format_args!("  {style}{words}{style:#}: {requires} {DIM}[{name}{not_paper}]{DIM:#}"));
        console.line(format_args!("    {DIM}{}{DIM:#}", hypothesis.because()));
        if let Some(change) = hypothesis.change() {
            console.line(format_args!("    to make it hold: {change}"));
        }
    }
    match agreement {
        Ok(prediction) => console.line(format_args!("  predicted agreement: {}", first(&prediction.known_digits()))),
        // One agent alone has no other to agree with.
        Err(_) if scenario.setup.agents.len() < 2 => {}
        Err(error) => {
            let reason = names::reason(&scenario.setup, error);
            console.line(format_args!("  {DIM}no exact value is predicted that all agree upon, since {reason}{DIM:#}"));
        }
    }
    show_practical(practical, console);
    for notice in &scenario.notices {
        console.line(format_args!("{FAIR}note{FAIR:#}: {notice}"));
    }
    // What is only checked may be too long to be run.
    if let Err(refused) = scenario.check_recording() {
        console.line(format_args!("{FAIR}note{FAIR:#}: `forwardstep run` refuses it: {refused}"));
    }
}

/// The practical verdicts, which are not the paper's.
fn show_practical(practical: &Practical, console: &mut Console) {
    if practical.findings.is_empty() {
        return;
    }
    console.line(format_args!("{BOLD}Practical{BOLD:#}: {}", Source::Derived.words()));
    for finding in &practical.findings {
        let style = match finding.answer() {
            PracticalAnswer::Bound => DIM,
            PracticalAnswer::Adequate => GOOD,
            PracticalAnswer::Marginal | PracticalAnswer::NotShown => FAIR,
            PracticalAnswer::Inadequate => BAD,
        };
        let (words, about, name) = (finding.answer().words(), finding.about(), finding.name());
        console.line(format_args!("  {style}{words}{style:#}: {about} {DIM}[{name}]{DIM:#}"));
        console.line(format_args!("    {DIM}{}{DIM:#}", finding.because()));
    }
}

/// The colour of an answer.
pub(crate) fn style(answer: Answer) -> anstyle::Style {
    match answer {
        Answer::Holds => GOOD,
        Answer::HoldsOnHorizon | Answer::Watched | Answer::NotShown | Answer::NotCovered => FAIR,
        Answer::Violated => BAD,
    }
}

/// Numbers to a precision that people compare by; of many the first few. What rounds to zero has no sign.
pub(crate) fn list(values: &[f64]) -> String {
    // Adding zero takes the sign from a zero.
    first(
        &values
            .iter()
            .map(|value| format!("{:.6}", (value * 1e6).round() / 1e6 + 0.0).replace('-', "−"))
            .collect::<Vec<_>>(),
    )
}

fn first(values: &[String]) -> String {
    const SHOWN: usize = 8;
    let shown = values[..values.len().min(SHOWN)].join(", ");
    match values.len().saturating_sub(SHOWN) {
        0 => format!("({shown})"),
        more => format!("({shown}, and {more} more)"),
    }
}
