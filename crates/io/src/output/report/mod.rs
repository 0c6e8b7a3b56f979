//! `report.html`: one self-contained page that opens offline.
//!
//! The page is written here in words and tables; `assets/report` has its style and the script that draws the plots with
//! uPlot. All text goes through maud, which escapes it, or through the JSON index.

mod cascade;
mod data;
mod families;
mod header;
mod injected;
mod interfaces;
mod loads;
mod network;
mod practical;
mod predicted;
mod scene;
mod sections;
mod side_by_side;
mod side_data;
mod single;
mod stage;

use std::time::Duration;

use forwardstep_check::derivation::{Explained, Explanation, Line, Subject, explain};
use forwardstep_sim::Setup;
use forwardstep_sim::recording::{Ending, Signal};
use maud::{DOCTYPE, Markup, PreEscaped, html};

use self::families::Family;
use self::interfaces::interfaces;
use super::explanation::explanation_markup;
use super::formula::unicode;
use super::metrics::{Absence, Disagreement, Gap, Metrics, keeps_balance};
use super::names;
use super::palette::{self, Ground};
use super::record::RunRecord;
use super::table::Table;
use super::text;
use super::timeline::Timeline;
pub(crate) use side_by_side::side_by_side;

const UPLOT_JS: &str = include_str!("../../../assets/uplot/uPlot.iife.min.js");
const UPLOT_CSS: &str = include_str!("../../../assets/uplot/uPlot.min.css");
const PAGE_CSS: &str = include_str!("../../../assets/report/page.css");
const STAGE_CSS: &str = include_str!("../../../assets/report/stage.css");
/// Draws bodies; only on pages that have some.
const THREE_JS: &str = include_str!("../../../assets/three/three.iife.min.js");
/// In the order in which they build on each other.
const PAGE_JS: [&str; 17] = [
    include_str!("../../../assets/report/data.js"),
    include_str!("../../../assets/report/plot.js"),
    include_str!("../../../assets/report/cards.js"),
    include_str!("../../../assets/report/vectors.js"),
    include_str!("../../../assets/report/scene.js"),
    include_str!("../../../assets/report/chart.js"),
    include_str!("../../../assets/report/painter.js"),
    include_str!("../../../assets/report/solids.js"),
    include_str!("../../../assets/report/flights.js"),
    include_str!("../../../assets/report/graph.js"),
    include_str!("../../../assets/report/svg.js"),
    include_str!("../../../assets/report/export.js"),
    include_str!("../../../assets/report/plane.js"),
    include_str!("../../../assets/report/paths.js"),
    include_str!("../../../assets/report/page.js"),
    include_str!("../../../assets/report/stage.js"),
    include_str!("../../../assets/report/talk.js"),
];
/// Keeps what a reader chose from one page of a run to the next.
const CHOICES_JS: &str = include_str!("../../../assets/report/choices.js");
/// Loads the page again; only on pages of a run that goes on.
const FOLLOW_JS: &str = include_str!("../../../assets/report/follow.js");
/// Of more agents a page draws quantiles, and curves of who is chosen; as in `cards.js`.
const MOST_CURVES: usize = 24;
/// Nothing is fetched, whatever the page says.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:";

