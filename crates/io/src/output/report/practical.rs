//! Practical verdicts beside what was watched: what is said of the loop as it is deployed, not from the paper.

use forwardstep_check::{PracticalAnswer, Source};
use forwardstep_sim::Setup;
use forwardstep_sim::recording::Signal;
use maud::{Markup, html};

use super::super::metrics::Metrics;
use super::super::names;
use super::super::practical::{Watched, WatchedLoad, WatchedMargin, WatchedPower};
use super::super::record::RunRecord;
use super::super::text::{self, number, prose};

/// Nothing where nothing is said.
pub(crate) fn practical(record: &RunRecord<'_>, metrics: &Metrics) -> Markup {
    let verdicts = &record.practical.findings;
    if verdicts.is_empty() && metrics.watched.is_none() && record.outcome.statistics.clipped.is_none() {
        return html! {};
    }
    html! {
        section #practical {
            h2 { "Practical" }
            div.beside {
                div.card {
                    h3 { "Before the run" " " span.by { (Source::Derived.words()) } }
                    @if verdicts.is_empty() { p.note { "Nothing is said." } }
                    ul.hypotheses {
                        @for finding in verdicts {
                            @let (class, sign) = style(finding.answer());
                            li class=(class) {
                                span.sign aria-hidden="true" { (sign) }
                                div {
                                    p { strong { (prose(finding.about())) } " " em { (finding.answer().words()) } }
                                    p.because { (prose(&finding.because())) }
                                    p.origin { code { (finding.name()) } }
                                }
                            }
                        }
                    }
                }
                @let watched = watched(record, metrics);
                @if !watched.0.is_empty() {
                    div.card {
                        h3 { "Watched" " " span.by { "at " (rows_of(record, metrics)) " of the recording" } }
                        table.facts { tbody { (watched) } }
                    }
                }
            }
        }
    }
}

fn style(answer: PracticalAnswer) -> (&'static str, &'static str) {
    match answer {
        PracticalAnswer::Bound => ("fair", "≤"),
        PracticalAnswer::Adequate => ("good", "✓"),
        PracticalAnswer::Marginal => ("fair", "✓"),
        PracticalAnswer::NotShown => ("warn", "?"),
        PracticalAnswer::Inadequate => ("bad", "✗"),
    }
}

/// At how many rows was looked.
fn rows_of(record: &RunRecord<'_>, metrics: &Metrics) -> String {
    let some = metrics.watched.and_then(|watched| watched.rows_words(&record.outcome.recording));
    some.unwrap_or_else(|| "rows".to_owned())
}

/// What a bound of the power takes from the run.
fn fed_by(setup: &Setup) -> &'static str {
    let pushed = setup.agents.iter().any(|agent| !agent.pushes.is_empty());
    match (pushed, setup.control.is_some()) {
        (true, true) => "the pushes, the start and σ",
        (true, false) => "the pushes and the start",
        (false, true) => "the start and σ",
        (false, false) => "the start",
    }
}

fn watched(record: &RunRecord<'_>, metrics: &Metrics) -> Markup {
    let setup = record.setup;
    let Watched { sampling_margin, static_load, tracking_power, .. } = metrics.watched.unwrap_or_default();
    html! {
        @if let Some(WatchedMargin { agent, t_s, sigma }) = sampling_margin {
            (fact("Sampling margin", html! {
                "σ = " (number(sigma)) " at most (" (names::agent_name(setup, agent)) ", t = " (number(t_s)) " s)"
            }))
        }
        @if let Some(WatchedLoad { agent, axis, t_s, torque, limit }) = static_load {
            (fact("Static torque", html! {
                "|g| = " (number(torque)) " of " (number(limit)) " " (text::unit(&names::unit(setup, agent, Signal::Torque, axis)))
                " at most (" (names::agent_name(setup, agent)) ", " (names::axis_words(setup, agent, axis)) ", t = " (number(t_s)) " s)"
            }))
        }
        @if let Some(WatchedPower { mean_w, bound_w }) = tracking_power {
            (fact("Σ sᵀKs", html! {
                (number(mean_w)) " W on the average"
                @if let Some(bound_w) = bound_w { ", at most " (number(bound_w)) " W with " (fed_by(setup)) " of this run" }
            }))
        }
        @if let Some(words) = record.outcome.statistics.clipped.and_then(|clipped| names::clipped_words(setup, clipped)) {
            (fact("Clipped", html! { (words) }))
        }
    }
}

fn fact(name: &str, what: Markup) -> Markup {
    html! { tr { th scope="row" { (name) } td { (what) } } }
}
