//! The top of the page in words: title, how the run ended, what it came to, and the few numbers that one looks for first.

use forwardstep_check::Answer;
use forwardstep_sim::recording::{Ending, Signal};
use maud::{Markup, html};

use super::super::conclusion::Conclusion;
use super::super::metrics::{Absence, Disagreement, Metrics};
use super::super::names;
use super::super::record::RunRecord;
use super::super::text::{number, prose};
use super::sections::{BALANCE_WORDS, answer_style, ending, final_gap, so_far, unit_at};

/// Letters of a title that is set smaller, so that it takes two lines or three.
const LONG_TITLE: usize = 100;

/// Title, how it ended, and the few numbers one looks for first.
pub(crate) fn header(record: &RunRecord<'_>, metrics: &Metrics, goes_on: bool) -> Markup {
    let (class, word) = match record.outcome.ending {
        Ending::Completed => ("good", "Completed"),
        Ending::Interrupted { .. } => ("warn", "Interrupted"),
        Ending::CutOff { .. } => ("warn", "Cut off"),
        Ending::BrokeDown(_) => ("bad", "Broke down"),
    };
    html! {
        header.top {
            p.eyebrow { "forwardstep run" span.sep { "/" } (record.scenario_name) }
            h1.long[record.title.chars().count() > LONG_TITLE] title=(record.title) { (record.title) }
            @if goes_on { p.ending {
                span #running .badge.warn { "running: " (so_far(record)) }
                span #running-note {}
                label { input #reload type="checkbox" checked; " reload" }
            } }
            @else { p.ending {
                span.badge.(class) { (word) }
                @if let Some(outcome) = record.goal {
                    @let (class, word) = match record.goal_word(outcome) {
                        "met" => ("good", "Goal met"),
                        "missed" => ("bad", "Goal missed"),
                        _ => ("warn", "Goal undecided"),
                    };
                    span.badge.(class) { (word) }
                }
                span { (prose(&ending(record, goes_on))) }
            } }
            @if let Some(Conclusion { reached, sentence, advice }) = Conclusion::of(record, metrics) {
                @let ended = !goes_on && !record.is_undecided();
                p.conclusion {
                    @if goes_on { "so far " } @else if !ended { "when it ended early: " }
                    strong.good[reached && (ended || goes_on)].bad[!reached && ended] { (prose(&sentence)) }
                }
                @if !goes_on { (advised(&advice)) }
            }
        }
    }
}

/// What to change: the most likely in sight, the rest a press away, so that the picture below stays in the window.
fn advised(advice: &[String]) -> Markup {
    html! {
        @match advice {
            [] => {}
            [only] => ul.advice { li { (prose(only)) } },
            [first, rest @ ..] => details.advice {
                summary { span.by { "1 of " (advice.len()) ": " } (prose(first)) }
                ul { @for line in rest { li { (prose(line)) } } }
            },
        }
    }
}

/// The few numbers that one looks for first.
pub(crate) fn figures(record: &RunRecord<'_>, metrics: &Metrics) -> Markup {
    let setup = record.setup;
    html! {
        dl.figures {
            @match metrics.disagreement {
                Disagreement::Measured { last, .. } => {
                    (figure(&final_gap(setup), &number(last), &names::gap_unit(setup)))
                }
                Disagreement::Absent(Absence::FewerThanTwoAgents) => {}
                Disagreement::Absent(_) => (figure(&final_gap(setup), "–", "")),
            }
            @if let Some(t_s) = metrics.settled_s { (figure("Settled after", &number(t_s), "s")) }
            @if let Some(speed) = metrics.speed {
                (figure("Largest speed, one axis", &number(speed.largest.value), &unit_at(setup, Signal::Velocity, speed.largest.agent, speed.largest.axis)))
            }
            @let peaks = metrics.peak_torques.iter();
            @if let Some(peak) = peaks.reduce(|a, b| if b.value.abs() > a.value.abs() { b } else { a }) {
                (figure(&format!("Peak recorded {}", names::input_words(setup).0), &number(peak.value.abs()), &unit_at(setup, Signal::Torque, peak.agent, peak.axis)))
            }
            @if let Some(balance) = metrics.balance_residual {
                div title=(BALANCE_WORDS) { dt.explained { "Balance residual" } dd { (number(balance.relative)) } }
            }
            (figure("Agents", &setup.agents.len().to_string(), ""))
        }
    }
}

/// What was promised, in a line, and how many hypotheses have which answer.
pub(crate) fn promised(record: &RunRecord<'_>) -> Markup {
    let report = record.verdicts;
    let mut counts: Vec<(Answer, usize)> = Vec::new();
    for answer in report.hypotheses.iter().map(|hypothesis| hypothesis.answer()) {
        match counts.iter_mut().find(|(known, _)| *known == answer) {
            Some((_, count)) => *count += 1,
            None => counts.push((answer, 1)),
        }
    }
    html! {
        p.promised {
            a href="#promises" { (report.theorem) } ": "
            @if counts.is_empty() { "no hypotheses were checked" }
            @for (k, (answer, count)) in counts.iter().enumerate() {
                @let (class, sign) = answer_style(*answer);
                @if k > 0 { ", " }
                span.(class) { (sign) " " (answer.words()) ": " (count) }
            }
            @for failure in record.failures() { "; " span.bad { (failure) } }
        }
    }
}

fn figure(name: &str, value: &str, unit: &str) -> Markup {
    html! { div { dt { (name) } dd { (value) @if !unit.is_empty() && !value.starts_with("not") { span.unit { " " (unit) } } } } }
}