/// The whole page; of a run that goes on one that a browser loads `again` after so long, and again.
pub(crate) fn page(record: &RunRecord<'_>, metrics: &Metrics, again: Option<Duration>) -> String {
    let goes_on = again.is_some();
    let table = Table::new(record.setup, &record.outcome.recording);
    let reached_s = match &record.outcome.ending {
        Ending::Completed => record.setup.time.end_s,
        Ending::Interrupted { t_s } | Ending::CutOff { t_s } => *t_s,
        Ending::BrokeDown(breakdown) => breakdown.t_s,
    };
    let until_s = table.t_s.last().copied().unwrap_or(0.0).max(if reached_s.is_finite() { reached_s } else { 0.0 });
    let timeline = Timeline::of_setup(record.setup, until_s);
    let payload = data::Payload::of(record, &table, &timeline, until_s);
    let absence = match metrics.disagreement {
        Disagreement::Absent(absence) => Some(absence),
        Disagreement::Measured { .. } => None,
    };
    let explained = explain(record.setup);
    html! {
        (DOCTYPE)
        html lang="en" data-again-s=[again.map(|again| again.as_secs_f64().ceil())] {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                @if goes_on { noscript { meta http-equiv="refresh" content="5"; } }
                meta name="generator" content={ "forwardstep " (record.version) };
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                title { @if goes_on { (sections::so_far(record)) ": " } (record.title) " – forwardstep" }
                style { (PreEscaped(UPLOT_CSS)) }
                style { (PreEscaped(PAGE_CSS)) (PreEscaped(STAGE_CSS)) (PreEscaped(colours(record.setup))) }
            }
            body {
                div #error-banner role="alert" {}
                main {
                    (header::header(record, metrics, goes_on))
                    (stage::stage(record, metrics, absence, goes_on))
                    @if !record.notices.is_empty() {
                        section.notices aria-label="Notices" { ul { @for notice in &record.notices { li { (text::prose(notice)) } } } }
                    }
                    (sections::verdicts(record, metrics, goes_on))
                    (practical::practical(record, metrics))
                    (predicted::section(record, metrics))
                    (signals(record, payload.cascade, absence == Some(Absence::FewerThanTwoAgents), &explained))
                    @if has_network(record) { (network(record, &timeline)) }
                    (interfaces(record.setup))
                    (explanation_markup(record.setup, &explained, &record.footing()))
                    (sections::digital(record))
                    (injected::injected(record))
                    (loads::loads(record.setup, metrics))
                    (sections::provenance(record))
                    footer {
                        @for note in &payload.notes { p { (text::prose(note)) } }
                        @if goes_on { p { "The tables are written when the run has ended." } }
                        @if !goes_on { p {
                            "Beside this page: " code { "trajectory.parquet" } " with every recorded number, " code { "summary.json" }
                            " for programs, " code { "plots/" } " for print, and " code { "scenario.toml" } " to run it again"
                            @if !record.inputs.is_empty() { ", with the files that it names in " code { "inputs/" } }
                            @if !super::packets::links(&record.setup.network).is_empty() { "; " code { "packets.csv" } " has every packet" }
                            "."
                        } }
                    }
                }
                script #index type="application/json" { (PreEscaped(payload.json)) }
                script #block type="text/plain" { (payload.block) }
                script { (PreEscaped(UPLOT_JS)) }
                @if payload.solid { script { (PreEscaped(THREE_JS)) } }
                script { (PreEscaped("(() => {\n\"use strict\";\n")) @for part in PAGE_JS { (PreEscaped(part)) } (PreEscaped(CHOICES_JS)) "choices();\n})();" }
                @if goes_on { script { (PreEscaped(FOLLOW_JS)) } }
            }
        }
    }
    .into_string()
}

/// The plot of all positions, which of one agent alone stands at the top.
fn positions(setup: &Setup) -> Markup {
    if turns(setup) {
        card("position", "Attitudes", "unit quaternions q, o for the scalar part", "")
    } else {
        card("position", "Positions", "q", "")
    }
}

/// Whether what moves are attitudes, by their units.
fn turns(setup: &Setup) -> bool {
    let axes = |signal| {
        (0..setup.agents.len())
            .flat_map(move |agent| (0..setup.agents[agent].robot.axes.len()).map(move |axis| (agent, axis, signal)))
    };
    let unit = |(agent, axis, signal)| names::unit(setup, agent, signal, axis);
    !setup.agents.is_empty()
        && axes(Signal::Position).map(unit).all(|unit| unit == "1")
        && axes(Signal::Velocity).map(unit).any(|unit| unit == "rad/s")
}

/// What s is, of each design as it is explained.
fn error_words(setup: &Setup, explained: &Explanation) -> String {
    let of = |design: &Explained| {
        let first = design.sections.iter().find(|section| section.subject == Subject::VirtualControl)?;
        first.lines.iter().find_map(|line| match line {
            Line::Formula(formula, _) => Some(unicode(formula)).filter(|text| text.starts_with('s')),
            Line::Words(_) => None,
        })
    };
    let mut all: Vec<String> = explained.designs.iter().filter_map(of).collect();
    all.dedup();
    match all.as_slice() {
        [] => "s = q̇ − z".into(),
        [one] => {
            // What agents agree on is then their positions less these.
            let away = if Gap::keeps_offsets(setup) { ", of positions less their offsets" } else { "" };
            format!("{one}{away}")
        }
        _ => "s, as the explanation below defines it for each".into(),
    }
}

