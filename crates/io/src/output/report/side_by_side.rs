//! `compare.html`: several runs on one page that opens offline, with one clock, one table, and plots laid over each other.
//!
//! Pictures in space are drawn by the script of a single run, once for each: the page puts that script into a function.

use maud::{DOCTYPE, Markup, PreEscaped, html};
use serde::Serialize;

use super::super::comparison::{Compared, ComparedRow, Comparison, RowGroup};
use super::super::palette::{self, Ground};
use super::super::text::prose;
use super::data::harmless_json;
use super::side_data::{SideIndex, side_data};
use super::stage::rates;
use super::{PAGE_CSS, POLICY, STAGE_CSS, UPLOT_CSS, UPLOT_JS, colours_of, network};
use crate::shown;

const SIDE_CSS: &str = include_str!("../../../assets/report/compare.css");
/// Before the pictures.
const COMMON_JS: [&str; 3] = [
    include_str!("../../../assets/report/data.js"),
    include_str!("../../../assets/report/plot.js"),
    include_str!("../../../assets/report/vectors.js"),
];
/// One picture, from what `index`, `data`, `agents` and `colour` are of its run.
const PICTURE_JS: [&str; 5] = [
    include_str!("../../../assets/report/scene.js"),
    include_str!("../../../assets/report/chart.js"),
    include_str!("../../../assets/report/painter.js"),
    include_str!("../../../assets/report/flights.js"),
    include_str!("../../../assets/report/graph.js"),
];
const BEGIN_PICTURE: &str = "const pictureIn = (index, data, agents, colour) => {\n";
const END_PICTURE: &str = "return { bodies, scene, world, charted, floorGrid, camera, frameAt, looking, heardAt, graphWords, lostWords, trailPoint, sceneColours, \
                           drawUnder, drawSolids, drawTrails, drawMarks, drawEdges, drawWords };\n};\n";
/// What leaves the page, and the page itself.
const LAST_JS: [&str; 3] = [
    include_str!("../../../assets/report/svg.js"),
    include_str!("../../../assets/report/export.js"),
    include_str!("../../../assets/report/compare.js"),
];

#[derive(Serialize)]
struct Index {
    until_s: f64,
    break_points: Vec<f64>,
    runs: Vec<SideIndex>,
}

/// The whole page.
pub(crate) fn side_by_side(comparison: &Comparison, runs: &[Compared<'_>]) -> String {
    let (indices, blocks): (Vec<SideIndex>, Vec<String>) =
        runs.iter().map(|run| side_data(run.name, run.record)).unzip();
    let last = |run: &Compared<'_>| run.record.outcome.recording.t_s.last().copied().unwrap_or(0.0);
    let index = Index { until_s: runs.iter().map(last).fold(0.0, f64::max), break_points: Vec::new(), runs: indices };
    // Each picture has as many colours as its run has agents.
    let colours = |(k, run): (usize, &Compared<'_>)| {
        let setup = run.record.setup;
        colours_of(&format!(" .scene.run{k}"), setup.agents.len(), network::vertices(setup))
    };
    let colours: String = runs.iter().enumerate().map(colours).collect();
    let names: Vec<&str> = runs.iter().map(|run| run.name).collect();
    let title = names.join(" beside ");
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                meta name="generator" content={ "forwardstep " (comparison.version) };
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                title { (title) " – forwardstep" }
                style { (PreEscaped(UPLOT_CSS)) }
                style {
                    (PreEscaped(PAGE_CSS)) (PreEscaped(STAGE_CSS)) (PreEscaped(SIDE_CSS))
                    (PreEscaped(colours)) (PreEscaped(run_colours(runs.len())))
                }
            }
            body {
                div #error-banner role="alert" {}
                main {
                    header.top {
                        p.eyebrow { "forwardstep compare" }
                        h1 { (title) }
                    }
                    (space(comparison))
                    (notices(comparison))
                    (table(comparison))
                    section #plots {
                        h2 { "Laid over each other" }
                        div #toolbar { div #legend role="group" aria-label="Runs" {} div.tools { button #reset type="button" disabled { "Reset zoom" } } }
                        noscript { p.note { "The plots need JavaScript." } }
                        div.grid #cards {}
                        p.note.hint { "One colour per run. What was predicted is dashed, and what all agents lie between is faint." }
                    }
                    footer { p {
                        "Beside this page: " code { "compare.json" } " with the table for programs. The runs: "
                        @for (k, run) in comparison.runs.iter().enumerate() { @if k > 0 { ", " } code { (shown(&run.folder).to_string()) } }
                        "."
                    } }
                }
                script #index type="application/json" { (PreEscaped(harmless_json(&index))) }
                @for (k, block) in blocks.iter().enumerate() { script id=(format!("block-{k}")) type="text/plain" { (block) } }
                script { (PreEscaped(UPLOT_JS)) }
                script {
                    (PreEscaped("(() => {\n\"use strict\";\n"))
                    @for part in COMMON_JS { (PreEscaped(part)) }
                    (PreEscaped(BEGIN_PICTURE)) @for part in PICTURE_JS { (PreEscaped(part)) } (PreEscaped(END_PICTURE))
                    @for part in LAST_JS { (PreEscaped(part)) }
                    "})();"
                }
            }
        }
    }
    .into_string()
}