/// The plots; the script fills their cards.
fn signals(record: &RunRecord<'_>, cascade: Option<bool>, is_alone: bool, explained: &Explanation) -> Markup {
    let agents = &record.setup.agents;
    let adaptive = agents.iter().any(|agent| agent.estimates());
    let columns = &record.outcome.recording.columns;
    let recorded = |signal| columns.iter().any(|column| column.signal == signal);
    let (_, input) = names::input_words(record.setup);
    let external = columns.iter().filter(|column| column.signal == Signal::External);
    let (external, by) = names::external_words(record.setup, external.map(|column| (column.agent, column.axis)));
    html! {
        section #signals {
            h2 { "Signals" }
            div #toolbar {
                div #legend role="group" aria-label="Agents" {}
                div.tools {
                    label #joint-label { "Joint " select #joint {} }
                    label { input #break-points type="checkbox" checked; " break-points" }
                    button #reset type="button" disabled { "Reset zoom" }
                }
            }
            noscript { p.note { "The plots need JavaScript; the same plots lie in " code { "plots/" } " as SVG." } }
            div.grid {
                @if !is_alone { (positions(record.setup)) }
                @if recorded(Signal::Torque) { (card("torque", input, "τ, after any limit", "")) }
                @if recorded(Signal::External) {
                    (card("external", external, by, ""))
                }
                @let (speed, letter) = if turns(record.setup) { ("Angular velocity", "ω") } else { ("Speed", "q̇") };
                @if recorded(Signal::Reference(0)) {
                    // Where agents keep offsets z is the velocity of what they agree on.
                    @let away = if Gap::keeps_offsets(record.setup) { ", which is of positions less their offsets" } else { "" };
                    @let dashed = if record.setup.agents.len() > MOST_CURVES { "; of who is chosen z dashed" } else { ", and z dashed" };
                    (card("velocity", &format!("{speed} and reference"), &format!("{letter}{dashed}{away}"), ""))
                } @else {
                    (card("velocity", speed, letter, ""))
                }
                (card("plane", "One over another", "paths and phase planes", ""))
                @if recorded(Signal::TrackingError) { (card("error", "Tracking error", &error_words(record.setup, explained), "")) }
                (card("reference", "Reference derivatives", "ż and higher", ""))
                @for family in Family::of(&record.outcome.recording) {
                    (card(&family.id(), &family.title, &family.letters, ""))
                }
                @if adaptive { (card("estimate", "Parameter estimates", "ϑ̂, the truth dashed", "no estimate was recorded")) }
                @if let Some(guaranteed) = cascade.filter(|_| !is_alone) {
                    @let dashed = if guaranteed { "; dashed what is guaranteed for s ≡ 0, above which robots with tracking errors may lie" } else { "" };
                    (card("cascade", "Interval of the cascade", &format!("max − min of all ψ, each scaled to be a position at rest{dashed}"), ""))
                }
                @if recorded(Signal::Lyapunov) {
                    @if recorded(Signal::Dissipation) && keeps_balance(record.setup) { (card("balance", "Lyapunov balance", sections::balance_letters(record), "")) }
                    @else { (card("balance", "Lyapunov function", "V of each agent", "")) }
                }
                @if record.injected_course.is_some() { (card("injected", "V and what was injected", "of all agents together, by cause", "")) }
            }
            p.note.hint { "Drag across a plot to zoom all of them; double-click to see everything again." }
        }
    }
}

/// An empty card of a plot, which the script fills.
fn card(id: &str, title: &str, what: &str, empty: &str) -> Markup {
    html! {
        article.card.plot data-plot=(id) data-empty=(empty) {
            div.head { h3 { (title) " " span.by { (what) } } div.pick {} }
            div.canvas {}
        }
    }
}

/// Whether anybody ever hears anybody, or could.
fn has_network(record: &RunRecord<'_>) -> bool {
    (Gap::of(record.setup) == Gap::Disagreement && record.setup.agents.len() > 1) || record.setup.network.has_edges()
}

fn network(record: &RunRecord<'_>, timeline: &Timeline<'_>) -> Markup {
    html! {
        section #network {
            h2 { "Network" }
            div.card {
                h3 { "Graphs" }
                (network::graphs(record.setup, timeline))
            }
            // Of one graph all edges are active from the start to the end.
            @if record.setup.network.schedule.graphs.len() > 1 {
                article.card.plot data-plot="gantt" {
                    div.head { h3 { "Active edges" " " span.by #gantt-by { "sender → receiver, in the sender’s colour" } } }
                    div.canvas {}
                }
            }
            article.card.plot data-plot="delay" {
                div.head { h3 { "Delays" " " span.by { "T(t)" } } div.pick {} }
                div.canvas {}
            }
            (network::links(record))
        }
    }
}

/// The agents' colours as CSS variables and classes, for both grounds.
fn colours(setup: &Setup) -> String {
    colours_of("", setup.agents.len(), network::vertices(setup))
}

/// The same of so many agents, within what a selector finds; vertices beyond them are leaders.
fn colours_of(within: &str, agents: usize, vertices: usize) -> String {
    let variables = |ground| -> String {
        let agent = (0..agents).map(|k| format!("--a{k}:{};", palette::css(palette::agent(k, agents, ground))));
        let ramp = (0..RAMP).map(|k| format!("--r{k}:{};", palette::css(palette::ramp(k, RAMP, ground))));
        // A leader that is no agent has the colour of the text.
        let leader = (agents..vertices).map(|k| format!("--a{k}:var(--ink);"));
        agent.chain(leader).chain(ramp).collect()
    };
    let classes: String = (0..vertices).map(|k| format!(".a{k}{{--c:var(--a{k})}}")).collect();
    format!(
        ":root{within}{{{}}}@media screen and (prefers-color-scheme:dark){{:root:not(.printing){within}{{{}}}}}{classes}",
        variables(Ground::Light),
        variables(Ground::Dark)
    )
}

/// Steps of the colour ramp for things that are not agents.
const RAMP: usize = 16;