/// A colour for each run, as CSS variables and classes.
fn run_colours(runs: usize) -> String {
    let variables = |ground| -> String {
        (0..runs).map(|k| format!("--run{k}:{};", palette::css(palette::agent(k, runs, ground)))).collect()
    };
    let classes: String = (0..runs).map(|k| format!(".run{k}{{--c:var(--run{k})}}")).collect();
    format!(
        ":root{{{}}}@media screen and (prefers-color-scheme:dark){{:root:not(.printing){{{}}}}}{classes}",
        variables(Ground::Light),
        variables(Ground::Dark)
    )
}

/// Pictures side by side, and one clock below them.
fn space(comparison: &Comparison) -> Markup {
    html! {
        section #side aria-label="The runs in space and time" {
            div.scenes tabindex="0" role="application" aria-roledescription="pictures in space" aria-describedby="view-help" {
                @for (k, run) in comparison.runs.iter().enumerate() {
                    article.card.scene.(format!("run{k}")) {
                        h3 { span.dot {} (run.name) " " span.by { (run.title) } }
                        div.view {}
                        p.note.words {}
                    }
                }
            }
            div.card.clock {
                button #play type="button" aria-pressed="false" { "Play" }
                input #slider type="range" min="0" max="1000" value="0" step="any" aria-label="Simulated time" aria-describedby="view-help";
                output #time for="slider" { "t = 0 s" }
                label { "rate " (rates()) }
                details { summary { "Keys and gestures" } p.note #view-help {
                    "Space plays and pauses; ← and → move in time; Home and End go to the start and the end. Drag or W, A, S, D turn all pictures, + and − \
                     zoom. Plots follow the same clock."
                } }
                noscript { p.note { "The pictures need JavaScript." } }
            }
        }
    }
}

fn notices(comparison: &Comparison) -> Markup {
    let notices = comparison.runs.iter().flat_map(|run| run.notices.iter().map(move |notice| (run, notice)));
    let notices: Vec<_> = notices.collect();
    html! {
        @if !notices.is_empty() {
            section.notices aria-label="Notices" { ul { @for (run, notice) in notices { li { (run.name) ": " (prose(notice)) } } } }
        }
    }
}

/// Promised, predicted, observed; what is the same stands once across all columns.
fn table(comparison: &Comparison) -> Markup {
    let runs = comparison.runs.len();
    html! {
        section #table {
            h2 { "Promised, predicted, observed" }
            @if comparison.is_same() { p { "The runs are the same in all that is compared." } }
            div.card { div.scroll {
                table.compared {
                    thead { tr {
                        th {}
                        @for (k, run) in comparison.runs.iter().enumerate() { th scope="col" class=(format!("run{k}")) { span.dot {} (run.name) } }
                    } }
                    @for group in RowGroup::ALL {
                        tbody {
                            tr.group { th scope="rowgroup" colspan=(runs + 1) { (group.words()) } }
                            @let rows: Vec<_> = comparison.rows.iter().filter(|row| row.group == group).collect();
                            @for (k, row) in rows.iter().enumerate() { (line(row, k.checked_sub(1).map(|k| rows[k]), runs)) }
                        }
                    }
                }
            } }
        }
    }
}

/// A row below another of its group, whose reasons are not said twice.
fn line(row: &ComparedRow, above: Option<&ComparedRow>, runs: usize) -> Markup {
    let is_repeated = |k: usize, because: &Option<String>| {
        above.and_then(|above| above.cells.get(k)).is_some_and(|cell| cell.because == *because)
    };
    html! {
        tr.differs[!row.same] data-row=(row.key) {
            th scope="row" {
                @if !row.same { span.mark title="differs" { "≠" } }
                (prose(&row.name))
                @if let Some(note) = &row.note { small { (prose(note)) } }
            }
            @for (k, cell) in row.cells.iter().enumerate().take(if row.same { 1 } else { runs }) {
                td colspan=[row.same.then_some(runs)] {
                    (prose(&cell.words))
                    @if row.same && runs > 1 { span.by { "the same in all" } }
                    @if let Some(because) = &cell.because {
                        small { @if is_repeated(k, &cell.because) { "as above" } @else { (prose(because)) } }
                    }
                }
            }
        }
    }
}
